"""Results as labelled datasets and as files."""

from fpsolve._support.netcdf import load, save
from fpsolve.results.kinds import from_xarray, to_xarray

__all__ = ["from_xarray", "load", "save", "to_xarray"]
