"""Rows of a comparison, and what is written of them: tables and plots."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Sequence
from itertools import cycle
from math import inf
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.peer_scenes.comparisons import COMPARISONS, Comparison
from fem_lie.pictures.diagrams import COLOURS

FIGURES: dict[str, tuple[str, ...]] = {
    "motion": ("pendulum1", "pendulum3", "pendulum2", "pendulum2_mesh"),
    "trees": ("chain", "chain30", "chain100", "chain300", "free_body"),
    "contacts": ("sliding_ball", "bouncing_ball", "block", "rod_in_box", "pile"),
    "statics": ("bend", "rollup", "hemisphere", "thin_hemisphere", "plate"),
}
CODES = dict(zip(("ours", "exudyn", "mujoco", "pinocchio", "kratos"), COLOURS, strict=False))
STYLES = ("o-", "s--", "^:", "D-.", "v-")
"""Of the methods of a code, whose colour they share."""


class Row(NamedTuple):
    """The best of several runs.

    Attributes:
        scene: Key of the comparison.
        code: Who computes.
        label: Of the method.
        resolution: Step, elements or cells.
        error: Of the probe.
        seconds: Of the solver.
        steps: In time, or of the load.
        iterations: Of all steps.
        matrices: Factorised.
        unknowns: With those of constraints.
        settings: With which it arrives.
    """

    scene: str
    code: str
    label: str
    resolution: float
    error: float
    seconds: float
    steps: int
    iterations: int
    matrices: int
    unknowns: int
    settings: str


class Run(NamedTuple):
    """All rows of one run.

    Attributes:
        date: On which it began, ISO 8601.
        blas: Of this library; the peers' packages bring their own linear algebra.
        rows: In the order in which they were measured.
    """

    date: str
    blas: str
    rows: list[Row]

    @property
    def heading(self) -> str:
        """For the table of the rows."""
        return f"{self.date}, BLAS of fem_lie: {self.blas}"

    @classmethod
    def read(cls, path: Path) -> Run:
        """What :meth:`write` wrote."""
        record = json.loads(path.read_text())
        return cls(**record | {"rows": [Row(**row) for row in record["rows"]]})

    def write(self, path: Path) -> None:
        """As JSON."""
        record = self._asdict() | {"rows": [row._asdict() for row in self.rows]}
        path.write_text(json.dumps(record, indent=1) + "\n")


def milliseconds(row: Row) -> float:
    """Of a step of motions, of everything in statics."""
    return 1e3 * row.seconds / (row.steps if COMPARISONS[row.scene].duration else 1)


def ratio(row: Row, rows: Iterable[Row]) -> float | None:
    """Its time over that of the first of our methods at the same resolution."""
    first = COMPARISONS[row.scene].methods[0].label
    for other in rows:
        if (other.scene, other.resolution, other.label) == (row.scene, row.resolution, first):
            return milliseconds(row) / milliseconds(other)
    return None


# --- tables ---------------------------------------------------------------------------------------

HEADER = (
    "| scene | step or mesh | method | unknowns | error | ms | over ours | iterations "
    "| matrices | settings |\n|---|---|---|---|---|---|---|---|---|---|"
)


def line(row: Row, rows: Iterable[Row]) -> str:
    """One line of the table; iterations of motions are those per step."""
    comparison = COMPARISONS[row.scene]
    each = row.iterations / row.steps if comparison.duration else row.iterations
    over = ratio(row, rows)
    cells = (
        comparison.title,
        f"{row.resolution:g}",
        row.label,
        str(row.unknowns),
        f"{row.error:.1e}",
        f"{milliseconds(row):.3g}",
        "" if over is None else f"{over:.2g}",
        f"{each:.3g}",
        str(row.matrices),
        row.settings,
    )
    return f"| {' | '.join(cells)} |"


def table(rows: Sequence[Row]) -> str:
    """Markdown of the rows at the base resolution of each scene."""
    base = [row for row in rows if row.resolution == COMPARISONS[row.scene].base]
    return "\n".join([HEADER, *(line(row, base) for row in base)])


def beaten(rows: Sequence[Row]) -> str:
    """How many of each peer's runs take longer than our best method for the same error."""
    lines = ["| scene | method | runs | ours is faster at their error | ours is slower at |"]
    lines.append("|---|---|---|---|---|")
    for key in dict.fromkeys(row.scene for row in rows):
        here = [row for row in rows if row.scene == key]
        ours = [[row for row in here if row.label == label] for label in _labels(here, "ours")]
        for label in [name for name in _labels(here) if name not in _labels(here, "ours")]:
            theirs = [row for row in here if row.label == label]
            least = [min(seconds_at(row.error, mine) for mine in ours) for row in theirs]
            lost = [row for row, s in zip(theirs, least, strict=True) if not s < row.seconds]
            at = ", ".join(f"{row.resolution:g}" for row in lost)
            cells = (COMPARISONS[key].title, label, len(theirs), len(theirs) - len(lost), at)
            lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def seconds_at(error: float, rows: Sequence[Row]) -> float:
    """What an error costs by one method, between its runs along the straight line of the plot.

    Only runs count that are more exact than all faster ones. An error larger than all costs as much
    as the fastest run, one smaller than all cannot be had; of that 5 % are round-off.
    """
    good: list[Row] = []
    for row in sorted(rows, key=lambda row: row.seconds):
        if not good or row.error < good[-1].error:
            good.append(row)
    if error * 1.05 < good[-1].error:
        return inf
    known = np.log([(row.error, row.seconds) for row in reversed(good)])
    return float(np.exp(np.interp(np.log(error), known[:, 0], known[:, 1])))


