"""The pages about a fibre in motion, and about one that was laid down."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve.pages.blocks import Facts, Part, Section
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import curve_text

if TYPE_CHECKING:
    from fpsolve.fibre.laid import LayDown
    from fpsolve.fibre.motion import Motion
    from fpsolve.fibre.string import String

__all__ = ["lay_down_section", "motion_section"]

_Items = list[tuple[str, str]]


def motion_section(motion: Motion, source: str) -> Section:
    """Return the section of a page about a fibre that moved."""
    energy = motion.energy
    items = [
        *_string_items(motion.string),
        ("held by", f"{motion.string.start!r} and {motion.string.end!r}"),
        *_run_items(motion),
        ("energy", f"{energy[0]:.6g} J at first, {energy[-1]:.6g} J at last"),
    ]
    return Section("Motion of a fibre", source, [
        Part("Parameters and numbers", [Facts(items)]),
        Part("Figure", drawings(motion)),
        provenance_part(motion.provenance, call=motion.call),
    ])  # fmt: skip


def lay_down_section(found: LayDown, source: str) -> Section:
    """Return the section of a page about a fibre on the belt."""
    belt, nozzle = found.belt, found.nozzle
    slower = belt is None or belt.speed < nozzle.speed
    items = [
        *_string_items(found.string),
        ("spinning speed", f"{nozzle.speed:g} m/s"),
        ("belt",
         "none" if belt is None else f"{belt.speed:g} m/s at {belt.height:g} m"),
        ("reference curve", curve_text(found.reference_curve) if slower else "none"),
        *_run_items(found),
        ("spun out", f"{found.fed:.6g} m"),
        ("nodes on the belt", f"{len(found.landed)}"),
        ("in the air at last", f"{found.free_length[-1]:.4g} m"),
        ("steps taken in halves", f"{int(found.rejected.sum())}"),
    ]  # fmt: skip
    return Section("Fibre laid down on a belt", source, [
        Part("Parameters and numbers", [Facts(items)]),
        Part("Figure", drawings(found)),
        provenance_part(found.provenance, call=found.call),
    ])  # fmt: skip


def _string_items(string: String) -> _Items:
    return [
        ("fibre", f"{string.length:g} m of {1e6 * string.diameter:.4g} µm in "
                  f"{string.n_edges} edges at the beginning"),
        ("line density ρA", f"{string.line_density:.4g} kg/m"),
        ("bending stiffness EI", f"{string.bending_stiffness:.4g} N m²"),
    ]  # fmt: skip


def _run_items(found: Motion | LayDown) -> _Items:
    steps = found.t.size - 1
    return [
        ("steps", f"{steps} to t = {found.t[-1]:g} s"),
        ("iterations of a step", f"{found.iterations[1:].mean():.3g} on average"),
        ("edges keep their length to", f"{found.stretched.max():.1e}"),
        ("error of the last positions", f"{found.position_error:.2g} m at most"),
    ]
