"""A spatial slider-crank whose slider has Coulomb friction, exactly: by events.

The mechanism is that of demos/slider_crank.py with a flywheel on the crank and a rod without mass:
a drive without a function keeps the distance of its ends. Friction is a constant force whose factor
changes its sign when the slider turns back, at events. The flywheel carries the mechanism through
these points, so that the slider does not stick.

Reference: friction takes its force times the path of the slider. The energy that is left gives the
rate of the crank as a function of its angle, and a quadrature the time.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from scipy.integrate import quad

import fem_lie as fl

PIVOT, CRANK_END, SLIDER = np.array([[0, 0.1, 0.12], [0, 0.1, 0.2], [0.2, 0, 0]])
ROD, FLYWHEEL, MASS, FRICTION, SPEED = 0.3, 0.02, 2.0, 0.5, 6.0
CENTRES = np.arctan2(-0.1, 0.12) + np.pi * np.arange(1, 9)
"""Angles at which the slider turns back."""


def mechanism() -> tuple[fl.Scene, fl.joints.Revolute]:
    """The scene, and the hinge of the crank."""
    scene, ground = fl.Scene(gravity=(0, 0, -9.81)), fl.ground()
    crank = scene.add(fl.RigidBody(0.12, (FLYWHEEL, 0.01, 0.01), 0.5 * (PIVOT + CRANK_END)))
    slider = scene.add(fl.RigidBody(MASS, (1e-3, 1e-3, 1e-3), SLIDER))
    crank.add_velocity(omega=(SPEED, 0, 0), about=PIVOT)
    slider.add_velocity((slope(0.0) * SPEED, 0, 0))
    axle, centre = crank.point("centre"), slider.point("centre")
    hinge = scene.add(fl.joints.Revolute(ground, axle, at=PIVOT, axis=(1, 0, 0)))
    rail = scene.add(fl.joints.Prismatic(ground, centre, axis=(1, 0, 0)))
    rod = scene.add(fl.joints.Distance(crank.point(CRANK_END), centre))
    scene.add(fl.joints.Drive(rod.length))
    friction = scene.add(fl.PointLoad(centre, force=(-FRICTION, 0, 0)))
    for sign in (1, -1):
        turned = fl.schemes.Scale(friction, sign)
        scene.add(fl.schemes.Event(lambda s: s.rate(rail), turned, direction=sign, repeated=True))
    return scene, hinge


def position(angle: Any) -> Any:
    """Position of the slider."""
    side, height = 0.1 - 0.08 * np.sin(angle), 0.12 + 0.08 * np.cos(angle)
    return np.sqrt(ROD**2 - side**2 - height**2)


def slope(angle: float) -> float:
    """Derivative of the position by the angle."""
    return 0.08 * (0.1 * np.cos(angle) + 0.12 * np.sin(angle)) / position(angle)


def rate(angle: float) -> float:
    """Rate of the crank."""
    path = np.abs(np.diff(position(np.array([0, *CENTRES[CENTRES < angle], angle])))).sum()
    inertia = [FLYWHEEL + 0.12 * 0.04**2 + MASS * slope(a) ** 2 for a in (0.0, angle)]
    work = 0.12 * 9.81 * 0.04 * (1 - np.cos(angle)) - FRICTION * path
    return np.sqrt((inertia[0] * SPEED**2 + 2 * work) / inertia[1])


def main(step: float = 1e-3, duration: float = 2.0, pictures: bool = True) -> dict[str, Any]:
    """Largest error of the angle at eleven of its values, and the times of reversals."""
    scene, hinge = mechanism()
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=duration, step=step, save_every=10)
    angles, error = result.coordinate(hinge), 0.0
    for k in np.linspace(0, len(angles) - 1, 11).astype(int):
        within = CENTRES[CENTRES < angles[k]]
        time = quad(lambda a: 1 / rate(a), 0, angles[k], points=within, epsabs=1e-11, limit=200)[0]
        error = max(error, abs(time - result.times[k]) * rate(angles[k]))
    if pictures:
        result.picture(in_results("slider_crank_friction.png"), title="Slider-crank with friction")
    reversals = result.steps.event_times.tolist()
    return {"error": float(error), "reversals": reversals, "seconds": result.seconds}


if __name__ == "__main__":
    run(main, show=True)
