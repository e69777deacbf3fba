"""How an identification is stored, with the fibre of which it is."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.labels import labels, to_json
from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_counts,
    check_dimensions,
)
from fpsolve.evolution.parts import Model
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.goodness import TESTS
from fpsolve.studies.identification.increments import NAMES

__all__ = ["FIBRE", "IDENTIFICATION", "METHODS", "checked_method"]

METHODS = ("likelihood", "functional")
_LAG, _BAND = ("lag",), ("band", "lag")


def checked_method(name: str) -> str:
    """The method; ValueError for one that does not exist."""
    if name not in METHODS:
        raise ValueError(f"`method` must be one of {METHODS}, got {name!r}")
    return name


class _Data(Part):
    """The fibre: its own parts, but the reference curve, which the model has."""

    @property
    def needed(self) -> tuple[str, ...]:
        return tuple(name for part in FibreCurve.layout.parts for name in part.needed)

    def write(self, result: Any) -> Stored:
        stored: Stored = {}
        for part in FibreCurve.layout.parts:
            stored |= part.write(result.data)
        return stored

    def read(self, source: Source) -> dict[str, Any]:
        fields: dict[str, Any] = {}
        for part in FibreCurve.layout.parts:
            fields |= part.read(source)
        return {"data": FibreCurve(**fields)}


FIBRE = _Data()


class _Parameters(Part):
    """Parameters and p-values, by names that are there in this order."""

    needed = ("estimate", "p_value", "covariance")

    def write(self, result: Any) -> Stored:
        values = np.array(list(result.parameters.values()))
        p_values = np.array([result.p_values[name] for name in TESTS])
        return {
            "parameter": ("parameter", np.array(list(result.parameters), dtype=object)),
            "test": ("test", np.array(TESTS, dtype=object)),
            "estimate": ("parameter", values, labels("estimate of the parameter")),
            "covariance": (("parameter", "other"), result.covariance,
                           labels("covariance of the estimates")),
            "p_value": ("test", p_values, labels("p-value of the goodness of fit")),
        }  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        dataset = source.dataset
        check_dimensions(dataset, "estimate", ("parameter",))
        check_dimensions(dataset, "p_value", ("test",))
        check_dimensions(dataset, "covariance", ("parameter", "other"))
        values, covariance = dataset["estimate"].values, dataset["covariance"].values
        n = len(values)
        if n not in (3, 4):
            raise ValueError(f"`estimate` must be of 3 or 4 parameters, got {n}")
        check_counts("covariance", covariance.shape, (n, n), "`estimate`")
        check_counts("p_value", dataset.sizes["test"], len(TESTS), "the tests")
        names = NAMES[:n]
        found = dict(zip(names, values.tolist(), strict=True))
        p_values = dict(zip(TESTS, dataset["p_value"].values.tolist(), strict=True))
        return {"parameters": found, "covariance": covariance, "p_values": p_values}


IDENTIFICATION = Layout(
    "Parameters of a lay-down model from a fibre curve",
    Model(equation="process_equation"),
    FIBRE,
    Attribute("method", read_as=checked_method),
    _Parameters(),
    Variable("log_likelihood", (), "logarithm of the likelihood", kind=float,
             optional=True),
    Variable("history", ("iteration", "parameter"), "parameters of the iterations"),
    Variable("k_max", (), "longest lag of increments in steps", kind=int),
    Variable("h", _LAG, "length of fibre between two angles"),
    Variable("angle_increments", _BAND,
             "Γ_α: data, mean and 95 % band of surrogates", "angle_bands"),
    Variable("curvature_increments", _BAND,
             "Γ_κ: data, mean and 95 % band of surrogates", "curvature_bands"),
    Attribute("undetermined", write_as=to_json, read_as=dict),
    Attribute("notes", write_as=lambda notes: to_json(list(notes)), read_as=tuple),
)  # fmt: skip
