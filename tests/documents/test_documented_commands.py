"""Command lines and configurations that README and documentation show are valid."""

import re
import shlex

import pytest
import typer
from pages import FENCE, ROOT, all_pages, fences, name_of
from typer.testing import CliRunner

from fpsolve.cli import app
from fpsolve.cli.config import (
    DesignConfig,
    PathsConfig,
    RunConfig,
    WebConfig,
    load_config,
)

COMMANDS = typer.main.get_command(app)
# Whichever click typer is made of, its own or the installed one.
USAGE_ERROR = typer.BadParameter.__mro__[1]
PAGES = all_pages()
# Seconds at most; the others are run by the tests of the command line.
QUICK = [
    "fpsolve info",
    *(
        pytest.param(line, marks=pytest.mark.documents)
        for line in (
            "fpsolve energy --noise 0.3 --passage 0.1 0.5",
            "fpsolve spectrum --potential linear --noise 0.8",
        )
    ),
]


def command_lines(page):
    """Every line that calls fpsolve, in blocks and in running text, with its line."""
    text = page.read_text("utf-8")
    found = []
    for kind, block, line, _ in fences(page):
        if kind in ("", "sh"):
            joined = block.replace("\\\n", " ")
            calls = re.split(r"\n|&&", joined)
            found += [(line, call.strip()) for call in calls]
    prose = FENCE.sub(lambda block: "\n" * block[0].count("\n"), text)
    for span in re.finditer(r"`([^`]+)`", prose):
        line = prose.count("\n", 0, span.start()) + 1
        found.append((line, " ".join(span[1].split())))
    # A variable of the environment or the folder of an environment may come first.
    pattern = re.compile(r"^(?:[A-Z_]+=\S+ )?(?:\S*/)?fpsolve (?=[a-z-])(.*)$")
    return [
        (line, match[1])
        for line, call in found
        if (match := pattern.match(call)) is not None
    ]


def complaint(words):
    """What is wrong with a command line, or None; nothing is run."""
    context = COMMANDS.make_context("fpsolve", [], resilient_parsing=True)
    try:
        if words[0].startswith("--"):
            COMMANDS.make_parser(context).parse_args(list(words))
            return None
        command = COMMANDS.get_command(context, words[0])
        if command is None:
            return f"no command {words[0]}"
        inner = type(context)(command, info_name=words[0], parent=context)
        command.make_parser(inner).parse_args(list(words[1:]))
    except USAGE_ERROR as error:
        return error.format_message()
    return None


@pytest.mark.parametrize(
    "page", [page for page in PAGES if command_lines(page)], ids=name_of
)
def test_commands_and_options_of_every_command_line_shown_exist(page):
    wrong = {
        f"{name_of(page)}:{line}: fpsolve {call}": found
        for line, call in command_lines(page)
        if (found := complaint(shlex.split(call))) is not None
    }
    assert wrong == {}


def test_a_command_line_that_does_not_exist_would_be_noticed():
    assert complaint(["rum"]) == "no command rum"
    assert "--nois" in complaint(["spectrum", "--nois", "0.8"])
    assert complaint(["spectrum", "--noise", "0.8"]) is None


def options_of(name):
    """Long names of the options of a command."""
    return {
        option
        for parameter in COMMANDS.commands[name].params
        if parameter.param_type_name == "option"
        for option in parameter.opts
        if option.startswith("--")
    }


@pytest.mark.parametrize("name", sorted(COMMANDS.commands))
def test_every_option_of_a_command_is_documented(name):
    page = (ROOT / "docs/command_line.md").read_text("utf-8")
    assert f"## fpsolve {name}" in page
    shown = set(re.findall(r"--[a-z][a-z0-9-]*", page))
    assert sorted(options_of(name) - shown) == []


def test_options_are_found():
    assert {"--out", "--threads"} <= options_of("run")


@pytest.mark.parametrize("line", QUICK)
def test_quick_commands_that_are_shown_succeed(line, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shown = (ROOT / "docs/command_line.md").read_text("utf-8")
    assert f"\n{line}\n" in shown
    result = CliRunner().invoke(app, shlex.split(line)[1:])
    assert result.exit_code == 0, result.output


def tables_of(text):
    """The tables of a TOML text by name, each as text."""
    parts = re.split(r"^(?=\[)", text, flags=re.MULTILINE)
    return {part[1 : part.index("]")]: part for part in parts if part.startswith("[")}


def configurations():
    """Every TOML block, completed by the tables of the first that it leaves out."""
    blocks = [
        (f"{name_of(page)}:{line}", tables_of(text))
        for page in PAGES
        for kind, text, line, _ in fences(page)
        if kind == "toml"
    ]
    _, first = blocks[0]
    for place, tables in blocks:
        special = {"paths": PathsConfig, "web": WebConfig, "design": DesignConfig}
        kind = next((special[name] for name in tables if name in special), RunConfig)
        physics = {"potential", "model", "curve"} if "process" in tables else set()
        rest = {
            name: table
            for name, table in first.items()
            if name in kind.model_fields and name not in physics
        }
        yield pytest.param("".join({**rest, **tables}.values()), kind, id=place)


@pytest.mark.parametrize(("text", "kind"), list(configurations()))
def test_configurations_shown_are_read_and_describe_something(text, kind, tmp_path):
    path = tmp_path / "shown.toml"
    path.write_text(text, "utf-8")
    assert load_config(path, kind).build() is not None
