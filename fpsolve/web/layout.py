"""How a web is stored: pixels, what determines its fibres, what was measured on it."""

from __future__ import annotations

from dataclasses import asdict
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
from fpsolve.evolution.parts import Model, checked_step
from fpsolve.model.process import Process
from fpsolve.web.margins import Margins
from fpsolve.web.plan import Plan, ensemble_of
from fpsolve.web.window import Window

__all__ = ["WEB", "pixel_labels"]

_PIXELS = ("cross", "machine")


class _Determined(Part):
    """Window, fibres and margins, in units of the throwing range."""

    needed = ("web", "seed", "ds", "n_steps", "position", "phase")

    def write(self, result: Any) -> Stored:
        plan = result.plan
        ensemble, margins = plan.ensemble, plan.margins
        about = {
            **asdict(margins),
            "window": asdict(plan.window),
            "periodic": plan.periodic,
            "origin": plan.origin,
            "spacing": plan.spacing,
            "speed": plan.speed,
        }
        return {
            "position": ("fibre", plan.places,
                         labels("place across the belt in throwing ranges")),
            "phase": ("fibre", plan.phases, labels("phase of the nozzle in radians")),
            "web": to_json(about),
            # As text, because a seed may be longer than any integer of a file.
            "seed": str(ensemble.seed),
            "ds": ensemble.schedule.ds,
            "n_steps": ensemble.schedule.n_steps,
        }  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        about, told = source.about, dict(source.about["web"])
        window = Window.of(**told.pop("window"))
        plan = {name: told.pop(name) for name in ("periodic", "origin", "spacing",
                                                  "speed")}  # fmt: skip
        (low1, high1), (low2, high2) = told.pop("reach")
        margins = Margins(**told, reach=((low1, high1), (low2, high2)))
        places, phases = (_fibres(source, name) for name in ("position", "phase"))
        check_counts("phase", phases.shape, places.shape, "`position`")
        ensemble = ensemble_of(
            source.fields.pop("model"), places.size, checked_step(about["ds"]),
            about["n_steps"], int(about["seed"]),
        )  # fmt: skip
        made = Plan(
            ensemble=ensemble, window=window, places=places, phases=phases,
            margins=margins, **plan,
        )  # fmt: skip
        return {"plan": made}


class _Pixels(Part):
    """Length density and orientation over the centres of the pixels."""

    needed = ("length_density", "orientation_11", "orientation_12", *_PIXELS)

    def write(self, result: Any) -> Stored:
        stored: Stored = {
            name: (_PIXELS, getattr(result, name), about)
            for name, about in pixel_labels(result).items()
        }
        where = {"cross": "across the belt", "machine": "along the belt"}
        for name, text in where.items():
            about = labels(f"{text} in {result.unit or 'throwing ranges'}")
            stored[name] = (name, getattr(result, name), about)
        return stored

    def read(self, source: Source) -> dict[str, Any]:
        dataset, shape = source.dataset, source.fields["plan"].window.shape
        fields = {}
        for name in self.needed[:3]:
            check_dimensions(dataset, name, _PIXELS)
            check_counts("window", shape, dataset[name].shape, f"`{name}`")
            fields[name] = dataset[name].values
        return fields


def pixel_labels(result: Any) -> dict[str, dict[str, str]]:
    """Labels of what is known of every pixel, by the name of its variable."""
    unit = result.unit or "throwing ranges"
    found = {
        "length_density": labels(f"laid length of fibre per area in 1/({unit})"),
        "orientation_11": labels("mean of τ₁τ₁, 1 along the belt"),
        "orientation_12": labels("mean of τ₁τ₂, 2 across the belt"),
    }
    if result.titer is not None:
        found["mass_density"] = {**labels("mass per area"), "units": "g m-2"}
    return found


def _fibres(source: Source, name: str) -> Any:
    check_dimensions(source.dataset, name, ("fibre",))
    return np.asarray(source.dataset[name].values)


WEB = Layout(
    "Web of fibres laid on a belt",
    Attribute("Conventions", values=lambda _: "CF-1.11"),
    Model(equation="process_equation"),
    _Determined(),
    Attribute(
        "process", optional=True,
        write_as=lambda process: to_json(process.to_dict()),
        read_as=lambda about: Process(**about),
    ),
    Attribute("titer", optional=True),
    _Pixels(),
    Variable("laid_length", (), "laid length of all fibres", kind=float),
    Variable("outside_length", (), "laid length outside of the window", kind=float),
    Variable("margin_error", (), "share that may be beyond the margins", kind=float),
)  # fmt: skip
