r"""Deployable truss: with local frames the iteration matrix of a large motion hardly changes.

The example of Figure 23 and Table 1 of the paper on local frames. The layout of its cell is not
published; this one has the same size and count of bars, 28 per cell, and is stated here in full.

Cells stand on each other along z, each on the square frame below it, the first on the ground. One
of the four side faces of a cell, deployed (left) and at a small angle (right)::

    c1 o============o d1   upper frame: 4 battens of 2 m
       |  \      /  |
       |    \  /    |       c1 o============o d1
    m  o     ><     |          |  ' - .  . '|
       |    /  \    |          |   . '  ' - o m     m -> the knee, between
       |  /      \  |          o============o        c0-m and m-c1 of 2 m
    c0 o............o d0      c0            d0

- 4 battens: the upper frame of 2 m x 2 m, rigidly joined at its corners.
- 8 halves of the 4 longerons: c0-m and m-c1, of 2 m each. Revolute joints at c0, m and c1, axes
  normal to the face. At the angle of deployment q both halves are inclined by q to the horizontal,
  the knee m points towards the next corner d, and the cell is 4 sin q high. Longeron i folds
  in face i, so that the faces follow each other around the cell.
- 16 tubes of 8 telescopes, two crossing in each face: c0-d1 and d0-c1. Each tube is 2.4 m long
  and tied to its corner by a revolute joint with an axis normal to the face; the two are joined
  tip to tip by a prismatic joint along their line. A telescope is 2.03 m long at 5 degrees, where
  the tubes reach 0.37 m past the corners, and 4.47 m at 90 degrees, where 0.33 m overlap.

As rigid bodies this would be many times redundant; flexible bars take up all of it, and no
constraint is redundant. There is no gravity and no contact between bars.

The knees of --driven longerons of each cell are driven: q follows a cosine law from 5 to 90 degrees
in 20 s, the knee turns by twice that. The other longerons are carried along by the frame. At 90
degrees a longeron is straight, a singular posture: a knee that is not driven could then turn either
way. (Drives at the feet do not work with thin tubes: the square frame is soft about z, and at 5
degrees a small turn of it lets the corners fall by eleven times as much.)

Hollow round steel bars, inner and outer diameter 0.055/0.08 m (stiff) or 0.023/0.024 m (thin). With
the stiff ones geometric stiffness is left out of the iteration matrix.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import fem_lie as fl
from fem_lie import lie
from fem_lie._jit import Array

RESULTS = Path(__file__).parents[1] / "results"
STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
DIAMETERS = {"stiff": (0.055, 0.08), "thin": (0.023, 0.024)}
POLICIES: dict[str, fl.Policy] = {
    "full": fl.EveryIteration(),
    "nni4": fl.Limit(4),
    "frozen": fl.ConstraintsOnly(4),
    "auto": fl.Automatic(),
}
SIDE, HALF, TUBE = 2.0, 2.0, 2.4
START, END = np.radians([5.0, 90.0])
DEPLOYMENT = 20.0
SQUARE = SIDE * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
UP = np.array([0.0, 0.0, 1.0])


def angle(t: float) -> float:
    """Angle of deployment by the cosine law."""
    return float(START + (END - START) * 0.5 * (1 - np.cos(np.pi * t / DEPLOYMENT)))


def turned(t: float) -> float:
    """What the driven knees follow: rotation of the upper half against the lower one."""
    return 2 * (START - angle(t))


class Truss:
    """The scene of some cells at 5 degrees, and its bars.

    Attributes:
        scene: With all bars, joints and drives.
        section: Of all bars.
        elements: Of each bar.
        bars: 28 for each cell.
        corners: Of the frames, from the lowest (ground) to the highest, four each.
    """

    def __init__(
        self, cells: int, section: fl.Section, elements: int, driven: int, choices: fl.Choices
    ) -> None:
        self.scene, self.section, self.elements = fl.Scene(choices=choices), section, elements
        self.bars: list[fl.Beam] = []
        self.corners = [[fl.ground()] * 4]
        height = 2 * HALF * np.sin(START)
        for cell in range(cells):
            below, above = cell * height * UP, (cell + 1) * height * UP
            self.corners.append(self._frame(above))
            for face in range(4):
                self._face(face, below, above, driven=face < driven)

    def _bar(self, start: Array, end: Array, up: Array) -> fl.Beam:
        name = f"bar {len(self.bars)}"
        bar = fl.Beam.straight(start, end, self.section, cells=self.elements, up=up, name=name)
        self.bars.append(self.scene.add(bar))
        return bar

    def _frame(self, level: Array) -> list[fl.Point]:
        places = SQUARE + level
        battens = [self._bar(places[i], places[(i + 1) % 4], UP) for i in range(4)]
        for i in range(4):
            self.scene.add(fl.RigidLink(battens[i - 1].end, battens[i].start))
        return [battens[i - 1].end for i in range(4)]

    def _face(self, face: int, below: Array, above: Array, *, driven: bool) -> None:
        """Longeron and two telescopes between the corners ``face`` and the next."""
        following = (face + 1) % 4
        c, d = SQUARE[face], SQUARE[following]
        normal = np.cross((d - c) / SIDE, UP)
        (c0, d0), (c1, d1) = ((f[face], f[following]) for f in self.corners[-2:])
        knee = below + c + HALF * (np.cos(START) * (d - c) / SIDE + np.sin(START) * UP)
        lower = self._bar(c + below, knee, normal)
        upper = self._bar(knee, c + above, normal)
        self._hinge(c0, lower.start, normal)
        middle = self._hinge(lower.end, upper.start, normal)
        self._hinge(c1, upper.end, normal)
        if driven:
            self.scene.add(fl.Drive(middle.angle, turned))
        self._telescope(c0, d1, c + below, d + above, normal)
        self._telescope(d0, c1, d + below, c + above, normal)

    def _telescope(self, a: fl.Point, b: fl.Point, start: Array, end: Array, normal: Array) -> None:
        along = (end - start) / np.linalg.norm(end - start)
        one = self._bar(start, start + TUBE * along, normal)
        two = self._bar(end, end - TUBE * along, normal)
        self._hinge(a, one.start, normal)
        self._hinge(b, two.start, normal)
        self.scene.add(fl.Prismatic(one.end, two.end, at=one.end.position, axis=along))

    def _hinge(self, a: fl.Point, b: fl.Point, normal: Array) -> fl.Revolute:
        return self.scene.add(fl.Revolute(a, b, axis=normal))


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


def posture_error(result: fl.Result | fl.StaticResult, truss: Truss, time: float) -> float:
    """Largest distance of a corner at the end, ``time``, from where rigid bars would have it."""
    height = 2 * HALF * np.sin(angle(time))
    return max(
        float(np.linalg.norm(result.position(point)[-1] - SQUARE[i] - level * height * UP))
        for level, frame in enumerate(truss.corners)
        for i, point in enumerate(frame)
        if not point.is_ground
    )


def main(
    cells: int = 2,
    tubes: str = "stiff",
    step: float = 2e-3,
    policy: str = "auto",
    elements: int = 10,
    driven: int = 1,
    duration: float = DEPLOYMENT,
    inertial: bool = False,
    pictures: bool = True,
    animation: bool = False,
) -> dict[str, Any]:
    if tubes not in DIAMETERS or policy not in POLICIES:
        raise ValueError(
            f"tubes must be one of {', '.join(DIAMETERS)} and policy one of {', '.join(POLICIES)}, "
            f"got {tubes!r} and {policy!r}"
        )
    if cells < 1 or not 1 <= driven <= 4:
        raise ValueError(f"wanted cells ≥ 1 and 1 to 4 driven longerons, got {cells}, {driven}")
    inner, outer = (0.5 * diameter for diameter in DIAMETERS[tubes])
    section = fl.Section.tube(inner, outer, STEEL)
    truss = Truss(cells, section, elements, driven, fl.Choices(geometric=tubes == "thin"))
    scheme = fl.GeneralisedAlpha(
        radius=0.8, policy=POLICIES[policy], components=fl.Components(int(inertial))
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
        "posture_error": posture_error(result, truss, steps * step),
        "violation": float(result.joint_violations.max()),
    }
    print(f"{cells} cells, {len(truss.bars)} bars, {tubes} tubes, policy {policy}, h = {step:g} s")
    print("steps   iterations (per step)   updates of K   of constraints   ms per step")
    print(
        f"{steps:5} {record['iterations']:12} ({record['iterations'] / steps:.2f})"
        f"{result.k_updates:17}{result.phi_updates:17}{record['ms_per_step']:14.2f}"
    )
    print(
        f"largest deflection {100 * deflection:.3f} % of the length, strain {strain:.1e}, "
        f"corners off by {record['posture_error']:.1e} m"
    )
    if pictures or animation:
        RESULTS.mkdir(exist_ok=True)
    if pictures:
        file = RESULTS / f"truss_deployment_{tubes}.png"
        result.picture(file, title=f"Deployable truss, {cells} cells")
        print(f"picture: {file}")
    if animation:
        result.animate(RESULTS / f"truss_deployment_{tubes}.gif", title="Deployable truss")
    return record


if __name__ == "__main__":
    from command_line import run

    run(main)
