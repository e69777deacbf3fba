"""Runs of `drift_kick` on the host, and what one elsewhere must have in common."""

import numpy as np

import fpsolve as fp

SPAN, DS = (0.0, 1.0), 0.125
# What coarse cells leave at the edge and below zero is not in question here.
LAX = {"boundary_tolerance": 1.0, "negative_tolerance": 9.0,
       "circulation_tolerance": 9.0, "entropy_tolerance": 9.0}  # fmt: skip
TILTED = fp.CallablePotential(
    lambda a, b: 0.5 * a**2 + 0.3 * b**2 + 0.1 * a * b,
    lambda a, b: (a + 0.1 * b, 0.6 * b + 0.1 * a),
)
# Even and odd numbers of cells; |∇B| that is the same everywhere, shared by mirror
# images and different in every cell; belts at rest and in motion, and a nozzle, for
# which every step has other shifts.
PROBLEMS = {
    "quadratic": (fp.QuadraticPotential(), fp.FixedBelt(), (16, 18, 12)),
    "linear on a belt": (fp.LinearPotential(), fp.MovingBelt(0.3), (17, 16, 10)),
    "tilted under a nozzle": (TILTED, fp.RotatingNozzle(0.2, 0.5, 1.0), (14, 13, 8)),
}
OPTIONS = {
    "plain": {},
    "fourier": {"translation": "fourier"},
    "balanced": {"balanced": True, "translation": "fourier"},
}


def scheme_of(problem, options):
    potential, curve, shape = PROBLEMS[problem]
    grid = fp.PhaseSpaceGrid(half_width=4.0, shape=shape)
    model = fp.LayDownModel(potential=potential, noise=0.8, curve=curve)
    return fp.drift_kick(model, grid, **OPTIONS[options])


def start_of(scheme):
    return fp.initial.gaussian(
        scheme.grid, mean=(0.5, 0.2), variance=0.5, angle=1.0, concentration=2.0
    )


def run(scheme, p0, **more):
    return fp.solve(scheme, p0, SPAN, DS, save_at=(0.5, 1.0), **LAX, **more)


def assert_same_run(found, expected):
    """Densities and every series, to the rounding of a thousand sums of 1e-16.

    Relative to the largest density, and of series, which are of order one, absolutely.
    """
    scale = expected.densities.max()
    np.testing.assert_allclose(
        found.densities, expected.densities, rtol=0, atol=1e-13 * scale
    )
    assert found.series.keys() == expected.series.keys()
    for name, values in expected.series.items():
        np.testing.assert_allclose(found.series[name], values, rtol=0, atol=1e-12)
