"""Paths against stationary solutions: the marginals of ensembles and of long runs.

Claims: (1) v = 0: ensembles that began at one point have, after a long arclength, the
law e^{−B} in ξ and the uniform law in α, jointly, for quadratic, anisotropic, linear
and quartic B and several A; (2) so have the time averages of single long paths;
(3) v ≠ 0: E cos α = −v and E sin α = 0 for every B, in ensembles and along long
paths, and the ensembles have the density of `steady_state`.

False alarms: all tests of one row together reject what is right with probability at
most 1e-3 (Bonferroni); seeds are fixed.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from reporting import Report
from scipy import stats

import fpsolve as fp
from fpsolve.paths import PointLaw, sample_paths
from fpsolve.studies import compare
from fpsolve.studies.agreement.goodness_of_fit import chi_square, z_score
from fpsolve.studies.agreement.partition import (
    equal_probability_bins,
    equal_probability_boxes,
)

FALSE_ALARM = 1e-3
SEED = 20080611
# Far from equilibrium, with one direction.
START = PointLaw((1.0, 0.0), 0.5)
# Bins of the long runs, in each of α, the direction of ξ and B(ξ).
N_BINS = 12
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class Shape:
    """A potential with what is known of e^{−B}, and the box and step it needs."""

    name: str
    potential: object
    # B is homogeneous of this degree n; under e^{−B}, B has the Gamma law of 2/n.
    degree: float
    mean_square: float
    half_width: tuple[float, float]
    ds: float


SHAPES = (
    Shape("quadratic", fp.QuadraticPotential(), 2, 2.0, (6.0, 6.0), 0.1),
    Shape(
        "anisotropic", fp.QuadraticPotential(1.0, 0.5), 2, 1.25, (6.0, 3.0), 0.05
    ),
    Shape("linear", fp.LinearPotential(), 1, 6.0, (16.0, 16.0), 0.1),
    Shape("quartic", fp.PowerPotential(4.0), 4, 2 / np.sqrt(np.pi), (3.0, 3.0), 0.05),
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A model, and the arclength after which its start is forgotten."""

    shape: Shape
    noise: float
    belt_speed: float = 0.0
    s_end: float = 150.0

    @property
    def name(self) -> str:
        belt = f", v = {self.belt_speed:g}" if self.belt_speed else ""
        return f"{self.shape.name}, A = {self.noise:g}{belt}"

    @property
    def model(self) -> fp.LayDownModel:
        curve = fp.MovingBelt(self.belt_speed) if self.belt_speed else fp.FixedBelt()
        return fp.LayDownModel(self.shape.potential, self.noise, curve)

    def ensemble(self, n_paths: int, grid: fp.PhaseSpaceGrid):
        return sample_paths(
            self.model, n_paths, self.s_end, self.shape.ds,
            seed=SEED, initial=START, histogram=grid, keep=False,
        )  # fmt: skip


# The circulation G decays like e^{−A²s/2} from any start, the position like
# e^{−Λs/A²} at large noise, Λ = 1 (quadratic), 2/9 (linear): at most e^{−8} is left.
FIXED = [
    Case(shape, noise, s_end=s_end)
    for shape in SHAPES
    for noise, s_end in ((0.5, 100.0), (1.0, 80.0), (2.0, 150.0))
]
BELTS = [
    Case(SHAPES[0], 1.0, 0.1, 40.0),
    Case(SHAPES[0], 0.5, 0.3, 100.0),
    Case(SHAPES[1], 2.0, 0.2, 60.0),
    Case(SHAPES[2], 1.0, 0.1, 80.0),
    Case(SHAPES[3], 1.0, 0.2, 60.0),
]
QUICK_FIXED = [Case(SHAPES[0], 1.0, s_end=40.0), Case(SHAPES[3], 2.0, s_end=40.0)]
QUICK_BELTS = BELTS[:1]
BELT_CELLS = {
    "quadratic": (48, 48, 32),
    "anisotropic": (64, 56, 32),
    "linear": (128, 128, 32),
    "quartic": (56, 56, 32),
}


def equilibrium_cells(potential, grid: fp.PhaseSpaceGrid) -> np.ndarray:
    """∫ p_S over every cell by Gauss-Legendre quadrature; what is missing is outside.

    The kink of |ξ| lies at a corner of cells, where it does no harm.
    """
    d1, d2, _ = grid.spacing
    xi1 = (grid.xi1[:, None] + NODES * d1 / 2).ravel()
    xi2 = (grid.xi2[:, None] + NODES * d2 / 2).ravel()
    values = np.exp(-potential.value(xi1[:, None], xi2[None, :]))
    blocks = values.reshape(grid.shape[0], 4, grid.shape[1], 4)
    plane = np.einsum("iajb,a,b->ij", blocks, WEIGHTS, WEIGHTS) * d1 * d2 / 4
    plane /= potential.partition_function
    return np.repeat(plane[:, :, None] / grid.shape[2], grid.shape[2], axis=2)


