"""The density of a smooth fibre, equation (23): exact laws, orders, limits."""

from functools import cache

import numpy as np
import pytest
from orders import assert_order, measure_order

import fpsolve as fp
from fpsolve import errors, initial
from fpsolve.density.schemes import drift_kick
from fpsolve.density.smooth import smooth_drift_kick
from fpsolve.density.smooth.relaxation import covariance
from fpsolve.density.smooth.smooth_drift_kick import split_force
from fpsolve.density.solve import solve
from fpsolve.evolution.series import SERIES
from fpsolve.grids import diagnostics
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid
from fpsolve.model.curves import MovingBelt
from fpsolve.model.potentials import FreePotential, QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel

BOWL = QuadraticPotential()
# Cells of two thirds of the deviation of a free curvature, five of it to either side.
N_KAPPA, DEVIATIONS = 16, 5.2


def smooth(length, noise=1.0, potential=BOWL, speed=0.0):
    return SmoothLayDownModel(potential, length, noise, MovingBelt(speed))


def grid_for(model, n=20, n_alpha=16, half_width=5.5, largest=None, n_kappa=N_KAPPA):
    if largest is None:
        largest = DEVIATIONS * np.sqrt(model.curvature_variance)
    return SmoothPhaseSpaceGrid(half_width, largest, (n, n, n_alpha, n_kappa))


def start(model, grid, mean=(1.0, 0.0), variance=0.7):
    p = initial.gaussian(grid.phase_space, mean, variance, np.pi / 2, 1.0)
    return initial.with_curvature(p, grid, model.curvature_variance)


def run(model, grid, p0, end, n_steps, interpolation_order=8, **options):
    options = {"record_every": n_steps, **options}
    scheme = smooth_drift_kick(model, grid, interpolation_order=interpolation_order)
    return solve(scheme, p0, (0.0, end), end / n_steps, **options)


@pytest.mark.parametrize("length", [1e-3, 0.1, 1.0])
def test_without_force_the_direction_and_the_curvature_are_exact(length):
    # E cos(α_s − α_0) = exp(−½ Var), Var = A²(s − R(1 − e^{−s/R})) from the stationary
    # curvature, and none of it changes E κ² = A²/(2R).
    model = smooth(length, 0.8, FreePotential())
    grid = grid_for(model, n=12, half_width=8.0)
    p0 = start(model, grid, (0.0, 0.0), 1.5)
    found = run(model, grid, p0, 1.0, 4, record_every=1, boundary_tolerance=0.1)
    turned = 0.8**2 * (found.s + length * np.expm1(-found.s / length))
    expected = found.mean_sin_alpha[0] * np.exp(-0.5 * turned)
    # The Gaussian of κ ends at 5.2 of its deviations, where e^{−5.2²/2} = 1e-6.
    np.testing.assert_allclose(found.mean_sin_alpha, expected, rtol=0, atol=1e-6)
    np.testing.assert_allclose(
        found.mean_kappa2, model.curvature_variance, rtol=1e-4, atol=0
    )
    np.testing.assert_allclose(found.mass, 1.0, rtol=0, atol=1e-14)


def test_a_curvature_relaxes_to_its_variance_at_twice_the_rate():
    model = smooth(0.5, 1.0, FreePotential())
    grid = grid_for(model, n=12, half_width=8.0, largest=8.0, n_kappa=24)
    basic = initial.gaussian(grid.phase_space, (0.0, 0.0), 1.5)
    p0 = initial.with_curvature(basic, grid, 1.7)
    found = run(model, grid, p0, 1.0, 4, record_every=1, boundary_tolerance=0.1)
    faded = np.exp(-2 * found.s / 0.5)
    expected = 1.7 * faded + model.curvature_variance * (1 - faded)
    # The tail of the start beyond 8: 36 e^{−8²/3.4} of it.
    np.testing.assert_allclose(found.mean_kappa2, expected, rtol=1e-6, atol=0)


@pytest.mark.parametrize("ratio", [1e-4, 0.019, 0.021, 1.0, 60.0])
def test_the_split_force_answers_a_constant_one_exactly(ratio):
    length = 0.3
    kick, turn = split_force(ratio * length, length)
    faded = np.exp(-ratio)
    assert kick * (1 + faded) == pytest.approx(-np.expm1(-ratio), rel=1e-14)
    moved = 2 * turn + length * -np.expm1(-ratio) * kick
    assert moved == pytest.approx(length * (ratio + np.expm1(-ratio)), rel=1e-11)
    assert split_force(-ratio * length, length) == (-kick, -turn)


