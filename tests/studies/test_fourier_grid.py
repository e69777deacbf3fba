"""Grids for Fourier translations keep the tolerance they were chosen for."""

import math

import numpy as np
import pytest
from problems import DecayingCirculation

import fpsolve as fp
from fpsolve.grids.diagnostics import l1_distance
from fpsolve.studies import fourier_grid, suggested_grid

MODEL = fp.LayDownModel(fp.QuadraticPotential(), 1.0)


def swirl(grid):
    """A solution in closed form."""
    return DecayingCirculation(MODEL.potential, MODEL.noise, grid, share=0.5)


def narrow(grid, variance=0.5):
    return fp.initial.gaussian(grid, (0.5, 0.0), variance, 0.3, 1.0)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_a_run_on_the_grid_is_as_near_the_exact_density_as_asked(tolerance):
    grid = fp.suggest_fourier_grid(
        MODEL, lambda one: swirl(one).initial(), 0.5, tolerance
    )
    problem, scheme = swirl(grid), fp.drift_kick(MODEL, grid, translation="fourier")
    p = fp.solve(scheme, problem.initial(), (0.0, 0.5), tolerance=tolerance).final
    error = l1_distance(p, problem.density(0.5), grid)
    # The coarsest cells are good for more than the first; 5.1e-6 and 4.1e-9 measured.
    assert error < tolerance
    assert math.prod(grid.shape) < 60_000


def test_the_interpolant_of_waves_that_cells_resolve_is_exact_anywhere():
    few, many = fp.PhaseSpaceGrid(2.0, (8, 10, 12)), fp.PhaseSpaceGrid(1.5, (14, 6, 10))

    def waves(grid):
        xi1, xi2, alpha = grid.mesh()
        turn = np.pi / 2
        return np.cos(3 * turn * xi1 + 0.2) * np.sin(4 * turn * xi2) + np.cos(5 * alpha)

    # Rounding of sums over 30 cells.
    np.testing.assert_allclose(
        fourier_grid._read(waves(few), few, many), waves(many), rtol=0, atol=1e-13
    )


def test_a_narrower_start_gets_smaller_cells_and_a_farther_one_a_wider_box():
    def chosen(mean, variance):
        def start(grid):
            return fp.initial.gaussian(grid, (mean, 0.0), variance, 0.3, 1.0)

        return fp.suggest_fourier_grid(MODEL, start, 0.25, 1e-2)

    plain, sharp, far = chosen(0.5, 0.5), chosen(0.5, 0.2), chosen(3.0, 0.5)
    assert max(sharp.spacing[:2]) < 0.8 * min(plain.spacing[:2])
    assert far.half_widths[0] > 1.1 * plain.half_widths[0]
    assert "the shortest waves hold" in plain.reason
    assert "finer by 1.5" in plain.reason


def test_what_needs_too_many_cells_is_refused(monkeypatch):
    monkeypatch.setattr(fourier_grid, "MOST_CELLS", 200_000)
    with pytest.raises(ValueError, match=r"`initial` must be smooth for Fourier"):
        fp.suggest_fourier_grid(MODEL, lambda one: narrow(one, 0.05), 0.25, 1e-6)


@pytest.mark.parametrize("s_end", [0.0, -1.0, np.nan, np.inf])
def test_a_length_of_the_run_that_is_none_is_refused(s_end):
    with pytest.raises(ValueError, match="`s_end` must be"):
        fp.suggest_fourier_grid(MODEL, narrow, s_end)


def test_a_potential_that_does_not_confine_has_no_box():
    free = fp.LayDownModel(fp.FreePotential(), 1.0)
    with pytest.raises(ValueError, match="`potential` must confine"):
        fp.suggest_fourier_grid(free, narrow, 1.0)


def test_suggest_grid_tries_the_start_that_a_law_or_nothing_says(monkeypatch):
    tried = []
    monkeypatch.setattr(
        suggested_grid,
        "suggest_fourier_grid",
        lambda model, start, s_end, tolerance: tried.append((start, s_end, tolerance)),
    )
    potential, law = MODEL.potential, fp.paths.GaussianLaw((0.5, 0.0), 0.5, 0.3, 1.0)
    for initial in (law, narrow, None, fp.paths.EquilibriumLaw(potential)):
        fp.suggest_grid(MODEL, 1e-4, initial=initial, s_end=0.25, translation="fourier")
    grid = fp.PhaseSpaceGrid(4.0, (12, 12, 8))
    rest = fp.initial.equilibrium(grid, potential)
    expected = (narrow(grid), narrow(grid), rest, rest)
    for (start, s_end, tolerance), p in zip(tried, expected, strict=True):
        assert (s_end, tolerance) == (0.25, 1e-4)
        np.testing.assert_array_equal(start(grid), p)


def test_a_grid_for_fourier_translations_needs_a_length_and_a_start():
    def suggested(**arguments):
        return fp.suggest_grid(MODEL, 1e-2, **arguments)

    with pytest.raises(ValueError, match="`s_end` must be given for Fourier"):
        suggested(translation="fourier")
    with pytest.raises(TypeError, match="`initial` must be a GaussianLaw, an Equi"):
        suggested(translation="fourier", initial=0.5, s_end=1.0)
    with pytest.raises(ValueError, match=r'`translation` must be "lagrange" or "four'):
        suggested(translation="spline")
    smooth = fp.SmoothLayDownModel(MODEL.potential, 0.5, 1.0)
    with pytest.raises(TypeError, match="`model` must be"):
        fp.suggest_grid(smooth, 1e-2, s_end=1.0, translation="fourier")