def ensemble_row(case: Case, n_paths: int) -> dict:
    """Smallest p-value among the tests of an ensemble against p_S."""
    grid = fp.PhaseSpaceGrid(case.shape.half_width, (48, 48, 32))
    paths = case.ensemble(n_paths, grid)
    histogram = paths.histogram()
    probabilities = equilibrium_cells(case.shape.potential, grid)
    size = FALSE_ALARM / 10
    tests = {}
    for most in (32, 512):
        labels = equal_probability_boxes(probabilities, most, 25 / n_paths).ravel()
        shares = np.bincount(labels, probabilities.ravel())
        counts = np.bincount(labels, histogram.counts.ravel()).astype(int)
        shares[0] = 1.0 - shares[1:].sum()
        counts[0] += histogram.outside
        tests[f"{most} cells"] = chi_square(counts, shares, size)
    for which, axes in (("xi1", (1, 2)), ("xi2", (0, 2)), ("alpha", (0, 1))):
        shares = probabilities.sum(axis=axes) / probabilities.sum()
        labels = equal_probability_bins(shares, 32, 25 / n_paths)
        counts = np.bincount(labels, histogram.counts.sum(axis=axes)).astype(int)
        tests[which] = chi_square(counts, np.bincount(labels, shares), size)
    expected = dict.fromkeys(("mean_xi1", "mean_xi2"), 0.0)
    expected |= {"mean_cos_alpha": 0.0, "mean_sin_alpha": 0.0}
    expected["mean_square"] = case.shape.mean_square
    for name, value in expected.items():
        found, error = (float(one[-1]) for one in paths.moments()[name])
        tests[name] = z_score(found, value, error, size)
    worst = min(tests, key=lambda name: tests[name].p_value)
    return {
        "case": case.name,
        "paths": n_paths,
        "s": case.s_end,
        "ds": case.shape.ds,
        "chi2/k, 512 cells": tests["512 cells"].statistic / tests["512 cells"].degrees,
        "p of alpha": tests["alpha"].p_value,
        "z of E|xi|^2": tests["mean_square"].statistic,
        "worst test": worst,
        "p, worst x tests": min(1.0, tests[worst].p_value * len(tests)),
        "L1 seen": tests["512 cells"].detectable,
    }


def binned(values, n_bins: int, low: float = 0.0, width: float = 2 * np.pi):
    """Indicator functions of bins of a function of (ξ1, ξ2, α)."""

    def indicator(number: int):
        def inside(xi1, xi2, alpha):
            place = np.floor((values(xi1, xi2, alpha) - low) * n_bins / width)
            return np.mod(place, n_bins) == number

        return inside

    return [indicator(number) for number in range(n_bins)]


def bins_of(shape: Shape) -> dict[str, list]:
    """Bins of equal probability under p_S for α, the direction of ξ, and B(ξ)."""
    law = stats.gamma(2 / shape.degree)
    sigma2 = getattr(shape.potential, "sigma2", 1.0)

    def share(xi1, xi2, alpha):
        return np.minimum(law.cdf(shape.potential.value(xi1, xi2)), 1 - 1e-12)

    return {
        "alpha": binned(lambda xi1, xi2, alpha: alpha, N_BINS),
        "direction": binned(
            lambda xi1, xi2, alpha: np.arctan2(xi2 / sigma2, xi1), N_BINS
        ),
        "B": binned(share, N_BINS, width=1.0),
    }


def averages_after(case: Case, functions: list, n_paths: int, length: float):
    """Time averages over [s_end, s_end + length] of independent paths."""
    first, last = case.s_end, case.s_end + length
    paths = sample_paths(
        case.model, n_paths, last, case.shape.ds,
        seed=SEED + 1, initial=START, save_at=(first, last),
    )  # fmt: skip
    until = paths.time_averages(functions)
    return (last * until[:, 1] - first * until[:, 0]) / length


def student(averages: np.ndarray, expected: float) -> np.ndarray:
    """t of the means over independent paths; one for every function."""
    n_paths = averages.shape[1]
    error = averages.std(axis=1, ddof=1) / np.sqrt(n_paths)
    return (averages.mean(axis=1) - expected) / error


