"""Pages of the documentation as tests read them."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
FENCE = re.compile(r"^```(\S*)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def fences(page):
    """Fenced blocks of a page: (kind, text, line, whether it follows at once)."""
    source, end = page.read_text("utf-8"), 0
    found = []
    for match in FENCE.finditer(source):
        at_once = not source[end : match.start()].strip()
        line = source.count("\n", 0, match.start()) + 1
        found.append((match[1], match[2], line, at_once))
        end = match.end()
    return found


def all_pages():
    """README and the pages under docs that are written by hand."""
    found = sorted((ROOT / "docs").rglob("*.md"))
    return [ROOT / "README.md", *(page for page in found if "_build" not in page.parts)]


def pages_with(kind):
    """Those of them that have a block of that kind."""
    return [page for page in all_pages() if any(f[0] == kind for f in fences(page))]


def name_of(page):
    return str(page.relative_to(ROOT))
