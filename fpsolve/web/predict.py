"""The homogeneity of a web without simulating it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.blas import one_blas_thread
from fpsolve._support.checks import check_flag, check_one_of, check_positive, shown
from fpsolve.errors import ToleranceError
from fpsolve.evolution.call import recorded
from fpsolve.model.fibre import FibreModel
from fpsolve.model.process import Process
from fpsolve.spectral.evolution.quadratic import checked_tolerance
from fpsolve.spectral.resolvent.fibre import (
    Fibre,
    check_fibre,
    fibre_of,
    has_gradients,
)
from fpsolve.web import coherent
from fpsolve.web.band_power import band_power
from fpsolve.web.gradient import of_process, with_gradient
from fpsolve.web.prediction import POSITIONS, WebPrediction
from fpsolve.web.table import Axis, SpectrumTable
from fpsolve.web.zone_variance import zone_variance

__all__ = ["predict_web"]

# Zones in units of the throwing range: beyond, there are more periods of the window
# than nodes.
SMALLEST, LARGEST = 1e-4, 1e3
# Nodes of an axis, at most.
MOST_NODES = 65
N_STRIPS = 3
# Of the tolerance the part that the spectrum may take; the rest is left to its table.
SHARE = 0.5


@recorded()
@one_blas_thread()
def predict_web(
    model: FibreModel | Process,
    *,
    spacing: float,
    zones: ArrayLike,
    positions: str = "regular",
    bands: Sequence[tuple[float, float]] = (),
    tolerance: float = 5e-3,
    gradients: bool = False,
) -> WebPrediction:
    """CV² = v d ∫ Ŝ(k) sinc²(k1 x/2) sinc²(k2 x/2) d²k/(2π)² + coherent part.

    Ŝ is that of `web_spectrum`, from a table of a few hundred wave vectors: within
    |k_i| σ_i <= 2.5 a product of polynomials, beyond it polynomials of 1/|k| down to
    the law of the angle. The coherent part comes from the mean of every fibre: spinning
    positions that know nothing of each other add d ∫ |φ(0, k2)|² sinc²(k2 x/2) dk2/2π,
    φ the characteristic function of ξ, and regular ones 2 Σ |φ(0, 2πj/d)|²
    sinc²(πjx/d), the strips.

    With `gradients` the result has ∂CV/∂θ for every parameter θ, from adjoint solutions
    with the same factors: of A u = w and Ŝ = 2 Re E u the derivative is that of E and
    of A, ∂Ŝ = 2 Re (∂E u − λ ∂A u), Aᵀλ = E. The polynomials are kept while σ_i
    changes. Of a process the derivatives are those in its own numbers in SI units.

    Of smooth fibres Ŝ takes seconds to minutes, the more the longer R/σ and the smaller
    the noise, and derivatives, also in R, as much again or a little more.

    Parameters
    ----------
    model : LayDownModel, SmoothLayDownModel or Process
        With a `QuadraticPotential`, of the basic model also with an isotropic potential
        that is smooth in ‖ξ‖², and a belt at constant speed v ≠ 0. Of a process all
        lengths are metres.
    spacing : float
        Distance d of the spinning positions across the belt.
    zones : array_like
        Sides x of square zones, one or many, 1e-4 to 1000 of the larger throwing range,
        which for other potentials is the root mean square of ξ2 at rest.
    positions : {"regular", "random"}
        Whether the positions are at equal distances or anywhere.
    bands : sequence of pairs of float, optional
        Shortest and longest wavelength of bands for the `cloudiness`.
    tolerance : float
        For every CV, relative.
    gradients : bool
        Whether derivatives are computed, too, under a `QuadraticPotential`. They do not
        change the rest, and have the errors that they have: `tolerance` is for CV.

    Returns
    -------
    WebPrediction

    Raises
    ------
    ValueError
        As `web_spectrum`, or if the belt is at rest, a length is not positive, or
        `gradients` under another potential are asked for.
    ToleranceError
        If the spectrum is not known to the tolerance.

    References
    ----------
    [KMW09]_, section 4.2.
    """
    unit = model.length if isinstance(model, Process) else 1.0
    fibre: Any = model.model if isinstance(model, Process) else model
    check_fibre(fibre)
    gradients = check_flag("gradients", gradients)
    if gradients and not has_gradients(fibre):
        raise ValueError(
            "`gradients` are those of a model with a quadratic potential, got another "
            "one; compare predictions for two values of a parameter."
        )
    found = of_model(
        fibre, unit, check_positive("spacing", spacing), zones, positions,
        checked_bands(bands), checked_tolerance(tolerance), gradients,
    )  # fmt: skip
    return of_process(found) if isinstance(model, Process) else found


def of_model(
    model: FibreModel,
    unit: float,
    spacing: float,
    zones: ArrayLike,
    positions: str,
    pairs: Array,
    tolerance: float,
    gradients: bool = False,
) -> WebPrediction:
    """The prediction for a model whose unit of length is `unit`."""
    if not abs(model.curve.speed) > 0:
        raise ValueError(
            "`curve` must be a belt in motion, got one at rest; on it the fibre piles "
            "up and there is no web."
        )
    distance = spacing / unit
    check_one_of("positions", positions, POSITIONS)
    ladder = fibre_of(model)
    sides = checked_zones(zones, unit * max(ladder.scales))
    table, variances, errors = refined(ladder, sides / unit, tolerance, gradients)
    per_line = abs(model.curve.speed) * distance
    of_positions = getattr(coherent, f"{positions}_positions")
    added = np.array([of_positions(ladder, distance, float(x)) for x in sides / unit])
    squares = per_line * variances + added[:, 0]
    cv = np.sqrt(squares)
    powers = np.array(
        [band_power(table, *pair[::-1]) for pair in pairs / unit]
    ).reshape(-1, 2)
    lines = N_STRIPS if positions == "regular" else 0
    amplitudes, amplitude_errors = coherent.strips(ladder, distance, lines)
    tensor, tensor_errors = coherent.orientation(ladder)
    found = WebPrediction(
        model, spacing, unit, positions, sides, cv,
        0.5 * (per_line * errors + added[:, 1]) / cv,
        pairs[:, 0], pairs[:, 1],
        per_line * powers[:, 0], per_line * powers[:, 1],
        amplitudes, amplitude_errors, tensor, tensor_errors,
    )  # fmt: skip
    if not gradients:
        return found
    return with_gradient(found, table, (variances, errors))


def refined(
    ladder: Fibre, sides: Array, tolerance: float, gradients: bool = False
) -> tuple[SpectrumTable, Array, Array]:
    """A table fine enough for all zones, their variances and bounds of the errors."""
    # CV² is wrong by twice as much as CV.
    table = SpectrumTable.of(ladder, SHARE * 2 * tolerance, gradients)
    while True:
        found = [zone_variance(table, float(side)) for side in sides]
        values = np.array([value for value, _, _ in found])
        errors = np.array([sum(by.values()) + nodes for _, by, nodes in found])
        if (errors <= 2 * tolerance * values).all():
            return table, values, errors
        worst = int(np.argmax(errors / values))
        changes = found[worst][1]
        axis: Axis = max(changes, key=changes.__getitem__)
        if table.nodes[axis].n >= MOST_NODES:
            reached = float(0.5 * (errors / values)[worst])
            raise ToleranceError(reached, tolerance, "raise `tolerance`")
        table = table.finer(axis)


def checked_zones(zones: ArrayLike, wide: float) -> Array:
    """Sides as an array; ValueError unless they fit to the throwing range `wide`."""
    sides = np.atleast_1d(check_finite_numbers("zones", zones)).ravel()
    if not sides.size:
        raise ValueError("`zones` must name a side at least, got none.")
    wrong = ~((sides >= SMALLEST * wide) & (sides <= LARGEST * wide))
    if wrong.any():
        raise ValueError(
            f"`zones` must lie between {SMALLEST * wide:g} and {LARGEST * wide:g}, "
            f"{SMALLEST:g} and {LARGEST:g} throwing ranges, got {sides[wrong][0]:g}."
        )
    return sides


def checked_bands(bands: Any) -> Array:
    """Pairs as an array; ValueError unless shortest < longest, both positive."""
    pairs = check_finite_numbers("bands", bands)
    if pairs.size == 0:
        return np.zeros((0, 2))
    if (
        pairs.ndim != 2
        or pairs.shape[1] != 2
        or not ((pairs[:, 0] > 0) & (pairs[:, 1] > pairs[:, 0])).all()
    ):
        raise ValueError(
            "`bands` must be pairs of a shortest and a longer wavelength, both "
            f"positive, got {shown(bands)}."
        )
    return pairs
