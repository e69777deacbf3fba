"""Gradients of predicted webs: exact laws, differences, units, files."""

import math
from functools import cached_property
from itertools import pairwise

import numpy as np
import pytest
from scipy.special import erf

import fpsolve as fp
from fpsolve.pages import predicted_web
from fpsolve.results.kinds import from_xarray
from fpsolve.spectral.resolvent import fibre_spectrum
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.generator import Generator
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.web import coherent, gradient
from fpsolve.web import table as table_module
from fpsolve.web import zone_variance as zone_module
from fpsolve.web.gradient import square_gradient, strip_gradient
from fpsolve.web.table import N_NODES, Source, SpectrumTable
from fpsolve.web.zone_variance import zone_variance

# Noise, belt speed, σ1, σ2, spacing.
NUMBERS = np.array([2.0, 0.2, 1.0, 0.8, 1.5])
# Sides in triples, for differences in the side.
H = 0.01
SIDES = np.outer([0.3, 4.0], [1 - H, 1.0, 1 + H]).ravel()
MIDDLE = slice(1, None, 3)


def model_of(numbers):
    noise, speed, sigma1, sigma2 = numbers[:4]
    potential = fp.QuadraticPotential(sigma1, sigma2)
    return fp.LayDownModel(potential, noise, fp.MovingBelt(speed))


def predicted(numbers, zones, **options):
    return fp.predict_web(model_of(numbers), spacing=numbers[4], zones=zones, **options)


@pytest.fixture(scope="module")
def web():
    return predicted(NUMBERS, SIDES, tolerance=0.05, gradients=True)


@pytest.fixture
def few_nodes(monkeypatch):
    """For laws that hold between any nodes."""
    for axis, n in (("along", 3), ("across", 5), ("shortness", 3), ("direction", 3)):
        monkeypatch.setitem(N_NODES, axis, n)


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
    ladder = Ladder(model_of(NUMBERS))
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


class Kept(Ladder):
    """One truncation of each kind, whose polynomials do not move with the numbers."""

    numbers = NUMBERS

    def generator(self, basis):
        if basis not in self._kept:
            found = Changed(self.model, basis, self.centre)
            found.__dict__["numbers"] = self.numbers
            self._kept[basis] = found
        return self._kept[basis]

    def climb(self, first, compute, allowed, level=0, most=None):
        found = compute(self.generator(first))
        return found, np.zeros_like(found), level


