"""Parameters of a run in words."""

from __future__ import annotations

import tomllib
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fpsolve.grids.smooth import AnyGrid, SmoothPhaseSpaceGrid
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.pages.blocks import Block, Equation, Facts, Notice, Part
from fpsolve.pages.equations import (
    energy_equations,
    model_equations,
    potential_equation,
)
from fpsolve.pages.numbers import assigned

if TYPE_CHECKING:
    from fpsolve.model.curves.curve import Curve
    from fpsolve.model.fibre import FibreModel
    from fpsolve.model.process import Process
    from fpsolve.reduced.energy.process import EnergyProcess

__all__ = [
    "curve_text",
    "grid_text",
    "model_facts",
    "model_or_unread",
    "process_equations",
    "process_facts",
    "process_of",
    "start_text",
    "units_part",
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


def grid_text(grid: AnyGrid) -> str:
    """Return numbers of cells, box and cell widths."""
    cells = " × ".join(map(str, grid.shape))
    (width1, width2), (d1, d2, turn, *bend) = grid.half_widths, grid.spacing
    curved, by = "", ""
    if isinstance(grid, SmoothPhaseSpaceGrid):
        curved, by = f", |κ| < {grid.kappa_half_width:g}", f" by {bend[0]:.4g}"
    return (
        f"{cells} cells, |ξ₁| < {width1:g}, |ξ₂| < {width2:g}{curved}; cells of "
        f"{d1:.4g} by {d2:.4g} by {turn:.4g} rad{by}"
    )


def start_text(provenance: Mapping[str, Any], section: str) -> str:
    """Return the start that the configuration describes; empty without one."""
    options = dict(_configuration(provenance).get(section, {}))
    return with_options(options.pop("kind"), options) if "kind" in options else ""


def process_of(provenance: Mapping[str, Any]) -> Process | None:
    """Return the process of the section [process] of a configuration, if any."""
    section = _configuration(provenance).get("process")
    if section is None:
        return None
    from fpsolve.model.process import Process

    with warnings.catch_warnings():
        # Said when the run was made.
        warnings.simplefilter("ignore", UserWarning)
        return Process(**section)


def units_part(process: Process | None) -> list[Part]:
    """Return what the dimensionless units of a process stand for, if there is one."""
    if process is None:
        return []
    sigma1, sigma2 = 1e3 * process.sigma1, 1e3 * process.sigma2
    belt_speed = process.speed_ratio * process.spinning_speed
    items = [
        ("throwing ranges", f"σ₁ = {sigma1:g} mm, σ₂ = {sigma2:g} mm"),
        ("noise", f"{process.noise:g} m^-1/2, A = {process.model.noise:g}"),
        ("spinning speed", f"{process.spinning_speed:g} m/s"),
        ("belt speed", f"{belt_speed:g} m/s, v = {process.speed_ratio:g}"),
        ("unit of length (ξ, s)", f"{1e3 * process.length:g} mm"),
        ("unit of time (s)", f"{1e3 * process.time:g} ms to lay down one unit of s"),
    ]
    if process.relaxation_length is not None:
        length = process.relaxation_length
        told = f"{1e3 * length:g} mm, R = {length / process.sigma1:g}"
        items.insert(2, ("relaxation length", told))
    return [Part("Production process", [Facts(items)])]


def with_options(name: str, options: Mapping[str, Any]) -> str:
    """Write a name with its options as a call."""
    return f"{name}({assigned(options)})" if options else name


def model_facts(model: FibreModel | None) -> list[tuple[str, str]]:
    """Return potential, noise and curve of a model, if it is known."""
    if model is None:
        return []
    return [
        ("potential", f"B = {model.potential.formula}"),
        ("noise", noise_text(model)),
        ("reference curve", curve_text(model.curve)),
    ]


def noise_text(model: FibreModel) -> str:
    """Return the noise, and the relaxation length of a smooth model."""
    if not isinstance(model, SmoothLayDownModel):
        return f"A = {model.noise:g}"
    length, amplitude = model.relaxation_length, model.curvature_noise
    return f"A = {model.noise:g}, R = {length:g}, K = A/R = {amplitude:g}"


def model_or_unread(
    model: FibreModel | None, provenance: Mapping[str, Any]
) -> list[Block]:
    """Return the equations of a model, or how one of a user's own described itself."""
    return [*model_equations(model)] if model else unread_model(provenance)


def unread_model(provenance: Mapping[str, Any]) -> list[Block]:
    """Return the equation as it came, for a model made of a user's own functions."""
    said = (
        "The model is made of a user's own functions, which a file cannot hold; this "
        "is how it described itself."
    )
    plain = str(provenance.get("equation") or "no description of the model")
    return [Notice(said, "warning"), Equation(None, plain)]


def process_facts(process: EnergyProcess | None) -> list[tuple[str, str]]:
    """Return potential and noise of an energy process, if it is known."""
    if process is None:
        return []
    return [
        ("potential", f"B = {process.potential.formula}"),
        ("noise", f"A = {process.noise:g}"),
    ]


def process_equations(
    process: EnergyProcess | None, provenance: Mapping[str, Any]
) -> list[Block]:
    """Return the equations of an energy process, or how a user's own was described."""
    if process is None:
        described = provenance.get("process_description", {})
        return [*energy_equations(), *unread_model(described)]
    return [*energy_equations(), potential_equation(process.potential)]


def _configuration(provenance: Mapping[str, Any]) -> dict[str, Any]:
    return tomllib.loads(str(provenance.get("configuration", "")))
