"""Figures of solutions and of paths; each function returns a matplotlib Figure.

The figures belong to no window: nothing is shown and pyplot keeps no record of them.
Save one with ``figure.savefig(path)``; a notebook shows it when it is the last value
of a cell.
"""

from fpsolve._support.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
