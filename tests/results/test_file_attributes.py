"""Attributes of files have the types that are declared, or the file is refused."""

import json
import re
import shutil
from functools import cache

import h5py
import numpy as np
import pytest
import result_files
import xarray as xr
from malformed import files as table

import fpsolve as fp
from fpsolve._support.declared import declared
from fpsolve._support.json_text import bounded_json
from fpsolve._support.netcdf import read_dataset, write_dataset
from fpsolve.errors import FileFormatError, NotRepeatableError
from fpsolve.evolution.call import Call

DEEP = "[" * 100_000 + "]" * 100_000
WRONG = [
    ({"ds": "small"}, "`ds` must be a number, got 'small'"),
    ({"n_paths": 1.5}, "`n_paths` must be an integer, got 1.5"),
    ({"n_paths": 2**70}, "`n_paths` must be less than"),
    ({"title": 3}, "`title` must be text, got 3"),
    ({"model": "[]"}, r"`model` must be a table, got \[\]"),
    ({"model": "null"}, "`model` must be a table, got None"),
    ({"model": {"noise": 1}}, "`model` must be JSON, got {'noise': 1}"),
    ({"grid": "6 x 6"}, "`grid` must be JSON, got '6 x 6'"),
    ({"provenance": DEEP}, "`provenance` must hold at most 40 objects and lists"),
    ({"provenance": '{"a":' * 45 + "1" + "}" * 45}, "`provenance` must hold at most"),
    ({"provenance": '{"n_steps": 1e999}'}, r"`provenance.n_steps` must be an integer"),
    ({"provenance": f'{{"n_steps": 1{"0" * 400}}}'}, "at most 300 digits"),
    ({"provenance": '{"versions": []}'}, r"`provenance.versions` must be a table"),
    ({"saved_steps": "{}"}, "`saved_steps` must be a list, got {}"),
    ({"call": '{"function": 3}'}, r"`call.function` must be text, got 3"),
]


@pytest.mark.parametrize(("attributes", "message"), WRONG)
def test_an_attribute_of_another_type_is_named(attributes, message):
    with pytest.raises(ValueError, match=message):
        declared(attributes)


def test_attributes_are_read_and_those_of_others_left_out():
    given = {
        "ds": np.float64(0.5), "kept": np.bool_(True), "n_paths": np.array([3]),
        "grid": '{"shape": [2]}', "model": "", "history": object(), "expected_order": 1,
    }  # fmt: skip
    assert declared(given) == {
        "ds": 0.5, "kept": 1, "n_paths": 3, "grid": {"shape": [2]}, "expected_order": 1
    }  # fmt: skip


def test_json_may_be_as_deep_as_it_has_to():
    inner = "[" * 40 + "]" * 40
    assert len(bounded_json("it", inner)) == 1
    with pytest.raises(ValueError, match="`it` must hold at most 40"):
        bounded_json("it", f"[{inner}]")


@pytest.mark.parametrize(
    "change",
    [
        {"provenance": DEEP},
        {"model": "null"},
        {"provenance": '{"environment": {"numba": 3}, "versions": {}}'},
        {"provenance": '{"n_steps": 1e999}'},
        {"grid": '{"shape": [1e999, 4, 4], "half_width": 5.0}'},
    ],
    ids=["deep", "null", "number", "overflow", "grid"],
)
def test_every_command_refuses_such_a_file_and_writes_nothing(
    change, fpsolve, tmp_path
):
    path = table.write_solution(tmp_path / "a.nc")
    table.attribute(**change)(path)
    commands = (
        ("report", "a.nc", "--out", "a.html"),
        ("rerun", "a.nc"),
        ("plot", "a.nc"),
    )
    for command in (*commands, ("compare", "a.nc", "a.nc")):
        found = fpsolve(*command)
        if command[0] == "compare" and "grid" in change:
            # Two datasets are compared as they are.
            continue
        assert found.exit_code == 2, (command, found.output)
        assert found.stderr.startswith("error: "), found.stderr
        assert [one.name for one in tmp_path.iterdir()] == ["a.nc"]


@pytest.mark.parametrize("name", ["laydown.nc", "fibres.nc", "energy.nc"])
def test_every_attribute_that_is_written_is_declared(name):
    attributes = read_dataset(result_files.result_file(name)).attrs
    assert declared(attributes).keys() == attributes.keys()


# Files that other programs have touched.


def touched(path, **changes):
    """What ncatted and others do: attributes are added, and a variable."""
    import h5netcdf

    with h5netcdf.File(path, "a") as file:
        for name, value in changes.items():
            file.attrs[name] = value
        file.dimensions["day"] = 2
        file.create_variable("rain", ("day",), float)[:] = [1.0, 2.0]
    return path


