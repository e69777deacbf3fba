"""Gradients of predicted webs: laws, differences, units, files."""

import math

import numpy as np
import pytest
from web_numbers import NUMBERS, choose_few_nodes, model_of

import fpsolve as fp
from fpsolve.pages import predicted_web
from fpsolve.results.kinds import from_xarray
from fpsolve.spectral.resolvent.fibre import BasicFibre
from fpsolve.web.coherent_gradient import strip_gradient
from fpsolve.web.gradient import orientation_gradient

# Sides in triples, for differences in the side.
H = 0.01
SIDES = np.outer([0.3, 4.0], [1 - H, 1.0, 1 + H]).ravel()
MIDDLE = slice(1, None, 3)
BAND = np.array([0.5, 3.0])


def predicted(numbers, zones, **options):
    return fp.predict_web(model_of(numbers), spacing=numbers[4], zones=zones, **options)


@pytest.fixture(scope="module")
def web():
    bands = [share * BAND for share in (1 - H, 1.0, 1 + H)]
    return predicted(NUMBERS, SIDES, bands=bands, tolerance=0.05, gradients=True)


@pytest.fixture
def few_nodes(monkeypatch):
    choose_few_nodes(monkeypatch)


@pytest.mark.nightly
def test_gradients_fulfil_the_law_of_dimensions(web):
    """CV does not know units: σ1 ∂1 + σ2 ∂2 + d ∂d + x ∂x − (A/2) ∂_A = 0.

    All of it but x ∂x is from adjoints; that is a difference between zones of one
    spectrum, with h²/6 of its third derivative left.
    """
    weights = np.array([-0.5, 0.0, 1.0, 1.0, 1.0]) * NUMBERS
    low, high = web.cv[0::3], web.cv[2::3]
    by_side = (high - low) / (2 * H)
    total = weights @ web.gradient[:, MIDDLE] + by_side
    sizes = np.abs(weights) @ np.abs(web.gradient[:, MIDDLE])
    errors = np.abs(weights) @ web.gradient_errors[:, MIDDLE]
    assert (np.abs(total) <= errors).all()
    # Far less than the errors, which add up here: the nodes are the same ones.
    assert (np.abs(total) <= 0.02 * sizes).all()
    assert (errors <= 0.1 * sizes).all()
    assert web.parameters == ("noise", "belt_speed", "sigma1", "sigma2", "spacing")
    assert "∂ by noise, belt_speed" in repr(web)


@pytest.mark.nightly
def test_gradients_of_the_cloudiness_fulfil_the_law_of_dimensions(web):
    """The same with both ends of the band in place of the side of the zone."""
    weights = np.array([-0.5, 0.0, 1.0, 1.0, 1.0]) * NUMBERS
    by_band = (web.cloudiness[2] - web.cloudiness[0]) / (2 * H)
    total = weights @ web.cloudiness_gradient[:, 1] + by_band
    size = np.abs(weights) @ np.abs(web.cloudiness_gradient[:, 1])
    errors = np.abs(weights) @ web.cloudiness_gradient_errors[:, 1]
    assert abs(total) <= min(errors, 0.02 * size)
    # Errors of all nodes of one sign, as if nothing cancelled between them.
    assert errors <= 0.2 * size


def test_the_ratio_of_both_directions_fulfils_the_law_of_dimensions():
    """σ1 ∂1 + σ2 ∂2 − (A/2) ∂_A of ⟨τ₁²⟩ is zero, within the errors.

    Polynomials are kept, so that it is not so in one truncation by construction.
    """
    values, errors = orientation_gradient(BasicFibre(model_of(NUMBERS)))
    weights = np.array([-0.5, 0.0, 1.0, 1.0, 1.0]) * NUMBERS
    total = np.tensordot(weights, values, axes=1)
    assert (np.abs(total) <= np.tensordot(np.abs(weights), errors, axes=1)).all()
    assert np.abs(total).max() < 1e-10 < 1e-5 < np.abs(values[:4]).min(axis=0)[0, 0]
    # ⟨τ₁²⟩ + ⟨τ₂²⟩ = 1 whatever the parameters.
    assert (values[:, 0, 0] == -values[:, 1, 1]).all()


