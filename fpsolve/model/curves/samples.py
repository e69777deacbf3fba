"""Where a reference curve is and how it moves: by this it is known again."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.digests import digest_of_answers
from fpsolve.model.curves.curve import Curve

__all__ = ["digest_of_curve"]

Function = Callable[..., Any]

# Arclengths of every scale that a run may have, decade by decade.
_DECADES, _IN_DECADE = range(-3, 4), 73


def digest_of_curve(curve: Curve, stops: Array | None = None) -> str:
    """Return the SHA-256 of γ and γ' at arclengths of all scales, and at given ones.

    The former are 0 and 511 on either side of it from 1e-3 to 1e4, each 1.032 times the
    one before. From each of the given stops to the next, to the second and to the
    fourth, the displacement counts too. What a curve does in between is not seen. Every
    bit counts, so that another machine may give another digest.

    Parameters
    ----------
    curve : Curve
    stops : ndarray, shape (n,), optional
        Ascending arclengths at which it is asked, if they are known.
    """
    asked = [np.zeros(1), *([] if stops is None else [stops])]
    for decade in _DECADES:
        ahead = 10.0**decade * np.geomspace(1.0, 10.0, _IN_DECADE, endpoint=False)
        asked += [ahead, -ahead]
    calls: list[tuple[Function, tuple[Array, ...]]] = []
    for s in asked:
        calls += [(_elementwise(one), (s,)) for one in (curve.position, curve.velocity)]
    if stops is not None:
        moved = _one_by_one(curve.displacement)
        calls += [(moved, (stops[:-n], stops[n:])) for n in (1, 2, 4)]
    return digest_of_answers(calls)


def _elementwise(function: Function) -> Function:
    """The function; one by one if it needs that.

    Schemes ask for one arclength at a time, so that a curve works which does not take
    arrays.
    """

    def asked(s: Array) -> Any:
        # A user's function raises whatever it likes.
        try:
            answer = function(s)
            if all(np.shape(part) == s.shape for part in answer):
                return answer
        except Exception:
            pass
        return _one_by_one(function)(s)

    return asked


def _one_by_one(function: Function) -> Function:
    def asked(*arguments: Array) -> tuple[Array, ...]:
        listed = (argument.tolist() for argument in arguments)
        answers = [function(*one) for one in zip(*listed, strict=True)]
        return tuple(np.array(answers, dtype=np.float64).T)

    return asked
