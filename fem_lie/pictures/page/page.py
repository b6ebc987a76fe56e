"""The page: content, the script that draws it, diagrams, and the slider."""

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
    """A line in a diagram: label, x and y, colour."""

    label: str
    x: Array
    y: Array
    colour: str


@dataclass(frozen=True, eq=False)
class Diagram:
    """Curves, and the point of each state in them.

    Attributes:
        title: Title.
        x_label: Label of the horizontal axis, with its unit.
        y_label: Label of the vertical axis.
        curves: The curves.
        at_x: Horizontal coordinate of each of the k states, shape (k,).
        at_y: Vertical coordinate, if a state is a point of a curve; else it is a vertical line.
    """

    title: str
    x_label: str
    y_label: str
    curves: Sequence[Curve]
    at_x: Array
    at_y: Array | None = None

    def content(self) -> dict[str, object]:
        """The diagram as the page's script expects it."""
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
    """Numbers with seven digits, for a small page."""
    return [float(f"{value:.7g}") for value in values]


def energies(
    times: Array, parts: dict[str, Array], rows: Indices, units: Units
) -> tuple[Diagram, Diagram]:
    """Energies over time, and the change of their sum.

    Args:
        times: Times of all states, shape (T,).
        parts: Energies by name, each of shape (T,).
        rows: Indices of the states of the page.
        units: Units of the axes.
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
    """Load factor over the norm of a displacement, both at all states, shape (k,)."""
    curve = Curve("path", displaced, factors, COLOURS[0])
    at = displaced[rows], factors[rows]
    label = f"displacement of {name} [{unit}]"
    return Diagram("Equilibrium path", label, "load factor", [curve], *at)


def _drawn(count: int) -> slice:
    """At most some thousand of the states."""
    return slice(None, None, max(1, count // _MOST))


_TOTAL = "#333333"
_MOST = 2000

_HEIGHT = 640  # height of a page in a notebook, pixels


@dataclass(frozen=True, eq=False)
class Slider:
    """Slider that selects the state.

    Attributes:
        values: Time or load factor of each of the k states, shape (k,).
        label: Name of these values.
        unit: Unit; may be empty.
        seconds: Duration of the animation.
        plays: Whether the animation starts when the page opens.
    """

    values: Array
    label: str
    unit: str
    seconds: float
    plays: bool

    def content(self) -> Content:
        """The slider as the page's script expects it."""
        return {
            "states": [float(f"{value:.7g}") for value in self.values],
            "state_label": self.label,
            "state_unit": self.unit and " " + self.unit,
            "seconds": self.seconds,
            "plays": self.plays,
        }


@dataclass(frozen=True)
class Page:
    """An HTML page, which notebooks display.

    Attributes:
        text: Source of the page.
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
        content: Bodies, paths and axes.
        slider: Slider that selects the state.
        diagrams: Diagrams next to the picture.
        title: Title of the page.

    Raises:
        ValueError: The name does not end in ``.html``, or the duration is not positive.
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
