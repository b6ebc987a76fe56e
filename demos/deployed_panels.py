"""Two folded panels are released at 1 s, unfold by torsion springs, and latch.

Each panel has 5 kg and 1 m and is hinged at its edge, with springs of 0.5 N m/rad that are relaxed
at 108 degrees (first panel) and 200 degrees (second panel, folded back onto the first). Drives
without a function hold the panels down until an event releases them. Two more drives are latches:
events lock them when the angles reach 90 and 180 degrees. A latch is a plastic impact, whose lost
energy is in result.steps.

Reference: the equations of the two angles, integrated by SciPy with events of its own, with the
momenta over each latching by hand.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from scipy.integrate import solve_ivp

import fem_lie as fl

M, J, K, RELEASE = 5.0, 5.0 / 12.0, 0.5, 1.0
REST, STOP = np.radians([108.0, 200.0]), np.radians([90.0, 180.0])


def panels() -> fl.Scene:
    """The scene; hinges are called hinge 0 and hinge 1."""
    scene, before = fl.Scene(), fl.ground()
    for k in range(2):
        body = scene.add(fl.RigidBody(M, (1e-3, J, J), position=(0.5, 0, 0), name=f"panel {k}"))
        hinge = fl.joints.Revolute(before, body.point("centre"), at=(k, 0, 0), name=f"hinge {k}")
        scene.add(hinge)
        scene.add(fl.joints.Spring(hinge.angle, K, rest=REST[k]))
        held = scene.add(fl.joints.Drive(hinge.angle))
        latch = scene.add(fl.joints.Drive(hinge.angle, active=False, name=f"latch {k}"))
        release, lock = fl.schemes.Release(held), fl.schemes.Lock(latch)
        scene.add(fl.schemes.Event(lambda state: state.time - RELEASE, release))
        scene.add(fl.schemes.Event(lambda s, k=k, hinge=hinge: s.coordinate(hinge) - STOP[k], lock))
        before = body.point("centre")
    return scene


def inertia(angle: float) -> np.ndarray:
    """Mass matrix of both angles; it depends on the second one."""
    own, arm = M / 4 + J, -M / 2 * np.cos(angle)
    return np.array([[2 * own + M + 2 * arm, own + arm], [own + arm, own]])


def reference() -> list[tuple[float, int, float]]:
    """Time, panel and lost energy of each latching."""
    free, found, time, state = np.array([True, True]), [], 0.0, np.zeros(4)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        q, v, a = y[:2], y[2:], np.zeros(2)
        turning = M / 2 * np.sin(q[1]) * np.array([2 * v[0] * v[1] + v[1] ** 2, -(v[0] ** 2)])
        forces, matrix = -K * (q - REST) - turning, inertia(q[1])
        a[free] = np.linalg.solve(matrix[np.ix_(free, free)], forces[free])
        return np.concatenate([v, a])

    while free.any():
        latch = [lambda t, y, k=k: y[k] - STOP[k] for k in np.flatnonzero(free)]
        for each in latch:
            each.terminal = True
        end = solve_ivp(rate, (time, 99.0), state, "DOP853", events=latch, rtol=1e-12, atol=1e-13)
        k = int(np.flatnonzero(free)[int(np.argmax([len(t) for t in end.t_events]))])
        time, state = float(end.t[-1]), end.y[:, -1]
        matrix = inertia(state[1])
        v, free[k] = state[2:].copy(), False
        state[2:] = 0.0
        if free.any():
            state[2:][free] = np.linalg.solve(matrix[np.ix_(free, free)], (matrix @ v)[free])
        found.append((time, k, 0.5 * (v @ matrix @ v - state[2:] @ matrix @ state[2:])))
    return found


def main(step: float = 2e-3, pictures: bool = True) -> dict[str, Any]:
    """Times count from the release."""
    exact = reference()
    duration = step * np.ceil((RELEASE + exact[-1][0] + 0.5) / step)
    result = fl.GeneralisedAlpha(radius=0.9).run(panels(), duration=duration, step=step)
    times, lost = result.steps.event_times[2:] - RELEASE, result.steps.event_losses[2:]
    record = {
        "panels": (result.steps.event_numbers[2:] // 2).tolist(),
        "times": times.tolist(),
        "time_errors": np.abs(times - [each[0] for each in exact]).tolist(),
        "losses": lost.tolist(),
        "loss_errors": np.abs(lost - [each[2] for each in exact]).tolist(),
        "seconds": result.seconds,
    }
    if pictures:
        result.picture(in_results("deployed_panels.png"), title="Panels that unfold and latch")
    return record


if __name__ == "__main__":
    run(main, show=True)
