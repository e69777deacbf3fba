"""What the variables of a result are: their names in words, series and errors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "COORDINATES",
    "DENSITY",
    "SERIES",
    "START",
    "long_name",
    "read_errors",
    "read_series",
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
}

SERIES = {
    "mass": "mass ∫ p dξ dα",
    "relative_entropy": "relative entropy H(p|p_S)",
    "entropy_dissipation": "entropy dissipation (A²/2) ∫ p (∂_α ln(p/p_S))² dξ dα",
    "minimum": "smallest value of p",
    "negative_mass": "mass of the negative part of the density",
    "boundary_mass": "mass in the cells at the boundary of the box",
    "mass_correction": "relative mass error removed",
    "entropy_rise": "rise of H(p|p_S) above its smallest value so far",
    "circulation": "circulation E G relative to the largest G",
    "circulation_deviation": "deviation of the circulation from its exact law",
    "mean_xi1": "mean E ξ₁",
    "mean_xi2": "mean E ξ₂",
    "variance_xi1": "variance Var ξ₁",
    "variance_xi2": "variance Var ξ₂",
    "covariance": "covariance Cov(ξ₁, ξ₂)",
    "mean_cos_alpha": "mean E cos α",
    "mean_sin_alpha": "mean E sin α",
    "theta": "weight θ of the adjusted advection",
}

_ERRORS = {"density_l1": "L¹ norm of p"}


def long_name(variable: str) -> str:
    """Return the long name of a series or of an error estimate.

    Parameters
    ----------
    variable : str
        Name in the dataset, for instance "mass" or "mass_error".
    """
    quantity = variable.removesuffix("_error")
    name = _ERRORS.get(quantity) or SERIES.get(quantity, quantity)
    return name if quantity == variable else f"estimated error of: {name}"


def read_series(dataset: xr.Dataset, dimension: str) -> dict[str, Any]:
    """Return every recorded series of a solution, s first; errors are left out."""
    series = {"s": dataset["s_step"].values}
    for name, variable in dataset.data_vars.items():
        if variable.dims == (dimension,) and not str(name).endswith("_error"):
            series[str(name)] = variable.values
    return series


def read_errors(dataset: xr.Dataset) -> dict[str, Any]:
    """Return every error estimate of a solution by the name of its quantity."""
    return {
        str(name).removesuffix("_error"): variable.values
        for name, variable in dataset.data_vars.items()
        if str(name).endswith("_error")
    }
