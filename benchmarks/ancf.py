"""What a beam of positions and three slopes costs, and how often it needs a new matrix.

Residual per element, microseconds of the processor, the least of several turns. Then a rope that
swings, hinged at one end, and one that tumbles freely, by generalised-alpha with the policy
``Automatic``, the same step and tolerance, with equations in axes fixed in space and in those of
the sections; with the beam of frames beside it. It prints the matrices, the iterations and the
largest distance of any point at any time from the first run, over the length.

Last, an I beam of steel that is twisted at its tip, its root held against warping: the angle
against Vlasov's ``T L/GJ (1 - tanh kL/kL)``, ``k² = GJ/EI_ω``.

With --conserving it makes so many steps of energy-momentum instead.

    python benchmarks/ancf.py [--steps 10000] [--elements 10000] [--turns 5] [--conserving 0]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np

import fem_lie as fl

CELLS = 10


def section() -> fl.Section:
    return fl.Section.from_stiffness([1e4, 4e3, 4e3, 1.0, 1.0, 1.0], mass=1.0, polar=1e-3)


def residual(elements: int) -> float:
    """Seconds per element."""
    body = fl.AncfBeam.curve(lambda s: (s, 0.3 * s * s, 0.1 * s**3), section(), cells=elements)
    term, out = body.model.assemble([body.model]), np.zeros((len(body.frames), 6))
    H = body.frames.copy()
    term.add_forces(H, out)
    start = process_time()
    for _ in range(10):
        term.add_forces(H, out)
    return (process_time() - start) / (10 * elements)


Made = Callable[..., Any]


def swinging(made: Made) -> tuple[fl.Scene, Any]:
    body = made.straight((0, 0, 0), (1, 0, 0), section(), cells=CELLS)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    scene.add(fl.joints.Revolute(fl.ground(), body.point("start"), axis=(0, 1, 0)))
    return scene, body


def tumbling(made: Made, cells: int = CELLS) -> tuple[fl.Scene, Any]:
    body = made.curve(lambda s: (s, 0.5 * s * s, 0.2 * s**3), section(), cells=cells)
    body.add_velocity(omega=(3.0, 4.0, 2.0), about=(0.4, 0.2, 0.0))
    scene = fl.Scene()
    scene.add(body)
    return scene, body


def twisted(cells: int) -> tuple[float, float]:
    """Error of the angle, and by how much it is less than without restraint."""
    E, G, length, torque = 2.1e11, 8.1e10, 2.0, 1e-3
    flange, web, depth, width = 8.5e-3, 5.6e-3, 0.1915, 0.1  # IPE 200, middle lines
    J = (2 * width * flange**3 + depth * web**3) / 3
    strong = depth**2 * width * flange / 2 + web * depth**3 / 12
    weak = flange * width**3 / 6
    area = 2 * width * flange + depth * web
    stiff = [E * area, G * width * flange, G * depth * web, G * J, E * strong, E * weak]
    own = fl.Section.from_stiffness(stiff)
    warping = E * weak * depth**2 / 4
    beam = fl.AncfBeam.straight((0, 0, 0), (length, 0, 0), own, cells=cells, warping=warping)
    beam.clamp(beam.point("start"))
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.PointLoad(beam.point("end"), moment=(torque, 0, 0)))
    rows = fl.statics(scene).frames[-1][2 * beam.model.points_count - 1]
    x = length * np.sqrt(G * J / warping)
    part = 1 - np.tanh(x) / x
    angle = 0.5 * (rows[1, 2] - rows[2, 1])
    return abs(angle / (torque * length / (G * J) * part) - 1), part


def conserved(steps: int) -> None:
    """Six elements that tumble, by energy-momentum."""
    scene, _ = tumbling(fl.AncfBeam, 6)
    result = fl.EnergyMomentum().run(scene, duration=1e-3 * steps, step=1e-3)
    kept = result.total_energy, result.angular_momentum, result.momentum
    errors = [np.abs(values - values[0]).max() / np.abs(values[0]).max() for values in kept]
    print("energy, angular momentum, momentum: {:.1e} {:.1e} {:.1e}".format(*errors), end=", ")
    print(f"{result.k_updates} matrices, {int(result.iterations[-1]) / steps:.1f} iterations")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--elements", type=int, default=10_000)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--conserving", type=int, default=0)
    options = parser.parse_args()
    if options.conserving:
        return conserved(options.conserving)
    cost = min(residual(options.elements) for _ in range(options.turns))
    print(f"residual per element: {1e6 * cost:.2f} µs")
    print("I beam, elements: error of the angle, and that over the angle of free warping")
    for cells in (4, 8, 16, 32):
        print("{:4}: {:.1e}, {:.3f}".format(cells, *twisted(cells)))
    runs = (
        ("slopes, fixed axes", fl.AncfBeam, fl.schemes.MatrixFrame.INERTIAL),
        ("slopes, own axes", fl.AncfBeam, fl.schemes.MatrixFrame.LOCAL),
        ("frames, own axes", fl.Beam, fl.schemes.MatrixFrame.LOCAL),
    )
    print("scene     nodes, axes         matrices  iterations per step  distance", flush=True)
    for name, scene_of in (("swinging", swinging), ("tumbling", tumbling)):
        first = None
        for label, made, components in runs:
            scene, _ = scene_of(made)
            scheme = fl.GeneralisedAlpha(radius=0.8, matrix_frame=components)
            result = scheme.run(scene, duration=1e-3 * options.steps, step=1e-3)
            positions = result.frames[:, : CELLS + 1, 0]
            first = positions if first is None else first
            gap = np.abs(positions - first).max()
            mean = int(result.iterations[-1]) / options.steps
            print(f"{name:9} {label:20} {result.k_updates:7} {mean:20.1f}  {gap:8.1e}", flush=True)


if __name__ == "__main__":
    main()
