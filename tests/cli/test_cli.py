"""The command line does what it says, and a mistake costs one line and no file."""

import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from command_line import HANGS, assert_mistake, command_waiting_at, files
from solutions import relaxing_solution

import fpsolve as fp
from fpsolve.cli.config import load_config

ROOT = Path(__file__).parents[2]
CONFIG = """
[potential]
kind = "quadratic"

[model]
noise = 1.0

[grid]
half_width = 6.0
shape = [24, 24, 16]

[initial]
kind = "gaussian"
variance = 0.5

[scheme]
kind = "drift_kick"

[run]
s_end = 1.0
ds = 0.125
save_at = [0.5, 1.0]
extrapolate = true

[output]
name = "small"
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
    path = tmp_path / "run.toml"
    path.write_text(CONFIG)
    return path


def test_a_run_writes_result_configuration_and_figures(
    fpsolve, config, tmp_path, undrawn
):
    result = fpsolve("run", config, "--out", "out")
    assert result.exit_code == 0, result.output
    figures = ["angle", "entropy", "marginals", "moments", "overview"]
    names = [*(f"small-{name}.png" for name in figures), "small.nc", "small.toml"]
    assert files(tmp_path / "out") == sorted(names)
    solution = fp.load(tmp_path / "out" / "small.nc")
    assert solution.status == "finished"
    assert solution.errors is not None
    np.testing.assert_array_equal(solution.saved_s, [0.5, 1.0])
    for name in names:
        assert f"out/{name}" in result.stdout


def test_a_run_says_what_it_does_and_what_came_out(fpsolve, config):
    shown = fpsolve("run", config, "--out", "out", "--no-figures").stdout
    assert "∂ₛp + τ(α)·∇p - ∂_α(∇B·τ⊥ p) = 0.5 ∂_αα p" in shown
    assert "24 x 24 x 16 cells, |ξ₁| < 6, |ξ₂| < 6" in shown
    assert "ds = 0.125 and ds/2, extrapolated (from the configuration)" in shown
    assert "drift_kick(positive=False" in shown
    for column in ("H(p|p_S)", "± H", "minimum", "mass error", "boundary mass"):
        assert column in shown
    assert "estimated L1 error of the saved densities: at most" in shown
    assert "finished after" in shown


def test_the_run_can_be_repeated_from_what_it_wrote(fpsolve, config, tmp_path):
    fpsolve("run", config, "--out", "first", "--no-figures")
    written = tmp_path / "first" / "small.toml"
    fpsolve("run", written, "--out", "second")
    first, second = (
        fp.load(tmp_path / folder / "small.nc") for folder in ("first", "second")
    )
    np.testing.assert_array_equal(first.densities, second.densities)
    assert first.provenance["configuration"] == written.read_text()
    assert load_config(written) == load_config(tmp_path / "second" / "small.toml")
    # Figures were switched off for the first run, and so are they for its repetition.
    assert files(tmp_path / "second") == ["small.nc", "small.toml"]


def test_what_is_suggested_is_said_and_written(fpsolve, config, tmp_path):
    config.write_text(CONFIG.replace("ds = 0.125\n", "tolerance = 0.05\n"))
    result = fpsolve("run", config, "--out", "out", "--no-figures")
    assert result.exit_code == 0, result.output
    assert "suggested: the splitting error is at most" in result.stdout
    assert load_config(tmp_path / "out" / "small.toml").run.ds is not None
    reasons = fp.load(tmp_path / "out" / "small.nc").provenance["suggested"]
    assert list(reasons) == ["ds"]
    assert reasons["ds"].startswith("the splitting error is at most")


def test_a_process_is_shown_with_its_units(fpsolve, config):
    config.write_text(PROCESS + CONFIG[CONFIG.index("[grid]") :])
    result = fpsolve("run", config, "--out", "out", "--no-figures")
    assert result.exit_code == 0, result.output
    assert "ξ and s in units of 10 mm, laid down in 0.2 ms" in result.stdout


def test_an_unlikely_process_is_a_warning_without_a_source_line(fpsolve, config):
    unlikely = PROCESS.replace("noise = 16.0", "noise = 0.5")
    config.write_text(unlikely + CONFIG[CONFIG.index("[grid]") :])
    result = fpsolve("run", config, "--out", "out", "--no-figures")
    assert result.exit_code == 0, result.output
    warnings = [line for line in result.stderr.splitlines() if "warning" in line]
    assert len(warnings) == 1
    assert warnings[0].startswith("warning: `noise` is 0.5 m^-1/2, outside the")
    assert ".py" not in result.stderr


def test_results_can_be_stored_as_zarr(fpsolve, config, tmp_path):
    config.write_text(CONFIG + 'format = "zarr"\n')
    result = fpsolve("run", config, "--out", "out", "--no-figures")
    assert result.exit_code == 0, result.output
    assert fp.load(tmp_path / "out" / "small.zarr").status == "finished"


def test_a_misspelt_key_is_answered_with_the_nearest(fpsolve, config, tmp_path):
    config.write_text(CONFIG.replace("variance", "varience"))
    result = fpsolve("run", config, "--out", "out")
    assert_mistake(
        result, "`varience` is not a key of the kind 'gaussian'; did you mean"
    )
    assert "`variance`?" in result.stderr
    assert files(tmp_path) == ["run.toml"]


def test_a_configuration_that_is_not_there_is_named(fpsolve):
    assert_mistake(fpsolve("run", "none.toml"), "got `none.toml`; leave it out")


def test_an_unknown_example_is_answered_with_the_nearest(fpsolve):
    result = fpsolve("run", "--example", "laydwn")
    assert_mistake(result, "got 'laydwn'; did you mean `laydown`?")


def test_a_file_and_an_example_exclude_each_other(fpsolve, config):
    result = fpsolve("run", config, "--example", "laydown")
    assert_mistake(result, "`--example` must not be given beside a file")


def test_too_many_threads_are_refused(fpsolve, config):
    assert_mistake(fpsolve("run", config, "--threads", 9999), "must be at most")


def test_threads_are_set(fpsolve, config, monkeypatch):
    asked = []
    monkeypatch.setattr("numba.set_num_threads", asked.append)
    result = fpsolve("run", config, "--threads", 1, "--no-figures")
    assert result.exit_code == 0, result.output
    assert asked[0] == 1


def test_an_unknown_option_is_a_mistake_too(fpsolve):
    result = fpsolve("run", "--outt", "x")
    assert result.exit_code == 2
    assert "No such option" in result.stderr
    assert "Traceback" not in result.output


def test_a_run_that_fails_keeps_what_it_recorded(fpsolve, config, tmp_path):
    config.write_text(CONFIG.replace("half_width = 6.0", "half_width = 2.0"))
    result = fpsolve("run", config, "--out", "out")
    assert_mistake(result, "error: boundary mass", code=1)
    assert "enlarge `half_width`" in result.stderr
    assert files(tmp_path / "out") == ["small-failed.nc", "small-failed.toml"]
    partial = fp.load(tmp_path / "out" / "small-failed.nc")
    assert partial.status == "failed"
    assert partial.message in result.stderr


def test_a_run_that_does_not_fit_into_memory_never_starts(fpsolve, config, tmp_path):
    config.write_text(CONFIG.replace("[24, 24, 16]", "[40000, 40000, 4]"))
    result = fpsolve("run", config, "--out", "out")
    assert result.exit_code == 1, result.output
    assert "GiB are available" in result.stderr
    assert "Traceback" not in result.output
    assert not (tmp_path / "out").exists()


def interrupting(at):
    """A progress bar at which the user presses Ctrl-C when s passes `at`."""

    @contextmanager
    def bar():
        def report(n_done, n_total, s):
            if s >= at:
                raise KeyboardInterrupt

        yield report

    return bar


def test_an_interrupted_run_keeps_what_it_recorded(
    fpsolve, config, tmp_path, monkeypatch
):
    fpsolve("run", config, "--out", "out", "--no-figures")
    complete = (tmp_path / "out" / "small.nc").read_bytes()
    monkeypatch.setattr("fpsolve.cli.progress.progress_bar", interrupting(at=0.75))
    result = fpsolve("run", config, "--out", "out")
    assert_mistake(result, "interrupted; what was recorded until then is kept", 130)
    partial = fp.load(tmp_path / "out" / "small-interrupted.nc")
    assert partial.status == "interrupted"
    assert partial.s[-1] == 0.75
    np.testing.assert_array_equal(partial.saved_s, [0.5])
    # The result of the earlier, complete run is still there.
    assert (tmp_path / "out" / "small.nc").read_bytes() == complete


def test_an_interrupt_elsewhere_leaves_nothing(fpsolve, config, tmp_path, monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr("fpsolve.cli.plan.print_plan", interrupted)
    assert_mistake(fpsolve("run", config, "--out", "out"), "interrupted", 130)
    assert not (tmp_path / "out").exists() or not files(tmp_path / "out")


def test_a_full_disk_is_an_error_without_a_traceback(
    fpsolve, config, tmp_path, monkeypatch
):
    def full(*arguments, **options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("xarray.Dataset.to_netcdf", full)
    result = fpsolve("run", config, "--out", "out")
    assert_mistake(result, "No space left on device", code=1)
    assert not (tmp_path / "out").exists() or not files(tmp_path / "out")


def test_a_stored_result_is_drawn_beside_itself_or_elsewhere(
    fpsolve, tmp_path, undrawn
):
    (tmp_path / "out").mkdir()
    # A movie of two frames.
    path = relaxing_solution(saved=(0.0, 5.0)).save(tmp_path / "out" / "run.nc")
    result = fpsolve("plot", path)
    assert result.exit_code == 0, result.output
    assert len(result.stdout.split()) == 5
    assert (tmp_path / "out" / "run-entropy.png").exists()
    result = fpsolve("plot", path, "--out", "elsewhere", "--movie")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "elsewhere" / "run.gif").exists()


def test_a_file_that_cannot_be_drawn_is_named(fpsolve, config, tmp_path):
    assert_mistake(fpsolve("plot", "none.nc"), "got `none.nc`")
    assert_mistake(fpsolve("plot", config), "it is not a netCDF-4 file")
    assert files(tmp_path) == ["run.toml"]


def test_a_movie_of_one_frame_is_refused(fpsolve, tmp_path):
    path = relaxing_solution(saved=(5.0,)).save(tmp_path / "run.nc")
    result = fpsolve("plot", path, "--movie")
    assert_mistake(result, "must hold at least two saved densities for a movie")


def test_a_defect_of_the_program_keeps_its_traceback(fpsolve, config, monkeypatch):
    def defect(*arguments):
        raise ZeroDivisionError("defect")

    monkeypatch.setattr("fpsolve.cli.plan.print_plan", defect)
    result = fpsolve("run", config, "--out", "out")
    assert isinstance(result.exception, ZeroDivisionError)


def test_info_tells_versions_threads_and_cache(fpsolve):
    result = fpsolve("info")
    assert result.exit_code == 0, result.output
    for name in ("python", "numpy", "numba", "threads", "compile cache"):
        assert name in result.stdout
    assert "MiB)" in result.stdout


@pytest.mark.parametrize("command", ["run", "plot", "info"])
def test_help_shows_a_working_example(fpsolve, command):
    result = fpsolve(command, "--help")
    assert result.exit_code == 0
    assert f"Example: fpsolve {command}" in result.stdout


def command_line(*words):
    return subprocess.Popen(
        [sys.executable, "-m", "fpsolve", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )


def test_the_module_is_the_command():
    process = command_line("run", "none.toml")
    stdout, stderr = process.communicate(timeout=HANGS)
    assert process.returncode == 2
    assert stderr.startswith("error: `config` must be an existing TOML file")
    assert stderr.count("\n") == 1
    assert stdout == ""


def test_help_imports_nothing_that_takes_long():
    code = (
        "import sys; from fpsolve.cli import app\n"
        "slow = {'numpy', 'numba', 'matplotlib', 'xarray', 'pydantic', 'rich'}\n"
        "print(sorted(slow & sys.modules.keys()))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT
    )
    assert done.stdout.strip() == "[]", done.stderr


@pytest.mark.processes
def test_a_signal_stops_a_run_and_keeps_it(config, tmp_path):
    config.write_text(CONFIG.replace("save_at = [0.5, 1.0]", "save_at = [0.0]"))
    process = command_waiting_at(3, "run", config, "--out", tmp_path / "out", cwd=ROOT)
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=HANGS)
    assert process.returncode == 130, stderr
    assert "interrupted" in stderr
    assert "Traceback" not in stderr
    partial = fp.load(tmp_path / "out" / "small-interrupted.nc")
    assert partial.status == "interrupted"
    assert partial.s[-1] == 0.375
