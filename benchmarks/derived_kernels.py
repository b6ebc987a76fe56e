"""Elements with derived forces, to compare with the hand-written ones.

- **Corners of discrete rods** by the general kernel of small energies. The axes of an edge are
  derived vectors: those of the frame of its first node, rotated by the smallest rotation. Strains
  are a function of the nine scalar products of the axes of both edges.
- **Thin shells** by the general kernel of small energies. All strains of a cell, assumed ones and
  those at quadrature points, are those of a single point, whose stiffness couples them: the kernel
  has no strains sampled at other points.
- **Reduced-order bodies** by forward-mode derivatives of the energy along each unknown, as the
  hand-written tangent stiffness has them of the forces.
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

import fem_lie as fl
from fem_lie.bodies.reduced.assembly import ReducedAssembly, _cell, _kind
from fem_lie.bodies.thin_shells.assembly import ThinShellAssembly
from fem_lie.elements.rods.bends import Springs
from fem_lie.elements.rods.corners import Corners
from fem_lie.elements.thin_shells.bicubic import unloaded
from fem_lie.elements.thin_shells.nodal_coordinates import COORDINATES, CORNERS
from fem_lie.extend import CELL_SIGNATURE, CellFunctions, NodeType, callback, cell, compiled, tuples
from fem_lie.forms.cell_sums import CellSum
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE
from fem_lie.forms.small_energy.assembly import ElementAssembly
from fem_lie.lie.node_types.floating_coordinates import coordinates
from fem_lie.lie.node_types.forces import push_forward

_RULE = fl.elements.BicubicHermite().rule()
_N1, _N2, _N3, _G = _RULE.counts
_SAMPLES = _N1 + _N2 + _N3
_LINEAR = len(_RULE.table)
_STRAINS = _SAMPLES + 6 * _G


@compiled
def _unit_normal(slopes: tuple[Any, ...]) -> Any:
    """Unit normal of two tangents."""
    m = tuples.cross(slopes[:3], slopes[3:])
    return tuples.scaled(1.0 / math.sqrt(tuples.dot(m, m)), m)


def _products() -> list[tuple[int, int, int, float]]:
    """Strain, both vectors and factor of each product; derivatives at points come first."""
    first, second = 5 * _G, 5 * _G + _N1
    third = second + _N2
    found = [(s, first + s, first + s, 0.5) for s in range(_N1)]
    found += [(_N1 + s, second + s, second + s, 0.5) for s in range(_N2)]
    found += [(_N1 + _N2 + s, third + s, third + _N3 + s, 1.0) for s in range(_N3)]
    for g in range(_G):
        r = [g + k * _G for k in range(5)]
        n, at = _LINEAR + g, _SAMPLES + g
        found += [(at, r[0], r[0], 0.5), (at + _G, r[1], r[1], 0.5), (at + 2 * _G, r[0], r[1], 1.0)]
        found += [(at + (3 + k) * _G, r[2 + k], n, -(1.0 + (k == 2))) for k in range(3)]
    return found


ELEMENT = fl.extend.element(
    [NodeType.SURFACE_GRADIENT] * CORNERS + [NodeType.MIXED_DERIVATIVE] * CORNERS,
    _products(),
    vectors=_LINEAR,
    strains=_STRAINS,
    derive=_unit_normal,
    inputs=[(g, _G + g) for g in range(_G)],
)


@callback(CELL_SIGNATURE)
def energy_of_cell(A: Any, w: Any, h: Any) -> None:
    """Energy of a cell."""
    cell.add_energy(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def forces_of_cell(A: Any, w: Any, h: Any) -> None:
    """Forces of a cell."""
    cell.add_forces(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def tangent_of_cell(A: Any, w: Any, h: Any) -> None:
    """Tangent stiffness of a cell."""
    cell.add_tangent_at_stress(ELEMENT, A, w)


@callback(CELL_SIGNATURE)
def stress_of_cell(A: Any, w: Any, h: Any) -> None:
    """Linearised stress of a cell."""
    cell.update_stress(ELEMENT, A, w, h)


FUNCTIONS = CellFunctions(energy_of_cell, forces_of_cell, tangent_of_cell, stress_of_cell)


def _fields(rule: Any) -> np.ndarray:
    """Six strains at each point from all strains of a cell, shape (g, 6, strains)."""
    found = np.zeros((_G, 6, _STRAINS))
    starts = (0, _N1, _N1 + _N2)
    for k, (start, spread) in enumerate(zip(starts, rule.spread, strict=True)):
        found[:, k, start : start + spread.shape[1]] = (1.0 - rule.share) * spread
    for g in range(_G):
        own = [_SAMPLES + k * _G + g for k in range(6)]
        found[g, range(6), own] = [rule.share] * 3 + [1.0] * 3
    return found


def thin_shell(body: Any) -> ElementAssembly:
    """Assembly of the model of a thin shell without hanging corners."""
    by_hand, rule = ThinShellAssembly([body]), body.formulation.rule()
    q = body.vectors()
    sampled, strains, z = unloaded(rule, q)
    areas = np.linalg.norm(np.cross(z[:, :, 0], z[:, :, 1]), axis=-1)
    areas = (areas * body.formulation.weights())[..., np.newaxis, np.newaxis]
    weighted = by_hand.stiffness[:, np.newaxis] * areas
    D = np.einsum("mgia,mgij,mgjb->mgab", by_hand.turned, weighted, by_hand.turned)
    fields = _fields(rule)
    C = np.einsum("gas,mgab,gbt->mst", fields, D, fields, optimize=True)
    rest = np.hstack([sampled, strains.transpose(0, 2, 1).reshape(len(q), -1)])
    first = _N1 + _N2 + 2 * _N3
    table = np.concatenate([rule.table[first:], rule.table[:first]])
    T = (table @ body.hermite_matrices())[:, np.newaxis, :, COORDINATES]
    parameters = np.hstack([rest, C.reshape(len(q), -1)])[:, np.newaxis]
    data = fl.extend.cell_data(ELEMENT, T, parameters)
    return ElementAssembly(ELEMENT, FUNCTIONS, body.connectivity, data, len(body.frames))


@compiled
def _rotated_axis(inputs: tuple[Any, ...]) -> Any:
    """Axis of a frame, rotated by the smallest rotation from its first axis to an edge."""
    edge, first, axis = inputs[:3], inputs[3:6], inputs[6:]
    t = tuples.scaled(1.0 / math.sqrt(tuples.dot(edge, edge)), edge)
    turn = tuples.cross(first, t)
    once = tuples.cross(turn, axis)
    twice = tuples.scaled(1.0 / (1.0 + tuples.dot(first, t)), tuples.cross(turn, once))
    return tuples.plus(axis, tuples.plus(once, twice))


@compiled
def _twist_and_curvature(Q: tuple[Any, ...], parameters: tuple[float, ...]) -> Any:
    """Twist and both curvatures from the products of the axes of two edges, row by row."""
    X = 1.0 + Q[0]
    twist = 2.0 * math.atan((Q[7] - Q[5]) / (X + Q[4] + Q[8]))
    return twist, (Q[2] - Q[6]) / X, (Q[3] - Q[1]) / X


CORNER = fl.extend.element(
    [NodeType.FRAME] * 3,
    [(8 + i, 11 + j) for i in range(3) for j in range(3)],
    vectors=8,
    strains=3,
    strain=_twist_and_curvature,
    derive=_rotated_axis,
    inputs=[(4 * side, 4 * side + 1, 4 * side + k) for side in range(2) for k in (1, 2, 3)],
)


@callback(CELL_SIGNATURE)
def energy_of_corner(A: Any, w: Any, h: Any) -> None:
    """Energy of a spring between two edges."""
    cell.add_energy(CORNER, A, w)


@callback(CELL_SIGNATURE)
def forces_of_corner(A: Any, w: Any, h: Any) -> None:
    """Forces of a spring between two edges."""
    cell.add_forces(CORNER, A, w)


@callback(CELL_SIGNATURE)
def tangent_of_corner(A: Any, w: Any, h: Any) -> None:
    """Tangent stiffness of a spring between two edges."""
    cell.add_tangent_at_stress(CORNER, A, w)


class DerivedCorners(Springs):
    """Springs between the edges of discrete rods, whose forces and tangent are derived."""

    label = "discrete rods, derived"

    def __init__(self, corners: Corners, count: int) -> None:
        b = len(corners.nodes)
        own, start = corners.frames.astype(float), np.where(corners.frames[:, 1], 2, 1)
        T, every = np.zeros((b, 8, 3, 4)), np.arange(b)
        for first, end, node, at_node in ((0, 1, 0, own[:, 0]), (4, 2, start, own[:, 1])):
            T[:, first, end, 0] = 1.0
            T[every, first, node, 0] -= 1.0
            T[every, first, node, 1] = at_node
            for k in (1, 2, 3):
                T[every, first + k, node, k] = 1.0
        parameters = np.hstack([corners.natural, corners.stiffness.reshape(b, 9)])
        tables = T.reshape(b, 1, 8, 12)
        values = fl.extend.cell_data(CORNER, tables, parameters[:, np.newaxis])
        kernels = energy_of_corner, forces_of_corner, tangent_of_corner
        super().__init__(kernels, values, corners, count)


def corners_of(body: Any) -> DerivedCorners:
    """Springs between the edges of the model of a discrete rod."""
    return DerivedCorners(body.assemble([body]).further_terms[0].springs, len(body.frames))


_STEP = 1e-30


@compiled
def _energy(K: Any, Q: Any, z: Any) -> Any:
    """Energy ``½ e·K e`` of ``e_a = z_a + ½ Q_abc z_b z_c``, ``Q`` at ``[c, a, b]``."""
    m = len(z)
    e = z.copy()
    for c in range(m):
        for a in range(m):
            for b in range(m):
                e[a] += 0.5 * Q[c, a, b] * z[b] * z[c]
    found = 0.0 * e[0]
    for a in range(m):
        for b in range(m):
            found += 0.5 * e[a] * K[a, b] * e[b]
    return found


@callback(UFCX_SIGNATURE)
def derived_forces(A: Any, w: Any, c: Any, x: Any, entity: Any, permutation: Any) -> None:
    """Forces on the nodes of a reduced-order body."""
    cell = _cell(w, c)
    q, interfaces, k = cell.q, cell.interfaces, cell.q.shape[0]
    out, unit, pushed = numba.carray(A, (k, 6)), np.empty(6), np.empty((4, 3))
    moved, z = q.astype(np.complex128), np.zeros(cell.K.shape[0], np.complex128)
    for i in range(k):
        for column in range(6):
            unit[:] = 0.0
            unit[column] = 1.0
            push_forward(_kind(i, interfaces.shape[0]), q[i], unit, pushed)
            moved[i] = q[i] + 1j * _STEP * pushed
            coordinates(moved, interfaces, z)
            out[i, column] += _energy(cell.K, cell.Q, z).imag / _STEP
        moved[i] = q[i]


class DerivedReduced(ReducedAssembly):
    """Reduced-order bodies whose forces are derived."""

    def __init__(self, bodies: Any) -> None:
        super().__init__(bodies)
        nowhere = np.zeros((len(bodies), 1))
        self._forces = CellSum(
            self.cells, derived_forces.address, self._values, self._sizes, nowhere
        )


def reduced_body(body: Any) -> DerivedReduced:
    """Assembly of the model of a reduced-order body."""
    return DerivedReduced([body])


TERMS = {
    "corners of a discrete rod": corners_of,
    "thin shell": thin_shell,
    "reduced body": reduced_body,
}
