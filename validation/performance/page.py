"""Writes what the blocks of a page print under them, after a new run of the benchmark.

    python validation/performance/page.py            # docs/benchmarks.md

A `text` block right below a `python` block is replaced by what the latter prints now.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import re
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parents[2] / "docs/benchmarks.md"
PAIR = re.compile(
    r"^```python\n(?P<code>.*?)^```\n(?P<shown>```text\n.*?^```\n)?",
    re.MULTILINE | re.DOTALL,
)


def refreshed(source: str) -> str:
    """The page with what its blocks print now."""
    names: dict[str, Any] = {"__name__": "example"}

    def run(pair: re.Match[str]) -> str:
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            exec(pair["code"], names)
        printed = output.getvalue().rstrip()
        shown = f"```text\n{printed}\n```\n" if printed else ""
        return f"```python\n{pair['code']}```\n{shown}"

    return PAIR.sub(run, source)


def main() -> None:
    """Refresh a page in place."""
    from fpsolve._support.files import atomic_path

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("page", type=Path, nargs="?", default=PAGE)
    page = parser.parse_args().page
    with atomic_path(page) as draft:
        draft.write_text(refreshed(page.read_text("utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
