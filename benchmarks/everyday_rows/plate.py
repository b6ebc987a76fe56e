"""Prints processor seconds of the statics of a plate of 100² cells, for any checkout.

In turns, each in its own environment, whose BLAS counts:

    tools/run python3 benchmarks/everyday_rows/plate.py
    OTHER/tools/run env PYTHONPATH=OTHER python3 benchmarks/everyday_rows/plate.py
"""

import time

import fem_lie as fl

SIDE, THICKNESS = 1.0, 0.01
STEEL = fl.Material(2.1e11, 0.3, 7800.0)
STIFFNESS = STEEL.E * THICKNESS**3 / (12.0 * (1.0 - STEEL.nu**2))


def plate(cells: int) -> fl.Scene:
    """An edge clamped, a dead transverse load on the opposite one with F L²/D = 4."""
    scene = fl.Scene()
    mesh = fl.surface(lambda a, b: (SIDE * a, SIDE * b, 0.0), (cells, cells))
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(THICKNESS, STEEL)))
    for node in shell.points("a=0"):
        scene.add(fl.Clamp(node))
    scene.add(fl.EdgeLoad(shell, "a=1", (0.0, 0.0, 4.0 * STIFFNESS / SIDE**3)))
    return scene


fl.statics(plate(4))
scene = plate(100)
began = time.process_time()
fl.statics(scene)
print(time.process_time() - began)
