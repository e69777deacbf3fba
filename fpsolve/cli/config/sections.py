"""Sections of a configuration, made from the constructors that they fill.

A section has the parameters of its constructor as keys, with the same types and
defaults, so that a new option of a scheme needs no line here.
"""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Mapping
from functools import reduce
from operator import or_
from typing import Annotated, Any, ClassVar, Literal, get_type_hints

from pydantic import BaseModel, ConfigDict, Field, create_model, model_validator

__all__ = ["Section", "kinds_of", "one_of", "section"]

# Parameters that come from other sections of the file.
_FROM_ELSEWHERE = ("model", "grid", "potential", "curve")


class Section(BaseModel):
    """A table of a configuration file; unknown keys and wrong types are refused."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, arbitrary_types_allowed=True
    )

    target: ClassVar[Callable[..., Any]]
    # Whether the target can be made, and so checked, from this section alone.
    complete: ClassVar[bool] = False

    def make(self, **others: Any) -> Any:
        """Call the constructor with the keys of this section.

        Those of `others` that it takes come in addition.
        """
        target = type(self).target
        known = inspect.signature(target).parameters
        values = {**others, **{name: getattr(self, name) for name in self.keys()}}
        return target(**{name: values[name] for name in values if name in known})

    @classmethod
    def keys(cls) -> tuple[str, ...]:
        """Return the names that may be given."""
        return tuple(cls.model_fields)

    @model_validator(mode="after")
    def _check(self) -> Section:
        if self.complete:
            with warnings.catch_warnings():
                # They are given when the run is built.
                warnings.simplefilter("ignore")
                self.make()
        return self


def section(
    target: Callable[..., Any],
    kind: str | None = None,
    types: Mapping[str, Any] | None = None,
) -> type[Section]:
    """Return the section whose keys are the parameters of `target`.

    Parameters
    ----------
    target : callable
        Class or function to call with the values.
    kind : str, optional
        Value of the key `kind` that selects this section among several.
    types : mapping, optional
        Types of parameters whose annotation says less than a file may hold.
    """
    parameters = inspect.signature(target).parameters
    hints = get_type_hints(target.__init__ if inspect.isclass(target) else target)
    hints |= types or {}
    keys: dict[str, Any] = {
        name: (hints[name], ... if one.default is one.empty else one.default)
        for name, one in parameters.items()
        if name not in _FROM_ELSEWHERE
    }
    if kind is not None:
        keys = {"kind": (Literal[kind], ...), **keys}
    made = create_model(kind or target.__name__, __base__=Section, **keys)
    made.target = target
    made.complete = not any(name in parameters for name in _FROM_ELSEWHERE)
    return made


def one_of(*sections: type[Section]) -> Any:
    """Return the type of a section that the key `kind` selects."""
    return Annotated[reduce(or_, sections), Field(discriminator="kind")]


def kinds_of(annotation: Any) -> dict[str | None, type[Section]]:
    """Return the sections that an annotation of a configuration allows, by kind."""
    if inspect.isclass(annotation) and issubclass(annotation, Section):
        kind = annotation.model_fields.get("kind")
        name = None if kind is None else kind.annotation.__args__[0]  # type: ignore[union-attr]
        return {name: annotation}
    found: dict[str | None, type[Section]] = {}
    for part in getattr(annotation, "__args__", ()):
        found |= kinds_of(part)
    return found
