"""Results through files, figures, reports, repetitions and checkpoints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve import plotting

from .draws import (
    between,
    curve,
    grid_for,
    isotropic,
    noise,
    one_of,
    scheme,
    shown,
)
from .families import family
from .laws import tilted_equilibrium


def small_run(rng: Any, notes: Any, named: bool = True) -> Any:
    """A solution of a few steps."""
    model = fp.LayDownModel(isotropic(rng, own=not named), noise(rng), curve(rng))
    grid = grid_for(rng, 6.0, most=14)
    make, options = scheme(rng)
    if options.get("form") == "p":
        options["form"] = "h"
    ds = one_of(rng, 1 / 8, 0.1, 1 / 3)
    steps = int(rng.integers(2, 7))
    saves = sorted({int(k) * ds for k in rng.integers(0, steps + 1, 3)})
    arguments = {
        "save_at": tuple(saves),
        "extrapolate": bool(rng.random() < 0.4),
        "boundary_tolerance": 1.0,
        "negative_tolerance": 10.0,
        "mass_tolerance": 1.0,
        "record_every": int(rng.integers(1, 4)),
    }
    notes.say(
        f"solve({make.__name__}({shown(model)}, {grid}, **{options}), tilted start, "
        f"(0, {steps * ds}), {ds}, **{arguments})"
    )
    run = make(model, grid, **options)
    return fp.solve(
        run, tilted_equilibrium(rng, model, grid), (0.0, steps * ds), ds, **arguments
    )


def small_paths(rng: Any, notes: Any, named: bool = True) -> Any:
    model = fp.LayDownModel(isotropic(rng, own=not named), noise(rng), curve(rng))
    ds = one_of(rng, 1 / 8, 0.1)
    arguments = {
        "seed": int(rng.integers(100)),
        "keep": bool(rng.random() < 0.7),
        "save_at": (0.0, 4 * ds, 8 * ds),
        "method": one_of(rng, "splitting", "heun", "euler_maruyama"),
        "initial": one_of(
            rng,
            None,
            fp.paths.GaussianLaw((0.2, 0.1), 0.3),
            fp.paths.PointLaw((0.1, 0.2), 0.5),
        ),
        "histogram": one_of(rng, None, fp.PhaseSpaceGrid(4.0, (6, 7, 8))),
    }
    n = one_of(rng, 1, 2, 50)
    notes.say(f"sample_paths({shown(model)}, {n}, {8 * ds}, {ds}, **{arguments})")
    return fp.sample_paths(model, n, 8 * ds, ds, **arguments)


def any_result(rng: Any, notes: Any, named: bool = True) -> Any:
    make = one_of(
        rng,
        small_run,
        small_run,
        small_paths,
        small_energy,
        small_limit,
        small_spectrum,
    )
    return make(rng, notes, named)


def small_energy(rng: Any, notes: Any, named: bool = True) -> Any:
    one = fp.EnergyProcess(isotropic(rng, own=not named), between(rng, 0.2, 1.0))
    notes.say(f"{one!r}.solve")
    cells = one.grid(int(rng.integers(4, 40)), bool(rng.random() < 0.5))
    return one.solve(0.3 * one.g_max, (0.0, 1.0), 0.25, grid=cells, save_at=(0.5, 1.0))


def small_limit(rng: Any, notes: Any, named: bool = True) -> Any:
    model = fp.LayDownModel(isotropic(rng, own=not named), between(rng, 1.0, 3.0))
    notes.say(f"HydrodynamicLimit({shown(model)}).solve")
    grid = fp.PlaneGrid(8.0, (int(rng.integers(8, 20)), 12))
    return fp.HydrodynamicLimit(model).solve(
        lambda x, y: np.exp(-((x - 0.5) ** 2) - y**2),
        (0.0, 1.0),
        0.25,
        grid=grid,
        save_at=(0.0, 1.0),
        extrapolate=bool(rng.random() < 0.5),
        boundary_tolerance=1.0,
    )


def small_spectrum(rng: Any, notes: Any, named: bool = True) -> Any:
    model = fp.LayDownModel(
        isotropic(rng, smooth=True, own=False), between(rng, 0.6, 3.0)
    )
    n = int(rng.integers(1, 6))
    notes.say(f"spectrum({shown(model)}, {n}, tolerance=1e-3)")
    return fp.spectrum(model, n, tolerance=1e-3)


@family(24, 3)
def files_keep_every_bit(rng: Any, notes: Any) -> None:
    """Saved and loaded, a result compares as the same bits; no draft is left."""
    result = any_result(rng, notes, named=rng.random() < 0.7)
    name = one_of(rng, "a.nc", "a.zarr", "ä b.nc")
    notes.say(f"save to {name!r}, load, compare")
    result.save(name)
    back = fp.load(name)
    notes.holds("the same kind", type(back) is type(result))
    for key, value in arrays_of(result).items():
        # Angles are cached beside the states when they were asked for.
        if key in ("alpha", "xi", "wrapped_alpha", "eta"):
            continue
        got = arrays_of(back).get(key)
        notes.holds(f"{key} is there", got is not None)
        if got is not None:
            equal = np.array_equal(np.asarray(got), np.asarray(value), equal_nan=True)
            notes.holds(f"{key} bitwise", equal)
    told = fp.compare(result, name)
    notes.holds(f"compare says equal, not {told.differing}", told.equal)
    left = sorted(one.name for one in Path().iterdir())
    if left != [name]:
        notes.leftovers.append(f"left {left}")


def arrays_of(result: Any) -> dict[str, Any]:
    """Arrays among the attributes of a result, one level deep."""
    found: dict[str, Any] = {}
    for name, value in vars(result).items():
        if isinstance(value, np.ndarray):
            found[name] = value
        elif isinstance(value, dict):
            found |= {
                f"{name}[{k}]": v for k, v in value.items() if isinstance(v, np.ndarray)
            }
    return found


@family(12, 1)
def repetitions_are_the_same(rng: Any, notes: Any) -> None:
    """`rerun` of a loaded file gives the same bits."""
    result = any_result(rng, notes)
    notes.say("save, load, rerun, compare")
    result.save("a.nc")
    again = fp.rerun("a.nc")
    told = fp.compare(result, again)
    notes.holds(f"the same, not {told.differing}", told.equal)


@family(14, 1)
def figures_and_reports(rng: Any, notes: Any) -> None:
    """Every figure that fits a result can be drawn, and a report written."""
    result = any_result(rng, notes, named=rng.random() < 0.7)
    import matplotlib.pyplot as plt

    drawn = 0
    for name in sorted(plotting.__all__):
        if not name.startswith("plot_"):
            continue
        notes.say(name)
        try:
            plotting_function = getattr(plotting, name)
            plotting_function(result)
            drawn += 1
        except (TypeError, ValueError) as error:
            # Made for another kind of result, said in the project's own words.
            notes.holds(f"{name}: {type(error).__name__} {error}", "`" in str(error))
        finally:
            plt.close("all")
    notes.say("report")
    page = fp.report(result, "page.html")
    text = page.read_text(encoding="utf-8")
    notes.holds("a page", text.rstrip().endswith("</html>"))
    notes.holds("no nan for a number", "undefined" not in text)


@family(8, 1)
def checkpoints_go_on(rng: Any, notes: Any) -> None:
    """A run that is stopped anywhere and resumed has the bits of one that was not."""
    model = fp.LayDownModel(isotropic(rng, own=False), noise(rng, 0.1), curve(rng))
    grid = grid_for(rng, 6.0, most=12)
    make, options = scheme(rng)
    if "form" in options:
        options["form"] = "h"
    p0, n = tilted_equilibrium(rng, model, grid), int(rng.integers(3, 12))
    stop = int(rng.integers(1, n + 1))
    extrapolate = bool(rng.random() < 0.5)
    arguments = {
        "save_at": (0.0, 0.125 * (n // 2), 0.125 * n),
        "extrapolate": extrapolate,
        "boundary_tolerance": 1.0,
        "negative_tolerance": 10.0,
        "mass_tolerance": 1.0,
    }
    notes.say(
        f"solve({make.__name__}({shown(model)}, {grid}, **{options}), (0, "
        f"{0.125 * n}), 0.125, **{arguments}), stopped after {stop} steps"
    )
    run = make(model, grid, **options)
    whole = fp.solve(run, p0, (0.0, 0.125 * n), 0.125, **arguments)

    def until(done: int, *_: Any) -> None:
        if done >= stop:
            raise KeyboardInterrupt

    keep = fp.Checkpoint("kept", every=int(rng.integers(1, 4)))
    try:
        fp.solve(
            run,
            p0,
            (0.0, 0.125 * n),
            0.125,
            checkpoint=keep,
            progress=until,
            **arguments,
        )
        notes.holds("the interrupt came through", False)
    except fp.RunInterrupted as interrupt:
        notes.holds("partial", interrupt.solution.status == "interrupted")
    resumed = fp.resume("kept")
    told = fp.compare(whole, resumed)
    notes.holds(f"the same, not {told.differing}", told.equal)
