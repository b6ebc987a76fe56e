"""The equations of a scene: residual, matrix and invariants on nodes in local frames.

Unknowns are six per moving node (all bodies, kind by kind) and one multiplier per constraint. A
node that follows another rigidly has none and appears in results only. The frames of what does not
move by itself follow the moving ones in every array: ground first, then the prescribed motions.
Index 3 equations at a time level::

    Lᵀ G q̈ + f_elastic(H) − f_load(H, t) + Bᵀ λ = 0,     Φ(H) = 0
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import scipy.linalg
import scipy.sparse as sp

from fem_lie import constraints, inertia, lie
from fem_lie._jit import Array, Indices
from fem_lie.choices import Choices
from fem_lie.constraints import JointTable
from fem_lie.elastic import Elastic
from fem_lie.groups import Parametrisation
from fem_lie.info import JointInfo, SceneInfo
from fem_lie.joints import Fixed, Joint
from fem_lie.kkt import KKT
from fem_lie.load_cases import LoadCases
from fem_lie.nodal import (
    Inertia,
    add_blocks,
    add_mass_damping,
    combine,
    drop_turning,
    load_potential,
    rigid_residual,
    rigid_tangent,
    to_inertial,
)
from fem_lie.numbering import Numbering
from fem_lie.rigid import RigidBody
from fem_lie.scene import Scene
from fem_lie.supports import Supports


def refuse_ranks() -> None:
    """Raise ``ValueError`` if there is more than one rank."""
    if MPI.COMM_WORLD.size > 1:
        raise ValueError(
            f"scenes run on one rank, got {MPI.COMM_WORLD.size}; the forms of "
            "local_frame_forms run on any number"
        )


class System:
    """The equations of a scene.

    Attributes:
        count: Moving nodes ``n``; ``size`` unknowns are six of each and ``m`` multipliers.
        frames: Initial frames, shape (n + 1 + p, 4, 3): moving nodes, ground, prescribed motions.
        velocities: Initial local velocities, same rows, (…, 6).
        table: All joints.
        kinds: Group and parametrisation of each moving node, shape (n,), see
            :mod:`fem_lie.groups`.
        held: Which unknowns of the moving nodes are zero, shape (n, 6).
        uncoupled: Which of them move by ``x + R u`` in statics, shape (n,).
        supports: Which of them have unknowns along axes fixed in space.
        choices: What :meth:`fill_matrix` takes in.
        length: Diagonal of the initial bounding box, or a body's size: the length of tolerances.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        dynamics: bool,
        parametrisation: Parametrisation = Parametrisation.EXPONENTIAL,
    ) -> None:
        """Number the unknowns and build what stays constant.

        Args:
            scene: What there is.
            dynamics: Whether inertia is needed.
            parametrisation: What the increments of :meth:`fill_matrix` are.

        Raises:
            ValueError: More than one rank; no body; no inertia though needed; redundant joints.
        """
        refuse_ranks()
        if not scene.bodies:
            raise ValueError("the scene has no body")
        self.scene = scene
        self.numbering = Numbering(scene.bodies, scene.links)
        self.count = self.numbering.count
        self.kinds = self.numbering.groups + 2 * int(parametrisation)
        self._motions = [motion.motion for motion in scene.motions]
        fixed = np.array([lie.frame(np.zeros(3), np.eye(3))] + [m(0.0) for m in self._motions])
        self.frames = np.concatenate([self.numbering.frames, fixed])
        still = np.zeros((len(fixed), 6))
        self.velocities = np.concatenate([self.numbering.velocities, still])
        self.held, self.uncoupled = self.numbering.held.copy(), self.numbering.uncoupled
        for clamp in scene.clamps:
            self.held[self.numbering.node(clamp.point)] = True
        self._any_held = bool(self.held.any())
        self.joints, self.table = self._tabulate(scene)
        self.m = len(self.table.selection)
        self.size = 6 * self.count + self.m
        box = np.ptp(self.frames[: self.count, 0], axis=0)
        self.length = max(float(np.linalg.norm(box)), *(body.size for body in scene.bodies))
        self._build_inertia(scene, dynamics)
        self._loads = LoadCases(scene, self.numbering, self._weight(scene))
        self.time_dependent = self._loads.time_dependent or bool(self._motions)
        numbering = self.numbering
        self.elastic = Elastic(numbering.assemblies, numbering.attachment, self._loads.pressure)
        self._viscous = dynamics and self.elastic.viscous
        self._build_matrix()
        if dynamics and self.supports:
            raise ValueError(
                "supports along axes fixed in space (Shell.guide) are for statics; use InPlane "
                "joints in dynamics"
            )
        self._check_redundancy()
        self._work = np.zeros((2, self.count, 4, 3))
        self._damping_work = np.zeros_like(self._work)
        self._still = np.zeros((self.count, 6))
        self._applied, self._any_uncoupled = np.zeros((self.count, 6)), self.uncoupled.any()
        self.choices = Choices(gyroscopic=True, geometric=True)
        self._plain_inertia, self._plain_table = tuple(self.inertia), tuple(self.table)
        self.set_time(0.0, 1.0)

    def _tabulate(self, scene: Scene) -> tuple[list[Joint], JointTable]:
        """All joints, a prescribed motion being a fixed joint to its moving frame."""
        joints = list(scene.joints)
        sides = [(self.numbering.node(joint.a), self.numbering.node(joint.b)) for joint in joints]
        for k, motion in enumerate(scene.motions):
            joints.append(Fixed(motion.point, motion.point, name=f"motion of {motion.point.label}"))
            sides.append((self.numbering.node(motion.point), self.count + 1 + k))
        nodes = np.array(sides, dtype=np.int64).reshape(-1, 2)
        still = np.append(self.held.all(axis=1), [True] * (len(self.frames) - self.count))[nodes]
        turned = np.array([joint.reversible for joint in joints], dtype=bool)
        self._reported = (turned & still[:, 0] & ~still[:, 1]).astype(np.int64)
        nodes[self._reported == 1] = nodes[self._reported == 1, ::-1]
        frames = np.empty((len(joints), 2, 4, 3))
        for k, joint in enumerate(joints):
            for side in range(2):
                inverse = lie.se3_inverse(self.frames[nodes[k, side]])
                frames[k, side] = lie.se3_compose(inverse, joint.frame())
        sizes = [len(joint.selection) for joint in joints]
        first = np.concatenate([[0], np.cumsum(sizes, dtype=np.int64)]).astype(np.int64)
        selection = np.concatenate([np.empty((0, 12))] + [joint.selection for joint in joints])
        return joints, JointTable(nodes, frames, first, selection)

    # --- what stays constant ---

    def _build_inertia(self, scene: Scene, dynamics: bool) -> None:
        rows: list[Indices] = [np.empty(0, dtype=np.int64)]
        columns: list[Indices] = [np.empty(0, dtype=np.int64)]
        blocks: list[Array] = [np.empty((0, 4, 4))]
        damping: list[Array] = [np.empty((0, 4, 4))]
        for where, assembly in self.numbering.assemblies:
            if assembly.inertia is None and (dynamics or scene.gravity.any()):
                raise ValueError(
                    "dynamics and gravity need the inertia of all sections: "
                    "Section.from_stiffness(..., inertia=...)"
                )
            if assembly.inertia is not None:
                r = np.repeat(np.arange(assembly.count), np.diff(assembly.indptr))
                rows.append(where.start + r)
                columns.append(where.start + assembly.indices)
                blocks.append(assembly.inertia.mass)
                none = np.zeros_like(assembly.inertia.mass)
                given = assembly.inertia.damping
                damping.append(none if given is None else given)
        for body in scene.bodies:
            if isinstance(body, RigidBody):
                rows.append(self.numbering.nodes[body])
                columns.append(self.numbering.nodes[body])
                blocks.append(body.gram[np.newaxis])
                damping.append(np.zeros((1, 4, 4)))
        r, c = np.concatenate(rows), np.concatenate(columns)
        self.inertia = self._on_leaders(r, c, np.concatenate(blocks))
        self._inertia_rows = np.repeat(np.arange(self.count), np.diff(self.inertia.indptr))
        D = np.concatenate(damping)
        self._damping = self._on_leaders(r, c, D) if dynamics and D.any() else None

    def _on_leaders(self, r: Indices, c: Indices, blocks: Array) -> Inertia:
        """Blocks of pairs of all nodes as blocks ``Wᵀ G W`` of pairs of leaders, sorted."""
        attachment = self.numbering.attachment
        if not attachment.trivial:
            W = attachment.linear()
            blocks = W[r].transpose(0, 2, 1) @ blocks @ W[c]
            r, c = attachment.leader[r], attachment.leader[c]
        key, place = np.unique(r * self.count + c, return_inverse=True)
        G = np.zeros((len(key), 4, 4))
        np.add.at(G, place, blocks)
        indptr = np.searchsorted(key // self.count, np.arange(self.count + 1))
        return Inertia(indptr, key % self.count, G)

    def _weight(self, scene: Scene) -> Array:
        """Force of gravity on (x, d₁, d₂, d₃), shape (n, 4, 3)."""
        q = np.zeros((self.count, 4, 3))
        q[:, 0] = scene.gravity
        weight = np.zeros_like(q)
        inertia.multiply(*self.inertia, q, weight)
        return weight

    def set_time(self, time: float, factor: float = 1.0) -> None:
        """Loads at ``time`` (those without history times ``factor``, as gravity is) and motions.

        Raises:
            ValueError: A history or motion is not finite.
        """
        self.loads = self._loads.at(time, factor)
        self._plain_loads = tuple(self.loads)

    def prescribed_frames(self, time: float) -> Array:
        """Frames of the prescribed motions at ``time``, shape (p, 4, 3)."""
        frames = np.array([motion(time) for motion in self._motions]).reshape(-1, 4, 3)
        if not np.isfinite(frames).all():
            raise ValueError(f"a prescribed motion is not finite at time {time:g}")
        return frames

    # --- matrix ---

    def _build_matrix(self) -> None:
        pairs = [(self._inertia_rows, self.inertia.indices), *self.elastic.pairs]
        self.kkt = KKT(pairs, self.table, self.held)
        place, diagonal = self.kkt.place, np.arange(self.count)
        self._place_inertia = place(*pairs[0])
        self._place_elastic = [place(*pair) for pair in pairs[1:]]
        self._diagonal = place(diagonal, diagonal)
        a, b = self.table.nodes.T
        self._place_joints = np.stack(
            [np.stack([place(a, a), place(a, b)], 1), np.stack([place(b, a), place(b, b)], 1)], 1
        )
        self._per_constraint = np.repeat(self.table.nodes, np.diff(self.table.first), axis=0)
        self.supports = Supports(
            self.numbering.supports, self.kkt.indptr, self.kkt.indices, self._per_constraint
        )
        self._A = np.zeros((len(self.kkt.indices), 6, 6))
        self._K = np.zeros_like(self._A)
        self._rows = np.zeros((self.m, 2, 6))

    def jacobian(self, H: Array) -> sp.csr_matrix:
        """``B = ∂Φ/∂h`` in the twists of the moving nodes, held ones left out; (m, 6 n)."""
        constraints.jacobian(H, self.table, self._rows)
        self.supports.turn_border(H, self._rows)
        c, side = np.nonzero(self._per_constraint < self.count)
        node = self._per_constraint[c, side]
        free = ~self.held[node].all(axis=1)
        c, side, node = c[free], side[free], node[free]
        columns = (6 * node[:, np.newaxis] + np.arange(6)).ravel()
        values = np.where(self.held[node], 0.0, self._rows[c, side]).ravel()
        return sp.csr_matrix((values, (np.repeat(c, 6), columns)), shape=(self.m, 6 * self.count))

    def _check_redundancy(self) -> None:
        """Raise ``ValueError`` naming joints whose constraints follow from others."""
        if self.m == 0:
            return
        B = self.jacobian(self.frames)
        weight = np.tile([1.0, 1, 1] + [1.0 / self.length] * 3, self.count)
        B = B @ sp.diags(weight)
        norms = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
        # within one rigid body both sides cancel up to round-off
        norms[self._per_constraint[:, 0] == self._per_constraint[:, 1]] = 0.0
        empty = np.flatnonzero(norms == 0.0)
        unit = sp.diags(np.divide(1.0, norms, out=np.zeros_like(norms), where=norms > 0)) @ B
        gram = (unit @ unit.T).toarray()
        # a pivot is the squared distance of a row from the span of those before it
        _, pivots, rank, _ = scipy.linalg.lapack.dpstrf(gram, tol=1e-10)
        redundant = np.union1d(pivots[rank:] - 1, empty)
        if len(redundant):
            owner = np.searchsorted(self.table.first, redundant, side="right") - 1
            names = "; ".join(self.joints[k].label for k in dict.fromkeys(owner))
            raise ValueError(
                f"{len(redundant)} of {self.m} constraints are redundant, they follow from the "
                f"other joints and clamps: {names}. Replace a joint by one with fewer constraints "
                "(e.g. Spherical instead of Revolute) or remove it"
            )

    # --- equations ---

    def residual(
        self, H: Array, v: Array, a: Array, weights: Array, scale: Array, r: Array
    ) -> None:
        """Equations of motion and constraints times ``scale``, into ``r`` (size,).

        Args:
            H: Frames of all rows.
            v: Local velocities, shape (≥ n, 6).
            a: Their rates, shape (≥ n, 6).
            weights: Multipliers (forces and moments), shape (m,).
            scale: Factor of each constraint, shape (m,).
            r: Overwritten.
        """
        self.applied(H, v, a, weights, scale, r)
        self.elastic.add_forces(H, r)
        if self._viscous:
            self.elastic.add_viscous_forces(H, v, r)
        if self._damping is not None:
            add_mass_damping(H, v, tuple(self._damping), self._damping_work, self._work[1], r)
        if self.supports:
            self.supports.turn(H, r[: 6 * self.count].reshape(-1, 6))
        if self._any_held:
            r[: 6 * self.count].reshape(-1, 6)[self.held] = 0.0

    def applied(self, H: Array, v: Array, a: Array, weights: Array, scale: Array, r: Array) -> None:
        """What :meth:`residual` is without elastic forces and damping."""
        rigid_residual(
            H,
            v,
            a,
            self._plain_inertia,
            self._plain_loads,
            self._plain_table,
            weights,
            scale,
            self._work,
            r,
        )
        self._applied[:] = r[: 6 * self.count].reshape(-1, 6)

    def fill_matrix(
        self,
        H: Array,
        v: Array,
        a: Array,
        weights: Array,
        scale: Array,
        d: Array,
        mass: float,
        damping: float,
        joint_frames: Array | None = None,
        inertial: bool = False,
    ) -> None:
        """Derivative of :meth:`residual` in the increments ``d`` that led to ``H``, into the KKT.

        ``mass`` and ``damping`` are ∂a/∂d and ∂v/∂d; the constraints' Jacobian is taken at
        ``joint_frames`` (default: ``H``). Call it after a residual at the same state. The matrix
        is in components along the nodes' axes, or along fixed ones if ``inertial``.
        """
        ahead = H if joint_frames is None else joint_frames
        self._A[:] = 0.0
        self._K[:] = 0.0
        spinning = bool(self.choices.gyroscopic)
        rigid_tangent(
            H,
            v if spinning else self._still,
            a if spinning else self._still,
            self.kinds,
            self.inertia,
            self._place_inertia,
            self._work[1],
            self.loads.moment,
            self._diagonal,
            (mass, damping),
            self._A,
            self._K,
        )
        for place, blocks in zip(self._place_elastic, self.elastic.tangents(H), strict=True):
            add_blocks(self._K, place, blocks)
        if damping != 0.0:
            self._add_damping(H, v, damping)
        if self.choices.geometric:
            constraints.geometric(H, self.table, weights, self._place_joints, self._K)
        if self._any_uncoupled:
            drop_turning(self._applied, self.uncoupled, self._diagonal, self._K)
        constraints.jacobian(ahead, self.table, self._rows)
        nodes, bind = self._per_constraint, self.kkt.indices
        columns = self._rows.copy()
        if d.any():
            combine(self._A, self._K, self._rows, self.kinds, d, nodes, bind)
        else:
            self._A += self._K
        if self.supports:
            self.supports.turn_blocks(H, self._A)
            self.supports.turn_border(H, columns)
            self.supports.turn_border(H, self._rows)
        if inertial:
            to_inertial(self._A, columns, self._rows, ahead, nodes, self.kkt.indptr, bind)
        self.kkt.fill(self._A, columns, self._rows, scale)

    def _add_damping(self, H: Array, v: Array, damping: float) -> None:
        """Add ``damping`` times the derivative of damping forces in the velocities to ``A``."""
        if self._viscous:
            self._add_viscosity(H, damping)
        if self._damping is not None:
            self._add_mass_damping(H, v, damping)

    def _add_viscosity(self, H: Array, damping: float) -> None:
        for k, blocks in self.elastic.viscous_tangents(H):
            add_blocks(self._A, self._place_elastic[k], damping * blocks)

    def _add_mass_damping(self, H: Array, v: Array, damping: float) -> None:
        """Also ``Lᵀ D ∂(L v)/∂h`` to ``K``: ``L v`` is the acceleration ``v`` of a body at rest."""
        assert self._damping is not None
        still, place = np.zeros((self.count, 6)), self._place_inertia
        rate = v[: self.count]
        local = np.zeros(self.count, dtype=np.int64)
        inertia.tangents(
            H, still, rate, local, *self._damping, place, damping, 0.0, self._A, self._K
        )

    def linearised(self, H: Array, v: Array, weights: Array) -> tuple[Array, Array, Array]:
        """Mass, damping and stiffness of small motions about steady motion, blocks of ``kkt``.

        All nodes move with constant local velocities ``v``, those of one rigid motion, and a
        little aside: ``H exp(h)``. Then ``δv = ḣ + ad(v) h``, ``δv̇ = ḧ + ad(v) ḣ`` and

            M ḧ + (C + M ad(v)) ḣ + (∂r/∂h + C ad(v)) h + Bᵀ δλ = 0,    M = ∂r/∂a, C = ∂r/∂v.

        Viscous stress does not feel the rigid motion and enters with ``ḣ`` alone. Elastic stress is
        the carried one: see ``elastic.reset_stress``.

        Args:
            H: Frames of all rows.
            v: Local velocities of the moving nodes, shape (n, 6).
            weights: Multipliers, shape (m,).

        Returns:
            Three arrays of shape (nnz, 6, 6).
        """
        none = np.zeros_like(v)
        scale, r = np.ones(self.m), np.empty(self.size)
        self.residual(H, v, none, weights, scale, r)
        ad = lie.se3_ad(v)[self.kkt.indices]
        self._add_rigid_tangent(H, v, (1.0, 0.0))
        M = self._A.copy()
        self._add_rigid_tangent(H, v, (0.0, 1.0))
        if self._damping is not None:
            self._add_mass_damping(H, v, 1.0)
        for place, blocks in zip(self._place_elastic, self.elastic.tangents(H), strict=True):
            add_blocks(self._K, place, blocks)
        constraints.geometric(H, self.table, weights, self._place_joints, self._K)
        if self._any_uncoupled:
            drop_turning(self._applied, self.uncoupled, self._diagonal, self._K)
        K = self._K + self._A @ ad
        if self._viscous:
            self._add_viscosity(H, 1.0)
        return M, self._A + M @ ad, K

    def fill_steady(self, H: Array, v: Array, weights: Array, scale: Array) -> None:
        """Stiffness of :meth:`linearised`, bordered by the scaled constraints, into the KKT."""
        _, _, K = self.linearised(H, v, weights)
        constraints.jacobian(H, self.table, self._rows)
        self.kkt.fill(K, self._rows, self._rows, scale)

    def _add_rigid_tangent(self, H: Array, v: Array, factors: tuple[float, float]) -> None:
        """Start ``A`` and ``K`` anew, without acceleration; see :func:`rigid_tangent`."""
        self._A[:] = 0.0
        self._K[:] = 0.0
        rigid_tangent(
            H,
            v,
            np.zeros_like(v),
            np.zeros(self.count, dtype=np.int64),  # derivatives in rates of twists, on any group
            self.inertia,
            self._place_inertia,
            self._work[1],
            self.loads.moment,
            self._diagonal,
            factors,
            self._A,
            self._K,
        )

    def fill_start_matrix(self, H: Array, stiffness: float) -> None:
        """``M + stiffness · K_elastic`` bordered by the unscaled constraints, into the KKT."""
        self._A[:] = 0.0
        self._K[:] = 0.0
        if stiffness > 0.0:
            self.elastic.reset_stress(H)
            for place, blocks in zip(self._place_elastic, self.elastic.tangents(H), strict=True):
                add_blocks(self._A, place, stiffness * blocks)
        still = np.zeros((self.count, 6))
        inertia.tangents(
            H,
            still,
            still,
            self.kinds,
            *self.inertia,
            self._place_inertia,
            1.0,
            0.0,
            self._A,
            self._K,
        )
        constraints.jacobian(H, self.table, self._rows)
        self.kkt.fill(self._A, self._rows, self._rows, np.ones(self.m))

    def constraint_scale(self, H: Array) -> Array:
        """``1/(B diag(S)⁻¹ Bᵀ)`` of each constraint with the ``S`` filled last, shape (m,).

        Bordered by ``σ B`` with these factors ``σ`` the matrix is about as well conditioned as
        ``S``: as ``S → M/(βh²)`` this is the index 3 scaling of Bottasso, Bauchau & Cardona.
        """
        diagonal = np.abs(self._A[self._diagonal].diagonal(axis1=1, axis2=2)).ravel()
        B = self.jacobian(H)
        weighted = B.multiply(B).multiply(1.0 / np.where(diagonal > 0, diagonal, 1.0))
        return 1.0 / np.asarray(weighted.sum(axis=1)).ravel()

    def potential_energy(self, H: Array) -> float:
        """Potential of gravity and of loads fixed in space that have no history and no moment."""
        return float(load_potential(H, self.loads.dead))

    def joint_forces(self, H: Array, weights: Array) -> Array:
        """Force and moment of each joint on its point ``a``, in its axes there, shape (j, 6)."""
        forces = np.empty((len(self.joints), 6))
        constraints.wrenches(H, self.table, weights, self._reported, forces)
        return forces

    @property
    def symmetric(self) -> bool:
        """Whether the static equations have a symmetric matrix in every state."""
        bound = bool(self.table.selection[:, 3:].any())
        turning = self._loads.turning or self._loads.pressure is not None
        return bool(self.uncoupled.all()) and not bound and not turning

    def describe(self) -> str:
        """What the scene consists of and what was chosen, in one line, for the log."""
        total, n, flat = self.numbering.total, self.count, int((self.kinds & 1).sum())
        parts = [
            f"{total} nodes, {total - n} of them follow others, {self.m} constraints",
            f"{n - flat} nodes on SE(3), {flat} on R³×SO(3), all with three rotations",
            f"gyroscopic terms in the matrix: {_yes(self.choices.gyroscopic)}",
            f"geometric stiffness: {_yes(self.choices.geometric)}",
            f"viscous damping: {_yes(self._viscous)}, of mass: {_yes(self._damping is not None)}",
            f"pressure: {_yes(self._loads.pressure is not None)}",
            f"loads or motions in time: {_yes(self.time_dependent)}",
        ]
        return "; ".join(parts)

    def info(self) -> SceneInfo:
        """Bodies and joints in the numbering of all nodes, for results."""
        leaders, table = self.numbering.attachment.leaders, self.table
        # drawn on its side A, or on B if A is ground
        sides = (table.nodes[:, 0] >= self.count).astype(np.int64)
        joints = tuple(
            JointInfo(
                name=joint.label,
                kind=type(joint).__name__,
                node=int(leaders[table.nodes[k, side]]),
                offset=table.frames[k, side, 0],
            )
            for k, (joint, side) in enumerate(zip(self.joints, sides, strict=True))
        )
        return SceneInfo(self.numbering.bodies(), joints)


def _yes(chosen: bool | None) -> str:
    return "yes" if chosen else "no"
