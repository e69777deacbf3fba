"""The phase space with a curvature, and densities on it."""

import numpy as np
import pytest

from fpsolve import initial
from fpsolve.errors import GridMismatchError
from fpsolve.grids import diagnostics
from fpsolve.grids.dictionaries import grid_from_dict
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.smooth import SmoothPhaseSpaceGrid

GRID = SmoothPhaseSpaceGrid((4.0, 5.0), 6.0, (8, 10, 12, 24))


def started(grid=GRID, variance=1.3):
    p = initial.gaussian(grid.phase_space, (0.4, -0.3), 0.9, 0.5, 1.0)
    return initial.with_curvature(p, grid, variance)


def test_cells_are_those_of_the_phase_space_and_centred_in_kappa():
    basic = PhaseSpaceGrid((4.0, 5.0), (8, 10, 12))
    assert GRID.phase_space == basic
    for axis in ("xi1", "xi2", "alpha"):
        assert np.array_equal(getattr(GRID, axis), getattr(basic, axis))
    assert GRID.spacing == (*basic.spacing, 0.5)
    assert GRID.kappa[[0, -1]].tolist() == [-5.75, 5.75]
    mesh = np.broadcast_arrays(*GRID.mesh())
    for axis, name in enumerate(GRID.axes):
        assert mesh[0].shape == GRID.shape
        line = np.moveaxis(mesh[axis], axis, 0)[:, 0, 0, 0]
        assert np.array_equal(line, getattr(GRID, name))


def test_a_grid_is_read_back_with_its_curvature_and_a_basic_one_without():
    for grid in (GRID, GRID.phase_space):
        assert grid_from_dict(grid.to_dict()) == grid
    wider = SmoothPhaseSpaceGrid((4.0, 5.0), 7.0, (8, 10, 12, 24))
    assert wider != GRID


def test_a_start_has_the_mass_and_the_moments_of_its_parts():
    p, basic = started(), initial.gaussian(GRID.phase_space, (0.4, -0.3), 0.9, 0.5, 1.0)
    assert diagnostics.mass(p, GRID) == pytest.approx(1.0, abs=1e-14)
    found = diagnostics.moments(p, GRID)
    for name, value in diagnostics.moments(basic, GRID.phase_space).items():
        assert found[name] == pytest.approx(value, abs=1e-14)
    # Sums over cells of less than half a deviation: e^{−2π²·5} of aliasing, and
    # e^{−6²/2.6} beyond the ends, where κ²p is 36 times that.
    assert found["mean_kappa"] == pytest.approx(0.0, abs=1e-14)
    assert found["mean_kappa2"] == pytest.approx(1.3, abs=3e-5)


@pytest.mark.parametrize("which", ["xi", "alpha", "xi1", "xi2", "kappa", "xi_alpha"])
def test_marginals_are_densities_of_what_is_left(which):
    p = started()
    kept = {"xi": "xi1 xi2", "xi_alpha": "xi1 xi2 alpha"}.get(which, which).split()
    found = diagnostics.marginal(p, GRID, which)
    assert found.shape == tuple(getattr(GRID, name).size for name in kept)
    widths = dict(zip(GRID.axes, GRID.spacing, strict=True))
    volume = np.prod([widths[name] for name in kept])
    assert found.sum() * volume == pytest.approx(1.0, abs=1e-13)


def test_entropy_relative_to_itself_is_zero_and_dissipation_is_that_of_kappa():
    p, wider = started(variance=1.0), started(variance=1.5)
    assert diagnostics.relative_entropy(p, GRID, p) == pytest.approx(0.0, abs=1e-14)
    # Of two Gaussians ½(σ²/s² − 1 − ln(σ²/s²)), and (K²/2) E (κ/σ² − κ/s²)².
    ratio = 1.0 / 1.5
    entropy = 0.5 * (ratio - 1 - np.log(ratio))
    found = diagnostics.relative_entropy(p, GRID, wider)
    assert found == pytest.approx(entropy, abs=1e-6)
    dissipation = diagnostics.entropy_dissipation(p, GRID, 2.0, wider)
    # Differences of order eight on half a deviation leave 5e-5 of it.
    assert dissipation == pytest.approx(2.0 * (1 - ratio) ** 2, rel=1e-3)
    with pytest.raises(ValueError, match="`reference` must be given on a grid with a"):
        diagnostics.entropy_dissipation(p, GRID, 2.0)


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        ((4.0, -1.0, (8, 8, 8, 8)), ValueError, "`kappa_half_width` must be positive"),
        ((4.0, 1e200, (8, 8, 8, 8)), ValueError, "between 1e-100 and 1e.100, got 1e"),
        ((4.0, np.nan, (8, 8, 8, 8)), ValueError, "`kappa_half_width` must be"),
        ((4.0, 2.0, (8, 8, 8)), ValueError, "`shape` must be four integers"),
        ((4.0, 2.0, (8, 8, 8, 3)), ValueError, r"`shape\[3\] \(n_kappa\)` must be"),
    ],
)
def test_a_grid_without_sense_is_refused(arguments, error, words):
    with pytest.raises(error, match=words):
        SmoothPhaseSpaceGrid(*arguments)


def test_a_density_without_curvature_is_told_how_to_get_one():
    p = initial.gaussian(GRID.phase_space, (0.0, 0.0), 1.0)
    with pytest.raises(ValueError, match=r"initial\.with_curvature\(p, grid"):
        GRID.check(p, "p0")
    with pytest.raises(GridMismatchError):
        GRID.check(np.ones((8, 10, 12, 23)))


def test_a_curvature_that_the_cells_cannot_hold_is_told_or_refused():
    p = initial.gaussian(GRID.phase_space, (0.0, 0.0), 1.0)
    with pytest.raises(
        ValueError, match="`variance` must be positive and finite, got 0"
    ):
        initial.with_curvature(p, GRID, 0.0)
    with pytest.warns(UserWarning, match="before normalisation"):
        initial.with_curvature(p, GRID, 25.0)
    with (
        pytest.warns(UserWarning, match="before normalisation"),
        pytest.raises(ValueError, match="`variance` must leave mass"),
    ):
        initial.with_curvature(p, GRID, 1e-6)
    with pytest.raises(TypeError, match="SmoothPhaseSpaceGrid"):
        initial.with_curvature(p, GRID.phase_space, 1.0)
