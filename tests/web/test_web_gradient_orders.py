"""Gradients of predicted webs: known spectra, and differences of one truncation."""

import math
from functools import cached_property
from itertools import pairwise

import numpy as np
import pytest
from scipy.special import erf
from web_numbers import NUMBERS, choose_few_nodes, model_of

from fpsolve.spectral.resolvent import fibre as fibre_module
from fpsolve.spectral.resolvent import fibre_spectrum
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.fibre import BasicFibre
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.web import coherent
from fpsolve.web import zone_variance as zone_module
from fpsolve.web.band_power import band_power
from fpsolve.web.gradient import (
    cloudiness_gradient,
    orientation_gradient,
    square_gradient,
)
from fpsolve.web.table import Source, SpectrumTable
from fpsolve.web.zone_variance import zone_variance


class GaussianSource(Source):
    """Ŝ = A e^{−(k1²σ1² + k2²σ2²)/2} in place of that of a fibre."""

    def __call__(self, k1, k2):
        noise = self.ladder.model.noise
        sigma1, sigma2 = self.ladder.scales
        value = noise * np.exp(-0.5 * ((k1 * sigma1) ** 2 + (k2 * sigma2) ** 2))
        factors = (1.0, 1 / noise, 0.0, -(k1**2) * sigma1, -(k2**2) * sigma2)
        return factors[self.column] * value, np.zeros(k1.shape)


class GaussianTable(SpectrumTable):
    """Its table; κ Ŝ → 0."""

    def _law(self, k1, k2):
        return np.zeros(k1.shape)


def gaussian_variance(side, noise, sigma):
    """∫ sinc²(k x/2) e^{−k²σ²/2} dk/2π of both directions, in closed form."""
    ratio = side / np.asarray(sigma)
    means = (
        erf(ratio / math.sqrt(2))
        + np.expm1(-0.5 * ratio**2) * math.sqrt(2 / math.pi) / ratio
    )
    return noise * np.prod(means / side)


@pytest.mark.parametrize("side", [0.3, 2.0, 10.0])
def test_zones_of_a_gaussian_spectrum_have_their_exact_derivatives(side):
    """Of the variance itself by differences of the closed form, 1e-8 at h = 1e-4."""
    ladder = BasicFibre(model_of(NUMBERS))
    made = SpectrumTable.of(ladder, 1e-3)
    table = GaussianTable(GaussianSource(ladder, 1e-12, True), made.nodes)
    table = table.finer("along").finer("shortness").finer("shortness")
    value, _, error = zone_variance(table, side)
    exact = gaussian_variance(side, 2.0, (1.0, 0.8))
    assert value == pytest.approx(exact, rel=2e-4)
    values, errors = square_gradient(table, 0.1, side, "regular", (value, error))
    speed, spacing, h = 0.2, 0.1, 1e-4
    expected = [speed * spacing * exact / 2.0, spacing * exact]
    for change in ((h, 0.0), (0.0, h)):
        there, back = (
            gaussian_variance(side, 2.0, np.array([1.0, 0.8]) + sign * np.array(change))
            for sign in (1, -1)
        )
        expected.append(speed * spacing * (there - back) / (2 * h))
    expected.append(speed * exact)
    # Of Ŝ some per cent lie outside, where polynomials of 1/κ converge slowly.
    away = np.abs(values - expected)
    assert (away <= errors + 1e-9).all()
    assert (away <= 2e-3 * np.abs(expected)).all()


class Changed(Generator):
    """L of other numbers in the basis of the model: exactly, in every truncation."""

    numbers = NUMBERS

    @property
    def speed(self):
        return self.numbers[1]

    @cached_property
    def matrix(self):
        """L is linear in D and in 1/σ_i²; v it has from `speed`."""
        there, here = self.numbers, NUMBERS
        squares = (here / there) ** 2 - 1.0
        factors = (
            0.5 * (there[0] ** 2 - here[0] ** 2) / here[0],
            0.0,
            -0.5 * here[2] * squares[2],
            -0.5 * here[3] * squares[3],
        )
        changes = zip(factors, self.derivatives, strict=True)
        return super().matrix + sum(factor * change for factor, change in changes)


