"""Hoop truss antenna with two nets of cables, 4 m: full retraction, afloat and without gravity.

The size of example 4.6 of the paper on local frames, whose layout is not published: 150 bars of 18
elements, 630 cables of 20, and spherical, revolute, prismatic joints and gears. The layout of this
one is that of antenna_scene.py. Cables go slack as the ring folds; --slack is the strain below
which they do, and are a weak spring from then on, whose force is small and linear in the places of
its ends: a slack cable is drawn as a straight line, as if it were short.

The numbers: unknowns are those of nodes, three of each of cables and six of bars, constraints
those of joints; k_updates and phi_updates count every matrix of mass and stiffness and every
Jacobian of constraints, the first included; solver_iterations are solutions of the linear system
per step, which is solved directly, with frozen factors. width is the largest distance of a vertical
from the axis at the end; off_posture how far the tops are then from where rigid bars would have
them, but for a motion of all along the axis; asymmetry by how much radii of the tops differ, and
heights of those that go up and of those that go down, at any time kept.

energy_error is the difference of energy and its balance, over the largest of either, violation
the largest of any constraint. Forces are the largest of the joints of a kind and of the telescopes
that are driven, after a twentieth of the motion.
"""

from __future__ import annotations

from typing import Any

import antenna_pictures
from antenna_numbers import forces, shape, sizes
from antenna_scene import Antenna
from command_line import one_of, run

import fem_lie as fl

POLICIES: dict[str, fl.schemes.RefactorisationPolicy] = {
    "auto": fl.schemes.Automatic(),
    "secants": fl.schemes.Automatic(secants=3),
    "nni4": fl.schemes.IterationLimit(4),
    "full": fl.schemes.EveryIteration(),
}


def main(
    bays: int = 30,
    elements: int = 18,
    cells: int = 20,
    driven: int = 30,
    duration: float = 20.0,
    step: float = 1e-2,
    steps: int | None = None,
    slack: float = 1e-3,
    radius: float = 0.0,
    policy: str = "auto",
    inertial: bool = False,
    pictures: bool = True,
) -> dict[str, Any]:
    one_of("policy", policy, POLICIES)
    antenna = Antenna(bays, driven, duration, elements, cells, slack)
    kept, axes = POLICIES[policy], fl.schemes.MatrixFrame(int(inertial))
    scheme = fl.GeneralisedAlpha(radius=radius, policy=kept, matrix_frame=axes)
    made = round(duration / step) if steps is None else steps
    every = max(1, made // 100)
    result = scheme.run(antenna.scene, duration=made * step, step=step, save_every=every)
    if pictures:
        antenna_pictures.motion(antenna, result, "hoop_antenna")
        antenna_pictures.layout(antenna, result, "hoop_antenna_layout")
    return {
        "bays": bays,
        **sizes(antenna),
        "steps": made,
        "iterations_per_step": float(result.iterations[-1] / made),
        "solver_iterations": float(result.iterations[-1] / made),
        "k_updates": result.k_updates,
        "phi_updates": result.phi_updates,
        "seconds_per_step": result.seconds / made,
        "energy_error": result.balance_error,
        "momentum_error": result.momentum_error,
        "violation": float(result.joint_violations.max()),
        **shape(antenna, result),
        **forces(antenna, result),
    }


if __name__ == "__main__":
    run(main, show=True)
