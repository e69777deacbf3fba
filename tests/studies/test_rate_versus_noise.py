"""Runs, spectra and variances of one study agree; failures stay where they are."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure

from fpsolve.density.schemes import drift_kick
from fpsolve.density.solve import solve
from fpsolve.errors import RunInterrupted, ToleranceError
from fpsolve.grids.initial import from_function
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    FreePotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)
from fpsolve.paths import EquilibriumLaw
from fpsolve.plotting.rates import (
    plot_asymptotic_variance,
    plot_inverse_decay_rate,
    plot_rates,
)
from fpsolve.plotting.spectrum import plot_spectrum
from fpsolve.spectral.bases.sectors import Truncation
from fpsolve.spectral.eigen.spectrum import spectrum
from fpsolve.studies.observables import default_observables
from fpsolve.studies.rates.cases import PARTS
from fpsolve.studies.rates.modes import CLASSES, slowest_modes
from fpsolve.studies.rates.poisson import (
    AsymptoticVariances,
    asymptotic_variances,
)
from fpsolve.studies.rates.rate_versus_noise import rate_versus_noise
from fpsolve.studies.rates.relaxation import _slowest
from fpsolve.studies.rates.relaxation_plan import plan_relaxation

QUADRATIC = QuadraticPotential()
NOISES = (1.6, 2.0)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A quick study in this process, kept in a folder."""
    folder = tmp_path_factory.mktemp("store")
    return rate_versus_noise(
        QUADRATIC, NOISES, quick=True, workers=0, directory=folder
    ), folder


def test_the_decay_rate_of_entropy_is_twice_the_gap_within_its_error(study):
    dataset, _ = study
    difference = np.abs(dataset["entropy_rate"] - 2 * dataset["gap"])
    assert np.all(difference < dataset["entropy_rate_error"] + 2 * dataset["gap_error"])
    # An error that says something: below one per cent even of quick runs.
    assert np.all(dataset["entropy_rate_error"] < 0.01 * dataset["entropy_rate"])
    # At the end of a run H is half the square of the norm, to which modes refer.
    np.testing.assert_allclose(dataset["quadratic_share"], 1.0, atol=0.02)


def test_the_integral_of_the_entropy_is_that_of_the_spectral_solver(study):
    dataset, _ = study
    difference = dataset["inverse_decay_rate"] - dataset["spectral_inverse_decay_rate"]
    error = dataset["inverse_decay_rate_error"]
    error = error + dataset["spectral_inverse_decay_rate_error"]
    assert np.all(np.abs(difference) < error)
    assert np.all(error < 0.02 * dataset["inverse_decay_rate"])
    assert np.all(dataset["tail_bound"] < 0.01 * dataset["inverse_decay_rate"])


def test_a_run_that_resolves_no_mode_gives_a_slope_that_covers_and_says_so():
    found = rate_versus_noise(
        QUADRATIC, [1.0], quick=True, parts=["relaxation", "gap"], s_end=5.0, workers=0
    ).isel(noise=0)
    assert found["slowest_class"].item() == "not resolved"
    off = abs(found["entropy_rate"] - 2 * found["gap"])
    assert off <= 2 * found["entropy_rate_error"]
    assert found["entropy_rate"] == found["entropy_rate_line"]
    message = found["message"].sel(part="relaxation").item()
    assert "no slowest mode stands out in a run to s = 5: the rate of H is" in message
    assert "`s_end=10` would resolve it if modes are apart, and the part" in message


def test_runs_see_the_slowest_branch_of_every_symmetry(study):
    dataset, _ = study
    branches = dataset["branch_rate"].isel(mode=0)
    for symmetry, sectors in (
        ("M = 0", ["M = 0 even", "M = 0 odd"]), ("M = ±1", ["M = ±1"]),
    ):  # fmt: skip
        expected = branches.sel(sector=sectors).min("sector")
        found = dataset["run_rate"].sel(symmetry=symmetry)
        error = dataset["run_rate_error"].sel(symmetry=symmetry)
        assert np.all(np.abs(found - expected) < error)


def test_the_gap_is_the_least_branch_and_bounds_lie_below(study):
    dataset, _ = study
    least = dataset["branch_rate"].min(("sector", "mode"))
    # Branches have the tolerance 1e-2 of a quick study, and are better.
    np.testing.assert_allclose(dataset["gap"], least, rtol=1e-3)
    for bound in ("hypocoercive_bound", "averaging_bound"):
        assert np.all(dataset[bound] < dataset["gap"])
    # Every eigenvalue of an isotropic potential: M = 0 odd has A²/2.
    odd = dataset["branch_rate"].sel(sector="M = 0 odd", mode=0)
    np.testing.assert_allclose(odd, dataset["small_noise_asymptote"], rtol=1e-5)


