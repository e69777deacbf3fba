"""How the energy process, its cells and its laws are stored."""

from __future__ import annotations

import warnings
from typing import Any

from fpsolve._support.labels import UNREADABLE, labels, to_json
from fpsolve.evolution.layout import (
    Attribute,
    Layout,
    Part,
    Source,
    Variable,
    Variables,
    Written,
    check_counts,
    check_dimensions,
)
from fpsolve.evolution.parts import SAVED, STATUS, STEP, Arclengths, Recorded
from fpsolve.model.potentials.dictionaries import potential_from_dict, potential_to_dict
from fpsolve.model.stored import is_of_a_user
from fpsolve.reduced.energy.grid import EnergyGrid

__all__ = ["PATHS", "SOLUTION", "process_attributes"]

SERIES = {
    "mass": "mass ∫ p dg",
    "relative_entropy": "relative entropy to the stationary law S/∫S",
    "entropy_dissipation": "entropy dissipation −dH/ds of the discrete equation",
    "minimum": "smallest cell mass",
    "saved_l1": "L¹ norm of p",
}


def words(name: str) -> str:
    """Long name of a series, or of its error."""
    quantity = name.removesuffix("_error")
    known = SERIES[quantity]
    return known if quantity == name else f"estimated error in ds of: {known}"


def process_attributes(process: Any, provenance: Any) -> dict[str, Any]:
    """Return the attributes that say which process it is.

    Of a process that could not be read back they go on as they came.
    """
    if process is None:
        return dict(provenance["process_description"])
    return {
        "equation": "dG = −(A²/2) G ds + σ(G) dW, σ² = A² J(G)/S(G)",
        "potential": to_json(potential_to_dict(process.potential)),
        "formula": process.potential.formula,
        "noise": process.noise,
        "radius": process.radius,
        "g_max": process.g_max,
    }


class Process(Part):
    """The energy process; None with a warning if its potential was a user's own.

    What described it is in the provenance then.
    """

    needed_attributes = ("potential", "noise")

    def attributes(self, result: Any) -> dict[str, Any]:
        """Its potential and noise, and what follows from them."""
        return process_attributes(result.process, result.provenance)

    def read(self, source: Source) -> dict[str, Any]:
        """The process, made by the owner of that name."""
        about = source.about
        try:
            potential = potential_from_dict(about["potential"])
        except ValueError as error:
            if not is_of_a_user("potential", about["potential"]):
                raise
            names = ("equation", "formula", "noise", "radius", "g_max")
            described = {name: about[name] for name in names if name in about}
            described["potential"] = to_json(about["potential"])
            source.provenance[UNREADABLE[2]] = described
            warnings.warn(
                f"the process could not be read back, so `process` is None: {error}",
                UserWarning,
                stacklevel=6,
            )
            return {"process": None}
        noise = float(about["noise"])
        return {"process": source.owners["process"](potential, noise)}


class Cells(Part):
    """The cells of energy; those of the file without the process that makes them."""

    needed = ("g", "face", "stationary_mass")
    needed_attributes = ("n_cells", "signed")

    def variables(self, result: Any) -> Variables:
        """Their stationary masses."""
        masses = result.grid.equilibrium
        return {"stationary_mass": ("g", masses, labels("stationary cell masses"))}

    def coordinates(self, result: Any) -> Variables:
        """Their centres (stationary means) and ends."""
        grid, mean = result.grid, "mean energy of the cell, stationary law"
        return {
            "g": ("g", grid.centres, labels(mean)),
            "face": ("face", grid.faces, labels("ends of the cells")),
        }

    def attributes(self, result: Any) -> dict[str, Any]:
        """Their number, and whether energies are signed."""
        return {"n_cells": result.grid.n_cells, "signed": int(result.grid.signed)}

    def read(self, source: Source) -> dict[str, Any]:
        """As many cells as there are masses."""
        dataset, signed = source.dataset, bool(source.about["signed"])
        n_cells = dataset["cell_mass"].shape[-1]
        check_counts("n_cells", source.about["n_cells"], n_cells, "`cell_mass`")
        for name, over in (("g", "g"), ("face", "face"), ("stationary_mass", "g")):
            check_dimensions(dataset, name, (over,))
        process = source.fields["process"]
        if process is not None:
            return {"grid": process.grid(dataset.sizes["g"], signed)}
        faces, centres, masses = (dataset[name].values for name in
                                  ("face", "g", "stationary_mass"))  # fmt: skip
        return {"grid": EnergyGrid.of_cells(faces, centres, masses, signed)}


_CELLS = ("s", "g")
SOLUTION = Layout(
    "law of the energy process of fibre lay-down",
    Process(),
    SAVED,
    Written("density", _CELLS, lambda one: one.densities, "cell means of p(g, s)"),
    Variable("cell_mass", _CELLS, "masses of the cells", "masses"),
    Cells(),
    Variable("initial_mass", ("g",), "masses of the cells at the start, as given",
             "initial_masses", optional=True),
    Recorded(words=words),
    Attribute("method"),
    STEP,
    STATUS,
)  # fmt: skip
PATHS = Layout(
    "Paths of the energy process of fibre lay-down",
    Process(),
    Arclengths("s", ("s",), "arclength s of the saved points"),
    Variable("energy", ("s", "path"), "signed energy G", "g"),
    STEP,
    # As text, because a seed may be longer than any integer of a file.
    Attribute("seed", write=str, make=int),
    Attribute("method"),
)
