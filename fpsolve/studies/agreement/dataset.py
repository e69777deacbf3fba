"""A cross-check as a labelled `xarray.Dataset`, and back."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete, made_with, read_model, to_json
from fpsolve.density.layout import check_counts
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.studies.agreement.check import MARGINALS, AgreementTest, CrossCheck
from fpsolve.studies.recipe import RECIPE

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray", "to_xarray"]

_NUMBERS = {
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

_NEEDED_ATTRIBUTES = (
    "false_alarm",
    "n_paths",
    "equation",
    "model",
    "grid",
    "solver",
    "sampler",
)
# Stands for the degrees of freedom of a test that has none.
_NO_DEGREES = -1


def to_xarray(check: CrossCheck) -> xr.Dataset:
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
        for number, meaning in _NUMBERS.items()
    }
    agrees = _table(check, "agrees", np.int8)
    variables["agrees"] = (("s", "test"), agrees, _labels("1 if the test agrees"))
    degrees = [_NO_DEGREES if t.degrees is None else t.degrees for t in check.tests]
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
    if check.start is not None:
        meaning = "probability density p0 of the start"
        variables["initial_density"] = (MARGINALS, check.start, _labels(meaning))
    coordinates = {
        "s": ("s", check.s, _labels("arclength s")),
        "test": ("test", np.array(names, dtype=object)),
        **{which: (which, getattr(check.grid, which)) for which in MARGINALS},
    }
    return xr.Dataset(variables, coordinates, _attributes(check))


def from_xarray(dataset: xr.Dataset) -> CrossCheck:
    """Return the cross-check that `to_xarray` turned into `dataset`.

    Parameters
    ----------
    dataset : xarray.Dataset

    Raises
    ------
    ValueError
        If the dataset does not have the layout of `to_xarray`.

    Warns
    -----
    UserWarning
        If the model was made of a user's own functions; `model` is None then.
    """
    # Older files know nothing of the error of the grid.
    always = [number for number in _NUMBERS if number != "grid_error"]
    numbers = (*always, "degrees", "s", "test")
    counts = [f"{kind}_{which}" for kind in ("probability", "count")
              for which in MARGINALS]  # fmt: skip
    check_complete(dataset, (*numbers, *counts), _NEEDED_ATTRIBUTES)
    about = declared(dataset.attrs)
    grid = PhaseSpaceGrid.from_dict(about["grid"])
    for axis, n in zip(MARGINALS, grid.shape, strict=True):
        check_counts("grid", n, dataset.sizes[axis], f"`{axis}`")
    return CrossCheck(
        model=read_model(about, {}) if "model" in about else None,
        grid=grid,
        s=dataset["s"].to_numpy(),
        tests=tuple(_read_tests(dataset)),
        false_alarm=float(about["false_alarm"]),
        n_paths=about["n_paths"],
        solver=about["solver"],
        sampler=about["sampler"],
        probabilities={
            which: dataset[f"probability_{which}"].to_numpy() for which in MARGINALS
        },
        counts={which: dataset[f"count_{which}"].to_numpy() for which in MARGINALS},
        recipe={RECIPE: dataset.attrs[RECIPE]} if RECIPE in about else {},
        start=(
            dataset["initial_density"].to_numpy()
            if "initial_density" in dataset
            else None
        ),
    )


def _read_tests(dataset: xr.Dataset) -> Iterator[AgreementTest]:
    """Yield every test, in the order of arclengths, then names."""
    known = [number for number in _NUMBERS if number in dataset]
    tables = {number: dataset[number].to_numpy() for number in known}
    degrees = dataset["degrees"].to_numpy()
    for row, s in enumerate(dataset["s"].to_numpy()):
        for column, name in enumerate(dataset["test"].to_numpy()):
            free = int(degrees[row, column])
            yield AgreementTest(
                float(s), str(name),
                degrees=None if free == _NO_DEGREES else free,
                **{key: float(table[row, column]) for key, table in tables.items()},
            )  # fmt: skip


def _table(check: CrossCheck, number: str, kind: type) -> Any:
    """One number of every test, as an array over (s, test)."""
    values = [getattr(test, number) for test in check.tests]
    return np.array(values, dtype=kind).reshape(len(check.s), -1)


def _labels(meaning: str) -> dict[str, str]:
    return {"long_name": meaning, "units": "1"}


def _attributes(check: CrossCheck) -> dict[str, Any]:
    model = check.model
    return {
        "title": "Density against paths",
        "verdict": str(check),
        "agrees": int(check.agrees),
        "false_alarm": check.false_alarm,
        "n_paths": check.n_paths,
        "equation": "" if model is None else model.equation,
        "model": "" if model is None else to_json(model.to_dict()),
        "grid": json.dumps(check.grid.to_dict()),
        "solver": json.dumps(check.solver),
        "sampler": json.dumps(check.sampler),
        **made_with(),
        **check.recipe,
    }
