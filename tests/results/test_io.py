"""Results survive a file bit for bit, and no file is ever half written."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from solutions import PROVENANCE, relaxing_solution

import fpsolve as fp
from fpsolve._support import files as atomic
from fpsolve._support.netcdf import write_dataset
from fpsolve.errors import FileFormatError
from fpsolve.model.curves import (
    EllipticNozzle,
    FixedBelt,
    MovingBelt,
    OscillatingNozzle,
    RotatingNozzle,
    TabulatedCurve,
)
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    CallablePotential,
    FreePotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)

SUFFIXES = [".nc", ".zarr"]


@pytest.fixture(scope="module")
def solution():
    return relaxing_solution()


@pytest.fixture(scope="module")
def bare():
    """With one series only, as most of the cost of a file is that of its variables."""
    whole = relaxing_solution(errors=False)
    return replace(whole, series={name: whole.series[name] for name in ("s", "mass")})


def same_bits(first, second):
    """Whether two arrays agree in type, shape and every bit, NaN included."""
    return (
        first.dtype == second.dtype
        and first.shape == second.shape
        and first.tobytes() == second.tobytes()
    )


def assert_same(first, second):
    for name in ("model", "grid", "scheme", "ds", "status", "message", "provenance"):
        assert getattr(first, name) == getattr(second, name), name
    assert first.entropy_floor == second.entropy_floor
    assert same_bits(first.saved_s, second.saved_s)
    assert same_bits(first.densities, second.densities)
    for one, other in ((first.series, second.series), (first.errors, second.errors)):
        assert (one is None) == (other is None)
        assert set(one or {}) == set(other or {})
        assert all(same_bits(one[name], other[name]) for name in one or {})


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_solution_comes_back_bit_for_bit(solution, tmp_path, suffix):
    path = tmp_path / f"result{suffix}"
    assert solution.save(path) == path
    assert_same(fp.load(path), solution)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_bit_pattern_of_a_density_survives(bare, tmp_path, suffix, rng):
    bits = rng.integers(0, 2**64, bare.densities.shape, dtype=np.uint64)
    special = [np.nan, np.inf, -np.inf, -0.0, 5e-324]
    densities = bits.view(np.float64)
    densities.flat[: len(special)] = special
    path = tmp_path / f"result{suffix}"
    replace(bare, densities=densities).save(path)
    assert same_bits(fp.load(path).densities, densities)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_run_stopped_before_its_first_saving_point_is_stored(tmp_path, suffix):
    partial = relaxing_solution(
        saved=(), errors=False, status="interrupted", message="stopped by the user"
    )
    path = partial.save(tmp_path / f"result{suffix}")
    assert_same(fp.load(path), partial)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_run_stopped_before_its_first_record_is_stored(tmp_path, suffix):
    nothing = {"s": np.empty(0), "mass": np.empty(0)}
    partial = relaxing_solution(
        saved=(), errors=False, series=nothing, status="interrupted"
    )
    assert_same(fp.load(partial.save(tmp_path / f"result{suffix}")), partial)


@pytest.mark.parametrize(
    "curve",
    [
        FixedBelt(),
        MovingBelt(0.1),
        RotatingNozzle(0.1, 0.5, 2.0, 0.25),
        OscillatingNozzle(0.1, 0.5, 2.0),
        EllipticNozzle(0.1, 0.5, 0.25, 2.0),
        # Longer than the 64 KiB that an attribute may have in the oldest HDF5 files.
        TabulatedCurve(np.arange(9000.0), np.zeros(9000), np.sin(np.arange(9000.0))),
    ],
    ids=lambda curve: curve.kind,
)
def test_every_curve_comes_back(bare, tmp_path, curve):
    model = LayDownModel(QuadraticPotential(), noise=0.1, curve=curve)
    path = replace(bare, model=model).save(tmp_path / "result.nc")
    assert fp.load(path).model == model


@pytest.mark.parametrize(
    "potential",
    [
        QuadraticPotential(1.0, 1 / 3),
        LinearPotential(0.7),
        PowerPotential(3.0, 2.0),
        FreePotential(),
    ],
    ids=lambda potential: potential.kind,
)
def test_every_potential_comes_back(bare, tmp_path, potential):
    model = LayDownModel(potential, noise=1.0)
    path = replace(bare, model=model).save(tmp_path / "result.nc")
    assert fp.load(path).model == model


def quartic(xi1, xi2):
    return (xi1**2 + xi2**2) ** 2


def quartic_gradient(xi1, xi2):
    r2 = xi1**2 + xi2**2
    return 4 * r2 * xi1, 4 * r2 * xi2


def test_a_model_of_functions_leaves_its_description(bare, tmp_path):
    model = LayDownModel(CallablePotential(quartic, quartic_gradient), noise=1.0)
    replace(bare, model=model).save(tmp_path / "first.nc")
    with pytest.warns(UserWarning, match=r"could not be read back, so `model` is None"):
        loaded = fp.load(tmp_path / "first.nc")
    assert loaded.model is None
    assert "value=quartic" in loaded.provenance["model_description"]
    assert loaded.provenance["equation"] == model.equation
    # The description goes on when the solution is stored again.
    loaded.save(tmp_path / "second.nc")
    with pytest.warns(UserWarning, match="could not be read back"):
        again = fp.load(tmp_path / "second.nc")
    assert again.provenance == loaded.provenance


def test_the_dataset_is_labelled(solution):
    dataset = solution.to_xarray()
    assert dataset["density"].dims == ("s", "xi1", "xi2", "alpha")
    assert dataset["relative_entropy"].dims == ("step",)
    assert dataset["relative_entropy_error"].dims == ("step",)
    assert dataset["density_l1_error"].dims == ("s",)
    np.testing.assert_array_equal(dataset["s_step"], solution.s)
    np.testing.assert_array_equal(dataset["xi1"], solution.grid.xi1)
    for name, variable in dataset.variables.items():
        assert variable.attrs["units"] == "1", name
        assert len(variable.attrs["long_name"]) > 5, name


def test_the_dataset_says_what_was_solved(solution):
    attributes = solution.to_xarray().attrs
    assert attributes["equation"] == solution.model.equation
    assert json.loads(attributes["model"]) == solution.model.to_dict()
    assert json.loads(attributes["grid"]) == solution.grid.to_dict()
    assert json.loads(attributes["scheme"]) == solution.scheme
    assert attributes["ds"] == solution.ds
    assert attributes["status"] == "finished"
    assert attributes["numpy_version"] == PROVENANCE["versions"]["numpy"]
    assert attributes["date_created"] == PROVENANCE["date"]
    assert attributes["Conventions"].startswith("CF-")


def test_other_programs_read_the_file(bare, tmp_path):
    path = bare.save(tmp_path / "result.nc")
    with xr.open_dataset(path, engine="h5netcdf") as dataset:
        density = dataset["density"].sel(s=2.0)
        np.testing.assert_array_equal(density, bare.density(2.0))


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_failed_write_leaves_the_old_file_and_nothing_else(
    bare, tmp_path, suffix, monkeypatch
):
    path = bare.save(tmp_path / f"result{suffix}")

    def half_written(dataset, draft, **options):
        Path(draft).write_bytes(b"half")
        raise OSError("no space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", half_written)
    monkeypatch.setattr(xr.Dataset, "to_zarr", half_written)
    with pytest.raises(OSError, match="no space left"):
        replace(bare, ds=1.0).save(path)
    assert list(tmp_path.iterdir()) == [path]
    assert_same(fp.load(path), bare)


def test_an_interrupted_write_leaves_nothing(bare, tmp_path, monkeypatch):
    def interrupted(dataset, draft, **options):
        Path(draft).write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(xr.Dataset, "to_netcdf", interrupted)
    with pytest.raises(KeyboardInterrupt):
        bare.save(tmp_path / "result.nc")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_new_result_takes_the_place_of_the_old_one(bare, tmp_path, suffix):
    path = bare.save(tmp_path / f"result{suffix}")
    replace(bare, ds=1.0).save(path)
    assert fp.load(path).ds == 1.0
    assert list(tmp_path.iterdir()) == [path]


def test_an_older_store_returns_when_the_new_one_cannot_be_moved(
    bare, tmp_path, monkeypatch
):
    path = bare.save(tmp_path / "result.zarr")
    rename = Path.rename

    def refuse_the_draft(self, target):
        if target == path and self.name == path.name:
            raise OSError("device is gone")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", refuse_the_draft)
    with pytest.raises(OSError, match="device is gone"):
        replace(bare, ds=1.0).save(path)
    assert list(tmp_path.iterdir()) == [path]
    assert fp.load(path).ds == bare.ds


def test_a_folder_of_something_else_is_never_replaced(bare, tmp_path):
    precious = tmp_path / "data.zarr"
    precious.mkdir()
    (precious / "thesis.tex").write_text("years of work")
    with pytest.raises(IsADirectoryError, match=r"`path` must not be a folder, got"):
        bare.save(precious)
    assert (precious / "thesis.tex").read_text() == "years of work"


def test_a_file_never_replaces_a_store(bare, tmp_path):
    path = bare.save(tmp_path / "result.zarr")
    with pytest.raises(IsADirectoryError, match=r"`path` must not be a folder, got"):
        bare.save(path, engine="h5netcdf")
    assert list(tmp_path.iterdir()) == [path]
    assert_same(fp.load(path), bare)


def test_the_folder_of_a_file_must_exist(bare, tmp_path):
    with pytest.raises(FileNotFoundError, match=r"must lie in an existing folder.*new"):
        bare.save(tmp_path / "new" / "result.nc")


def test_engines_are_named(bare, tmp_path):
    with pytest.raises(ValueError, match=r"`engine` must be one of 'h5netcdf', 'zarr'"):
        bare.save(tmp_path / "result.nc", engine="pickle")


@pytest.mark.parametrize("share", [0.0, 0.001, 0.1, 0.5, 0.999])
def test_a_truncated_file_is_refused(bare, tmp_path, share):
    path = bare.save(tmp_path / "result.nc")
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(FileFormatError, match=r"cannot read `.*result.nc`: ") as caught:
        fp.load(path)
    assert caught.value.path == path


def test_a_file_of_another_kind_is_refused(tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("not a result")
    with pytest.raises(FileFormatError, match="it is not a netCDF-4 file"):
        fp.load(path)


def test_a_netcdf_file_of_another_program_is_refused(tmp_path):
    path = tmp_path / "weather.nc"
    xr.Dataset({"rain": ("day", [1.0, 2.0])}).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(FileFormatError, match="it is not a result of fpsolve"):
        fp.load(path)


def test_a_store_without_anything_is_refused(tmp_path):
    with pytest.raises(FileFormatError, match=r"cannot read `.*`: "):
        fp.load(tmp_path)


def test_a_layout_from_the_future_is_refused(bare, tmp_path):
    dataset = bare.to_xarray()
    dataset.attrs["fpsolve_format"] = 99
    dataset.to_netcdf(tmp_path / "result.nc", engine="h5netcdf")
    with pytest.raises(FileFormatError, match=r"it has layout 99.*update fpsolve"):
        fp.load(tmp_path / "result.nc")


def test_a_missing_variable_is_named(bare, tmp_path):
    dataset = bare.to_xarray().drop_vars("entropy_floor")
    del dataset.attrs["scheme"]
    dataset.to_netcdf(tmp_path / "result.nc", engine="h5netcdf")
    with pytest.raises(
        FileFormatError, match=r"`entropy_floor`, `scheme` is missing in it\."
    ):
        fp.load(tmp_path / "result.nc")


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"`path` must exist to be read.*none"):
        fp.load(tmp_path / "none.nc")


def on_a_disk_with(free, monkeypatch):
    def usage(path):
        return SimpleNamespace(free=free)

    monkeypatch.setattr(atomic.shutil, "disk_usage", usage)


def test_a_file_that_does_not_fit_is_refused_before_hdf5_meets_the_full_disk(
    solution, tmp_path, monkeypatch
):
    # After a failed write HDF5 ends the process at some later time.
    size = solution.densities.nbytes
    path = tmp_path / "run.nc"
    on_a_disk_with(size, monkeypatch)
    with pytest.raises(OSError, match=r"No space left on device \(\d+ MiB needed, "):
        solution.save(path)
    with pytest.raises(OSError, match="No space left on device"):
        write_dataset(solution.to_xarray(), path)
    assert not list(tmp_path.iterdir())
    # Series, coordinates and a mebibyte for what describes them.
    on_a_disk_with(size + 2**21, monkeypatch)
    assert solution.save(path).is_file()
