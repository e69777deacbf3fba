"""Translations of the trigonometric interpolant, and the palindrome made of them."""

import numpy as np
import pytest
from orders import assert_order, measure_order
from problems import DecayingCirculation

import fpsolve as fp
from fpsolve.density.schemes.fourier_translation import (
    FourierTranslation,
    shift_weights,
)
from fpsolve.grids.diagnostics import l1_distance

QUADRATIC = fp.QuadraticPotential()


def model_of(noise=1.0, **more):
    return fp.LayDownModel(potential=QUADRATIC, noise=noise, **more)


def start_on(grid, variance=0.5):
    return fp.initial.gaussian(
        grid, mean=(1.0, 0.3), variance=variance, angle=1.0, concentration=2.0
    )


def wave(grid, modes, shift1=0.0, shift2=0.0):
    """cos of a Fourier mode of the box, every angle shifted by its own amount."""
    m1, m2 = modes
    period = 2 * np.array(grid.half_widths)
    phase1 = 2 * np.pi * m1 * (grid.xi1[:, None, None] - shift1) / period[0]
    phase2 = 2 * np.pi * m2 * (grid.xi2[None, :, None] - shift2) / period[1]
    return np.cos(phase1 + phase2 + 0.3) + 0 * grid.alpha


# Even and odd numbers of cells, columns that are no multiple of four, angles that are
# none of eight.
SHAPES = [(16, 16, 8), (18, 22, 12), (15, 17, 10), (16, 13, 18)]


