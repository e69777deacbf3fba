"""Pages of the gallery are complete; `.ci/docs --gallery` runs their scripts."""

import importlib
from pathlib import Path

import pytest
import xarray as xr
from matplotlib.figure import Figure

FOLDER = Path(__file__).parents[2] / "docs/gallery"
SCRIPTS = sorted(FOLDER.glob("*.py"))


@pytest.fixture
def checks(monkeypatch):
    """What the build of the pages asks of every script."""
    monkeypatch.syspath_prepend(str(FOLDER.parent))
    return importlib.import_module("gallery_checks")


def test_the_gallery_has_the_figures_of_the_paper_that_the_lay_down_model_makes():
    names = {script.stem for script in SCRIPTS}
    assert {f"figure_{number}" for number in (3, 4, 5, 6, 7, 8, 10, 11)} <= names


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_a_page_says_what_is_seen_what_the_paper_has_and_what_it_costs(script):
    text = script.read_text("utf-8")
    for part in ("**What is seen.**", "**Compared with the paper.**", "**Cost.**"):
        assert part in text


def test_a_build_refuses_an_empty_figure(checks):
    figure = Figure()
    axes = figure.subplots()
    with pytest.raises(ValueError, match="a figure of the gallery is empty"):
        checks.check_drawn(figure)
    axes.plot([1, 2])
    checks.check_drawn(figure)


def test_a_build_refuses_a_study_that_went_on_without_a_case(checks):
    def study(*statuses):
        return {"study": xr.Dataset({"status": ("noise", list(statuses))}), "n": 1}

    checks.check_finished(study("finished", "finished"))
    with pytest.raises(ValueError, match="`study` holds cases that are"):
        checks.check_finished(study("finished", "failed"))
