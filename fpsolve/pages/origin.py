"""Where a result comes from: status, configuration, versions, date, times."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fpsolve.pages.blocks import Block, Facts, Listing, Notice, Paragraph, Part
from fpsolve.pages.numbers import grouped

if TYPE_CHECKING:
    from fpsolve.evolution.call import Call

__all__ = ["provenance_part", "status_notice", "suggestion"]

# Shown elsewhere on the page, or stand in for a model that cannot be read back.
_ELSEWHERE = (
    "versions", "date", "wall_seconds", "cpu_seconds", "n_steps", "extrapolated",
    "levels", "environment", "configuration", "suggested", "call", "model_description",
    "equation", "initial_description",
)  # fmt: skip
_TONES = {"finished": "good", "interrupted": "warning"}
_NAMES = {"python": "Python"}
# Shown folded, as JSON.
_LISTINGS = {
    "environment": "Environment in full",
    "call": "Function and arguments that repeat this result",
}
_MISSING = {"date": "date", "environment": "machine"}


def status_notice(status: str, message: str) -> Notice:
    """Say how a run ended, and why if not at its end."""
    if status == "finished":
        return Notice("Finished.", "good")
    reason = f": {message.rstrip('.')}" if message else ""
    return Notice(
        f"{status.capitalize()}{reason}. What was recorded until then is below.",
        _TONES.get(status, "bad"),
    )


def provenance_part(
    provenance: Mapping[str, Any], steps: str = "steps", call: Call | None = None
) -> Part:
    """Return versions, machine, date and times, whatever else is known, and the TOML.

    Parameters
    ----------
    provenance : mapping
    steps : str, optional
        What `n_steps` counts.
    call : Call, optional
        How the result was made.
    """
    if call is not None:
        told = {"function": call.function, "arguments": call.arguments}
        provenance = {**provenance, "call": told}
    items = [(_NAMES.get(name, name), str(number)) for name, number in
             provenance.get("versions", {}).items()]  # fmt: skip
    facts = [*_when(provenance, steps), ("versions", _joined(items)),
             ("machine", _machine(provenance.get("environment", {})))]  # fmt: skip
    facts += [
        (str(name).replace("_", " "), _text(value))
        for name, value in provenance.items()
        if name not in _ELSEWHERE
    ]
    blocks: list[Block] = [Facts([fact for fact in facts if fact[1]])]
    missing = [name for key, name in _MISSING.items() if key not in provenance]
    if missing:
        blocks.append(Paragraph(f"Not recorded in the file: {', '.join(missing)}."))
    blocks += [
        Listing(summary, json.dumps(provenance[name], indent=1, ensure_ascii=False))
        for name, summary in _LISTINGS.items()
        if name in provenance
    ]
    if "configuration" in provenance:
        toml = str(provenance["configuration"]).strip()
        blocks.append(Listing("Configuration (TOML), which repeats this run", toml))
    return Part("Provenance", blocks)


def suggestion(provenance: Mapping[str, Any], name: str) -> str:
    """Return why a grid or a step was suggested, in brackets; empty if it was given."""
    reason = provenance.get("suggested", {}).get(name)
    return f" (suggested: {reason})" if reason else ""


def _when(provenance: Mapping[str, Any], steps: str) -> list[tuple[str, str]]:
    facts = [("date", str(provenance.get("date", "")).replace("T", " "))]
    if "wall_seconds" in provenance:
        wall, cpu = provenance["wall_seconds"], provenance.get("cpu_seconds", 0.0)
        facts.append(("time", f"{wall:.4g} s ({cpu:.4g} s of CPU time)"))
    if "n_steps" in provenance:
        facts.append((steps, grouped(provenance["n_steps"])))
    return facts


def _machine(environment: Mapping[str, Any]) -> str:
    """Return processor, system and threads, as far as they were recorded."""
    names = ("processor", "architecture", "system")
    known = [str(environment[name]) for name in names if environment.get(name)]
    threads = environment.get("numba", {}).get("threads")
    if threads is not None:
        known.append(f"{threads} thread{'s' if threads != 1 else ''}")
    return ", ".join(known)


def _joined(items: list[tuple[str, str]]) -> str:
    return ", ".join(f"{name} {value}" for name, value in items)


def _text(value: Any) -> str:
    if isinstance(value, Mapping):
        return _joined([(str(key), _text(entry)) for key, entry in value.items()])
    if isinstance(value, (list, tuple)):
        return ", ".join(map(_text, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)
