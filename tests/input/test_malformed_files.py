"""A damaged file is recognised, by Python and on the command line, and left alone."""

import shutil

import pytest
from malformed import files as table
from malformed import stores
from malformed.cases import assert_said, parametrised
from refusals import everything

import fpsolve as fp
from fpsolve.errors import FileFormatError


@pytest.fixture(scope="module")
def pristine(tmp_path_factory):
    """Valid files, made once and copied for every case."""
    folder = tmp_path_factory.mktemp("pristine")
    return {
        "solution": table.write_solution(folder / "result.nc"),
        "store": table.write_solution(folder / "result.zarr"),
        "paths": table.write_paths(folder / "paths.nc"),
    }


def copied(path, name, folder):
    target = folder / name
    shutil.copytree(path, target) if path.is_dir() else shutil.copy(path, target)
    return target


def assert_refused(case, path, fpsolve, folder):
    damaged = case.do(path)
    before = everything(folder)
    with pytest.raises(FileFormatError) as caught:
        fp.load(damaged)
    assert caught.value.path == damaged
    assert_said(str(caught.value), case)
    result = fpsolve("plot", damaged.name, "--out", "figures")
    assert result.exit_code == 2, result.output
    assert result.stderr.startswith(f"error: cannot read `{damaged.name}`: ")
    assert_said(result.stderr, case)
    assert everything(folder) == before


@parametrised(table.FILES)
def test_a_damaged_solution_is_recognised(case, pristine, fpsolve, tmp_path):
    path = copied(pristine["solution"], "result.nc", tmp_path)
    assert_refused(case, path, fpsolve, tmp_path)


@parametrised(stores.STORES)
def test_a_damaged_store_is_recognised(case, pristine, fpsolve, tmp_path):
    path = copied(pristine["store"], "result.zarr", tmp_path)
    assert_refused(case, path, fpsolve, tmp_path)


@parametrised(stores.PATHS)
def test_damaged_paths_are_recognised(case, pristine, fpsolve, tmp_path):
    path = copied(pristine["paths"], "result.nc", tmp_path)
    assert_refused(case, path, fpsolve, tmp_path)


def same(first, second):
    return (
        first.model == second.model
        and first.scheme == second.scheme
        and first.ds == second.ds
        and first.densities.tobytes() == second.densities.tobytes()
        and all(
            first.series[name].tobytes() == second.series[name].tobytes()
            for name in first.series
        )
    )


def test_a_file_of_an_older_version_without_checksums_is_read(pristine, tmp_path):
    path = copied(pristine["solution"], "result.nc", tmp_path)
    table.tampered(lambda dataset: None, path)
    assert same(fp.load(path), fp.load(pristine["solution"]))


def test_checksums_do_not_depend_on_where_a_result_is_stored(pristine):
    stored = [
        _checksums(pristine["solution"], "h5netcdf"),
        _checksums(pristine["store"], "zarr"),
    ]
    assert stored[0] == stored[1]
    assert len(stored[0]) == 10


def _checksums(path, engine):
    import json

    import xarray as xr

    options = {"consolidated": False} if engine == "zarr" else {}
    with xr.open_dataset(path, engine=engine, **options) as dataset:
        return set(json.loads(dataset.attrs["fpsolve_checksums"]).values())
