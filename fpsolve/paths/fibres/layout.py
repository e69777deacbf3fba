"""How fibre curves are stored: points, one fibre after the other, and their curve."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from fpsolve._support.labels import labels, to_json
from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_counts,
    check_dimensions,
)
from fpsolve.evolution.parts import checked_step
from fpsolve.model.curves.dictionaries import curve_from_dict, curve_to_dict
from fpsolve.model.stored import is_of_a_user

__all__ = ["FIBRE_CURVE", "Points"]


@dataclass(frozen=True)
class Points(Part):
    """η of all fibres, one after the other, with numbers and first arclengths."""

    needed = ("eta", "lengths", "s_start")

    def write(self, result: Any) -> Stored:
        """Three variables, and what the components are."""
        words = "component, 1 along the belt and 2 across"
        return {
            "eta": (("point", "component"), result.eta, labels("points η of fibres")),
            "component": ("component", np.array([1, 2]), labels(words)),
            "lengths": ("fibre", result.lengths, labels("number of points of a fibre")),
            "s_start": ("fibre", result.s_start,
                        labels("arclength of the first point of a fibre")),
        }  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        """The three; ValueError unless the numbers are those of the points."""
        dataset = source.dataset
        check_dimensions(dataset, "eta", ("point", "component"))
        for name in ("lengths", "s_start"):
            check_dimensions(dataset, name, ("fibre",))
        lengths = dataset["lengths"].values
        check_counts("lengths", int(lengths.sum()), dataset.sizes["point"], "`eta`")
        return {name: dataset[name].values for name in self.needed}


class _Curve(Part):
    """The reference curve; None if it is unknown or a user's own."""

    def write(self, result: Any) -> Stored:
        curve = result.curve
        return {} if curve is None else {"curve": to_json(curve_to_dict(curve))}

    def read(self, source: Source) -> dict[str, Any]:
        about = source.about.get("curve")
        if about is None:
            return {"curve": None}
        try:
            return {"curve": curve_from_dict(about)}
        except ValueError as error:
            if not is_of_a_user("curve", about):
                raise
            warnings.warn(
                f"the curve could not be read back, so `curve` is None: {error}",
                UserWarning,
                stacklevel=6,
            )
            return {"curve": None}


FIBRE_CURVE = Layout(
    "Fibres on a belt",
    Attribute("Conventions", values=lambda _: "CF-1.11"),
    Points(),
    _Curve(),
    Attribute("ds", read_as=checked_step),
    Variable("position_error", (), "standard deviation of the points", kind=float),
    Variable("resampling_error", (), "error of interpolated points", kind=float),
)
