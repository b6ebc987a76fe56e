"""Matrices that a run makes as an elastic beam falls on a plane, by the stiffness of the penalty.

    python -m benchmarks.falling_beam

A beam of 20 elements, tilted by 5 degrees, radius 0.01 and E = 1e7, falls on a plane 0.03 below its
lower end and lies there partly: 400 steps of 1e-3 s. Its nodes touch, or the line that it is. At
1 N/m it hardly feels the plane, and at 1e3 N/m contacts do not count in the matrix.
"""

from __future__ import annotations

from time import process_time

import numpy as np

import fem_lie as fl

STIFFNESSES = 1.0, 1e3, 1e4, 1e5, 1e6
RADIUS, CELLS = 0.01, 20


def fall(stiffness: float, *, line: bool) -> tuple[fl.Result, float, float]:
    """The motion, its largest overlap, and seconds of the processor."""
    section = fl.Section.circle(RADIUS, fl.Material(1e7, 0.3, 1000.0))
    tilt = np.radians(5)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    end = np.cos(tilt), 0, np.sin(tilt)
    beam = scene.add(fl.Beam.straight((0, 0, 0), end, section, cells=CELLS))
    plane = fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, -0.03))
    if line:
        surface, law = fl.contact.Line(beam, RADIUS), fl.contact.Penalty(stiffness * CELLS)
    else:
        nodes = [fl.extend.Point(beam, k) for k in range(CELLS + 1)]
        surface, law = fl.contact.Vertices(nodes), fl.contact.Penalty(stiffness)
    contact = scene.add(fl.contact.Contact(surface, plane, law))
    scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-6)
    before = process_time()
    result = scheme.run(scene, duration=0.4, step=1e-3, progress=False)
    seconds = process_time() - before
    return result, float(fl.post.contact_forces(result, contact).penetration.max()), seconds


def main() -> dict[tuple[bool, float], int]:
    """How many matrices, for nodes and for lines and each stiffness."""
    found = {}
    for line in (False, True):
        print("line, penalty per length times 20" if line else "nodes")
        for stiffness in STIFFNESSES:
            try:
                result, deep, seconds = fall(stiffness, line=line)
            except fl.ConvergenceError as error:
                print(f"{stiffness:8.0e} N/m: {error}")
                continue
            steps = len(result.times) - 1
            found[line, stiffness] = result.factorisations
            print(
                f"{stiffness:8.0e} N/m: {result.factorisations:4} matrices, "
                f"{result.iterations[-1] / steps:.2f} iterations and "
                f"{1e3 * seconds / steps:.2f} ms per step, overlap {deep:.1e} m"
            )
    return found


if __name__ == "__main__":
    main()
