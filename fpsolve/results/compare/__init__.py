"""Two results of the same kind side by side: numbers, errors, parameters."""

from fpsolve.results.compare.comparing import compare
from fpsolve.results.compare.comparison import Comparison
from fpsolve.results.compare.differences import Difference

__all__ = ["Comparison", "Difference", "compare"]
