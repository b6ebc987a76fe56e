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

from fem_lie import constraints, inertia, lie
from fem_lie._jit import Array, Indices
from fem_lie.choices import Choices
from fem_lie.constraints import JointTable
from fem_lie.elastic import Elastic
from fem_lie.groups import Parametrisation
from fem_lie.info import JointInfo, SceneInfo
from fem_lie.joints import Fixed, Joint
from fem_lie.load_cases import LoadCases
from fem_lie.masses import inertia_of
from fem_lie.nodal import Inertia, add_mass_damping, load_potential, rigid_residual
from fem_lie.numbering import Numbering
from fem_lie.pressure import Pressure
from fem_lie.redundancy import check_redundancy
from fem_lie.scene import Scene
from fem_lie.tangent import Tangent


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
        inertia: That of the moving nodes.
        elastic: Elements and pressure.
        tangent: The matrix; ``kkt`` is what it is filled into.
        force: On (x, d₁, d₂, d₃) in the last residual: ``G q̈`` and mass damping minus dead loads,
            shape (n, 4, 3).
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
        self.joints, self.table, self._reported = self._tabulate(scene)
        self.m = len(self.table.selection)
        self.size = 6 * self.count + self.m
        box = np.ptp(self.frames[: self.count, 0], axis=0)
        self.length = max(float(np.linalg.norm(box)), *(body.size for body in scene.bodies))
        required = dynamics or bool(scene.gravity.any())
        self.inertia, damping = inertia_of(scene.bodies, self.numbering, required=required)
        self._damping = damping if dynamics else None
        self._loads = LoadCases(scene, self.numbering, self._weight(scene))
        self.time_dependent = self._loads.time_dependent or bool(self._motions)
        numbering = self.numbering
        self.elastic = Elastic(numbering.assemblies, numbering.attachment, self._loads.pressure)
        self._viscous = dynamics and self.elastic.viscous
        self.tangent = Tangent(
            self.inertia,
            self._damping,
            self.elastic,
            self.table,
            self.held,
            self.numbering.supports,
            viscous=self._viscous,
        )
        self.kkt, self.supports = self.tangent.kkt, self.tangent.supports
        if dynamics and self.supports:
            raise ValueError(
                "supports along axes fixed in space (Shell.guide) are for statics; use InPlane "
                "joints in dynamics"
            )
        B = self.tangent.jacobian(self.frames)
        check_redundancy(B, self.joints, self.table, self.length)
        self._work = np.zeros((2, self.count, 4, 3))
        self.force = self._work[1]
        self._damping_work = np.zeros_like(self._work)
        self._still = np.zeros((self.count, 6))
        self._applied, self._any_uncoupled = np.zeros((self.count, 6)), self.uncoupled.any()
        self.choices = Choices(gyroscopic=True, geometric=True)
        self._plain_inertia, self._plain_table = tuple(self.inertia), tuple(self.table)
        self.set_time(0.0, 1.0)

    def _tabulate(self, scene: Scene) -> tuple[list[Joint], JointTable, Indices]:
        """All joints, a prescribed motion being a fixed joint to its moving frame.

        Side A is one that moves; the third result is where in the table the user's side A is.
        """
        joints = list(scene.joints)
        sides = [(self.numbering.node(joint.a), self.numbering.node(joint.b)) for joint in joints]
        for k, motion in enumerate(scene.motions):
            joints.append(Fixed(motion.point, motion.point, name=f"motion of {motion.point.label}"))
            sides.append((self.numbering.node(motion.point), self.count + 1 + k))
        nodes = np.array(sides, dtype=np.int64).reshape(-1, 2)
        still = np.append(self.held.all(axis=1), [True] * (len(self.frames) - self.count))[nodes]
        reversible = np.array([joint.reversible for joint in joints], dtype=bool)
        turned = reversible & still[:, 0] & ~still[:, 1]
        nodes[turned] = nodes[turned, ::-1]
        frames = np.empty((len(joints), 2, 4, 3))
        for k, joint in enumerate(joints):
            for side in range(2):
                inverse = lie.se3_inverse(self.frames[nodes[k, side]])
                frames[k, side] = lie.se3_compose(inverse, joint.frame())
        sizes = [len(joint.selection) for joint in joints]
        first = np.concatenate([[0], np.cumsum(sizes, dtype=np.int64)]).astype(np.int64)
        selection = np.concatenate([np.empty((0, 12))] + [joint.selection for joint in joints])
        return joints, JointTable(nodes, frames, first, selection), turned.astype(np.int64)

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

    @property
    def pressure(self) -> Pressure | None:
        """All pressures on pairs of nodes, or ``None``."""
        return self._loads.pressure

    @property
    def mass_damping(self) -> Inertia | None:
        """Damping that goes with mass, on (x, d₁, d₂, d₃) of the moving nodes."""
        return self._damping

    @property
    def conservative(self) -> Array:
        """Gravity and forces fixed in space without history, on (x, d₁, d₂, d₃), (n, 4, 3)."""
        return self._loads.constant

    def prescribed_frames(self, time: float) -> Array:
        """Frames of the prescribed motions at ``time``, shape (p, 4, 3)."""
        frames = np.array([motion(time) for motion in self._motions]).reshape(-1, 4, 3)
        if not np.isfinite(frames).all():
            raise ValueError(f"a prescribed motion is not finite at time {time:g}")
        return frames

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
        if self._any_uncoupled:
            self._applied[:] = r[: 6 * self.count].reshape(-1, 6)

    def drop_turning(self) -> None:
        """Leave out of the matrix what elements that move by ``x + R u`` leave out of theirs."""
        if self._any_uncoupled:
            self.tangent.drop_turning(self._applied, self.uncoupled)

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
        tangent, spinning = self.tangent, bool(self.choices.gyroscopic)
        tangent.clear()
        tangent.add_inertia(
            H,
            v if spinning else self._still,
            a if spinning else self._still,
            self.kinds,
            self.force,
            self.loads.moment,
            (mass, damping),
        )
        tangent.add_elastic(H)
        if damping != 0.0:
            tangent.add_viscosity(H, damping)
            tangent.add_mass_damping(H, v, damping)
        if self.choices.geometric:
            tangent.add_geometric(H, weights)
        self.drop_turning()
        ahead = H if joint_frames is None else joint_frames
        tangent.fill_increments(ahead, self.kinds, d, scale, inertial=inertial)

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
