"""What a report consists of; the template says what each looks like."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

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
    """One element of a page."""

    @property
    def kind(self) -> str:
        """Name of the macro of the template that draws it."""
        return type(self).__name__.lower()


@dataclass(frozen=True)
class Paragraph(Block):
    """A paragraph of plain text."""

    text: str


@dataclass(frozen=True)
class Notice(Block):
    """A sentence that must be seen: "good", "warning" or "bad"."""

    text: str
    tone: str


@dataclass(frozen=True)
class Equation(Block):
    """A formula as MathML that is safe to be put into a page, and as plain text.

    Without MathML the plain text is shown.
    """

    mathml: str | None
    plain: str


@dataclass(frozen=True)
class Facts(Block):
    """Names with their values."""

    items: Sequence[tuple[str, str]]


@dataclass(frozen=True)
class Table(Block):
    """Rows of text under headings; the columns in `words` hold words, not numbers."""

    caption: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""
    words: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Figure(Block):
    """A picture as a data URL, `width` CSS pixels wide where there is room."""

    source: str
    width: int
    caption: str
    alt: str


@dataclass(frozen=True)
class Listing(Block):
    """Text as it is, folded under a summary."""

    summary: str
    text: str


@dataclass(frozen=True)
class Part:
    """Blocks under a heading."""

    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True)
class Section:
    """All about one result: what it is, its file, and its parts; empty ones go."""

    title: str
    source: str
    parts: Sequence[Part] = field(default_factory=tuple)
