"""Files that were cut, flipped, tampered with, or are of another program."""

from __future__ import annotations

import atexit
import json
import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
import numpy as np
import xarray as xr
from solutions import relaxing_solution

import fpsolve as fp

from . import problems
from .cases import Case

# Ends of every message about a damaged file.
DAMAGED = "make it again, or take a copy"


def solution():
    """A result with few series, because each costs time to read."""
    made = relaxing_solution(saved=(0.0, 1.0), errors=False)
    few = {name: made.series[name] for name in ("s", "mass", "relative_entropy")}
    return replace(made, series=few)


def cut(share):
    """The first part of a valid file."""

    def damage(path):
        content = path.read_bytes()
        path.write_bytes(content[: int(share * len(content))])
        return path

    return damage


def flipped(seed):
    """A valid file with one bit changed at a random place among the numbers of p."""

    def damage(path):
        content = bytearray(path.read_bytes())
        density = fp.load(path).densities.tobytes()
        start = content.index(density[: 8 * 64])
        place, bit = np.random.default_rng(seed).integers((len(density), 8))
        content[start + int(place)] ^= 1 << int(bit)
        path.write_bytes(content)
        return path

    return damage


def overwritten(content):
    def damage(path):
        path.write_bytes(content)
        return path

    return damage


def renamed(old, new):
    """A valid file in which some text is another, as an editor of bytes would do it."""

    def damage(path):
        content = path.read_bytes()
        assert old in content
        assert len(old) == len(new)
        path.write_bytes(content.replace(old, new, 1))
        return path

    return damage


def tampered(change, path):
    """What a program writes that changes a result without knowing what it is."""
    with xr.open_dataset(
        path, engine="h5netcdf", mask_and_scale=False, decode_times=False
    ) as opened:
        dataset = opened.load()
    del dataset.attrs["fpsolve_checksums"]
    changed = change(dataset)
    (dataset if changed is None else changed).to_netcdf(path, engine="h5netcdf")
    return path


def without_checksums(change):
    """A file as of an older version, and changed."""
    return lambda path: tampered(change, path)


def with_attributes(change):
    """A file as of an older version with changed attributes, written in its place."""

    def damage(path):
        with h5py.File(path, "a") as file:
            del file.attrs["fpsolve_checksums"]
            change(file.attrs)
        return path

    return damage


def attribute(**changes):
    return with_attributes(lambda attributes: attributes.update(changes))


def described(name, **changes):
    """A changed entry of an attribute that is JSON."""

    def change(attributes):
        description = {**json.loads(attributes[name]), **changes}
        attributes[name] = json.dumps(description)

    return with_attributes(change)


def variable(name, change):
    def spoil(dataset):
        dataset[name] = change(dataset[name])

    return without_checksums(spoil)


def kept_checksums(path):
    """A number changed by a program that keeps all attributes."""
    with xr.open_dataset(path, engine="h5netcdf", mask_and_scale=False) as opened:
        dataset = opened.load()
    dataset["density"].values[0, 0, 0, 0] += 1e-3
    dataset.to_netcdf(path, engine="h5netcdf")
    return path


def plain_hdf5(path):
    with h5py.File(path, "w") as file:
        file["numbers"] = np.arange(3.0)
    return path


def emptied(path):
    path.unlink()
    path.mkdir()
    return path


