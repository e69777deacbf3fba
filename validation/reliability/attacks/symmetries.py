"""What every input must do: reflect, turn by a quarter, and scale (remark 3.1)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import fpsolve as fp

from .draws import (
    belt,
    between,
    curve,
    grid_for,
    isotropic,
    noise,
    one_of,
    potential,
    scaled_curve,
    scaled_potential,
    scheme,
    shown,
    start,
)
from .families import family

# Rounding grows with the number of steps; a wrong sign or cell is of order one.
ROUNDING = 1e-8
# Powers of four make the scaled run the same but for exponents.
POWERS = (-8, -3, -1, 1, 3, 8)


def chosen_run(rng: Any, notes: Any, any_curve: Any = curve) -> Any:
    """Model, grid, scheme with its options, start, span and step of a small run."""
    model = fp.LayDownModel(potential(rng), noise(rng), any_curve(rng))
    grid = grid_for(rng)
    make, options = scheme(rng)
    p0 = start(rng, grid)
    ds = one_of(rng, 1 / 16, 1 / 8, 1 / 4)
    span = (0.0, ds * int(rng.integers(1, 9)))
    notes.say(
        f"solve({make.__name__}({shown(model)}, {grid}, **{options}), "
        f"gaussian(...), {span}, {ds})"
    )
    return model, grid, make, options, p0, span, ds


def finished(scheme_: Any, p0: Any, span: Any, ds: float) -> Any:
    """A run that nothing stops but numbers that are none."""
    return fp.solve(
        scheme_,
        p0,
        span,
        ds,
        mass_tolerance=1.0,
        boundary_tolerance=1.0,
        negative_tolerance=10.0,
    )


def compared_run(notes: Any, one: Any, other: Any, expected: Any) -> None:
    """Compare the final density of a run with that of another, transformed."""
    notes.holds("the density is finite", np.isfinite(one).all())
    notes.same("density", other, expected(one), ROUNDING)


@family(30, 4)
def solve_reflects(rng: Any, notes: Any) -> None:
    """(ξ2, α) → (−ξ2, −α) commutes with a run on any belt.

    Only the curve is reflected too: its second component changes sign.
    """
    model, grid, make, options, p0, span, ds = chosen_run(rng, notes, belt)
    run = make(model, grid, **options)
    plain = finished(run, p0, span, ds).final
    mirrored = np.ascontiguousarray(p0[:, ::-1, ::-1])
    other = finished(run, mirrored, span, ds).final
    compared_run(notes, plain, other, lambda p: p[:, ::-1, ::-1])


@family(16, 2)
def solve_turns(rng: Any, notes: Any) -> None:
    """A quarter turn commutes with a run on a belt at rest in a square box."""
    model = fp.LayDownModel(isotropic(rng), noise(rng))
    n, n_alpha = int(rng.integers(8, 22)), 4 * int(rng.integers(2, 5))
    grid = fp.PhaseSpaceGrid(between(rng, 4.0, 6.5), (n, n, n_alpha))
    make, options = scheme(rng)
    # Clamped fluxes act in one direction after the other: turning changes the order.
    options |= {name: False for name in ("positive",) if name in options}
    p0, ds = start(rng, grid), one_of(rng, 1 / 16, 1 / 8, 1 / 4)
    span = (0.0, 6 * ds)
    notes.say(
        f"solve({make.__name__}({shown(model)}, {grid}, **{options}), "
        f"gaussian(...), {span}, {ds}), and turned"
    )

    def turned(p: Any) -> Any:
        # (ξ1, ξ2) → (−ξ2, ξ1), α → α + π/2.
        moved = np.roll(p, n_alpha // 4, axis=2)
        return np.ascontiguousarray(moved.transpose(1, 0, 2)[::-1])

    run = make(model, grid, **options)
    plain = finished(run, p0, span, ds).final
    other = finished(run, turned(p0), span, ds).final
    compared_run(notes, plain, other, turned)


@family(24, 3)
def solve_scales(rng: Any, notes: Any) -> None:
    """ξ and s in units of σ, A in units of σ^(−1/2): the same density (remark 3.1)."""
    model, grid, make, options, p0, span, ds = chosen_run(rng, notes)
    sigma = 4.0 ** one_of(rng, *POWERS)
    notes.say(f"the same scaled by {sigma:g}")
    other_model = scaled_model(model, sigma)
    widths = tuple(sigma * width for width in grid.half_widths)
    other_grid = fp.PhaseSpaceGrid(widths, grid.shape)
    plain = finished(make(model, grid, **options), p0, span, ds)
    other = finished(
        make(other_model, other_grid, **options),
        p0 / sigma**2,
        tuple(sigma * s for s in span),
        sigma * ds,
    )
    corrected = sum(np.abs(run.mass_correction).sum() for run in (plain, other))
    if options.get("adjusted") and not corrected < 0.1 * ROUNDING:
        compared_corrections(notes, grid, plain, other, sigma)
        return
    compared_run(notes, plain.final, other.final, lambda p: p / sigma**2)
    units = {
        "mass": 1.0,
        "relative_entropy": 1.0,
        "entropy_dissipation": 1 / sigma,
        "mean_xi1": sigma,
        "variance_xi2": sigma**2,
        "mean_cos_alpha": 1.0,
        "boundary_mass": 1.0,
        "s": sigma,
    }
    value = model.potential.value(*grid.plane())
    if not np.ptp(value) < 600:
        # H counts −ln p_S up to a limit that has a unit, and says so.
        del units["relative_entropy"]
    for name, unit in units.items():
        got, expected = getattr(other, name), unit * getattr(plain, name)
        if not np.isfinite(expected).all():
            continue
        size = max(unit, float(np.abs(expected).max()))
        notes.close(name, got, expected, ROUNDING * size)


def compared_corrections(
    notes: Any, grid: Any, plain: Any, other: Any, sigma: float
) -> None:
    """Feet moved by η b ds² have a unit: the same mass is restored elsewhere.

    In L¹ a correction is about the mass error it repairs, in either unit.
    """
    corrected = sum(np.abs(run.mass_correction).sum() for run in (plain, other))
    size = np.abs(plain.final).sum() * grid.cell_volume
    away = np.abs(sigma**2 * other.final - plain.final).sum() * grid.cell_volume
    notes.close("density in L1", away, 0.0, (2 * corrected + ROUNDING) * size)
    notes.close("mass", other.mass, plain.mass, ROUNDING * size)


def scaled_model(model: Any, sigma: float) -> Any:
    return fp.LayDownModel(
        scaled_potential(model.potential, sigma),
        model.noise / math.sqrt(sigma),
        scaled_curve(model.curve, sigma),
    )


@family(14, 2)
def paths_scale(rng: Any, notes: Any) -> None:
    """With the same seed ξ is σ times as large, bit for bit but for rounding of B."""
    model = fp.LayDownModel(potential(rng), noise(rng, 0.15), curve(rng))
    sigma = 4.0 ** one_of(rng, *POWERS)
    method = one_of(rng, "splitting", "splitting", "heun", "euler_maruyama")
    ds = one_of(rng, 1 / 32, 1 / 8)
    notes.say(
        f"sample_paths({shown(model)}, 20, {8 * ds}, {ds}, seed=3, "
        f"method={method!r}), scaled by {sigma:g}"
    )
    given = (0.4, 0.3), 0.7
    first = fp.sample_paths(model, 20, 8 * ds, ds, seed=3, initial=given, method=method)
    other = fp.sample_paths(
        scaled_model(model, sigma),
        20,
        8 * ds * sigma,
        ds * sigma,
        seed=3,
        initial=((0.4 * sigma, 0.3 * sigma), 0.7),
        method=method,
    )
    notes.same("xi", other.xi, sigma * first.xi, ROUNDING)
    notes.holds("xi is finite", np.isfinite(first.xi).all())


@family(20, (3, 18))
def suggestions_scale(rng: Any, notes: Any) -> None:
    """The suggested box and step scale; what lies outside the box is what it says."""
    model = fp.LayDownModel(potential(rng), noise(rng, 0.1), belt(rng))
    sigma = 4.0 ** one_of(rng, *POWERS)
    tolerance = one_of(rng, 1e-1, 1e-2, 1e-3)
    notes.say(f"suggest_grid({shown(model)}, {tolerance}), scaled by {sigma:g}")
    other_model = scaled_model(model, sigma)
    grid = fp.suggest_grid(model, tolerance)
    if model.curve.fixed:
        check_box(notes, model, grid, 1.01 * min(0.1 * tolerance, 5e-5))
    other = fp.suggest_grid(other_model, tolerance)
    # Boxes are rounded upwards: both must be near each other, not equal.
    ratios = np.divide(other.half_widths, grid.half_widths) / sigma
    notes.holds(f"box scales, ratio {ratios}", np.all(abs(ratios - 1) < 0.15))
    cells = np.divide(other.shape, grid.shape)
    notes.holds(
        f"cells scale, {other.shape} for {grid.shape}", np.all(abs(cells - 1) < 0.35)
    )


def check_box(notes: Any, model: Any, grid: Any, allowed: float) -> None:
    """Share of e^{−B} outside the box, on a plane of many cells three boxes wide."""
    wide = fp.PlaneGrid(tuple(3 * w for w in grid.half_widths), (600, 600))
    x, y = wide.mesh()
    value = model.potential.value(x, y)
    weight = np.exp(value.min() - value)
    inside = (abs(x) <= grid.half_widths[0]) & (abs(y) <= grid.half_widths[1])
    outside = 1.0 - float((weight * inside).sum() / weight.sum())
    # One row of cells at the edge may be counted on the wrong side.
    notes.close("share outside of the box", outside, 0.0, 2 * allowed + 1e-6)


@family(10, 1)
def gaps_scale(rng: Any, notes: Any) -> None:
    """The spectral gap is a rate: it falls by σ."""
    base = (
        isotropic(rng, own=False)
        if rng.random() < 0.6
        else fp.QuadraticPotential(between(rng, 0.7, 1.4), between(rng, 0.7, 1.4))
    )
    model = fp.LayDownModel(base, between(rng, 0.3, 4.0))
    sigma = 4.0 ** one_of(rng, *POWERS)
    notes.say(f"spectral_gap({shown(model)}, tolerance=1e-5), scaled by {sigma:g}")
    gap = fp.spectral_gap(model, tolerance=1e-5)
    other = fp.spectral_gap(scaled_model(model, sigma), tolerance=1e-5)
    error = gap.error / sigma + other.error + 1e-9 * gap / sigma
    notes.close("gap", float(other), float(gap) / sigma, error)
    if base.isotropic:
        # G is an eigenfunction for every isotropic B.
        bound = 0.5 * model.noise**2
        notes.holds(
            f"gap {float(gap):.8g} ≤ A²/2 = {bound:.8g}", gap <= bound + gap.error
        )


@family(8, 1)
def limits_scale(rng: Any, notes: Any) -> None:
    """Energy process and hydrodynamic limit in other units."""
    base = isotropic(rng)
    amplitude = between(rng, 0.2, 4.0)
    sigma = 4.0 ** one_of(rng, *POWERS)
    notes.say(f"EnergyProcess({shown(base)}, {amplitude}), scaled by {sigma:g}")
    process = fp.EnergyProcess(base, amplitude)
    other = fp.EnergyProcess(scaled_potential(base, sigma), amplitude / sigma**0.5)
    notes.same("g_max", other.g_max, sigma * process.g_max)
    g = process.g_max * np.array([0.02, 0.3, 0.7, 0.99])
    notes.same("period", other.period(sigma * g), sigma * process.period(g))
    notes.same("variance", other.variance(sigma * g), sigma * process.variance(g), 1e-8)
    notes.same(
        "rates",
        other.eigenvalues(3, "odd"),
        process.eigenvalues(3, "odd") / sigma,
        1e-8,
    )
    model = fp.LayDownModel(base, amplitude)
    at = fp.PlaneGrid(4.0, (12, 10)), fp.PlaneGrid(4.0 * sigma, (12, 10))
    notes.say(f"HydrodynamicLimit({shown(model)}).spectrum(grid, 3)")
    plain = fp.HydrodynamicLimit(model).spectrum(at[0], 3)
    scaled = fp.HydrodynamicLimit(scaled_model(model, sigma)).spectrum(at[1], 3)
    notes.same(
        "rates of the limit", scaled.eigenvalues, plain.eigenvalues / sigma, 1e-7
    )
