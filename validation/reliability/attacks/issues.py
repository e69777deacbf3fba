"""What was once wrong without a word: walls, holes, shifts, wells, threads, names."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve import initial, studies

from .draws import belt, between, isotropic, log_between, one_of, scheme, shown
from .families import family
from .laws import SIGMAS, circulation, expected, tilted_equilibrium
from .symmetries import check_box


@family(16, 1)
def steep_walls(rng: Any, notes: Any) -> None:
    """E G = e^{−A²s/2} E G0, H falls behind any wall in any box, or it is refused."""
    exponent, scale = one_of(rng, 12.0, 20.0, 60.0), one_of(rng, 1.0, 1.0, 2.0)
    model = fp.LayDownModel(
        fp.PowerPotential(exponent, scale), log_between(rng, 0.3, 2.0)
    )
    width = scale * one_of(rng, 1.3, 1.8, 2.5, 4.0)
    n = 2 * int(rng.integers(10, 33))
    grid = fp.PhaseSpaceGrid(width, (n, n, 16))
    make, options = one_of(
        rng,
        (fp.drift_kick, {"positive": True}),
        (fp.drift_kick, {}),
        (fp.drift_kick, {"balanced": True}),
        (fp.semi_lagrangian, {}),
    )
    mean: Any = (between(rng, -0.4, 0.4) * scale, 0.2 * scale)
    p0 = initial.gaussian(grid, mean, 0.06 * scale**2, 0.4, 1.0)
    if options.get("balanced") or make is fp.semi_lagrangian:
        # A Gaussian reaches into the wall, where p/p_S has no bound.
        p0, mean = tilted_equilibrium(rng, model, grid), "tilted equilibrium"
    notes.say(
        f"solve({make.__name__}({shown(model)}, {grid}, **{options}), {mean}, "
        f"(0, {scale}), {scale / 32})"
    )
    run = make(model, grid, **options)
    found = fp.solve(run, p0, (0.0, scale), scale / 32, boundary_tolerance=1.0)
    G = circulation(model, grid)
    law = math.exp(-0.5 * model.noise**2 * scale) * expected(G, p0, grid)
    # What a run may miss without being refused, of the largest G.
    allowed = 0.06 * float(np.abs(G).max())
    notes.close("E G", expected(G, found.final, grid), law, allowed)
    notes.close("mass", found.mass, 1.0, 1e-9)
    notes.holds("H falls", np.diff(found.relative_entropy).max() <= 0.1)


def with_a_hole(place: float) -> Any:
    """B = ‖ξ‖ by hand: ∇B is 0/0 at the origin, or at another place."""

    def value(x: Any, y: Any) -> Any:
        return np.hypot(np.subtract(x, place), y)

    def gradient(x: Any, y: Any) -> Any:
        x = np.subtract(x, place)
        with np.errstate(invalid="ignore", divide="ignore"):
            return x / np.hypot(x, y), y / np.hypot(x, y)

    return fp.CallablePotential(value, gradient)


HOLES = {
    "drift_kick": lambda m, g: fp.drift_kick(m, g),
    "positive": lambda m, g: fp.drift_kick(m, g, positive=True),
    "semi_lagrangian": lambda m, g: fp.semi_lagrangian(m, g),
    "suggest_step": lambda m, g: fp.suggest_step(m, g),
    "steady_state": lambda m, g: fp.steady_state(
        m, g, boundary_tolerance=1.0, error_tolerance=1.0
    ),
}


@family(12, 1)
def holes_in_the_gradient(rng: Any, notes: Any) -> None:
    """A cell on the hole is refused by name; an even grid, which has none, works."""
    name = one_of(rng, *sorted(HOLES))
    n, width = int(rng.integers(6, 12)), 4.0
    n -= n % 2
    odd = fp.PhaseSpaceGrid(width, (n + 1, n + 1, 8))
    even = fp.PhaseSpaceGrid(width, (n, n, 8))
    place = float(odd.xi1[int(rng.integers(n + 1))])
    model = fp.LayDownModel(with_a_hole(place), between(rng, 0.5, 2.0))
    notes.say(f"{name}(B = ‖ξ − ({place:.4g}, 0)‖ by hand, {odd}), {even}")
    notes.holds("works beside it", HOLES[name](model, even) is not None)
    try:
        HOLES[name](model, odd)
        notes.holds("a NaN is refused", False)
    except ValueError as error:
        notes.holds(str(error), "`potential` must be finite" in str(error))


@family(14, 1)
def shifted_potentials(rng: Any, notes: Any) -> None:
    """B and B + c have one law, whatever c."""
    base, shift = isotropic(rng, own=False), one_of(rng, 1e4, -1e4, 600.0, -750.0)
    moved = fp.IsotropicPotential(
        lambda r: base.radial_value(r) + shift, base.radial_derivative
    )
    plain = fp.IsotropicPotential(base.radial_value, base.radial_derivative)
    amplitude, curve = between(rng, 0.5, 2.0), belt(rng)
    models = [fp.LayDownModel(one, amplitude, curve) for one in (plain, moved)]
    notes.say(f"{base!r} and + {shift:g}, A = {amplitude}, {curve!r}")
    rounding = 1e-11 * abs(shift)
    grid = fp.PhaseSpaceGrid(6.0, (14, 12, 8))
    p0 = initial.gaussian(grid, (0.3, -0.2), 1.0, 0.5, 1.0)
    runs = [
        fp.solve(
            fp.drift_kick(model, grid), p0, (0.0, 0.5), 0.125,
            boundary_tolerance=1.0, negative_tolerance=1.0,
        )
        for model in models
    ]  # fmt: skip
    notes.same("density", runs[1].final, runs[0].final, 1e-12)
    notes.close("H", runs[1].relative_entropy, runs[0].relative_entropy, rounding)
    laws = [model.equilibrium(*grid.plane()) for model in models]
    notes.same("p_S", laws[1], laws[0], rounding)
    logarithms = [one.normalisation.log_value for one in (plain, moved)]
    notes.close("ln Z", logarithms[1], logarithms[0] - shift, rounding)
    boxes = [fp.suggest_grid(fp.LayDownModel(one, amplitude)) for one in (plain, moved)]
    notes.same("box", boxes[1].half_widths, boxes[0].half_widths, 1e-12)
    plane = fp.PlaneGrid(8.0, (20, 20))
    settled = [
        fp.HydrodynamicLimit(fp.LayDownModel(one, amplitude))
        .steady_state(plane, boundary_tolerance=1.0)
        .density
        for one in (plain, moved)
    ]
    notes.same("limit", settled[1], settled[0], rounding)


def two_wells(away: float, width: float) -> Any:
    """−ln of two Gaussians at (±away, 0)."""

    def parts(x: Any, y: Any) -> tuple[Any, Any]:
        x, y = np.asarray(x, float), np.asarray(y, float)
        right = -((x - away) ** 2 + y**2) / (2 * width**2)
        left = -((x + away) ** 2 + y**2) / (2 * width**2)
        return right, left

    def value(x: Any, y: Any) -> Any:
        return -np.logaddexp(*parts(x, y))

    def gradient(x: Any, y: Any) -> Any:
        right, left = parts(x, y)
        lean = np.tanh(0.5 * (right - left))
        return (x - away * lean) / width**2, np.asarray(y) / width**2

    return fp.CallablePotential(value, gradient)


@family(12, 1)
def two_wells_are_seen(rng: Any, notes: Any) -> None:
    """Z, box and equilibrium of two wells: both hold half of the mass, or a refusal."""
    away, width = one_of(rng, 2.0, 8.0, 16.0, 40.0, 300.0), between(rng, 0.5, 1.5)
    well = two_wells(away, width)
    notes.say(f"two wells of width {width} at ±{away}")
    exact = 4 * math.pi * width**2
    notes.close("Z", well.partition_function, exact, 1e-6 * exact)
    n = 4000
    law = fp.paths.EquilibriumLaw(well)
    ds = 0.01 * width
    paths = fp.sample_paths(
        fp.LayDownModel(well, 1.0), n, ds, ds, seed=1, initial=law, save_at=(0.0,)
    )
    right = float((paths.xi[0, :, 0] > 0).mean())
    notes.close("share of a well", right, 0.5, SIGMAS * 0.5 / math.sqrt(n))
    square = float((paths.xi[0] ** 2).sum(axis=1).mean())
    second, fourth = away**2 + 2 * width**2, 4 * (away**2 + width**2) * width**2
    notes.close("E‖ξ‖²", square, second, SIGMAS * math.sqrt(fourth / n))
    model = fp.LayDownModel(well, between(rng, 0.5, 2.0))
    check_box(notes, model, fp.suggest_grid(model, 1e-2), 5e-5)


@family(6, 1)
def schemes_in_threads(rng: Any, notes: Any) -> None:
    """One scheme in four threads gives the bits of one, or refuses the second."""
    model = fp.LayDownModel(isotropic(rng), log_between(rng, 0.3, 3.0), belt(rng))
    grid = fp.PhaseSpaceGrid(6.0, (14, 12, 8))
    make, options = scheme(rng)
    run = make(model, grid, **options)
    starts = [
        initial.gaussian(grid, (0.1 * k, -0.2), 1.0, 0.3 * k, 1.0) for k in range(8)
    ]
    notes.say(f"{make.__name__}({shown(model)}, {grid}, **{options}) in four threads")

    def final(p0: Any) -> Any:
        return fp.solve(
            run, p0, (0.0, 1.0), 0.125, mass_tolerance=1.0, boundary_tolerance=1.0,
            negative_tolerance=10.0, entropy_tolerance=math.inf,
            circulation_tolerance=math.inf,
        ).final  # fmt: skip

    alone = [final(p0) for p0 in starts]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(final, starts))
    for one, other in zip(alone, together, strict=True):
        notes.close("bits", other, one, 0.0)


def spring(stiffness: float) -> Any:
    """A function whose name does not tell the stiffness."""

    def gap_of(noise: float) -> dict[str, float]:
        return {"gap": stiffness * noise}

    return gap_of


@family(6, 1)
def closures_in_a_folder(rng: Any, notes: Any) -> None:
    """Kept cases of one closure are not those of another of the same name."""
    noises = [log_between(rng, 0.6, 3.0) for _ in range(2)]
    cases = [{"noise": noise} for noise in noises]
    stiffnesses = [1.0, between(rng, 2.0, 5.0)]
    notes.say(f"sweep(spring(k), {noises}, directory='kept') for k in {stiffnesses}")
    for stiffness in [*stiffnesses, *stiffnesses]:
        found = studies.sweep(spring(stiffness), cases, workers=0, directory="kept")
        for noise, case in zip(noises, found, strict=True):
            notes.holds(f"{case.status} {case.message}", case.status == "finished")
            notes.close("value", case.values["gap"], stiffness * noise, 1e-14 * noise)
    gaps = []
    for width in (1.0, 0.5):
        potential = fp.IsotropicPotential(
            lambda r, width=width: r**2 / (2 * width**2),
            lambda r, width=width: r / width**2,
        )
        found = studies.rate_versus_noise(
            potential, noises[:1], parts=("gap",), quick=True, workers=0,
            directory="rates",
        )  # fmt: skip
        exact = fp.QuadraticPotential(width, width)
        model = fp.LayDownModel(exact, noises[0])
        gaps.append(float(found["gap"][0]))
        notes.close("gap", gaps[-1], float(fp.spectral_gap(model)), 1e-4 * gaps[-1])
