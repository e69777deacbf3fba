"""The rate that `entropy_rate` reads off a run is within its error of the exact one.

So it is of runs that are ended early, when a slower mode may have yet to show.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np
from reporting import Report

import fpsolve as fp
from fpsolve.errors import FpsolveError
from fpsolve.evolution.decay import DecayRate, fit_decay
from fpsolve.paths import GaussianLaw
from fpsolve.spectral import Sector
from fpsolve.studies.rates.relaxation_plan import plan_relaxation
from fpsolve.studies.starts import density_and_law

POTENTIALS = {
    "|ξ|²/2": fp.QuadraticPotential(),
    "anisotropic": fp.QuadraticPotential(1.0, 0.7),
    "|ξ|": fp.LinearPotential(),
    "|ξ|⁴/4": fp.PowerPotential(4.0),
}
STARTS = {
    "off centre": GaussianLaw((0.6, 0.0), 0.1, np.pi / 2, 4.0),
    "centred": GaussianLaw((0.0, 0.0), 0.2),
}
SCHEMES: dict[str, dict[str, Any]] = {
    "plain": {}, "positive": {"positive": True}, "balanced": {"balanced": True},
}  # fmt: skip
NOISES = (0.3, 0.5, 0.8, 1.0, 1.5, 2.5, 5.0)
# Below, the exact rate of an anisotropic B needs a basis of minutes; above, H of |ξ|
# takes hundreds of s to fall.
WITHIN = {"anisotropic": (0.8, 5.0), "|ξ|": (0.3, 2.5)}
# Cells and steps as for an L1 error of a tenth; until H has fallen by e⁻¹².
TOLERANCE, E_FOLDS = 0.1, 12.0
# An exact rate that takes more memory than this is left out.
MEMORY = 2**24
# Balanced runs are also ended where H has fallen by so many powers of e.
EARLY = (3, 4, 5, 6, 8, 10, 13, 16, 20)
LENIENT = {"boundary_tolerance": 0.1, "negative_tolerance": 1.0}


def exact_rates(model: fp.LayDownModel) -> dict[str, float]:
    """Twice the gap of what every start excites; without those out of reach.

    A centred start that is uniform in the angle has every reflection symmetry, and the
    rotations that B has.
    """
    even = Sector(0, 1) if model.potential.isotropic else Sector(None, 1, 1)
    found = {}
    for start, sectors in (("off centre", None), ("centred", [even])):
        try:
            spectrum = fp.spectrum(
                model, 1, tolerance=1e-3, sectors=sectors, memory_limit=MEMORY
            )
        except FpsolveError:
            continue
        found[start] = 2 * float(spectrum.gap)
    return found


def runs(name: str, noise: float, schemes: list[str]) -> Iterator[dict[str, Any]]:
    """A row for every start and scheme."""
    model = fp.LayDownModel(POTENTIALS[name], noise)
    plan = plan_relaxation(model, TOLERANCE, E_FOLDS)
    for start, exact in exact_rates(model).items():
        p0, _ = density_and_law(STARTS[start], plan.grid)
        for scheme in schemes:
            try:
                solution = fp.solve(
                    fp.drift_kick(model, plan.grid, **SCHEMES[scheme]), p0,
                    (0.0, plan.s_end), plan.ds,
                    record_every=max(1, int(0.1 / plan.ds)), **LENIENT,
                )  # fmt: skip
            except (ValueError, FpsolveError) as error:
                # In the corners of the box of |ξ|⁴/4 no Gaussian falls off like e^{−B},
                # and a run that breaks a law of the belt at rest has no rate.
                print(f"refused: {name}, A = {noise:g}, {start}, {scheme}: {error}")
                continue
            found = {scheme: solution.entropy_rate()}
            if scheme == "balanced":
                found |= early_rates(solution)
            for label, rate in found.items():
                yield row(rate, exact) | {
                    "B": name, "A": noise, "start": start, "scheme": label,
                }  # fmt: skip


def row(found: DecayRate, exact: float) -> dict[str, Any]:
    """A rate beside the exact one."""
    return {
        "2 gap": exact, "rate": str(found),
        "deviation / error": (found.rate - exact) / found.standard_error,
        "error / rate": found.standard_error / exact, "resolved": str(found.resolved),
    }  # fmt: skip


def early_rates(solution: fp.Solution) -> dict[str, DecayRate]:
    """What the same run would have said if it had been ended earlier."""
    s, entropy = solution.s, solution.relative_entropy - solution.entropy_floor
    resolution = solution.entropy_rate().step_error / solution.entropy_rate().rate
    found = {}
    for fall in EARLY:
        n = int(np.argmax(entropy < entropy[0] * np.exp(-fall)))
        if n == 0:
            continue
        try:
            rate = fit_decay(s[:n], entropy[:n], step_error=resolution)
        except ValueError:
            # Fewer than five values.
            continue
        found[f"ended at e^-{fall}"] = rate
    return found


def coverage(report: Report, rows: list[dict[str, Any]]) -> None:
    """Shares within one error and within two, by scheme."""
    by_scheme = defaultdict(list)
    for one in rows:
        early = one["scheme"].startswith("ended")
        by_scheme["balanced, ended early" if early else one["scheme"]].append(one)
    for scheme, own in by_scheme.items():
        off = np.array([abs(one["deviation / error"]) for one in own])
        for errors, least in ((1, 0.68), (2, 0.9)):
            report.check(
                f"{scheme}: share of {off.size} runs within {errors} error(s)",
                float(np.mean(off <= errors)), ">", least,
            )  # fmt: skip
        report.check(f"{scheme}: largest deviation, in errors", off.max(), "<", 3.0)
    report.check(
        "balanced: median of the error, relative",
        float(np.median([one["error / rate"] for one in by_scheme["balanced"]])),
        "<", 0.1,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one B, three noises")
    quick = parser.parse_args().quick
    report = Report("entropy_rate_coverage", quick)
    names = ["|ξ|²/2"] if quick else list(POTENTIALS)
    noises = (0.5, 1.0, 1.5, 3.0) if quick else NOISES
    schemes = ["plain", "balanced"] if quick else list(SCHEMES)
    rows = []
    for name in names:
        least, largest = WITHIN.get(name, (0.0, np.inf))
        for noise in noises:
            if least <= noise <= largest:
                rows += runs(name, noise, schemes)
    report.table(rows)
    coverage(report, rows)
    report.finish()


if __name__ == "__main__":
    main()