@pytest.mark.parametrize("ratio", [1e-3, 0.049, 0.051, 2.0, 80.0])
def test_the_covariance_of_the_free_flow_is_its_integral(ratio):
    model = smooth(0.4, 1.3)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    ds = ratio * 0.4
    u = 0.5 * ds * (nodes + 1)
    answer = np.stack([np.exp(-u / 0.4), -0.4 * np.expm1(-u / 0.4)])
    expected = model.curvature_noise**2 * 0.5 * ds * (answer * weights) @ answer.T
    # Sixty nodes resolve e^{−80 x} to 1e-11; without the series the last entry would
    # be lost to cancellation below a ratio of 1e-3.
    np.testing.assert_allclose(covariance(model, ds), expected, rtol=1e-9)


def test_the_order_is_two_where_the_curvature_is_resolved():
    model = smooth(1.0, 2.0, speed=0.1)
    # Fourteen points of the translation, or its error would cover that of the step.
    grid = grid_for(model, largest=9.0, n_kappa=24, half_width=6.0)
    p0 = start(model, grid, variance=0.9)
    exact = run(model, grid, p0, 1.0, 32, 14, extrapolate=True).final

    def error_of(n_steps):
        p = run(model, grid, p0, 1.0, n_steps, 14).final
        return diagnostics.l1_distance(p, exact, grid)

    # Measured: 1.4e-2, 3.5e-3, 9.1e-4.
    assert_order(measure_order(error_of, first=4), 2, 2e-3)


def test_the_order_in_position_and_angle_is_two_where_the_curvature_is_not():
    # ds/R from 250 to 62: the curvature is forgotten within every step.
    model = smooth(1e-3, speed=0.1)
    grid = grid_for(model)
    p0 = start(model, grid)
    exact = run(model, grid, p0, 1.0, 32, extrapolate=True)
    fine = exact.marginal("xi_alpha", 1.0)

    def error_of(n_steps):
        p = run(model, grid, p0, 1.0, n_steps).marginal("xi_alpha", 1.0)
        return np.abs(p - fine).sum() * grid.phase_space.cell_volume

    # Measured: 7e-3, 1.7e-3, 4.3e-4.
    assert_order(measure_order(error_of, first=4), 2, 1e-3)


def test_short_relaxation_lengths_keep_the_accuracy_of_the_limit():
    # At ds = 0.1 the marginal of (ξ, α) differs from the basic model's by both errors
    # and O(R), whose coefficient must not depend on ds/R = 100 or 1000.
    differences = []
    for length in (1e-3, 1e-4):
        model = smooth(length, speed=0.1)
        grid = grid_for(model)
        p0 = start(model, grid)
        found = run(model, grid, p0, 1.0, 10, extrapolate=True)
        basic = diagnostics.marginal(p0, grid, "xi_alpha")
        limit = solve(
            drift_kick(model.white_noise_limit, grid.phase_space), basic, (0.0, 1.0),
            0.1, extrapolate=True, record_every=10,
        )  # fmt: skip
        apart = found.marginal("xi_alpha", 1.0) - limit.final
        distance = np.abs(apart).sum() * grid.phase_space.cell_volume
        allowed = found.errors["density_l1"][-1] + limit.errors["density_l1"][-1]
        # 0.9 R is the distance for A = 1 that R = 1e-3 … 1e-2 show alike.
        assert distance <= allowed + 1.2 * length
        differences.append(found.variance_xi1[-1] - limit.variance_xi1[-1])
    # Derived in R: the ratio is ten up to a share R.
    assert differences[0] / differences[1] == pytest.approx(10.0, rel=0.02)


def test_the_curvature_is_told_well_by_steps_that_do_not_resolve_it():
    model = smooth(0.03, speed=0.1)
    grid = grid_for(model, n_kappa=20)
    p0 = start(model, grid, variance=0.9)
    exact = run(model, grid, p0, 0.5, 64, extrapolate=True).final
    found = run(model, grid, p0, 0.5, 4, extrapolate=True).final
    # ds = 4 R; 1.0e-3 measured, and 7e-3 without the correction.
    assert diagnostics.l1_distance(found, exact, grid) < 2e-3
    # Which leaves mass, position and angle as they are, to rounding.
    scheme = smooth_drift_kick(model, grid)
    state = scheme.start(p0)
    scheme.advance(state, 0.0, 0.125, 2)
    read, raw = scheme.density(state).copy(), scheme.evolved(state).copy()
    apart = diagnostics.marginal(read - raw, grid, "xi_alpha")
    assert np.abs(apart).max() < 1e-15
    assert diagnostics.l1_distance(read, raw, grid) > 1e-3


