"""Shows every matplotlib Figure that a block of a gallery script leaves in a variable.

fpsolve's figures are not known to pyplot, where sphinx-gallery's own scraper looks. A
script that leaves nothing to see fails the build.
"""

from gallery_checks import check_drawn, check_finished
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

_DOTS_PER_INCH = 150


def _get_sg_image_scraper():
    """Tell sphinx-gallery the scraper of this module, by the name it asks for."""
    return scrape_figures


def scrape_figures(block, block_vars, gallery_conf):
    """Save the figures that are new since the last block; return their reST."""
    names = block_vars["example_globals"]
    shown = names.setdefault("__shown__", set())
    found = {id(value): value for value in names.values() if isinstance(value, Figure)}
    paths = []
    for identity, figure in found.items():
        if identity not in shown:
            shown.add(identity)
            check_drawn(figure)
            paths.append(next(block_vars["image_path_iterator"]))
            figure.savefig(paths[-1], dpi=_DOTS_PER_INCH)
    check_finished(names)
    return figure_rst(paths, gallery_conf["src_dir"])
