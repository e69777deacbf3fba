"""What a report consists of; the template says what each looks like."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

__all__ = [
    "Block",
    "Equation",
    "Facts",
    "Figure",
    "Listing",
    "Notice",
    "Paragraph",
    "Part",
    "Section",
    "Table",
]


class Block:
    """One element of a page; `kind` names the macro of the template that draws it."""

    kind: ClassVar[str]


@dataclass(frozen=True)
class Paragraph(Block):
    """A paragraph of plain text."""

    kind: ClassVar[str] = "paragraph"
    text: str


@dataclass(frozen=True)
class Notice(Block):
    """A sentence that must be seen: "good", "warning" or "bad"."""

    kind: ClassVar[str] = "notice"
    text: str
    tone: str


@dataclass(frozen=True)
class Equation(Block):
    """A formula as MathML that is safe to be put into a page, and as plain text.

    Without MathML the plain text is shown.
    """

    kind: ClassVar[str] = "equation"
    mathml: str | None
    plain: str


@dataclass(frozen=True)
class Facts(Block):
    """Names with their values."""

    kind: ClassVar[str] = "facts"
    items: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Table(Block):
    """Rows of text under headings; the columns in `words` hold words, not numbers."""

    kind: ClassVar[str] = "table"
    caption: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""
    words: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Figure(Block):
    """A picture as a data URL, `width` CSS pixels wide where there is room."""

    kind: ClassVar[str] = "figure"
    source: str
    width: int
    caption: str
    alt: str


@dataclass(frozen=True)
class Listing(Block):
    """Text as it is, folded under a summary."""

    kind: ClassVar[str] = "listing"
    summary: str
    text: str


@dataclass(frozen=True)
class Part:
    """Blocks under a heading."""

    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Section:
    """All about one result: what it is, where it comes from, and its parts."""

    title: str
    source: str
    parts: Sequence[Part] = field(default_factory=tuple)
