"""Prescribed rotations of 10° to 1080° about any axis in statics, against closed forms and drives.

    python -m benchmarks.prescribed_turns [case ...]

Free bodies must rotate as rigid ones. The moment of a shaft that is clamped at its other end must
be ``GJ/L`` times the prescribed angle. Two torsion springs in series with a rigid body between them
must divide it. A solid bar must be twisted as by a driven joint. Errors are the largest difference
of frames, with translations over the size of the model, or relative errors of moments.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

import fem_lie as fl
from fem_lie import lie

Vector: TypeAlias = tuple[float, float, float]
Array: TypeAlias = NDArray[np.float64]

ANGLES = (10, 45, 80, 100, 120, 180, 270, 359, 360, 540, 720, 1080)
AXES: tuple[Vector, ...] = ((1, 0, 0), (0, 0, 1), (1, -2, 3))

MATERIAL = fl.Material(1.2e6, 0.25, 1.0)
SECTION = fl.Section.rectangle(0.3, 0.2, MATERIAL)
LAYER = fl.ShellSection.layer(0.1, MATERIAL)
SHAFT = fl.Section.from_stiffness(np.diag([1e4, 1e4, 1e4, 10.0, 1e2, 1e2]))
"""Soft in torsion: it does not buckle when it is twisted by three turns."""


def turned(point: fl.extend.Point, axis: Vector, degrees: float) -> fl.PrescribedMotion:
    """The point's frame rotates about an axis through itself, in proportion to time."""
    start, angle = point.frame.copy(), np.radians(degrees) * np.asarray(axis, dtype=np.float64)
    angle /= np.linalg.norm(axis)

    def motion(t: float) -> Array:
        return np.vstack([start[:1], start[1:] @ lie.so3_exp(t * angle).T])

    return fl.PrescribedMotion(point, motion)


def driven(scene: fl.Scene, point: fl.extend.Point, axis: Vector, degrees: float) -> None:
    """The same by a joint with the ground and a drive."""
    hinge = scene.add(fl.joints.Revolute(fl.ground(), point, axis=axis))
    scene.add(fl.joints.Drive(hinge.angle, lambda t: t * np.radians(degrees)))


def beam() -> tuple[fl.extend.Body, fl.extend.Point]:
    """By its end."""
    body = fl.Beam.straight((0, 0, 0), (4, 0, 0), SECTION, cells=8)
    return body, body.point("end")


def position() -> tuple[fl.extend.Body, fl.extend.Point]:
    """A beam by an attachment frame within an element."""
    body = fl.Beam.straight((0, 0, 0), (4, 0, 0), SECTION, cells=3)
    return body, body.point((1.7, 0, 0))


def rod() -> tuple[fl.extend.Body, fl.extend.Point]:
    """By its end."""
    body = fl.Rod.straight((0, 0, 0), (4, 0, 0), SECTION, cells=8)
    return body, body.point("end")


def ancf() -> tuple[fl.extend.Body, fl.extend.Point]:
    """By an attachment frame at its end."""
    body = fl.AncfBeam.straight((0, 0, 0), (4, 0, 0), SECTION, cells=4)
    return body, body.point("end")


