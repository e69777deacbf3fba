"""The benchmark page: its figures, its numbers, and that no run is missing from it."""

import json
import platform
import re
import runpy
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "validation/performance"
FILES = sorted((FOLDER / "results").glob("benchmark-*.json"))
NOISES = ("0.1", "0.3", "1", "3", "10")
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
    assert set(sections) == {"ours", "sectors", *PEERS}
    # Sectors have no grid.
    for section in (sections[solver] for solver in ("ours", *PEERS)):
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
    for name in names - {"read", "rows", "sections"}:
        assert f"tables.{name}(" in page, name


@pytest.fixture(scope="module")
def wins():
    """Names of validation/performance/wins.py."""
    return runpy.run_path(str(FOLDER / "wins.py"))


def runs(solver, costs):
    """Runs of a solver, CPU seconds by error."""
    return [
        {"solver": solver, "shape": [8, 8, 8], "cpu": cpu, "l1_error": error}
        for error, cpu in costs.items()
    ]


def test_a_run_wins_at_every_error_above_its_own(wins):
    ours = runs("drift_kick (Fourier, 3 levels)", {1e-3: 1.0, 1e-9: 2.0})
    rows = ours + runs("Dedalus 3", {1e-4: 30.0, 1e-8: 60.0})
    ratios = [wins["ratio"](rows, level) for level in wins["AIMED_LEVELS"]]
    # Only ours is below 1e-8, and its run of 2 s is for every error below 1e-3.
    assert ratios == [30, 15, 30, 30, 30, 30, np.inf]
    assert wins["lost_lines"](rows, 1.0) == []
    assert wins["ratio_line"](rows, 1.0).startswith("reached")


def test_an_aim_is_missed_where_one_error_misses_it(wins):
    ours = runs("drift_kick", {1e-3: 1.0, 1e-9: 2.0})
    rows = ours + runs("Dedalus 3", {1e-4: 9.0, 1e-9: 30.0})
    # A tenth is aimed at where A <= 1, a third beyond.
    assert wins["ratio_line"](rows, 1.0).startswith("MISSED")
    assert wins["ratio_line"](rows, 3.0).startswith("reached")
    unreached = runs("drift_kick", {1e-8: 1.0})
    assert wins["ratio_line"](unreached, 3.0).startswith("MISSED")
    assert "nobody" in wins["ratio_line"](unreached, 3.0)


def test_a_cheaper_peer_is_named_with_its_gain(wins):
    rows = runs("drift_kick", {1e-5: 3.0}) + runs("Dedalus 3", {1e-4: 1.5, 1e-6: 2.5})
    lines = wins["lost_lines"](rows, 0.3)
    assert lines[3] == "A = 0.3, 1e-04: 2 times, Dedalus 3"
    assert lines[-1] == "A = 0.3, 1e-06: alone, Dedalus 3"
    assert wins["ratio"](rows, 1e-6) == 0.0
    # Sectors have no grid: they are neither ours nor a peer's.
    sectors = runs("spectral_solve (sectors)", {1e-9: 1e-3})
    assert wins["lost_lines"](rows + sectors, 0.3) == lines


@pytest.fixture(scope="module")
def rows():
    """Every run of the kept files, by noise."""
    tables = runpy.run_path(str(FOLDER / "tables.py"))["Tables"]()
    return {float(noise): tables.rows(float(noise)) for noise in NOISES}


def test_what_the_page_says_of_winners_holds_in_the_files(rows, wins):
    levels = wins["AIMED_LEVELS"]
    reached = {
        noise: [
            level
            for level in levels
            if wins["ratio"](rows[noise], level) >= wins["aim_at"](noise)
        ]
        for noise in rows
    }
    assert reached[0.1] == reached[0.3] == list(levels)
    assert reached[1.0] == [1e-9]
    assert reached[3.0] == pytest.approx([1e-3, 1e-5, 1e-8, 1e-9])
    assert reached[10.0] == pytest.approx([10.0**-k for k in (3, *range(5, 10))])
    lost = [line for noise in rows for line in wins["lost_lines"](rows[noise], noise)]
    assert [line.split(":")[0] for line in lost] == ["A = 10, 1e-02"]


def test_what_the_page_says_of_the_peers_holds_in_the_files(rows, wins):
    for noise, found in rows.items():
        peers = wins["peers"](found)
        for level in wins["LEVELS"]:
            best = wins["cheapest"](peers, level)
            assert best is None or best["solver"].startswith("Fourier")
            few = level > 2e-6 if noise == 10.0 else level > 2e-9
            assert best is None or few or best["shape"] == [128, 128, 128]
        low = [one for one in peers if one["solver"].startswith(("py-", "Fi", "fpl"))]
        assert min(one["l1_error"] for one in low) > 1e-3


def test_what_the_page_says_of_sectors_holds_in_the_files(rows, wins):
    first = {1.0: 1e-8, 3.0: 1e-7, 10.0: 1e-5}
    for noise, found in rows.items():
        grids = wins["grid_schemes"](found) + wins["peers"](found)
        for level in wins["LEVELS"]:
            spectral = wins["cheapest"](wins["sectors"](found), level)
            grid = wins["cheapest"](grids, level)
            cheaper = spectral is not None and spectral["cpu"] < grid["cpu"]
            assert cheaper == (level < 2 * first.get(noise, 0.0)), (noise, level)
