"""The parts that results of several kinds have in common."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.labels import labels, to_json
from fpsolve.evolution.layout import (
    Attribute,
    Part,
    Source,
    Stored,
    Variable,
    check_dimensions,
    check_increasing,
)
from fpsolve.evolution.series import COORDINATES, long_name
from fpsolve.model.stored import describe_model, read_model

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SAVED", "STATUS", "STEP", "Model", "OnGrid", "Recorded", "checked_step"]

_STATUS = ("finished", "interrupted", "failed")
# Cell centres are stored as they were computed; a later version may round otherwise.
_SAME = 1e-9


def checked_step(ds: Any) -> float:
    """The step; ValueError unless it is positive."""
    if not 0 < float(ds) < math.inf:
        raise ValueError(f"`ds` must be positive, got {float(ds):g}")
    return float(ds)


def checked_status(status: str) -> str:
    """The status; ValueError unless it is how a run can end."""
    if status not in _STATUS:
        raise ValueError(
            f"`status` must be one of {', '.join(map(repr, _STATUS))}, got {status!r}"
        )
    return status


SAVED = Variable("s", ("s",), COORDINATES["s"], "saved_s", increasing=True)
STEP = Attribute("ds", read_as=checked_step)
STATUS = Attribute("status", read_as=checked_status)


@dataclass(frozen=True)
class Model(Part):
    """A model, or what owns one, as the attributes `equation` and `model`.

    One of a user's own functions cannot be read back: the field is None then, with a
    warning, and its description and equation are in `provenance`.

    Attributes
    ----------
    field : str
    equation : str
        Attribute of the model: which of its equations is told.
    owned : bool
        Whether the field is made of the model by what `owners` of the source names.
    """

    field: str = "model"
    equation: str = "equation"
    owned: bool = False

    needed = ("model",)

    def write(self, result: Any) -> Stored:
        """What is solved, and the model."""
        model = getattr(result, self.field)
        if self.owned and model is not None:
            model = model.model
        equation = None if model is None else getattr(model, self.equation)
        return {**describe_model(model, equation, result.provenance)}

    def read(self, source: Source) -> dict[str, Any]:
        """The model; None if it cannot be made again."""
        # A check against a density without a model has none.
        known = "model" in source.about
        model = read_model(source.about, source.provenance) if known else None
        if self.owned and model is not None:
            return {self.field: source.owners[self.field](model)}
        return {self.field: model}


@dataclass(frozen=True)
class OnGrid(Part):
    """A grid and densities on it, over the axes of the grid.

    Attributes
    ----------
    read_grid : callable
        Makes the grid of what its `to_dict` gave. It has the names of its `axes`, their
        centres by these names, and a `shape`.
    words : str
        Long name of the densities.
    field : str
        The densities in the result.
    over : tuple of str
        Dimensions before those of the grid.
    """

    read_grid: Callable[[Mapping[str, Any]], Any]
    words: str
    field: str = "densities"
    over: tuple[str, ...] = ("s",)

    needed = ("density", "grid")

    def write(self, result: Any) -> Stored:
        """The grid, its centres, and the densities, which share their memory."""
        densities = np.asarray(getattr(result, self.field))
        axes = result.grid.axes
        centres = {
            name: (name, getattr(result.grid, name),
                   labels(COORDINATES.get(name, name)))
            for name in axes
        }  # fmt: skip
        return {
            "density": ((*self.over, *axes), densities, labels(self.words)),
            **centres,
            "grid": to_json(result.grid.to_dict()),
        }

    def read(self, source: Source) -> dict[str, Any]:
        """The grid and the densities; both must fit, and the centres to the grid."""
        grid = self.read_grid(source.about["grid"])
        self._check(source.dataset, grid)
        return {"grid": grid, self.field: source.dataset["density"].values}

    def _check(self, dataset: xr.Dataset, grid: Any) -> None:
        density, dims = dataset["density"], (*self.over, *grid.axes)
        expected = (*(dataset.sizes[name] for name in self.over), *grid.shape)
        if density.dims != dims or density.shape != expected:
            parts = " and ".join(f"`{name}`" for name in (*self.over, "grid"))
            raise ValueError(
                f"`density` must have the shape {expected} of {parts}, got "
                f"{density.shape} over {', '.join(map(str, density.dims))}"
            )
        for name in grid.axes:
            centres = getattr(grid, name)
            if not np.allclose(dataset[name], centres, rtol=_SAME, atol=_SAME):
                raise ValueError(
                    f"`{name}` must be the cell centres of `grid`, got others"
                )


@dataclass(frozen=True)
class Recorded(Part):
    """`series` over every recorded step, and `errors` of them and of what was saved.

    Attributes
    ----------
    over : str
        Dimension of the recorded steps; their arclengths are the coordinate `s_step`.
    words : callable
        Long name of a variable; see `fpsolve.evolution.series.long_name`.
    """

    over: str = "s_step"
    words: Callable[[str], str] = long_name

    needed = ("s_step",)

    def write(self, result: Any) -> Stored:
        """A variable for every series, and one that ends in `_error` for an error."""
        series, s = dict(result.series), labels(COORDINATES["s_step"])
        stored: Stored = {"s_step": (self.over, series.pop("s"), s)}
        columns = {name: (self.over, values) for name, values in series.items()}
        for name, values in (result.errors or {}).items():
            over = self.over if name in result.series else "s"
            columns[f"{name}_error"] = (over, values)
        for name, (over, values) in columns.items():
            stored[name] = (over, values, labels(self.words(name)))
        return stored

    def read(self, source: Source) -> dict[str, Any]:
        """Every series, s first, and every error."""
        dataset = source.dataset
        check_dimensions(dataset, "s_step", (self.over,))
        s = dataset["s_step"].values
        check_increasing("s_step", s)
        series, errors = {"s": s}, {}
        for key, variable in dataset.data_vars.items():
            name, dims = str(key), tuple(map(str, variable.dims))
            of_an_error = name.endswith("_error")
            if of_an_error and dims not in {("s",), (self.over,)}:
                raise ValueError(
                    f"`{name}` must be a series over s or {self.over}, got one over "
                    f"{', '.join(dims) or 'nothing'}"
                )
            if of_an_error or dims == (self.over,):
                check_dimensions(dataset, name, dims)
            if of_an_error:
                errors[name.removesuffix("_error")] = variable.values
            elif dims == (self.over,):
                series[name] = variable.values
        return {"series": series, "errors": errors or None}
