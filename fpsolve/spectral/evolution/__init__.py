"""Densities evolved in a basis of the generator."""
