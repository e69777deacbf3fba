"""ln p(chord angles | parameters) of the fibres of one process."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fpsolve._kernels.chord_filter import Chords, chord_densities
from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_kind
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.chord_law import Parameters, chord_law
from fpsolve.studies.identification.chords import chords_of
from fpsolve.studies.identification.coordinates import parameters_at

__all__ = ["Likelihood"]


@dataclass(frozen=True, eq=False)
class Likelihood:
    """ln p of the chord angles of some fibres, given the first angle of each.

    Gaussian in an angle given the chords before it. The force is read off the chord,
    which contains the noise of the chord, and the density has the Jacobian of that.

    Attributes
    ----------
    fibres : sequence of Chords
    ds : float
        Length of fibre between points.
    position_error : float
        Standard deviation of every coordinate of a point.
    """

    fibres: Sequence[Chords]
    ds: float
    position_error: float = 0.0

    @classmethod
    def of(cls, curve: FibreCurve) -> Likelihood:
        """That of a curve.

        Raises
        ------
        TypeError
            If it is no curve.
        ValueError
            If its reference curve is not known, or its angles cannot be unwrapped.
        """
        check_kind("curve", curve, FibreCurve, "FibreCurve(eta, ds) makes one")
        curve.check_turns()
        fibres = [
            chords_of(eta, eta - xi, curve.ds)
            for eta, xi in zip(curve.pieces, curve.deviations, strict=True)
        ]
        return cls(fibres, curve.ds, curve.position_error)

    @property
    def n_angles(self) -> int:
        """Angles that count: all but the first of every fibre."""
        return sum(len(chords.angles) - 1 for chords in self.fibres)

    def densities(self, at: Parameters, *, exact_points: bool = False) -> Array:
        """Innovations in standard deviations and ln p of every angle, (2, n)."""
        error = 0.0 if exact_points else self.position_error
        law = chord_law(at, self.ds, error)
        found = [np.empty((2, len(chords.angles))) for chords in self.fibres]
        for chords, out in zip(self.fibres, found, strict=True):
            chord_densities(chords, law, out)
        return np.concatenate([out[:, 1:] for out in found], axis=1)

    def __call__(self, coordinates: Array) -> float:
        """ln p at (1/σ1², 1/σ2², ln A) or (1/σ1², 1/σ2², ln A, ln R).

        -∞ where a search has gone so far that the law has no digits left.
        """
        try:
            value = float(self.densities(parameters_at(coordinates))[1].sum())
        except (ArithmeticError, np.linalg.LinAlgError):
            return -math.inf
        return value if math.isfinite(value) else -math.inf
