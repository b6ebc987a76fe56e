"""Residual errors of shells: jumps of stress resultants across the edges of cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import basix
import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.adapt.estimates.edge_layers import EdgeLayers
from fem_lie.adapt.estimates.estimate import ElementErrors
from fem_lie.bodies.shells.shell import Shell
from fem_lie.mesh.surfaces import KINK_ANGLE
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.results.stresses.nodal_values import axes_along, extrapolation, unit
from fem_lie.results.stresses.shell_quantities import turned
from fem_lie.results.stresses.shell_stress import ShellStress, StressPlaces, between, integration
from fem_lie.scene import Scene

_OPPOSITE = {"quadrilateral": (3, 2, 1, 0)}  # of the edges in the order of basix
_SHARE = {"quadrilateral": 1 / 24, "triangle": 1 / 12}
"""Of area times square of the jump: exact where the stress that is missed is linear."""


def shell_residual(
    result: Result | StaticResult, shell: Shell, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    """Errors from the jumps J of stress at the middles of edges, in the axes of each edge.

    They are::

        η² = c A Σ_edges J·D⁻¹J,    c = 1/24 for quadrilaterals, 1/12 for triangles.

    In elements of first degree edges dominate what is within (C. Carstensen & R. Verfürth, SIAM J.
    Numer. Anal. 36 (1999) 1571), and for even meshes jumps give the error exactly (I. Babuška &
    D.-H. Yu, RAIRO 21 (1987)): c is what makes η that of a solution of second degree, on
    rectangles, and on triangles with edges in three directions.

    Local frames make it simple: both sides have their resultants along axes that move with them, so
    the jump is taken across a bend, and rigid motion is not in it. At a border, a kink or where the
    section changes, an edge has no other side; then the opposite one counts twice, or on triangles
    those that are left count for all. What is missed in layers along borders comes to it, see
    :mod:`~fem_lie.adapt.estimates.edge_layers`.

    Raises:
        ValueError: The cells have nodes besides their corners, or no edge in common; the shell is
            not in that result, or there is no such step.
    """
    edges, stress = ShellEdges.of(shell), ShellStress.of(shell)
    nodes = nodes_in(result.info, shell)
    return [edges.errors(stress(result.frames[step][nodes])) for step in steps]


@dataclass(frozen=True, eq=False)
class ShellEdges:
    """What does not change with the state.

    Attributes:
        to_edges: From values at the points of integration to the middles of c edges, (c, g).
        turns: To the axes of the edges, shape (m, c, 8, 8).
        compliance: ``D⁻¹`` along these axes, shape (m, c, 8, 8).
        a: Cell and edge of one side of what is common, numbers in (m c), shape (e,).
        b: Of the other side.
        areas: Of what is carried by the points, shape (m, g).
        shares: Of area times square of each jump, shape (m, c).
        plain: ``D⁻¹`` of each cell, shape (m, 8, 8).
        layers: Of the edges without another side.
    """

    to_edges: Array
    turns: Array
    compliance: Array
    a: Indices
    b: Indices
    areas: Array
    shares: Array
    plain: Array
    layers: EdgeLayers

    @classmethod
    def of(cls, shell: Shell) -> ShellEdges:
        """Those of a shell, found once."""
        if shell not in _EDGES:
            _EDGES[shell] = cls._found(shell)
        return _EDGES[shell]

    @classmethod
    def _found(cls, shell: Shell) -> ShellEdges:
        mesh = shell.own_mesh
        if mesh.degree != 1:
            raise ValueError(
                f"residual errors are for cells of degree 1, those of {shell.label} are of degree "
                f"{mesh.degree}: take Recovery()"
            )
        ends = np.array(basix.topology(basix.CellType[mesh.cell])[1], dtype=np.int64)
        places = StressPlaces.in_sections(shell, KINK_ANGLE)
        a, b = _common(places.patches.number, ends)
        m, c = len(mesh.cells), len(ends)
        known = np.isin(np.arange(m * c), [a, b])
        shares = _shares(mesh.cell, known.reshape(m, c))
        if not shares.any(axis=1).all():
            raise ValueError(
                f"residual errors need cells with smooth neighbours, cell "
                f"{np.flatnonzero(~shares.any(axis=1))[0]} of {shell.label} has none"
            )
        turns = _turns(shell, ends)
        plain = np.linalg.inv(shell.stiffness)
        inverse = np.linalg.inv(turns)
        compliance = np.einsum("mcki,mkl,mclj->mcij", inverse, plain, inverse)
        rule, _ = integration(shell)
        to_edges = extrapolation(mesh, rule)[ends].mean(axis=1)
        layers = EdgeLayers.of(shell, places, ends, np.flatnonzero(~known), turns)
        return cls(to_edges, turns, compliance, a, b, places.areas, shares, plain, layers)

    def errors(self, stress: Array) -> ElementErrors:
        """From stress at the points of integration, in the axes of the sections, (m, g, 8)."""
        m, c = self.shares.shape
        at_edges = np.matmul(self.turns, (self.to_edges @ stress)[..., np.newaxis])[..., 0]
        flat, jumps = at_edges.reshape(m * c, 8), np.zeros((m * c, 8))
        jumps[self.a] = flat[self.b] - flat[self.a]
        jumps[self.b] = jumps[self.a]
        rows = jumps.reshape(m, c, 1, 8)
        squares = ((rows @ self.compliance) * rows).sum(axis=(2, 3))
        energy = ((stress @ self.plain) * stress).sum(axis=2)
        layers = self.layers.squares(stress, at_edges, jumps.reshape(m, c, 8))
        return ElementErrors(
            self.areas.sum(axis=1) * (squares * self.shares).sum(axis=1) + layers,
            float((energy * self.areas).sum()),
        )


_EDGES: WeakKeyDictionary[Shell, ShellEdges] = WeakKeyDictionary()


def _common(number: Indices, ends: Indices) -> tuple[Indices, Indices]:
    """Pairs of edges of cells (numbers in m c) between smooth neighbours."""
    pairs = np.sort(number[:, ends], axis=2).reshape(-1, 2)
    _, edge, met = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(edge.ravel(), kind="stable")
    twice = order[met[edge.ravel()[order]] == 2].reshape(-1, 2)
    return twice[:, 0], twice[:, 1]


def _shares(cell: str, known: Flags) -> Array:
    """Share of each edge (m, c), where some are without another side."""
    if cell in _OPPOSITE:
        shares = known * (2.0 - known[:, _OPPOSITE[cell]])
    else:
        shares = known.astype(np.float64)
    total = shares.sum(axis=1, keepdims=True)
    scale = np.divide(known.shape[1], total, out=np.zeros_like(total), where=total > 0)
    return np.asarray(_SHARE[cell] * shares * scale)


def _turns(shell: Shell, ends: Indices) -> Array:
    """From components along the axes of the sections to those along edges, (m, c, 8, 8)."""
    mesh = shell.own_mesh
    normals = unit(mesh.normals[:, ends].sum(axis=2))
    along = np.diff(mesh.points[mesh.cells[:, ends]], axis=2)[:, :, 0]
    # one direction for both sides
    first, second = np.moveaxis(mesh.cells[:, ends], 2, 0)
    along[first > second] *= -1.0
    section = axes_along(normals, shell.axes[:, np.newaxis])
    cosine, sine = between(section, axes_along(normals, along))
    basis = turned(np.eye(8), cosine[..., np.newaxis], sine[..., np.newaxis])
    return np.asarray(np.swapaxes(basis, 2, 3), dtype=np.float64)
