"""The lessons as notebooks, made of the plain scripts in ``notebooks`` by jupytext."""

from __future__ import annotations

from pathlib import Path

import jupytext

ROOT = Path(__file__).parents[2]


def write(docs: Path) -> None:
    """A notebook for each script; Sphinx runs it."""
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
        "scripts in `notebooks/`; `jupytext --to notebook` makes notebooks of them.\n"
    )
    listed = "\n".join(script.stem for script in scripts)
    text = f"{head}\n```{{toctree}}\n:maxdepth: 1\n\n{listed}\n```\n"
    (folder / "index.md").write_text(text, encoding="utf-8")
