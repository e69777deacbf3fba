"""What a unit means in a production process, if the configuration describes one."""

from __future__ import annotations

import tomllib
import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fpsolve.pages.blocks import Facts, Part

if TYPE_CHECKING:
    from fpsolve.model.process import Process

__all__ = ["process_of", "units_part"]


def process_of(provenance: Mapping[str, Any]) -> Process | None:
    """Return the process of the section [process] of a configuration, if any."""
    section = tomllib.loads(str(provenance.get("configuration", ""))).get("process")
    if section is None:
        return None
    from fpsolve.model.process import Process

    with warnings.catch_warnings():
        # Said when the run was made.
        warnings.simplefilter("ignore", UserWarning)
        return Process(**section)


def units_part(process: Process) -> Part:
    """Return the process in SI units and what the dimensionless units stand for."""
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
    return Part("Production process", [Facts(items)])
