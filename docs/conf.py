"""How Sphinx makes the site; ``make docs`` calls it."""

from __future__ import annotations

import sys
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util.inspect import TypeAliasForwardRef

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from tools.site import gallery, lessons, mathjax, parameters, reference, scenes  # noqa: E402

project = "fem_lie"
author = "the authors of fem_lie"
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_design",
    "sphinx_copybutton",
]
copybutton_selector = "div:not(.highlight-text) > div.highlight > pre"  # not of output
exclude_patterns = ["scenes/grid.md", "_pages"]

html_theme = "furo"
html_title = "fem_lie"
html_css_files = ["site.css"]
html_static_path = ["_static", "_mathjax"]
html_extra_path = ["_pages"]
html_show_sphinx = False
html_show_copyright = False

myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_dmath_double_inline = True
myst_heading_anchors = 4
myst_update_mathjax = False

mathjax_path = mathjax.FILE
mathjax3_config = mathjax.CONFIGURATION

suppress_warnings = ["myst.header"]  # pages of tables begin where their heading belongs

nb_execution_mode = "cache"
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_execution_cache_path = str(HERE.parent / "results" / "lessons")

autoclass_content = "class"  # tools/site/parameters.py adds the constructor
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_type_aliases = {
    name: name.rpartition(".")[2]
    for name in ("npt.ArrayLike", "Array", "Indices", "Field", "History", "Sections", "Up")
}
# nested in other types, Sphinx would print the name of its own class with it
TypeAliasForwardRef.__repr__ = lambda self: self.name  # type: ignore[method-assign]
python_use_unqualified_type_names = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False

# Pages that are made from what the project has; none of them is kept under version control.
mathjax.write(HERE)
gallery.write(HERE)
lessons.write(HERE)
reference.write(HERE)
scenes.write(HERE)


def setup(app: Sphinx) -> None:
    """Show constructor arguments as parameters, before napoleon reads the docstrings."""
    app.connect("autodoc-process-docstring", parameters.process, priority=100)