@pytest.mark.parametrize(
    ("positions", "spacing"),
    [("regular", 0.3), pytest.param("random", 1.5, marks=pytest.mark.nightly)],
)
def test_cv_goes_with_the_root_of_the_spacing(positions, spacing, few_nodes):
    """Of regular positions without strips, of random ones always: ∂CV = CV/(2 d)."""
    numbers = [*NUMBERS[:4], spacing]
    found = predicted(numbers, [0.5, 3.0], positions=positions, tolerance=0.5,
                      gradients=True)  # fmt: skip
    # Within rounding of derivatives of φ, 1e-13.
    assert found.gradient[4] == pytest.approx(found.cv / (2 * spacing), rel=1e-11)
    assert found.strip_gradient.shape == (5, 0 if positions == "random" else 3)
    assert found.mean_gradient == pytest.approx(
        [0.0, -found.mean / 0.2, 0.0, 0.0, -found.mean / spacing], rel=1e-14
    )


def test_a_process_has_the_gradient_of_its_own_numbers(few_nodes):
    """In metres σ1 ∂1 + σ2 ∂2 + d ∂d − (A/2) ∂_A is what it is without a unit."""
    process = fp.Process(4e-3, 3e-3, 30.0, 0.2, 20.0)
    options = {"tolerance": 0.5, "gradients": True}
    found = fp.predict_web(
        process, spacing=6e-3, zones=8e-3, bands=[(2e-3, 1e-2)], **options
    )
    plain = fp.predict_web(
        process.model, spacing=1.5, zones=2.0, bands=[(0.5, 2.5)], **options
    )
    assert found.parameters == ("noise", "speed_ratio", "sigma1", "sigma2", "spacing")
    in_metres = np.array([30.0, 0.2, 4e-3, 3e-3, 6e-3])
    in_units = np.array([process.model.noise, 0.2, 1.0, 0.75, 1.5])
    for name in (
        "gradient",
        "gradient_errors",
        "strip_gradient",
        "cloudiness_gradient",
    ):
        elasticities = in_metres[:, None] * getattr(found, name)
        assert elasticities == pytest.approx(
            in_units[:, None] * getattr(plain, name), rel=1e-9
        )
    assert found.mean_gradient[1] == pytest.approx(-found.mean / 0.2)
    assert in_metres * found.machine_cross_gradient == pytest.approx(
        in_units * plain.machine_cross_gradient, rel=1e-9
    )


def test_strips_of_a_slow_belt_change_as_those_of_a_gaussian():
    """2 e^{−2π²j²σ2²/d²}: −4π²j²σ2/d² in σ2, 4π²j²σ2²/d³ in d, relative to it."""
    model = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.8), 2.0, fp.MovingBelt(1e-6))
    spacing, j = 3.0, np.arange(1, 4)
    values, errors = strip_gradient(BasicFibre(model), spacing, 3)
    amplitude = 2 * np.exp(-2 * (math.pi * j * 0.8 / spacing) ** 2)
    expected = np.zeros((5, 3))
    expected[3] = -4 * (math.pi * j) ** 2 * 0.8 / spacing**2 * amplitude
    expected[4] = 4 * (math.pi * j * 0.8) ** 2 / spacing**3 * amplitude
    # The belt changes the law by O(v²), its derivative in v by O(v).
    assert values == pytest.approx(expected, abs=2e-5)
    others = [0, 2, 3, 4]
    away = np.abs(values - expected)[others]
    assert (away <= errors[others] + 1e-10).all()


@pytest.mark.nightly
def test_gradients_are_stored_and_files_without_them_read(web, tmp_path):
    web.save(tmp_path / "web.nc")
    back = fp.load(tmp_path / "web.nc")
    assert back.parameters == web.parameters
    assert fp.compare(web, back).equal
    for name in ("gradient", "gradient_errors", "strip_gradient"):
        assert (getattr(back, name) == getattr(web, name)).all()
    kinds = [
        "gradient",
        "strip_gradient",
        "cloudiness_gradient",
        "orientation_gradient",
    ]
    names = [*kinds, *(f"{kind}_error" for kind in kinds)]
    older = from_xarray(web.to_xarray().drop_vars([*names, "parameter"]))
    assert older.parameters == ()
    assert older.gradient is None
    assert older.machine_cross_gradient is None
    assert older.machine_cross_gradient_errors is None
    wrong = web.to_xarray().assign_coords(parameter=np.arange(5.0))
    with pytest.raises(ValueError, match="`parameter` must hold names"):
        from_xarray(wrong)


