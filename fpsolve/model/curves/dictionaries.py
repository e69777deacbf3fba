"""Curves from the dictionaries they write."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve.model.curves.belts import FixedBelt, MovingBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.nozzles import (
    EllipticNozzle,
    OscillatingNozzle,
    RotatingNozzle,
)
from fpsolve.model.curves.samples import digest_of_curve
from fpsolve.model.curves.table import TabulatedCurve
from fpsolve.model.dictionaries import described, rebuilt

__all__ = ["KINDS", "curve_from_dict", "curve_to_dict"]

KINDS: dict[str, type[Curve]] = {
    curve.kind: curve
    for curve in (
        FixedBelt,
        MovingBelt,
        RotatingNozzle,
        OscillatingNozzle,
        EllipticNozzle,
        TabulatedCurve,
    )
}


def curve_to_dict(curve: Curve) -> dict[str, Any]:
    """Return a description that two curves share only if they are the same.

    That of fpsolve's own curves is what their `to_dict` says, which `curve_from_dict`
    reads. To that of a user's own class, whatever it says, a digest of positions and
    velocities is added (see `model.curves.samples`), and `curve_from_dict` refuses
    it.
    """
    return described(curve, KINDS, digest_of_curve)


def curve_from_dict(description: Mapping[str, Any]) -> Curve:
    """Return the curve that its `to_dict` described.

    Parameters
    ----------
    description : mapping
        "kind" and the parameters, for instance {"kind": "moving_belt", "speed": 0.1}.

    Raises
    ------
    ValueError
        If the kind is unknown, or a parameter does not exist or is missing; or if it
        was a class of a user's own, even one that inherits the kind of one of fpsolve.
    """
    return rebuilt("curve", description, KINDS)
