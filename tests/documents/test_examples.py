"""What README and documentation show runs, and prints what they say it prints."""

import contextlib
import doctest
import io
import re

import pytest
from pages import FENCE, ROOT, fences, name_of, pages_with

import fpsolve as fp
from fpsolve.pages.kinds import PAGES
from fpsolve.plotting.kinds import FIGURES
from fpsolve.results.kinds import KINDS

RUN_COMMAND = (
    "python3 -m venv .venv && .venv/bin/pip install -q . && "
    ".venv/bin/fpsolve run --out results"
)
TEST_COMMAND = (
    'python3 -m venv .venv && .venv/bin/pip install -q -e ".[test]" && '
    ".venv/bin/pytest -q"
)


# Pages that compute little; the others are left to the step that builds the pages.
QUICK = ("README.md", "docs/checkpoints.md", "docs/benchmarks.md")
# Pages that compute for four seconds and more, once a night.
LONG = (
    "docs/choosing.md", "docs/design.md", "docs/homogeneity.md", "docs/limits.md",
    "docs/misprints.md", "docs/pypde.md", "docs/rates.md", "docs/smooth.md",
    "docs/nozzles.md", "docs/string_to_web.md", "docs/webs.md",
)  # fmt: skip


def marks_of(name):
    """The markers of a page."""
    long = [pytest.mark.nightly] if name in LONG else []
    return [] if name in QUICK else [pytest.mark.documents, *long]


def marked(pages):
    """Pages as parameters, with the markers of those that take long."""
    return [
        pytest.param(page, id=name_of(page), marks=marks_of(name_of(page)))
        for page in pages
    ]


def start_of(page):
    """Names a page may use without defining them: results.md begins after a run."""
    namespace = {"__name__": "example"}
    if page.name == "results.md":
        model = fp.LayDownModel(fp.QuadraticPotential(), 1.0)
        grid = fp.PhaseSpaceGrid(5.0, (16, 16, 8))
        p0 = fp.initial.gaussian(grid, variance=0.5)
        scheme = fp.drift_kick(model, grid)
        namespace["solution"] = fp.solve(
            scheme, p0, (0.0, 5.0), 0.25, save_at=(0.0, 2.5, 5.0), extrapolate=True
        )
    return namespace


@pytest.mark.parametrize("page", marked(pages_with("python")))
def test_the_python_blocks_of_a_page_run_and_print_what_it_says(
    page, tmp_path, monkeypatch
):
    # Blocks of one page share a namespace. A `text` block right below a `python` block
    # is what the latter prints.
    monkeypatch.chdir(tmp_path)
    # A page adds a kind of result, which is not to stay.
    for rows in (KINDS, FIGURES, PAGES):
        monkeypatch.setitem(rows, "radius", None)
    namespace, printed = start_of(page), None
    for kind, text, line, at_once in fences(page):
        place = f"{name_of(page)}:{line}"
        if kind == "text" and at_once and printed:
            assert text.rstrip() == printed.rstrip(), place
            printed = None
            continue
        assert not printed, f"{place}: the output of the block above is not shown"
        if kind == "python":
            # Blank lines make tracebacks show the line of the page.
            code = compile("\n" * line + text, str(page), "exec")
            output = io.StringIO()
            with contextlib.redirect_stdout(output):
                exec(code, namespace)
            printed = output.getvalue()
    assert not printed, f"{name_of(page)}: the output of the last block is not shown"


@pytest.mark.parametrize("page", pages_with("pycon"), ids=name_of)
def test_the_interactive_sessions_of_a_page_show_what_python_answers(page):
    session = "\n".join(text for kind, text, *_ in fences(page) if kind == "pycon")
    parsed = doctest.DocTestParser().get_doctest(session, {}, name_of(page), None, 0)
    results = doctest.DocTestRunner(verbose=False).run(parsed)
    assert results.attempted > 0
    assert results.failed == 0


@pytest.mark.parametrize("command", [RUN_COMMAND, TEST_COMMAND], ids=["run", "test"])
def test_readme_shows_each_command_on_one_line(command):
    assert command in (ROOT / "README.md").read_text("utf-8").splitlines()


def test_continuous_integration_runs_the_test_command_of_the_readme():
    assert TEST_COMMAND in (ROOT / ".ci/run").read_text("utf-8").splitlines()


def test_the_example_of_the_readme_fits_on_a_screen():
    blocks = fences(ROOT / "README.md")
    (code,) = [text for kind, text, *_ in blocks if kind == "python"]
    assert len([line for line in code.splitlines() if line.strip()]) <= 15


def test_every_file_the_readme_links_to_exists():
    links = re.findall(r"\]\(([^):]+)\)", (ROOT / "README.md").read_text("utf-8"))
    assert len(links) > 10
    assert [link for link in links if not (ROOT / link).exists()] == []


@pytest.mark.parametrize(
    "section",
    ["potential", "curve", "operator", "scheme", "diagnostic", "study", "command"],
)
def test_every_extension_shown_is_shorter_than_thirty_lines(section):
    source = (ROOT / "docs/extending.md").read_text("utf-8")
    start = re.search(rf"^## .*{section}", source, re.MULTILINE).end()
    first = FENCE.search(source, start)
    assert first[1] == "python"
    assert first[2].count("\n") < 30
