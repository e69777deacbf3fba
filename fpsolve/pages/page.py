"""The page itself: sections put into the template, written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from fpsolve._support.checks import check_path
from fpsolve.pages.blocks import Section
from fpsolve.pages.reading import existing_file, section_of

__all__ = ["html_page", "report", "report_text"]


def report(
    results: Any,
    path: str | os.PathLike[str],
    *,
    title: str | None = None,
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
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from fpsolve._support.provenance import versions

    environment = Environment(
        loader=PackageLoader("fpsolve.pages"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    return environment.get_template("page.html").render(
        title=_title(sections) if title is None else title,
        sections=sections,
        version=versions()["fpsolve"],
    )


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
    for file in {*map(Path, files), *map(existing_file, files)}:
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
