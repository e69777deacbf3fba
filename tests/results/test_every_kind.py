"""Every kind of saved result meets every command: it works, or says what it cannot."""

from functools import cache

import numpy as np
import pytest
import result_files

import fpsolve as fp
from fpsolve import plotting, studies
from fpsolve.pages.page import report_text
from fpsolve.plotting.files import possible_figures

PROCESS = fp.EnergyProcess(fp.QuadraticPotential(), 0.5)
LIMIT = fp.HydrodynamicLimit(
    fp.LayDownModel(fp.QuadraticPotential(), 2.0, fp.MovingBelt(0.1))
)
OWN = fp.HydrodynamicLimit(
    fp.LayDownModel(fp.IsotropicPotential(lambda r: r**2 / 2, lambda r: r), 2.0)
)
PLANE = fp.PlaneGrid(5.0, (16, 16))


def start(xi1, xi2):
    return np.exp(-((xi1 - 1) ** 2) - xi2**2)


def hydrodynamic(limit=LIMIT, **options):
    return limit.solve(start, (0.0, 1.0), 0.25, grid=PLANE, **options)


def energy(signed=False, **options):
    grid = PROCESS.grid(12, signed)
    return PROCESS.solve(0.3, (0.0, 1.0), 0.25, grid=grid, **options)


@cache
def results():
    several = {"save_at": (0.0, 0.5, 1.0), "extrapolate": True}
    return {
        "hydrodynamic": hydrodynamic(**several),
        "hydrodynamic, plain": hydrodynamic(),
        "energy": energy(**several),
        "energy, signed": energy(signed=True),
    }


NAMES = ["hydrodynamic", "hydrodynamic, plain", "energy", "energy, signed"]


@pytest.mark.parametrize("ending", ["nc", "zarr"])
@pytest.mark.parametrize("name", NAMES)
def test_a_solution_of_a_limit_is_loaded_and_repeated_bit_for_bit(
    name, ending, tmp_path
):
    path = results()[name].save(tmp_path / f"run.{ending}")
    assert fp.compare(path, results()[name]).equal
    assert fp.compare(fp.load(path), results()[name]).equal
    assert fp.compare(path, fp.rerun(path)).equal


@pytest.mark.parametrize("name", NAMES)
def test_a_report_about_a_solution_of_a_limit_tells_its_numbers(name):
    solution = results()[name]
    page = report_text(solution)
    assert page.count("<figure") == 1
    assert f"ds = {solution.ds:g}" in page
    assert f"{solution.series['relative_entropy'][-1]:.6g}" in page
    extrapolated = solution.errors is not None
    assert ("Not extrapolated" in page) is not extrapolated
    if extrapolated:
        assert f"{solution.errors['relative_entropy'].max():.1e}" in page


def test_a_limit_of_a_users_own_potential_is_reported_as_it_describes_itself(tmp_path):
    path = hydrodynamic(OWN).save(tmp_path / "run.nc")
    with pytest.warns(UserWarning, match="the model could not be read back"):
        page = report_text(path)
    assert "a user&#39;s own functions" in page
    assert page.count("<figure") == 1
    with pytest.raises(fp.errors.NotRepeatableError, match="`model` was your own code"):
        fp.rerun(path)


def test_the_commands_write_what_they_can(fpsolve, tmp_path):
    results()["hydrodynamic"].save(tmp_path / "h.nc")
    results()["energy"].save(tmp_path / "e.nc")
    assert fpsolve("plot", "h.nc").output.split() == ["h-hydrodynamic.png"]
    assert fpsolve("plot", "e.nc").output.split() == ["e-law.png"]
    assert fpsolve("compare", "h.nc", "h.nc").exit_code == 0
    assert fpsolve("rerun", "e.nc").exit_code == 0
    assert fpsolve("report", "e.nc").output.split() == ["e.html"]


def test_without_a_saved_density_there_is_nothing_to_draw():
    for solution in (hydrodynamic(save_at=()), energy(save_at=())):
        assert possible_figures(solution) == {}
        assert "<figure" not in report_text(solution)
    with pytest.raises(ValueError, match="must hold a saved density to show"):
        plotting.plot_hydrodynamic(hydrodynamic(save_at=()))
    with pytest.raises(TypeError, match=r"see HydrodynamicLimit\.solve"):
        plotting.plot_hydrodynamic(3)


def test_a_study_is_loaded_and_drawn(fpsolve):
    path = result_files.result_file("energy.nc")
    assert fp.compare(fp.load(path), path).equal
    found = fpsolve("plot", str(path), "--out", "figures")
    assert found.exit_code == 0, found.output
    assert found.output.split() == [
        f"figures/energy-{name}.png"
        for name in ("orbits", "coefficients", "eigenfunctions")
    ]


def test_averages_are_not_saved_more_often_than_memory_allows():
    with pytest.raises(ValueError, match="`n_saved` must be at most 100000, got 10"):
        studies.ergodic_averages(
            fp.QuadraticPotential(), [1.0], s_end=2.0, n_paths=40, seed=1,
            n_saved=10**12,
        )  # fmt: skip


def test_averages_over_too_few_steps_name_the_step_that_was_chosen():
    with pytest.raises(ValueError, match=r"into at least 4 steps, got 0\.5; try 0\.25"):
        studies.ergodic_averages(
            fp.QuadraticPotential(), [1.0], s_end=1.0, n_paths=40, seed=1
        )