@pytest.mark.parametrize("shape", SHAPES)
def test_every_resolved_wave_moves_along_its_angle_without_error(shape):
    grid = fp.PhaseSpaceGrid(half_width=(3.0, 4.0), shape=shape)
    belt = model_of(curve=fp.MovingBelt(0.4))
    translate, out = FourierTranslation(belt, grid), np.empty(grid.shape)
    ds = 0.37
    moved = belt.curve.displacement(0.2, 0.2 + ds)
    shift1 = np.cos(grid.alpha) * ds - moved[0]
    shift2 = np.sin(grid.alpha) * ds - moved[1]
    most = [(n - 1) // 2 for n in shape[:2]]
    for modes in [(0, 0), (1, 2), (-3, 5), tuple(most), (most[0], -most[1])]:
        translate(wave(grid, modes), 0.2, ds, out)
        expected = wave(grid, modes, shift1, shift2)
        # n sums of n products, each rounded: a few 1e-15.
        np.testing.assert_allclose(out, expected, rtol=0, atol=2e-14)


@pytest.mark.parametrize("n", [12, 13])
def test_weights_are_the_matrix_of_the_interpolant(n):
    """Against sin nt/2 over n tan t/2, or over n sin t/2 for an odd n."""
    shift = np.array([0.3, -1.7, 2.0])
    parts = shift_weights(shift, n)
    if n % 2 == 0:
        parts = np.concatenate([parts[0] + parts[1], parts[0] - parts[1]])[None]
    half = np.pi / n * (np.arange(n)[:, None] - shift)
    below = np.tan(half) if n % 2 == 0 else np.sin(half)
    with np.errstate(invalid="ignore", divide="ignore"):
        cardinal = np.sin(n * half) / (n * below)
    # At its own node the quotient is 0/0, and one.
    cardinal[np.abs(np.sin(half)) < 1e-12] = 1.0
    # The sine of up to 40, rounded, over the sine of a tenth.
    np.testing.assert_allclose(parts[0], cardinal, rtol=0, atol=1e-14)


@pytest.mark.parametrize("n", [12, 13])
def test_shifts_there_and_back_are_the_identity_but_for_the_unmatched_mode(n):
    grid = fp.PhaseSpaceGrid(half_width=3.0, shape=(n, n, 8))
    translate = FourierTranslation(model_of(), grid)
    p = np.random.default_rng(5).random(grid.shape)
    if n % 2 == 0:
        spectrum = np.fft.fft2(p, axes=(0, 1))
        spectrum[n // 2], spectrum[:, n // 2] = 0.0, 0.0
        p = np.fft.ifft2(spectrum, axes=(0, 1)).real
    there, back = np.empty(grid.shape), np.empty(grid.shape)
    translate(p, 0.0, 0.4, there)
    translate(there, 0.0, -0.4, back)
    np.testing.assert_allclose(back, p, rtol=0, atol=2e-14)


@pytest.mark.parametrize("balanced", [False, True])
@pytest.mark.parametrize("speed", [0.0, 0.3])
@pytest.mark.parametrize("shape", [(20, 20, 12), (21, 18, 10)])
def test_mass_is_kept_to_1e_13(balanced, speed, shape):
    grid = fp.PhaseSpaceGrid(half_width=6.0, shape=shape)
    scheme = fp.drift_kick(
        model_of(curve=fp.MovingBelt(speed)),
        grid,
        translation="fourier",
        balanced=balanced,
    )
    found = fp.solve(
        scheme, start_on(grid), (0.0, 2.0), 0.25, extrapolate=3, negative_tolerance=9.0,
        entropy_tolerance=9.0, circulation_tolerance=9.0, boundary_tolerance=1.0,
    )  # fmt: skip
    assert np.abs(found.mass / found.mass[0] - 1.0).max() < 1e-13


def test_the_equilibrium_stays_to_rounding_in_the_balanced_form():
    grid = fp.PhaseSpaceGrid(half_width=5.0, shape=(20, 21, 12))
    model = model_of()
    scheme = fp.drift_kick(model, grid, translation="fourier", balanced=True)
    p_s = np.broadcast_to(model.equilibrium(*grid.plane())[..., None], grid.shape)
    found = fp.solve(scheme, np.array(p_s), (0.0, 5.0), 0.25)
    # 1e-16 a step, of twenty.
    assert l1_distance(found.final, p_s, grid) < 1e-13


def test_turning_everything_turns_the_solution():
    """The cells are a square: a quarter turn of ξ and α commutes with the flow."""
    grid = fp.PhaseSpaceGrid(half_width=5.0, shape=(20, 20, 16))
    scheme = fp.drift_kick(model_of(), grid, translation="fourier")
    p0 = start_on(grid)

    def turned(p):
        # ξ → (−ξ₂, ξ₁), α → α + π/2, four of sixteen angles.
        return np.roll(np.rot90(p, axes=(0, 1)), 4, axis=2)

    run = {"s_span": (0.0, 1.0), "ds": 0.25}
    one = fp.solve(scheme, p0, **run).final
    other = fp.solve(scheme, turned(p0), **run).final
    # Other sums, in another order.
    np.testing.assert_allclose(other, turned(one), rtol=0, atol=1e-13)


@pytest.mark.parametrize("balanced", [False, True])
def test_the_exact_density_is_met_with_order_two_in_the_step(balanced):
    exact = DecayingCirculation(
        QUADRATIC, 1.0, fp.PhaseSpaceGrid(half_width=6.0, shape=(32, 32, 16))
    )
    scheme = fp.drift_kick(
        exact.model, exact.grid, translation="fourier", balanced=balanced
    )

    def error_of(n_steps):
        found = fp.solve(scheme, exact.initial(), (0.0, 1.0), 1.0 / n_steps,
                         record_every=64)  # fmt: skip
        return l1_distance(found.final, exact.density(1.0), exact.grid)

    # 1.9e-4 measured at sixteen steps.
    assert_order(measure_order(error_of, first=4), 2, 1e-3)


def test_a_belt_is_met_like_by_piecewise_interpolation_of_order_sixteen():
    """A second method: Lagrange interpolation, on twice the cells."""
    belt = model_of(curve=fp.MovingBelt(0.5))
    fine = fp.PhaseSpaceGrid(half_width=6.0, shape=(64, 64, 24))
    coarse = fp.PhaseSpaceGrid(half_width=6.0, shape=(32, 32, 24))
    run = {"s_span": (0.0, 0.5), "ds": 0.125, "record_every": 4}
    one = fp.solve(
        fp.drift_kick(belt, coarse, translation="fourier"), start_on(coarse), **run
    )
    other = fp.solve(
        fp.drift_kick(belt, fine, interpolation_order=16), start_on(fine), **run
    )
    for name in ("mean_xi1", "mean_xi2", "variance_xi1", "mean_cos_alpha"):
        # Both have the same error in ds. Order sixteen leaves 1e-7 on 64 cells.
        difference = one.series[name][-1] - other.series[name][-1]
        assert abs(difference) < 2e-6, name


def test_results_do_not_depend_on_the_number_of_threads(on_threads):
    grid = fp.PhaseSpaceGrid(half_width=6.0, shape=(30, 27, 20))

    def run():
        scheme = fp.drift_kick(model_of(), grid, translation="fourier")
        return fp.solve(scheme, start_on(grid), (0.0, 1.0), 0.25, extrapolate=3)

    one, two = on_threads(1, run), on_threads(2, run)
    np.testing.assert_array_equal(one.final, two.final)
    np.testing.assert_array_equal(one.relative_entropy, two.relative_entropy)


@pytest.mark.parametrize("kind", [np.float32, ">f8", np.float16])
def test_a_start_of_another_kind_of_number_is_that_start_as_doubles(kind):
    grid = fp.PhaseSpaceGrid(half_width=5.0, shape=(16, 16, 8))
    scheme = fp.drift_kick(model_of(), grid, translation="fourier")
    p0 = (1000 * start_on(grid, variance=1.0)).astype(kind)
    run = {"s_span": (0.0, 0.5), "ds": 0.25, "boundary_tolerance": 1.0}
    one, other = (fp.solve(scheme, p, **run) for p in (p0, p0.astype(np.float64)))
    np.testing.assert_array_equal(one.final, other.final)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"translation": "spectral"}, r"`translation` must be .*, got 'spectral'"),
        ({"translation": None}, r"`translation` must be .*, got None"),
        ({"translation": "fourier", "positive": True},
         r"`positive` must be False .* got True: a trigonometric interpolant"),
        ({"translation": "fourier", "interpolation_order": 12},
         r"`interpolation_order` must be left out .*, got 12"),
    ],
)  # fmt: skip
def test_what_does_not_go_together_is_told(options, told):
    grid = fp.PhaseSpaceGrid(half_width=5.0, shape=(16, 16, 8))
    with pytest.raises(ValueError, match=told):
        fp.drift_kick(model_of(), grid, **options)


def test_an_odd_number_of_angles_is_refused_as_before():
    grid = fp.PhaseSpaceGrid(half_width=5.0, shape=(16, 16, 9))
    with pytest.raises(ValueError, match="even number of angles, got 9"):
        fp.drift_kick(model_of(), grid, translation="fourier")


def test_options_name_the_translation_only_where_it_was_chosen():
    """Files and checkpoints of before hold schemes without one."""
    grid = fp.PhaseSpaceGrid(half_width=5.0, shape=(16, 16, 8))
    assert "translation" not in fp.drift_kick(model_of(), grid).options
    scheme = fp.drift_kick(model_of(), grid, translation="fourier")
    again = fp.drift_kick(model_of(), grid, **scheme.options)
    assert again.options == scheme.options
