"""Spatial slider-crank: a crank drives a slider through a rod, rigid or flexible.

After the IFToMM benchmark of that name (E. J. Haug, Computer Aided Kinematics and Dynamics of
Mechanical Systems, 1989). The crank, 0.08 m, turns about the axis x through A = (0, 0.1, 0.12) m;
the rod, 0.3 m, joins its end B to a slider C on the axis x. Gravity acts along -z, the crank starts
upright with 6 rad/s. Revolute joint at A, spherical joints at B and C, prismatic joint of the
slider. Crank 0.12 kg, rod 0.5 kg, slider 2 kg.

The rigid mechanism has one degree of freedom; its reference is Lagrange's equation of that, solved
to ten digits. (With a spherical joint at C the rod may spin about its axis; it does not start to.)
Runs with --step, half of it and so on are extrapolated.

With --elements the rod is a beam of the same mass. Its bending makes the crank lag and lead; there
is no published value, and the demo shows how its own result converges with elements and step.
Differences between runs of the soft rod (--modulus 2e8) grow tenfold between 0.75 s and 1 s: steps
of 1e-3 leave 0.4 rad there, and only from 1.25e-4 on errors fall with the square of the step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from extrapolation import extrapolated, largest_errors, order
from records import bow, of_motion
from reference.tables import table
from rigid import axes_along

import fem_lie as fl
from fem_lie.joints import Prismatic, Revolute, Spherical

PIVOT, CRANK_END, SLIDER = np.array([[0, 0.1, 0.12], [0, 0.1, 0.2], [0.2, 0, 0]])
SPEED, ROD_MASS, ROD_RADIUS = 6.0, 0.5, 0.008
REFERENCE = table("slider_crank")
Mechanism = tuple[fl.Scene, Revolute, Prismatic]
EVERY = 0.05
"""Time between two rows of the reference."""


def flexible(elements: int, modulus: float) -> fl.Beam:
    """A round rod of the mass of the rigid one."""
    density = ROD_MASS / (np.pi * ROD_RADIUS**2 * 0.3)
    section = fl.Section.circle(ROD_RADIUS, fl.Material(modulus, 0.3, density))
    return fl.Beam.straight(CRANK_END, SLIDER, section, cells=elements, name="rod")


def mechanism(rod: fl.extend.Body | None = None) -> Mechanism:
    """The scene, the crank's and the slider's joint; the rod is rigid if none is given."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    middle, J = 0.5 * (PIVOT + CRANK_END), (1e-4, 1e-4, 1e-5)
    crank = scene.add(fl.RigidBody(0.12, J, middle, name="crank"))
    slider = scene.add(fl.RigidBody(2.0, (1e-3, 1e-3, 1e-3), SLIDER, name="slider"))
    ends = "start", "end"
    if rod is None:
        middle, ends = 0.5 * (CRANK_END + SLIDER), ("centre", "centre")
        axes = axes_along((SLIDER - CRANK_END) / 0.3)
        rod = fl.RigidBody(ROD_MASS, (4e-4, 4e-3, 4e-3), middle, axes, name="rod")
    scene.add(rod)
    pivot = scene.add(Revolute(fl.ground(), crank.point("centre"), at=PIVOT, axis=(1, 0, 0)))
    scene.add(Spherical(crank.point("centre"), rod.point(ends[0]), at=CRANK_END))
    scene.add(Spherical(slider.point("centre"), rod.point(ends[1]), at=SLIDER))
    guide = scene.add(Prismatic(fl.ground(), slider.point("centre"), axis=(1, 0, 0)))
    # the slider and the rod, without deforming, follow the crank
    fl.schemes.set_initial_velocities(scene, 1e-3, rates=[(pivot.angle, SPEED)])
    return scene, pivot, guide


def main(
    elements: int = 0,
    step: float = 1e-3,
    runs: int = 3,
    duration: float = 5.0,
    modulus: float = 2e8,
    pictures: bool = True,
) -> dict[str, Any]:
    """``runs``: with step, step/2 and so on; each must divide 0.05 s."""
    # round-off limits what a flexible rod can be iterated to
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-9 if elements else 1e-11)
    results = []
    for h in (step / 2**k for k in range(runs)):
        scene, pivot, guide = mechanism(flexible(elements, modulus) if elements else None)
        result = scheme.run(scene, duration=duration, step=h, save_every=round(EVERY / h))
        slide, turn = result.coordinate(guide)[1:], result.coordinate(pivot)[1:]
        results.append(np.column_stack([0.2 + slide, turn]))
    limit = extrapolated(results)
    errors, away = largest_errors(results, REFERENCE[1 : len(result.times), 1:])
    if pictures:
        file = in_results("slider_crank.png")
        result.picture(file, trace=["crank.centre"], title="Spatial slider-crank")
    return {
        "elements": elements,
        "step": step,
        "order": order(results),
        "slider_errors": errors[:, 0].tolist(),
        "angle_errors": errors[:, 1].tolist(),
        "slider_extrapolated": float(away[0]),
        "angle_extrapolated": float(away[1]),
        "angles": {f"{t:g}": float(a) for t, a in zip(result.times[1:], limit[:, 1], strict=True)},
        "change": np.abs(limit - results[-1]).max(axis=0).tolist(),
        "energy_error": result.energy_error,
        "violation": float(result.joint_violations.max()),
        **of_motion(result, round(duration / h)),
        **({"deflection": bow(result, "rod")} if elements else {}),
    }


if __name__ == "__main__":
    run(main, show=True)
