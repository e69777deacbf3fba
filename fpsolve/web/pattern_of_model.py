"""The mean pattern of a web from the generator of its fibres, without a grid."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array, Complex
from fpsolve._support.blas import one_blas_thread
from fpsolve.model import laydown
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.resolvent.nozzle_ladder import NozzleLadder
from fpsolve.spectral.resolvent.nozzle_law import NozzleLaw
from fpsolve.spectral.resolvent.plane_waves import coefficients
from fpsolve.web.nozzles import has_phases
from fpsolve.web.pattern_result import MeanPattern
from fpsolve.web.pattern_row import of_the_row, offsets_of

__all__ = ["check_nozzle_model", "pattern_of_model"]

# |k_i| σ_i of the shortest waves: beyond, e^{−B} has 4e-6 of its mass and less.
SHORTEST = 5.0
# Points in s for every oscillation, and at least.
OVERSAMPLED, FEWEST_POINTS = 4, 64
# A √σ below which two truncations may agree on what is wrong.
LOWEST_NOISE = 0.7


def check_nozzle_model(model: Any) -> None:
    """Raise unless there is a `NozzleLadder` of the model, on a belt."""
    laydown.check_model(model)
    potential = quadratic(model)
    lowest = LOWEST_NOISE / math.sqrt(min(potential.sigma1, potential.sigma2))
    if not model.noise >= lowest:
        raise ValueError(
            f"`noise` must be at least {lowest:g}, which is {LOWEST_NOISE:g}/√σ, got "
            f"{model.noise:g}; below, use `periodic_state` and `mean_pattern`."
        )
    if not has_phases(model.curve):
        raise ValueError(
            "`curve` must be a nozzle that moves, got "
            f"{model.curve!r}; `predict_web` has the strips of those at rest."
        )
    if not abs(model.curve.speed) > 0:
        raise ValueError(
            f"`curve` must be on a belt that moves, got {model.curve!r}; the web on a "
            "belt at rest grows without end."
        )


@one_blas_thread()
def pattern_of_model(
    model: LayDownModel, spacing: float, phases: Any, tolerance: float
) -> MeanPattern:
    """The pattern of a model that was checked."""
    curve: Any = model.curve
    offsets = offsets_of(phases)
    length, width = abs(curve.speed) * curve.period, spacing * offsets.size
    scales = quadratic(model).sigma1, quadratic(model).sigma2
    k1, k2 = (
        waves(period, sigma)
        for period, sigma in zip((length, width), scales, strict=True)
    )
    found, errors = NozzleLadder(model).expectations(
        lambda law: averaged(law, k1, k2).ravel(),
        lambda numbers: np.full(numbers.shape, 0.5 * tolerance),
    )
    row = of_the_row(k1, k2, phases, offsets, spacing, curve.speed)
    shape = (k1.size, k2.size)
    return MeanPattern(
        length=length,
        width=width,
        spacing=spacing,
        mean=1.0 / (abs(curve.speed) * spacing),
        coefficients=found.reshape(shape) * row,
        errors=errors.reshape(shape) * np.abs(row),
        phases=phases if isinstance(phases, str) else tuple(offsets.tolist()),
    )


def waves(period: float, sigma: float) -> Array:
    """2πn/period for all n with |k| σ <= SHORTEST."""
    last = int(SHORTEST / sigma * period / (2 * math.pi))
    return np.asarray(np.arange(-last, last + 1) * (2 * math.pi / period))


def averaged(law: NozzleLaw, k1: Array, k2: Array) -> Complex:
    """(1/P) ∫ e^{−ik·(γ + c)} E e^{−ik·(ξ − c)} ds, shape (n1, n2)."""
    generator = law.generator
    curve: Any = generator.model.curve
    known = waves_of(law, k1, k2)
    n = known.shape[0] - 1
    reach = float(np.abs(k1).max()) * swept(generator, 0)
    reach += float(np.abs(k2).max()) * swept(generator, 1)
    points = 2 * n + FEWEST_POINTS + OVERSAMPLED * math.ceil(reach + k1.size)
    values = np.zeros(known.shape[1:], np.complex128)
    order = np.arange(-n, n + 1)
    # φ_{−j}(k) is conjugate to φ_j(−k).
    whole = np.concatenate([known[:0:-1, ::-1, ::-1].conj(), known])
    for s in np.arange(points) * (curve.period / points):
        along, across = generator.place(curve, float(s))
        phi = np.tensordot(np.exp(1j * generator.frequency * s * order), whole, 1)
        values += np.exp(-1j * (k1[:, None] * along + k2 * across)) * phi
    values /= points
    return values


def waves_of(law: NozzleLaw, k1: Array, k2: Array) -> Complex:
    """φ_j(k), harmonics of E e^{−ik·(ξ − c)}, j = 0 … n; shape (n + 1, n1, n2)."""
    basis, scales = law.generator.basis.plain, law.generator.plain.scales
    m, n, _ = basis.states
    plain = basis.without_angle
    shape = (law.harmonics.shape[0], basis.degree + 1, basis.degree + 1)
    table = np.zeros(shape, np.complex128)
    table[:, m[plain], n[plain]] = law.harmonics[:, plain]
    along, across = (
        np.array([coefficients(-one * sigma, basis.degree) for one in k])
        for k, sigma in zip((k1, k2), scales, strict=True)
    )
    return np.asarray(along @ table @ across.T)


def swept(generator: Any, axis: int) -> float:
    """How far γ + c, without the belt, goes within a period."""
    nozzle = generator.model.curve.radii[axis]
    return float(nozzle + abs(generator.swing[1 + axis]))
