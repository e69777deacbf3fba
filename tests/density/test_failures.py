"""What stops a run, with which numbers, and what survives it."""

import numpy as np
import pytest

from fpsolve import initial
from fpsolve.density.schemes import drift_kick, semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.errors import (
    DomainTooSmallError,
    EntropyRiseError,
    MassCorrectionError,
    MassDriftError,
    NegativeDensityError,
    NonFiniteDensityError,
    RunInterrupted,
)
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import FreePotential, QuadraticPotential

MODEL = LayDownModel(QuadraticPotential(), 1.0)
GRID = PhaseSpaceGrid(6.0, (20, 20, 16))
P0 = initial.gaussian(GRID, (1.5, 0.0), 0.5, np.pi / 2, 2.0)
# Switches off what else a spoiled run is noticed by.
LAWLESS = {"entropy_tolerance": np.inf, "circulation_tolerance": np.inf}


class Spoiled(drift_kick):
    """The drift-kick scheme with an accident when s passes 0.35."""

    def __init__(self, accident):
        super().__init__(MODEL, GRID)
        self.accident = accident

    def advance(self, state, s, ds, n_steps=1):
        super().advance(state, s, ds, n_steps)
        if s <= 0.35 < s + n_steps * ds:
            self.accident(state)


def spoil(index, value):
    def accident(state):
        state.values[index] = value

    return accident


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_density_that_is_not_finite_stops_the_run_where_it_is(value):
    scheme = Spoiled(spoil((3, 4, 5), value))
    with pytest.raises(NonFiniteDensityError, match=r"not finite at s = 0\.4, first at index \(3, 4, 5\)") as caught:  # fmt: skip  # noqa: E501
        solve(scheme, P0, (0.0, 1.0), 0.1, save_at=(0.0, 0.2, 1.0))
    assert caught.value.s == pytest.approx(0.4)
    assert caught.value.index == (3, 4, 5)
    check_partial(caught.value.solution)


def test_mass_that_drifts_stops_the_run_with_the_numbers():
    def accident(state):
        state.values *= 1.0 + 3e-5

    with pytest.raises(MassDriftError, match=r"relative mass drift 3e-05 exceeds tolerance 1e-10 at s = 0\.4") as caught:  # fmt: skip  # noqa: E501
        solve(Spoiled(accident), P0, (0.0, 1.0), 0.1, save_at=(0.0, 0.2, 1.0))
    # The mass itself is kept to 1e-14.
    assert caught.value.drift == pytest.approx(3e-5, rel=1e-8)
    assert caught.value.tolerance == 1e-10
    check_partial(caught.value.solution, n_records=5)


def test_a_larger_mass_tolerance_lets_the_same_run_pass():
    def accident(state):
        state.values *= 1.0 + 3e-5

    solution = solve(Spoiled(accident), P0, (0.0, 1.0), 0.1, mass_tolerance=1e-4)
    assert solution.mass[-1] / solution.mass[0] - 1 == pytest.approx(3e-5, rel=1e-8)


def test_characteristics_without_adjustment_drift_and_say_so():
    scheme = semi_lagrangian(MODEL, GRID, adjusted=False)
    with pytest.raises(MassDriftError, match="use a conservative scheme, a smaller"):
        solve(scheme, P0, (0.0, 1.0), 0.1)
    free = solve(scheme, P0, (0.0, 1.0), 0.1, mass_tolerance=0.1)
    drift = np.abs(free.mass / free.mass[0] - 1)
    # The interpolation error of cubics on cells of 0.6.
    assert 1e-6 < drift.max() < 1e-2


def test_a_correction_that_is_no_rounding_is_an_error_not_a_rescaling():
    def accident(state):
        state.correction = 0.05

    with pytest.raises(MassDriftError, match=r"drift 0\.05 exceeds tolerance 0\.02"):
        solve(Spoiled(accident), P0, (0.0, 1.0), 0.1)


def test_a_density_that_is_largely_negative_stops_the_run_with_its_share():
    def accident(state):
        # Mass 0.3 more at one cell, and as much less at another.
        amount = 0.3 / GRID.cell_volume
        state.values[8, 9, 3] += amount
        state.values[12, 9, 3] -= amount

    with pytest.raises(NegativeDensityError, match=r"negative mass 0\.\d+ exceeds tolerance 0\.2 at s = 0\.4.*`positive=True`") as caught:  # fmt: skip  # noqa: E501
        solve(Spoiled(accident), P0, (0.0, 1.0), 0.1, save_at=(0.0, 0.2, 1.0))
    # Less what the density there makes up for.
    assert 0.25 < caught.value.negative_mass <= 0.3
    assert caught.value.tolerance == 0.2
    check_partial(caught.value.solution, n_records=5)
    allowed = Spoiled(accident)
    solve(allowed, P0, (0.0, 0.4), 0.1, negative_tolerance=0.5, **LAWLESS)


