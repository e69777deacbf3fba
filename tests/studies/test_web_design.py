"""Designs of webs: known laws whose optimum is in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from known_webs import KnownWeb
from scipy.special import stdtrit
from web_numbers import choose_few_nodes, choose_one_truncation

import fpsolve as fp
from fpsolve import studies
from fpsolve.errors import ToleranceError, UnreachableTargetError
from fpsolve.studies.design import predictions
from fpsolve.studies.design.confirm import laid_variation, positions_within
from fpsolve.studies.design.settings import PARAMETERS, Settings

PROCESS = fp.Process(0.005, 0.005, 25.0, 0.05, 50.0)
ZONES = np.array([0.01, 0.05])
SPACING, TITER = 2e-3, 1.5e-4
BELT = ("speed_ratio", "spacing")
WIDE = {"noise": (5.0, 50.0), "speed_ratio": (0.01, 0.25)}
LAW = KnownWeb()
NOISE, SPEED, DISTANCE = (
    PARAMETERS.index(name) for name in ("noise", "speed_ratio", "spacing")
)


@pytest.fixture
def known(monkeypatch):
    """Designs webs of a law in closed form; laying none."""

    def designed(target, law=LAW, process=PROCESS, **options):
        monkeypatch.setattr(predictions, "predict_web", law)
        names = options.setdefault("free", ("noise", *BELT))
        options.setdefault("bounds", {one: WIDE[one] for one in names if one in WIDE})
        return studies.design_web(
            process, target, spacing=SPACING, titer=TITER, n_webs=0, **options
        )

    return designed


def best_speed(law=LAW):
    """Of b (log v/v₀)² + c (log d/d₀)² where v d is that of the start."""
    product = np.log(PROCESS.speed_ratio * SPACING)
    other = product - law.best_spacing
    return (law.b * law.best_speed + law.c * other) / (law.b + law.c)


def test_the_most_even_web_is_where_its_law_has_its_minimum(known):
    """To the precision of the objective, 1e-6: √(1e-6/0.3) of a logarithm."""
    design = known(ZONES)
    expected = np.exp([LAW.best(ZONES).mean(), best_speed()])
    assert design.values[[NOISE, SPEED]] == pytest.approx(expected, rel=2e-3)
    assert design.active == ()
    assert design.kkt_residual < 2e-3
    assert design.cv == pytest.approx(np.exp(
        LAW.log_cv(*np.log(design.values[[NOISE, SPEED, DISTANCE]]), ZONES)
    ), rel=1e-14)  # fmt: skip


def test_the_base_weight_is_kept_along_the_whole_search(known):
    design = known(ZONES)
    weights = TITER / design.history[:, SPEED] / design.history[:, DISTANCE]
    assert weights == pytest.approx(TITER / (0.05 * SPACING), rel=1e-12)
    assert design.base_weight == pytest.approx(weights[0], rel=1e-12)
    # Kilograms per hour and metre: 3.6 titer U/d.
    assert design.throughput == pytest.approx(
        3.6 * TITER * 50.0 / design.spacing, rel=1e-12
    )
    assert design.history_throughput[-1] == pytest.approx(design.throughput)


def test_a_belt_that_runs_backwards_is_designed_as_well(known):
    forwards, back = (
        known(ZONES, process=replace(PROCESS, speed_ratio=speed))
        for speed in (0.05, -0.05)
    )
    assert back.values == pytest.approx(forwards.values, rel=1e-12)
    assert back.process.speed_ratio < 0
    assert back.sensitivities == pytest.approx(forwards.sensitivities, abs=1e-12)


def test_the_relaxation_length_of_smooth_fibres_ends_where_its_law_says(known):
    """At R₀ within the bounds, with the slope 2 e log (R/R₀) at one that holds it."""
    smooth, place = replace(PROCESS, relaxation_length=1e-3), -1
    free = ("noise", "relaxation_length")
    ends = {**WIDE, "relaxation_length": (1e-4, 2e-3)}
    design = known(ZONES, process=smooth, free=free, bounds={
        name: ends[name] for name in free
    })  # fmt: skip
    # To the precision of the objective, as above.
    assert design.values[place] == pytest.approx(5e-4, rel=3e-3)
    assert design.process.relaxation_length == design.values[place]
    assert design.history[0, place] == pytest.approx(1e-3, rel=1e-14)
    held = known(ZONES, process=smooth, free=free, bounds={
        "noise": WIDE["noise"], "relaxation_length": (8e-4, 2e-3)
    })  # fmt: skip
    assert held.active == ("relaxation_length at its lower bound",)
    slope = 2 * LAW.e * np.log(8e-4 / 5e-4)
    assert held.lower_multipliers[place] == pytest.approx(slope, rel=1e-9)
    assert held.sensitivities[place] == pytest.approx([slope] * 2, rel=1e-9)
    # A basic fibre has none, and nothing depends on it.
    basic = known(ZONES)
    assert basic.values[place] == 0
    assert not basic.sensitivities[place].any()


def test_the_multiplier_of_a_bound_is_the_slope_that_it_holds_back(known):
    """2 a (A − best) at the bound of A, which gives way by its logarithm."""
    low = {**WIDE, "noise": (5.0, 12.0)}
    design = known(ZONES, bounds=low)
    assert design.active == ("noise at its upper bound",)
    slope = 2 * LAW.a * (LAW.best(ZONES).mean() - np.log(12.0))
    assert design.upper_multipliers[NOISE] == pytest.approx(slope, rel=1e-6)
    assert not design.lower_multipliers.any()
    assert design.value_errors[NOISE] == 0.0
    # And so it is: with a little more room, the mean of log CV falls by it.
    more = known(ZONES, bounds={**low, "noise": (5.0, 12.0 * np.exp(1e-3))})
    gain = np.log(design.cv).mean() - np.log(more.cv).mean()
    # Up to its own change, a (1e-3)², and the precision of both searches.
    assert gain == pytest.approx(1e-3 * slope, abs=2e-6)


def test_the_fastest_belt_whose_web_is_even_enough_meets_the_bound(known):
    """With v free alone at the product v d: b and c make a quadratic equation."""
    bound, x = 0.0112, np.array([0.02])
    design = known({0.02: bound}, free=BELT)
    product = np.log(0.05 * SPACING)
    noise = LAW.a * (np.log(25.0) - LAW.best(x[0])) ** 2
    square = np.polynomial.Polynomial([-LAW.best_speed, 1.0]) ** 2
    other = np.polynomial.Polynomial([product - LAW.best_spacing, -1.0]) ** 2
    law = 0.5 * product + noise + LAW.b * square + LAW.c * other - np.log(bound)
    fastest = law.roots().real.max()
    assert np.isreal(law.roots()).all()
    assert np.log(design.values[SPEED]) == pytest.approx(fastest, abs=1e-6)
    assert design.cv == pytest.approx(bound, rel=1e-6)
    assert design.active == ("CV at 0.02 m",)
    # One per cent more of CV are worth 1/slope per cent of the belt speed.
    assert design.target_multipliers[0] == pytest.approx(
        1 / law.deriv()(fastest), rel=1e-5
    )


def test_what_cost_is_bought_can_be_chosen(known):
    """The fewest positions are the slowest belt, the coarsest fibre needs no v."""
    options = {"bounds": WIDE | {"noise": (24.0, 26.0)}}
    few = known({0.02: 0.0112}, cost="positions", **options)
    fast = known({0.02: 0.0112}, cost="throughput", **options)
    assert few.spacing > SPACING * 0.9 > fast.spacing
    coarse = known(
        {0.02: 0.0112}, cost="fineness", free=("spacing", "titer"),
        bounds={"titer": (1e-5, 1e-3)},
    )  # fmt: skip
    # Of titer and d alone, v stays, and the web is as uneven as it may be.
    assert coarse.process == PROCESS
    assert coarse.cv == pytest.approx(0.0112, rel=1e-6)
    assert coarse.titer / coarse.spacing == pytest.approx(TITER / SPACING, rel=1e-12)


@pytest.mark.parametrize("signs", [(1, 1), (1, -1), (-1, 1)])
def test_errors_of_the_optimum_cover_those_of_the_predictions(known, signs):
    """Slopes wrong by 1e-2 move a minimum, CV by 2e-3 what a bound allows, by less."""
    wrong = replace(LAW, wrong=2e-3 * signs[0], tilt=1e-2 * signs[1])
    for target, free, of in (
        (ZONES, ("noise",), NOISE),
        ({0.02: 0.0112}, BELT, SPEED),
    ):
        exact, found = (known(target, law, free=free) for law in (LAW, wrong))
        moved = abs(np.log(found.values[of] / exact.values[of]))
        # Beside the precision of the searches, as above.
        assert moved <= found.value_errors[of] + 2e-3
        # The error of a slope counts that of CV, too.
        assert moved > 0.5 * found.value_errors[of]


def test_a_bound_that_may_hold_nothing_leaves_the_error_of_its_parameter(known):
    """Slopes wrong by 1e-2 cannot tell one of 5e-3 at a bound from none."""
    law = replace(LAW, tilt=1e-2)
    best = LAW.best(ZONES).mean() - law.tilt / (2 * law.a)
    for slope, errs in ((5e-3, True), (5e-2, False)):
        high = float(np.exp(best - slope / (2 * law.a)))
        design = known(ZONES, law, free=("noise",), bounds={"noise": (5.0, high)})
        assert design.active == ("noise at its upper bound",)
        assert (design.value_errors[NOISE] >= law.tilt / (2 * law.a)) == errs
        assert (design.value_errors[NOISE] > 0) == errs


def test_a_parameter_that_nothing_tells_has_an_infinite_error(known):
    """A loose bound of CV is met at the fastest belt by noises of a whole interval."""
    design = known({0.02: 0.5}, bounds=WIDE | {"noise": (20.0, 30.0)})
    assert design.active == ("speed_ratio at its upper bound",)
    assert design.value_errors[NOISE] == np.inf
    assert design.value_errors[SPEED] == 0.0


def test_the_front_is_the_most_even_web_of_every_throughput(known):
    design = known(ZONES, front=4)
    speeds = np.exp(np.linspace(*np.log(WIDE["speed_ratio"]), 4))
    assert design.front[:, SPEED] == pytest.approx(speeds, rel=1e-12)
    assert design.front[:, NOISE] == pytest.approx(
        np.exp(LAW.best(ZONES).mean()), rel=2e-3
    )
    assert design.front_throughput == pytest.approx(
        design.throughput * speeds / design.values[SPEED], rel=1e-12
    )
    # None is better than the optimum, whose throughput is between theirs.
    means = np.log(design.front_cv).mean(axis=1)
    assert (means >= np.log(design.cv).mean() - 1e-6).all()


def test_the_front_of_a_bound_is_below_it_as_far_as_the_optimum(known):
    """Where the least of the worst CV/bound is 1, there is the fastest belt."""
    bounds = {0.01: 0.0113, 0.05: 0.0113}
    design = known(bounds, front=9)
    worst = (design.front_cv / design.largest).max(axis=1)
    slower = design.front_throughput < design.throughput
    # From the optimum of v on the worst ratio rises with the throughput.
    rising = design.front[:, SPEED] > np.exp(best_speed())
    assert (worst[slower & rising] < 1).all()
    assert (worst[~slower] > 1).all()
    assert (~slower).any()


def test_a_target_that_cannot_be_met_says_what_can(known):
    """The least CV of this law, at its minimum, and where."""
    least = np.exp(LAW.log_cv(
        LAW.best(0.02), best_speed(), np.log(0.05 * SPACING) - best_speed(), 0.02
    ))  # fmt: skip
    with pytest.raises(UnreachableTargetError, match="cannot be met") as raised:
        known({0.02: 0.9 * least})
    assert raised.value.reached == pytest.approx(least, rel=1e-6)
    assert raised.value.place["speed_ratio"] == pytest.approx(
        np.exp(best_speed()), rel=2e-3
    )
    assert str(raised.value).endswith("free another parameter.")


def test_slopes_that_are_no_slopes_are_noticed(known):
    """A law whose slopes belong to another one has no point that they call optimal."""

    class Wrong(KnownWeb):
        def __call__(self, process, **options):
            found = super().__call__(process, **options)
            found.gradient = found.gradient * 0 - found.cv / 20.0
            return found

    with pytest.raises(ToleranceError, match="no bound balances the gradient"):
        known(ZONES, Wrong(), free=("noise",))


def test_what_cannot_be_predicted_says_where_the_search_had_come(known):
    class Far(KnownWeb):
        def __call__(self, process, **options):
            if process.noise < 22.0:
                raise ToleranceError(0.1, 0.01, "raise `tolerance`")
            return super().__call__(process, **options)

    with pytest.raises(ToleranceError, match=r"away from noise = 1.* by `bounds`"):
        known(ZONES, Far(best_noise=np.log(30.0)), free=("noise",))


@pytest.mark.parametrize("positions", ["regular", "random"])
def test_laid_webs_of_small_zones_are_those_of_straight_lines(positions):
    """CV² → 0.946402 v d/x; at x = 0.05 σ and v = 0.05, with A = 1, it lacks 1 %."""
    zone, process = 0.05 * 0.005, fp.Process(0.005, 0.005, 14.1421, 0.05, 50.0)
    settings = Settings(process, 5e-4, TITER)
    cv, error = laid_variation(settings, np.array([zone]), positions, 6, seed=2)
    law = np.sqrt(0.946402 * 0.05 * 5e-4 / zone)
    if positions == "random":
        # Of independent positions, whose law of differences is N(0, 2 σ²).
        law = np.hypot(law, np.sqrt(5e-4 / (2 * np.sqrt(np.pi) * 0.005)))
    # Five scores in twenty thousand are beyond these bounds by chance.
    assert cv[0] == pytest.approx(law, abs=stdtrit(5, 0.999) * error[0] + 0.01 * law)
    assert error[0] < 0.03 * law


def test_shifted_positions_reach_over_the_window():
    settings = Settings(PROCESS, SPACING, TITER)
    places = positions_within(settings, 0.1, 0.25)
    assert np.diff(places) == pytest.approx(SPACING)
    assert places[0] <= -6 * PROCESS.sigma2 + SPACING
    assert places[-1] >= 0.1 + 6 * PROCESS.sigma2


@pytest.mark.nightly
def test_the_relaxation_length_of_a_predicted_web_ends_at_its_bound(monkeypatch):
    """Slopes of smooth fibres have the sign that two predictions have, in SI units.

    Of one truncation between few nodes, which are the same ones at every point.
    """
    choose_few_nodes(monkeypatch)
    choose_one_truncation(monkeypatch)
    process, zone = fp.Process(4e-3, 4e-3, 45.0, 0.2, 20.0, 8e-4), 0.016
    ends = 4e-4, 1.2e-3
    design = studies.design_web(
        process, zone, spacing=1e-3, titer=TITER, free=["relaxation_length"],
        bounds={"relaxation_length": ends}, tolerance=0.5, n_webs=0,
    )  # fmt: skip
    low, high = (
        fp.predict_web(
            replace(process, relaxation_length=end), spacing=1e-3, zones=zone,
            tolerance=0.5,
        ).cv[0]
        for end in ends
    )  # fmt: skip
    best = int(high < low)
    assert design.process.relaxation_length == pytest.approx(ends[best], rel=1e-9)
    assert design.cv[0] == pytest.approx((low, high)[best], rel=1e-9)
    assert design.history_cv[0, 0] > design.cv[0]
    # The mean slope between both ends is between those at the ends.
    mean = np.log(high / low) / np.log(ends[1] / ends[0])
    slopes = design.sensitivities[-1, 0]
    assert np.sign(slopes) == np.sign(mean)
