"""The white-noise study as a labelled `xarray.Dataset`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fpsolve._support.arrays import Array
from fpsolve._support.labels import labels
from fpsolve.model.potentials.potential import Potential
from fpsolve.studies.limits.large_noise_dataset import distance_variables
from fpsolve.studies.limits.quantities import Quantity
from fpsolve.studies.sweeps.study import (
    by_noise_and_part,
    outcomes,
    study_dataset,
    texts,
)
from fpsolve.studies.sweeps.sweep import Case

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["white_noise_dataset"]

# Order in R and meaning, by part and measure.
_MEASURES: dict[str, dict[str, tuple[float, str]]] = {
    "density": {
        "joint": (1.0, "‖p − p_0‖₁ of (ξ, α)"),
        "marginal": (1.0, "‖p − p_0‖₁ of ξ"),
        "angle": (1.0, "‖p − p_0‖₁ of α"),
        "mean": (1.0, "difference of E ξ"),
        "second_moment": (1.0, "difference of E‖ξ‖²"),
        "direction": (1.0, "difference of E τ"),
    },
    "paths": {
        "angle": (0.5, "E|α − α_0|, same noise"),
        "position": (1.0, "E‖ξ − ξ_0‖, same noise"),
        "corrected": (1.0, "E|α + Rκ − α_0|, same noise"),
    },
    "gap": {
        "gap": (1.0, "|gap − gap_0|"),
        "next_term": (2.0, "|gap − gap_0 − R gap_0′|"),
    },
    "variance": {
        "variance": (1.0, "|Var ξ₁ − σ²|"),
        "next_term": (2.0, "|Var ξ₁ − σ² − R (Var ξ₁)_0′|"),
    },
}


def white_noise_dataset(
    potential: Potential,
    lengths: Array,
    parts: Sequence[str],
    cases: Sequence[Case],
    about: Mapping[str, Any],
) -> xr.Dataset:
    """The cases of a study as a Dataset; NaN where there is none."""
    over = "relaxation_length"
    placed = by_noise_and_part(cases, lengths, parts, over)
    listed = [
        Quantity(part, measure, order, meaning)
        for part in parts
        for measure, (order, meaning) in _MEASURES[part].items()
    ]
    columns = dict(zip(parts, placed.T, strict=True))
    variables = distance_variables(columns, listed, lengths, over)
    coordinates = {
        over: (over, lengths, labels("relaxation length R")),
        "quantity": ("quantity", texts(one.name for one in listed)),
        "meaning": ("quantity", texts(one.meaning for one in listed)),
        "part": ("part", texts(parts)),
    }
    variables |= outcomes(placed, (over, "part"))
    title = "Distance of smooth fibres to their white-noise limit"
    return study_dataset("white-noise", title, potential, variables, coordinates, about)
