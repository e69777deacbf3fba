"""`fpsolve energy` prints, writes and draws the small-noise limit, or says why not."""

import numpy as np
import pytest
import xarray as xr
from command_line import assert_mistake, files
from matplotlib.image import imread

from fpsolve.model.potentials import QuadraticPotential
from fpsolve.reduced.energy import EnergyProcess

PROCESS = EnergyProcess(QuadraticPotential(), 0.3)


@pytest.fixture
def call(fpsolve):
    return lambda *words: fpsolve("energy", *words)


def test_tables_rates_and_figures_are_printed_written_and_drawn(call, tmp_path):
    result = call("--noise", 0.3, "--energies", 4, "--count", 3, "--passage", 0.1, 0.5,
                  "--out", "out")  # fmt: skip
    assert result.exit_code == 0, result.output
    assert "B = (ξ₁² + ξ₂²)/2, A = 0.3: circle r = 1, g_max = 0.606531" in result.stdout
    for column in ("g", "r_min", "r_max", "period S", "σ²(g)", "density S/∫S"):
        assert column in result.stdout
    assert "0 exactly" in result.stdout
    assert "0.1233578813 ±" in result.stdout
    assert "0.045 ±" in result.stdout
    mean = float(PROCESS.passage(0.5).mean(0.1))
    assert f"|G| from 0.1 to 0.5: expected length {mean:.6g}" in result.stdout
    names = ["energy-coefficients.png", "energy-eigenfunctions.png",
             "energy-orbits.png", "energy.nc"]  # fmt: skip
    assert files(tmp_path / "out") == names
    for name in names:
        assert f"out/{name}" in result.stdout
    for name in names[:-1]:
        assert imread(tmp_path / "out" / name).shape[1] == 1400
    check_tables(tmp_path / "out" / "energy.nc")


def check_tables(path):
    with xr.open_dataset(path) as tables:
        g = tables["g"].to_numpy()
        np.testing.assert_allclose(g, PROCESS.g_max * np.array([0.25, 0.5, 0.75, 1.0]))
        for name, function in (
            ("period", PROCESS.period),
            ("action", PROCESS.action),
            ("variance", PROCESS.variance),
            ("drift", PROCESS.drift),
            ("stationary_density", PROCESS.stationary_density),
        ):
            np.testing.assert_array_equal(tables[name], function(g))
        np.testing.assert_array_equal(tables["r_max"], PROCESS.turning_points(g)[1])
        for family in ("even", "odd"):
            found = tables.sel(family=family)["eigenvalue"]
            np.testing.assert_allclose(
                found, PROCESS.eigenvalues(3, family), rtol=1e-11
            )
        assert tables.attrs["noise"] == 0.3
        assert tables.attrs["potential"].startswith('{"kind": "quadratic"')
        assert tables.attrs["g_max"] == PROCESS.g_max
        assert "numpy" in tables.attrs["versions"]
        assert all(tables[name].attrs["units"] == "1" for name in tables.data_vars)


def test_without_figures_only_numbers_are_left(call, tmp_path):
    result = call("--potential", "power", "--exponent", 3, "--no-figures",
                  "--passage", 0.1, 0.7165313105737893, "--out", "out")  # fmt: skip
    assert result.exit_code == 0, result.output
    assert "expected length infinite, the circle is never reached" in result.stdout
    assert files(tmp_path / "out") == ["energy.nc"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--sigma2", 2), "`potential` must be isotropic for an energy process"),
        (("--potential", "free"), "exactly one radius, got FreePotential() with none"),
        (("--potential", "cubic"), "`--potential` must be one of quadratic, linear"),
        (("--noise", 0), "`noise` must be positive and finite, got 0"),
        (("--noise", "nan"), "`noise` must be positive and finite, got nan"),
        (("--passage", 0.1, 0.9), "`target` must lie in [0, 0.606530659713]"),
        (("--passage", 0.9, 0.1), "`g` must lie in [0, 0.606530659713]"),
    ],
)
def test_mistakes_cost_one_line_and_no_file(call, tmp_path, words, message):
    assert_mistake(call(*words, "--out", "out"), message)
    assert not (tmp_path / "out").exists()


def test_help_shows_an_example_that_works(call):
    result = call("--help")
    assert result.exit_code == 0
    for word in ("--passage", "--energies", "--count", "--noise", "--no-figures"):
        assert word in result.stdout
    example = result.stdout.split("Example: fpsolve energy ")[1].split()
    assert call(*example, "--no-figures").exit_code == 0
