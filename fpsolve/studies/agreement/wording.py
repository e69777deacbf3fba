"""A cross-check in words: verdict, false alarms, and what would have been seen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from fpsolve.studies.agreement.goodness_of_fit import POWER
from fpsolve.studies.agreement.outcome import AgreementTest
from fpsolve.studies.agreement.reference import MOMENTS

__all__ = ["LABELS", "detection", "finding", "report", "verdict"]

LABELS = {
    "coarse cells": "large cells of phase space",
    "cells": "cells of phase space",
    "largest cell": "largest single cell",
    "marginal xi1": "marginal of ξ₁",
    "marginal xi2": "marginal of ξ₂",
    "marginal alpha": "marginal of α",
    "mean_xi1": "E ξ₁",
    "mean_xi2": "E ξ₂",
    "variance_xi1": "Var ξ₁",
    "variance_xi2": "Var ξ₂",
    "covariance": "Cov(ξ₁, ξ₂)",
    "mean_cos_alpha": "E cos α",
    "mean_sin_alpha": "E sin α",
    "mean_square": "E ‖ξ‖²",
}
_MOST_FINDINGS = 6


def report(check: Any) -> str:
    """Everything worth saying, in a few lines."""
    lines = [verdict(check), *_sources(check)]
    if check.agrees:
        lines.append(f"Closest to a disagreement: {finding(_most_extreme(check))}.")
    else:
        shown = check.failed[:_MOST_FINDINGS]
        lines += [f"  {finding(test)}" for test in shown]
        if len(check.failed) > len(shown):
            lines.append(f"  and {len(check.failed) - len(shown)} more")
    lines += [false_alarm(check), detection(check), *step_errors(check)]
    lines.append(grid_errors(check))
    return "\n".join(lines)


def verdict(check: Any) -> str:
    """One sentence: do density and paths agree."""
    places = listed([f"{s:g}" for s in check.s])
    n_tests = len(check.tests)
    if check.agrees:
        return f"Density and paths agree at s = {places}: all {n_tests} tests passed."
    return (
        f"Density and paths DISAGREE at s = "
        f"{listed([f'{s:g}' for s in sorted({test.s for test in check.failed})])}: "
        f"{len(check.failed)} of {n_tests} tests failed."
    )


def finding(test: AgreementTest) -> str:
    """One test in words and numbers."""
    return (
        f"{LABELS.get(test.name, test.name)} at s = {test.s:g}: {_values(test)}, "
        f"p = {test.p_value:.2g}"
    )


def false_alarm(check: Any) -> str:
    """How likely an alarm is when there is nothing to find."""
    threshold = check.tests[0].threshold
    return (
        f"A density and paths of the same law fail with probability at most "
        f"{check.false_alarm:g}: each of the {len(check.tests)} tests rejects at "
        f"p < {threshold:.2g} (Bonferroni)."
    )


def detection(check: Any) -> str:
    """How large a disagreement would have been seen."""
    largest = {name: float(np.max(values)) for name, values in check.detectable.items()}
    shifts = [
        f"{LABELS[name]} by {largest[name]:.2g}" for name in MOMENTS if name in largest
    ]
    return (
        f"Seen with probability {POWER:g}: a density whose probabilities of "
        f"{_n_cells(check, 'coarse cells')} cells differ by "
        f"{largest['coarse cells']:.2g} in L1, of {_n_cells(check, 'cells')} cells by "
        f"{largest['cells']:.2g} (of a marginal in ξ₁ by "
        f"{largest['marginal xi1']:.2g}, in ξ₂ by {largest['marginal xi2']:.2g}, in α "
        f"by {largest['marginal alpha']:.2g}), or a shift of {listed(shifts, 'or')}."
    )


def step_errors(check: Any) -> list[str]:
    """Whether steps, and not the mathematics, could be what disagrees."""
    known = [test for test in check.tests if not math.isnan(test.step_error)]
    if not known:
        return [_why_unknown(check)]
    worst = max(known, key=lambda test: test.step_error / test.detectable)
    share = worst.step_error / worst.detectable
    label = LABELS.get(worst.name, worst.name)
    said = (
        f"Step errors of density and paths are at most {share:.2g} times what is seen "
        f"({label} at s = {worst.s:g}: {worst.step_error:.2g} by Richardson's estimate)"
    )
    explained = [test for test in check.failed if test.may_be_step_error]
    if explained:
        return [
            f"{said}: {len(explained)} of the {len(check.failed)} disagreements may be "
            "step error; reduce `ds` and `paths_ds`."
        ]
    if check.failed:
        return [f"{said}, which does not explain the disagreement."]
    if worst.blurred:
        return [f"{said}; reduce `ds` and `paths_ds` to see less than that."]
    return [f"{said}."]


def grid_errors(check: Any) -> str:
    """How much the tests allow for the grid, or that they do not."""
    coarser = check.solver.get("coarser")
    known = [test for test in check.tests if not math.isnan(test.grid_error)]
    if not known or not coarser or isinstance(coarser, str):
        why = f" ({coarser})" if isinstance(coarser, str) else ""
        also = ", and may be what disagrees" if check.failed else ""
        return (
            f"The error of the grid is not estimated{why}{also}; pass `compare` runs "
            "on coarser ones, or refine it."
        )
    worst = max(known, key=lambda test: test.grid_error / test.detectable)
    label = LABELS.get(worst.name, worst.name)
    cells = listed([" x ".join(map(str, shape)) for shape in coarser])
    return (
        f"The tests allow for the grid error of the density, at most "
        f"{worst.grid_error / worst.detectable:.2g} times what is seen ({label} at s = "
        f"{worst.s:g}: {worst.grid_error:.2g} by runs on {cells} cells)."
    )


def _why_unknown(check: Any) -> str:
    if check.solver["extrapolated"]:
        return (
            f"The step error of {check.sampler['method']} is not estimated; halve "
            "`paths_ds` to see whether a disagreement is one."
        )
    return (
        "Step errors are not estimated; solve with `extrapolate=True` to know whether "
        "a disagreement could be one."
    )


def listed(words: Sequence[str], last: str = "and") -> str:
    """Join words: "a", "a and b", "a, b and c"."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}"


def _n_cells(check: Any, name: str) -> int:
    return max(test.degrees or 0 for test in check.tests if test.name == name) + 1


def _sources(check: Any) -> list[str]:
    solver, sampler = check.solver, check.sampler
    cells = " x ".join(map(str, check.grid.shape))
    also = " and ds/2, extrapolated" if solver["extrapolated"] else ""
    return [
        f"Density: {solver['name']}, ds = {solver['ds']:.4g}{also}, {cells} cells.",
        f"Paths: {check.n_paths} by {sampler['method']}, ds = {sampler['ds']:.4g}, "
        f"seed {sampler['seed']}.",
    ]


def _most_extreme(check: Any) -> AgreementTest:
    least: AgreementTest = min(check.tests, key=lambda test: test.p_value)
    return least


def _values(test: AgreementTest) -> str:
    if test.name == "largest cell":
        return f"|z| = {test.statistic:.3g} among {test.degrees}"
    if test.degrees is not None:
        return f"χ² = {test.statistic:.4g} with {test.degrees} degrees of freedom"
    return (
        f"{test.density:.5g} by the density, {test.paths:.5g} ± "
        f"{test.standard_error:.1g} by the paths, z = {test.statistic:+.3g}"
    )
