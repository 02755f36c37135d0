"""How Sphinx makes the site of these pages (``make docs``); :mod:`hil_tests.documents.site` calls it.

Sphinx rather than mkdocs-material: docstrings are written for Sphinx, its search needs no server, and nothing of
its theme furo is loaded from elsewhere; mkdocs-material is at the end of its life in May 2027.
"""

from __future__ import annotations

from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

project = "railhil"
author = "The railhil authors"
extensions = ["myst_parser", "sphinx.ext.autodoc"]
html_theme = "furo"
html_title = "railhil"
html_static_path = ["_static"]
html_js_files = ["site.js"]
html_copy_source = False
html_show_copyright = False
# The excerpt of a found page is fetched from it, which browsers refuse for files.
html_show_search_summary = False
# Names as users import them.
add_module_names = False
autodoc_member_order = "bysource"
# As GitHub names them: every heading can be the target of a link.
myst_heading_anchors = 6


def setup(app: Sphinx) -> None:
    """Show a command line with all that may follow (```usage```) as it is."""
    app.add_lexer("usage", TextLexer)
