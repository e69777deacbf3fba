"""Who writes about which kind of result."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fpsolve.pages.blocks import Section

__all__ = ["PAGES"]

# By the kind of a result "module:name" of a function of it and of the name of its
# file, which returns a Section, or the function. Loaded only when it is asked for.
PAGES: dict[str, str | Callable[[Any, str], Section]] = {
    "solution": "fpsolve.pages.solution:section",
    "paths": "fpsolve.pages.paths:section",
    "fibre-curve": "fpsolve.pages.fibre_curve:section",
    "fibre-motion": "fpsolve.pages.fibre_motion:motion_section",
    "fibre-lay-down": "fpsolve.pages.fibre_motion:lay_down_section",
    "hydrodynamic": "fpsolve.pages.limit_solutions:hydrodynamic_section",
    "energy": "fpsolve.pages.limit_solutions:energy_section",
    "steady-state": "fpsolve.pages.plain:steady_state",
    "periodic-state": "fpsolve.pages.periodic:section",
    "spectral": "fpsolve.pages.plain:spectral",
    "smooth-spectral": "fpsolve.pages.plain:smooth_spectral",
    "spectral-steady-state": "fpsolve.pages.plain:spectral_steady_state",
    "smooth-spectral-steady-state": "fpsolve.pages.plain:spectral_steady_state",
    "energy-paths": "fpsolve.pages.plain:energy_paths",
    "hydrodynamic-paths": "fpsolve.pages.plain:hydrodynamic_paths",
    "web": "fpsolve.pages.web:section",
    "mean-pattern": "fpsolve.pages.pattern:section",
    "check": "fpsolve.pages.cross_check:section",
    "spectrum": "fpsolve.pages.spectrum:section",
    "web-prediction": "fpsolve.pages.predicted_web:section",
    "identification": "fpsolve.pages.identification:section",
    "identification-comparison": "fpsolve.pages.identification_comparison:section",
    "rate": "fpsolve.pages.rates:section",
    "large-noise": "fpsolve.pages.limits:large_section",
    "white-noise": "fpsolve.pages.white_noise:white_section",
    "web-homogeneity": "fpsolve.pages.homogeneity:section",
    "web-design": "fpsolve.pages.design:section",
    "nozzle-design": "fpsolve.pages.nozzle_design:section",
    "small-noise": "fpsolve.pages.limits:small_section",
    "small-noise-spectrum": "fpsolve.pages.limits:spectrum_section",
    "energy-tables": "fpsolve.pages.energy:section",
    "averages": "fpsolve.pages.averages:section",
}
