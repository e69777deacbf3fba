"""Predicted CV and its slopes in the logarithms of the parameters, each once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.errors import ToleranceError
from fpsolve.studies.design.settings import PARAMETERS, Settings
from fpsolve.studies.design.space import Space
from fpsolve.web.predict import predict_web

__all__ = ["At", "Predictions"]


@dataclass(frozen=True, eq=False)
class At:
    """What is predicted for one process.

    Attributes
    ----------
    cv, errors : ndarray
        Of the zones, with bounds of the errors.
    slopes, slope_errors : ndarray, shape (parameter, zone)
        ∂ log CV/∂ log θ over all `PARAMETERS`, the others unchanged.
    """

    cv: Array
    errors: Array
    slopes: Array
    slope_errors: Array


@dataclass(eq=False)
class Predictions:
    """Predictions at the points of a space.

    Attributes
    ----------
    space : Space
    zones : ndarray
    positions : {"regular", "random"}
    tolerance : float
    """

    space: Space
    zones: Array
    positions: str
    tolerance: float
    _known: dict[bytes, At] = field(default_factory=dict)

    @property
    def n(self) -> int:
        """How many there were."""
        return len(self._known)

    def __call__(self, y: Array) -> At:
        """At a point, which need not keep the base weight."""
        key = y.tobytes()
        if key not in self._known:
            try:
                self._known[key] = self._predicted(self.space.settings(y))
            except ToleranceError as error:
                raise self._unpredicted(error, y) from None
        return self._known[key]

    def _unpredicted(self, error: ToleranceError, y: Array) -> ToleranceError:
        """The error of a prediction with the point to which a search came."""
        values = zip(self.space.names, np.exp(y), strict=True)
        place = ", ".join(f"{name} = {value:.4g}" for name, value in values)
        remedy = f"{error.remedy}; keep the search away from {place} by `bounds`"
        return ToleranceError(error.reached, error.tolerance, remedy)

    def _predicted(self, settings: Settings) -> At:
        found: Any = predict_web(
            settings.process, spacing=settings.spacing, zones=self.zones,
            positions=self.positions, tolerance=self.tolerance, gradients=True,
        )  # fmt: skip
        slopes, errors = np.zeros((2, len(PARAMETERS), self.zones.size))
        of = [PARAMETERS.index(name) for name in found.parameters]
        # ∂ log CV/∂ log θ = θ/CV ∂CV/∂θ; the belt speed has a sign, which cancels.
        values = settings.values[of, None]
        signs = np.array([
            np.sign(settings.process.speed_ratio) if name == "speed_ratio" else 1.0
            for name in found.parameters
        ])  # fmt: skip
        slopes[of] = signs[:, None] * values * found.gradient / found.cv
        share = found.errors / found.cv
        errors[of] = (
            values * found.gradient_errors / found.cv + np.abs(slopes[of]) * share
        )
        return At(found.cv, found.errors, slopes, errors)
