"""Exceptions carry their numbers, say what to do, and cross process boundaries."""

import pickle

import pytest

from fpsolve import errors

# One of each, with its message from beginning to end.
EXAMPLES = [
    (
        errors.MassDriftError(s=0.25, drift=3.1e-5, tolerance=1e-10),
        "relative mass drift 3.1e-05 exceeds tolerance 1e-10 at s = 0.25; use a "
        "conservative scheme, a smaller `ds`, or a larger `mass_tolerance` if this "
        "drift is acceptable.",
    ),
    (
        errors.NonFiniteDensityError(s=1.5, index=(1, 2, 3)),
        "the density is not finite at s = 1.5, first at index (1, 2, 3); reduce `ds` "
        "or choose a scheme that is stable for this noise.",
    ),
    (
        errors.NonFinitePathError(17, 0.5, (2.0, 3.0), (float("inf"), 1.0)),
        "path 17 cannot go on at s = 0.5: the gradient of the potential at xi = (2, 3) "
        "is (inf, 1); define it wherever a path may come, or start the paths closer to "
        "the origin.",
    ),
    (
        errors.DomainTooSmallError(0.02, 6.0),
        "boundary mass 0.02: the box of half width 6 is too small; enlarge "
        "`half_width`.",
    ),
    (
        errors.DomainTooSmallError(0.02, (6.0, 5.0), s=1.0, tolerance=1e-3),
        "boundary mass 0.02 exceeds tolerance 0.001 at s = 1: the box of half width "
        "(6, 5) is too small; enlarge `half_width`.",
    ),
    (
        errors.CurvatureRangeError(0.02, 6.0, 1e-3, 1.0),
        "boundary mass 0.02 in κ exceeds tolerance 0.001 at s = 1: curvatures up to 6 "
        "are too few; enlarge `kappa_half_width`.",
    ),
    (
        errors.MassCorrectionError(s=0.1, theta=-15.0, step=3),
        "adjusted-advection weight theta = -15 outside [0, 1] at s = 0.1 (step 3); "
        "refine the grid, raise `interpolation_order`, or enlarge `ds`: moving feet by "
        "η b ds² can restore no more mass than that. At low noise the form `p` is "
        "unstable; use the form `h`.",
    ),
    (
        errors.EntropyRiseError(s=0.5, rise=2.25, tolerance=0.1),
        "relative entropy risen by 2.2, more than the tolerance 0.1, at s = 0.5, where "
        "it can only fall: the density is wrong; use more cells or a smaller "
        "`half_width` where B is steep, a smaller `ds`, or a larger "
        "`entropy_tolerance` if this is acceptable.",
    ),
    (
        errors.CirculationError(s=0.5, deviation=-0.07, tolerance=0.05),
        "circulation off its exact law by -0.07, more than the tolerance 0.05, at s = "
        "0.5: the L1 error of the density is at least as large; use a smaller `ds`, a "
        "finer grid, or a larger `circulation_tolerance` if this is acceptable.",
    ),
    (
        errors.GridMismatchError((6, 7, 8), (6, 7), name="p0"),
        "`p0` must have the shape (6, 7, 8) of the grid, got (6, 7).",
    ),
    (
        errors.MemoryLimitError(required=3 * 2**30, available=2**29),
        "the run needs 3 GiB but 512 MiB are available; save fewer densities, choose "
        "a coarser grid, or raise `memory_limit`.",
    ),
    (
        errors.MemoryLimitError(2**30, 2**29, "sample fewer paths"),
        "the run needs 1 GiB but 512 MiB are available; sample fewer paths, or raise "
        "`memory_limit`.",
    ),
    (
        errors.CheckpointError("run/a.npz", "No space left", "make room"),
        "checkpoint `run/a.npz` cannot be written: No space left; make room.",
    ),
    (
        errors.CheckpointMismatchError("run", ["`ds` was 1, is 2", "`p0` differs"]),
        "checkpoint `run` is of another run: `ds` was 1, is 2, `p0` differs; use the "
        "arguments of that run, or name another folder, or remove this one to begin "
        "anew.",
    ),
    (
        errors.ForkedProcessError(),
        "kernels cannot run in a process that was forked after their threads had "
        "started; start it by `multiprocessing.get_context('spawn')` (or "
        "'forkserver'), for an executor `mp_context=` of the same, or set "
        "NUMBA_THREADING_LAYER=workqueue, whose threads start anew.",
    ),
    (
        errors.SteadyStateError(residual=1e-3, tolerance=1e-8),
        "steady state not reached: residual 0.001 exceeds tolerance 1e-08; refine "
        "the grid, shorten `ds` or enlarge `tolerance`.",
    ),
    (
        errors.EdgeLengthError(t=0.5, dt=0.1, stretched=0.03),
        "no step of 0.1 s was found from t = 0.5 s on in which the fibre keeps its "
        "length, an edge is off by a part of 0.03; take more `n_steps`.",
    ),
    (
        errors.FrictionError(t=0.5, dt=0.1, stretched=0.03, left=3),
        "no step of 0.1 s was found from t = 0.5 s on in which friction on the belt is "
        "settled: 3 nodes change between sticking, sliding and the air, or move what "
        "was left behind, and an edge is off by a part of 0.03; take more `n_steps`, "
        "or more `friction`.",
    ),
    (
        errors.NoiseStrengthError(0.5, 4e-3, 3.5e-4, 2.1, 700),
        "`turbulence` of 0.00035 N s^½/m^½ turns edges by 2.1 rad in a step of 0.004 s "
        "from t = 0.5 s on, after which their directions mean nothing; take at least "
        "700 `n_steps`, in which they turn by ½.",
    ),
    (
        errors.EquilibriumError(residual=1e-3, tolerance=1e-10),
        "no position of rest was found: a force of 0.001 of the weight and the "
        "stiffness is left, 1e-10 are allowed; give a `shape` that is nearer to it.",
    ),
    (
        errors.FlowRangeError(t=0.25, position=(0.1, 0.0, -1.5)),
        "the fibre is at (0.1, 0, -1.5) m at t = 0.25 s, outside of the table of the "
        "flow; enlarge the table or shorten the fibre.",
    ),
    (
        errors.ToleranceError(reached=2.5e-6, tolerance=1e-10),
        "tolerance 1e-10 not reached: the error is estimated at 2.5e-06; raise "
        "`memory_limit` or enlarge `tolerance`.",
    ),
    (
        errors.ToleranceError(1e-3, 1e-8, "start closer to the equilibrium"),
        "tolerance 1e-08 not reached: the error is estimated at 0.001; start closer "
        "to the equilibrium.",
    ),
    (
        errors.UnreachableTargetError(0.01, 0.05, 0.0625, 1e-4, {"noise": 14.0}),
        "`target` CV <= 0.05 of zones of 0.01 m cannot be met within `bounds`: the "
        "best that was found is 0.0625 ± 0.0001, at noise = 14; allow more, widen the "
        "bounds or free another parameter.",
    ),
    (errors.ConfigurationError("no section `grid`."), "no section `grid`."),
    (
        errors.FileFormatError("run.nc", "it has no density"),
        "cannot read `run.nc`: it has no density.",
    ),
]
IDS = [type(error).__name__ for error, _ in EXAMPLES]


