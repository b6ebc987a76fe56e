"""Andrews' squeezer: seven bodies in a plane, three loops, driven by a constant moment.

Problem of the test set for initial value problem solvers (F. Mazzia & C. Magherini, University of
Bari, 2008), after G. C. Andrews. Loops are closed by joints that act within the plane, whose points
are complex numbers. Angles at 0.03 s, extrapolated from runs with halved steps, against that
reference.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from extrapolation import extrapolated

import fem_lie as fl
from fem_lie.joints import Distance, InPlane, Revolute, Spring

A, B, C = -0.06934 - 0.00227j, -0.03635 + 0.03273j, 0.014 + 0.072j
MASSES = 0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498
INERTIAS = 2.194e-6, 4.41e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5
START = [-0.06171389001427645, 0.45527981916307038, 0.22266839016588588, 0.48736497954384255,
         1.2305474445498212]  # fmt: skip
END = [15.81077119629904, 0.04082224013073101, -0.5347301163226948, 0.5244099658805304,
       1.048080741042263]  # fmt: skip
"""Angles of crank, plate, lower arm against its rod, and of both rods."""


def squeezer() -> tuple[fl.Scene, list[Revolute]]:
    """The scene, and the hinges of these angles."""
    crank, plate, bent, rod, arm = np.exp(1j * np.array(START))
    tip, lower, upper = -0.021 * crank, A + 0.04 * rod, A - 0.04j * arm
    centres = (0.00092 * crank, -0.0045 * crank, B + (0.01043 - 0.01874j) * plate,
               A + (0.04 - 0.00579j * bent) * rod, A + (0.02308 + 0.00916j) * rod,
               A + (0.00579 / bent - 0.04j) * arm, A - (0.00449 + 0.01228j) * arm)  # fmt: skip
    scene, ground = fl.Scene(), fl.ground()
    a, b, c, d, e, f, g = (
        scene.add(fl.RigidBody(m, (J, J, J), (x.real, x.imag, 0))).point("centre")
        for m, J, x in zip(MASSES, INERTIAS, centres, strict=True)
    )
    pairs = (ground, a, 0j), (ground, c, B), (e, d, lower), (ground, e, A), (ground, g, A)
    hinges = [
        scene.add(Revolute(first, second, at=(x.real, x.imag, 0)))
        for first, second, x in (*pairs, (a, b, 0.007 * crank), (g, f, upper))
    ]
    for other, axis in ((k, axis) for k in (c, d, f) for axis in np.eye(3)[:2]):
        scene.add(InPlane(b, other, at=(tip.real, tip.imag, 0), axis=axis))
    eye = B + (0.02 - 0.018j) * plate
    length = Distance(ground, c, at=(C.real, C.imag, 0), to=(eye.real, eye.imag, 0)).length
    scene.add(Spring(length, 4530.0, rest=0.07785))
    scene.add(fl.PointLoad(a, moment=(0, 0, 0.033)))
    return scene, hinges[:5]


def main(step: float = 2e-5, runs: int = 3, pictures: bool = True) -> dict[str, Any]:
    """Errors of the angles, of each run and extrapolated."""
    found, scheme = [], fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12)
    for k in range(runs):
        scene, hinges = squeezer()
        result = scheme.run(scene, duration=0.03, step=step / 2**k, save_every=100 * 2**k)
        found.append(np.add(START, [result.coordinate(hinge)[-1] for hinge in hinges]))
    errors = [float(np.abs(each - END).max()) for each in (*found, extrapolated(found))]
    if pictures:
        result.picture(in_results("squeezer.png"), title="Andrews' squeezer")
    return {"errors": errors, "seconds": result.seconds}


if __name__ == "__main__":
    run(main, show=True)
