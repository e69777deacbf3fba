"""Results as labelled datasets and as files."""

from fpsolve.io.dataset import from_xarray, to_xarray
from fpsolve.io.files import load, save

__all__ = ["from_xarray", "load", "save", "to_xarray"]
