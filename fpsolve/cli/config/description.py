"""What the configurations of all commands share: the model, and how it is written."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Self, cast

from pydantic import model_validator

from fpsolve.cli.config.kinds import (
    CurveSection,
    ModelSection,
    PotentialSection,
    ProcessSection,
)
from fpsolve.cli.config.sections import Section
from fpsolve.errors import ConfigurationError
from fpsolve.model.curves.belts import FixedBelt
from fpsolve.model.fibre import FibreModel

__all__ = ["Description", "Written", "named_section"]


class Written(Section):
    """Tables of a file, which are written out again with the defaults."""

    def changed(self, section: str, **keys: Any) -> Self:
        """Return the configuration with the keys that are not None in a section."""
        given = {name: value for name, value in keys.items() if value is not None}
        changed = getattr(self, section).model_copy(update=given)
        return self.model_copy(update={section: changed})

    def to_toml(self) -> str:
        """Return the configuration as TOML, with the defaults written out."""
        tables = self.model_dump(exclude_none=True)
        return "\n".join(
            f"[{name}]\n" + "".join(_line(*item) for item in table.items())
            for name, table in tables.items()
        )


class Description(Written):
    """The sections `potential`, `model` and `curve`, or `process` in their place."""

    potential: PotentialSection | None = None
    model: ModelSection | None = None
    curve: CurveSection | None = None
    process: ProcessSection | None = None

    @model_validator(mode="after")
    def _check_model(self) -> Description:
        parts = {"potential": self.potential, "model": self.model, "curve": self.curve}
        given = [f"[{name}]" for name, part in parts.items() if part is not None]
        if self.process is not None and given:
            raise ValueError(
                f"[process] must stand alone, got {', '.join(given)} beside it; remove "
                "one or the other."
            )
        if self.process is None and (self.potential is None or self.model is None):
            raise ValueError(
                "the sections [potential] and [model], or [process], must be given, "
                f"got {', '.join(given) or 'none of them'}."
            )
        return self

    def build_model(self) -> FibreModel:
        """Return the model.

        Raises
        ------
        ConfigurationError
            If its sections do not fit each other.
        """
        with named_section("model" if self.process is None else "process"):
            return self._model()

    def _model(self) -> FibreModel:
        if self.potential is None or self.model is None:
            process = cast(Section, self.process)
            return cast(FibreModel, process.make().model)
        curve = FixedBelt() if self.curve is None else self.curve.make()
        model = self.model.make(potential=self.potential.make(), curve=curve)
        return cast(FibreModel, model)


@contextmanager
def named_section(name: str) -> Iterator[None]:
    """Name the section in what its constructor complains about."""
    try:
        yield
    except (ValueError, TypeError) as error:
        raise ConfigurationError(f"section [{name}]: {error}") from error


def _line(key: str, value: Any) -> str:
    return f"{key} = {_literal(value)}\n"


def _literal(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_literal, value))}]"
    if isinstance(value, float):
        return repr(value)
    # JSON and TOML differ in infinity, in characters that JSON writes as a pair of
    # surrogates, and in the one control character that JSON leaves as it is.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
