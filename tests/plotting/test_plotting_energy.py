"""Figures of the energy process show the curves that their axes name."""

import numpy as np
import pytest
from energy_processes import PROCESSES

from fpsolve import plotting
from fpsolve.plotting.style import COLOURS

PROCESS = PROCESSES["linear"]


@pytest.fixture(scope="module")
def solution():
    return PROCESS.solve(
        0.3, (0.0, 4.0), 0.05, grid=PROCESS.grid(40, signed=True),
        save_at=0.5 * np.arange(9),
    )  # fmt: skip


def labels(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


@pytest.mark.parametrize("name", ["linear", "quartic, scaled", "heavy", "flat"])
def test_orbits_are_level_sets_of_the_energy_around_the_fixed_point(name):
    process = PROCESSES[name]
    figure = plotting.plot_orbits(process)
    orbits, fibres, bar = figure.axes
    *curves, point = orbits.lines
    assert point.get_xydata().tolist() == [[process.radius, np.pi / 2]]
    shares = []
    for curve in curves:
        r, beta = curve.get_data()
        energy = r * np.exp(-process.potential.radial_value(r)) * np.sin(beta)
        shares.append(energy[0] / process.g_max)
        np.testing.assert_allclose(energy, energy[0], rtol=1e-9)
        # Closed, around the fixed point, on both sides of it.
        assert beta[0] == pytest.approx(beta[-1], abs=1e-5)
        assert r.min() < process.radius < r.max()
        assert beta.min() < np.pi / 2 < beta.max()
        assert beta.min() + beta.max() == pytest.approx(np.pi, rel=1e-9)
    assert np.all(np.diff(shares) > 0)
    np.testing.assert_allclose(shares, bar.get_yticks(), rtol=1e-9)
    assert (orbits.get_xlabel(), orbits.get_ylabel()) == (
        "distance $r$", r"angle to the radius $\beta$"
    )  # fmt: skip
    assert labels(fibres) == [
        rf"$G = {x}\,g_{{\max}}$" for x in ("0.02", "0.25", "0.85")
    ]
    for line, share in zip(fibres.lines, (0.02, 0.25, 0.85), strict=False):
        distance = np.hypot(*line.get_data())
        r_min, r_max = process.turning_points(share * process.g_max)
        assert distance.min() == pytest.approx(float(r_min), rel=1e-9)
        assert distance.max() == pytest.approx(float(r_max), rel=1e-2)


def test_coefficients_are_drawn_where_they_are_finite():
    figure = plotting.plot_energy_coefficients(PROCESS)
    period, variance, density = figure.axes
    g, values = period.lines[0].get_data()
    np.testing.assert_array_equal(values, PROCESS.period(g))
    assert np.isfinite(values).all()
    g, values = density.lines[0].get_data()
    np.testing.assert_array_equal(values, PROCESS.stationary_density(g))
    bound, curve = variance.lines
    g, values = curve.get_data()
    np.testing.assert_array_equal(values, PROCESS.variance(g))
    assert np.all(values <= bound.get_ydata())
    assert labels(variance) == [r"$A^2(g_{\max}^2 - g^2)$", r"$\sigma^2(g)$"]
    assert "$A = 1.3$" in figure.get_suptitle()
    assert r"$g_{\max} = 0.3679$" in figure.get_suptitle()


def test_the_law_is_drawn_at_six_arclengths_beside_the_stationary_one(solution):
    figure = plotting.plot_energy_law(solution)
    law, entropy = figure.axes
    shown = labels(law)
    assert len(shown) == 7
    assert shown[0] == "$s = 0$"
    assert shown[-2:] == ["$s = 4$", "stationary"]
    steps = law.patches[5].get_data()
    np.testing.assert_array_equal(steps.values, solution.density(4.0))
    np.testing.assert_array_equal(steps.edges, solution.grid.faces)
    assert law.get_xlim() == (-PROCESS.g_max, PROCESS.g_max)
    # The spike at the start does not set the scale.
    assert law.get_ylim()[1] < solution.density(0.0).max() / 2
    s, values = entropy.lines[0].get_data()
    np.testing.assert_array_equal(values, solution.relative_entropy)
    np.testing.assert_array_equal(s, solution.s)
    assert entropy.get_yscale() == "log"


def test_one_saved_law_is_enough():
    solution = PROCESS.solve(0.1, (0.0, 1.0), 0.5, grid=PROCESS.grid(20))
    figure = plotting.plot_energy_law(solution)
    assert labels(figure.axes[0]) == ["$s = 1$", "stationary"]
    assert figure.axes[0].get_xlim() == (0.0, PROCESS.g_max)


def test_eigenfunctions_of_both_families_carry_their_rates():
    figure = plotting.plot_energy_eigenfunctions(PROCESS, 3)
    for axes, family in zip(figure.axes, ("even", "odd"), strict=True):
        found = PROCESS.spectrum(3, family)
        assert labels(axes) == [rf"$\lambda = {x:.4g}$" for x in found.eigenvalues]
        for index in range(3):
            g, values = axes.lines[index].get_data()
            np.testing.assert_allclose(
                values, found.eigenfunction(index, g), atol=1e-12
            )
        assert axes.lines[0].get_color() == COLOURS["blue"]
    for n in (0, 7):
        with pytest.raises(ValueError, match=f"`n` must be from 1 to 6, got {n}"):
            plotting.plot_energy_eigenfunctions(PROCESS, n)


def test_figures_are_rendered_whole(tmp_path, solution):
    figures = [plotting.plot_orbits(PROCESS), plotting.plot_energy_law(solution)]
    for index, figure in enumerate(figures):
        path = tmp_path / f"{index}.png"
        figure.savefig(path)
        assert path.stat().st_size > 10_000