@pytest.mark.parametrize(("error", "message"), EXAMPLES, ids=IDS)
def test_message_states_the_numbers_and_the_remedy(error, message):
    assert str(error) == message


@pytest.mark.parametrize("error", [error for error, _ in EXAMPLES], ids=IDS)
def test_every_error_is_caught_as_an_fpsolve_error(error):
    assert isinstance(error, errors.FpsolveError)


@pytest.mark.parametrize("error", [error for error, _ in EXAMPLES], ids=IDS)
def test_an_error_survives_pickling_with_all_its_numbers(error):
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert vars(copy) == vars(error)


@pytest.mark.parametrize("error", [error for error, _ in EXAMPLES[:5]], ids=IDS[:5])
def test_errors_of_a_run_can_carry_the_partial_solution(error):
    assert isinstance(error, errors.RunError)
    assert error.solution is None
    copy = pickle.loads(pickle.dumps(error))
    copy.solution = "partial"
    assert pickle.loads(pickle.dumps(copy)).solution == "partial"


def test_a_grid_mismatch_is_also_a_value_error():
    with pytest.raises(ValueError, match=r"`p` must have the shape \(2, 2\)"):
        raise errors.GridMismatchError((2, 2), (3,))


def test_an_interruption_keeps_the_solution_and_is_a_keyboard_interrupt():
    interruption = pickle.loads(pickle.dumps(errors.RunInterrupted("partial")))
    assert isinstance(interruption, KeyboardInterrupt)
    assert not isinstance(interruption, Exception)
    assert interruption.solution == "partial"
    assert str(interruption) == "run interrupted; the partial result is in `solution`."
