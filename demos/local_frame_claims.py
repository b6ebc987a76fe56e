"""What local frames are worth: the same motions with the iteration matrix in three kinds of frames.

In formulations of multibody dynamics with a global vector of velocity and rotation vectors along
fixed axes the iteration matrix turns with the bodies: as soon as one has turned by some 20 degrees,
the matrix of before is of no use. In the bodies' own frames the leading mass and stiffness do not
change when the bodies turn (V. Sonneville, A. Cardona & O. Brüls, CMAME 268 (2014) 451; A. Müller,
Proc. R. Soc. A 477 (2021) 20210303), so that one matrix serves for thousands of steps. Three
descriptions of each motion, with the same bodies, step and tolerance:

    local, SE(3)          screw motions; unknowns along the nodes' axes
    local, R3 x SO(3)     translations and rotations apart; unknowns along the nodes' axes
    inertial, R3 x SO(3)  as before, but unknowns along fixed axes: the classical description

The last two make the same steps, and hence the same error: what differs is the matrix alone. It is
made for the middle of its expected life in all of them, and renewed by the same policy: automatic,
when keeping it has cost as many iterations as a new one, or when a step takes more than 4. The
Cayley map in place of the exponential changes neither; its increments are rational.

    pendulum   the double pendulum of double_pendulum.py, case 1: turns by some 0.8 of a revolution
    spinning   the same pendulum, ten times as fast, in a tenth of the step
    net        4 x 4 meshes of flexible bars with spherical joints, thrown and tumbling

Without --scene all three are run. The error is the largest distance of any node, over the run, from
a run with an eighth of the step on SE(3), relative to the size of the model.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import fem_lie as fl

RESULTS = Path(__file__).parents[1] / "results"
LOCAL, INERTIAL = fl.Components.LOCAL, fl.Components.INERTIAL
SE3, APART = fl.Group.SE3, fl.Group.R3xSO3
EXPONENTIAL, CAYLEY = fl.Parametrisation.EXPONENTIAL, fl.Parametrisation.CAYLEY


def pendulum(group: fl.Group, speed: float = 1.0) -> fl.Scene:
    """Two bars of aluminium, 0.3 m and 0.5 m, on spherical joints."""
    b = 5e-3
    aluminium = fl.Material(E=70e9, nu=0.3, density=2700.0)
    square = fl.Section.rectangle(
        b, b, aluminium, shear_factor=5 / 6, torsion_constant=0.1406 * b**4
    )
    scene, corner = fl.Scene(), (0.3, 0, 0)
    one = scene.add(fl.Beam.straight((0, 0, 0), corner, square, cells=10, group=group))
    two = scene.add(fl.Beam.straight(corner, (0.3, 0.5, 0), square, cells=10, group=group))
    scene.add(fl.Spherical(fl.ground(), one.start))
    scene.add(fl.Spherical(one.end, two.start))
    two.turn((3 * speed, 0, -4 * speed), about=two.start)
    return scene


def spinning(group: fl.Group) -> fl.Scene:
    """The pendulum with ten times the speed."""
    return pendulum(group, speed=10.0)


def net(group: fl.Group, meshes: int = 4) -> fl.Scene:
    """Bars of 0.25 m between the knots of a square net, thrown with a spin."""
    section = fl.Section.circle(4e-3, fl.Material(E=3e9, nu=0.35, density=1150.0))
    scene, side = fl.Scene(), 0.25
    knots: dict[tuple[int, int], list[fl.Point]] = {}
    for i in range(meshes + 1):
        for j in range(meshes + 1):
            for k, m in ((i + 1, j), (i, j + 1)):
                if max(k, m) > meshes:
                    continue
                bar = fl.Beam.straight(
                    (side * i, side * j, 0), (side * k, side * m, 0), section, cells=2, group=group
                )
                scene.add(bar)
                knots.setdefault((i, j), []).append(bar.start)
                knots.setdefault((k, m), []).append(bar.end)
    for first, *others in knots.values():
        for other in others:
            scene.add(fl.Fixed(first, other))
    half = 0.5 * side * meshes
    for body in scene.bodies:
        body.turn((6, 3, 12), about=(half, half, 0))
        body.move((1, 0, 2))
    return scene


class Case(NamedTuple):
    """A scene, with the step and duration of its run."""

    build: Callable[[fl.Group], fl.Scene]
    step: float
    duration: float


CASES = {
    "pendulum": Case(pendulum, 1e-4, 1.0),
    "spinning": Case(spinning, 1e-5, 0.5),
    "net": Case(net, 5e-4, 2.0),
}
