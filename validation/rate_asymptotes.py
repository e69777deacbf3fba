"""The gap meets its asymptotes for small and for large noise, and its proven bounds.

Claims: for B = |ξ|²/2, |ξ| and |ξ|⁴/4 the gap is exactly A²/2 below the first crossing
of branches, and smaller beyond it; for large noise it is Λ/A² (1 + c/A⁴ + O(A⁻⁸)) with
c = 3/2 for B = |ξ|²/2 and −1/48 for B = |ξ|; the hypocoercive bound with its constants
lies below the gap, by a bounded factor at small noise and by none at large noise.
"""

from __future__ import annotations

import argparse

from reporting import Report

import fpsolve as fp
from fpsolve.spectral.eigen.gap import spectral_gap
from fpsolve.studies.constants.poincare import poincare_constant
from fpsolve.studies.rates.bounds import averaging_bound, hypocoercive_bound

QUADRATIC, LINEAR = fp.QuadraticPotential(), fp.LinearPotential()
# Noises below the first crossing, and one beyond it.
SMALL = {
    "|ξ|²/2": (QUADRATIC, (0.2, 0.4), 0.7),
    "|ξ|": (LINEAR, (0.3, 0.5), 1.0),
    "|ξ|⁴/4": (fp.PowerPotential(4.0), (0.2, 0.4), 0.5),
}
LARGE = {"|ξ|²/2": (QUADRATIC, 1.5), "|ξ|": (LINEAR, -1 / 48)}


def gap(potential: fp.Potential, noise: float, tolerance: float) -> float:
    return float(spectral_gap(fp.LayDownModel(potential, noise), tolerance=tolerance))


def check_small(report: Report, quick: bool) -> None:
    """A²/2, then less."""
    rows = []
    for name, (potential, noises, beyond) in SMALL.items():
        chosen = noises[-1:] if quick else noises
        shares = [gap(potential, noise, 1e-7) / noise**2 for noise in chosen]
        rows += [{"B": name, "A": A, "gap / A²": share}
                 for A, share in zip(chosen, shares, strict=True)]  # fmt: skip
        # The tolerance of the eigenvalues, relative.
        report.check(
            f"B = {name}: |gap/(A²/2) − 1| at A = {', '.join(map(str, chosen))}",
            max(abs(2 * share - 1) for share in shares), "<", 1e-7,
        )  # fmt: skip
        share = gap(potential, beyond, 1e-6) / beyond**2
        rows.append({"B": name, "A": beyond, "gap / A²": share})
        report.check(f"B = {name}: gap/A² at A = {beyond}", share, "<", 0.4999)
    report.table(rows)


def check_large(report: Report) -> None:
    """The correction to Λ/A², from two noises and the next order removed."""
    rows = []
    for name, (potential, expected) in LARGE.items():
        poincare = poincare_constant(potential)
        noises, found = (5.0, 10.0), []
        for noise in noises:
            value = gap(potential, noise, 1e-12)
            found.append((value * noise**2 / poincare - 1) * noise**4)
            rows.append({"B": name, "A": noise, "gap A²/Λ − 1": found[-1] / noise**4,
                         "times A⁴": found[-1]})  # fmt: skip
        # found = c + d/A⁴, and A⁴ grows by 16.
        correction = found[1] + (found[1] - found[0]) / 15
        report.check(
            f"B = {name}: c of Λ/A² (1 + c/A⁴), relative error",
            abs(correction / expected - 1), "<", 1e-4,
        )  # fmt: skip
    report.table(rows)


def check_bounds(report: Report) -> None:
    """Proven bounds over the true gap."""
    rows, shares, averaged = [], [], []
    for noise in (0.5, 1.0, 2.0, 4.0, 10.0, 30.0):
        true = gap(QUADRATIC, noise, 1e-6)
        shares.append(hypocoercive_bound(QUADRATIC, noise).rate / true)
        averaged.append(averaging_bound(QUADRATIC, noise) / true)
        rows.append({"A": noise, "gap": true, "hypocoercive / gap": shares[-1],
                     "theorem 3.3 / gap": averaged[-1]})  # fmt: skip
    report.table(rows)
    report.check("hypocoercive bound / gap, at most", max(shares), "<", 1.0)
    report.check("hypocoercive bound / gap, at least", min(shares), ">", 0.02)
    report.check("hypocoercive bound / gap at A = 30", shares[-1], ">", 0.98)
    report.check("theorem 3.3 as a rate / gap, at most", max(averaged), "<", 1.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer noises")
    quick = parser.parse_args().quick
    report = Report("rate_asymptotes", quick)
    check_small(report, quick)
    check_large(report)
    check_bounds(report)
    report.finish()


if __name__ == "__main__":
    main()
