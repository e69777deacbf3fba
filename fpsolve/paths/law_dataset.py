"""Laws of the start of paths, as an attribute and, where needed, arrays."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import construct
from fpsolve._support.digests import SAMPLED, digest_of, plain
from fpsolve._support.labels import labels, to_json
from fpsolve.evolution.layout import Part, Source, Stored
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.potentials.dictionaries import potential_from_dict
from fpsolve.paths.ensemble import START_BLOCK, GivenStart
from fpsolve.paths.laws import DensityLaw, EquilibriumLaw, GaussianLaw, PointLaw
from fpsolve.paths.randomness import start_generator

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["FORMULAS", "Law", "describe_law", "law_from_formula"]

# Stands in `provenance` for a law that cannot be read back.
_UNREADABLE = "initial_description"
_GIVEN = {"xi": "deviation ξ", "alpha": "angle α", "kappa": "curvature κ"}
_DENSITY = ("initial_xi1", "initial_xi2", "initial_alpha")
# Laws that are a formula, so that a dictionary holds them whole.
FORMULAS = (PointLaw, GaussianLaw, EquilibriumLaw)
_KNOWN = (*FORMULAS, DensityLaw, GivenStart)


def describe_law(law: Any, provenance: Mapping[str, Any]) -> dict[str, Any]:
    """Return a law without its arrays as a JSON-able dictionary."""
    # Of a class that is derived from one of these it would not be all.
    if type(law) in _KNOWN:
        known: dict[str, Any] = law.to_dict()
        return known
    if law is None and _UNREADABLE in provenance:
        return dict(provenance[_UNREADABLE])
    own = {"description": plain(repr(law)), SAMPLED: _digest_of_draws(law)}
    return {"kind": "custom", **own}


def _digest_of_draws(law: Any) -> str | None:
    """What a law of unknown code draws from a generator that is always the same."""
    # A user's law raises whatever it likes.
    try:
        sample = law.sample(start_generator(0, 0), START_BLOCK)
        return digest_of(np.column_stack(list(sample)))
    except Exception:
        return None


class Law(Part):
    """The law of the start; None with a warning if it was a user's own.

    Its description is added to the provenance then.
    """

    needed = ("initial",)

    def write(self, result: Any) -> Stored:
        """The law as JSON, and its arrays."""
        law = result.initial
        stored: Stored = {"initial": to_json(describe_law(law, result.provenance))}
        if isinstance(law, DensityLaw):
            about = labels("probability density of the start")
            stored["initial_density"] = (_DENSITY, np.asarray(law.p), about)
        if isinstance(law, GivenStart):
            for name, values in law.parts.items():
                over = ("initial_path", "component")[: values.ndim]
                words = f"{_GIVEN[name]} given for the start"
                stored[f"initial_{name}"] = (over, values, labels(words))
        return stored

    def read(self, source: Source) -> dict[str, Any]:
        """The law."""
        description = source.about["initial"]
        try:
            return {"initial": _law(dict(description), source.dataset)}
        except ValueError as error:
            source.provenance[_UNREADABLE] = dict(description)
            warnings.warn(
                f"the law of the start could not be read back, so `initial` is None: "
                f"{error}",
                UserWarning,
                stacklevel=6,
            )
            return {"initial": None}


def _law(parameters: dict[str, Any], dataset: xr.Dataset) -> Any:
    kind = parameters.pop("kind")
    if kind == "given":
        names = [f"initial_{name}" for name in _GIVEN if f"initial_{name}" in dataset]
        return GivenStart(*(dataset[name].values for name in names))
    if kind == "density":
        grid = PhaseSpaceGrid.from_dict(parameters["grid"])
        return DensityLaw(grid, dataset["initial_density"].values)
    return law_from_formula({"kind": kind, **parameters})


def law_from_formula(description: Mapping[str, Any]) -> Any:
    """Return the law of `FORMULAS` that its `to_dict` described.

    Raises
    ------
    ValueError
        If it is another one.
    """
    parameters = dict(description)
    kind = parameters.pop("kind")
    if kind == "equilibrium":
        return EquilibriumLaw(potential_from_dict(parameters["potential"]))
    if kind == "point":
        return construct(PointLaw, "initial", parameters)
    if kind == "gaussian":
        return construct(GaussianLaw, "initial", parameters)
    raise ValueError(f"{parameters.get('description', kind)} is a user's own law.")
