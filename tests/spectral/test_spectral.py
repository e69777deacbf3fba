"""Spectra of the generator against exact statements, definitions and dense algebra."""

import gc
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.linalg import eigs

import fpsolve as fp
from fpsolve.errors import MemoryLimitError, ToleranceError
from fpsolve.spectral import Sector, SpectralGap, spectral_gap, spectrum
from fpsolve.spectral.bases.choice import discretisation_for
from fpsolve.spectral.bases.hermite import HermiteDiscretisation
from fpsolve.spectral.bases.sectors import Truncation
from fpsolve.spectral.bases.tensor import TensorDiscretisation
from fpsolve.spectral.eigen.eigenvalues import ShiftedInverse
from fpsolve.spectral.eigen.following import slowness
from fpsolve.spectral.eigen.survey import Scale, survey

ODD, EVEN, ONE = Sector(0, -1), Sector(0, 1), Sector(1)


def quadratic(noise, sigma=1.0, **options):
    return fp.LayDownModel(fp.QuadraticPotential(sigma, sigma), noise, **options)


# ---------------------------------------------------------------- exact statements


@pytest.mark.parametrize("noise", [0.1, 0.3, 1.0, 4.0])
@pytest.mark.parametrize(
    "potential",
    [
        fp.QuadraticPotential(),
        fp.QuadraticPotential(0.7, 0.7),
        fp.PowerPotential(4.0),
        fp.LinearPotential(),
    ],
    ids=["quadratic", "quadratic 0.7", "quartic", "linear"],
)
def test_half_the_squared_noise_is_an_eigenvalue_of_every_isotropic_potential(
    potential, noise
):
    # G = exp(-B)(ξ1 sin α - ξ2 cos α), odd under the reflection, M = 0.
    model = fp.LayDownModel(potential, noise)
    basis = discretisation_for(model)
    matrix = basis.matrix(ODD, *basis.truncation(1))
    exact = -0.5 * noise**2
    values = eigs(matrix, 3, sigma=(1 + 1e-5) * exact, return_eigenvectors=False)
    # Hermite series of exp(-B) fall by a factor 2 per pair of degrees, the error of the
    # eigenvalue by 4: 4^-17 at degree 34, times a constant that grows as A falls.
    assert np.min(np.abs(values - exact)) < 1e-4 * abs(exact)


@pytest.mark.parametrize("noise", [0.05, 0.1, 0.3, 0.5])
def test_for_small_noise_the_gap_is_half_the_squared_noise(noise):
    gap = spectral_gap(quadratic(noise))
    assert gap.sector == ODD
    assert abs(gap - 0.5 * noise**2) <= max(gap.error, 1e-15)
    assert gap.error < 1e-10 * gap


def test_for_large_noise_the_gap_has_its_expansion():
    # A² gap = 1 + (3/2) A⁻⁴ + c A⁻⁸ + ...: the remainder times A⁸ settles on c.
    remainders = []
    for noise in (6.0, 8.0, 10.0):
        gap = spectral_gap(quadratic(noise))
        assert gap.sector == ONE
        remainders.append((noise**2 * gap - 1 - 1.5 * noise**-4) * noise**8)
    # Rounding of A² gap, 1e-15, times A⁸ is 1e-7; the next term is of relative size
    # A⁻⁴ = 8e-4 times its coefficient over c.
    assert np.ptp(remainders) < 0.03 * abs(remainders[-1]), remainders


@given(st.floats(0.4, 8.0), st.floats(0.2, 5.0))
@settings(max_examples=8, deadline=None)
def test_the_gap_scales_with_the_throwing_range(noise, sigma):
    wide = spectral_gap(quadratic(noise, sigma), tolerance=1e-8)
    unit = spectral_gap(quadratic(math.sqrt(sigma) * noise), tolerance=1e-8)
    # Both are known to 1e-8, except next to the double eigenvalue.
    assert abs(wide - unit / sigma) <= wide.error + unit.error / sigma + 1e-14


