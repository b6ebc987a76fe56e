"""Springs and dampers along joint coordinates, and mass-proportional damping, as terms.

The compiled loop over joints (:mod:`fem_lie.system.constraint_sets`) includes the forces and the
geometric stiffness of springs; as terms here they stand by themselves.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.forms.abilities import ViscousForces
from fem_lie.forms.term import Pairs, Term
from fem_lie.lie.node_types import at_rest, inertia, pull_back_derivative
from fem_lie.lie.node_types.inertia import Inertia
from fem_lie.system.constraint_sets.constraint_set import ConstraintSet
from fem_lie.system.nodes.sums import add_mass_damping


@compiled
def _add_turned(kinds: Indices, H: Array, f: Array, diagonal: Indices, blocks: Array) -> None:
    """Add ``∂(Lᵀ f)/∂h`` of each node to ``blocks``."""
    for i in range(f.shape[0]):
        if diagonal[i] >= 0:
            pull_back_derivative(kinds[i], H[i], f[i], 1.0, blocks[diagonal[i]])


class MassDamping(Term, ViscousForces):
    """Forces ``Lᵀ D q̇`` with a constant matrix ``D`` on (x, d₁, d₂, d₃) of the master nodes."""

    label, in_space, conserved = "damping of mass", True, True

    def __init__(self, D: Inertia, kinds: Indices) -> None:
        """Store the matrix and the types of the nodes."""
        self._kinds = at_rest(kinds)
        self._D, self._count = D, len(D.indptr) - 1
        self._rows = np.repeat(np.arange(self._count), np.diff(D.indptr))
        own = np.flatnonzero(self._rows == D.indices)
        self._diagonal = np.full(self._count, -1)
        self._diagonal[self._rows[own]] = own
        self._index = np.arange(len(D.indices))
        self._work = np.zeros((2, self._count, 4, 3))

    @property
    def viscosity(self) -> ViscousForces:
        """The term itself: all of its forces are viscous."""
        return self

    @property
    def pairs(self) -> Pairs:
        """Node pairs of the matrix."""
        return self._rows, self._D.indices

    @property
    def rates(self) -> tuple[Indices, Indices, Array]:
        """The matrix ``D``."""
        return self._D.plain

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add nothing: there are no forces at rest."""

    def tangent(self, H: Array, kept: Array) -> Array:
        """Zero."""
        return np.zeros((len(self._rows), 6, 6))

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the forces at twists ``v`` (≥ nodes that move, 6)."""
        self._forces(H, v, out)

    def _forces(self, H: Array, v: Array, out: Array) -> Array:
        """Add the forces to ``out``, and return ``D q̇``, shape (n, 4, 3)."""
        f = np.zeros((self._count, 4, 3))
        add_mass_damping(self._kinds, H, v, self._D.plain, self._work, f, out.reshape(-1))
        return f

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """``Lᵀ D L`` and ``∂(Lᵀ D L v)/∂h``."""
        A, K = np.zeros((2, len(self._rows), 6, 6))
        # L v is the acceleration v of a body at rest
        motion = H, np.zeros((self._count, 6)), v[: self._count]
        block_indices = self._index, self._index
        inertia.tangents(motion, self._kinds, self._D.plain, block_indices, (1.0, 0.0), (A, K))
        f = self._forces(H, v, np.zeros((self._count, 6)))
        _add_turned(self._kinds, H, f, self._diagonal, K)
        return A, K


class _Along(Term):
    """Springs or dampers along coordinates: a set of constraints with zero multipliers."""

    within_joints, conserved = True, True

    def __init__(self, joints: ConstraintSet, count: int, m: int) -> None:
        """Find the node pairs.

        Args:
            joints: The set of constraints with the springs.
            count: Number of moving nodes.
            m: Number of constraints of all sets.
        """
        self._joints, self._count, self._none = joints, count, np.zeros(m)
        rows, columns = joints.pairs
        moves = (rows < count) & (columns < count) & joints.sprung
        self._pairs = rows[moves], columns[moves]
        self._index = np.where(moves, np.cumsum(moves).reshape(moves.shape) - 1, -1)

    @property
    def pairs(self) -> Pairs:
        """Node pairs of the joints with springs or dampers."""
        return self._pairs

    def _forces(self, H: Array, v: Array) -> Array:
        r = np.zeros(6 * self._count + len(self._none))
        self._joints.evaluate(H, v, self._none, self._none, self._count, r)
        return r[: 6 * self._count].reshape(-1, 6)

    def _blocks(self) -> Array:
        return np.zeros((len(self._pairs[0]), 6, 6))


class Springs(_Along):
    """All springs of a set of joints."""

    label = "springs"

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces at frames ``H``."""
        out[: self._count] += self._forces(H, np.zeros((self._count, 6)))

    def tangent(self, H: Array, kept: Array) -> Array:
        """``k bᵀb`` with the derivatives ``b`` of the coordinates."""
        blocks = self._blocks()
        self._joints.stiffen(H, np.empty((0, 6)), self._index, 1.0, 0.0, blocks)
        return blocks

    def geometric(self, H: Array) -> Array:
        """``k (q − q₀) ∂b/∂h``."""
        blocks = self._blocks()
        self._joints.geometric(H, self._none, self._index, blocks)
        return blocks

    def energy(self, H: Array) -> float:
        """``½ k (q − q₀)²``."""
        return self._joints.spring_energy(H)


class Dampers(_Along, ViscousForces):
    """All dampers of a set of joints."""

    label = "dampers"

    @property
    def viscosity(self) -> ViscousForces:
        """The term itself: all of its forces are viscous."""
        return self

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add nothing: there are no forces at rest."""

    def tangent(self, H: Array, kept: Array) -> Array:
        """Zero."""
        return self._blocks()

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the forces at twists ``v`` (≥ nodes that move, 6)."""
        still = np.zeros((self._count, 6))
        out[: self._count] += self._forces(H, v) - self._forces(H, still)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """``c bᵀb``; the derivative of ``b`` is neglected."""
        blocks = self._blocks()
        self._joints.stiffen(H, v, self._index, 0.0, 1.0, blocks)
        return blocks, None
