"""What the reports of all studies over noises share: failures, origin, potential."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.declared import declared
from fpsolve.pages.blocks import Block, Equation, Notice, Part, Table
from fpsolve.pages.equations import potential_equation
from fpsolve.pages.numbers import assigned, formatted
from fpsolve.pages.origin import provenance_part
from fpsolve.plotting.selection import potential_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["cases_blocks", "listed", "potential_equations", "start_of", "versions_part"]

# Attributes of a study that say where it was computed.
_ORIGIN = ("versions", "environment", "call", "date")


def potential_equations(dataset: xr.Dataset) -> list[Equation]:
    """Return B(ξ) = … of a study; nothing if it was a user's own."""
    potential = potential_of(dataset)
    return [] if potential is None else [potential_equation(potential)]


def start_of(law: Mapping[str, Any]) -> str:
    """Return a law of the start as a call."""
    options = dict(law)
    return f"{options.pop('kind')}({assigned(options, '.4g')})"


def listed(values: xr.DataArray, form: str = "g") -> str:
    """Return numbers on a line."""
    return ", ".join(formatted(values, form))


def cases_blocks(dataset: xr.Dataset) -> list[Block]:
    """Say how many cases are finished, and list those that are not with the reason."""
    status = dataset["status"]
    asked = status.to_numpy() != "not asked for"
    n_asked, n_finished = int(asked.sum()), int((status == "finished").sum())
    if n_asked == n_finished:
        return [Notice(f"Finished: all {n_asked} cases.", "good")]
    n_failed = int((status == "failed").sum())
    waiting = n_asked - n_finished - n_failed
    said = [f"{n_finished} of {n_asked} cases finished"]
    said += [f"{n_failed} failed"] if n_failed else []
    said += [f"{waiting} not computed"] if waiting else []
    tone = "bad" if n_failed or not n_finished else "warning"
    rows = _unfinished(dataset)
    headings = (*map(_heading, status.dims), "status", "reason")
    words = frozenset(range(len(status.dims), len(headings)))
    return [
        Notice(f"{', '.join(said)}.", tone),
        Table("Cases without a result.", headings, rows, words=words),
    ]


def versions_part(dataset: xr.Dataset) -> Part:
    """Return the provenance of a study, whose files hold versions and times."""
    about = declared(dataset.attrs)
    found = {name: about[name] for name in _ORIGIN if name in about}
    if "seconds" in dataset:
        total = float(np.nansum(dataset["seconds"].to_numpy()))
        found["time of all cases"] = f"{total:.4g} s"
    return provenance_part(found)


def _unfinished(dataset: xr.Dataset) -> list[tuple[str, ...]]:
    status, rows = dataset["status"], []
    others = ~np.isin(status.to_numpy(), ["finished", "not asked for"])
    for place in zip(*others.nonzero(), strict=True):
        at = dict(zip(status.dims, map(int, place), strict=True))
        where = [_label(dataset[name].to_numpy()[n]) for name, n in at.items()]
        told = (str(dataset[name].isel(at).item()) for name in ("status", "message"))
        rows.append((*where, *told))
    return rows


def _heading(dimension: Any) -> str:
    return {"noise": "A", "belt_speed_scale": "v/A²"}.get(dimension, str(dimension))


def _label(value: Any) -> str:
    return f"{value:g}" if isinstance(value, (float, np.floating)) else str(value)
