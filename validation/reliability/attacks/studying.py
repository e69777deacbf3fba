"""Studies, at their smallest, against exact rates, orders and variances."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve import studies

from .draws import between, isotropic, log_between, one_of, shown
from .families import family


def doubled(x: float) -> dict[str, float]:
    """What a sweep calls."""
    return {"twice": 2.0 * x, "root": math.sqrt(x)}


@family(8, 1)
def variances_of_averages(rng: Any, notes: Any) -> None:
    """L G = −(A²/2) G makes the asymptotic variance of G (4/A²) E G²."""
    base = isotropic(rng, smooth=True, own=False)
    model = fp.LayDownModel(base, log_between(rng, 0.7, 3.0))

    def G(xi1: Any, xi2: Any, alpha: Any) -> Any:
        weight = np.exp(-base.value(xi1, xi2))
        return weight * (xi1 * np.sin(alpha) - xi2 * np.cos(alpha))

    notes.say(f"asymptotic_variances({shown(model)}, {{'G': G}}, tolerance=1e-4)")
    found = studies.asymptotic_variances(model, {"G": G}, tolerance=1e-4)
    r = np.linspace(0.0, 12.0, 200001)
    value = base.radial_value(r)
    weight = r * np.exp(-value)
    square = float((0.5 * r**2 * np.exp(-2 * value) * weight).sum() / weight.sum())
    exact = 4.0 / model.noise**2 * square
    error = 3 * found.errors[0] + 1e-3 * exact
    notes.close("variance of the average of G", found.values[0], exact, error)


@family(8, 1)
def gaps_in_studies(rng: Any, notes: Any) -> None:
    """`rate_versus_noise`: the gap is that of `spectral_gap`, at most A²/2."""
    base = isotropic(rng, own=False)
    noises = sorted({log_between(rng, 0.2, 4.0) for _ in range(2)})
    notes.say(
        f"rate_versus_noise({shown(base)}, {noises}, parts=('gap',), quick=True, "
        "workers=0)"
    )
    found = studies.rate_versus_noise(
        base, noises, parts=("gap",), quick=True, workers=0
    )
    gaps = found["gap"].values
    notes.holds("gaps are there", np.isfinite(gaps).all())
    for noise, gap in zip(noises, gaps, strict=True):
        notes.holds("at most A²/2", gap <= 0.5 * noise**2 * (1 + 1e-5))
        exact = fp.spectral_gap(fp.LayDownModel(base, noise), tolerance=1e-6)
        notes.close("gap", gap, float(exact), 1e-5 * exact + exact.error)


@family(3, 1)
def relaxations_in_studies(rng: Any, notes: Any) -> None:
    """The fitted rate is twice the gap within its error, or says why not."""
    base = one_of(
        rng,
        fp.QuadraticPotential(),
        fp.LinearPotential(),
        fp.QuadraticPotential(1.0, 1.3),
    )
    noise = between(rng, 0.8, 2.5)
    notes.say(
        f"rate_versus_noise({shown(base)}, [{noise}], parts=('relaxation', 'gap'),"
        " quick=True, workers=0)"
    )
    found = studies.rate_versus_noise(
        base, [noise], parts=("relaxation", "gap"), quick=True, workers=0
    )
    rate, error = (float(found[n][0]) for n in ("entropy_rate", "entropy_rate_error"))
    if math.isfinite(rate):
        gap = float(found["gap"][0])
        notes.close("decay rate", rate, 2 * gap, 1.5 * error + 1e-3 * gap)
    else:
        said = str(found["message"].sel(part="relaxation").values)
        notes.holds("a NaN says why", said)


@family(8, 1)
def sweeps_and_orders(rng: Any, notes: Any) -> None:
    """`sweep` in this process, twice with a folder; `fitted_order` of a power law."""
    values = [log_between(rng, 0.1, 9.0) for _ in range(int(rng.integers(1, 5)))]
    values += [-1.0] * int(rng.integers(0, 2))
    notes.say(f"sweep(doubled, {values}, workers=0, directory='kept')")
    for _ in range(2):
        cases = studies.sweep(
            doubled, [{"x": x} for x in values], workers=0, directory="kept"
        )
        for x, case in zip(values, cases, strict=True):
            good = case.status == "finished"
            notes.holds(f"status {case.status} {case.message}", good == (x >= 0))
            if good:
                notes.close("value", float(case.values["twice"]), 2 * x, 1e-15)
    order, constant = between(rng, 0.5, 4.0), log_between(rng, 1e-3, 1e3)
    epsilon = np.array([0.5, 0.25, 0.1, 0.05])
    found = studies.fitted_order(epsilon, constant * epsilon**order)
    notes.close("order", found.order, order, 1e-9)
    notes.close("constant", found.constant, constant, 1e-8 * constant)
    observed = studies.observed_orders(epsilon, constant * epsilon**order)
    notes.close("observed", observed[np.isfinite(observed)], order, 1e-9)


@family(5, 1)
def cross_checks_agree(rng: Any, notes: Any) -> None:
    """Density and paths of one process agree; of two they do not."""
    base = isotropic(rng, smooth=True, own=False)
    noise = log_between(rng, 0.6, 2.0)
    model = fp.LayDownModel(base, noise, fp.MovingBelt(between(rng, -0.2, 0.2)))
    law = fp.paths.GaussianLaw((0.4, -0.2), 0.4, 1.0, 1.0)
    grid = fp.PhaseSpaceGrid(7.5, (48, 48, 24))
    notes.say(
        f"cross_check({shown(model)}, {law}, 1.0, n_paths=20000, seed=1, ds=1/16)"
    )
    told = studies.cross_check(
        model, law, 1.0, grid=grid, n_paths=20000, seed=1, ds=1 / 16
    )
    notes.holds(f"agree: {[one.name for one in told.failed]}", told.agrees)
    other = fp.LayDownModel(base, 1.5 * noise, model.curve)
    paths = fp.sample_paths(other, 20000, 1.0, 1 / 32, seed=2, initial=law)
    from fpsolve import initial

    p0 = initial.gaussian(grid, (0.4, -0.2), 0.4, 1.0, 1.0)
    run = fp.solve(fp.drift_kick(model, grid), p0, (0, 1), 1 / 16, extrapolate=True)
    notes.holds("another noise is noticed", not studies.compare(run, paths).agrees)
