"""What a result may be written to, and what a killed process leaves behind."""

import os
import socket
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import result_files

import fpsolve as fp
from fpsolve import plotting
from fpsolve._support import staging
from fpsolve._support.files import atomic_path
from fpsolve._support.netcdf import write_dataset


@pytest.fixture
def sock(tmp_path, monkeypatch):
    # The address of a socket is short: it is named from its own folder.
    monkeypatch.chdir(tmp_path)
    with socket.socket(socket.AF_UNIX) as made:
        made.bind("target.nc")
        yield tmp_path / "target.nc"


def fifo(path):
    os.mkfifo(path)


def dangling(path):
    path.symlink_to("nothing.nc")


def looping(path):
    path.symlink_to("other.nc")
    (path.parent / "other.nc").symlink_to(path.name)


TARGETS = {
    fifo: r"`path` must be a pipe that a program reads from, got `.*target.*`; start",
    dangling: r"link to nothing, got `.*target.*`, which leads to `nothing.*`; remove",
    looping: r"`path` must not be a link in a circle, got `.*target.*`; remove it",
}
WRITERS = {
    "result": lambda path: result_files.solution().save(path),
    "study": lambda path: write_dataset(result_files.energy(), path),
    "page": lambda path: fp.report(result_files.result_file("energy.nc"), path),
    "movie": lambda path: plotting.movie(result_files.solution(), path),
}


@pytest.mark.parametrize("make", TARGETS, ids=lambda make: make.__name__)
@pytest.mark.parametrize("writer", WRITERS)
def test_what_is_no_file_is_refused_and_stays(make, writer, tmp_path):
    path = tmp_path / ("target.gif" if writer == "movie" else "target.nc")
    make(path)
    before = {one.name: one.lstat().st_ino for one in tmp_path.iterdir()}
    with pytest.raises((ValueError, FileNotFoundError), match=TARGETS[make]):
        WRITERS[writer](path)
    assert {one.name: one.lstat().st_ino for one in tmp_path.iterdir()} == before


def test_a_socket_is_refused_and_stays(sock):
    with pytest.raises(ValueError, match=r"got `.*`, which is a socket; name another"):
        result_files.solution().save(sock)
    assert sock.is_socket()


def test_a_device_is_refused(tmp_path, monkeypatch):
    # None is made here: only root could, and it would be one of this machine.
    from fpsolve._support import targets

    path = tmp_path / "target.nc"
    path.write_text("")
    monkeypatch.setattr(targets, "_mode", lambda path, name: 0o020666)
    with pytest.raises(ValueError, match="which is a device; name another one"):
        result_files.solution().save(path)


def test_a_link_is_followed_to_the_file_that_it_names(tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "run.nc").write_text("old")
    (tmp_path / "link.nc").symlink_to("folder/run.nc")
    assert result_files.solution().save(tmp_path / "link.nc") == tmp_path / "link.nc"
    assert (tmp_path / "link.nc").readlink() == Path("folder/run.nc")
    assert fp.load(tmp_path / "folder" / "run.nc").status == "finished"
    assert [one.name for one in (tmp_path / "folder").iterdir()] == ["run.nc"]


def test_a_link_to_a_store_is_followed_too(tmp_path):
    result_files.solution().save(tmp_path / "run.zarr")
    (tmp_path / "link.zarr").symlink_to("run.zarr")
    (tmp_path / "run.zarr" / "density" / "zarr.json").unlink()
    result_files.solution().save(tmp_path / "link.zarr")
    assert (tmp_path / "link.zarr").is_symlink()
    assert fp.load(tmp_path / "run.zarr").status == "finished"


def test_a_file_is_written_through_a_pipe_that_is_read(tmp_path):
    path, read = tmp_path / "target.nc", []
    fifo(path)
    # Opened without waiting for a writer: nothing depends on who comes first.
    handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    os.set_blocking(handle, True)

    def reader():
        with os.fdopen(handle, "rb") as pipe:
            read.append(pipe.read())

    # It waits in `read` until the writer, which is there, has closed.
    with atomic_pipe(path):
        thread = threading.Thread(target=reader)
        thread.start()
        result_files.solution().save(path)
    thread.join()
    (tmp_path / "read.nc").write_bytes(read[0])
    assert fp.compare(tmp_path / "read.nc", result_files.solution()).equal
    assert path.is_fifo()


def atomic_pipe(path):
    """The pipe, open for writing: until it is closed, its reader waits."""
    return path.open("wb")


