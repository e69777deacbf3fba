"""The benchmark page: its figures, its numbers, and that no run is missing from it."""

import json
import platform
import re
import runpy
import sys
from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "validation/performance"
FILES = sorted((FOLDER / "results").glob("benchmark-*.json"))
NOISES = ("0.3", "1", "3")
PEERS = ("pypde", "fipy", "dedalus", "fplanck", "fourier")


@pytest.fixture(scope="module")
def figures():
    """Names of validation/performance/figures.py, which is no package."""
    sys.path.insert(0, str(FOLDER))
    try:
        yield runpy.run_path(str(FOLDER / "figures.py"))
    finally:
        sys.path.remove(str(FOLDER))
        sys.modules.pop("tables", None)


@pytest.mark.parametrize("name", ["benchmark_errors.png", "benchmark_scaling.png"])
def test_the_figures_of_the_page_were_drawn_from_the_numbers_that_are_kept(
    name, figures
):
    expected = figures["digest"](
        figures["FIGURES"][name], FOLDER / "results", "benchmark"
    )
    with Image.open(ROOT / "docs/_static" / name) as image:
        assert image.text["Numbers"] == expected


@pytest.mark.parametrize("noise", NOISES)
def test_every_solver_has_a_number_or_a_reason_on_every_cube(noise):
    path = FOLDER / f"results/benchmark-noise-{noise}.json"
    sections = json.loads(path.read_text("utf-8"))["sections"]
    assert set(sections) == {"ours", *PEERS}
    for section in sections.values():
        shapes = [entry["shape"] for entry in section["rows"] + section["left_out"]]
        assert all([n, n, n] in shapes for n in (32, 64, 128))
        assert all(entry["reason"] for entry in section["left_out"])


def test_the_kept_numbers_name_no_machine_and_no_folder():
    assert len(FILES) >= len(NOISES) + 5
    for path in FILES:
        text = path.read_text("utf-8")
        assert re.search(r'"/|/(home|root|tmp|usr)/', text) is None, path.name
        assert f'"{platform.node()}"' not in text, path.name
        assert {"processor", "versions"} <= set(re.findall(r'"(\w+)":', text)), (
            path.name
        )


def test_the_page_shows_every_table():
    page = (ROOT / "docs/benchmarks.md").read_text("utf-8")
    tables = runpy.run_path(str(FOLDER / "tables.py"))["Tables"]
    names = {name for name in vars(tables) if not name.startswith("_")}
    for name in names - {"read", "rows"}:
        assert f"tables.{name}(" in page, name
