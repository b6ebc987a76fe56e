"""The reference of all public names, by what they are for."""

from __future__ import annotations

from inspect import isclass, isfunction
from pathlib import Path
from typing import Any

import fem_lie

CHAPTERS = {
    "Scenes": ("scene.scene", "scene.choices", "bodies.body", "bodies.points"),
    "Bodies": ("bodies",),
    "Sections and materials": ("sections", "elements.solids.materials"),
    "Elements": ("elements",),
    "Joints, springs and drives": ("joints",),
    "Contact": ("contact",),
    "Loads and supports": ("scene",),
    "Meshes": ("mesh",),
    "Forms": ("forms", "lie"),
    "Equilibrium and stability": ("solve.statics", "solve.stability", "linear"),
    "Integrators": ("solve",),
    "Error in space and refinement": ("adapt", "adapt.following"),
    "Reduction": ("reduce",),
    "Results": ("results", "pictures", "system"),
}
"""Chapters, and rooms whose names stand there; a name goes to the longest room that fits."""


def chapter(thing: Any) -> str:
    """Where a public name belongs; a constant belongs to its class."""
    module = thing.__module__ if isclass(thing) or isfunction(thing) else type(thing).__module__
    fitting = [
        (len(room), heading)
        for heading, rooms in CHAPTERS.items()
        for room in rooms
        if f"{module}.".startswith(f"fem_lie.{room}.")
    ]
    if not fitting:
        raise ValueError(f"{module} stands in no chapter of the reference: tools/site/reference.py")
    return max(fitting)[1]


def entry(name: str) -> str:
    """The directive of one name."""
    thing = getattr(fem_lie, name)
    if isfunction(thing):
        return f".. autofunction:: fem_lie.{name}"
    if not isclass(thing):
        return f".. autodata:: fem_lie.{name}\n   :no-value:"
    foreign = "int, str, tuple, Enum, Exception, Warning, ABC, Generic"
    return f".. autoclass:: fem_lie.{name}\n   :members:\n   :inherited-members: {foreign}"


def write(docs: Path) -> None:
    """A page for each chapter."""
    folder = docs / "reference"
    folder.mkdir(exist_ok=True)
    found: dict[str, list[str]] = {heading: [] for heading in CHAPTERS}
    for name in fem_lie.__all__:
        found[chapter(getattr(fem_lie, name))].append(name)
    parts = ["# Reference", "All public names; `import fem_lie as fl`."]
    files = []
    for heading, names in found.items():
        file = heading.lower().replace(",", "").replace(" ", "_")
        files.append(file)
        linked = ", ".join(f"{{py:obj}}`~fem_lie.{name}`" for name in names)
        parts += [f"**[{heading}]({file}.md)**: {linked}"]
        body = "\n\n".join(entry(name) for name in names)
        text = f"# {heading}\n\n```{{eval-rst}}\n{body}\n```\n"
        (folder / f"{file}.md").write_text(text, encoding="utf-8")
    parts += ["```{toctree}\n:hidden:\n\n" + "\n".join(files) + "\n```"]
    (folder / "index.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")
