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
    "Named",
    "Part",
    "Source",
    "Told",
    "Variable",
    "Written",
    "check_counts",
    "check_dimensions",
]

Variables = dict[str, Any]
Take = Callable[[Any], Any]


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
    """Some fields of a result in its dataset; what a part has not is empty."""

    @property
    def needed(self) -> tuple[str, ...]:
        """Variables without which it cannot be read."""
        return ()

    @property
    def needed_attributes(self) -> tuple[str, ...]:
        """Attributes without which it cannot be read."""
        return ()

    def variables(self, result: Any) -> Variables:
        """Variables of the dataset, as xarray takes them."""
        return {}

    def coordinates(self, result: Any) -> Variables:
        """Coordinates of the dataset, as xarray takes them."""
        return {}

    def attributes(self, result: Any) -> dict[str, Any]:
        """Attributes of the dataset."""
        return {}

    def read(self, source: Source) -> dict[str, Any]:
        """The fields; ValueError if what is stored does not fit."""
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

        variables: Variables = {}
        coordinates: Variables = {}
        attributes: dict[str, Any] = {"title": self.title}
        for part in self.parts:
            variables |= part.variables(result)
            coordinates |= part.coordinates(result)
            attributes |= part.attributes(result)
        attributes |= origin(result.provenance)
        dataset = xr.Dataset(variables, coordinates, attributes)
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
        told = [name for part in self.parts for name in part.needed_attributes]
        check_complete(dataset, needed, [*told, "provenance"])
        about = declared(dataset.attrs)
        source = Source(dataset, about, read_provenance(about), owners)
        for part in self.parts:
            source.fields.update(part.read(source))
        call = Call.from_xarray(dataset)
        return {**source.fields, "call": call, "provenance": source.provenance}


@dataclass(frozen=True)
class Variable(Part):
    """A field of numbers.

    Attributes
    ----------
    name : str
        In the dataset.
    dims : tuple of str
    words : str
        Its long name.
    field : str
        In the result, if it is another name.
    kind : callable
        Of what is read: `float`, `int`; an array by default.
    optional : bool
        Whether the field may be None, and is left out then.
    """

    name: str
    dims: tuple[str, ...]
    words: str
    field: str = ""
    kind: Take = np.asarray
    optional: bool = False

    @property
    def needed(self) -> tuple[str, ...]:
        """Its name, unless it may be left out."""
        return () if self.optional else (self.name,)

    def variables(self, result: Any) -> Variables:
        """One, or none."""
        values = getattr(result, self.field or self.name)
        if values is None and self.optional:
            return {}
        return {self.name: (self.dims, values, labels(self.words))}

    def read(self, source: Source) -> dict[str, Any]:
        """The numbers, over the dimensions that they had."""
        name = self.field or self.name
        if self.name not in source.dataset:
            return {name: None}
        check_dimensions(source.dataset, self.name, self.dims)
        return {name: self.kind(source.dataset[self.name].values)}


@dataclass(frozen=True)
class Written(Part):
    """A variable for the readers of the dataset, from which no field is made.

    Attributes
    ----------
    name : str
    dims : tuple of str
    values : callable
        Of the result.
    words : str
        Its long name; none for texts.
    coordinate : bool
    """

    name: str
    dims: tuple[str, ...]
    values: Take
    words: str = ""
    coordinate: bool = False

    def variables(self, result: Any) -> Variables:
        """One, unless it is a coordinate."""
        return {} if self.coordinate else self._labelled(result)

    def coordinates(self, result: Any) -> Variables:
        """One, if it is a coordinate."""
        return self._labelled(result) if self.coordinate else {}

    def _labelled(self, result: Any) -> Variables:
        about = labels(self.words) if self.words else {}
        return {self.name: (self.dims, self.values(result), about)}


@dataclass(frozen=True)
class Attribute(Part):
    """A field as an attribute.

    Attributes
    ----------
    name : str
        In the dataset.
    field : str
        In the result, if it is another name.
    write, make : callable
        Of the field, and of the attribute as `declared` gives it.
    optional : bool
        Whether the field may be None, and is left out then.
    """

    name: str
    field: str = ""
    write: Take = lambda value: value
    make: Take = lambda value: value
    optional: bool = False

    @property
    def needed_attributes(self) -> tuple[str, ...]:
        """Its name, unless it may be left out."""
        return () if self.optional else (self.name,)

    def attributes(self, result: Any) -> dict[str, Any]:
        """One, or none."""
        value = getattr(result, self.field or self.name)
        left_out = value is None and self.optional
        return {} if left_out else {self.name: self.write(value)}

    def read(self, source: Source) -> dict[str, Any]:
        """What is made of it."""
        value = source.about.get(self.name)
        left_out = value is None and self.optional
        return {self.field or self.name: None if left_out else self.make(value)}


@dataclass(frozen=True)
class Told(Part):
    """An attribute for the readers of the dataset, from which no field is made."""

    name: str
    value: Take

    def attributes(self, result: Any) -> dict[str, Any]:
        """One."""
        return {self.name: self.value(result)}


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

    def variables(self, result: Any) -> Variables:
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


@dataclass(frozen=True)
class Named(Part):
    """A mapping of floats: one variable over their names."""

    name: str
    over: str
    words: str
    field: str

    @property
    def needed(self) -> tuple[str, ...]:
        """The numbers and their names."""
        return self.name, self.over

    def variables(self, result: Any) -> Variables:
        """The numbers."""
        values = np.array([*getattr(result, self.field).values()], dtype=np.float64)
        return {self.name: (self.over, values, labels(self.words))}

    def coordinates(self, result: Any) -> Variables:
        """The names."""
        names = np.array([*getattr(result, self.field)], dtype=object)
        return {self.over: (self.over, names)}

    def read(self, source: Source) -> dict[str, Any]:
        """The mapping."""
        check_dimensions(source.dataset, self.name, (self.over,))
        names, values = (source.dataset[one].values for one in (self.over, self.name))
        pairs = zip(names, values, strict=True)
        return {self.field: {str(name): float(value) for name, value in pairs}}


def check_dimensions(dataset: xr.Dataset, name: str, dims: tuple[str, ...]) -> None:
    """Raise ValueError unless a variable holds numbers over these dimensions."""
    found = dataset[name]
    if found.dims != dims or found.dtype.kind not in "iuf":
        raise ValueError(
            f"`{name}` must hold numbers over {', '.join(dims) or 'nothing'}, got "
            f"{found.dtype} over {', '.join(map(str, found.dims)) or 'nothing'}"
        )


def check_counts(name: str, expected: Any, got: Any, of: str) -> None:
    """Raise ValueError unless what an attribute says is what a variable holds."""
    if expected != got:
        raise ValueError(
            f"`{name}` must be {shown(got)} as in {of}, got {shown(expected)}"
        )
