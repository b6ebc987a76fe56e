"""Pictures of hoop_antenna.py: its layout, and how it folds."""

from __future__ import annotations

import numpy as np
from antenna_scene import Antenna, angle
from command_line import in_results
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

import fem_lie as fl

OBLIQUE = np.array([[1.0, 0.0], [0.35, 0.3], [0.0, 1.0]])
PLAN = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
UPRIGHT, LONGERON, TELESCOPE, CORD = "#444444", "#D55E00", "#56B4E9", "#999999"


def lines(antenna: Antenna, result: fl.Result, row: int) -> list[tuple[np.ndarray, str, float]]:
    """Places of the nodes along all bars and cables, colours and widths."""
    positions, info = result.frames[row, :, 0], result.info
    bays, found = len(antenna.uprights), []
    if antenna.net is not None:
        ends = antenna.net.model.elements
        found.append((positions[info.body("net").nodes[ends]], CORD, 0.3))
    bars = np.array([positions[info.body(bar.name).nodes] for bar in antenna.bars])
    found.append((bars[:bays], UPRIGHT, 1.2))
    folding = bars[bays:].reshape(bays, 4, *bars.shape[1:])
    found.append((folding[:, :2].reshape(-1, *bars.shape[1:]), LONGERON, 1.2))
    found.append((folding[:, 2:].reshape(-1, *bars.shape[1:]), TELESCOPE, 0.9))
    return found


def draw(panel: Axes, of: list[tuple[np.ndarray, str, float]], view: np.ndarray) -> None:
    for positions, colour, width in of:
        panel.add_collection(
            LineCollection(list(positions @ view), colors=colour, linewidths=width)
        )
    panel.set(aspect="equal")
    panel.autoscale_view()


def motion(antenna: Antenna, result: fl.Result, name: str) -> None:
    """Deployed, at four angles, and folded."""
    figure = Figure(figsize=(15.0, 8.0), layout="constrained")
    panels = figure.subplots(2, 3, sharex=True, sharey=True).ravel()
    for panel, part in zip(panels, (0.0, 0.35, 0.45, 0.55, 0.65, 1.0), strict=True):
        time = part * result.times[-1]
        row = result.index(time)
        draw(panel, lines(antenna, result, row), OBLIQUE)
        q = np.degrees(angle(result.times[row], antenna.duration))
        panel.set(title=f"t = {result.times[row]:g} s, q = {q:.0f}°", xlabel="m")
    figure.savefig(in_results(f"{name}.png"), dpi=120)


def layout(antenna: Antenna, result: fl.Result, name: str) -> None:
    """From above, and some bays in the middle of the motion, unrolled, with their joints."""
    figure = Figure(figsize=(13.0, 6.5), layout="constrained")
    plan, side = figure.subplots(1, 2)
    of = lines(antenna, result, 0)
    draw(plan, of, PLAN)
    plan.set(title="deployed, from above: both nets lie on each other", xlabel="m", ylabel="m")
    row = result.index(0.5 * result.times[-1])
    tops, feet = (
        np.array([result.position(getattr(bar, end))[row] for bar in antenna.uprights[:5]])
        for end in ("end", "start")
    )
    apart = np.linalg.norm(np.diff(tops[:, :2], axis=0), axis=1)
    x = np.concatenate([[0.0], np.cumsum(apart)])
    z, low = tops[:, 2], feet[:, 2]
    side.vlines(x, low, z, UPRIGHT, lw=3, label="vertical")
    side.plot(x, z, LONGERON, lw=3, label="longeron")
    side.plot(x, low, LONGERON, lw=3)
    for i in range(4):
        (a, b) = (i, i + 1) if i % 2 else (i + 1, i)
        foot, head = np.array([x[a], low[a]]), np.array([x[b], z[b]])
        along = (head - foot) / np.linalg.norm(head - foot)
        across = 0.006 * np.array([-along[1], along[0]])
        for start, way, shift in ((foot, along, across), (head, -along, -across)):
            tube = np.array([start, start + antenna.tube_length * way])
            side.plot(*(tube + np.sign(way @ along) * shift).T, TELESCOPE, lw=2)
        side.annotate("prismatic, driven", 0.5 * (foot + head), fontsize=8, rotation=0)
        side.annotate("revolute", foot, (4, -12), textcoords="offset points", fontsize=8)
        side.annotate("spherical", head, (4, 6), textcoords="offset points", fontsize=8)
    side.plot(x, z, "o", color=LONGERON, ms=7, label="two revolutes and a pair of gears")
    side.plot(x, low, "o", color=LONGERON, mfc="white", ms=7, label="two revolutes")
    side.set(aspect="equal", title="four bays, half folded, unrolled", xlabel="m")
    side.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2, fontsize=8)
    figure.savefig(in_results(f"{name}.png"), dpi=110)
