"""Compute again what a file holds, from what it says about how it was made."""

from fpsolve.results.rerun.repeating import rerun

__all__ = ["rerun"]