def test_the_rate_is_the_dissipation_of_the_eigenfunction():
    # Re ⟨f, L f⟩ = -(A²/2) ‖∂_α f‖², and the transport is antisymmetric.
    found = spectrum(quadratic(0.9), 6, tolerance=1e-8)
    for mode in found._modes:
        k = found._discretisation.harmonics(mode.sector, mode.truncation)
        weight = np.abs(mode.vector) ** 2
        dissipation = 0.5 * 0.9**2 * np.sum(k**2 * weight) / weight.sum()
        assert dissipation == pytest.approx(mode.rate, rel=1e-9)


# ---------------------------------------------------------------- branches


def test_branches_of_different_sectors_cross():
    # Measured: M = 0 odd and even cross at 0.57942, M = 0 even and ±1 at 0.98160; on
    # both sides both branches are in the spectrum.
    for before, after, noises in ((ODD, EVEN, BELOW), (EVEN, ONE, ABOVE)):
        rates = {before: [], after: []}
        for noise in noises:
            found = spectrum(quadratic(noise), 3, tolerance=1e-8)
            for sector in rates:
                i = found.sectors.index(sector)
                rates[sector].append(-found.eigenvalues[i].real)
        difference = np.subtract(rates[before], rates[after])
        assert difference[0] < 0 < difference[1]
        gaps = [spectral_gap(quadratic(noise), tolerance=1e-8) for noise in noises]
        assert [gap.sector for gap in gaps] == [before, after]
        assert gaps == pytest.approx([rates[before][0], rates[after][1]], rel=1e-8)


BELOW, ABOVE = (0.57, 0.59), (0.97, 0.99)
# Where the pair merges, to 13 digits (test_optimal_noise).
BEST = 1.6157138035238


def test_a_complex_pair_merges_at_a_double_eigenvalue():
    distances = np.array([1e-3, 4e-3])
    for side in (-1, 1):
        halves, means = [], []
        for distance in distances:
            model = quadratic(BEST + side * distance)
            found = spectrum(model, 2, sectors=[ONE], tolerance=1e-8)
            assert found.sectors == [ONE, ONE]
            halves.append(np.diff(found.eigenvalues)[0] / 2)
            means.append(found.eigenvalues.mean().real)
        halves = np.array(halves)
        # Complex below, real above; √δ with δ linear in the distance, to a curvature
        # of order one times the distance.
        part = halves.imag if side < 0 else halves.real
        assert np.all(np.abs(part) == np.abs(halves))
        assert part[1] / part[0] == pytest.approx(2.0, rel=0.02)
        # The mean is smooth: -0.7222717 with a slope of about -0.6.
        np.testing.assert_allclose(means, -0.7222717, rtol=0, atol=5e-3)


def test_at_the_double_eigenvalue_the_error_says_what_rounding_leaves():
    gap = spectral_gap(quadratic(BEST), tolerance=1e-8)
    # √ of what remains of 1e-13 in the noise is 3e-7.
    assert abs(gap - 0.7222717229986) < 1e-6
    assert gap.error < 1e-4


@given(st.floats(0.3, 6.0), st.integers(1, 8))
@settings(max_examples=12, deadline=None)
def test_no_eigenvalue_right_of_the_line_is_lost(noise, n):
    # Against LAPACK on the same truncation, for all sectors that may matter.
    basis, scale = HermiteDiscretisation(1.0, noise), Scale(1.0, 0.02)
    truncation = Truncation(14, 8)
    found = survey(basis, truncation, n, scale)
    dense = []
    for sector in (EVEN, ODD, ONE, *map(Sector, range(2, 7))):
        matrix = basis.matrix(sector, *truncation).toarray()
        values = np.linalg.eigvals(matrix)
        values = values[(values.imag >= 0) & (np.abs(values) > 1e-9)]
        dense += [(-value.real, sector) for value in values]
    last = found[-1].rate
    # Rounding of ARPACK and LAPACK apart from 1e-7, no mode of `dense` is missing.
    expected = sorted(rate for rate, _ in dense if rate < last * (1 - 1e-7))
    slower = [mode.rate for mode in found if mode.rate < last * (1 - 1e-7)]
    np.testing.assert_allclose(slower, expected, rtol=1e-6)


