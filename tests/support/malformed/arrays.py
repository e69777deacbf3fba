"""Arrays that are no densities, and those that are although they look odd."""

from __future__ import annotations

import numpy as np

import fpsolve as fp
from fpsolve import diagnostics, interop
from fpsolve.errors import GridMismatchError

from . import problems as at
from .cases import Case


def spoilt(value, index=(3, 4, 5)):
    p = at.p0().copy()
    p[index] = value
    return p


def masked():
    hidden = np.zeros(at.grid().shape, bool)
    hidden[0, 0, 0] = True
    return np.ma.masked_array(at.p0(), hidden)


# What is wrong with a density, the array, value, remedy and error.
DENSITIES = [
    ("none", lambda: None, "got object", "floating-point numbers", TypeError),
    ("a string", lambda: "p0", "got <U2", "floating-point numbers", TypeError),
    ("one number", lambda: 1.0, r"got \(\)", "shape", GridMismatchError),
    ("rows of different lengths", lambda: [[1.0, 2.0], [3.0]],
     r"got \[\[1.0, 2.0\], \[3.0\]\]", "rows differ in length", TypeError),
    ("an empty array", lambda: np.empty((0, 0, 0)), r"got \(0, 0, 0\)", "shape",
     GridMismatchError),
    ("a plane", lambda: at.p0()[0], r"got \(12, 8\)", r"\(12, 12, 8\) of the grid",
     GridMismatchError),
    ("axes in another order", lambda: at.p0().transpose(2, 0, 1),
     r"got \(8, 12, 12\)", r"\(12, 12, 8\) of the grid", GridMismatchError),
    ("a leading axis too many", lambda: at.p0()[None],
     r"got \(1, 12, 12, 8\)", "of the grid", GridMismatchError),
    ("integers", lambda: np.ones(at.grid().shape, int), "got int64",
     r"`.astype\(float\)`", TypeError),
    ("truth values", lambda: at.p0() > 0, "got bool", r"astype\(float\)", TypeError),
    ("complex numbers", lambda: at.p0().astype(complex), "got complex128",
     "floating-point", TypeError),
    ("objects", lambda: at.p0().astype(object), "got object", r"astype", TypeError),
    ("strings", lambda: at.p0().astype(str), "got <U32", "astype", TypeError),
    ("hidden numbers", masked, "masked array with 1 of them", "fill it first",
     TypeError),
]  # fmt: skip
SPOILT = [
    ("NaN", lambda: spoilt(np.nan), r"got nan|got NaN", "must be finite"),
    ("infinity", lambda: spoilt(np.inf), r"got inf", "must be finite"),
    ("minus infinity", lambda: spoilt(-np.inf), "got -inf", "must be finite"),
    ("no mass", lambda: np.zeros(at.grid().shape), "got 0", "positive mass"),
    ("negative mass", lambda: -at.p0(), "got -", "positive mass"),
]


def each(owner, call, rows, wanted=None):
    """One case for each row: `call` on its array."""
    return [
        Case(
            f"{owner}: {row[0]}", lambda call=call, make=row[1]: call(make()), *row[2:]
        )
        for row in rows
        if wanted is None or row[0] in wanted
    ]


STARTS = [
    *each("start of a run", lambda p: at.solve(p0=p), DENSITIES),
    *each("start of a run", lambda p: at.solve(p0=p), SPOILT),
]
FEW = ("rows of different lengths", "axes in another order", "complex numbers",
       "hidden numbers")  # fmt: skip
