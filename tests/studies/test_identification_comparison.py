"""Two models of one fibre: what AIC and the goodness of fit say, and what is stored."""

from dataclasses import dataclass, replace
from importlib import import_module

import numpy as np
import pytest
from known_identifications import known_identification

import fpsolve as fp
from fpsolve.plotting.files import possible_figures
from fpsolve.studies.identification.comparison import SMALLEST_LEVEL
from fpsolve.studies.identification.goodness import TESTS, Comparison
from fpsolve.studies.identification.increments import samples_of, squares
from fpsolve.studies.identification.synthetic import laid_fibres

POTENTIAL, BELT = fp.QuadraticPotential(1.0, 0.7), fp.MovingBelt(0.2)


def compared(basic=10.0, smooth=12.0, curve=BELT):
    """A comparison of known logarithms of likelihoods; by the functional without."""
    models = {
        "basic": fp.LayDownModel(POTENTIAL, 1.0, curve),
        "smooth": fp.SmoothLayDownModel(POTENTIAL, 0.5, 1.0, curve),
    }
    found = {name: known_identification(model) for name, model in models.items()}
    method = "functional" if basic is None else "likelihood"
    for (name, one), value in zip(found.items(), (basic, smooth), strict=True):
        found[name] = replace(one, log_likelihood=value, method=method)
    return fp.IdentificationComparison(**found)


LOW = {"law of xi1": 1 / 129}


def test_aic_counts_the_parameters_and_its_weights_are_likelihood_ratios():
    found = compared(10.0, 12.0)
    assert found.aic == {"basic": 6 - 20, "smooth": 8 - 24}
    assert found.aic_difference == 2.0
    weights = found.weights
    # exp(2/2), to rounding.
    assert weights["smooth"] / weights["basic"] == pytest.approx(np.e, rel=1e-14)
    assert sum(weights.values()) == pytest.approx(1.0, rel=1e-15)
    assert (found.preferred, found.best) == ("smooth", found.smooth)
    assert compared(10.0, 10.9).preferred == "basic"
    # Where one is out of the question, nothing overflows.
    assert compared(-9e5, 12.0).weights == {"basic": 0.0, "smooth": 1.0}


def test_six_tests_reject_together_at_the_level():
    found = compared()
    assert found.p_values == {"basic": 1.0, "smooth": 1.0}
    assert found.rejected() == {}
    for p, rejected in ((0.05 / 6, True), (0.0501 / 6, False)):
        one = replace(found.basic, p_values=dict.fromkeys(TESTS, 0.9) | {TESTS[2]: p})
        other = replace(found, basic=one)
        assert other.rejected() == ({"basic": (TESTS[2],)} if rejected else {})
        assert other.p_values["basic"] == pytest.approx(6 * p, rel=1e-15)
    # 128 surrogates and the data: the smallest p-value rejects at 5 per cent.
    assert SMALLEST_LEVEL == 6 / 129 < 0.05


@pytest.mark.parametrize("level", [0.04, 1.0, np.nan])
def test_a_level_at_which_nothing_can_be_rejected_is_refused(level):
    with pytest.raises(ValueError, match=r"`level` must be .*(0\.0465|finite)"):
        compared().rejected(level)


def test_a_verdict_says_what_aic_means_where_models_are_rejected():
    neither = compared().verdict
    assert neither == (
        "AIC prefers the smooth model, by 2.00 (weight 0.731).",
        "The goodness of fit rejects neither model.",
    )
    one = compared()
    basic = replace(one.basic, p_values=one.basic.p_values | LOW)
    smooth = replace(one.smooth, p_values=one.smooth.p_values | LOW)
    assert replace(one, basic=basic).verdict[1:] == (
        "The goodness of fit rejects the basic model: law of xi1.",
    )
    contrary = replace(one, smooth=smooth).verdict
    assert "rejects the smooth model: law of xi1." in contrary[1]
    assert "AIC prefers the rejected model" in contrary[2]
    both = replace(one, basic=basic, smooth=smooth).verdict
    assert both[1] == (
        "The goodness of fit rejects both models (basic: law of xi1; smooth: law of "
        "xi1)."
    )
    assert "AIC then only says which of two wrong models" in both[2]
    assert "hold for neither" in both[3]
    assert " ".join(both) in repr(replace(one, basic=basic, smooth=smooth))


def test_the_functional_has_no_aic_and_prefers_the_only_model_that_is_left():
    found = compared(None, None)
    assert (found.aic, found.aic_difference, found.weights) == (None, None, None)
    assert found.verdict[0].endswith("no likelihood, and no AIC.")
    assert found.preferred is None
    with pytest.raises(
        ValueError, match=r"`best` must be preferred .* rejects neither"
    ):
        _ = found.best
    basic = replace(found.basic, p_values=found.basic.p_values | LOW)
    smooth = replace(found.smooth, p_values=found.smooth.p_values | LOW)
    left = replace(found, basic=basic)
    assert (left.preferred, left.best) == ("smooth", found.smooth)
    with pytest.raises(ValueError, match="a fit that rejects both; take"):
        _ = replace(left, smooth=smooth).best
    assert len(replace(left, smooth=smooth).verdict) == 3


