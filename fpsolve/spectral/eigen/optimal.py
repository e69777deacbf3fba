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
from fpsolve.model.potentials.potential import Potential
from fpsolve.spectral.bases.sectors import Sector
from fpsolve.spectral.eigen.branches import Branch, PairBranch
from fpsolve.spectral.eigen.family import Family
from fpsolve.spectral.eigen.following import slowness
from fpsolve.spectral.eigen.gap import SpectralGap, spectral_gap
from fpsolve.spectral.eigen.settings import check_tolerance
from fpsolve.spectral.eigen.survey import Scale, survey

__all__ = ["OptimalNoise", "optimal_noise"]

# Noises of the first scan, in units of the one for which the circular orbit has
# radius 1: the maximum of all potentials tried lies well inside.
SCAN = np.geomspace(0.4, 4.0, 8)
# Relative width of the bracket in which the branches are told apart, of basic and of
# smooth fibres, of which the coarsest truncation is less accurate.
BRACKET, SMOOTH_BRACKET = 1e-3, 5e-3
# Accuracy of the gaps at its ends, which tell sectors and whether they are complex.
ROUGH, SMOOTH_ROUGH = 1e-4, 1e-3
# Levels of truncation tried for the noise itself.
LEVELS, SMOOTH_LEVELS = range(1, 9), range(1, 5)
# Relative errors that are reached in seconds.
BASIC, SMOOTH = 1e-8, 1e-5
# Of longer relaxation lengths, in units of the throwing range, the coarsest truncation
# knows nothing.
LONGEST = 0.5
# Rounding of noise and gap, relative.
ROUNDING, SMOOTH_ROUNDING = 1e-14, 1e-9


