"""A report holds what a reader needs, escapes what it quotes, and loads nothing."""

import base64
import importlib
import re
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from html_pages import Page
from result_files import KINDS, MODEL, page_file, rates, result_file, solution
from solutions import relaxing_solution

import fpsolve as fp
from fpsolve.errors import FileFormatError
from fpsolve.pages.blocks import Figure
from fpsolve.pages.equations import mathml
from fpsolve.pages.page import report_text

# What pages show, as that of the documentation.
pytestmark = pytest.mark.documents


@pytest.fixture(scope="module")
def folder():
    """A folder with one file of every kind."""
    return {result_file(name).parent for name in KINDS}.pop()


@pytest.fixture(scope="module")
def pages():
    """The report about each file, as text and taken apart."""
    texts = {name: page_file(name).read_text(encoding="utf-8") for name in KINDS}
    return {name: (html, Page(html)) for name, html in texts.items()}


@pytest.fixture
def page_of(tmp_path, monkeypatch):
    """`page_of(result, **options)` writes a report and takes it apart.

    Figures are not drawn, which would take the most time: empty ones stand for them.
    """
    # By its module: `fpsolve.report` is the function.
    monkeypatch.setattr(
        importlib.import_module("fpsolve.pages.figures"),
        "embedded",
        lambda draw, caption, alt: Figure("data:,", 100, caption, alt),
    )

    def make(result, **options):
        path = fp.report(result, tmp_path / "page.html", **options)
        return Page(path.read_text(encoding="utf-8"))

    return make


# Every kind