@pytest.mark.parametrize(
    "positions", ["regular", pytest.param("random", marks=pytest.mark.nightly)]
)
def test_differences_converge_with_order_two_at_every_halving(
    monkeypatch, few_nodes, positions
):
    """CV² of the same nodes and truncations, in all five parameters.

    Small truncations do, since their derivatives are exact, too.
    """
    monkeypatch.setattr(fibre_spectrum, "FIRST_LONG", Basis(6, 4))
    for name, number in (("DEGREE", 4), ("HARMONICS", 4), ("PER_ROOT", 0.0)):
        monkeypatch.setattr(fibre_spectrum, name, number)
    monkeypatch.setattr(table_module, "LAW", Basis(6, 4))
    # Without errors, and not as far as they are small.
    for name, number in (("AXES", ()), ("FAR_PERIODS", 20.0), ("FAR_SCALES", 10.0)):
        monkeypatch.setattr(zone_module, name, number)
    for module in (coherent, gradient):
        monkeypatch.setattr(module, "FINE", Basis(8, 5))
        monkeypatch.setattr(module, "COARSE", Basis(6, 4))
    side, model = 0.7, model_of(NUMBERS)
    of_positions = getattr(coherent, f"{positions}_positions")

    def square(numbers, gradients=False):
        ladder = Kept(model)
        ladder.numbers = numbers
        table = SpectrumTable(Source(ladder, 0.1, gradients), nodes)
        value = zone_variance(table, side)[0]
        per_line = numbers[1] * numbers[4]
        added = of_positions(ladder, numbers[4], side)[0]
        return table, value, per_line * value + added

    nodes = SpectrumTable.of(Ladder(model), 0.1).nodes
    table, value, _ = square(NUMBERS, gradients=True)
    exact, _ = square_gradient(table, NUMBERS[4], side, positions, (value, 0.0))
    for parameter in range(5):
        errors = []
        for share in (0.08, 0.04, 0.02):
            step = share * NUMBERS * np.eye(5)[parameter]
            there, back = (square(NUMBERS + sign * step)[2] for sign in (1, -1))
            errors.append(abs((there - back) / (2 * step.sum()) - exact[parameter]))
        if parameter == 4 and positions == "random":
            # CV² is linear in it.
            assert max(errors) < 1e-12
            continue
        # Of CV² = 0.3; then it falls by 4.
        assert errors[2] < 1e-3
        for coarse, fine in pairwise(errors):
            assert math.log2(coarse / fine) == pytest.approx(2, abs=0.1)


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
    found = fp.predict_web(process, spacing=6e-3, zones=8e-3, **options)
    plain = fp.predict_web(process.model, spacing=1.5, zones=2.0, **options)
    assert found.parameters == ("noise", "speed_ratio", "sigma1", "sigma2", "spacing")
    in_metres = np.array([30.0, 0.2, 4e-3, 3e-3, 6e-3])
    in_units = np.array([process.model.noise, 0.2, 1.0, 0.75, 1.5])
    for name in ("gradient", "gradient_errors", "strip_gradient"):
        elasticities = in_metres[:, None] * getattr(found, name)
        assert elasticities == pytest.approx(
            in_units[:, None] * getattr(plain, name), rel=1e-9
        )
    assert found.mean_gradient[1] == pytest.approx(-found.mean / 0.2)


def test_strips_of_a_slow_belt_change_as_those_of_a_gaussian():
    """2 e^{−2π²j²σ2²/d²}: −4π²j²σ2/d² in σ2, 4π²j²σ2²/d³ in d, relative to it."""
    model = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.8), 2.0, fp.MovingBelt(1e-6))
    spacing, j = 3.0, np.arange(1, 4)
    values, errors = strip_gradient(Ladder(model), spacing, 3)
    amplitude = 2 * np.exp(-2 * (math.pi * j * 0.8 / spacing) ** 2)
    expected = np.zeros((5, 3))
    expected[3] = -4 * (math.pi * j) ** 2 * 0.8 / spacing**2 * amplitude
    expected[4] = 4 * (math.pi * j * 0.8) ** 2 / spacing**3 * amplitude
    # The belt changes the law by O(v²), its derivative in v by O(v).
    assert values == pytest.approx(expected, abs=2e-5)
    others = [0, 2, 3, 4]
    away = np.abs(values - expected)[others]
    assert (away <= errors[others] + 1e-10).all()


def test_gradients_are_stored_and_files_without_them_read(web, tmp_path):
    web.save(tmp_path / "web.nc")
    back = fp.load(tmp_path / "web.nc")
    assert back.parameters == web.parameters
    assert fp.compare(web, back).equal
    for name in ("gradient", "gradient_errors", "strip_gradient"):
        assert (getattr(back, name) == getattr(web, name)).all()
    names = ["gradient", "gradient_error", "strip_gradient", "strip_gradient_error"]
    older = from_xarray(web.to_xarray().drop_vars([*names, "parameter"]))
    assert older.parameters == ()
    assert older.gradient is None
    wrong = web.to_xarray().assign_coords(parameter=np.arange(5.0))
    with pytest.raises(ValueError, match="`parameter` must hold names"):
        from_xarray(wrong)


def test_a_page_shows_every_derivative_with_its_error(web, monkeypatch):
    monkeypatch.setattr(predicted_web, "drawings", lambda _: [])
    tables = [
        block
        for part in predicted_web.section(web, "web.nc").parts
        for block in part.blocks
        if getattr(block, "caption", "").startswith("Derivatives of CV")
    ]
    (table,) = tables
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
