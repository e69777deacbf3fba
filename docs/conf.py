"""Sphinx configuration: MyST pages, numpydoc docstrings, nothing from the network."""

import tomllib
from pathlib import Path

project = "fpsolve"
author = "The fpsolve developers"
project_copyright = author
_pyproject = Path(__file__).parents[1] / "pyproject.toml"
release = tomllib.loads(_pyproject.read_text("utf-8"))["project"]["version"]
version = release

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
]
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = f"fpsolve {release}"
html_static_path = ["_static"]

# $…$ and $$…$$ for formulas, and anchors for headings down to the third level.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3

# Types are in the signatures; "Attributes" of a class becomes a list, because its
# members are documented a second time otherwise.
napoleon_google_docstring = False
napoleon_numpy_docstring = True
napoleon_use_ivar = True
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_type_aliases = {"Array": "Array", "ArrayLike": "ArrayLike"}
python_use_unqualified_type_names = True


def escape_bars(app, what, name, obj, options, lines):
    """Keep the bars of |∇B| from being read as substitutions."""
    lines[:] = [
        "``".join(
            part if position % 2 else part.replace("|", r"\|")
            for position, part in enumerate(line.split("``"))
        )
        for line in lines
    ]


def setup(app):
    # After napoleon, whose priority is 500.
    app.connect("autodoc-process-docstring", escape_bars, priority=800)