def fourier_solution(model, grid, p, end, n_steps):
    """Equation (23) by Fourier derivatives in all directions and Runge-Kutta 4."""
    xi1, xi2, alpha, kappa = grid.mesh()
    slopes = [
        2j * np.pi * np.fft.fftfreq(n, width)
        for n, width in zip(grid.shape, grid.spacing, strict=True)
    ]

    def derivative(values, axis, power=1):
        slope = slopes[axis].copy()
        if power == 1:
            slope[slope.size // 2] = 0.0
        shape = [-1 if at == axis else 1 for at in range(4)]
        modes = np.fft.fft(values, axis=axis) * slope.reshape(shape) ** power
        return np.fft.ifft(modes, axis=axis).real

    force1, force2 = model.potential.gradient(xi1, xi2)
    bend = force2 * np.cos(alpha) - force1 * np.sin(alpha)
    along, across = np.cos(alpha) + model.belt_speed, np.sin(alpha)
    pull = (kappa + bend) / model.relaxation_length

    def rate(values):
        moved = along * derivative(values, 0) + across * derivative(values, 1)
        turned = kappa * derivative(values, 2) - derivative(pull * values, 3)
        spread = 0.5 * model.curvature_noise**2 * derivative(values, 3, 2)
        return spread - moved - turned

    ds = end / n_steps
    for _ in range(n_steps):
        k1 = rate(p)
        k2 = rate(p + 0.5 * ds * k1)
        k3 = rate(p + 0.5 * ds * k2)
        p = p + ds / 6 * (k1 + 2 * k2 + 2 * k3 + rate(p + ds * k3))
    return p


def test_it_is_the_solution_that_derivatives_and_runge_kutta_give():
    model = smooth(1.0, 1.5, speed=0.1)
    grid = grid_for(model, n=16, n_alpha=16, largest=7.0, n_kappa=16)
    p0 = start(model, grid, (0.6, 0.0), 1.1)
    other = fourier_solution(model, grid, p0, 0.5, 16)
    scheme = smooth_drift_kick(model, grid, interpolation_order=12)
    found = solve(scheme, p0, (0.0, 0.5), 0.125, extrapolate=True, record_every=4)
    # Both are exact in the cells but for the translation, 2e-3 of twelve points here;
    # the coarse cells leave ripples that both carry, each in its way.
    assert diagnostics.l1_distance(found.final, other, grid) < 6e-3
    moments = diagnostics.moments(other, grid)
    for name, value in moments.items():
        assert found.series[name][-1] == pytest.approx(value, abs=2e-3), name


@pytest.mark.parametrize("length", [0.1, 1.0])
def test_errors_of_an_extrapolated_run_cover(length):
    model = smooth(length, 2.0, speed=0.1)
    largest = 9.0 if length == 1.0 else None
    grid = grid_for(model, n=16, largest=largest, n_kappa=24)
    p0 = start(model, grid, variance=0.9)
    # Estimates are of the step, not of the translation: fourteen points of it.
    fine = run(model, grid, p0, 1.0, 64, 14, extrapolate=True)
    for n_steps in (4, 8):
        found = run(model, grid, p0, 1.0, n_steps, 14, extrapolate=True)
        distance = diagnostics.l1_distance(found.final, fine.final, grid)
        assert distance <= found.errors["density_l1"][-1]
        for name in ("mean_xi1", "variance_xi1", "mean_cos_alpha", "mean_kappa",
                     "mean_kappa2"):  # fmt: skip
            error = abs(found.series[name][-1] - fine.series[name][-1])
            assert error <= found.errors[name][-1], (name, n_steps)


def test_a_run_is_kept_resumed_saved_and_repeated_bit_for_bit(tmp_path):
    model = smooth(0.2, speed=0.1)
    grid = grid_for(model, n=8, n_alpha=8)
    p0 = start(model, grid, (0.0, 0.0), 1.5)
    options = {"save_at": (0.0, 0.5, 1.0), "boundary_tolerance": 0.1, "record_every": 1}
    plain = run(model, grid, p0, 1.0, 8, **options)

    def stopped(done, total, s):
        if s == 0.75:
            raise KeyboardInterrupt

    kept = fp.Checkpoint(tmp_path / "kept", every=2)
    with pytest.raises(errors.RunInterrupted):
        run(model, grid, p0, 1.0, 8, checkpoint=kept, progress=stopped, **options)
    kept = fp.resume(tmp_path / "kept")
    assert np.array_equal(plain.densities, kept.densities)
    for name, values in plain.series.items():
        np.testing.assert_array_equal(values, kept.series[name])
    file = kept.save(tmp_path / "solution.nc")
    read = fp.load(file)
    assert read.model == model
    assert read.grid == grid
    assert np.array_equal(read.densities, plain.densities)
    assert read.to_xarray().density.dims == ("s", "xi1", "xi2", "alpha", "kappa")
    assert fp.compare(read, fp.rerun(read)).equal


def test_the_number_of_threads_does_not_matter(on_threads):
    model = smooth(0.2, speed=0.1)
    grid = grid_for(model, n=12)
    p0 = start(model, grid, (0.0, 0.0), 1.0)
    one, two = (
        on_threads(n, lambda: run(model, grid, p0, 0.5, 4, record_every=1))
        for n in (1, 2)
    )
    assert np.array_equal(one.final, two.final)
    for name, values in one.series.items():
        np.testing.assert_array_equal(values, two.series[name])


def test_the_entropy_is_recorded_relative_to_what_is_given_and_to_nothing_else():
    model = smooth(0.2)
    grid = grid_for(model, n=12)
    p0, reference = start(model, grid), start(model, grid, (0.0, 0.0), 1.0)
    alone = run(model, grid, p0, 0.5, 2)
    assert np.isnan(alone.relative_entropy).all()
    assert np.isnan(alone.entropy_floor)
    told = run(model, grid, p0, 0.5, 2, reference=reference)
    expected = diagnostics.relative_entropy(told.final, grid, reference)
    assert told.relative_entropy[-1] == pytest.approx(expected, rel=1e-12)
    assert (told.entropy_dissipation > 0).all()


def test_every_run_records_what_is_known_of_the_curvature():
    model = smooth(0.2)
    grid = grid_for(model, n=12)
    found = run(model, grid, start(model, grid), 0.5, 2)
    lawful = {"theta", "entropy_rise", "circulation", "circulation_deviation"}
    assert set(found.series) == set(SERIES) - lawful
    labels = found.to_xarray()
    assert labels.mean_kappa2.attrs["long_name"] == "mean E κ² of the squared curvature"


def test_a_range_of_curvature_that_cuts_the_density_is_refused():
    model = smooth(0.2)
    grid = grid_for(model, n=12, largest=2.2 * np.sqrt(model.curvature_variance))
    p = initial.gaussian(grid.phase_space, (0.0, 0.0), 1.0)
    p0 = initial.with_curvature(p, grid, 0.4 * model.curvature_variance)
    with pytest.raises(errors.CurvatureRangeError, match="enlarge `kappa_half_width`"):
        run(model, grid, p0, 2.0, 16, record_every=1)


def test_what_cannot_be_solved_is_refused_in_words():
    model = smooth(0.2)
    grid = grid_for(model)
    with pytest.raises(ValueError, match=r"`grid` must have cells in κ no wider"):
        smooth_drift_kick(model, grid_for(model, n_kappa=8))
    with pytest.raises(ValueError, match="`noise` must be positive for a density"):
        smooth_drift_kick(SmoothLayDownModel(BOWL, 0.2, 0.0), grid)
    with pytest.raises(TypeError, match="`grid` must be a SmoothPhaseSpaceGrid"):
        smooth_drift_kick(model, grid.phase_space)
    with pytest.raises(TypeError, match="`model` must be a SmoothLayDownModel"):
        smooth_drift_kick(model.white_noise_limit, grid)
    with pytest.raises(TypeError, match="white_noise_limit"):
        drift_kick(model, grid.phase_space)
    scheme, p0 = smooth_drift_kick(model, grid), start(model, grid)
    with pytest.raises(errors.MemoryLimitError):
        solve(scheme, p0, (0.0, 1.0), 0.1, memory_limit=2**20)
    with pytest.raises(ValueError, match="`p0` must have a curvature"):
        solve(scheme, p0[..., 0], (0.0, 1.0), 0.1)


@cache
def steady(speed):
    """The stationary density on coarse cells, from three step lengths."""
    model = smooth(0.3, 2.0, speed=speed)
    grid = grid_for(model, n=14, n_alpha=12)
    return fp.steady_state(
        model, grid, ds=0.1, extrapolate=True, tolerance=1e-5, error_tolerance=1.0,
        boundary_tolerance=1e-2,
    )  # fmt: skip


@pytest.mark.parametrize("speed", [0.0, 0.2])
def test_the_stationary_density_obeys_the_identities_of_the_belt(speed, tmp_path):
    # E cos α = −v, E sin α = 0, and for B = |ξ|²/2
    # E κ² = A²/2R + E cos² α + E sin² α − v², on coarse cells that say so.
    found = steady(speed)
    model, grid = found.model, found.grid
    moments, error = found.moments(), found.moment_errors
    assert abs(moments["mean_cos_alpha"] + speed) <= error["mean_cos_alpha"]
    assert abs(moments["mean_sin_alpha"]) <= error["mean_sin_alpha"]
    expected = model.curvature_variance + 1.0 - speed**2
    assert abs(moments["mean_kappa2"] - expected) <= error["mean_kappa2"]
    # Measured: 0.2 % of 7.67, where the stated error is a sum of worst cases.
    assert moments["mean_kappa2"] == pytest.approx(expected, rel=6e-3)
    # Of the mean of ξ·τ, which does not change: E (ξ·τ⊥)κ = −(1 − v²).
    xi1, xi2, alpha, kappa = grid.mesh()
    across = xi2 * np.cos(alpha) - xi1 * np.sin(alpha)
    turned = float((across * kappa * found.density).sum()) * grid.cell_volume
    assert turned == pytest.approx(speed**2 - 1.0, abs=2e-2)
    # e^{−B} times a Gaussian is not stationary: the density is wider than that.
    assert moments["variance_xi2"] > 1.3
    p0 = found.density
    later = run(model, grid, p0, 1.0, 40, 12, boundary_tolerance=1e-2)
    # One step length of order two, and the residual.
    assert diagnostics.l1_distance(later.final, p0, grid) < 2e-3
    read = fp.load(found.save(tmp_path / "steady.nc"))
    assert np.array_equal(read.density, found.density)
    assert read.moment_errors == found.moment_errors
    assert (read.grid, read.model) == (grid, model)


def test_the_entropy_relative_to_the_stationary_density_falls_by_its_dissipation():
    found = steady(0.2)
    grid = found.grid
    # Ripples of coarse cells are below zero in the tails, by 2e-4 of the largest.
    assert found.density.min() > -1e-3 * found.density.max()
    told = run(
        found.model, grid, start(found.model, grid, variance=0.9), 2.0, 32, 12,
        record_every=1, extrapolate=True, boundary_tolerance=1e-2,
        reference=np.maximum(found.density, 0.0),
    )  # fmt: skip
    s, entropy = told.s[8:], told.relative_entropy[8:]
    assert (np.diff(entropy) < 0).all()
    lost = np.trapezoid(told.entropy_dissipation[8:], s)
    # Tails that the dissipation leaves out and sixteen cells in κ: 1 % measured.
    assert lost == pytest.approx(entropy[0] - entropy[-1], rel=0.04)


def test_a_stationary_density_is_refused_where_memory_or_curvature_do_not_do():
    model = smooth(0.3, 2.0)
    with pytest.raises(TypeError, match="`grid` must be a SmoothPhaseSpaceGrid"):
        fp.steady_state(model, grid_for(model).phase_space)
    with pytest.raises(errors.MemoryLimitError):
        fp.steady_state(model, grid_for(model, n=2000, n_alpha=256))
    # Two and a half deviations of a free curvature.
    narrow = grid_for(model, n=10, n_alpha=8, largest=6.5, n_kappa=12)
    with (
        pytest.warns(UserWarning, match="before normalisation"),
        pytest.raises(errors.CurvatureRangeError, match="enlarge `kappa_half_width`"),
    ):
        fp.steady_state(
            model, narrow, ds=0.1, tolerance=1e-2, error_tolerance=10.0,
            boundary_tolerance=0.02,
        )  # fmt: skip


def test_a_step_is_a_quarter_of_r_unless_that_is_too_many():
    basic = fp.suggest_step(
        smooth(1.0).white_noise_limit, grid_for(smooth(1.0)).phase_space
    )
    for length, expected in ((0.2, 0.05), (1e-3, basic), (50.0, basic)):
        model = smooth(length)
        step = fp.suggest_step(model, grid_for(model))
        assert step == expected
    assert (
        "a quarter of R" in fp.suggest_step(smooth(0.2), grid_for(smooth(0.2))).reason
    )
