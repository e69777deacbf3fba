"""Runs with checkpoints that tests of them share: small, killed in process."""

import numpy as np

from fpsolve import initial
from fpsolve.density.checkpoints import Checkpoint
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import RotatingNozzle
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential

GRID = PhaseSpaceGrid((6.0, 5.5), (14, 12, 8))
MODEL = LayDownModel(QuadraticPotential(), 1.0)
# Its characteristics and shifts depend on s.
NOZZLE = LayDownModel(QuadraticPotential(), 0.8, RotatingNozzle(0.2, 0.3, 0.7))
P0 = initial.gaussian(GRID, (0.5, 0.0), 0.8, np.pi / 2, 1.0)
RUN = {"s_span": (0.0, 1.0), "ds": 0.125, "save_at": (0.0, 0.25, 1.0)}
SCHEMES = {
    "drift_kick": drift_kick(MODEL, GRID),
    "balanced": drift_kick(NOZZLE, GRID, balanced=True, positive=True),
    "semi_lagrangian": semi_lagrangian(MODEL, GRID),
    "density form": semi_lagrangian(NOZZLE, GRID, form="p", splitting="lie"),
}


class Killed(BaseException):
    """What SIGKILL is to a process: nothing of the run answers it."""


def killing_at(step):
    """A progress callback that kills the run when so many steps are done."""

    def report(n_done, n_total, s):
        if n_done >= step:
            raise Killed

    return report


def run(folder=None, every=2, scheme=None, p0=P0, **changes):
    """The run that is interrupted and repeated here."""
    checkpoint = None if folder is None else Checkpoint(folder, every)
    scheme = SCHEMES["drift_kick"] if scheme is None else scheme
    return solve(scheme, p0, **{**RUN, **changes}, checkpoint=checkpoint)


def left_at(step, folder, **options):
    """The same, killed."""
    try:
        run(folder, progress=killing_at(step), **options)
    except Killed:
        return folder
    raise AssertionError("the run came to its end")


def plain_arguments(solution):
    """Those of the call that are no objects."""
    objects = ("scheme", "p0", "reference")
    arguments = solution.call.arguments.items()
    return {name: value for name, value in arguments if name not in objects}


def assert_same_bits(first, second):
    """Everything but times and dates agrees in every bit."""
    assert (
        np.asarray(first.densities).tobytes() == np.asarray(second.densities).tobytes()
    )
    assert first.saved_s.tobytes() == second.saved_s.tobytes()
    assert first.entropy_floor == second.entropy_floor
    assert (first.status, first.ds) == (second.status, second.ds)
    assert first.provenance["n_steps"] == second.provenance["n_steps"]
    assert plain_arguments(first) == plain_arguments(second)
    for one, other in ((first.series, second.series), (first.errors, second.errors)):
        # zarr lists what it holds in an order of its own.
        assert set(one or {}) == set(other or {})
        for name in one or {}:
            assert one[name].tobytes() == other[name].tobytes(), name