@pytest.mark.nightly
def test_a_page_shows_every_derivative_with_its_error(web, monkeypatch):
    monkeypatch.setattr(predicted_web, "drawings", lambda _: [])
    tables = [
        block
        for part in predicted_web.section(web, "web.nc").parts
        for block in part.blocks
        if getattr(block, "caption", "").startswith("Derivatives of")
    ]
    table, of_others = tables
    assert of_others.rows[0][-1] == (
        f"{web.machine_cross_gradient[0]:.4g} ± "
        f"{web.machine_cross_gradient_errors[0]:.1g}"
    )
    assert [row[0] for row in table.rows] == list(web.parameters)
    assert table.rows[1][2] == (
        f"{web.gradient[1, 1]:.4g} ± {web.gradient_errors[1, 1]:.1g}"
    )


@pytest.mark.nightly
def test_gradients_change_nothing_else(web):
    plain = predicted(NUMBERS, SIDES, tolerance=0.05)
    for name in ("cv", "errors", "strips", "strip_errors", "orientation"):
        assert (getattr(plain, name) == getattr(web, name)).all()
    assert plain.parameters == ()
    assert plain.gradient is None
    assert plain.mean_gradient is None


@pytest.mark.nightly
def test_central_differences_agree_within_the_errors(web):
    """In the noise and in σ2; the step costs h²/6 of the third derivative."""
    for parameter, h in ((0, 0.1), (3, 0.04)):
        there, back = (
            predicted(NUMBERS + sign * h * np.eye(5)[parameter], SIDES[MIDDLE],
                      tolerance=0.02)
            for sign in (1, -1)
        )  # fmt: skip
        difference = (there.cv - back.cv) / (2 * h)
        away = np.abs(difference - web.gradient[parameter, MIDDLE])
        # Errors of the spectrum are alike on both sides, and do not count by 1/h.
        assert (away <= web.gradient_errors[parameter, MIDDLE]).all()
        assert (away <= 0.03 * np.abs(difference)).all()


@pytest.mark.nightly
def test_errors_cover_the_distance_to_finer_predictions(web):
    finer = predicted(NUMBERS, SIDES[MIDDLE], tolerance=2e-3, gradients=True)
    away = np.abs(finer.gradient - web.gradient[:, MIDDLE])
    assert (away <= finer.gradient_errors + web.gradient_errors[:, MIDDLE]).all()


@pytest.mark.nightly
def test_small_zones_know_the_mean_only():
    """CV² → 0.946402 v d/x: ∂ log CV is 1/2 in v and in d, and nothing in the others.

    Isotropic and slow, so that the angle has no direction; O(x) is left.
    """
    numbers = np.array([1.0, 0.05, 1.0, 1.0, 0.2])
    found = predicted(numbers, 0.01, tolerance=0.05, gradients=True)
    elasticities = numbers * found.gradient[:, 0] / found.cv[0]
    errors = numbers * found.gradient_errors[:, 0] / found.cv[0]
    away = np.abs(elasticities - [0.0, 0.5, 0.0, 0.0, 0.5])
    assert (away <= errors + 0.01).all()
    assert (errors <= 0.1).all()


@pytest.mark.nightly
def test_differences_of_a_process_agree_in_its_own_units():
    options = {"zones": [2e-3, 8e-3], "tolerance": 0.1}

    def of(noise=25.0, sigma1=4e-3, spacing=6e-3, **more):
        process = fp.Process(sigma1, 3e-3, noise, 0.2, 20.0)
        return fp.predict_web(process, spacing=spacing, **options, **more)

    found = of(gradients=True)
    for place, name, value, h in (
        (0, "noise", 25.0, 1.0), (2, "sigma1", 4e-3, 1e-4), (4, "spacing", 6e-3, 1e-4)
    ):  # fmt: skip
        there, back = (of(**{name: value + step}) for step in (h, -h))
        away = np.abs((there.cv - back.cv) / (2 * h) - found.gradient[place])
        assert (away <= found.gradient_errors[place]).all()


def test_gradients_under_another_potential_are_refused():
    model = fp.LayDownModel(fp.PowerPotential(4), 2.0, fp.MovingBelt(0.2))
    with pytest.raises(ValueError, match="`gradients` are those of a model with a qua"):
        fp.predict_web(model, spacing=1.0, zones=1.0, gradients=True)
