"""Kernels of the sampler: random numbers, elementary functions, threads."""

import math

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher
from scipy import stats

from fpsolve._kernels import paths as kernels
from fpsolve._kernels.compiling import ParallelKernel
from fpsolve.paths.smooth_step import smooth_step

KERNELS = {
    name: function
    for name, function in vars(kernels).items()
    if isinstance(function, Dispatcher | ParallelKernel)
}
KEY = (0x243F6A88, 0x85A308D3)
QUADRATIC = (kernels.QUADRATIC, 1.0, 1.5)
POTENTIALS = [
    (kernels.FREE, 0.0, 0.0),
    QUADRATIC,
    (kernels.LINEAR, 1.2, 0.0),
    (kernels.EVEN_POWER, 0.7, 4.0),
    (kernels.POWER, 0.9, 2.5),
]
NO_TRACE = np.zeros((0, 5, 0))
LAW = smooth_step(0.3, 1.2, 0.2)


def random_state(n):
    rng = np.random.default_rng(4)
    angle = rng.uniform(-np.pi, np.pi, n)
    turns = rng.integers(-3, 4, n)
    return np.stack([*rng.normal(size=(2, n)), np.cos(angle), np.sin(angle), turns])


def random_smooth_state(n):
    return np.stack([*random_state(n), np.random.default_rng(6).normal(size=n)])


def in_phase(shifts):
    """Of nozzles that all move as the curve."""
    return kernels.Shifts(shifts, np.zeros((0, 2, 2, 2)), np.zeros((2, 0)))


def own_phases(n_steps, n):
    """Of nozzles that add two motions to the curve, each weighted in its own way."""
    rng = np.random.default_rng(9)
    common, own = rng.normal(size=(n_steps, 2, 2)), rng.normal(size=(n_steps, 2, 2, 2))
    return kernels.Shifts(0.1 * common, 0.1 * own, rng.normal(size=(2, n)))


def work_array():
    """A work array with a state, normal numbers and forces in its rows."""
    rng = np.random.default_rng(5)
    w = rng.uniform(0.1, 0.9, kernels.N_SMOOTH_ROWS * kernels.LANES)
    w[: 5 * kernels.LANES] = random_state(kernels.LANES).ravel()
    return w


def cases():
    """Name of a kernel: list of argument tuples."""
    w, n = work_array(), 3
    state, together = random_state(n), in_phase(np.full((5, 2, 2), 0.01))
    normals = np.random.default_rng(7).normal(size=(4, kernels.LANES))
    words = np.zeros((4, kernels.LANES), np.int64)
    step = (0.2, QUADRATIC, together.common[0], 2.5, 3, normals, w)
    return {
        "philox_round": [(1, 2, 3, 4, *KEY)],
        "philox": [(1, 2, 3, 4, *KEY), (2**32 - 1, 0, 2**31, 7, *KEY)],
        "cosine_sine": [(0.3,), (-3.1,)],
        "cosine_sine_of_quarter": [(0.3,), (-1.5,)],
        "hyperbolic": [(0.01,), (12.0,)],
        "half_angle": [(0.2,), (-0.5,)],
        "minus_twice_logarithm": [(3.7, 0.0), (2.0**31 + 0.5, 32.0)],
        "turns_taken": [(1.0, -1.0, 0.5), (-1.0, 1.0, -0.2), (1.0, -1.0, -0.5)],
        "standard_normals": [(2**40 + 3, 17, *KEY, words, normals)],
        "translate_block": [(0.1, 0.02, -0.03, w)],
        "force_block": [(*potential, w) for potential in POTENTIALS],
        "limit_force": [(0.1, w), (40.0, w)],
        "load_weights": [(np.arange(2.0 * n).reshape(2, n), 0, n, w)],
        "displace_block": [(np.array([[0.1, -0.2], [0.3, 0.4]]), w)],
        "kick_block": [(0.1, 2.5, 1, normals, w)],
        "rotate_block": [(w,)],
        "splitting_step": [step],
        "euler_step": [step],
        "heun_step": [step],
        "load_block": [(state, 0, n, w)],
        "store_block": [(w, 0, n, state)],
        "advance_paths": [
            (
                kernels.Noise(7, 2, KEY, 0.4), 0.2, potential, shifts, method,
                NO_TRACE, state,
            )
            for potential in POTENTIALS
            for method in (kernels.SPLITTING, kernels.EULER_MARUYAMA, kernels.HEUN)
            for shifts in (together, own_phases(5, n))
        ],
        "fill_normals": [(5, 3, KEY, np.zeros((4, n)))],
        "kick_paths": [(0.1, np.array([1.0, -9.0, 0.0]), np.ones((2, n)), state)],
        "rotate_paths": [(np.array([1.0, -9.0, 40.0]), state)],
        "sum_powers": [(random_state(70), np.zeros((2, 19)))],
        **smooth_cases(w, n, together),
    }  # fmt: skip


