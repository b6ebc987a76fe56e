"""The page: what is drawn, the script that draws it, and the numbers of the states."""

from __future__ import annotations

import html
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from fem_lie._arrays import Array
from fem_lie.pictures.page.content import Content
from fem_lie.pictures.page.curves import Diagram
from fem_lie.pictures.page.packed import json_text
from fem_lie.pictures.stage import target_of

_HEIGHT = 640  # of a page within a notebook, pixels


@dataclass(frozen=True, eq=False)
class Slider:
    """How one goes through the states.

    Attributes:
        values: Time or load factor of each of the k states, shape (k,).
        label: What these are.
        unit: Behind them; may be empty.
        seconds: How long all states play.
        plays: Whether they play when the page opens.
    """

    values: Array
    label: str
    unit: str
    seconds: float
    plays: bool

    def content(self) -> Content:
        """As the page's script takes it."""
        return {
            "states": [float(f"{value:.7g}") for value in self.values],
            "state_label": self.label,
            "state_unit": self.unit and " " + self.unit,
            "seconds": self.seconds,
            "plays": self.plays,
        }


@dataclass(frozen=True)
class Page:
    """A page, which notebooks show as it is.

    Attributes:
        text: The whole page.
    """

    text: str

    def _repr_html_(self) -> str:
        """For notebooks: the page in a frame of its own."""
        return (
            f'<iframe srcdoc="{html.escape(self.text)}" width="100%" height="{_HEIGHT}" '
            'style="border: 1px solid #ccc"></iframe>'
        )


def page(
    path: str | os.PathLike[str] | None,
    content: Content,
    slider: Slider,
    diagrams: Sequence[Diagram],
    title: str,
) -> Page:
    """Compose a page, and write it if there is a path.

    Args:
        path: Name of the ``.html`` file.
        content: What is drawn.
        slider: How one goes through the states.
        diagrams: Beside them.
        title: Above all.

    Raises:
        ValueError: The name does not end in ``.html``, or it plays for no time.
    """
    if not slider.seconds > 0.0:
        raise ValueError(f"seconds must be positive, got {slider.seconds!r}")
    target = None if path is None else target_of(path, ".html")
    shown = {
        **content,
        **slider.content(),
        "diagrams": [diagram.content() for diagram in diagrams],
    }
    made = Page(
        _part("page.html").format(
            title=html.escape(title), content=json_text(shown), script=_part("viewer.js")
        )
    )
    if target is not None:
        Path(target).write_text(made.text, encoding="utf-8")
    return made


@cache
def _part(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")
