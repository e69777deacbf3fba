"""Webs of many fibres: laid, measured and described."""