@pytest.mark.parametrize("name", KINDS)
def test_a_page_names_its_result_and_has_headings_in_order(pages, name):
    _, page = pages[name]
    assert page.text("title") == f"{KINDS[name][1]}: {name}"
    assert page.text("h1") == page.text("title")
    levels = [int(tag[1]) for tag, _ in page.elements if re.fullmatch(r"h\d", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert set(levels[1:]) == {2}
    assert "Provenance" in page.text("h2")
    assert page.all("html")[0]["lang"] == "en"


@pytest.mark.parametrize("name", KINDS)
def test_a_page_loads_nothing_and_runs_nothing(pages, name):
    html, page = pages[name]
    for _, attributes in page.elements:
        for key in ("src", "href"):
            assert attributes.get(key, "data:").startswith(("data:", "#"))
        assert not any(key.startswith("on") for key in attributes)
    assert page.all("script") == []
    assert "url(" not in html
    assert "@import" not in html


@pytest.mark.parametrize("name", KINDS)
def test_every_figure_is_a_picture_with_alternative_text_and_caption(pages, name):
    _, page = pages[name]
    pictures = page.all("img")
    assert pictures
    assert len(pictures) == len(page.all("figure")) == len(page.all("figcaption"))
    for picture in pictures:
        assert picture["alt"]
        kind, data = re.fullmatch(
            r"data:image/(svg\+xml|png);base64,(.*)", picture["src"]
        ).groups()
        start = {"png": b"\x89PNG", "svg+xml": b"<?xml"}[kind]
        assert base64.b64decode(data).startswith(start)


@pytest.mark.parametrize("name", KINDS)
def test_the_equation_is_typeset_with_its_plain_text(pages, name):
    _, page = pages[name]
    formulas = page.all("math")
    assert len(formulas) >= 2
    assert any("B(ξ) = (ξ₁² + ξ₂²)/2" in formula["alttext"] for formula in formulas)
    # What the converter does not know would be left as a command.
    assert "\\" not in page.text("mi", "mo", "mtext")


# Figures of a solution, of paths and of a study, which have all that is drawn; texts of
# the others come from the same parts.
@pytest.mark.parametrize("name", ["laydown.nc", "fibres.nc", "rate-quadratic.nc"])
def test_the_same_file_gives_the_same_page(pages, folder, tmp_path, name):
    again = fp.report(folder / name, tmp_path / "again.html")
    assert again.read_text(encoding="utf-8") == pages[name][0]


@pytest.mark.parametrize("name", KINDS)
def test_rows_have_as_many_cells_as_there_are_headings(pages, name):
    _, page = pages[name]
    tags = [tag for tag, _ in page.elements if tag in ("table", "tr", "th", "td")]
    for table in " ".join(tags).split("table")[1:]:
        head, *rows = table.split("tr")[1:]
        assert rows
        assert {row.count("td") for row in rows} == {head.count("th")}


def test_several_results_share_a_page_with_a_table_of_contents(folder, page_of):
    page = page_of([folder / "laydown.nc", folder / "spectrum.nc"])
    assert page.text("title") == "Report on 2 results"
    targets = [link["href"] for link in page.all("a")]
    assert targets == ["#result-1", "#result-2"]
    assert [section["id"] for section in page.all("section")] == [
        "result-1", "result-2",
    ]  # fmt: skip
    assert "laydown.nc" in page.text("span")
    assert "Parameters" in page.text("h3")


# Runs


def test_a_run_shows_equation_numbers_errors_units_and_provenance(pages):
    html, page = pages["laydown.nc"]
    cells, facts = page.text("td"), page.text("dd")
    found = solution()
    assert "Finished." in page.text("p")
    for saved in found.saved_s:
        step = int(np.argmin(np.abs(found.s - saved)))
        assert f"{found.relative_entropy[step]:.6g}" in cells
        assert f"{found.errors['relative_entropy'][step]:.1e}" in cells
    # Ten millimetres for every unit of s.
    assert "s in mm" in page.text("th")
    assert "σ₁ = 10 mm, σ₂ = 10 mm" in facts
    assert "0.2 ms to lay down one unit of s" in facts
    assert str(found.entropy_rate()) in page.text("p")
    assert "Estimated L1 error of the saved densities: at most 1.0e-04" in html
    assert "ds = 0.125 and ds/2, extrapolated" in facts
    assert "(suggested: error law C ds²)" in facts
    assert "gaussian(mean = (1.5, 0), variance = 1)" in facts
    assert "Python 3.11.0, fpsolve 0.1.0, numpy 2.1.0" in facts
    assert "2026-01-01" in facts
    assert "1.5 s (1.25 s of CPU time)" in facts
    assert "speed_ratio = 0.0" in page.text("code")
    assert len(page.all("img")) == 5


def test_without_extrapolation_it_says_that_there_is_no_estimate(page_of):
    page = page_of(relaxing_solution(errors=False))
    assert "Not extrapolated: no estimate of the error in ds." in page.text("p")
    assert "± H" not in page.text("th")


@pytest.mark.parametrize("status", ["failed", "interrupted"])
def test_a_run_that_did_not_finish_says_why_and_shows_what_there_is(page_of, status):
    stopped = replace(
        relaxing_solution(saved=()), status=status, message="mass < 1 & falling."
    )
    page = page_of(stopped)
    tone = {"failed": "bad", "interrupted": "warning"}[status]
    assert {"class": f"notice {tone}"} in page.all("p")
    assert f"{status.capitalize()}: mass < 1 & falling. What" in page.text("p")
    # Without a saved density there are entropy and moments.
    assert len(page.all("img")) == 2
    assert f"{stopped.relative_entropy[-1]:.6g}" in page.text("td")


def test_a_run_that_recorded_nothing_has_a_page(page_of):
    empty = {name: values[:0] for name, values in relaxing_solution().series.items()}
    page = page_of(
        relaxing_solution(
            saved=(), series=empty, errors=None, status="failed", message="no step"
        )
    )
    assert "Nothing was recorded." in page.text("p")
    assert page.all("img") == []


def test_on_a_moving_belt_no_limit_of_the_entropy_is_named(page_of):
    page = page_of(
        relaxing_solution(fp.LayDownModel(fp.QuadraticPotential(), 1.0,
                                          fp.RotatingNozzle(0.1, 0.5, 2.0)))
    )  # fmt: skip
    assert "H tends to a positive constant" in page.text("p")
    assert "H_box" not in page.text("p")
    assert any(one["alttext"].startswith("γ(s) = ") for one in page.all("math"))


def test_a_model_of_a_users_own_functions_is_shown_as_it_describes_itself(
    tmp_path, page_of
):
    own = fp.CallablePotential(
        lambda x, y: (x**2 + y**2) / 2, lambda x, y: (x, y)
    )  # fmt: skip
    run = relaxing_solution(fp.LayDownModel(own, 1.0))
    path = run.save(tmp_path / "own.nc")
    with pytest.warns(UserWarning, match="the model could not be read back"):
        page = page_of(path)
    assert "a user's own functions" in page.text("p")
    assert run.model.equation in page.text("div")
    assert page.all("math") == []


def test_a_zarr_store_is_a_result_too(tmp_path, page_of):
    pytest.importorskip("zarr")
    page = page_of(relaxing_solution().save(tmp_path / "laydown.zarr"))
    assert page.text("h1") == "Density of a run: laydown.zarr"


# Other kinds


def test_paths_show_moments_with_standard_errors_and_the_seed(pages):
    _, page = pages["fibres.nc"]
    assert "In parentheses: one standard error" in page.text("p")
    assert re.search(r"\d\(\d+\)", page.text("td"))
    assert "60 7 " in page.text("dd")
    assert "there is no estimate of it here" in page.text("p")
    alternatives = [formula["alttext"] for formula in page.all("math")]
    assert alternatives[:2] == [
        "dξ = (τ(α) + 0.1 e₁) ds",
        "dα = -∇B(ξ)·τ⊥(α) ds + 1 dW",
    ]


def test_a_study_names_what_failed_and_what_was_not_computed(pages):
    html, page = pages["rate-quadratic.nc"]
    assert "4 of 6 cases finished, 1 failed, 1 not computed." in page.text("p")
    assert "2 gap failed MemoryError: <no room>" in page.text("td")
    assert "<no room>" not in html
    assert "2 relaxation pending" in page.text("td")
    assert "0.36000000(10)" in page.text("td")
    assert "5.200(20)" in page.text("td")
    assert "4 s" in page.text("dd")
    assert "Not recorded in the file: date." in page.text("p")
    assert "Environment in full" in page.text("summary")


def test_a_check_shows_its_verdict_and_every_moment(pages):
    _, page = pages["laydown-check.nc"]
    assert "Density and paths agree at s = 1: all" in page.text("p")
    assert {"class": "notice good"} in page.all("p")
    for moment in ("E ξ₁", "Var ξ₂", "E cos α"):
        assert moment in page.text("td")
    assert "A density and paths of the same law fail with probability" in page.text("p")


def test_a_spectrum_shows_the_gap_and_its_error(pages):
    _, page = pages["spectrum.nc"]
    assert re.search(r"The spectral gap is 0\.\d+ ± \de-\d+", page.text("p"))
    assert "M = ±1" in page.text("td")


def test_the_limits_show_orders_derived_and_fitted(pages):
    _, page = pages["large-noise-quadratic.nc"]
    assert "|gap·A²/Λ − 1|; v = 0" in page.text("td")
    # The invented distances fall like ε² exactly.
    assert "2 2" in page.text("td")
    _, page = pages["small-noise-quadratic.nc"]
    assert "chance" in page.text("th")
    assert "Finished: all 2 cases." in page.text("p")


def test_results_in_memory_are_reported_like_their_files(page_of):
    from result_files import cross_check, paths

    process = fp.EnergyProcess(fp.QuadraticPotential(), 0.5)
    for result, title in (
        (solution(), "Density of a run"),
        (paths(), "Sampled paths"),
        (cross_check(), "Density against paths"),
        (fp.spectrum(MODEL, 2, tolerance=1e-4), "Eigenvalues of the generator"),
        (process, "Energy process of little noise"),
        (rates(), "Rate of convergence against noise"),
    ):
        assert page_of(result).text("title") == title


# Escaping

HOSTILE = '<script>alert("x")</script>&amp;'


def test_a_title_and_messages_are_escaped(page_of, tmp_path):
    stopped = replace(relaxing_solution(), status="failed", message=HOSTILE)
    page = page_of(stopped, title=HOSTILE)
    assert page.all("script") == []
    assert page.text("title") == page.text("h1") == HOSTILE
    assert HOSTILE in page.text("p")


def test_a_file_name_is_escaped(tmp_path, page_of):
    page = page_of(relaxing_solution().save(tmp_path / "<b>&.nc"))
    assert page.all("b") == []
    assert page.text("h1") == "Density of a run: <b>&.nc"


@pytest.mark.parametrize(
    "latex", [r"\text{<script>alert(1)</script>}", r"x \text{&lt;img src=x&gt;} y"]
)
def test_formulas_of_a_user_are_escaped(latex):
    page = Page(mathml(latex, "plain").mathml)
    assert {tag for tag, _ in page.elements} <= {"math", "mrow", "mtext", "mi"}


def test_formulas_that_cannot_be_typeset_come_as_plain_text():
    for latex in (r"x \over", r"\href{https://example.org}{x}", r"\unheard of"):
        assert mathml(latex, "plain").mathml is None


# Mistakes


def test_an_old_page_stays_when_a_file_is_damaged(folder, tmp_path):
    data = (folder / "spectrum.nc").read_bytes()
    damaged, page = tmp_path / "damaged.nc", tmp_path / "page.html"
    damaged.write_bytes(data[: len(data) // 2])
    page.write_text("before")
    with pytest.raises(FileFormatError, match=r"cannot read `.*damaged\.nc`: "):
        fp.report([folder / "small-noise-quadratic.nc", damaged], page)
    assert page.read_text() == "before"
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "damaged.nc", "page.html",
    ]  # fmt: skip


def without_attribute(dataset):
    del dataset.attrs["potential"]
    return dataset


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (without_attribute, "`potential` is missing in it"),
        (lambda dataset: dataset.drop_vars("status"), "`status` is missing in it"),
        (lambda dataset: dataset.drop_vars("gap_error"), "'gap_error'"),
        (lambda dataset: dataset.assign_attrs(p0="{"), "Expecting property name"),
        (lambda dataset: dataset.assign_attrs(fpsolve_kind="x"), "it holds 'x'"),
    ],
)  # fmt: skip
def test_a_tampered_study_is_refused_by_name(tmp_path, change, reason):
    path = tmp_path / "rate.nc"
    change(rates().copy()).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(FileFormatError, match=r"cannot read `.*rate\.nc`: ") as error:
        fp.report(path, tmp_path / "page.html")
    assert reason in str(error.value)
    assert not (tmp_path / "page.html").exists()


def test_the_json_of_a_check_leads_to_its_numbers(folder, tmp_path, page_of):
    beside = result_file("laydown-check.nc").with_suffix(".json")
    beside.write_text("{}")
    assert page_of(beside).text("h1") == "Density against paths: laydown-check.nc"
    lonely = tmp_path / "lonely.json"
    lonely.write_text("{}")
    with pytest.raises(FileFormatError, match=r"the numbers are in `.*lonely\.nc`"):
        fp.report(lonely, tmp_path / "page.html")


def test_wrong_arguments_are_named(tmp_path):
    page = tmp_path / "page.html"
    with pytest.raises(ValueError, match="`results` must name at least one result"):
        fp.report([], page)
    with pytest.raises(TypeError, match=r"`result` must be a result .* got 3"):
        fp.report([3], page)
    with pytest.raises(FileNotFoundError, match="`path` must exist to be read"):
        fp.report(tmp_path / "missing.nc", page)
    path = relaxing_solution().save(tmp_path / "laydown.nc")
    with pytest.raises(
        ValueError, match="`path` must not be a result that is reported"
    ):
        fp.report(path, path)
    with pytest.raises(
        FileNotFoundError, match="`path` must lie in an existing folder"
    ):
        fp.report(path, tmp_path / "none" / "page.html")
    assert not page.exists()


def test_a_check_comes_back_from_its_dataset():
    from result_files import cross_check

    from fpsolve.results.kinds import from_xarray

    check = cross_check()
    back = from_xarray(check.to_xarray())
    assert str(back) == str(check)
    assert back.model == check.model
    assert back.grid == check.grid
    for one, other in zip(back.tests, check.tests, strict=True):
        np.testing.assert_equal(vars(one), vars(other))
    xr.testing.assert_identical(back.to_xarray(), check.to_xarray())


def test_the_page_of_smooth_paths_has_their_three_equations_and_the_curvature():
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 0.5, 1.0)
    paths = fp.sample_paths(model, 20, 0.2, 0.1, seed=1)
    page = report_text(paths)
    for text in (
        "dκ = -(κ + ∇B(ξ)·τ⊥(α))/0.5 ds + 2 dW",
        "E κ²",
        "R = 0.5, K = A/R = 2",
    ):
        assert text in page
    assert "white: contours" not in page


def test_the_page_of_a_smooth_density_speaks_of_no_equilibrium():
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), 0.3, 2.0)
    largest = 5.2 * np.sqrt(model.curvature_variance)
    grid = fp.SmoothPhaseSpaceGrid(6.0, largest, (16, 16, 8, 16))
    basic = fp.initial.gaussian(grid.phase_space, (0.0, 0.0), 1.0)
    p0 = fp.initial.with_curvature(basic, grid, model.curvature_variance)
    scheme = fp.smooth_drift_kick(model, grid)
    page = report_text(fp.solve(scheme, p0, (0.0, 0.25), 0.125))
    assert "There is no equilibrium that H could be relative to." in page
    assert "in white" not in page
    assert "white: contours" not in page
    given = fp.solve(scheme, p0, (0.0, 0.125), 0.125, reference=p0)
    assert "H is relative to the density that was given" in report_text(given)
