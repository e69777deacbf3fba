"""What a comparison of two results found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fpsolve.results.compare.differences import FLOOR, Difference

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["ROUNDING", "Comparison", "place_text", "verdict"]

# What other processors and libraries change, in units of the largest value: rounding
# of 1e-16, a thousand steps, and a condition number of a thousand.
ROUNDING = 1e-10
_MOST_ROWS = 12


@dataclass(frozen=True, eq=False)
class Comparison:
    """Two results of the same kind: where they differ, by how much, and why.

    ``print(comparison)`` says it in words.

    Attributes
    ----------
    kind : str
        What was compared, in words.
    names : (str, str)
        Of A and B.
    differences : tuple of Difference
        One for every variable; "density_l1" is the L¹ distance of the densities.
    left_out : tuple of str
        What was not compared, and why.
    parameters : tuple of str
        Parameters that differ, with both values.
    environment : tuple of str
        Versions, processor and threads that differ, likewise.
    dataset : xarray.Dataset
        See `to_xarray`.
    """

    kind: str
    names: tuple[str, str]
    differences: tuple[Difference, ...]
    left_out: tuple[str, ...]
    parameters: tuple[str, ...]
    environment: tuple[str, ...]
    dataset: xr.Dataset

    @property
    def equal(self) -> bool:
        """Whether all numbers and texts are the same, bit by bit, and none left out."""
        return not self.left_out and all(one.equal for one in self.differences)

    @property
    def differing(self) -> tuple[Difference, ...]:
        """The variables that differ, the largest relative difference first.

        Those that differ by 1e-12 at most come last, after differences of errors.
        """
        found = [one for one in self.differences if not one.equal]
        return tuple(sorted(found, key=_weight))

    @property
    def within_errors(self) -> bool | None:
        """Whether estimated errors explain every difference that has them, or None."""
        known = [one.within_errors for one in self.differences]
        known = [one for one in known if one is not None]
        return all(known) if known else None

    def within(self, tolerance: float) -> bool:
        """Whether every max |b − a| <= tolerance max |a| (or 1e-12), none left out."""
        return not self.left_out and all(
            one.within(tolerance) for one in self.differences
        )

    @property
    def is_rounding(self) -> bool:
        """Whether all that differs is `within` 1e-10: another machine explains it."""
        return self.within(ROUNDING)

    def __getitem__(self, name: str) -> Difference:
        for one in self.differences:
            if one.name == name:
                return one
        known = ", ".join(one.name for one in self.differences)
        raise KeyError(f"`name` must be one of {known}, got {name!r}.")

    def to_xarray(self) -> xr.Dataset:
        """b − a of every number on common coordinates; `..._error` are those of b − a.

        The attributes hold what is said in words.
        """
        return self.dataset.assign_attrs(
            title="Difference of two results, B − A",
            compared=self.kind,
            equal=int(self.equal),
            left_out="\n".join(self.left_out),
            parameters="\n".join(self.parameters),
            environment="\n".join(self.environment),
        )

    def __str__(self) -> str:
        return report(self)

    def __repr__(self) -> str:
        outcome = "equal" if self.equal else f"{len(self.differing)} variables differ"
        return f"Comparison({self.kind}: {outcome})"


def _weight(one: Difference) -> tuple[bool, bool, float]:
    """What a list of differences is sorted by, ascending."""
    return one.largest <= FLOOR, one.name.endswith("_error"), -one.relative


def report(comparison: Comparison) -> str:
    """Return the verdict, the variables that differ most, and what else differs."""
    a, b = comparison.names
    lines = [f"A = {a}, B = {b}: {comparison.kind}", verdict(comparison)]
    shown = comparison.differing[:_MOST_ROWS]
    lines += [f"  {_line(one)}" for one in shown]
    if len(comparison.differing) > len(shown):
        lines.append(f"  and {len(comparison.differing) - len(shown)} more variables")
    for title, entries in sections(comparison).items():
        if entries:
            lines += [f"{title}:", *(f"  {entry}" for entry in entries)]
    return "\n".join(lines)


def sections(comparison: Comparison) -> dict[str, tuple[str, ...]]:
    """Return what is said below the numbers, with headings."""
    return {
        "not compared": comparison.left_out,
        "parameters that differ": comparison.parameters,
        "environment that differs": comparison.environment,
    }


def verdict(comparison: Comparison) -> str:
    """Return in a sentence or two whether both are the same, and if not how far off."""
    n = len(comparison.differences)
    if comparison.equal:
        return f"equal: the same bits in all {n} variables"
    if not comparison.differing:
        return f"what was compared is equal, the same bits in all {n} variables"
    worst = comparison.differing[0]
    text = (
        f"different in {len(comparison.differing)} of {n} variables, at most by "
        f"{worst.relative:.2g} of the largest value ({worst.name})"
    )
    if comparison.is_rounding:
        text += f"; rounding explains this (below {ROUNDING:g} of the largest value)"
    if comparison.within_errors is not None:
        inside = "within" if comparison.within_errors else "beyond"
        text += f"; {inside} the estimated errors of A and B"
    return text


def _line(one: Difference) -> str:
    text = f"{one.name}: {one.largest:.3g} ({one.relative:.2g} of the largest value)"
    place = place_text(one)
    text += f" at {place}" if place else ""
    if one.in_errors is not None:
        unit = "standard errors" if one.statistical else "of the estimated errors"
        text += f", {one.in_errors:.2g} {unit}"
    return text


def place_text(one: Difference) -> str:
    """Return where the difference is largest."""
    return ", ".join(
        f"{name} = {value:.3g}" if isinstance(value, float) else f"{name} = {value}"
        for name, value in one.place.items()
    )
