"""What a run on a belt at rest records of the laws that it must keep."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.density.recorder import Recorder

GRID = fp.PhaseSpaceGrid(5.0, (20, 16, 16))
MODEL = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
P0 = fp.initial.gaussian(GRID, (1.0, 0.3), 0.6, angle=1.0, concentration=2.0)
RUN = {"s_span": (0.0, 1.0), "ds": 0.125}
SCHEMES = {
    "drift_kick": lambda model: fp.drift_kick(model, GRID),
    "positive": lambda model: fp.drift_kick(model, GRID, positive=True),
    "balanced": lambda model: fp.drift_kick(model, GRID, balanced=True),
    "h": lambda model: fp.semi_lagrangian(model, GRID),
    "p": lambda model: fp.semi_lagrangian(model, GRID, form="p"),
}


@pytest.mark.parametrize("name", SCHEMES)
def test_both_laws_are_recorded_and_kept_by_every_scheme(name):
    solution = fp.solve(SCHEMES[name](MODEL), P0, **RUN)
    # The entropy falls at once from this start, and never rises.
    np.testing.assert_array_equal(solution.entropy_rise, 0.0)
    law = solution.circulation[0] * np.exp(-0.5 * solution.s)
    np.testing.assert_allclose(
        solution.circulation_deviation, solution.circulation - law, rtol=0, atol=1e-15
    )
    # 3e-3 measured for cubic interpolation with these cells, 2e-4 for eight points.
    assert np.abs(solution.circulation_deviation).max() < 5e-3
    assert solution.circulation[0] > 0.2


def test_the_circulation_is_its_integral():
    solution = fp.solve(fp.drift_kick(MODEL, GRID), P0, **RUN)
    xi1, xi2, alpha = GRID.mesh()
    weight = np.exp(-(xi1**2 + xi2**2) / 2)
    circulation = weight * (xi1 * np.sin(alpha) - xi2 * np.cos(alpha))
    largest = (weight * np.hypot(xi1, xi2)).max()
    found = (solution.final * circulation).sum() / solution.final.sum() / largest
    assert solution.circulation[-1] == pytest.approx(found, rel=1e-13)


@pytest.mark.parametrize("shift", [-800.0, 800.0])
def test_only_differences_of_the_potential_matter(shift):
    # e^{800} is no number.
    shifted = fp.IsotropicPotential(lambda r: r**2 / 2 + shift, lambda r: 1.0 * r)
    model = fp.LayDownModel(shifted, 1.0)
    exact = fp.solve(fp.drift_kick(MODEL, GRID), P0, **RUN)
    options = {"reference": MODEL.equilibrium(*GRID.plane())}
    found = fp.solve(fp.drift_kick(model, GRID), P0, **RUN, **options)
    np.testing.assert_allclose(found.circulation, exact.circulation, rtol=1e-10)
    # Relative to a density of the caller's own H may rise.
    assert "entropy_rise" not in found.series


@pytest.mark.parametrize(
    ("model", "recorded"),
    [
        (fp.LayDownModel(fp.QuadraticPotential(1.0, 0.7), 1.0), {"entropy_rise"}),
        (fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.2)), set()),
        (
            fp.LayDownModel(fp.FreePotential(), 1.0),
            {"circulation", "circulation_deviation"},
        ),
    ],
    ids=["anisotropic", "moving", "free"],
)
def test_a_law_is_recorded_where_it_holds(model, recorded):
    solution = fp.solve(
        fp.drift_kick(model, GRID), P0, (0.0, 0.25), 0.125, boundary_tolerance=1.0
    )
    laws = {"entropy_rise", "circulation", "circulation_deviation"}
    assert laws & solution.series.keys() == recorded


def test_a_rise_is_measured_from_the_lowest_entropy_and_not_from_the_last():
    sharp = fp.initial.gaussian(GRID, variance=0.5)
    blurred = fp.initial.gaussian(GRID, variance=0.8)
    own = fp.initial.equilibrium(GRID, MODEL.potential)
    recorder = Recorder(MODEL, GRID)
    for p in (sharp, own, blurred, sharp):
        recorder.record(p, 0.0)
    h_sharp, h_own, h_blurred, _ = recorder.series()["relative_entropy"]
    expected = [0.0, 0.0, h_blurred - h_own, h_sharp - h_own]
    assert recorder.series()["entropy_rise"].tolist() == expected
    # As after a checkpoint.
    other = Recorder(MODEL, GRID)
    other.go_on(recorder.columns, recorder.table())
    assert other.record(sharp, 0.0)["entropy_rise"] == h_sharp - h_own


def test_extrapolation_leaves_the_rise_and_extrapolates_the_circulation():
    fine = fp.solve(fp.drift_kick(MODEL, GRID), P0, (0.0, 1.0), 0.125, record_every=2)
    coarse = fp.solve(fp.drift_kick(MODEL, GRID), P0, (0.0, 1.0), 0.25)
    found = fp.solve(fp.drift_kick(MODEL, GRID), P0, (0.0, 1.0), 0.25, extrapolate=True)
    np.testing.assert_array_equal(found.entropy_rise, fine.entropy_rise)
    np.testing.assert_allclose(
        found.circulation_deviation,
        (4 * fine.circulation_deviation - coarse.circulation_deviation) / 3,
        rtol=0, atol=1e-16,
    )  # fmt: skip
    assert found.errors["circulation"].max() > 0


def test_a_run_that_goes_on_knows_how_low_its_entropy_was(tmp_path):
    # Without noise the plain form lets H rise by undershoots it does not count.
    grid = fp.PhaseSpaceGrid(4.0, (10, 10, 8))
    scheme = fp.drift_kick(fp.LayDownModel(fp.QuadraticPotential(0.7, 0.5), 0.0), grid)
    p0 = fp.initial.gaussian(grid, (0.5, 0.0), 0.2, angle=1.0, concentration=2.0)
    run = {
        "s_span": (0.0, 2.0), "ds": 0.125, "entropy_tolerance": np.inf,
        "boundary_tolerance": 1.0, "negative_tolerance": 1.0,
    }  # fmt: skip
    whole = fp.solve(scheme, p0, **run)
    assert whole.entropy_rise.max() > 0

    def interrupt(n_done, n_total, s):
        if n_done == 12:
            raise KeyboardInterrupt

    folder = tmp_path / "run"
    with pytest.raises(fp.RunInterrupted):
        fp.solve(scheme, p0, **run, checkpoint=folder, progress=interrupt)
    resumed = fp.resume(folder)
    for name, values in whole.series.items():
        np.testing.assert_array_equal(resumed.series[name], values, err_msg=name)


@pytest.mark.parametrize("name", ["entropy", "circulation"])
def test_tolerances_are_positive(name):
    option = {f"{name}_tolerance": 0.0}
    with pytest.raises(ValueError, match=f"`{name}_tolerance` must be positive, got 0"):
        fp.solve(fp.drift_kick(MODEL, GRID), P0, **RUN, **option)


# The start reaches into the wall, which is told.
@pytest.mark.filterwarnings("ignore:`p0` has a mass of")
def test_the_solver_of_py_pde_keeps_the_laws_too():
    wall = fp.LayDownModel(fp.PowerPotential(60.0), 1.0)
    grid = fp.PhaseSpaceGrid(2.5, (40, 40, 8))
    field = fp.to_pde_field(fp.initial.gaussian(grid, (0.4, 0.0), 0.04), grid)
    with pytest.raises(fp.EntropyRiseError):
        fp.interop.FokkerPlanckPDE(wall).solve(
            field, 3.0, dt=1 / 16, solver="drift-kick", positive=True,
            tracker=None, boundary_tolerance=1.0,
        )  # fmt: skip
