"""Suggested steps and grids follow the measured error laws and say why."""

import copy
import pickle

import numpy as np
import pytest
from mixtures import two_wells

import fpsolve as fp
from fpsolve.cli.config import RunConfig
from fpsolve.studies import suggested_grid


def model(noise=1.0, potential=None, curve=None):
    return fp.LayDownModel(
        potential or fp.QuadraticPotential(), noise, curve or fp.FixedBelt()
    )


GRID = fp.PhaseSpaceGrid(6.0, (64, 64, 32))


def test_the_suggested_step_keeps_the_law_below_the_tolerance():
    for noise in (0.0, 0.3, 1.0, 3.0, 10.0):
        step = fp.suggest_step(model(noise), GRID, tolerance=1e-3)
        # κ = ½ ∫|∇B|² e^{−B}/Z = 1 for the isotropic quadratic potential.
        assert (0.8 + 0.18 * noise**2) * step**2 <= 1e-3 * (1 + 1e-9)


def test_a_quarter_of_the_tolerance_halves_the_step():
    wide = fp.suggest_step(model(), GRID, tolerance=1e-2)
    narrow = fp.suggest_step(model(), GRID, tolerance=2.5e-3)
    # Steps are 1/m: rounding moves the ratio by at most 1/m.
    assert narrow / wide == pytest.approx(0.5, abs=0.06)


def test_a_suggested_step_divides_whole_spans_and_explains_itself():
    step = fp.suggest_step(model(2.0), GRID)
    assert round(1 / step) * step == pytest.approx(1.0, abs=1e-15)
    assert "splitting error" in step.reason
    assert "A = 2" in step.reason
    assert pickle.loads(pickle.dumps(step)).reason == step.reason


def test_cells_too_coarse_for_the_tolerance_are_pointed_out():
    coarse = fp.PhaseSpaceGrid(6.0, (24, 24, 32))
    assert "refine the grid" in fp.suggest_step(model(), coarse, 1e-3).reason


def test_the_suggested_box_holds_all_but_a_tenth_of_the_tolerance():
    for tolerance in (1e-2, 1e-4):
        grid = fp.suggest_grid(model(), tolerance)
        half = grid.half_widths[0]
        # Both Gaussian tails outside ±L, per direction.
        assert np.exp(-(half**2) / 2) < tolerance
        assert str(half).rstrip(".0") in grid.reason


def test_the_box_follows_the_belt_and_the_anisotropy():
    wide = fp.suggest_grid(model(3.0, curve=fp.MovingBelt(0.2)))
    assert wide.half_widths[0] >= wide.half_widths[1] + 1.5
    flat = fp.suggest_grid(model(1.0, fp.QuadraticPotential(1.0, 0.25)))
    assert flat.half_widths[1] < 0.5 * flat.half_widths[0]


def test_the_belt_shift_tends_to_the_mean_of_the_hydrodynamic_limit():
    shifted = model(2.0, curve=fp.MovingBelt(0.001))
    # ⟨ξ1⟩ = A²k/2 with k → 2v as v → 0; the next term is of relative order v².
    assert suggested_grid.belt_shift(shifted) == pytest.approx(0.004, rel=1e-5)


def share_outside(grid, model, s_end, law=None):
    """Largest share, over eight s, of 20 000 paths outside the box."""
    law = law or fp.paths.EquilibriumLaw(model.potential)
    looks = s_end / 8 * np.arange(1, 9)
    paths = fp.sample_paths(
        model, 20_000, s_end, s_end / 400, seed=7, initial=law, save_at=looks
    )
    outside = (np.abs(paths.xi) > grid.half_widths).any(axis=2)
    return outside.mean(axis=1).max()


MOVING = {
    "rotating nozzle": (1.0, None, fp.RotatingNozzle(0.0, 3.0, 2.0)),
    "swinging nozzle on a belt": (1.0, None, fp.OscillatingNozzle(0.2, 1.0, 2.0)),
    "fast belt": (1.0, None, fp.MovingBelt(0.9)),
    "steep noise": (3.0, None, fp.MovingBelt(0.3)),
    "off-centre well": (1.0, two_wells(5.0, 0.05).potential(), fp.MovingBelt(0.2)),
    "table from 5": (
        1.0,
        None,
        fp.TabulatedCurve([5, 6, 7, 8], [0, 2, -2, 0], [0, 1, 3, 1]),
    ),
}


@pytest.mark.parametrize("name", [name for name in MOVING if name != "table from 5"])
def test_the_box_holds_the_paths_of_every_curve(name):
    noise, potential, curve = MOVING[name]
    moving = model(noise, potential, curve)
    grid = fp.suggest_grid(moving)
    # 5e-5 may be outside: of 20 000 paths one, and eight at one of eight places only
    # once in 1e5 such tests.
    assert share_outside(grid, moving, 20.0) <= 8 / 20_000
    assert "lie outside" in grid.reason


def test_the_box_of_a_table_is_that_of_its_arclengths():
    grid = fp.suggest_grid(model(*MOVING["table from 5"]))
    # The curve goes four to and fro along the belt, three across.
    assert grid.half_widths[0] > 5
    assert "up to s = 3" in grid.reason


