"""How a design of nozzles is stored: over its parameters, zones, and points."""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
)
from fpsolve.evolution.parts import Model
from fpsolve.web.pattern_layout import Phases

__all__ = ["NOZZLES"]

_PARAMETER, _ZONE = ("parameter",), ("zone",)
_POINT, _BOTH = ("point", "parameter"), ("point", "zone")


class _Names(Part):
    """The names of the free numbers, over their dimension."""

    needed = ("parameter",)

    def write(self, result: Any) -> Stored:
        return {"parameter": (_PARAMETER, np.array(result.names, dtype=object), {})}

    def read(self, source: Source) -> dict[str, Any]:
        named = source.dataset["parameter"]
        if named.dims != _PARAMETER:
            raise ValueError("`parameter` must be a row of names")
        return {"names": tuple(map(str, named.values))}


NOZZLES = Layout(
    "Design of moving nozzles",
    Model(),
    _Names(),
    Variable("spacing", (), "distance of neighbouring nozzles", kind=float),
    Phases(),
    Variable("lower", _PARAMETER, "lower bound"),
    Variable("upper", _PARAMETER, "upper bound"),
    Variable("range", ("end", "parameter"), "where the optimum may be", "ranges"),
    Variable("zone", _ZONE, "side of the zone", "zones"),
    Variable("pattern_cv", _ZONE, "CV of the mean pattern"),
    Variable("pattern_error", _ZONE, "error of it", "pattern_errors"),
    Variable("at", _POINT, "where patterns were computed", "points"),
    Variable("n_scanned", (), "patterns of the scan", kind=int),
    Variable("point_cv", _BOTH, "CV of the pattern at a point", "points_cv"),
    Variable("point_error", _BOTH, "error of it", "points_errors"),
    Variable("laid_pattern", _ZONE, "CV² that laid webs share"),
    Variable("laid_pattern_error", _ZONE, "standard error of it",
             "laid_pattern_errors"),
    Variable("laid", _ZONE, "CV² of laid webs"),
    Variable("laid_error", _ZONE, "standard error of it", "laid_errors"),
    Attribute("n_webs"),
)  # fmt: skip
