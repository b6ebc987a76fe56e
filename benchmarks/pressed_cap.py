"""A rigid ball presses a shallow cap of shell in until it has snapped: force by depth and mesh.

    python -m benchmarks.pressed_cap [--mesh 8 12 16 24]

A square cap of a sphere of radius 2.54 m, half side 0.7849 m, thickness 0.03 m, hinged at its
edges, of which symmetry leaves a quarter. A ball of 0.4 m comes down on its crown, on its face: the
force has a maximum and falls as the cap goes over to the other side.
"""

from __future__ import annotations

import argparse

import numpy as np

import fem_lie as fl

RADIUS, SIDE, THICKNESS, BALL = 2.54, 0.7849, 0.03, 0.4
MATERIAL = fl.Material(6.895e7, 0.3, 1.0)
DEPTH, AREAL = 0.3, 2e9
LEVELS = np.linspace(0.1, 1.0, 10)


def position(a: float, b: float) -> np.ndarray:
    """From the crown to the edges."""
    x, y = SIDE * a, SIDE * b
    return np.array([x, y, np.sqrt(RADIUS**2 - x**2 - y**2)])


def press(mesh: int, load_steps: int = 60) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Depths, forces of the whole cap, the largest overlap, and iterations per step."""
    section = fl.ShellSection.layer(THICKNESS, MATERIAL)
    shell = fl.Shell(
        fl.mesh.parametric_surface(position, (mesh, mesh)), section, director=lambda x: x / RADIUS
    )
    shell.symmetry("a=0", (1, 0, 0))
    shell.symmetry("b=0", (0, 1, 0))
    shell.hinge("a=1")
    shell.hinge("b=1")
    top = RADIUS + 0.5 * THICKNESS + BALL
    ball = fl.RigidBody(1.0, np.eye(3), (0, 0, top))

    def down(part: float) -> np.ndarray:
        return np.vstack([[0, 0, top - part * DEPTH], np.eye(3)])

    scene = fl.Scene()
    scene.add(shell)
    scene.add(ball)
    scene.add(fl.PrescribedMotion(ball.point("centre"), down))
    nodes = [fl.extend.Point(shell, node) for node in range(len(shell.frames))]
    law = fl.contact.Penalty(AREAL * (SIDE / mesh) ** 2)
    surface = fl.contact.Vertices(nodes, 0.5 * THICKNESS)
    touch = scene.add(
        fl.contact.Contact(surface, fl.contact.Sphere(ball.point("centre"), BALL), law)
    )
    result = fl.statics(scene, levels=LEVELS, load_steps=load_steps)
    found = fl.post.contact_forces(result, touch)
    iterations = float(result.iterations[-1] / (len(result.factors) - 1))
    forces = 4.0 * np.abs(found.total[:, 2])
    return DEPTH * result.factors, forces, float(found.penetration.max()), iterations


def main() -> None:
    """Forces at these depths, and the largest one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mesh", nargs="+", type=int, default=[8, 12, 16, 24])
    for mesh in parser.parse_args().mesh:
        depths, forces, deep, iterations = press(mesh)
        at = [int(np.argmin(np.abs(depths - DEPTH * level))) for level in LEVELS]
        shown = " ".join(f"{force:.0f}" for force in forces[at])
        most = forces[depths < 0.8 * DEPTH].max()
        print(
            f"{mesh:3d} x {mesh} elements on a quarter: {shown} N at {LEVELS * DEPTH} m, before it "
            f"snaps {most:.0f} N, overlap {deep / THICKNESS:.1e} thicknesses, "
            f"{iterations:.1f} iterations per step",
            flush=True,
        )


if __name__ == "__main__":
    main()
