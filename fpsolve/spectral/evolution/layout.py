"""How expansions are stored, in time and stationary."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._kernels.lanes import LANES
from fpsolve._support.labels import check_complete, labels
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
from fpsolve.spectral.evolution.sector_expansion import SectorExpansion

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
    needed: tuple[str, ...] = (
        "degree", "harmonics", "n_limits", "limit", "coefficient",
    )  # fmt: skip

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
        for name in (*self.needed[:2], "n_limits"):
            check_dimensions(source.dataset, name, (self.over,))
        pairs = (map(int, source.dataset[name].values) for name in self.needed[:2])
        return self.fields(tuple(zip(*pairs, strict=True)), unpacked(source.dataset))

    def held(self, result: Any) -> tuple[Iterable[Truncation], Sequence[Any]]:
        return result.truncation, result._expansions

    def fields(
        self, truncations: Sequence[Truncation], expansions: tuple[Any, ...]
    ) -> dict[str, Any]:
        return {"truncation": truncations, "_expansions": expansions}


class _InEitherBasis(_Expansions):
    """Expansions in products of polynomials, or in sectors of the angular index."""

    needed = ("degree", "harmonics", "coefficient")

    def write(self, result: Any) -> Stored:
        truncations, expansions = self.held(result)
        if not isinstance(expansions[0], SectorExpansion):
            return super().write(result)
        kept = np.array(list(truncations), np.int64).reshape(-1, 2)
        rows = [[n.size for n in one.counts] for one in expansions]
        counts = np.concatenate([n for one in expansions for n in one.counts])
        values = np.concatenate([one.packed() for one in expansions])
        stored = {
            "degree": ((self.over,), kept[:, 0], "largest degree"),
            "harmonics": ((self.over,), kept[:, 1], "largest harmonic"),
            "n_rows": ((self.over, "sector"), np.array(rows), "rows of a sector M"),
            "held_count": ("held_row", counts, "coefficients held in a row"),
            "coefficient": ("held", values, "Re and Im of coefficients of p/p_S"),
        }
        return {
            name: (over, array, labels(words))
            for name, (over, array, words) in stored.items()
        }

    def read(self, source: Source) -> dict[str, Any]:
        if "held_count" not in source.dataset:
            check_complete(source.dataset, *_Expansions.needed)
            return super().read(source)
        for name in self.needed[:2]:
            check_dimensions(source.dataset, name, (self.over,))
        pairs = (map(int, source.dataset[name].values) for name in self.needed[:2])
        found = unpacked_sectors(source.dataset)
        return self.fields(tuple(zip(*pairs, strict=True)), found)


class _FineAndCoarse(_Expansions):
    """That of a stationary density, and that of the next coarser truncation."""

    over = "expansion"

    def write(self, result: Any) -> Stored:
        names = np.array(["fine", "coarse"], dtype=object)
        return {self.over: (self.over, names), **super().write(result)}

    def held(self, result: Any) -> tuple[Iterable[Truncation], Sequence[Any]]:
        both = (result._expansion, result._coarser)
        return [(one.degree, one.harmonics) for one in both], both

    def fields(
        self, truncations: Sequence[Truncation], expansions: tuple[Any, ...]
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


def unpacked_sectors(dataset: xr.Dataset) -> tuple[SectorExpansion, ...]:
    """All expansions of a dataset; ValueError unless they fill it."""
    check_complete(dataset, "n_rows")
    check_dimensions(dataset, "n_rows", ("s", "sector"))
    rows, counts = dataset["n_rows"].values, dataset["held_count"].values
    check_counts("n_rows", int(rows.sum()), counts.size, "`held_count`")
    odd = rows.size > 0 and rows.min() >= 3 and (rows % 2 == 1).all()
    whole = counts.min(initial=0) >= 0 and (counts % LANES == 0).all()
    if not (odd and whole and counts.max(initial=0) < _LARGEST):
        raise ValueError("`held_count` must hold counts of every row, got others")
    check_counts("coefficient", 2 * int(counts.sum()), dataset["coefficient"].size,
                 "`held_count`")  # fmt: skip
    values: Any = dataset["coefficient"].values
    parts = iter(np.split(counts, np.cumsum(rows.ravel())[:-1]))
    found = []
    for n_rows in rows:
        own = tuple(next(parts) for _ in n_rows)
        if any(one[0] or one[-1] for one in own):
            raise ValueError("`held_count` must be zero in outer rows, got others")
        size = 2 * sum(int(one.sum()) for one in own)
        found.append(SectorExpansion.unpacked(own, values[:size]))
        values = values[size:]
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
    _InEitherBasis(),
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
