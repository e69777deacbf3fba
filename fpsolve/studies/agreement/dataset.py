"""A cross-check as a labelled `xarray.Dataset`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.labels import marked, origin
from fpsolve.model.stored import describe_model
from fpsolve.studies.agreement.outcome import MARGINALS

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["NO_DEGREES", "NUMBERS", "to_xarray"]

NUMBERS = {
    "statistic": "χ², largest |z|, or z",
    "critical": "|statistic| from which on the test disagrees",
    "p_value": "p-value",
    "threshold": "p-value below which the test disagrees",
    "detectable": "disagreement seen with probability 0.99",
    "difference": "disagreement found",
    "step_error": "estimated step error of density and paths",
    "grid_error": "estimated error of the density's grid, for which the test allows",
    "density": "value by the density",
    "paths": "value by the paths",
    "standard_error": "standard error of the value by the paths",
}

# Stands for the degrees of freedom of a test that has none.
NO_DEGREES = -1


def to_xarray(check: Any) -> xr.Dataset:
    """Every number of the tests over (s, test), and the marginals of both sides.

    The attributes say where density and paths come from (JSON) and hold the verdict.

    Parameters
    ----------
    check : CrossCheck

    Returns
    -------
    xarray.Dataset
    """
    import xarray as xr

    names = list(check.detectable)
    variables: dict[str, Any] = {
        number: (("s", "test"), _table(check, number, np.float64), _labels(meaning))
        for number, meaning in NUMBERS.items()
    }
    agrees = _table(check, "agrees", np.int8)
    variables["agrees"] = (("s", "test"), agrees, _labels("1 if the test agrees"))
    degrees = [NO_DEGREES if t.degrees is None else t.degrees for t in check.tests]
    variables["degrees"] = (
        ("s", "test"), np.array(degrees, dtype=np.int64).reshape(len(check.s), -1),
        _labels("degrees of freedom, -1 if the test has none"),
    )  # fmt: skip
    for which in MARGINALS:
        variables[f"probability_{which}"] = (
            ("s", which), check.probabilities[which],
            _labels(f"probability of a cell of {which} by the density"),
        )  # fmt: skip
        variables[f"count_{which}"] = (
            ("s", which), check.counts[which],
            _labels(f"paths inside the box in a cell of {which}"),
        )  # fmt: skip
    coordinates = {
        "s": ("s", check.s, _labels("arclength s")),
        "test": ("test", np.array(names, dtype=object)),
        **{which: (which, getattr(check.grid, which)) for which in MARGINALS},
    }
    dataset = xr.Dataset(variables, coordinates, _attributes(check))
    dataset = dataset if check.call is None else check.call.on(dataset)
    return marked(dataset, "check")


def _table(check: Any, number: str, kind: type) -> Any:
    """One number of every test, as an array over (s, test)."""
    values = [getattr(test, number) for test in check.tests]
    return np.array(values, dtype=kind).reshape(len(check.s), -1)


def _labels(meaning: str) -> dict[str, str]:
    return {"long_name": meaning, "units": "1"}


def _attributes(check: Any) -> dict[str, Any]:
    model = check.model
    return {
        "title": "Density against paths",
        "verdict": str(check),
        "agrees": int(check.agrees),
        "false_alarm": check.false_alarm,
        "n_paths": check.n_paths,
        **describe_model(
            model, None if model is None else model.equation, check.provenance
        ),
        "grid": json.dumps(check.grid.to_dict()),
        "solver": json.dumps(check.solver),
        "sampler": json.dumps(check.sampler),
        **origin(check.provenance),
    }
