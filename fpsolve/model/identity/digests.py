"""Digests of values, functions and objects of any kind."""

from __future__ import annotations

import functools
import hashlib
import types
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fpsolve.model.curves.curve import Curve
from fpsolve.model.curves.dictionaries import KINDS as CURVES
from fpsolve.model.curves.dictionaries import curve_to_dict
from fpsolve.model.identity.code import (
    attribute_names,
    enclosed,
    facts,
    imported,
    named_globals,
)
from fpsolve.model.identity.objects import (
    UnidentifiedError,
    name_of,
    own_entries,
    state_of,
    without_kept,
)
from fpsolve.model.identity.packages import (
    package_of_class,
    package_of_file,
    package_of_module,
)
from fpsolve.model.potentials.dictionaries import KINDS as POTENTIALS
from fpsolve.model.potentials.dictionaries import potential_to_dict
from fpsolve.model.potentials.potential import Potential

__all__ = ["digest_or_none", "identity_digest"]

_OWN = (*POTENTIALS.values(), *CURVES.values())
_LEAVES = {bool, int, str, type(None), type(...), type(NotImplemented)}
_ACCESSORS = (property, staticmethod, classmethod, functools.cached_property)


def identity_digest(value: Any, *, sampled: bool = True) -> str:
    """Return a SHA-256 that says what `value` is.

    The same for objects built alike, in this process or in another with the same
    versions; another one if data differ in a bit or in their order, or code in an
    instruction, a constant, a default, an enclosed variable, or in a global function,
    class or value that it names, in its own module or in another one of the user's.
    Code of Python and of installed packages is known by its name and their version,
    that of fpsolve by its source as well. Not seen is what code reads from files,
    clocks and generators of random numbers, and what it finds by names that it puts
    together.

    Parameters
    ----------
    value : object
    sampled : bool
        A user's potentials and curves are also known by what they compute (see
        `model.potentials.samples`), and by this alone if they hold something with
        neither code nor data. False leaves this out, and so the rounding of a machine.

    Raises
    ------
    UnidentifiedError
        If there is something with neither code nor data in it, as an open file.
    """
    try:
        return _Digests(sampled).of(value).hex()
    except UnidentifiedError:
        raise
    except Exception:
        # An object that is asked for its parts raises whatever it likes.
        raise UnidentifiedError(value) from None


def digest_or_none(value: Any, *, sampled: bool = True) -> str | None:
    """As `identity_digest`; None for what cannot be identified."""
    try:
        return identity_digest(value, sampled=sampled)
    except UnidentifiedError:
        return None


def _hashed(kind: str, *parts: bytes) -> bytes:
    found = hashlib.sha256(f"{kind}\0{len(parts)}\0".encode())
    for part in parts:
        # The digest of each: where one ends and the next begins must not matter.
        found.update(hashlib.sha256(part).digest())
    return found.digest()


