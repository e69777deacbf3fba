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
    Stored,
    Variable,
    check_counts,
    check_dimensions,
)
from fpsolve.evolution.parts import SAVED, STATUS, STEP, Recorded
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


class _Process(Part):
    """The energy process; None with a warning if its potential was a user's own.

    What described it is in the provenance then.
    """

    needed = ("potential", "noise")

    def write(self, result: Any) -> Stored:
        return process_attributes(result.process, result.provenance)

    def read(self, source: Source) -> dict[str, Any]:
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


class _Cells(Part):
    """The cells of energy; those of the file without the process that makes them."""

    needed = ("g", "face", "stationary_mass", "n_cells", "signed")

    def write(self, result: Any) -> Stored:
        grid, mean = result.grid, "mean energy of the cell, stationary law"
        return {
            "stationary_mass": ("g", grid.equilibrium,
                                labels("stationary cell masses")),
            "g": ("g", grid.centres, labels(mean)),
            "face": ("face", grid.faces, labels("ends of the cells")),
            "n_cells": grid.n_cells,
            "signed": int(grid.signed),
        }  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        dataset, signed = source.dataset, bool(source.about["signed"])
        n_cells = dataset["cell_mass"].shape[-1]
        check_counts("n_cells", source.about["n_cells"], n_cells, "`cell_mass`")
        cells = {"face": "face", "g": "g", "stationary_mass": "g"}
        for name, over in cells.items():
            check_dimensions(dataset, name, (over,))
        if source.fields["process"] is not None:
            return {"grid": source.fields["process"].grid(n_cells, signed)}
        faces, centres, masses = (dataset[name].values for name in cells)
        return {"grid": EnergyGrid.of_cells(faces, centres, masses, signed)}


_CELLS = ("s", "g")
SOLUTION = Layout(
    "law of the energy process of fibre lay-down",
    _Process(),
    SAVED,
    Variable("density", _CELLS, "cell means of p(g, s)",
             values=lambda solution: solution.densities),
    Variable("cell_mass", _CELLS, "masses of the cells", "masses"),
    _Cells(),
    Variable("initial_mass", ("g",), "masses of the cells at the start, as given",
             "initial_masses", optional=True),
    Recorded(words=words),
    Attribute("method"),
    STEP,
    STATUS,
)  # fmt: skip
PATHS = Layout(
    "Paths of the energy process of fibre lay-down",
    _Process(),
    Variable("s", ("s",), "arclength s of the saved points", increasing=True),
    Variable("energy", ("s", "path"), "signed energy G", "g"),
    STEP,
    # As text, because a seed may be longer than any integer of a file.
    Attribute("seed", write_as=str, read_as=int),
    Attribute("method"),
)
