"""Every script of the gallery runs alone and leaves the figures its page shows."""

import runpy
from pathlib import Path

import pytest
import xarray as xr
from matplotlib.figure import Figure

FOLDER = Path(__file__).parents[1] / "docs/gallery"
SCRIPTS = sorted(FOLDER.glob("*.py"))


def test_the_gallery_has_the_figures_of_the_paper_that_the_lay_down_model_makes():
    names = {script.stem for script in SCRIPTS}
    assert {"figure_3", "figure_4", "figure_5", "figure_6"} <= names


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_script_of_the_gallery_runs_and_leaves_a_figure(
    script, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    names = runpy.run_path(str(script), run_name="__main__")
    figures = [value for value in names.values() if isinstance(value, Figure)]
    assert figures
    for figure in figures:
        figure.savefig(tmp_path / "figure.png")
        assert any(axes.has_data() for axes in figure.axes)
    # A study goes on when one of its cases fails; a page may not show that.
    for study in names.values():
        if isinstance(study, xr.Dataset) and "status" in study:
            assert set(study["status"].values.ravel()) == {"finished"}
    printed = capsys.readouterr().out
    assert "nan" not in printed.lower()


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_page_says_what_is_seen_what_the_paper_has_and_what_it_costs(script):
    text = script.read_text("utf-8")
    for part in ("**What is seen.**", "**Compared with the paper.**", "**Cost.**"):
        assert part in text
