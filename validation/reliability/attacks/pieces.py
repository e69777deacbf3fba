"""Potentials, curves, grids, starts, diagnostics, units: each against its formula."""

from __future__ import annotations

import copy
import math
import pickle
import warnings
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve import diagnostics, initial, interop

from .draws import (
    between,
    curve,
    grid_for,
    log_between,
    one_of,
    potential,
    shown,
    start,
)
from .families import family

# What an array may be handed over as.
KINDS = (np.float32, np.float16, np.int64, np.int8, ">f8", np.longdouble, np.bool_)
SHAPES = ((), (0,), (1,), (3,), (2, 0), (2, 3))


def foreign(rng: Any, values: Any) -> Any:
    """The same numbers in another dtype, order, stride, or as a list."""
    values = np.asarray(values)
    how = one_of(
        rng, "f4", ">f8", "longdouble", "list", "strided", "fortran", "readonly"
    )
    if how == "list":
        return values.tolist()
    if how == "strided":
        wide = np.repeat(values, 2, axis=-1) if values.ndim else values
        return wide[..., ::2] if values.ndim else wide
    if how == "fortran":
        return values.copy(order="F")
    if how == "readonly":
        values = values.copy()
        values.flags.writeable = False
        return values
    return values.astype(how)


@family(20, 2)
def potentials_fit_their_gradient(rng: Any, notes: Any) -> None:
    """∇B against differences, Z against sums, for any shape and dtype of ξ."""
    one = potential(rng)
    shape = SHAPES[int(rng.integers(len(SHAPES)))]
    x, y = (rng.uniform(-2.0, 2.0, shape) for _ in range(2))
    handed = foreign(rng, x)
    notes.say(f"{shown(one)}.gradient on shape {shape} of {type(handed).__name__}")
    g1, g2 = one.gradient(handed, y)
    notes.holds("shape of ∇B", np.shape(g1) == np.shape(g2) == shape)
    notes.holds("float64", np.asarray(g1).dtype == np.float64)
    x, h = np.asarray(handed, float), 1e-5
    for got, (dx, dy) in ((g1, (h, 0.0)), (g2, (0.0, h))):
        slope = (one.value(x + dx, y + dy) - one.value(x - dx, y - dy)) / (2 * h)
        size = 1.0 + np.abs(got).max(initial=0.0)
        # A kink at the origin may lie between the two.
        away = np.hypot(x, y) > 1e-3
        notes.close("∇B", np.where(away, got, 0), np.where(away, slope, 0), 1e-4 * size)
    check_partition(notes, one)
    twin = pickle.loads(pickle.dumps(one)) if not hasattr(one, "own") else one
    notes.holds("equal after pickling", twin == one)


def check_partition(notes: Any, one: Any) -> None:
    """Z by the midpoint rule on a wide plane, where it is smooth enough."""
    n, width = 800, 40.0
    places = (np.arange(n) + 0.5) * (2 * width / n) - width
    value = one.value(places[:, None], places[None, :])
    least = float(value.min())
    total = float(np.exp(least - value).sum()) * (2 * width / n) ** 2
    exact = one.partition_function * math.exp(least)
    notes.close("Z", total, exact, 2e-2 * exact)


@family(14, 1)
def curves_move(rng: Any, notes: Any) -> None:
    """γ(s1) − γ(s0) against positions, γ' against differences, far away and near."""
    one = curve(rng)
    if rng.random() < 0.3:
        s = np.sort(rng.uniform(-3.0, 5.0, 12))
        one = fp.TabulatedCurve(s, -0.3 * s + 0.1 * np.sin(s), np.cos(s))
        at = between(rng, float(s[1]), float(s[-2]))
    else:
        at = one_of(rng, 0.0, between(rng, -9.0, 9.0), 1e6)
    notes.say(f"{one!r} at {at}")
    h = 1e-3 / (1.0 + abs(getattr(one, "angular_speed", 1.0)))
    (a1, a2), (b1, b2) = one.position(at - h), one.position(at + h)
    v1, v2 = one.velocity(at)
    # Of the chord h² ω³ r/6, and of positions as far away as s rounding over h.
    speed = 1.0 + abs(getattr(one, "angular_speed", 1.0))
    error = 1e-6 * speed + 1e-15 * max(1.0, abs(at)) * speed / h
    notes.close("γ1'", float(v1), float(b1 - a1) / (2 * h), error)
    notes.close("γ2'", float(v2), float(b2 - a2) / (2 * h), error)
    d1, d2 = one.displacement(at - h, at + h)
    size = 1e-15 * max(1.0, abs(at)) * speed
    notes.close("displacement", (d1, d2), (float(b1 - a1), float(b2 - a2)), 10 * size)
    for shape in SHAPES:
        inside = np.full(shape, at)
        p1, p2 = one.position(inside)
        w1, w2 = one.velocity(inside)
        notes.holds(
            f"shapes for {shape}",
            np.shape(p1) == np.shape(p2) == np.shape(w1) == np.shape(w2) == shape,
        )


