"""Laid webs are as even as the prediction says, within their standard errors."""

import math

import numpy as np
import pytest
from scipy.special import stdtrit

import fpsolve as fp
from fpsolve import studies
from fpsolve.plotting import plot_web_homogeneity
from fpsolve.studies.webs.homogeneity_case import Laid, seeds_of, zone_squares

UNIT = fp.QuadraticPotential()
N_WEBS = 10


def study(directory, **further):
    return studies.web_homogeneity(
        UNIT, [1.0], [0.3], [0.5], zones=[0.25, 1.0, 3.0], positions="random",
        n_webs=N_WEBS, ds=0.05, tolerance=0.05, workers=0, directory=directory,
        **further,
    )  # fmt: skip


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    return tmp_path_factory.mktemp("cases")


@pytest.fixture(scope="module")
def dataset(directory):
    return study(directory)


def test_laid_webs_vary_as_predicted(dataset):
    assert dataset["status"].to_numpy().tolist() == [[["finished"]]]
    z = dataset["z"].to_numpy()
    # Three scores of Student's distribution: beyond the bound one study in a hundred.
    assert np.abs(z).max() < stdtrit(N_WEBS - 1, 1 - 0.005 / z.size)
    # Four errors would have shown that the coherent part lacks in the largest zones,
    # d/x² ∫ (x − |y|)₊ g(y) dy with the law g of the difference of two ξ2, N(0, 2):
    # 86 % of CV².
    x, largest = 3.0, dataset.isel(noise=0, belt_speed=0, spacing=0, zone=-1)
    inside = x * math.erf(x / 2) - 2 * (1 - math.exp(-(x**2) / 4)) / math.sqrt(math.pi)
    share = 0.5 / x**2 * inside / float(largest["predicted"]) ** 2
    assert 8 * largest["standard_error"] < share * largest["simulated"]


def test_scores_are_those_of_the_numbers_beside_them(dataset):
    one = {name: dataset[name].to_numpy() for name in
           ("predicted", "predicted_error", "simulated", "standard_error")}  # fmt: skip
    errors = np.hypot(
        2 * one["simulated"] * one["standard_error"],
        2 * one["predicted"] * one["predicted_error"],
    )
    difference = one["simulated"] ** 2 - one["predicted"] ** 2
    np.testing.assert_allclose(dataset["z"], difference / errors, rtol=1e-10)


def test_a_study_goes_on_from_what_it_has_kept(dataset, directory):
    told = []
    again = study(directory, progress=lambda *case: told.append(case))
    assert not [case for _, _, case in told if not case.resumed]
    np.testing.assert_array_equal(again["z"], dataset["z"])


def test_zones_around_a_web_are_all_squares_of_pixels():
    rng = np.random.default_rng(1)
    density = rng.normal(size=(6, 9))
    for n in (1, 2, 5, 6):
        squares = [
            density[np.ix_(np.arange(i, i + n) % 6, np.arange(j, j + n))].mean() ** 2
            for i in range(6)
            for j in range(9 - n + 1)
        ]
        # Sums of rounding of a few dozen numbers of order one.
        assert zone_squares(density, n) == pytest.approx(np.mean(squares), rel=1e-12)


def test_cases_have_webs_of_their_own_whatever_is_studied_beside():
    laid = Laid((1.0,), "regular", 2, 1.0, None, 1, 0.1)
    first, again, other = (seeds_of(laid, 1.0, 0.3, d) for d in (0.5, 0.5, 2.0))
    states = [
        tuple(int(seed.generate_state(1, np.uint64)[0]) for seed in seeds)
        for seeds in (first, again, other)
    ]
    assert states[0] == states[1]
    assert len({*states[0], *states[2]}) == 4


def test_the_figure_has_a_panel_for_noise_and_speed(dataset):
    figure = plot_web_homogeneity(dataset)
    (axes,) = figure.axes
    assert axes.get_title() == "$A$ = 1,  $v$ = 0.3"
    assert axes.get_legend_handles_labels()[1] == ["$d$ = 0.5"]
    np.testing.assert_allclose(
        axes.lines[0].get_ydata(), 100 * dataset["predicted"][0, 0, 0]
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"zones": [0.25, 0.3]}, "`zones` must be multiples of `pixel` = 0.25"),
        ({"spacings": [0.3]}, "`spacings` must be multiples .* got 0.3"),
        ({"spacings": [0.1]}, "`spacings` must be multiples .* got 0.1"),
        ({"spacings": [np.nan]}, "`spacings` must be positive"),
        ({"spacings": []}, "`spacings` must hold at least one"),
        ({"belt_speeds": [0.0]}, "`belt_speeds` must hold speeds other than 0"),
        ({"belt_speeds": [np.nan]}, "`belt_speeds` must hold speeds .* got .nan"),
        ({"belt_speeds": []}, "`belt_speeds` must hold speeds"),
        ({"noises": []}, "`noises` must hold"),
        ({"zones": []}, "`zones` must name a side"),
        ({"zones": [1e5]}, "`zones` must lie between"),
        ({"positions": "hexagonal"}, "`positions`"),
        ({"n_webs": 1}, "`n_webs` must be at least 2"),
        ({"pixel": 0.0}, "`pixel` must be positive"),
        ({"ds": np.nan}, "`ds` must be positive"),
        ({"seed": -1}, "`seed` must be at least 0"),
        ({"tolerance": 0.0}, "`tolerance` must be positive"),
        ({"potential": fp.LinearPotential()}, "`potential` must be a smooth function"),
    ],
)  # fmt: skip
def test_what_no_study_can_be_of_is_refused_before_a_web_is_laid(options, message):
    arguments = {"potential": UNIT, "noises": [1.0], "belt_speeds": [0.3],
                 "spacings": [0.5], "zones": [0.25, 1.0], **options}  # fmt: skip
    with pytest.raises(ValueError, match=message):
        studies.web_homogeneity(**arguments, workers=0)


@pytest.mark.nightly
def test_webs_of_smooth_fibres_vary_as_predicted():
    dataset = studies.web_homogeneity(
        UNIT, [3.0], [0.3], [0.5], zones=[0.5, 1.0, 3.0], n_webs=N_WEBS, ds=0.02,
        relaxation_length=0.1, tolerance=0.05, workers=0,
    )  # fmt: skip
    assert dataset.attrs["relaxation_length"] == 0.1
    z = dataset["z"].to_numpy()
    assert np.abs(z).max() < stdtrit(N_WEBS - 1, 1 - 0.005 / z.size)
    # The prediction of the basic model is missed by more than four errors.
    basic = fp.predict_web(
        fp.LayDownModel(UNIT, 3.0, fp.MovingBelt(0.3)), spacing=0.5,
        zones=dataset["zone"].to_numpy(), tolerance=0.05,
    )  # fmt: skip
    one = dataset.isel(noise=0, belt_speed=0, spacing=0)
    away = np.abs(one["simulated"].to_numpy() - basic.cv)
    assert (away > 4 * one["standard_error"].to_numpy()).any()
