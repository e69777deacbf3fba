"""A shell proposes commands, options and the words an option takes."""

import os
import subprocess
import sys
from typing import get_args

import pytest

from fpsolve.cli import options
from fpsolve.cli.config import EXAMPLES
from fpsolve.cli.config.web import WebSection
from fpsolve.studies.rates.cases import PARTS


def answer(**asked):
    """What the program answers a shell that asks by variables of the environment."""
    return subprocess.run(
        [sys.executable, "-m", "fpsolve"],
        env={**os.environ, **asked},
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def proposals(line):
    """What bash would be told after `line`."""
    last = str(line.count(" "))
    return answer(
        _FPSOLVE_COMPLETE="complete_bash", COMP_WORDS=line, COMP_CWORD=last
    ).split()


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("fpsolve sp", ["spectrum"]),
        ("fpsolve run --no", ["--no-figures"]),
        ("fpsolve run --example s", ["spunbond"]),
        ("fpsolve energy --potential ", ["quadratic", "linear", "power"]),
        ("fpsolve rate --part b", ["branches"]),
        ("fpsolve web --positions r", ["regular", "random"]),
        ("fpsolve web --export t", ["tiff"]),
    ],
)
def test_a_shell_is_told_what_fits(line, expected):
    assert proposals(line) == expected


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_there_is_a_completion_script_for_every_common_shell(shell):
    script = answer(_FPSOLVE_COMPLETE=f"source_{shell}")
    assert f"_FPSOLVE_COMPLETE=complete_{shell}" in script


def test_the_words_proposed_are_those_that_are_taken():
    assert options.EXAMPLES == EXAMPLES
    assert tuple(PARTS) == options.PARTS
    for key, words in (
        ("positions", options.POSITIONS),
        ("phases", options.PHASES),
        ("exports", options.EXPORTS),
    ):
        annotation = WebSection.model_fields[key].annotation
        (literal,) = [part for part in get_args(annotation) if get_args(part)][:1]
        assert get_args(literal) == words
