"""Paths of a smooth fibre and of its white-noise limit, of one Wiener process."""

from __future__ import annotations

import math

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.laws import GaussianLaw

__all__ = ["coupled_distances"]


def coupled_distances(
    model: SmoothLayDownModel,
    law: GaussianLaw,
    s_end: float,
    steps_per_length: float,
    n_paths: int,
    seed: int,
) -> dict[str, float]:
    """E|·| of what smooth and basic paths of the same noise differ by at s_end.

    Both begin at the same points, with κ = 0. With W the Wiener process, β = α + Rκ
    obeys dβ = f ds + A dW, the basic equation but that its force is taken at
    α = β − Rκ: α is off by −Rκ, of variance A²R/2 for s ≫ R, and β and ξ by O(R).
    Mean squares are no measure of it: where the force is steep, a share O(R) of all
    pairs parts for good on the ridge of the angle that the force turns away from.

    Parameters
    ----------
    model : SmoothLayDownModel
    law : GaussianLaw
        Of the start.
    s_end : float
    steps_per_length : float
        Steps per relaxation length R.
    n_paths : int
    seed : int

    Returns
    -------
    dict of float
        "angle", "position" and "corrected" (of β), each with its standard error
        under "…_error".
    """
    n_steps = math.ceil(s_end * steps_per_length / model.relaxation_length)
    ds = s_end / n_steps
    rng = np.random.default_rng(seed)
    mixing = np.linalg.cholesky(_covariance(ds, model.relaxation_length))
    xi, alpha = law.sample(rng, n_paths)
    smooth, basic = _Smooth(model, ds, xi.T, alpha), _Basic(model, ds, xi.T, alpha)
    for step in range(n_steps):
        noise = mixing @ rng.standard_normal((3, n_paths))
        shift = np.array(model.curve.displacement(step * ds, (step + 1) * ds))
        smooth.advance(noise, shift)
        basic.advance(noise, shift)
    away = {
        "angle": np.abs(smooth.alpha - basic.alpha),
        "position": np.hypot(*(smooth.xi - basic.xi)),
        "corrected": np.abs(smooth.beta - basic.alpha),
    }
    numbers: dict[str, float] = {}
    for name, distance in away.items():
        numbers[name] = float(distance.mean())
        numbers[f"{name}_error"] = float(distance.std()) / math.sqrt(n_paths)
    return numbers


def _covariance(h: float, relaxation_length: float) -> Array:
    """That of ∫dW, ∫(h − u)dW and ∫e^{−(h−u)/R}dW over a step of length h."""
    length = relaxation_length
    x = h / length
    fallen = -math.expm1(-x)
    white_late = length * fallen
    area_late = length**2 * (fallen - x * math.exp(-x))
    late = 0.5 * length * -math.expm1(-2 * x)
    return np.array([
        [h, h**2 / 2, white_late],
        [h**2 / 2, h**3 / 3, area_late],
        [white_late, area_late, late],
    ])  # fmt: skip


class _Basic:
    """dξ = τ(α) ds − dγ, dα = f ds + A dW; the tangent at the mean angle of a step."""

    def __init__(
        self, model: SmoothLayDownModel, ds: float, xi: Array, alpha: Array
    ) -> None:
        self.model, self.ds = model, ds
        self.xi, self.alpha = xi.copy(), alpha.copy()

    def advance(self, noise: Array, shift: Array) -> None:
        """One step: the force at both ends (Heun), the noise exact."""
        white, area = self.model.noise * noise[0], self.model.noise * noise[1]
        force = _force(self.model, self.xi, self.alpha)
        ahead = self.alpha + self.ds * force + white
        mean = self.alpha + 0.5 * self.ds * force + area / self.ds
        self.xi += _travelled(mean, self.ds, shift)
        later = _force(self.model, self.xi, ahead)
        self.alpha += 0.5 * self.ds * (force + later) + white


class _Smooth:
    """The same with β = α + Rκ in place of α, and the curvature of the same noise."""

    def __init__(
        self, model: SmoothLayDownModel, ds: float, xi: Array, alpha: Array
    ) -> None:
        self.model, self.ds = model, ds
        self.xi, self.alpha = xi.copy(), alpha.copy()
        self.beta, self.kappa = alpha.copy(), np.zeros(alpha.size)

    def advance(self, noise: Array, shift: Array) -> None:
        """One step: force linear in between (exponential Heun), the noise exact."""
        length, h = self.model.relaxation_length, self.ds
        white, area = self.model.noise * noise[0], self.model.noise * noise[1]
        late = self.model.curvature_noise * noise[2]
        kept = math.exp(-h / length)
        force = _force(self.model, self.xi, self.alpha)
        alpha, beta, kappa = self.alpha, self.beta, self.kappa
        ahead_kappa = kept * kappa + (1 - kept) * force + late
        ahead = beta + h * force + white - length * ahead_kappa
        # ∫α = ∫β − R∫κ, and ∫κ is the change of α.
        mean = beta + 0.5 * h * force + area / h - length * (ahead - alpha) / h
        self.xi = self.xi + _travelled(mean, h, shift)
        later = _force(self.model, self.xi, ahead)
        # A force that grows linearly by `more` over the step.
        more = later - force
        self.beta = beta + h * (force + 0.5 * more) + white
        self.kappa = ahead_kappa + (1 - (1 - kept) * length / h) * more
        self.alpha = self.beta - length * self.kappa


def _force(model: SmoothLayDownModel, xi: Array, alpha: Array) -> Array:
    """f = −∇B·τ⊥."""
    slope1, slope2 = model.potential.gradient(xi[0], xi[1])
    return np.asarray(slope1 * np.sin(alpha) - slope2 * np.cos(alpha))


def _travelled(mean: Array, ds: float, shift: Array) -> Array:
    """Δξ of a step along its mean angle."""
    return ds * np.stack([np.cos(mean), np.sin(mean)]) - shift[:, None]
