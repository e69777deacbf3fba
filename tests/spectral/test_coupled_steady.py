"""Stationary densities of smooth fibres by expansion, on belts and at rest."""

import math

import numpy as np
import pytest
from fourier import derivative

import fpsolve as fp
from fpsolve.errors import ToleranceError
from fpsolve.spectral.bases.choice import smooth_discretisation_for
from fpsolve.spectral.bases.coupled_moments import mean_cos2_alpha
from fpsolve.spectral.evolution.coupled_steady import Refinement
from fpsolve.spectral.work import Work


def fibre(length, noise, speed=0.0, sigmas=(1.0, 1.0)):
    belt = fp.MovingBelt(speed) if speed else fp.FixedBelt()
    return fp.SmoothLayDownModel(fp.QuadraticPotential(*sigmas), length, noise, belt)


BELT = fibre(0.3, 1.5, 0.2, (0.9, 1.2))
# Every error below is that of a truncation, much above rounding. On belts the even
# and the odd indices are coupled, and four truncations take ten seconds and more.
CASES = [
    pytest.param(fibre(0.1, 3.0, 0.3), 1e-3, marks=pytest.mark.nightly),
    pytest.param(fibre(1.0, 3.0, 0.2), 5e-2, marks=pytest.mark.nightly),
    (fibre(0.3, 1.5, 0.0, (0.8, 1.6)), 1e-2),
]
# The same claim on three belts, one of them a quick one.
BELTS = [
    pytest.param(BELT, marks=pytest.mark.nightly),
    pytest.param(fibre(1.0, 1.0, 0.3), marks=pytest.mark.nightly),
    fibre(0.1, 3.0, 0.5),
]


@pytest.mark.nightly
@pytest.mark.parametrize(("model", "tolerance"), CASES)
def test_errors_cover_what_the_next_truncation_changes(model, tolerance):
    """Against one of 1.3 times the degree, whose own error is several times less."""
    found = fp.spectral_steady_state(model, tolerance=tolerance)
    finer = None
    basis = smooth_discretisation_for(model)
    for finer in Refinement(basis, 0.0, 2**31, Work(math.inf)).densities():
        if finer.fine[1].degree > found.truncation.degree:
            break
    for name, error in found.errors.items():
        assert abs(found.moments[name] - finer.moments[name]) <= error, name
        assert error <= tolerance * max(1.0, abs(found.moments[name]))


@pytest.mark.parametrize("model", BELTS)
def test_the_identities_of_the_stationary_state_hold(model):
    """E cos α = −v; E κ² from E d(κ ∂_s α) = 0. They converge faster than the rest."""
    found = fp.spectral_steady_state(model, tolerance=1e-2)
    moments, speed = found.moments, model.belt_speed
    # Their defects are far below the errors of the variances, but not zero.
    assert moments["mean_cos_alpha"] == pytest.approx(-speed, abs=1e-3)
    sigma1, sigma2 = model.potential.sigma1, model.potential.sigma2
    basis = smooth_discretisation_for(model)
    states = basis.states(basis.stationary_sector, found.truncation)
    along = mean_cos2_alpha(states, found._vector, basis.placement)
    exact = model.curvature_variance + along / sigma1**2
    exact += (1 - along) / sigma2**2 - speed**2 / sigma1**2
    assert moments["mean_kappa2"] == pytest.approx(exact, abs=1e-3)
    assert moments["mean_sin_alpha"] == moments["mean_kappa"] == 0.0
    assert moments["mean_xi2"] == moments["covariance"] == 0.0


@pytest.mark.nightly
def test_for_short_relaxation_the_belt_has_the_moments_of_the_basic_model():
    """The distance is of first order in R, observed at every halving."""
    sigmas, names = (0.9, 1.2), ("mean_xi1", "variance_xi1", "variance_xi2")
    limit = fp.spectral_steady_state(
        fibre(1.0, 1.5, 0.2, sigmas).white_noise_limit, tolerance=1e-7
    )
    distances = []
    for length in (0.04, 0.02, 0.01):
        found = fp.spectral_steady_state(
            fibre(length, 1.5, 0.2, sigmas), tolerance=1e-4
        )
        distances.append([found.moments[n] - limit.moments[n] for n in names])
    distances = np.array(distances)
    # Errors are below 3e-5, the distances above 4e-3; ratios 2 up to O(R).
    np.testing.assert_allclose(distances[:-1] / distances[1:], 2.0, rtol=0.15)


