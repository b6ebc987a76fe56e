"""The reference of all public names: a page for each namespace, and one for each class.

A namespace is :mod:`fem_lie` itself or a public module in it that has ``__all__``; its page has a
table of its names, and its functions and constants. ``tests/test_reference.py`` checks that all
public names are in the pages, and that all parameters are documented.
"""

from __future__ import annotations

import inspect
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from inspect import isclass, ismodule
from pathlib import Path
from types import GenericAlias, ModuleType, UnionType
from typing import Any

import fem_lie

FOREIGN = "int, float, str, tuple, Enum, Exception, Warning, UserWarning, ABC, Generic, Protocol"
"""Base classes whose members are left out."""

ALIASES = GenericAlias, UnionType, type(Callable[[], None])
"""Types of type aliases: they are documented as data, not as what they stand for."""


@dataclass(frozen=True)
class Namespace:
    """A public module and its public names.

    Attributes:
        module: The module.
        short: Its name as users write it, ``fl`` or ``fl.joints``.
    """

    module: ModuleType
    short: str

    @property
    def page(self) -> str:
        """Name of its page, without suffix."""
        return self.short.replace(".", "_")

    @property
    def names(self) -> list[str]:
        """Its public names, other namespaces left out."""
        found = [name for name in self.module.__all__ if not isinstance(self.get(name), ModuleType)]
        return sorted(found, key=str.lower)

    @property
    def modules(self) -> list[str]:
        """Modules among its public names that have no ``__all__``: they stand on its page."""
        found = [name for name in self.module.__all__ if ismodule(self.get(name))]
        return sorted(name for name in found if not hasattr(self.get(name), "__all__"))

    def get(self, name: str) -> Any:
        """Object of a name."""
        return getattr(self.module, name)

    def qualified(self, name: str) -> str:
        """Full name of a name, ``fem_lie.joints.Revolute``."""
        return f"{self.module.__name__}.{name}"


def namespaces() -> list[Namespace]:
    """``fl`` and the public modules in it, in alphabetical order."""
    inner = [name for name in fem_lie.__all__ if ismodule(getattr(fem_lie, name))]
    found = [Namespace(getattr(fem_lie, name), f"fl.{name}") for name in sorted(inner)]
    return [Namespace(fem_lie, "fl"), *found]


def summary(thing: Any) -> str:
    """First sentence of a docstring, for a cell of a table; constants show those of their class."""
    if isinstance(thing, ALIASES):
        return f"Type: ``{thing}``."
    paragraph = (inspect.getdoc(thing) or "").partition("\n\n")[0]
    return " ".join(paragraph.split()).replace("|", "\\|")


def directive(space: Namespace, name: str) -> str:
    """The autodoc directive of one name."""
    thing = space.get(name)
    full = space.qualified(name)
    if ismodule(thing):
        return f".. automodule:: {full}\n   :members:\n   :no-index:"
    if isclass(thing):
        options = f"   :members:\n   :inherited-members: {FOREIGN}"
        return f".. autoclass:: {full}\n{options}"
    if isinstance(thing, ALIASES):
        return f".. py:data:: {full}\n\n   {summary(thing)}"
    if callable(thing):
        return f".. autofunction:: {full}"
    return f".. autodata:: {full}\n   :no-value:"


def rows(space: Namespace, names: Sequence[str]) -> str:
    """Table of names with links and summaries, in reStructuredText."""
    lines = [".. list-table::", "   :widths: 30 70", ""]
    for name in names:
        lines += [
            f"   * - :py:obj:`~{space.qualified(name)}`",
            f"     - {summary(space.get(name))}",
        ]
    return "\n".join(lines)


def evaluated(text: str) -> str:
    """A block of reStructuredText within Markdown."""
    return f"```{{eval-rst}}\n{text}\n```"


def class_page(space: Namespace, name: str) -> str:
    """Page of one class."""
    return f"# {space.short}.{name}\n\n{evaluated(directive(space, name))}\n"


def namespace_page(space: Namespace) -> str:
    """Page of a namespace: the table of its names, its functions and constants."""
    classes = [name for name in space.names if isclass(space.get(name))]
    others = [name for name in space.names if name not in classes]
    intro = inspect.getdoc(space.module) or ""
    parts = [f"# {space.short}", evaluated(intro), evaluated(rows(space, space.names))]
    if others:
        parts += ["## Functions and constants"]
        parts += [evaluated("\n\n".join(directive(space, name) for name in others))]
    for name in space.modules:
        parts += [f"## Module {name}", evaluated(directive(space, name))]
    pages = "\n".join(f"{name} <{space.page}/{name}>" for name in classes)
    parts += [f"```{{toctree}}\n:hidden:\n\n{pages}\n```"]
    return "\n\n".join(parts) + "\n"


def index_page(spaces: Sequence[Namespace]) -> str:
    """Page that leads to all namespaces."""
    lines = [
        f"| [`{space.short}`]({space.page}.md) | {summary(space.module)} |" for space in spaces
    ]
    table = "\n".join(["| | |", "|---|---|", *lines])
    pages = "\n".join(space.page for space in spaces)
    head = "# Reference\n\nAll public names, with `import fem_lie as fl`. Each class has a page."
    return f"{head}\n\n{table}\n\n```{{toctree}}\n:hidden:\n\n{pages}\n```\n"


def write(docs: Path) -> None:
    """Write all pages into ``docs/reference``, without those of earlier names.

    Args:
        docs: The folder of the documentation's sources.
    """
    folder = docs / "reference"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    spaces = namespaces()
    for space in spaces:
        (folder / f"{space.page}.md").write_text(namespace_page(space), encoding="utf-8")
        (folder / space.page).mkdir()
        for name in space.names:
            if isclass(space.get(name)):
                file = folder / space.page / f"{name}.md"
                file.write_text(class_page(space, name), encoding="utf-8")
    (folder / "index.md").write_text(index_page(spaces), encoding="utf-8")
