"""What pydantic found wrong, in the words of the configuration file."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import SequenceMatcher
from typing import Any

from pydantic import ValidationError

from fpsolve.cli.config.description import Written
from fpsolve.cli.config.design import DesignConfig
from fpsolve.cli.config.paths import PathsConfig
from fpsolve.cli.config.run import RunConfig
from fpsolve.cli.config.sections import kinds_of
from fpsolve.cli.config.string import StringConfig
from fpsolve.cli.config.web import WebConfig

__all__ = ["complaints", "suggestion"]

# The command that reads a kind of configuration.
_COMMANDS: dict[type[Written], str] = {
    RunConfig: "fpsolve run",
    PathsConfig: "fpsolve paths",
    WebConfig: "fpsolve web",
    DesignConfig: "fpsolve design",
    StringConfig: "fpsolve string",
}
# A section of one name is the same in all of them.
_SECTIONS = {
    name: kinds_of(field.annotation)
    for config in _COMMANDS
    for name, field in config.model_fields.items()
}
# Share of matching letters from which a name counts as meant.
_NEAR = 0.5
# What TOML calls the types that pydantic speaks of.
_TYPES = {
    "a valid number": "a number",
    "a valid integer": "an integer",
    "a valid string": "a string",
    "a valid boolean": "true or false",
    "a valid tuple": "a list",
}


def complaints(error: ValidationError, config: type[Written]) -> list[str]:
    """Return a sentence for every key that is wrong, the section named first.

    A value that fits none of several types gives one sentence with all of them. A
    whole configuration of another command gives one sentence that names it.
    """
    command = _other_command(error, config)
    if command is not None:
        return [f"its sections are those of `{command}`; give it to that command."]
    found: dict[tuple[Any, ...], str] = {}
    for entry in error.errors():
        place, sentence = _place(entry["loc"]), _sentence(entry, config)
        if place in found and entry["type"] != "extra_forbidden":
            found[place] = _joined(found[place], sentence)
        else:
            found[place] = sentence
    return list(found.values())


def suggestion(name: str, known: Iterable[str], quote: str = "`{}`") -> str:
    """Return the end of a sentence: "; did you mean `noise`?", or "." if none is near.

    Parameters
    ----------
    name : str
        What was written.
    known : iterable of str
        What could have been meant; the first of equally near ones is named.
    quote : str
        How to quote a name.
    """

    def nearness(candidate: str) -> float:
        return SequenceMatcher(None, name, candidate).ratio()

    nearest = max(known, key=nearness, default="")
    near = nearest and nearness(nearest) >= _NEAR
    return f"; did you mean {quote.format(nearest)}?" if near else "."


def _other_command(error: ValidationError, config: type[Written]) -> str | None:
    """Return the command to which the file belongs, if its sections say so."""
    unknown = {
        entry["loc"][0]
        for entry in error.errors()
        if entry["type"] == "extra_forbidden"
    }
    for other, command in _COMMANDS.items():
        fields = other.model_fields.items()
        needed = {name for name, field in fields if field.is_required()}
        if other is not config and needed <= unknown - config.model_fields.keys():
            return command
    return None


def _place(location: tuple[int | str, ...]) -> tuple[Any, ...]:
    """Return (section, kind, key) of an error, as far as it says."""
    if not location:
        return (None, None, None)
    name, *rest = location
    kind = rest.pop(0) if rest and rest[0] in _SECTIONS.get(str(name), {}) else None
    return (name, kind, rest[0] if rest else None)


def _sentence(entry: Mapping[str, Any], config: type[Written]) -> str:
    name, kind, key = _place(entry["loc"])
    what = entry["type"]
    if what == "value_error":
        text = str(entry["ctx"]["error"])
        return text if name is None else f"section [{name}]: {text}"
    if key is None and what in ("extra_forbidden", "missing"):
        return _wrong_section(name, what, config)
    if what.startswith("union_tag"):
        return _wrong_kind(name, entry)
    if what == "extra_forbidden":
        return _unknown_key(name, kind, key)
    if what == "missing" and not _entry_number(entry):
        return f"section [{name}]: `{key}` must be given. {_keys_text(name, kind)}"
    return _wrong_value(name, key, entry)


def _wrong_section(name: str, what: str, config: type[Written]) -> str:
    if what == "missing":
        return f"section [{name}] must be given, got none."
    near = suggestion(name, config.model_fields, "[{}]")
    for other, command in _COMMANDS.items():
        if name in other.model_fields:
            near = f"; it belongs to the configuration of `{command}`."
    known = ", ".join(f"[{section}]" for section in config.model_fields)
    return f"unknown section [{name}]{near} Sections are {known}."


def _wrong_kind(name: str, entry: Mapping[str, Any]) -> str:
    kinds = [str(kind) for kind in _SECTIONS[name]]
    known = ", ".join(repr(kind) for kind in kinds)
    rule = f"section [{name}]: `kind` must be one of {known}"
    if entry["type"] == "union_tag_not_found":
        return f"{rule}, got none."
    given = entry["ctx"]["tag"]
    return f"{rule}, got {given!r}{suggestion(given, kinds, '{!r}')}"


def _unknown_key(name: str, kind: str | None, key: str) -> str:
    near = suggestion(key, _SECTIONS[name][kind].keys())
    owner = "" if kind is None else f" of the kind {kind!r}"
    keys = _keys_text(name, kind)
    return f"section [{name}]: `{key}` is not a key{owner}{near} {keys}"


def _wrong_value(name: str, key: str | None, entry: Mapping[str, Any]) -> str:
    if key is None:
        return f"section [{name}] must be a table, got {entry['input']!r}."
    rule, number = _rule(entry), _entry_number(entry)
    if entry["type"] == "missing":
        number = ""
    return f"section [{name}]: `{key}{number}` {rule}, got {_shown(entry['input'])}."


def _rule(entry: Mapping[str, Any]) -> str:
    if entry["type"] == "missing":
        return "must be a longer list"
    if entry["type"] == "too_long":
        return f"must be a list of {entry['ctx']['max_length']}"
    rule = str(entry["msg"]).replace("Input should", "must")
    for theirs, ours in _TYPES.items():
        rule = rule.replace(theirs, ours)
    return rule


def _entry_number(entry: Mapping[str, Any]) -> str:
    """Return "[1]" when the second entry of a list is wrong, else nothing."""
    last = entry["loc"][-1]
    return f"[{last}]" if isinstance(last, int) else ""


def _joined(first: str, second: str) -> str:
    """Return one sentence for two rules that the same value breaks."""
    rule = second.partition("` must be ")[2].rpartition(", got ")[0]
    if not rule or f"be {rule}" in first or f"or {rule}" in first:
        return first
    start, got, value = first.rpartition(", got ")
    return f"{start} or {rule}{got}{value}"


def _shown(value: Any) -> str:
    return str(list(value)) if isinstance(value, tuple) else repr(value)


def _keys_text(name: str, kind: str | None) -> str:
    return f"Keys are {', '.join(_SECTIONS[name][kind].keys())}."
