"""`fpsolve run --checkpoint` and `fpsolve resume`: files as of an unbroken run."""

import errno
import signal
from contextlib import contextmanager

import numpy as np
import pytest
from checkpoint_runs import Killed, assert_same_bits, left_at
from command_line import HANGS, assert_mistake, command_waiting_at, files
from typer.testing import CliRunner

import fpsolve as fp
from fpsolve.cli import app
from fpsolve.density.checkpoints import snapshots
from fpsolve.density.checkpoints.status import status_of

CONFIG = """
[potential]
kind = "quadratic"

[model]
noise = 1.0

[grid]
half_width = 6.0
shape = [14, 14, 8]

[initial]
kind = "gaussian"
variance = 0.8

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
KEPT = "out/small.checkpoint"


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(unsynced):
    """No test here cuts the power."""


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "run.toml"
    path.write_text(CONFIG)
    return path


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The result of a run without checkpoints."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "run.toml").write_text(CONFIG)
    words = ["run", folder / "run.toml", "--out", folder, "--no-figures"]
    assert CliRunner().invoke(app, list(map(str, words))).exit_code == 0
    return fp.load(folder / "small.nc")


def stopping(at, by):
    """A progress bar at which something happens when so many steps are done."""

    @contextmanager
    def bar():
        def report(n_done, n_total, s):
            if n_done >= at:
                raise by

        yield report

    return bar


@pytest.fixture
def killed(fpsolve, config, tmp_path, monkeypatch):
    """The folder of a run that was killed in its second pass."""
    with monkeypatch.context() as patch:
        patch.setattr("fpsolve.cli.progress.progress_bar", stopping(13, Killed))
        with pytest.raises(Killed):
            fpsolve("run", config, "--out", "out", "--checkpoint", 2, "--no-figures")
    assert files(tmp_path / "out") == ["small.checkpoint"]
    return tmp_path / KEPT


def test_a_run_with_checkpoints_leaves_the_same_files(
    fpsolve, config, whole, tmp_path, undrawn
):
    result = fpsolve("run", config, "--out", "out", "--checkpoint", 3)
    assert result.exit_code == 0, result.output
    figures = ["angle", "entropy", "marginals", "moments", "overview"]
    names = [*(f"small-{name}.png" for name in figures), "small.nc", "small.toml"]
    assert files(tmp_path / "out") == sorted(names)
    assert_same_bits(fp.load(tmp_path / "out" / "small.nc"), whole)


def test_a_killed_run_is_resumed_to_the_same_files(fpsolve, whole, killed, tmp_path):
    result = fpsolve("resume", killed)
    assert result.exit_code == 0, result.output
    assert (
        f"going on from `{killed}` at s = 0.25, after 12 of 24 steps" in result.stderr
    )
    # Figures were switched off for the run, and so they are for the rest of it.
    assert files(tmp_path / "out") == ["small.nc", "small.toml"]
    assert_same_bits(fp.load(tmp_path / "out" / "small.nc"), whole)
    assert "estimated L1 error of the saved densities" in result.stdout
    toml = (tmp_path / "out" / "small.toml").read_text()
    assert fp.load(tmp_path / "out" / "small.nc").provenance["configuration"] == toml


def test_the_same_command_goes_on_too(fpsolve, config, whole, killed, tmp_path):
    words = ["run", config, "--out", "out", "--checkpoint", "10s", "--no-figures"]
    result = fpsolve(*words)
    assert result.exit_code == 0, result.output
    assert "going on from `out/small.checkpoint` at s = 0.25" in result.stderr
    assert_same_bits(fp.load(tmp_path / "out" / "small.nc"), whole)
    assert files(tmp_path / "out") == ["small.nc", "small.toml"]


def test_a_result_can_be_written_elsewhere_and_the_checkpoint_kept(
    fpsolve, whole, killed, tmp_path
):
    result = fpsolve("resume", killed, "--out", "there", "--keep-checkpoint")
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "there") == ["small.nc", "small.toml"]
    assert_same_bits(fp.load(tmp_path / "there" / "small.nc"), whole)
    again = fpsolve("resume", killed)
    assert again.exit_code == 0, again.output
    assert "was finished; its result is written now" in again.stderr
    assert_same_bits(fp.load(tmp_path / "out" / "small.nc"), whole)


def test_a_stored_zarr_is_written_from_the_checkpoint(fpsolve, config, whole, tmp_path):
    config.write_text(CONFIG + 'format = "zarr"\n')
    result = fpsolve("run", config, "--out", "out", "--checkpoint", 3, "--no-figures")
    assert result.exit_code == 0, result.output
    assert_same_bits(fp.load(tmp_path / "out" / "small.zarr"), whole)


def test_another_configuration_is_refused_naming_the_difference(
    fpsolve, config, killed, tmp_path
):
    config.write_text(CONFIG.replace("noise = 1.0", "noise = 2.0"))
    result = fpsolve("run", config, "--out", "out", "--checkpoint", 2)
    assert_mistake_at_end(result, "is of another run: `noise` was 1.0, is 2.0; use", 2)
    assert files(tmp_path / "out") == ["small.checkpoint"]


def assert_mistake_at_end(result, message, code):
    """As `assert_mistake`, after lines that say where the run begins."""
    assert result.exit_code == code, result.output
    assert result.stderr.splitlines()[-1].startswith("error: ")
    assert message in result.stderr
    assert "Traceback" not in result.output


def test_ctrl_c_says_how_to_go_on(fpsolve, config, whole, tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        stop = stopping(5, KeyboardInterrupt)
        patch.setattr("fpsolve.cli.progress.progress_bar", stop)
        words = ["run", config, "--out", "out", "--checkpoint", "1h", "--no-figures"]
        result = fpsolve(*words)
    assert_mistake(
        result,
        "interrupted; what was recorded until then is kept; `fpsolve resume "
        f"{KEPT}` goes on",
        130,
    )
    assert status_of(tmp_path / KEPT).n_done == 5
    partial = fp.load(tmp_path / "out" / "small-interrupted.nc")
    assert partial.s[-1] == 0.625
    np.testing.assert_array_equal(partial.saved_s, [0.5])
    assert fpsolve("resume", KEPT).exit_code == 0
    assert_same_bits(fp.load(tmp_path / "out" / "small.nc"), whole)


def test_a_full_disk_is_told_with_what_is_kept(
    fpsolve, config, whole, tmp_path, monkeypatch
):
    def full(*arguments, **options):
        raise OSError(errno.ENOSPC, "No space left on device")

    @contextmanager
    def bar():
        def report(n_done, n_total, s):
            if n_done == 6:
                patch.setattr(snapshots.np, "savez", full)
                patch.setattr("xarray.Dataset.to_netcdf", full)

        yield report

    with monkeypatch.context() as patch:
        patch.setattr("fpsolve.cli.progress.progress_bar", bar)
        words = ["run", config, "--out", "out", "--checkpoint", 4, "--no-figures"]
        result = fpsolve(*words)
    assert result.exit_code == 1, result.output
    first, last = result.stderr.splitlines()
    assert first.startswith("warning: what was recorded cannot be written")
    assert "cannot be written: No space left on device; the last good one" in last
    assert f"`fpsolve resume {KEPT}`" in last
    assert files(tmp_path / "out") == ["small.checkpoint"]
    assert fpsolve("resume", KEPT).exit_code == 0
    assert_same_bits(fp.load(tmp_path / "out" / "small.nc"), whole)


def test_a_checkpoint_from_python_is_completed_and_stays(fpsolve, tmp_path):
    folder = left_at(5, tmp_path / "mine")
    result = fpsolve("resume", folder, "--out", "out", "--no-figures")
    assert result.exit_code == 0, result.output
    assert files(tmp_path / "out") == ["mine.nc"]
    assert fp.load(tmp_path / "out" / "mine.nc").status == "finished"
    assert status_of(folder).finished


def test_what_is_no_checkpoint_is_a_mistake(fpsolve, config, tmp_path):
    assert_mistake(fpsolve("resume", "none"), "got `none`, which does not exist")
    assert_mistake(fpsolve("resume", tmp_path), "it holds no `run.json`")
    assert_mistake(fpsolve("resume", config), "it holds no `run.json`")


def test_an_interval_that_is_none_is_a_mistake(fpsolve, config, tmp_path):
    result = fpsolve("run", config, "--out", "out", "--checkpoint", "often")
    assert_mistake(result, "`every` must be a number of steps, such as 100, or a")
    assert files(tmp_path) == ["run.toml"]


def test_a_folder_of_something_else_is_a_mistake(fpsolve, config, tmp_path):
    (tmp_path / KEPT).mkdir(parents=True)
    (tmp_path / KEPT / "notes").write_text("mine")
    result = fpsolve("run", config, "--out", "out", "--checkpoint", 3)
    assert_mistake(result, "which holds `notes`; name another")


@pytest.mark.processes
def test_a_process_that_is_killed_leaves_a_run_that_can_be_resumed(
    fpsolve, config, whole, tmp_path
):
    # Before the checkpoint at this step, the fourth of the second pass.
    words = ["run", config, "--out", "out", "--checkpoint", "2", "--no-figures"]
    process = command_waiting_at(12, *words, cwd=tmp_path)
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=HANGS)
    assert status_of(tmp_path / KEPT).n_done == 10
    assert fpsolve("resume", KEPT).exit_code == 0
    assert_same_bits(fp.load(tmp_path / "out" / "small.nc"), whole)