def test_small_steps_without_noise_are_stopped_before_they_blow_up():
    # Nothing damps the angles here, and without `positive` the undershoots of the
    # interpolation grow: to six times the density if the run went on to s = 50.
    grid = PhaseSpaceGrid(5.5, (24, 24, 16))
    p0 = initial.gaussian(grid, (1.0, 0.0), 0.5, np.pi / 2, 2.0)
    model = LayDownModel(QuadraticPotential(), 0.0)
    # The entropy tells before the negative mass does.
    with pytest.raises(EntropyRiseError):
        solve(
            drift_kick(model, grid, balanced=True), p0, (0.0, 50.0), 0.025,
            record_every=20,
        )  # fmt: skip
    positive = drift_kick(model, grid, balanced=True, positive=True)
    # Limiting every row in 2000 steps wears the circulation off.
    solution = solve(
        positive, p0, (0.0, 50.0), 0.025, record_every=20, circulation_tolerance=1.0
    )
    assert solution.minimum.min() >= 0.0
    assert np.abs(solution.final).max() <= p0.max()


def test_mass_at_the_boundary_stops_the_run_with_the_half_width():
    grid = PhaseSpaceGrid((3.0, 4.0), (20, 20, 16))
    p0 = initial.gaussian(grid, variance=0.25, angle=0.0, concentration=4.0)
    model = LayDownModel(FreePotential(), 0.0)
    with pytest.raises(DomainTooSmallError, match=r"boundary mass 0\.\d+ exceeds tolerance 0\.001 at s = [\d.]+: the box of half width \(3, 4\) is too small; enlarge") as caught:  # fmt: skip  # noqa: E501
        solve(drift_kick(model, grid), p0, (0.0, 4.0), 0.1)
    # E ξ₁ = 0.86 s; three standard deviations before the boundary it begins.
    assert 0.5 < caught.value.s < 2.5
    assert caught.value.boundary_mass > caught.value.tolerance == 1e-3
    assert caught.value.solution.status == "failed"


@pytest.mark.parametrize("form", ["h", "p"])
def test_a_weight_outside_zero_and_one_is_refused(form):
    # The mass that interpolation loses in a step does not shrink with ds, what moving
    # the feet by η b ds² can restore does.
    scheme = semi_lagrangian(MODEL, GRID, form=form)
    with pytest.raises(MassCorrectionError, match=r"weight theta = -[\d.]+ outside \[0, 1\] at s = 0 \(step 0\).*enlarge `ds`") as caught:  # fmt: skip  # noqa: E501
        solve(scheme, P0, (0.0, 1.0), 1 / 512)
    assert caught.value.theta < 0
    assert caught.value.step == 0
    assert len(caught.value.solution.s) == 1


def test_the_p_form_is_refused_at_low_noise():
    grid = PhaseSpaceGrid(6.0, (24, 24, 16))
    p0 = initial.gaussian(grid, (1.5, 0.0), 0.25, np.pi / 2, 4.0)
    model = LayDownModel(QuadraticPotential(), 0.3)
    with pytest.raises(MassCorrectionError, match="unstable; use the form `h`"):
        solve(semi_lagrangian(model, grid, form="p"), p0, (0.0, 5.0), 1 / 64)


def check_partial(solution, n_records=4):
    """Everything up to the accident is there."""
    assert solution.status == "failed"
    assert solution.message
    np.testing.assert_allclose(solution.s, 0.1 * np.arange(n_records), atol=1e-15)
    assert solution.saved_s.tolist() == pytest.approx([0.0, 0.2])
    assert np.isfinite(solution.densities).all()
    assert solution.densities.shape == (2, *GRID.shape)


def interrupt_at(step):
    def progress(n_done, n_total, s):
        if n_done >= step:
            raise KeyboardInterrupt

    return progress


def test_an_interrupted_run_keeps_what_it_had():
    with pytest.raises(RunInterrupted, match="partial result") as caught:
        solve(
            drift_kick(MODEL, GRID), P0, (0.0, 1.0), 0.125,
            save_at=(0.25, 0.5, 1.0), progress=interrupt_at(5),
        )  # fmt: skip
    solution = caught.value.solution
    assert isinstance(caught.value, KeyboardInterrupt)
    assert solution.status == "interrupted"
    assert solution.message == "stopped by the user"
    assert solution.saved_s.tolist() == [0.25, 0.5]
    assert len(solution.s) == 6


def test_an_interrupted_extrapolation_falls_back_on_the_finished_run():
    with pytest.raises(RunInterrupted) as caught:
        solve(
            drift_kick(MODEL, GRID), P0, (0.0, 1.0), 0.125, extrapolate=True,
            progress=interrupt_at(15),
        )  # fmt: skip
    solution = caught.value.solution
    plain = solve(drift_kick(MODEL, GRID), P0, (0.0, 1.0), 0.125)
    assert solution.status == "interrupted"
    assert solution.errors is None
    assert np.array_equal(solution.final, plain.final)


def test_a_failure_at_half_the_step_leaves_the_finished_run_at_the_whole_one():
    class FailsWhenFine(drift_kick):
        def advance(self, state, s, ds, n_steps=1):
            super().advance(state, s, ds, n_steps)
            if ds < 0.1:
                state.values[0, 0, 0] = np.nan

    with pytest.raises(NonFiniteDensityError, match="density is not finite") as caught:
        solve(
            FailsWhenFine(MODEL, GRID), P0, (0.0, 1.0), 0.125, save_at=(0.5, 1.0),
            extrapolate=True,
        )  # fmt: skip
    kept = caught.value.solution
    expected = solve(drift_kick(MODEL, GRID), P0, (0.0, 1.0), 0.125, save_at=(0.5, 1.0))
    assert kept.status == "failed"
    assert "this is the one at ds, not extrapolated" in kept.message
    np.testing.assert_array_equal(kept.densities, expected.densities)
