"""Small vibrations about any equilibrium: unloaded, loaded, or in steady rotation.

With ``H exp(h)`` beside the equilibrium ``H`` the linear equations are, without any further
assumption on what is in the scene (:func:`fem_lie.solve.statics.steady.linearised`)::

    M ḧ + (C + M ad(v)) ḣ + (∂r/∂h + C ad(v)) h + Bᵀ δλ = 0,    B h = 0

with ``v`` the local velocities of the steady rotation. The stiffness holds geometric stiffness of
stress, loads and joints and centrifugal softening, the damping the Coriolis terms.
"""

from __future__ import annotations

import logging

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array, instance, whole
from fem_lie.linear.rigid_parts import RigidParts
from fem_lie.linear.spectrum import Complex, Pencil
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.vibrations import Modes
from fem_lie.scene import Scene
from fem_lie.scene.choices import Redundant
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.stability.mode_scaling import node_lengths, scaled
from fem_lie.solve.stability.rigid_motions import rigid_motions, stress_terms
from fem_lie.solve.statics.statics import statics
from fem_lie.solve.statics.steady import linearised
from fem_lie.system import System

_log = logging.getLogger(__name__)

_BALANCED = 1e-9
_ULPS = 1e-15  # of the largest stiffness: forces that are round-off of the frames


def vibrations(
    scene: Scene,
    count: int = 6,
    *,
    at: StaticResult | None = None,
    spin: npt.ArrayLike = (0.0, 0.0, 0.0),
    about: npt.ArrayLike = (0.0, 0.0, 0.0),
    load_steps: int = 1,
    petsc_options_prefix: str = "fem_lie_vibrations_",
) -> Modes:
    """Frequencies, damping and shapes of the slowest small vibrations.

    The equilibrium is the initial configuration if that is one under the full loads (unloaded
    bodies, or a top that stands upright), or else what
    :func:`~fem_lie.solve.statics.load_steps.statics` finds. Bodies may be free: rigid motions have
    eigenvalues zero. An unstable equilibrium is no
    error: see ``Modes.unstable``.

    Args:
        scene: What there is; initial velocities do not matter.
        count: Number of modes.
        at: Equilibrium of this scene, the last state of it; its rotation is taken with it.
        spin: Angular velocity of the frame in which there is equilibrium, global components, rad
            per time; frequencies and shapes are those seen in it.
        about: A place on its axis.
        load_steps: For statics.
        petsc_options_prefix: Prefix for the choice of SLEPc's solver.

    Raises:
        ValueError: Bad scene or options; no inertia; more modes than degrees of freedom.
        ConvergenceError: No equilibrium, or not all modes were found.
    """
    rotation = Rotation.of(spin, about)
    rotation.check(scene)
    whole(count, "count")
    instance(at, StaticResult | None, "at", "a result of fl.statics or None")
    if at is not None:
        if rotation:
            raise ValueError("the rotation comes with at=...; do not give spin, too")
        rotation = at.steady_rotation
    system = System(scene, dynamics=True)
    if scene.redundant is not Redundant.REFUSE:
        raise ValueError("vibrations need constraints of which none is redundant")
    if any(joint.velocity_ties() for joint in scene.joints):
        raise ValueError("vibrations need constraints of positions, got one of velocities")
    free = int((~system.held).sum()) - system.m
    if not 1 <= count <= free:
        raise ValueError(f"count must be 1 … {free}, the degrees of freedom, got {count}")
    state = _Linear(system, rotation)
    if at is not None:
        state.move(at)
    elif not state.balanced():
        result = statics(scene, spin=spin, about=about, load_steps=load_steps)
        state.move(result)
    s, vectors, residuals = state.pencil().smallest(count, state.rate, petsc_options_prefix)
    found = [state.shape(vector) for vector in vectors]
    modes = Modes(
        eigenvalues=s,
        shapes=np.array([shape for shape, _ in found]),
        turns_only=np.array([turns for _, turns in found], dtype=np.bool_),
        frames=system.numbering.attachment.frames(state.H).copy(),
        size=system.length,
        residuals=residuals,
        info=system.info(),
    )
    if modes.unstable.any():
        _log.warning("the equilibrium is unstable: eigenvalues %s", s[modes.unstable])
    return modes


