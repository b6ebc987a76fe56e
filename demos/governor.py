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

The dampers take up the load within m/c = 1e-4 s of the start. Steps of --step that jump over that
leave an error that is proportional to h and stays (7e-8 m after 10 s in what is extrapolated from
1e-3 and 5e-4 s), so that the error has no expansion in h. Variable steps find that moment: they
start with 8e-6 s and have the size --step after 0.02 s. Of such runs with --step, half of it and
so on the limit is extrapolated.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, one_of, run
from extrapolation import extrapolated, largest_errors, order
from records import of_motion
from reference.tables import table

import fem_lie as fl

ASIDE, START, X = 0.05, np.radians(60.0), np.array([1, 0, 0])
COLUMNS = {1.0: (0, 1, 2), 0.16: (0, 3, 4)}
"""Columns of the reference for each speed: t, height of the slider, angle of the rods (degrees)."""
REFERENCE = table("governor")
FINER, TOLERANCE = 128, 0.1
"""First step over --step, and tolerance of the first milliseconds, m/s over --step."""


def rod(scene: fl.Scene, side: float, axis: fl.extend.Point, slider: fl.extend.Point) -> None:
    """A rod with its mass, hinge and spring."""
    m, end, y = 0.3, 5.0, np.array([0, 1, 0])
    hinge, along = side * ASIDE * X, np.array([side * np.sin(START), 0, -np.cos(START)])
    lever = (m * 0.5 + end * 1.0) / (m + end)
    across = m / 3 * (0.005**2 + 0.25) + m * (lever - 0.5) ** 2 + end * (1.0 - lever) ** 2
    inertia = (m / 3 * (2 * 0.005**2), across, across)
    axes = np.column_stack([along, y, np.cross(along, y)])
    body = fl.RigidBody(m + end, inertia, hinge + lever * along, axes, name=f"rod {side:+.0f}")
    scene.add(body)
    scene.add(fl.joints.Revolute(axis, body.point("centre"), at=hinge, axis=(0, -side, 0)))
    middle, bottom = hinge + 0.5 * along, slider.position + hinge
    distance = fl.joints.Distance(body.point("centre"), slider, at=middle, to=bottom)
    scene.add(fl.joints.Spring(distance.length, stiffness=8e5, damping=4e4, rest=0.5))


def governor(speed: float) -> fl.Scene:
    """The scene; the bodies are called axis, slider, rod +1 and rod -1."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    axis = scene.add(fl.RigidBody(0.3, (0.025, 0.025, 5e-6), (0, 0, 0), name="axis"))
    slider = scene.add(fl.RigidBody(3.0, (0.005, 0.005, 0.005), (0, 0, -0.5), name="slider"))
    middle, bead = axis.point("centre"), slider.point("centre")
    scene.add(fl.joints.Revolute(fl.ground(), middle, axis=(0, 0, 1), name="bearing"))
    scene.add(fl.joints.Prismatic(middle, bead, at=(0, 0, -0.5), axis=(0, 0, 1), name="guide"))
    for side in (1.0, -1.0):
        rod(scene, side, middle, bead)
    for body in scene.bodies:
        body.add_velocity(omega=(0, 0, 2 * np.pi * speed), about=(0, 0, 0))
    return scene


def motion(result: fl.Result, times: Any) -> Any:
    """Height of the slider above its lowest position, angle of a rod in degrees, shape (T, 2)."""
    there = result.resampled(times)
    along = there.rotation("rod +1.centre")[:, :, 0]
    theta = np.degrees(np.arctan2(np.hypot(along[:, 0], along[:, 1]), -along[:, 2]))
    return np.column_stack([1.0 + there.position("slider.centre")[:, 2], theta])


def main(
    speed: float = 1.0,
    step: float = 1e-3,
    runs: int = 2,
    duration: float = 10.0,
    pictures: bool = True,
) -> dict[str, Any]:
    """``runs``: with step, step/2 and so on."""
    one_of("speed", speed, COLUMNS)
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-9)
    reference = REFERENCE[:, COLUMNS[speed]]
    reference = reference[(reference[:, 0] > 0) & (reference[:, 0] <= duration)]
    results = []
    for h in (step / 2**k for k in range(runs)):
        variable = fl.schemes.AdaptiveStep(TOLERANCE * h, first=h / FINER, largest=h)
        result = scheme.run(governor(speed), duration=duration, step=variable)
        results.append(motion(result, reference[:, 0]))
    errors, limit = largest_errors(results, reference[:, 1:])
    momentum, steps = result.angular_momentum[:, 2], len(result.times) - 1
    if pictures:
        result.picture(in_results("governor.png"), title="Flyball governor")
    return {
        "speed": speed,
        "step": step,
        "order": order(results),
        "s_errors": errors[:, 0].tolist(),
        "theta_errors": errors[:, 1].tolist(),
        "s_extrapolated": float(limit[0]),
        "theta_extrapolated": float(limit[1]),
        "s": float(extrapolated(results)[-1, 0]),
        "momentum_error": float(np.abs(momentum / momentum[0] - 1).max()),
        "violation": float(result.joint_violations.max()),
        "steps": steps,
        **of_motion(result, steps),
    }


if __name__ == "__main__":
    run(main, show=True)
