"""Assert that a wheel holds the whole package, and an sdist its tests and pages too.

python .ci/package_contents.py dist/*
"""

from __future__ import annotations

import sys
import tarfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDERS = ("fpsolve", "tests", "docs", "validation")
FILES = ("pyproject.toml", "README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE")
# What is made where a package is used, and must not be shipped.
MADE = (
    "__pycache__", "_build", "figures", "sg_execution_times.rst", "results", ".cache",
)  # fmt: skip


def main() -> None:
    """Check every archive named; say what is missing or too much."""
    for name in sys.argv[1:]:
        path = Path(name)
        expected = set(in_wheel() if path.suffix == ".whl" else in_sdist())
        held = set(names(path))
        missing = sorted(expected - held)
        assert not missing, f"{path.name} lacks {', '.join(missing)}"
        # Numbers that are kept lie under results, too.
        unwanted = set(MADE) - {"results"}
        made = sorted(one for one in held if set(Path(one).parts) & unwanted)
        assert not made, f"{path.name} holds {', '.join(made)}"
        print(f"{path.name}: {len(expected)} files of the checkout, all there")


def in_wheel() -> Iterator[str]:
    """Files of the package."""
    return files_in("fpsolve")


def in_sdist() -> Iterator[str]:
    """Files of the package, its tests, documentation and validation."""
    yield from FILES
    for folder in FOLDERS:
        yield from files_in(folder)


def files_in(folder: str) -> Iterator[str]:
    """Files of the checkout under a folder, without what running it leaves there."""
    for path in (ROOT / folder).rglob("*"):
        parts = path.relative_to(ROOT).parts
        # The map of the package is drawn when the pages are built.
        made = set(parts) & set(MADE) or parts[:2] == ("docs", "house")
        if path.is_file() and not made:
            yield "/".join(parts)


def names(path: Path) -> list[str]:
    """Names in an archive; those of an sdist without its first folder."""
    if path.suffix == ".whl":
        with zipfile.ZipFile(path) as wheel:
            return wheel.namelist()
    with tarfile.open(path) as sdist:
        return [one.split("/", 1)[-1] for one in sdist.getnames()]


if __name__ == "__main__":
    main()
