"""Where fibre curves come from: points, paths, tables of text, datasets."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind, check_positive
from fpsolve.paths.fibres import reading
from fpsolve.paths.fibres.points import checked_points
from fpsolve.paths.fibres.resampling import resampled
from fpsolve.paths.result import Paths

if TYPE_CHECKING:
    from typing import Self

__all__ = ["Sources"]

# Rounding of a table below this part of Δs is that of any number.
NEGLIGIBLE = 1e-10


class Sources(ABC):
    """What makes a fibre curve of which its class takes points, ds and options."""

    @abstractmethod
    def __init__(self, eta: Any, ds: Any, curve: Any = None, **options: Any) -> None:
        """A fibre of points at equal arclength."""

    @classmethod
    def from_points(
        cls,
        points: ArrayLike | Sequence[ArrayLike],
        ds: float,
        *,
        s: ArrayLike | None = None,
        **options: Any,
    ) -> Self:
        """A fibre from points at any distances, resampled to equal arclength.

        Parameters
        ----------
        points : array_like, shape (n, 2), or a sequence of such
        ds : float
        s : array_like, shape (n,), optional
            Arclengths of the points of one fibre, where they are known, as of a
            string; by default those of a cubic spline through the points.
        **options
            As for `FibreCurve`.

        Raises
        ------
        ValueError
            If points are not finite, two neighbours the same, or the fibre too short.
        """
        both, lengths = checked_points(points, options.pop("lengths", None))
        pieces = np.split(both, np.cumsum(lengths)[:-1])
        if s is not None and len(pieces) > 1:
            raise ValueError("`s` must be of one fibre, got several; give them one by "
                             "one.")  # fmt: skip
        found = [resampled(piece, ds, s) for piece in pieces]
        if s is not None:
            options.setdefault("s_start", float(np.asarray(s, dtype=float)[0]))
        return cls._of_resampled(found, ds, options)

    @classmethod
    def _of_resampled(
        cls, found: list[tuple[Array, float]], ds: float, options: dict[str, Any]
    ) -> Self:
        known = options.pop("resampling_error", 0.0)
        weights = [len(points) for points, _ in found]
        new = np.average([error**2 for _, error in found], weights=weights)
        options |= {"ds": ds, "resampling_error": float(np.hypot(known, np.sqrt(new)))}
        return cls([points for points, _ in found], **options)

    @classmethod
    def from_paths(cls, paths: Paths) -> Self:
        """The fibres η = ξ + γ of paths that were saved at equal arclengths.

        Raises
        ------
        ValueError
            If they were saved at other arclengths, or positions not kept.
        TypeError
            If it is no `Paths`.
        """
        check_kind("paths", paths, Paths, "`sample_paths` returns one")
        eta = paths.eta
        ds = reading.equal_step(paths.s, "save_at")
        fibres = [np.ascontiguousarray(eta[:, k]) for k in range(paths.n_paths)]
        return cls(fibres, ds, paths.model.curve, s_start=float(paths.s[0]))

    @classmethod
    def read_csv(
        cls, path: str | Path, ds: float | None = None, *, unit: float = 1.0,
        **options: Any,
    ) -> Self:  # fmt: skip
        """A fibre from a table of text with a header, or two columns without one.

        Columns are `eta1`, `eta2` (or `x`, `y`; along and across the belt), if known
        `s`, the arclength, and for several fibres `fibre`, the number of each.

        Parameters
        ----------
        path : str or Path
        ds : float, optional
            In the unit of the result. By default the step of `s`. If `s` has no equal
            steps, the points are resampled to ds.
        unit : float, optional
            Lengths in the file are divided by it: 1e-3 of metres gives millimetres.
        **options
            As for `FibreCurve`. The position error is by default what rounding to the
            digits of the table costs, the last one over √12.

        Raises
        ------
        ValueError
            If a column is missing, a line is no row of finite numbers, or ds is not
            known.
        """
        return cls._of_table(reading.read_csv(path), ds, unit, options)

    @classmethod
    def from_xarray(
        cls, dataset: Any, ds: float | None = None, *, unit: float = 1.0, **options: Any
    ) -> Self:
        """A fibre from the variables of a dataset, or of a netCDF file.

        Variables are those of `read_csv`, or `eta` over (point, component).

        Parameters
        ----------
        dataset : xarray.Dataset, str or Path
        ds, unit, **options
            As for `read_csv`.
        """
        return cls._of_table(reading.read_dataset(dataset), ds, unit, options)

    @classmethod
    def _of_table(
        cls, table: reading.Table, ds: float | None, unit: float, options: Any
    ) -> Self:
        scaled = table.scaled(check_positive("unit", unit))
        if scaled.s is not None:
            options = {"s_start": [float(s[0]) for s in scaled.s], **options}
        step = scaled.step(ds)
        if step is not None and not scaled.rounding < NEGLIGIBLE * step:
            options = {"position_error": scaled.rounding, **options}
        if step is not None:
            return cls(scaled.pieces, step, **options)
        ds = check_positive("ds", ds)
        s = scaled.s or []
        both = zip(scaled.pieces, s, strict=True)
        return cls._of_resampled([resampled(x, ds, at) for x, at in both], ds, options)
