"""Reports for people: one self-contained HTML page for any number of results.

`report` takes files or results and writes the page. There is one module for every
kind of result; what they show are the blocks of `fpsolve.report.blocks`.
"""

from fpsolve.pages.page import report

__all__ = ["report"]
