"""Energy of a ball after an impact that lasts few steps, over that before, for phases of the step.

A free ball of 1 kg meets a penalty of 1e6 N/m at 100 m/s, and is in contact for π ms.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

import fem_lie as fl
from demos.command_line import run

SCHEMES = {
    "GeneralisedAlpha": fl.GeneralisedAlpha(radius=0.8),
    "Variational": fl.schemes.Variational(),
    "Explicit": fl.Explicit(),
    "EnergyMomentum": fl.EnergyMomentum(),
}
SPEED, RADIUS = 100.0, 0.1


def energy(scheme: Any, steps: int, phase: float) -> float:
    """Of a ball after an impact of so many steps, which begins at a part of one."""
    h = 1e-3 * np.pi / steps
    ball = fl.RigidBody(1.0, (1e-2,) * 3, position=(0, 0, RADIUS + (2.0 + phase) * h * SPEED))
    ball.add_velocity((0, 0, -SPEED))
    scene, plane = fl.Scene(), fl.contact.Plane(fl.ground(), (0, 0, 1))
    scene.add(ball)
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), RADIUS), plane, fl.contact.Penalty(1e6)
        )
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fl.contact.UnresolvedContactWarning)
        result = scheme.run(scene, duration=(10 + 2 * steps) * h, step=h, progress=False)
    return float((result.velocity(ball.point("centre"))[-1, 2] / SPEED) ** 2)


def main(phases: int = 13) -> dict[str, Any]:
    """The least and the largest, by scheme and steps in contact."""
    rows = {}
    for name, scheme in SCHEMES.items():
        for steps in (1, 2, 3, 4, 6, 8, 12, 20):
            found = [energy(scheme, steps, part) for part in np.linspace(0.02, 0.98, phases)]
            rows[f"{name}, {steps} steps"] = {"least": min(found), "largest": max(found)}
    return {"rows": rows}


if __name__ == "__main__":
    run(main, show=True)