def test_attributes_and_variables_of_other_programs_are_accepted(tmp_path):
    path = table.write_solution(tmp_path / "a.nc")
    before = fp.load(path)
    touched(path, history="yesterday: ncatted", CDO="2.0", colour=[1.0, 2.0])
    after = fp.load(path)
    assert after.densities.tobytes() == before.densities.tobytes()
    assert after.series.keys() == before.series.keys()
    assert fp.compare(path, before).parameters == ()
    assert not {"history", "colour"} & read_dataset(path).attrs.keys()
    assert "rain" not in read_dataset(path)


def test_they_are_accepted_in_a_store_too(tmp_path):
    path = table.write_solution(tmp_path / "a.zarr")
    root = json.loads((path / "zarr.json").read_text())
    root["attributes"]["history"] = {"by": ["someone", None]}
    (path / "zarr.json").write_text(json.dumps(root))
    assert fp.load(path).status == "finished"


def test_an_older_file_does_not_name_its_attributes_and_is_read(tmp_path):
    from fpsolve._support import checksums

    dataset = table.solution().to_xarray()
    old = dataset.assign_attrs(
        {checksums.CHECKSUMS: json.dumps(checksums._digests(dataset))}
    )
    old.to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    touched(tmp_path / "a.nc", history="yesterday: ncatted")
    assert fp.load(tmp_path / "a.nc").status == "finished"


def test_our_own_attributes_are_still_protected(tmp_path):
    path = table.write_solution(tmp_path / "a.nc")
    touched(path, ds=0.25)
    with pytest.raises(FileFormatError, match="checksum of `attributes of the file`"):
        fp.load(path)


# Files that declare more than there is.


def declaring(path, size, name="extra"):
    """A file of some kilobytes with a variable of so many zeros, compressed."""
    import h5netcdf

    with h5netcdf.File(path, "a") as file:
        file.dimensions[f"{name}_size"] = size
        file.create_variable(
            name, (f"{name}_size",), float, chunks=(2**16,), compression="gzip"
        )
    return path


def test_a_variable_that_nobody_asked_for_is_not_read(tmp_path):
    path = declaring(table.write_solution(tmp_path / "a.nc"), 2**42)
    assert path.stat().st_size < 2**20
    assert fp.load(path).status == "finished"


@pytest.mark.parametrize(
    ("size", "name", "chunk"),
    [(2**42, "extra", None), (2**42, "extra_size", None), (4, "extra", 2**27)],
    ids=["variable", "coordinate", "chunk"],
)
def test_a_size_beyond_memory_is_refused_before_it_is_read(
    size, name, chunk, tmp_path, monkeypatch
):
    monkeypatch.setattr("fpsolve._support.sizes.allowed_memory", lambda: 2.0**29)
    path = table.tampered(
        lambda one: None, table.write_solution(tmp_path / "a.nc")
    )  # without checksums
    if chunk is None:
        declaring(path, size, name)
    else:
        import h5netcdf

        with h5netcdf.File(path, "a") as file:
            file.dimensions["more"] = None
            file.create_variable("extra", ("more",), float, chunks=(chunk,),
                                        compression="gzip")  # fmt: skip
            file.resize_dimension("more", size)
    message = rf"declares .* GiB, of it `{name}` the most, and 0\.5 GiB of memory are"
    with pytest.raises(FileFormatError, match=message):
        fp.load(path)


def test_arrays_that_do_not_fit_their_attributes_are_refused(tmp_path):
    steps = {"n_steps": 2, "saved_steps": "[0, 10, 40]"}
    for change, message in (
        ({"n_paths": 10**15}, r"`n_paths` must be 60 as in `xi`, got 1000000000000000"),
        ({"saved_steps": "[0]"}, "`saved_steps` must be 3 steps as in `s`, got 1"),
        (steps, "`n_steps` must be the last step, got 2 before 40"),
    ):
        path = shutil.copy(result_files.result_file("fibres.nc"), tmp_path / "a.nc")
        table.attribute(**change)(path)
        with pytest.raises(FileFormatError, match=message):
            fp.load(path)


@pytest.mark.parametrize("how", ["gone", "text", "error"])
def test_damaged_variables_are_refused_by_compare_as_by_load(how, tmp_path):
    changes = {
        "gone": lambda one: one.drop_vars("density"),
        "text": lambda one: one.assign(mass=one["mass"].astype(str)),
        "error": lambda one: one.assign(mass_error=one["mass"].astype(str)),
    }
    path = table.write_solution(tmp_path / "a.nc")
    table.tampered(changes[how], path)
    for read in (fp.load, lambda path: fp.compare(path, path)):
        with pytest.raises(
            FileFormatError, match=r"is missing in it|must hold numbers"
        ):
            read(path)


