"""With little noise the law of G by the full equation tends to the averaged one."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy import stats

from fpsolve import initial, studies
from fpsolve.errors import MemoryLimitError, RunInterrupted
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.potentials import FreePotential, LinearPotential, QuadraticPotential
from fpsolve.paths import GaussianLaw, PointLaw
from fpsolve.plotting.small_noise import plot_small_noise, plot_small_noise_spectrum
from fpsolve.reduced.energy import EnergyProcess
from fpsolve.studies.limits import energy_sectors as spectrum_module
from fpsolve.studies.limits.energy_law import (
    N_FUNCTIONS,
    SmoothedLaw,
    density_of,
    energy_masses,
)
from fpsolve.studies.limits.energy_sectors import small_noise_spectrum
from fpsolve.studies.limits.small_noise import small_noise_limit
from fpsolve.studies.limits.small_noise_case import half_width_for

QUADRATIC = QuadraticPotential()
PROCESS = EnergyProcess(QUADRATIC, 1.0)
LAW = GaussianLaw((1.0, 0.0), 0.3, np.pi / 4, 2.0)
NOISES = (0.2, 0.3)
SCALES = (0.0, 0.3)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A quick study in this process, kept in a folder."""
    folder = tmp_path_factory.mktemp("store")
    found = small_noise_limit(
        QUADRATIC, NOISES, belt_speed_scales=SCALES, quick=True, n_paths=20_000,
        workers=0, directory=folder,
    )  # fmt: skip
    return found, folder


@pytest.fixture(scope="module")
def spectra():
    return small_noise_spectrum(QUADRATIC, (0.4, 0.5))


# -- the study ------------------------------------------------------------------------


def test_the_distance_falls_like_the_square_of_the_noise_or_faster(study):
    found, _ = study
    assert (found.status == "finished").all()
    assert found.attrs["expected_order"] == 1.0
    # Order 1 in A² is the asymptote; the fast modes that are left at A = 0.3 make the
    # distance there larger, never smaller.
    orders = found.observed_order.values
    assert np.isnan(orders[:, 0]).all()
    assert (orders[:, 1] > 0.9).all()
    # Not much below what was measured at full accuracy at A = 0.2 (0.0017 and 0.0047,
    # see docs/limits.md), and not above.
    np.testing.assert_allclose(found.distance.values[:, 1], [0.0017, 0.0047], rtol=0.1)


def test_the_error_of_the_cells_is_below_the_distance(study):
    found, _ = study
    assert (found.distance_error < found.distance).all()


def test_the_mean_of_g_decays_exactly_on_a_belt_at_rest_only(study):
    found, _ = study
    still, moving = found.isel(belt_speed_scale=0), found.isel(belt_speed_scale=1)
    # The grid's own error; statement 1 of the exact laws holds for every noise.
    np.testing.assert_allclose(still["mean"], still.exact_mean, rtol=2e-4)
    assert (np.abs(moving["mean"] / moving.exact_mean - 1) > 1e-3).all()


def test_the_averaged_law_does_not_know_noise_nor_belt(study):
    # At fixed A² s, up to rounding of the steps.
    laws = study[0].averaged_law.values.reshape(-1, N_FUNCTIONS)
    np.testing.assert_allclose(laws, np.broadcast_to(laws[0], laws.shape), atol=1e-12)


def test_paths_agree_with_the_grid_and_stay_near_what_chance_allows(study):
    found, _ = study
    # 48 comparisons: P(|z| > 4.5) = 7e-6 each; the grid adds less than half a
    # standard error at 20 000 paths.
    assert (found.paths_z < 4.5).all()
    # The distance by paths exceeds that by the grid by no more than their noise, whose
    # spread is about a third of its mean.
    surplus = found.paths_distance - found.distance
    assert (surplus < 2.5 * found.paths_distance_by_chance).all()


