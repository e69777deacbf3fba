"""Eigenvalues of the generator, the gap, and what they rest on."""
