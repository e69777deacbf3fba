"""Webs: what the fibres of many spinning positions become on the belt."""
