"""A cross-check from the labelled `xarray.Dataset` that describes it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fpsolve._support.declared import declared
from fpsolve._support.labels import check_complete, read_provenance
from fpsolve.evolution.call import Call
from fpsolve.evolution.layout import check_counts
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.stored import read_model
from fpsolve.studies.agreement.check import CrossCheck
from fpsolve.studies.agreement.dataset import NO_DEGREES, NUMBERS
from fpsolve.studies.agreement.outcome import MARGINALS, AgreementTest

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["from_xarray"]

_NEEDED_ATTRIBUTES = (
    "false_alarm",
    "n_paths",
    "equation",
    "model",
    "grid",
    "solver",
    "sampler",
    "provenance",
)


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
    numbers = (*NUMBERS, "degrees", "s", "test")
    counts = [f"{kind}_{which}" for kind in ("probability", "count")
              for which in MARGINALS]  # fmt: skip
    check_complete(dataset, (*numbers, *counts), _NEEDED_ATTRIBUTES)
    about = declared(dataset.attrs)
    provenance = read_provenance(about)
    grid = PhaseSpaceGrid.from_dict(about["grid"])
    for axis, n in zip(MARGINALS, grid.shape, strict=True):
        check_counts("grid", n, dataset.sizes[axis], f"`{axis}`")
    return CrossCheck(
        model=read_model(about, provenance) if "model" in about else None,
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
        call=Call.from_xarray(dataset),
        provenance=provenance,
    )


def _read_tests(dataset: xr.Dataset) -> Iterator[AgreementTest]:
    """Yield every test, in the order of arclengths, then names."""
    tables = {number: dataset[number].to_numpy() for number in NUMBERS}
    degrees = dataset["degrees"].to_numpy()
    for row, s in enumerate(dataset["s"].to_numpy()):
        for column, name in enumerate(dataset["test"].to_numpy()):
            free = int(degrees[row, column])
            yield AgreementTest(
                float(s), str(name),
                degrees=None if free == NO_DEGREES else free,
                **{key: float(table[row, column]) for key, table in tables.items()},
            )  # fmt: skip
