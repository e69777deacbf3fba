"""Densities that come back every period: identities, limits, paths and refusals."""

import math
import warnings
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from orders import measure_order

import fpsolve as fp
from fpsolve.density.periodic.period import on_mean_belt, period_of
from fpsolve.density.periodic.phases import at_phases
from fpsolve.density.stationary.coarser import carried
from fpsolve.density.stationary.iteration import stationary
from fpsolve.density.stationary.start import start_on
from fpsolve.errors import ToleranceError

QUADRATIC = fp.QuadraticPotential()
SWINGING = fp.LayDownModel(QUADRATIC, 1.5, fp.OscillatingNozzle(0.1, 0.6, 1.0))
GRID = fp.PhaseSpaceGrid(6.0, (28, 28, 16))
LENIENT = {"error_tolerance": 0.1, "tolerance": 1e-7}


def rotating(noise, speed, radius, angular_speed, potential=QUADRATIC):
    curve = fp.RotatingNozzle(speed, radius, angular_speed)
    return fp.LayDownModel(potential, noise, curve)


@pytest.fixture(scope="module")
def swinging():
    return fp.periodic_state(SWINGING, GRID, n_phases=16, **LENIENT)


def derivative(values, period):
    """d/ds of a trigonometric interpolant over the phases of a period."""
    modes = 2j * np.pi / period * np.fft.rfftfreq(values.size, 1 / values.size)
    modes[-1] = 0.0
    return np.fft.irfft(modes * np.fft.rfft(values), values.size)


def test_a_nozzle_at_rest_leaves_the_stationary_density_of_its_belt():
    grid = fp.PhaseSpaceGrid(5.5, (24, 24, 12))
    belt = fp.LayDownModel(QUADRATIC, 1.0, fp.MovingBelt(0.1))
    still = fp.steady_state(belt, grid, error_tolerance=0.1)
    found = fp.periodic_state(
        rotating(1.0, 0.1, 0.0, 2 * np.pi), grid, n_phases=4, error_tolerance=0.1
    )
    # Other steps, so that the errors of both are between them, and a small share of
    # that of the cells: interpolation errs more often with more steps.
    allowed = found.errors["step"] + still.errors["step"] + 0.01 * still.errors["grid"]
    for p in found.densities:
        assert 0 < fp.diagnostics.l1_distance(p, still.density, grid) < allowed


def test_the_mean_direction_is_what_nozzle_and_mean_deviation_leave(swinging):
    moments, s = swinging.moments(), swinging.s
    nozzle = SWINGING.curve.velocity(s)
    for k, direction in enumerate(("mean_cos_alpha", "mean_sin_alpha")):
        name = f"mean_xi{k + 1}"
        change = derivative(moments[name], swinging.period)
        # d(E ξ)/ds = E τ − γ′ for every density; 16 phases resolve it to 1e-4.
        defect = np.abs(moments[direction] - nozzle[k] - change)
        assert np.all(defect < swinging.moment_errors[direction] + 1e-4)
    # On average over the period, where the error of the phases cancels.
    assert abs(moments["mean_cos_alpha"].mean() + 0.1) < 1e-4
    assert abs(moments["mean_sin_alpha"].mean()) < 1e-6


def test_every_phase_has_mass_one_and_next_to_no_negative_values(swinging):
    for p in swinging.densities:
        assert abs(fp.diagnostics.mass(p, GRID) - 1) < 1e-13
        assert fp.diagnostics.negative_mass(p, GRID) < swinging.error
    assert swinging.residual <= 1e-7


def test_half_a_period_later_the_density_of_a_swinging_nozzle_is_its_mirror_image(
    swinging,
):
    for j in range(8):
        mirrored = swinging.densities[j][:, ::-1, ::-1]
        apart = fp.diagnostics.l1_distance(mirrored, swinging.densities[j + 8], GRID)
        # The scheme has the symmetry; what the iteration left has it not.
        assert apart < 1e-5


def test_under_a_rotating_nozzle_at_rest_the_density_turns_with_it():
    grid = fp.PhaseSpaceGrid(5.5, (26, 26, 16))
    found = fp.periodic_state(rotating(1.5, 0.0, 0.5, 1.0), grid, n_phases=8, **LENIENT)
    moments, errors = found.moments(), found.moment_errors
    for pair in (("mean_xi1", "mean_xi2"), ("mean_cos_alpha", "mean_sin_alpha")):
        first, second = (moments[name] for name in pair)
        size = np.hypot(first, second)
        spread = np.hypot(*(errors[name] for name in pair)).max()
        assert np.ptp(size) < spread < 0.1 * size.mean()
        turned = np.unwrap(np.arctan2(second, first))
        np.testing.assert_allclose(
            np.diff(turned), 2 * np.pi / 8, atol=2 * spread / size.min()
        )


