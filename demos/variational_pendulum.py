"""The double pendulum by a variational integrator: exact momenta, and an energy without drift.

fem_lie.schemes.Variational makes a discrete action stationary. What that keeps is kept exactly:
here the angular momentum about the pivot. The energy is none of it. It goes up and down, with the
square of
the step, as long as the motion lasts, but goes nowhere: a line fitted to it over the whole run
rises by less than it goes up and down. The bars are those of double_pendulum.py, as are the cases.

--free is a free rigid body instead, that of time_error.py without forces.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from double_pendulum import STEP, pendulum

import fem_lie as fl

INERTIA = [
    [3783.42, 352.9, 484.74],
    [352.9, 3776.16, 469.74],
    [484.74, 469.74, 2630.94],
]


def free_body() -> fl.Scene:
    """A rigid body that flies and turns."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1000.0, INERTIA))
    body.velocities[:] = 10.0
    return scene


def main(
    case: int = 1,
    steps: int = 10_000,
    step: float | None = None,
    elements: int = 10,
    free: bool = False,
    tolerance: float = 0.0,
    pictures: bool = True,
) -> dict[str, Any]:
    if case not in STEP:
        raise ValueError(f"case must be 1, 2 or 3, got {case}")
    h = (1e-3 if free else STEP[case]) if step is None else step
    scene = free_body() if free else pendulum(case, elements)[0]
    every = max(1, steps // 500)
    scheme = fl.schemes.Variational(tolerance=tolerance)
    result = scheme.run(scene, duration=steps * h, step=h, save_every=every)
    energy = result.total_energy / result.total_energy[0] - 1.0
    slope, _ = np.polyfit(result.times, energy, 1)
    swing = float(np.ptp(energy))
    record: dict[str, Any] = {
        "case": "free" if free else case,
        "steps": steps,
        "step": h,
        "energy_error": float(np.abs(energy).max()),
        "energy_swing": swing,
        "energy_drift": float(abs(slope) * result.times[-1]),
        "angular_momentum_error": result.angular_momentum_error,
        "joint_gap": float(result.joint_violations.max(initial=0.0)),
        "iterations_per_step": float(result.iterations[-1] / steps),
        "factorisations": result.factorisations,
        "seconds": result.seconds,
        "ms_per_step": 1e3 * result.seconds / steps,
    }
    if pictures:
        name = in_results("variational_pendulum")
        result.plot_energies(f"{name}_energies.png")
        result.plot_momentum(f"{name}_momenta.png")
    return record


if __name__ == "__main__":
    run(main, show=True)
