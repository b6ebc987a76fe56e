"""The page: what is drawn, the script that draws it, diagrams, and the numbers of the states."""

from __future__ import annotations

import html
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from fem_lie._arrays import Array, Indices
from fem_lie.pictures.diagrams import COLOURS
from fem_lie.pictures.page.content import Content, json_text
from fem_lie.pictures.stage import Units, target_of


@dataclass(frozen=True, eq=False)
class Curve:
    """A line in a diagram: what it is, x and y, its colour."""

    label: str
    x: Array
    y: Array
    colour: str


@dataclass(frozen=True, eq=False)
class Diagram:
    """Curves, and where in them a state is.

    Attributes:
        title: Above it.
        x_label: What goes to the right, and its unit.
        y_label: What goes up.
        curves: The lines.
        at_x: Where each of the k states is, shape (k,).
        at_y: Likewise, if a state is a point of a curve; else it is a line through the diagram.
    """

    title: str
    x_label: str
    y_label: str
    curves: Sequence[Curve]
    at_x: Array
    at_y: Array | None = None

    def content(self) -> dict[str, object]:
        """As the page's script takes it."""
        return {
            "title": self.title,
            "x_label": self.x_label,
            "y_label": self.y_label,
            "curves": [
                {
                    "label": curve.label,
                    "x": _short(curve.x),
                    "y": _short(curve.y),
                    "colour": curve.colour,
                }
                for curve in self.curves
            ],
            "at_x": _short(self.at_x),
            "at_y": None if self.at_y is None else _short(self.at_y),
        }


def _short(values: Array) -> list[float]:
    """Numbers of seven digits: more is not seen, and makes the page larger."""
    return [float(f"{value:.7g}") for value in values]


def energies(
    times: Array, parts: dict[str, Array], rows: Indices, units: Units
) -> tuple[Diagram, Diagram]:
    """Energies over time, and the change of their sum.

    Args:
        times: Of all states, shape (T,).
        parts: Kinds of energy, each of shape (T,).
        rows: Which states the page has.
        units: For the axes.
    """
    at, label = times[rows], f"time [{units.time}]"
    drawn = _drawn(len(times))
    total = sum(parts.values(), start=0.0 * times)
    shown = {name: values for name, values in parts.items() if values.any()}
    curves = [
        Curve(name, times[drawn], values[drawn], colour)
        for colour, (name, values) in zip(COLOURS, shown.items(), strict=False)
    ]
    sums = Curve("total", times[drawn], total[drawn], _TOTAL)
    change = Curve("total − start", times[drawn], (total - total[0])[drawn], _TOTAL)
    unit = f"[{units.energy}]"
    return (
        Diagram("Energy", label, f"energy {unit}", [*curves, sums], at),
        Diagram("Change of the total energy", label, f"total − start {unit}", [change], at),
    )


def along_a_load(displaced: Array, factors: Array, name: str, rows: Indices, unit: str) -> Diagram:
    """Load factor over the amount of a displacement, both of all states, shape (k,)."""
    curve = Curve("path", displaced, factors, COLOURS[0])
    at = displaced[rows], factors[rows]
    label = f"displacement of {name} [{unit}]"
    return Diagram("Equilibrium path", label, "load factor", [curve], *at)


def _drawn(count: int) -> slice:
    """At most some thousand of the states."""
    return slice(None, None, max(1, count // _MOST))


_TOTAL = "#333333"
_MOST = 2000

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
