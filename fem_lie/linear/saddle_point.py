"""The sparse saddle-point (KKT) matrix of a scene: 6×6 blocks of node pairs and constraint blocks.

::

    [ S      Bᵀ σ ]
    [ σ BT   0    ]

``σ`` is the scaling of the constraints, and ``T`` the derivative of twists in increments: with
``(BT)ᵀ`` as columns the iteration for a body that rotates by θ in a step would converge at the rate
θ/2. One compiled loop fills the values of a PETSc matrix. Held unknowns have unit rows and empty
columns, since a factorisation would treat stored zeros as coupling.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple, Protocol, TypeAlias

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.linear.domains.division import Division, Part
from fem_lie.linear.low_rank import LowRank, LowRankCorrection
from fem_lie.ranks.shared_nodes import SharedNodes

SOFTNESS = 1e-9
"""Compliance of redundant constraints in one iteration, relative to their own flexibility.

It makes the matrix regular, and the iteration still ends with all constraints satisfied.
"""


_NONE = 1e-14
"""Stiffness, over the largest one, that is round-off, as of rigid bodies in statics."""


def flexibility(diagonal: Array, units: Array) -> Array:
    """Inverse of a stiffness diagonal, (n, 6); a zero stiffness counts as the largest one.

    Args:
        diagonal: Stiffness, not negative, shape (n, 6).
        units: Unit of each unknown, which makes stiffness comparable; zero if held, (n, 6).
    """
    energy = diagonal * units**2
    stiffest = float(energy.max(initial=0.0))
    return np.asarray(
        units**2 / np.where(energy > _NONE * stiffest, energy, stiffest if stiffest > 0.0 else 1.0)
    )


@compiled
def _fill(
    pattern: tuple[Indices, Indices, Indices, Indices, Indices],
    blocks: Array,
    held: Flags,
    columns: Array,
    rows: Array,
    scale: Array,
    softness: Array,
    data: Array,
) -> None:
    bptr, bind, iptr, incident, lptr = pattern
    at = 0
    for i in range(bptr.shape[0] - 1):
        for k in range(6):
            if held[i, k]:
                data[at] = 1.0
                at += 1
            else:
                for b in range(bptr[i], bptr[i + 1]):
                    for n in range(6):
                        if not held[bind[b], n]:
                            data[at] = blocks[b, k, n]
                            at += 1
            for entry in range(iptr[i], iptr[i + 1]):
                c, incidence = incident[entry, 0], incident[entry, 1]
                data[at] = 0.0 if held[i, k] else columns[incidence, k] * scale[c]
                at += 1
    for c in range(lptr.shape[0] - 1):
        for incidence in range(lptr[c], lptr[c + 1]):
            for n in range(6):
                data[at] = rows[incidence, n] * scale[c]
                at += 1
        if len(softness):
            data[at] = -softness[c]
            at += 1


@compiled
def _clear_held(rows: Array, nodes: Indices, held: Flags) -> None:
    for incidence in range(rows.shape[0]):
        for k in range(6):
            if held[nodes[incidence], k]:
                rows[incidence, k] = 0.0


_Pattern: TypeAlias = tuple[Indices, Indices, Indices, Indices]
"""Row pointers and columns of node pairs, then pointers and incidences of each node."""


@compiled
def _count(pattern: _Pattern, held: Flags, lengths: Indices) -> None:
    """Number of entries of each row of nodes, shape (6 n,): see :func:`_set_columns`."""
    bptr, bind, iptr, _ = pattern
    for i in range(held.shape[0]):
        free = 0
        for b in range(bptr[i], bptr[i + 1]):
            for n in range(6):
                free += not held[bind[b], n]
        for k in range(6):
            lengths[6 * i + k] = (1 if held[i, k] else free) + iptr[i + 1] - iptr[i]


@compiled
def _set_columns(pattern: _Pattern, held: Flags, columns: npt.NDArray[np.int32]) -> None:
    """Columns of the rows of all nodes.

    A row has the free columns of its node's blocks, or its diagonal if it is held, and then the
    multipliers of its node.
    """
    bptr, bind, iptr, incident = pattern
    at = 0
    for i in range(held.shape[0]):
        for k in range(6):
            if held[i, k]:
                columns[at] = 6 * i + k
                at += 1
            else:
                for b in range(bptr[i], bptr[i + 1]):
                    for n in range(6):
                        if not held[bind[b], n]:
                            columns[at] = 6 * bind[b] + n
                            at += 1
            for entry in range(iptr[i], iptr[i + 1]):
                columns[at] = 6 * held.shape[0] + incident[entry, 0]
                at += 1


@compiled
def _find(bptr: Indices, bind: Indices, rows: Indices, columns: Indices, found: Indices) -> None:
    """Positions of node pairs in the pattern, −1 for nodes that do not move."""
    count = bptr.shape[0] - 1
    for p in range(rows.shape[0]):
        found[p] = -1
        if rows[p] < count and columns[p] < count:
            low, high = bptr[rows[p]], bptr[rows[p] + 1]
            while high - low > 1:
                middle = (low + high) // 2
                if bind[middle] <= columns[p]:
                    low = middle
                else:
                    high = middle
            found[p] = low


class Divisible(Protocol):
    """Fills a matrix, and can fill that of a subdomain as well."""

    def division(self, count: int) -> Division:
        """Division of cells and constraints into subdomains."""

    def divide(self, division: Division, rank: int) -> None:
        """Select the subdomain of a rank."""


class KKT:
    """Pattern and values of the saddle-point (KKT) matrix.

    Attributes:
        indptr: Row pointers of the pattern of node pairs, with ``indices``.
        matrix: The PETSc matrix; :meth:`fill` changes its values, :meth:`couple` replaces it.
        version: Version of the pattern.
        filled: Number of times that values of node pairs, not only of constraints, were set.
        units: Powers of two, shape (6 n + m,), that make rows and columns of one dimension.
        unit_rows: Whether a row is that of a held unknown, shape (6 n + m,).
        measure: Norm scaling of each multiplier, shape (m,).
        redundant: Whether constraints may be redundant.
        inactive: Whether a constraint does not act, shape (m,): its multiplier is zero.
        correction: Low-rank correction of solutions; ``None`` after values were filled.
        incidences: Incidences of the constraints with nodes.
        held: Unknowns of nodes that are zero, shape (n, 6).
        part: Part of this rank's subdomain, if the matrix is divided.
        divisible: Object that fills the matrix, and can fill that of a subdomain.
        splits: Whether that object puts couplings of many nodes by few sums into :attr:`low_rank`,
            from the next matrix on.
        low_rank: Part of the matrix that is not in its pattern.
        length: Power of two near the length of the model.
        shared: Nodes that other ranks have, too: the matrix is then the part of this rank of a sum.
    """

    shared: SharedNodes
    correction: LowRankCorrection | None = None
    part: Part | None = None
    divisible: Divisible | None = None
    splits = False
    low_rank: LowRank | None = None

    def __init__(
        self,
        pairs: list[tuple[Indices, Indices]],
        incidences: Incidences,
        held: Flags,
        *,
        units: Array,
        length: float,
        angular: Flags,
        redundant: bool = False,
        switched: bool = False,
    ) -> None:
        """Build the pattern.

        Args:
            pairs: Rows and columns of coupled node pairs. Nodes that do not move are left out; the
                diagonal is added.
            incidences: Incidences of the constraints with nodes.
            held: Unknowns of the nodes that are zero, shape (n, 6).
            units: Unit of each unknown of the nodes, shape (6 n,): the length of the model, or 1.
            length: Length of the model.
            angular: Whether a constraint has rotations only, shape (m,).
            redundant: Whether constraints may be redundant; they are then slightly compliant, see
                :data:`SOFTNESS`.
            switched: Whether constraints may be inactive, see :attr:`inactive`.
        """
        self.redundant, self._on_diagonal = redundant, redundant or switched
        m = len(incidences.ptr) - 1
        each = np.append(np.where(held.ravel(), 1.0, units), np.where(angular, 1.0, length))
        self.units: Array = 2.0 ** np.round(np.log2(each))
        self.length = float(2.0 ** np.round(np.log2(length)))
        self.unit_rows = np.append(held, np.zeros(m, dtype=bool))
        self.measure = np.where(angular, 1.0 / length, 1.0)
        self.inactive: Flags = np.zeros(m, dtype=bool)
        self.incidences, self.held, self._m, self.version, self.filled = incidences, held, m, 0, 0
        self.shared = SharedNodes.alone(len(held))
        self.couple(pairs)

    def couple(self, pairs: list[tuple[Indices, Indices]]) -> None:
        """Build a new pattern for other node pairs; the values are zero.

        Args:
            pairs: Rows and columns of coupled node pairs.
        """
        count, m = len(self.held), self._m
        self.version, self.filled = self.version + 1, self.filled + 1
        diagonal = np.arange(count)
        r = np.concatenate([diagonal, *(p[0] for p in pairs)])
        c = np.concatenate([diagonal, *(p[1] for p in pairs)])
        moves = (r < count) & (c < count)
        r, c = r[moves], c[moves]
        pattern = sp.csr_matrix((np.ones(len(r)), (r, c)), shape=(count, count))
        pattern.sort_indices()
        self.indptr, self.indices = pattern.indptr, pattern.indices
        self._touch(count, m)
        self._data: Array = np.zeros(self._size)
        shape = 6 * count + m
        self.matrix = PETSc.Mat().createAIJWithArrays(
            (shape, shape), (self._row_pointers, self._columns, self._data), comm=PETSc.COMM_SELF
        )

    @property
    def free_units(self) -> Array:
        """Units of the unknowns of nodes, zero for held ones, shape (n, 6)."""
        return np.where(self.held, 0.0, self.units[: self.held.size].reshape(-1, 6))

    @property
    def size(self) -> int:
        """Number of unknowns, those of other ranks included; shared ones count once."""
        own = 6 * self.shared.owns + self._m
        return int(self.shared.total(np.array(own))) if self.shared.several else own

    @property
    def csr(self) -> tuple[Array, npt.NDArray[Any], npt.NDArray[Any]]:
        """Values, columns and row pointers of the matrix without :attr:`low_rank`, as views.

        See also :attr:`whole`.
        """
        return self._data, self._columns, self._row_pointers

    @property
    def whole(self) -> sp.csr_matrix:
        """Copy of the matrix with its low-rank part."""
        values, columns, pointers = self.csr
        size = len(self.units)
        found = sp.csr_matrix((values.copy(), columns, pointers), shape=(size, size))
        return found if self.low_rank is None else found + self.low_rank.matrix(size)

    def times(self, x: Array) -> Array:
        """Product of the matrix, with low-rank part and correction, with ``x``."""
        product: Array = sp.csr_matrix(self.csr) @ x
        for part in (self.low_rank, self.correction):
            product = product if part is None else product + part.times(x)
        self.shared.sum(product[: self.held.size].reshape(-1, 6))
        return product

    def _touch(self, count: int, m: int) -> None:
        """Build the scalar pattern from node pairs and incidences."""
        incidences = self.incidences
        c, incidence = incidences.rows, np.arange(len(incidences.nodes))
        order = np.lexsort((c, incidences.nodes))
        self._incident = np.stack([c, incidence], axis=1)[order]
        self._incident_ptr = np.searchsorted(incidences.nodes[order], np.arange(count + 1))
        of_constraints: Indices = (6 * incidences.nodes[:, np.newaxis] + np.arange(6)).ravel()
        ends = 6 * incidences.ptr[1:]
        if self._on_diagonal:
            of_constraints = np.insert(of_constraints, ends, 6 * count + np.arange(m))
        own: Indices = np.empty(6 * count, dtype=np.int64)
        pattern = self.indptr, self.indices, self._incident_ptr, self._incident
        _count(pattern, self.held, own)
        lengths = np.append(own, 6 * np.diff(incidences.ptr) + int(self._on_diagonal))
        self._row_pointers = np.append(0, np.cumsum(lengths)).astype(PETSc.IntType)
        self._columns = np.empty(self._row_pointers[-1], dtype=PETSc.IntType)
        _set_columns(pattern, self.held, self._columns)
        self._columns[own.sum() :] = of_constraints
        self._size = len(self._columns)

    def block_index(self, rows: Indices, columns: Indices) -> Indices:
        """Positions of node pairs among the blocks; −1 if a node does not move."""
        found: Indices = np.empty(rows.shape, dtype=np.int64)
        _find(self.indptr, self.indices, rows.ravel(), columns.ravel(), found.ravel())
        return found

    def share_among_ranks(self) -> None:
        """Divide the matrix into a subdomain per rank; later matrices also fill :attr:`part`.

        Raises:
            ValueError: The scene cannot be divided into so many.
        """
        world = MPI.COMM_WORLD
        assert self.divisible is not None
        self.divisible.divide(world.bcast(self.divisible.division(world.size)), world.rank)

    def divide(self, part: Part) -> None:
        """Allocate values for the matrix of a subdomain; see :meth:`of_part`."""
        self.part = part
        part.values = np.zeros_like(self._data)

    @contextmanager
    def of_part(self) -> Iterator[None]:
        """Context in which :meth:`fill` sets the values of the subdomain."""
        assert self.part is not None
        whole, self._data = self._data, self.part.values
        try:
            yield
        finally:
            self._data = whole

    def fill(
        self, blocks: Array, columns: Array, rows: Array, scale: Array, *, anew: bool = True
    ) -> None:
        """Set the values.

        Args:
            blocks: ``S``, shape (nnz, 6, 6).
            columns: ``B`` in twists, one row of six per incidence, shape (incidences, 6); held
                unknowns are set to zero, as in ``rows``.
            rows: ``BT`` in increments, one row of six per incidence, shape (incidences, 6).
            scale: ``σ``, shape (m,).
            anew: Whether the blocks differ from the last ones.
        """
        _clear_held(columns, self.incidences.nodes, self.held)
        _clear_held(rows, self.incidences.nodes, self.held)
        softness = self._diagonal(columns, rows, scale)
        incident = self._incident_ptr, self._incident
        pattern = self.indptr, self.indices, *incident, self.incidences.ptr
        _fill(pattern, blocks, self.held, columns, rows, scale, softness, self._data)
        self.filled += int(anew)
        self._changed()

    def _diagonal(self, columns: Array, rows: Array, scale: Array) -> Array:
        """Negative diagonal of the constraints, shape (m,) or empty; clear what does not act.

        Solutions are freed of multipliers without force. Only the compliance of redundant
        constraints, :data:`SOFTNESS` over ``B diag(S)⁻¹ Bᵀ`` of the stiffness by which they are
        scaled, resists these: otherwise round-off of the constraints would move them in every
        iteration. That of the current stiffness is not bounded under an earlier scale: a rigid
        body has no stiffness at the start of statics, and later a little.
        """
        if not self._on_diagonal:
            return np.empty(0)
        found: Array = np.zeros(self._m)
        if self.redundant:
            found = SOFTNESS * scale
        if self.inactive.any():
            found[self.inactive] = 1.0
            for each in (columns, rows):
                each[self.inactive[self.incidences.rows]] = 0.0
        return found

    def restore(self, values: Array) -> None:
        """Set the values to earlier ones of :attr:`csr`."""
        self._data[:] = values
        self.filled += 1
        self._changed()

    def _changed(self) -> None:
        self.correction = None
        self.matrix.stateIncrease()
        self.matrix.assemble()


class Incidences(NamedTuple):
    """Incidences of constraints with moving nodes, ordered by constraint and node.

    Attributes:
        ptr: First incidence of each constraint, and the total at the end, shape (m + 1,).
        nodes: Node of each incidence.
    """

    ptr: Indices
    nodes: Indices

    @property
    def rows(self) -> Indices:
        """Constraint of each incidence."""
        return np.repeat(np.arange(len(self.ptr) - 1), np.diff(self.ptr))

    @classmethod
    def of(cls, touched: Sequence[set[int]], count: int) -> Incidences:
        """Incidences from the nodes of each constraint; nodes from ``count`` on do not move."""
        of_each = [sorted(node for node in nodes if node < count) for nodes in touched]
        ptr = np.concatenate([[0], np.cumsum([len(nodes) for nodes in of_each], dtype=np.int64)])
        nodes = np.array([node for group in of_each for node in group], dtype=np.int64)
        return cls(ptr.astype(np.int64), nodes)

    def at(self, row: int, node: int) -> int:
        """Incidence of a constraint with a node, −1 if the node does not move."""
        nodes = self.nodes[self.ptr[row] : self.ptr[row + 1]]
        found = np.flatnonzero(nodes == node)
        return int(self.ptr[row] + found[0]) if len(found) else -1

    def find(self, rows: Indices, nodes: Indices) -> Indices:
        """Incidences of constraints (t,) with nodes (t, k), −1 where there is none."""
        if not len(self.nodes):
            return np.full_like(nodes, -1)
        count = max(int(self.nodes.max()), int(nodes.max(initial=0))) + 1
        keys, sought = self.rows * count + self.nodes, rows[:, np.newaxis] * count + nodes
        found = np.searchsorted(keys, sought).clip(max=len(keys) - 1)
        return np.where(keys[found] == sought, found, -1)
