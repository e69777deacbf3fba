"""How the mean pattern of a web is stored."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fpsolve._support.labels import labels, to_json
from fpsolve.evolution.layout import (
    Layout,
    Part,
    Source,
    Stored,
    Variable,
    check_dimensions,
)

__all__ = ["PATTERN", "Phases"]

_WAVES = ("n", "m")
_CELL = ("x2", "x1")


class _Coefficients(Part):
    """c_nm as two arrays of numbers, over the numbers of waves along and across."""

    needed = ("coefficient_real", "coefficient_imag", "coefficient_error", *_WAVES)

    def write(self, result: Any) -> Stored:
        values = result.coefficients
        words = {"n": "waves along the belt", "m": "waves across the belt"}
        numbers = {
            name: (name, _numbers(size), labels(words[name]))
            for name, size in zip(_WAVES, values.shape, strict=True)
        }
        return {
            "coefficient_real": (_WAVES, values.real, labels("real part of c_nm")),
            "coefficient_imag": (_WAVES, values.imag, labels("imaginary part of c_nm")),
            "coefficient_error": (_WAVES, result.errors, labels("error of |c_nm|")),
            **numbers,
        }

    def read(self, source: Source) -> dict[str, Any]:
        dataset = source.dataset
        for name in self.needed[:3]:
            check_dimensions(dataset, name, _WAVES)
        for name in _WAVES:
            size = dataset.sizes[name]
            # From -n to n: an odd number of them.
            expected = _numbers(size) if size % 2 else np.zeros(0)
            if not np.array_equal(dataset[name], expected):
                raise ValueError(f"`{name}` must go from -n to n by 1, got others")
        real, imaginary, errors = (dataset[name].values for name in self.needed[:3])
        coefficients = np.empty(real.shape, np.complex128)
        # Part by part, so that every bit is kept.
        coefficients.real, coefficients.imag = real, imaginary
        return {"coefficients": coefficients, "errors": errors}


class Phases(Part):
    """What was said of the phases: a word, or angles."""

    needed = ("nozzle_phases",)

    def write(self, result: Any) -> Stored:
        """The word, or the angles, in a list."""
        phases = result.phases
        told = [phases] if isinstance(phases, str) else list(phases)
        return {"nozzle_phases": to_json(told)}

    def read(self, source: Source) -> dict[str, Any]:
        """The same."""
        told = source.about["nozzle_phases"]
        if told in (["in phase"], ["independent"]):
            return {"phases": told[0]}
        if not told or any(type(one) not in (int, float) for one in told):
            raise ValueError(
                "`nozzle_phases` must be a word or angles of nozzles, got others"
            )
        return {"phases": tuple(map(float, told))}


def _positive(value: Any) -> float:
    number = float(value)
    if not 0 < number < math.inf:
        raise ValueError(f"a pattern must have positive lengths, got {number:g}")
    return number


def _numbers(size: int) -> Any:
    return np.arange(size) - size // 2


PATTERN = Layout(
    "Expected length of fibre per area",
    Variable("length", (), "length of a cell of the pattern along the belt",
             kind=_positive),
    Variable("width", (), "width of a cell of the pattern across it", kind=_positive),
    Variable("spacing", (), "distance of neighbouring nozzles", kind=_positive),
    Variable("mean", (), "mean length of fibre per area, 1/(v d)", kind=_positive),
    _Coefficients(),
    Phases(),
    Variable("length_density", _CELL, "expected length of fibre per area",
             values=lambda result: result.length_density),
    Variable("x1", ("x1",), "along the belt", values=lambda result: result.x1),
    Variable("x2", ("x2",), "across the belt", values=lambda result: result.x2),
)  # fmt: skip
