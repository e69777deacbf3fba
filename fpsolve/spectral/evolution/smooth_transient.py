"""Moments of smooth fibres over s, for quadratic B, by expansion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse as sparse

from fpsolve._support.arrays import Array
from fpsolve._support.memory import allowed_memory
from fpsolve.errors import MemoryLimitError
from fpsolve.model.persistence import Persistence
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.spectral.agreement import excess, failure
from fpsolve.spectral.evolution.circular_functions import (
    CircularFunctions,
    Scales,
    Truncation,
)
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.evolution.smooth_generator import backward_generator, by_parity
from fpsolve.spectral.evolution.smooth_observables import (
    SERIES,
    observables,
    series_of,
)
from fpsolve.spectral.evolution.smooth_solution import SmoothSpectralSolution
from fpsolve.spectral.evolution.smooth_start import check_law, expectations, scaled
from fpsolve.spectral.evolution.sparse_exponential import (
    SparseExponential,
    largest_eigenvalue,
)
from fpsolve.spectral.work import OutOfWork, Work

__all__ = ["TOLERANCE", "transient"]

TOLERANCE = 1e-6
# The first truncation, its growth, and how many there are at most.
DEGREE, RATIO, LEVELS = 20, 1.25, 11
# The last functions are damped DAMPING times as fast as truncation could let them
# grow, others by the power ORDER of their position: nothing that matters feels it.
# Where that is not enough, more of them are: the next order.
DAMPING, ORDERS = 2.0, (20, 10)
# The exponential may be wrong by this share of the tolerance, and rounding by this.
SHARE, ROUNDING = 1e-3, 1e-13
# Share of the largest change at an s in the error of every number there.
NEIGHBOURS = 0.5
# Bytes for every function: entries of the generator, of its halves, and vectors.
BYTES = 3000


def transient(
    model: SmoothLayDownModel,
    p0: Any,
    stops: Array,
    tolerance: float,
    memory_limit: int | None,
    work: Work,
) -> SmoothSpectralSolution:
    """Refine until two truncations agree; see `spectral_solve`."""
    check_law(p0)
    scales = scales_of(model, p0)
    budget = allowed_memory(memory_limit)
    result: SmoothSpectralSolution | None = None
    coarse: Array | None = None
    try:
        for number in range(LEVELS):
            truncation = truncation_of(model, number)
            required = int(BYTES * truncation.size)
            if not required <= budget:
                if number < 2:
                    raise MemoryLimitError(required, int(budget), "use `solve`")
                break
            functions = CircularFunctions(truncation, scales)
            fine = run(model, functions, p0, stops, tolerance, work)
            if coarse is not None:
                result = compared(model, functions, stops, (coarse, fine), tolerance)
                if excess(result) <= 1:
                    return result
            coarse = fine
    except OutOfWork:
        pass
    raise failure(result, model, work, tolerance)


def scales_of(model: SmoothLayDownModel, law: Any) -> Scales:
    """Weights as wide as the stationary density is, or the start.

    The law of ξ has tails that are longer than those of e^{−B} the longer R is, which
    a density that carries all of the weight does not follow.
    """
    length, spread, _ = numbers(model)
    diffusive = 0.4 * (Persistence.of(model).factor + length)
    widest = float(np.linalg.eigvalsh(scaled(law, model)[1])[-1])
    return Scales(
        plane=max(1.0 + 0.4 * min(length, 1.0), diffusive, widest / 1.5),
        curvature=model.curvature_variance * max(1.0, 0.2 / spread),
        plane_share=1.0 - 0.35 * length / (length + 0.1),
        curvature_share=1.0 - 0.25 / (1.0 + 0.5 * spread),
    )


def numbers(model: SmoothLayDownModel) -> tuple[float, float, float]:
    """R, K²R/2 and A²R/2 with σ, the harmonic mean of both, as the unit of length."""
    potential = quadratic(model)
    sigma = 2.0 / (1.0 / potential.sigma1 + 1.0 / potential.sigma2)
    length, spread = (
        model.relaxation_length / sigma, model.curvature_variance * sigma**2
    )  # fmt: skip
    return length, spread, spread * length**2


def truncation_of(model: SmoothLayDownModel, number: int) -> Truncation:
    """Truncation number `number`; sectors that are not coupled stay apart."""
    potential, (length, _, turns) = quadratic(model), numbers(model)
    degree = round(DEGREE * RATIO**number)
    share = 0.35 + 0.65 * length / (length + 0.1) + 0.15 * min(math.sqrt(turns), 4.0)
    apart = potential.sigma1 == potential.sigma2 and model.belt_speed == 0
    a, b = 1.0 / potential.sigma1, 1.0 / potential.sigma2
    mixing = 0.2 + 0.5 * abs(model.belt_speed) + 2.0 * abs(a - b) / (a + b)
    sectors = 0 if apart else round(min(mixing, 1.0) * degree)
    return Truncation(degree, max(4, round(share * degree)), sectors)


def run(
    model: SmoothLayDownModel,
    functions: CircularFunctions,
    law: Any,
    stops: Array,
    tolerance: float,
    work: Work,
) -> Array:
    """`SERIES` at every stop within one truncation; NaN where it is not stable."""
    generator = backward_generator(functions, model)
    start = expectations(functions, law, model)
    wanted = observables(functions)
    rows = np.zeros((stops.size, wanted.shape[0]), complex)
    # Expectations of a real density: real parts are even, imaginary parts odd.
    halves = zip(by_parity(functions), (1.0, 1j), (start.real, start.imag), strict=True)
    for columns, phase, part in halves:
        half = columns.T @ part
        if half.any():
            inner = (columns.T @ generator @ columns).tocsr()
            place = (columns.multiply(columns)).T @ positions(functions)
            found = stable_states(inner, place, half, stops, SHARE * tolerance, work)
            rows += phase * (found @ (wanted @ columns).T)
    potential = quadratic(model)
    return np.array(series_of(rows, (potential.sigma1, potential.sigma2)))


def positions(functions: CircularFunctions) -> Array:
    """From 0, inside the truncation, to 1 on its last functions."""
    return functions.truncation.position(*functions.indices)


def stable_states(
    generator: sparse.csr_array,
    place: Array,
    x: Array,
    stops: Array,
    tolerance: float,
    work: Work,
) -> Array:
    """States at every stop, with as much damping as it takes; NaN without success.

    Truncation leaves modes at its border that grow, since ∂_κ(κ p)/R narrows what no
    noise widens there. What bounds their growth in the norm sets the rate.
    """
    symmetric = (0.5 * (generator + generator.T)).tocsr()
    rate = DAMPING * max(largest_eigenvalue(symmetric), 0.0)
    for order in ORDERS:
        away = sparse.diags_array(rate * place**order)
        forward = SparseExponential((generator.T - away).tocsr())
        try:
            return states(forward, x, stops, tolerance, work)
        except ArithmeticError:
            continue
    return np.full((stops.size, x.size), np.nan)


def states(
    forward: SparseExponential, x: Array, stops: Array, tolerance: float, work: Work
) -> Array:
    """e^{sG} x at every stop; shape (n, size)."""
    found, reached = [], 0.0
    for stop in stops:
        if stop > reached:
            x = forward(x, stop - reached, tolerance, work)
        found.append(x)
        reached = stop
    return np.array(found)


def compared(
    model: SmoothLayDownModel,
    functions: CircularFunctions,
    stops: Array,
    runs: Sequence[Array],
    tolerance: float,
) -> SmoothSpectralSolution:
    """The finer run, with its change from the coarser one as estimate."""
    coarse, fine = runs
    # A moment that is not a number has no bound.
    change = np.nan_to_num(np.abs(fine - coarse), nan=np.inf, posinf=np.inf)
    size = np.maximum(1.0, np.nan_to_num(np.abs(fine)))
    # A number may stay as it is by chance, all at the same s do not.
    others = NEIGHBOURS * (change / size).max(axis=0)
    missing = np.nan_to_num(np.abs(fine[0] - 1.0), nan=np.inf) + ROUNDING
    errors = change + (others + missing) * size
    t = functions.truncation
    return SmoothSpectralSolution(
        model, stops, dict(zip(SERIES, fine, strict=True)),
        dict(zip(SERIES, errors, strict=True)),
        (t.degree, t.curvature, t.sectors), tolerance,
    )  # fmt: skip