ELSEWHERE = [
    *each("mass", lambda p: diagnostics.mass(p, at.grid()), DENSITIES, FEW),
    *each("moments", lambda p: diagnostics.moments(p, at.grid()), DENSITIES, FEW),
    *each("entropy",
          lambda p: diagnostics.relative_entropy(p, at.grid(), at.p0()),
          DENSITIES, FEW),
    *each("a law of the start", lambda p: fp.paths.DensityLaw(at.grid(), p),
          DENSITIES, FEW),
    *each("a law of the start", lambda p: fp.paths.DensityLaw(at.grid(), p),
          SPOILT, ("NaN", "no mass")),
    *each("a field of py-pde", lambda p: interop.to_pde_field(p, at.grid()),
          DENSITIES, FEW),
    *each("initial layer", lambda p: at.limit().initial_layer(p, at.grid()), DENSITIES,
          FEW),
    *each("initial layer", lambda p: at.limit().initial_layer(p, at.grid()), SPOILT,
          ("NaN", "negative mass")),
    Case("mass on no grid", lambda: diagnostics.mass(at.p0(), None),
         "got None", "must be a PhaseSpaceGrid", TypeError),
    Case("boundary mass on a plane",
         lambda: diagnostics.boundary_mass(at.p0(), at.plane()),
         "got PlaneGrid", "must be a PhaseSpaceGrid", TypeError),
    Case("dissipation of a negative noise",
         lambda: diagnostics.entropy_dissipation(at.p0(), at.grid(), -1.0),
         "got -1", "must be non-negative"),
    Case("field of a field", lambda: interop.from_pde_field(at.p0()),
         "got", "ScalarField", TypeError),
]  # fmt: skip
REFERENCES = [
    Case("reference in words", lambda: at.solve(reference="p_S"),
         "got 'p_S'", "real numbers", TypeError),
    Case("reference one number", lambda: at.solve(reference=1.0),
         r"got \(\)", "of the grid", GridMismatchError),
    Case("reference of another grid", lambda: at.solve(reference=np.ones((4, 4))),
         r"got \(4, 4\)", "of the grid", GridMismatchError),
    Case("reference negative", lambda: at.solve(reference=-at.p0()),
         "values from -", "positive mass"),
    Case("reference NaN", lambda: at.solve(reference=spoilt(np.nan)),
         r"got nan at index \(3, 4, 5\)", "must be finite"),
    Case("reference nothing", lambda: at.solve(reference=0 * at.p0()),
         "from 0 to 0", "relative to a density"),
    Case("limit from three axes",
         lambda: at.limit().solve(at.p0(), (0, 1), 0.25, grid=at.plane()),
         r"got \(12, 12, 8\)", r"\(12, 12\) of the grid", GridMismatchError),
    Case("limit from integers",
         lambda: at.limit().solve(
             np.ones((12, 12), int), (0, 1), 0.25, grid=at.plane()),
         "got int64", "astype", TypeError),
    Case("limit from NaN",
         lambda: at.limit().solve(
             np.full((12, 12), np.nan), (0, 1), 0.25, grid=at.plane()),
         "got NaN", "must be finite"),
    Case("reconstruction from NaN",
         lambda: at.limit().reconstruct(np.full((12, 12), np.nan), at.grid()),
         "got nan", "must be finite"),
    Case("energies from masses of another grid",
         lambda: at.energy().solve(np.ones(5), (0, 1), 0.25, grid=at.energy_grid()),
         r"shape \(5,\)", "one mass for each of 16 cells"),
    Case("energies from negative masses",
         lambda: at.energy().solve(-np.ones(16), (0, 1), 0.25, grid=at.energy_grid()),
         "a minimum of -1", "non-negative and finite"),
    Case("energies from complex masses",
         lambda: at.energy().solve(
             np.ones(16, complex), (0, 1), 0.25, grid=at.energy_grid()),
         "complex128", "real numbers", TypeError),
]  # fmt: skip

ARRAYS = [*STARTS, *ELSEWHERE, *REFERENCES]

# What is the same density in another dress, and must give the same bits.
HARMLESS = {
    "Fortran order": lambda p: np.asfortranarray(p),
    "a view with gaps": lambda p: np.repeat(p, 2, axis=2)[:, :, ::2],
    "axes swapped back": lambda p: np.ascontiguousarray(p.transpose(2, 1, 0)).T,
    "reversed twice": lambda p: np.ascontiguousarray(p[::-1])[::-1],
    "read-only": lambda p: _read_only(p),
    "long doubles": lambda p: p.astype(np.longdouble),
    "big-endian": lambda p: p.astype(">f8"),
    "a list of lists": lambda p: p.tolist(),
    "nothing masked": lambda p: np.ma.masked_array(p),
}


def _read_only(p):
    q = p.copy()
    q.flags.writeable = False
    return q
