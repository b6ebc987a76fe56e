"""Equations linearised about rest or steady rotation, and rigid motions of a scene."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie import lie
from fem_lie._arrays import Array, Flags
from fem_lie.lie import node_types
from fem_lie.lie.node_types import POSITION_GRADIENT, all_result_twists, at_rest
from fem_lie.linear.spectra.free_unknowns import FreeUnknowns, free_unknowns
from fem_lie.linear.spectra.pencil import Complex, Pencil, RigidParts
from fem_lie.scene.rotation import Rotation
from fem_lie.system.nodes.groups import Groups
from fem_lie.system.system import System
from fem_lie.system.time_state import TimeState


class RigidMotions(NamedTuple):
    """Rigid motions of all connected groups of elements, with nodes of any types.

    Attributes:
        basis: Orthonormal motions of the free unknowns as columns, those that supports allow; shape
            (n, r). Groups and columns are those of all ranks.
        of_frames: Whether all nodes of the group of each column are frames or positions, shape
            (r,).
    """

    basis: sp.csr_matrix
    of_frames: Flags


def rigid_motions(system: System, H: Array, weight: Array) -> RigidMotions:
    """Rigid motions of all connected groups that have any; unknowns are twists over ``weight``."""
    count, kinds, held = system.count, system.kinds, system.held
    groups = Groups(system.shared, system.elastic.pairs)
    sums = groups.sums(np.column_stack([H[:count, 0], np.ones(count), kinds >= POSITION_GRADIENT]))
    moved = H[:count].copy()
    moved[:, 0] -= (sums[:, :3] / sums[:, 3:4])[groups.of_node]
    R = node_types.rigid_motions(kinds, moved, np.zeros(3)) * np.repeat([system.length, 1.0], 3)
    for k in range(6):
        along = np.ascontiguousarray(R[:, :, k])
        system.supports.rotate(H, along)
        R[:, :, k] = along
    # drilling rotations that shells hold are no supports
    drills = held & system.numbering.held & system.separates_director[:, np.newaxis]
    drills[:, :5] = False
    R = np.asarray(R.reshape(-1, 6) / weight[:, np.newaxis])
    basis, of_column = groups.basis(R, (held & ~drills).ravel(), held.ravel())
    return RigidMotions(basis, sums[of_column, 4] == 0)


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
    tangent.add_friction(H, v, multipliers, 1.0)
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
        system.shared.sum(r[:n].reshape(-1, 6))
        lengths = np.where(system.connections.angular, 1.0, system.length)
        gap = float((np.abs(r[n:]) / lengths).max(initial=0.0))
        self.gap = system.shared.largest(gap)
        self.B = system.tangent.jacobian(self.H) @ sp.diags(self.weight)
        force = self.weight * r[:n]
        self.multipliers: Array = np.zeros(system.m)
        if system.m:
            normal_factors = scipy.sparse.linalg.splu((self.B @ self.B.T).tocsc())
            self.multipliers = -normal_factors.solve(self.B @ force)
        # without joints the residual is the sum of all forces
        largest = system.shared.largest
        self.force = max(applied, largest(float(np.abs(force).max(initial=0.0))))
        left = np.abs(force + self.B.T @ self.multipliers)
        self.left = largest(float(left.max(initial=0.0)))
        self.blocks = linearised(system, self.H, self.v, self.multipliers)
        if self.force <= _ULPS * self._largest_entry(self.blocks[2]):
            # joint forces from round-off of strains would add stiffness
            self.multipliers[:] = 0.0
            self.blocks = linearised(system, self.H, self.v, self.multipliers)

    def _largest(self, r: Array) -> float:
        """The largest of the forces ``r`` on free unknowns, in units of energy."""
        system = self._system
        forces = r[: 6 * system.count].reshape(-1, 6).copy()
        system.shared.sum(forces)
        if system.supports:
            system.supports.rotate(self.H, forces)
        forces[system.held] = 0.0
        return system.shared.largest(float(np.abs(self.weight * forces.ravel()).max(initial=0.0)))

    def _largest_entry(self, blocks: Array) -> float:
        """The largest entry of the matrices of all parts."""
        return self._system.shared.largest(float(abs(self._matrix(blocks)).max()))

    def balanced(self, tolerance: float = _BALANCED) -> bool:
        """Whether joint forces balance all other forces."""
        M, _, K = self.blocks
        inertia = self._largest_entry(M) * self.rate**2
        # iterations end at a fraction of the model length, and positions have finite precision
        far = self._system.shared.largest(float(np.abs(self.H[: self._system.count, 0]).max()))
        reach = far / self._system.length
        stiffness = (1e-12 + 4.0 * np.finfo(np.float64).eps * reach) * self._largest_entry(K)
        return bool(
            self.gap <= tolerance and self.left <= tolerance * max(self.force, inertia) + stiffness
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
        system = self._system
        M, C, K = (self._matrix(blocks) for blocks in self.blocks)
        free = np.flatnonzero(~system.held.ravel())
        damped, unknowns = system.shared.any(C.nnz > 0), free_unknowns(system.shared, free)
        B = self.B.tocsr()[:, free]
        pencil = Pencil(M, C if damped else None, K, B, self._parts(K, unknowns), unknowns)
        return pencil if pencil.split_is_exact else replace(pencil, parts=None)

    def stiffness(self) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Tangent stiffness of free unknowns, in units of energy, and constraint Jacobian."""
        return self._matrix(self.blocks[2]), self.B.tocsr()[:, ~self._system.held.ravel()]

    def _parts(self, K: sp.csr_matrix, unknowns: FreeUnknowns) -> RigidParts:
        """Stiffness of elements and of everything else, with rigid motions."""
        system, kkt = self._system, self._system.kkt
        state = system, self.H, self.v, self.multipliers
        rest = self._matrix(linearised(*state, elements=False)[2])
        forces, blocks = np.zeros(6 * system.count), np.zeros_like(self.blocks[2])
        system.elastic.add_forces(self.H, forces)
        nodes = np.arange(system.count)
        blocks[kkt.block_index(nodes, nodes)] = stress_terms(forces.reshape(-1, 6))
        # nodes with vector coordinates do not have exact rigid motions of stressed groups
        motions = rigid_motions(system, self.H, self.weight)
        basis = motions.basis[:, motions.of_frames]
        elements, stress = (K - rest).tocsr(), self._matrix(blocks)
        return RigidParts(rest, elements, stress, basis, unknowns)

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
