"""Models, grids and processes that cannot be."""

from __future__ import annotations

import numpy as np

import fpsolve as fp

from .cases import INF, NAN, NUMBER, POSITIVE, Case

Q = fp.QuadraticPotential
VALID_PROCESS = {
    "sigma1": 0.01, "sigma2": 0.01, "noise": 16.0, "speed_ratio": 0.1,
    "spinning_speed": 50.0,
}  # fmt: skip


def process(**changes):
    return fp.Process(**{**VALID_PROCESS, **changes})


def isotropic(value=lambda r: r**2 / 2, derivative=lambda r: r):
    return fp.IsotropicPotential(value, derivative)


def plane(value=lambda x, y: (x**2 + y**2) / 2, gradient=lambda x, y: (x, y)):
    return fp.CallablePotential(value, gradient)


def table(s=(0, 1, 2), gamma1=(0, 0, 0), gamma2=(0, 0, 0)):
    return fp.TabulatedCurve(s, gamma1, gamma2)


MODELS = [
    Case("a function as potential", lambda: fp.LayDownModel(abs, 1.0),
         "got <built-in function abs>", "wrap functions in CallablePotential",
         TypeError),
    Case("no potential", lambda: fp.LayDownModel(None, 1.0),
         "got None", "`potential` must be a Potential", TypeError),
    Case("noise in words", lambda: fp.LayDownModel(Q(), "large"),
         "got 'large'", NUMBER, TypeError),
    Case("noise true", lambda: fp.LayDownModel(Q(), True), "got True", NUMBER,
         TypeError),
    Case("noise none", lambda: fp.LayDownModel(Q(), None), "got None", NUMBER,
         TypeError),
    Case("noise complex", lambda: fp.LayDownModel(Q(), 1j), "got 1j", NUMBER,
         TypeError),
    Case("noise a numpy complex", lambda: fp.LayDownModel(Q(), np.complex128(1)),
         "1\\+0j", NUMBER, TypeError),
    Case("noise a list", lambda: fp.LayDownModel(Q(), [1.0]),
         r"got \[1.0\]", NUMBER, TypeError),
    Case("noise negative", lambda: fp.LayDownModel(Q(), -1.0),
         "got -1", "must be non-negative and finite"),
    Case("noise NaN", lambda: fp.LayDownModel(Q(), NAN), "got nan", "must be non-neg"),
    Case("noise infinite", lambda: fp.LayDownModel(Q(), INF), "got inf", "finite"),
    Case("noise beyond floating point", lambda: fp.LayDownModel(Q(), 1e200),
         "got 1e[+]200", "must be at most 1e[+]60"),
    Case("noise an endless integer", lambda: fp.LayDownModel(Q(), 10**400),
         "a number of 401 digits", "must be finite"),
    Case("a speed as curve", lambda: fp.LayDownModel(Q(), 1.0, 0.1),
         "got 0.1", r"use MovingBelt\(speed\)", TypeError),
    Case("deviation zero", lambda: Q(0.0), "`sigma1` .*got 0", POSITIVE),
    Case("deviation negative", lambda: Q(1.0, -2.0), "`sigma2` .*got -2", POSITIVE),
    Case("deviation NaN", lambda: Q(NAN), "got nan", POSITIVE),
    Case("slope zero", lambda: fp.LinearPotential(0.0), "`slope` .*got 0", POSITIVE),
    Case("slope a string", lambda: fp.LinearPotential("1"), "got '1'", NUMBER,
         TypeError),
    Case("exponent below one", lambda: fp.PowerPotential(0.5),
         "got 0.5", "below 1 the gradient is singular"),
    Case("exponent infinite", lambda: fp.PowerPotential(INF), "got inf", "and finite"),
    Case("scale negative", lambda: fp.PowerPotential(2.0, -1.0), "got -1", POSITIVE),
    Case("profile no function", lambda: isotropic(value=3),
         "got 3|got int", "callable", TypeError),
    Case("profile that is not elementwise",
         lambda: isotropic(value=lambda r: np.zeros(3)), r"got|shape", "elementwise"),
    Case("profile with NaN", lambda: isotropic(value=lambda r: r * NAN),
         "nan", "must be finite"),
    Case("profile and derivative of different functions",
         lambda: isotropic(derivative=lambda r: 2 * r), "got",
         "must be the derivative"),
    Case("gradient of another function",
         lambda: plane(gradient=lambda x, y: (y, x)), "got",
         "`gradient.0.` must be the derivative"),
    Case("gradient one array", lambda: plane(gradient=lambda x, y: x),
         "`gradient`", "pair|two", (TypeError, ValueError)),
    Case("potential of strings", lambda: plane(value=lambda x, y: "B"),
         "`value`.*got", "real numbers", TypeError),
    Case("belt faster than the fibre", lambda: fp.MovingBelt(1.5),
         "got 1.5", "strictly between -1 and 1"),
    Case("belt speed in per cent", lambda: fp.MovingBelt(10.0), "got 10", "tears the"),
    Case("belt speed a string", lambda: fp.MovingBelt("fast"),
         "got 'fast'", NUMBER, TypeError),
    Case("nozzle of negative radius",
         lambda: fp.RotatingNozzle(0.1, -1.0, 1.0), "`radius` .*got -1",
         "non-negative"),
    Case("nozzle that turns infinitely fast",
         lambda: fp.RotatingNozzle(0.1, 1.0, INF), "`angular_speed` .*got inf",
         "finite"),
    Case("phase NaN", lambda: fp.RotatingNozzle(0.1, 1.0, 1.0, NAN),
         "`phase` .*got nan", "finite"),
    Case("amplitude negative", lambda: fp.OscillatingNozzle(0.0, -0.5, 1.0),
         "`amplitude` .*got -0.5", "non-negative"),
    Case("elliptic radius none", lambda: fp.EllipticNozzle(0.1, 1.0, None, 1.0),
         "`radius2` .*got None", NUMBER, TypeError),
    Case("table out of order", lambda: table(s=(0, 2, 1)),
         "table that is not", "strictly increasing"),
    Case("table with NaN", lambda: table(gamma1=(0, NAN, 0)), "NaN", "must be finite"),
    Case("table of strings", lambda: table(s=("a", "b", "c")),
         "'a'", "must hold real numbers", TypeError),
    Case("table with a column too short", lambda: table(gamma2=(0, 0)),
         r"`gamma2` .*got \(2,\)", "shape"),
    Case("table of one row", lambda: fp.TabulatedCurve((0,), (0,), (0,)),
         r"got \(1,\)", "n >= 2"),
]  # fmt: skip

