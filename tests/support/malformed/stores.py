"""Zarr stores and files of paths that lost a part, or have another one."""

from __future__ import annotations

import shutil

from .cases import Case
from .files import DAMAGED, attribute, cut, without_checksums


def without(pattern):
    """A store that has lost the first file of a pattern."""

    def damage(path):
        found = sorted(path.glob(pattern))
        assert found, pattern
        lost = found[0]
        shutil.rmtree(lost) if lost.is_dir() else lost.unlink()
        return path

    return damage


def changed(pattern, change):
    """A store of which a file has other bytes."""

    def damage(path):
        found = next(one for one in sorted(path.glob(pattern)) if one.is_file())
        found.write_bytes(change(found.read_bytes()))
        return path

    return damage


def edited(pattern, old, new):
    def edit(content):
        assert old in content
        return content.replace(old, new, 1)

    return changed(pattern, edit)


def flip(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


STORES = [
    Case("a chunk lost", without("density/c/*"), "checksum of `density`", DAMAGED),
    Case("a chunk flipped", changed("density/c/**/[0-9]*", flip),
         "`density`|it is damaged", DAMAGED),
    Case("a chunk cut", changed("density/c/**/[0-9]*", lambda one: one[:100]),
         "it is damaged|`density`", DAMAGED),
    Case("a chunk of nothing", changed("density/c/**/[0-9]*", lambda one: b""),
         "it is damaged|`density`", DAMAGED),
    Case("an array lost", without("density"), "`density`", DAMAGED),
    Case("a series lost", without("mass"), "checksum of `mass`", DAMAGED),
    Case("the root lost", without("zarr.json"), "result.zarr`: it is damaged", DAMAGED),
    Case("a root that is no JSON", changed("zarr.json", lambda one: one[:-20]),
         "result.zarr`: it is damaged", DAMAGED),
    Case("a root of nothing", changed("zarr.json", lambda one: b""),
         "result.zarr`: it is damaged", DAMAGED),
    Case("a root of another format",
         edited("zarr.json", b'"zarr_format": 3', b'"zarr_format": 9'),
         "result.zarr`: it is damaged", DAMAGED),
    Case("noise edited",
         edited("zarr.json", rb'\"noise\": 1.0', rb'\"noise\": 3.0'),
         "checksum of `attributes of the file`", DAMAGED),
    Case("an array's metadata lost", without("density/zarr.json"), "`density`",
         DAMAGED),
    Case("an array's metadata cut",
         changed("density/zarr.json", lambda one: one[: len(one) // 2]),
         "it is damaged", DAMAGED),
    Case("an array of another type",
         changed("density/zarr.json", lambda one: one.replace(b"float64", b"float32")),
         "it is damaged|`density`", DAMAGED),
    Case("an array of another shape",
         changed("density/zarr.json", lambda one: one.replace(b"14,", b"15,", 1)),
         "it is damaged|`density`", DAMAGED),
]  # fmt: skip


PATHS = [
    Case("a seed in words", attribute(seed="luck"), "'luck'", "int"),
    Case("a number of paths in words", attribute(n_paths="ten"), "'ten'", "int"),
    Case("saved steps that are no JSON", attribute(saved_steps="all"),
         "line 1", "JSON|Expecting"),
    Case("a start that is no JSON", attribute(initial="origin"),
         "line 1", "JSON|Expecting"),
    Case("no positions", without_checksums(lambda one: one.drop_vars("tau")),
         "`tau`", "is missing in it"),
    Case("no moments", without_checksums(lambda one: one.drop_vars("moment_sums")),
         "`moment_sums`", "is missing in it"),
    Case("paths cut byte by byte", cut(0.7), "result.nc`: it is damaged", DAMAGED),
]  # fmt: skip
