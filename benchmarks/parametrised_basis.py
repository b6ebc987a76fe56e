"""Reduced-order crane arms at lengths and loads that no basis was computed for.

A tapered tube of steel, luffed by 60 degrees in 2 s with a load at its tip, is computed with all
unknowns at three lengths and two loads. Inner modes of a reduced-order body at other lengths and
loads are those of POD of all these runs, POD interpolated between them, POD of the nearest one, or
Craig-Bampton modes of the arm itself. Prints the largest error of the tip deflection relative to
its range, for the number of inner modes.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import NamedTuple

import numpy as np

import fem_lie as fl

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
LENGTHS, LOADS = (8.0, 11.0, 14.0), (500.0, 2000.0)  # m, kg
BETWEEN = ((9.5, 1200.0), (12.5, 800.0), (13.0, 1800.0))
DURATION, STEP, RISE = 3.0, 5e-3, 2.0  # s
CELLS = 24
AXES = fl.reduction.NodeAxes(0)


class Run(NamedTuple):
    """Motion of an arm with all its nodes.

    Attributes:
        arm: The arm.
        result: The motion.
    """

    arm: fl.Beam
    result: fl.Result

    def deflection(self) -> np.ndarray:
        """Displacement of the tip across the arm in the frame of its root, shape (T,)."""
        root = self.result.frames[:, self.result.info.body("arm").nodes[0]]
        along = self.result.position(self.arm.point("end")) - root[:, 0]
        return np.einsum("tj,tj->t", along, root[:, 3])


def arm(scene: fl.Scene, length: float) -> fl.Beam:
    """The arm, a tube whose radius falls from 0.3 to 0.15 m."""

    def section(s: float) -> fl.Section:
        radius = 0.3 - 0.15 * s / length
        return fl.Section.tube(radius - 0.012, radius, STEEL)

    start, end = (0, 0, 0), (length, 0, 0)
    return scene.add(fl.Beam.straight(start, end, section, cells=CELLS, name="arm"))


def luffed(scene: fl.Scene, start: fl.extend.Point, end: fl.extend.Point, load: float) -> fl.Result:
    """Motion of an arm with a load at its tip."""
    weight = scene.add(fl.RigidBody.ball(load, 0.3, end.position))
    scene.add(fl.joints.Fixed(end, weight.point("centre")))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), start, axis=(0, -1, 0)))
    scene.add(fl.joints.Drive(hinge.angle, rise))
    scene.gravity = (0.0, 0.0, -9.81)
    scheme = fl.GeneralisedAlpha(radius=0.8)
    return scheme.run(scene, duration=DURATION, step=STEP, progress=False)


def rise(t: float) -> float:
    """Angle of the arm at a time."""
    part = min(t / RISE, 1.0)
    return float(np.pi / 3 * (part - np.sin(2 * np.pi * part) / (2 * np.pi)))


def full(length: float, load: float) -> Run:
    """Motion with all unknowns."""
    scene = fl.Scene()
    beam = arm(scene, length)
    return Run(beam, luffed(scene, beam.point("start"), beam.point("end"), load))


def reduced(
    length: float, load: float, modes: Callable[[fl.Beam], fl.reduction.Basis | int]
) -> Run:
    """Motion of the reduced-order arm, expanded to all nodes."""
    part, scene = fl.Scene(), fl.Scene()
    beam = arm(part, length)
    ends = [beam.point("start"), beam.point("end")]
    body = scene.add(fl.reduction.reduced_order_body(part, ends, modes(beam), name="arm"))
    result = luffed(scene, body.point("start"), body.point("end"), load)
    return Run(beam, fl.reduction.recover_full_motion(result, body))


def trained(runs: dict[tuple[float, float], Run], modes: int) -> fl.reduction.Basis:
    """POD of several runs."""
    results, arms = [run.result for run in runs.values()], [run.arm for run in runs.values()]
    return fl.reduction.pod(results, arms, modes, axes=AXES)


def errors(
    runs: dict[tuple[float, float], Run], exact: Run, at: tuple[float, float], modes: int
) -> dict[str, float]:
    """Errors of all choices of inner modes at one length and load."""
    common = trained(runs, modes)
    bases = [trained({key: run}, modes) for key, run in runs.items()]
    away = np.abs((np.array(list(runs)) - at) / np.ptp(list(runs), axis=0)).sum(axis=1)
    choices: dict[str, Callable[[fl.Beam], fl.reduction.Basis | int]] = {
        "POD of all": common.transferred,
        "interpolated": lambda beam: fl.reduction.interpolated_basis(bases, list(runs), at, beam),
        "POD of the nearest": bases[int(away.argmin())].transferred,
        "Craig-Bampton": lambda beam: modes,
    }
    right = exact.deflection()
    return {
        name: float(np.abs(reduced(*at, choice).deflection() - right).max() / np.ptp(right))
        for name, choice in choices.items()
    }


def main() -> None:
    """Print the table."""
    runs = {key: full(*key) for key in product(LENGTHS, LOADS)}
    for at in BETWEEN:
        exact = full(*at)
        largest = np.abs(exact.deflection()).max() / at[0]
        print(f"length {at[0]} m, load {at[1]:.0f} kg, deflection {largest:.3f} of the length")
        for modes in (1, 2, 4, 6):
            found = errors(runs, exact, at, modes)
            print(f"  {modes} modes  " + "  ".join(f"{k} {v:.2e}" for k, v in found.items()))


if __name__ == "__main__":
    main()
