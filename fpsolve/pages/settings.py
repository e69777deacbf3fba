"""Parameters of a run in words."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fpsolve.pages.blocks import Block, Equation, Notice

if TYPE_CHECKING:
    from fpsolve.grids.phase_space import PhaseSpaceGrid
    from fpsolve.model.curves.curve import Curve
    from fpsolve.model.laydown import LayDownModel

__all__ = [
    "curve_text",
    "grid_text",
    "model_facts",
    "model_or_unread",
    "start_text",
    "unread_model",
    "with_options",
]


def curve_text(curve: Curve) -> str:
    """Return what moves: belt at rest, belt speed, or γ(s)."""
    if curve.fixed:
        return "fixed belt"
    if curve.autonomous:
        return f"belt moving at v = {curve.speed:g}"
    return f"γ(s) = {curve.formula}, mean belt speed v = {curve.speed:g}"


def grid_text(grid: PhaseSpaceGrid) -> str:
    """Return numbers of cells, box and cell widths."""
    cells = " × ".join(map(str, grid.shape))
    (width1, width2), (d1, d2, turn) = grid.half_widths, grid.spacing
    return (
        f"{cells} cells, |ξ₁| < {width1:g}, |ξ₂| < {width2:g}; cells of {d1:.4g} by "
        f"{d2:.4g} by {turn:.4g} rad"
    )


def start_text(provenance: Mapping[str, Any], section: str) -> str:
    """Return the start that the configuration describes; empty without one."""
    tables = tomllib.loads(str(provenance.get("configuration", "")))
    options = dict(tables.get(section, {}))
    return with_options(options.pop("kind"), options) if "kind" in options else ""


def with_options(name: str, options: Mapping[str, Any]) -> str:
    """Write a name with its options as a call."""
    listed = ", ".join(f"{key} = {_plain(value)}" for key, value in options.items())
    return f"{name}({listed})" if listed else name


def model_facts(model: LayDownModel | None) -> list[tuple[str, str]]:
    """Return potential, noise and curve of a model, if it is known."""
    if model is None:
        return []
    return [
        ("potential", f"B = {model.potential.formula}"),
        ("noise", f"A = {model.noise:g}"),
        ("reference curve", curve_text(model.curve)),
    ]


def model_or_unread(
    model: LayDownModel | None, provenance: Mapping[str, Any]
) -> list[Block]:
    """Return the equations of a model, or how one of a user's own described itself."""
    from fpsolve.pages.equations import model_equations

    return [*model_equations(model)] if model else unread_model(provenance)


def unread_model(provenance: Mapping[str, Any]) -> list[Block]:
    """Return the equation as it came, for a model made of a user's own functions."""
    said = (
        "The model is made of a user's own functions, which a file cannot hold; this "
        "is how it described itself."
    )
    plain = str(provenance.get("equation") or "no description of the model")
    return [Notice(said, "warning"), Equation(None, plain)]


def _plain(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return f"({', '.join(map(_plain, value))})"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
