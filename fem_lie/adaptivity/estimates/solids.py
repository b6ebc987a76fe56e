"""Recovered stress of solids: polynomials through the best stress of the cells around vertices.

In each cell those of its vertices are blended by linear shape functions. Around a vertex errors of
cells of any shape cancel, around the middle of a tetrahedron they do not: with patches of
tetrahedra the estimate was half of the error. The stress is that of Piola and Kirchhoff, in axes of
the unloaded body, so that rigid motion does not enter; the error is in the norm of the tangent
moduli in the middle of each cell.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.adaptivity.estimates.patches import (
    Pairs,
    Patches,
    complete_powers,
    shared_nodes,
    tensor_powers,
)
from fem_lie.adaptivity.estimates.stress_fields import StressFields
from fem_lie.bodies.solids.solid import Solid
from fem_lie.elements.solids.element import Strains
from fem_lie.mesh.shapes import nodes_of, rule, tabulated
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.results.stresses.solid_stress import CellValues
from fem_lie.results.stresses.stress_free import require_no_strains
from fem_lie.scene import Scene

_LEAST = 8
"""Least number of cells of a patch."""


def solid_fields(
    result: Result | StaticResult, solid: Solid, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Stress of the cells and recovered stress in some states.

    Raises:
        ValueError: The solid is not in that result, or has stress-free strains there.
    """
    require_no_strains(result, solid, "errors of solids cannot be estimated")
    model, nodes = solid.model, nodes_in(result.info, solid)
    cell, degree = model.mesh.cell, model.degree
    points, w = rule(cell, 2 * degree + 1)
    best, _ = rule(cell, 2 * degree - 1 if cell == "hexahedron" else degree)
    middle = nodes_of(cell, 1).mean(axis=0, keepdims=True)
    stress = CellValues(solid, lambda *given: Strains.piola(*given)[0])
    moduli = CellValues(solid, lambda *given: Strains.piola(*given)[1]).at(middle)
    own, samples = stress.at(points), stress.at(best)
    x = model.positions[model.connectivity]
    slopes = np.einsum("kgi,mij->mgkj", tabulated(cell, degree, points)[1:], x)
    volumes = np.abs(np.linalg.det(slopes)) * w
    recovered = _VertexPatches(solid, points, best)
    found = []
    for k in steps:
        frames = np.ascontiguousarray(result.frames[k][nodes])
        compliance = np.asarray(np.linalg.inv(moduli(frames)[:, 0]), dtype=np.float64)
        found.append(StressFields(own(frames), recovered(samples(frames)), volumes, compliance))
    return found


class _VertexPatches:
    """Fits around vertices, blended in each cell by its linear shape functions."""

    def __init__(self, solid: Solid, points: Array, best: Array) -> None:
        """Set up the fits.

        Args:
            solid: The solid.
            points: Reference points at which stress is recovered, shape (q, 3).
            best: Reference points at which it is best, shape (g, 3).
        """
        model = solid.model
        cell, degree = model.mesh.cell, model.degree
        x = model.positions[model.connectivity]
        count = len(nodes_of(cell, 1))
        corners = x[:, :count]
        self._number = shared_nodes(model.connectivity[:, :count], model.parameters)
        pairs = Pairs.around_nodes(self._number, _LEAST)
        self._origins = np.empty((len(pairs.first), 3))
        self._origins[self._number] = corners
        # axes and sizes of the cells around
        away = corners[pairs.elements] - self._origins[pairs.patches, np.newaxis]
        spread = np.add.reduceat(away.swapaxes(1, 2) @ away, pairs.first, axis=0)
        sizes = count * np.diff([*pairs.first, len(pairs.patches)])
        self._scale = np.linalg.inv(np.linalg.cholesky(spread / sizes[:, np.newaxis, np.newaxis]))
        samples = tabulated(cell, degree, best)[0] @ x
        # stress of hexahedra of degree 2 has quadratic terms in products of coordinates, too
        chosen = tensor_powers if (cell, degree) == ("hexahedron", 2) else complete_powers
        within = self._from(pairs.patches, samples[pairs.elements])
        self._patches = Patches.of(pairs, within, chosen(3, degree))
        self._points = tabulated(cell, degree, points)[0] @ x
        self._shapes = tabulated(cell, 1, points)[0]

    def _from(self, patches: Indices, positions: Array) -> Array:
        """Coordinates of positions (p, g, 3) in patches (p,)."""
        away = positions - self._origins[patches, np.newaxis]
        return np.asarray(away @ self._scale[patches].swapaxes(1, 2))

    def __call__(self, best: Array) -> Array:
        """Recovered stress (m, q, b) from the best one (m, g, b)."""
        fits = self._patches.coefficients(best[self._patches.pairs.elements])
        found = np.zeros((*self._points.shape[:2], best.shape[2]))
        for k in range(self._number.shape[1]):
            patches = self._number[:, k]
            values = self._patches.at(patches, self._from(patches, self._points)) @ fits[patches]
            found += self._shapes[:, k, np.newaxis] * values
        return found
