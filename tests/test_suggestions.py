"""Suggested steps and grids follow the measured error laws and say why."""

import copy
import pickle

import numpy as np
import pytest

import fpsolve as fp
from fpsolve import suggestions


def model(noise=1.0, potential=None, curve=None):
    return fp.LayDownModel(
        potential or fp.QuadraticPotential(), noise, curve or fp.FixedBelt()
    )


GRID = fp.PhaseSpaceGrid(6.0, (64, 64, 32))


def test_the_suggested_step_keeps_the_law_below_the_tolerance():
    for noise in (0.0, 0.3, 1.0, 3.0, 10.0):
        step = fp.suggest_step(model(noise), GRID, tolerance=1e-3)
        # κ = ½ ∫|∇B|² e^{−B}/Z = 1 for the isotropic quadratic potential.
        assert (0.8 + 0.18 * noise**2) * step**2 <= 1e-3 * (1 + 1e-9)


def test_a_quarter_of_the_tolerance_halves_the_step():
    wide = fp.suggest_step(model(), GRID, tolerance=1e-2)
    narrow = fp.suggest_step(model(), GRID, tolerance=2.5e-3)
    # Steps are 1/m: rounding moves the ratio by at most 1/m.
    assert narrow / wide == pytest.approx(0.5, abs=0.06)


def test_a_suggested_step_divides_whole_spans_and_explains_itself():
    step = fp.suggest_step(model(2.0), GRID)
    assert round(1 / step) * step == pytest.approx(1.0, abs=1e-15)
    assert "splitting error" in step.reason
    assert "A = 2" in step.reason
    assert pickle.loads(pickle.dumps(step)).reason == step.reason


def test_cells_too_coarse_for_the_tolerance_are_pointed_out():
    coarse = fp.PhaseSpaceGrid(6.0, (24, 24, 32))
    assert "refine the grid" in fp.suggest_step(model(), coarse, 1e-3).reason


def test_the_suggested_box_holds_all_but_a_tenth_of_the_tolerance():
    for tolerance in (1e-2, 1e-4):
        grid = fp.suggest_grid(model(), tolerance)
        half = grid.half_widths[0]
        # Both Gaussian tails outside ±L, per direction.
        assert np.exp(-(half**2) / 2) < tolerance
        assert str(half).rstrip(".0") in grid.reason


def test_the_box_follows_the_belt_and_the_anisotropy():
    wide = fp.suggest_grid(model(3.0, curve=fp.MovingBelt(0.2)))
    assert wide.half_widths[0] >= wide.half_widths[1] + 1.5
    flat = fp.suggest_grid(model(1.0, fp.QuadraticPotential(1.0, 0.25)))
    assert flat.half_widths[1] < 0.5 * flat.half_widths[0]


def test_the_belt_shift_tends_to_the_mean_of_the_hydrodynamic_limit():
    shifted = model(2.0, curve=fp.MovingBelt(0.001))
    # ⟨ξ1⟩ = A²k/2 with k → 2v as v → 0; the next term is of relative order v².
    assert suggestions.belt_shift(shifted) == pytest.approx(0.004, rel=1e-5)


def test_less_noise_and_a_kink_ask_for_more_cells():
    smooth, quiet = fp.suggest_grid(model(1.0)), fp.suggest_grid(model(0.1))
    assert quiet.shape[0] > smooth.shape[0]
    assert quiet.shape[2] > smooth.shape[2]
    assert "kink of slope 1" in fp.suggest_grid(model(1, fp.LinearPotential())).reason


def test_suggestions_are_grids_and_steps_that_a_run_accepts():
    found = fp.suggest_grid(model(), 5e-2)
    assert isinstance(found, fp.PhaseSpaceGrid)
    assert copy.deepcopy(found).reason == found.reason
    p0 = fp.initial.equilibrium(found, fp.QuadraticPotential())
    step = fp.suggest_step(model(), found)
    scheme = fp.drift_kick(model(), found, balanced=True)
    solution = fp.solve(scheme, p0, (0.0, 1.0), step)
    assert solution.status == "finished"


def test_tolerances_and_potentials_without_meaning_are_refused():
    for wrong in (0.0, 1.0, -1.0, float("nan")):
        with pytest.raises(ValueError, match="`tolerance` must lie between 0 and 1"):
            fp.suggest_grid(model(), wrong)
        with pytest.raises(ValueError, match="`tolerance` must lie between 0 and 1"):
            fp.suggest_step(model(), GRID, wrong)
    with pytest.raises(ValueError, match="`potential` must confine"):
        fp.suggest_grid(model(1.0, fp.FreePotential()))
