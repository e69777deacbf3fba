"""`fpsolve paths` samples what a file asks for; a mistake costs one line, no file."""

import signal
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from command_line import HANGS, assert_mistake, command_waiting_at, files

import fpsolve as fp
from fpsolve.cli.config import PathsConfig, load_config
from fpsolve.pages.numbers import with_error

ROOT = Path(__file__).parents[2]
CONFIG = """
[potential]
kind = "quadratic"

[model]
noise = 1.0

[curve]
kind = "moving_belt"
speed = 0.1

[paths]
n_paths = 20
s_end = 1.0
ds = 0.125
seed = 5
save_every = 0.5

[histogram]
half_width = 4.0
shape = [8, 8, 8]

[output]
name = "few"
"""
PROCESS = """
[process]
sigma1 = 0.010
sigma2 = 0.010
noise = 16.0
speed_ratio = 0.1
spinning_speed = 50.0
"""


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "paths.toml"
    path.write_text(CONFIG)
    return path


def interrupting(at):
    """A progress bar at which the user presses Ctrl-C when s passes `at`."""

    @contextmanager
    def bar():
        def report(n_done, n_total, s):
            if s >= at:
                raise KeyboardInterrupt

        yield report

    return bar


def test_sampling_writes_paths_configuration_and_figures(
    fpsolve, config, tmp_path, undrawn
):
    result = fpsolve("paths", config, "--out", "out")
    assert result.exit_code == 0, result.output
    names = ["few-ensemble.png", "few-fibre.png", "few.nc", "few.toml"]
    assert files(tmp_path / "out") == names
    for name in names:
        assert f"out/{name}" in result.stdout
    loaded = fp.load(tmp_path / "out" / "few.nc")
    expected = fp.sample_paths(
        fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1)),
        20, 1.0, 0.125, seed=5, save_at=(0.0, 0.5, 1.0),
    )  # fmt: skip
    np.testing.assert_array_equal(loaded.states, expected.states)


def test_sampling_says_what_it_does_and_what_came_out(fpsolve, config, tmp_path):
    shown = fpsolve("paths", config, "--out", "out", "--no-figures").stdout
    assert "dξ = (τ(α) + 0.1 e₁) ds, dα = -∇B(ξ)·τ⊥(α) ds + 1 dW, B = " in shown
    assert "ξ = 0, α uniform" in shown
    assert "20 of length 1, ds = 0.125, saved at 3 arclengths" in shown
    assert "splitting" in shown
    assert "5 (from the configuration)" in shown
    assert "8 x 8 x 8 cells, |ξ₁| < 4, |ξ₂| < 4" in shown
    for column in ("E ξ₁", "E ξ₂", "Var ξ₁", "Var ξ₂", "E cos α"):
        assert column in shown
    moments = fp.load(tmp_path / "out" / "few.nc").moments()
    value, error = moments["variance_xi1"]
    assert with_error(value[-1], error[-1]) in shown
    assert "one standard error" in shown
    assert "finished after" in shown


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.15312, 0.0157, "0.153(16)"),
        (-0.0002, 0.0157, "-0.000(16)"),
        (3.21, 1.6, "3.2(1.6)"),
        (123.4, 45.0, "123(45)"),
        (1.5, 0.0, "1.5"),
        (1.5, float("nan"), "1.5"),
        (0.37429405198, 1.2e-10, "0.3742940520(1)"),
        (0.37429405198, 1e-13, "0.3742940520"),
    ],
)
def test_errors_are_printed_with_two_digits(value, error, text):
    assert with_error(value, error) == text


def test_the_paths_can_be_repeated_from_what_was_written(fpsolve, config, tmp_path):
    config.write_text(CONFIG.replace("seed = 5\n", ""))
    result = fpsolve("paths", config, "--out", "first", "--no-figures")
    assert "(drawn)" in result.stdout
    written = tmp_path / "first" / "few.toml"
    fpsolve("paths", written, "--out", "second")
    first, second = (
        fp.load(tmp_path / name / "few.nc") for name in ("first", "second")
    )
    np.testing.assert_array_equal(first.states, second.states)
    assert first.provenance["configuration"] == written.read_text()
    # Figures were switched off for the first, and so are they for its repetition.
    assert files(tmp_path / "second") == ["few.nc", "few.toml"]