def test_a_study_goes_on_from_its_folder(study):
    found, folder = study
    again = small_noise_limit(
        QUADRATIC, NOISES, belt_speed_scales=SCALES, quick=True, n_paths=20_000,
        workers=0, directory=folder,
    )  # fmt: skip
    np.testing.assert_array_equal(again.distance, found.distance)
    np.testing.assert_array_equal(again.seconds, found.seconds)


def test_the_attributes_repeat_the_study(study):
    options = json.loads(study[0].attrs["options"])
    assert options["slow_length"] == 1.0
    assert options["law"]["kind"] == "gaussian"
    assert options["n_paths"] == 20_000


def test_an_interrupted_study_keeps_what_was_finished(tmp_path):
    def stop(n_done, n_total, case):
        raise KeyboardInterrupt

    with pytest.raises(RunInterrupted) as caught:
        small_noise_limit(
            QUADRATIC, (0.5, 0.4), belt_speed_scales=(0.0,), quick=True, n_paths=0,
            workers=0, directory=tmp_path, progress=stop,
        )  # fmt: skip
    partial = caught.value.solution
    assert list(partial.status.values.ravel()) == ["finished", "pending"]
    assert np.isfinite(partial.distance.values[0, 0])
    assert np.isnan(partial.distance.values[0, 1])
    # Without paths there is nothing to compare them with.
    assert np.isnan(partial.paths_distance).all()


# -- laws of G ------------------------------------------------------------------------


def test_the_functions_add_up_to_one_and_are_exact_for_all_descriptions():
    smoothed = SmoothedLaw(PROCESS)
    grid = PhaseSpaceGrid(5.0, (64, 64, 40))
    law = smoothed.of_density(initial.equilibrium(grid, QUADRATIC), grid)
    assert law.sum() == pytest.approx(1.0, abs=1e-12)
    energy_grid = PROCESS.grid(400, signed=True)
    exact = smoothed.of_masses(energy_grid.equilibrium, energy_grid)
    # The sum over all functions was measured to be 5e-3, 5e-4, 5e-5 on 32, 48, 64
    # cells.
    np.testing.assert_allclose(law, exact, atol=2e-5)
    paths = PROCESS.sample(100_000, 1.0, 1.0, seed=2, initial="stationary")
    mean, error = smoothed.of_energies(paths.g[0])
    # Twelve comparisons.
    assert np.abs((mean - exact) / error).max() < 4.0


def test_distances_of_smoothed_laws_are_at_most_the_total_variation():
    smoothed, grid = SmoothedLaw(PROCESS), PROCESS.grid(200, signed=True)
    rng = np.random.default_rng(5)
    for _ in range(5):
        one, other = rng.dirichlet(np.ones(200), size=2)
        distance = np.abs(
            smoothed.of_masses(one, grid) - smoothed.of_masses(other, grid)
        ).sum()
        assert distance <= np.abs(one - other).sum()


@pytest.mark.parametrize("potential", [QUADRATIC, LinearPotential()], ids=repr)
@pytest.mark.parametrize(
    "law", [LAW, GaussianLaw((0.5, -0.8), (0.4, 0.2))], ids=["directed", "uniform"]
)
def test_the_law_of_g_along_orbits_is_that_of_points_drawn_from_the_start(
    potential, law
):
    process = EnergyProcess(potential, 1.0)
    smoothed, grid = SmoothedLaw(process), process.grid(800, signed=True)
    along = smoothed.of_masses(energy_masses(law, process, grid), grid)
    xi, alpha = law.sample(np.random.default_rng(3), 200_000)
    drawn, error = smoothed.of_energies(process.energy(*xi.T, alpha))
    # Twelve comparisons; functions that nobody reaches have no error at all.
    assert np.abs(along - drawn).max() < 4.0 * max(error.max(), 1e-6)


