"""What solutions of every equation have in common: states over s, and series."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.decay import DecayRate, fit_decay
from fpsolve.evolution.saved import Saved
from fpsolve.evolution.schedule import saved_index

__all__ = ["Evolution", "WithSeries"]


class WithSeries:
    """Series over s, which are attributes.

    Attributes
    ----------
    series : dict of ndarray
    """

    series: Mapping[str, Array]

    def __getattr__(self, name: str) -> Array:
        # Only called for names that are not fields; guards against half-built
        # objects, as pickle and copy make them.
        series: Mapping[str, Array] = self.__dict__.get("series", {})
        if name in series:
            found: Array = series[name]
            return found
        raise AttributeError(
            f"{type(self).__name__} has no attribute {name!r}; its series are "
            f"{', '.join(series)}."
        )

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.series]


class Evolution(WithSeries, Saved):
    """Densities that were saved, and series over every recorded step.

    The axes of a density are those of the grid. A class of one equation adds what it
    knows of the error of its decay rate.

    Attributes
    ----------
    ds : float
    saved_s : ndarray, shape (n_saved,)
    densities : ndarray, shape (n_saved, ...)
    errors : dict of ndarray, or None
        Estimates in ds of series, and of what was saved.
    """

    ds: float
    saved_s: Array
    densities: Any
    errors: Mapping[str, Array] | None

    def density(self, s: float) -> Array:
        """Saved density at s, over the axes of the grid.

        Raises
        ------
        ValueError
            If no density was saved at s.
        """
        found: Array = self.densities[saved_index(self.saved_s, s, self.ds)]
        return found

    @property
    def final(self) -> Array:
        """Last saved density."""
        return self.density(self.saved_s[-1] if self.saved_s.size else np.nan)

    def entropy_rate(self, window: tuple[float, float] | None = None) -> DecayRate:
        """Rate λ of H − floor ~ e^{−λs}, fitted on a window of s; see `fit_decay`.

        Its error contains that of the step: from `errors` if there are any, else by a
        law of the scheme.
        """
        s, above = self.series["s"], self._above_floor()
        known, resolution = (
            (self.errors or {}).get("relative_entropy"),
            self._of_cells(),
        )
        if known is None or not np.isfinite(known).all():
            known = None
            resolution += self._of_step(above, window)
        return fit_decay(s, above, window, errors=known, step_error=resolution)

    def _above_floor(self) -> Array:
        """H less what it tends to on the grid."""
        return self.series["relative_entropy"]

    def _of_cells(self) -> float:
        """Relative error of a decay rate from the cells, as far as it is known."""
        return 0.0

    def _of_step(self, above: Array, window: tuple[float, float] | None) -> float:
        """Relative error of a decay rate from the step, without `errors`."""
        raise NotImplementedError
