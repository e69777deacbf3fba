"""Walls: forces over a hundred decades, held against laws that are exact for them.

For B(r) on a belt at rest p = c e^{−B} [1 + q e^{−A²s/2} G] solves (9) for all s, with
G = e^{−B} (ξ₁ sin α − ξ₂ cos α) over its largest value and |q| <= 1.
"""

import numpy as np
import pytest
from applied_operators import applied, kicked_by_full_matrices

import fpsolve as fp
from fpsolve._kernels import paths as kernels
from fpsolve.density.schemes.rotation import RotationDiffusion
from fpsolve.density.schemes.rotation_table import SAME_STRENGTH, rotation_table

WALL = fp.PowerPotential(60.0)
# A quadratic potential within a wall that begins at r = 2.5.
WALLED = fp.IsotropicPotential(
    lambda r: r**2 / 2 + (r / 2.5) ** 20, lambda r: r + 8 * (r / 2.5) ** 19
)
LOPSIDED = fp.CallablePotential(
    lambda x, y: x**2 / 2 + y**2 + (x / 2) ** 30 / 30 + 0.1 * x * y,
    lambda x, y: (x + (x / 2) ** 29 / 2 + 0.1 * y, 2 * y + 0.1 * x),
)


def circling(grid, potential, q):
    """c e^{−B} [1 + q G], normalised on the grid."""
    xi1, xi2, alpha = grid.mesh()
    value = potential.value(xi1, xi2)
    weight = np.exp(value.min() - value)
    circulation = weight * (xi1 * np.sin(alpha) - xi2 * np.cos(alpha))
    p = weight * (1 + q * circulation / (weight * np.hypot(xi1, xi2)).max())
    return p / (p.sum() * grid.cell_volume)


def second_moment(p, grid):
    xi1, xi2, _ = grid.mesh()
    return float((p * (xi1**2 + xi2**2)).sum() / p.sum())


@pytest.mark.parametrize("balanced", [False, True])
@pytest.mark.parametrize(
    ("potential", "half_width"), [(WALL, 2.5), (WALLED, 8.0), (LOPSIDED, 6.0)]
)
def test_every_cell_is_turned_by_its_own_force(potential, half_width, balanced, rng):
    grid = fp.PhaseSpaceGrid(half_width, (10, 12, 8))
    kick = RotationDiffusion(fp.LayDownModel(potential, 0.7), grid, balanced)
    p = rng.normal(size=grid.shape)
    # Rounding, as in test_operators: there is one matrix for every cell there.
    np.testing.assert_allclose(
        applied(kick, p), kicked_by_full_matrices(kick, p, 0.2), rtol=0, atol=1e-13
    )


CHAIN = 1.0 + 0.9 * SAME_STRENGTH * np.arange(4000)
STRENGTHS = {
    "one": np.array([2.0]),
    "equal": np.full(9, 3.0),
    "none": np.zeros(9),
    "a hundred decades": 10.0 ** np.arange(-50, 52),
    "a chain of neighbours": CHAIN,
    "infinite": np.array([1.0, np.inf, np.inf, 2.0]),
    "the largest": np.array([1e308, 1.7e308, np.finfo(float).max]),
    "no numbers": np.full(6, np.nan),
}  # fmt: skip


@pytest.mark.parametrize("n_alpha", [4, 64])
@pytest.mark.parametrize("name", STRENGTHS)
def test_no_row_is_left_out_of_a_table(name, n_alpha):
    # 64 angles have matrices so large that some tables are interpolated.
    strength = STRENGTHS[name]
    table = rotation_table(strength, 0.5, 0.1, n_alpha, False)
    assert set(table.rows) == set(range(strength.size))
    assert np.all((table.matrix_of >= 0) & (table.matrix_of < table.matrices.shape[1]))


def test_groups_do_not_grow_by_links():
    # Neighbours differ by rounding, the ends by 4e-10: 4000 forces are no single one.
    table = rotation_table(CHAIN, 0.5, 0.1, 4, False)
    assert table.coefficients.shape[1] == 1
    strengths = CHAIN[table.rows.reshape(-1, 4)]
    # A turn by the smallest force of the group: within 1e-13 of each.
    assert np.ptp(strengths, axis=1).max() <= 1.01 * SAME_STRENGTH
    assert 1000 < table.matrices.shape[1] <= 2001


