"""What a shell proposes for the value of an option."""

from __future__ import annotations

from collections.abc import Callable

__all__ = ["CONFINING", "EXAMPLES", "PARTS", "proposing"]

# Written out, because a shell waits for the answer: the modules that know these words
# take half a second to import. tests/cli/test_cli_completion.py holds them together.
EXAMPLES = ("laydown", "spunbond")
CONFINING = ("quadratic", "linear", "power")
PARTS = ("relaxation", "evolution", "branches", "gap", "variance")


def proposing(*words: str) -> Callable[[str], list[str]]:
    """Return what completes the beginning of one of the words."""

    def completions(incomplete: str) -> list[str]:
        return [word for word in words if word.startswith(incomplete)]

    return completions
