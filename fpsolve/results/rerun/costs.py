"""Whether what a file asks for is what it holds, before it is computed again.

A file that was tampered with may ask for more than anybody can wait for. What it asks
for decides sizes that the file has, too; where both differ it is refused.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.declared import declared
from fpsolve.density.levels import MOST_LEVELS, n_steps
from fpsolve.errors import NotRepeatableError

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["check_call"]

# Seconds that a step takes for a cell, or a path, at the very least.
_FASTEST = 1e-10
_LONGEST = 30 * 86400.0
# Arguments that decide the number of steps.
_DECISIVE = {"s_span", "s_start", "s_end", "ds", "save_at", "record_every",
             "extrapolate", "tolerance", "n_paths"}  # fmt: skip
_SAME = 1e-6


def check_call(
    function: str, arguments: Mapping[str, Any], result: Any, given: Any
) -> None:
    """Raise NotRepeatableError unless a call has the size that its result shows.

    Parameters
    ----------
    function : str
    arguments : mapping
    result : object
        A study, or what has `to_xarray`.
    given : collection of str
        Names of arguments that the caller chose instead; those are not looked at.
    """
    if function in _STEPPING and not _DECISIVE & set(given):
        _check_steps(result, arguments, given)
    read = _HELD.get(function)
    if read is None:
        return
    dataset = result if hasattr(result, "data_vars") else result.to_xarray()
    for name, held in read(dataset, declared(dataset.attrs)):
        asked = arguments.get(name)
        asked = asked.shape if name == "grid" and asked is not None else asked
        # What is not in the call has its default.
        if name in given or asked is None or held is None:
            continue
        if not _same(asked, held):
            raise _refused(f"`{name}`", str(asked), str(np.asarray(held).tolist()))


def _check_time(n_steps: float, n_each: int, what: str) -> None:
    seconds = n_steps * n_each * _FASTEST
    if not seconds <= _LONGEST:
        raise NotRepeatableError(
            f"the result asks for {n_steps * n_each:.2g} {what}, which take "
            f"{seconds / 86400:.2g} days at the very least; pass arguments that ask "
            "for less, or call its function again."
        )


def _passes(extrapolate: Any) -> int:
    """Steps of all passes for one of ds; what a file says need not be a level."""
    if not isinstance(extrapolate, int) or extrapolate not in range(MOST_LEVELS + 1):
        allowed = f"True, False or at most {MOST_LEVELS}"
        raise _refused("`extrapolate`", str(extrapolate), allowed)
    return n_steps(extrapolate)


def _check_steps(result: Any, asked: Mapping[str, Any], given: Collection[str]) -> None:
    """Raise NotRepeatableError unless a run takes the steps that its result shows."""
    are_paths, passes = "n_paths" in asked, _passes(asked.get("extrapolate", False))
    span, ds = asked.get("s_span", ()), asked.get("ds", 0.0)
    if are_paths:
        span, passes = (asked.get("s_start"), asked.get("s_end")), asked["n_paths"]
    if not (_are_numbers(*_listed(span), ds, passes) and len(span) == 2 and ds > 0):
        raise _refused("`s_span` and `ds`", f"{span} and {ds}", "two numbers, a step")
    n_coarse, finished = abs(span[1] - span[0]) / ds, result.status == "finished"
    if are_paths:
        _check_time(n_coarse, passes, "steps of all paths")
    else:
        _check_time(n_coarse * passes, result.grid.n_cells, "steps of all cells")
        _check_records(result, asked, n_coarse, finished)
    # A scheme of the caller's own need not count; with a tolerance steps are at least
    # so many.
    open_ended = "scheme" in given or asked.get("tolerance") is not None
    told = None if open_ended else result.provenance.get("n_steps")
    if finished and told is not None and abs(told - passes * n_coarse) > 1:
        raise _refused("`ds`", f"{passes * n_coarse:.6g} steps", f"{told} steps")


def _listed(value: Any) -> tuple[Any, ...]:
    return tuple(value) if isinstance(value, list | tuple) else (value,)


def _are_numbers(*values: Any) -> bool:
    """Whether all are finite numbers; what is in a file may be anything."""
    return all(isinstance(one, int | float) and math.isfinite(one) for one in values)


def _check_records(
    result: Any, run: Mapping[str, Any], n_steps: float, finished: bool
) -> None:
    s = result.series["s"]
    n_saves, every = np.size(run.get("save_at", ())), run.get("record_every", 1)
    if not _are_numbers(every):
        raise _refused("`record_every`", str(every), "a number")
    fewest = n_steps / max(every, 1)
    held = s.size - 1
    if not held <= fewest + n_saves + 1 or (finished and not fewest <= held + 1):
        raise _refused("`record_every`", f"{fewest + 1:.6g} records", f"{s.size}")
    ends, found = run["s_span"], (s[0], s[-1]) if s.size else ()
    if finished and not (found and np.allclose(found, ends, rtol=_SAME)):
        raise _refused("`s_span`", str(ends), ", ".join(f"{one:g}" for one in found))


def _refused(name: str, asked: str, held: str) -> NotRepeatableError:
    return NotRepeatableError(
        f"the result cannot be of the arguments that are in it: {name} would give "
        f"{asked}, and it holds {held}; pass the arguments that are right, or call its "
        "function again."
    )


def _same(asked: Any, held: Any) -> bool:
    try:
        one, two = (np.sort(np.ravel(np.asarray(x, dtype=np.float64))) for x in
                    (asked, held))  # fmt: skip
    except (TypeError, ValueError):
        return False
    return one.shape == two.shape and np.allclose(one, two, rtol=_SAME, atol=0.0)


Held = Iterator[tuple[str, Any]]


def _values(dataset: xr.Dataset, name: str) -> Any:
    return dataset[name].to_numpy() if name in dataset else None


def _of_rates(dataset: xr.Dataset, about: Mapping[str, Any]) -> Held:
    yield "noises", _values(dataset, "noise")
    ends = _values(dataset, "s_end")
    known = np.zeros(0) if ends is None else ends[np.isfinite(ends)]
    yield "s_end", known[0] if known.size else None


def _of_large_noise(dataset: xr.Dataset, about: Mapping[str, Any]) -> Held:
    yield "noises", _values(dataset, "noise")
    for name in ("slow_length", "belt_speed_scale", "fixed_speed", "bending"):
        yield name, about.get(name)


def _of_white_noise(dataset: xr.Dataset, about: Mapping[str, Any]) -> Held:
    yield "relaxation_lengths", _values(dataset, "relaxation_length")
    for name in ("noise", "s_end", "belt_speed", "n_paths"):
        yield name, about.get(name)


def _of_homogeneity(dataset: xr.Dataset, about: Mapping[str, Any]) -> Held:
    yield "noises", _values(dataset, "noise")
    yield "belt_speeds", _values(dataset, "belt_speed")
    yield "spacings", _values(dataset, "spacing")
    yield "zones", _values(dataset, "zone")
    for name in ("n_webs", "pixel", "tolerance"):
        yield name, about.get(name)


def _of_small_noise(dataset: xr.Dataset, about: Mapping[str, Any]) -> Held:
    yield "noises", _values(dataset, "noise")
    yield "belt_speed_scales", _values(dataset, "belt_speed_scale")
    for name in ("slow_length", "ds", "n_paths"):
        yield name, about.get("options", {}).get(name)


def _of_small_noise_spectrum(dataset: xr.Dataset, about: Mapping[str, Any]) -> Held:
    yield "noises", _values(dataset, "noise")
    yield "tolerance", about.get("tolerance")


def _of_averages(dataset: xr.Dataset, about: Mapping[str, Any]) -> Held:
    yield "noises", _values(dataset, "noise")
    saved, steps = _values(dataset, "s"), _values(dataset, "ds")
    yield "s_end", None if saved is None else saved[-1:]
    yield "n_paths", about.get("n_paths")
    # If it was given, it is the same for every noise.
    yield "ds", None if steps is None else np.unique(steps)


def _of_check(dataset: xr.Dataset, about: Mapping[str, Any]) -> Held:
    yield "s", _values(dataset, "s")
    yield "n_paths", about.get("n_paths")
    yield "ds", about.get("solver", {}).get("ds")
    yield "paths_ds", about.get("sampler", {}).get("ds")
    cells = [dataset.sizes.get(axis, 0) for axis in ("xi1", "xi2", "alpha")]
    # Nothing is compared along the curvature: its cells are those of the grid.
    yield "grid", [*cells, *about.get("grid", {}).get("shape", [])[3:]]


def _of_tables(dataset: xr.Dataset, about: Mapping[str, Any]) -> Held:
    yield "n_energies", dataset.sizes.get("g", 0)
    yield "n_eigenvalues", dataset.sizes.get("mode", 0)
    yield "noise", about.get("noise")


# Functions that step, of which the result tells how often.
_STEPPING = ("solve", "sample_paths", "HydrodynamicLimit.solve", "EnergyProcess.solve")
# Of every function what its dataset holds of its arguments.
_HELD: dict[str, Callable[[Any, Mapping[str, Any]], Held]] = {
    "rate_versus_noise": _of_rates,
    "large_noise_limit": _of_large_noise,
    "white_noise_limit": _of_white_noise,
    "web_homogeneity": _of_homogeneity,
    "small_noise_limit": _of_small_noise,
    "small_noise_spectrum": _of_small_noise_spectrum,
    "ergodic_averages": _of_averages,
    "cross_check": _of_check,
    "energy_tables": _of_tables,
}
