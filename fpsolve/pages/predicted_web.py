"""The page about a web that was predicted."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fpsolve.pages.blocks import Block, Facts, Part, Section, Table
from fpsolve.pages.figures import drawings
from fpsolve.pages.origin import provenance_part
from fpsolve.pages.settings import model_facts, model_or_unread

if TYPE_CHECKING:
    from fpsolve._support.arrays import Array
    from fpsolve.web.prediction import WebPrediction

__all__ = ["section"]


def section(prediction: WebPrediction, source: str) -> Section:
    """Return the section of a page about a predicted web."""
    items = [
        *model_facts(prediction.model),
        ("distance of the spinning positions", f"{prediction.spacing:g}"),
        ("positions", prediction.positions),
        ("laid length per area", f"1/(v d) = {prediction.mean:.6g}"),
        ("MD/CD", f"{prediction.machine_cross_ratio:.6g}"),
    ]
    return Section("Predicted web", source, [
        Part("Equation", model_or_unread(prediction.model, prediction.provenance)),
        Part("Parameters", [Facts(items)]),
        Part("Homogeneity", _tables(prediction)),
        Part("Figure", drawings(prediction)),
        provenance_part(prediction.provenance, call=prediction.call),
    ])  # fmt: skip


def _tables(prediction: WebPrediction) -> list[Block]:
    zones = zip(prediction.zones, prediction.cv, prediction.errors, strict=True)
    tables: list[Block] = [Table(
        "Coefficient of variation of square zones.", ("side", "CV", "error"),
        [(f"{side:g}", f"{cv:.5g}", f"{error:.1e}") for side, cv, error in zones],
    )]  # fmt: skip
    bands = [
        (f"{short:g} to {long:g}", f"{power:.5g}", f"{error:.1e}")
        for short, long, power, error in zip(
            prediction.shortest, prediction.longest, prediction.cloudiness,
            prediction.cloudiness_errors, strict=True,
        )
    ]  # fmt: skip
    if bands:
        told = "Cloudiness: the part of CV² with wavelengths in a band."
        tables.append(Table(told, ("wavelengths", "part", "error"), bands))
    strips = [
        (f"{prediction.spacing / j:g}", f"{amplitude:.3g}", f"{error:.1e}")
        for j, (amplitude, error) in enumerate(
            zip(prediction.strips, prediction.strip_errors, strict=True), start=1
        )
    ]
    if strips:
        told = "Strips of the mean web, relative to it."
        tables.append(Table(told, ("period", "amplitude", "error"), strips))
    return tables + _carried(prediction) + _gradients(prediction)


def _carried(prediction: WebPrediction) -> list[Block]:
    """What the errors of identified parameters make of CV."""
    if prediction.carried_errors is None:
        return []
    rows = [
        (f"{side:g}", f"{error:.2g}")
        for side, error in zip(prediction.zones, prediction.carried_errors, strict=True)
    ]
    told = "Standard errors of CV by those of the identified parameters."
    return [Table(told, ("side", "standard error"), rows)]


def _gradients(prediction: WebPrediction) -> list[Block]:
    """∂CV by every parameter, a column for every zone; then of bands and of MD/CD."""
    if prediction.gradient is None or prediction.gradient_errors is None:
        return []
    tables = [_derivatives(
        prediction,
        "Derivatives of CV in the parameters, each with bounds of its error.",
        [f"side {side:g}" for side in prediction.zones],
        prediction.gradient, prediction.gradient_errors,
    )]  # fmt: skip
    ratio, wrong = (
        prediction.machine_cross_gradient,
        prediction.machine_cross_gradient_errors,
    )
    of_bands = prediction.cloudiness_gradient, prediction.cloudiness_gradient_errors
    if ratio is None or wrong is None or of_bands[0] is None or of_bands[1] is None:
        return [*tables]
    bands = zip(prediction.shortest, prediction.longest, strict=True)
    headings = [*(f"{short:g} to {long:g}" for short, long in bands), "MD/CD"]
    tables.append(_derivatives(
        prediction, "Derivatives of the cloudiness of bands and of MD/CD.", headings,
        np.column_stack([of_bands[0], ratio]), np.column_stack([of_bands[1], wrong]),
    ))  # fmt: skip
    return [*tables]


def _derivatives(
    prediction: WebPrediction,
    caption: str,
    headings: list[str],
    values: Array,
    errors: Array,
) -> Table:
    """A row for every parameter."""
    rows = []
    for name, some, wrong in zip(prediction.parameters, values, errors, strict=True):
        pairs = zip(some, wrong, strict=True)
        rows.append((name, *(f"{one:.4g} ± {error:.1g}" for one, error in pairs)))
    return Table(caption, ("parameter", *headings), rows, words=frozenset((0,)))
