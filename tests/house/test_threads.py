"""Objects that threads share give what one thread gets, bit for bit."""

import sys
import threading
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from threadpoolctl import ThreadpoolController

import fpsolve as fp
from fpsolve._support.blas import one_blas_thread
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.spectral.bases.radial_basis import radial_basis
from fpsolve.studies.sweeps.recorded_warnings import recorded_warnings

GRID = fp.PhaseSpaceGrid(5.0, (16, 16, 8))
N_THREADS = 4


@pytest.fixture(autouse=True)
def threads_take_turns_at_once():
    """Threads change as often as they can: what one overwrites, another reads."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def in_threads(function, arguments):
    """Results in the order of the arguments, computed by threads that begin at once."""
    n_threads = min(N_THREADS, len(arguments))
    barrier = threading.Barrier(n_threads)
    with ThreadPoolExecutor(n_threads, initializer=barrier.wait) as pool:
        return list(pool.map(function, arguments))


def same(one, other):
    """Whether everything computed is the same, NaN being NaN."""
    arrays = zip(one, other, strict=True)
    return all(np.array_equal(a, b, equal_nan=True) for a, b in arrays)


SCHEMES = [
    (semi_lagrangian, {}),
    (semi_lagrangian, {"form": "p", "splitting": "lie", "limited": True}),
    (drift_kick, {}),
    (drift_kick, {"positive": True, "balanced": True}),
]


# Feet are the same at every step, or others at each.
@pytest.mark.parametrize(
    "curve", [fp.MovingBelt(0.2), fp.RotatingNozzle(0.1, 0.5, 1.0)], ids=repr
)
@pytest.mark.parametrize(("scheme", "options"), SCHEMES)
def test_one_scheme_runs_many_starts_at_once(scheme, options, curve):
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, curve)
    shared = scheme(model, GRID, **options)
    starts = [
        (fp.initial.gaussian(GRID, (0.2 * k, -0.1 * k), 1.0, 0.5 * k, 0.5), ds)
        for k in range(4)
        for ds in (0.25, 0.125)
    ]

    def run(start):
        p0, ds = start
        # On so few cells nothing else is to stop a run.
        found = fp.solve(
            shared, p0, (0.0, 1.0), ds, extrapolate=ds > 0.2,
            boundary_tolerance=1.0, negative_tolerance=10.0,
        )  # fmt: skip
        return [found.densities, *found.series.values()]

    alone = [run(start) for start in starts]
    for one, other in zip(alone, in_threads(run, starts), strict=True):
        assert same(one, other)


MODEL = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
OWN = fp.IsotropicPotential(lambda r: 0.5 * r**2, lambda r: r)


def shared_objects():
    """Functions of a number, each of which uses one object for all."""
    limit = fp.HydrodynamicLimit(MODEL)
    process = fp.EnergyProcess(fp.QuadraticPotential(), 0.5)
    cells = process.grid(20)
    passage = process.passage(0.3)
    law = fp.paths.EquilibriumLaw(fp.PowerPotential(4))
    density = fp.paths.DensityLaw(GRID, fp.initial.gaussian(GRID, (0.0, 0.0), 1.0))
    paths = fp.sample_paths(MODEL, 50, 1.0, 0.25, seed=3, save_at=(0.5, 1.0))
    plane = GRID.evaluate(lambda x, y, a: np.exp(-(x**2) - y**2)).sum(axis=2)
    return {
        "hydrodynamic limit": lambda k: limit.solve(
            np.roll(plane, k, axis=0), (0.0, 1.0), 0.25, grid=GRID,
            boundary_tolerance=1.0, extrapolate=True,
        ).densities,
        "energy process": lambda k: process.solve(
            0.05 * (k + 1), (0.0, 1.0), 0.25, grid=cells
        ).masses[-1],
        "energies": lambda k: process.sample(
            20, 1.0, 0.5, seed=k, initial=0.1, method="sphere"
        ).g,
        "passage": lambda k: passage.variance(np.linspace(0.05, 0.55, k + 3)),
        "spectrum": lambda k: fp.spectrum(
            fp.LayDownModel(fp.QuadraticPotential(), 1.0 + 0.25 * k), 1, tolerance=1e-3
        ).eigenvalues,
        "radial basis": lambda k: radial_basis(OWN, 24).raising(k, 1 - k, 8),
        "paths": lambda k: fp.sample_paths(
            MODEL, 40, 1.0, 0.25, seed=k, initial=density
        ).xi,
        "law": lambda k: law.sample(np.random.default_rng(k), 50)[0],
        "density law": lambda k: density.sample(np.random.default_rng(k), 50)[0],
        "moments of paths": lambda k: paths.moments()["mean_xi1"][0],
        "equilibrium": lambda k: OWN.partition_function,
        "table": lambda k: fp.TabulatedCurve(
            np.arange(5.0), 0.1 * np.arange(5.0), np.zeros(5)
        ).position(0.5 * k)[0],
    }  # fmt: skip


SHARED = shared_objects()


@pytest.mark.parametrize("name", SHARED)
def test_one_object_answers_many_threads(name):
    function = SHARED[name]
    # Threads first: what is computed once only is not there yet.
    n_different = 2 if name in ("energies", "spectrum") else N_THREADS
    together = in_threads(function, range(n_different))
    for k, found in enumerate(together):
        assert np.array_equal(found, function(k), equal_nan=True)


def test_blas_has_one_thread_until_the_last_one_inside_has_left():
    def number():
        found = ThreadpoolController().select(user_api="blas").info()
        return {library["num_threads"] for library in found}

    first_left, second_may_leave = threading.Event(), threading.Event()
    inside = []

    def second(both_inside):
        with one_blas_thread():
            both_inside.wait()
            first_left.wait()
            inside.append(number())
            second_may_leave.wait()

    with ThreadpoolController().limit(limits=2, user_api="blas"):
        assert number() == {2}
        both = threading.Barrier(2)
        other = threading.Thread(target=second, args=(both,))
        with one_blas_thread():
            other.start()
            both.wait()
            assert number() == {1}
        first_left.set()
        second_may_leave.set()
        other.join()
        assert inside == [{1}]
        # The one that came first has gone long ago: the other gives the threads back.
        assert number() == {2}


def test_every_thread_records_its_own_warnings():
    both, done = threading.Barrier(2), threading.Barrier(2)

    def warned(name):
        with recorded_warnings() as caught:
            both.wait()
            warnings.warn(name, UserWarning, stacklevel=1)
            done.wait()
        return [str(one.message) for one in caught]

    shown = warnings.showwarning
    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(warned, ["a", "b"])) == [["a"], ["b"]]
    assert warnings.showwarning is shown
    with pytest.warns(UserWarning, match="afterwards"):
        warnings.warn("afterwards", UserWarning, stacklevel=1)
