"""The noise with the fastest convergence."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from fpsolve._support.arrays import Array
from fpsolve._support.blas import one_blas_thread
from fpsolve.errors import ToleranceError
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.spectral.bases.choice import discretisation_for, orbit_radius
from fpsolve.spectral.bases.sectors import Sector
from fpsolve.spectral.eigen.branches import Branch, PairBranch
from fpsolve.spectral.eigen.gap import SpectralGap, spectral_gap
from fpsolve.spectral.eigen.settings import check_tolerance, essential_of
from fpsolve.spectral.eigen.survey import Scale, survey

__all__ = ["OptimalNoise", "optimal_noise"]

# Noises of the first scan, in units of the one for which the circular orbit has
# radius 1: the maximum of all potentials tried lies well inside.
SCAN = np.geomspace(0.4, 4.0, 8)
# Relative width of the bracket in which the branches are told apart.
BRACKET = 1e-3
# Accuracy of the gaps at its ends.
ROUGH = 1e-4
# Levels of truncation tried for the noise itself.
LEVELS = range(1, 9)
# Rounding of noise and gap, relative.
ROUNDING = 1e-14


@dataclass(frozen=True)
class OptimalNoise:
    """Where the spectral gap is largest.

    Attributes
    ----------
    noise, gap : float
        The maximising A and the gap there.
    noise_error, gap_error : float
        Change between the last two truncations, plus rounding.
    kind : str
        What makes the maximum. "double eigenvalue": a complex pair merges on the real
        axis, the gap has a vertical tangent on one side and convergence is
        (1 + s) exp(-gap s). "crossing": two branches cross, the gap has a corner.
        "smooth maximum": of one branch.
    sectors : tuple of (Sector or None)
        Of the branches that meet; None stands for the essential spectrum.
    """

    noise: float
    gap: float
    noise_error: float
    gap_error: float
    kind: str
    sectors: tuple[Sector | None, ...]


@one_blas_thread()
def optimal_noise(potential: Potential, *, tolerance: float = 1e-8) -> OptimalNoise:
    """The noise A that maximises the spectral gap, and the gap there, on a fixed belt.

    The gap is located on a scan of A and by golden section, then the branches on both
    sides tell what makes the maximum, and the equation that defines it is solved in
    growing truncations: δ(A) = 0 for a double eigenvalue m ± √δ, in terms of the
    discriminant δ, which unlike the eigenvalues is analytic there; equal rates for a
    crossing; a vanishing derivative for a smooth maximum. The scan assumes one maximum
    between 0.4 and 4 in units of 1/√r, r the radius of the circular orbit.

    Scaling: for B(ξ/σ) the noise is divided by √σ and the gap by σ.

    Parameters
    ----------
    potential : Potential
        Quadratic or linear; other isotropic ones as for `spectrum`.
    tolerance : float
        Largest relative error of noise and gap, at least 1e-13.

    Raises
    ------
    TypeError
        If `potential` is not a Potential.
    ValueError
        If there is no gap or no basis, see `spectrum`, or no maximum in the scan.
    ToleranceError
        If the truncations tried do not reach the tolerance.

    References
    ----------
    The question is that of [KMW09]_, section 3.1.1 and theorem 3.3.
    """
    tolerance = check_tolerance(tolerance)
    meeting = Meeting.near(potential, *located(potential))
    before = meeting.solve(LEVELS[0])
    for level in LEVELS[1:]:
        found = meeting.solve(level)
        change = np.abs(np.subtract(found, before))
        reached = float(np.max(change / found))
        if reached <= tolerance:
            noise_error, gap_error = change + ROUNDING * np.array(found)
            return OptimalNoise(
                *found,
                float(noise_error),
                float(gap_error),
                meeting.kind,
                meeting.sectors,
            )
        before = found
    raise ToleranceError(reached, tolerance, "enlarge `tolerance`")


def located(potential: Potential) -> tuple[float, float]:
    """A bracket of the maximum, of relative width BRACKET."""

    def gap(noise: float) -> float:
        return rough_gap(potential, noise)

    # Checks the potential before its length scale is asked for.
    discretisation_for(LayDownModel(potential, 1.0))
    noises = SCAN / math.sqrt(orbit_radius(potential))
    best = int(np.argmax([gap(noise) for noise in noises]))
    if best in (0, len(noises) - 1):
        raise ValueError(
            f"`potential` must have its best noise between {noises[0]:.3g} and "
            f"{noises[-1]:.3g}, got the largest gap at {noises[best]:.3g} for "
            f"{potential!r}; use `spectral_gap` over your own range."
        )
    return shrunk(gap, noises[best - 1 : best + 2])


def rough_gap(potential: Potential, noise: float) -> float:
    """The gap of the coarsest truncation."""
    model = LayDownModel(potential, noise)
    basis = discretisation_for(model)
    scale = Scale.of(model, essential_of(model))
    modes = survey(basis, basis.truncation(0), 1, scale)
    return modes[0].rate if modes else scale.limit


def shrunk(function: Callable[[float], float], points: Array) -> tuple[float, float]:
    """Golden section for a maximum that need not be smooth."""
    lower, middle, upper = map(float, points)
    top = function(middle)
    golden = (3 - math.sqrt(5)) / 2
    while upper - lower > BRACKET * middle:
        # The probe divides the longer part.
        right = upper - middle > middle - lower
        probe = middle + golden * ((upper if right else lower) - middle)
        value = function(probe)
        if value > top:
            lower, upper = (middle, upper) if right else (lower, middle)
            middle, top = probe, value
        elif right:
            upper = probe
        else:
            lower = probe
    return lower, upper


@dataclass(frozen=True)
class Meeting:
    """What makes the maximum, told from the gaps at the two ends of a bracket."""

    potential: Potential
    noises: tuple[float, float]
    gaps: tuple[SpectralGap, SpectralGap]

    @classmethod
    def near(cls, potential: Potential, lower: float, upper: float) -> Meeting:
        """The bracket, widened by its width to either side, with the gaps there."""
        width = upper - lower
        noises = lower - width, upper + width
        models = [LayDownModel(potential, noise) for noise in noises]
        left, right = (spectral_gap(model, tolerance=ROUGH) for model in models)
        return cls(potential, noises, (left, right))

    @property
    def sectors(self) -> tuple[Sector | None, ...]:
        """Of the branches that meet."""
        left, right = self.gaps
        if self.kind == "crossing":
            return left.sector, right.sector
        return (left.sector,)

    @property
    def kind(self) -> str:
        """See `OptimalNoise`."""
        left, right = self.gaps
        if left.sector != right.sector:
            return "crossing"
        if bool(left.eigenvalue.imag) != bool(right.eigenvalue.imag):
            return "double eigenvalue"
        # Within the bracket one branch hardly moves; two of a sector may cross there.
        far = abs(left.eigenvalue - right.eigenvalue) > 0.05 * left
        return "crossing" if far else "smooth maximum"

    def solve(self, level: int) -> tuple[float, float]:
        """Noise and gap in the truncation of a level."""
        if self.kind == "crossing":
            left, right = self.rate(0, level), self.rate(1, level)
            noise = root(lambda a: left(a) - right(a), self.noises)
            return noise, left(noise)
        if self.kind == "smooth maximum":
            branch = self.branch(0, level)
            noise = root(branch.slope, self.noises)
            return noise, branch.rate(noise)
        # The side of the complex pair knows the mean.
        pair = PairBranch(*self.start(0 if self.gaps[0].eigenvalue.imag else 1, level))
        noise = root(pair.discriminant, self.noises)
        return noise, pair.rate(noise)

    def rate(self, side: int, level: int) -> Callable[[float], float]:
        """-Re λ(A) of the branch that is slowest on a side."""
        if self.gaps[side].sector is not None:
            return self.branch(side, level).rate
        return lambda a: -float(essential_of(LayDownModel(self.potential, a)) or 0.0)

    def branch(self, side: int, level: int) -> Branch:
        """The branch that is slowest on a side."""
        return Branch(*self.start(side, level))

    def start(
        self, side: int, level: int
    ) -> tuple[Potential, Sector, int, float, complex]:
        """Where that branch is known: the arguments of `Branch`."""
        gap = self.gaps[side]
        assert gap.sector is not None
        return self.potential, gap.sector, level, self.noises[side], gap.eigenvalue


def root(function: Callable[[float], float], bracket: tuple[float, float]) -> float:
    """The zero of a function between two noises."""
    return float(brentq(function, *bracket, xtol=1e-15, rtol=1e-15))