def test_what_moves_between_truncations_is_not_reported():
    # At small noise a coarse basis shows modes that are far too slow.
    noise = 0.3
    basis = HermiteDiscretisation(1.0, noise)
    coarse = survey(basis, basis.truncation(0), 3, Scale(1.0, 0.045))
    found = spectrum(quadratic(noise), 3, tolerance=1e-4)
    rates = [mode.rate for mode in coarse]
    # Coarse: a pair with M = ±1 at 0.073. True: 0.0817 and 0.0849 (degree 200).
    assert any(abs(rate - 0.0731) < 1e-3 for rate in rates)
    assert not np.any(np.abs(found.eigenvalues.real + 0.0731) < 1e-3)
    assert np.all(found.errors <= 1e-4 * -found.eigenvalues.real)


def test_the_anisotropic_spectrum_joins_the_isotropic_one():
    near = fp.LayDownModel(fp.QuadraticPotential(1.0, 1.0 + 1e-9), 2.0)
    gap = spectral_gap(near, tolerance=1e-8)
    # The shift is of the order of the difference of the throwing ranges.
    assert gap == pytest.approx(spectral_gap(quadratic(2.0)), rel=1e-8)
    assert gap.sector.M is None
    # A belt of tiny speed leaves one symmetry less, and changes the gap by v².
    belt = fp.LayDownModel(fp.QuadraticPotential(), 2.0, fp.MovingBelt(1e-5))
    assert spectral_gap(belt, tolerance=1e-8) == pytest.approx(gap, rel=1e-7)


def test_the_direction_of_the_belt_does_not_matter():
    models = [
        fp.LayDownModel(fp.QuadraticPotential(1.0, 0.8), 3.0, fp.MovingBelt(speed))
        for speed in (0.15, -0.15)
    ]
    first, second = (spectrum(model, 2, tolerance=1e-8) for model in models)
    np.testing.assert_allclose(first.eigenvalues, second.eigenvalues, rtol=1e-8)


def test_the_large_noise_limit_of_an_anisotropic_potential():
    # Poincaré constant: min 1/σᵢ², with corrections of relative order A⁻⁴.
    model = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.5), 10.0)
    assert 100 * spectral_gap(model) == pytest.approx(1.0, abs=1e-3)


def test_a_spurious_pair_whose_frequency_grows_with_the_basis_is_left_out():
    # M = ±4 at A = 0.8: degree 48 has a pair at -1.235 ± 5.58i, degree 96 one at
    # -1.315 ± 8.28i, both right of the first true one.
    sector, noise = Sector(4), 0.8
    basis = HermiteDiscretisation(1.0, noise)
    pairs = [
        survey(basis, basis.truncation(level), 2, Scale(1.0, 0.3), (sector,))[0]
        for level in (2, 4)
    ]
    frequencies = [pair.eigenvalue.imag for pair in pairs]
    assert frequencies == pytest.approx([5.58, 8.28], abs=0.01)
    found = spectrum(quadratic(noise), 1, sectors=[sector], tolerance=1e-6)
    assert found.gap > max(pair.rate for pair in pairs)
    assert found.eigenvalues[0].imag == pytest.approx(1.0481, abs=1e-3)


# ---------------------------------------------------------------- results


@pytest.mark.parametrize("degree", [12, 13])
def test_no_eigenvalue_of_the_truncation_alone_is_reported(degree):
    # With k = 1 and the highest degree there is one at −A²/2, in the same sectors in
    # every truncation of one parity: it stands still, and would be taken for the gap.
    model = fp.LayDownModel(fp.QuadraticPotential(1.0, 0.7), 0.3)
    basis, scale = TensorDiscretisation(1.0, 0.7, 0.3), Scale.of(model, None)
    found = survey(basis, Truncation(degree, 8), 2, scale)
    assert min(abs(mode.eigenvalue + 0.3**2 / 2) for mode in found) > 0.1 * 0.045


def test_errors_bound_the_distance_to_a_finer_computation():
    for noise in (0.7, 1.0, 1.3):
        rough = spectrum(quadratic(noise), 4, tolerance=1e-5)
        fine = spectrum(quadratic(noise), 4, tolerance=1e-11)
        distance = np.abs(rough.eigenvalues - fine.eigenvalues)
        assert np.all(distance <= rough.errors + fine.errors)
        assert np.all(fine.errors <= 1e-11 * -fine.eigenvalues.real)
        assert np.all(fine.residuals < rough.residuals)


