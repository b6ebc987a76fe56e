"""Flyball governor: two rods with heavy ends swing out from a turning axis and lift a slider.

IFToMM benchmark A05. The vertical axis turns freely; at its top, 0.05 m aside, two rods of 1 m are
hinged, with point masses of 5 kg at their ends. The middle of each rod is tied to a slider of 3 kg
on the axis by a stiff spring and damper, 8e5 N/m and 4e4 N s/m, 0.5 m long at rest. The rods start
60 degrees from the vertical; --speed is that of the axis at the start over 2 pi rad/s: 1, where the
rods swing out, or 0.16, where they fall.

Revolute joints of axis and rods, a prismatic one of the slider, and springs of two Distances. The
angular momentum about the axis must stay, though the axis is held: its bearing turns freely.
Reference: the reduced equations of s and theta, eight digits (the inertia of axis and rods is one
reading of the benchmark's sheet).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import fem_lie as fl

RESULTS = Path(__file__).parents[1] / "results"
ASIDE, START = 0.05, np.radians(60.0)

# t: height of the slider s, angle of the rods in degrees
REFERENCE = {
    1.0: {
        0.25: (0.622092722, 67.8039788),
        0.5: (0.743249425, 75.132239),
        0.75: (0.640396712, 68.9318096),
        1.0: (0.501420922, 60.1011542),
        2.0: (0.505909294, 60.397345),
        5.0: (0.535563104, 62.3333247),
        10.0: (0.619622917, 67.6504232),
    },
    0.16: {
        0.25: (0.289347352, 44.7138511),
        0.5: (0.0173517511, 10.7006256),
        0.75: (0.24806858, 41.2452672),
        1.0: (0.497094819, 59.8089457),
        2.0: (0.488474008, 59.2359184),
        5.0: (0.42989909, 55.2446517),
        10.0: (0.249165332, 41.3404878),
    },
}


def rod(scene: fl.Scene, side: float, axis: fl.RigidBody, slider: fl.RigidBody) -> fl.Revolute:
    """A rod with its mass, hinge and spring; returns the hinge, whose angle grows with theta."""
    m, end = 0.3, 5.0
    along = np.array([side * np.sin(START), 0, -np.cos(START)])
    hinge, middle = np.array([side * ASIDE, 0, 0]), np.array([side * ASIDE, 0, 0]) + 0.5 * along
    lever = (m * 0.5 + end * 1.0) / (m + end)
    length_wise = m / 3 * (2 * 0.005**2)
    across = m / 3 * (0.005**2 + 0.25) + m * (lever - 0.5) ** 2 + end * (1.0 - lever) ** 2
    axes = np.column_stack([along, (0, 1, 0), np.cross(along, (0, 1, 0))])
    body = scene.add(
        fl.RigidBody(m + end, (length_wise, across, across), hinge + lever * along, axes)
    )
    joint = scene.add(
        fl.Revolute(axis.centre, body.centre, at=hinge, axis=(0, -side, 0), name=f"hinge {side:+}")
    )
    bottom = slider.centre.position + np.array([side * ASIDE, 0, 0])
    distance = fl.Distance(body.centre, slider.centre, at=middle, to=bottom)
    scene.add(fl.Spring(distance.length, stiffness=8e5, damping=4e4, rest=0.5))
    return joint


def governor(speed: float) -> tuple[fl.Scene, fl.Revolute, fl.Prismatic]:
    """The scene, the hinge of one rod and the joint of the slider."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    axis = scene.add(fl.RigidBody(0.3, (0.025, 0.025, 5e-6), (0, 0, 0), name="axis"))
    slider = scene.add(fl.RigidBody(3.0, (0.005, 0.005, 0.005), (0, 0, -0.5), name="slider"))
    scene.add(fl.Revolute(fl.ground(), axis.centre, axis=(0, 0, 1), name="bearing"))
    guide = scene.add(
        fl.Prismatic(axis.centre, slider.centre, at=(0, 0, -0.5), axis=(0, 0, 1), name="guide")
    )
    hinges = [rod(scene, side, axis, slider) for side in (1.0, -1.0)]
    for body in scene.bodies:
        body.turn((0, 0, 2 * np.pi * speed), about=(0, 0, 0))
    return scene, hinges[0], guide


def main(
    speed: float = 1.0, step: float = 5e-4, duration: float = 1.0, pictures: bool = True
) -> dict[str, Any]:
    if speed not in REFERENCE:
        raise ValueError(f"speed must be 1 or 0.16, got {speed}")
    scene, hinge, guide = governor(speed)
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)
    result = scheme.run(scene, duration=duration, step=step)
    s = 0.5 + result.coordinate(guide)
    theta = 60.0 + np.degrees(result.coordinate(hinge))
    print("   t [s]       s [m]   theta [deg]   (and their errors)")
    errors = []
    for t, reference in REFERENCE[speed].items():
        if t <= duration:
            row = result.index(t)
            errors.append(np.abs([s[row] - reference[0], theta[row] - reference[1]]))
            print(f"{t:8} {s[row]:11.8f} {theta[row]:13.7f}   {errors[-1]}")
    momentum = result.angular_momentum[:, 2]
    record = {
        "speed": speed,
        "step": step,
        "s_error": float(np.max(errors, axis=0)[0]) if errors else float("nan"),
        "theta_error": float(np.max(errors, axis=0)[1]) if errors else float("nan"),
        "momentum_error": float(np.abs(momentum / momentum[0] - 1).max()),
        "violation": float(result.joint_violations.max()),
        "iterations_per_step": float(result.iterations[-1] / (len(result.times) - 1)),
        "seconds": result.seconds,
    }
    print(f"angular momentum about the axis to {record['momentum_error']:.1e}")
    if pictures:
        RESULTS.mkdir(exist_ok=True)
        file = RESULTS / "governor.png"
        result.picture(file, title="Flyball governor")
        print(f"picture: {file}")
    return record


if __name__ == "__main__":
    from command_line import run

    run(main)