@family(16, 2)
def starts_are_what_was_asked(rng: Any, notes: Any) -> None:
    """Mass one always; mean and variance as asked unless a warning says otherwise."""
    grid = grid_for(rng, most=40)
    mean = tuple(between(rng, -2.0, 2.0) for _ in range(2))
    variance = log_between(rng, 1e-6, 3.0)
    angle, kappa = between(rng, -9.0, 9.0), one_of(rng, 0.0, 1.0, 5.0, 1e4, 1e12)
    notes.say(f"gaussian({grid}, {mean}, {variance}, {angle}, {kappa})")
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        p = initial.gaussian(grid, mean, variance, angle, kappa)
    notes.close("mass", diagnostics.mass(p, grid), 1.0, 1e-12)
    notes.holds("no negative", p.min() >= 0)
    if told:
        notes.holds("a word about cells", "enlarge" in str(told[0].message))
        return
    found = diagnostics.moments(p, grid)
    cell = max(grid.spacing[:2])
    notes.close("mean", (found["mean_xi1"], found["mean_xi2"]), mean, 0.05 + 0.1 * cell)
    notes.close("variance", found["variance_xi1"], variance, 0.15 * variance + 0.05)
    from scipy.special import ive

    exact = math.cos(angle) * float(ive(1, kappa) / ive(0, kappa))
    notes.close("E cos α", found["mean_cos_alpha"], exact, 0.02)


@family(16, 2)
def diagnostics_are_sums(rng: Any, notes: Any) -> None:
    """Every functional against its formula in numpy, for arrays of any kind."""
    grid = grid_for(rng)
    p = start(rng, grid)
    if rng.random() < 0.4:
        p = p * (rng.random(p.shape) > 0.3)
    handed = foreign(rng, p)
    noise = one_of(rng, 0.0, 0.5, 20.0)
    notes.say(
        f"diagnostics on {grid}, {type(handed).__name__} {getattr(handed, 'dtype', '')}"
    )
    q = np.asarray(handed, dtype=np.float64)
    volume, (xi1, _, alpha) = grid.cell_volume, grid.mesh()
    mass = float(q.sum()) * volume
    notes.close("mass", diagnostics.mass(handed, grid), mass, 1e-6)
    found = diagnostics.moments(handed, grid)
    notes.close("mean", found["mean_xi1"], (xi1 * q).sum() * volume / mass, 1e-5)
    notes.close(
        "E cos α",
        found["mean_cos_alpha"],
        (np.cos(alpha) * q).sum() * volume / mass,
        1e-5,
    )
    r = np.exp(-0.5 * (grid.xi1[:, None] ** 2 + grid.xi2[None, :] ** 2))
    r /= r.sum() * volume * grid.shape[2]
    inside = q > 0
    wide = np.broadcast_to(r[:, :, None], q.shape)
    exact = float((q[inside] * np.log(q[inside] / wide[inside])).sum()) * volume
    notes.close("H", diagnostics.relative_entropy(handed, grid, r), exact, 1e-5)
    lost = diagnostics.entropy_dissipation(handed, grid, noise, r)
    notes.holds("dissipation is not negative", lost >= -1e-12)
    notes.close("l1", diagnostics.l1_distance(handed, q, grid), 0.0, 1e-12)
    for which, axis in (("xi1", 0), ("alpha", 2)):
        one = diagnostics.marginal(handed, grid, which)
        notes.close(which, float(one.sum()) * grid.spacing[axis], mass, 1e-5)


@family(10, 1)
def processes_convert(rng: Any, notes: Any) -> None:
    """SI units and back; the model has A √σ1 and σ2/σ1."""
    numbers = (
        log_between(rng, 2e-4, 0.4),
        log_between(rng, 2e-4, 0.4),
        one_of(rng, 0.0, log_between(rng, 0.1, 400.0)),
        between(rng, -0.95, 0.95),
        log_between(rng, 0.01, 900.0),
    )
    notes.say(f"Process{numbers}")
    one = fp.Process(*numbers)
    x = one_of(rng, 3.0, np.float32(2.5), [1, 2], np.zeros((0, 2)), np.int64(7))
    notes.same("metres", one.from_metres(one.to_metres(x)), np.asarray(x, float), 1e-12)
    notes.same(
        "seconds",
        one.to_seconds(x) * one.rate_per_second(1.0),
        np.asarray(x, float),
        1e-12,
    )
    model = one.model
    notes.same("A", model.noise, numbers[2] * math.sqrt(numbers[0]), 1e-12)
    notes.same("σ2", model.potential.sigma2, numbers[1] / numbers[0], 1e-12)
    notes.same("v", model.belt_speed, numbers[3], 1e-15)


@family(10, 1)
def fields_and_copies(rng: Any, notes: Any) -> None:
    """py-pde and back, copies and pickles, dictionaries and back."""
    grid = grid_for(rng, most=12)
    p = start(rng, grid)
    notes.say(f"to_pde_field, pickle, to_dict on {grid}")
    back, other = fp.from_pde_field(fp.to_pde_field(foreign(rng, p), grid))
    notes.close("field", back, p, 1e-5 * p.max())
    notes.holds("grid", other == grid)
    model = fp.LayDownModel(
        fp.QuadraticPotential(between(rng, 0.1, 9.0)), 0.7, curve(rng)
    )
    notes.holds("dict", fp.LayDownModel.from_dict(model.to_dict()) == model)
    notes.holds(
        "copy", copy.deepcopy(model) == pickle.loads(pickle.dumps(model)) == model
    )
    notes.holds("grid dict", fp.PhaseSpaceGrid.from_dict(grid.to_dict()) == grid)
    pde = interop.FokkerPlanckPDE(model)
    rate = pde.evolution_rate(fp.to_pde_field(p, grid))
    notes.close("∂ₛ∫p", float(np.sum(rate.data)) * grid.cell_volume, 0.0, 1e-6)
