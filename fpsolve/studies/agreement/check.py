"""The result of comparing a density with paths: tests, numbers and a verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.evolution.schedule import index_of
from fpsolve.grids.smooth import AnyGrid
from fpsolve.model.fibre import FibreModel
from fpsolve.studies.agreement.layout import CHECK
from fpsolve.studies.agreement.outcome import AgreementTest
from fpsolve.studies.agreement.wording import report

__all__ = ["CrossCheck"]


@dataclass(frozen=True, eq=False)
class CrossCheck(Saved):
    """Whether a density and an ensemble of paths agree, in numbers and in words.

    ``print(check)`` says whether they agree, how likely a false alarm was, and how
    large a disagreement would have been seen. ``bool(check)`` is `agrees`.

    Attributes
    ----------
    model : LayDownModel or SmoothLayDownModel or None
        That of the density.
    grid : PhaseSpaceGrid or SmoothPhaseSpaceGrid
    s : ndarray, shape (n_s,)
    tests : tuple of AgreementTest
    false_alarm : float
        Upper bound of the probability that any test disagrees although density and
        paths have the same law; divided evenly among the tests (Bonferroni).
    n_paths : int
    solver, sampler : dict
        Where the density and the paths come from: names, steps, seed.
    probabilities, counts : mapping of ndarray
        Of the cells of the grid along "xi1", "xi2" and "alpha", shapes (n_s, n);
        probabilities of the density, counts of paths inside the box.
    call : Call or None
        That of `cross_check`; None for two results that were compared.
    provenance : dict
        Versions, environment, date and times.
    """

    kind: ClassVar[str] = "check"
    layout = CHECK

    model: FibreModel | None
    grid: AnyGrid
    s: Array
    tests: tuple[AgreementTest, ...]
    false_alarm: float
    n_paths: int
    solver: dict[str, Any]
    sampler: dict[str, Any]
    probabilities: Mapping[str, Array]
    counts: Mapping[str, NDArray[np.int64]]
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    @property
    def agrees(self) -> bool:
        """Whether every test agrees."""
        return all(test.agrees for test in self.tests)

    @property
    def failed(self) -> tuple[AgreementTest, ...]:
        """Tests that disagree, the least likely first."""
        failed = (test for test in self.tests if not test.agrees)
        return tuple(sorted(failed, key=lambda test: test.p_value))

    @property
    def detectable(self) -> dict[str, Array]:
        """Smallest disagreement seen with probability 0.99: name to (n_s,) array."""
        names = dict.fromkeys(test.name for test in self.tests)
        return {
            name: np.array([t.detectable for t in self.tests if t.name == name])
            for name in names
        }

    def test(self, name: str, s: float) -> AgreementTest:
        """The test of that name at s.

        Raises
        ------
        ValueError
            If there is none.
        """
        place = index_of(np.array(self.s), s)
        for test in self.tests:
            if test.name == name and place is not None and test.s == self.s[place]:
                return test
        known = ", ".join(repr(test) for test in self.detectable)
        places = ", ".join(f"{place:g}" for place in self.s)
        raise ValueError(
            f"`name` must be one of {known} and `s` one of {places}, got {name!r} at "
            f"{s:g}."
        )

    def __bool__(self) -> bool:
        return self.agrees

    def __str__(self) -> str:
        return report(self)

    def __repr__(self) -> str:
        outcome = "agree" if self.agrees else "disagree"
        return (
            f"CrossCheck(density and {self.n_paths} paths {outcome}: "
            f"{len(self.failed)} of {len(self.tests)} tests failed, "
            f"false alarm {self.false_alarm:g})"
        )

    def to_dict(self) -> dict[str, Any]:
        """The verdict, the tests and where both sides come from, ready for JSON.

        What is not known is None: JSON has no NaN.
        """
        return {
            "agrees": self.agrees,
            "verdict": str(self),
            "model": None if self.model is None else self.model.equation,
            "grid": self.grid.to_dict(),
            "s": self.s.tolist(),
            "false_alarm": self.false_alarm,
            "n_paths": self.n_paths,
            "solver": self.solver,
            "sampler": self.sampler,
            "tests": [
                {
                    **{name: _known(value) for name, value in asdict(test).items()},
                    "agrees": test.agrees,
                }
                for test in self.tests
            ],
        }


def _known(value: Any) -> Any:
    """Return the value, or None for a number that is not finite."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
