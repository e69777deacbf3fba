"""Every result can be computed again from its file, to the last bit."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import xarray as xr
from command_line import assert_mistake, files
from solutions import relaxing_solution

import fpsolve as fp
from fpsolve import studies
from fpsolve._support.netcdf import read_dataset, write_dataset
from fpsolve.density.schemes.dictionaries import described_scheme
from fpsolve.errors import NotRepeatableError, RunInterrupted
from fpsolve.evolution.call import CALL, Call
from fpsolve.paths import DensityLaw, GaussianLaw
from fpsolve.results.rerun.arguments import arguments_of
from fpsolve.studies.energy_tables import tables_dataset

GRID = fp.PhaseSpaceGrid(5.0, (12, 14, 8))
QUADRATIC = fp.QuadraticPotential()
MODEL = fp.LayDownModel(QUADRATIC, 1.0)
BELT = fp.LayDownModel(QUADRATIC, 1.0, fp.MovingBelt(0.2))
START = fp.initial.gaussian(
    GRID, mean=(1.0, 0.3), variance=1.0, angle=1.0, concentration=1.0
)
# The grid is a coarse one, made for quick tests.
LENIENT = {
    f"{name}_tolerance": 1.0
    for name in ("mass", "boundary", "negative", "entropy", "circulation")
}
ENERGY = fp.EnergyProcess(QUADRATIC, 0.5)


def solved(scheme=None, **options):
    scheme = fp.drift_kick(MODEL, GRID) if scheme is None else scheme
    return fp.solve(scheme, START, (0.0, 1.0), 0.25, **{**LENIENT, **options})


def sampled(**options):
    return fp.sample_paths(
        BELT, **{"n_paths": 50, "s_end": 1.0, "ds": 0.25, "seed": 3, **options}
    )


def hydrodynamic(**options):
    return fp.HydrodynamicLimit(BELT).solve(
        lambda x, y: np.exp(-((x - 1) ** 2) - y**2), (0.0, 1.0), 0.25,
        grid=fp.PlaneGrid(5.0, (12, 10)), **options,
    )  # fmt: skip


def energy(start, **options):
    return ENERGY.solve(start, (0.0, 2.0), 0.5, grid=ENERGY.grid(20), **options)


# A check refuses a grid on which it could not tell anything.
FINER = fp.PhaseSpaceGrid(5.5, (24, 24, 16))


def checked(p0, **options):
    return studies.cross_check(
        MODEL, p0, [0.5], n_paths=1000, seed=1, grid=FINER, ds=0.25, paths_ds=0.125,
        solve_options={"boundary_tolerance": 1.0}, **options,
    )  # fmt: skip


RESULTS = {
    "solution": lambda: solved(save_at=[0.5, 1.0]),
    "solution, start saved": lambda: solved(save_at=[0.0, 1.0], record_every=2),
    "solution, extrapolated": lambda: solved(extrapolate=True),
    "solution, reference": lambda: solved(reference=START),
    "solution, semi_lagrangian": lambda: solved(
        fp.semi_lagrangian(MODEL, GRID, splitting="lie")
    ),
    "paths": lambda: sampled(save_at=[0.5, 1.0], histogram=GRID),
    "paths, density": lambda: sampled(initial=DensityLaw(GRID, START)),
    "paths, given": lambda: sampled(
        n_paths=3, initial=(np.zeros((3, 2)), np.arange(3.0))
    ),
    "paths, not kept": lambda: sampled(keep=False, method="heun", s_start=0.5),
    "paths, continued": lambda: sampled().continued(2.0),
    "energy, point": lambda: energy(0.2, extrapolate=True),
    "energy, density": lambda: energy(lambda g: 1 + g),
    "energy, masses": lambda: energy(np.arange(20.0)),
    "check, law": lambda: checked(GaussianLaw((0.5, 0.0), 0.8, 1.0, 1.0)),
}


@cache
def result(name):
    """The result of that name, computed once for all tests."""
    return RESULTS[name]()


def write(result, path):
    """Save a result of any kind."""
    if hasattr(result, "save"):
        return result.save(path)
    return write_dataset(
        result.to_xarray() if hasattr(result, "to_xarray") else result, path
    )


# test_every_kind has one of every kind; here what can be asked for.
@pytest.mark.parametrize("name", RESULTS)
def test_a_result_is_repeated_from_its_file_to_the_last_bit(name, tmp_path):
    file = write(result(name), tmp_path / "result.nc")
    comparison = fp.compare(result(name), fp.rerun(file))
    assert comparison.equal, str(comparison)
    assert not comparison.parameters


def test_a_zarr_store_and_an_object_are_repeated_too(tmp_path):
    solution = solved()
    for given in (solution, solution.save(tmp_path / "result.zarr")):
        assert fp.compare(solution, fp.rerun(given)).equal
    check = result("check, law")
    assert isinstance(fp.rerun(check), studies.CrossCheck)


def test_arguments_can_be_changed(tmp_path):
    file = solved(save_at=[1.0]).save(tmp_path / "result.nc")
    finer = fp.rerun(file, ds=0.125, extrapolate=True)
    assert finer.ds == 0.125
    comparison = fp.compare(file, finer)
    assert "ds: 0.25 in A, 0.125 in B" in comparison.parameters
    assert fp.rerun(sampled(), n_paths=7).n_paths == 7
    assert fp.rerun(hydrodynamic(), method="sdirk2").method == "sdirk2"
    assert fp.rerun(energy(0.2), ds=0.25).ds == 0.25
    study = studies.rate_versus_noise(
        QUADRATIC, [2.0], quick=True, parts=["gap"], workers=0
    )
    assert fp.rerun(study, noises=[3.0], workers=0)["noise"].item() == 3.0


def stopped_at(step):
    """A progress callback that interrupts once so many steps are done."""

    def report(n_done, n_total, s):
        if n_done >= step:
            raise KeyboardInterrupt

    return report


def test_of_an_interrupted_run_the_whole_is_repeated(tmp_path):
    with pytest.raises(RunInterrupted) as stopped:
        solved(save_at=[0.25, 1.0], progress=stopped_at(2))
    part = stopped.value.solution
    assert part.status == "interrupted"
    whole = fp.rerun(part.save(tmp_path / "part.nc"))
    assert fp.compare(whole, solved(save_at=[0.25, 1.0])).equal
    assert not fp.compare(part, whole).differing


def test_of_interrupted_paths_all_are_repeated(tmp_path):
    with pytest.raises(RunInterrupted) as stopped:
        sampled(save_at=[0.5, 1.0], progress=stopped_at(100))
    part = stopped.value.solution
    assert part.ensemble.schedule.n_steps < 4
    whole = fp.rerun(part.save(tmp_path / "part.nc"))
    assert fp.compare(whole, sampled(save_at=[0.5, 1.0])).equal


def test_a_failed_run_fails_again_in_the_same_way():
    with pytest.raises(fp.DomainTooSmallError) as failed:
        solved(boundary_tolerance=1e-6)
    part = failed.value.solution
    assert part.status == "failed"
    assert fp.compare(part, fp.rerun(part)).equal


def own_value(x, y):
    return (x**2 + y**2) / 2


def own_gradient(x, y):
    return x + 0 * y, y + 0 * x


def test_a_class_of_the_user_is_not_run_again_as_the_one_it_inherits_from(tmp_path):
    class Own(type(fp.drift_kick(MODEL, GRID))):
        pass

    solution = solved(Own(MODEL, GRID))
    file = solution.save(tmp_path / "own.nc")
    with pytest.raises(NotRepeatableError, match="a class of your own that calls"):
        fp.rerun(file)
    assert fp.compare(solution, fp.rerun(file, scheme=Own(MODEL, GRID))).equal
    (named,) = fp.compare(solution, solved(fp.drift_kick(MODEL, GRID))).parameters
    assert named.startswith("scheme.code: ")


def test_for_a_potential_of_ones_own_the_model_must_be_given(tmp_path):
    own = fp.LayDownModel(fp.CallablePotential(own_value, own_gradient), 1.0)
    solution = solved(fp.drift_kick(own, GRID))
    file = solution.save(tmp_path / "own.nc")
    message = (
        r"`model` was your own code .*own_value.*, which no file holds; pass it as "
        r"`fpsolve\.rerun\(file, model=\.\.\.\)`"
    )
    with pytest.raises(NotRepeatableError, match=message):
        fp.rerun(file)
    again = fp.rerun(file, model=own)
    np.testing.assert_array_equal(again.densities, solution.densities)
    # Until it is written the result has it.
    assert fp.compare(solution, fp.rerun(solution)).equal


def test_for_functions_of_ones_own_they_must_be_given():
    functions = {"mine": lambda xi1, xi2, alpha: xi1**2 + 0 * alpha}
    arguments = {"s_end": 2.0, "n_paths": 40, "seed": 1}
    found = studies.ergodic_averages(QUADRATIC, [1.0], functions=functions, **arguments)
    with pytest.raises(NotRepeatableError, match="`functions` was your own code"):
        fp.rerun(found)
    assert fp.compare(found, fp.rerun(found, functions=functions)).equal


def test_a_start_of_ones_own_must_be_given():
    class Corner:
        def sample(self, rng, n):
            return np.ones((n, 2)), np.zeros(n)

    paths = sampled(initial=Corner())
    assert fp.compare(paths, fp.rerun(paths)).equal
    lost = replace(paths, ensemble=replace(paths.ensemble, law=None))
    with pytest.raises(NotRepeatableError, match="`initial` was your own code"):
        fp.rerun(lost)
    assert fp.compare(paths, fp.rerun(lost, initial=Corner()))["xi"].equal


def test_results_that_do_not_say_how_they_were_made_are_refused():
    message = "the result does not say how it was computed; it was put together "
    with pytest.raises(NotRepeatableError, match=message):
        fp.rerun(relaxing_solution())
    message = "the result does not say its `p0`; it was put together by hand"
    with pytest.raises(NotRepeatableError, match=message):
        fp.rerun(replace(solved(), initial_density=None))
    old = tables_dataset(ENERGY, 3, 2)
    del old.attrs[CALL]
    with pytest.raises(NotRepeatableError, match="does not say how it was computed"):
        fp.rerun(old)
    for limit in (hydrodynamic(), energy(0.2)):
        with pytest.raises(
            NotRepeatableError, match="does not say how it was computed"
        ):
            fp.rerun(replace(limit, call=None))
    with pytest.raises(NotRepeatableError, match="`result` must be a result of"):
        fp.rerun(3.0)


def test_paths_that_went_on_are_repeated_in_one_go_with_changes():
    fewer = fp.rerun(sampled().continued(2.0), n_paths=3)
    assert np.array_equal(fewer.states, sampled(n_paths=3, s_end=2.0).states)


def test_the_functions_of_a_study_are_a_closed_list():
    dataset = tables_dataset(ENERGY, 3, 2)
    strange = Call.of("os.remove", {"path": "x"}).on(dataset)
    with pytest.raises(NotRepeatableError, match=r"got 'os\.remove'; update fpsolve"):
        fp.rerun(strange)


@pytest.mark.parametrize(
    "value",
    [
        1.5, "text", None, True, [1, 2.5], {"a": {"b": 1}}, QUADRATIC, BELT, GRID,
        fp.PlaneGrid(3.0, (4, 5)), GaussianLaw((0.5, 0.0), 0.8, 1.0, 1.0),
    ],
)  # fmt: skip
def test_arguments_survive_a_call(value):
    call = written(Call.of("f", {"x": value}))
    assert call.function == "f"
    # What has its default is not written.
    assert arguments_of(call, {}) == ({} if value is None else {"x": value})


def written(call):
    """The call as a dataset holds it."""
    return Call.from_xarray(call.on(xr.Dataset()))


@pytest.mark.parametrize("shape", [(300,), (4, 5), (2, 2, 2)])
def test_long_arrays_are_variables_beside_the_call(shape):
    values = np.random.default_rng(1).standard_normal(shape)
    pair = (GRID, values)
    found = arguments_of(written(Call.of("f", {"p0": pair, "x": values})), {})
    assert isinstance(found["p0"], tuple)
    assert found["p0"][0] == GRID
    np.testing.assert_array_equal(found["p0"][1], values)
    np.testing.assert_array_equal(found["x"], values)


def test_a_density_and_a_scheme_survive_a_call():
    law = DensityLaw(GRID, START)
    scheme = fp.drift_kick(MODEL, GRID, positive=True)
    call = Call.of("f", {"law": law, "scheme": described_scheme(scheme)})
    found = arguments_of(written(call), {})
    np.testing.assert_array_equal(found["law"].p, START)
    assert found["scheme"].options == scheme.options
    assert found["scheme"].model == MODEL


def test_seeds_survive_a_call():
    seed = np.random.SeedSequence(2**100, spawn_key=(1, 2))
    found = arguments_of(written(Call.of("f", {"seed": seed})), {})
    assert found["seed"].entropy == seed.entropy
    assert found["seed"].spawn_key == seed.spawn_key


def test_a_call_names_the_argument_that_no_file_holds():
    call = written(Call.of("f", {"x": {"mine": own_value}}))
    with pytest.raises(NotRepeatableError, match=r"`x` was your own code \(own_value"):
        arguments_of(call, {})
    assert arguments_of(call, {"x": 1}) == {"x": 1}


RUN = """\
[potential]
kind = "quadratic"
[model]
noise = 1.0
[grid]
half_width = 5.0
shape = [12, 12, 8]
[initial]
kind = "equilibrium"
[scheme]
kind = "drift_kick"
[run]
s_end = 0.5
ds = 0.25
boundary_tolerance = 1.0
[output]
name = "small"
figures = false
"""


def test_the_result_of_a_command_is_repeated_by_a_command(fpsolve, tmp_path):
    (tmp_path / "small.toml").write_text(RUN)
    assert fpsolve("run", "small.toml").exit_code == 0
    result = fpsolve("rerun", "results/small.nc", "--threads", "1")
    assert result.exit_code == 0, result.output
    assert "equal: the same bits in all" in result.stdout
    assert files(tmp_path / "rerun") == ["small.nc"]
    again = fp.load(tmp_path / "rerun/small.nc")
    before = fp.load(tmp_path / "results/small.nc")
    assert again.provenance["configuration"] == before.provenance["configuration"]


def test_a_result_that_is_not_repeated_is_a_failure(fpsolve, tmp_path):
    solution = solved()
    densities = solution.densities + 1e-6
    replace(solution, densities=densities).save(tmp_path / "wrong.nc")
    result = fpsolve("rerun", "wrong.nc")
    assert result.exit_code == 1
    assert "density" in result.stdout
    # Rounding of another machine is none.
    densities = solution.densities * (1 + 1e-13)
    replace(solution, densities=densities).save(tmp_path / "close.nc")
    result = fpsolve("rerun", "close.nc")
    assert result.exit_code == 0, result.output
    assert "rounding explains this" in result.stdout


def test_a_part_is_repeated_whole_by_a_command(fpsolve, tmp_path):
    with pytest.raises(RunInterrupted) as stopped:
        solved(save_at=[0.25, 1.0], progress=stopped_at(2))
    stopped.value.solution.save(tmp_path / "run-interrupted.nc")
    result = fpsolve("rerun", "run-interrupted.nc")
    assert result.exit_code == 0, result.output
    assert "the file holds an interrupted run; the whole is repeated" in result.stdout
    assert "the part that both have is the same" in result.stdout
    assert files(tmp_path / "rerun") == ["run.nc"]


def test_the_file_of_a_study_names_its_command_and_is_repeated(fpsolve, tmp_path):
    command = ["spectrum", "--noise", "2", "-n", "1", "--tolerance", "1e-6"]
    assert fpsolve(*command, "--no-figures").exit_code == 0
    used = read_dataset(tmp_path / "results/spectrum.nc").attrs["command"]
    assert used == (
        "fpsolve spectrum --potential quadratic --sigma1 1.0 --sigma2 1.0 --noise 2.0 "
        "--count 1 --tolerance 1e-06"
    )
    result = fpsolve("rerun", "results/spectrum.nc")
    assert result.exit_code == 0, result.output
    assert f"repeating spectra: {used}" in result.stdout
    assert fpsolve(*used.split()[1:], "--no-figures", "--out", "c").exit_code == 0
    first, second = (tmp_path / one / "spectrum.nc" for one in ("results", "c"))
    assert fp.compare(first, second).equal


def test_mistakes_of_the_command_are_one_line(fpsolve, tmp_path):
    result = fpsolve("rerun", "missing.nc")
    assert_mistake(result, "`path` must exist to be read, got `missing.nc`.")
    relaxing_solution().save(tmp_path / "old.nc")
    assert_mistake(fpsolve("rerun", "old.nc"), "the result does not say how it was")
    message = "`--out` must not be the folder of the file, got `.`; the result"
    assert_mistake(fpsolve("rerun", "old.nc", "--out", "."), message)
    assert files(tmp_path) == ["old.nc"]
