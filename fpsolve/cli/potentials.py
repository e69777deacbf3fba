"""Potentials from options of the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from fpsolve.model.potentials.potential import Potential

__all__ = [
    "Exponent",
    "Sigma1",
    "Sigma2",
    "Slope",
    "make_potential",
    "potential_options",
]

Sigma1 = Annotated[
    float, typer.Option("--sigma1", help="Throwing range σ1 of a quadratic potential.")
]
Sigma2 = Annotated[
    float | None,
    typer.Option(
        "--sigma2", help="Throwing range σ2 across the belt.", show_default="σ1"
    ),
]
Slope = Annotated[
    float, typer.Option("--slope", help="Slope K of a linear potential K|ξ|.")
]
Exponent = Annotated[
    float, typer.Option("--exponent", help="Exponent n of a power potential |ξ|ⁿ/n.")
]
KINDS = ("quadratic", "linear", "power", "free")


def make_potential(
    kind: str, sigma1: float, sigma2: float | None, slope: float, exponent: float
) -> Potential:
    """Return the potential of a kind with the parameters that belong to it."""
    from fpsolve.model.potentials.free import FreePotential
    from fpsolve.model.potentials.linear import LinearPotential
    from fpsolve.model.potentials.power import PowerPotential
    from fpsolve.model.potentials.quadratic import QuadraticPotential

    if kind == "quadratic":
        return QuadraticPotential(sigma1, sigma1 if sigma2 is None else sigma2)
    if kind == "linear":
        return LinearPotential(slope)
    if kind == "power":
        return PowerPotential(exponent)
    if kind == "free":
        return FreePotential()
    raise ValueError(f"`--potential` must be one of {', '.join(KINDS)}, got {kind!r}.")


def potential_options(potential: Potential) -> dict[str, str | float]:
    """Return the options with which `make_potential` makes this one."""
    parameters = potential.to_dict()
    names = {"sigma1", "sigma2", "slope", "exponent"}
    own = {name: float(parameters[name]) for name in names & parameters.keys()}
    return {"potential": potential.kind, **dict(sorted(own.items()))}
