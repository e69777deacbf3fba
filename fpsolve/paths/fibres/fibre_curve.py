"""A fibre as it lies on the belt, point by point, and what is computed of it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import (
    check_kind,
    check_non_negative,
    check_positive,
    keep_checked,
    shown,
)
from fpsolve._support.provenance import Stopwatch
from fpsolve.evolution.call import Call, Kept
from fpsolve.evolution.saved import Saved
from fpsolve.model.curves.curve import Curve
from fpsolve.paths.fibres.chords import (
    check_steps,
    check_turns,
    chord_angles,
    chord_curvatures,
    turns_of,
)
from fpsolve.paths.fibres.layout import FIBRE_CURVE
from fpsolve.paths.fibres.points import checked_points
from fpsolve.paths.fibres.resampling import resampled
from fpsolve.paths.fibres.sources import Sources

__all__ = ["FibreCurve"]


@dataclass(frozen=True, eq=False, repr=False)
class FibreCurve(Sources, Saved):
    """Points η(s₀ + iΔs) of one fibre on the belt, or of several.

    The unit of length is the user's: parameters that are identified from the curve come
    in its powers, σ and R in lengths, A = RK in length^(-1/2), K in length^(-3/2).

    Parameters
    ----------
    eta : array_like, shape (n, 2), or a sequence of such
        Points at equal distances along the fibre; 1 along the belt, 2 across. Several
        arrays are several fibres of one process.
    ds : float
        Δs, the length of fibre between neighbouring points. Points that are not
        equally far apart take `from_points`.
    curve : Curve, optional
        Reference curve γ, with which ξ = η - γ; unknown by default.
    position_error : float, optional
        Standard deviation of each coordinate of every point, independent from point to
        point: what the camera does not see.
    s_start : float or sequence of float, optional
        Arclength of the first point, or that of every fibre: the phase of γ.
    resampling_error : float, optional
        Estimated root mean square error of the points where they were interpolated.
    lengths : sequence of int, optional
        Numbers of points of the fibres, where `eta` holds one after the other.
    call : Call, optional
    provenance : dict, optional
        How it was made, which an object that is read from a file brings.

    Raises
    ------
    ValueError
        If points are not finite, have another shape, are fewer than five, lie further
        apart than ds or much closer.
    TypeError
        If an argument is of another kind.

    References
    ----------
    [KMW09]_, section 4.1.
    """

    kind: ClassVar[str] = "fibre-curve"
    layout = FIBRE_CURVE

    eta: Any
    ds: float
    curve: Curve | None = None
    position_error: float = field(default=0.0, kw_only=True)
    s_start: Any = field(default=0.0, kw_only=True)
    resampling_error: float = field(default=0.0, kw_only=True)
    lengths: Any = field(default=None, kw_only=True)
    call: Call | None = field(default=None, kw_only=True)
    provenance: dict[str, Any] = field(default_factory=dict, kw_only=True)

    def __post_init__(self) -> None:
        points, lengths = checked_points(self.eta, self.lengths)
        keep_checked(self, check_positive, "ds")
        keep_checked(self, check_non_negative, "position_error", "resampling_error")
        starts = check_finite_numbers("s_start", self.s_start)
        if starts.shape not in ((), lengths.shape):
            raise ValueError(
                f"`s_start` must be one number or one for each of the {len(lengths)} "
                f"fibres, got {shown(self.s_start)}."
            )
        if self.curve is not None:
            check_kind("curve", self.curve, Curve, "MovingBelt(speed) is one")
        made: dict[str, Any] = {
            "eta": points,
            "lengths": lengths,
            "s_start": np.broadcast_to(starts, lengths.shape).copy(),
        }
        for name, value in made.items():
            object.__setattr__(self, name, value)
        check_steps(self.pieces, self.ds, self._scatter)
        self._tell_origin()

    def _tell_origin(self) -> None:
        """How the object is made again, and by which versions it was."""
        if self.call is None:
            call = Call.of("FibreCurve", self.parts("eta", "lengths", "s_start"))
            object.__setattr__(self, "call", call)
        if not self.provenance:
            object.__setattr__(self, "provenance", Stopwatch().provenance())

    def parts(self, eta: str, lengths: str, s_start: str) -> dict[str, Any]:
        """The arguments that make the curve, arrays by the names that a result has."""
        return {
            "eta": Kept(eta, self.eta),
            "ds": self.ds,
            "curve": self.curve,
            "position_error": self.position_error,
            "s_start": Kept(s_start, self.s_start),
            "resampling_error": self.resampling_error,
            "lengths": Kept(lengths, self.lengths),
        }

    def __repr__(self) -> str:
        n, m = len(self.eta), len(self.lengths)
        of = "one fibre" if m == 1 else f"{m} fibres"
        return (
            f"FibreCurve({n} points of {of}, ds = {self.ds:g}, length "
            f"{self.length:g}, curve={self.curve!r})"
        )

    @property
    def pieces(self) -> tuple[Array, ...]:
        """The points of every fibre, (n, 2) each."""
        return tuple(np.split(self.eta, np.cumsum(self.lengths)[:-1]))

    @property
    def length(self) -> float:
        """Length of fibre, of all fibres together."""
        return float(self.ds * (self.lengths - 1).sum())

    @property
    def _scatter(self) -> float:
        """By how much points may lie from the fibre, one standard deviation."""
        return float(np.hypot(self.position_error, self.resampling_error))

    @property
    def arclengths(self) -> tuple[Array, ...]:
        """s₀ + iΔs of every fibre."""
        return tuple(
            start + self.ds * np.arange(n)
            for start, n in zip(self.s_start, self.lengths, strict=True)
        )

    @property
    def deviations(self) -> tuple[Array, ...]:
        """ξ = η - γ of every fibre, (n, 2) each.

        Raises
        ------
        ValueError
            If the reference curve is not known.
        """
        if self.curve is None:
            raise ValueError(
                "`curve` must be known for deviations ξ = η - γ, got none; pass the "
                "reference curve as `curve=MovingBelt(speed)`, or find it by "
                "`fit_curve`."
            )
        return tuple(
            eta - np.stack(self.curve.position(s), axis=-1)
            for eta, s in zip(self.pieces, self.arclengths, strict=True)
        )

    @property
    def angles(self) -> tuple[Array, ...]:
        """Chord angles α of every fibre, unwrapped, (n - 1,) each.

        Raises
        ------
        ValueError
            If the fibre turns by so much from chord to chord that α is not known.
        """
        self.check_turns()
        return tuple(chord_angles(piece) for piece in self.pieces)

    @property
    def curvatures(self) -> tuple[Array, ...]:
        """κ = Δα/Δs between the chords of every fibre, (n - 2,) each."""
        return tuple(chord_curvatures(alpha, self.ds) for alpha in self.angles)

    def check_turns(self) -> float:
        """Root mean square turn κ_rms Δs; ValueError if α cannot be unwrapped."""
        return check_turns(np.concatenate([turns_of(piece) for piece in self.pieces]))

    def with_curve(self, curve: Curve) -> FibreCurve:
        """The same points with that reference curve."""
        return replace(self, curve=curve, call=None)

    def resampled(self, ds: float) -> FibreCurve:
        """The fibre at other equal distances of arclength, with the error that costs.

        Through the points goes a cubic spline; `resampling_error` is how far apart
        lie, in root mean square, the curve through all and that through every other
        point, which bounds the error wherever finer points are better.

        Parameters
        ----------
        ds : float

        Raises
        ------
        ValueError
            If the fibre is too short for points at such distances.
        """
        found = [
            resampled(piece, ds, s)
            for piece, s in zip(self.pieces, self.arclengths, strict=True)
        ]
        return self._of_resampled(found, ds, {
            "curve": self.curve, "position_error": self.position_error,
            "s_start": self.s_start, "resampling_error": self.resampling_error,
        })  # fmt: skip