def test_options_take_the_place_of_keys_and_are_written_down(fpsolve, config, tmp_path):
    words = ("--n-paths", 30, "--seed", 6, "--no-figures", "--out", "out")
    result = fpsolve("paths", config, *words)
    assert result.exit_code == 0, result.output
    assert "6 (from `--seed`)" in result.stdout
    loaded = fp.load(tmp_path / "out" / "few.nc")
    assert (loaded.n_paths, loaded.seed) == (30, 6)
    used = load_config(tmp_path / "out" / "few.toml", PathsConfig).paths
    assert (used.n_paths, used.seed) == (30, 6)


def test_path_k_is_the_same_for_any_number_of_paths(fpsolve, config, tmp_path):
    fpsolve("paths", config, "--no-figures", "--out", "few")
    fpsolve("paths", config, "--no-figures", "--out", "many", "--n-paths", 100)
    few, many = (fp.load(tmp_path / name / "few.nc") for name in ("few", "many"))
    np.testing.assert_array_equal(few.xi, many.xi[:, :20])


def test_without_a_file_the_example_is_sampled(fpsolve, tmp_path):
    result = fpsolve("paths", "--out", "out", "--n-paths", 10, "--no-figures")
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "out") == ["fibres.nc", "fibres.toml"]


def test_a_process_is_shown_with_its_units(fpsolve, config):
    config.write_text(PROCESS + CONFIG[CONFIG.index("[paths]") :])
    result = fpsolve("paths", config, "--out", "out", "--no-figures")
    assert result.exit_code == 0, result.output
    assert "ξ and s in units of 10 mm, laid down in 0.2 ms" in result.stdout


def test_positions_need_not_be_kept(fpsolve, config, tmp_path, undrawn):
    config.write_text(CONFIG.replace("seed = 5", "seed = 5\nkeep = false"))
    result = fpsolve("paths", config, "--out", "out")
    assert result.exit_code == 0, result.output
    assert "positions not kept" in result.stdout
    assert not fp.load(tmp_path / "out" / "few.nc").kept


def test_paths_can_be_stored_as_zarr(fpsolve, config, tmp_path):
    config.write_text(CONFIG + 'format = "zarr"\n')
    result = fpsolve("paths", config, "--out", "out", "--no-figures")
    assert result.exit_code == 0, result.output
    assert fp.load(tmp_path / "out" / "few.zarr").status == "finished"


def test_a_misspelt_key_is_answered_with_the_nearest(fpsolve, config, tmp_path):
    config.write_text(CONFIG.replace("save_every", "save_evry"))
    result = fpsolve("paths", config, "--out", "out")
    assert_mistake(result, "`save_evry` is not a key; did you mean `save_every`?")
    assert files(tmp_path) == ["paths.toml"]


def test_a_configuration_of_a_run_names_its_command(fpsolve, config, tmp_path):
    laydown = ROOT / "fpsolve" / "examples" / "laydown.toml"
    assert_mistake(fpsolve("paths", laydown), "its sections are those of `fpsolve run`")
    assert_mistake(fpsolve("run", config), "its sections are those of `fpsolve paths`")
    assert files(tmp_path) == ["paths.toml"]


def test_a_configuration_that_is_not_there_is_named(fpsolve):
    assert_mistake(fpsolve("paths", "none.toml"), "got `none.toml`; leave it out")


def test_a_start_that_does_not_exist_leaves_no_folder(fpsolve, config, tmp_path):
    text = CONFIG.replace('"quadratic"', '"free"')
    config.write_text(text + '\n[start]\nkind = "equilibrium"\n')
    result = fpsolve("paths", config, "--out", "out")
    assert_mistake(result, "section [start]: `potential` must")
    assert files(tmp_path) == ["paths.toml"]


@pytest.mark.parametrize("option", ["--n-paths=0", "--seed=-1", "--outt=x"])
def test_options_that_make_no_sense_are_refused(fpsolve, tmp_path, option):
    result = fpsolve("paths", option)
    assert result.exit_code == 2
    assert option.partition("=")[0] in result.stderr
    assert "Traceback" not in result.output
    assert files(tmp_path) == []


