r"""The hoop truss antenna of hoop_antenna.py: a ring of bays, and a net in front and one behind.

Seen from outside, two bays deployed and half folded, and a sector of a net between two verticals
seen along the axis::

    T0     T1     T2        T0            T2       rim   T0-----------T1
    o------o------o         o\           /o               \ \       / /     r0 = 2 m
    |    / | \    |         | \  (down) / |                \  \   /  /
    |  //  |  \\  |         |//\\ T1  //\\|         ring 1  o----o----o     3/4 r0
    | /    |    \ |         /   \\o// /   \                  \  / \  /
    o------o------o         o\ // | \\  / o         ring 2    o----o        1/2 r0
    B0     B1     B2        B0 \\ | //    B2                   \  /
                                 \o/                  ring 3    o           1/4 r0
                                  B1

Every second vertical goes up and the others down by half of what longerons (T-T, B-B) rise, so that
all stay upright. Each bay is a parallelogram, and its telescope (//, from the foot of a vertical
that goes down to the top of one that goes up) opens.

- ``bays`` verticals of 0.6 m on a circle of radius 2 m, and two longerons between neighbours.
  Longerons end in revolute joints on the verticals, with axes across the plane of their bay.
- A telescope in each bay: two tubes of 0.56 m, joined tip to tip by a prismatic joint along their
  line. The lower one stands on a revolute joint, the upper one hangs on a spherical joint.
- A pair of gears on each top binds the angles of both longerons there. That leaves one motion.
- Nets: in front (between the T) and behind (between the B) three rings of as many knots as there
  are bays, at 3/4, 1/2 and 1/4 of the radius, each turned by half a bay. Each knot is tied to its
  two neighbours on its ring, and to two on the next ring outside or the rim; a tie leads from each
  to its like in the other net. That is 21 cables for each bay. The nets hang on the tops and feet
  of the verticals by spherical joints. Knots lie on paraboloids of 0.2 m depth.
- Forces of cables are in equilibrium at each knot. Per bay the radial force grows as the radius, as
  in a membrane that is pulled by 12 N/m in all directions; rings and ties have what that
  asks for. Unstretched lengths follow: cords are elastic, E = 1e8 N/m², 1 mm thick, and stretched
  by 0.2 to 11 %.
- All bars are carbon tubes of 28/32 mm, E = 7e10 N/m², 1600 kg/m³.

Nothing is held: the antenna floats. There is no gravity and no contact. The angle q of longerons
follows a law of fifth order in time from 0 to 85 degrees; telescopes of ``driven`` bays at equal
distances are driven by what that means for their length. At 90 degrees the ring would have no
width.
"""

from __future__ import annotations

import numpy as np
from antenna_cables import HEIGHT, RADIUS, cables, nets

import fem_lie as fl

FOLDED, PULL = np.radians(85.0), 12.0
CARBON = fl.Material(E=7e10, nu=0.3, density=1600.0)
UP = np.array([0.0, 0.0, 1.0])


def angle(t: float, duration: float) -> float:
    """Of longerons: starts and ends with neither velocity nor acceleration."""
    s = min(max(t / duration, 0.0), 1.0)
    return float(FOLDED * s**3 * (10.0 - 15.0 * s + 6.0 * s**2))