class _Digests:
    """The digests of all objects that one refers to."""

    def __init__(self, sampled: bool) -> None:
        self.sampled = sampled
        # Addresses of the objects whose digest has begun: what refers to one of them
        # closes a circle.
        self.open: list[int] = []
        # Digests by address, with the objects, so that no address is used again.
        self.known: dict[int, tuple[Any, bytes]] = {}

    def of(self, value: Any) -> bytes:
        """Digest of any object."""
        if type(value) in _LEAVES:
            return _hashed(type(value).__name__, repr(value).encode())
        if id(value) in self.known:
            return self.known[id(value)][1]
        if id(value) in self.open:
            up = len(self.open) - self.open.index(id(value))
            return _hashed("circle", str(up).encode())
        self.open.append(id(value))
        try:
            found = self._new(value)
        finally:
            self.open.pop()
        self.known[id(value)] = value, found
        return found

    def all(self, kind: str, *values: Any) -> bytes:
        """Digest of several objects, in their order."""
        return _hashed(kind, *map(self.of, values))

    def _new(self, value: Any) -> bytes:
        if type(value) in _PLAIN:
            return _PLAIN[type(value)](self, value)
        for kinds, rule in _RULES:
            if isinstance(value, kinds):
                return rule(self, value)
        return self._object(value)

    def _number(self, value: Any) -> bytes:
        parts = (value.real, value.imag) if isinstance(value, complex) else (value,)
        return _hashed("number", *(float(part).hex().encode() for part in parts))

    def _array(self, value: Any) -> bytes:
        array = np.asarray(value)
        about = f"{array.dtype.str}{array.dtype.descr}{array.shape}"
        if array.dtype.hasobject:
            return self.all("objects", about, array.ravel().tolist())
        bits = np.ascontiguousarray(array).tobytes()
        return _hashed("array", type(value).__name__.encode(), about.encode(), bits)

    def _bytes(self, value: Any) -> bytes:
        return _hashed(type(value).__name__, bytes(value))

    def _sequence(self, value: Any) -> bytes:
        return self.all(type(value).__name__, *value)

    def _mapping(self, value: Any) -> bytes:
        # In its order, in which a function may give its results.
        return self.all("mapping", *(part for pair in value.items() for part in pair))

    def _set(self, value: Any) -> bytes:
        return _hashed(type(value).__name__, *sorted(map(self.of, value)))

    def _module(self, value: types.ModuleType) -> bytes:
        package = package_of_module(value)
        if package is not None:
            return self.all("module", package, value.__name__)
        file = getattr(value, "__file__", None)
        if file is None:
            raise UnidentifiedError(value)
        return _hashed("module", Path(file).read_bytes())

    def _function(self, value: types.FunctionType) -> bytes:
        name = name_of(value)
        if name is not None:
            return self.all("named", *name)
        own = self.all(
            "own", value.__code__, value.__defaults__, value.__kwdefaults__,
            enclosed(value), without_kept(value, vars(value)),
        )  # fmt: skip
        package = package_of_file(value.__code__.co_filename)
        if package is not None:
            return _hashed("function", self.of(package), own)
        names = attribute_names(value)
        around = {**named_globals(value), **imported(value)}
        about = [part for name in around for part in (name, around[name])]
        return _hashed("function", own, *(self._referred(one, names) for one in about))

    def _referred(self, value: Any, names: tuple[str, ...]) -> bytes:
        """Digest of what code refers to: of a user's module, what it may ask for."""
        if not isinstance(value, types.ModuleType) or package_of_module(value):
            return self.of(value)
        if id(value) in self.open:
            return _hashed("circle", value.__name__.encode())
        self.open.append(id(value))
        try:
            asked = {name: vars(value)[name] for name in names if name in vars(value)}
            parts = (self._referred(one, names) for one in asked.values())
            return _hashed("attributes", self.of(tuple(asked)), *parts)
        finally:
            self.open.pop()

    def _code(self, value: types.CodeType) -> bytes:
        return self.all("code", *facts(value), value.co_consts)

    def _method(self, value: types.MethodType) -> bytes:
        return self.all("method", value.__func__, value.__self__)

    def _accessor(self, value: Any) -> bytes:
        names = ("fget", "fset", "fdel", "func", "__func__")
        parts = (getattr(value, name, None) for name in names)
        return self.all(type(value).__name__, *parts)

    def _class(self, value: type) -> bytes:
        package = package_of_class(value)
        if package is not None:
            return self.all("class", package, value.__module__, value.__qualname__)
        return self.all("class", own_entries(value), value.__bases__)

    def _potential(self, value: Potential | Curve) -> bytes:
        """Digest of a potential or a curve: of ours by parameters alone."""
        if type(value) in _OWN:
            return self.all("ours", type(value), value.to_dict())
        if not self.sampled:
            return self._object(value)
        try:
            own = self._object(value)
        except UnidentifiedError:
            own = b""
        if isinstance(value, Potential):
            return _hashed("potential", own, self.of(potential_to_dict(value)))
        return _hashed("curve", own, self.of(curve_to_dict(value)))

    def _vectorized(self, value: np.vectorize) -> bytes:
        about = (value.otypes, value.excluded, value.signature)
        return self.all("vectorize", value.pyfunc, *about)

    def _object(self, value: Any) -> bytes:
        """Digest of an instance: its class and its state; or of what has a name."""
        name = name_of(value)
        if name is not None:
            return self.all("named", *name)
        wrapped = getattr(value, "py_func", None) or getattr(value, "__wrapped__", None)
        if callable(wrapped):
            return self.all("wrapped", type(value), wrapped)
        owner = getattr(value, "__self__", None)
        if isinstance(value, types.BuiltinFunctionType | types.MethodWrapperType):
            return self.all("method", value.__name__, owner)
        if is_dataclass(value) and package_of_class(type(value)) is not None:
            # What follows from the arguments, or has been asked before, adds nothing.
            parts = {f.name: getattr(value, f.name) for f in fields(value) if f.init}
            return self.all("dataclass", type(value), parts)
        return self.all("object", type(value), *state_of(value))


_Rule = Callable[[_Digests, Any], bytes]
# Of these exactly: what is derived from them may hold more.
_PLAIN: dict[type, _Rule] = {
    list: _Digests._sequence,
    tuple: _Digests._sequence,
    dict: _Digests._mapping,
    set: _Digests._set,
    frozenset: _Digests._set,
    np.ndarray: _Digests._array,
}
_RULES: tuple[tuple[Any, _Rule], ...] = (
    ((float, complex), _Digests._number),
    ((bytes, bytearray), _Digests._bytes),
    (np.generic, _Digests._array),
    (types.ModuleType, _Digests._module),
    (types.FunctionType, _Digests._function),
    (types.CodeType, _Digests._code),
    (types.MethodType, _Digests._method),
    (types.MappingProxyType, _Digests._mapping),
    (_ACCESSORS, _Digests._accessor),
    (type, _Digests._class),
    ((Potential, Curve), _Digests._potential),
    (np.vectorize, _Digests._vectorized),
)