def test_the_density_of_a_gaussian_law_is_the_one_on_grids():
    grid = PhaseSpaceGrid(5.0, (40, 40, 24))
    on_grid = initial.gaussian(grid, (1.0, 0.0), 0.3, np.pi / 4, 2.0)
    exact = grid.evaluate(density_of(LAW))
    # The grid's is normalised by its own sum, which is exact to 1e-7 here.
    np.testing.assert_allclose(on_grid, exact, rtol=1e-6)


@pytest.mark.parametrize("potential", [QUADRATIC, LinearPotential()], ids=repr)
def test_the_box_leaves_the_share_outside_that_it_says(potential):
    width = half_width_for(potential, EnergyProcess(potential, 1.0))
    tail = {
        "quadratic": np.exp(-0.5 * width**2),
        "linear": stats.gamma(2.0).sf(width),
    }[potential.kind]
    # Tolerance 1e-6 in the width.
    assert tail == pytest.approx(3e-5, rel=1e-4)


# -- spectra --------------------------------------------------------------------------


def test_sectors_of_index_zero_tend_to_the_families_of_the_energy_process(spectra):
    even, odd = spectra.sel(family="even"), spectra.sel(family="odd")
    # A²/2 exactly, to the tolerance of 1e-6.
    np.testing.assert_allclose(odd.rate, 0.5, rtol=1e-6)
    assert odd.limit == pytest.approx(0.5, rel=1e-12)
    # Measured: 1.2e-3 at A = 0.4; the correction is of order A⁴.
    assert abs(even.rate.sel(noise=0.4) / even.limit - 1) < 2e-3
    assert list(spectra.noise.values) == [0.5, 0.4]


def test_restricting_the_angle_loses_the_slowest_mode(spectra):
    assert spectra.limit.sel(family="even") > 2.5 * spectra.limit.sel(family="odd")


def test_a_basis_that_does_not_fit_leaves_nan(monkeypatch):
    def too_large(*_, **__):
        raise MemoryLimitError(2, 1)

    monkeypatch.setattr(spectrum_module, "spectrum", too_large)
    assert np.isnan(small_noise_spectrum(QUADRATIC, (0.1,)).rate).all()


# -- figures and messages -------------------------------------------------------------


def test_figures_show_a_line_for_every_belt_and_family(study, spectra):
    figure = plot_small_noise([study[0], study[0]])
    assert isinstance(figure, Figure)
    assert len(figure.axes) == 2
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert "belt at rest" in labels
    assert any("0.3" in label for label in labels)
    axes = plot_small_noise_spectrum(spectra).axes[0]
    assert any("energy process, odd: 0.5" in text.get_text() for text in axes.texts)


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"noises": []}, ValueError, "`noises` must hold at least one noise"),
        ({"noises": [0.0]}, ValueError, "`noises` must be positive and finite, got 0"),
        ({"noises": [np.nan]}, ValueError, "`noises` must be positive"),
        ({"potential": FreePotential()}, ValueError, "must have a single well"),
        ({"potential": QuadraticPotential(1, 2)}, ValueError, "must be isotropic"),
        ({"slow_length": 0.0}, ValueError, "`slow_length` must be positive"),
        ({"belt_speed_scales": [np.inf]}, ValueError, "`belt_speed_scales` must be"),
        ({"p0": PointLaw()}, TypeError, "`p0` must be a GaussianLaw"),
        ({"n_paths": -1}, ValueError, "`n_paths` must be at least 0, got -1"),
        ({"ds": -0.1}, ValueError, "`ds` must be positive"),
        ({"seed": -1}, ValueError, "`seed` must be at least 0"),
    ],
)
def test_mistakes_are_named(change, error, message):
    arguments = {"potential": QUADRATIC, "noises": [0.4], **change}
    with pytest.raises(error, match=message):
        small_noise_limit(
            arguments.pop("potential"), arguments.pop("noises"), **arguments
        )


def test_the_studies_are_reached_by_their_names():
    assert studies.small_noise_limit is small_noise_limit
    assert studies.small_noise_spectrum is small_noise_spectrum