def long_run_row(case: Case, n_paths: int, length: float) -> dict:
    """Smallest p-value among the occupation times of bins, by t-tests over paths."""
    bins = bins_of(case.shape)
    functions = [one for group in bins.values() for one in group]
    averages = averages_after(case, functions, n_paths, length)
    t = student(averages, 1 / N_BINS)
    p_values = 2 * stats.t.sf(np.abs(t), n_paths - 1)
    worst = int(np.argmin(p_values))
    error = averages.std(axis=1, ddof=1) / np.sqrt(n_paths) * N_BINS
    return {
        "case": case.name,
        "long paths": n_paths,
        "length": length,
        "worst bin": f"{list(bins)[worst // N_BINS]} {worst % N_BINS}",
        "largest |t|": float(np.abs(t).max()),
        "p, worst x bins": min(1.0, float(p_values[worst]) * t.size),
        "largest relative error": float(error.max()),
    }


def belt_row(case: Case, n_paths: int, n_long: int, length: float) -> dict:
    """Identities and agreement with `steady_state` on a moving belt."""
    half1, half2 = case.shape.half_width
    grid = fp.PhaseSpaceGrid((half1, half2), BELT_CELLS[case.shape.name])
    # e^{−B} of the quartic falls by too many decades for the balanced form.
    balanced = case.shape.name != "quartic"
    scheme = fp.drift_kick(case.model, grid, balanced=balanced)
    steady = fp.steady_state(scheme, ds=1 / 16, tolerance=1e-7, extrapolate=True)
    paths = case.ensemble(n_paths, grid)
    check = compare(steady, paths, false_alarm=FALSE_ALARM)
    row = {"case": case.name, "paths": n_paths, "residual": steady.residual}
    identities = {"cos": -case.belt_speed, "sin": 0.0}
    for name, expected in identities.items():
        value, error = (float(x[-1]) for x in paths.moments()[f"mean_{name}_alpha"])
        row[f"z of E {name}"] = (value - expected) / error
    averages = averages_after(
        case,
        [lambda x, y, alpha: np.cos(alpha), lambda x, y, alpha: np.sin(alpha)],
        n_long,
        length,
    )
    for function, (name, expected) in zip(averages, identities.items(), strict=True):
        row[f"t of {name}, long"] = float(student(function[None], expected)[0])
        row[f"largest error of {name}, long"] = float(np.abs(function - expected).max())
    worst = min(check.tests, key=lambda test: test.p_value)
    row["worst test"] = worst.name
    row["p, worst x tests"] = min(1.0, worst.p_value * len(check.tests))
    row["L1 seen"] = check.test("cells", float(check.s[0])).detectable
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few cases, fewer paths")
    quick = parser.parse_args().quick
    report = Report("path_marginals", quick)
    n_paths, n_long, length = (40_000, 64, 200.0) if quick else (400_000, 128, 1000.0)
    fixed, belts = (QUICK_FIXED, QUICK_BELTS) if quick else (FIXED, BELTS)
    rows = [ensemble_row(case, n_paths) for case in fixed]
    report.table(rows)
    long_rows = [long_run_row(case, n_long, length) for case in fixed]
    report.table(long_rows)
    belt_rows = [belt_row(case, n_paths, n_long, length) for case in belts]
    report.table(belt_rows)
    # With Bonferroni, the p-value of a row is that of its worst test times their
    # number; of two or four identities as well.
    for row in rows:
        claim = f"ensemble, {row['case']}: no test rejects p_S"
        report.check(claim, row["p, worst x tests"], ">", FALSE_ALARM)
    for row in long_rows:
        claim = f"long runs, {row['case']}: no bin is visited too often"
        report.check(claim, row["p, worst x bins"], ">", FALSE_ALARM)
    critical = stats.norm.isf(FALSE_ALARM / 4)
    for row in belt_rows:
        claim = f"{row['case']}: paths have the stationary density"
        report.check(claim, row["p, worst x tests"], ">", FALSE_ALARM)
        for name in ("cos", "sin"):
            claim = f"{row['case']}: E {name} alpha, ensemble, |z|"
            report.check(claim, abs(row[f"z of E {name}"]), "<", critical)
            # The mean over s of cos α + v is (ξ1(s) − ξ1(0))/s, bounded by the few
            # widths of the stationary density over the length.
            claim = f"{row['case']}: mean of {name} alpha along every long path"
            bound = 12 / length if "linear" not in row["case"] else 30 / length
            report.check(claim, row[f"largest error of {name}, long"], "<", bound)
    report.finish()


if __name__ == "__main__":
    main()
