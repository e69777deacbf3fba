"""How a result is stored: a table of its parts, from which both directions follow.

A class of results names its parts in a `Layout`. Each part is some fields of the
result and what holds them in the dataset; it writes them, says what it needs, and
reads them again where they fit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from fpsolve._support.checks import shown
from fpsolve._support.declared import declared
from fpsolve._support.labels import (
    check_complete,
    labels,
    marked,
    origin,
    read_provenance,
)
from fpsolve.evolution.call import Call

if TYPE_CHECKING:
    import xarray as xr

__all__ = [
    "Attribute",
    "Columns",
    "Layout",
    "Part",
    "Source",
    "Variable",
    "check_counts",
    "check_dimensions",
]

# Name to a variable as xarray takes it, a tuple, or to an attribute, which is none.
Stored = dict[str, Any]
Take = Callable[[Any], Any]


def _as_it_is(value: Any) -> Any:
    return value


@dataclass(frozen=True)
class Source:
    """What a result is read from.

    Attributes
    ----------
    dataset : xarray.Dataset
    about : dict
        Its attributes, each of its type.
    provenance : dict
        To which a part adds what it cannot make again.
    owners : mapping
        What makes, from a model, a field whose class stands above the result's.
    fields : dict
        Those that were read before, by name.
    """

    dataset: xr.Dataset
    about: Mapping[str, Any]
    provenance: dict[str, Any]
    owners: Mapping[str, Callable[..., Any]]
    fields: dict[str, Any] = field(default_factory=dict)


class Part:
    """Some fields of a result in its dataset."""

    @property
    def needed(self) -> tuple[str, ...]:
        """Variables and attributes without which it cannot be read."""
        return ()

    def write(self, result: Any) -> Stored:
        """Variables and attributes by name."""
        raise NotImplementedError

    def read(self, source: Source) -> dict[str, Any]:
        """The fields by name; ValueError if what is stored does not fit."""
        return {}


class Layout:
    """The parts of a kind of result, in the order of its dataset.

    How it was called and its provenance come along by themselves.

    Parameters
    ----------
    title : str
        Attribute of the dataset.
    *parts : Part
        Each is read after those before it.
    """

    def __init__(self, title: str, *parts: Part) -> None:
        self.title, self.parts = title, parts

    def dataset(self, result: Any) -> xr.Dataset:
        """The result as a labelled Dataset."""
        import xarray as xr

        variables: Stored = {}
        attributes: Stored = {"title": self.title}
        for part in self.parts:
            for name, value in part.write(result).items():
                (variables if isinstance(value, tuple) else attributes)[name] = value
        attributes |= origin(result.provenance)
        dataset = xr.Dataset(variables, attrs=attributes)
        # What is named like its dimension is a coordinate by itself.
        dataset = dataset.set_coords([one for one in ("s_step",) if one in dataset])
        dataset = dataset if result.call is None else result.call.on(dataset)
        return marked(dataset, result.kind)

    def read(
        self, dataset: xr.Dataset, owners: Mapping[str, Callable[..., Any]]
    ) -> dict[str, Any]:
        """The fields of the result that `dataset` turned into a Dataset.

        Raises
        ------
        ValueError
            If a part is missing, or does not fit.
        """
        needed = [name for part in self.parts for name in part.needed]
        check_complete(dataset, *needed, "provenance")
        about = declared(dataset.attrs)
        source = Source(dataset, about, read_provenance(about), owners)
        for part in self.parts:
            source.fields.update(part.read(source))
        call = Call.from_xarray(dataset)
        return {**source.fields, "call": call, "provenance": source.provenance}


@dataclass(frozen=True)
class Variable(Part):
    """A field of numbers, or numbers for the readers of the dataset alone.

    Attributes
    ----------
    name : str
        In the dataset.
    dims : tuple of str
    words : str
        Its long name; none for texts.
    field : str
        In the result, if it is another name.
    kind : callable
        Of what is read: `float`, `int`; an array by default.
    optional : bool
        Whether the field may be None, and is left out then.
    increasing : bool
        Whether the numbers must be arclengths, which increase.
    values : callable
        Of the result, in place of a field; nothing is read then.
    """

    name: str
    dims: tuple[str, ...]
    words: str = ""
    field: str = ""
    kind: Take = np.asarray
    optional: bool = False
    increasing: bool = False
    values: Take | None = None

    @property
    def needed(self) -> tuple[str, ...]:
        """Its name, unless it may be left out."""
        return () if self.optional or self.values else (self.name,)

    def write(self, result: Any) -> Stored:
        """One, or none."""
        take = self.values or (lambda result: getattr(result, self.field or self.name))
        values = take(result)
        about = labels(self.words) if self.words else {}
        left_out = values is None and self.optional
        return {} if left_out else {self.name: (self.dims, values, about)}

    def read(self, source: Source) -> dict[str, Any]:
        """The numbers, over the dimensions that they had."""
        name = self.field or self.name
        if self.values:
            return {}
        if self.name not in source.dataset:
            return {name: None}
        check_dimensions(source.dataset, self.name, self.dims)
        values = source.dataset[self.name].values
        if self.increasing:
            check_increasing(self.name, values)
        return {name: self.kind(values)}


@dataclass(frozen=True)
class Attribute(Part):
    """A field as an attribute, or an attribute for the readers of the dataset alone.

    Attributes
    ----------
    name, field, optional, values
        As for `Variable`.
    write_as, read_as : callable
        Of the field, and of the attribute as `declared` gives it.
    """

    name: str
    field: str = ""
    write_as: Take = _as_it_is
    read_as: Take = _as_it_is
    optional: bool = False
    values: Take | None = None

    @property
    def needed(self) -> tuple[str, ...]:
        """Its name, unless it may be left out."""
        return () if self.optional or self.values else (self.name,)

    def write(self, result: Any) -> Stored:
        """One, or none."""
        if self.values:
            return {self.name: self.values(result)}
        value = getattr(result, self.field or self.name)
        left_out = value is None and self.optional
        return {} if left_out else {self.name: self.write_as(value)}

    def read(self, source: Source) -> dict[str, Any]:
        """What is made of it."""
        if self.values:
            return {}
        value = source.about.get(self.name)
        left_out = value is None and self.optional
        return {self.field or self.name: None if left_out else self.read_as(value)}


@dataclass(frozen=True)
class Columns(Part):
    """A mapping of numbers: a variable for every name.

    Attributes
    ----------
    field : str
    names : tuple of str
        What may be in it.
    dims : tuple of str
        "{}" stands for the name.
    words : callable
        Long name of a name.
    pattern : str
        Name of the variable.
    kind : callable
        Of what is read: `float`; an array by default.
    """

    field: str
    names: tuple[str, ...]
    dims: tuple[str, ...]
    words: Callable[[str], str]
    pattern: str = "{}"
    kind: Take = np.asarray

    @property
    def needed(self) -> tuple[str, ...]:
        """A variable for every name."""
        return tuple(map(self.pattern.format, self.names))

    def write(self, result: Any) -> Stored:
        """As many as there are names."""
        return {
            self.pattern.format(name): (self._over(name), values,
                                        labels(self.words(name)))
            for name, values in getattr(result, self.field).items()
        }  # fmt: skip

    def read(self, source: Source) -> dict[str, Any]:
        """The mapping."""
        found = {}
        for name, variable in zip(self.names, self.needed, strict=True):
            check_dimensions(source.dataset, variable, self._over(name))
            found[name] = self.kind(source.dataset[variable].values)
        return {self.field: found}

    def _over(self, name: str) -> tuple[str, ...]:
        return tuple(one.format(name) for one in self.dims)


def check_dimensions(dataset: xr.Dataset, name: str, dims: tuple[str, ...]) -> None:
    """Raise ValueError unless a variable holds numbers over these dimensions."""
    found = dataset[name]
    if found.dims != dims or found.dtype.kind not in "iuf":
        raise ValueError(
            f"`{name}` must hold numbers over {', '.join(dims) or 'nothing'}, got "
            f"{found.dtype} over {', '.join(map(str, found.dims)) or 'nothing'}"
        )


def check_increasing(name: str, values: Any) -> None:
    """Raise ValueError unless the arclengths are finite and increase."""
    if not (np.isfinite(values).all() and (np.diff(values) > 0).all()):
        raise ValueError(f"`{name}` must be finite and increase, got other numbers")


def check_counts(name: str, expected: Any, got: Any, of: str) -> None:
    """Raise ValueError unless what an attribute says is what a variable holds."""
    if expected != got:
        raise ValueError(
            f"`{name}` must be {shown(got)} as in {of}, got {shown(expected)}"
        )
