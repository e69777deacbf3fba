"""Reference curves γ(s): where the nozzle is, seen from the moving belt."""

from fpsolve.curves.belts import FixedBelt, MovingBelt
from fpsolve.curves.curve import Curve
from fpsolve.curves.dictionaries import curve_from_dict, curve_to_dict
from fpsolve.curves.nozzles import EllipticNozzle, OscillatingNozzle, RotatingNozzle
from fpsolve.curves.table import TabulatedCurve

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
