"""Potentials from the dictionaries they write."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve._checks import construct
from fpsolve.potentials.free import FreePotential
from fpsolve.potentials.linear import LinearPotential
from fpsolve.potentials.potential import Potential
from fpsolve.potentials.power import PowerPotential
from fpsolve.potentials.quadratic import QuadraticPotential
from fpsolve.potentials.user import CallablePotential

__all__ = ["KINDS", "potential_from_dict"]

KINDS: dict[str, type[Potential]] = {
    potential.kind: potential
    for potential in (
        QuadraticPotential,
        LinearPotential,
        PowerPotential,
        FreePotential,
    )
}


def potential_from_dict(description: Mapping[str, Any]) -> Potential:
    """Return the potential that its `to_dict` described.

    Parameters
    ----------
    description : mapping
        "kind" and the parameters, for instance {"kind": "quadratic", "sigma1": 1.0}.

    Raises
    ------
    ValueError
        If the kind is unknown or made of functions, which no dictionary can hold, or
        if a parameter does not exist or is missing.
    """
    parameters = dict(description)
    kind = parameters.pop("kind", None)
    if kind == CallablePotential.kind:
        raise ValueError(
            f"`potential` must not be made of functions to be read back, got "
            f"{parameters.get('description', 'a callable')}; build it again in Python."
        )
    if kind not in KINDS:
        known = ", ".join(repr(name) for name in KINDS)
        raise ValueError(f"`kind` of a potential must be one of {known}, got {kind!r}.")
    return construct(KINDS[kind], kind, parameters)
