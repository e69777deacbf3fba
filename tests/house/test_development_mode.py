"""The packaged example runs in development mode without a word of complaint."""

import subprocess
import sys
from pathlib import Path

import pytest
from command_line import COMPILING, HANGS


# Tests that start processes are in this mode on every push, all others every night.
@pytest.mark.nightly
def test_the_example_leaves_nothing_unclosed_and_nothing_deprecated(tmp_path):
    # Development mode tells of files and processes that were not closed; every warning,
    # of whatever library, is an error here.
    example = Path(__file__).parents[2] / "fpsolve/examples/laydown.toml"
    # On an eighth of its cells, which is as talkative.
    text = example.read_text("utf-8")
    assert "shape = [64, 64, 32]" in text
    config = tmp_path / "laydown.toml"
    config.write_text(text.replace("[64, 64, 32]", "[32, 32, 16]"), "utf-8")
    words = ["run", str(config), "--out", str(tmp_path / "out")]
    called = subprocess.run(
        [sys.executable, "-X", "dev", "-W", "error", "-m", "fpsolve", *words],
        capture_output=True, text=True, timeout=HANGS, check=False,
    )  # fmt: skip
    assert called.stderr.removeprefix(COMPILING) == ""
    assert called.returncode == 0
    assert (tmp_path / "out" / "laydown.nc").exists()
