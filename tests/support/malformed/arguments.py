"""Arguments that no function can work with, over all public entry points."""

from __future__ import annotations

from .answers import FIGURES, INTEROP, REDUCED, SPECTRA, STUDIES
from .designs import DESIGNS
from .models import GRIDS, MODELS, PROCESSES
from .runs import RUNS, SAMPLES, SCHEMES, STARTS

ARGUMENTS = [
    *MODELS, *GRIDS, *STARTS, *SCHEMES, *RUNS, *SAMPLES, *SPECTRA, *REDUCED,
    *PROCESSES, *STUDIES, *DESIGNS, *INTEROP, *FIGURES,
]  # fmt: skip
