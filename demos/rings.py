"""Rings and helices of rods: what a Kirchhoff rod does in closed form.

Isotropic rods, EI = GJ = 1, stretch EA = 1e6, with the elements of --formulation rod or discrete.

- Helix: a straight cantilever of length 2 pi under a moment at its tip, fixed in space and oblique
  to it. All cuts carry the same moment, so that axes turn about it at a constant rate, once around
  over the length: H(s) = exp(s (e1, M/EI)). helix_error is that of the tip over the length.
- Michell's ring: a straight rod is bent to a circle and joined to itself, after one end was turned
  by an angle. It stays plane up to 2 pi sqrt(3) EI/GJ (J. H. Michell, Messenger of Math. 11 (1889)
  181; E. E. Zajac, J. Appl. Mech. 29 (1962) 136).
- Overcurved ring: of natural curvature k it carries the moment M = EI (1/R - k), and stays plane as
  long as (1 - M R/EI) (1 - M R/GJ) < 4, which is k < 2/R where EI = GJ: linear equilibrium of
  axes turned by (a, b) about tangent and normal, C (a' - b)' = (B - M)(b' + a) and
  B (b' + a)' = (M - C)(a' - b) with R = 1, has the solution of two waves there.

The rings are cut, and both ends held at the same point: that leaves them as stable as they are when
closed. Angle and curvature at which the first negative eigenvalue appears are found by bisection.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from command_line import run

import fem_lie as fl
from fem_lie import lie

LENGTH = 2 * np.pi
SECTION = fl.Section.from_stiffness([1e6] * 3 + [1.0] * 3)
MICHELL = 2 * np.pi * np.sqrt(3.0)
OVERCURVED = 2.0
MOMENT = (0.6, 0.0, 0.8)  # of length one: once around
GAP = 1e-5  # of the ring, between its ends


def helix(formulation: fl.elements.BeamFormulation, elements: int) -> tuple[float, float]:
    """Error of the tip over the length, and iterations per load step."""
    scene, ends = fl.Scene(), ((0, 0, 0), (LENGTH, 0, 0))
    rod = scene.add(fl.Rod.straight(*ends, SECTION, cells=elements, formulation=formulation))
    scene.add(fl.Clamp(rod.point("start")))
    scene.add(fl.PointLoad(rod.point("end"), moment=MOMENT))
    result = fl.statics(scene, load_steps=20)
    exact = lie.se3_exp(LENGTH * np.array([1.0, 0, 0, *MOMENT]))[0]
    error = np.linalg.norm(result.position(rod.point("end"))[-1] - exact) / LENGTH
    return float(error), (result.total_iterations + result.failed_iterations) / 20


def ring(discrete: bool, elements: int, natural: tuple[float, float, float]) -> fl.Scene:
    """A circle of radius one of a rod of natural (torsion, curvatures), both ends held."""
    turn = LENGTH * (1 - GAP)

    def circle(s: float) -> tuple[float, float, float]:
        return float(np.sin(turn * s)), 1.0 - float(np.cos(turn * s)), 0.0

    scene = fl.Scene()
    element = fl.elements.DiscreteRod(natural=natural) if discrete else fl.elements.KirchhoffRod()
    options: dict[str, Any] = {"up": (0, 0, 1), "formulation": element}
    rod = scene.add(fl.Rod.curve(circle, SECTION, cells=elements, **options))
    scene.add(fl.Clamp(rod.point("start")))
    scene.add(fl.Clamp(rod.point("end")))
    if not discrete:
        own = np.array([0, 0, 0, *natural]) - [0, 0, 0, 0, 0, 1.0]
        scene.add(fl.loads.Eigenstrain(rod, own))
    return scene


def critical(unstable: Callable[[float], bool], below: float, above: float) -> float:
    """Where it begins, to 1e-4."""
    if unstable(below) or not unstable(above):
        raise RuntimeError(f"the ring does not become unstable between {below:g} and {above:g}")
    while above - below > 1e-4 * above:
        middle = 0.5 * (below + above)
        below, above = (below, middle) if unstable(middle) else (middle, above)
    return 0.5 * (below + above)


def buckles(discrete: bool, elements: int, natural: tuple[float, float, float]) -> bool:
    """Whether the plane ring is unstable."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fl.stability.UnstableEquilibriumWarning)
        try:
            result = fl.statics(ring(discrete, elements, natural), load_steps=1)
        except fl.ConvergenceError:
            return True  # laid beside an equilibrium that is unstable, it leaves for another
    return bool(result.negative_pivots[-1] > 0)


def main(formulation: str = "rod", elements: int = 64) -> dict[str, Any]:
    if formulation not in ("rod", "discrete"):
        raise ValueError(f"formulation must be rod or discrete, got {formulation}")
    discrete = formulation == "discrete"
    element = fl.elements.DiscreteRod() if discrete else fl.elements.KirchhoffRod()
    error, iterations = helix(element, elements)
    twist = critical(lambda angle: buckles(discrete, elements, (-angle / LENGTH, 0, 0)), 8.0, 14.0)
    curvature = critical(lambda k: buckles(discrete, elements, (0, 0, k)), 1.5, 3.0)
    record = {
        "formulation": formulation,
        "elements": elements,
        "helix_error": error,
        "helix_iterations": iterations,
        "michell_error": float(twist / MICHELL - 1),
        "overcurved_error": float(curvature / OVERCURVED - 1),
    }
    return record


if __name__ == "__main__":
    run(main, show=True)
