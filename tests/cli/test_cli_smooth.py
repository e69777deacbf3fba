"""`fpsolve run` solves for smooth fibres what a file asks for."""

import numpy as np
import pytest
from command_line import assert_mistake, files

import fpsolve as fp
from fpsolve.cli.config import RunConfig, load_config

CONFIG = """
[potential]
kind = "quadratic"

[model]
noise = 1.0
relaxation_length = 0.2

[curve]
kind = "moving_belt"
speed = 0.1

[grid]
half_width = 5.0
shape = [10, 10, 8]
kappa_half_width = 8.5
n_kappa = 16

[initial]
kind = "gaussian"
variance = 1.2

[scheme]
kind = "smooth_drift_kick"

[run]
s_end = 0.5
ds = 0.125
boundary_tolerance = 0.1

[output]
name = "smooth"
figures = false
"""


@pytest.fixture
def run(fpsolve, tmp_path):
    def run(text=CONFIG):
        path = tmp_path / "smooth.toml"
        path.write_text(text, encoding="utf-8")
        return fpsolve("run", path, "--out", tmp_path / "out")

    return run


def test_a_smooth_run_from_a_file_is_that_of_the_library(run, tmp_path):
    answer = run()
    assert answer.exit_code == 0, answer.output
    assert "|κ| < 8.5" in answer.output
    found = fp.load(tmp_path / "out/smooth.nc")
    problem = load_config(tmp_path / "smooth.toml", RunConfig).build()
    solved = fp.solve(problem.scheme, problem.p0, **problem.arguments)
    assert np.array_equal(found.final, solved.final)
    # The file beside the result says it all again.
    again = load_config(tmp_path / "out/smooth.toml", RunConfig).build()
    assert (again.grid, again.model) == (problem.grid, problem.model)
    assert np.array_equal(again.p0, problem.p0)


def test_a_smooth_configuration_is_checked_against_paths(fpsolve, tmp_path):
    path = tmp_path / "smooth.toml"
    path.write_text(CONFIG.replace("ds = 0.125", "ds = 0.0625"), encoding="utf-8")
    words = (
        "--n-paths",
        "2000",
        "--seed",
        "3",
        "--no-figures",
        "--out",
        tmp_path / "out",
    )
    answer = fpsolve("check", path, *words)
    assert answer.exit_code == 0, answer.output
    assert "all 14 tests passed" in answer.output
    assert fp.load(tmp_path / "out/smooth-check.nc").agrees


@pytest.mark.parametrize(
    ("line", "instead", "message"),
    [
        ("n_kappa = 16", "", "`kappa_half_width` and `n_kappa` must be given together"),
        ("n_kappa = 16", "n_kappa = 3", "`shape[3] (n_kappa)` must be"),
        ("relaxation_length = 0.2", "", "`relaxation_length` of [model] must be given"),
        ("relaxation_length = 0.2", "relaxation_length = 0.0",
         "`relaxation_length` must be positive"),
        ("smooth_drift_kick", "drift_kick", "`model` must be a LayDownModel"),
        ("kappa_half_width = 8.5", "kappa_half_width = 17.0",
         "`grid` must have cells in κ no wider than"),
    ],
)  # fmt: skip
def test_what_does_not_fit_costs_a_line_and_leaves_no_file(
    run, tmp_path, line, instead, message
):
    assert_mistake(run(CONFIG.replace(line, instead)), message)
    assert not (tmp_path / "out").exists() or files(tmp_path / "out") == []


def test_a_smooth_run_without_a_grid_gets_one_that_is_kept(run, tmp_path):
    start, rest = CONFIG.split("[grid]")
    text = start + rest[rest.index("[initial]") :]
    answer = run(text.replace("s_end = 0.5", "s_end = 0.25\ntolerance = 0.5"))
    assert answer.exit_code == 0, answer.output
    grid = fp.load(tmp_path / "out/smooth.nc").grid
    assert isinstance(grid, fp.SmoothPhaseSpaceGrid)
    assert "are 6 times" in answer.output
    written = load_config(tmp_path / "out/smooth.toml", RunConfig)
    assert written.grid.make() == grid


def test_the_spectrum_of_a_smooth_fibre_is_that_of_the_library(fpsolve, tmp_path):
    answer = fpsolve(
        "spectrum", "--noise", 4, "--relaxation-length", 0.1, "--count", 1,
        "--tolerance", 1e-3, "--no-figures", "--out", tmp_path,
    )  # fmt: skip
    assert answer.exit_code == 0, answer.output
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 0.1, 4.0)
    found = fp.load(tmp_path / "spectrum.nc")
    assert found.model == model
    assert found.gap == fp.spectral_gap(model, tolerance=1e-3)
    assert f"gap {found.gap:.12g}" in answer.output


def test_a_spectrum_of_a_smooth_fibre_without_a_basis_is_a_mistake(fpsolve, tmp_path):
    answer = fpsolve(
        "spectrum", "--relaxation-length", 0.1, "--potential", "linear",
        "--out", tmp_path,
    )  # fmt: skip
    assert_mistake(answer, "`potential` must be a QuadraticPotential")


# A fibre about a belt at rest, of which there is a spectrum.
AT_REST = CONFIG.replace('kind = "moving_belt"\nspeed = 0.1', 'kind = "fixed_belt"')
AT_REST = AT_REST.replace("noise = 1.0", "noise = 4.0")


@pytest.mark.nightly
def test_a_spectrum_from_the_file_of_a_run_is_that_of_its_model(fpsolve, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(AT_REST, encoding="utf-8")
    answer = fpsolve(
        "spectrum", path, "--count", 1, "--tolerance", 1e-3, "--no-figures",
        "--out", tmp_path,
    )  # fmt: skip
    assert answer.exit_code == 0, answer.output
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 0.2, 4.0)
    found = fp.load(tmp_path / "spectrum.nc")
    assert found.model == model
    assert found.gap == fp.spectral_gap(model, tolerance=1e-3)
    assert found.provenance["command"].startswith("fpsolve spectrum case.toml --count")
    assert "relaxation_length = 0.2" in found.provenance["configuration"]


def test_a_spectrum_takes_its_model_from_a_file_or_from_options(fpsolve, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(AT_REST, encoding="utf-8")
    for option, value in (("--noise", 1.0), ("--sigma1", 1), ("--belt-speed", 0)):
        answer = fpsolve("spectrum", path, option, value, "--out", tmp_path / "out")
        assert_mistake(answer, f"`{option}` must not be given beside a file")


def test_a_spectrum_from_a_file_with_a_mistake_names_section_and_key(fpsolve, tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(AT_REST.replace("relaxation_length", "length"), encoding="utf-8")
    answer = fpsolve("spectrum", path, "--out", tmp_path / "out")
    assert_mistake(answer, "relaxation_length")
    path.write_text(AT_REST.replace("quadratic", "linear"), encoding="utf-8")
    answer = fpsolve("spectrum", path, "--out", tmp_path / "out")
    assert_mistake(answer, "`potential` must be a QuadraticPotential")
