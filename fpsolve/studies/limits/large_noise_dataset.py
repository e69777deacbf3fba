"""The large-noise study as a labelled `xarray.Dataset`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.labels import labels
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.studies.limits.orders import fitted_order, observed_orders
from fpsolve.studies.limits.quantities import Quantity, quantities_of
from fpsolve.studies.sweeps.study import (
    by_noise_and_part,
    numbers_of,
    outcomes,
    study_dataset,
    texts,
)
from fpsolve.studies.sweeps.sweep import Case

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["distance_variables", "large_noise_dataset"]


def large_noise_dataset(
    potential: Potential,
    noises: Array,
    parts: Sequence[str],
    cases: Sequence[Case],
    about: Mapping[str, Any],
) -> xr.Dataset:
    """The cases of a study as a Dataset; NaN where there is none."""
    placed = by_noise_and_part(cases, noises, parts)
    listed = quantities_of(parts, quadratic=isinstance(potential, QuadraticPotential))
    columns = dict(zip(parts, placed.T, strict=True))
    variables = distance_variables(columns, listed, noises**-2.0)
    coordinates = {
        "noise": ("noise", noises, labels("noise A")),
        "epsilon": ("noise", noises**-2.0, labels("ε = 1/A²")),
        "quantity": ("quantity", texts(one.name for one in listed)),
        "meaning": ("quantity", texts(one.meaning for one in listed)),
        "part": ("part", texts(parts)),
    }
    variables |= outcomes(placed, ("noise", "part"))
    title = "Distance to the limit of large noise"
    return study_dataset("large-noise", title, potential, variables, coordinates, about)


def distance_variables(
    columns: Mapping[str, NDArray[Any]],
    listed: Sequence[Quantity],
    epsilon: Array,
    over: str = "noise",
) -> dict[str, Any]:
    """Distances, their errors, and orders in a small parameter over a dimension."""
    distance, error = (
        np.stack(
            [numbers_of(columns[one.part], one.measure + end) for one in listed], 1
        )
        for end in ("", "_error")
    )
    observed = np.array([observed_orders(epsilon, one) for one in distance.T]).T
    fits = [
        fitted_order(epsilon, one, floor)
        for one, floor in zip(distance.T, error.T, strict=True)
    ]
    last = over.replace("_", " ")
    both, each = (over, "quantity"), "quantity"
    expected = np.array([one.order for one in listed])
    fitted = np.array([(one.order, one.standard_error) for one in fits]).T
    return {
        "distance": (both, distance, labels("distance to the limit")),
        "distance_error": (both, error, labels("numerical error of the distance")),
        "observed_order": (both, observed, labels(f"order since the last {last}")),
        "expected_order": (each, expected, labels("order that is derived")),
        "fitted_order": (each, fitted[0], labels("fitted order")),
        "fitted_order_error": (
            each, fitted[1], labels("standard error of the fitted order"),
        ),
    }  # fmt: skip
