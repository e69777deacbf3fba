"""Stationary densities and spectra against identities and second methods."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve import diagnostics

from .draws import (
    anisotropic,
    belt,
    between,
    isotropic,
    log_between,
    one_of,
    shown,
)
from .families import family
from .laws import circulation, expected


@family(14, 1)
def stationary_densities(rng: Any, notes: Any) -> None:
    """E cos α = −v and E sin α = 0 for every B; moments of the expansion for |ξ|²/2."""
    base = anisotropic(rng) if rng.random() < 0.5 else isotropic(rng)
    speed = one_of(rng, between(rng, -0.4, 0.4), 1e-6, 0.0)
    model = fp.LayDownModel(base, log_between(rng, 0.6, 3.0), fp.MovingBelt(speed))
    shift = model.noise**2 * abs(speed)
    grid = fp.PhaseSpaceGrid(7.5 + 2.0 * shift, (48, 44, 16))
    notes.say(f"steady_state({shown(model)}, {grid})")
    found = fp.steady_state(model, grid)
    error = 2e-3 if found.error is None else 2 * found.error + 1e-6
    moments = found.moments()
    notes.close("mass", diagnostics.mass(found.density, grid), 1.0, 1e-9)
    notes.close("E cos α", moments["mean_cos_alpha"], -speed, error)
    notes.close("E sin α", moments["mean_sin_alpha"], 0.0, error)
    if isinstance(base, fp.QuadraticPotential):
        exact = fp.spectral_steady_state(model, tolerance=1e-4).moments
        for name in ("mean_xi1", "variance_xi1", "variance_xi2"):
            size = max(1.0, abs(exact[name]))
            allowed = (2e-3 if found.error is None else 8 * error) * size
            notes.close(name, moments[name], exact[name], allowed + 2e-4)


@family(8, 1)
def default_stationary_densities(rng: Any, notes: Any) -> None:
    """`steady_state` with all defaults on the suggested grid, against the expansion."""
    speed = between(rng, -0.3, 0.3)
    sigma = between(rng, 0.8, 1.3)
    model = fp.LayDownModel(
        fp.QuadraticPotential(sigma, sigma),
        between(rng, 1.0, 3.0),
        fp.MovingBelt(speed),
    )
    notes.say(f"steady_state({shown(model)}, suggest_grid(model, 0.05))")
    grid = fp.suggest_grid(model, 5e-2)
    found = fp.steady_state(model, grid)
    exact = fp.spectral_steady_state(model, tolerance=1e-5)
    distance = diagnostics.l1_distance(found.density, exact.density(grid), grid)
    stated = 1e-4 if found.error is None else found.error
    notes.close("L1 error, against what is stated", distance, 0.0, 2 * stated + 1e-5)


@family(14, 1)
def spectra(rng: Any, notes: Any) -> None:
    """A²/2 is an eigenvalue for every isotropic B: it is listed, or beyond the list."""
    base = isotropic(rng)
    model = fp.LayDownModel(base, log_between(rng, 0.4, 5.0))
    n = int(rng.integers(2, 9))
    notes.say(f"spectrum({shown(model)}, {n}, tolerance=1e-5)")
    found = fp.spectrum(model, n, tolerance=1e-5)
    rates, exact = -found.eigenvalues.real, 0.5 * model.noise**2
    notes.holds("rates are positive", np.all(rates > 0))
    notes.holds("slowest first", np.all(np.diff(rates) > -1e-9))
    slowest = -found.essential if found.essential is not None else math.inf
    last = rates[-1] if rates.size >= n else slowest
    if exact < last * (1 - 1e-9):
        away = np.abs(found.eigenvalues + exact)
        nearest = int(np.argmin(away)) if away.size else 0
        notes.holds("some eigenvalue is listed", away.size)
        error = found.errors[nearest] + 1e-8 * exact if away.size else 0.0
        notes.close("A²/2", away.min(initial=np.inf), 0.0, error)
    if isinstance(base, fp.QuadraticPotential) and model.noise > 3:
        limit = 1.0 / (model.noise * base.sigma1) ** 2
        notes.close(
            "gap A² σ²",
            found.gap / limit,
            1.0,
            4.0 / (model.noise * math.sqrt(base.sigma1)) ** 4,
        )


@family(5, 1)
def best_noises(rng: Any, notes: Any) -> None:
    """No other noise has a larger gap than the best one; it scales as σ^(−1/2)."""
    sigma = log_between(rng, 0.05, 20.0)
    kind = one_of(rng, "quadratic", "power")
    one = fp.QuadraticPotential(sigma, sigma)
    if kind == "power":
        one = fp.PowerPotential(between(rng, 2.0, 4.0), sigma)
    notes.say(f"optimal_noise({one!r}, tolerance=1e-5)")
    best = fp.optimal_noise(one, tolerance=1e-5)
    for factor in (0.7, 0.97, 1.03, 1.4):
        model = fp.LayDownModel(one, factor * best.noise)
        gap = fp.spectral_gap(model, tolerance=1e-5)
        notes.holds(
            f"gap at {factor} A* is smaller",
            gap <= best.gap + best.gap_error + gap.error,
        )


@family(12, 1)
def expansions(rng: Any, notes: Any) -> None:
    """`spectral_solve`: E G from its density, the equilibrium, moments at s = 0."""
    sigma = between(rng, 0.8, 1.25)
    curve = belt(rng)
    if abs(curve.speed) > 0.6:
        curve = fp.MovingBelt(0.5)
    model = fp.LayDownModel(
        fp.QuadraticPotential(sigma, sigma), between(rng, 0.7, 4.0), curve
    )
    law = fp.paths.GaussianLaw(
        (between(rng, -0.7, 0.7), between(rng, -0.7, 0.7)),
        between(rng, 0.3, 1.2) * sigma**2,
        between(rng, -3.0, 3.0),
        between(rng, 0.0, 3.0),
    )
    s = between(rng, 0.2, 1.5)
    notes.say(f"spectral_solve({shown(model)}, {law}, [0, {s}], tolerance=1e-4)")
    found = fp.spectral_solve(model, law, [0.0, s], tolerance=1e-4)
    notes.close("mass", found.mass, 1.0, 1e-4)
    for name, exact in (
        ("mean_xi1", law.mean[0]),
        ("variance_xi2", law.variance[1][1]),
    ):
        notes.close(f"{name} at 0", getattr(found, name)[0], exact, 2e-4)
    if not curve.fixed:
        return
    grid = fp.PhaseSpaceGrid(7.0 * sigma, (48, 48, 24))
    G = circulation(model, grid)
    before, after = (expected(G, found.density(at, grid), grid) for at in (0.0, s))
    decay = math.exp(-0.5 * model.noise**2 * s)
    notes.close("E G", after, decay * before, 2e-3)
    notes.holds(
        "H falls", found.relative_entropy[1] <= found.relative_entropy[0] + 2e-4
    )
