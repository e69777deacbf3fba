"""How two identifications of one fibre are stored: numbers over the models."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.labels import labels, to_json
from fpsolve.evolution.call import Call
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
from fpsolve.model.stored import describe_model, read_model
from fpsolve.studies.identification.goodness import TESTS
from fpsolve.studies.identification.identification import Identification
from fpsolve.studies.identification.increments import NAMES
from fpsolve.studies.identification.layout import FIBRE, checked_method

__all__ = ["COMPARISON", "MODELS", "call_of"]

MODELS = ("basic", "smooth")
# Parameters of each; what the basic model has not is NaN.
_COUNTS = {"basic": 3, "smooth": 4}
_MODEL, _LAG = ("model",), ("lag",)
_BANDS = ("model", "band", "lag")
# Variables that are read back, over which dimensions, and what they are.
_VARIABLES = {
    "estimate": (("model", "parameter"), "estimate of the parameter"),
    "covariance": (("model", "parameter", "other"), "covariance of the estimates"),
    "p_value": (("model", "test"), "p-value of the goodness of fit"),
    "log_likelihood": (_MODEL, "logarithm of the likelihood; NaN by the functional"),
    "history": (("model", "iteration", "parameter"), "parameters of the iterations"),
    "n_iterations": (_MODEL, "iterations"),
    "k_max": ((), "longest lag of increments in steps"),
    "h": (_LAG, "length of fibre between two angles"),
    "angle_increments": (_BANDS, "Γ_α: data, mean and 95 % band of surrogates"),
    "curvature_increments": (_BANDS, "Γ_κ: data, mean and 95 % band of surrogates"),
}


def call_of(call: Call | None, model: str) -> Call | None:
    """The call of `identify` that a call of `compare_models` makes for a model."""
    if call is None:
        return None
    return Call("identify", {**call.arguments, "model": model}, call.arrays)


class _Models(Part):
    """Both identifications, and their fibre once."""

    needed = (*FIBRE.needed, *_VARIABLES, "method", "models")

    def write(self, result: Any) -> Stored:
        both = [getattr(result, name) for name in MODELS]
        values = _values(both)
        told = {name: _told(one) for name, one in zip(MODELS, both, strict=True)}
        coordinates = {"model": MODELS, "parameter": NAMES, "test": TESTS}
        named = {name: (name, np.array(words, dtype=object))
                 for name, words in coordinates.items()}  # fmt: skip
        numbers = {name: (dims, values[name], labels(words))
                   for name, (dims, words) in _VARIABLES.items()}  # fmt: skip
        about = {"method": both[0].method, "models": to_json(told)}
        return FIBRE.write(result) | named | numbers | about

    def read(self, source: Source) -> dict[str, Any]:
        dataset = source.dataset
        for name, (dims, _) in _VARIABLES.items():
            check_dimensions(dataset, name, dims)
        for name, known in (("model", MODELS), ("parameter", NAMES), ("test", TESTS)):
            check_counts(name, dataset.sizes[name], len(known), "this version")
        data = FIBRE.read(source)["data"]
        return {name: _read(name, source, data) for name in MODELS}


def _told(one: Identification) -> dict[str, Any]:
    """The model, and what is said in words."""
    equation = None if one.model is None else one.model.process_equation
    described = describe_model(one.model, equation, one.provenance)
    return {
        "equation": described["equation"],
        "model": json.loads(described["model"]),
        "undetermined": one.undetermined,
        "notes": list(one.notes),
    }


def _values(both: list[Identification]) -> dict[str, Any]:
    """Numbers of both, those of the basic model filled up with NaN."""
    n, longest = len(NAMES), max(len(one.history) for one in both)
    likelihoods = [one.log_likelihood for one in both]
    return {
        "estimate": np.stack([_filled([*one.parameters.values()], n) for one in both]),
        "covariance": np.stack([_filled(one.covariance, n, n) for one in both]),
        "p_value": np.array([[one.p_values[test] for test in TESTS] for one in both]),
        "log_likelihood": np.array(likelihoods, dtype=np.float64),
        "history": np.stack([_filled(one.history, longest, n) for one in both]),
        "n_iterations": np.array([len(one.history) for one in both]),
        "k_max": both[0].k_max,
        "h": both[0].h,
        "angle_increments": np.stack([one.angle_bands for one in both]),
        "curvature_increments": np.stack([one.curvature_bands for one in both]),
    }


def _filled(values: Any, *shape: int) -> Array:
    """The values in the first corner of an array, NaN elsewhere."""
    values, filled = np.asarray(values), np.full(shape, np.nan)
    filled[tuple(slice(size) for size in values.shape)] = values
    return filled


def _read(name: str, source: Source, data: Any) -> Identification:
    """One of both."""
    table = source.dataset.isel(model=MODELS.index(name))
    numbers = {key: table[key].values for key in _VARIABLES}
    n, n_iterations = _COUNTS[name], int(numbers["n_iterations"])
    likelihood = float(numbers["log_likelihood"])
    told, provenance = source.about["models"][name], dict(source.provenance)
    return Identification(
        model=read_model(told, provenance),
        data=data,
        method=checked_method(source.about["method"]),
        parameters=dict(zip(NAMES, numbers["estimate"].tolist()[:n], strict=False)),
        covariance=numbers["covariance"][:n, :n],
        log_likelihood=None if np.isnan(likelihood) else likelihood,
        history=numbers["history"][:n_iterations, :n],
        k_max=int(numbers["k_max"]),
        h=numbers["h"],
        angle_bands=numbers["angle_increments"],
        curvature_bands=numbers["curvature_increments"],
        p_values=dict(zip(TESTS, numbers["p_value"].tolist(), strict=True)),
        undetermined=dict(told["undetermined"]),
        notes=tuple(told["notes"]),
        call=call_of(Call.from_xarray(source.dataset), name),
        provenance=provenance,
    )


def _over_models(name: str) -> Any:
    """A number of every model, for the readers of the dataset, or None."""

    def take(result: Any) -> Array | None:
        found = getattr(result, name)
        return None if found is None else np.array(list(found.values()))

    return take


COMPARISON = Layout(
    "Basic and smooth model of a fibre curve",
    _Models(),
    Variable("aic", _MODEL, "2 n - 2 ln L", optional=True,
             values=_over_models("aic")),
    Variable("weight", _MODEL, "Akaike weight", optional=True,
             values=_over_models("weights")),
    Attribute("verdict", values=lambda result: " ".join(result.verdict)),
)  # fmt: skip
