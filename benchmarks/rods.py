"""What cables, nets and rods cost: residual per element, and an implicit step of a rod of 51 nodes.

All elements, one after the other in turns; the least of several runs of each, seconds of the
processor. A step is one of generalised-alpha of a straight cantilever that swings under its weight,
the same motion for all, matrix made when it pays (``Automatic``), all states kept.

    python benchmarks/rods.py [--elements 10000] [--turns 5]
"""

from __future__ import annotations

import argparse
from time import process_time

import numpy as np

import fem_lie as fl
from fem_lie.mesh.curves import curve

ELEMENTS: dict[str, fl.elements.BeamFormulation] = {
    "positions and slopes": fl.elements.HermiteCable(),
    "discrete": fl.elements.DiscreteCable(),
    "Kirchhoff rod": fl.elements.KirchhoffRod(),
    "discrete rod": fl.elements.DiscreteRod(),
}


def cable(
    elements: int, element: fl.elements.BeamFormulation, bow: float = 0.0
) -> fl.Cable | fl.Rod:
    section = fl.Section.from_stiffness([1e4] * 3 + [1.0] * 3, mass=0.1, polar=2e-5)
    mesh = curve(lambda s: (s, 3 * bow * s * s, bow * s**3), elements)
    if isinstance(element, fl.elements.KirchhoffRod | fl.elements.DiscreteRod):
        return fl.Rod(mesh, section, formulation=element)
    return fl.Cable(mesh, section, formulation=element)


def residual(elements: int, element: fl.elements.BeamFormulation) -> float:
    """Seconds per element."""
    body = cable(elements, element, bow=0.1)
    assembly = body.model.assemble([body.model])
    H, out = np.empty_like(body.frames), np.zeros(6 * len(body.frames))
    H[assembly.order] = body.frames
    terms = [assembly, *assembly.further_terms]

    def once() -> None:
        for term in terms:
            term.add_forces(H, out)

    once()
    start = process_time()
    for _ in range(10):
        once()
    return (process_time() - start) / (10 * elements)


def step(element: fl.elements.BeamFormulation) -> tuple[float, float]:
    """Seconds per step without what a run takes to begin, and iterations."""
    body, scene = cable(50, element), fl.Scene(gravity=(0, -9.81, 0))
    scene.add(body)
    if isinstance(body, fl.Rod):
        scene.add(fl.Clamp(body.point("start")))
    else:
        body.clamp(body.point("start"))
    scheme, seconds = fl.GeneralisedAlpha(radius=0.9), []
    for steps in (10, 10, 1010):
        start = process_time()
        result = scheme.run(scene, duration=1e-3 * steps, step=1e-3)
        seconds.append(process_time() - start)
    return (seconds[2] - seconds[1]) / 1000, int(result.iterations[-1]) / steps


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--elements", type=int, default=10_000)
    parser.add_argument("--turns", type=int, default=5)
    options = parser.parse_args()
    residuals: dict[str, list[float]] = {name: [] for name in ELEMENTS}
    steps: dict[str, list[tuple[float, float]]] = {name: [] for name in ELEMENTS}
    for _ in range(options.turns):
        for name, element in ELEMENTS.items():
            residuals[name].append(residual(options.elements, element))
            steps[name].append(step(element))
    print("element             residual per element, µs  step of 51 nodes, ms  iterations")
    for name in ELEMENTS:
        seconds, iterations = min(steps[name])
        print(f"{name:20}{1e6 * min(residuals[name]):24.3f}{1e3 * seconds:23.3f}{iterations:12.1f}")


if __name__ == "__main__":
    main()
