"""Every eigenvalue of a truncation to the right of a line: no branch may be lost."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array

from fpsolve._support.arrays import Complex
from fpsolve.model.fibre import FibreModel
from fpsolve.spectral.bases.choice import orbit_radius
from fpsolve.spectral.bases.sectors import Discretisation, Sector, Truncation
from fpsolve.spectral.eigen.constants import SAME, Constants
from fpsolve.spectral.eigen.eigenvalues import ShiftedInverse, neighbour
from fpsolve.spectral.work import Work

__all__ = ["Mode", "Scale", "leading", "order", "survey"]

# Eigenvalues around one shift; more give larger discs and cost more each.
N_NEAREST = 8
# Eigenvalues accumulate at the essential spectrum, in ever higher sectors; those nearer
# to it than this share are left out.
NEAR_ESSENTIAL = 1e-3
# Share taken of a distance to the spectrum that is known to one per cent.
EMPTY = 0.9
# Chords long enough to be content with an empty disc: in units of the frequency of the
# circular orbit; and, in a strip narrower than NARROW of these units, in units of the
# last chord that eigenvalues gave, which cost several times as much.
CHORD, NARROW, WORTH = 0.1, 0.02, 0.25
# By how much a disc must be wider than the strip to count.
CLEARLY = 1e-3
# Of the eigenvalues of a survey, relative to their distance from the shift.
TOLERANCE = 1e-8
# Modes up to this factor beyond the last one wanted are kept, so that a comparison of
# truncations sees the neighbours too.
MARGIN = 1.15


@dataclass(frozen=True, eq=False)
class Mode:
    """An eigenpair of one truncation: imaginary part >= 0 for its conjugate too.

    Attributes
    ----------
    eigenvalue : complex
    vector : ndarray
        Coefficients of the eigenfunction.
    sector, truncation
        Where the coefficients belong.
    partner : complex or None
        The nearest other eigenvalue, which may be the conjugate.
    change : float
        Distance to the eigenvalue of the truncation before.
    error : float
        That times how slowly it falls, plus `rounding`.
    rounding : float
        What rounding may have changed.
    residual : float
        ‖L f - λ f‖/‖f‖ in the next larger basis.
    """

    eigenvalue: complex
    vector: Complex
    sector: Sector
    truncation: Truncation
    partner: complex | None = None
    change: float = math.inf
    error: float = math.inf
    rounding: float = 0.0
    residual: float = math.inf

    @property
    def rate(self) -> float:
        """-Re λ."""
        return -self.eigenvalue.real

    @property
    def count(self) -> int:
        """1 for a real eigenvalue, 2 for a complex pair."""
        return 2 if self.eigenvalue.imag else 1

    def conjugate(self) -> Mode:
        """The other one of a complex pair."""
        return replace(
            self, eigenvalue=self.eigenvalue.conjugate(), vector=self.vector.conj()
        )


@dataclass(frozen=True)
class Scale:
    """What the search may assume.

    Attributes
    ----------
    frequency : float
        Angular frequency of the circular orbit: unit of the imaginary parts.
    rate : float
        A rate smaller than all that matter: distance of the shifts from the axis.
    limit : float
        Rates from here on are not looked for (essential spectrum), may be infinite.
    """

    frequency: float
    rate: float
    limit: float = math.inf

    @classmethod
    def of(cls, model: FibreModel, essential: float | None) -> Scale:
        """From the circular orbit, r B'(r) = 1, and both limits of the noise."""
        frequency = 1 / orbit_radius(model.potential)
        slow = min(0.5 * model.noise**2, (frequency / model.noise) ** 2)
        limit = math.inf if essential is None else (1 - NEAR_ESSENTIAL) * -essential
        return cls(frequency, slow, limit)


def survey(
    discretisation: Discretisation,
    truncation: Truncation,
    n: int,
    scale: Scale,
    sectors: tuple[Sector, ...] | None = None,
    work: Work | None = None,
) -> list[Mode]:
    """The n slowest modes of all sectors, and those up to 15 % faster.

    Sectors are searched in order, and the search ends after two successive sectors
    M > 1 without a mode that counts: the slowest rate of a sector grows with |M|. For
    large noise it is |M|/(A² σ²); for small noise the eigenfunction of ±M turns |M|
    times as often along an orbit, which diffusion smooths faster. In between this is
    measured, not proved: for the quadratic potential and |M| <= 8 the slowest rates
    increase from |M| = 1 on at A = 0.1, 0.3, 0.55, 0.8, 1, 1.6, 2.5 and 6, and windows
    of frequency four times as wide hold nothing slower. Complex pairs count twice, ±M
    once.
    """
    modes: list[Mode] = []
    silent = 0
    for sector in discretisation.sectors() if sectors is None else sectors:
        cut = cut_after(modes, n, scale.limit)
        found = Search(discretisation, sector, truncation, scale, work).run(n, cut)
        modes = slowest(modes + found, n, scale.limit)
        counts = not sector.M or sector.M < 2 or any(mode in modes for mode in found)
        silent = 0 if counts else silent + 1
        if silent == 2:
            break
    return modes


def nth_rate(modes: list[Mode], n: int, limit: float) -> float:
    """Rate of the n-th eigenvalue, or the limit when there are fewer."""
    rates = np.sort([mode.rate for mode in modes for _ in range(mode.count)])
    return min(float(rates[n - 1]), limit) if len(rates) >= n else limit


def cut_after(modes: list[Mode], n: int, limit: float) -> float:
    """A rate beyond the n-th: by 15 %, at most half the way to the limit."""
    nth = nth_rate(modes, n, limit)
    return min(MARGIN * nth, (nth + limit) / 2)