@pytest.mark.parametrize(
    ("name", "scheme", "error"),
    [
        # Measured 0.031; h is interpolated where it is constant but for G.
        ("balanced", {"balanced": True}, 0.05),
        # Measured 0.052 and 0.051: the edge of e^{−B} lies between two cells.
        ("plain", {}, 0.08),
        ("positive", {"positive": True}, 0.08),
    ],
)
def test_a_density_within_walls_keeps_to_the_exact_solution(name, scheme, error):
    potential = fp.PowerPotential(20.0)
    grid, model = fp.PhaseSpaceGrid(1.8, (40, 40, 16)), fp.LayDownModel(potential, 1.0)
    solution = fp.solve(
        fp.drift_kick(model, grid, **scheme), circling(grid, potential, 0.9),
        (0.0, 2.0), 1 / 16, record_every=8,
    )  # fmt: skip
    exact = circling(grid, potential, 0.9 * np.exp(-1.0))
    assert fp.diagnostics.l1_distance(solution.final, exact, grid) < error
    assert second_moment(solution.final, grid) == pytest.approx(
        second_moment(exact, grid), rel=0.02
    )


@pytest.mark.parametrize("half_width", [4.0, 8.0])
def test_a_wall_far_out_does_not_change_the_decay_of_the_circulation(half_width):
    # It did when forces within 1e-13 of the largest counted as one.
    grid = fp.PhaseSpaceGrid(half_width, (int(8 * half_width),) * 2 + (16,))
    p0 = fp.initial.gaussian(grid, (0.8, 0.0), 0.3, angle=np.pi / 2, concentration=2.0)
    scheme = fp.drift_kick(fp.LayDownModel(WALLED, 1.0), grid, positive=True)
    solution = fp.solve(scheme, p0, (0.0, 1.0), 1 / 16)
    # Splitting and interpolation: 4e-4 measured.
    assert np.abs(solution.circulation_deviation).max() < 2e-3
    assert solution.circulation[-1] > 0.15


# The start reaches into the wall, which is told.
@pytest.mark.filterwarnings("ignore:`p0` has a mass of")
def test_cells_too_coarse_for_a_wall_are_refused_by_the_entropy():
    # 64 cells of 0.08 for a wall of 0.02: E|ξ|² would be off by 1 %, H by 3. When the
    # force was lost it ended at four times the right E|ξ|², and at H = 467.
    grid = fp.PhaseSpaceGrid(2.5, (64, 64, 16))
    scheme = fp.drift_kick(fp.LayDownModel(WALL, 1.0), grid, positive=True)
    p0 = fp.initial.gaussian(grid, (0.4, 0.0), 0.04)
    with pytest.raises(fp.EntropyRiseError, match=r"relative entropy risen by [\d.]+, more than the tolerance 0.1, at s = [\d.]+, where it can only fall: .*`half_width`.*`entropy_tolerance`") as caught:  # fmt: skip  # noqa: E501
        fp.solve(scheme, p0, (0.0, 3.0), 1 / 32, record_every=4)
    error = caught.value
    assert error.rise > error.tolerance == 0.1
    solution = error.solution
    assert solution.status == "failed"
    assert solution.s[-1] == error.s
    assert solution.entropy_rise[-1] == error.rise
    lowest = solution.relative_entropy.min()
    assert solution.relative_entropy[-1] - lowest == error.rise


def test_a_step_too_long_for_a_wall_is_refused_by_the_circulation():
    # Balanced, the entropy falls whatever the step; L1 is off by 0.27 at the end.
    grid, model = fp.PhaseSpaceGrid(1.6, (40, 40, 16)), fp.LayDownModel(WALL, 0.3)
    scheme = fp.drift_kick(model, grid, balanced=True)
    with pytest.raises(fp.CirculationError, match=r"circulation off its exact law by -0\.0\d+, more than the tolerance 0\.05, at s = [\d.]+: the L1 error .* is at least as large; .*`circulation_tolerance`") as caught:  # fmt: skip  # noqa: E501
        fp.solve(scheme, circling(grid, WALL, 0.9), (0.0, 4.0), 1 / 16)
    error = caught.value
    assert abs(error.deviation) > error.tolerance == 0.05
    exact = circling(grid, WALL, 0.9 * np.exp(-0.5 * 0.3**2 * error.s))
    state = scheme.start(circling(grid, WALL, 0.9))
    scheme.advance(state, 0.0, 1 / 16, round(16 * error.s))
    off = fp.diagnostics.l1_distance(scheme.density(state), exact, grid)
    assert off >= abs(error.deviation)
    np.testing.assert_array_equal(error.solution.entropy_rise, 0.0)