def smooth_cases(w, n, together):
    """Those of the smooth model."""
    state, rng = random_smooth_state(n), np.random.default_rng(5)
    numbers, forces = rng.normal(size=(3, n)), rng.normal(size=(2, n))
    of_four = rng.normal(size=(12, kernels.LANES))
    words = np.zeros((4, kernels.LANES), np.int64)
    return {
        "numbers_of_four_steps": [(2**40 + 3, 17, *KEY, words, of_four)],
        "noise_block": [(LAW.noise, 3, of_four, w)],
        "turn_block": [(0.2, LAW.weights, LAW.spread, 0.01, -0.02, w)],
        "load_smooth_block": [(state, 0, n, w)],
        "store_smooth_block": [(w, 0, n, state)],
        "advance_smooth_paths": [
            (7, 2, KEY, LAW, potential, shifts, np.zeros((0, 6, 0)), state)
            for potential in POTENTIALS
            for shifts in (together, own_phases(5, n))
        ],
        "turn_paths": [(LAW, numbers, forces, together.common[0, 1], state)],
    }


CASES = cases()
PARALLEL = [
    name for name, kernel in KERNELS.items() if isinstance(kernel, ParallelKernel)
]


def called(function, arguments):
    """What a call returns and leaves in its array arguments."""
    mine = [np.copy(a) if isinstance(a, np.ndarray) else a for a in arguments]
    result = function(*mine)
    returned = [] if result is None else np.atleast_1d(result)
    floats = [a for a in mine if isinstance(a, np.ndarray) and a.dtype == np.float64]
    return [*returned, *floats]


