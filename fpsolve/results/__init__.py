"""Results of every kind: from files, set side by side, computed again."""

from fpsolve.results.kinds import from_xarray
from fpsolve.results.load import load

__all__ = ["from_xarray", "load"]