@dataclass(frozen=True)
class OptimalNoise:
    """Where the spectral gap is largest.

    Attributes
    ----------
    noise, gap : float
        The maximising A and the gap there.
    noise_error, gap_error : float
        Change between the last two truncations, times what is still to come if the
        changes fall slowly, plus rounding.
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
def optimal_noise(
    potential: Potential,
    *,
    relaxation_length: float | None = None,
    tolerance: float | None = None,
) -> OptimalNoise:
    """The noise A that maximises the spectral gap, and the gap there, on a fixed belt.

    The gap is located on a scan of A and by golden section, then the branches on both
    sides tell what makes the maximum, and the equation that defines it is solved in
    growing truncations: δ(A) = 0 for a double eigenvalue m ± √δ, in terms of the
    discriminant δ, which unlike the eigenvalues is analytic there; equal rates for a
    crossing; a vanishing derivative for a smooth maximum. The scan assumes one maximum
    between 0.4 and 4 in units of 1/√r, r the radius of the circular orbit.

    Scaling: for B(ξ/σ) the noise is divided by √σ and the gap by σ, at R/σ.

    Parameters
    ----------
    potential : Potential
        Quadratic or linear; other isotropic ones as for `spectrum`. Of smooth fibres an
        isotropic quadratic one.
    relaxation_length : float, optional
        R of smooth fibres, which is kept while A = RK varies: at most half the throwing
        range. For R → 0 the noise and the gap are those without it, up to O(R).
    tolerance : float, optional
        Largest relative error of noise and gap, at least 1e-13; by default 1e-8, of
        smooth fibres 1e-5.

    Raises
    ------
    TypeError
        If `potential` is not a Potential.
    ValueError
        If there is no gap or no basis, see `spectrum`, no maximum in the scan, or the
        relaxation length is too long.
    ToleranceError
        If the truncations tried do not reach the tolerance.

    References
    ----------
    The question is that of [KMW09]_, section 3.1.1 and theorem 3.3; smooth fibres,
    section 3.2.
    """
    family = Family(potential, relaxation_length)
    if tolerance is None:
        tolerance = SMOOTH if family.smooth else BASIC
    tolerance = check_tolerance(tolerance)
    meeting = Meeting.near(family, *located(family))
    rounding = SMOOTH_ROUNDING if family.smooth else ROUNDING
    levels = SMOOTH_LEVELS if family.smooth else LEVELS
    before, reached, changes = meeting.solve(levels[0]), math.inf, (math.inf, math.inf)
    for level in levels[1:]:
        found = meeting.solve(level)
        # Of a truncation without a maximum nothing is known.
        moved = np.nan_to_num(np.abs(np.subtract(found, before)), nan=math.inf)
        still = [slowness(*pair) for pair in zip(moved, changes, strict=True)]
        errors = moved * still + rounding * np.array(found)
        reached = float(np.max(np.nan_to_num(errors / found, nan=math.inf)))
        if reached <= tolerance:
            noise_error, gap_error = map(float, errors)
            return OptimalNoise(
                *found, noise_error, gap_error, meeting.kind, meeting.sectors
            )
        before, changes = found, tuple(moved)
    raise ToleranceError(reached, tolerance, "enlarge `tolerance`")


def located(family: Family) -> tuple[float, float]:
    """A bracket of the maximum, of relative width BRACKET."""

    def gap(noise: float) -> float:
        return rough_gap(family, noise)

    # Checks the potential before its length scale is asked for.
    family.basis(1.0)
    check_length(family)
    noises = SCAN * family.unit
    best = int(np.argmax([gap(noise) for noise in noises]))
    if best in (0, len(noises) - 1):
        raise ValueError(
            f"`potential` must have its best noise between {noises[0]:.3g} and "
            f"{noises[-1]:.3g}, got the largest gap at {noises[best]:.3g} for "
            f"{family.potential!r}; use `spectral_gap` over your own range."
        )
    width = SMOOTH_BRACKET if family.smooth else BRACKET
    return shrunk(gap, noises[best - 1 : best + 2], width)


def check_length(family: Family) -> None:
    """ValueError unless the coarsest truncation can locate the maximum."""
    if family.relaxation_length is None:
        return
    longest = LONGEST / family.unit**2
    if not family.relaxation_length <= longest:
        raise ValueError(
            f"`relaxation_length` must be at most {longest:.3g}, half the throwing "
            f"range, got {family.relaxation_length:g}; use `spectral_gap` over your "
            "own range of noises."
        )


def rough_gap(family: Family, noise: float) -> float:
    """The gap of the coarsest truncation."""
    basis = family.basis(noise)
    scale = Scale.of(family.model(noise), family.essential(noise))
    modes = survey(basis, basis.truncation(0), 1, scale)
    return modes[0].rate if modes else scale.limit


def shrunk(
    function: Callable[[float], float], points: Array, width: float = BRACKET
) -> tuple[float, float]:
    """Golden section for a maximum that need not be smooth."""
    lower, middle, upper = map(float, points)
    top = function(middle)
    golden = (3 - math.sqrt(5)) / 2
    while upper - lower > width * middle:
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

    family: Family
    noises: tuple[float, float]
    gaps: tuple[SpectralGap, SpectralGap]

    @classmethod
    def near(cls, family: Family, lower: float, upper: float) -> Meeting:
        """The bracket, widened by its width to either side, with the gaps there."""
        width = upper - lower
        noises = lower - width, upper + width
        models = [family.model(noise) for noise in noises]
        rough = SMOOTH_ROUGH if family.smooth else ROUGH
        left, right = (spectral_gap(model, tolerance=rough) for model in models)
        return cls(family, noises, (left, right))

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
            return self.root(lambda a: left(a) - right(a), left)
        if self.kind == "smooth maximum":
            branch = self.branch(0, level)
            return self.root(branch.slope, branch.rate)
        # The side of the complex pair knows the mean.
        pair = PairBranch(*self.start(0 if self.gaps[0].eigenvalue.imag else 1, level))
        return self.root(pair.discriminant, pair.rate)

    def root(
        self, function: Callable[[float], float], rate: Callable[[float], float]
    ) -> tuple[float, float]:
        """The zero of a function between both noises, and the rate there.

        Not a number in a truncation that has none there, which is too coarse.
        """
        left, right = map(function, self.noises)
        if not left * right <= 0:
            return math.nan, math.nan
        noise = float(brentq(function, *self.noises, xtol=1e-15, rtol=1e-15))
        return noise, rate(noise)

    def rate(self, side: int, level: int) -> Callable[[float], float]:
        """-Re λ(A) of the branch that is slowest on a side."""
        if self.gaps[side].sector is not None:
            return self.branch(side, level).rate
        return lambda a: -float(self.family.essential(a) or 0.0)

    def branch(self, side: int, level: int) -> Branch:
        """The branch that is slowest on a side."""
        return Branch(*self.start(side, level))

    def start(
        self, side: int, level: int
    ) -> tuple[Family, Sector, int, float, complex]:
        """Where that branch is known: the arguments of `Branch`."""
        gap = self.gaps[side]
        assert gap.sector is not None
        return self.family, gap.sector, level, self.noises[side], gap.eigenvalue
