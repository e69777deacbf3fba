"""What the expansion of a smooth fibre's density leaves behind: its moments."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.labels import to_json
from fpsolve.evolution.call import Call
from fpsolve.evolution.evolution import WithSeries
from fpsolve.evolution.layout import Attribute, Columns, Layout, Variable
from fpsolve.evolution.saved import Saved
from fpsolve.evolution.series import long_name
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.evolution.layout import KnownModel
from fpsolve.spectral.evolution.smooth_observables import SERIES

__all__ = ["SmoothSpectralSolution"]


def words_of_error(name: str) -> str:
    """Long name of the error of a series."""
    return long_name(f"{name}_error")


LAYOUT = Layout(
    "Moments of the density of a smooth fibre by expansion in time",
    KnownModel(),
    Variable("s", ("s",), "arclength s", increasing=True),
    Columns("series", SERIES, ("s",), long_name),
    Columns("errors", SERIES, ("s",), words_of_error, "{}_error"),
    Attribute("truncation", write_as=to_json, read_as=tuple),
    Attribute("tolerance", read_as=float),
)


@dataclass(frozen=True, eq=False)
class SmoothSpectralSolution(WithSeries, Saved):
    """Moments of p(ξ, α, κ, s), with an error estimate for every number.

    Attributes `mass`, `mean_xi1`, `mean_xi2`, `variance_xi1`, `variance_xi2`,
    `covariance`, `mean_cos_alpha`, `mean_sin_alpha`, `mean_kappa`, `mean_kappa2` are
    the series, each of shape (n,) and dimensionless. There is no relative entropy: what
    is stationary has no closed form.

    Attributes
    ----------
    model : SmoothLayDownModel
    s : ndarray, shape (n,)
    series : dict of ndarray
    errors : dict of ndarray
        One estimate for each number of `series`: the change from the next coarser
        truncation, which bounds the error as long as refinement helps, plus what is
        missing of the mass.
    truncation : (int, int, int)
        Degree in ξ, degree in κ, and how far sectors go beyond those of the moments.
    tolerance : float
    call : Call or None
        How it was made.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "smooth-spectral"
    layout = LAYOUT

    model: SmoothLayDownModel
    s: Array
    series: dict[str, Array]
    errors: dict[str, Array]
    truncation: tuple[int, int, int]
    tolerance: float
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        worst = max(float(np.max(values)) for values in self.errors.values())
        degree, curvature, _ = self.truncation
        return (
            f"SmoothSpectralSolution(s = {self.s[0]:g} to {self.s[-1]:g} at "
            f"{self.s.size} places, degrees {degree} in ξ and {curvature} in κ, "
            f"largest error {worst:.1e})"
        )
