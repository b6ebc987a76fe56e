"""Two folded panels are released at 1 s, unfold by torsion springs, and latch.

Each panel has 5 kg and 1 m and is hinged at its edge, with springs of 0.5 N m/rad that are relaxed
at 108 degrees (first panel) and 200 degrees (second panel, folded back onto the first). Drives
without a function hold the panels down until an event releases them. Two more drives are latches:
events lock them when the angles reach 90 and 180 degrees. A latch is a plastic impact, whose lost
energy is in result.steps. The iteration's tolerance is a relative error of velocities in each step;
4000 steps add these up in the time of the last latching, which shall be right to 1e-6 of it.

Reference: the equations of the two angles, integrated by SciPy with events of its own, with the
momenta over each latching by hand (demos/reference/deployed_panels.py).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from reference.deployed_panels import REST, STOP, J, K, M, latched, latchings

import fem_lie as fl

RELEASE, INDEX = 1.0, fl.schemes.ConstraintIndex.STABILISED_TWO


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


def main(step: float = 2e-3, pictures: bool = True) -> dict[str, Any]:
    """Times count from the release."""
    exact = latchings()
    duration = step * np.ceil((RELEASE + exact[-1][0] + 0.5) / step)
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-9, index=INDEX)
    result = scheme.run(panels(), duration=duration, step=step)
    times, lost = result.steps.event_times[2:] - RELEASE, result.steps.event_losses[2:]
    before = np.flatnonzero(np.diff(result.times) == 0.0)[-2:]
    omega = [result.velocity(f"panel {k}.centre")[:, 5] for k in range(2)]
    rates, angle = np.stack([omega[0], omega[1] - omega[0]], axis=1), result.coordinate("hinge 1")
    free = np.array([[True, False], [False, False]])
    hand = [latched(angle[i], rates[i], left) for i, left in zip(before, free, strict=True)]
    record = {
        "panels": (result.steps.event_numbers[2:] // 2).tolist(),
        "times": times.tolist(),
        "time_errors": np.abs(times - [each[0] for each in exact]).tolist(),
        "losses": lost.tolist(),
        "loss_errors": np.abs(lost - [each[2] for each in exact]).tolist(),
        "losses_by_hand": [each[1] for each in hand],
        "rates": rates[before + 1].tolist(),
        "rates_by_hand": [each[0].tolist() for each in hand],
        "seconds": result.seconds,
    }
    if pictures:
        result.picture(in_results("deployed_panels.png"), title="Panels that unfold and latch")
    return record


if __name__ == "__main__":
    run(main, show=True)
