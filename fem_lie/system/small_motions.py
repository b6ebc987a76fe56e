"""Equations linearised about rest or steady rotation, and rigid motions of a scene."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg
from scipy.sparse.csgraph import connected_components

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.lie import node_types
from fem_lie.lie.node_types import POSITION_GRADIENT, all_result_twists, at_rest
from fem_lie.linear.spectra.pencil import FREE, Complex, Pencil, RigidParts, kernel
from fem_lie.scene.rotation import Rotation
from fem_lie.system.system import System
from fem_lie.system.time_state import TimeState


class RigidMotions(NamedTuple):
    """Rigid motions of a connected group of elements, with nodes of any types.

    Attributes:
        nodes: Nodes of the group, shape (n,).
        unknowns: Its free unknowns among all free ones, shape (k,).
        basis: Orthonormal rigid motions that the supports allow, shape (k, ≤ 6).
    """

    nodes: Indices
    unknowns: Indices
    basis: Array


def rigid_motions(system: System, H: Array, weight: Array) -> list[RigidMotions]:
    """Rigid motions of all connected groups that have any; unknowns are twists over ``weight``."""
    count = system.count
    # without elements each node is a group of its own
    none = np.zeros(0, dtype=np.int64)
    pairs = (none, none), *system.elastic.pairs
    rows, columns = (np.concatenate([p[k] for p in pairs]) for k in (0, 1))
    graph = sp.coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(count, count))
    pieces, label = connected_components(graph, directed=False)
    number = np.cumsum(~system.held.ravel()) - 1
    held = system.held.copy()
    # drilling rotations that shells hold are no supports
    drills = held & system.numbering.held & system.separates_director[:, np.newaxis]
    drills[:, :5] = False
    found = []
    for piece in range(pieces):
        nodes = np.flatnonzero(label == piece)
        R = node_types.rigid_motions(system.kinds[nodes], H[nodes], H[nodes, 0].mean(axis=0))
        R *= np.repeat([system.length, 1.0], 3)
        for k in range(6):
            every = np.zeros((count, 6))
            every[nodes] = R[:, :, k]
            system.supports.rotate(H, every)
            R[:, :, k] = every[nodes]
        R = R.reshape(-1, 6) / weight.reshape(-1, 6)[nodes].reshape(-1, 1)
        stuck = (held & ~drills)[nodes].ravel()
        allowed = kernel(R[stuck])
        free = ~held[nodes].ravel()
        unknowns = (6 * nodes[:, np.newaxis] + np.arange(6)).ravel()[free]
        basis = _orthonormal(R[free] @ allowed)
        if basis.shape[1]:
            found.append(RigidMotions(nodes, number[unknowns], basis))
    return found


def _orthonormal(motions: Array) -> Array:
    """Orthonormal basis of the columns, without those that move nothing, as the spin of a cable."""
    Q, R = np.linalg.qr(motions)
    sizes = np.abs(np.diagonal(R))
    if (sizes > FREE * sizes.max(initial=0.0)).all() and len(sizes) == motions.shape[1]:
        return np.asarray(Q)
    return np.asarray(scipy.linalg.orth(motions, rcond=FREE)) if motions.any() else Q[:, :0]


def stress_terms(forces: Array) -> Array:
    """Blocks of ``P``, shape (n, 6, 6), for internal forces (n, 6): ``P ψ = ad(ψ)ᵀ f``."""
    ad = lie.se3_ad(np.eye(6))
    return np.asarray(np.einsum("kji,nj->nik", ad, forces))


def linearised(
    system: System, H: Array, v: Array, multipliers: Array, *, elements: bool = True
) -> tuple[Array, Array, Array]:
    """Mass, damping and stiffness of small motions about a steady motion, blocks of ``kkt``.

    All nodes move with constant local velocities ``v``, those of one rigid motion, plus a small
    motion: ``H exp(h)``. Then ``δv = ḣ + ad(v) h``, ``δv̇ = ḧ + ad(v) ḣ`` and

        M ḧ + (C + M ad(v)) ḣ + (∂r/∂h + C ad(v)) h + Bᵀ δλ = 0,    M = ∂r/∂a, C = ∂r/∂v.

    Viscous stress does not depend on the rigid motion and contributes with ``ḣ`` only. Elastic
    stress is the independent one: see ``terms.reset_stress``.

    Args:
        system: The equations.
        H: Frames of all nodes, ground and prescribed motions.
        v: Local velocities of the moving nodes, shape (n, 6).
        multipliers: Lagrange multipliers, shape (m,).
        elements: Whether the stiffness of elements and pressure is included.

    Returns:
        Three arrays of shape (nnz, 6, 6).
    """
    tangent = system.tangent
    scale, r, forces = np.ones(system.m), np.empty(system.size), system.workspace()
    twists = at_rest(system.kinds)  # derivatives in the rates of twists, on any group
    now = TimeState(H, v, np.zeros_like(v), multipliers)
    system.residual(now, scale, r, forces)
    loads = forces.on_rows, system.loads.moment
    tangent.separate_blocks()
    tangent.clear()
    tangent.add_inertia(now, twists, loads, (1.0, 0.0))
    M = tangent.A.copy()
    tangent.clear()
    tangent.add_inertia(now, twists, loads, (0.0, 1.0))
    tangent.add_viscosity(H, v, 1.0, lambda _, viscosity: viscosity.in_space)
    tangent.add_terms(H, forces.own, lambda term: elements or not term.of_bodies)
    tangent.add_geometric(H, multipliers)
    system.follow_motion(forces)
    ad = lie.se3_ad(v)[tangent.kkt.indices]
    K = tangent.parts.K + tangent.A @ ad
    tangent.add_viscosity(H, v, 1.0, lambda _, viscosity: not viscosity.in_space)
    return M, tangent.A + M @ ad, K


def fill_steady(system: System, H: Array, v: Array, multipliers: Array, scale: Array) -> None:
    """Fill the KKT matrix with the stiffness of :func:`linearised` and the scaled constraints."""
    _, _, K = linearised(system, H, v, multipliers)
    system.tangent.fill(K, H, scale)


_BALANCED = 1e-9
_ULPS = 1e-15  # forces over the largest stiffness that are round-off of the frames


class SmallMotions:
    """Linear equations of a scene about one state; the unit of translations is the model length.

    Attributes:
        rotation: The steady rotation.
        rate: Its angular velocity.
        H: Frames of all nodes, ground and prescribed motions.
    """

    def __init__(self, system: System, rotation: Rotation) -> None:
        """Linearise about the initial frames under the loads of time 1."""
        self._system, self.rotation = system, rotation
        self.rate = float(np.linalg.norm(rotation.spin))
        self.weight = system.units
        system.set_time(1.0)
        self.H = system.frames.copy()
        self.H[system.count + 1 :] = system.prescribed_frames(1.0)
        self._evaluate()

    def move(self, frames: Array) -> None:
        """Linearise about the last of several equilibria, frames of all nodes (k, N, 4, 3).

        Raises:
            ValueError: It is not an equilibrium of this scene.
        """
        system, master_map = self._system, self._system.numbering.master_map
        last = frames[-1:]
        if last.shape[1:] != (system.numbering.total, 4, 3):
            raise ValueError(
                f"at=... must be an equilibrium of this scene with {system.numbering.total} nodes, "
                f"got frames of shape {frames.shape}"
            )
        self.H[: system.count] = last[0, master_map.masters]
        self._evaluate()
        if not self.balanced(1e-5):
            raise ValueError(
                "at=... is not an equilibrium of this scene under its full loads, or a rough one: "
                "statics with newton=fl.schemes.Newton(tolerance=1e-13) finds a more accurate one"
            )

    def _evaluate(self) -> None:
        """Compute the joint forces that balance the other forces best, and the residual."""
        system = self._system
        n = 6 * system.count
        self.v = self.rotation.velocities(system.kinds, self.H)
        none, r = np.zeros_like(self.v), np.empty(system.size)
        now, ones = TimeState(self.H, self.v, none, np.zeros(system.m)), np.ones(system.m)
        system.terms.reset_stress(self.H)
        system.applied(now, ones, r)
        applied = self._largest(r)
        system.residual(now, ones, r)
        lengths = np.where(system.connections.angular, 1.0, system.length)
        self.gap = float((np.abs(r[n:]) / lengths).max(initial=0.0))
        self.B = system.tangent.jacobian(self.H) @ sp.diags(self.weight)
        force = self.weight * r[:n]
        self.multipliers: Array = np.zeros(system.m)
        if system.m:
            normal_factors = scipy.sparse.linalg.splu((self.B @ self.B.T).tocsc())
            self.multipliers = -normal_factors.solve(self.B @ force)
        # without joints the residual is the sum of all forces
        self.force = max(applied, float(np.abs(force).max(initial=0.0)))
        self.left = float(np.abs(force + self.B.T @ self.multipliers).max(initial=0.0))
        self.blocks = linearised(system, self.H, self.v, self.multipliers)
        if self.force <= _ULPS * abs(self._matrix(self.blocks[2])).max():
            # joint forces from round-off of strains would add stiffness
            self.multipliers[:] = 0.0
            self.blocks = linearised(system, self.H, self.v, self.multipliers)

    def _largest(self, r: Array) -> float:
        """The largest of the forces ``r`` on free unknowns, in units of energy."""
        system = self._system
        forces = r[: 6 * system.count].reshape(-1, 6).copy()
        if system.supports:
            system.supports.rotate(self.H, forces)
        forces[system.held] = 0.0
        return float(np.abs(self.weight * forces.ravel()).max(initial=0.0))

    def balanced(self, tolerance: float = _BALANCED) -> bool:
        """Whether joint forces balance all other forces."""
        M, _, K = (self._matrix(blocks) for blocks in self.blocks)
        inertia = abs(M).max() * self.rate**2
        # iterations end at a fraction of the model length, and positions have finite precision
        reach = float(np.abs(self.H[: self._system.count, 0]).max()) / self._system.length
        stiffness = (1e-12 + 4.0 * np.finfo(np.float64).eps * reach) * abs(K).max()
        return self.gap <= tolerance and self.left <= (
            tolerance * max(self.force, inertia) + stiffness
        )

    def _matrix(self, blocks: Array) -> sp.csr_matrix:
        """Matrix of the free unknowns, in units of energy."""
        kkt, held = self._system.kkt, self._system.held.ravel()
        if self._system.supports:
            blocks = blocks.copy()
            self._system.supports.rotate_blocks(self.H, blocks)
        size = (len(held), len(held))
        A = sp.bsr_matrix((blocks, kkt.indices, kkt.indptr), shape=size).tocsr()
        scale = sp.diags(self.weight)
        A = (scale @ A @ scale).tocsr()[~held][:, ~held]
        A.eliminate_zeros()
        return A

    def pencil(self) -> Pencil:
        """The eigenvalue problem."""
        M, C, K = (self._matrix(blocks) for blocks in self.blocks)
        free = ~self._system.held.ravel()
        pencil = Pencil(M, C if C.nnz else None, K, self.B.tocsr()[:, free], self._parts(K))
        return pencil if pencil.split_is_exact else replace(pencil, parts=None)

    def stiffness(self) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Tangent stiffness of free unknowns, in units of energy, and constraint Jacobian."""
        return self._matrix(self.blocks[2]), self.B.tocsr()[:, ~self._system.held.ravel()]

    def _parts(self, K: sp.csr_matrix) -> RigidParts:
        """Stiffness of elements and of everything else, with rigid motions."""
        system, kkt = self._system, self._system.kkt
        state = system, self.H, self.v, self.multipliers
        rest = self._matrix(linearised(*state, elements=False)[2])
        forces, blocks = np.zeros(6 * system.count), np.zeros_like(self.blocks[2])
        system.elastic.add_forces(self.H, forces)
        nodes = np.arange(system.count)
        blocks[kkt.block_index(nodes, nodes)] = stress_terms(forces.reshape(-1, 6))
        # nodes with vector coordinates do not have exact rigid motions of stressed groups
        motions = [
            (piece.unknowns, piece.basis)
            for piece in rigid_motions(system, self.H, self.weight)
            if (system.kinds[piece.nodes] < POSITION_GRADIENT).all()
        ]
        return RigidParts(rest, (K - rest).tocsr(), self._matrix(blocks), motions)

    def forces(self, nodal: Array) -> Array:
        """Forces on the free unknowns, in the unit of energy, from those of all, shape (6 n,)."""
        return np.asarray((self.weight * nodal)[~self._system.held.ravel()])

    def twists(self, vector: Complex) -> Complex:
        """Twists of all nodes, (N, 6), from a vector of free unknowns."""
        system = self._system
        h = np.zeros((system.count, 6), dtype=np.complex128)
        h[~system.held] = vector
        h *= self.weight.reshape(-1, 6)
        system.supports.rotate_back(self.H, h.real)
        system.supports.rotate_back(self.H, h.imag)
        twists = system.numbering.master_map.twists
        shown = np.empty((2, *h.shape))
        for part, out in zip((h.real, h.imag), shown, strict=True):
            all_result_twists(system.kinds, self.H, np.ascontiguousarray(part), out)
        return np.asarray(twists(shown[0]) + 1j * twists(shown[1]))
