"""The full equation approaches its limit for large noise with the orders derived."""

import json
import warnings

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.special import ive

from fpsolve import initial, studies
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    FreePotential,
    IsotropicPotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)
from fpsolve.paths import EquilibriumLaw, GaussianLaw
from fpsolve.plotting.limits import plot_large_noise
from fpsolve.reduced.hydrodynamic import HydrodynamicLimit
from fpsolve.spectral.eigen.gap import spectral_gap
from fpsolve.spectral.evolution.evolution import spectral_solve
from fpsolve.spectral.evolution.steady import spectral_steady_state
from fpsolve.studies.constants.poincare import next_gap_term, poincare_constant
from fpsolve.studies.limits.balance import balanced_force
from fpsolve.studies.limits.distances import distances
from fpsolve.studies.limits.large_noise import LARGE_NOISE_START, large_noise_limit
from fpsolve.studies.limits.plane_limit import stationary_limit, transient_limit

QUADRATIC = QuadraticPotential()
NOISES = 2.0 ** np.array([1.0, 1.5, 2.0])  # ε = 1/4, 1/8, 1/16
# How far an order may be from the one derived at the halvings to ε = 1/8 and 1/16.
# The next term is of relative size ε² (ε for uncorrected starts), and in transients,
# where it grows with the slow time, about 10 ε².
BANDS = {"transient": (0.9, 0.4), "stationary": (0.15, 0.1)}
PARTS = ["stationary", "belt_directed", "rest_uniform", "fixed_speed"]


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A quick study in this process, kept in a folder."""
    folder = tmp_path_factory.mktemp("store")
    return large_noise_limit(
        QUADRATIC, NOISES, parts=PARTS, quick=True, workers=0, directory=folder
    ), folder


def test_distances_fall_with_the_orders_derived_at_every_halving(study):
    dataset, _ = study
    for name in dataset["quantity"].to_numpy():
        one = dataset.sel(quantity=name)
        expected = float(one["expected_order"])
        part, measure = name.split("/")
        # Exact, or close to a zero.
        if not np.isfinite(expected) or measure == "second_moment":
            continue
        # A²v misses a share that still changes: see its own test.
        if name == "fixed_speed/mean_linear":
            continue
        kind = "transient" if "_" in part and part != "fixed_speed" else "stationary"
        # Ascending noise: the order at each is that since the noise before.
        deviation = np.abs(one["observed_order"].to_numpy()[1:] - expected)
        assert np.all(deviation < BANDS[kind]), f"{name}: {deviation}"


def test_the_solver_is_far_more_accurate_than_the_limit(study):
    dataset, _ = study
    ours = dataset.sel(quantity=~dataset["quantity"].isin(["stationary/direction_p1"]))
    share = (ours["distance_error"] / ours["distance"]).sel(noise=NOISES[2])
    # Of every distance but the second moments, which come close to a zero.
    others = [name for name in share["quantity"].to_numpy() if "second" not in name]
    assert float(share.sel(quantity=others).max()) < 0.2


def test_the_mean_direction_of_the_stationary_state_is_exact_with_p1(study):
    dataset, _ = study
    exact = dataset.sel(quantity="stationary/direction_p1")
    # E cos α = −v holds for p₁ and for every scheme that keeps E ξ: what is left is
    # the residual of the steady state and the quadrature over 12 angles.
    assert np.all(exact["distance"] < 2e-5)
    without = dataset.sel(quantity="stationary/direction")
    np.testing.assert_allclose(without["distance"], 0.5 / NOISES**2, atol=2e-5)


def test_the_correction_raises_the_order_of_the_joint_density(study):
    dataset, _ = study
    orders = dataset["fitted_order"]
    for part in ("stationary", "rest_uniform", "belt_directed"):
        plain = float(orders.sel(quantity=f"{part}/joint"))
        corrected = float(orders.sel(quantity=f"{part}/joint_p1"))
        assert corrected > plain + 0.8
    # p₁ alone does not help a start with a direction: its displacement is missed.
    assert float(orders.sel(quantity="belt_directed/joint_p1_uncorrected")) < 1.5


def test_distances_are_those_to_spectral_solutions_within_their_errors(study):
    dataset, _ = study
    noise = float(NOISES[1])
    s = 1.25 * noise**2
    still = LayDownModel(QUADRATIC, noise)
    moving = LayDownModel(QUADRATIC, noise, MovingBelt(0.5 / noise**2))
    grid = PhaseSpaceGrid((6.0, 5.5), (60, 52, 16))
    law = GaussianLaw(LARGE_NOISE_START.mean, LARGE_NOISE_START.variance)
    evolved = spectral_solve(still, law, [s], tolerance=1e-5)
    steady = spectral_steady_state(moving, tolerance=1e-8)
    for part, model, p, limit in (
        ("rest_uniform", still, evolved.density(s, grid),
         transient_limit(still, grid, law, s, corrected=True)),
        ("stationary", moving, steady.density(grid), stationary_limit(moving, grid)),
    ):  # fmt: skip
        for name, value in distances(p, limit, grid, model).items():
            one = dataset.sel(quantity=f"{part}/{name}", noise=noise)
            # The estimates are those of a coarser run; 2e-5 for what another grid
            # changes in the norms.
            allowed = float(one["distance_error"]) + 2e-5
            assert abs(float(one["distance"]) - value) < allowed, f"{part}/{name}"


def test_at_rest_the_limit_has_the_exact_stationary_density():
    model = LayDownModel(PowerPotential(4.0), 2.0)
    grid = PhaseSpaceGrid(3.0, (24, 24, 8))
    p = initial.equilibrium(grid, model.potential)
    found = distances(p, stationary_limit(model, grid), grid, model)
    # p₁ vanishes; the box cuts off e^{−20}.
    assert max(found.values()) < 1e-7


def test_the_limit_is_solved_as_the_closed_form_has_it():
    isotropic = IsotropicPotential(lambda r: r**2 / 2, lambda r: r)
    grid = PhaseSpaceGrid(5.0, (32, 32, 8))
    for corrected in (False, True):
        exact, solved = (
            transient_limit(
                LayDownModel(potential, 2.0, MovingBelt(0.1)),
                grid, LARGE_NOISE_START, 2.0, corrected=corrected,
            )
            for potential in (QUADRATIC, isotropic)
        )  # fmt: skip
        # Cells of 0.31 combined with cells of 0.1 leave an error of order four.
        plane = np.abs(exact.plane - solved.plane).sum() * grid.cell_area
        assert plane < 4e-4
        joint = np.abs(exact.joint - solved.joint).sum() * grid.cell_volume
        assert joint < 8e-4


def test_the_corrected_start_is_that_of_the_initial_layer():
    errors = []
    for n in (32, 64):
        grid = PhaseSpaceGrid(4.0, (n, n, 16))
        model = LayDownModel(QUADRATIC, 2.0)
        law = LARGE_NOISE_START
        p0 = initial.gaussian(
            grid, law.mean, law.variance, law.angle, law.concentration
        )
        layer = HydrodynamicLimit(model).initial_layer(p0, grid)
        start = transient_limit(model, grid, law, 0.0, corrected=True)
        difference = np.abs(layer.corrected_start - start.plane).sum()
        errors.append(difference * PlaneGrid.of(grid).cell_area)
    # The layer differentiates by centred differences, of order two.
    assert 3.5 < errors[0] / errors[1] < 4.5
    assert errors[1] < 0.02


@pytest.mark.parametrize(
    "potential",
    [QUADRATIC, QuadraticPotential(1.0, 0.7), QuadraticPotential(0.7, 1.0),
     QuadraticPotential(1.0, 0.3), LinearPotential()],
)  # fmt: skip
def test_the_next_term_of_the_gap_is_the_one_derived(potential):
    noise = 16.0 / np.sqrt(poincare_constant(potential)) ** 0.5
    gap = float(spectral_gap(LayDownModel(potential, noise), tolerance=1e-12))
    excess = (gap * noise**2 / poincare_constant(potential) - 1) * noise**4
    # The term after it is of relative size ε² ≈ 4e-6, with a factor that grows with
    # the anisotropy.
    assert excess == pytest.approx(next_gap_term(potential), rel=3e-3)


def test_the_gap_tends_to_its_expansion_with_the_orders_two_and_four():
    found = large_noise_limit(
        QUADRATIC, (4.0, 4.0 * 2**0.5, 8.0), parts=["gap"], workers=0
    )
    for measure, order in (("gap", 2.0), ("next_term", 4.0)):
        observed = found["observed_order"].sel(quantity=f"gap/{measure}")
        # The next term is of relative size ε².
        np.testing.assert_allclose(observed[1:], order, atol=0.1)
    assert np.isnan(next_gap_term(PowerPotential(4.0)))


def test_the_balance_holds_the_angle():
    for speed in (-0.3, 0.0, 0.01, 0.5, 0.99):
        concentration = 2 * balanced_force(speed, 3.0) / 9.0
        ratio = ive(1, concentration) / ive(0, concentration)
        assert ratio == pytest.approx(speed, abs=1e-12)
    # v + v³/2 + O(v⁵).
    assert balanced_force(0.01, 1.0) == pytest.approx(0.01 + 0.5e-6, abs=1e-10)
    with pytest.raises(ValueError, match="`belt_speed` must lie strictly between"):
        balanced_force(1.0, 1.0)


def test_at_a_fixed_speed_only_the_balance_converges(study):
    dataset, _ = study
    linear = dataset["distance"].sel(quantity="fixed_speed/mean_linear")
    # A²v misses 1 − 2v/k of the mean for ever.
    share = 1 - 0.3 / balanced_force(0.3, 1.0)
    assert float(linear[-1]) == pytest.approx(share, rel=0.05)
    balance = dataset["distance"].sel(quantity="fixed_speed/mean_balance")
    assert float(balance[-1]) < 0.002


def test_a_dataset_says_what_repeats_it_and_comes_back_from_its_folder(study, tmp_path):
    dataset, folder = study
    assert np.all(dataset["status"] == "finished")
    assert json.loads(dataset.attrs["p0"])["concentration"] == 2.0
    assert json.loads(dataset.attrs["potential"])["kind"] == "quadratic"
    np.testing.assert_allclose(dataset["epsilon"], NOISES**-2)
    told = []
    again = large_noise_limit(
        QUADRATIC, NOISES, parts=PARTS, quick=True, workers=0, directory=folder,
        progress=lambda *what: told.append(what),
    )  # fmt: skip
    assert told == []
    assert again.identical(dataset)
    dataset.to_netcdf(tmp_path / "study.nc", engine="h5netcdf")


def test_other_potentials_have_the_parts_that_can_be_had():
    found = large_noise_limit(
        PowerPotential(4.0), (2.0, 8**0.5), parts=["stationary"],
        quick=True, workers=0, belt_speed_scale=0.4,
    )  # fmt: skip
    names = found["quantity"].to_numpy()
    assert "stationary/mean_balance" not in names
    observed = found["observed_order"].isel(noise=1)
    for name, order in (("marginal", 2.0), ("joint", 1.0), ("joint_p1", 2.0)):
        # One halving from ε = 1/4, where the next term still shows.
        assert abs(float(observed.sel(quantity=f"stationary/{name}")) - order) < 0.3
    without = large_noise_limit(
        PowerPotential(4.0), (3.0,), parts=["gap"], workers=0, belt_speed_scale=0.0
    )
    assert float(without["distance"].sel(quantity="gap/gap")[0]) < 0.1
    with pytest.raises(ValueError, match="`parts` must be among rest_directed, rest_"):
        large_noise_limit(
            PowerPotential(4.0), (3.0,), parts=["stationary"], belt_speed_scale=0.0
        )


def test_a_part_that_fails_leaves_the_others():
    # A start narrower than the cells, which are chosen for e^{−B}; a gap needs none.
    point = GaussianLaw((1.0, 0.0), 1e-6, 0.0, 1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = large_noise_limit(
            QUADRATIC, (2.0,), parts=["rest_uniform", "gap"], p0=point, workers=0,
            quick=True,
        )  # fmt: skip
    assert found["status"].values.tolist() == [["failed", "finished"]]
    assert "Error: " in str(found["message"].values[0, 0])
    assert np.isnan(found["distance"].sel(quantity="rest_uniform/joint")).all()


def test_the_figure_has_a_panel_for_every_part(study):
    dataset, _ = study
    figure = plot_large_noise(dataset)
    assert isinstance(figure, Figure)
    figure.canvas.draw()
    titles = [axes.get_title() for axes in figure.axes if axes.axison]
    assert len(titles) == 4
    alone = large_noise_limit(QUADRATIC, (3.0, 4.0), parts=["gap"], workers=0)
    plot_large_noise(alone).canvas.draw()
    with pytest.raises(ValueError, match="`dataset` must come from `large_noise_limit"):
        plot_large_noise(dataset.drop_vars("expected_order"))


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"noises": []}, ValueError, "`noises` must hold at least one noise"),
        ({"noises": [0.0]}, ValueError, "`noises` must be positive and finite, got 0"),
        ({"potential": FreePotential()}, ValueError, "`potential` must confine"),
        ({"belt_speed_scale": 4.0}, ValueError, "must be below A² = 4 of the least"),
        (
            {"potential": LinearPotential(), "belt_speed_scale": 1.5}, ValueError,
            "`belt_speed_scale` must be small enough .* below K = 1, got 1.5",
        ),
        ({"slow_length": 0.0}, ValueError, "`slow_length` must be positive"),
        ({"fixed_speed": 1.0}, ValueError, "`fixed_speed` must be below 1, got 1"),
        ({"p0": EquilibriumLaw(QUADRATIC)}, TypeError, "`p0` must be a GaussianLaw"),
        ({"p0": GaussianLaw()}, ValueError, "`p0` must have a positive concentration"),
        ({"parts": ["gaps"]}, ValueError, "`parts` must be among .*, got gaps"),
        ({"parts": []}, ValueError, "`parts` must be among .*, got none"),
    ],
)  # fmt: skip
def test_bad_arguments_are_named(options, kind, message):
    arguments = {"potential": QUADRATIC, "noises": [2.0], **options}
    with pytest.raises(kind, match=message):
        large_noise_limit(arguments.pop("potential"), arguments.pop("noises"),
                          workers=0, **arguments)  # fmt: skip


def test_the_study_is_found_by_its_short_name():
    assert studies.large_noise_limit is large_noise_limit
