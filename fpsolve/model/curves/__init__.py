"""Reference curves γ(s): where the nozzle is, seen from the moving belt."""

from fpsolve.model.curves.belts import FixedBelt, MovingBelt
from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.dictionaries import curve_from_dict, curve_to_dict
from fpsolve.model.curves.nozzles import (
    EllipticNozzle,
    OscillatingNozzle,
    RotatingNozzle,
)
from fpsolve.model.curves.table import TabulatedCurve

__all__ = [
    "Curve",
    "EllipticNozzle",
    "FixedBelt",
    "MovingBelt",
    "OscillatingNozzle",
    "RotatingNozzle",
    "TabulatedCurve",
    "curve_from_dict",
    "curve_to_dict",
]
