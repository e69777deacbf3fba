"""The kinds of results: what each is called, who reads it, and what makes it again."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fpsolve._support.checks import shown
from fpsolve._support.declared import declared
from fpsolve._support.labels import FORMAT, check_complete
from fpsolve.evolution.saved import restored

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["KINDS", "Kind", "from_xarray", "kind_of", "named"]


@dataclass(frozen=True)
class Kind:
    """One kind of result.

    Attributes
    ----------
    words : str
        In the plural, as messages call it.
    function : str
        "module:name" of the public function that makes one, or the function itself.
    reading : str
        "module:name" of the class of the result, or of what makes one from its
        dataset; empty for a study, which is a dataset.
    counts : str
        What a progress bar counts while it is computed: "steps" (with s), "cases", or
        nothing.
    variables, attributes : tuple of str
        What the dataset of a study must hold.
    """

    words: str
    function: str | Callable[..., Any]
    reading: str | Callable[..., Any] = ""
    counts: str = ""
    variables: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()


_CASES = ("noise", "status", "message")
_POTENTIAL = ("potential", "formula", "versions")
# What a result says in `kind`, and its dataset in `fpsolve_kind`.
KINDS = {
    "solution": Kind(
        "solutions", "fpsolve.density.solve:solve",
        "fpsolve.density.solution:Solution", counts="steps",
    ),
    "paths": Kind(
        "paths", "fpsolve.paths.sampling:sample_paths",
        "fpsolve.paths.result:Paths", counts="steps",
    ),
    "fibre-curve": Kind(
        "fibre curves", "fpsolve.paths.fibres.fibre_curve:FibreCurve",
        "fpsolve.paths.fibres.fibre_curve:FibreCurve",
    ),
    "fibre-motion": Kind(
        "motions of a fibre", "fpsolve.fibre.simulating:simulate",
        "fpsolve.fibre.motion:Motion",
    ),
    "fibre-lay-down": Kind(
        "fibres laid down on a belt", "fpsolve.fibre.laying:lay_down",
        "fpsolve.fibre.laid:LayDown",
    ),
    "hydrodynamic": Kind(
        "solutions of the hydrodynamic limit",
        "fpsolve.reduced.hydrodynamic.limit:HydrodynamicLimit.solve",
        "fpsolve.reduced.hydrodynamic.reading:read_solution", counts="steps",
    ),
    "energy": Kind(
        "solutions of the energy process",
        "fpsolve.reduced.energy.process:EnergyProcess.solve",
        "fpsolve.reduced.energy.reading:read_solution", counts="steps",
    ),
    "steady-state": Kind(
        "stationary densities", "fpsolve.density.steady_state:steady_state",
        "fpsolve.density.stationary.result:SteadyState",
    ),
    "periodic-state": Kind(
        "time-periodic densities", "fpsolve.density.periodic_state:periodic_state",
        "fpsolve.density.periodic.result:PeriodicState",
    ),
    "spectral": Kind(
        "expansions in time", "fpsolve.spectral.evolution.evolution:spectral_solve",
        "fpsolve.spectral.evolution.solution:SpectralSolution",
    ),
    "smooth-spectral": Kind(
        "expansions in time, of smooth fibres",
        "fpsolve.spectral.evolution.evolution:spectral_solve",
        "fpsolve.spectral.evolution.smooth_solution:SmoothSpectralSolution",
    ),
    "spectral-steady-state": Kind(
        "stationary expansions",
        "fpsolve.spectral.evolution.steady:spectral_steady_state",
        "fpsolve.spectral.evolution.steady:SpectralSteadyState",
    ),
    "smooth-spectral-steady-state": Kind(
        "stationary expansions of smooth fibres",
        "fpsolve.spectral.evolution.steady:spectral_steady_state",
        "fpsolve.spectral.evolution.smooth_steady:SmoothSpectralSteadyState",
    ),
    "energy-paths": Kind(
        "paths of the energy process",
        "fpsolve.reduced.energy.process:EnergyProcess.sample",
        "fpsolve.reduced.energy.reading:read_paths",
    ),
    "hydrodynamic-paths": Kind(
        "paths of the hydrodynamic limit",
        "fpsolve.reduced.hydrodynamic.limit:HydrodynamicLimit.sample",
        "fpsolve.reduced.hydrodynamic.sampling:HydrodynamicPaths",
    ),
    "web": Kind(
        "webs", "fpsolve.web.lay_web:lay_web", "fpsolve.web.web:Web", counts="steps",
    ),
    "mean-pattern": Kind(
        "mean patterns of webs", "fpsolve.web.pattern:mean_pattern",
        "fpsolve.web.pattern_result:MeanPattern",
    ),
    "check": Kind(
        "checks of density against paths",
        "fpsolve.studies.agreement.cross_check:cross_check",
        "fpsolve.studies.agreement.check:CrossCheck", counts="steps",
    ),
    "spectrum": Kind(
        "spectra", "fpsolve.spectral.eigen.spectrum:spectrum",
        "fpsolve.spectral.eigen.spectrum:Spectrum",
    ),
    "web-prediction": Kind(
        "predicted webs", "fpsolve.web.predict:predict_web",
        "fpsolve.web.prediction:WebPrediction",
    ),
    "identification": Kind(
        "identifications", "fpsolve.studies.identification.identify:identify",
        "fpsolve.studies.identification.identification:Identification",
    ),
    "identification-comparison": Kind(
        "comparisons of identified models",
        "fpsolve.studies.identification.compare_models:compare_models",
        "fpsolve.studies.identification.comparison:IdentificationComparison",
    ),
    "rate": Kind(
        "rates against the noise",
        "fpsolve.studies.rates.rate_versus_noise:rate_versus_noise", counts="cases",
        variables=(*_CASES, "part"),
        attributes=(*_POTENTIAL, "p0", "settings", "quick"),
    ),
    "large-noise": Kind(
        "distances to the limit of large noise",
        "fpsolve.studies.limits.large_noise:large_noise_limit", counts="cases",
        variables=(*_CASES, "quantity", "meaning", "distance", "distance_error",
                   "expected_order", "fitted_order"),
        attributes=(*_POTENTIAL, "p0", "slow_length", "belt_speed_scale",
                    "fixed_speed", "quick"),
    ),
    "white-noise": Kind(
        "distances of smooth fibres to their white-noise limit",
        "fpsolve.studies.limits.white_noise:white_noise_limit", counts="cases",
        variables=("relaxation_length", *_CASES[1:], "quantity", "meaning", "distance",
                   "distance_error", "expected_order", "fitted_order"),
        attributes=(*_POTENTIAL, "noise", "p0", "s_end", "belt_speed", "n_paths",
                    "quick"),
    ),
    "web-homogeneity": Kind(
        "variations of laid and predicted webs",
        "fpsolve.studies.webs.homogeneity:web_homogeneity", counts="cases",
        variables=(*_CASES, "belt_speed", "spacing", "zone", "predicted",
                   "predicted_error", "simulated", "standard_error", "z"),
        attributes=(*_POTENTIAL, "positions", "n_webs", "pixel", "tolerance"),
    ),
    "web-design": Kind(
        "designs of webs", "fpsolve.studies.design.design_web:design_web",
        "fpsolve.studies.design.result:WebDesign",
    ),
    "nozzle-design": Kind(
        "designs of moving nozzles",
        "fpsolve.studies.nozzles.design_nozzles:design_nozzles",
        "fpsolve.studies.nozzles.result:NozzleDesign",
    ),
    "small-noise": Kind(
        "distances to the limit of small noise",
        "fpsolve.studies.limits.small_noise:small_noise_limit", counts="cases",
        variables=(*_CASES, "belt_speed_scale", "distance"),
        attributes=(*_POTENTIAL, "options"),
    ),
    "small-noise-spectrum": Kind(
        "spectra in the limit of small noise",
        "fpsolve.studies.limits.energy_sectors:small_noise_spectrum",
        variables=("noise", "family", "rate", "rate_error", "limit", "limit_error"),
        attributes=(*_POTENTIAL, "tolerance"),
    ),
    "energy-tables": Kind(
        "tables of the energy process", "fpsolve.studies.energy_tables:energy_tables",
        variables=("g", "r_min", "eigenvalue", "eigenvalue_error"),
        attributes=(*_POTENTIAL, "noise", "radius", "g_max"),
    ),
    "averages": Kind(
        "averages along paths", "fpsolve.studies.ergodicity.averages:ergodic_averages",
        counts="steps",
        variables=("noise", "function", "s", "error", "error_standard_error",
                   "asymptotic_variance", "asymptotic_variance_standard_error",
                   "expectation", "deviation"),
        attributes=(*_POTENTIAL, "n_paths"),
    ),
}  # fmt: skip


def named(place: str | Callable[..., Any]) -> Any:
    """Return what "module:name" names; a function as it is."""
    if not isinstance(place, str):
        return place
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(module), name)


def kind_of(result: Any) -> str:
    """Return the key of `KINDS` for a result, or for the dataset of one.

    Raises
    ------
    TypeError
        If it is something else.
    ValueError
        If it is a dataset of something else.
    """
    import xarray as xr

    if isinstance(result, xr.Dataset):
        return _kind_of_dataset(declared(result.attrs))
    kind = getattr(type(result), "kind", None)
    if not (isinstance(kind, str) and kind in KINDS):
        raise TypeError(
            "`result` must be a result of fpsolve (a solution, paths, a spectrum, a "
            f"check or a study), got {shown(result)}."
        )
    return kind


def from_xarray(dataset: xr.Dataset) -> Any:
    """Return the result that its `to_xarray` turned into `dataset`.

    Arrays come back bit for bit. A model made of a user's own functions cannot be
    read back: `model` is None then, and its description and equation are in
    `provenance`. A study is a dataset, and comes back as it is.

    Parameters
    ----------
    dataset : xarray.Dataset

    Raises
    ------
    ValueError
        If the dataset does not have the layout of its kind.

    Warns
    -----
    UserWarning
        If the model could not be read back.
    """
    kind = KINDS[kind_of(dataset)]
    if kind.reading:
        made = named(kind.reading)
        return restored(made, dataset) if isinstance(made, type) else made(dataset)
    check_complete(dataset, *kind.variables, *kind.attributes)
    return dataset


def _kind_of_dataset(about: dict[str, Any]) -> str:
    for name in ("fpsolve_format", "fpsolve_kind"):
        if name not in about:
            raise ValueError(
                f"it is not a result of fpsolve (attribute `{name}` is missing)"
            )
    written, kind = about["fpsolve_format"], str(about["fpsolve_kind"])
    if written > FORMAT:
        raise ValueError(
            f"it has layout {written}, this version of fpsolve reads up to "
            f"{FORMAT}; update fpsolve"
        )
    if kind not in KINDS:
        known = ", ".join(map(repr, KINDS))
        raise ValueError(
            f"it holds {kind!r}, this version of fpsolve reads {known}; update fpsolve"
        )
    return kind