def shell() -> tuple[fl.extend.Body, fl.extend.Point]:
    """By a corner."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (2 * a, b, 0.0), (4, 2))
    body = fl.Shell(mesh, LAYER)
    return body, body.point("00")


def solid() -> tuple[fl.extend.Body, fl.extend.Point]:
    """By the attachment frame of a face."""
    body = fl.Solid.brick(
        (2.0, 0.5, 0.5), fl.sections.SaintVenantKirchhoff(1e4, 0.3, 1.0), cells=(4, 1, 1)
    )
    return body, body.point("a=0")


def rigid() -> tuple[fl.extend.Body, fl.extend.Point]:
    """By its centre."""
    body = fl.RigidBody(1.0, (1, 1, 1), position=(0.3, 0.2, 0.1))
    return body, body.point("centre")


FREE = {"beam": beam, "place": position, "rod": rod, "ancf": ancf, "shell": shell, "solid": solid}
FREE["rigid"] = rigid


def free(
    make: Callable[[], tuple[fl.extend.Body, fl.extend.Point]], axis: Vector, degrees: float
) -> float:
    """Error of a body that nothing else holds."""
    scene, (body, point) = fl.Scene(), make()
    scene.add(body)
    scene.add(turned(point, axis, degrees))
    found, start = fl.statics(scene), point.position
    R = lie.so3_exp(np.radians(degrees) * np.asarray(axis) / np.linalg.norm(axis))
    before, after = found.info.undeformed, found.frames[-1]
    size = np.ptp(before[:, 0], axis=0).max() or 1.0
    positions = start + (before[:, 0] - start) @ R.T
    error = np.abs(after[:, 0] - positions).max() / size
    attached = found.rotation(point)[-1] - R @ np.asarray(point.frame[1:]).T
    return float(max(error, np.abs(attached).max()))


def shaft(kind: type[fl.Beam] | type[fl.Rod], degrees: float) -> float:
    """Relative error of the moment of a shaft that is clamped at one end, twisted at the other."""
    scene = fl.Scene()
    body = scene.add(kind.straight((0, 0, 0), (4, 0, 0), SHAFT, cells=16))
    held = scene.add(fl.Clamp(body.point("start")))
    scene.add(turned(body.point("end"), (1, 0, 0), degrees))
    moment = -fl.statics(scene).reaction(held)[-1][3]
    return float(abs(moment / (np.radians(degrees) * SHAFT.stiffness[3, 3] / 4) - 1.0))


def springs(axis: Vector, degrees: float) -> float:
    """Relative error of the moment of two torsion springs in series, through a rigid body."""
    scene = fl.Scene()
    first, second = (scene.add(fl.RigidBody(1.0, (1, 1, 1))) for _ in range(2))
    grounded = scene.add(fl.joints.Revolute(fl.ground(), first.point("centre"), axis=axis))
    between = scene.add(
        fl.joints.Revolute(first.point("centre"), second.point("centre"), axis=axis)
    )
    scene.add(fl.joints.Spring(grounded.angle, stiffness=2.0))
    spring = scene.add(fl.joints.Spring(between.angle, stiffness=3.0))
    scene.redundant = fl.joints.RedundantConstraints.MINIMUM_NORM
    scene.add(turned(second.point("centre"), axis, degrees))
    moment = np.linalg.norm(fl.statics(scene).joint_force(spring)[-1][3:])
    return float(abs(moment / (1.2 * np.radians(degrees)) - 1.0))


def bar(degrees: float) -> float:
    """Difference of a solid bar that is twisted by a prescribed motion and by a driven joint."""
    found = []
    for by_joint in (False, True):
        scene = fl.Scene()
        material = fl.sections.SaintVenantKirchhoff(1e4, 0.0, 1.0)
        body = scene.add(fl.Solid.brick((8.0, 0.2, 0.2), material, cells=(16, 1, 1)))
        body.clamp("a=0")
        end = body.point("a=1")
        if by_joint:
            driven(scene, end, (1, 0, 0), degrees)
        else:
            scene.add(turned(end, (1, 0, 0), degrees))
        found.append(fl.statics(scene, newton=fl.schemes.Newton(tolerance=1e-12)).frames[-1])
    return float(np.abs(found[0][:, 0] - found[1][:, 0]).max() / 8.0)


def cases() -> Iterator[tuple[str, float, Callable[[], float]]]:
    """Name, degrees, and what gives the error."""
    for degrees in ANGLES:
        for axis in AXES:
            for name, make in FREE.items():
                yield (
                    f"{name} about {axis}",
                    degrees,
                    lambda m=make, a=axis, d=degrees: free(m, a, d),
                )
            yield f"springs about {axis}", degrees, lambda a=axis, d=degrees: springs(a, d)
        yield "shaft Beam", degrees, lambda d=degrees: shaft(fl.Beam, d)
        yield "shaft Rod", degrees, lambda d=degrees: shaft(fl.Rod, d)
        yield "bar", degrees, lambda d=degrees: bar(d)


def main() -> None:
    """Print the largest error of each case."""
    wanted, worst = sys.argv[1:], dict[str, tuple[float, float]]()
    start = time.perf_counter()
    for name, degrees, error in cases():
        if not wanted or name.split()[0] in wanted:
            worst[name] = max(worst.get(name, (0.0, 0.0)), (error(), degrees))
    for name, (error, degrees) in worst.items():
        print(f"{name:24} {error:9.1e}  at {degrees:g}°")
    print(f"{time.perf_counter() - start:.0f} s")


if __name__ == "__main__":
    main()
