"""Every series of a solution, once; what the variables of a result are in words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

__all__ = [
    "COORDINATES",
    "DENSITY",
    "SERIES",
    "START",
    "Series",
    "is_extrapolated",
    "long_name",
]

DENSITY = "probability density p(s, ξ₁, ξ₂, α)"

START = {
    "initial_density": "initial density p₀(ξ₁, ξ₂, α)",
    "reference_density": "density that the entropy is relative to",
}

COORDINATES = {
    "s": "arclength s of the saved densities",
    "s_step": "arclength s of the recorded steps",
    "xi1": "deviation ξ₁ along the belt",
    "xi2": "deviation ξ₂ across the belt",
    "alpha": "angle α in radians",
    "kappa": "curvature κ",
}


@dataclass(frozen=True)
class Series:
    """A number that is recorded at every step.

    Attributes
    ----------
    name : str
        That of the attribute of a solution and of the variable in its dataset.
    words : str
    value : callable
        Takes the record of a step (`density.recorder.Record`); None where the run has
        no such number.
    approximates : bool
        Whether it approximates something that does not depend on ds, so that two runs
        are extrapolated; others describe the finer run.
    """

    name: str
    words: str
    value: Callable[[Any], float | None]
    approximates: bool = True


def _moment(name: str, words: str) -> Series:
    return Series(name, words, lambda record: record.moments.get(name))


# Every series of a solution, in the order of its record.
SERIES = {one.name: one for one in (
    Series("s", "arclength s", lambda record: record.s, approximates=False),
    Series("mass", "mass ∫ p dξ dα", lambda record: record.sums.mass()),
    Series("relative_entropy", "relative entropy H(p|p_S)",
           lambda record: record.relative_entropy),
    Series("entropy_dissipation",
           "entropy dissipation (A²/2) ∫ p (∂_α ln(p/p_S))² dξ dα",
           lambda record: record.entropy_dissipation),
    Series("minimum", "smallest value of p", lambda record: record.sums.minimum(),
           approximates=False),
    Series("negative_mass", "mass of the negative part of the density",
           lambda record: record.sums.negative_mass(), approximates=False),
    Series("boundary_mass", "mass in the cells at the boundary of the box",
           lambda record: record.boundary_mass, approximates=False),
    Series("kappa_boundary_mass", "mass in the cells at the ends of κ",
           lambda record: getattr(record, "kappa_boundary_mass", None),
           approximates=False),
    Series("mass_correction", "relative mass error removed",
           lambda record: record.report.get("mass_correction"), approximates=False),
    Series("theta", "weight θ of the adjusted advection",
           lambda record: record.report.get("theta"), approximates=False),
    _moment("mean_xi1", "mean E ξ₁"),
    _moment("mean_xi2", "mean E ξ₂"),
    _moment("variance_xi1", "variance Var ξ₁"),
    _moment("variance_xi2", "variance Var ξ₂"),
    _moment("covariance", "covariance Cov(ξ₁, ξ₂)"),
    _moment("mean_cos_alpha", "mean E cos α"),
    _moment("mean_sin_alpha", "mean E sin α"),
    _moment("mean_kappa", "mean E κ of the curvature"),
    _moment("mean_kappa2", "mean E κ² of the squared curvature"),
    Series("entropy_rise", "rise of H(p|p_S) above its smallest value so far",
           lambda record: record.entropy_rise, approximates=False),
    Series("circulation", "circulation E G relative to the largest G",
           lambda record: record.circulation),
    Series("circulation_deviation", "deviation of the circulation from its exact law",
           lambda record: record.circulation_deviation),
)}  # fmt: skip


def is_extrapolated(name: str) -> bool:
    """Whether two runs are combined for a series; those of a user are, too."""
    return name not in SERIES or SERIES[name].approximates


_ERRORS = {"density_l1": "L¹ norm of p"}


def long_name(variable: str) -> str:
    """Return the long name of a series or of an error estimate.

    Parameters
    ----------
    variable : str
        Name in the dataset, for instance "mass" or "mass_error".
    """
    quantity = variable.removesuffix("_error")
    known = SERIES.get(quantity)
    name = _ERRORS.get(quantity) or (known.words if known else quantity)
    return name if quantity == variable else f"estimated error of: {name}"
