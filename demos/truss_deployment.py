r"""Deployable truss: with local frames the iteration matrix of a large motion hardly changes.

The example of Figure 23 and Table 1 of the paper on local frames. The layout of its cell is not
published; this one has the same size, count of bars, kinds of joints and law of deployment, and is
stated here in full.

Cells stand on each other. Seen along y, two cells at some angle of deployment q, and the eight
tubes of telescopes in the side face of a cell and in the face that leans with the longerons::

            o------o                    c1         d1       c1        e1
             \      \   cell 2          o----------o        o----------o
              \      \                 /  '    '  /         |  \    /  |
               o======o               /     X    /          |    \/    |
              /      /               /   .   .  /           |  /    \  |
             /      /   cell 1      o----------o            o----------o
        ----o------o----            c0         d0           c0        e0
          lower frame              a side face              a leaning face
        z                          z                        along c0-c1
        '-- x                      '-- x                    '-- y

Telescopes cross without touching.

- 8 battens: a lower and an upper frame of 2 m x 2 m, rigidly joined at the corners. The upper frame
  of a cell and the lower one of the next are bolted together (===), the lowest is clamped.
- 4 longerons of 4 m from the lower to the upper frame, parallel to each other and at the angle q to
  the horizontal. The next cell leans the other way, so that the package folds onto itself.
- 16 tubes of 8 telescopes, two crossing in each face. Two tubes are joined tip to tip by a
  prismatic joint along their line. In the side faces c0-d1 closes from 6.0 m to 4.47 m (tubes of
  3.2 m) and d0-c1 opens from 2.03 m, where the tubes reach past the corners, to 4.47 m (tubes of
  2.4 m). In the leaning faces the length stays 4.47 m (tubes of 2.4 m).
- All longerons and telescopes end in revolute joints at the corners, with axes along y.

As rigid bodies this would be many times redundant; flexible bars take up all of it, and no
constraint is redundant. There is no gravity and no contact between bars.

The first and then every second cell is driven at the foot of --driven longerons (default: one, all
four of more than two cells): q follows a cosine law from 5 to 90 degrees in 20 s. A pair of gears
on the corner above turns the longeron of the next cell by the same angle the other way. The other
longerons are carried along by the frames. So all that is accelerated hangs on one bar, which bends.
The law starts and ends with its full acceleration, as if struck, and the thin truss swings by a
metre.

Hollow round steel bars, inner and outer diameter 0.055/0.08 m (stiff) or 0.023/0.024 m (thin). With
the stiff ones geometric stiffness is left out of the iteration matrix.

The numbers: k_updates and phi_updates count every matrix of mass and stiffness and every Jacobian
of the constraints, the first included; max_deflection is the largest distance of a bar's axis from
its chord over the bar's length, max_strain that of a fibre; posture_error is the largest distance
of a corner from where rigid bars have it, in the equilibrium at the end of the law (statics along
the law, without inertia), off_at_end the same at the end of the motion, while the truss swings.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from command_line import in_results, run
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

import fem_lie as fl
from fem_lie import lie
from fem_lie._arrays import Array

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
DIAMETERS = {"stiff": (0.055, 0.08), "thin": (0.023, 0.024)}
POLICIES: dict[str, fl.Policy] = {
    "full": fl.EveryIteration(),
    "nni4": fl.Limit(4),
    "frozen": fl.ConstraintsOnly(4),
    "auto": fl.Automatic(),
}
SIDE, LONGERON = 2.0, 4.0
TUBES = {"closing": 3.2, "opening": 2.4}
START, END = np.radians([5.0, 90.0])
DEPLOYMENT = 20.0
SQUARE = SIDE * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
AXIS, UP = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
DRIVEN_FIRST = (0, 2, 1, 3)
OBLIQUE = np.array([[1.0, 0.0], [0.4, 0.25], [0.0, 1.0]])  # side view, y into the depth
COLOURS = 8 * ["#888888"] + 4 * ["#D55E00"] + 16 * ["#56B4E9"]  # of the bars of a cell


def angle(t: float) -> float:
    """Angle of deployment by the cosine law."""
    return float(START + (END - START) * 0.5 * (1 - np.cos(np.pi * t / DEPLOYMENT)))


def turned(t: float) -> float:
    """What the driven feet follow: rotation of the longeron about y."""
    return START - angle(t)


def corners(level: int, q: float) -> Array:
    """The corners of a frame, 0 being the clamped one, if bars were rigid."""
    return SQUARE + LONGERON * np.array([level % 2 * np.cos(q), 0.0, level * np.sin(q)])


class Truss:
    """The scene of some cells at 5 degrees, and its bars.

    Attributes:
        scene: With all bars, joints, gears and drives.
        section: Of all bars.
        elements: Of each bar.
        driven: Longerons whose foot is driven, in every second cell.
        bars: 28 for each cell.
        frames: Corners of the frames, from the lowest (ground) to the highest, four each.
    """

    def __init__(
        self, cells: int, section: fl.Section, elements: int, driven: int, choices: fl.Choices
    ) -> None:
        self.scene, self.section, self.elements = fl.Scene(choices=choices), section, elements
        self.driven = DRIVEN_FIRST[:driven]
        self.bars: list[fl.Beam] = []
        self.frames = [[fl.ground()] * 4]
        tops: dict[int, fl.Revolute] = {}
        for cell in range(cells):
            self._lower_frame(cell)
            self.frames.append(self._frame(cell + 1))
            tops = self._longerons(cell, tops)
            for face in range(4):
                self._telescope(cell, face, (face + 1) % 4)
                self._telescope(cell, (face + 1) % 4, face)

    def _bar(self, start: Array, end: Array, up: Array) -> fl.Beam:
        name = f"bar {len(self.bars)}"
        bar = fl.Beam.straight(start, end, self.section, cells=self.elements, up=up, name=name)
        self.bars.append(self.scene.add(bar))
        return bar

    def _battens(self, level: int) -> list[fl.Beam]:
        places = corners(level, START)
        return [self._bar(places[i], places[(i + 1) % 4], UP) for i in range(4)]

    def _frame(self, level: int) -> list[fl.Point]:
        battens = self._battens(level)
        for i in range(4):
            self.scene.add(fl.RigidLink(battens[i - 1].end, battens[i].start))
        return [batten.start for batten in battens]

    def _lower_frame(self, cell: int) -> None:
        for i, batten in enumerate(self._battens(cell)):
            for corner, end in ((i, batten.start), ((i + 1) % 4, batten.end)):
                on = self.frames[cell][corner]
                self.scene.add(fl.Clamp(end) if on.is_ground else fl.RigidLink(on, end))

    def _longerons(self, cell: int, below: dict[int, fl.Revolute]) -> dict[int, fl.Revolute]:
        """All four; takes and returns the hinges at the tops of the driven ones."""
        lower, upper = (corners(cell + k, START) for k in range(2))
        tops = {}
        for i in range(4):
            bar = self._bar(lower[i], upper[i], AXIS)
            foot = self._hinge(self.frames[cell][i], bar.start)
            top = self._hinge(self.frames[cell + 1][i], bar.end)
            if i not in self.driven:
                continue
            tops[i] = top
            if cell % 2:
                self.scene.add(fl.Gear(below[i].angle, foot.angle, ratio=1.0))
            else:
                self.scene.add(fl.Drive(foot.angle, turned))
        return tops

    def _telescope(self, cell: int, i: int, j: int) -> None:
        """From corner i of the lower frame to corner j of the upper one."""
        start, end = corners(cell, START)[i], corners(cell + 1, START)[j]
        length = float(np.linalg.norm(end - start))
        along = (end - start) / length
        closing = length > np.hypot(SIDE, LONGERON) + 1e-9
        tube = TUBES["closing" if closing else "opening"]
        across = np.cross(AXIS, along)
        one = self._bar(start, start + tube * along, across)
        two = self._bar(end, end - tube * along, across)
        self._hinge(self.frames[cell][i], one.start)
        self._hinge(self.frames[cell + 1][j], two.start)
        self.scene.add(fl.Prismatic(one.end, two.end, at=one.end.position, axis=along))

    def _hinge(self, a: fl.Point, b: fl.Point) -> fl.Revolute:
        return self.scene.add(fl.Revolute(a, b, axis=AXIS))


def bending(
    result: fl.Result | fl.StaticResult, truss: Truss, radius: float
) -> tuple[float, float]:
    """Largest distance of an axis from its chord over the length, and largest strain of a fibre."""
    nodes = np.array([result.info.body(bar.name).nodes for bar in truss.bars])
    x = result.frames[:, nodes, 0]
    chord = x[:, :, -1:] - x[:, :, :1]
    length = np.linalg.norm(chord, axis=-1, keepdims=True)
    away = np.linalg.norm(np.cross(x - x[:, :, :1], chord / length), axis=-1)
    deflection = away.max(axis=2) / length[:, :, 0, 0]
    rest = np.array([bar.lengths for bar in truss.bars])[..., np.newaxis]
    strain = 0.0
    for frames in result.frames[:, nodes]:
        moved = lie.se3_relative(frames[:, :-1], frames[:, 1:]) / rest
        fibre = np.abs(moved[..., 0] - 1.0) + radius * np.linalg.norm(moved[..., 4:], axis=-1)
        strain = max(strain, float(fibre.max()))
    return float(deflection.max()), strain


def off_posture(result: fl.Result | fl.StaticResult, truss: Truss, time: float) -> float:
    """Largest distance of a corner at the end, ``time``, from where rigid bars would have it."""
    return max(
        float(np.linalg.norm(result.position(point)[-1] - place))
        for level, frame in enumerate(truss.frames)
        for point, place in zip(frame, corners(level, angle(time)), strict=True)
        if not point.is_ground
    )


def posture_error(truss: Truss, time: float) -> float:
    """The same in the equilibrium that statics along the law reaches at ``time``."""
    return off_posture(fl.statics(truss.scene, levels=np.linspace(0.0, time, 21)[1:]), truss, time)


def picture(result: fl.Result, truss: Truss, file: Path) -> None:
    """Figure 23: the truss at six times, longerons, battens and telescopes in a colour each."""
    figure = Figure(figsize=(15.0, 4.5), layout="constrained")
    panels = figure.subplots(1, 6, sharex=True, sharey=True)
    nodes = np.array([result.info.body(bar.name).nodes for bar in truss.bars])
    for panel, time in zip(panels, np.linspace(0.0, result.times[-1], 6), strict=True):
        axes = result.frames[result.index(time), nodes, 0] @ OBLIQUE
        colours = COLOURS * (len(axes) // len(COLOURS))
        panel.add_collection(LineCollection(list(axes), colors=colours, linewidths=1.2))
        panel.set(title=f"t = {time:g} s", aspect="equal", xlabel="x [m]")
        panel.autoscale_view()
        panel.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("z [m]")
    figure.savefig(file, dpi=120)


def _check(cells: int, tubes: str, policy: str, driven: int) -> None:
    if tubes not in DIAMETERS or policy not in POLICIES:
        raise ValueError(
            f"tubes must be one of {', '.join(DIAMETERS)} and policy one of {', '.join(POLICIES)}, "
            f"got {tubes!r} and {policy!r}"
        )
    if cells < 1 or not 1 <= driven <= 4:
        raise ValueError(f"wanted cells ≥ 1 and 1 to 4 driven longerons, got {cells}, {driven}")


def report(record: dict[str, Any]) -> None:
    """Print a record as rows of Table 1."""


def main(
    cells: int = 2,
    tubes: str = "stiff",
    step: float = 2e-3,
    policy: str = "auto",
    elements: int = 10,
    driven: int | None = None,
    duration: float = DEPLOYMENT,
    tolerance: float = fl.GeneralisedAlpha.tolerance,
    inertial: bool = False,
    pictures: bool = True,
    table: bool = False,
) -> dict[str, Any]:
    """``table``: all policies, each with ``step`` and half of it, without pictures."""
    if table:
        options = (elements, driven, duration, tolerance, inertial, False)
        rows = [
            main(cells, tubes, h, name, *options) for h in (step, 0.5 * step) for name in POLICIES
        ]
        return {"rows": rows}
    driven = (1 if cells <= 2 else 4) if driven is None else driven
    _check(cells, tubes, policy, driven)
    inner, outer = (0.5 * diameter for diameter in DIAMETERS[tubes])
    section = fl.Section.tube(inner, outer, STEEL)
    truss = Truss(cells, section, elements, driven, fl.Choices(geometric=tubes == "thin"))
    scheme = fl.GeneralisedAlpha(
        radius=0.8,
        tolerance=tolerance,
        policy=POLICIES[policy],
        components=fl.Components(int(inertial)),
    )
    steps = round(duration / step)
    result = scheme.run(
        truss.scene, duration=steps * step, step=step, save_every=max(1, steps // 500)
    )
    deflection, strain = bending(result, truss, outer)
    record = {
        "cells": cells,
        "tubes": tubes,
        "policy": policy,
        "inertial": inertial,
        "step": step,
        "steps": steps,
        "bars": len(truss.bars),
        "iterations": int(result.iterations[-1]),
        "k_updates": result.k_updates,
        "phi_updates": result.phi_updates,
        "ms_per_step": 1e3 * result.seconds / steps,
        "max_deflection": deflection,
        "max_strain": strain,
        "off_at_end": off_posture(result, truss, steps * step),
        "posture_error": posture_error(truss, steps * step),
        "violation": float(result.joint_violations.max()),
    }
    report(record)
    if pictures:
        name = in_results(f"truss_deployment_{tubes}")
        picture(result, truss, name.with_suffix(".png"))
        result.animate(name.with_suffix(".gif"), title=f"Deployable truss, {tubes} tubes")
    return record


if __name__ == "__main__":
    run(main, show=True)