def test_characteristics_at_a_wall_are_refused():
    # The angle turns by 10²⁰ in a step far out: no mass can be restored from that.
    grid, model = fp.PhaseSpaceGrid(2.5, (24, 24, 8)), fp.LayDownModel(WALL, 1.0)
    p0 = circling(grid, WALL, 0.9)
    for form in ("h", "p"):
        with pytest.raises((fp.MassCorrectionError, fp.NonFiniteDensityError)):
            fp.solve(fp.semi_lagrangian(model, grid, form=form), p0, (0.0, 1.0), 1 / 16)


def test_the_gap_of_the_limit_does_not_depend_on_how_far_its_box_reaches_into_a_wall():
    # Rates within a wall reach 1e20; a shift as large as they are hid every mode.
    limit = fp.HydrodynamicLimit(fp.LayDownModel(WALL, 5.0))
    tight, wide = (
        limit.spectrum(fp.PlaneGrid(half_width, (n, n)), 3)
        for half_width, n in ((1.3, 32), (2.5, 62))
    )
    difference = np.abs(tight.eigenvalues - wide.eigenvalues)
    assert np.all(difference <= tight.errors + wide.errors)
    assert np.all(wide.errors[1:] < 0.02 * wide.eigenvalues[1:])


def second_moment_of(paths):
    """Mean of |ξ|² at the end and its standard error."""
    squares = (paths.xi[-1] ** 2).sum(axis=1)
    return squares.mean(), squares.std() / np.sqrt(squares.size)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_a_wall_is_the_same_in_every_unit_of_length(scale):
    # c⁻⁶⁰ underflows or overflows; the force was lost where it became zero.
    paths = fp.sample_paths(
        fp.LayDownModel(fp.PowerPotential(60.0, scale), scale**-0.5), 400, 2.0 * scale,
        scale / 64, seed=3, initial=(np.array([0.4 * scale, 0.0]), 0.3),
    )  # fmt: skip
    unit = fp.sample_paths(
        fp.LayDownModel(WALL, 1.0), 400, 2.0, 1 / 64, seed=3,
        initial=(np.array([0.4, 0.0]), 0.3),
    )  # fmt: skip
    # The same noise: 128 steps of rounding, and the bounces that magnify it.
    np.testing.assert_allclose(paths.xi[-1] / scale, unit.xi[-1], rtol=0, atol=1e-6)


def test_paths_reflected_by_long_steps_are_told_of():
    # E|ξ|² at equilibrium, Γ(4/n) n^{2/n}/Γ(2/n), is 0.5637: off by 3 %.
    model = fp.LayDownModel(WALL, 1.0)
    options = {
        "seed": 1,
        "initial": fp.paths.EquilibriumLaw(fp.QuadraticPotential(0.4, 0.4)),
    }
    with pytest.warns(UserWarning, match=r"`ds` = 0\.125 is long for this force: \|∇B\| ds exceeds 2\.5 where [\d.]+ % of the paths end"):  # fmt: skip  # noqa: E501
        fp.sample_paths(model, 4000, 4.0, 1 / 8, **options)
    mean, error = second_moment_of(
        fp.sample_paths(model, 4000, 8.0, 1 / 128, **options)
    )
    assert abs(mean - 0.56368) < 4 * error


def test_a_force_whose_length_overflows_still_turns():
    # (F, F) with F√2 beyond the largest number turns as any strong force does.
    states = np.zeros((2, 5, 1))
    states[:, 2] = 1.0
    for state, size in zip(states, (1.5e308, 1e200), strict=True):
        kernels.kick_paths(0.25, np.zeros(1), np.full((2, 1), size), state)
    np.testing.assert_allclose(states[0], states[1], rtol=0, atol=1e-15)
    np.testing.assert_allclose(states[0, 2:4, 0], -np.sqrt(0.5), atol=1e-12)
