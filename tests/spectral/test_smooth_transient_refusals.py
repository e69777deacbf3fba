"""What the expansion of smooth fibres in time refuses, and what it says of itself."""

import pytest

import fpsolve as fp
from fpsolve.errors import MemoryLimitError, ToleranceError
from fpsolve.paths import GaussianLaw, PointLaw

ROUND = fp.QuadraticPotential()
START = GaussianLaw((0.5, -0.3), ((0.7, 0.1), (0.1, 0.6)), 0.8, 1.0)
REST = fp.SmoothLayDownModel(ROUND, 0.1, 1.0)

REFUSED = {
    "a point": (
        lambda: fp.spectral_solve(REST, PointLaw(), 1.0),
        TypeError, "`p0` must be a GaussianLaw for a SmoothLayDownModel, got PointLaw",
    ),
    "another potential": (
        lambda: fp.spectral_solve(
            fp.SmoothLayDownModel(fp.PowerPotential(4.0), 0.1, 1.0), START, 1.0
        ),
        ValueError, "`potential` must be a QuadraticPotential",
    ),
    "no noise": (
        lambda: fp.spectral_solve(fp.SmoothLayDownModel(ROUND, 0.1, 0.0), START, 1.0),
        ValueError, "`noise` must be positive, got 0",
    ),
    "s that falls": (
        lambda: fp.spectral_solve(REST, START, (1.0, 0.5)),
        ValueError, "`s` must be finite, non-negative and increasing",
    ),
    "a model of another kind": (
        lambda: fp.spectral_solve(ROUND, START, 1.0),
        TypeError, "`model` must be a LayDownModel or a SmoothLayDownModel",
    ),
    "memory": (
        lambda: fp.spectral_solve(REST, START, 1.0, memory_limit=1000),
        MemoryLimitError, "use `solve`",
    ),
    "work": (
        lambda: fp.spectral_solve(REST, START, 9.0, work_limit=1e7),
        ToleranceError, "ask for earlier `s`, enlarge `tolerance`, raise `work_limit`",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_not_solved_is_refused(case):
    call, error, words = REFUSED[case]
    with pytest.raises(error, match=words):
        call()


def test_a_solution_says_what_it_is():
    found = fp.spectral_solve(REST, START, (0.0, 1.0), tolerance=1e-3)
    assert "SmoothSpectralSolution(s = 0 to 1 at 2 places, degrees " in repr(found)
    with pytest.raises(AttributeError, match="its series are mass, mean_xi1"):
        found.relative_entropy  # noqa: B018
