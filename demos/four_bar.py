"""Flexible four-bar mechanism whose last axis is tilted by 5 degrees.

IFToMM benchmark (O. A. Bauchau et al., Multibody Syst. Dyn. 37 (2016) 29). Three steel bars AB, BC,
CD, at first a rectangle 0.24 m x 0.12 m in the x-z plane, are hinged about y to each other and to
the ground at A and D; the axis at C is turned by 5 degrees about the vertical. Bar AB is driven
with 0.6 rad/s. With parallel axes the parallelogram would move freely; with the defect the bars
must bend and twist at every angle but one, and where it is flat (90 degrees) the mechanism goes
over to the crossed branch, and back at 270 degrees.

Bars AB and BC 16 mm, CD 8 mm square. The speed is taken up smoothly within --ramp seconds; results
are compared at equal angles of the drive, for the motion is quasi-static. Reference: Exudyn 1.13.6,
two-node geometrically exact beams, extrapolated; positions to 5e-7 m, forces to 2e-4 of their
largest, next to the change of the branch 1 % for N.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from records import of_motion
from reference.tables import table

import fem_lie as fl

A, B, C, D = np.array([[0, 0, 0], [0, 0, 0.12], [0.24, 0, 0.12], [0.24, 0, 0]])
SPEED, DEFECT = 0.6, np.radians(5.0)
THICK = ([5.2992e7, 1.68803e7, 1.68803e7, 733.488, 1130.5, 1130.5], 1.9968, 4.25984e-5)
THIN = ([1.3248e7, 4.22008e6, 4.22008e6, 45.843, 70.656, 70.656], 0.4992, 2.6624e-6)

REFERENCE = table("four_bar")
PEAKS = np.array([433.4, 44.2, 715.2, 63.9, 119.1, 2.67])


def bar(start: Any, end: Any, cells: int, of: Any, name: str) -> fl.Beam:
    """A bar with its third axis along +y."""
    stiffness, mass, inertia = of
    section = fl.Section.from_stiffness(stiffness, mass=mass, polar=2 * inertia)
    return fl.Beam.straight(start, end, section, cells=cells, up=(0, 1, 0), name=name)


def mechanism(cells: int, ramp: float) -> tuple[fl.Scene, fl.Beam, fl.joints.Revolute]:
    """The scene, bar AB and the joint at D."""
    scene = fl.Scene()
    one = scene.add(bar(A, B, cells, THICK, "AB"))
    two = scene.add(bar(B, C, cells, THICK, "BC"))
    three = scene.add(bar(C, D, cells, THIN, "CD"))
    y, tilted = (0, 1, 0), (-np.sin(DEFECT), np.cos(DEFECT), 0)
    drive = scene.add(fl.joints.Revolute(fl.ground(), one.point("start"), axis=y, name="A"))
    scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=y, name="B"))
    scene.add(fl.joints.Revolute(two.point("end"), three.point("start"), axis=tilted, name="C"))
    last = scene.add(fl.joints.Revolute(fl.ground(), three.point("end"), axis=y, name="D"))

    def angle(t: float) -> float:
        s = min(t / ramp, 1.0)
        return SPEED * (ramp * s**4 * (2.5 - 3 * s + s**2) + max(t - ramp, 0.0))

    scene.add(fl.joints.Drive(drive.angle, angle, name="motor"))
    return scene, one, last


def main(
    elements: int = 9,
    step: float = 4e-3,
    duration: float = 12.0,
    ramp: float = 0.48,
    pictures: bool = True,
) -> dict[str, Any]:
    if elements % 2 == 0:
        raise ValueError(f"elements must be odd, for the section in the middle, got {elements}")
    scene, one, last = mechanism(elements, ramp)
    steps = round((duration + ramp / 2) / step)
    result = fl.GeneralisedAlpha(radius=0.5).run(scene, duration=steps * step, step=step)
    forces = fl.post.section_forces(result, one, scene)
    values = np.column_stack(
        [
            result.position("AB.end"),
            result.position("BC.end"),
            [forces.at_points(k)[elements // 2, 0] for k in range(steps + 1)],
            result.coordinate(last),
        ]
    )
    times = result.times - ramp / 2
    reference = REFERENCE[REFERENCE[:, 0] <= duration]
    ours = np.array([np.interp(reference[:, 0], times, column) for column in values.T]).T
    error = np.abs(ours - reference[:, 1:])
    if pictures:
        file = in_results("four_bar.png")
        result.picture(file, trace=["BC.end"], title="Four-bar mechanism with a tilted axis")
    return {
        "elements": elements,
        "step": step,
        "position_error": float(error[:, :6].max()),
        "force_error": float((error[:, 6:12] / PEAKS).max()),
        "angle_error": float(error[:, 12].max()),
        "motor_moment": float(np.abs(result.joint_force("motor")[:, 5]).max()),
        "violation": float(result.joint_violations.max()),
        **of_motion(result, steps),
        "factorisations": result.factorisations,
    }


if __name__ == "__main__":
    run(main, show=True)
