"""Formulas of figures, each parsed once for all tests of a process."""

from matplotlib.mathtext import MathTextParser

__all__ = ["parse_each_once"]


def parse_each_once():
    """Let the renderers of matplotlib share what they have parsed.

    Each keeps the last fifty formulas to itself, and every drawing has new renderers:
    a figure of 33 different labels parses 290, for a third of the time that it takes.
    What is parsed depends on the arguments alone.
    """
    kept, parse = {}, MathTextParser._parse_cached.__wrapped__

    def parse_once(parser, *arguments):
        key = parser._output_type, *arguments
        if key not in kept:
            kept[key] = parse(parser, *arguments)
        return kept[key]

    MathTextParser._parse_cached = parse_once
