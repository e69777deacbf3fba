"""Two results of the same kind side by side: numbers, errors, parameters."""

from fpsolve.comparisons.comparing import compare
from fpsolve.comparisons.comparison import Comparison
from fpsolve.comparisons.differences import Difference

__all__ = ["Comparison", "Difference", "compare"]