# Recipes of absurd size.


def rerun_of(path, change=None):
    if change is not None:
        change(path)
    with pytest.raises(NotRepeatableError) as caught:
        fp.rerun(path)
    return str(caught.value)


def calling(attributes, changes):
    """Change arguments of the call in attributes."""
    call = json.loads(attributes["call"])
    call["arguments"].update(changes)
    attributes["call"] = json.dumps(call)


def with_arguments(**changes):
    return table.with_attributes(lambda attributes: calling(attributes, changes))


@cache
def small_run():
    grid = fp.PhaseSpaceGrid(5.0, (8, 8, 8))
    p0 = fp.initial.gaussian(grid, (0.0, 0.0), 1.0)
    scheme = fp.drift_kick(result_files.MODEL, grid)
    return fp.solve(scheme, p0, (0.0, 1.0), 0.25, boundary_tolerance=1.0)


@pytest.fixture(scope="module")
def unchecked(tmp_path_factory):
    """The file of a small run, without checksums."""
    path = small_run().save(tmp_path_factory.mktemp("small") / "a.nc")
    table.tampered(lambda dataset: None, path)
    return path


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ds": 1e-12}, "`record_every` would give .* records, and it holds 5"),
        (
            {"s_span": [0.0, 1e9]},
            "`record_every` would give 4e.09 records, and it hold",
        ),
        ({"ds": 1e-6}, r"`record_every` would give 1e\+06 records, and it holds 5"),
        (
            {"ds": 1e-6, "record_every": 250_000},
            "`ds` would give .* steps, and it hold",
        ),
        (
            {"s_span": [7.0, 8.0]},
            r"`s_span` would give \[7.0, 8.0\], and it holds 0, 1",
        ),
        ({"s_span": [0.0]}, "`s_span` and `ds` would give"),
    ],
)
def test_a_run_of_other_size_than_its_file_is_not_repeated(
    changes, message, tmp_path, unchecked
):
    path = shutil.copy(unchecked, tmp_path / "a.nc")
    with h5py.File(path, "a") as file:
        calling(file.attrs, changes)
    assert re.search(message, rerun_of(path))


def test_a_run_is_repeated_with_what_the_caller_asks_for(tmp_path):
    path = small_run().save(tmp_path / "a.nc")
    with_arguments(ds=1e-12)(path)
    assert fp.rerun(path, ds=0.5).ds == 0.5


def test_an_interrupted_run_may_ask_for_more_but_not_for_ever(tmp_path):
    import dataclasses

    part = dataclasses.replace(small_run(), status="interrupted")
    path = part.save(tmp_path / "a.nc")
    text = rerun_of(path, with_arguments(s_span=[0.0, 1e15], record_every=2**40))
    assert "days at the very least" in text


@pytest.mark.parametrize(
    ("name", "argument", "value"),
    [("energy.nc", "n_energies", 10**9), ("energy.nc", "n_eigenvalues", 10**6)],
)
def test_a_study_of_other_size_than_its_file_is_not_repeated(
    name, argument, value, tmp_path
):
    path = shutil.copy(result_files.result_file(name), tmp_path / name)
    text = rerun_of(path, with_arguments(**{argument: value}))
    assert f"`{argument}` would give {value}" in text


def test_an_argument_that_its_function_has_not_is_named():
    dataset = result_files.energy()
    calling(dataset.attrs, {"colour": 1})
    with pytest.raises(NotRepeatableError, match="to be repeated, got 'colour'"):
        fp.rerun(dataset)


def test_a_call_that_is_none_is_told():
    with pytest.raises(ValueError, match="`call` must name a function and its argum"):
        Call.from_xarray(xr.Dataset(attrs={"call": "{}"}))


def test_paths_of_other_length_than_their_file_are_not_repeated(tmp_path):
    kept = result_files.result_file("fibres.nc")
    for s_end, reason in (
        (1e6, r"`ds` would give .* steps, and it holds 2400 steps"),
        (1e15, "days at the very least"),
    ):
        path = shutil.copy(kept, tmp_path / "a.nc")
        assert re.search(reason, rerun_of(path, with_arguments(s_end=s_end)))


def test_a_study_without_what_its_kind_needs_is_no_study(tmp_path):
    path = write_dataset(result_files.energy().drop_vars("r_min"), tmp_path / "a.nc")
    with pytest.raises(FileFormatError, match="`r_min` is missing in it"):
        fp.load(path)
