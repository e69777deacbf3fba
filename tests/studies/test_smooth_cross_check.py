"""Density and paths of smooth fibres, which know nothing of each other, agree."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.density.smooth.marginal import without_curvature
from fpsolve.paths.laws import GaussianLaw
from fpsolve.studies.agreement.cross_check import compare

START = GaussianLaw((1.0, 0.0), 0.9, np.pi / 2, 1.0)


def model_of(length):
    return fp.SmoothLayDownModel(
        fp.QuadraticPotential(), length, 1.5, fp.MovingBelt(0.1)
    )


def grid_for(model):
    largest = 5.2 * np.sqrt(model.curvature_variance)
    return fp.SmoothPhaseSpaceGrid(5.5, largest, (16, 16, 12, 18))


@pytest.mark.parametrize("length", [1e-3, 0.2])
def test_density_and_paths_of_a_smooth_fibre_agree(length, tmp_path):
    # The seed is fixed: the probability of an alarm, 1e-3, is no chance of the test.
    model = model_of(length)
    check = fp.studies.cross_check(
        model,
        START,
        (0.5, 1.0),
        grid=grid_for(model),
        n_paths=20_000,
        seed=7,
        ds=1 / 16,
    )
    assert check.agrees, str(check)
    assert check.model == model
    read = fp.load(check.save(tmp_path / "check.nc"))
    assert str(read) == str(check)
    assert read.grid == grid_for(model)
    if length > 0.1:
        assert fp.compare(read, fp.rerun(read)).equal


def test_paths_of_another_relaxation_length_are_told_apart():
    model, other = model_of(0.2), model_of(1e-3)
    check = fp.studies.cross_check(
        model, START, 1.0, grid=grid_for(model), n_paths=20_000, seed=7, ds=1 / 16
    )
    solution = fp.solve(
        fp.smooth_drift_kick(model, grid_for(model)), started(model), (0.0, 1.0),
        1 / 16, extrapolate=True, record_every=16,
    )  # fmt: skip
    paths = fp.sample_paths(other, 20_000, 1.0, 1 / 32, seed=7, initial=START)
    assert check.agrees
    assert not compare(solution, paths, s=1.0).agrees


def started(model):
    grid = grid_for(model)
    basic = fp.initial.gaussian(grid.phase_space, (1.0, 0.0), 0.9, np.pi / 2, 1.0)
    return fp.initial.with_curvature(basic, grid, model.curvature_variance)


def test_a_result_without_its_curvature_is_that_of_position_and_angle():
    model = model_of(0.2)
    solution = fp.solve(
        fp.smooth_drift_kick(model, grid_for(model)), started(model), (0.0, 0.25), 0.125
    )
    plain = without_curvature(solution)
    assert plain.grid == solution.grid.phase_space
    assert np.array_equal(plain.final, solution.marginal("xi_alpha", 0.25))
    assert without_curvature(plain) is plain
    assert plain.initial_density is None


def test_a_check_of_a_smooth_fibre_needs_a_grid_with_a_curvature():
    model = model_of(0.2)
    with pytest.raises(TypeError, match="`grid` must be a SmoothPhaseSpaceGrid"):
        fp.studies.cross_check(
            model, START, 1.0, grid=grid_for(model).phase_space, n_paths=2000, seed=1
        )
