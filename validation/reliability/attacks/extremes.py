"""Noises, speeds, scales and steps at the ends of what numbers hold."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve import diagnostics, initial, studies

from .draws import between, one_of, shown
from .families import family

NOISES = (
    1e-300,
    1e-100,
    1e-59,
    1e-30,
    1e-12,
    1e-6,
    1e-4,
    1e-3,
    0.02,
    30.0,
    1e3,
    1e5,
    1e8,
    1e12,
    1e30,
    1e59,
)
SCALES = (1e-12, 1e-6, 1e-3, 1.0, 1.0, 1.0, 1e3, 1e6, 1e12)


def model_of(rng: Any, noise: float, curve: Any = None) -> Any:
    """A model whose length scale may be extreme too; the noise is dimensionless."""
    scale = one_of(rng, *SCALES)
    base = one_of(
        rng,
        fp.QuadraticPotential(scale, scale),
        fp.PowerPotential(3.0, scale),
        fp.LinearPotential(1 / scale),
        fp.QuadraticPotential(scale, 1.3 * scale),
    )
    amplitude = noise / math.sqrt(scale)
    return fp.LayDownModel(base, min(amplitude, 1e60), curve or fp.FixedBelt()), scale


@family(24, 1)
def extreme_gaps(rng: Any, notes: Any) -> None:
    """0 < gap ≤ A²/2 (isotropic B); A²/2 itself for little noise, ∝ 1/A² for much."""
    noise = float(one_of(rng, *NOISES))
    model, scale = model_of(rng, noise)
    notes.say(f"spectral_gap({shown(model)}, tolerance=1e-3)")
    gap = fp.spectral_gap(model, tolerance=1e-3)
    notes.holds(f"gap {float(gap)!r}", 0 < gap < math.inf)
    if model.potential.isotropic:
        notes.holds("at most A²/2", gap <= 0.5 * model.noise**2 * (1 + 1e-3))
    round_well = model.potential.kind == "quadratic" and model.potential.isotropic
    if noise < 0.03 and round_well:
        notes.same("A²/2", float(gap), 0.5 * model.noise**2, 2e-3)
    if noise >= 30:
        constant = {
            "quadratic": 1.0 / getattr(model.potential, "sigma2", 1.0) ** 2,
            "linear": 2 / 9 / scale**2,
        }.get(model.potential.kind)
        if constant is not None:
            notes.same("Λ/A²", float(gap), constant / model.noise**2, 2e-2)


def sampled(model: Any, scale: float) -> Any:
    ds = min(0.1 * scale, 1e300)
    paths = fp.sample_paths(model, 50, 8 * ds, ds, seed=1)
    away = np.abs(paths.xi).max() / scale
    # The unit speed and the belt: no path leaves the ball of radius 2 s.
    return away <= 2 * 0.8 * (1 + 1e-9)


def evolved(model: Any, scale: float) -> Any:
    grid = fp.PhaseSpaceGrid(8.0 * scale, (16, 16, 8))
    p0 = initial.gaussian(grid, (0.2 * scale, 0.0), scale**2)
    run = fp.drift_kick(model, grid)
    found = fp.solve(
        run,
        p0,
        (0.0, 0.4 * scale),
        0.1 * scale,
        boundary_tolerance=0.5,
        negative_tolerance=1.0,
    )
    return abs(found.mass[-1] - 1) < 1e-9 and bool(np.isfinite(found.final).all())


def settled(model: Any, scale: float) -> Any:
    grid = fp.PhaseSpaceGrid(9.0 * scale, (16, 16, 8))
    found = fp.steady_state(model, grid, ds=0.25 * scale, boundary_tolerance=0.5)
    return abs(diagnostics.mass(found.density, grid) - 1) < 1e-6


def stepped(model: Any, scale: float) -> Any:
    grid = fp.PhaseSpaceGrid(6.0 * scale, (16, 16, 8))
    return 0 < fp.suggest_step(model, grid) < math.inf


def boxed(model: Any, scale: float) -> Any:
    return 2 < fp.suggest_grid(model).half_widths[0] / scale < 60


def averaged(model: Any, scale: float) -> Any:
    process = fp.EnergyProcess(model.potential, model.noise)
    rates = process.eigenvalues(2, "odd")
    return abs(rates[0] / (0.5 * model.noise**2) - 1) < 1e-6


def limited(model: Any, scale: float) -> Any:
    grid = fp.PlaneGrid(8.0 * scale, (24, 24))
    limit = fp.HydrodynamicLimit(model)
    found = limit.solve(
        lambda x, y: np.exp(-(x**2 + y**2) / scale**2),
        (0.0, scale),
        scale / 4,
        grid=grid,
        boundary_tolerance=0.5,
    )
    return abs(found.mass[-1] - 1) < 1e-9 and 0 < limit.gap(grid) < math.inf


def expanded(model: Any, scale: float) -> Any:
    law = fp.paths.GaussianLaw((0.2 * scale, 0.0), 0.8 * scale**2)
    found = fp.spectral_solve(model, law, 0.3 * scale, tolerance=1e-3)
    return abs(found.mass[-1] - 1) < 1e-3


def fluctuating(model: Any, scale: float) -> Any:
    found = studies.asymptotic_variances(
        model, {"x": lambda x, y, a: x / scale}, tolerance=1e-2
    )
    return 0 < found.values[0] < math.inf


WAYS: tuple[Callable[[Any, float], Any], ...] = (
    sampled,
    evolved,
    settled,
    stepped,
    boxed,
    averaged,
    limited,
    expanded,
    fluctuating,
)


@family(60, 3)
def extreme_models(rng: Any, notes: Any) -> None:
    """Every way to use a model, at any noise and scale: a sound number or a refusal."""
    way = WAYS[int(rng.integers(len(WAYS)))]
    curve = one_of(
        rng,
        None,
        None,
        fp.MovingBelt(between(rng, -0.3, 0.3)),
        fp.MovingBelt(1 - 1e-12),
    )
    model, scale = model_of(rng, float(one_of(rng, *NOISES)), curve)
    notes.say(f"{way.__name__}({shown(model)}, {scale:g})")
    notes.holds(f"{way.__name__} is sound", way(model, scale))


@family(16, 1)
def extreme_studies(rng: Any, notes: Any) -> None:
    """Studies of one extreme noise: numbers, a refusal, or a message in its place."""
    noise = float(one_of(rng, *NOISES))
    base = one_of(
        rng, fp.QuadraticPotential(), fp.LinearPotential(), fp.PowerPotential(4.0)
    )
    name = one_of(rng, "gap", "branches", "variance", "averages", "large", "spectrum")
    notes.say(f"study {name} of {base!r} at {noise:g}")
    if name in ("gap", "branches", "variance"):
        found = studies.rate_versus_noise(
            base, [noise], parts=(name,), quick=True, workers=0
        )
    elif name == "averages":
        found = studies.ergodic_averages(base, [noise], s_end=2.0, n_paths=40, seed=1)
        notes.holds("finite", np.isfinite(found["error"]).all())
        return
    elif name == "large":
        found = studies.large_noise_limit(
            base, [noise], quick=True, parts=("gap",), workers=0
        )
    else:
        found = studies.small_noise_spectrum(base, [noise], tolerance=1e-2)
        return
    statuses, messages = np.ravel(found["status"]), np.ravel(found["message"])
    for status, message in zip(statuses, messages, strict=True):
        said = str(message)
        notes.holds(
            f"{status}: {said}",
            status == "finished" or "`" in said or "tolerance" in said,
        )
