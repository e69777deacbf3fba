"""`fpsolve check` says whether density and paths agree, and its exit code does too."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from matplotlib.image import imread

from fpsolve.paths import sample_paths

CONFIG = """
[potential]
kind = "quadratic"

[model]
noise = 1.0

[grid]
half_width = 6.0
shape = [32, 32, 16]

[initial]
kind = "gaussian"
mean = [1.0, 0.0]
variance = 0.5
angle = 1.5
concentration = 2.0

[scheme]
kind = "drift_kick"

[run]
s_end = 1.0
ds = 0.125
save_every = 0.25

[output]
name = "small"
"""


@pytest.fixture
def fpsolve_check(fpsolve):
    """Call the command in an empty folder; returns what click recorded."""
    return lambda *words: fpsolve("check", *words)


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "run.toml"
    path.write_text(CONFIG)
    return path


@pytest.fixture
def paths_of_more_noise(monkeypatch):
    """Paths of a process with more noise than the density knows of."""

    def sampled(model, *arguments, **options):
        return sample_paths(replace(model, noise=1.2), *arguments, **options)

    monkeypatch.setattr("fpsolve.paths.sampling.sample_paths", sampled)


def assert_mistake(result, message, code=2):
    """One line of error, the right exit code, no traceback."""
    assert result.exit_code == code, result.output
    assert message in result.stderr
    assert result.stderr.startswith("error: ")
    assert "Traceback" not in result.output


def files(folder):
    return sorted(path.name for path in folder.iterdir())


def test_agreement_is_said_written_and_drawn(fpsolve_check, config, tmp_path):
    result = fpsolve_check(config, "--n-paths", 20_000, "--out", "out")
    assert result.exit_code == 0, result.output
    shown = result.stdout
    assert "equation  ∂ₛp + τ(α)·∇p - ∂_α(∇B·τ⊥ p) = 0.5 ∂_αα p" in shown
    for column in ("χ²/k of cells", "largest cell", "largest moment", "tests failed"):
        assert column in shown
    # The first, the middle and the last of what the file saves.
    rows = [line for line in shown.splitlines() if line.endswith("0 of 14  ")]
    assert [row.split()[0] for row in rows] == ["0.25", "0.75", "1"]
    assert "Density and paths agree at s = 0.25, 0.75 and 1: all 42 tests" in shown
    assert "Seen with probability 0.99" in shown
    names = ["small-check.json", "small-check.nc", "small-check.png"]
    assert files(tmp_path / "out") == names
    for name in names:
        assert f"out/{name}" in shown
    numbers = json.loads((tmp_path / "out" / "small-check.json").read_text())
    assert numbers["agrees"] is True
    assert numbers["n_paths"] == 20_000
    assert numbers["sampler"]["seed"] == 1
    with xr.open_dataset(tmp_path / "out" / "small-check.nc") as dataset:
        assert dataset.sizes["s"] == 3
    assert imread(tmp_path / "out" / "small-check.png").shape[1] == 1400


def test_disagreement_is_exit_code_one_and_is_written_too(
    fpsolve_check, config, tmp_path, paths_of_more_noise
):
    result = fpsolve_check(config, "--n-paths", 20_000, "--at", 1.0, "--out", "out")
    assert result.exit_code == 1, result.output
    assert "Density and paths DISAGREE at s = 1: " in result.stdout
    assert "by the density" in result.stdout
    assert "Traceback" not in result.output
    numbers = json.loads((tmp_path / "out" / "small-check.json").read_text())
    assert numbers["agrees"] is False
    assert files(tmp_path / "out") == [
        "small-check.json", "small-check.nc", "small-check.png",
    ]  # fmt: skip


def test_arclengths_seed_steps_and_figures_are_chosen(fpsolve_check, config, tmp_path):
    words = ("--n-paths", 2000, "--at", 0.5, "--at", 1, "--seed", 7)
    more = ("--paths-ds", 0.125, "--false-alarm", 0.01, "--no-figures")
    result = fpsolve_check(config, *words, *more, "--out", "out")
    assert result.exit_code == 0, result.output
    assert "Paths: 2000 by splitting, ds = 0.125, seed 7." in result.stdout
    assert "fail with probability at most 0.01" in result.stdout
    assert files(tmp_path / "out") == ["small-check.json", "small-check.nc"]
    numbers = json.loads((tmp_path / "out" / "small-check.json").read_text())
    np.testing.assert_array_equal(numbers["s"], [0.5, 1.0])


def test_without_a_file_the_packaged_example_is_checked(fpsolve_check, tmp_path):
    result = fpsolve_check("--n-paths", 2000, "--at", 0.5, "--no-figures")
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "results") == ["laydown-check.json", "laydown-check.nc"]


def test_bad_input_is_one_line_and_exit_code_two(fpsolve_check, config, tmp_path):
    assert_mistake(fpsolve_check("none.toml"), "got `none.toml`; leave it out")
    assert_mistake(fpsolve_check(config, "--n-paths", 5), "`n_paths` must be at least")
    assert_mistake(fpsolve_check(config, "--at", -1), "`s` must be one or more")
    assert_mistake(
        fpsolve_check(config, "--n-paths", 2000, "--at", 0.3), "`ds` must divide"
    )
    assert_mistake(
        fpsolve_check(config, "--false-alarm", 2), "`false_alarm` must lie between"
    )
    assert_mistake(
        fpsolve_check("--example", "laydwn"), "got 'laydwn'; did you mean `laydown`?"
    )
    assert files(tmp_path) == ["run.toml"]


def test_a_run_that_fails_is_one_line_and_exit_code_one(
    fpsolve_check, config, tmp_path
):
    narrow = CONFIG.replace("half_width = 6.0", "half_width = 3.5")
    config.write_text(narrow.replace("[1.0, 0.0]", "[1.7, 0.0]"))
    result = fpsolve_check(config, "--n-paths", 2000)
    assert_mistake(result, "error: boundary mass", code=1)
    assert files(tmp_path) == ["run.toml"]


def test_the_tolerances_of_the_file_hold_for_the_check_too(fpsolve_check, config):
    config.write_text(
        CONFIG.replace("half_width = 6.0", "half_width = 3.5").replace(
            "ds = 0.125", "ds = 0.125\nboundary_tolerance = 0.2"
        )
    )
    result = fpsolve_check(config, "--n-paths", 2000, "--at", 0.25, "--no-figures")
    assert result.exit_code == 0, result.output


def test_ctrl_c_leaves_nothing(fpsolve_check, config, tmp_path, monkeypatch):
    def interrupted(*arguments, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("fpsolve.paths.sampling.sample_paths", interrupted)
    result = fpsolve_check(config, "--n-paths", 2000)
    assert_mistake(result, "interrupted", code=130)
    assert files(tmp_path) == ["run.toml"]
