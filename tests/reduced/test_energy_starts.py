"""Starts, records and files of a run of (16), and the arguments it refuses."""

import math

import numpy as np
import pytest
import xarray
from energy_processes import NOISE, PROCESSES, exact_masses, tilted

EPS = np.finfo(float).eps
QUADRATIC = PROCESSES["quadratic"]
GRIDS = {"|G|": QUADRATIC.grid(24), "signed": QUADRATIC.grid(24, signed=True)}


def test_all_mass_at_an_energy_keeps_the_mean():
    grid = GRIDS["signed"]
    for energy in (-0.55, -1e-3, 0.0, 0.2, 0.6):
        mass = QUADRATIC.solve(energy, (0.0, 1.0), 1.0, grid=grid, save_at=(0.0,)).mass(
            0.0
        )
        assert mass.sum() == pytest.approx(1.0, abs=4 * EPS)
        inside = grid.centres[0] <= energy <= grid.centres[-1]
        if inside:
            assert mass @ grid.centres == pytest.approx(energy, abs=1e-15)
        assert np.count_nonzero(mass) <= 2


def test_a_density_is_normalised_and_integrated_cell_by_cell():
    grid = GRIDS["|G|"]
    run = QUADRATIC.solve(lambda g: 7.0 * g, (0.0, 1.0), 1.0, grid=grid, save_at=(0.0,))
    exact = np.diff(grid.faces**2) / grid.faces[-1] ** 2
    np.testing.assert_allclose(run.mass(0.0), exact, rtol=1e-13)
    np.testing.assert_allclose(run.density(0.0), exact / grid.widths, rtol=1e-13)
    assert run.distribution(0.0)[-1] == pytest.approx(1.0, abs=4 * EPS)
    assert run.distribution(0.0)[12] == pytest.approx(
        (grid.faces[12] / grid.faces[-1]) ** 2, rel=1e-13
    )


def test_histograms_fold_the_sign_only_where_the_grid_does():
    g = [-0.5, -0.1, 0.1, 0.1, 0.6]
    counts = [grid.histogram(g) for grid in GRIDS.values()]
    for count in counts:
        assert count.sum() == pytest.approx(1.0, abs=EPS)
    signed = GRIDS["signed"]
    cell = np.searchsorted(signed.faces, 0.1) - 1
    assert counts[1][cell] == pytest.approx(0.4, abs=EPS)
    unsigned = GRIDS["|G|"]
    cell = np.searchsorted(unsigned.faces, 0.1) - 1
    assert counts[0][cell] == pytest.approx(0.6, abs=EPS)
    with pytest.raises(ValueError, match=r"`g` must lie in \[-0\.606"):
        unsigned.histogram([1.0])


def test_extrapolation_estimates_its_error_and_records_what_was_asked():
    grid = GRIDS["signed"]
    seen = []
    run = QUADRATIC.solve(
        tilted(), (0.0, 1.0), 0.125, grid=grid, extrapolate=True, record_every=4,
        save_at=(0.0, 0.5, 1.0), progress=lambda *where: seen.append(where),
    )  # fmt: skip
    assert run.s.tolist() == [0.0, 0.5, 1.0]
    assert run.saved_s.tolist() == [0.0, 0.5, 1.0]
    assert set(run.errors) == {"relative_entropy", "entropy_dissipation", "saved_l1"}
    assert seen[-1][:2] == (24, 24)
    difference = np.abs(run.mass(1.0) - exact_masses(grid, 1.0)).sum()
    assert difference <= run.errors["saved_l1"][-1]
    assert "backward_euler, ds = 0.125, s = 1" in repr(run)
    assert repr(grid) == "EnergyGrid(24 cells on [-0.606531, 0.606531])"


def test_the_dataset_tells_everything(tmp_path):
    grid = GRIDS["signed"]
    run = QUADRATIC.solve(0.2, (0.0, 1.0), 0.25, grid=grid, save_at=(0.5, 1.0),
                          extrapolate=True)  # fmt: skip
    path = tmp_path / "law.nc"
    run.to_xarray().to_netcdf(path, engine="h5netcdf")
    with xarray.open_dataset(path) as found:
        assert found["density"].dims == ("s", "g")
        np.testing.assert_array_equal(found["density"], run.densities)
        np.testing.assert_array_equal(found["face"], grid.faces)
        np.testing.assert_array_equal(found["relative_entropy"], run.relative_entropy)
        assert found["saved_l1_error"].dims == ("s",)
        assert found.attrs["potential"].startswith('{"kind": "quadratic"')
        assert found.attrs["noise"] == NOISE
        assert found.attrs["method"] == "backward_euler"
        assert found.attrs["ds"] == 0.25
        assert "numpy" in found.attrs["provenance"]
        assert all(found[name].attrs["units"] == "1" for name in found.variables)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"grid": 24}, TypeError, "`grid` must be an EnergyGrid, got 24; make one"),
        (
            {"grid": PROCESSES["linear"].grid(24)},
            ValueError,
            "`grid` must be one of this process, got one for LinearPotential",
        ),
        ({"start": np.ones(5)}, ValueError, r"one mass for each of 24 cells, got .*5"),
        ({"start": 0.7}, ValueError, r"`start` must lie in \[0, 0\.606"),
        ({"start": math.nan}, ValueError, r"`start` must lie in \[0, .*got nan"),
        ({"start": np.full(24, -1.0)}, ValueError, "`start` must be non-negative and"),
        ({"start": np.zeros(24)}, ValueError, "positive mass, got a minimum of 0"),
        ({"start": lambda g: g * math.nan}, ValueError, "got a minimum of nan"),
        ({"ds": 0.3}, ValueError, "`ds` must divide the span"),
        ({"method": "euler"}, ValueError, "`method` must be one of 'backward_euler'"),
    ],
)
def test_wrong_arguments_are_named(arguments, error, message):
    given_ones = {"start": 0.2, "s_span": (0.0, 1.0), "ds": 0.1, "grid": GRIDS["|G|"]}
    with pytest.raises(error, match=message):
        QUADRATIC.solve(**(given_ones | arguments))


def test_densities_are_kept_where_asked_only():
    run = QUADRATIC.solve(0.2, (0.0, 1.0), 0.5, grid=GRIDS["|G|"])
    with pytest.raises(
        ValueError, match=r"`s` must be one of the saved values 1, got 0\.5"
    ):
        run.density(0.5)


@pytest.mark.parametrize(
    ("n_cells", "signed", "error", "message"),
    [
        (3, False, ValueError, "`n_cells` must be at least 4, got 3"),
        (
            5001,
            False,
            ValueError,
            "`n_cells` must be at most 4000, got 5001: more cells",
        ),
        (9, True, ValueError, "`n_cells` must be even on a signed grid, got 9: zero"),
        (8.0, False, TypeError, "`n_cells` must be an integer"),
    ],
)
def test_grids_that_do_not_fit_are_refused(n_cells, signed, error, message):
    with pytest.raises(error, match=message):
        QUADRATIC.grid(n_cells, signed)
