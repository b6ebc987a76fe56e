"""The matrix of a scene as a sum of parts, each in blocks on one pattern of node pairs."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.joints.equations import sliding, terms
from fem_lie.lie.motions import add_turnings
from fem_lie.linear.bordered import KKT
from fem_lie.system.constraints import Connections
from fem_lie.system.elastic import Elastic
from fem_lie.system.nodes import inertia
from fem_lie.system.nodes.fixed_axes import Supports
from fem_lie.system.nodes.inertia import Inertia
from fem_lie.system.nodes.sums import add_blocks, combine, combine_rows, rigid_tangent, to_inertial

_SYMMETRIC = 1e-9  # of the largest entry, far above round-off and far below an open edge


class Tangent:
    """Parts are added to ``A`` and ``K``, and the sum is filled into the bordered matrix.

    Attributes:
        kkt: The bordered matrix.
        supports: Which nodes have unknowns along axes fixed in space.
        A: Derivatives in corrections of the nodes' increments, blocks of ``kkt``, (nnz, 6, 6).
        K: Derivatives in the twists ``h`` of the nodes' frames, likewise.
    """

    def __init__(
        self,
        mass: Inertia,
        damping: Inertia | None,
        elastic: Elastic,
        connections: Connections,
        held: Flags,
        axes: Array,
        *,
        viscous: bool,
        redundant: bool,
        length: float,
    ) -> None:
        """Find the pattern.

        Args:
            mass: Inertia of the leaders.
            damping: Damping that goes with mass.
            elastic: All assemblies, and pressure.
            connections: All joints.
            held: Which unknowns of the nodes are zero, shape (n, 6).
            axes: Fixed axes of the supports, see
                :class:`~fem_lie.system.nodes.fixed_axes.Supports`.
            viscous: Whether the viscous forces of ``elastic`` count.
            redundant: Whether constraints may follow from others.
            length: Of the model.
        """
        self._mass, self._damping = mass, damping
        self._elastic, self._viscous = elastic, viscous
        self._connections = connections
        self._table, self._border = connections.table, connections.border
        self._held, self._count = held, len(held)
        diagonal = np.arange(self._count)
        pair = (np.repeat(diagonal, np.diff(mass.indptr)), mass.indices)
        a, b = self._table.nodes.T
        both = (np.concatenate([a, b]), np.concatenate([b, a]))
        slides = connections.sliding_pairs()
        pairs = [pair, *elastic.pairs, both, (slides[0].ravel(), slides[1].ravel())]
        angular = connections.angular
        self.kkt = KKT(
            pairs, self._border, held, length=length, angular=angular, redundant=redundant
        )
        place = self.kkt.place
        self._place_mass = place(*pair)
        self._place_elastic = [place(*pair) for pair in elastic.pairs]
        self._diagonal = place(diagonal, diagonal)
        self._place_sliding = place(*slides)
        self._place_joints = np.stack(
            [np.stack([place(a, a), place(a, b)], 1), np.stack([place(b, a), place(b, b)], 1)], 1
        )
        nodes = self._border.nodes
        self.supports = Supports(axes, self.kkt.indptr, self.kkt.indices, nodes)
        self._rows = np.zeros((len(nodes), 6))
        self.A = np.zeros((len(self.kkt.indices), 6, 6))
        self.K = np.zeros_like(self.A)

    def jacobian(self, H: Array) -> sp.csr_matrix:
        """``B = ∂Φ/∂h`` in the twists of the moving nodes, held ones left out; (m, 6 n)."""
        self._connections.jacobian(H, self._rows)
        self.supports.turn_border(H, self._rows)
        border, held = self._border, self._held
        free = ~held[border.nodes].all(axis=1)
        node = border.nodes[free]
        columns = (6 * node[:, np.newaxis] + np.arange(6)).ravel()
        values = np.where(held[node], 0.0, self._rows[free]).ravel()
        shape = (len(border.ptr) - 1, 6 * self._count)
        return sp.csr_matrix((values, (np.repeat(border.rows[free], 6), columns)), shape=shape)

    def constraint_scale(self, H: Array) -> Array:
        """``1/(B diag(S)⁻¹ Bᵀ)`` of each constraint with the ``S`` in ``A``, shape (m,).

        Bordered by ``σ B`` with these factors ``σ`` the matrix is about as well conditioned as
        ``S``: as ``S → M/(βh²)`` this is the index 3 scaling of Bottasso, Bauchau & Cardona.
        """
        diagonal = np.abs(self.A[self._diagonal].diagonal(axis1=1, axis2=2)).ravel()
        B = self.jacobian(H)
        weighted = B.multiply(B).multiply(1.0 / np.where(diagonal > 0, diagonal, 1.0))
        total = np.asarray(weighted.sum(axis=1)).ravel()
        return np.divide(1.0, total, out=np.ones_like(total), where=total > 0.0)

    # --- parts ---

    def clear(self) -> None:
        """Start anew."""
        self.A[:] = 0.0
        self.K[:] = 0.0

    def add_inertia(
        self,
        H: Array,
        v: Array,
        a: Array,
        kinds: Indices,
        force: Array,
        moment: Array,
        factors: tuple[float, float],
    ) -> None:
        """Inertia and nodal loads, see :func:`~fem_lie.system.nodes.sums.rigid_tangent`."""
        rigid_tangent(
            H,
            v,
            a,
            kinds,
            self._mass,
            self._place_mass,
            force,
            moment,
            self._diagonal,
            factors,
            self.A,
            self.K,
        )

    def add_mass(self, H: Array, kinds: Indices) -> None:
        """The mass matrix, to ``A``."""
        still = np.zeros((self._count, 6))
        inertia.tangents(
            H, still, still, kinds, *self._mass, self._place_mass, 1.0, 0.0, self.A, self.K
        )

    def add_elastic(self, H: Array) -> None:
        """Elements, with the stress they carry, and pressure, to ``K``."""
        for place, blocks in zip(self._place_elastic, self._elastic.tangents(H), strict=True):
            add_blocks(self.K, place, blocks)

    def symmetric_pressures(self, H: Array) -> bool:
        """Whether each pressure has a symmetric tangent in the free unknowns at frames ``H``.

        For nodes that move by ``x + R u``: the turning of forces is none of theirs.
        """
        free = np.flatnonzero(~self._held.ravel())
        for k, blocks in self._elastic.pressure_tangents(H):
            self.clear()
            add_blocks(self.K, self._place_elastic[k], blocks)
            self.K[:, :, 3:] = 0.0
            self.supports.turn_blocks(H, self.K)
            A = sp.bsr_matrix((self.K, self.kkt.indices, self.kkt.indptr)).tocsr()[free][:, free]
            if abs(A - A.T).max() > _SYMMETRIC * abs(A).max():
                return False
        return True

    def add_geometric(self, H: Array, weights: Array) -> None:
        """Geometric stiffness of joints with the multipliers ``weights``, to ``K``."""
        terms.geometric(H, self._table, weights, self._place_joints, self.K)
        if len(self._place_sliding):
            sliding.geometric(H, self._connections.sliding, weights, self._place_sliding, self.K)

    def add_springs(self, H: Array) -> None:
        """Stiffness of springs in joints, to ``K``."""
        if len(self._table.springs):
            terms.add_springs(H, self._table, self._place_joints, 1.0, 0.0, self.K)

    def add_dampers(self, H: Array, factor: float) -> None:
        """``factor`` times the derivative of dampers in joints in the twists, to ``A``."""
        if len(self._table.springs):
            terms.add_springs(H, self._table, self._place_joints, 0.0, factor, self.A)

    def add_viscosity(self, H: Array, factor: float) -> None:
        """``factor`` times the derivative of viscous forces in the twists' rates, to ``A``."""
        if self._viscous:
            for k, blocks in self._elastic.viscous_tangents(H):
                add_blocks(self.A, self._place_elastic[k], factor * blocks)

    def add_mass_damping(self, H: Array, v: Array, factor: float) -> None:
        """``factor Lᵀ D L`` to ``A``, ``Lᵀ D ∂(L v)/∂h`` to ``K``.

        ``L v`` is the acceleration ``v`` of a body at rest.
        """
        if self._damping is None:
            return
        still, rate = np.zeros((self._count, 6)), v[: self._count]
        local = np.zeros(self._count, dtype=np.int64)
        place = self._place_mass
        inertia.tangents(H, still, rate, local, *self._damping, place, factor, 0.0, self.A, self.K)

    def add_turnings(self, forces: Array, nodes: Flags) -> None:
        """See :func:`~fem_lie.lie.motions.add_turnings`; to ``K``."""
        add_turnings(forces, 1.0, self._diagonal, nodes, self.K)

    # --- sum ---

    def fill(self, blocks: Array, H: Array, scale: Array) -> None:
        """Blocks, bordered by the constraints at ``H`` times ``scale``, into the KKT."""
        self._connections.jacobian(H, self._rows)
        if self.supports:
            blocks = blocks.copy()
            self.supports.turn_blocks(H, blocks)
            self.supports.turn_border(H, self._rows)
        self.kkt.fill(blocks, self._rows, self._rows, scale)

    def refill_border(self, H: Array, kinds: Indices, d: Array, scale: Array) -> None:
        """What :meth:`fill_increments` filled, with the constraints anew at ``H``."""
        self._connections.jacobian(H, self._rows)
        columns = self._rows.copy()
        combine_rows(self._rows, kinds, d, self._border.nodes)
        if self.supports:
            self.supports.turn_border(H, columns)
            self.supports.turn_border(H, self._rows)
        self.kkt.fill(self.A, columns, self._rows, scale)

    def fill_increments(
        self,
        H: Array,
        kinds: Indices,
        d: Array,
        scale: Array,
        *,
        inertial: bool,
        forces_at: Array | None = None,
    ) -> None:
        """``A + K T(d)``, bordered by the constraints at ``H``, into the KKT.

        In components along the nodes' axes, or along fixed ones if ``inertial``. Forces of the
        constraints are those at the frames ``forces_at`` (default: ``H``).
        """
        self._connections.jacobian(H, self._rows)
        columns, bind, nodes = self._rows.copy(), self.kkt.indices, self._border.nodes
        if forces_at is not None:
            self._connections.jacobian(forces_at, columns)
        if d.any():
            combine(self.A, self.K, kinds, d, bind)
            combine_rows(self._rows, kinds, d, nodes)
        else:
            self.A += self.K
        if self.supports:
            self.supports.turn_blocks(H, self.A)
            self.supports.turn_border(H, columns)
            self.supports.turn_border(H, self._rows)
        if inertial:
            to_inertial(self.A, columns, self._rows, H, nodes, self.kkt.indptr, bind)
        self.kkt.fill(self.A, columns, self._rows, scale)