def test_too_many_threads_are_refused(fpsolve, config):
    assert_mistake(fpsolve("paths", config, "--threads", 9999), "must be at most")


def test_paths_that_do_not_fit_into_memory_never_start(fpsolve, config, tmp_path):
    result = fpsolve("paths", config, "--out", "out", "--n-paths", 10**12)
    assert result.exit_code == 1, result.output
    assert "GiB are available" in result.stderr
    assert "Traceback" not in result.output
    assert not (tmp_path / "out").exists() or not files(tmp_path / "out")


def test_an_interrupt_keeps_what_was_finished(fpsolve, config, tmp_path, monkeypatch):
    fpsolve("paths", config, "--out", "out", "--no-figures")
    complete = (tmp_path / "out" / "few.nc").read_bytes()
    monkeypatch.setattr("fpsolve.cli.progress.progress_bar", interrupting(at=0.75))
    result = fpsolve("paths", config, "--out", "out")
    assert_mistake(result, "interrupted; what was finished until then is kept", 130)
    assert "interrupted after" in result.stdout
    partial = fp.load(tmp_path / "out" / "few-interrupted.nc")
    assert partial.status == "interrupted"
    np.testing.assert_array_equal(partial.s, [0.0, 0.5])
    # The paths of the earlier, complete sampling are still there.
    assert (tmp_path / "out" / "few.nc").read_bytes() == complete


def test_an_interrupt_elsewhere_leaves_nothing(fpsolve, config, tmp_path, monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("fpsolve.cli.plan.print_paths_plan", interrupted)
    assert_mistake(fpsolve("paths", config, "--out", "out"), "interrupted", 130)
    assert not (tmp_path / "out").exists() or not files(tmp_path / "out")


def test_a_full_disk_is_an_error_without_a_traceback(
    fpsolve, config, tmp_path, monkeypatch
):
    def full(*arguments, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("xarray.Dataset.to_netcdf", full)
    result = fpsolve("paths", config, "--out", "out")
    assert_mistake(result, "No space left on device", code=1)
    assert not (tmp_path / "out").exists() or not files(tmp_path / "out")


def test_stored_paths_are_drawn_beside_themselves_or_elsewhere(
    fpsolve, config, tmp_path, undrawn
):
    fpsolve("paths", config, "--out", "out", "--no-figures")
    result = fpsolve("plot", "out/few.nc")
    assert result.exit_code == 0, result.output
    assert result.stdout.split() == ["out/few-ensemble.png", "out/few-fibre.png"]
    result = fpsolve("plot", "out/few.nc", "--out", "elsewhere")
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "elsewhere") == ["few-ensemble.png", "few-fibre.png"]


def test_a_movie_of_paths_is_refused_before_anything_is_drawn(
    fpsolve, config, tmp_path
):
    fpsolve("paths", config, "--out", "out", "--no-figures")
    result = fpsolve("plot", "out/few.nc", "--movie")
    assert_mistake(result, "`--movie` must be given with the result of `fpsolve run`")
    assert files(tmp_path / "out") == ["few.nc", "few.toml"]


@pytest.mark.parametrize("command", ["paths", "check"])
def test_help_shows_a_working_example(fpsolve, command):
    result = fpsolve(command, "--help")
    assert result.exit_code == 0
    assert f"Example: fpsolve {command}" in result.stdout


@pytest.mark.processes
@pytest.mark.nightly
def test_a_signal_stops_the_sampling_and_keeps_what_is_done(config, tmp_path):
    at = "save_at = [0.0, 0.125, 0.5, 1.0]"
    config.write_text(CONFIG.replace("save_every = 0.5", at))
    # Four steps of twenty paths: there the third one has not been kept yet.
    process = command_waiting_at(80, "paths", config, cwd=tmp_path)
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=HANGS)
    assert process.returncode == 130, stderr
    assert "interrupted" in stderr
    assert "Traceback" not in stderr
    partial = fp.load(tmp_path / "results" / "few-interrupted.nc")
    assert partial.status == "interrupted"
    np.testing.assert_array_equal(partial.s, [0.0, 0.125])
