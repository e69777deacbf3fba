"""The large-noise study as a labelled `xarray.Dataset`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.labels import labels, made_with, marked, to_json
from fpsolve.model.potentials.dictionaries import potential_to_dict
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.studies.limits.orders import fitted_order, observed_orders
from fpsolve.studies.limits.quantities import Quantity, quantities_of
from fpsolve.studies.sweeps.sweep import Case

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["large_noise_dataset"]

Array = NDArray[np.float64]


def large_noise_dataset(
    potential: Potential,
    noises: Array,
    parts: Sequence[str],
    cases: Sequence[Case],
    about: Mapping[str, Any],
) -> xr.Dataset:
    """The cases of a study as a Dataset; NaN where there is none."""
    import xarray as xr

    by_place = {
        (case.arguments["part"], case.arguments["noise"]): case for case in cases
    }
    rows = [{part: by_place[part, float(noise)] for part in parts} for noise in noises]
    listed = quantities_of(parts, quadratic=isinstance(potential, QuadraticPotential))
    dataset = xr.Dataset(
        _distances(rows, listed, noises**-2.0) | _statuses(rows, parts),
        {
            "noise": ("noise", noises, labels("noise A")),
            "epsilon": ("noise", noises**-2.0, labels("ε = 1/A²")),
            "quantity": ("quantity", _texts(one.name for one in listed)),
            "meaning": ("quantity", _texts(one.meaning for one in listed)),
            "part": ("part", _texts(parts)),
        },
        {
            "title": "Distance to the limit of large noise",
            "potential": to_json(potential_to_dict(potential)),
            "formula": potential.formula,
            **about,
            **made_with(),
        },
    )
    return marked(dataset, "large-noise")


def _distances(
    rows: Sequence[Mapping[str, Case]], listed: Sequence[Quantity], epsilon: Array
) -> dict[str, Any]:
    """Distances, their errors and orders."""
    distance, error = (
        np.array(
            [
                [_number(row[one.part], one.measure + end) for one in listed]
                for row in rows
            ]
        )
        for end in ("", "_error")
    )
    observed = np.array([observed_orders(epsilon, one) for one in distance.T]).T
    fits = [
        fitted_order(epsilon, one, floor)
        for one, floor in zip(distance.T, error.T, strict=True)
    ]
    both = ("noise", "quantity")
    return {
        "distance": (both, distance, labels("distance to the limit")),
        "distance_error": (both, error, labels("numerical error of the distance")),
        "observed_order": (both, observed, labels("order since the last noise")),
        "expected_order": (
            "quantity", np.array([one.order for one in listed]),
            labels("order that is derived"),
        ),
        "fitted_order": (
            "quantity", np.array([one.order for one in fits]), labels("fitted order"),
        ),
        "fitted_order_error": (
            "quantity", np.array([one.standard_error for one in fits]),
            labels("standard error of the fitted order"),
        ),
    }  # fmt: skip


def _number(case: Case, name: str) -> float:
    return float(case.values[name]) if name in case.values else math.nan


def _statuses(
    rows: Sequence[Mapping[str, Case]], parts: Sequence[str]
) -> dict[str, Any]:
    both = ("noise", "part")
    tables = {
        name: np.array(
            [[getattr(row[part], name) for part in parts] for row in rows], dtype=kind
        )
        for name, kind in (("status", object), ("message", object), ("seconds", float))
    }
    return {
        "status": (both, tables["status"]),
        "message": (both, tables["message"]),
        "seconds": (both, tables["seconds"], {"long_name": "wall time", "units": "s"}),
    }


def _texts(values: Iterable[str]) -> NDArray[Any]:
    return np.array(list(values), dtype=object)