@pytest.fixture
def quick_fit(monkeypatch):
    """A goodness of fit that draws nothing: every p-value is 1/(1 + seed)."""

    def compare_with_surrogate(fibre, estimate, lags, seed):
        own = squares(samples_of(fibre), lags, fibre.ds)
        return Comparison(own, own, dict.fromkeys(TESTS, 1 / (1 + seed)))

    place = import_module("fpsolve.studies.identification.identify")
    monkeypatch.setattr(place, "compare_with_surrogate", compare_with_surrogate)


def test_both_models_are_those_of_identify_and_have_their_calls(tmp_path, quick_fit):
    model = fp.LayDownModel(POTENTIAL, 1.0, BELT)
    eta = laid_fibres(model, 1, 601, 0.2, seed=5)[0]
    found = fp.compare_models(eta, ds=0.2, curve=BELT, seed=3)
    alone = fp.identify(eta, ds=0.2, curve=BELT, model="basic", seed=3)
    assert fp.compare(found.basic, alone).equal
    # Fresh noise: the seed after that of the estimate.
    assert found.basic.p_values["law of xi1"] == 1 / (1 + 4)
    assert found.data is found.smooth.data is found.basic.data
    loaded = fp.load(found.save(tmp_path / "both.nc"))
    for name, one in loaded.identifications.items():
        own = found.identifications[name]
        assert fp.compare(one, own).equal
        assert one.call.function == "identify"
        assert one.call.arguments == own.call.arguments
        assert one.parameters == own.parameters
    # Of a basic fibre the smooth model has an R that is not told from 0.
    assert "curvature_noise" in loaded.smooth.undetermined
    assert loaded.smooth.undetermined == found.smooth.undetermined


def test_what_is_stored_of_the_functional_comes_back(tmp_path):
    found = compared(None, None)
    long = replace(
        found.smooth, history=np.arange(12.0).reshape(3, 4),
        notes=("k_max = 1",), undetermined={"noise": "it is loud"},
    )  # fmt: skip
    found = replace(found, smooth=long, provenance={"versions": {"fpsolve": "0"}})
    dataset = found.to_xarray()
    assert "aic" not in dataset
    assert np.isnan(dataset["estimate"].sel(model="basic")[3])
    loaded = fp.load(found.save(tmp_path / "both.nc"))
    assert loaded.smooth.log_likelihood is None
    assert loaded.smooth.notes == ("k_max = 1",)
    assert loaded.smooth.undetermined == {"noise": "it is loud"}
    assert loaded.basic.history.shape == (0, 3)
    np.testing.assert_array_equal(loaded.smooth.history, long.history)
    np.testing.assert_array_equal(loaded.basic.covariance, found.basic.covariance)
    assert fp.compare(found, loaded).equal


@dataclass(frozen=True)
class Swaying(fp.Curve):
    """γ = −(v s + a sin s) e₁: a user's own."""

    speed: float
    autonomous, fixed = False, False
    formula = "sways"
    latex = "s"

    def position(self, s):
        return -self.speed * (np.asarray(s) + 0.1 * np.sin(s)), np.zeros(np.shape(s))

    def velocity(self, s):
        return -self.speed * (1 + 0.1 * np.cos(s)), np.zeros(np.shape(s))

    def displacement(self, s0, s1):
        return float(self.position(s1)[0] - self.position(s0)[0]), 0.0


def test_models_about_a_curve_of_a_user_come_back_as_their_descriptions(tmp_path):
    found = compared(curve=Swaying(0.2))
    path = replace(found, provenance={"versions": {}}).save(tmp_path / "own.nc")
    with pytest.warns(UserWarning, match="could not be read back"):
        loaded = fp.load(path)
    assert (loaded.basic.model, loaded.smooth.model) == (None, None)
    described = [one.provenance["equation"] for one in loaded.identifications.values()]
    assert described == [found.basic.model.process_equation,
                         found.smooth.model.process_equation]  # fmt: skip
    assert loaded.to_xarray().attrs["models"] == found.to_xarray().attrs["models"]
    assert list(possible_figures(loaded)) == ["increments"]
    assert list(possible_figures(found)) == ["fibres", "increments"]


def test_a_comparison_is_drawn_as_its_models_are():
    found = compared()
    figure = fp.plotting.plot_increments(found)
    labels = [one.get_text() for one in figure.legends[0].get_texts()]
    assert labels == ["data", "basic", "smooth"]
    with pytest.raises(TypeError, match="`compare_models` returns"):
        fp.plotting.plot_increments(found.data)
