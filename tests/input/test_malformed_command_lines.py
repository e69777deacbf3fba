"""Every wrong command line costs one line, an exit code, and no file."""

from collections import Counter

import pytest
from malformed import configurations, stores, webs
from malformed import files as results
from malformed.cases import parametrised
from malformed.command_lines import MISTAKES, USAGE
from refusals import assert_one_line, everything
from solutions import relaxing_solution


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stored")
    relaxing_solution().save(folder / "result.nc")
    results.write_paths(folder / "paths.nc")
    return folder


@pytest.fixture
def call(fpsolve, stored, tmp_path):
    """Call the command line in a folder with a few files; returns what is left too."""
    for path in stored.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "run.toml").write_bytes(configurations.RUN)
    (tmp_path / "notes.txt").write_text("potential: quadratic, noise: one\n")
    (tmp_path / "folder").mkdir()
    before = everything(tmp_path)

    def call(case):
        result = fpsolve(*case.split())
        assert everything(tmp_path) == before
        return result

    return call


@pytest.mark.parametrize(("words", "named"), USAGE)
def test_what_the_parser_refuses_is_named(words, named, call):
    result = call(words)
    assert result.exit_code == 2
    assert "Error" in result.stderr
    assert named in result.stderr
    assert "Traceback" not in result.output


@parametrised(MISTAKES)
def test_what_fpsolve_refuses_costs_one_line(case, call):
    assert_one_line(call(case.what), case, 2)


def test_every_command_has_rows():
    from fpsolve.cli import app

    commands = {command.callback.__name__ for command in app.registered_commands}
    rows = [words for words, _ in USAGE] + [case.what for case in MISTAKES]
    found = Counter(words.split()[0] for words in rows)
    assert {name for name in commands if found[name] < 3} == set()


def test_the_corpus_is_large_and_no_row_is_there_twice():
    from malformed.arguments import ARGUMENTS
    from malformed.arrays import ARRAYS

    tables = {
        "arguments": ARGUMENTS,
        "arrays": ARRAYS,
        "configurations": [*configurations.CONFIGURATIONS, *webs.WEB_FILES],
        "files": [*results.FILES, *stores.STORES, *stores.PATHS],
        "command lines": MISTAKES,
    }
    for name, cases in tables.items():
        assert len({case.what for case in cases}) == len(cases), name
    assert sum(map(len, tables.values())) >= 480