@pytest.mark.parametrize("shape", [(16, 16, 12), (20, 20, 12)])
def test_what_a_result_states_covers_every_phase_and_moment(swinging, shape):
    grid = fp.PhaseSpaceGrid(6.0, shape)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        found = fp.periodic_state(SWINGING, grid, n_phases=16, error_tolerance=1.0)
    allowed = swinging.moment_errors
    for name, values in found.moments().items():
        apart = np.abs(values - swinging.moments()[name])
        assert np.all(apart < found.moment_errors[name] + allowed[name]), name
    for coarse, fine, stated in zip(
        found.densities, swinging.densities, found.phase_errors, strict=True
    ):
        apart = fp.diagnostics.l1_distance(carried(coarse, GRID.shape), fine, GRID)
        # It covers, and not by a factor beyond all use.
        assert 0.02 * stated < apart < stated + swinging.error


def test_paths_have_the_means_of_the_density_at_every_phase(swinging):
    n_periods, shown = 3, (0, 5, 11)
    places = [n_periods * swinging.period + swinging.s[j] for j in shown]
    places = [round(s / (swinging.period / 160)) for s in places]
    ds = swinging.period / 160
    paths = fp.sample_paths(
        SWINGING, 20000, places[-1] * ds, ds, seed=18, save_at=[n * ds for n in places]
    )
    moments, errors = swinging.moments(), swinging.moment_errors
    for row, j in enumerate(shown):
        samples = {
            "mean_xi1": paths.xi[row, :, 0], "mean_xi2": paths.xi[row, :, 1],
            "mean_cos_alpha": np.cos(paths.alpha[row]),
            "mean_sin_alpha": np.sin(paths.alpha[row]),
        }  # fmt: skip
        for name, sample in samples.items():
            spread = sample.std() / math.sqrt(sample.size)
            # Four standard errors, and what three periods leave of the start: e^{−15}.
            apart = abs(sample.mean() - moments[name][j])
            assert apart < 4 * spread + errors[name][j], (j, name)
            assert errors[name][j] < 2 * spread


# Ten seconds; its sample paths and identities hold the same density on every push.
@pytest.mark.nightly
def test_for_large_noise_the_mean_follows_the_nozzle_as_in_the_hydrodynamic_limit():
    def distance(noise):
        radius, turn, drift = 1.0, 0.5, 0.2
        model = rotating(noise, drift / noise**2, radius, turn / noise**2)
        found = fp.periodic_state(
            model, fp.PhaseSpaceGrid(6.0, (20, 20, 12)), n_phases=4, **LENIENT
        )
        # m′ = −m/A² − γ′ for B = |ξ|²/2: m = A²v e₁, and what turns with the nozzle.
        turning = np.exp(1j * turn / noise**2 * found.s)
        limit = drift - radius * 1j * turn / (1j * turn + 1) * turning
        moments = found.moments()
        mean = moments["mean_xi1"] + 1j * moments["mean_xi2"]
        return np.abs(mean - limit).max()

    found = measure_order(distance, 1.5, n_halvings=1)
    # What the limit leaves out is A^{−4} of the whole, 0.64: 0.12 and 0.0076.
    assert abs(found.orders[0] - 4.0) < 0.3
    assert found.errors[1] < 0.01


def test_phases_are_of_order_six_in_the_step_and_two_with_a_single_one():
    # So fine that what the cells miss more of with more steps lies below.
    grid = fp.PhaseSpaceGrid(5.5, (40, 40, 14))
    scheme = fp.drift_kick(SWINGING, grid, interpolation_order=12)
    period = period_of(SWINGING.curve)
    start = start_on(grid, on_mean_belt(SWINGING))

    @cache
    def phases(n):
        found = stationary(scheme, period / n, start, 1e-6, length=period)
        return found, at_phases(scheme, found, period, 3).densities

    def error_of(n):
        apart = phases(n)[1] - phases(48)[1]
        return max(np.abs(apart).sum(axis=(1, 2, 3))) * grid.cell_volume

    def error_of_the_mean(n):
        apart = phases(n)[1] - phases(48)[1]
        return np.abs(np.einsum("sijk,j->s", apart, grid.xi2)).max()

    mean = measure_order(error_of_the_mean, 8, n_halvings=1)
    assert abs(mean.orders[0] - 6.0) < 0.4, mean
    # The highest harmonics of the angle, which a step damps out, have no expansion in
    # ds: with them it is beyond four and below six (measured 4.8).
    density = measure_order(error_of, 8, n_halvings=1)
    assert 4.3 < density.orders[0] < 6.0, density
    single = measure_order(
        lambda n: float(np.abs(phases(n)[0].splitting).sum()), 8, n_halvings=1
    )
    np.testing.assert_allclose(single.orders, 2.0, atol=0.3)


