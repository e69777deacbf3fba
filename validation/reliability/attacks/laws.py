"""Exact laws of densities and paths (docs/model.md), for whatever is drawn."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve import diagnostics, initial

from .draws import (
    anisotropic,
    belt,
    between,
    curve,
    isotropic,
    log_between,
    noise,
    one_of,
    potential,
    scheme,
    shown,
)
from .families import family

# Standard errors that chance may use: about 1e-6 for one number.
SIGMAS = 5.0


def circulation(model: Any, grid: Any) -> Any:
    """G = e^{min B − B} (ξ1 sin α − ξ2 cos α) on the grid; E G falls as e^{−A²s/2}."""
    xi1, xi2, alpha = grid.mesh()
    value = model.potential.value(*grid.plane())[:, :, None]
    weight = np.exp(value.min() - value)
    return weight * (xi1 * np.sin(alpha) - xi2 * np.cos(alpha))


def expected(f: Any, p: Any, grid: Any) -> float:
    return float((f * p).sum()) * grid.cell_volume


@family(24, 3)
def resolved_runs(rng: Any, notes: Any) -> None:
    """With the suggested step: E G = e^{−A²s/2} E G0, H falls, mass one, no sign."""
    model = fp.LayDownModel(isotropic(rng), noise(rng, 0.15))
    grid = fp.PhaseSpaceGrid(between(rng, 6.0, 7.0), (44, 44, 24))
    make, options = scheme(rng)
    options.update({"form": "h"} if "form" in options else {"interpolation_order": 8})
    p0 = tilted_equilibrium(rng, model, grid)
    step = fp.suggest_step(model, grid, 2e-2)
    s = one_of(rng, 0.5, 1.0)
    n_steps = max(8, math.ceil(s / step - 1e-9))
    if n_steps > 200:
        s, n_steps = s * 100 / n_steps, 100
    notes.say(
        f"solve({make.__name__}({shown(model)}, {grid}, **{options}), "
        f"tilted equilibrium, (0, {s}), {s} / {n_steps})"
    )
    run = make(model, grid, **options)
    kept = 1e-10 if options.get("adjusted", True) else 1e-2
    solution = fp.solve(
        run, p0, (0.0, s), s / n_steps, boundary_tolerance=0.1, mass_tolerance=kept
    )
    notes.close("mass", solution.mass, 1.0, kept)
    G = circulation(model, grid)
    law = math.exp(-0.5 * model.noise**2 * s) * expected(G, p0, grid)
    if run.order == 2 and "too coarse" not in step.reason:
        # The suggested step promises an L1 error; twice it, for the cells beside it.
        allowed = 4e-2 * float(np.abs(G).max())
        notes.close("E G", expected(G, solution.final, grid), law, allowed)
    if options.get("positive") or options.get("limited"):
        notes.holds("not negative", solution.minimum.min() > -1e-12)
    rise = np.diff(solution.relative_entropy).max()
    # The cells beside a kink and the mass that is not restored leave this much.
    notes.holds(f"H falls, rise {rise:.2g}", rise <= 2e-3 + 2 * kept)


def tilted_equilibrium(rng: Any, model: Any, grid: Any) -> Any:
    """e^{−B} (1 + a circulation + b cos(α − c)): a start for every form and B."""
    turn, lean, at = (
        between(rng, -0.5, 0.5),
        between(rng, -0.4, 0.4),
        between(rng, 0, 6),
    )

    def f(x: Any, y: Any, alpha: Any) -> Any:
        value = model.potential.value(*grid.plane())[:, :, None]
        swirl = (x * np.sin(alpha) - y * np.cos(alpha)) / (1.0 + x**2 + y**2)
        tilt = 1.0 + 2 * turn * swirl + lean * np.cos(alpha - at)
        return np.exp(value.min() - value) * tilt

    return initial.from_function(grid, f)


@family(10, 2)
def equilibria_stay(rng: Any, notes: Any) -> None:
    """p_S stays to rounding in the balanced form, whatever A, B and ds."""
    model = fp.LayDownModel(potential(rng), noise(rng, 0.4))
    grid = fp.PhaseSpaceGrid(
        between(rng, 3.0, 6.0),
        (
            int(rng.integers(8, 20)),
            int(rng.integers(8, 20)),
            2 * int(rng.integers(3, 9)),
        ),
    )
    make, options = one_of(
        rng, (fp.drift_kick, {"balanced": True}), (fp.semi_lagrangian, {})
    )
    ds = one_of(rng, 1 / 8, 1.0, 16.0)
    notes.say(
        f"solve({make.__name__}({shown(model)}, {grid}, **{options}), "
        f"equilibrium, (0, {4 * ds}), {ds})"
    )
    p0 = initial.equilibrium(grid, model.potential)
    solution = fp.solve(
        make(model, grid, **options), p0, (0.0, 4 * ds), ds, boundary_tolerance=1.0
    )
    notes.same("density", solution.final, p0, 1e-9)
    notes.close("H", solution.relative_entropy, solution.relative_entropy[0], 1e-9)


@family(14, 2)
def estimates_cover(rng: Any, notes: Any) -> None:
    """The error estimate of an extrapolated run against a step eight times as short.

    Cells are fine enough for B: with more steps a coarse grid would be worse, not
    better. Single moments may cross zero; what has to be covered is the density.
    """
    amplitude = one_of(rng, log_between(rng, 0.3, 3.0), 6.0, 20.0, 1e3)
    base = isotropic(rng, smooth=True) if rng.random() < 0.6 else anisotropic(rng)
    model = fp.LayDownModel(base, float(amplitude), curve(rng))
    grid = fp.PhaseSpaceGrid(between(rng, 5.5, 6.5), (44, 44, 24))
    mean, ds = (between(rng, -0.7, 0.7), 0.3), one_of(rng, 1 / 8, 1 / 4, 1 / 2)
    p0 = initial.gaussian(grid, mean, between(rng, 0.35, 0.6), 0.5, 1.0)
    notes.say(
        f"solve(drift_kick({shown(model)}, {grid}), gaussian {mean}, (0, 1), "
        f"{ds}, extrapolate=True)"
    )
    run = fp.drift_kick(model, grid)
    options = {"boundary_tolerance": 0.5, "negative_tolerance": 1.0}
    found = fp.solve(run, p0, (0.0, 1.0), ds, extrapolate=True, **options)
    fine = fp.solve(run, p0, (0.0, 1.0), ds / 8, **options)
    distance = diagnostics.l1_distance(found.final, fine.final, grid)
    stated = float(found.errors["density_l1"][-1])
    notes.close(
        f"L1 error, A² ds = {amplitude**2 * ds:g}", distance, 0.0, 1.1 * stated + 2e-4
    )
    for name in ("mean_xi1", "mean_cos_alpha"):
        away = abs(float(getattr(found, name)[-1] - getattr(fine, name)[-1]))
        # |E f| moves by at most max |f| times the L1 distance.
        bound = (grid.half_widths[0] if name == "mean_xi1" else 1.0) * distance
        notes.holds(f"{name} is off by {away:.2g}", away <= bound + 1e-12)


@family(12, 2)
def random_walks(rng: Any, notes: Any) -> None:
    """B = 0: E cos(α − α0) = e^{−Ds}, E‖ξ‖² = (2/D)(s − (1 − e^{−Ds})/D), by paths."""
    amplitude = one_of(rng, log_between(rng, 0.3, 3.0), 0.0, 1e-6, 20.0, 1e4)
    model = fp.LayDownModel(fp.FreePotential(), float(amplitude), belt(rng))
    n, ds = 4000, one_of(rng, 0.05, 0.25, 1.0)
    notes.say(
        f"sample_paths({shown(model)}, {n}, 4.0, {ds}, seed=5, initial=((0, 0), 0.3))"
    )
    paths = fp.sample_paths(model, n, 4.0, ds, seed=5, initial=((0.0, 0.0), 0.3))
    D, s = 0.5 * model.noise**2, 4.0
    lag = -math.expm1(-D * s) / D if D else s
    travelled = model.belt_speed * s
    found = paths.moments()
    compare_moment(notes, found, "mean_cos_alpha", math.cos(0.3) * math.exp(-D * s))
    # The splitting takes the angle as constant over a step: O(D ds) of the way.
    bias = one_step_bias(D, ds)
    compare_moment(
        notes, found, "mean_xi1", travelled + math.cos(0.3) * lag, bias * lag
    )


def one_step_bias(D: float, ds: float) -> float:
    """Relative error of T½ D T½ in ∫ e^{−Du} du over many steps: (D ds)²/12 and up."""
    x = D * ds
    return abs(x / 2 / math.tanh(x / 2) - 1.0) if x > 1e-6 else 0.0


def compare_moment(
    notes: Any, found: Any, name: str, exact: float, bias: float = 0.0
) -> None:
    value, error = (float(one[-1]) for one in found[name])
    notes.close(
        name, value, exact, SIGMAS * error + abs(bias) + 1e-9 * (1 + abs(exact))
    )


@family(16, 2)
def paths_obey_the_laws(rng: Any, notes: Any) -> None:
    """E G of paths, and the equilibrium that stays, within standard errors."""
    model = fp.LayDownModel(isotropic(rng), noise(rng, 0.15))
    n, s = 3000, one_of(rng, 0.5, 2.0)
    ds = s / math.ceil(s / min(0.05, 0.2 / max(model.noise, 1e-3) ** 2) - 1e-9)
    if s / ds > 4000:
        s, ds = 1.0, 0.05
    notes.say(f"sample_paths({shown(model)}, {n}, {s}, {ds}, seed=7)")
    around = fp.paths.GaussianLaw((0.6, -0.2), 0.2, 1.2, 2.0)
    paths = fp.sample_paths(model, n, s, ds, seed=7, initial=around, save_at=(0.0, s))

    def G(xi1: Any, xi2: Any, alpha: Any) -> Any:
        least = float(model.potential.value(0.0, 0.0))
        weight = np.exp(least - model.potential.value(xi1, xi2))
        return weight * (xi1 * np.sin(alpha) - xi2 * np.cos(alpha))

    (first, last), (noise1, noise2) = paths.expectation(G)
    decay = math.exp(-0.5 * model.noise**2 * s)
    allowed = SIGMAS * math.hypot(noise1 * decay, noise2) + 2e-2
    notes.close("E G", last, decay * first, allowed)
    settled = fp.sample_paths(
        model, n, s, ds, seed=8, initial=fp.paths.EquilibriumLaw(model.potential)
    )
    exact = second_moment(model.potential)
    value, error = (float(one[-1]) for one in settled.moments()["mean_square"])
    notes.close("E‖ξ‖²", value, exact, SIGMAS * error + 0.03 * exact)
    notes.holds("finite", np.isfinite(settled.xi).all())


def second_moment(potential: Any) -> float:
    """E‖ξ‖² of e^{−B}, isotropic, by quadrature over the radius."""
    r = np.linspace(0.0, 60.0, 600001)
    value = potential.radial_value(r)
    weight = r * np.exp(value.min() - value)
    return float((r**2 * weight).sum() / weight.sum())


@family(8, 1)
def paths_do_not_depend(rng: Any, notes: Any) -> None:
    """Path k is the same for fewer paths, another end, and after going on."""
    model = fp.LayDownModel(potential(rng), noise(rng), curve(rng))
    ds = one_of(rng, 0.01, 0.125)
    notes.say(
        f"sample_paths({shown(model)}, 200, {40 * ds}, {ds}, seed=2), fewer, continued"
    )
    many = fp.sample_paths(model, 200, 40 * ds, ds, seed=2, save_at=(20 * ds, 40 * ds))
    few = fp.sample_paths(model, 7, 20 * ds, ds, seed=2)
    notes.close("fewer paths", few.xi[-1], many.xi[0][:7], 0.0)
    more = few.continued(40 * ds)
    notes.close("continued", more.xi[-1], many.xi[1][:7], 0.0)
    one = few.replay(3)
    notes.close("replayed", one.xi[-1], few.xi[-1][3], 0.0)


@family(8, 1)
def moments_of_runs_and_paths(rng: Any, notes: Any) -> None:
    """The density of a run and an ensemble have the same moments."""
    base = anisotropic(rng) if rng.random() < 0.5 else isotropic(rng, smooth=True)
    model = fp.LayDownModel(base, log_between(rng, 0.5, 2.0), curve(rng))
    if model.curve.speed and abs(model.curve.speed) > 0.9:
        model = fp.LayDownModel(base, model.noise)
    omega = abs(getattr(model.curve, "angular_speed", 0.0))
    if omega > 4.0:
        model = fp.LayDownModel(base, model.noise, fp.MovingBelt(0.2))
    grid = fp.PhaseSpaceGrid(7.0, (44, 44, 24))
    law = fp.paths.GaussianLaw((0.5, -0.4), 0.4, 0.9, 1.5)
    p0 = initial.gaussian(grid, (0.5, -0.4), 0.4, 0.9, 1.5)
    notes.say(f"{shown(model)}: solve and sample_paths to s = 1 from {law}")
    run = fp.solve(fp.drift_kick(model, grid), p0, (0, 1), 1 / 32)
    paths = fp.sample_paths(model, 8000, 1.0, 1 / 32, seed=4, initial=law)
    found = paths.moments()
    for name in (
        "mean_xi1",
        "mean_xi2",
        "variance_xi1",
        "covariance",
        "mean_cos_alpha",
        "mean_sin_alpha",
    ):
        compare_moment(notes, found, name, float(getattr(run, name)[-1]), 6e-3)
    notes.close("mass", diagnostics.mass(run.final, grid), 1.0, 1e-9)