GRIDS = [
    Case("half width zero", lambda: fp.PhaseSpaceGrid(0.0, (8, 8, 8)), "got 0",
         POSITIVE),
    Case("half width NaN", lambda: fp.PhaseSpaceGrid(NAN, (8, 8, 8)), "nan", POSITIVE),
    Case("half width of a universe", lambda: fp.PhaseSpaceGrid(1e300, (8, 8, 8)),
         "got 1e[+]300", "must lie between 1e-30 and 1e[+]30"),
    Case("three half widths", lambda: fp.PhaseSpaceGrid((1.0, 2.0, 3.0), (8, 8, 8)),
         "got 3 of them", "one number or two"),
    Case("half widths as a string", lambda: fp.PhaseSpaceGrid("6", (8, 8, 8)),
         "got '6'", NUMBER, TypeError),
    Case("one number of cells", lambda: fp.PhaseSpaceGrid(6.0, 64),
         "got 64", r"three integers \(n_xi1, n_xi2, n_alpha\)"),
    Case("two numbers of cells", lambda: fp.PhaseSpaceGrid(6.0, (64, 64)),
         r"got \(64, 64\)", "three integers"),
    Case("cells as a string", lambda: fp.PhaseSpaceGrid(6.0, "888"),
         "got '888'", "three integers"),
    Case("cells as a set", lambda: fp.PhaseSpaceGrid(6.0, {8, 9, 10}),
         r"got \{8, 9, 10\}", "three integers"),
    Case("a fraction of a cell", lambda: fp.PhaseSpaceGrid(6.0, (8, 8, 8.5)),
         "got 8.5", r"shape\[2\] \(n_alpha\)` must be an integer", TypeError),
    Case("too few cells", lambda: fp.PhaseSpaceGrid(6.0, (3, 8, 8)),
         "got 3", r"shape\[0\] \(n_xi1\)` must be at least 4"),
    Case("a negative number of cells", lambda: fp.PhaseSpaceGrid(6.0, (8, -8, 8)),
         "got -8", "at least 4"),
    Case("three axes of a plane", lambda: fp.PlaneGrid(6.0, (8, 8, 8)),
         r"got \(8, 8, 8\)", r"PlaneGrid.of\(grid\)"),
    Case("the plane of no grid", lambda: fp.PlaneGrid.of("grid"),
         "got 'grid'", "must be a PhaseSpaceGrid", TypeError),
]  # fmt: skip

PROCESSES = [
    Case("throwing range in millimetres", lambda: process(sigma1=10.0),
         "got 10", "0.001 to 0.05 m: millimetres given instead of metres"),
    Case("throwing range across in millimetres", lambda: process(sigma2=8.0),
         "`sigma2` .*got 8", "millimetres given instead of metres"),
    Case("throwing range in kilometres", lambda: process(sigma1=1e-5),
         "got 1e-05", "between 0.0001 and 0.5 m"),
    Case("noise per kilometre", lambda: process(noise=16e3),
         "got 16000", r"industrial range is 1 to 50 m\^-1/2"),
    Case("speed ratio in per cent", lambda: process(speed_ratio=10.0),
         "got 10", "strictly between -1 and 1"),
    Case("speed ratio upside down", lambda: process(speed_ratio=1 / 0.1),
         "got 10", "a faster belt tears the fibre"),
    Case("spinning speed per minute", lambda: process(spinning_speed=4000.0),
         "got 4000", "metres per minute given instead"),
    Case("spinning speed zero", lambda: process(spinning_speed=0.0), "got 0", POSITIVE),
    Case("throwing range with its unit", lambda: process(sigma1="10 mm"),
         "got '10 mm'", NUMBER, TypeError),
    Case("noise of a process NaN", lambda: process(noise=NAN), "got nan",
         "non-negative and finite"),
    Case("lengths in words", lambda: process().to_metres("ten"),
         "got 'ten'", "real numbers", TypeError),
]  # fmt: skip
