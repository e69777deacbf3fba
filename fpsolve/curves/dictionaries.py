"""Curves from the dictionaries they write."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fpsolve._checks import construct
from fpsolve.curves.belts import FixedBelt, MovingBelt
from fpsolve.curves.curve import Curve
from fpsolve.curves.nozzles import EllipticNozzle, OscillatingNozzle, RotatingNozzle
from fpsolve.curves.table import TabulatedCurve

__all__ = ["KINDS", "curve_from_dict"]

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


def curve_from_dict(description: Mapping[str, Any]) -> Curve:
    """Return the curve that its `to_dict` described.

    Parameters
    ----------
    description : mapping
        "kind" and the parameters, for instance {"kind": "moving_belt", "speed": 0.1}.

    Raises
    ------
    ValueError
        If the kind is unknown, or a parameter does not exist or is missing.
    """
    parameters = dict(description)
    kind = parameters.pop("kind", None)
    if kind not in KINDS:
        known = ", ".join(repr(name) for name in KINDS)
        raise ValueError(f"`kind` of a curve must be one of {known}, got {kind!r}.")
    return construct(KINDS[kind], kind, parameters)
