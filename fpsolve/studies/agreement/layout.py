"""How a cross-check is stored: numbers of the tests, and marginals of both sides."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from fpsolve._support.labels import labels, to_json
from fpsolve.evolution.layout import (
    Attribute,
    Columns,
    Layout,
    Part,
    Source,
    Stored,
    check_counts,
)
from fpsolve.evolution.parts import Model
from fpsolve.grids.dictionaries import grid_from_dict
from fpsolve.studies.agreement.outcome import MARGINALS, AgreementTest

__all__ = ["CHECK"]

NUMBERS = {
    "statistic": "χ², largest |z|, or z",
    "critical": "|statistic| from which on the test disagrees",
    "p_value": "p-value",
    "threshold": "p-value below which the test disagrees",
    "detectable": "disagreement seen with probability 0.99",
    "difference": "disagreement found",
    "step_error": "estimated step error of density and paths",
    "grid_error": "estimated error of the density's grid, for which the test allows",
    "density": "value by the density",
    "paths": "value by the paths",
    "standard_error": "standard error of the value by the paths",
}
# Stands for the degrees of freedom of a test that has none.
NO_DEGREES = -1
_TESTS = ("s", "test")


class _Tests(Part):
    """Every number of every test, over arclengths, then names."""

    needed = (*NUMBERS, "degrees", "s", "test")

    def write(self, result: Any) -> Stored:
        degrees = [
            NO_DEGREES if one.degrees is None else one.degrees for one in result.tests
        ]
        agrees = [one.agrees for one in result.tests]
        tables = {
            **{name: ([getattr(one, name) for one in result.tests], np.float64, words)
               for name, words in NUMBERS.items()},
            "agrees": (agrees, np.int8, "1 if the test agrees"),
            "degrees": (degrees, np.int64,
                        "degrees of freedom, -1 if the test has none"),
        }  # fmt: skip
        names = np.array(list(result.detectable), dtype=object)
        here = {"s": ("s", result.s, labels("arclength s")), "test": ("test", names)}
        return here | {
            name: (_TESTS, np.array(values, dtype=kind).reshape(len(result.s), -1),
                   labels(words))
            for name, (values, kind, words) in tables.items()
        }  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        values = {name: source.dataset[name].to_numpy() for name in self.needed}
        return {"s": values["s"], "tests": tuple(tests_of(values))}


def tests_of(values: dict[str, Any]) -> Iterator[AgreementTest]:
    """Every test, in the order of arclengths, then names."""
    for row, s in enumerate(values["s"]):
        for column, name in enumerate(values["test"]):
            free = int(values["degrees"][row, column])
            yield AgreementTest(
                float(s), str(name),
                degrees=None if free == NO_DEGREES else free,
                **{number: float(values[number][row, column]) for number in NUMBERS},
            )  # fmt: skip


class _Cells(Part):
    """The grid, whose axes are those of the marginals; of as many cells as they."""

    needed = ("grid",)

    def write(self, result: Any) -> Stored:
        centres = {axis: (axis, getattr(result.grid, axis)) for axis in MARGINALS}
        return {**centres, "grid": to_json(result.grid.to_dict())}

    def read(self, source: Source) -> dict[str, Any]:
        grid = grid_from_dict(source.about["grid"])
        for axis, n in zip(MARGINALS, grid.shape[:3], strict=True):
            check_counts("grid", n, source.dataset.sizes[axis], f"`{axis}`")
        return {"grid": grid}


CHECK = Layout(
    "Density against paths",
    Attribute("verdict", values=str),
    Attribute("agrees", values=lambda check: int(check.agrees)),
    Attribute("false_alarm", read_as=float),
    Attribute("n_paths"),
    Model(),
    _Cells(),
    Attribute("solver", write_as=to_json),
    Attribute("sampler", write_as=to_json),
    _Tests(),
    Columns("probabilities", MARGINALS, ("s", "{}"),
            "probability of a cell of {} by the density".format, "probability_{}"),
    Columns("counts", MARGINALS, ("s", "{}"),
            "paths inside the box in a cell of {}".format, "count_{}"),
)  # fmt: skip
