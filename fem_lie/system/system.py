"""The equations of a scene: residual, matrix and invariants on nodes in local frames.

Unknowns are six per moving node (all bodies, kind by kind) and one multiplier per constraint. A
node that follows another rigidly has none and appears in results only. The frames of what does not
move by itself follow the moving ones in every array: ground first, then the prescribed motions.
Index 3 equations at a time level::

    Lᵀ G q̈ + f_elastic(H) − f_load(H, t) + Bᵀ λ = 0,     Φ(H) = 0
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from functools import cached_property

from mpi4py import MPI

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices, diameter
from fem_lie.bodies.catalogue import SceneInfo, SupportInfo
from fem_lie.forms.fixed_arrays import FixedArrays
from fem_lie.joints.equations import terms
from fem_lie.joints.histories import declared, until_next
from fem_lie.lie.motions import Group, Parametrisation, retract
from fem_lie.linear.idle_multipliers import IdleMultipliers
from fem_lie.linear.redundancy import redundant_constraints
from fem_lie.scene import Scene
from fem_lie.scene.choices import Choices, Redundant
from fem_lie.scene.pressure import Pressure
from fem_lie.scene.surface_pressure import SurfacePushes
from fem_lie.system.constraints import Connections, refuse
from fem_lie.system.elastic import Elastic
from fem_lie.system.load_cases import Contents, LoadCases
from fem_lie.system.nodes import inertia
from fem_lie.system.nodes.carried_drilling import CarriedDrilling
from fem_lie.system.nodes.element_turns import ElementTurns
from fem_lie.system.nodes.fixed_axes import wrenches
from fem_lie.system.nodes.inertia import Inertia
from fem_lie.system.nodes.loads import Loads
from fem_lie.system.nodes.masses import inertia_of
from fem_lie.system.nodes.shared_setup import numbering_for
from fem_lie.system.nodes.sums import add_mass_damping, report, residual, rigid_residual
from fem_lie.system.tangent import Tangent

_log = logging.getLogger(__name__)


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
        connections: All joints, and what acts along them; ``table`` is theirs.
        kinds: Group and parametrisation of each moving node, shape (n,), see
            :mod:`fem_lie.lie.motions`.
        held: Which unknowns of the moving nodes are zero, shape (n, 6).
        supported: Moving nodes that clamps and bodies hold, see :meth:`reactions`, shape (s,).
        uncoupled: Which of them move by ``x + R u`` in statics, shape (n,).
        inertia: That of the moving nodes.
        loads: At the time that was set last; ``lasting_loads``: the same in arrays that stay.
        elastic: Elements and pressure.
        tangent: The matrix; ``kkt`` is what it is filled into.
        force: On (x, d₁, d₂, d₃) in the last residual: ``G q̈`` and mass damping minus dead loads,
            shape (n, 4, 3).
        carried_drilling: Frames that follow the mid-surface, to be turned after each step.
        velocity_factor: Of constraints of velocities in the residual: ∂d/∂v, so that their rows in
            the matrix are like those of positions.
        choices: What :meth:`fill_matrix` takes in.
        turns: How far elements turn from end to end.
        length: Largest distance of two nodes, or a body's size: the length of tolerances.
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
        self.numbering = numbering_for(scene, self)
        self.count = self.numbering.count
        # what is held along fixed axes is held exactly where translations are along fixed axes
        supported = np.isfinite(self.numbering.supports[:, 0, 0])
        groups = np.where(supported, int(Group.R3xSO3), self.numbering.groups)
        self.kinds = groups + 2 * int(parametrisation)
        self._motions = scene.motions
        self._breaks = declared([motion.motion for motion in scene.motions], kinks=True)
        fixed = np.array([lie.frame(np.zeros(3), np.eye(3)), *self.prescribed_frames(0.0)])
        self.frames = np.concatenate([self.numbering.frames, fixed])
        still = np.zeros((len(fixed), 6))
        self.velocities = np.concatenate([self.numbering.velocities, still])
        self.held, self.uncoupled = self.numbering.held.copy(), self.numbering.uncoupled
        clamped = [self.numbering.node(clamp.point) for clamp in scene.clamps]
        self.held[clamped] = True
        self.supported = np.union1d(self.numbering.supported, clamped).astype(np.int64)
        self._everything = np.ones_like(self.held)
        self._any_held = bool(self.held.any())
        self.connections = Connections(scene, self.numbering, self.frames, self.held)
        self.table = self.connections.table
        self.m = self.connections.m
        self._others = not self.connections.of_joints_only
        if self.connections.of_velocities and not dynamics:
            raise ValueError("KnifeEdge and RollingDisc bind velocities: they are for dynamics")
        self.size = 6 * self.count + self.m
        places = self.frames[: self.count, 0]
        self.length = max(diameter(places), *(body.size for body in scene.bodies))
        required = dynamics or bool(scene.gravity.any())
        self.inertia, damping = inertia_of(scene.bodies, self.numbering, required=required)
        self._damping = damping if dynamics else None
        z, n = np.zeros, self.count
        self.lasting_loads = Loads(z((n, 4, 3)), z((n, 3)), z((n, 6)))
        self._loads = LoadCases(scene, self.numbering, self._weight(scene))
        moves = bool(self._motions) or self.connections.driven
        self.time_dependent = self._loads.time_dependent or moves
        numbering = self.numbering
        self.elastic = Elastic(numbering.assemblies, numbering.attachment, self._loads.pressures)
        self._viscous = dynamics and self.elastic.viscous
        self.tangent = Tangent(
            self.inertia,
            self._damping,
            self.elastic,
            self.connections,
            self.held,
            self.numbering.supports,
            viscous=self._viscous,
            redundant=scene.redundant is not Redundant.REFUSE,
            length=self.length,
        )
        self.turns = ElementTurns(self.numbering)
        self.kkt, self.supports = self.tangent.kkt, self.tangent.supports
        self._guided = bool(self.supports)
        self.carried_drilling = CarriedDrilling(numbering, self.held, self.table.nodes.ravel())
        B = self.tangent.jacobian(self.frames)
        redundant = redundant_constraints(B, self.length, self.kkt.measure)
        if scene.redundant is Redundant.REFUSE:
            refuse(redundant, self.connections)
        elif len(redundant):
            _log.info("%d of %d constraints are redundant", len(redundant), self.m)
        self._work = np.zeros((2, self.count, 4, 3))
        self.force, self._report_work = self._work[1], np.zeros_like(self._work)
        self._damping_work = np.zeros_like(self._work)
        self._still = np.zeros((self.count, 6))
        self._applied, self._internal = np.zeros((2, self.count, 6))
        self._any_uncoupled = bool(self.uncoupled.any())
        self._fixed: FixedArrays | None = None
        if not self._others and not self._any_uncoupled and self.elastic.tables is not None:
            constant = *self.inertia, *self.lasting_loads, *self.connections.packed, self._work
            self._fixed = FixedArrays([*constant, *self.elastic.tables[0]])
        # reactions of what is held in a node's own axes turn with them
        self._turns = ~self.held
        self._turns[np.isfinite(self.numbering.supports[:, 0, 0]), :3] = True
        self.choices, self.velocity_factor = Choices(gyroscopic=True, geometric=True), 1.0
        self._plain_inertia = self.inertia.plain
        self.set_time(0.0, 1.0)

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
            ValueError: A history, motion or drive is not finite.
        """
        self.loads = self._loads.at(time, factor)
        for lasting, now in zip(self.lasting_loads, self.loads, strict=True):
            lasting[:] = now
        self._plain_loads = self.loads.plain
        if self.connections.driven:
            self.connections.set_time(time)

    @property
    def pressures(self) -> Sequence[Pressure | SurfacePushes]:
        """The forces of each pressure."""
        return self._loads.pressures

    @property
    def load_contents(self) -> Contents:
        """See :attr:`~fem_lie.system.load_cases.LoadCases.contents`."""
        return self._loads.contents

    @property
    def mass_damping(self) -> Inertia | None:
        """Damping that goes with mass, on (x, d₁, d₂, d₃) of the moving nodes."""
        return self._damping

    @property
    def conservative(self) -> Array:
        """Gravity and forces fixed in space without history, on (x, d₁, d₂, d₃), (n, 4, 3).

        They alone have a potential; all other loads do work (:mod:`fem_lie.bodies.balances`).
        """
        return self._loads.constant

    @property
    def loaded(self) -> bool:
        """Whether gravity or any load acts on nodes."""
        return self._loads.any_nodal

    @property
    def strains_change(self) -> bool:
        """Whether a strain without stress has a history."""
        return self._loads.strains_change

    def prescribed_frames(self, time: float) -> Array:
        """Frames of the prescribed motions at ``time``, shape (p, 4, 3).

        Raises:
            ValueError: One of them is not a frame then.
        """
        frames = [motion.frame(time) for motion in self._motions]
        return np.array(frames).reshape(-1, 4, 3)

    def until_break(self, time: float) -> float:
        """How long it is to the next time at which a prescribed motion says that it jumps."""
        return until_next(self._breaks, time)

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
        self.with_reactions(H, v, a, weights, scale, r)
        if self._any_held:
            r[: 6 * self.count].reshape(-1, 6)[self.held] = 0.0

    def with_reactions(
        self, H: Array, v: Array, a: Array, weights: Array, scale: Array, r: Array
    ) -> None:
        """:meth:`residual`, with the forces that hold what is held."""
        if self._fixed is None:
            self.applied(H, v, a, weights, scale, r)
            self.elastic.add_forces(H, r)
        else:
            residual(H, v, a, weights, scale, r, self._fixed.table)
        if self._viscous:
            self.elastic.add_viscous_forces(H, v, r)
        if self._damping is not None:
            add_mass_damping(H, v, self._damping.plain, self._damping_work, self._work[1], r)
        if self._any_uncoupled:
            self._internal[:] = r[: 6 * self.count].reshape(-1, 6) - self._applied
        if self._guided:
            self.supports.turn(H, r[: 6 * self.count].reshape(-1, 6))

    def applied(self, H: Array, v: Array, a: Array, weights: Array, scale: Array, r: Array) -> None:
        """What :meth:`residual` is without elastic forces and damping."""
        rigid_residual(
            H,
            v,
            a,
            self._plain_inertia,
            self._plain_loads,
            self.connections.packed,
            weights,
            scale,
            self._work,
            r,
        )
        if self._others:
            self.connections.add_others(H, v, weights, scale, self.velocity_factor, r)
        if self._any_uncoupled:
            self._applied[:] = r[: 6 * self.count].reshape(-1, 6)

    def follow_motion(self) -> None:
        """Make the matrix the derivative along the motion of statics, see :attr:`uncoupled`.

        The parts are derivatives in twists of forces in local axes. What is added is linear in the
        sum of all forces on a node, zero at equilibrium.
        """
        if self._any_uncoupled:
            forces = np.where(self._turns, self._applied + self._internal, 0.0)
            self.tangent.add_turnings(forces, self.uncoupled)

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
        forces_at: Array | None = None,
    ) -> None:
        """Derivative of :meth:`residual` in the increments ``d`` that led to ``H``, into the KKT.

        ``mass`` and ``damping`` are ∂a/∂d and ∂v/∂d; the constraints' Jacobian is taken at
        ``joint_frames`` (default: ``H``), for their forces at ``forces_at`` (default: the same).
        Call it after a residual at the same state. The matrix
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
        tangent.add_springs(H)
        if damping != 0.0:
            tangent.add_dampers(H, damping)
            tangent.add_viscosity(H, damping)
            tangent.add_mass_damping(H, v, damping)
        if self.choices.geometric:
            tangent.add_geometric(H, weights)
        self.follow_motion()
        ahead = H if joint_frames is None else joint_frames
        tangent.fill_increments(ahead, self.kinds, d, scale, inertial=inertial, forces_at=forces_at)

    def report(self, H: Array, v: Array, invariants: Array) -> float:
        """Set kinetic energy, momentum and angular momentum, (7,).

        Returns:
            Potential of :attr:`conservative` loads.
        """
        work = self._report_work
        return float(report(H, v, self._plain_inertia, self.conservative, work, invariants))

    def stored_energy(self, H: Array) -> float:
        """Energy of elements and springs."""
        springs = terms.spring_energy(H, self.table) if len(self.table.springs) else 0.0
        return self.elastic.energy(H) + springs

    def joint_forces(self, H: Array, weights: Array) -> Array:
        """Force and moment of each joint at rest on its point ``a``, in its axes, shape (j, 6)."""
        return self.report_joints(H, self._still, weights)[0]

    def reactions(self, H: Array, v: Array, a: Array, weights: Array) -> Array:
        """Force and moment of supports on the nodes ``supported``, about them, shape (s, 6).

        Global components, at the frames, twists and rates of :meth:`residual`.
        """
        if not len(self.supported):
            return np.zeros((0, 6))
        r = np.empty(self.size)
        # along the axes of supports, where there are any
        self.with_reactions(H, v, a, weights, np.ones(self.m), r)
        local = r[: 6 * self.count].reshape(-1, 6)
        if self._guided:
            local[~self.held] = 0.0
            self.supports.turn_back(H, local)
            return wrenches(H, local, self._everything, self.supported)
        return wrenches(H, local, self.held, self.supported)

    def report_joints(self, H: Array, v: Array, weights: Array) -> tuple[Array, Array, Array]:
        """See :meth:`~fem_lie.system.constraints.Connections.report`."""
        return self.connections.report(H, v, self.felt(H, weights))

    def felt(self, H: Array, weights: Array) -> Array:
        """The multipliers that results report, shape (m,): the smallest, where that was chosen."""
        if self.scene.redundant is not Redundant.MINIMUM_NORM or not self.m:
            return weights
        B = self.tangent.jacobian(H)
        return IdleMultipliers.of(B, self.length, self.kkt.measure).remove(weights)

    @cached_property
    def has_potential(self) -> bool:
        """Whether all loads have one: no moment about a fixed axis, nothing that follows a node."""
        if self._loads.turning:
            return False
        return not self._loads.pressures or self._conserves()

    @property
    def symmetric(self) -> bool:
        """Whether the static equations have a symmetric matrix in every state."""
        bound = bool(self.table.selection[:, 3:].any() or self.table.functions.any())
        if bound or self._loads.turning or not self.uncoupled.all():
            return False
        return not self._loads.pressures or self._conserves()

    def _conserves(self) -> bool:
        """Whether all pressures have symmetric load stiffness.

        Its entries are polynomials of the state: what is symmetric in a state without any order is
        so in all.
        """
        H, rng = self.frames.copy(), np.random.default_rng(0)
        h = np.where(self.held, 0.0, 0.1 * rng.normal(size=(self.count, 6)))
        h[:, :3] *= self.length
        self.supports.turn_back(H, h)
        retract(H[: self.count], h)
        return self.tangent.symmetric_pressures(H)

    def check_turns(self, H: Array, when: str) -> None:
        """Warn where an element turns nearly as far as it may, at frames ``H`` of the leaders.

        Raises:
            FoldedElementError: One turns farther.
        """
        self.turns.check(self.numbering.attachment.frames(H), when)

    def turn_hint(self, H: Array) -> str:
        """What to say of the element that turns most, after a failure, if that may be why."""
        return self.turns.hint(self.numbering.attachment.frames(H))

    def describe(self) -> str:
        """What the scene consists of and what was chosen, in one line, for the log."""
        total, n, flat = self.numbering.total, self.count, int((self.kinds & 1).sum())
        shells = [body for body in self.scene.bodies if body.uncoupled]
        drills = self.numbering.drills
        parts = [
            f"{total} nodes, {total - n} of them follow others, {self.m} constraints",
            f"{n - flat} nodes on SE(3), {flat} on R³×SO(3), all with three rotations",
            f"shells with five parameters: {[b.label for b in shells if not drills[b]]}, with six: "
            f"{[b.label for b in shells if drills[b]]}",
            f"gyroscopic terms in the matrix: {_yes(self.choices.gyroscopic)}",
            f"geometric stiffness: {_yes(self.choices.geometric)}",
            f"viscous damping: {_yes(self._viscous)}, of mass: {_yes(self._damping is not None)}",
            f"pressure: {_yes(bool(self._loads.pressures))}",
            f"loads or motions in time: {_yes(self.time_dependent)}",
        ]
        return "; ".join(parts)

    def info(self) -> SceneInfo:
        """Bodies and joints in the numbering of all nodes, for results."""
        mass = float(self.inertia.blocks[:, 0, 0].sum())
        attachment, supported = self.numbering.attachment, self.supported
        nodes: Indices = np.flatnonzero(np.isin(attachment.leader, supported))
        rows = np.searchsorted(supported, attachment.leader[nodes])
        supports = SupportInfo(attachment.leaders[supported], nodes, rows)
        return SceneInfo(self.numbering.bodies(), self.connections.info(), mass, supports)


def _yes(chosen: bool | None) -> str:
    return "yes" if chosen else "no"
