"""Settings of the site for Sphinx; `tools/build_site.py` writes the sources that it reads."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from pygments.lexer import inherit
from pygments.lexers.python import PythonLexer
from pygments.token import Keyword
from sphinx.application import Sphinx

import elitescript

project = "elitescript"
author = "elitescript contributors"
copyright = "elitescript contributors, MIT licence"
release = version = elitescript.__version__

extensions = ["myst_parser", "sphinx_copybutton"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["files"]
nitpicky = True
highlight_language = "text"
# Programs may contain mistakes, a JSON block may hold one object per line, and cases of the language skip a heading.
suppress_warnings = ["misc.highlighting_failure", "myst.header"]

myst_heading_anchors = 4
copybutton_exclude = ".linenos, .gp, .go"

html_theme = "pydata_sphinx_theme"
html_title = f"elitescript {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_extra_path = ["../../build/site/extra"]
html_copy_source = False
html_show_sourcelink = False
html_sidebars = {"index": []}
html_theme_options = {
    "show_toc_level": 2,
    "navigation_depth": 3,
    "show_nav_level": 1,
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "show_prev_next": True,
}


class EliteScriptLexer(PythonLexer):
    """EliteScript: Python with `end` and `sec`."""

    name = "EliteScript"
    aliases = ["elitescript", "elite"]  # noqa: RUF012
    tokens = {  # noqa: RUF012
        "keywords": [(r"\b(end|sec)\b", Keyword), inherit],
    }


def keep_names(app: Sphinx, tree: nodes.document) -> None:
    """Give each heading the name of its link as an id too: `get_tcp_offset` beside docutils' `get-tcp-offset`."""
    for section in tree.findall(nodes.section):
        slug = section.get("slug")
        if slug and slug not in section["ids"]:
            section["ids"].insert(0, slug)


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_lexer("elitescript", EliteScriptLexer)
    app.add_lexer("elite", EliteScriptLexer)
    app.connect("doctree-read", keep_names)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