def _labels(rows: Sequence[Row], code: str | None = None) -> list[str]:
    return list(dict.fromkeys(row.label for row in rows if code in (None, row.code)))


def write_csv(rows: Iterable[Row], path: Path) -> None:
    """All rows."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(Row._fields)
        writer.writerows(rows)


# --- plots ----------------------------------------------------------------------------------------


def draw(rows: Sequence[Row], folder: Path) -> list[Path]:
    """Error over time, a plot for each scene; the files that were written."""
    written = []
    for name, keys in FIGURES.items():
        own = [row for row in rows if row.scene in keys]
        shown = [COMPARISONS[key] for key in keys if any(row.scene == key for row in own)]
        if not shown:
            continue
        columns = min(len(shown), 3 if len(shown) > 4 else 2)
        lines = -(-len(shown) // columns)
        figure = Figure((4.6 * columns, 3.8 * lines + 0.8), dpi=100, layout="constrained")
        grid = figure.subplots(lines, columns, squeeze=False).ravel()
        drawn: dict[str, Artist] = {}
        for axes, comparison in zip(grid, shown, strict=False):
            drawn |= panel(axes, comparison, own)
        for axes in grid[len(shown) :]:
            axes.remove()
        labels = [label for label in styles(own) if label in drawn]
        handles = [drawn[label] for label in labels]
        figure.legend(handles, labels, loc="outside lower center", ncols=columns, frameon=False)
        path = folder / f"peers_{name}.png"
        figure.savefig(path)
        written.append(path)
    return written


def styles(rows: Sequence[Row]) -> dict[str, tuple[str, str]]:
    """Colour and line of each method of a picture, code by code."""
    found = {}
    for code, colour in CODES.items():
        for label, style in zip(_labels(rows, code), cycle(STYLES), strict=False):
            found[label] = colour, style
    return found


def panel(axes: Axes, comparison: Comparison, rows: Sequence[Row]) -> dict[str, Artist]:
    """The lines of one scene, of the ``rows`` of its picture; each by its label."""
    drawn: dict[str, Artist] = {}
    for label, (colour, style) in styles(rows).items():
        own = [row for row in rows if (row.scene, row.label) == (comparison.key, label)]
        if own:
            errors, seconds = [row.error for row in own], [row.seconds for row in own]
            (drawn[label],) = axes.loglog(seconds, errors, style, color=colour, markersize=4)
    unit = "m" if comparison.duration else "relative"
    axes.set(title=comparison.title, xlabel="processor time, s", ylabel=f"error, {unit}")
    axes.grid(color="#DDDDDD", linewidth=0.6)
    return drawn
