"""Every joint between two free bodies under the energy-momentum scheme.

Two bodies of different inertia, out of balance, tumble together and then move against each other as
far as their joint lets them. Energy, momenta and the joint are to be kept to round-off.

    python3 -m benchmarks.conserving_joints --steps 10000
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np

import fem_lie as fl

X, Y, Z = np.eye(3)

Maker = Callable[[fl.extend.Point, fl.extend.Point], fl.joints.Joint]

JOINTS: dict[str, Maker] = {
    "fixed": lambda a, b: fl.joints.Fixed(a, b, at=(0, 0, 0)),
    "spherical": lambda a, b: fl.joints.Spherical(a, b, at=(0, 0, 0)),
    "revolute": lambda a, b: fl.joints.Revolute(a, b, at=(0, 0, 0), axis=Y),
    "universal": lambda a, b: fl.joints.Universal(a, b, at=(0, 0, 0), axis=Y, second=Z),
    "prismatic": lambda a, b: fl.joints.Prismatic(a, b, at=(0, 0, 0), axis=X),
    "cylindrical": lambda a, b: fl.joints.Cylindrical(a, b, at=(0, 0, 0), axis=X),
    "planar": lambda a, b: fl.joints.Planar(a, b, at=(0, 0, 0), axis=Z),
    "screw": lambda a, b: fl.joints.Screw(a, b, at=(0, 0, 0), axis=X, pitch=0.3),
    "in plane": lambda a, b: fl.joints.InPlane(a, b, at=(0, 0, 0), axis=Z),
    "distance": lambda a, b: fl.joints.Distance(a, b),
}


def two_bodies(kind: str, *, spring: float = 0.0) -> tuple[fl.Scene, fl.joints.Joint]:
    """Two free bodies on a joint of :data:`JOINTS`; the spring is along its first coordinate."""
    scene = fl.Scene()
    one = scene.add(fl.RigidBody(2.0, (0.1, 0.25, 0.3), (-0.4, 0.1, 0.0)))
    two = scene.add(fl.RigidBody(1.0, (0.08, 0.05, 0.11), (0.5, 0.0, 0.2)))
    joint = scene.add(JOINTS[kind](one.point("centre"), two.point("centre")))
    if spring:
        scene.add(fl.joints.Spring(joint.coordinates()[0], stiffness=spring))
    for body in (one, two):
        body.add_velocity(omega=(1.5, 2.0, 0.7), about=(0.0, 0.3, 0.0))
        body.add_velocity((0.3, -0.2, 0.1))
    return scene, joint


def errors(kind: str, *, steps: int, step: float = 1e-3, spring: float = 0.0) -> dict[str, float]:
    """Relative errors of the invariants, and the largest violation of the joint."""
    scene, joint = two_bodies(kind, spring=spring)
    result = fl.EnergyMomentum().run(scene, duration=steps * step, step=step)
    moved = np.ptp(
        result.position(scene.bodies[0].point("centre"))
        - result.position(scene.bodies[1].point("centre"))
    )
    return {
        "energy_error": result.energy_error,
        "angular_momentum_error": result.angular_momentum_error,
        "violation": float(np.abs(result.joint_violation(joint)).max()),
        "moved": float(moved),
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=10_000)
    steps = parser.parse_args().steps
    print("| joint | energy | angular momentum | violation |\n|---|---|---|---|")
    for kind in JOINTS:
        e = errors(kind, steps=steps)
        numbers = " | ".join(f"{e[k]:.1e}" for k in list(e)[:3])
        print(f"| {kind} | {numbers} |", flush=True)


if __name__ == "__main__":
    main()
