"""What the equations of a scene cost before the first step, for bodies of each formulation.

    python3 benchmarks/set_up.py [--repeats 8]

The first set-up of a kind of body in a process loads FFCx's libraries; later ones take their forms
from the process, for other bodies on other meshes. Milliseconds of the processor, the least of all
repeats; bodies are built before the clock starts.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from time import process_time

import fem_lie as fl
from fem_lie.extend import Equations

RUBBER = fl.Material(E=1e7, nu=0.3, density=1000.0)
BAR, WIRE = fl.Section.rectangle(0.1, 0.1, RUBBER), fl.Section.circle(0.02, RUBBER)
LINE = (0, 0, 0), (1, 0, 0)


def sheet(cell: str) -> fl.Shell:
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (4, 4), cell=cell)
    return fl.Shell(mesh, fl.ShellSection.layer(0.01, RUBBER))


def block(cell: str) -> fl.Solid:
    law = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1e3)
    return fl.Solid(fl.mesh.brick((1, 1, 1), (2, 2, 2), cell=cell), law)


BODIES: dict[str, Callable[[], fl.Body]] = {
    "beam": lambda: fl.Beam.straight(*LINE, BAR, cells=8),
    "rod": lambda: fl.Rod.straight(*LINE, WIRE, cells=8),
    "cable": lambda: fl.Cable.straight(*LINE, WIRE, cells=8),
    "shell of quadrilaterals": lambda: sheet("quadrilateral"),
    "shell of triangles": lambda: sheet("triangle"),
    "solid of hexahedra": lambda: block("hexahedron"),
    "solid of tetrahedra": lambda: block("tetrahedron"),
}


def seconds(make: Callable[[], fl.Body]) -> float:
    """Processor time of the equations of one new body."""
    scene = fl.Scene()
    scene.add(make())
    start = process_time()
    Equations(scene, dynamics=True)
    return process_time() - start


def main(repeats: int = 8) -> dict[str, tuple[float, float]]:
    """Seconds of the first set-up of each body, and the least of the later ones."""
    found = {}
    for name, make in BODIES.items():
        first, *later = (seconds(make) for _ in range(repeats + 1))
        found[name] = first, min(later)
        print(f"{name:26} first {1e3 * first:7.1f} ms, later {1e3 * min(later):6.1f} ms")
    return found


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=8)
    main(parser.parse_args().repeats)