def test_a_dataset_says_what_repeats_it_and_survives_a_file(study, tmp_path):
    dataset, _ = study
    assert dataset.attrs["formula"] == "(ξ₁² + ξ₂²)/2"
    assert json.loads(dataset.attrs["potential"])["kind"] == "quadratic"
    assert json.loads(dataset.attrs["p0"])["mean"] == [1.5, 0.0]
    assert json.loads(dataset.attrs["settings"])["e_folds"] == 9
    assert "fpsolve" in json.loads(dataset.attrs["versions"])
    assert np.all(dataset["status"] == "finished")
    assert all("long_name" in dataset[name].attrs for name in ("gap", "entropy_rate"))
    dataset.to_netcdf(tmp_path / "study.nc", engine="h5netcdf")


def test_a_study_is_read_back_from_its_folder(study):
    dataset, folder = study
    told = []
    again = rate_versus_noise(
        QUADRATIC, NOISES, quick=True, workers=0, directory=folder,
        progress=lambda *what: told.append(what),
    )  # fmt: skip
    assert told == []
    assert again.identical(dataset)


def test_figures_are_drawn(study):
    dataset, _ = study
    cheap = rate_versus_noise(
        QUADRATIC, (1.2, 1.4), parts=("gap",), workers=0, quick=True
    )
    for figure in (
        plot_inverse_decay_rate([dataset, dataset]), plot_rates(dataset),
        plot_rates(cheap, runs=dataset), plot_asymptotic_variance(dataset),
        plot_spectrum(spectrum(LayDownModel(QUADRATIC, 1.0), 3, tolerance=1e-3)),
        plot_spectrum(spectrum(LayDownModel(QUADRATIC, 4.0), 3, tolerance=1e-3)),
    ):  # fmt: skip
        assert isinstance(figure, Figure)
        figure.canvas.draw()
    with pytest.raises(ValueError, match='`dataset` must hold "asymptotic_variance"'):
        plot_asymptotic_variance(cheap)


def test_a_spectrum_becomes_a_dataset():
    found = spectrum(LayDownModel(QUADRATIC, 1.0), 3, tolerance=1e-3)
    dataset = found.to_xarray()
    np.testing.assert_array_equal(dataset["real"], found.eigenvalues.real)
    assert dataset["sector"].values[0] == "M = ±1"
    assert dataset.attrs["gap"] == found.gap


def test_modes_of_a_run_are_eigenvalues_of_its_propagator():
    # A superposition of the exact mode A²/2 and a start far from equilibrium: of every
    # class the slowest mode, whatever its share.
    model = LayDownModel(QUADRATIC, 0.5)
    grid = PhaseSpaceGrid(5.5, (40, 40, 24))
    p0 = from_function(
        grid, lambda x, y, a: np.exp(-((x - 1) ** 2) - y**2) * (1.5 + np.cos(a - 1))
    )
    spacing = 2.0
    solution = solve(
        drift_kick(model, grid, balanced=True), p0, (0.0, 60.0), 0.2,
        save_at=np.arange(0.0, 61.0, spacing), record_every=400,
    )  # fmt: skip
    modes = slowest_modes(solution.densities, spacing, model, grid)
    assert tuple(modes) == CLASSES
    # ds² of the splitting.
    assert modes["M = 0"].rate == pytest.approx(0.125, rel=1e-3)
    assert modes["M = 0"].error < 1e-5
    assert modes["M = ±1"].rate == pytest.approx(0.16968930, rel=5e-3)


@pytest.mark.parametrize("noise", [0.8, 3.0])
def test_asymptotic_variances_have_their_exact_values(noise):
    found = asymptotic_variances(
        LayDownModel(QUADRATIC, noise), default_observables(QUADRATIC), tolerance=1e-5
    )
    names = list(default_observables(QUADRATIC))
    values = dict(zip(names, found.values, strict=True))
    # G is an eigenfunction of −A²/2: v = 2 Var G/(A²/2), Var G = 1/9.
    assert values["circulation"] == pytest.approx(4 / noise**2 / 9, rel=1e-5)
    # cos α = dξ₁/ds along a path.
    assert abs(values["direction"]) < 1e-12
    np.testing.assert_allclose(found.deviations[:2], [1.0, 2.0], rtol=1e-9)
    assert np.all(found.errors <= 1e-5 * found.values + 1e-12)


def test_quarter_turned_and_stretched_bases_give_the_same_variance():
    # The same potential in the tensor basis, which knows no angular index.
    functions = {
        name: f for name, f in default_observables(QUADRATIC).items() if name != "core"
    }
    round_one = asymptotic_variances(LayDownModel(QUADRATIC, 2.0), functions)
    nearly = LayDownModel(QuadraticPotential(1.0, 1 + 1e-9), 2.0)
    found = asymptotic_variances(nearly, functions, tolerance=1e-4)
    np.testing.assert_allclose(found.values, round_one.values, rtol=1e-3, atol=1e-9)


def test_at_large_noise_variances_are_those_of_the_diffusion():
    # ξ₁ of the hydrodynamic limit is Ornstein-Uhlenbeck with rate 1/A²: v = 2 A².
    found = asymptotic_variances(
        LayDownModel(QUADRATIC, 12.0), {"position": lambda xi1, xi2, alpha: xi1}
    )
    # The next order is A⁻⁴.
    assert found.values[0] == pytest.approx(2 * 144, rel=1e-3)


