"""Cells of phase space and of the plane, densities on them and what is read off."""

from fpsolve._support.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
