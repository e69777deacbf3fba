"""Potentials from the dictionaries they write."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve.model.dictionaries import described, rebuilt
from fpsolve.model.potentials.free import FreePotential
from fpsolve.model.potentials.linear import LinearPotential
from fpsolve.model.potentials.potential import Potential
from fpsolve.model.potentials.power import PowerPotential
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.potentials.samples import digest_of_potential
from fpsolve.model.potentials.user import CallablePotential

__all__ = ["KINDS", "potential_from_dict", "potential_to_dict"]

KINDS: dict[str, type[Potential]] = {
    potential.kind: potential
    for potential in (
        QuadraticPotential,
        LinearPotential,
        PowerPotential,
        FreePotential,
    )
}


def potential_to_dict(potential: Potential) -> dict[str, Any]:
    """Return a description that two potentials share only if they compute the same.

    That of fpsolve's own potentials is what their `to_dict` says, which
    `potential_from_dict` reads. To that of a user's own class, and of a user's
    functions, whatever it says, a digest of values and gradients is added (see
    `fpsolve.model.potentials.samples`), and `potential_from_dict` refuses it.
    """
    return described(potential, KINDS, digest_of_potential)


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
        if a parameter does not exist or is missing; or if it was a class of a user's
        own, even one that inherits the kind of one of fpsolve.
    """
    description = dict(description)
    if description.get("kind") == CallablePotential.kind:
        raise ValueError(
            f"`potential` must not be made of functions to be read back, got "
            f"{description.get('description', 'a callable')}; build it again in Python."
        )
    return rebuilt("potential", description, KINDS)