def test_variances_that_no_basis_resolves_are_refused():
    def position(xi1, xi2, alpha):
        return xi1

    model = LayDownModel(QUADRATIC, 1e-9)
    with pytest.raises(
        ToleranceError, match=r"at noise 1e-09 no basis that fits resolves .* of x:"
    ):
        asymptotic_variances(model, {"x": position}, tolerance=1e-2)


def test_of_variances_a_study_keeps_those_that_are_known():
    found = AsymptoticVariances(
        np.array([2.0, 2.0, 0.0]),
        np.array([0.1, 1.5, 1e-14]),
        np.ones(3),
        Truncation(16, 8),
    )
    np.testing.assert_array_equal(found.known_only().values, [2.0, np.nan, 0.0])


def test_a_case_that_fails_leaves_a_message_and_the_others(monkeypatch):
    def unreachable(potential, noise, tolerance):
        if noise > 1:
            raise ToleranceError(3e-5, tolerance)
        return {"gap": 1.0, "gap_error": 0.0, "gap_frequency": 0.0, "gap_sector": "x"}

    monkeypatch.setitem(PARTS, "gap", unreachable)
    dataset = rate_versus_noise(LinearPotential(), (0.8, 2.0), parts=["gap"], workers=0)
    assert dataset["status"].sel(part="gap").values.tolist() == ["finished", "failed"]
    message = dataset["message"].sel(part="gap").values[1]
    assert message.startswith("ToleranceError: tolerance 1e-08 not reached: the error")
    assert np.isnan(dataset["gap"].values).tolist() == [False, True]


def test_ctrl_c_leaves_a_dataset(monkeypatch):
    def interrupted(potential, noise, tolerance):
        raise KeyboardInterrupt

    monkeypatch.setitem(PARTS, "gap", interrupted)
    with pytest.raises(RunInterrupted) as caught:
        rate_versus_noise(
            QUADRATIC, [1.0], parts=["gap", "branches"], workers=0, quick=True
        )
    dataset = caught.value.solution
    assert dataset["status"].values.tolist() == [["finished", "pending"]]
    assert np.isfinite(dataset["branch_rate"].values[0, 0, 0])


def test_the_length_of_a_run_follows_the_asymptotes():
    for noise in (0.2, 1.0, 5.0):
        plan = plan_relaxation(LayDownModel(QUADRATIC, noise), 1e-1, 9.0)
        rate = 9.0 / (2 * plan.s_end)
        assert rate == pytest.approx(1 / (2 / noise**2 + noise**2), rel=1e-9)
        assert plan.ds * noise**2 <= 0.8
    plan = plan_relaxation(LayDownModel(QUADRATIC, 1.0), 1e-1, 9.0, s_end=8.0)
    assert plan.s_end == pytest.approx(8.0)


def test_bad_input_is_refused_before_anything_runs():
    with pytest.raises(
        ValueError, match=r"`potential` must confine, got FreePotential"
    ):
        rate_versus_noise(FreePotential(), [1.0])
    with pytest.raises(
        ValueError, match="`noises` must be positive and finite, got 0; w"
    ):
        rate_versus_noise(QUADRATIC, [1.0, 0.0])
    with pytest.raises(
        ValueError, match="`noises` must hold at least one noise, got no"
    ):
        rate_versus_noise(QUADRATIC, [])
    with pytest.raises(TypeError, match="`potential` must be a Potential, got 3"):
        rate_versus_noise(3, [1.0])
    with pytest.raises(TypeError, match=r"`p0` must be a GaussianLaw, got Equilibrium"):
        rate_versus_noise(QUADRATIC, [1.0], p0=EquilibriumLaw(QUADRATIC))
    with pytest.raises(
        ValueError, match="`parts` must be among relaxation, branches, g"
    ):
        rate_versus_noise(PowerPotential(4.0), [1.0], parts=["evolution"])
    with pytest.raises(ValueError, match=r"`tolerance` must lie in .*, got"):
        rate_versus_noise(QUADRATIC, [1.0], tolerance=-1.0)
    moving = LayDownModel(QUADRATIC, 1.0, MovingBelt(0.1))
    with pytest.raises(
        ValueError, match="`model` must have a fixed belt for asymptotic"
    ):
        asymptotic_variances(moving, default_observables(QUADRATIC))


def test_a_class_that_is_not_resolved_hides_the_rate_of_the_others():
    rates, errors = np.array([0.3, np.nan, 0.2]), np.array([0.01, np.nan, 0.01])
    assert _slowest(rates, errors, np.array([0.3, 0.25, 0.2])) is None
    assert _slowest(rates, errors, np.array([0.3, 0.40, 0.2])) == 2
    assert _slowest(rates, errors, np.array([0.3, np.inf, 0.2])) == 2
    assert _slowest(np.full(3, np.nan), errors, np.full(3, np.inf)) is None
