"""Notes of estimates from points that are too far apart for their errors."""

import math

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.studies.identification.determined import (
    chord_bias,
    coarse_points,
    with_chord_bias,
)
from fpsolve.studies.identification.likelihood_basic import estimate_basic
from fpsolve.studies.identification.likelihood_smooth import estimate_smooth
from fpsolve.studies.identification.synthetic import laid_fibres

BELT = fp.MovingBelt(0.3)
ROUND = fp.QuadraticPotential()


def fibre(model, length, ds, seed, error=0.0):
    n_points = round(length / ds) + 1
    eta = laid_fibres(model, 1, n_points, ds, seed=seed, position_error=error)
    return fp.FibreCurve(eta[0], ds, BELT, position_error=error)


def test_points_too_far_apart_for_the_errors_of_the_noise_are_noted():
    # Turns of (2/3)A²Δs = 0.36, of which 0.7 % are more than half of an error of 0.3 %;
    # of 4000 they are known to 2.4 %, and chords turn by less than mean angles.
    fine = fibre(fp.LayDownModel(ROUND, 3.0, BELT), 240.0, 0.03, 3)
    coarse = fp.FibreCurve(fine.eta[::2], 0.06, BELT)
    covariance = np.diag([0.1, 0.1, 0.003**2])
    (note,) = coarse_points(coarse, covariance)
    square, bias = chord_bias(coarse)
    assert square == pytest.approx(0.36, rel=0.1)
    assert f"turns by κ_rms Δs = {math.sqrt(square):.2g}" in note
    assert f"may change noise by up to {100 * bias:.2g} %" in note
    assert "take points closer together than 0.06" in note
    # The interval holds it: ln A is known to the root of both squares.
    wider = with_chord_bias(coarse, covariance)
    assert wider[2, 2] == pytest.approx(0.003**2 + bias**2, rel=1e-12)
    assert coarse_points(coarse, 9 * covariance) == ()
    # Half of it.
    assert chord_bias(fine)[1] / bias == pytest.approx(0.5, rel=0.1)
    # K = A/R: a variance of the difference of logarithms.
    of_both = np.diag([0.1, 0.1, 0.02**2, 0.02**2])
    of_both[2, 3] = of_both[3, 2] = 0.02**2 - 0.5 * 0.003**2
    (note,) = coarse_points(coarse, of_both)
    assert "may change curvature_noise by up to" in note


def test_estimates_whose_errors_cover_have_no_notes():
    smooth = fp.SmoothLayDownModel(ROUND, 0.5, 1.0, BELT)
    for model, estimate in (
        (smooth.white_noise_limit, estimate_basic),
        (smooth, estimate_smooth),
    ):
        assert estimate(fibre(model, 400.0, 0.2, 5)).notes == ()


def test_errors_of_points_are_no_turns_of_the_fibre():
    model = fp.SmoothLayDownModel(ROUND, 0.5, 1.0, BELT)
    exact, scattered = (
        chord_bias(fibre(model, 400.0, 0.2, 7, error))[1] for error in (0.0, 0.005)
    )
    # 6 (error/Δs)² is a tenth of the turns, and known to the root of 2/2000.
    assert scattered == pytest.approx(exact, rel=0.03)
