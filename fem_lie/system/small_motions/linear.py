"""Small vibrations beside a state: the equations as matrices of the free unknowns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array
from fem_lie.lie.kinds import SLOPE, shown_all
from fem_lie.linear.spectra.pencil import Pencil
from fem_lie.linear.spectra.rigid_parts import RigidParts
from fem_lie.linear.spectra.slepc import Complex
from fem_lie.scene.rotation import Rotation
from fem_lie.system.instant import Instant
from fem_lie.system.small_motions.rigid_motions import rigid_motions, stress_terms
from fem_lie.system.small_motions.steady import linearised
from fem_lie.system.system import System

_BALANCED = 1e-9
_ULPS = 1e-15  # of the largest stiffness: forces that are round-off of the frames


class SmallMotions:
    """Linear equations of a scene in one state; translations are measured in its length.

    Attributes:
        rotation: The steady rotation about which motions are small.
        rate: Its angular velocity.
        H: Frames of all rows.
    """

    def __init__(self, system: System, rotation: Rotation) -> None:
        """Beside the initial frames, under the loads of time 1."""
        self._system, self.rotation = system, rotation
        self.rate = float(np.linalg.norm(rotation.spin))
        self.weight = system.units
        system.set_time(1.0)
        self.H = system.frames.copy()
        self.H[system.count + 1 :] = system.prescribed_frames(1.0)
        self._evaluate()

    def move(self, frames: Array) -> None:
        """Take over an equilibrium, frames of all nodes in its states, (k, N, 4, 3): the last one.

        Raises:
            ValueError: It is none of this scene.
        """
        system, attachment = self._system, self._system.numbering.attachment
        last = frames[-1:]
        if last.shape[1:] != (system.numbering.total, 4, 3):
            raise ValueError(
                f"at=... must be an equilibrium of this scene with {system.numbering.total} nodes, "
                f"got frames of shape {frames.shape}"
            )
        self.H[: system.count] = last[0, attachment.leaders]
        self._evaluate()
        if not self.balanced(1e-5):
            raise ValueError(
                "at=... is no equilibrium of this scene under its full loads, or a rough one: "
                "statics with newton=fl.Newton(tolerance=1e-13) finds a finer one"
            )

    def _evaluate(self) -> None:
        """Joint forces that balance the rest as well as they can, and what is left."""
        system = self._system
        n = 6 * system.count
        self.v = self.rotation.velocities(system.kinds, self.H)
        none, r = np.zeros_like(self.v), np.empty(system.size)
        now, ones = Instant(self.H, self.v, none, np.zeros(system.m)), np.ones(system.m)
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
            gram = scipy.sparse.linalg.splu((self.B @ self.B.T).tocsc())
            self.multipliers = -gram.solve(self.B @ force)
        # where no joint takes it, what is left is all of the sum
        self.force = max(applied, float(np.abs(force).max(initial=0.0)))
        self.left = float(np.abs(force + self.B.T @ self.multipliers).max(initial=0.0))
        self.blocks = linearised(system, self.H, self.v, self.multipliers)
        if self.force <= _ULPS * abs(self._matrix(self.blocks[2])).max():
            # what round-off makes of strains would stiffen joints
            self.multipliers[:] = 0.0
            self.blocks = linearised(system, self.H, self.v, self.multipliers)

    def _largest(self, r: Array) -> float:
        """The largest of the forces ``r`` on what is free to move, in units of energy."""
        system = self._system
        forces = r[: 6 * system.count].reshape(-1, 6).copy()
        if system.supports:
            system.supports.turn(self.H, forces)
        forces[system.held] = 0.0
        return float(np.abs(self.weight * forces.ravel()).max(initial=0.0))

    def balanced(self, tolerance: float = _BALANCED) -> bool:
        """Whether joints can balance all other forces."""
        M, _, K = (self._matrix(blocks) for blocks in self.blocks)
        inertia = abs(M).max() * self.rate**2
        # an iteration knows its state to a part of the model's size, and places to their digits
        reach = float(np.abs(self.H[: self._system.count, 0]).max()) / self._system.length
        stiffness = (1e-12 + 4.0 * np.finfo(np.float64).eps * reach) * abs(K).max()
        return self.gap <= tolerance and self.left <= (
            tolerance * max(self.force, inertia) + stiffness
        )

    def _matrix(self, blocks: Array) -> sp.csr_matrix:
        """Of the free unknowns, in units of energy."""
        kkt, held = self._system.kkt, self._system.held.ravel()
        if self._system.supports:
            blocks = blocks.copy()
            self._system.supports.turn_blocks(self.H, blocks)
        size = (len(held), len(held))
        A = sp.bsr_matrix((blocks, kkt.indices, kkt.indptr), shape=size).tocsr()
        weights = sp.diags(self.weight)
        A = (weights @ A @ weights).tocsr()[~held][:, ~held]
        A.eliminate_zeros()
        return A

    def pencil(self) -> Pencil:
        """The eigenvalue problem."""
        M, C, K = (self._matrix(blocks) for blocks in self.blocks)
        free = ~self._system.held.ravel()
        pencil = Pencil(M, C if C.nnz else None, K, self.B.tocsr()[:, free], self._parts(K))
        return pencil if pencil.split_is_exact else replace(pencil, parts=None)

    def stiffness(self) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Tangent of the free unknowns in units of energy, and the Jacobian of constraints."""
        return self._matrix(self.blocks[2]), self.B.tocsr()[:, ~self._system.held.ravel()]

    def _parts(self, K: sp.csr_matrix) -> RigidParts:
        """What elements do, and what else there is."""
        system, kkt = self._system, self._system.kkt
        state = system, self.H, self.v, self.multipliers
        rest = self._matrix(linearised(*state, elements=False)[2])
        forces, blocks = np.zeros(6 * system.count), np.zeros_like(self.blocks[2])
        system.elastic.add_forces(self.H, forces)
        nodes = np.arange(system.count)
        blocks[kkt.place(nodes, nodes)] = stress_terms(forces.reshape(-1, 6))
        # axes that do not turn about themselves feel that of a stressed piece
        motions = [
            (piece.unknowns, piece.basis)
            for piece in rigid_motions(system, self.H, self.weight)
            if (system.kinds[piece.nodes] < SLOPE).all()
        ]
        return RigidParts(rest, (K - rest).tocsr(), self._matrix(blocks), motions)

    def twists(self, vector: Complex) -> Complex:
        """Twists of all nodes, (N, 6), that a vector of free unknowns means."""
        system = self._system
        h = np.zeros((system.count, 6), dtype=np.complex128)
        h[~system.held] = vector
        h *= self.weight.reshape(-1, 6)
        system.supports.turn_back(self.H, h.real)
        system.supports.turn_back(self.H, h.imag)
        twists = system.numbering.attachment.twists
        shown = np.empty((2, *h.shape))
        for part, out in zip((h.real, h.imag), shown, strict=True):
            shown_all(system.kinds, self.H, np.ascontiguousarray(part), out)
        return np.asarray(twists(shown[0]) + 1j * twists(shown[1]))