@pytest.mark.nightly
def test_a_smooth_fibre_has_a_periodic_density_too():
    curve = fp.OscillatingNozzle(0.1, 0.5, 1.0)
    model = fp.SmoothLayDownModel(QUADRATIC, 0.3, 2.0, curve)
    grid = fp.SmoothPhaseSpaceGrid(5.5, 13.4, (14, 14, 12, 16))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        found = fp.periodic_state(
            model, grid, ds=0.25, n_phases=4, tolerance=1e-4, error_tolerance=1.0,
            boundary_tolerance=0.1,
        )  # fmt: skip
    moments = found.moments()
    assert found.densities.shape == (4, *grid.shape)
    # Exact on average; four phases tell it to the harmonics beyond their reach.
    assert abs(moments["mean_cos_alpha"].mean() + 0.1) < 0.02
    assert abs(moments["mean_sin_alpha"].mean()) < 1e-3
    # In the limit of large noise the fibre follows γ₂ = r sin s by E sin α =
    # r a sin(s + …)/√(1 + a²), a = 1/A²: 0.12 at most, and near that a quarter later.
    assert 0.06 < moments["mean_sin_alpha"][1] < 0.18


@dataclass(frozen=True)
class Wobble(fp.Curve):
    """A curve of a user's own: γ = −v s e₁ + r (cos ωs, sin ωs), period as stated."""

    speed: float
    radius: float
    period: float
    autonomous, fixed, formula, latex = False, False, "wobble", "wobble"

    def _nozzle(self):
        return fp.RotatingNozzle(self.speed, self.radius, 2 * np.pi)

    def position(self, s):
        return self._nozzle().position(s)

    def velocity(self, s):
        return self._nozzle().velocity(s)

    def displacement(self, s0, s1):
        return self._nozzle().displacement(s0, s1)


def test_a_curve_of_ones_own_must_keep_its_period():
    assert period_of(Wobble(0.1, 0.3, 1.0)) == 1.0
    assert period_of(Wobble(0.1, 0.3, 2.0)) == 2.0
    for wrong in (0.7, 0.5):
        with pytest.raises(ValueError, match=r"`curve` must move by -v P e1 over its"):
            period_of(Wobble(0.1, 0.3, wrong))


@pytest.mark.parametrize(
    "curve", [fp.MovingBelt(0.1), fp.RotatingNozzle(0.1, 1.0, 0.0), fp.FixedBelt()]
)
def test_what_does_not_move_periodically_is_refused(curve):
    model = replace(SWINGING, curve=curve)
    with pytest.raises(ValueError, match=r"`curve` must move periodically.*`steady_s"):
        fp.periodic_state(model, GRID)


def test_arguments_that_cannot_work_are_named():
    def refused(message, kind=ValueError, model=SWINGING, grid=GRID, **options):
        with pytest.raises(kind, match=message):
            fp.periodic_state(model, grid, **options)

    refused("`model` must be a FibreModel", TypeError, model="model")
    refused("`grid` is needed with a model", TypeError, grid=None)
    refused("`n_phases` must be at least 4, got 2", n_phases=2)
    refused("`n_phases` must be an integer", TypeError, n_phases=8.5)
    refused("`tolerance` must be positive, got nan", tolerance=math.nan)
    refused("`error_tolerance` must be positive, got -1", error_tolerance=-1.0)
    refused("`ds` must be positive, got nan", ds=math.nan)
    refused("`noise` must be positive, got 0", model=replace(SWINGING, noise=0.0))
    free = replace(SWINGING, potential=fp.FreePotential())
    refused("`potential` must confine", model=free)
    weak = rotating(3.0, 0.2, 0.5, 1.0, fp.LinearPotential())
    refused(r"`speed` must be below .* = 0\.1104 for", model=weak)
    few = fp.PhaseSpaceGrid(6.0, (16, 16, 4))
    refused("`grid` must have at least 6 cells in every", grid=few)


@pytest.mark.nightly
def test_a_box_or_a_grid_that_does_not_hold_the_density_is_refused():
    with pytest.raises(fp.DomainTooSmallError, match="enlarge `half_width`"):
        fp.periodic_state(SWINGING, fp.PhaseSpaceGrid(2.5, (20, 20, 12)), n_phases=4)
    fast = rotating(1.0, 0.1, 1.0, 1.0)
    with pytest.raises(ToleranceError, match="a grid of about half widths"):
        fp.periodic_state(fast, fp.PhaseSpaceGrid(7.0, (24, 24, 14)), n_phases=4)
    with pytest.raises(fp.SteadyStateError, match="refine the grid"):
        fp.periodic_state(
            rotating(1.0, 0.1, 2.0, 0.5), fp.PhaseSpaceGrid(7.5, (12, 12, 10)),
            n_phases=4,
        )  # fmt: skip
    with pytest.warns(UserWarning, match=r"the periodic density has an L1 error .*ce`"):
        fp.periodic_state(
            SWINGING, fp.PhaseSpaceGrid(6.0, (20, 20, 12)), n_phases=4,
            error_tolerance=1e-2, tolerance=1e-4,
        )  # fmt: skip
