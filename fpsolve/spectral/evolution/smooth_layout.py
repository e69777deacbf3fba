"""How the expansion of a stationary density of (ξ, α, κ) is stored."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.labels import labels
from fpsolve.evolution.layout import (
    Columns,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_counts,
    check_dimensions,
)
from fpsolve.evolution.series import long_name
from fpsolve.grids.smooth_sums import SMOOTH_MOMENTS
from fpsolve.spectral.bases.choice import smooth_discretisation_for
from fpsolve.spectral.bases.sectors import Truncation
from fpsolve.spectral.evolution.layout import KnownModel, words_of_error

__all__ = ["SMOOTH_STEADY"]

_OVER = "expansion"
_SIZES = ("degree", "harmonics", "curvature_degree")
_WORDS = ("degree in ξ", "largest harmonic", "degree in κ")


class _Vectors(Part):
    """Coefficients of the density and of the next coarser one, each with its basis."""

    needed = (*_SIZES, "coefficient")

    def write(self, result: Any) -> Stored:
        vectors, truncations = zip(
            (result._vector, result.truncation), result._coarser, strict=True
        )
        sizes = np.array(truncations, np.int64).T
        stored: Stored = {_OVER: (_OVER, np.array(["fine", "coarse"], dtype=object))}
        for name, words, row in zip(_SIZES, _WORDS, sizes, strict=True):
            stored[name] = (_OVER, row, labels(words))
        stored["coefficient"] = (
            "held", np.concatenate(vectors), labels("coefficients of p")
        )  # fmt: skip
        return stored

    def read(self, source: Source) -> dict[str, Any]:
        dataset = source.dataset
        basis = smooth_discretisation_for(source.fields["model"])
        for name in _SIZES:
            check_dimensions(dataset, name, (_OVER,))
        check_counts(_OVER, 2, dataset.sizes[_OVER], "the expansions")
        columns = zip(*(dataset[name].values for name in _SIZES), strict=True)
        fine, coarse = (Truncation(*map(int, sizes)) for sizes in columns)
        values = dataset["coefficient"].values
        sector = basis.stationary_sector
        first, second = basis.size(sector, fine), basis.size(sector, coarse)
        check_counts("coefficient", first + second, values.size, "the truncations")
        return {
            "truncation": fine,
            "_vector": values[:first].copy(),
            "_coarser": (values[first:].copy(), coarse),
        }


SMOOTH_STEADY = Layout(
    "Stationary density of a smooth fibre by expansion",
    KnownModel(),
    Variable("residual", (), "‖L* p‖/‖p‖ of coefficients", kind=float),
    Columns("moments", SMOOTH_MOMENTS, (), long_name, kind=float),
    Columns("errors", SMOOTH_MOMENTS, (), words_of_error, "{}_error", float),
    _Vectors(),
)
