"""What the reports of all studies over noises share: failures, origin, potential."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.declared import declared
from fpsolve.model.potentials.dictionaries import potential_from_dict
from fpsolve.model.potentials.potential import Potential
from fpsolve.pages.blocks import Block, Notice, Part, Table
from fpsolve.pages.origin import provenance_part

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["cases_blocks", "entries", "origin_of", "potential_of", "versions_part"]


def potential_of(dataset: xr.Dataset) -> Potential | None:
    """Return the potential of a study; None if it was a user's own."""
    try:
        return potential_from_dict(declared(dataset.attrs)["potential"])
    except ValueError:
        return None


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


def versions_part(dataset: xr.Dataset, seconds: bool = True) -> Part:
    """Return the provenance of a study, whose files hold versions and times."""
    found = origin_of(dataset)
    if seconds and "seconds" in dataset:
        total = float(np.nansum(dataset["seconds"].to_numpy()))
        found["time of all cases"] = f"{total:.4g} s"
    return provenance_part(found)


def origin_of(dataset: xr.Dataset) -> dict[str, Any]:
    """Return what the attributes of a study say about where it was computed."""
    kept = ("versions", "environment", "call", "date")
    about = declared(dataset.attrs)
    return {name: about[name] for name in kept if name in about}


def entries(options: Mapping[str, Any]) -> str:
    """Return names with their values on a line."""
    return ", ".join(f"{name} = {_short(value)}" for name, value in options.items())


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


def _short(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"({entries(value)})"
    if isinstance(value, (list, tuple)):
        return f"({', '.join(map(_short, value))})"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
