"""Stationary densities on a belt for isotropic quadratic B, between sectors.

A belt adds v x†/σ to L*, x† = (a† + b†)/√2: it couples the sectors M of the angular
index to M ± 1. The sectors alone are factorised, and GMRES does the rest. The density
is even under the reflection (ξ2, α) → −(ξ2, α), so that all coefficients are real, and
those of −M the mirror image of those of M.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.sparse import coo_array, csc_array

from fpsolve._support.arrays import Array, Complex
from fpsolve.model.laydown import LayDownModel
from fpsolve.spectral.bases.hermite import HermiteDiscretisation
from fpsolve.spectral.bases.sectors import Integers, Sector, Truncation
from fpsolve.spectral.bases.states import Part, States
from fpsolve.spectral.coupled_inverse import CoupledInverse
from fpsolve.spectral.evolution.expansion import Expansion
from fpsolve.spectral.evolution.quadratic import quadratic
from fpsolve.spectral.evolution.sector_start import turned_back

__all__ = ["SectorsOnBelt", "memory_of"]

# Harmonics and sectors of a truncation, at least and per degree, and what the last
# sector keeps of its degrees and harmonics.
FEWEST_HARMONICS, ASPECT = 16, 0.36
FEWEST_SECTORS, SECTORS = 16, 1 / 12
LAST_DEGREE, LAST_HARMONIC = 0.4, 0.7
# Bytes for every unknown: the vectors of GMRES, factors and matrices; measured 2400.
PER_UNKNOWN = 2700


def truncations(degree: int) -> list[Truncation]:
    """Degree and harmonics of every sector M = 0, 1, …, fewer the larger M."""
    harmonics = max(FEWEST_HARMONICS, round(ASPECT * degree))
    last = max(FEWEST_SECTORS, round(SECTORS * degree))
    shares = np.arange(last + 1) / last
    return [
        Truncation(
            round(degree * (1 - (1 - LAST_DEGREE) * share)),
            round(harmonics * (1 - (1 - LAST_HARMONIC) * share)),
        )
        for share in shares
    ]


def sector_of(index: int) -> Sector:
    """M; of M = 0 the functions that are even under the reflection."""
    return Sector(0, 1) if index == 0 else Sector(index)


def memory_of(degree: int) -> int:
    """Bytes of a solution, and of two expansions as large."""
    all_states = (
        HermiteDiscretisation(1.0, 1.0).size(sector_of(index), one)
        for index, one in enumerate(truncations(degree))
    )
    harmonics = max(FEWEST_HARMONICS, round(ASPECT * degree))
    cube = (degree + 2) ** 2 * (2 * harmonics + 4) * 8
    return PER_UNKNOWN * sum(all_states) + 2 * cube


class SectorsOnBelt:
    """L* of a belt in one truncation, on functions that the reflection keeps.

    Parameters
    ----------
    model : LayDownModel
        With an isotropic QuadraticPotential.
    degree : int
    """

    def __init__(self, model: LayDownModel, degree: int) -> None:
        self.degree = degree
        sigma = quadratic(model).sigma1
        # v/(√2 σ), of a† and of b†.
        self.belt = model.belt_speed / (math.sqrt(2.0) * sigma)
        self.discretisation = HermiteDiscretisation(sigma, model.noise)
        self.truncations = truncations(degree)
        self.states: list[States] = [
            self.discretisation.states(sector_of(index), one)
            for index, one in enumerate(self.truncations)
        ]
        sizes = [one.k.size for one in self.states]
        self.offsets = np.concatenate([[0], np.cumsum(sizes)])

    def stationary(self) -> Expansion:
        """The null vector, its constant coefficient one.

        Raises
        ------
        ToleranceError
            If GMRES does not converge.
        """
        matrix = self.matrix()
        first = self.states[0]
        constant = int(np.flatnonzero((first.k == 0) & (first.m == 0))[0])
        others = np.delete(np.arange(matrix.shape[0]), constant)
        right = -matrix[:, [constant]].toarray()[others, 0]
        offsets = np.concatenate([[0], self.offsets[1:] - 1])
        inverse = CoupledInverse(csc_array(matrix[others][:, others]), offsets)
        solution = np.ones(matrix.shape[0])
        solution[others] = inverse.solve(right)
        return turned_back(self.circles(solution))

    def matrix(self) -> csc_array:
        """L*, sector behind sector."""
        parts = [
            part for index in range(len(self.states)) for part in self.parts(index)
        ]
        rows, columns, entries = map(np.concatenate, zip(*parts, strict=True))
        size = int(self.offsets[-1])
        return csc_array(coo_array((entries, (rows, columns)), shape=(size, size)))

    def parts(self, index: int) -> Iterator[Part]:
        """Rows, columns and entries of what a sector is taken to.

        Of M = 0 the states are √2 Re of a wave for k > 0; its waves k < 0, the mirror
        images, are raised to M = 1 as well, and reached from there.
        """
        sector, states = sector_of(index), self.states[index]
        own = self.discretisation.matrix(sector, *self.truncations[index]).T.tocoo()
        offset = self.offsets[index]
        yield own.row + offset, own.col + offset, own.data
        k, a, b = states.k, states.m, states.n
        raised_a, raised_b = self.belt * np.sqrt(a + 1.0), self.belt * np.sqrt(b + 1.0)
        half = math.sqrt(0.5)
        if index == 0:
            share = np.where(k == 0, 1.0, half)
            yield self.raised(0, 1, (k, a + 1, b), share * raised_a)
            mirrored = np.where(k == 0, 0.0, half * raised_b)
            yield self.raised(0, 1, (-k, b + 1, a), mirrored)
            return
        if index + 1 < len(self.states):
            yield self.raised(index, index + 1, (k, a + 1, b), raised_a)
        if index > 1:
            yield self.raised(index, index - 1, (k, a, b + 1), raised_b)
            return
        turned = np.where(k < 0, b + 1, a), np.where(k < 0, a, b + 1)
        share = np.where(k == 0, 2.0, math.sqrt(2.0))
        yield self.raised(1, 0, (np.abs(k), *turned), share * raised_b)

    def raised(
        self,
        source: int,
        target: int,
        place: tuple[Integers, Integers, Integers],
        entries: Array,
    ) -> Part:
        """What is inside the target of a move of all states of the source."""
        states, (k, a, b) = self.states[target], place
        inside = (k >= states.first) & (k <= states.last)
        inside &= (a + b <= states.degree) & (entries != 0)
        rows = states.position(k[inside], a[inside], b[inside])
        columns = np.flatnonzero(inside)
        return (
            rows + self.offsets[target],
            columns + self.offsets[source],
            entries[inside],
        )

    def circles(self, solution: Array) -> Complex:
        """c[a, b, k] of a solution, k ≥ 0, by the mirror images for M < 0."""
        harmonics = max(one.harmonics for one in self.truncations)
        result = np.zeros((self.degree + 1, self.degree + 1, harmonics + 1), complex)
        for index, states in enumerate(self.states):
            part = solution[self.offsets[index] : self.offsets[index + 1]]
            k, a, b = states.k, states.m, states.n
            if index == 0:
                result[a, b, k] = np.where(k == 0, 1.0, math.sqrt(0.5)) * part
                continue
            up, down = k >= 0, k <= 0
            result[a[up], b[up], k[up]] = part[up]
            result[b[down], a[down], -k[down]] = part[down]
        return result
