"""Which group for which body: errors at equal steps, iterations and factorisations.

Every scene on SE(3) and on R3 x SO(3), with the exponential and the Cayley map. Errors of position
and rotation are the largest over the run against a run with a sixteenth of the step; joint forces
against those of the same run, relative to the largest. Where beams are in a scene they stay on
SE(3), unless it says otherwise. The tables of docs/measured/groups.md are made here.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import fem_lie as fl
from demos.heavy_top import top

SE3 = fl.lie.Group.SE3
G = (0, 0, -9.81)


def slow_top(group: fl.lie.Group) -> fl.Scene:
    """The heavy top with 5 rad/s: it falls."""
    scene = fl.Scene(gravity=G)
    body = scene.add(fl.RigidBody(15.0, (0.234375, 0.46875, 0.234375), (0, 1, 0)).set_group(group))
    scene.add(fl.joints.Spherical(fl.ground(), body.point("centre"), at=(0, 0, 0)))
    body.add_velocity(omega=(0, 5, -4.61538), about=(0, 0, 0))
    return scene


def flight(group: fl.lie.Group) -> fl.Scene:
    """A body thrown with a spin about nearly its middle axis."""
    scene = fl.Scene(gravity=G)
    body = scene.add(fl.RigidBody(2.0, (0.1, 0.2, 0.25)).set_group(group))
    body.add_velocity((1, 2, 3))
    body.add_velocity(omega=(0.3, 6, 0.2), about=body.point("centre"))
    return scene


def double_pendulum(group: fl.lie.Group, spin: float = 0.0) -> fl.Scene:
    """Two rigid bars of 0.3 m and 0.5 m on spherical joints, falling from the horizontal."""
    scene, side = fl.Scene(gravity=G), 5e-3

    def bar(start: float, length: float) -> fl.RigidBody:
        mass = 2700 * side**2 * length
        along, across = mass * side**2 / 6, mass * (length**2 + side**2) / 12
        centre = (start + length / 2, 0, 0)
        return scene.add(fl.RigidBody(mass, (along, across, across), centre).set_group(group))

    one, two = bar(0.0, 0.3), bar(0.3, 0.5)
    scene.add(fl.joints.Spherical(fl.ground(), one.point("centre"), at=(0, 0, 0)))
    scene.add(fl.joints.Spherical(one.point("centre"), two.point("centre"), at=(0.3, 0, 0)))
    for body in (one, two):
        body.add_velocity(omega=(0, 0, 0.4 * spin), about=(0, 0, 0))
    two.add_velocity(omega=(0, 0, spin), about=(0.3, 0, 0))
    return scene


def spinning_pendulum(group: fl.lie.Group) -> fl.Scene:
    """The same, thrown across gravity with 8 and 28 rad/s."""
    return double_pendulum(group, 20.0)


def arm(group: fl.lie.Group, beams: fl.lie.Group = SE3) -> fl.Scene:
    """A soft arm on a hinge, 6 rad/s, with a body at its end."""
    section = fl.Section.rectangle(0.01, 0.02, fl.Material(2e9, 0.3, 1200))
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=6).set_group(beams))
    body = scene.add(fl.RigidBody(0.5, (1e-3, 2e-3, 2e-3), (1.05, 0, 0)).set_group(group))
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 0, 1)))
    scene.add(fl.joints.Fixed(beam.point("end"), body.point("centre"), at=(1, 0, 0)))
    for item in (beam, body):
        item.add_velocity(omega=(0, 0, 6), about=(0, 0, 0))
    return scene


def arm_apart(group: fl.lie.Group) -> fl.Scene:
    """The arm with its beam on the same group as the body."""
    return arm(group, group)


def rotor(group: fl.lie.Group) -> fl.Scene:
    """A rotor, 100 rad/s, at the end of a clamped shaft that a force bends."""
    section = fl.Section.rectangle(0.02, 0.02, fl.Material(2e11, 0.3, 7800))
    scene = fl.Scene()
    shaft = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=6))
    body = scene.add(fl.RigidBody(5.0, (0.1, 0.05, 0.05), (1, 0, 0)).set_group(group))
    scene.add(fl.Clamp(shaft.point("start")))
    scene.add(fl.joints.Revolute(shaft.point("end"), body.point("centre"), axis=(1, 0, 0)))
    body.add_velocity(omega=(100, 0, 0), about=body.point("centre"))
    scene.add(fl.PointLoad(body.point("centre"), force=(0, 50, 0)))
    return scene


class Case(NamedTuple):
    """A scene, with the step and duration of its run."""

    name: str
    build: Callable[[fl.lie.Group], fl.Scene]
    step: float
    duration: float


CASES = (
    Case("top, 150 rad/s", lambda group: top(group)[0], 1e-3, 0.2),
    Case("top, 5 rad/s", slow_top, 5e-3, 0.5),
    Case("free flight", flight, 1e-2, 0.5),
    Case("double pendulum", double_pendulum, 2e-3, 1.0),
    Case("the same, spinning", spinning_pendulum, 1e-3, 0.5),
    Case("body on an arm", arm, 2e-3, 0.5),
    Case("the same, beam too", arm_apart, 2e-3, 0.5),
    Case("rotor on a shaft", rotor, 5e-4, 0.1),
)


def run(
    case: Case, group: fl.lie.Group, parametrisation: fl.lie.Parametrisation, refined: int = 1
) -> fl.Result:
    """Integrate; ``refined``: into how many a step is cut."""
    scheme = fl.GeneralisedAlpha(
        parametrisation=parametrisation, tolerance=2e-8 if refined == 1 else 1e-10
    )
    step, duration = case.step / refined, case.duration
    return scheme.run(case.build(group), duration=duration, step=step, save_every=refined)


def main() -> None:
    print(
        "| scene | group | map | position, m | rotation | joint force | energy | it/step | fact. |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for case in CASES:
        fine = run(case, fl.lie.Group.R3xSO3, fl.lie.Parametrisation.EXPONENTIAL, refined=16)
        for group in fl.lie.Group:
            for parametrisation in fl.lie.Parametrisation:
                result = run(case, group, parametrisation)
                gap = np.abs(result.frames - fine.frames).max(axis=(0, 1, 3))
                force = np.abs(result.joint_forces - fine.joint_forces)[1:].max(initial=0.0)
                force /= max(np.abs(fine.joint_forces).max(initial=0.0), 1e-300)
                print(
                    f"| {case.name} | {group.name} | {parametrisation.name.lower()} "
                    f"| {gap[0]:.1e} | {gap[1:].max():.1e} | {force:.1e} "
                    f"| {result.energy_error:.0e} "
                    f"| {result.iterations[-1] / round(case.duration / case.step):.2f} "
                    f"| {result.factorisations} |"
                )


if __name__ == "__main__":
    main()
