"""A mass on a belt sticks and slips: Coulomb friction with a higher coefficient at rest.

A spring holds a mass on a belt of constant speed v. While the mass sticks, a drive without a
function holds it on the belt; it is released where the force of the spring reaches μₛ m g. Then
friction μ m g pulls the mass along the belt, until its velocity is again that of the belt, and the
drive locks it. Both are events. What is lost at these is nothing, as the velocities are equal.

Reference, in closed form: with a = (μₛ − μ) m g / k and ω² = k/m the mass sticks for 2 a/v, and
slips for (2π − 2 arctan(a ω/v))/ω, as both ends of the slip are at a velocity v, at a and −a from
the position where the spring balances friction.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run
from diagrams import COLOURS, diagram

import fem_lie as fl

MASS, STIFFNESS, SPEED, GRAVITY = 1.0, 100.0, 0.1, 9.81
AT_REST, SLIDING = 0.4, 0.3
LONGEST = AT_REST * MASS * GRAVITY / STIFFNESS  # elongation of the spring where the mass slips


def mass_on_belt() -> tuple[fl.Scene, fl.RigidBody]:
    """The scene, and the mass, which sticks at the start."""
    scene, inertia = fl.Scene(gravity=(0, 0, -GRAVITY)), (0.1, 0.1, 0.1)
    belt, mass = (scene.add(fl.RigidBody(MASS, inertia, name=name)) for name in ("belt", "mass"))
    for body in (belt, mass):
        body.add_velocity((SPEED, 0, 0))
    on, centre = belt.point("centre"), mass.point("centre")
    frame = np.vstack([np.zeros(3), np.eye(3)])
    along = np.vstack([(SPEED, 0, 0), np.zeros((3, 3))])
    scene.add(fl.PrescribedMotion(on, lambda t: frame + t * along))
    slide = scene.add(fl.joints.Prismatic(on, centre, axis=(1, 0, 0)))
    stick = scene.add(fl.joints.Drive(slide.displacement))
    spring = scene.add(fl.joints.Distance(fl.ground(), centre, at=(-1, 0, 0)))
    scene.add(fl.joints.Spring(spring.length, STIFFNESS))
    friction = scene.add(fl.PointLoad(centre, force=(SLIDING * MASS * GRAVITY, 0, 0)))
    slips = fl.schemes.Release(stick), fl.schemes.Scale(friction, 1.0, initial=0.0)
    sticks = fl.schemes.Lock(stick), fl.schemes.Scale(friction, 0.0)
    when = {"direction": 1, "repeated": True}
    scene.add(fl.schemes.Event(lambda s: s.coordinate(spring) - 1 - LONGEST, slips, **when))
    scene.add(fl.schemes.Event(lambda s: s.rate(slide), sticks, **when))
    return scene, mass


def main(step: float = 1e-3, duration: float = 4.0, pictures: bool = True) -> dict[str, Any]:
    """Periods and durations of slips, and their largest errors relative to the period."""
    scene, mass = mass_on_belt()
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=duration, step=step)
    times, numbers = result.steps.event_times, result.steps.event_numbers
    start, end = times[numbers == 0], times[numbers == 1]
    a, rate = (AT_REST - SLIDING) * MASS * GRAVITY / STIFFNESS, np.sqrt(STIFFNESS / MASS)
    slip = (2 * np.pi - 2 * np.arctan(a * rate / SPEED)) / rate
    period = 2 * a / SPEED + slip
    if pictures:
        with diagram("stick_slip.png") as axes:
            axes.plot(result.times, result.position(mass.point("centre"))[:, 0], color=COLOURS[0])
            axes.set(xlabel="time in s", ylabel="position in m", title="A mass on a belt")
    return {
        "period": period,
        "period_error": float(np.abs(np.diff(start) / period - 1).max()),
        "slip_error": float(np.abs(end - start[: len(end)] - slip).max() / period),
        "periods": len(start) - 1,
        "lost": float(np.abs(result.steps.event_losses).max()),
    }


if __name__ == "__main__":
    run(main, show=True)
