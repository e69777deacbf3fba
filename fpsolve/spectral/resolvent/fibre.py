"""What a web asks of one fibre, whichever model it has."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, cast

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.fibre import FibreModel, check_fibre_model
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.evolution.quadratic import check_parts
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.fibre_spectrum import (
    LONG,
    fibre_gradient,
    fibre_spectrum,
)
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.spectral.resolvent.limit import (
    angle_harmonics,
    harmonic_derivatives,
    limit_derivatives,
    short_wave_limit,
)
from fpsolve.spectral.resolvent.plane_waves import (
    characteristic,
    characteristic_changes,
)
from fpsolve.spectral.resolvent.round_ladder import RoundLadder, check_spectrum_model
from fpsolve.spectral.resolvent.smooth_generator import SmoothGenerator
from fpsolve.spectral.resolvent.smooth_ladder import LAW, SmoothLadder
from fpsolve.spectral.resolvent.smooth_limit import smooth_angle_limit
from fpsolve.spectral.resolvent.smooth_spectrum import LONG as SMOOTH_LONG
from fpsolve.spectral.resolvent.smooth_spectrum import (
    smooth_gradient,
    smooth_spectrum,
)
from fpsolve.spectral.resolvent.smooth_waves import angle_moments
from fpsolve.spectral.resolvent.smooth_waves import (
    characteristic_changes as smooth_characteristic_changes,
)

__all__ = [
    "Differentiable",
    "Fibre",
    "check_fibre",
    "differentiable",
    "fibre_of",
    "has_gradients",
    "scales_of",
]

# Two truncations of the stationary law of the basic model; twice their difference is
# the error.
COARSE, FINE = Basis(18, 12), Basis(25, 16)
# For the law of the angle.
ANGLE = Basis(16, 12)
Pair = tuple[Array, Array]


class Fibre(Protocol):
    """One fibre in its stationary law, to a tolerance or in two truncations.

    Attributes
    ----------
    model : FibreModel
    scales : (float, float)
        The throwing ranges.
    """

    @property
    def model(self) -> Any:
        """The model."""

    @property
    def scales(self) -> tuple[float, float]:
        """The throwing ranges."""

    @property
    def shared(self) -> float:
        """|k| σ up to which one factorisation serves every k2 of a k1."""

    def spectrum(self, k1: Array, k2: Array, tolerance: float) -> Pair:
        """Ŝ at (k1[i], k2[i]) and bounds of the errors."""

    def limit(self, k: tuple[float, float]) -> float:
        """(2π/|k|) Σ± f(β ± π/2), the end of short waves in the direction of k."""

    def characteristics(self, k2: Array) -> Pair:
        """E e^{i k2 ξ2} in two truncations, the finer one first."""

    def double_cosines(self) -> tuple[float, float]:
        """E cos 2α in two truncations, the finer one first."""


class Differentiable(Fibre, Protocol):
    """A fibre whose derivatives are known, too.

    Attributes
    ----------
    parameters : tuple of str
        What they are in.
    """

    @property
    def parameters(self) -> tuple[str, ...]:
        """What they are in."""

    def gradient(self, k1: Array, k2: Array, tolerance: float) -> Pair:
        """Ŝ and its derivatives in the parameters, (i, column), and their errors."""

    def limit_changes(self, k: tuple[float, float]) -> Array:
        """Derivatives of the end of short waves."""

    def characteristic_changes(self, k2: Array) -> Pair:
        """E e^{i k2 ξ2} and its derivatives in the parameters and in k2, (row, k2).

        In two truncations, the finer one first.
        """

    def double_cosine_changes(self) -> Pair:
        """Derivatives of E cos 2α in two truncations, the finer one first."""


class _Resolved(Ladder):
    """A fibre of the basic model, in any basis."""

    @property
    def shared(self) -> float:
        """|k| σ up to which one factorisation serves every k2 of a k1."""
        return LONG

    def spectrum(self, k1: Array, k2: Array, tolerance: float) -> Pair:
        """Ŝ at (k1[i], k2[i]) and bounds of the errors."""
        return fibre_spectrum(self, k1, k2, tolerance)

    def limit(self, k: tuple[float, float]) -> float:
        """(2π/|k|) Σ± f(β ± π/2), the end of short waves in the direction of k."""
        return short_wave_limit(self.generator(ANGLE), k)

    def characteristics(self, k2: Array) -> Pair:
        """E e^{i k2 ξ2} in two truncations, the finer one first."""
        fine, coarse = (
            np.array([characteristic(self.generator(one), (0.0, k)).real for k in k2])
            for one in (FINE, COARSE)
        )
        return fine, coarse

    def double_cosines(self) -> tuple[float, float]:
        """E cos 2α in two truncations, the finer one first."""
        fine, coarse = (
            float(angle_harmonics(self.generator(one))[2]) for one in (FINE, COARSE)
        )
        return fine, coarse


class BasicFibre(_Resolved):
    """A fibre of the basic model under a quadratic potential."""

    @property
    def parameters(self) -> tuple[str, ...]:
        """What derivatives are in."""
        return Generator.parameters

    def gradient(self, k1: Array, k2: Array, tolerance: float) -> Pair:
        """Ŝ and its derivatives in the parameters, (i, column), and their errors."""
        return fibre_gradient(self, k1, k2, tolerance)

    def limit_changes(self, k: tuple[float, float]) -> Array:
        """Derivatives of the end of short waves."""
        return limit_derivatives(self.generator(ANGLE), k)

    def characteristic_changes(self, k2: Array) -> Pair:
        """E e^{i k2 ξ2} and its derivatives in the parameters and in k2, (row, k2)."""
        rows = 2 + len(self.parameters)
        fine, coarse = (
            np.array([characteristic_changes(self.generator(one), k) for k in k2])
            .reshape(k2.size, rows)
            .T
            for one in (FINE, COARSE)
        )
        return fine, coarse

    def double_cosine_changes(self) -> Pair:
        """Derivatives of E cos 2α in two truncations, the finer one first."""
        fine, coarse = (
            harmonic_derivatives(self.generator(one))[:, 2] for one in (FINE, COARSE)
        )
        return fine, coarse


class RoundFibre(RoundLadder, _Resolved):
    """A fibre of the basic model under another isotropic potential."""


@dataclass(eq=False)
class SmoothFibre(SmoothLadder):
    """A fibre of the smooth model."""

    @property
    def shared(self) -> float:
        """|k| σ up to which one factorisation serves every k2 of a k1."""
        pairs = zip(self.spreads, self.scales, strict=True)
        return SMOOTH_LONG / max(spread / sigma for spread, sigma in pairs)

    def spectrum(self, k1: Array, k2: Array, tolerance: float) -> Pair:
        """Ŝ at (k1[i], k2[i]) and bounds of the errors."""
        return smooth_spectrum(self, k1, k2, tolerance)

    def limit(self, k: tuple[float, float]) -> float:
        """(2π/|k|) Σ± f(β ± π/2), the end of short waves in the direction of k."""
        return smooth_angle_limit(self.laws(LAW)[0], k)

    @property
    def parameters(self) -> tuple[str, ...]:
        """What derivatives are in."""
        return SmoothGenerator.parameters

    def gradient(self, k1: Array, k2: Array, tolerance: float) -> Pair:
        """Ŝ and its derivatives in the parameters, (i, column), and their errors."""
        return smooth_gradient(self, k1, k2, tolerance)

    def limit_changes(self, k: tuple[float, float]) -> Array:
        """Derivatives of the end of short waves."""
        law = self.laws(LAW)[0]
        changes = law.stationary_derivatives
        return np.array([smooth_angle_limit(law, k, one) for one in changes])

    def characteristic_changes(self, k2: Array) -> Pair:
        """E e^{i k2 ξ2} and its derivatives in the parameters and in k2, (row, k2)."""
        rows = 2 + len(self.parameters)
        fine, coarse = (
            np.array([smooth_characteristic_changes(law, k) for k in k2.tolist()])
            .reshape(k2.size, rows)
            .T
            for law in self.laws(LAW)
        )
        return fine, coarse

    def double_cosine_changes(self) -> Pair:
        """Derivatives of E cos 2α in two truncations, the finer one first."""
        fine, coarse = (
            np.array(
                [angle_moments(law, 0, one)[2] for one in law.stationary_derivatives]
            )
            for law in self.laws(LAW)
        )
        return fine, coarse


def differentiable(fibre: Fibre) -> Differentiable:
    """The same fibre, known to be one whose derivatives there are."""
    assert has_gradients(fibre.model)
    return cast(Differentiable, fibre)


def has_gradients(model: Any) -> bool:
    """Whether the fibre of a model is `differentiable`."""
    known = isinstance(model, LayDownModel | SmoothLayDownModel)
    return known and isinstance(model.potential, QuadraticPotential)


def check_fibre(model: Any) -> None:
    """Raise unless `model` is one whose `Fibre` there is."""
    check_fibre_model(model)
    if isinstance(model, SmoothLayDownModel):
        check_parts(model)
    else:
        check_spectrum_model(model)


def scales_of(model: FibreModel) -> tuple[float, float]:
    """The throwing ranges, or what takes their place, without a fibre."""
    if isinstance(model.potential, QuadraticPotential):
        return model.potential.sigma1, model.potential.sigma2
    assert isinstance(model, LayDownModel)
    return RoundLadder(model).scales


def fibre_of(model: FibreModel) -> Fibre:
    """The fibre of a model, basic or smooth.

    Raises
    ------
    ToleranceError
        If its stationary law cannot be expanded.
    """
    if isinstance(model, SmoothLayDownModel):
        return SmoothFibre(model)
    assert isinstance(model, LayDownModel)
    return BasicFibre(model) if has_gradients(model) else RoundFibre(model)
