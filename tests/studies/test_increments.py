"""Increments of angle and curvature, and the functional (24), where they are known."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.studies import functional, increment_curves
from fpsolve.studies.identification.increments import lags_up_to

BELT = fp.MovingBelt(0.1)


def circle(n, radius=2.0, ds=0.1):
    angle = ds * np.arange(n) / radius
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def test_increments_of_a_straight_fibre_are_zero():
    s = 0.1 * np.arange(400)
    line = fp.FibreCurve(np.stack([0.6 * s, 0.8 * s], axis=-1), 0.1, fp.MovingBelt(0.0))
    curves = increment_curves(line, 20)
    # Rounding of an angle, 1e-15 of numbers of size 40 apart by 0.1.
    np.testing.assert_allclose(curves.angle, 0.0, atol=1e-11)
    np.testing.assert_allclose(curves.curvature, 0.0, atol=1e-9)


def test_increments_of_a_circle_are_those_of_its_curvature():
    fibre = fp.FibreCurve(circle(2000), 0.1, fp.FixedBelt())
    curves = increment_curves(fibre, 100)
    # α(s + h) − α(s) = h/r exactly.
    np.testing.assert_allclose(curves.angle, np.sqrt(curves.h) / 2.0, rtol=1e-10)
    np.testing.assert_allclose(curves.curvature, 0.0, atol=1e-8)
    found = functional(fibre, 100)
    assert found["noise"] == pytest.approx(np.sqrt(10.0) / 2.0, rel=1e-10)
    # ⟨ξ₁²⟩ over 15.9 turns is r²/2 up to a part of one turn.
    assert found["sigma1"] == pytest.approx(np.sqrt(2.0), rel=0.02)


def increments_of_chords(k, ds):
    """Γ_α² and Γ_κ² at h = kΔs of chords of smooth fibres with B = 0, R = K = 1.

    E(α(h) − α(0))² = h − (1 − e⁻ʰ). The angle of a chord is the mean of α over it, up
    to its square, so that differences see this under the triangle of width 2Δs.
    """
    x, weights = np.polynomial.legendre.leggauss(12)
    u = np.concatenate([(x - 1) / 2, (x + 1) / 2])
    weights = np.concatenate([weights, weights]) / 2 * (1 - np.abs(u))

    def smoothed(k):
        h = np.abs(k[:, None] + u) * ds
        return (h + np.expm1(-h)) @ weights

    def of_angle(k):
        return smoothed(k) - smoothed(np.zeros(1))

    second = of_angle(k + 1) + of_angle(k - 1) - 2 * of_angle(k)
    of_curvature = (2 * of_angle(np.ones(1)) - second) / ds**2
    return of_angle(k) / (k * ds), of_curvature / (k * ds)


def test_increments_without_force_are_those_of_the_closed_form():
    ds = 0.05
    model = fp.SmoothLayDownModel(fp.FreePotential(), 1.0, 1.0)
    paths = fp.sample_paths(
        model, 40, 60.0, ds / 4, seed=1, save_at=ds * np.arange(1201)
    )
    each = [
        increment_curves(fp.FibreCurve(piece, ds, fp.FixedBelt()), 60)
        for piece in fp.FibreCurve.from_paths(paths).pieces
    ]
    h = each[0].h
    angle, curvature = increments_of_chords(h / ds, ds)
    # The law of (22) itself, which chords of h ≫ Δs have: Γ² = 1 − (1 − e⁻ʰ)/h and
    # (1 − e⁻ʰ)/h. Chords average κ over 2Δs, which takes half of it off its memory.
    memory = -np.expm1(-h) / h
    assert np.abs(angle - (1 - memory)).max() < 1e-3
    assert np.all(np.abs(curvature / memory - 1) < 0.5 * ds / h + 0.5 * ds)
    for name, exact in (("angle", angle), ("curvature", curvature)):
        squares = np.array([getattr(one, name) ** 2 for one in each])
        error = squares.std(axis=0, ddof=1) / np.sqrt(len(each))
        # Four standard errors for all lags, which depend on each other.
        assert np.abs((squares.mean(axis=0) - exact) / error).max() < 4.0


def test_lags_are_all_near_and_thinned_out_beyond():
    np.testing.assert_array_equal(lags_up_to(10), np.arange(1, 11))
    lags = lags_up_to(500)
    assert lags[-1] == 500
    assert len(lags) <= 48
    assert np.all(np.diff(lags) > 0)


def test_the_third_component_grows_with_k_max_where_a_fibre_circles():
    fibre = fp.FibreCurve(circle(4000), 0.1, fp.FixedBelt())
    assert functional(fibre, 200)["noise"] > 1.9 * functional(fibre, 50)["noise"]


@pytest.mark.parametrize(
    ("k_max", "said"),
    [
        (0, "`k_max` must be at least 1, got 0"),
        (41, "a tenth of the points of the shortest fibre, 40, got 41"),
    ],
)
def test_lags_that_a_fibre_has_not_are_refused(k_max, said):
    with pytest.raises(ValueError, match=said):
        increment_curves(fp.FibreCurve(circle(400), 0.1, BELT), k_max)
