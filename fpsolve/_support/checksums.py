"""Checksums of what a file holds: damage that no library sees is noticed on reading.

Neither netCDF nor zarr protects plain numbers: a flipped bit is another number, and a
chunk that is missing reads as a fill value. The digests cover every variable (name,
dimensions, shape, type, labels, bytes) and all attributes that were written; what
another program adds to the file is not looked at. They are kept in one attribute, and a
file without it, of an older version or another program, is read as it is.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.json_text import bounded_json

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "CHECKSUMS",
    "covered_variables",
    "digest_of",
    "stamped",
    "verified",
    "with_digest",
]

CHECKSUMS = "fpsolve_checksums"
# Names of the attributes that the digest covers, itself among them.
_COVERED = "fpsolve_attributes"

# In the place of a variable's name.
_ATTRIBUTES = "attributes of the file"
# What libraries and tools add to a file of their own accord. Files of older versions do
# not name their attributes.
_FOREIGN = frozenset((
    CHECKSUMS, "coordinates", "history", "history_of_appended_files", "NCO", "CDO",
    "CDI", "nco_openmp_thread_number", "_NCProperties",
))  # fmt: skip
_LABELS = ("long_name", "units")


def stamped(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with the attribute that holds its checksums."""
    names = sorted({*map(str, dataset.attrs), _COVERED} - {CHECKSUMS})
    named = dataset.assign_attrs({_COVERED: json.dumps(names)})
    return named.assign_attrs({CHECKSUMS: json.dumps(_digests(named))})


def covered_variables(attributes: Mapping[Any, Any]) -> frozenset[str] | None:
    """Return the names of the variables with a checksum; None if there are none."""
    if CHECKSUMS not in attributes:
        return None
    return frozenset(_written(attributes)) - {_ATTRIBUTES}


def verified(dataset: xr.Dataset) -> xr.Dataset:
    """Return what was written, without its checksums, which must fit.

    Variables and attributes that were added later are left out.

    Raises
    ------
    ValueError
        If one does not, or a variable is missing; names all that are damaged.
    """
    if CHECKSUMS not in dataset.attrs:
        return dataset
    written = _written(dataset.attrs)
    dataset = dataset.drop_vars(
        [one for one in dataset.variables if one not in written]
    )
    found = _digests(dataset)
    damaged = [name for name in written if found.get(name) != written[name]]
    if damaged:
        names = ", ".join(f"`{name}`" for name in damaged)
        raise ValueError(
            f"it is not what was written: the checksum of {names} does not fit; make "
            "it again, or take a copy from before it was damaged or changed"
        )
    plain = dataset.copy(deep=False)
    kept = _covered(dataset.attrs)
    kept.pop(_COVERED, None)
    plain.attrs = kept
    return plain


def digest_of(
    name: str,
    dimensions: Iterable[str],
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
    labels: Mapping[str, Any],
    blocks: Iterable[Any],
) -> str:
    """Return the digest of a variable, whose numbers may come in blocks."""
    header = [name, *dimensions, *map(str, shape), _type_name(dtype)]
    header += [str(labels.get(label, "")) for label in _LABELS]
    digest = hashlib.blake2b("\0".join(header).encode(), digest_size=16)
    for block in blocks:
        digest.update(_content(np.asarray(block)))
    return digest.hexdigest()


def with_digest(checksums: str, name: str, digest: str) -> str:
    """Return the attribute with the digest of one more variable."""
    return json.dumps({**json.loads(checksums), name: digest})


def _digests(dataset: xr.Dataset) -> dict[str, str]:
    digests = {
        str(name): digest_of(
            str(name),
            map(str, variable.dims),
            variable.shape,
            variable.dtype,
            variable.attrs,
            [variable.values],
        )
        for name, variable in dataset.variables.items()
    }
    return {**digests, _ATTRIBUTES: _attributes_digest(dataset.attrs)}


def _attributes_digest(attributes: Mapping[Any, Any]) -> str:
    own = {name: _plain(value) for name, value in _covered(attributes).items()}
    text = json.dumps(own, sort_keys=True)
    return hashlib.blake2b(text.encode(), digest_size=16).hexdigest()


def _written(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    written = bounded_json(CHECKSUMS, attributes[CHECKSUMS])
    if not isinstance(written, dict):
        raise ValueError(f"`{CHECKSUMS}` must be a table, got something else.")
    return written


def _covered(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    """Return the attributes that a digest covers; those of others may be there too."""
    named = {str(name): value for name, value in attributes.items()}
    if _COVERED not in named:
        return {name: one for name, one in named.items() if name not in _FOREIGN}
    names = bounded_json(_COVERED, named[_COVERED])
    if not isinstance(names, list):
        raise ValueError(f"`{_COVERED}` must be a list, got something else.")
    return {name: one for name, one in named.items() if name in set(map(str, names))}


def _type_name(dtype: np.dtype[Any]) -> str:
    """Return the name of a type, the same for every way of storing text."""
    if dtype.kind in "OUST":
        return "text"
    return dtype.newbyteorder("<").str


def _content(block: np.ndarray) -> Any:
    if _type_name(block.dtype) == "text":
        return "\0".join(map(str, block.ravel())).encode()
    plain = np.ascontiguousarray(block, dtype=block.dtype.newbyteorder("<"))
    return plain.reshape(-1).view(np.uint8)


def _plain(value: Any) -> Any:
    """Return an attribute as the same text before and after a file."""
    array = np.asarray(value)
    if array.dtype.kind in "OUST":
        return [str(one) for one in array.ravel()]
    return [repr(float(one)) for one in array.ravel()]
