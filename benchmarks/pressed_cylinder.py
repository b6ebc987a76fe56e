"""A shell rolled to a cylinder is pressed between rigid planes: force against the elastica.

    python -m benchmarks.pressed_cylinder [--mesh 8 16 32 64]

A quarter of a ring, radius 1 and thickness 0.02, without Poisson's ratio, is pressed by its outer
face: balls of half the thickness about its nodes touch a plane that comes down. Of a ring that does
not stretch, ``EI κ² = EI κ₀² + 2 P sin θ`` from the plane to the side. It touches along one line as
long as κ₀ > 0, and lies flat on the plane beyond.
"""

from __future__ import annotations

import argparse

import numpy as np
from scipy.optimize import brentq

import fem_lie as fl

RADIUS, THICKNESS, WIDTH, E = 1.0, 0.02, 0.1, 1e9
PRESSED = np.array([0.05, 0.1, 0.2, 0.3, 0.4, 0.5])
BENDING = E * THICKNESS**3 / 12


def position(a: float, b: float) -> np.ndarray:
    """From the crown to the side, and along the axis."""
    angle = 0.5 * np.pi * a
    return np.array([WIDTH * b, RADIUS * np.sin(angle), RADIUS * np.cos(angle)])


def inwards(x: np.ndarray) -> np.ndarray:
    """Normal of the cylinder."""
    return -np.array([0.0, x[1], x[2]]) / np.hypot(x[1], x[2])


def _lengths(ratio: float, start: float) -> tuple[float, float]:
    """Length and height of the free part, of ``2 P/EI`` and ``κ₀²``; with θ = u²."""
    u, weights = np.polynomial.legendre.leggauss(60)
    u, weights = 0.5 * (u + 1) * np.sqrt(np.pi / 2), 0.5 * weights * np.sqrt(np.pi / 2)
    rate = 2 * u / np.sqrt(start + ratio * np.sin(u**2))
    return float(weights @ rate), float(weights @ (rate * np.sin(u**2)))


def elastica(pressed: float) -> float:
    """Force of a whole ring per width when each side has come down by this part of the radius."""
    length, height = 0.5 * np.pi * RADIUS, RADIUS * (1 - pressed)
    flat = (_lengths(1.0, 0.0)[1] / height) ** 2
    if _lengths(flat, 0.0)[0] <= length:
        return float(flat * BENDING)

    def start(ratio: float) -> float:
        return float(brentq(lambda q: _lengths(ratio, q)[0] - length, 0.0, 2.0 / RADIUS**2))

    ratio = brentq(lambda p: _lengths(p, start(p))[1] - height, 1e-9, flat)
    return float(ratio * BENDING)


def press(
    mesh: int, stiffness: float = 1e9, load_steps: int = 40
) -> tuple[fl.StaticResult, np.ndarray, float]:
    """States, forces of a whole ring per width, and the largest overlap."""
    section = fl.ShellSection.layer(THICKNESS, fl.Material(E, 0.0, 1.0))
    shell = fl.Shell(fl.mesh.parametric_surface(position, (mesh, 1)), section, director=inwards)
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (0, 0, 1))
    shell.symmetry("b=0", (1, 0, 0))
    face = RADIUS + 0.5 * THICKNESS
    plate = fl.RigidBody(1.0, np.eye(3), (0, 0, face))

    def down(part: float) -> np.ndarray:
        return np.vstack([[0, 0, face - part * RADIUS], np.eye(3)])

    scene = fl.Scene()
    scene.add(shell)
    scene.add(plate)
    scene.add(fl.PrescribedMotion(plate.point("centre"), down))
    nodes = [fl.extend.Point(shell, node) for node in range(len(shell.frames))]
    surface = fl.contact.Vertices(nodes, 0.5 * THICKNESS)
    law = fl.contact.Penalty(stiffness * WIDTH / mesh)
    touch = scene.add(
        fl.contact.Contact(surface, fl.contact.Plane(plate.point("centre"), (0, 0, -1)), law)
    )
    result = fl.statics(scene, levels=PRESSED, load_steps=load_steps)
    found = fl.post.contact_forces(result, touch)
    # of a quarter, of the nodes in the plane of symmetry half
    return result, 2.0 * np.abs(found.total[:, 2]) / WIDTH, float(found.penetration.max())


def main() -> None:
    """Forces over those of the elastica."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mesh", nargs="+", type=int, default=[8, 16, 32, 64])
    wanted = [elastica(pressed) for pressed in PRESSED]
    for mesh in parser.parse_args().mesh:
        result, forces, deep = press(mesh)
        at = [int(np.argmin(np.abs(result.factors - pressed))) for pressed in PRESSED]
        errors = forces[at] / wanted - 1
        reported = " ".join(f"{100 * error:+.2f}" for error in errors)
        iterations = result.iterations[-1] / (len(result.factors) - 1)
        print(
            f"{mesh:3d} elements on a quarter: force {reported} % at {PRESSED} R, overlap "
            f"{deep / THICKNESS:.1e} thicknesses, {iterations:.1f} iterations per step",
            flush=True,
        )


if __name__ == "__main__":
    main()
