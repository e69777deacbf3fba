"""`fpsolve report` writes a page beside a file, and says what is wrong in one line."""

import pytest
from command_line import assert_mistake, files
from html_pages import Page
from result_files import result_file


@pytest.fixture
def result(tmp_path):
    """A result whose report is quickly written: it has one figure."""
    (tmp_path / "results").mkdir()
    path = tmp_path / "results" / "small-noise.nc"
    path.write_bytes(result_file("small-noise-quadratic.nc").read_bytes())
    return path


def test_the_page_goes_beside_the_first_file_and_its_path_is_printed(
    fpsolve, result, tmp_path
):
    called = fpsolve("report", "results/small-noise.nc")
    assert called.exit_code == 0, called.output
    assert called.stdout.strip() == "results/small-noise.html"
    assert files(tmp_path / "results") == ["small-noise.html", "small-noise.nc"]
    page = Page((tmp_path / "results" / "small-noise.html").read_text(encoding="utf-8"))
    assert page.text("h1") == "Limit of little noise: small-noise.nc"


def test_a_place_and_a_title_can_be_chosen(fpsolve, result, tmp_path):
    called = fpsolve(
        "report", result, result, "--out", "page.html", "--title", "A < B & C"
    )
    assert called.exit_code == 0, called.output
    page = Page((tmp_path / "page.html").read_text(encoding="utf-8"))
    assert page.text("h1") == "A < B & C"
    assert len(page.all("section")) == 2


def test_a_file_that_is_no_result_is_one_line_and_nothing_is_written(
    fpsolve, result, tmp_path
):
    (tmp_path / "notes.nc").write_text("none of ours")
    called = fpsolve("report", result, "notes.nc")
    assert_mistake(called, "cannot read `notes.nc`: it is not a netCDF-4 file")
    result.write_bytes(result.read_bytes()[:5000])
    assert_mistake(fpsolve("report", result), "cannot read `")
    assert_mistake(fpsolve("report", "missing.nc"), "`path` must exist to be read")
    assert files(tmp_path) == ["notes.nc", "results"]
    assert files(tmp_path / "results") == ["small-noise.nc"]


def test_a_place_that_cannot_be_written_to_is_one_line(fpsolve, result):
    assert_mistake(
        fpsolve("report", result, "--out", "none/page.html"),
        "`path` must lie in an existing folder, got `none/page.html`",
    )
    assert_mistake(
        fpsolve("report", result, "--out", "results"),
        "`path` must not be a folder, got `results`",
    )
    assert_mistake(
        fpsolve("report", result, "--out", result),
        "`path` must not be a result that is reported on",
    )
    assert fpsolve("report").exit_code == 2
