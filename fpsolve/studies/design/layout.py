"""How a design is stored: over its parameters, zones, iterates, and the front."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.labels import to_json
from fpsolve.evolution.layout import Attribute, Layout, Variable
from fpsolve.model.process import Process
from fpsolve.studies.design.settings import PARAMETERS
from fpsolve.studies.design.target import COSTS
from fpsolve.web.prediction import POSITIONS

__all__ = ["DESIGN"]

_PARAMETER, _ZONE, _BOTH = ("parameter",), ("zone",), ("parameter", "zone")
_ITERATE, _POINT = "iterate", "point"


def _one_of(name: str, known: Any) -> Any:
    def read(word: str) -> str:
        if word not in known:
            raise ValueError(f"`{name}` must be one of {tuple(known)}, got {word!r}")
        return word

    return read


DESIGN = Layout(
    "Design of a web",
    Attribute("equation", values=lambda design: design.process.model.equation),
    Attribute(
        "process",
        write_as=lambda process: to_json(process.to_dict()),
        read_as=lambda about: Process(**about),
    ),
    Variable("parameter", _PARAMETER,
             values=lambda _: np.array(PARAMETERS, dtype=object)),
    Variable("spacing", (), "distance of the spinning positions in m", kind=float),
    Attribute("titer"),
    Attribute("positions", read_as=_one_of("positions", POSITIONS)),
    Attribute("cost", read_as=_one_of("cost", COSTS)),
    Variable("value_error", _PARAMETER, "relative error of the optimal parameter",
             "value_errors"),
    Variable("lower", _PARAMETER, "lower bound; NaN of what is not free"),
    Variable("upper", _PARAMETER, "upper bound; NaN of what is not free"),
    Variable("lower_multiplier", _PARAMETER, "multiplier of the lower bound",
             "lower_multipliers"),
    Variable("upper_multiplier", _PARAMETER, "multiplier of the upper bound",
             "upper_multipliers"),
    Variable("zone", _ZONE, "side of the zone in m", "zones"),
    Variable("largest", _ZONE, "bound of CV; NaN where it is minimised"),
    Variable("target_multiplier", _ZONE, "multiplier of the bound of CV",
             "target_multipliers"),
    Variable("cv", _ZONE, "predicted CV of the zones"),
    Variable("cv_error", _ZONE, "error of CV", "errors"),
    Variable("sensitivity", _BOTH, "∂ log CV/∂ log θ", "sensitivities"),
    Variable("sensitivity_error", _BOTH, "error of it", "sensitivity_errors"),
    Variable("kkt_residual", (), "gradient that no bound balances", kind=float),
    Variable("history", (_ITERATE, "parameter"), "parameters of the iterates"),
    Variable("history_cv", (_ITERATE, "zone"), "CV of the iterates"),
    Variable("n_predictions", (), "predictions", kind=int),
    Variable("simulated", _ZONE, "CV of laid webs"),
    Variable("standard_error", _ZONE, "standard error of it", "standard_errors"),
    Attribute("n_webs"),
    Variable("front", (_POINT, "parameter"), "parameters along the front"),
    Variable("front_cv", (_POINT, "zone"), "CV along the front"),
    Variable("front_error", (_POINT, "zone"), "error of it", "front_errors"),
)  # fmt: skip