class Kept(BasicFibre):
    """One truncation of each kind, whose polynomials do not move with the numbers."""

    numbers = NUMBERS

    def generator(self, basis):
        if basis not in self._kept:
            found = Changed(self.model, basis, self.centre)
            found.__dict__["numbers"] = self.numbers
            self._kept[basis] = found
        return self._kept[basis]

    def climb(self, first, compute, allowed, level=0, most=None, unseen=None):
        found = compute(self.generator(first))
        return found, np.zeros_like(found), level


@pytest.mark.parametrize(
    "positions", ["regular", pytest.param("random", marks=pytest.mark.nightly)]
)
def test_differences_converge_with_order_two_at_every_halving(monkeypatch, positions):
    """CV², cloudiness and ⟨τ₁²⟩ of the same nodes and truncations, in five parameters.

    Small truncations do, since their derivatives are exact, too.
    """
    choose_few_nodes(monkeypatch)
    monkeypatch.setattr(fibre_spectrum, "FIRST_LONG", Basis(6, 4))
    for name, number in (("DEGREE", 4), ("HARMONICS", 4), ("PER_ROOT", 0.0)):
        monkeypatch.setattr(fibre_spectrum, name, number)
    monkeypatch.setattr(fibre_module, "ANGLE", Basis(6, 4))
    # Without errors, and not as far as they are small.
    for name, number in (("AXES", ()), ("FAR_PERIODS", 20.0), ("FAR_SCALES", 10.0)):
        monkeypatch.setattr(zone_module, name, number)
    monkeypatch.setattr(fibre_module, "FINE", Basis(8, 5))
    monkeypatch.setattr(fibre_module, "COARSE", Basis(6, 4))
    side, band, model = 0.7, (0.5, 3.0), model_of(NUMBERS)
    of_positions = getattr(coherent, f"{positions}_positions")

    def square(numbers, gradients=False):
        ladder = Kept(model)
        ladder.numbers = numbers
        table = SpectrumTable(Source(ladder, 0.1, gradients), nodes)
        value, power = zone_variance(table, side)[0], band_power(table, *band[::-1])[0]
        per_line = numbers[1] * numbers[4]
        added = of_positions(ladder, numbers[4], side)[0]
        along = coherent.orientation(ladder)[0][0, 0]
        return (
            table,
            value,
            np.array([per_line * value + added, per_line * power, along]),
        )

    nodes = SpectrumTable.of(BasicFibre(model), 0.1).nodes
    table, value, _ = square(NUMBERS, gradients=True)
    squares, _ = square_gradient(table, NUMBERS[4], side, positions, (value, 0.0))
    powers, _ = cloudiness_gradient(table, NUMBERS[4], np.array([band]))
    tensor, _ = orientation_gradient(table.source.ladder)
    exact = np.stack([squares, powers[:, 0], tensor[:, 0, 0]], axis=1)
    for parameter in range(5):
        errors = []
        for share in (0.08, 0.04, 0.02):
            step = share * NUMBERS * np.eye(5)[parameter]
            there, back = (square(NUMBERS + sign * step)[2] for sign in (1, -1))
            errors.append(np.abs((there - back) / (2 * step.sum()) - exact[parameter]))
        # Of CV² = 0.3, cloudiness 1.1 and ⟨τ₁²⟩ = 0.51.
        assert (errors[2] < 3e-3).all()
        # Linear in d or no function of it, the other two differ by rounding; cloudiness
        # is nearly linear in v.
        curved = errors[0] > 1e-10
        assert curved.tolist() == (
            [positions == "regular", False, False] if parameter == 4 else [True] * 3
        )
        for coarse, fine in pairwise(errors):
            rates = np.log2(coarse[curved] / fine[curved])
            assert rates == pytest.approx(2, abs=0.1)
