"""The forward equation in one sector from one arclength to another, with its error.

What is kept follows what is significant. L* is dissipative in L²(μ): whatever a sector
leaves out, at a time or as it goes on, is at most as large later. Its error is
therefore at most the sum of the norms left out at each fitting, the tolerances of the
series, and the integral of the norm of what L* takes out of the counts.
"""

from typing import NamedTuple

import numpy as np

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.lanes import LANES
from fpsolve._kernels.sectors import (
    advance_sector,
    flux,
    half_axes,
    norm_between,
    within,
)

# Room beyond the last significant coefficient: degrees, and a share of the harmonics;
# how it grows when a step fails and is repeated, how often, and how it shrinks again
# when less than a share of what may flow out does.
DEGREES, SHARE, FEWEST = 4.0, 0.1, 2
WIDER, MOST_TRIALS, NARROWER, LITTLE = 1.3, 16, 1.2, 1e-2
# Chebyshev terms per unit of (half axes) × (arclength) approach one from above as the
# product grows; beyond this product little is gained. See `ForwardOperator.longest`.
REACH, GROWTH, FLATTER = 64.0, 0.6, 60.0
# Shares of what may be neglected: by all fittings, by all series, and, squared, by what
# flows out. Between its two ends a step may lose this much more than at either.
FITTING, SERIES, FLOWING, BETWEEN = 0.1, 0.01, 0.2, 4.0
# What is left out decays within a few coefficients of the edge, which is as long as the
# root of all. Where it does not, the threshold is lowered.
ALONG_EDGE, LOWER = 8.0, 0.1

# What a step costs besides its terms: in terms, and at least. As a density spreads its
# steps may become cheaper and longer by no more than CHEAPER.
FITTING_TERMS, AT_LEAST, CHEAPER = 10, 5e3, 1e-4

DONE, TOO_LARGE, TOO_LONG, DIVERGED = 0, 1, 2, 3


class Allowance(NamedTuple):
    """What one sector may neglect and take.

    Attributes
    ----------
    norm, over : float
        What norm may be neglected over which arclength.
    largest : float
        Complex coefficients.
    work : float
        Coefficients gone through.
    """

    norm: float
    over: float
    largest: float
    work: float


@njit(cache=True, error_model="numpy")
def significant_degrees(c, counts, index, threshold):
    """Of every row the degree 2m + |l| of the last |c|² above a threshold, else −1.

    Made to fall from a row on outwards: a coefficient may vanish by symmetry between
    others that count.
    """
    harmonics = (counts.size - 3) // 2
    degrees = np.full(counts.size, -1)
    for row in range(1, counts.size - 1):
        for m in range(counts[row] - 1, -1, -1):
            if c[0, row, m + 1] ** 2 + c[1, row, m + 1] ** 2 > threshold:
                degrees[row] = 2 * m + abs(index - row + 1 + harmonics)
                break
    for row in range(1, harmonics + 1):
        degrees[row] = max(degrees[row], degrees[row - 1])
    for row in range(counts.size - 2, harmonics + 1, -1):
        degrees[row] = max(degrees[row], degrees[row + 1])
    return degrees


@njit(cache=True, error_model="numpy")
def roomy_counts(degrees, index, margin):
    """Counts for these degrees and a quarter of an ellipse of room beyond each."""
    harmonics = (degrees.size - 3) // 2
    last = 0
    for row in range(1, degrees.size - 1):
        if degrees[row] >= 0:
            last = max(last, abs(row - 1 - harmonics))
    room = int(np.ceil(margin * max(FEWEST, SHARE * last)))
    wanted = np.full(2 * (last + room) + 3, -1)
    offset = (wanted.size - degrees.size) // 2
    for row in range(1, degrees.size - 1):
        if degrees[row] < 0:
            continue
        for away in range(-room, room + 1):
            extra = margin * DEGREES * np.sqrt(1.0 - (away / (room + 1.0)) ** 2)
            target = row + offset + away
            if 0 < target < wanted.size - 1:
                wanted[target] = max(wanted[target], degrees[row] + int(extra))
    counts = np.zeros(wanted.size, np.int64)
    for row in range(1, wanted.size - 1):
        turns = abs(index - row + 2 + last + room - 1)
        if wanted[row] >= turns:
            n = (wanted[row] - turns) // 2 + 1
            counts[row] = (n + LANES - 1) // LANES * LANES
    return counts


@njit(cache=True, error_model="numpy")
def fitted(c, counts, index, neglected, margin):
    """The sector in counts that follow it, and the norm that it lost."""
    threshold = neglected**2 / (ALONG_EDGE * np.sqrt(max(1, counts.sum())))
    while True:
        degrees = significant_degrees(c, counts, index, threshold)
        new_counts = roomy_counts(degrees, index, margin)
        lost = norm_between(c, new_counts, counts)
        if lost <= neglected or threshold == 0.0:
            return within(c, counts, new_counts), new_counts, lost
        threshold *= LOWER


@njit(cache=True, error_model="numpy")
def longest(counts, index, equation):
    """Arclength that one series covers efficiently."""
    real, imaginary = half_axes(counts, index, equation)
    flatness = min(real / imaginary, FLATTER)
    by_growth = GROWTH * flatness**2 / real if real > 0.0 else 0.0
    return max(REACH / (real + imaginary), by_growth)


@njit(cache=True, error_model="numpy")
def fits(counts, index, equation, largest):
    """Whether the counts are allowed, and all roots that they and their edge need."""
    degree = 2 * counts.max() + counts.size + index + 4 * LANES
    return counts.sum() <= largest and degree < equation.roots.size


@njit(cache=True, error_model="numpy")
def evolve_sector(c, counts, index, equation, length, allowance):
    """e^{length L*} c: the sector, its counts, error, work, and how it ended.

    A step through whose edge more flows than its share is repeated with more room.
    """
    norm, over, largest, allowed = allowance
    rate, most = norm / over, FLOWING * norm**2 / over
    reached, error, flown, work, margin, trials = 0.0, 0.0, 0.0, 0.0, 1.0, 0
    c, counts, lost = fitted(c, counts, index, FITTING * rate * length, margin)
    error += lost
    if not fits(counts, index, equation, largest):
        return c, counts, error, work, TOO_LARGE
    before = flux(c, counts, index, equation)
    while reached < length:
        ds = min(longest(counts, index, equation), length - reached)
        moved, n = advance_sector(c, counts, index, equation, ds, SERIES * rate * ds)
        spent = (n + FITTING_TERMS) * counts.sum() + AT_LEAST
        work += spent
        if n == 0 and counts.sum() > 0:
            return c, counts, error, work, DIVERGED
        foreseen = work + CHEAPER * spent * (length - reached) / ds
        if not foreseen <= allowed:
            return c, counts, error, foreseen, TOO_LONG
        flow = BETWEEN * max(before, flux(moved, counts, index, equation))
        if not flow <= most and trials < MOST_TRIALS:
            trials, margin = trials + 1, WIDER * margin
            c, counts, lost = fitted(c, counts, index, FITTING * rate * ds, margin)
        else:
            error += SERIES * rate * ds
            flown += 2.0 * flow * ds
            reached += ds
            if length - reached <= 1e-13 * length:
                reached = length
            trials = 0
            if flow < LITTLE * most:
                margin = max(1.0, margin / NARROWER)
            c, counts, lost = fitted(moved, counts, index, FITTING * rate * ds, margin)
        error += lost
        if not fits(counts, index, equation, largest):
            return c, counts, error, work, TOO_LARGE
        before = flux(c, counts, index, equation)
    return c, counts, error + np.sqrt(flown), work, DONE
