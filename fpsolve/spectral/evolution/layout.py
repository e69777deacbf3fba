"""How expansions are stored, in time and stationary."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.labels import labels
from fpsolve.evolution.layout import (
    Attribute,
    Columns,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_counts,
    check_dimensions,
)
from fpsolve.evolution.parts import Model
from fpsolve.evolution.series import long_name
from fpsolve.grids.row_sums import MOMENTS
from fpsolve.model.reading import model_from_dict
from fpsolve.spectral.evolution.expansion import Expansion

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["SERIES", "SOLUTION", "STEADY"]

Truncation = tuple[int, int]

SERIES = ("mass", "relative_entropy", *MOMENTS)
# More than memory holds.
_LARGEST = 2000


class KnownModel(Model):
    """A model with a potential of this package, or the dataset is refused."""

    def read(self, source: Source) -> dict[str, Any]:
        return {"model": model_from_dict(source.about["model"])}


class _Expansions(Part):
    """Coefficients within the limits, of all expansions one behind the other."""

    over = "s"
    needed = ("degree", "harmonics", "n_limits", "limit", "coefficient")

    def write(self, result: Any) -> Stored:
        truncations, expansions = self.held(result)
        kept = np.array(list(truncations), np.int64).reshape(-1, 2)
        limits = np.concatenate([one.limits for one in expansions])
        values = np.concatenate([one.packed() for one in expansions])
        sizes = np.array([one.limits.size for one in expansions], np.int64)
        stored = {
            "degree": (self.over, kept[:, 0], "largest degree"),
            "harmonics": (self.over, kept[:, 1], "largest harmonic"),
            "n_limits": (self.over, sizes, "degrees held"),
            "limit": ("held_degree", limits, "last harmonic held at a degree"),
            "coefficient": ("held", values, "Re and Im of coefficients of p/p_S"),
        }
        return {
            name: (over, array, labels(words))
            for name, (over, array, words) in stored.items()
        }

    def read(self, source: Source) -> dict[str, Any]:
        for name in self.needed[:3]:
            check_dimensions(source.dataset, name, (self.over,))
        pairs = (map(int, source.dataset[name].values) for name in self.needed[:2])
        return self.fields(tuple(zip(*pairs, strict=True)), unpacked(source.dataset))

    def held(self, result: Any) -> tuple[Iterable[Truncation], Sequence[Expansion]]:
        return result.truncation, result._expansions

    def fields(
        self, truncations: Sequence[Truncation], expansions: tuple[Expansion, ...]
    ) -> dict[str, Any]:
        return {"truncation": truncations, "_expansions": expansions}


class _FineAndCoarse(_Expansions):
    """That of a stationary density, and that of the next coarser truncation."""

    over = "expansion"

    def write(self, result: Any) -> Stored:
        names = np.array(["fine", "coarse"], dtype=object)
        return {self.over: (self.over, names), **super().write(result)}

    def held(self, result: Any) -> tuple[Iterable[Truncation], Sequence[Expansion]]:
        both = (result._expansion, result._coarser)
        return [(one.degree, one.harmonics) for one in both], both

    def fields(
        self, truncations: Sequence[Truncation], expansions: tuple[Expansion, ...]
    ) -> dict[str, Any]:
        check_counts(self.over, 2, len(expansions), "`n_limits`")
        fine, coarse = expansions
        return {"truncation": truncations[0], "_expansion": fine, "_coarser": coarse}


def unpacked(dataset: xr.Dataset) -> tuple[Expansion, ...]:
    """All expansions of a dataset; ValueError unless they fill it."""
    sizes, limits = dataset["n_limits"].values, dataset["limit"].values
    check_counts("n_limits", int(sizes.sum()), limits.size, "`limit`")
    if not (sizes.min(initial=1) > 0 and limits.max(initial=0) < _LARGEST):
        raise ValueError("`limit` must hold harmonics of every degree, got others")
    values: Any = dataset["coefficient"].values
    found = []
    for part in np.split(limits, np.cumsum(sizes)[:-1]):
        count = Expansion.size(part)
        if count > values.size:
            raise ValueError("`coefficient` must fill the limits, got too few")
        found.append(Expansion.unpacked(part, values[:count]))
        values = values[count:]
    check_counts("coefficient", 0, values.size, "what is left of it")
    return tuple(found)


def words_of_error(name: str) -> str:
    """Long name of the error of a series."""
    return long_name(f"{name}_error")


SOLUTION = Layout(
    "Expansion of the fibre lay-down density in time",
    KnownModel(),
    Variable("s", ("s",), "arclength s", increasing=True),
    Columns("series", SERIES, ("s",), long_name),
    Columns("errors", SERIES, ("s",), words_of_error, "{}_error"),
    _Expansions(),
    Attribute("tolerance", read_as=float),
)
STEADY = Layout(
    "Stationary fibre lay-down density by expansion",
    KnownModel(),
    Variable("residual", (), "‖L* h‖/‖h‖ in L²(μ)", kind=float),
    Columns("moments", MOMENTS, (), long_name, kind=float),
    Columns("errors", MOMENTS, (), words_of_error, "{}_error", float),
    _FineAndCoarse(),
)
