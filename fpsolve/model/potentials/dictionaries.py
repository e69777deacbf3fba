"""Potentials from the dictionaries they write."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve._support.checks import construct
from fpsolve._support.digests import SAMPLED, plain
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
    if type(potential) in KINDS.values():
        return potential.to_dict()
    try:
        description = plain(potential.to_dict())
    # It is no dataclass.
    except TypeError:
        description = plain({"kind": potential.kind, "description": repr(potential)})
    return {**description, SAMPLED: digest_of_potential(potential)}


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
    parameters = dict(description)
    kind = parameters.pop("kind", None)
    if kind == CallablePotential.kind:
        raise ValueError(
            f"`potential` must not be made of functions to be read back, got "
            f"{parameters.get('description', 'a callable')}; build it again in Python."
        )
    if SAMPLED in parameters:
        raise ValueError(
            f"`potential` must not be of your own code to be read back, got {kind!r}; "
            "build it again in Python."
        )
    if not (isinstance(kind, str) and kind in KINDS):
        known = ", ".join(repr(name) for name in KINDS)
        raise ValueError(f"`kind` of a potential must be one of {known}, got {kind!r}.")
    return construct(KINDS[kind], kind, parameters)
