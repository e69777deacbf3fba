"""The model of a saved identification, in place of a file and of options."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from fpsolve.studies.identification.identification import Identification

__all__ = ["From", "read_identification", "tables_of_identification"]

From = Annotated[
    Path | None,
    typer.Option(
        "--from",
        metavar="IDENTIFICATION.nc",
        help="The model of an identification by `fpsolve identify`, in metres.",
    ),
]


def read_identification(
    path: Path, config: Path | None, options: list[str]
) -> Identification:
    """Return what a file holds; of a comparison that of the preferred model.

    ValueError if the model is given in two ways.
    """
    from fpsolve.results.load import load
    from fpsolve.studies.identification.comparison import IdentificationComparison
    from fpsolve.studies.identification.identification import Identification

    beside = [*options, *([] if config is None else [f"`{config}`"])]
    if beside:
        raise ValueError(
            f"{', '.join(beside)} must not be given beside `--from`, got `{path}`; the "
            "model is that of the identification."
        )
    found = load(path)
    if isinstance(found, IdentificationComparison):
        found = found.best
    if not isinstance(found, Identification):
        raise ValueError(
            f"`--from` must be an identification, got `{path}`, which is none; "
            "`fpsolve identify` writes one."
        )
    if found.model is None:
        raise ValueError(
            f"`--from` must have a model that can be read back, got `{path}`, whose "
            "reference curve is a user's own; use it in Python."
        )
    return found


def tables_of_identification(found: Identification) -> dict[str, Any]:
    """Sections of a configuration of the model, with a window of its size."""
    from fpsolve.model.smooth import SmoothLayDownModel

    described = found.model.to_dict()
    model = {"noise": described["noise"]}
    if isinstance(found.model, SmoothLayDownModel):
        model["relaxation_length"] = described["relaxation_length"]
    # The larger throwing range to a digit, so that lengths are round numbers.
    range_ = float(f"{max(found.parameters['sigma1'], found.parameters['sigma2']):.0e}")
    window = {"width": 20.0, "length": 20.0, "pixel": 0.1, "spacing": 0.1}
    return {
        "potential": described["potential"],
        "model": model,
        "curve": _plain(described["curve"]),
        "web": {
            name: float(f"{factor * range_:.3g}") for name, factor in window.items()
        },
    }


def _plain(described: dict[str, Any]) -> dict[str, Any]:
    """Tuples for lists, as constructors want them."""
    return {
        key: tuple(value) if isinstance(value, list) else value
        for key, value in described.items()
    }