@pytest.mark.nightly
def test_units_of_length_scale_the_moments():
    """ξ = σξ', R = σR', κ = κ'/σ and A = A'/√σ."""
    sigma = 1e-2
    unit = fp.spectral_steady_state(fibre(0.3, 1.5, 0.2, (1.0, 1.3)), tolerance=1e-3)
    scaled = fp.spectral_steady_state(
        fibre(0.3 * sigma, 1.5 / sigma**0.5, 0.2, (sigma, 1.3 * sigma)), tolerance=1e-3
    )
    powers = {"mean_xi1": 1, "variance_xi1": 2, "variance_xi2": 2, "mean_kappa2": -2}
    for name, power in powers.items():
        # Errors of lengths are absolute where they are short: both differ in degree.
        allowed = scaled.errors[name] + sigma**power * unit.errors[name]
        difference = scaled.moments[name] - sigma**power * unit.moments[name]
        assert abs(difference) <= allowed, name


def test_paths_have_these_moments():
    paths = fp.sample_paths(BELT, 40_000, 30.0, 0.05, seed=3, keep=False).moments()
    found = fp.spectral_steady_state(BELT, tolerance=1e-3)
    for name in ("mean_xi1", "variance_xi1", "variance_xi2", "mean_kappa2"):
        mean, error = (values[-1] for values in paths[name][:2])
        # Four standard errors; the bias of the step is below one, as is what is left
        # of the start after s = 30.
        assert abs(found.moments[name] - mean) <= 4 * error, name


@pytest.mark.nightly
def test_the_density_solves_the_forward_equation():
    """L* p = 0 by Fourier differentiation on a grid, which knows no basis."""
    grid = fp.SmoothPhaseSpaceGrid((9.0, 9.0), 13.5, (36, 36, 16, 36))
    found = fp.spectral_steady_state(BELT, tolerance=1e-3)
    p = found.density(grid)
    xi1, xi2, alpha, kappa = grid.mesh()
    motion1, motion2, turn, force = BELT.drift(xi1, xi2, alpha, kappa)
    flows = (motion1 * p, motion2 * p, turn * p, force * p)
    parts = [derivative(flow, grid, axis).real for axis, flow in enumerate(flows)]
    diffusion = 0.5 * BELT.curvature_noise**2 * derivative(p, grid, 3, 2).real
    residual = np.abs(sum(parts) - diffusion).sum() * grid.cell_volume
    size = sum(np.abs(one).sum() for one in parts) * grid.cell_volume
    # The density is known to 1e-2 at worst, in its tails; measured 1e-3.
    assert residual < 5e-3 * size
    assert p.sum() * grid.cell_volume == pytest.approx(1.0, abs=1e-3)
    mean = (p * xi1).sum() * grid.cell_volume
    assert mean == pytest.approx(found.moments["mean_xi1"], abs=1e-3)
    assert found.density_error(grid) < 1e-2


@pytest.mark.parametrize(
    ("model", "options", "error", "message"),
    [
        (fibre(0.3, 0.0), {}, ValueError, "`noise` must be positive, got 0"),
        (fp.SmoothLayDownModel(fp.LinearPotential(), 0.3, 1.0), {}, ValueError,
         "`potential` must be a QuadraticPotential"),
        (fp.SmoothLayDownModel(fp.QuadraticPotential(), 0.3, 1.0,
                               fp.RotatingNozzle(0.2, 0.5, 0.5)), {}, ValueError,
         "`curve` must be a belt"),
        (BELT, {"tolerance": math.nan}, ValueError, "`tolerance`"),
        (BELT, {"tolerance": 2.0}, ValueError, "`tolerance` must be at most 1"),
        (BELT, {"memory_limit": 1e6}, ToleranceError, "memory_limit"),
        # Too little noise: no truncation that fits in 100 MB holds the orbits.
        (fibre(0.3, 0.3, 0.2), {"memory_limit": 1e8}, ToleranceError, "more noise"),
        pytest.param(fibre(0.3, 1.5, 0.95), {}, ToleranceError, "slower belt",
                     marks=pytest.mark.nightly),
    ],
)  # fmt: skip
def test_what_cannot_be_known_is_refused(model, options, error, message):
    with pytest.raises(error, match=message):
        fp.spectral_steady_state(model, **options)
