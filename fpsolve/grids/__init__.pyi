"""The names of this package, and where each of them lives."""

from . import diagnostics as diagnostics
from . import initial as initial
