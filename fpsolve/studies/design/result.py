"""A web as it was designed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.model.process import Process
from fpsolve.studies.design.layout import DESIGN
from fpsolve.studies.design.settings import PARAMETERS, Settings

__all__ = ["WebDesign"]


@dataclass(frozen=True, eq=False)
class WebDesign(Saved):
    """The optimum of a web at fixed base weight: its process, its CV, their errors.

    SI units. Arrays over parameters have the order of `parameters`: noise, sigma1,
    sigma2, speed_ratio, spacing, titer, relaxation_length, which is 0 of basic fibres.

    Attributes
    ----------
    process : Process
        The optimal one.
    spacing : float
        Distance of the spinning positions in metres.
    titer : float
        Mass of the fibre in g/m.
    positions : {"regular", "random"}
    cost : str
        What a bound of CV was met at the least of; says nothing where none was given.
    value_errors : ndarray
        Relative errors of the optimal parameters, to first order in the errors of CV
        and its slopes; 0 of what is not free or held by its bounds, infinite of what CV
        does not tell.
    lower, upper : ndarray
        Bounds, 0 and infinity of a spacing without them; NaN of what is not free.
    lower_multipliers, upper_multipliers : ndarray
        What the logarithm of the objective gains per logarithm that a bound gives way;
        0 of bounds that are not active.
    zones : ndarray
        Sides of square zones in metres.
    largest : ndarray
        Bounds of CV; NaN where the mean of log CV was minimised.
    target_multipliers : ndarray
        Of these bounds.
    cv, errors : ndarray
        Predicted CV, and bounds of its errors.
    sensitivities, sensitivity_errors : ndarray, shape (parameter, zone)
        ∂ log CV/∂ log θ, the other parameters unchanged: per cent of CV per per cent.
    kkt_residual : float
        What no active bound balances of the gradient, per logarithm of a parameter.
    history, history_cv : ndarray, shape (iterate, parameter), (iterate, zone)
        Start, iterates and optimum of the search.
    n_predictions : int
        All there were, of errors and of the front too.
    simulated, standard_errors : ndarray
        CV of laid webs, and its standard errors from their spread; NaN without webs.
    n_webs : int
        Laid for every zone.
    front, front_cv, front_errors : ndarray, over (point, …)
        The most even webs at several throughputs: parameters, CV and bounds of errors.
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "web-design"
    layout = DESIGN

    process: Process
    spacing: float
    titer: float
    positions: str
    cost: str
    value_errors: Array = field(repr=False)
    lower: Array = field(repr=False)
    upper: Array = field(repr=False)
    lower_multipliers: Array = field(repr=False)
    upper_multipliers: Array = field(repr=False)
    zones: Array
    largest: Array
    target_multipliers: Array = field(repr=False)
    cv: Array
    errors: Array
    sensitivities: Array = field(repr=False)
    sensitivity_errors: Array = field(repr=False)
    kkt_residual: float
    history: Array = field(repr=False)
    history_cv: Array = field(repr=False)
    n_predictions: int
    simulated: Array
    standard_errors: Array
    n_webs: int
    front: Array = field(repr=False)
    front_cv: Array = field(repr=False)
    front_errors: Array = field(repr=False)
    call: Call | None = field(default=None, repr=False)
    provenance: dict[str, Any] = field(default_factory=dict, repr=False)

    parameters: ClassVar[tuple[str, ...]] = PARAMETERS

    @property
    def settings(self) -> Settings:
        """Process, spacing and titer together."""
        return Settings(self.process, self.spacing, self.titer)

    @property
    def values(self) -> Array:
        """The parameters at the optimum."""
        return self.settings.values

    @property
    def free(self) -> tuple[str, ...]:
        """Those that were free."""
        named = zip(PARAMETERS, np.isfinite(self.lower), strict=True)
        return tuple(name for name, one in named if one)

    @property
    def base_weight(self) -> float:
        """titer/(v d) in g/m², that of the start."""
        return self.settings.base_weight

    @property
    def throughput(self) -> float:
        """Base weight times belt speed, in kg/h per metre of width."""
        return self.settings.throughput

    @property
    def front_throughput(self) -> Array:
        """Of the points of the front."""
        return self._throughput(self.front)

    @property
    def history_throughput(self) -> Array:
        """Of the iterates."""
        return self._throughput(self.history)

    @property
    def bounded(self) -> bool:
        """Whether CV was bounded, and not minimised."""
        return bool(np.isfinite(self.largest).all())

    @property
    def active(self) -> tuple[str, ...]:
        """What holds the optimum: "noise at its upper bound", "CV at 0.01 m"."""
        words = [
            f"{name} at its {side} bound"
            for name, *both in zip(
                PARAMETERS, self.lower_multipliers, self.upper_multipliers, strict=True
            )
            for side, number in zip(("lower", "upper"), both, strict=True)
            if number > 0
        ]
        of_targets = zip(self.zones, self.target_multipliers, strict=True)
        return (*words, *(f"CV at {zone:g} m" for zone, one in of_targets if one > 0))

    @property
    def z(self) -> Array:
        """Difference of both CV² over its error: simulated less predicted.

        Where the prediction is exact it has nearly Student's distribution with
        `n_webs` − 1 degrees of freedom.
        """
        both = np.hypot(self.simulated * self.standard_errors, self.cv * self.errors)
        return np.asarray((self.simulated**2 - self.cv**2) / (2 * both))

    def __repr__(self) -> str:
        told = ", ".join(
            f"{cv:.4g} ± {error:.1g} at {zone:g} m"
            for zone, cv, error in zip(self.zones, self.cv, self.errors, strict=True)
        )
        free = ", ".join(
            f"{name} {value:.4g}"
            for name, value in zip(PARAMETERS, self.values, strict=True)
            if name in self.free
        )
        return f"WebDesign({free}: CV {told}, {self.throughput:.4g} kg/(h m))"

    def _throughput(self, rows: Array) -> Array:
        """At this base weight; it goes with the belt speed."""
        speeds = rows[:, PARAMETERS.index("speed_ratio")]
        return np.asarray(self.throughput * speeds / abs(self.process.speed_ratio))
