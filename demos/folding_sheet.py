"""A sheet that is rolled to a tube folds flat onto itself under pressure.

A ring of radius R without Poisson's ratio is loaded by a pressure p that stays normal to it. Beyond
3 EI/R³ it is unstable as a circle and becomes flatter, at 5.247 EI/R³ its opposite sides touch at a
point, which they do with an increasing force up to 10.34 EI/R³, and along a flat part beyond:
J. E. Flaherty, J. B. Keller, S. I. Rubinow, SIAM J. Appl. Math. 23 (1972) 446. The numbers here are
those of their equations for middle lines that come no nearer than the thickness, of R/50.

One shell, half of the ring, touches itself: Gauss points of each cell meet smooth
patches of the others, of which those that are near along the sheet are left out. The ring is
R/500 out of round in the beginning.

What is found: half the height in the middle, half the width, and the force N of the opposite sides
on each other, at some pressures, and the largest overlap over the thickness.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from reference.collapsed_ring import collapse

import fem_lie as fl

THICKNESS, MOST, ROUND = 0.02, 20.0, 0.002
PRESSURES = np.array([4.0, 4.5, 5.0, 6.0, 8.0, 12.0, 16.0, 20.0])
UNITS = fl.post.Units(length="R")


def position(a: float, b: float) -> np.ndarray:
    """Half a ring from the top to the bottom, and along the axis."""
    angle = np.pi * a
    radius = 1.0 - ROUND * np.cos(2 * angle)
    return np.array([radius * np.sin(angle), 0.1 * b, radius * np.cos(angle)])


def outwards(x: np.ndarray) -> np.ndarray:
    """Normal of the ring."""
    angle = np.arctan2(x[0], x[2])
    radius, slope = 1.0 - ROUND * np.cos(2 * angle), 2 * ROUND * np.sin(2 * angle)
    c, s = np.cos(angle), np.sin(angle)
    tangent = np.array([slope * s + radius * c, 0.0, slope * c - radius * s])
    return np.cross(tangent, [0, 1, 0]) / np.linalg.norm(tangent)


def tube(mesh: int, stiffness: float) -> tuple[fl.Scene, fl.Shell, fl.contact.Contact]:
    """The scene, its shell with EI = 1 per width, and how it touches itself."""
    section = fl.ShellSection.layer(THICKNESS, fl.Material(12 / THICKNESS**3, 0.0, 1.0))
    shell = fl.Shell(fl.mesh.parametric_surface(position, (mesh, 1)), section, director=outwards)
    for curve, normal in (("a=0", (1, 0, 0)), ("a=1", (1, 0, 0)), ("b=0", (0, 1, 0))):
        shell.symmetry(curve, normal)
    scene, surface = fl.Scene(), fl.contact.ShellSurface(shell)
    scene.add(shell)
    side = fl.extend.Point(shell, int(np.argmax(shell.frames[:, 0, 0])))
    scene.add(fl.joints.InPlane(fl.ground(), side, axis=(0, 0, 1)))
    scene.add(fl.loads.SurfacePressure(shell, -MOST))
    return (
        scene,
        shell,
        scene.add(fl.contact.Contact(surface, surface, fl.contact.Penalty(stiffness))),
    )


def main(
    mesh: int = 32, load_steps: int = 800, stiffness: float = 1e6, pictures: bool = True
) -> dict[str, Any]:
    """``mesh``: cells of half the ring; ``stiffness``: of the contact, in EI/R⁴ over lengths."""
    scene, shell, contact = tube(mesh, stiffness)
    result = fl.statics(scene, load_steps=load_steps)
    found = fl.post.contact_forces(result, contact)
    at = [int(np.argmin(np.abs(MOST * result.factors - p))) for p in PRESSURES]
    wanted = collapse(PRESSURES, THICKNESS)
    ends = np.flatnonzero(shell.frames[:, 0, 0] < 1e-9)
    x = result.frames[at][:, : len(shell.frames), 0]
    height = 0.5 * np.ptp(x[:, ends, 2], axis=1)
    sizes = np.bincount(found.states, np.linalg.norm(found.forces, axis=1), len(result.factors))
    # each point counts from both sides with half its area, and half a ring is 0.1 wide
    force = 2.0 * sizes[at] / 0.1
    if pictures:
        steps = [float(result.factors[k]) for k in (at[1], at[4], at[-1])]
        result.picture(in_results("folding_sheet.png"), steps, units=UNITS)
    return {
        "mesh": mesh,
        "pressures": PRESSURES.tolist(),
        "heights": height.tolist(),
        "wanted_heights": [each.height for each in wanted],
        "widths": x[:, :, 0].max(axis=1).tolist(),
        "wanted_widths": [each.width for each in wanted],
        "forces": force.tolist(),
        "wanted_forces": [float(each.force) for each in wanted],
        "overlap": float(found.penetration.max() / THICKNESS),
        "iterations_per_step": float(result.iterations[-1] / (len(result.factors) - 1)),
    }


if __name__ == "__main__":
    run(main, show=True)
