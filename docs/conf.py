"""Configuration of the documentation's site: ``make docs`` builds it into ``docs/_build/html``."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

project = "Scenic"
author = "The Scenic authors"
html_title = "Scenic"

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "docs._extensions.programs",
    "docs._extensions.declared",
    "docs._extensions.films",
    "docs._extensions.commands",
    "docs._extensions.for_models",
    "docs._extensions.gallery",
    "docs._extensions.links",
]
exclude_patterns = ["_build", "_extensions"]
nitpicky = True
nitpick_ignore_regex = [("py:.*", ".*")]  # signatures name classes of other libraries, and private ones
autodoc_typehints = "description"
autodoc_member_order = "bysource"
suppress_warnings = ["misc.highlighting_failure"]  # examples of wrong programs

myst_enable_extensions = ["attrs_inline", "colon_fence", "deflist"]
myst_heading_anchors = 4
# The first line of a block of Scenic says what is done with it; code hosts show it as any other block.
myst_fence_as_directive = ["scenic"]
nb_execution_mode = "cache"
nb_execution_raise_on_error = True
nb_execution_timeout = 120

smartquotes = False  # options begin with two hyphens

html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["scenic.css"]
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False
html_show_sourcelink = False
pygments_style = "default"
pygments_dark_style = "github-dark"
copybutton_prompt_text = "$ "