def test_the_spectrum_is_sorted_and_complete_in_its_pairs():
    found = spectrum(quadratic(1.0), 5)
    assert len(found.eigenvalues) == len(found.sectors) == len(found.errors) == 5
    assert np.all(np.diff(found.eigenvalues.real) <= 1e-12)
    first, second = found.eigenvalues[:2]
    assert first == second.conjugate()
    assert first.imag > 0
    assert found.sectors[:2] == [ONE, ONE]
    assert list(found.multiplicities) == [2, 2, 1, 1, 1]
    assert found.gap == -first.real
    assert found.gap_error == found.errors[0]
    assert found.essential is None
    text = str(found)
    assert "-0.37429405198" in text
    assert "M = ±1" in text
    assert "M = 0 odd" in text


def test_equal_calls_give_equal_numbers():
    first, second = (spectrum(quadratic(0.8), 4) for _ in range(2))
    assert np.array_equal(first.eigenvalues, second.eigenvalues)
    assert np.array_equal(first.errors, second.errors)
    grid = fp.PhaseSpaceGrid(3.0, (8, 8, 8))
    for i in range(4):
        assert np.array_equal(
            first.eigenfunction(i, grid), second.eigenfunction(i, grid)
        )


def test_a_gap_is_a_number_that_carries_its_error():
    gap = spectral_gap(quadratic(3.0))
    assert isinstance(gap, float)
    copy = pickle.loads(pickle.dumps(gap))
    assert isinstance(copy, SpectralGap)
    assert copy == gap
    assert (copy.error, copy.sector, copy.eigenvalue) == (gap.error, ONE, -float(gap))


def test_the_essential_spectrum_bounds_the_gap_of_the_linear_potential():
    found = spectrum(fp.LayDownModel(fp.LinearPotential(), 6.0), 1, tolerance=1e-4)
    # Large noise: 2/9 and 1/4 over A², with corrections of relative order A⁻⁴.
    assert 36 * found.gap == pytest.approx(2 / 9, rel=1e-3)
    assert 36 * found.essential == pytest.approx(-1 / 4, rel=1e-3)
    assert "essential spectrum from" in str(found)


# ---------------------------------------------------------------- refusals


def anisotropic_quartic():
    return fp.CallablePotential(
        lambda xi1, xi2: xi1**4 + 2 * xi2**4,
        lambda xi1, xi2: (4 * xi1**3 + 0 * xi2, 8 * xi2**3 + 0 * xi1),
    )


@pytest.mark.parametrize(
    ("model", "message"),
    [
        (quadratic(0.0), r"`noise` must be positive, got 0; without noise the orbits"),
        (fp.LayDownModel(fp.FreePotential(), 1.0), r"`potential` must confine, got Fr"),
        (
            fp.LayDownModel(anisotropic_quartic(), 1.0),
            r"`potential` must be isotropic or quadratic, got CallablePotential",
        ),
        (
            fp.LayDownModel(fp.LinearPotential(), 1.0, fp.MovingBelt(0.1)),
            r"`potential` must be quadratic on a moving belt, got LinearPotential",
        ),
        (
            quadratic(1.0, curve=fp.RotatingNozzle(0.1, 0.5, 2.0)),
            r"`curve` must be a belt at rest or at constant speed, got Rotating",
        ),
    ],
)
def test_models_without_a_gap_or_a_basis_are_refused(model, message):
    with pytest.raises(ValueError, match=message):
        spectrum(model)
    with pytest.raises(ValueError, match=message):
        spectral_gap(model)


def test_wrong_arguments_are_refused():
    model = quadratic(1.0)
    with pytest.raises(TypeError, match="`model` must be a LayDownModel, got 3; make"):
        spectrum(3)
    with pytest.raises(ValueError, match=r"`n_eigenvalues` must be at least 1, got 0"):
        spectrum(model, 0)
    for tolerance in (1e-14, 0.5, float("nan")):
        with pytest.raises(
            ValueError, match=r"`tolerance` must lie in \[1e-13, 0\.1\]"
        ):
            spectrum(model, tolerance=tolerance)
    with pytest.raises(TypeError, match=r"`tolerance` must be a real number, got 'x'"):
        spectrum(model, tolerance="x")
    with pytest.raises(ValueError, match=r"`memory_limit` must be at least 1, got -1"):
        spectrum(model, memory_limit=-1)
    truncation = Truncation(4, 2)
    with pytest.raises(ValueError, match=r"`sector` must have an angular index M"):
        HermiteDiscretisation(1.0, 1.0).matrix(Sector(parity=1), *truncation)
    with pytest.raises(ValueError, match=r"`sector` must have a parity and no M"):
        TensorDiscretisation(1.0, 1.0, 1.0).matrix(ONE, *truncation)


