"""A square plate, an edge clamped, that a dead load on the opposite edge bends far.

As a script it prints the processor seconds of the statics of 100² cells, for any checkout. In
turns, each in its own environment, whose BLAS counts:

    tools/run python3 benchmarks/everyday_rows/plate.py
    OTHER/tools/run python3 benchmarks/everyday_rows/plate.py
"""

import time

import fem_lie as fl

SIDE, THICKNESS = 1.0, 0.01
STEEL = fl.Material(2.1e11, 0.3, 7800.0)
STIFFNESS = STEEL.E * THICKNESS**3 / (12.0 * (1.0 - STEEL.nu**2))
"""Bending stiffness D, N m."""
FORCE = 4.0 * STIFFNESS / SIDE**2
"""Total force F on the edge, N: F L²/D = 4."""


def plate(cells: int) -> fl.Scene:
    """The plate with ``cells`` × ``cells`` cells, its edge load in the direction of z."""
    scene = fl.Scene()
    mesh = fl.mesh.parametric_surface(lambda a, b: (SIDE * a, SIDE * b, 0.0), (cells, cells))
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(THICKNESS, STEEL), name="plate"))
    for node in shell.points("a=0"):
        scene.add(fl.Clamp(node))
    scene.add(fl.loads.EdgeLoad(shell, "a=1", (0.0, 0.0, FORCE / SIDE)))
    return scene


if __name__ == "__main__":
    fl.statics(plate(4))  # compiles
    scene = plate(100)
    began = time.process_time()
    fl.statics(scene)
    print(time.process_time() - began)
