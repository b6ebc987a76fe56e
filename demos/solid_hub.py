"""A solid hub turns on a pivot and carries two beams and a cable with a weight, all by joints.

The hub is a block of hard rubber, 0.2 x 0.2 x 0.05, of quadratic bricks. Joints are
attached to its faces by averaging attachments: their frame has the weighted mean position and
the rotation nearest to the mean deformation. A revolute joint holds its lower face to the
ground, two beams of 0.5 are fixed to two sides, and a cable of 0.4 hangs on a third by a
spherical joint, with a point mass at its end. All turn at 10 rad/s at the start, without stress,
and nothing drives them.

What the joints do to the hub has to be its change of momentum. Generalised-alpha has, with the
forces F of the joints on the hub and its momentum P at successive steps 0, 1 and 2,

    (1 - am)(P2 - P1) + am (P1 - P0)
        = h (g ((1 - af) F2 + af F1) + (1 - g)((1 - af) F1 + af F0))

exactly: the algorithmic accelerations are eliminated, inner forces cancel, and the mass matrix
is constant. force_balance is the largest difference of both sides over h and the largest force of a
joint, from the second step on: accelerations at the start leave out what a step does not resolve.
spin_error is the change of the angular momentum about the pivot's axis, which no force has,
relative; energy_error that of the energy.

The hub's nodes have axes that follow it; --fixed-axes writes the equations along fixed ones. What
makes matrices stale here is the cable, though, whose stiffness across is its tension.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from reference.impulse import balance

import fem_lie as fl

SIZE = np.array([0.2, 0.2, 0.05])
RUBBER = fl.sections.NeoHooke(5e6, 0.45, 1200.0)
SPIN, RADIUS = 10.0, 0.8


def hub(cells: int) -> fl.Solid:
    """About the z axis."""
    origin = -0.5 * SIZE
    return fl.Solid.brick(
        SIZE, RUBBER, cells=(cells, cells, 1), origin=origin, degree=2, name="hub"
    )


def model(cells: int, elements: int) -> tuple[fl.Scene, fl.Solid, list[fl.joints.Joint]]:
    """The scene, the hub, and the joints, whose first point is on the hub."""
    scene, body = fl.Scene(), hub(cells)
    half = 0.5 * SIZE[0]
    rod = fl.Section.from_stiffness([2e5, 8e4, 8e4, 8, 10, 10], mass=0.8, rotary=(4e-5, 4e-5))
    left = fl.Beam.straight((-half, 0, 0), (-half - 0.5, 0, 0), rod, cells=elements, name="left")
    right = fl.Beam.straight((half, 0, 0), (half + 0.5, 0, 0), rod, cells=elements, name="right")
    wire = fl.Section.from_stiffness([1e4, 1, 1, 1e-3, 1e-3, 1e-3], mass=0.1)
    cable = fl.Cable.straight((0, half, 0), (0, half + 0.4, 0), wire, cells=elements, name="cable")
    weight = fl.RigidBody(0.2, (1e-5,) * 3, position=(0, half + 0.4, 0), name="weight")
    for part in (body, left, right, cable, weight):
        scene.add(part)
        part.add_velocity(omega=(0, 0, SPIN), about=(0, 0, 0))
    joints = [
        fl.joints.Revolute(body.point("c=0"), fl.ground(), at=(0, 0, origin_of(body))),
        fl.joints.Fixed(body.point("a=0"), left.point("start")),
        fl.joints.Fixed(body.point("a=1"), right.point("start")),
        fl.joints.Spherical(body.point("b=1"), cable.point("start")),
    ]
    for joint in joints:
        scene.add(joint)
    scene.add(fl.joints.Spherical(cable.point("end"), weight.point("centre")))
    return scene, body, joints


def origin_of(body: fl.Solid) -> float:
    """Height of its lower face."""
    return float(body.model.positions[:, 2].min())


def main(
    cells: int = 2,
    elements: int = 4,
    duration: float = 0.3,
    step: float = 5e-4,
    fixed_axes: bool = False,
    pictures: bool = True,
) -> dict[str, Any]:
    scene, body, joints = model(cells, elements)
    components = fl.schemes.MatrixFrame.INERTIAL if fixed_axes else fl.schemes.MatrixFrame.LOCAL
    scheme = fl.GeneralisedAlpha(radius=RADIUS, tolerance=5e-13, matrix_frame=components)
    result = scheme.run(scene, duration=duration, step=step)
    spin = result.angular_momentum[:, 2]
    record = {
        "nodes": len(body.frames),
        "steps": len(result.times) - 1,
        "factorisations": result.factorisations,
        "refreshed_borders": result.phi_updates,
        "iterations": int(result.iterations[-1]),
        "force_balance": balance(result, body, joints, step, RUBBER.density, RADIUS),
        "spin_error": float(np.abs(spin / spin[0] - 1).max()),
        "energy_error": float(result.energy_error),
        "violation": float(np.abs(result.joint_violations).max()),
        "seconds": result.seconds,
    }
    if pictures:
        result.picture(in_results("solid_hub.png"))
        stresses = fl.post.solid_stresses(result, body)
        stresses.picture(in_results("solid_hub_stress.png"), title="von Mises stress of the hub")
    return record


if __name__ == "__main__":
    run(main, show=True)