TRUNCATED = [
    Case(f"cut to {share:.4%}", cut(share), "result.nc`: it is",
         DAMAGED if share > 0.0001 else "name one that fpsolve wrote")
    for share in (0.0, 0.00005, 0.001, 0.01, 0.1, 0.5, 0.9, 0.99, 0.9999)
]  # fmt: skip
FLIPPED = [
    Case(f"a bit of the density flipped, seed {seed}", flipped(seed),
         "checksum of `density` does not fit", DAMAGED)
    for seed in range(6)
]  # fmt: skip
OTHERS = [
    Case("a picture", overwritten(b"\x89PNG\r\n\x1a\n" + bytes(1000)),
         "result.nc`: it is not a netCDF-4 file", "name one that fpsolve wrote"),
    Case("text", overwritten(b"s p\n0 1\n"), "it is not a netCDF-4 file", "name one"),
    Case("nothing", overwritten(b""), "it is not a netCDF-4 file", "name one"),
    Case("netCDF-3", overwritten(b"CDF\x01" + bytes(200)), "not a netCDF-4",
         "name one"),
    Case("a signature and nothing else", overwritten(b"\x89HDF\r\n\x1a\n"),
         "result.nc`: it is damaged", DAMAGED),
    Case("a signature and noise",
         overwritten(b"\x89HDF\r\n\x1a\n" + np.random.default_rng(1).bytes(4000)),
         "result.nc`: it is damaged", DAMAGED),
    Case("HDF5 that is no netCDF", plain_hdf5, "result.nc`: it is",
         "of fpsolve|program"),
    Case("an empty folder", emptied, "result.nc`: it is damaged", DAMAGED),
]  # fmt: skip
TAMPERED = [
    Case("noise edited byte by byte", renamed(b'"noise": 1.0', b'"noise": 3.0'),
         "checksum of `attributes of the file`", DAMAGED),
    Case("step edited byte by byte", renamed(b"finished", b"finish3d"),
         "checksum of `attributes of the file`", DAMAGED),
    Case("a number changed by a program", kept_checksums,
         "checksum of `density` does not fit", DAMAGED),
    Case("a layout of the future", attribute(fpsolve_format=99),
         "layout 99", "update fpsolve"),
    Case("a layout in words", attribute(fpsolve_format="new"), "got 'new'",
         "`fpsolve_format` must be an integer"),
    Case("an unknown kind", attribute(fpsolve_kind="weather"),
         "holds 'weather'", "update fpsolve"),
    Case("paths that are none", attribute(fpsolve_kind="paths"),
         "`moment_sums`", "is missing in it"),
    Case("a model that is no JSON", attribute(model="{noise"), "line 1",
         "JSON|Expecting"),
    Case("a model that is a number", attribute(model="3"), "got 3", "`model` must"),
    Case("a model without a potential", described("model", potential={}),
         "got None", "`kind` of a potential must be one of"),
    Case("noise negative", described("model", noise=-1.0),
         "got -1", "`noise` must be non-negative"),
    Case("noise NaN", described("model", noise=float("nan")), "got nan",
         "non-negative"),
    Case("a key the model has not", described("model", colour="red"),
         "colour", "parameters of `model` must be"),
    Case("a grid that is no JSON", attribute(grid="6 x 6"), "line 1|Extra",
         "JSON|data"),
    Case("a grid of another shape", described("grid", shape=[6, 6, 8]),
         r"got \(2, 12, 14, 8\)", r"`density` must have the shape \(2, 6, 6, 8\)"),
    Case("a grid of another width", described("grid", half_width=[9.0, 9.0]),
         "`xi1`", "must be the cell centres"),
    Case("a grid without cells", described("grid", shape=[0, 0, 0]), "got 0",
         "at least 4"),
    Case("a step of zero", attribute(ds=0.0), "got 0", "`ds` must be positive"),
    Case("a step below zero", attribute(ds=-0.1), "got -0.1", "`ds` must be positive"),
    Case("a step of NaN", attribute(ds=float("nan")), "got nan", "must be positive"),
    Case("a step in words", attribute(ds="small"), "'small'|small", "`ds`|float"),
    Case("an unknown status", attribute(status="perfect"),
         "got 'perfect'", "one of 'finished'"),
    Case("a scheme that is a list", attribute(scheme='["rk4"]'),
         r"got \['rk4'\]", "`scheme` must be a table"),
    Case("a scheme without a name", attribute(scheme="{}"),
         r"got \{\}", "`scheme` must name"),
    Case("provenance that is no JSON", attribute(provenance="yesterday"),
         "line 1", "JSON|Expecting"),
    Case("no density", without_checksums(lambda one: one.drop_vars("density")),
         "`density`", "is missing in it"),
    Case("no steps", without_checksums(lambda one: one.drop_vars("s_step")),
         "`s_step`", "is missing in it"),
    Case("a density without angles",
         without_checksums(lambda one: one.assign(density=one["density"].sum("alpha"))),
         r"got \(2, 12, 14\)", "`density` must have the shape"),
    Case("a density turned",
         without_checksums(lambda one: one.transpose("s", "alpha", "xi1", "xi2", ...)),
         "over s, alpha, xi1, xi2", "`density` must have the shape"),
    Case("half of the box",
         without_checksums(lambda one: one.isel(xi1=slice(0, 6))),
         r"got \(2, 6, 14, 8\)", "`density` must have the shape"),
    Case("arclengths backwards", without_checksums(lambda one: one.isel(s=[1, 0])),
         "got other numbers", "`s` must be finite and increase"),
    Case("an arclength of NaN",
         without_checksums(lambda one: one.assign_coords(s=[0.0, np.nan])),
         "got other numbers", "`s` must be finite and increase"),
    Case("another program's file",
         without_checksums(lambda one: xr.Dataset({"rain": ("day", [1.0, 2.0])})),
         "not a result of fpsolve", "`fpsolve_format` is missing"),
]  # fmt: skip
FILES = [*TRUNCATED, *FLIPPED, *OTHERS, *TAMPERED]


@cache
def _folder():
    """Where the file and the store of the solution are kept; it goes with Python."""
    kept = TemporaryDirectory()
    atexit.register(kept.cleanup)
    return Path(kept.name)


@cache
def _written(suffix):
    return solution().save(_folder() / f"solution{suffix}")


def write_solution(path):
    """A copy of the file or store of the solution, which is written once."""
    kept = _written(path.suffix)
    return (shutil.copytree if kept.is_dir() else shutil.copyfile)(kept, path)


def write_paths(path):
    return replace(problems.paths()).save(path)
