"""Sphinx configuration: MyST pages, numpydoc docstrings, nothing from the network."""

import sys
import tomllib
from pathlib import Path

project = "fpsolve"
author = "The fpsolve developers"
project_copyright = author
_pyproject = Path(__file__).parents[1] / "pyproject.toml"
release = tomllib.loads(_pyproject.read_text("utf-8"))["project"]["version"]
version = release

# Modules of this folder that the configuration names.
sys.path.insert(0, str(Path(__file__).parent))
import house_map  # noqa: E402

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
    # Puts MathJax beside the pages, which otherwise load it from the network.
    "sphinx-mathjax-offline",
]
# Scripts of the gallery become pages in `figures`, which is not kept.
exclude_patterns = ["_build", "gallery", "sg_execution_times.rst"]
html_theme = "furo"
html_title = f"fpsolve {release}"
html_static_path = ["_static"]

# $…$ and $$…$$ for formulas, and anchors for headings down to the third level.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3

# Every script is run when the pages are built; one that fails fails the build.
sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "figures",
    "filename_pattern": r"\.py$",
    "ignore_pattern": r"__init__\.py",
    "abort_on_example_error": True,
    "image_scrapers": ("figure_scraper",),
    "reset_modules": (),
    "capture_repr": (),
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,
    "min_reported_time": 1e9,
    "thumbnail_size": (400, 280),
    "nested_sections": False,
}

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
    # Before the pages are read, which show it.
    app.connect("builder-inited", house_map.draw)
    # After napoleon, whose priority is 500.
    app.connect("autodoc-process-docstring", escape_bars, priority=800)
