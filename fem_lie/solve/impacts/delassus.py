"""Delassus operator ``B M⁻¹ B̄ᵀ`` of contacts, with ``M⁻¹`` by the factors of a coupled matrix.

Nodes that no element, joint or spring couples are in different islands of the matrix. A right-hand
side of one island does not affect the others, so that one solution serves one contact in each
island: the number of solutions is the largest number of contacts of any island. Free bodies are
islands of one node each, and their part of the operator is the block-diagonal inverse of the mass
matrix.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.contact.cones.jacobian import (
    BlockRows,
    add_local_forces,
    take_local_velocities,
)
from fem_lie.contact.cones.sweeps import Cones, begin, cones_of, workspaces_of
from fem_lie.linear.saddle_point import KKT

_YIELD = 1e-10
"""Relative velocity per unit impulse below which joints fix a contact."""


def islands_of(matrix: KKT, whole: bool) -> tuple[Indices, Indices]:
    """Islands of the nodes, shape (n,), and of the constraints, shape (m,).

    Args:
        matrix: Iteration matrix of the nodes with the constraints.
        whole: Whether everything is one island, because nodes are coupled outside of that matrix.
    """
    n, border, pointers = len(matrix.held), matrix.incidences, matrix.indptr
    m = len(border.ptr) - 1
    if whole or matrix.low_rank is not None or matrix.correction is not None:
        return np.zeros(n, dtype=np.int64), np.zeros(m, dtype=np.int64)
    rows = np.concatenate([np.repeat(np.arange(n), np.diff(pointers)), n + border.rows])
    columns = np.concatenate([matrix.indices, border.nodes])
    graph = sp.coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(n + m, n + m))
    labels = connected_components(graph, directed=False)[1].astype(np.int64)
    return labels[:n], labels[n:]


class Delassus:
    """Numbering of the solutions for contacts, constant in a step.

    Attributes:
        touched: Moving nodes of any contact, shape (t,).
    """

    def __init__(
        self, rows: BlockRows, islands: tuple[Indices, Indices], kinds: Indices, free: Flags
    ) -> None:
        """Number the solutions.

        Args:
            rows: Contact Jacobian of k contacts; only its structure is used.
            islands: See :func:`islands_of`.
            kinds: Types of the moving nodes, shape (n,).
            free: Unknowns that are not fixed, shape (6 n,).
        """
        self._kinds, self._free = kinds, free.reshape(-1, 6)
        label, self._labels = islands[0], islands
        k, n = len(rows.first) - 1, len(label)
        contacts = np.repeat(np.arange(k), np.diff(rows.first))
        self._moving = np.flatnonzero(rows.nodes[: len(contacts)] < n)
        contact, node = contacts[self._moving], rows.nodes[self._moving]
        # a number for each contact of an island
        groups, of = np.unique(label[node] * k + contact, return_inverse=True)
        island, who = groups // k, groups % k
        number = np.arange(len(groups)) - np.searchsorted(island, island)
        self._solutions = int(number.max(initial=-1)) + 1
        self._node, self._number = node, number[of]
        last = max(int(each.max(initial=-1)) for each in islands) + 1
        self._contact_of = np.full((last, self._solutions), k)
        self._contact_of[island, number] = who
        # the response to an impulse is needed at the contacts of its own islands
        touched = np.unique(node)
        self.touched = touched[np.argsort(label[touched], kind="stable")]
        own = np.empty(n, dtype=np.int64)
        own[self.touched] = np.arange(len(touched))
        ends = np.concatenate([[0], np.cumsum(np.bincount(contact, minlength=k))])
        self._rows = ends, own[node]
        found = label[self.touched]
        start, stop = np.searchsorted(found, island), np.searchsorted(found, island, "right")
        order = np.argsort(who, kind="stable")
        counts = (stop - start)[order]
        skipped = np.repeat(start[order] - np.cumsum(counts) + counts, counts)
        at = np.arange(counts.sum()) + skipped
        ends = np.concatenate([[0], np.cumsum(np.bincount(who, stop - start, k).astype(np.int64))])
        self._pushes, self._numbers = (ends, at), np.repeat(number[order], counts)
        self._workspaces = workspaces_of(k, len(touched))

    def solve(
        self, forces: Array, H: Array, solve: Callable[[Array], tuple[Array, Array]]
    ) -> Responses:
        """Responses to unit impulses of all contacts.

        Args:
            forces: Rows of ``B̄``, in the blocks of the contact Jacobian, shape (b, 3, 6).
            H: Coordinates of the nodes, in whose axes the unknowns are.
            solve: ``M⁻¹`` with constraints, from forces (6 n, s) to unknowns and multipliers.
        """
        n, s = len(self._free), self._solutions
        f = np.zeros((n, 6, s, 3))
        blocks = self._node, self._number, forces[self._moving]
        add_local_forces(*blocks, self._kinds, H, self._free, f)
        x, multipliers = solve(f.reshape(6 * n, 3 * s))
        x, of_joints = x.reshape(n, 6, s, 3), multipliers.reshape(len(multipliers), s, 3)
        (ends, at), pushes = self._pushes, np.empty((len(self._numbers), 3, 6))
        blocks = self.touched[at], self._numbers, x
        take_local_velocities(*blocks, self._kinds, H, self._free, pushes)
        return Responses(self, x, of_joints, BlockRows(ends, at, pushes))

    def problem(self, rows: Array, responses: Responses, friction: Array) -> Cones:
        """Cone problem of the contacts with Jacobian ``B``, shape (b, 3, 6).

        ``q`` and ``r`` are zero.
        """
        own = BlockRows(*self._rows, rows[self._moving])
        problem = cones_of(own, responses.pushes, len(self.touched), self._workspaces)
        problem.friction[:] = friction
        begin(problem, len(problem.friction))
        traces = np.abs(np.trace(problem.own, axis1=1, axis2=2))
        problem.soft[:] = _YIELD * np.maximum(traces, 1e-6 * traces.max(initial=0.0))
        return problem

    def impulses_on_nodes(self, r: Array) -> Array:
        """Contact impulses (k, 3) by node and solution, (n, s, 3)."""
        return self._impulses(r, self._labels[0])

    def impulses_on_constraints(self, r: Array) -> Array:
        """Contact impulses (k, 3) by constraint and solution, (m, s, 3)."""
        return self._impulses(r, self._labels[1])

    def _impulses(self, r: Array, islands: Indices) -> Array:
        whole = np.concatenate([r, np.zeros((1, 3))])
        return np.asarray(whole[self._contact_of[islands]])


class Responses:
    """Unknowns and multipliers due to unit impulses of contacts.

    Attributes:
        pushes: Rows of ``M⁻¹ B̄ᵀ``, nodes in the order of :attr:`Delassus.touched`.
    """

    def __init__(
        self, of: Delassus, unknowns: Array, multipliers: Array, pushes: BlockRows
    ) -> None:
        """Store the responses; see :meth:`Delassus.solve`."""
        self._of, self._unknowns, self._multipliers, self.pushes = of, unknowns, multipliers, pushes

    def moved(self, r: Array) -> Array:
        """Unknowns due to impulses (k, 3), shape (6 n,)."""
        return np.einsum("nask,nsk->na", self._unknowns, self._of.impulses_on_nodes(r)).ravel()

    def reactions(self, r: Array) -> Array:
        """Multipliers due to impulses (k, 3), shape (m,)."""
        return np.einsum("msk,msk->m", self._multipliers, self._of.impulses_on_constraints(r))
