"""Thin plate with a sharp gradient: error over unknowns, cells cut where it is made and equal ones.

``tools/run python3 -m benchmarks.sharp_gradients [--case layer] [--tolerance 0.003]``

``--case layer``: a unit square, clamped all around, whose deflection is ``w = w₀ (16 x (1 − x) y (1
− y))² atan(α s)`` with the distance s from a slanting line, under the load ``B Δ²w``. The error is
the energy norm of the curvatures that are missing, over that of all, against the derivatives of w
at 8×8 points of Gauss' rule in each cell.

``--case force``: the plate of ``demos/adaptive_splines.py``, where curvatures are infinite as a
logarithm. The error is that of the energy, ``√(1 − w_h/w)``.

Loads are so small that all is linear. Bicubics with continuous slopes have order 2 in the size of
cells, −1 in unknowns, at best; equal ones under the force have −1/2.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from math import comb
from typing import NamedTuple

import numpy as np

import fem_lie as fl
from demos import adaptive_splines
from demos.adaptive_splines import EDGES, SECTION, square
from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.mesh.bicubic import hermite

AMPLITUDE, POINTS = 1e-6, 8
STIFFNESS = SECTION.stiffness[3:6, 3:6]
BUBBLE = np.array([0.0, 0.0, 16.0, -32.0, 16.0])
CHOOSE = np.array([[comb(i, k) for k in range(5)] for i in range(5)], dtype=np.float64)
ACROSS, OFFSET = (0.8, 0.6), 0.65
"""Of the layer: its normal, and how far it is from the corner at 0."""


@compiled
def bubble(x: float, order: int) -> float:
    """Derivatives of 16 x² (1 − x)²."""
    total, power = 0.0, 1.0
    for k in range(order, 5):
        factor = 1.0
        for m in range(k - order + 1, k + 1):
            factor *= m
        total += BUBBLE[k] * factor * power
        power *= x
    return total


@compiled
def layer(s: float, steep: float, order: int) -> float:
    """Derivatives of atan(α s)."""
    t = steep * s
    q = 1.0 + t * t
    parts = np.arctan(t), 1 / q, -2 * t / q**2, (6 * t**2 - 2) / q**3, 24 * t * (1 - t**2) / q**4
    return float(steep**order * parts[order])


@compiled
def deflection(x: float, y: float, steep: float, i: int, j: int) -> float:
    """``∂ₓⁱ∂ᵧʲ w`` by the rule of Leibniz."""
    s = ACROSS[0] * x + ACROSS[1] * y - OFFSET
    total = 0.0
    for k in range(i + 1):
        for m in range(j + 1):
            factor = CHOOSE[i, k] * CHOOSE[j, m] * ACROSS[0] ** k * ACROSS[1] ** m
            total += factor * bubble(x, i - k) * bubble(y, j - m) * layer(s, steep, k + m)
    return AMPLITUDE * total


class Layer(NamedTuple):
    """A deflection that is given.

    Attributes:
        steep: α.
    """

    steep: float = 20.0

    def scene(self, mesh: fl.mesh.SplineMesh) -> fl.Scene:
        """Clamped, under the load of that deflection."""
        scene = fl.Scene()
        shell = scene.add(fl.ThinShell(mesh, SECTION, name="plate"))
        for edge in EDGES:
            shell.clamp(edge)

        def load(x: Array) -> tuple[float, float, float]:
            at = float(x[0]), float(x[1]), self.steep
            fourth = deflection(*at, 4, 0) + 2.0 * deflection(*at, 2, 2) + deflection(*at, 0, 4)
            return 0.0, 0.0, float(STIFFNESS[0, 0]) * fourth

        scene.add(fl.AreaLoad(shell, load))
        return scene

    def error(self, scene: fl.Scene, result: fl.StaticResult) -> float:
        """Relative, in the energy norm of bending."""
        (shell,) = scene.bodies
        x, w = hermite.gauss(POINTS)
        table = hermite.table(hermite.products(x, x))
        lying, moved = shell.model.hermite_vectors(), shell.model.hermite_vectors(result.frames[-1])
        positions = np.einsum("ga,maj->mgj", table[:, hermite.VALUE], lying)
        a, b = shell.model.sizes[:, 0], shell.model.sizes[:, 1]
        spans = np.stack([a * a, b * b, a * b])[:, :, np.newaxis]
        found = np.einsum("gka,ma->kmg", table[:, hermite.BENT_ALONG :], moved[:, :, 2]) / spans
        at = np.vectorize(deflection)
        orders = (2, 0), (0, 2), (1, 1)
        true = np.stack([at(positions[..., 0], positions[..., 1], self.steep, *k) for k in orders])
        twice = np.array([1.0, 1.0, 2.0])[:, np.newaxis, np.newaxis]
        weights = (a * b)[:, np.newaxis] * np.outer(w, w).ravel()
        fields = np.stack([twice * (found - true), twice * true])
        squares = np.einsum("fimg,ij,fjmg,mg->f", fields, STIFFNESS, fields, weights, optimize=True)
        return float(np.sqrt(squares[0] / squares[1]))


class Force(NamedTuple):
    """That of the demo."""

    def scene(self, mesh: fl.mesh.SplineMesh) -> fl.Scene:
        """Hinged."""
        return adaptive_splines.plate(mesh)

    def error(self, scene: fl.Scene, result: fl.StaticResult) -> float:
        """Relative, of the energy."""
        return adaptive_splines.true_error(scene, result)


def run(
    case: Layer | Force, mesh: fl.mesh.SplineMesh, part: float, tolerance: float, most: int
) -> Iterator[tuple[fl.adaptivity.SpaceError, fl.mesh.SplineMesh, int, float]]:
    """Meshes with so much of the squared error cut each time: estimate, unknowns, true error."""
    while True:
        scene = case.scene(mesh)
        unknowns = 6 * len(scene.bodies[0].frames)
        if unknowns > most:
            return
        result = fl.statics(scene)
        found = fl.adaptivity.space_error(result, scene.bodies[0], scene)
        error = case.error(scene, result)
        yield found, mesh, unknowns, error
        if error <= tolerance:
            return
        mesh = fl.adaptivity.refine(mesh, found.worst(part))


def main() -> None:
    """Two tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--case", choices=("layer", "force"), default="layer")
    parser.add_argument("--steep", type=float, default=20.0)
    parser.add_argument("--cells", type=int, default=8)
    parser.add_argument("--tolerance", type=float, default=0.003)
    parser.add_argument("--most", type=int, default=60_000)
    parser.add_argument("--png")
    given = parser.parse_args()
    case = Layer(given.steep) if given.case == "layer" else Force()
    for way, part in (("equal cells", 1.0), ("cut by the estimate", 0.5)):
        print(f"{way}\n| cells | sizes | unknowns | true error | order | estimated over true |")
        before = None
        for found, mesh, n, e in run(case, square(given.cells), part, given.tolerance, given.most):
            order = f"{np.log(e / before[1]) / np.log(n / before[0]):.2f}" if before else ""
            sizes = len(np.unique(mesh.levels))
            print(
                f"| {len(mesh.cells)} | {sizes} | {n} | {100 * e:.3g} % | {order} | "
                f"{found.relative / e:.2f} |",
                flush=True,
            )
            before = n, e
        if given.png:
            found.picture(given.png)


if __name__ == "__main__":
    main()
