"""A comparison of density and paths: verdict, tests, what would have been seen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fpsolve.pages.blocks import Block, Facts, Notice, Paragraph, Part, Section, Table
from fpsolve.pages.figures import drawings
from fpsolve.pages.numbers import grouped
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import grid_text, model_facts, model_or_unread

if TYPE_CHECKING:
    from fpsolve.studies.agreement.check import CrossCheck

__all__ = ["HEADINGS", "section", "summary_row"]

HEADINGS = (
    "s",
    "χ²/k of cells",
    "p",
    "largest cell",
    "p of ξ₁, ξ₂, α",
    "largest moment",
    "tests failed",
)


def section(check: CrossCheck, source: str) -> Section:
    """Return the section of a page about a cross-check."""
    from fpsolve.studies.agreement.wording import verdict

    tone = "good" if check.agrees else "bad"
    equations = model_or_unread(check.model, check.provenance)
    return Section("Density against paths", source, [
        Part("Summary", [Notice(verdict(check), tone), *_words(check)]),
        Part("Equation", equations),
        Part("Parameters", [Facts(_parameters(check))]),
        Part("Tests", [_summary(check), _moments(check)]),
        Part("Figure", drawings(check)),
        provenance_part(check.provenance, call=check.call),
    ])  # fmt: skip


def summary_row(check: CrossCheck, s: float) -> tuple[str, ...]:
    """One cell under each of the `HEADINGS` for the tests at s."""
    from fpsolve.studies.agreement.wording import LABELS

    cells, single = check.test("cells", s), check.test("largest cell", s)
    lines = [check.test(f"marginal {which}", s) for which in ("xi1", "xi2", "alpha")]
    tests = [test for test in check.tests if test.s == s]
    moments = [test for test in tests if test.degrees is None]
    worst = max(moments, key=lambda test: abs(test.statistic))
    failed = sum(not test.agrees for test in tests)
    return (
        f"{s:g}",
        f"{cells.statistic / max(cells.degrees or 0, 1):.3f}",
        f"{cells.p_value:.2g}",
        f"|z| = {single.statistic:.2f}",
        ", ".join(f"{line.p_value:.2g}" for line in lines),
        f"{LABELS[worst.name]}, z = {worst.statistic:+.2f}",
        f"{failed} of {len(tests)}",
    )


def _words(check: CrossCheck) -> list[Block]:
    """Return the sentences after the verdict, one paragraph each."""
    return [Paragraph(line.strip()) for line in str(check).splitlines()[1:]]


def _parameters(check: CrossCheck) -> list[tuple[str, str]]:
    model, solver, sampler = check.model, check.solver, check.sampler
    also = " and ds/2, extrapolated" if solver["extrapolated"] else ", not extrapolated"
    return [
        *model_facts(model),
        ("grid", grid_text(check.grid)),
        ("density", f"{solver['name']}, ds = {solver['ds']:.4g}{also}"),
        ("paths", f"{grouped(check.n_paths)} by {sampler['method']}, "
                  f"ds = {sampler['ds']:.4g}"),
        ("seed", str(sampler["seed"])),
        ("false alarm", f"probability at most {check.false_alarm:g}"),
    ]  # fmt: skip


def _summary(check: CrossCheck) -> Table:
    return Table(
        "Tests at every arclength.", HEADINGS,
        [summary_row(check, float(s)) for s in check.s], words=frozenset({4, 5}),
    )  # fmt: skip


def _moments(check: CrossCheck) -> Table:
    from fpsolve.studies.agreement.reference import MOMENTS
    from fpsolve.studies.agreement.wording import LABELS

    rows = [
        (
            f"{test.s:g}", LABELS[test.name], f"{test.density:.5g}",
            f"{test.paths:.5g} ± {test.standard_error:.1g}",
            f"{test.statistic:+.2f}", f"{test.detectable:.2g}",
            "-" if test.step_error != test.step_error else f"{test.step_error:.1e}",
        )
        for test in check.tests if test.name in MOMENTS
    ]  # fmt: skip
    return Table(
        "Moments by the density and by the paths.",
        ("s", "moment", "density", "paths", "z", "shift that is seen", "step error"),
        rows,
        "z: deviation in standard errors. Shift that is seen: with probability 0.99. "
        "Step error: of density and paths together; a dash where it is not estimated.",
        words=frozenset({1}),
    )  # fmt: skip
