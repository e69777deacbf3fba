"""Print the lowest versions that pyproject.toml allows, as pip's constraints."""

from __future__ import annotations

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
# What a test run needs; tools for figures of the documentation and the like are not
# part of what a user installs.
EXTRAS = ("dask", "test")


def main() -> None:
    """Write name==version for every requirement that has a lower bound."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = project["dependencies"] + [one for name in EXTRAS for one in extras[name]]
    for requirement in wanted:
        if ">=" in requirement:
            print(requirement.replace(">=", "=="))


if __name__ == "__main__":
    main()
