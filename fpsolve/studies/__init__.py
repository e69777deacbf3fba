"""Questions that one call answers: do density and paths agree, do averages converge.

`cross_check` solves a model for its density, samples its paths and says whether both
agree; `compare` does so for results that exist already. `ergodic_averages` measures
how time averages converge to those of the equilibrium. `rate_versus_noise` puts decay
rates of runs, spectra and proven bounds side by side, and `sweep` runs any function
over many cases, in processes or on a cluster. `design_web` finds the process that lays
the most even web, `design_nozzles` how nozzles should move. The names are loaded on
first use.
"""

from fpsolve._support.lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
