"""The page itself: a section about every result, put into the template."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve._support.checks import check_path
from fpsolve._support.netcdf import reported_damage
from fpsolve.errors import FileFormatError
from fpsolve.pages.blocks import Section
from fpsolve.pages.kinds import PAGES
from fpsolve.results.kinds import kind_of, named
from fpsolve.results.load import load, opened

if TYPE_CHECKING:
    from jinja2 import Template

__all__ = ["html_page", "report", "report_text", "section_of"]

# What a damaged or tampered file makes those raise who read what is in it.
_DAMAGE = (ValueError, KeyError, TypeError, IndexError)


def report(
    results: Any, path: str | os.PathLike[str], *, title: str | None = None
) -> Path:
    """Write one self-contained HTML page about results: equation, numbers, figures.

    The page needs neither network nor scripts, can be printed, and is the same, byte
    for byte, for the same results. Nothing is written unless every result can be read.

    Parameters
    ----------
    results : one result or an iterable of them
        Each a file that fpsolve wrote (its path), a `Solution`, `Paths`, a
        `CrossCheck`, a `Spectrum`, an `EnergyProcess`, or the Dataset of a study of
        rates or limits.
    path : str or os.PathLike
        Where the page goes; its folder must exist.
    title : str, optional
        By default it names the results.

    Returns
    -------
    Path
        The path written.

    Raises
    ------
    ValueError
        If there is no result, or the page would take the place of one.
    TypeError
        If a result is of no known kind.
    FileNotFoundError, FileFormatError
        If a file does not exist, is damaged, or holds something else.

    Warns
    -----
    UserWarning
        If a model was made of a user's own functions, which its file cannot hold.
    """
    from fpsolve._support.files import atomic_path

    chosen, path = _listed(results), check_path("path", path)
    _check_place(chosen, path)
    # Begun before the figures are drawn, so that a place that does not do is told.
    with atomic_path(path) as draft:
        page = report_text(chosen, title=title)
        draft.write_text(page, encoding="utf-8", newline="\n")
    return path


def report_text(results: Any, *, title: str | None = None) -> str:
    """Return the page that `report` writes; raises what it does."""
    return html_page([section_of(one) for one in _listed(results)], title)


def html_page(sections: Sequence[Section], title: str | None = None) -> str:
    """Return the page with these sections as HTML.

    Parameters
    ----------
    sections : sequence of Section
    title : str, optional
    """
    from fpsolve._support.provenance import versions

    return _template().render(
        title=_title(sections) if title is None else title,
        sections=sections,
        version=versions()["fpsolve"],
    )


@cache
def _template() -> Template:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("fpsolve.pages"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    return environment.get_template("page.html")


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
        path = _existing_file(result)
        found = load(path)
        with reported_damage(path, *_DAMAGE):
            return _written(found, path.name)
    return _written(opened(_tables(result)), "")


def _tables(result: Any) -> Any:
    """Of an energy process, which is no result, a few coefficients and rates."""
    from fpsolve.reduced.energy.process import EnergyProcess
    from fpsolve.studies.energy_tables import tables_dataset

    is_process = isinstance(result, EnergyProcess)
    return tables_dataset(result, 10, 4) if is_process else result


def _written(result: Any, source: str) -> Section:
    section: Section = named(PAGES[kind_of(result)])(result, source)
    return section


def _existing_file(path: str | os.PathLike[str]) -> Path:
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


def _listed(results: Any) -> list[Any]:
    single = (
        isinstance(results, (str, os.PathLike))
        or not isinstance(results, Iterable)
        or hasattr(results, "data_vars")
    )
    chosen = [results] if single else list(results)
    if not chosen:
        raise ValueError("`results` must name at least one result, got none.")
    return chosen


def _check_place(results: Sequence[Any], path: Path) -> None:
    files = [one for one in results if isinstance(one, (str, os.PathLike))]
    for file in {*map(Path, files), *map(_existing_file, files)}:
        if os.path.realpath(file) == os.path.realpath(path):
            raise ValueError(
                f"`path` must not be a result that is reported on, got `{path}`; name "
                "a file that ends in .html."
            )


def _title(sections: Sequence[Section]) -> str:
    if len(sections) > 1:
        return f"Report on {len(sections)} results"
    only = sections[0]
    return f"{only.title}: {only.source}" if only.source else only.title