@pytest.mark.parametrize(
    "potential",
    [fp.LinearPotential(), fp.QuadraticPotential(1.0, 1.3)],
    ids=["linear", "anisotropic"],
)
@pytest.mark.parametrize("noise", [1e-3, 0.02])
def test_little_noise_ends_with_what_the_spectrum_would_take(potential, noise):
    model = fp.LayDownModel(potential, noise)
    with pytest.raises(
        ToleranceError,
        match=rf"at noise {noise:g} it takes work of .* or more, where 1e\+08 is "
        r"allowed: choose a larger noise .* or raise `work_limit`",
    ) as caught:
        spectral_gap(model, tolerance=1e-3, work_limit=1e8)
    assert caught.value.reached > 1e-3


def test_work_that_suffices_changes_nothing_and_none_is_refused():
    model = quadratic(1.0)
    assert spectral_gap(model) == spectral_gap(model, work_limit=1e12)
    with pytest.raises(ToleranceError, match="no estimate of the error yet; at noise"):
        spectral_gap(model, work_limit=1.0)
    with pytest.raises(ValueError, match="`work_limit` must be positive and finite"):
        spectral_gap(model, work_limit=float("nan"))


def test_changes_that_fall_slowly_leave_more_than_the_last():
    # Partial sums of 1/n³: the change is 1/n³, what is left about 1/(2n²).
    for n in (6, 10, 40):
        left = sum(1 / m**3 for m in range(n + 1, 10_000))
        assert left <= slowness(1 / n**3, 1 / (n - 1) ** 3) / n**3
    # A geometric series of ratio 1/4 leaves less than the last term.
    assert slowness(0.25, 1.0) == 1.0
    assert slowness(0.0, 0.0) == 1.0


def test_a_nearly_skew_matrix_is_eliminated_with_few_entries():
    basis = HermiteDiscretisation(1.0, 0.02)
    matrix = basis.matrix(ONE, *basis.truncation(3))
    quiet = ShiftedInverse(matrix, complex(-1e-4, 0.3))
    # Row exchanges on a symmetric order fill more than half of the triangles.
    assert quiet.factors.nnz < 0.1 * matrix.shape[0] ** 2
    right = np.random.default_rng(1).standard_normal(matrix.shape[0]) + 0j
    found = quiet.factors.solve(right)
    defect = matrix @ found - quiet.shift * found - right
    # Rounding of entries up to degree times harmonics.
    assert np.linalg.norm(defect) < 1e-12 * np.linalg.norm(found)


def test_a_tolerance_out_of_reach_of_the_memory_says_so():
    with pytest.raises(
        MemoryLimitError, match=r"the run needs .* MiB but 0\.0954 MiB are available"
    ):
        spectrum(quadratic(1.0), memory_limit=100_000)
    with pytest.raises(
        ToleranceError,
        match=r"tolerance 1e-10 not reached: the error is estimated at .*; raise "
        r"`memory_limit`, enlarge `tolerance` or ask for fewer eigenvalues\.",
    ) as caught:
        spectrum(quadratic(0.3), 3, memory_limit=2_000_000)
    assert caught.value.tolerance == 1e-10
    assert caught.value.reached > 1e-10


def test_factors_go_when_nobody_needs_them():
    # A circle of references would keep all of them until the garbage is collected.
    model = fp.LayDownModel(fp.LinearPotential(), 1.0)
    gc.collect()
    gc.disable()
    try:
        spectral_gap(model, tolerance=1e-2)
        left = [one for one in gc.get_objects() if type(one) is ShiftedInverse]
    finally:
        gc.enable()
    assert left == []
