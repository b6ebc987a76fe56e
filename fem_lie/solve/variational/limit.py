"""Limit of stability of vibrations of bodies that rotate; compiled.

Forces are those of mean positions over a step, ``x̄ = ½ (x₀ + x₁)``. Where a stiff direction rotates
by ``θ`` in a step of size ``h``, vibrations along it of the angular frequency ``ω`` grow if::

    h ω θ > 4

which is the closed form of a mass on a spring that rotates. A pair of nodes of a cell vibrates
along the line between them, whose rotation is ``θ``. In the fastest vibration of equal cells all
neighbours go to opposite sides. With the diagonals ``k`` of the stiffness and ``m`` of the mass
matrix of linear shape functions it has ``ω² = 4 k/m``, along lines, surfaces and solids; with bars
in a row and masses ``m'`` between neighbours ``ω² = 2 k/(m − 2 m')``. The smaller of the two is an
estimate for other cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.forms.term import Term
from fem_lie.lie.node_types import has_position
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.lie.tuples import cross, dot, load_row, minus
from fem_lie.system.equations import Equations

LIMIT = 4.0
"""Largest ``h ω θ`` of vibrations that do not grow."""
DIVIDES = "whole ones did not converge, or vibrations of bodies that rotate grow in them"
"""Why steps are divided."""


class Pairs(NamedTuple):
    """Pairs of nodes that vibrate along the line between them.

    Attributes:
        nodes: Both nodes of each pair, shape (p, 2).
        squares: Square of their largest angular frequency, shape (p,).
    """

    nodes: Indices
    squares: Array

    @classmethod
    def of(cls, equations: Equations) -> Pairs:
        """Pairs of nodes of the cells of all bodies, at the start."""
        unknowns, known = equations.unknowns, equations.arrays
        elastic = [term for term in known.terms if term.of_bodies and not term.load]
        count, positioned = unknowns.moving, has_position(unknowns.kinds)
        pairs = [np.zeros((0, 2), dtype=np.int64), *(np.column_stack(t.pairs) for t in elastic)]
        nodes = np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0).astype(np.int64)
        chosen = (nodes[:, 0] != nodes[:, 1]) & positioned[nodes].all(axis=1)
        stiffness = _node_stiffness(elastic, equations.start.frames, count)
        masses = _alternating_masses(known.inertia)
        free = (masses > 0.0) & positioned & ~unknowns.held[:, :3].all(axis=1)
        squares = np.zeros(count)
        squares[free] = 4.0 * np.linalg.eigvalsh(stiffness[free])[:, -1] / masses[free]
        nodes = np.ascontiguousarray(nodes[chosen])
        return cls(nodes, squares[nodes].max(axis=1, initial=0.0))


def _node_stiffness(terms: Sequence[Term], H: Array, count: int) -> Array:
    """Stiffness of translations of each node, (n, 3, 3)."""
    K = np.zeros((count, 3, 3))
    for term in terms:
        rows, columns = term.pairs
        kept, own = term.workspace(), rows == columns
        term.add_forces(H, np.zeros((count, 6)), kept)
        np.add.at(K, rows[own], term.tangent(H, kept)[own, :3, :3])
    return np.asarray(0.5 * (K + K.swapaxes(1, 2)))


def _alternating_masses(inertia: Inertia) -> Array:
    """The larger one of ``m`` and ``2 (m − Σ|m'|)`` of each node, (n,)."""
    rows = np.repeat(np.arange(len(inertia.indptr) - 1), np.diff(inertia.indptr))
    own, masses = rows == inertia.indices, inertia.blocks[:, 0, 0]
    diagonal, others = np.zeros((2, len(inertia.indptr) - 1))
    np.add.at(diagonal, rows[own], masses[own])
    np.add.at(others, rows[~own], np.abs(masses[~own]))
    return np.maximum(diagonal, 2.0 * (diagonal - others))


@compiled
def vibrations_grow(nodes: Indices, squares: Array, start: Array, end: Array, h: float) -> bool:
    """Whether vibrations of any pair grow in a step.

    Args:
        nodes: See :class:`Pairs`.
        squares: See :class:`Pairs`.
        start: Nodal coordinates at the start, (≥ n, 4, 3).
        end: Nodal coordinates at the end, (≥ n, 4, 3).
        h: Step size.
    """
    for p in range(nodes.shape[0]):
        i, j = nodes[p, 0], nodes[p, 1]
        before = minus(load_row(start[j], 0), load_row(start[i], 0))
        after = minus(load_row(end[j], 0), load_row(end[i], 0))
        across = cross(before, after)
        rotated = dot(across, across)
        limit = LIMIT * LIMIT * dot(before, before) * dot(after, after)
        if h * h * squares[p] * rotated > limit:
            return True
    return False
