"""MathJax as one file of the site, so that formulas are typeset without a network.

The file comes with the package ``django-static-mathjax`` (MathJax 3.2.2, Apache licence), which
``tools/docs`` installs; nothing of Django is needed. It draws formulas as SVG and needs no fonts.
"""

from __future__ import annotations

from importlib.metadata import distribution
from pathlib import Path
from typing import Any

FILE = "mathjax/tex-svg-full.js"
"""Path of the script in the static files of the site."""

SOURCE = "mathjax/static/mathjax/es5/tex-svg-full.js"
"""Path of the script in the installed package."""

CONFIGURATION: dict[str, Any] = {
    "options": {"enableMenu": False},
    "svg": {"mtextInheritFont": True},
    "tex": {
        "macros": {
            "SE": r"\mathrm{SE}(3)",
            "SO": r"\mathrm{SO}(3)",
            "Ad": r"\mathrm{Ad}",
            "ad": r"\mathrm{ad}",
            "axial": r"\operatorname{axial}",
            "tr": r"\operatorname{tr}",
        }
    },
}
"""Options of MathJax, and the macros of the theory pages."""


def write(docs: Path) -> None:
    """Copy the script to ``docs/_mathjax``.

    Args:
        docs: The folder of the documentation's sources.
    """
    source = Path(str(distribution("django-static-mathjax").locate_file(SOURCE)))
    target = docs / "_mathjax" / FILE
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(source.read_bytes())
