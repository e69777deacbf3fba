"""Gradients of predicted webs of smooth fibres: orders, dimensions, differences."""

from dataclasses import replace

import numpy as np
import pytest
from web_numbers import choose_few_nodes, choose_one_truncation

import fpsolve as fp
from fpsolve.spectral.resolvent import smooth_ladder, smooth_solutions
from fpsolve.spectral.resolvent import smooth_spectrum as spectrum_module
from fpsolve.spectral.resolvent.fibre import SmoothFibre
from fpsolve.spectral.resolvent.smooth_basis import SmoothBasis
from fpsolve.web import coherent
from fpsolve.web import zone_variance as zone_module
from fpsolve.web.gradient import orientation_gradient, square_gradient
from fpsolve.web.table import AXES, N_NODES, Source, SpectrumTable
from fpsolve.web.zone_variance import zone_variance

# Noise, belt speed, σ1, σ2, R, spacing.
NUMBERS = np.array([3.0, 0.2, 1.0, 0.8, 0.3, 1.5])
NAMES = ("noise", "belt_speed", "sigma1", "sigma2", "relaxation_length", "spacing")


def model_of(numbers):
    noise, speed, sigma1, sigma2, length = numbers[:5]
    potential = fp.QuadraticPotential(sigma1, sigma2)
    return fp.SmoothLayDownModel(potential, length, noise, fp.MovingBelt(speed))


class Kept(SmoothFibre):
    """The smallest truncations alone, with Gaussians that do not move."""

    # Of the nodes of a table, which do not move, either.
    scales = NUMBERS[2], NUMBERS[3]

    def basis(self, degree, harmonics):
        return SmoothBasis(degree, harmonics, degree)

    def climb(self, first, compute, allowed, level=0, most=None):
        found = compute(self.generator(first))
        return found, np.zeros_like(found), 0


def kept(numbers, like):
    """The fibre of other numbers in the basis, and between the scales, of a fibre."""
    fibre = Kept(model_of(numbers))
    fibre.placement, fibre.spreads = like.placement, like.spreads
    return fibre


@pytest.mark.parametrize(
    "parameter",
    [4, *(pytest.param(one, marks=pytest.mark.nightly) for one in (0, 1, 2, 3, 5))],
)
def test_differences_converge_with_order_two_at_every_halving(monkeypatch, parameter):
    """CV² and ⟨τ₁²⟩ of the same nodes and truncations."""
    choose_few_nodes(monkeypatch)
    monkeypatch.setattr(smooth_ladder, "DEGREE", 3)
    monkeypatch.setattr(smooth_ladder, "HARMONICS", 2)
    monkeypatch.setattr(spectrum_module, "PER_ROOT", 0.0)
    # Where arcs begin moves with R and A, which no derivative knows.
    monkeypatch.setattr(spectrum_module, "far_of", lambda _: 20.0)
    monkeypatch.setattr(spectrum_module, "first_of", lambda ladder, _: ladder.first)
    monkeypatch.setattr(smooth_solutions.ByDegree.solve, "__defaults__", ("N", 1e-11))
    for name, number in (("AXES", ()), ("FAR_PERIODS", 20.0), ("FAR_SCALES", 10.0)):
        monkeypatch.setattr(zone_module, name, number)
    like, side = SmoothFibre(model_of(NUMBERS)), 0.7
    nodes = SpectrumTable.of(like, 0.1).nodes

    def square(numbers, gradients=False):
        fibre = kept(numbers, like)
        table = SpectrumTable(Source(fibre, 1e9, gradients), nodes)
        value = zone_variance(table, side)[0]
        added = coherent.regular_positions(fibre, numbers[5], side)[0]
        along = coherent.orientation(fibre)[0][0, 0]
        return table, value, np.array([numbers[1] * numbers[5] * value + added, along])

    table, value, _ = square(NUMBERS, gradients=True)
    squares, _ = square_gradient(table, NUMBERS[5], side, "regular", (value, 0.0))
    tensor, _ = orientation_gradient(table.source.ladder)
    exact = np.array([squares[parameter], tensor[parameter, 0, 0]])
    errors = []
    for share in (0.02, 0.01, 0.005):
        step = share * NUMBERS * np.eye(6)[parameter]
        there, back = (square(NUMBERS + sign * step)[2] for sign in (1, -1))
        errors.append(np.abs((there - back) / (2 * step.sum()) - exact))
    # ⟨τ₁²⟩ is no function of d.
    away = np.array(errors)[:, : 1 if parameter == 5 else 2]
    rates = np.log2(away[:-1] / away[1:])
    assert rates == pytest.approx(2, abs=0.1)
    assert (errors[-1] < 2e-3).all()


