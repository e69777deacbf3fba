"""Which run a checkpoint is of: a call of `solve`, and what a user's code computes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.digests import SAMPLED, digest_of, plain
from fpsolve.density.levels import n_passes
from fpsolve.density.schemes.dictionaries import CODE
from fpsolve.density.schemes.scheme import Scheme
from fpsolve.evolution.call import IDENTITY, USER_CODE, Call
from fpsolve.evolution.differences import differences
from fpsolve.evolution.schedule import Schedule
from fpsolve.grids.smooth import AnyGrid
from fpsolve.model.curves.samples import digest_of_curve
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.samples import digest_of_potential

__all__ = ["differing_arguments", "digest_of_run", "identified"]


# Keys of digests, and what these are digests of.
_STEP = "first_step"
_DIGESTS = {SAMPLED: "values", CODE: "code", _STEP: "values"}
# A value that takes more characters is not shown.
_LONGEST = 50


def identified(
    call: Call, scheme: Scheme, p0: Array, schedule: Schedule
) -> dict[str, Any]:
    """Return all that decides the bits of a run but versions and machine.

    The arguments of its call. Of a user's own code it is said by digests what it
    computes where the run asks it: of a potential on the grid, of a curve on the steps,
    of a scheme in its first step from `p0`.

    Parameters
    ----------
    call : Call
    scheme : Scheme
    p0 : ndarray, shape (n1, n2, n_alpha)
    schedule : Schedule
    """
    run: dict[str, Any] = plain(call.arguments)
    about = run["scheme"]["$scheme"]
    last = schedule.refined(n_passes(run["extrapolate"]))
    _sample(about["model"]["$model"], scheme.model, scheme.grid, last)
    if CODE in about["scheme"]:
        about["scheme"][_STEP] = _first_step(scheme, p0, schedule)
    return run


def digest_of_run(run: Mapping[str, Any]) -> str:
    """Return the SHA-256 of what `identified` returned."""
    text = json.dumps(run, sort_keys=True, ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def differing_arguments(
    old: Mapping[str, Any], new: Mapping[str, Any]
) -> tuple[str, ...]:
    """Name every argument in which two runs differ, with both values."""
    found = differences(_named(old), _named(new), sort=_sort)
    # One function may differ in more than one of its digests.
    return tuple(dict.fromkeys(_line(*one) for one in found))


def _sample(
    about: dict[str, Any], model: FibreModel, grid: AnyGrid, schedule: Schedule
) -> None:
    """Describe a user's own parts of a model by what they return to schemes.

    Forces are asked for at the centres of cells and between them, the curve at steps
    and at halves of them.
    """
    potential, curve = about["potential"], about["curve"]
    if SAMPLED in potential:
        finer = _refined(grid.xi1)[:, None], _refined(grid.xi2)[None, :]
        places = grid.plane(), finer
        potential[SAMPLED] = digest_of_potential(model.potential, *places)
    if SAMPLED in curve:
        halves = np.arange(2 * schedule.n_steps + 1, dtype=np.float64)
        stops = schedule.start + schedule.ds / 2 * halves
        curve[SAMPLED] = digest_of_curve(model.curve, stops)


def _refined(centres: Array) -> Array:
    """Faces and centres of cells, and the middle between each two of them."""
    spacing = centres[1] - centres[0]
    quarters = np.arange(4 * centres.size + 1, dtype=np.float64) / 4
    return np.asarray(centres[0] + spacing * (quarters - 0.5))


def _first_step(scheme: Scheme, p0: Array, schedule: Schedule) -> str | None:
    """What a scheme of unknown code does to p0; None if it fails, as the run will."""
    # A user's scheme raises whatever it likes.
    try:
        state = scheme.start(p0)
        scheme.advance(state, schedule.start, schedule.ds)
        return digest_of(scheme.density(state))
    except Exception:
        return None


def _named(run: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments by the names that a caller knows."""
    rest = dict(run)
    about = rest.pop("scheme")["$scheme"]
    scheme = dict(about["scheme"])
    scheme = {"kind": scheme.pop("name"), **scheme, **scheme.pop("options")}
    del scheme["options"]
    model, grid = about["model"]["$model"], about["grid"]["$grid"]
    return {**model, "grid": grid, "scheme": scheme, **rest}


def _sort(table: Mapping[str, Any]) -> Any:
    return table.get("kind"), table.get(IDENTITY)


def _line(name: str, old: Any, new: Any) -> str:
    before, after = _text(old), _text(new)
    owner, _, last = name.rpartition(".")
    if last in _DIGESTS:
        return f"`{owner}` holds other {_DIGESTS[last]}"
    if any(isinstance(one, dict) and USER_CODE in one for one in (old, new)):
        return f"`{name}` holds other code"
    if max(len(before), len(after)) > _LONGEST:
        return f"`{name}` holds other values"
    return f"`{name}` was {before}, is {after}"


def _text(value: Any) -> str:
    if not isinstance(value, dict):
        return "not given" if value is None else repr(value)
    own = {key: entry for key, entry in value.items() if key != "order"}
    kind = own.pop("kind", "")
    text = f"{kind}({', '.join(f'{key}={entry!r}' for key, entry in own.items())})"
    return text if len(text) <= _LONGEST or not kind else str(kind)