def leading(modes: list[Mode], n: int) -> list[Mode]:
    """The first modes that make n eigenvalues, pairs whole; or all there are."""
    counts = np.cumsum([mode.count for mode in modes])
    return modes[: 1 + int(np.searchsorted(counts, n))]


def slowest(modes: list[Mode], n: int, limit: float) -> list[Mode]:
    """The n slowest and those within the margin, slowest first."""
    last = cut_after(modes, n, limit)
    return sorted((mode for mode in modes if mode.rate <= last), key=order)


def order(mode: Mode) -> tuple[float, float]:
    """Rightmost first, then by frequency."""
    return mode.rate, mode.eigenvalue.imag


def furthest(cut: float, middle: float) -> float:
    """Distance of the strip 0 < rate < cut from a shift: that of its further edge."""
    return max(cut + middle, abs(middle))


def half_chord(radius: float, reach: float) -> float:
    """Half the length of the strip inside a disc, whose edges are at most `reach` away.

    That no branch is lost rests on this: the discs are empty but for what was found,
    and the chords of neighbours overlap or touch.
    """
    return math.sqrt(max(radius**2 - reach**2, 0.0))


class Search:
    """All eigenvalues of one sector with a rate below a cut, by overlapping discs.

    The n eigenvalues nearest to a shift fill a disc without others. Discs around shifts
    along the imaginary axis, each reaching into the one before, cover the strip 0 <
    rate < cut from frequency 0 up to |M| + 3 times that of the circular orbit, and
    beyond until a stretch of 1.5 such frequencies is empty. The matrix is real, so the
    lower half plane follows.
    """

    def __init__(
        self,
        discretisation: Discretisation,
        sector: Sector,
        truncation: Truncation,
        scale: Scale,
        work: Work | None = None,
    ) -> None:
        self.sector, self.truncation, self.scale = sector, truncation, scale
        self.work = work
        self.basis = discretisation
        self.matrix: csc_array = discretisation.matrix(sector, *truncation)
        self.constants = Constants(discretisation, sector, truncation, scale.rate)
        self.modes: list[Mode] = []
        self.chord = math.inf

    def run(self, n: int, cut: float) -> list[Mode]:
        """The modes up to the cut or, if that is less, a little beyond the n-th."""
        if self.matrix.shape[0] == 0:
            return []
        self.cut, self.n = cut, n
        chord = self.disc(0.0)
        covered, step = chord, chord
        while covered < self.last():
            chord = self.disc(covered + step)
            if chord >= step:
                covered, step = covered + step + chord, max(chord, 0.5 * step)
            else:
                step *= 0.6
        return slowest(self.modes, n, self.scale.limit) if self.modes else []

    def last(self) -> float:
        """Frequency up to which the strip must be covered."""
        counted = [mode for mode in self.modes if mode.rate <= self.cut]
        highest = max((mode.eigenvalue.imag for mode in counted), default=0.0)
        least = (self.sector.M or 0) + 3.0
        return max(least * self.scale.frequency, highest + 1.5 * self.scale.frequency)

    def disc(self, frequency: float) -> float:
        """Search around one shift; half the length of the strip that it covers."""
        # In the middle of the strip, once it is known how wide it is.
        middle = 0.1 * self.scale.rate if math.isinf(self.cut) else -self.cut / 2
        shift = complex(middle, frequency)
        inverse = ShiftedInverse(self.matrix, shift, self.work, self.basis.ordering)
        if math.isfinite(self.cut) and (frequency > 0 or not self.sector.has_constants):
            # Most of the axis is far from everything, which is seen at little cost.
            empty = EMPTY * inverse.distance()
            chord = half_chord(empty, furthest(self.cut, middle))
            if chord > self.long_enough(frequency):
                return chord
        return self.filled(inverse)

    def filled(self, inverse: ShiftedInverse) -> float:
        """As `disc`, with ever more of the eigenvalues until they reach across."""
        n_nearest = N_NEAREST
        while True:
            values, vectors = inverse.eigenpairs(n_nearest, tolerance=TOLERANCE)
            distance = np.abs(values - inverse.shift)
            # Nothing hides within the last of them, which may have a twin itself.
            whole = n_nearest >= self.matrix.shape[0]
            radius = math.inf if whole else (1 - SAME) * distance[-1]
            constant = self.constants.among(values, vectors, inverse.shift)
            self.add(values, vectors, (distance < radius) & ~constant)
            # With more modes known the strip may end earlier.
            self.cut = min(self.cut, cut_after(self.modes, self.n, self.scale.limit))
            if whole:
                return math.inf
            reach = furthest(self.cut, inverse.shift.real)
            if radius > reach * (1 + CLEARLY):
                self.chord = half_chord(radius, reach)
                return self.chord
            n_nearest *= 2

    def long_enough(self, frequency: float) -> float:
        """A chord that the nearest eigenvalues would not lengthen enough."""
        unit = self.scale.frequency
        usual = CHORD * min(unit, 3 * frequency)
        return min(usual, WORTH * self.chord) if self.cut < NARROW * unit else usual

    def add(self, values: Complex, vectors: Complex, inside: NDArray[np.bool_]) -> None:
        """Keep what is new; multiple eigenvalues of one disc stay multiple."""
        known = np.array([mode.eigenvalue for mode in self.modes], complex)
        tiny = SAME * (np.abs(values) + self.scale.rate)
        new = inside & (values.imag >= 0)
        if known.size:
            new &= np.abs(values[:, None] - known).min(axis=1) > tiny
        for i in np.flatnonzero(new):
            if self.basis.on_edge(vectors[:, i], self.sector, self.truncation):
                continue
            # -0.0 would print as a conjugate.
            value = complex(values[i].real, abs(values[i].imag))
            partner = neighbour(values, i)
            self.modes.append(
                Mode(value, vectors[:, i], self.sector, self.truncation, partner)
            )