@pytest.mark.nightly
def test_gradients_fulfil_the_law_of_dimensions_and_differences(monkeypatch):
    """σ1 ∂1 + σ2 ∂2 + R ∂_R + d ∂d + x ∂x − (A/2) ∂_A of CV is zero.

    Nodes do not move with σ_i: 5 on an axis leave 4 % of it, 7 leave 0.6 %.
    """
    choose_one_truncation(monkeypatch)
    for axis in AXES:
        monkeypatch.setitem(N_NODES, axis, 7)
    h, sides = 0.01, np.array([0.99, 1.0, 1.01])

    def predicted(numbers, **options):
        return fp.predict_web(
            model_of(numbers), spacing=numbers[5], zones=sides, tolerance=0.5, **options
        )

    web = predicted(NUMBERS, gradients=True)
    assert web.parameters == NAMES
    weights = np.array([-0.5, 0.0, 1.0, 1.0, 1.0, 1.0]) * NUMBERS
    total = weights @ web.gradient[:, 1] + (web.cv[2] - web.cv[0]) / (2 * h)
    size = np.abs(weights) @ np.abs(web.gradient[:, 1])
    errors = np.abs(weights) @ web.gradient_errors[:, 1]
    assert abs(total) <= min(errors, 0.01 * size)
    for place, share in ((0, 0.02), (4, 0.02)):
        step = share * NUMBERS * np.eye(6)[place]
        there, back = (predicted(NUMBERS + sign * step).cv[1] for sign in (1, -1))
        away = abs((there - back) / (2 * step.sum()) - web.gradient[place, 1])
        # The Gaussians of the basis move between both, and a truncation notices.
        assert away <= web.gradient_errors[place, 1]
        assert away * NUMBERS[place] <= 0.01 * size


@pytest.mark.nightly
def test_a_process_with_a_relaxation_length_has_its_derivative_in_metres(monkeypatch):
    choose_few_nodes(monkeypatch)
    choose_one_truncation(monkeypatch)
    process = fp.Process(4e-3, 4e-3, 45.0, 0.2, 20.0, 1e-3)
    options = {"tolerance": 0.5, "gradients": True}
    found = fp.predict_web(process, spacing=6e-3, zones=8e-3, **options)
    plain = fp.predict_web(process.model, spacing=1.5, zones=2.0, **options)
    assert found.parameters == ("noise", "speed_ratio", *NAMES[2:])
    for name, one in (("relaxation_length", 4e-3), ("noise", 4e-3**-0.5)):
        place = found.parameters.index(name)
        assert found.gradient[place] * one == pytest.approx(
            plain.gradient[place], rel=1e-9
        )
    slower = replace(process, relaxation_length=1.02e-3)
    quicker = replace(process, relaxation_length=0.98e-3)
    there, back = (
        fp.predict_web(one, spacing=6e-3, zones=8e-3, tolerance=0.5).cv[0]
        for one in (slower, quicker)
    )
    away = abs((there - back) / 4e-5 - found.gradient[4, 0])
    assert away <= found.gradient_errors[4, 0]
