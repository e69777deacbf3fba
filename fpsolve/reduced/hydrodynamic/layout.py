"""How densities and paths of the hydrodynamic limit are stored."""

from __future__ import annotations

import numpy as np

from fpsolve.evolution.layout import Attribute, Layout, Variable
from fpsolve.evolution.parts import SAVED, STATUS, STEP, Model, OnGrid, Recorded
from fpsolve.evolution.series import long_name
from fpsolve.grids.plane import PlaneGrid

__all__ = ["PATHS", "SOLUTION"]

# Where the limit's quantity differs from that of the full equation.
WORDS = {
    "mass": "mass ∫ 𝒫 dξ",
    "relative_entropy": "relative entropy H(𝒫|𝒫_S)",
    "entropy_dissipation": "entropy dissipation −dH/ds of the discrete equation",
    "minimum": "smallest value of 𝒫",
    "density_l1_error": "estimated error of: L¹ norm of 𝒫",
}
_COMPONENT, _PAIR = ("s", "component"), ("component", "other")

SOLUTION = Layout(
    "hydrodynamic limit of fibre lay-down",
    Model("limit", owned=True),
    SAVED,
    OnGrid(PlaneGrid.from_dict, "plane density 𝒫(s, ξ₁, ξ₂) of the hydrodynamic limit"),
    Variable(
        "initial_density",
        PlaneGrid.axes,
        "plane density 𝒫₀ of the start",
        optional=True,
    ),
    Recorded(words=lambda name: WORDS.get(name) or long_name(name)),
    Attribute("method"),
    STEP,
    STATUS,
)
PATHS = Layout(
    "Paths of the hydrodynamic limit of fibre lay-down",
    Model(),
    Variable("s", ("s",), "arclength s of the saved points", increasing=True),
    Variable("xi", ("s", "path", "component"), "deviation ξ"),
    Variable("mean", _COMPONENT, "mean E ξ", values=lambda paths: paths.mean()[0]),
    Variable("mean_standard_error", _COMPONENT, "its standard error",
             values=lambda paths: paths.mean()[1]),
    Variable("covariance", ("s", *_PAIR), "covariance of ξ",
             values=lambda paths: paths.covariance()[0]),
    Variable("covariance_standard_error", ("s", *_PAIR), "standard error",
             values=lambda paths: paths.covariance()[1]),
    *(Variable(name, (name,), "1 along the belt, 2 across",
               values=lambda _: np.array([1, 2])) for name in _PAIR),
    Attribute("method"),
    # Zero where only the start is saved.
    Attribute("ds", read_as=float),
)  # fmt: skip