class Antenna:
    """The scene, deployed and at rest.

    Attributes:
        scene: With all bars, joints, gears, drives and cables.
        uprights: The verticals, from the foot to the top.
        bars: These and all others.
        telescopes: The prismatic joint of each bay.
        drives: Those of the driven bays.
        net: All cables, or none.

    Raises:
        ValueError: Bays are odd or less than four, or no divisor of theirs is driven.
    """

    def __init__(
        self, bays: int, driven: int, duration: float, elements: int, cells: int, slack: float
    ) -> None:
        if bays < 4 or bays % 2 or driven < 1 or bays % driven:
            raise ValueError(f"wanted even bays ≥ 4, a divisor driven, got {bays}, {driven}")
        self.scene, self.elements, self.duration = fl.Scene(), elements, duration
        self.section = fl.Section.tube(0.014, 0.016, CARBON)
        self.bars: list[fl.Beam] = []
        self.telescopes: list[fl.joints.Prismatic] = []
        phi = 2.0 * np.pi * np.arange(bays) / bays
        self.rim = RADIUS * np.stack([np.cos(phi), np.sin(phi), 0.0 * phi], axis=1)
        half = 0.5 * HEIGHT * UP
        self.uprights = [self._bar(x - half, x + half, x) for x in self.rim]
        turns = [self._bay(i) for i in range(bays)]
        for i in range(bays):
            self.scene.add(fl.joints.Gear(turns[i - 1][1].angle, turns[i][0].angle, ratio=1.0))
        self.drives = [
            self.scene.add(fl.joints.Drive(joint.displacement, self.opened))
            for joint in self.telescopes[:: bays // driven]
        ]
        self.net: fl.Net | None = None
        if cells:
            self.net = nets(cables(bays, PULL), cells, slack)
            self.scene.add(self.net)
            for i, upright in enumerate(self.uprights):
                self.scene.add(fl.joints.Spherical(upright.point("end"), self.net.point(i)))
                self.scene.add(
                    fl.joints.Spherical(upright.point("start"), self.net.point(bays + i))
                )

    @property
    def side(self) -> float:
        """Length of a longeron."""
        return float(2.0 * RADIUS * np.sin(np.pi / len(self.rim)))

    @property
    def tube_length(self) -> float:
        """Of both tubes of a telescope, which still overlap when longerons are upright."""
        return 0.55 * (self.side + HEIGHT)

    def opened(self, t: float) -> float:
        """By how much a telescope is longer than at the start."""
        rise = 2.0 * HEIGHT * self.side * np.sin(angle(t, self.duration))
        start = np.hypot(HEIGHT, self.side)
        return float(np.sqrt(start**2 + rise) - start)

    def _bar(self, start: np.ndarray, end: np.ndarray, up: np.ndarray) -> fl.Beam:
        name = f"bar {len(self.bars)}"
        bar = fl.Beam.straight(start, end, self.section, cells=self.elements, up=up, name=name)
        self.bars.append(self.scene.add(bar))
        return bar

    def _bay(self, i: int) -> tuple[fl.joints.Revolute, fl.joints.Revolute]:
        """From vertical i to the next; returns the joints at both ends of the upper longeron."""
        one, two = self.uprights[i], self.uprights[(i + 1) % len(self.uprights)]
        (foot1, foot2), (head1, head2) = (
            [b.point(e) for b in (one, two)] for e in ("start", "end")
        )
        across = foot1.position + foot2.position
        across = across * [1.0, 1.0, 0.0]

        def hinge(a: fl.extend.Point, b: fl.extend.Point) -> fl.joints.Revolute:
            return self.scene.add(fl.joints.Revolute(a, b, axis=across))

        low = self._bar(foot1.position, foot2.position, UP)
        hinge(foot1, low.point("start")), hinge(foot2, low.point("end"))
        top = self._bar(head1.position, head2.position, UP)
        found = hinge(head1, top.point("start")), hinge(head2, top.point("end"))
        foot, head = (foot1, head2) if i % 2 else (foot2, head1)
        along = head.position - foot.position
        along = along / np.linalg.norm(along)
        lower = self._bar(foot.position, foot.position + self.tube_length * along, across)
        upper = self._bar(head.position, head.position - self.tube_length * along, across)
        hinge(foot, lower.point("start"))
        self.scene.add(fl.joints.Spherical(head, upper.point("start")))
        tips = fl.joints.Prismatic(
            lower.point("end"), upper.point("end"), at=lower.point("end").position, axis=along
        )
        self.telescopes.append(self.scene.add(tips))
        return found
