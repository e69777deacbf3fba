"""Checks of scalar arguments, with the wording that all constructors share.

Each returns the argument as a plain `float` or `int`, so that equality, hashing and
JSON do not depend on the kind of number a caller had at hand. Comparisons are written
so that NaN fails.
"""

from __future__ import annotations

import inspect
import math
import operator
import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

__all__ = [
    "check_call",
    "check_finite",
    "check_flag",
    "check_integer",
    "check_kind",
    "check_noise",
    "check_non_negative",
    "check_one_of",
    "check_pair",
    "check_path",
    "check_positive",
    "check_real",
    "check_tolerance",
    "construct",
    "has_length",
    "keep_checked",
    "shown",
    "told_apart",
]

T = TypeVar("T")

# The fourth power still has digits to spare; above A = 1e3 only the limit of large
# noise tells anything, and likewise below 1e-3 that of little noise.
_SMALLEST_NOISE, _LARGEST_NOISE = 1e-60, 1e60
# What a message shows of a value; more would bury the message.
_LONGEST = 80


def shown(value: Any) -> str:
    """Return the repr of a value on one line, or its kind where that is long."""
    # Whoever has written a class may raise in its repr, and a deep list does too.
    try:
        text = " ".join(repr(value).split())
    except Exception:
        text = f"an object of {type(value).__name__}"
    if len(text) <= _LONGEST:
        return text
    kind, shape = type(value).__name__, getattr(value, "shape", None)
    return f"{text[:_LONGEST]}… ({kind})" if shape is None else f"{kind} of {shape}"


def told_apart(*numbers: float) -> list[str]:
    """Return the numbers with as few digits, six at least, as tell them apart."""
    n_different = len(set(numbers))
    for digits in range(6, 18):
        texts = [f"{number:.{digits}g}" for number in numbers]
        if len(set(texts)) >= n_different:
            break
    return texts


def check_real(name: str, value: Any) -> float:
    """Return `value` as a float; TypeError when it is not a real number."""
    try:
        if isinstance(value, str | bytes | bytearray | bool):
            raise TypeError
        # Of numpy's scalars and arrays without a dimension, booleans and complex
        # numbers would pass, the latter with a warning.
        if getattr(getattr(value, "dtype", None), "kind", "f") not in "iuf":
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(
            f"`{name}` must be a real number, got {shown(value)}."
        ) from None
    except OverflowError:
        raise ValueError(
            f"`{name}` must be finite, got a number of {len(str(value))} digits."
        ) from None


def check_finite(name: str, value: Any) -> float:
    """Return `value` as a float; ValueError when it is NaN or infinite."""
    number = check_real(name, value)
    if not math.isfinite(number):
        raise ValueError(f"`{name}` must be finite, got {number:g}.")
    return number


def check_positive(name: str, value: Any, remedy: str = "") -> float:
    """Return `value` as a float; ValueError unless 0 < value < infinity."""
    number = check_real(name, value)
    if not 0 < number < math.inf:
        raise ValueError(
            f"`{name}` must be positive and finite, got {number:g}{remedy}."
        )
    return number


def check_noise(name: str, value: Any, remedy: str = "") -> float:
    """Return a noise A > 0 as a float; ValueError unless A⁴ and A⁻⁴ are numbers."""
    noise = check_positive(name, value, remedy)
    if not noise <= _LARGEST_NOISE:
        raise ValueError(
            f"`{name}` must be at most {_LARGEST_NOISE:g}, got {noise:g}; its "
            "square is the diffusivity of the angle."
        )
    if not noise >= _SMALLEST_NOISE:
        raise ValueError(
            f"`{name}` must be at least {_SMALLEST_NOISE:g}, got {noise:g}; its "
            "square is the diffusivity of the angle, and 0 means none."
        )
    return noise


def check_non_negative(name: str, value: Any, remedy: str = "") -> float:
    """Return `value` as a float; ValueError unless 0 <= value < infinity."""
    number = check_real(name, value)
    if not 0 <= number < math.inf:
        raise ValueError(
            f"`{name}` must be non-negative and finite, got {number:g}{remedy}."
        )
    return number


