"""Figures of the gallery: what an example ends a block with, as a notebook shows it.

The figures of this package are matplotlib figures without pyplot, which sphinx-gallery itself
looks for; so this takes the value of the last line of each block.
"""

from typing import Any

from matplotlib.figure import Figure

DPI = 110


def returned_figures(
    block: tuple[Any, ...], block_vars: dict[str, Any], gallery_conf: dict[str, Any]
) -> str:
    """Save the figure that a block returned, and the text that shows it."""
    from sphinx_gallery.scrapers import figure_rst  # only there where the site is built

    value = block_vars["example_globals"].get("___")
    if not isinstance(value, Figure):
        return ""
    block_vars["example_globals"]["___"] = None  # a later block may return nothing
    path = next(block_vars["image_path_iterator"])
    value.savefig(path, dpi=DPI, bbox_inches="tight")
    return str(figure_rst([path], gallery_conf["src_dir"]))
