"""The limits of much and of little noise against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.integrate import quad

import fpsolve as fp
from fpsolve import initial

from .draws import (
    between,
    isotropic,
    log_between,
    noise,
    one_of,
    potential,
    shown,
)
from .families import family
from .laws import SIGMAS


@family(14)
def energy_laws(rng: Any, notes: Any) -> None:
    """J′ = −g S, ∫S dg = π ∫ r e^{−B} dr, period by quadrature, first odd rate A²/2."""
    base = isotropic(rng)
    amplitude = one_of(rng, log_between(rng, 0.01, 3.0), 1e-6, 50.0)
    notes.say(f"EnergyProcess({shown(base)}, {amplitude})")
    one = fp.EnergyProcess(base, amplitude)
    radius = one.radius
    notes.close("r B'(r)", radius * float(base.radial_derivative(radius)), 1.0, 1e-6)
    g = one.g_max * np.array([1e-6, 0.1, 0.5, 0.9, 0.999])
    h = 1e-5 * one.g_max
    middle = g[1:4]
    slope = (one.action(middle + h) - one.action(middle - h)) / (2 * h)
    notes.same("J'", slope, -middle * one.period(middle), 1e-5)
    notes.same(
        "σ²", one.variance(g), amplitude**2 * one.action(g) / one.period(g), 1e-9
    )
    notes.same("period", one.period(0.5 * one.g_max), period_by_quadrature(one), 1e-6)
    density = one.stationary_density
    total = quad(lambda x: float(density(x)), 0, one.g_max, limit=200)[0]
    notes.close("∫ stationary density", total, 1.0, 1e-4)
    odd = one.eigenvalues(3, "odd")
    notes.same("first odd rate", odd[0], 0.5 * amplitude**2, 1e-9)
    even = one.eigenvalues(3)
    notes.close("first even rate", even[0], 0.0, 1e-9 * amplitude**2)
    passage = one.passage(0.1 * one.g_max)
    at = 0.6 * one.g_max
    exact = passage_by_quadrature(one, 0.1 * one.g_max, at)
    notes.close("passage", float(passage.mean(at)), exact, 1e-4 * exact)


def period_by_quadrature(one: Any) -> float:
    """2 ∫ w/√(w² − g²) dr at g = g_max/2, r = middle + half sin t."""
    g = 0.5 * one.g_max
    low, high = (float(r) for r in one.turning_points(g))
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    slope = one.potential.radial_value
    base = one.g_max / (one.radius * math.exp(-float(slope(one.radius))))

    def integrand(t: float) -> float:
        r = middle + half * math.sin(t)
        w = base * r * math.exp(-float(slope(r)))
        return w / math.sqrt(max(w * w - g * g, 1e-300)) * half * math.cos(t)

    return 2 * quad(integrand, -math.pi / 2 + 1e-9, math.pi / 2 - 1e-9, limit=400)[0]


def passage_by_quadrature(one: Any, target: float, g: float) -> float:
    """(2/A²) ∫ from target to g of (∫ from x to g_max of S)/J dx."""
    top = one.g_max

    def beyond(x: float) -> float:
        return quad(lambda y: float(one.period(y)), x, top, limit=200)[0]

    amplitude = float(
        np.sqrt(one.variance(0.5 * top) * one.period(0.5 * top) / one.action(0.5 * top))
    )
    inner = quad(lambda x: beyond(x) / float(one.action(x)), target, g, limit=100)[0]
    return 2 / amplitude**2 * inner


@family(12, 1)
def energy_runs_and_paths(rng: Any, notes: Any) -> None:
    """E G = e^{−A²s/2} G0 for the signed process, by cells and by paths."""
    base, amplitude = isotropic(rng), log_between(rng, 0.05, 2.0)
    one = fp.EnergyProcess(base, amplitude)
    g0, s = between(rng, -0.9, 0.9) * one.g_max, between(rng, 0.2, 2.0) / amplitude**2
    method = one_of(rng, "backward_euler", "sdirk2")
    notes.say(
        f"EnergyProcess({shown(base)}, {amplitude}).solve({g0}, (0, {s}), {s / 32}, "
        f"grid=grid(64, True), method={method!r}, extrapolate=True); sample"
    )
    cells = one.grid(64, True)
    found = one.solve(g0, (0.0, s), s / 32, grid=cells, method=method, extrapolate=True)
    notes.close("mass", found.series["mass"], 1.0, 1e-9)
    law = math.exp(-0.5 * amplitude**2 * s) * g0
    n = 4000
    paths = one.sample(n, s, s / 4, seed=3, initial=g0)
    g = paths.g[-1]
    notes.close(
        "E G of paths",
        g.mean(),
        law,
        SIGMAS * g.std() / math.sqrt(n) + 5e-3 * one.g_max,
    )
    notes.holds("inside", np.all(np.abs(g) <= one.g_max * (1 + 1e-12)))
    settled = one.sample(n, s, s / 4, seed=4, initial="stationary")
    absolute = np.abs(settled.g[-1]) / one.g_max
    exact = float(one.stationary_distribution(0.5 * one.g_max))
    share = float((absolute <= 0.5).mean())
    notes.close("P(|G| ≤ g_max/2)", share, exact, SIGMAS * 0.5 / math.sqrt(n) + 5e-3)


@family(14, 2)
def large_noise_runs(rng: Any, notes: Any) -> None:
    """Mean, variance and entropy of the limit against Ornstein-Uhlenbeck, and paths."""
    sigma1, sigma2 = between(rng, 0.6, 1.5), between(rng, 0.6, 1.5)
    amplitude = one_of(rng, log_between(rng, 0.5, 5.0), 1e3)
    speed = between(rng, -1.0, 1.0) * min(0.9, 0.8 / amplitude**2)
    model = fp.LayDownModel(
        fp.QuadraticPotential(sigma1, sigma2), amplitude, fp.MovingBelt(speed)
    )
    mean, variance = (between(rng, -0.8, 0.8), 0.3), between(rng, 0.3, 1.0)
    exact = fp.OrnsteinUhlenbeckLimit(model, mean, variance)
    s = between(rng, 0.1, 2.0) * amplitude**2
    grid = fp.PlaneGrid(7.0, (70, 66))
    method = one_of(rng, "backward_euler", "sdirk2")
    limit = fp.HydrodynamicLimit(model)
    notes.say(
        f"HydrodynamicLimit({shown(model)}).solve(gaussian {mean} {variance}, "
        f"(0, {s}), {s / 16}, method={method!r}, extrapolate=True)"
    )
    found = limit.solve(
        lambda x, y: exact.density(x, y),
        (0.0, s),
        s / 16,
        grid=grid,
        method=method,
        extrapolate=True,
    )
    notes.close("mass", found.mass, 1.0, 1e-9)
    cell = 2e-2  # second order in cells of 0.2
    for k, name in enumerate(("mean_xi1", "mean_xi2")):
        got, error = getattr(found, name)[-1], found.errors[name][-1]
        notes.close(name, got, exact.mean(s)[k], 2 * error + cell)
    # Variances have no estimate of their own: they follow from the density.
    for k, name in enumerate(("variance_xi1", "variance_xi2")):
        error = 49.0 * found.errors["density_l1"][-1]
        notes.close(
            name, getattr(found, name)[-1], exact.covariance(s)[k, k], error + cell
        )
    n = 4000
    paths = limit.sample(n, s, seed=1, initial=mean)
    start = fp.OrnsteinUhlenbeckLimit(model, mean, 1e-12)
    spread = np.sqrt(np.diag(start.covariance(s)) / n)
    notes.close(
        "mean of paths", paths.xi[-1].mean(axis=0), start.mean(s), SIGMAS * spread
    )
    notes.same(
        "gap", limit.gap(), min(1 / sigma1**2, 1 / sigma2**2) / amplitude**2, 1e-9
    )
    notes.close("gap of cells", limit.gap(grid), limit.gap(), 0.05 * limit.gap())


@family(12, 1)
def large_noise_equilibria(rng: Any, notes: Any) -> None:
    """𝒫_S is normalised, has the moments of its formula, and reconstructs mass one."""
    model = fp.LayDownModel(
        potential(rng),
        max(noise(rng, 0.0), 0.6),
        fp.MovingBelt(between(rng, -0.3, 0.3)),
    )
    notes.say(f"HydrodynamicLimit({shown(model)}).steady_state(PlaneGrid(9, (60, 64)))")
    limit = fp.HydrodynamicLimit(model)
    grid = fp.PlaneGrid(9.0, (60, 64))
    found = limit.steady_state(grid)
    area = grid.cell_area
    notes.close("mass", float(found.density.sum()) * area, 1.0, 1e-9)
    x, y = grid.mesh()
    v = model.belt_speed * model.noise**2
    phi = model.potential.value(x, y) - v * x
    weight = np.exp(phi.min() - phi)
    weight /= weight.sum() * area
    notes.close("density", found.density, weight, 1e-9 * weight.max())
    closed = limit.equilibrium(x, y)
    notes.close("∫ of the formula", float(closed.sum()) * area, 1.0, 3e-2)
    wide = fp.PhaseSpaceGrid(9.0, (30, 32, 16))
    p = limit.reconstruct(limit.equilibrium(*wide.plane()), wide)
    notes.close("∫ p", float(p.sum()) * wide.cell_volume, 1.0, 8e-2)
    layer = limit.initial_layer(initial.equilibrium(wide, model.potential), wide)
    notes.holds("a layer", layer is not None)