def test_all_wells_are_in_the_box_and_resolved():
    for distance in (16.0, 18.0):
        grid = fp.suggest_grid(model(1.0, two_wells(distance).potential()))
        assert grid.half_widths[0] > distance + 3.5
        assert grid.half_widths[1] == 4.5
        # Cells as for one well: both deviations of the whole are larger on a diagonal.
        assert max(grid.spacing[:2]) < 0.3


def test_a_longer_throwing_range_is_a_longer_unit_of_length():
    for potential in (fp.QuadraticPotential, fp.LinearPotential):
        small, large = (
            fp.suggest_grid(model(noise, potential(*size)))
            for noise, size in (
                (1.0, [1.0] * (2 if potential is fp.QuadraticPotential else 1)),
                (
                    1.0,
                    [2.0**-7] * 2 if potential is fp.QuadraticPotential else [2.0**7],
                ),
            )
        )
        assert small.half_widths[0] / large.half_widths[0] == 2.0**7
        assert ("kink" in small.reason) == ("kink" in large.reason)


def test_a_start_far_out_is_in_the_box():
    law = fp.paths.GaussianLaw((7.0, 0.0), 0.1)
    grid = fp.suggest_grid(model(), initial=law)
    assert grid.half_widths[0] > 8
    assert share_outside(grid, model(), 20.0, law) <= 8 / 20_000


def test_a_file_without_a_grid_gets_one_for_its_start_and_its_nozzle():
    tables = {
        "potential": {"kind": "quadratic"},
        "model": {"noise": 1.0},
        "curve": {
            "kind": "rotating_nozzle", "speed": 0.0, "radius": 3.0, "angular_speed": 2.0
        },
        "initial": {"kind": "gaussian", "mean": (2.0, 0.0), "variance": 0.5},
        "scheme": {"kind": "drift_kick"},
        "run": {"s_end": 1.0, "tolerance": 0.1},
    }  # fmt: skip
    grid = RunConfig.model_validate(tables).build().grid
    assert min(grid.half_widths) > 6
    assert "up to s = 1," in grid.reason


def test_what_no_box_holds_is_refused():
    far = model(2.0, fp.LinearPotential(), fp.MovingBelt(0.5))
    with pytest.raises(ValueError, match="`model` must settle for a box to be sugg"):
        fp.suggest_grid(far)
    # For a run that ends there is a box: |ξ| grows by less than s (1 + v).
    assert fp.suggest_grid(far, s_end=2.0).half_widths[0] < 20
    slow = fp.IsotropicPotential(
        lambda r: 2 * np.log1p(r**2), lambda r: 4 * r / (1 + r**2)
    )
    with pytest.raises(ValueError, match="falls more slowly than an exponential"):
        fp.suggest_grid(model(1.0, slow, fp.MovingBelt(0.1)))
    slower = fp.IsotropicPotential(
        lambda r: 1.05 * np.log1p(r**2), lambda r: 2.1 * r / (1 + r**2)
    )
    with pytest.raises(ValueError, match=r"`potential` must fall fast enough for a"):
        fp.suggest_grid(model(1.0, slower))
    apart = two_wells(1e6).potential()
    with pytest.raises(ValueError, match="`model` must have a pattern that a grid can"):
        fp.suggest_grid(model(1.0, apart))
    with pytest.raises(ValueError, match="`s_end` must be positive"):
        fp.suggest_grid(model(curve=fp.MovingBelt(0.1)), s_end=-1.0)


def test_less_noise_and_a_kink_ask_for_more_cells():
    smooth, quiet = fp.suggest_grid(model(1.0)), fp.suggest_grid(model(0.1))
    assert quiet.shape[0] > smooth.shape[0]
    assert quiet.shape[2] > smooth.shape[2]
    assert "kink of slope 1" in fp.suggest_grid(model(1, fp.LinearPotential())).reason


def test_suggestions_are_grids_and_steps_that_a_run_accepts():
    found = fp.suggest_grid(model(), 5e-2)
    assert isinstance(found, fp.PhaseSpaceGrid)
    assert copy.deepcopy(found).reason == found.reason
    p0 = fp.initial.equilibrium(found, fp.QuadraticPotential())
    step = fp.suggest_step(model(), found)
    scheme = fp.drift_kick(model(), found, balanced=True)
    solution = fp.solve(scheme, p0, (0.0, 1.0), step)
    assert solution.status == "finished"


def test_tolerances_and_potentials_without_meaning_are_refused():
    for wrong in (0.0, 1.0, -1.0, float("nan")):
        with pytest.raises(ValueError, match="`tolerance` must lie between 0 and 1"):
            fp.suggest_grid(model(), wrong)
        with pytest.raises(ValueError, match="`tolerance` must lie between 0 and 1"):
            fp.suggest_step(model(), GRID, wrong)
    with pytest.raises(ValueError, match="`potential` must confine"):
        fp.suggest_grid(model(1.0, fp.FreePotential()))