def test_every_kernel_of_the_sampler_has_a_case():
    assert CASES.keys() == KERNELS.keys()
    assert set(PARALLEL) == {
        "advance_paths", "fill_normals", "kick_paths", "rotate_paths", "sum_powers",
        "advance_smooth_paths", "turn_paths",
    }  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_compiled_kernels_of_the_sampler_equal_their_source(name):
    for arguments in CASES[name]:
        compiled = called(KERNELS[name], arguments)
        source = called(KERNELS[name].py_func, arguments)
        for one, other in zip(compiled, source, strict=True):
            # A few eps from fused multiply-add; of the work array only the rows that
            # the kernel means to leave can be compared, but all of them agree.
            np.testing.assert_allclose(one, other, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("potential", POTENTIALS)
@pytest.mark.parametrize("method", [0, 1, 2])
def test_paths_do_not_depend_on_the_number_of_threads(potential, method, on_threads):
    shifts = in_phase(np.full((6, 2, 2), 0.01))

    def run():
        state = random_state(5000)
        noise = kernels.Noise(0, 0, KEY, 0.3)
        arguments = (noise, 0.1, potential, shifts, method, NO_TRACE)
        kernels.advance_paths(*arguments, state)
        return state

    assert np.array_equal(on_threads(1, run), on_threads(2, run))


@pytest.mark.parametrize("method", [0, 1, 2])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_position_that_is_not_finite_stays_so_and_spoils_no_other_path(value, method):
    shifts = in_phase(np.zeros((4, 2, 2)))
    good, spoiled = random_state(70), random_state(70)
    spoiled[0, 13] = value
    for state in (good, spoiled):
        noise = kernels.Noise(0, 0, KEY, 0.3)
        arguments = (noise, 0.1, QUADRATIC, shifts, method, NO_TRACE)
        kernels.advance_paths(*arguments, state)
    assert not np.isfinite(spoiled[:, 13]).all()
    others = np.arange(70) != 13
    assert np.array_equal(good[:, others], spoiled[:, others])


def test_the_trace_holds_the_state_after_every_step():
    shifts = np.full((9, 2, 2), 0.01)
    whole, trace = random_state(70), np.zeros((9, 5, 70))
    arguments = (kernels.Noise(3, 5, KEY, 0.3), 0.1, QUADRATIC)
    kernels.advance_paths(*arguments, in_phase(shifts), 0, trace, whole)
    for n_steps in range(1, 10):
        state = random_state(70)
        some = in_phase(shifts[:n_steps])
        kernels.advance_paths(*arguments, some, 0, NO_TRACE, state)
        assert np.array_equal(trace[n_steps - 1], state)
    assert np.array_equal(trace[-1], whole)


def advanced(state, step, shifts):
    """States after so many steps from one on, by the kernel of the model."""
    state, trace = state.copy(), np.zeros((len(shifts.common), *state.shape))
    if len(state) == kernels.N_STATE:
        noise = kernels.Noise(3, step, KEY, 0.3)
        kernels.advance_paths(noise, 0.1, QUADRATIC, shifts, 0, trace, state)
    else:
        kernels.advance_smooth_paths(3, step, KEY, LAW, QUADRATIC, shifts, trace, state)
    return trace


@pytest.mark.parametrize("start", [random_state(70), random_smooth_state(70)])
def test_a_nozzle_of_its_own_phase_moves_before_and_behind_every_step(start):
    shifts, state = own_phases(9, 70), start.copy()
    trace = advanced(start, 5, shifts)
    for j in range(9):
        before, behind = (part @ shifts.weights for part in shifts.own[j])
        state[:2] -= before
        state = advanced(state, 5 + j, in_phase(shifts.common[j : j + 1]))[0]
        state[:2] -= behind
        # Sums of two products, rounded in another order.
        np.testing.assert_allclose(trace[j], state, rtol=0, atol=1e-12)


def test_paths_whose_nozzles_have_the_weight_zero_are_those_in_phase():
    shifts = own_phases(9, 70)
    still = shifts._replace(weights=np.zeros((2, 70)))
    in_step = advanced(random_state(70), 5, in_phase(shifts.common))
    assert np.array_equal(advanced(random_state(70), 5, still), in_step)


@pytest.mark.parametrize(
    ("counter", "key", "words"),
    [
        ((0,) * 4, (0, 0), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
        (
            (0xFFFFFFFF,) * 4,
            (0xFFFFFFFF,) * 2,
            (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD),
        ),
        (
            (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
            (0xA4093822, 0x299F31D0),
            (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
        ),
    ],
)
def test_philox_gives_the_published_answers(counter, key, words):
    # Salmon, Moraes, Dror, Shaw 2011, known answers of their Philox 4x32-10.
    assert kernels.philox(*counter, *key) == words


def test_neighbouring_paths_and_steps_have_independent_normal_noise():
    groups, n = 25, 40_000
    normals = np.concatenate(
        [filled(0, group, n) for group in range(groups)]
    )  # one row a step
    sample = normals.ravel()
    # One million numbers: Kolmogorov-Smirnov would see a deviation of 0.2 %.
    assert stats.kstest(sample, "norm").pvalue > 1e-3
    error = 1 / math.sqrt(sample.size)
    for power, expected, spread in ((1, 0, 1), (2, 1, 2), (3, 0, 15), (4, 3, 96)):
        moment = np.mean(sample**power)
        # Four standard errors; the seed is fixed.
        assert abs(moment - expected) < 4 * math.sqrt(spread) * error
    for other in (np.roll(normals, 1, 0), np.roll(normals, 1, 1), normals[::-1]):
        for f in (lambda x: x, np.square):
            assert abs(np.corrcoef(f(normals).ravel(), f(other).ravel())[0, 1]) < (
                4 * error
            )


def filled(path, group, n):
    normals = np.empty((4, n))
    kernels.fill_normals(path, group, KEY, normals)
    return normals


def test_noise_depends_on_the_number_of_the_path_only():
    everyone = filled(0, 3, 200)
    for first, n in ((0, 1), (1, 64), (63, 65), (130, 70)):
        assert np.array_equal(filled(first, 3, n), everyone[:, first : first + n])
    far = 2**33 + 5
    assert not np.array_equal(filled(far, 3, 5), filled(5, 3, 5))


def test_cosine_and_sine_are_exact_to_rounding():
    angles = np.linspace(-math.pi, math.pi, 2001)
    values = np.array([kernels.cosine_sine(angle) for angle in angles])
    # Two doublings multiply an error of half an eps by about four.
    np.testing.assert_allclose(values[:, 0], np.cos(angles), rtol=0, atol=1e-15)
    np.testing.assert_allclose(values[:, 1], np.sin(angles), rtol=0, atol=1e-15)


def test_cosine_and_sine_of_a_quarter_turn_and_logarithms_are_exact_to_rounding():
    angles = np.linspace(-math.pi / 2, math.pi / 2, 2001)
    values = np.array([kernels.cosine_sine_of_quarter(angle) for angle in angles])
    # One rounding of the result and one of the first step before it.
    np.testing.assert_allclose(values[:, 0], np.cos(angles), rtol=0, atol=4e-16)
    np.testing.assert_allclose(values[:, 1], np.sin(angles), rtol=0, atol=4e-16)
    numbers = np.concatenate([np.geomspace(0.5, 2**32 - 0.5, 500), 1 + angles / 1e4])
    logarithms = [kernels.minus_twice_logarithm(number, 0.0) for number in numbers]
    # Of both signs; near one relative to itself.
    np.testing.assert_allclose(logarithms, -2 * np.log(numbers), rtol=1e-15, atol=0)


def test_hyperbolic_functions_are_exact_to_rounding_and_keep_their_order():
    x = np.geomspace(1e-6, 2 * kernels.FARTHEST, 500)
    values = np.array([kernels.hyperbolic((one / 8) ** 2) for one in x])
    cosh, one, sinh = values.T
    # 5e-15 is the error of the approximant where it is largest, near x = 12.
    np.testing.assert_allclose(x * sinh / cosh, np.tanh(x), rtol=1e-14, atol=0)
    np.testing.assert_allclose(one / cosh, 1 / np.cosh(x), rtol=0, atol=1e-14)
    assert (np.diff(cosh / one) > 0).all()
    assert (one > 0).all()


def test_the_half_of_every_angle_is_exact_to_rounding():
    turns = np.linspace(-0.5, 0.5, 1001)
    c, s = np.array([kernels.half_angle(turn) for turn in turns]).T
    length = np.hypot(c, s)
    # The approximant of tan is off by 5e-16 of an angle at most, at half a turn.
    np.testing.assert_allclose(c / length, np.cos(np.pi * turns), rtol=0, atol=1e-15)
    np.testing.assert_allclose(s / length, np.sin(np.pi * turns), rtol=0, atol=1e-15)
    assert (c > -1e-15).all()


def exact_kick(alpha, force, t, angle):
    """The exact flow over t/2, a turn by the angle, the exact flow over t/2."""
    halfway = exact_rotation(alpha, force, 0.5 * t) + angle
    return exact_rotation(halfway, force, 0.5 * t)


@pytest.mark.parametrize("force", [(0.0, 0.0), (1.0, -2.0), (-6.0, 8.0)])
def test_one_formula_turns_by_force_noise_and_force_and_counts_the_turns(force):
    rng, n, t = np.random.default_rng(8), 400, 0.3
    alpha, angles = rng.uniform(-7, 7, n), 4.0 * rng.normal(size=n)
    state = np.stack([*np.zeros((2, n)), np.cos(alpha), np.sin(alpha), np.zeros(n)])
    state[4] = np.rint((alpha - np.arctan2(state[3], state[2])) / (2 * np.pi))
    forces = np.tile(np.array(force)[:, None], (1, n))
    kernels.kick_paths(0.25 * t, angles, forces, state)
    turned = np.arctan2(state[3], state[2]) + 2 * np.pi * state[4]
    # Angles of up to 20 are known to 4e-15, which the flow stretches by up to e^{gt}.
    np.testing.assert_allclose(
        turned, exact_kick(alpha, force, t, angles), rtol=0,
        atol=2e-14 * math.exp(math.hypot(*force) * t),
    )  # fmt: skip


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3, 1e300])
def test_along_the_force_and_against_it_a_tangent_stays_where_it_is(size):
    # Both are fixed points of the flow; the first repels, and nothing may become 0/0.
    state = np.zeros((5, 2))
    state[2] = 1.0, -1.0
    kernels.kick_paths(0.1, np.zeros(2), np.array([[size] * 2, [0.0] * 2]), state)
    # Normalised to rounding.
    np.testing.assert_allclose(state[2], [1.0, -1.0], rtol=0, atol=3e-16)
    assert not state[3:].any()


def exact_rotation(alpha, force, t):
    """tan((α - φ)/2) grows by e^{|∇B| t}; φ is the direction of ∇B."""
    direction, size = math.atan2(force[1], force[0]), math.hypot(*force)
    half = 0.5 * (alpha - direction)
    away = 2 * np.arctan2(math.exp(size * t) * np.sin(half), np.cos(half))
    return alpha + (away - 2 * half + np.pi) % (2 * np.pi) - np.pi


@pytest.mark.parametrize("force", [(1.0, 0.0), (-0.3, 0.4), (0.0, -7.0), (60.0, 80.0)])
@pytest.mark.parametrize("t", [0.01, 0.3])
def test_the_rotation_is_the_exact_flow_of_the_frozen_angle(force, t):
    # Statement 4: without noise R½ D R½ is the flow over the whole step, and turns
    # are counted. Off the unstable direction, whose neighbourhood grows like e^{gt}.
    alpha = np.linspace(-7.0, 7.0, 200) + 0.003
    state = np.stack([*np.zeros((2, 200)), np.cos(alpha), np.sin(alpha), np.zeros(200)])
    state[4] = np.rint((alpha - np.arctan2(state[3], state[2])) / (2 * np.pi))
    forces = np.tile(np.array(force)[:, None], (1, 200))
    kernels.kick_paths(0.25 * t, np.zeros(200), forces, state)
    turned = np.arctan2(state[3], state[2]) + 2 * np.pi * state[4]
    growth = math.exp(math.hypot(*force) * t)
    # The flow stretches the rounding of the start by up to e^{gt}.
    tolerance = 1e-14 * growth + 1e-14
    np.testing.assert_allclose(
        turned, exact_rotation(alpha, force, t), rtol=0, atol=min(tolerance, 1e-6)
    )


def test_turns_are_counted_for_angles_of_every_size():
    angles = np.linspace(-40.0, 40.0, 801)
    state = np.zeros((5, 801))
    state[2] = 1.0
    kernels.rotate_paths(angles, state)
    turned = np.arctan2(state[3], state[2]) + 2 * np.pi * state[4]
    # 40 is known to 7e-15, and so is its remainder after full turns.
    np.testing.assert_allclose(turned, angles, rtol=0, atol=2e-14)
