"""From a file, or a result, to the section of a page about it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from fpsolve._support.netcdf import reported_damage
from fpsolve.errors import FileFormatError
from fpsolve.pages.blocks import Section
from fpsolve.pages.kinds import PAGES
from fpsolve.results.kinds import kind_of, named
from fpsolve.results.load import load, opened

__all__ = ["existing_file", "section_of"]

# What a damaged or tampered file makes those raise who read what is in it.
_DAMAGE = (ValueError, KeyError, TypeError, IndexError)


def section_of(result: Any) -> Section:
    """Return the section about a file or a result of any kind.

    Raises
    ------
    FileNotFoundError, FileFormatError
        If a file does not exist, is damaged, or holds something else.
    TypeError
        If the result is of no known kind.
    """
    if isinstance(result, (str, os.PathLike)):
        path = existing_file(result)
        found = load(path)
        with reported_damage(path, *_DAMAGE):
            return _written(found, path.name)
    return _written(opened(_tables(result)), "")


def _tables(result: Any) -> Any:
    """Of an energy process, which is no result, a few coefficients and rates."""
    from fpsolve.reduced.energy.process import EnergyProcess
    from fpsolve.studies.energy_tables import tables_dataset

    return (
        tables_dataset(result, 10, 4) if isinstance(result, EnergyProcess) else result
    )


def existing_file(path: str | os.PathLike[str]) -> Path:
    """Return the file that holds the numbers: for the JSON of a check its netCDF.

    Both come from `fpsolve check`; the JSON holds a part of the other.
    """
    path = Path(path)
    if path.suffix != ".json" or not path.is_file():
        return path
    numbers = path.with_suffix(".nc")
    if not numbers.is_file():
        raise FileFormatError(path, f"the numbers are in `{numbers}`, which is missing")
    return numbers


def _written(result: Any, source: str) -> Section:
    section: Section = named(PAGES[kind_of(result)])(result, source)
    return section
