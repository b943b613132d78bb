"""How Sphinx builds the site: `make site`, or `sphinx-build docs build/site`."""

import os
import sys
from importlib.resources import files
from pathlib import Path

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS.parent))  # for docs.builder

import thermobearing  # noqa: E402
from docs.builder import api, figures  # noqa: E402
from thermobearing.border.errors import InputError  # noqa: E402
from thermobearing.border.threads import one_blas_thread  # noqa: E402

one_blas_thread()
api.write_pages(DOCS / "api")

project = "thermobearing"
author = copyright = "the thermobearing developers"
version = release = thermobearing.__version__

extensions = [
    "myst_parser",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "numpydoc",
    "docs.builder.docstrings",
]
exclude_patterns = ["texts", "examples", "builder"]
suppress_warnings = ["config.cache"]  # the figures of the gallery are found by a function of ours
default_role = "literal"  # one backtick in a docstring
templates_path = ["_templates"]

# Markdown: the pages are read on their own too, so links are those between files.
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4

# Equations without a network: one file with MathJax and its fonts, from a wheel.
MATHJAX = "tex-svg.js"
mathjax_path = MATHJAX
mathjax3_config = {
    "options": {"enableMenu": False},  # the menu would load more files
    "svg": {"displayAlign": "left", "displayIndent": "1.5em", "scale": 0.95},
}

# Docstrings, one page a public name.
autosummary_generate = True
autosummary_ignore_module_all = False
autodoc_typehints = "none"  # what an argument is stands in its description
numpydoc_show_class_members = False  # the template of a class lists them
numpydoc_use_plots = False

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    # A function for a model that is open in OpenSees: it has no output of its own.
    "ignore_pattern": r"frame_table\.py$",
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": (figures.returned_figures,),
    "capture_repr": ("_repr_html_",),
    "ignore_repr_types": r"Figure|Picture",
    "abort_on_example_error": True,
    "show_memory": False,
    "show_signature": False,
    "download_all_examples": False,
    "remove_config_comments": True,
    "plot_gallery": True,
    "thumbnail_size": (800, 520),
    "min_reported_time": 1e9,
    "write_computation_times": False,
}

html_theme = "pydata_sphinx_theme"
html_title = f"thermobearing {version}"
html_static_path = [
    "_static",
    str(files("sphinx-mathjax-offline") / "static" / "mathjax" / MATHJAX),
]
# The first page shows a live bearing, if the kernels for web pages are built (make kernels).
LIVE = DOCS.parent / "build" / "live"
try:
    LIVE.mkdir(parents=True, exist_ok=True)
    thermobearing.live_page(LIVE / "bearing.html", overwrite=True, documents="../index.html")
    html_static_path.append(str(LIVE))
    tags.add("live")  # type: ignore[name-defined]  # noqa: F821
except InputError as missing:
    print(f"The first page shows no live bearing: {missing}")
html_css_files = ["site.css"]
html_js_files = [("site.js", {"defer": "defer"})]
# A repository with a web page makes "Edit this page" a link, such as
# THERMOBEARING_REPOSITORY=https://example.org/thermobearing/edit/main
html_context = {
    "default_mode": "auto",
    "repository": os.environ.get("THERMOBEARING_REPOSITORY", "").rstrip("/"),
}
html_last_updated_fmt = "%d %B %Y"
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "show_prev_next": True,
    "header_links_before_dropdown": 7,
    "navbar_align": "left",
    "navbar_persistent": ["search-button"],
    "navbar_end": ["theme-switcher"],
    "footer_start": ["edition"],
    "footer_center": [],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
html_sidebars = {"index": [], "guide/tutorial": [], "changelog": []}
