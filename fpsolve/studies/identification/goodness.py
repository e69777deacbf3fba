"""Whether fibres of the identified model are like the one that was measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.estimate import Estimate
from fpsolve.studies.identification.increments import (
    Sample,
    Squares,
    samples_of,
    squares,
)
from fpsolve.studies.identification.surrogate import (
    LONGEST_REACH,
    N_FIBRES,
    Surrogate,
    model_of,
    whole_periods,
)

__all__ = ["N_SURROGATES", "TESTS", "Comparison", "compare_with_surrogate"]

# What is compared.
TESTS = (
    "angle increments", "curvature increments", "moments of xi", "law of xi1",
    "law of xi2", "law of alpha",
)  # fmt: skip
# Cells of equal probability of the laws of ξ, and waves of that of α.
N_CELLS, N_WAVES = 10, 4
# Surrogates, 64 a round: their smallest p-value is below 5 % of six tests.
N_ROUNDS = 2
N_SURROGATES = N_ROUNDS * N_FIBRES
# Points of surrogates that tell what a relative change of a parameter does.
N_POINTS, CHANGE = 3125, 0.15
# Part of surrogates outside of the bands on either side.
OUTSIDE = 0.025


@dataclass(frozen=True, eq=False)
class Comparison:
    """Data beside surrogates of the same size.

    Attributes
    ----------
    data : Squares
        Of the fibre.
    surrogates : Squares
        Of every surrogate.
    p_values : dict of float
        By the names in `TESTS`: share of surrogates that are as far from their mean
        as the data, with the data counted as one of them.
    """

    data: Squares
    surrogates: Squares
    p_values: dict[str, float]

    def bands(self, name: str) -> Array:
        """Data, mean, lower and upper 2.5 % of Γ, "angle" or "curvature"; (4, n)."""
        data = np.sqrt(getattr(self.data, name)[:, 0])
        drawn = np.sqrt(getattr(self.surrogates, name))
        low, high = np.quantile(drawn, [OUTSIDE, 1 - OUTSIDE], axis=1)
        return np.stack([data, drawn.mean(axis=1), low, high])


def compare_with_surrogate(
    fibre: FibreCurve, estimate: Estimate, lags: NDArray[np.int64], seed: int
) -> Comparison:
    """Hold increments, moments and laws of a fibre against surrogates of a model.

    The statistic is the sum of squared deviations from the mean of the surrogates in
    units of their standard deviations; its law is that of the surrogates themselves,
    which knows how the points of a fibre depend on each other, and of parameters drawn
    from the law of their errors, to first order: an error that the functional does not
    see may be plain in numbers that are better known than it. P-values of a true model
    are too large rather than too small: a small one is evidence.
    """
    model = estimate.model
    surrogate = Surrogate(fibre, seed)
    own = samples_of(fibre)
    data = squares(own, lags, fibre.ds)
    drawn, parts, edges = [], [], None
    for _ in range(N_ROUNDS):
        # One after the other, for a long fibre fills the memory.
        pieces = surrogate.pieces(model)
        edges = _cells(pieces) if edges is None else edges
        drawn.append(squares(pieces, lags, fibre.ds))
        parts.append(_numbers(drawn[-1], pieces, edges))
    assert edges is not None
    both = Squares(*(
        np.concatenate([getattr(one, name) for one in drawn], axis=1)
        for name in ("xi", "angle", "curvature")
    ))  # fmt: skip
    of_data = _numbers(data, own, edges)
    slopes = _slopes(surrogate, estimate, lags, edges)
    shifts = _shifts(estimate, both.xi.shape[1], seed)
    p_values = {}
    for name in TESTS:
        values = np.concatenate([one[name] for one in parts], axis=1)
        p_values[name] = _p_value(of_data[name][:, 0], values, slopes[name] @ shifts)
    return Comparison(data, both, p_values)


def _numbers(
    found: Squares, pieces: Sequence[Sample], edges: Array
) -> dict[str, Array]:
    """What is compared in every test, (n, m) each."""
    mean1, mean2, square1, square2, product = found.xi
    root1, root2 = np.sqrt(square1), np.sqrt(square2)
    moments = [mean1 / root1, mean2 / root2, np.log(root1), np.log(root2),
               product / (root1 * root2)]  # fmt: skip
    return {
        "angle increments": np.log(found.angle),
        "curvature increments": np.log(found.curvature),
        "moments of xi": np.stack(moments),
        "law of xi1": _shares(pieces, 0, edges[0]),
        "law of xi2": _shares(pieces, 1, edges[1]),
        "law of alpha": _waves(pieces),
    }


def _cells(pieces: Sequence[Sample]) -> Array:
    """Inner ends of cells that hold the same number of points of surrogates."""
    levels = np.arange(1, N_CELLS) / N_CELLS
    both = np.concatenate([one.xi.reshape(-1, 2)[::7] for one in pieces])
    return np.asarray(np.quantile(both, levels, axis=0).T)


def _shares(pieces: Sequence[Sample], axis: int, ends: Array) -> Array:
    """Shares of the points of every fibre in the cells, (n_cells, m)."""
    cell = np.searchsorted(ends, np.concatenate([one.xi[..., axis] for one in pieces]))
    counts = np.stack([np.count_nonzero(cell == k, axis=0) for k in range(N_CELLS)])
    return np.asarray(counts / counts.sum(axis=0))


def _waves(pieces: Sequence[Sample]) -> Array:
    """Means of cos kα and sin kα along every fibre, (2 n_waves, m)."""
    alpha = np.concatenate([one.alpha for one in pieces])
    wave = np.exp(1j * alpha)
    powers, rows = np.ones_like(wave), []
    for _ in range(N_WAVES):
        powers = powers * wave
        mean = powers.mean(axis=0)
        rows += [mean.real, mean.imag]
    return np.array(rows)


def _slopes(
    surrogate: Surrogate, estimate: Estimate, lags: NDArray[np.int64], edges: Array
) -> dict[str, Array]:
    """Derivatives of what is compared by the logarithms of the parameters."""
    fibre, columns = surrogate.fibre, []
    n = whole_periods(fibre, max(N_POINTS, LONGEST_REACH * int(lags[-1])))
    for name in estimate.parameters:
        ends = []
        for sign in (1, -1):
            changed = dict(estimate.parameters)
            changed[name] *= np.exp(sign * CHANGE)
            sample = surrogate.sample(model_of(changed, estimate.model.curve), n)
            numbers = _numbers(squares([sample], lags, fibre.ds), [sample], edges)
            ends.append({key: one.mean(axis=1) for key, one in numbers.items()})
        columns.append({key: (ends[0][key] - ends[1][key]) / (2 * CHANGE)
                        for key in TESTS})  # fmt: skip
    return {key: np.stack([one[key] for one in columns], axis=1) for key in TESTS}


def _shifts(estimate: Estimate, n: int, seed: int) -> Array:
    """Errors of the logarithms of the parameters, drawn from their law; (n_par, n)."""
    values = np.array(list(estimate.parameters.values()))
    relative = estimate.covariance / np.outer(values, values)
    # Of a parameter that is not determined the variance may be infinite.
    relative = np.nan_to_num(relative, nan=0.0, posinf=1.0, neginf=0.0)
    drawn = np.random.default_rng(seed).multivariate_normal(
        np.zeros(len(values)), relative, size=n, check_valid="ignore"
    )
    return np.asarray(np.clip(drawn.T, -1.0, 1.0))


def _p_value(data: Array, surrogates: Array, shifts: Array) -> float:
    # Errors of parameters are of both signs: the mean is that of the estimate.
    drawn = surrogates + shifts
    mean, spread = surrogates.mean(axis=1), drawn.std(axis=1, ddof=1)
    safe = np.where(spread > 0, spread, 1.0)
    far = np.sum(((drawn - mean[:, None]) / safe[:, None]) ** 2, axis=0)
    own = np.sum(((data - mean) / safe) ** 2)
    return float((1 + np.count_nonzero(far >= own)) / (1 + len(far)))
