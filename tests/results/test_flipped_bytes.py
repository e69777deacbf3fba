"""Whatever byte of a file is hit: the result is what it was, or fpsolve says no."""

import shutil
import warnings

import numpy as np
import pytest
from checkpoint_runs import P0, assert_same_bits, left_at, run
from malformed import files as table
from malformed.stores import without

import fpsolve as fp
from fpsolve.errors import FileFormatError, FpsolveError

# validation/reliability/flipped_bytes.py does this hundreds of times.
N_FLIPS = 12


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(unsynced):
    """No test here cuts the power."""


def flipped(path, rng):
    """Change one byte of a file."""
    content = bytearray(path.read_bytes())
    content[rng.integers(len(content))] ^= int(rng.integers(1, 256))
    path.write_bytes(content)


def files_of(folder):
    """Its files, in an order that does not change."""
    found = sorted(path for path in folder.rglob("*") if path.is_file())
    return [path for path in found if path.stat().st_size]


def exact_or_refused(read, assert_same):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = read()
    except FpsolveError:
        return False
    assert_same(found)
    return True


def assert_identical(first, second):
    """The same attributes, variables and bits."""
    assert first.attrs == second.attrs
    assert set(first.variables) == set(second.variables)
    for name in first.variables:
        one, other = first[name].to_numpy(), second[name].to_numpy()
        assert one.tobytes() == other.tobytes(), name


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_a_saved_result_is_what_it_was_or_refused(ending, tmp_path, rng):
    intact = table.write_solution(tmp_path / f"run.{ending}")
    whole = fp.load(intact).to_xarray()
    for number in range(N_FLIPS):
        path = tmp_path / f"{number}.{ending}"
        (shutil.copytree if intact.is_dir() else shutil.copy)(intact, path)
        hit = rng.choice(files_of(path)) if path.is_dir() else path
        flipped(hit, rng)
        exact_or_refused(
            lambda path=path: fp.load(path),
            lambda one: assert_identical(one.to_xarray(), whole),
        )


def test_a_checkpoint_gives_the_result_or_is_refused(tmp_path, rng):
    options = {"save_at": tuple(np.arange(9) / 8)}
    intact, whole = left_at(7, tmp_path / "run", **options), run(**options)
    n_exact = 0
    for number in range(N_FLIPS):
        folder = tmp_path / str(number)
        shutil.copytree(intact, folder)
        flipped(rng.choice(files_of(folder)), rng)
        n_exact += exact_or_refused(
            lambda folder=folder: fp.resume(folder),
            lambda one: assert_same_bits(one, whole),
        )
    # Chunks and snapshots are most of the files, and none of them is needed.
    assert n_exact > N_FLIPS / 2


def chunk(folder, name):
    return folder / "output.zarr" / "pass-1" / name


@pytest.mark.parametrize("number", [0, 3])
def test_a_damaged_chunk_is_told_and_computed_again(number, tmp_path, rng):
    options = {"save_at": tuple(np.arange(9) / 8)}
    folder = left_at(7, tmp_path / "run", **options)
    flipped(chunk(folder, f"density/{number}.0.0.0"), rng)
    with pytest.warns(UserWarning, match="output that belongs to it is missing or dam"):
        assert_same_bits(fp.resume(folder), run(**options))


@pytest.mark.parametrize(
    ("old", "new"), [(b'"float64"', b'"int64"'), (b"9,", b"8,"), (b"crc32c", b"crc32d")]
)
def test_damaged_metadata_of_an_array_are_told_and_made_again(old, new, tmp_path):
    options = {"save_at": tuple(np.arange(9) / 8)}
    folder = left_at(7, tmp_path / "run", **options)
    path = chunk(folder, "density") / "zarr.json"
    assert old in path.read_bytes()
    path.write_bytes(path.read_bytes().replace(old, new, 1))
    with pytest.warns(UserWarning, match="output that belongs to it is missing or dam"):
        assert_same_bits(fp.resume(folder), run(**options))


def test_a_manifest_is_protected_as_a_whole(tmp_path):
    folder = left_at(5, tmp_path / "run")
    path = folder / "run.json"
    path.write_text(path.read_text().replace('"every": 2', '"every": 3'))
    with pytest.raises(FileFormatError, match="it was changed after it was written"):
        fp.resume(folder)


def test_a_checkpoint_with_something_else_than_files_is_refused(tmp_path):
    folder = left_at(5, tmp_path / "run")
    (folder / "lock").unlink()
    (folder / "lock").symlink_to("nothing")
    for action in (fp.resume, run):
        with pytest.raises(ValueError, match=r"in which `lock` is none; remove it"):
            action(folder)


def test_a_store_without_its_root_is_not_a_result(tmp_path):
    path = without("zarr.json")(table.write_solution(tmp_path / "run.zarr"))
    with pytest.raises(FileFormatError):
        fp.load(path)
    assert P0.min() > 0
