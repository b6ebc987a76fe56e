"""Pages of the eight short scenes: a picture, the moving page and the code of each.

A script of ``docs/scenes`` writes ``NAME.png`` and ``NAME.html`` into the current folder. Both are
made with the site, unless they are newer than the script.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

ORDER = "rollup pendulum crank shell cable column block net"


def scripts(docs: Path) -> list[Path]:
    """Scripts in the order of the first page."""
    return [docs / "scenes" / f"{name}.py" for name in ORDER.split()]


def caption(script: Path) -> str:
    """First line of a script: its caption."""
    return ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""


def run(script: Path, folder: Path) -> None:
    """Run a script, unless its picture and page are newer than it."""
    made = [folder / f"{script.stem}{suffix}" for suffix in (".png", ".html")]
    if not all(f.exists() and f.stat().st_mtime > script.stat().st_mtime for f in made):
        subprocess.run([sys.executable, str(script)], cwd=folder, check=True, capture_output=True)


def page(script: Path) -> str:
    """Page of one scene: the motion, then the code."""
    name, words = script.stem, caption(script)
    frame = f'<iframe src="../pages/{name}.html" title="{words}" class="moving"></iframe>'
    return "\n\n".join(
        [
            f"# {words.partition(':')[0].rstrip('.')}",
            words,
            f"```{{raw}} html\n{frame}\n```",
            f'```{{literalinclude}} {name}.py\n:language: python\n:start-after: \'"""\'\n```',
            f"Saved as a file, `tools/run python3 FILE` leaves `{name}.png` and `{name}.html`. "
            f'<a href="../pages/{name}.html">The moving page by itself</a>.',
        ]
    )


def write(docs: Path) -> None:
    """Write the pages of all scenes, and the grids of pictures that link to them."""
    folder = docs / "_pages" / "pages"
    folder.mkdir(parents=True, exist_ok=True)
    cards = []
    for script in scripts(docs):
        run(script, folder)
        name = script.stem
        (script.with_suffix(".md")).write_text(page(script) + "\n", encoding="utf-8")
        script.with_suffix(".png").write_bytes((folder / f"{name}.png").read_bytes())
        lines = [":::{grid-item-card}", f":img-top: {name}.png", f":img-alt: {caption(script)}"]
        lines += [f":link: {name}"]
        cards.append("\n".join([*lines, ":link-type: doc", caption(script), ":::"]))
    names = "\n".join(script.stem for script in scripts(docs))
    grid = "\n".join(["::::{grid} 2 2 4 4", ":gutter: 2", *cards, "::::"])
    below = f"```{{toctree}}\n:hidden:\n\n{names}\n```"
    head = "# Eight scenes"
    words = "Each picture links to the code that made it, and to the motion."
    text = "\n\n".join([head, words, grid, below]) + "\n"
    (docs / "scenes" / "index.md").write_text(text, encoding="utf-8")
    # on the first page the same, from there
    grid = grid.replace(":img-top: ", ":img-top: scenes/").replace(":link: ", ":link: scenes/")
    (docs / "scenes" / "grid.md").write_text(grid + "\n", encoding="utf-8")
