"""Rows of a comparison, and what is written of them: tables and plots."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.peer_scenes.comparisons import COMPARISONS, Comparison
from fem_lie.pictures.diagrams import COLOURS

FIGURES = {
    "motion": ("pendulum1", "pendulum2", "pendulum3", "chain", "free_body"),
    "statics": ("bend", "rollup", "hemisphere", "thin_hemisphere"),
}
MARKERS = {"ours": "o-", "exudyn": "s--", "kratos": "^:"}


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
    """Of each peer's runs, how many have one of ours that is faster and as exact, to 5 %."""
    lines = ["| scene | method | runs | with a faster one of ours that is as exact | without |"]
    lines.append("|---|---|---|---|---|")
    for key in dict.fromkeys(row.scene for row in rows):
        ours = [row for row in rows if row.scene == key and row.code == "ours"]
        peers = [row for row in rows if row.scene == key and row.code != "ours"]
        for label in dict.fromkeys(row.label for row in peers):
            theirs = [row for row in peers if row.label == label]
            lost = [row for row in theirs if not any(_better(mine, row) for mine in ours)]
            at = ", ".join(f"{row.resolution:g}" for row in lost)
            cells = (COMPARISONS[key].title, label, len(theirs), len(theirs) - len(lost), at)
            lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def _better(mine: Row, theirs: Row) -> bool:
    return mine.seconds < theirs.seconds and mine.error <= 1.05 * theirs.error


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
    present = {row.scene for row in rows}
    for name, keys in FIGURES.items():
        shown = [COMPARISONS[key] for key in keys if key in present]
        if not shown:
            continue
        columns = min(len(shown), 3 if len(shown) > 4 else 2)
        lines = -(-len(shown) // columns)
        figure = Figure((4.6 * columns, 3.8 * lines), dpi=100, layout="constrained")
        grid = figure.subplots(lines, columns, squeeze=False).ravel()
        for axes, comparison in zip(grid, shown, strict=False):
            panel(axes, comparison, [row for row in rows if row.scene == comparison.key])
        for axes in grid[len(shown) :]:
            axes.remove()
        path = folder / f"peers_{name}.png"
        figure.savefig(path)
        written.append(path)
    return written


def panel(axes: Axes, comparison: Comparison, rows: Sequence[Row]) -> None:
    """The lines of one scene."""
    labels = dict.fromkeys(row.label for row in rows)
    for colour, label in zip(COLOURS, labels, strict=False):
        own = [row for row in rows if row.label == label]
        errors, seconds = [row.error for row in own], [row.seconds for row in own]
        style = MARKERS[own[0].code]
        axes.loglog(seconds, errors, style, color=colour, label=label, markersize=4)
    unit = "m" if comparison.duration else "relative"
    axes.set(title=comparison.title, xlabel="seconds", ylabel=f"error, {unit}")
    axes.grid(color="#DDDDDD", linewidth=0.6)
    axes.legend(frameon=False, fontsize="x-small")
