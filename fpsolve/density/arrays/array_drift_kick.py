"""`drift_kick` on the arrays of another library, chosen by what p0 is one of."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.density.arrays.angle_step import AngleStep
from fpsolve.density.arrays.circulants import CirculantTranslation
from fpsolve.density.arrays.form import ArrayForm
from fpsolve.density.arrays.library import Library, check_double, library_of, on_host
from fpsolve.density.arrays.record import ArrayRecorder
from fpsolve.density.schemes.drift_kick import DriftKick
from fpsolve.density.schemes.form import State
from fpsolve.density.schemes.rotation_table import (
    LARGEST_TABLE,
    NODES,
    interval_width,
)

__all__ = ["ArrayDriftKick", "where_p0_lies"]


class ArrayDriftKick(DriftKick):
    """A `DriftKick` whose steps are products of matrices in an array library.

    The same tables, the same order of sub-steps, and the same numbers but for the
    rounding of sums: 1e-12 of the largest value after tens of steps. Nothing is
    written in place, as jax demands. Sums for the series are taken on the device.

    Parameters
    ----------
    scheme : DriftKick
        Not `positive`.
    library : Library

    Raises
    ------
    ValueError
        If the scheme is positive: limiters are loops, not products.
    """

    # What a result says of it: options and name are those of the scheme on the host.
    described_as = DriftKick
    kind_of_recorder = ArrayRecorder

    def __init__(self, scheme: DriftKick, library: Library) -> None:
        if scheme.positive:
            raise ValueError(
                "`positive` must be False to be evolved by "
                f"{library.name}, got True: limiters go from row to row; leave it out, "
                "or give `p0` as an array of numpy."
            )
        self.model, self.grid, self.library = scheme.model, scheme.grid, library
        self.positive, self.balanced = False, scheme.balanced
        self.interpolation_order = scheme.interpolation_order
        self.translation = scheme.translation
        self.form: Any = ArrayForm(scheme.form, library)
        self.translate: Any = CirculantTranslation(scheme.translate, library)
        self.kick: Any = AngleStep(scheme.kick, library)

    @property
    def origin(self) -> str:
        """The library, its version and its device."""
        return self.library.origin

    @property
    def n_arrays(self) -> float:
        """Densities alive during a run, where matrices are combined from eight.

        Rows that are weighted eight times are most of a step; circulants of two shifts;
        matrices for every interval of |∇B| there can be, in blocks that are filled up.
        """
        n1, n2, n_alpha = self.grid.shape
        matrices = (
            NODES / interval_width(n_alpha // 2) * (np.pi / 2) * (n_alpha / 2) ** 2
        )
        tables = max(LARGEST_TABLE, matrices / (n1 * n2 * n_alpha))
        return 19.0 + 2.0 * (n1 / n2 + n2 / n1) + 1.5 * float(tables)

    def _apply(self, operator: Any, state: State, s: float, ds: float) -> None:
        state.values = operator(state.values, s, ds)


def where_p0_lies(scheme: Any, p0: Any, kept: bool) -> tuple[Any, Array]:
    """The scheme for the library of p0, and p0 on the host.

    Both as they are where p0 is an array of numpy.

    Parameters
    ----------
    scheme : Scheme
    p0 : array
    kept : bool
        Whether the run is to be kept in a checkpoint.

    Raises
    ------
    TypeError
        If p0 does not hold float64.
    ValueError
        If scheme or checkpoint are not for arrays of that library.
    """
    library = library_of(p0)
    if library is None:
        return scheme, p0
    check_double("p0", p0, library)
    if type(scheme) is not DriftKick:
        raise ValueError(
            f"`scheme` must be a drift_kick to be evolved by {library.name}, got "
            f"{scheme.name}; make one by drift_kick(model, grid), or give `p0` as an "
            "array of numpy."
        )
    if kept:
        raise ValueError(
            f"`checkpoint` must be left out to be evolved by {library.name}: another "
            "device would not go on with the same bits; give `p0` as an array of numpy."
        )
    return ArrayDriftKick(scheme, library), on_host(p0)
