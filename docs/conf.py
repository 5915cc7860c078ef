"""Configuration of the documentation's site: ``make docs`` builds it into ``docs/_build/html``."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent
sys.path[:0] = [str(ROOT), str(HERE)]

project = "Scenic"
author = "The Scenic authors"
copyright = "the Scenic authors"
html_title = "Scenic"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_copybutton"]
exclude_patterns = ["_build", "_extensions", "README.md"]
source_suffix = {".md": "markdown"}
nitpicky = True

myst_enable_extensions = ["attrs_inline", "colon_fence", "deflist"]
myst_heading_anchors = 4
# The text of pages is shown by GitHub, too: links are written for files, and mean pages here.
myst_links_external_new_tab = False
suppress_warnings = ["misc.highlighting_failure"]

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["scenic.css"]
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False
pygments_style = "default"
pygments_dark_style = "github-dark"
copybutton_prompt_text = "$ "


def setup(app):
    from scenic.ide.pygments_lexer import ScenicLexer

    app.add_lexer("scenic", ScenicLexer)
