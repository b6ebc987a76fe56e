"""Lessons of the site: notebooks made by jupytext from the scripts in ``notebooks``."""

from __future__ import annotations

from pathlib import Path

import jupytext

ROOT = Path(__file__).parents[2]


def write(docs: Path) -> None:
    """Write a notebook for each script; Sphinx runs it."""
    folder = docs / "lessons"
    folder.mkdir(exist_ok=True)
    scripts = sorted((ROOT / "notebooks").glob("[0-9]*.py"))
    for script in scripts:
        notebook = jupytext.read(script)
        notebook.metadata["kernelspec"] = {
            "name": "python3",
            "display_name": "Python 3",
            "language": "python",
        }
        jupytext.write(notebook, folder / f"{script.stem}.ipynb")
    head = (
        "# Lessons\n\nSix notebooks, each with exercises and their solutions. They are plain "
        "scripts in `notebooks/`; `make notebooks` opens them in JupyterLab.\n"
    )
    listed = "\n".join(script.stem for script in scripts)
    text = f"{head}\n```{{toctree}}\n:maxdepth: 1\n\n{listed}\n```\n"
    (folder / "index.md").write_text(text, encoding="utf-8")
