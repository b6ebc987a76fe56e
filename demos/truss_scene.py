r"""The deployable truss of truss_deployment.py: cells of bars, hinges and telescopes.

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
"""

from __future__ import annotations

import numpy as np
from reference.truss import LONGERON, SIDE, START, corners, turned

import fem_lie as fl
from fem_lie.joints import Revolute, RigidLink
from fem_lie.schemes import MatrixTerms

TUBES = {"closing": 3.2, "opening": 2.4}
AXIS, UP = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
DRIVEN_FIRST = (0, 2, 1, 3)


class Truss:
    """The scene of some cells at 5 degrees, and its bars.

    Attributes:
        scene: With all bars, joints, gears and drives.
        section: Of all bars.
        elements: Of each bar.
        driven: Longerons whose foot is driven, in every second cell.
        bars: 28 for each cell.
        frames: Corners of the frames, from the lowest (ground) to the highest, four each.

    Raises:
        ValueError: There are no cells, or none or more than four longerons to be driven.
    """

    def __init__(
        self, cells: int, section: fl.Section, elements: int, driven: int, matrix_terms: MatrixTerms
    ) -> None:
        if cells < 1 or not 1 <= driven <= 4:
            raise ValueError(f"wanted cells ≥ 1 and 1 to 4 driven longerons, got {cells}, {driven}")
        self.scene = fl.Scene(matrix_terms=matrix_terms)
        self.section, self.elements = section, elements
        self.driven = DRIVEN_FIRST[:driven]
        self.bars: list[fl.Beam] = []
        self.frames = [[fl.ground()] * 4]
        tops: dict[int, Revolute] = {}
        for cell in range(cells):
            self._lower_frame(cell)
            self.frames.append(self._frame(cell + 1))
            tops = self._longerons(cell, tops)
            for face in range(4):
                self._telescope(cell, face, (face + 1) % 4)
                self._telescope(cell, (face + 1) % 4, face)

    def _bar(self, start: np.ndarray, end: np.ndarray, up: np.ndarray) -> fl.Beam:
        name = f"bar {len(self.bars)}"
        bar = fl.Beam.straight(start, end, self.section, cells=self.elements, up=up, name=name)
        self.bars.append(self.scene.add(bar))
        return bar

    def _battens(self, level: int) -> list[fl.Beam]:
        positions = corners(level, START)
        return [self._bar(positions[i], positions[(i + 1) % 4], UP) for i in range(4)]

    def _frame(self, level: int) -> list[fl.extend.Point]:
        battens = self._battens(level)
        for i in range(4):
            self.scene.add(RigidLink(battens[i - 1].point("end"), battens[i].point("start")))
        return [batten.point("start") for batten in battens]

    def _lower_frame(self, cell: int) -> None:
        for i, batten in enumerate(self._battens(cell)):
            for corner, end in ((i, batten.point("start")), ((i + 1) % 4, batten.point("end"))):
                on = self.frames[cell][corner]
                self.scene.add(fl.Clamp(end) if on.is_ground else RigidLink(on, end))

    def _longerons(self, cell: int, below: dict[int, Revolute]) -> dict[int, Revolute]:
        """All four; takes and returns the hinges at the tops of the driven ones."""
        lower, upper = (corners(cell + k, START) for k in range(2))
        tops = {}
        for i in range(4):
            bar = self._bar(lower[i], upper[i], AXIS)
            foot = self._hinge(self.frames[cell][i], bar.point("start"))
            top = self._hinge(self.frames[cell + 1][i], bar.point("end"))
            if i not in self.driven:
                continue
            tops[i] = top
            if cell % 2:
                self.scene.add(fl.joints.Gear(below[i].angle, foot.angle, ratio=1.0))
            else:
                self.scene.add(fl.joints.Drive(foot.angle, turned))
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
        self._hinge(self.frames[cell][i], one.point("start"))
        self._hinge(self.frames[cell + 1][j], two.point("start"))
        self.scene.add(
            fl.joints.Prismatic(
                one.point("end"), two.point("end"), at=one.point("end").position, axis=along
            )
        )

    def _hinge(self, a: fl.extend.Point, b: fl.extend.Point) -> Revolute:
        return self.scene.add(Revolute(a, b, axis=AXIS))