def check_pair(name: str, value: Any) -> tuple[float, float]:
    """Return two finite floats; ValueError unless there are two, TypeError else."""
    if not has_length(value, 2):
        raise ValueError(f"`{name}` must be two numbers, got {shown(value)}.")
    first, second = value
    return check_finite(name, first), check_finite(name, second)


def has_length(value: Any, n: int) -> bool:
    """Whether the value is a tuple, a list or an array of n entries, in order."""
    if hasattr(value, "shape"):
        return tuple(value.shape) == (n,)
    return isinstance(value, tuple | list) and len(value) == n


def check_tolerance(name: str, value: Any, remedy: str = "") -> float:
    """Return `value` as a float; ValueError unless 0 < value, infinity included."""
    number = check_real(name, value)
    if not number > 0:
        raise ValueError(f"`{name}` must be positive, got {number:g}{remedy}.")
    return number


def check_flag(name: str, value: Any) -> bool:
    """Return `value` as a bool; TypeError for anything else, "no" above all."""
    # Of numpy, too, whose boolean has two names.
    if type(value).__name__ in ("bool", "bool_"):
        return bool(value)
    raise TypeError(f"`{name}` must be True or False, got {shown(value)}.")


def check_kind(name: str, value: Any, kind: type, remedy: str = "") -> None:
    """Raise TypeError unless `value` is an instance of `kind`."""
    if not isinstance(value, kind):
        article = "an" if kind.__name__[0] in "AEIOU" else "a"
        hint = f"; {remedy}" if remedy else ""
        raise TypeError(
            f"`{name}` must be {article} {kind.__name__}, got {shown(value)}{hint}."
        )


def check_one_of(name: str, value: Any, known: Iterable[str]) -> None:
    """Raise ValueError unless `value` is one of the known names."""
    names = list(known)
    # An array would be compared with every name at once.
    if not isinstance(value, str | None) or value not in names:
        choices = ", ".join(map(repr, names))
        raise ValueError(f"`{name}` must be one of {choices}, got {shown(value)}.")


def check_call(name: str, value: Any, example: str) -> None:
    """Raise TypeError unless `value` can be called; `example` shows how it will be."""
    if not callable(value):
        raise TypeError(f"`{name}` must be callable as {example}, got {shown(value)}.")


def check_path(name: str, value: Any) -> Path:
    """Return `value` as a path; TypeError or ValueError unless it names a file."""
    if not isinstance(value, str | os.PathLike) or isinstance(os.fspath(value), bytes):
        raise TypeError(f"`{name}` must be the name of a file, got {shown(value)}.")
    path = Path(value)
    if not os.fspath(value) or "\0" in str(path):
        raise ValueError(f"`{name}` must be the name of a file, got {value!r}.")
    return path


def check_integer(
    name: str, value: Any, at_least: int, at_most: int | None = None
) -> int:
    """Return `value` as an int; ValueError below `at_least` or above `at_most`."""
    try:
        if isinstance(value, bool):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"`{name}` must be an integer, got {shown(value)}.") from None
    if number < at_least:
        raise ValueError(f"`{name}` must be at least {at_least}, got {number}.")
    if at_most is not None and number > at_most:
        raise ValueError(f"`{name}` must be at most {at_most}, got {number}.")
    return number


def keep_checked(made: Any, check: Callable[[str, Any], Any], *names: str) -> None:
    """Replace attributes of a frozen dataclass by what a check makes of them."""
    for name in names:
        object.__setattr__(made, name, check(name, getattr(made, name)))


def construct(target: type[T], name: str, parameters: Mapping[str, Any]) -> T:
    """Return target(**parameters); ValueError when the names do not fit.

    Parameters come from files here, so a misspelt one is a wrong value, not a
    programming error.
    """
    try:
        inspect.signature(target).bind(**parameters)
    except TypeError as error:
        known = ", ".join(inspect.signature(target).parameters) or "none"
        raise ValueError(
            f"parameters of `{name}` must be {known}, got "
            f"{', '.join(parameters) or 'none'}: {error}."
        ) from None
    return target(**parameters)
