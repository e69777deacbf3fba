"""A study: one function over many noises, as a labelled `xarray.Dataset`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.arrays import Array
from fpsolve._support.labels import labels, made_with, marked, to_json
from fpsolve.errors import RunInterrupted
from fpsolve.model.potentials.dictionaries import potential_to_dict
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.sweeps.sweep import Case, Function, sweep

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "TEXT",
    "by_noise_and_part",
    "numbers_of",
    "outcomes",
    "study_dataset",
    "swept",
    "texts",
    "variables_of",
]

# What a case returns: its meaning, and its dimensions beyond those of the cases.
Column = tuple[str, tuple[str, ...]]
# Stands for a word, which has no unit and is empty where there is none.
TEXT: Column = ("", ())


def swept(
    function: Function,
    cases: Iterable[Mapping[str, Any]],
    dataset: Callable[[list[Case]], xr.Dataset],
    **where: Any,
) -> xr.Dataset:
    """The dataset of all cases; see `sweep` for what says where they run.

    Raises
    ------
    RunInterrupted
        After Ctrl-C; `solution` is the dataset of what was finished.
    """
    try:
        found = sweep(function, cases, **where)
    except RunInterrupted as interrupt:
        raise RunInterrupted(dataset(interrupt.solution)) from None
    return dataset(found)


def by_noise_and_part(
    cases: Sequence[Case], noises: Array, parts: Sequence[str], name: str = "noise"
) -> NDArray[Any]:
    """The cases as an array over (noise, part), None where a part was not asked for.

    Another number than the noise has another name.
    """
    places = [(case.arguments[name], case.arguments["part"]) for case in cases]
    known = dict(zip(places, cases, strict=True))
    rows = [[known.get((float(noise), part)) for part in parts] for noise in noises]
    return np.array(rows, dtype=object).reshape(len(noises), len(parts))


def numbers_of(cases: NDArray[Any], name: str, shape: tuple[int, ...] = ()) -> Array:
    """A number of every case, or an array of them; NaN where there is none.

    Parameters
    ----------
    cases : ndarray of Case or None
    name : str
        Among the values of a case.
    shape : tuple of int
        Of what one case returns; comes behind that of the cases.
    """
    found = np.full((*cases.shape, *shape), np.nan)
    for place, case in np.ndenumerate(cases):
        if case is not None and name in case.values:
            found[place] = case.values[name]
    return found


def variables_of(
    cases: NDArray[Any],
    over: tuple[str, ...],
    columns: Mapping[str, Column],
    sizes: Mapping[str, int],
) -> dict[str, Any]:
    """The declared columns of a study as variables, over its cases and further."""
    found: dict[str, Any] = {}
    for name, column in columns.items():
        meaning, further = column
        if column is TEXT:
            words = [str(case.values[name]) if case and case.values else ""
                     for case in cases.flat]  # fmt: skip
            found[name] = (over, texts(words).reshape(cases.shape))
        else:
            numbers = numbers_of(cases, name, tuple(sizes[one] for one in further))
            found[name] = ((*over, *further), numbers, labels(meaning))
    return found


def outcomes(cases: NDArray[Any], over: tuple[str, ...]) -> dict[str, Any]:
    """Status, message and seconds of every case."""

    def table(name: str, missing: Any, kind: type) -> NDArray[Any]:
        values = [missing if one is None else getattr(one, name) for one in cases.flat]
        return np.array(values, dtype=kind).reshape(cases.shape)

    seconds = table("seconds", np.nan, float)
    return {
        "status": (over, table("status", "not asked for", object)),
        "message": (over, table("message", "", object)),
        "seconds": (over, seconds, {"long_name": "wall time", "units": "s"}),
    }


def texts(words: Iterable[str]) -> NDArray[Any]:
    """Words as xarray keeps them whole."""
    return np.array(list(words), dtype=object)


def study_dataset(
    kind: str,
    title: str,
    potential: Potential,
    variables: Mapping[str, Any],
    coordinates: Mapping[str, Any],
    about: Mapping[str, Any],
) -> xr.Dataset:
    """The dataset of a study, with what it is about and what made it."""
    import xarray as xr

    attributes = {
        "title": title,
        "potential": to_json(potential_to_dict(potential)),
        "formula": potential.formula,
        **about,
        **made_with(),
    }
    return marked(xr.Dataset(variables, coordinates, attributes), kind)