class _Linear:
    """Linear equations of a system in one state; translations are measured in its length."""

    def __init__(self, system: System, rotation: Rotation) -> None:
        self.system, self.rotation = system, rotation
        self.rate = float(np.linalg.norm(rotation.spin))
        self.weight = np.tile([system.length] * 3 + [1.0] * 3, system.count)
        self._lengths = node_lengths(system.numbering.nodes)
        system.set_time(1.0)
        self.H = system.frames.copy()
        self.H[system.count + 1 :] = system.prescribed_frames(1.0)
        self._evaluate()

    def move(self, result: StaticResult) -> None:
        """Take over an equilibrium.

        Raises:
            ValueError: It is none of this scene.
        """
        system, attachment = self.system, self.system.numbering.attachment
        last = result.frames[-1:]
        if last.shape[1:] != (system.numbering.total, 4, 3):
            raise ValueError(
                f"at=... must be an equilibrium of this scene with {system.numbering.total} nodes, "
                f"got frames of shape {result.frames.shape}"
            )
        self.H[: system.count] = last[0, attachment.leaders]
        self._evaluate()
        if not self.balanced(1e-5):
            raise ValueError("at=... is no equilibrium of this scene under its full loads")

    def _evaluate(self) -> None:
        """Joint forces that balance the rest as well as they can, and what is left."""
        system = self.system
        n = 6 * system.count
        self.v = self.rotation.velocities(self.H[: system.count])
        none, r = np.zeros_like(self.v), np.empty(system.size)
        state = self.H, self.v, none, np.zeros(system.m), np.ones(system.m)
        system.elastic.reset_stress(self.H)
        system.applied(*state, r)
        applied = self._largest(r)
        system.residual(*state, r)
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
        system = self.system
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
        reach = float(np.abs(self.H[: self.system.count, 0]).max()) / self.system.length
        stiffness = (1e-12 + 4.0 * np.finfo(np.float64).eps * reach) * abs(K).max()
        return self.gap <= tolerance and self.left <= (
            tolerance * max(self.force, inertia) + stiffness
        )

    def _matrix(self, blocks: Array) -> sp.csr_matrix:
        """Of the free unknowns, in units of energy."""
        kkt, held = self.system.kkt, self.system.held.ravel()
        if self.system.supports:
            blocks = blocks.copy()
            self.system.supports.turn_blocks(self.H, blocks)
        size = (len(held), len(held))
        A = sp.bsr_matrix((blocks, kkt.indices, kkt.indptr), shape=size).tocsr()
        weights = sp.diags(self.weight)
        A = (weights @ A @ weights).tocsr()[~held][:, ~held]
        A.eliminate_zeros()
        return A

    def pencil(self) -> Pencil:
        """The eigenvalue problem."""
        M, C, K = (self._matrix(blocks) for blocks in self.blocks)
        free = ~self.system.held.ravel()
        parts = self._parts(K) if self.system.elastic.pairs else None
        return Pencil(M, C if C.nnz else None, K, self.B.tocsr()[:, free], parts)

    def _parts(self, K: sp.csr_matrix) -> RigidParts:
        """What elements do, and what else there is."""
        system, kkt = self.system, self.system.kkt
        state = system, self.H, self.v, self.multipliers
        rest = self._matrix(linearised(*state, elements=False)[2])
        forces, blocks = np.zeros(6 * system.count), np.zeros_like(self.blocks[2])
        system.elastic.add_forces(self.H, forces)
        nodes = np.arange(system.count)
        blocks[kkt.place(nodes, nodes)] = stress_terms(forces.reshape(-1, 6))
        motions = rigid_motions(system, self.H, self.weight)
        return RigidParts(rest, (K - rest).tocsr(), self._matrix(blocks), motions)

    def shape(self, vector: Complex) -> tuple[Complex, bool]:
        """Increments of all nodes, see :class:`~.vibrations.Modes`, and if they only turn."""
        system = self.system
        h = np.zeros((system.count, 6), dtype=np.complex128)
        h[~system.held] = vector
        h *= self.weight.reshape(-1, 6)
        system.supports.turn_back(self.H, h.real)
        system.supports.turn_back(self.H, h.imag)
        twists = system.numbering.attachment.twists
        shape = twists(np.ascontiguousarray(h.real)) + 1j * twists(np.ascontiguousarray(h.imag))
        found, turns_only = scaled(shape, self._lengths)
        return np.asarray(found if turns_only else system.length * found), turns_only
