"""Bases in which the generator is a matrix."""