def test_a_store_does_not_go_through_a_pipe(tmp_path):
    path = tmp_path / "target.zarr"
    fifo(path)
    handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        with pytest.raises(IsADirectoryError, match="got a pipe; a store is a folder"):
            result_files.solution().save(path)
    finally:
        os.close(handle)


def test_a_pipe_is_not_read_as_a_result(fpsolve, tmp_path):
    fifo(tmp_path / "target.nc")
    for command in ("report", "plot", "rerun"):
        found = fpsolve(command, "target.nc", "--out", "out")
        assert found.exit_code == 2
        assert "it is not a netCDF-4 file" in found.stderr


def test_a_page_goes_to_the_standard_output(fpsolve, tmp_path):
    path = result_files.result_file("spectrum.nc")
    found = fpsolve("report", str(path), "--out", "-")
    assert found.exit_code == 0
    assert found.stdout.startswith("<!DOCTYPE html>")
    assert found.stdout.rstrip().endswith("</html>")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("command", "taken"),
    [
        (("energy",), "energy.nc"),
        (("spectrum",), "spectrum.png"),
        (("run",), "laydown.nc"),
        (("paths",), "fibres.toml"),
        (("check",), "laydown-check.json"),
        (("rate", "--potential", "quadratic"), "rate-quadratic.nc"),
        (("limits", "large-noise"), "large-noise-quadratic.nc"),
    ],
)
def test_a_command_refuses_before_it_computes(command, taken, fpsolve, tmp_path):
    (tmp_path / "results").mkdir()
    os.mkfifo(tmp_path / "results" / taken)
    found = fpsolve(*command)
    assert found.exit_code == 2, found.output
    assert (
        f"`results/{taken}` must be a file or a free place, got a pipe" in found.stderr
    )
    assert os.listdir(tmp_path / "results") == [taken]


def test_rerun_refuses_before_it_computes(fpsolve, tmp_path):
    path = result_files.solution().save(tmp_path / "run.nc")
    (tmp_path / "rerun").mkdir()
    dangling(tmp_path / "rerun" / "run.nc")
    found = fpsolve("rerun", path.name)
    assert found.exit_code == 2
    assert "must not be a link to nothing" in found.stderr


KILLED = """
import os, signal, sys
from fpsolve._support.files import atomic_path
with atomic_path(sys.argv[1]) as draft:
    draft.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def written(path):
    with atomic_path(path) as draft:
        draft.write_text("whole")


def test_what_a_killed_process_left_is_removed_by_the_next_writer(tmp_path):
    subprocess.run([sys.executable, "-c", KILLED, tmp_path / "a"], check=False)
    assert len(list(tmp_path.iterdir())) == 1
    written(tmp_path / "b")
    assert [one.name for one in tmp_path.iterdir()] == ["b"]


def test_what_another_writer_needs_stays(tmp_path):
    with atomic_path(tmp_path / "a") as draft:
        draft.write_text("first")
        written(tmp_path / "b")
        written(tmp_path / "a")
        assert draft.read_text() == "first"
    assert (tmp_path / "a").read_text() == "first"
    assert sorted(one.name for one in tmp_path.iterdir()) == ["a", "b"]


def test_hidden_folders_of_others_stay(tmp_path):
    (tmp_path / ".other.abcdefgh").mkdir()
    (tmp_path / ".other.abcdefgh" / "thesis").write_text("precious")
    (tmp_path / ".a.12345678").write_text("a file")
    written(tmp_path / "a")
    assert (tmp_path / ".other.abcdefgh" / "thesis").read_text() == "precious"
    assert (tmp_path / ".a.12345678").is_file()


def test_a_store_that_a_kill_left_moved_aside_is_put_back(tmp_path):
    left = tmp_path / ".run.zarr.abcdefgh"
    (left / staging.REPLACED).mkdir(parents=True)
    (left / staging.REPLACED / "zarr.json").write_text("{}")
    (left / ".fpsolve-lock").write_text("")
    written(tmp_path / "b")
    assert (tmp_path / "run.zarr" / "zarr.json").read_text() == "{}"
    assert not left.exists()


def test_a_file_system_without_locks_keeps_what_is_written(tmp_path, monkeypatch):
    def refuse(*arguments):
        raise OSError("no locks available")

    monkeypatch.setattr(staging.fcntl, "flock", refuse)
    with atomic_path(tmp_path / "a") as draft:
        draft.write_text("first")
        written(tmp_path / "b")
    assert (tmp_path / "a").read_text() == "first"
