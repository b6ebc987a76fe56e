"""The equations of a scene as solvers see them.

States are the solvers': frames ``H`` of all rows (moving nodes, ground, prescribed motions), local
twists ``v`` and their rates ``a``, multipliers. Nobody else than these verbs changes what is behind
them, and a solver may use nothing else.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.lie.kinds import advance, pull_all, shown_all
from fem_lie.lie.motions import Group, Parametrisation
from fem_lie.linear.bordered import KKT
from fem_lie.linear.direct import DirectSolver
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.system import describe, symmetry
from fem_lie.system.balance.books import Books
from fem_lie.system.equations import consistent, reports
from fem_lie.system.equations.consistent import Driven
from fem_lie.system.equations.contradiction import contradiction
from fem_lie.system.equations.unknowns import Start, Tables, Unknowns
from fem_lie.system.instant import Forces, Instant, Plan
from fem_lie.system.nodes import inertia
from fem_lie.system.nodes.sums import load_vector
from fem_lie.system.small_motions.linear import SmallMotions
from fem_lie.system.small_motions.rigid_motions import rigid_motions
from fem_lie.system.small_motions.steady import fill_steady
from fem_lie.system.system import System

_log = logging.getLogger(__name__)


class Equations:
    """The equations of a scene.

    Attributes:
        scene: What there is.
        unknowns: Which there are.
        start: Initial frames and velocities.
        tables: Arrays for compiled code.
        matrix: What :meth:`fill` and others fill.
        info: Bodies and joints, for results.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        dynamics: bool,
        parametrisation: Parametrisation = Parametrisation.EXPONENTIAL,
        group: Group | None = None,
    ) -> None:
        """Set them up.

        Args:
            scene: What there is.
            dynamics: Whether inertia is needed.
            parametrisation: What increments are.
            group: On which all frames move; default: each on that of its body.

        Raises:
            ValueError: See :class:`~fem_lie.system.system.System`.
        """
        self.scene = scene
        self._system = System(
            scene, dynamics=dynamics, parametrisation=parametrisation, group=group
        )
        # of springs in compiled sums these know themselves
        self._terms = self._system.terms.chosen(lambda term: not term.within_joints)
        self._settles = any(term.settles for term in self._terms)
        self._connections = self._system.connections
        self._many_sets = not self._connections.of_joints_only
        self._drills = bool(self._system.carried_drilling)
        self.unknowns = Unknowns.of(self._system)
        self.start = Start(self._system.frames, self._system.velocities)
        self.tables = Tables.of(self._system)
        self.matrix: KKT = self._system.kkt
        self.info: SceneInfo = self._info()
        self._work = np.zeros((self.unknowns.moving, 4, 3))

    def _info(self) -> SceneInfo:
        """Bodies and joints in the numbering of all nodes."""
        system = self._system
        mass = float(system.inertia.blocks[:, 0, 0].sum())
        joints = system.connections.info()
        return describe.catalogue(system.numbering, joints, system.supported, mass)

    @property
    def system(self) -> System:
        """What is behind."""
        return self._system

    def settle_choices(self, step: float, policy: str) -> None:
        """Decide, for steps of size ``step``, what the matrix takes in, and say so in the log."""
        system, spin = self._system, float(np.abs(self.start.velocities[:, 3:]).max())
        system.choices = system.scene.choices.resolve(spin * step)
        given = system.numbering, system.terms, system.kinds, system.m, system.choices
        told = describe.in_one_line(*given, time_dependent=system.time_dependent)
        _log.info("%s; matrix: %s", told, policy)

    def measure_velocities(self, per_increment: float) -> None:
        """Multiply constraints of velocities by ∂d/∂v: rows like those of positions."""
        self._system.velocity_factor = per_increment

    # --- time ---

    def set_time(self, time: float, factor: float = 1.0) -> None:
        """Loads and targets of ``time``; loads without history, and gravity, times ``factor``.

        Raises:
            ValueError: A history, motion or drive is not finite.
        """
        self._system.set_time(time, factor)

    def prescribed_frames(self, time: float) -> Array:
        """Frames of the prescribed motions at ``time``, (p, 4, 3).

        Raises:
            ValueError: One of them is not a frame then.
        """
        return self._system.prescribed_frames(time)

    def targets(self, time: float) -> Array:
        """What constraints are to be at ``time``, (m,).

        Raises:
            ValueError: A drive is not finite then.
        """
        return self._connections.targets(time)

    def driven(self, time: float, step: float) -> Driven:
        """Rates of prescribed motions and of drives at ``time``, by differences over ``step``."""
        return consistent.driven(self._system, time, step)

    # --- residual and matrix ---

    def room(self) -> Forces:
        """For what a residual finds."""
        return self._system.room()

    def residual(
        self,
        state: Instant,
        scale: Array,
        r: Array,
        forces: Forces | None = None,
        *,
        carried: bool = False,
        known: bool = False,
    ) -> None:
        """Equations of motion and constraints times ``scale``, into ``r`` (size,).

        Args:
            state: Where.
            scale: Factor of each constraint, shape (m,).
            r: Overwritten.
            forces: What the derivative needs of them, overwritten; default: it is not kept.
            carried: Whether cells keep their own unknowns as they were carried along.
            known: Whether nothing but loads has changed since ``forces`` were found: what of ``r``
                follows from the rest may be left out.
        """
        if known and not self._system.terms.loads:
            self._system.applied(state, scale, r, forces)
            return
        if self._settles and not carried:
            self._terms.settle(state.H)
        self._system.residual(state, scale, r, forces)

    def outer_forces(self, H: Array) -> Array:
        """Loads of the present time on the nodes at frames ``H``, in their unknowns, (6 n,)."""
        system, forces = self._system, np.zeros((self.unknowns.moving, 6))
        loads = system.loads
        load_vector(system.kinds, H, loads.dead, loads.moment, loads.following, forces)
        forces += system.terms.of_loads(H)
        system.supports.turn(H, forces)
        forces[system.held] = 0.0
        return forces.ravel()

    def add_inertia_forces(self, H: Array, q: Array, factor: float, forces: Array) -> None:
        """Add ``factor Lᵀ G q`` at frames ``H``: ``q`` (n, 4, 3), ``forces`` (n, 6)."""
        inertia.multiply(*self._system.inertia, q, self._work)
        pull_all(self._system.kinds, H, self._work, factor, forces.reshape(-1))

    def fill(
        self, state: Instant, forces: Forces, plan: Plan, *, stressed: Array | None = None
    ) -> None:
        """Derivative of :meth:`residual`, into :attr:`matrix`; not factorised.

        Args:
            state: Where.
            forces: That the residual has found there.
            plan: What the matrix is to be.
            stressed: Frames whose stress it has; default: the stress that is carried.
        """
        if not self._system.choices.geometric:
            self._terms.clear_stress()
        elif stressed is not None:
            self._terms.reset_stress(stressed)
        self._system.fill_matrix(state, forces, plan)

    def fill_steady(self, H: Array, v: Array, weights: Array, scale: Array) -> None:
        """Stiffness in a frame in which all nodes move steadily, into :attr:`matrix`."""
        fill_steady(self._system, H, v, weights, scale)

    def refresh(self, H: Array, d: Array, scale: Array) -> None:
        """The constraints anew at ``H`` in what :meth:`fill` has filled, by increments ``d``."""
        self._system.tangent.refill_border(H, self.unknowns.kinds, d, scale)

    def constraint_scale(self, H: Array) -> Array:
        """Factors of the constraints that suit the blocks that were filled last, (m,)."""
        return self._system.tangent.constraint_scale(H)

    def jacobian(self, H: Array) -> sp.csr_matrix:
        """``B`` in the twists of the moving nodes without what is held, (m, 6 n)."""
        return self._system.tangent.jacobian(H)

    def constraint_rates(self, H: Array, v: Array) -> Array:
        """``dΦ/dt`` at the twists ``v`` of all rows, targets at rest, shape (m,)."""
        first, _ = self._connections.rates(H, v)
        return first

    def contradiction(self, H: Array, values: Array) -> str:
        """What to say of constraints that are violated by ``values`` and contradict each other."""
        return contradiction(self._system, H, values)

    # --- what a state carries on ---

    def move(self, H: Array, x: Array, *, carried: bool) -> float:
        """Move nodes by ``−x``, in statics; ``carried``: the stress along.

        Returns:
            The largest increment, translations over the length of the model.
        """
        system = self._system
        if carried:
            self._terms.carry(H, -x[: 6 * system.count])
        largest = advance(system.kinds, H, x, system.held, system.uncoupled, system.length)
        system.carried_drilling.turn(H)
        return largest

    def carry(self, H: Array, h: Array) -> None:
        """Carry the stress on along the increment ``h`` (6 n,) made from frames ``H``."""
        self._terms.carry(H, h)

    def reset_stress(self, H: Array) -> None:
        """Make the stress that is carried the true one at frames ``H``."""
        self._terms.reset_stress(H)

    @property
    def carried(self) -> list[Array]:
        """Copies of what is carried from iterate to iterate; to be set to what they were."""
        return self._terms.carried()

    @carried.setter
    def carried(self, values: Sequence[Array]) -> None:
        self._terms.restore(list(values))

    def kept(self) -> dict[str, Array]:
        """All that what comes depends on but the state and the time, for a checkpoint."""
        kept = {"matrix": self.matrix.csr[0], "blocks": self._system.tangent.A}
        kept |= {f"carried.{k}": part for k, part in enumerate(self.carried)}
        return kept | {"joints": self.memory}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`kept` was called."""
        self.memory = kept["joints"]
        self.carried = [kept[f"carried.{k}"] for k in range(len(self.carried))]
        self._system.tangent.A[:], self.matrix.csr[0][:] = kept["blocks"], kept["matrix"]
        self.matrix.matrix.stateIncrease()
        self.matrix.matrix.assemble()

    @property
    def memory(self) -> Array:
        """What frames do not tell of the last accepted state: turns of joints, places on beams."""
        return self._connections.memory

    @memory.setter
    def memory(self, values: Array) -> None:
        self._connections.memory = values

    def accept(self, H: Array) -> None:
        """Go on from here: joints count their turns.

        Raises:
            ValueError: Something slid off its beam.
        """
        self._connections.accept(H)

    def turn_drills(self, H: Array, motion: Array, written_locally: Flags) -> None:
        """Turn frames that follow a mid-surface, and what is written in them.

        Args:
            H: Frames of all rows.
            motion: Velocities, accelerations and the like, shape (k, n, 6).
            written_locally: Which of them have components in the frames on any group, (k,).
        """
        if self._drills:
            kinds = self.unknowns.kinds
            self._system.carried_drilling.turn_motion(H, motion, kinds, written_locally)

    # --- unknowns along axes fixed in space ---

    def to_unknowns(self, H: Array, x: Array) -> None:
        """Turn components in the nodes' frames (≥ 6 n,) into those of the unknowns, in place."""
        if self.unknowns.guided:
            self._system.supports.turn(H, x[: 6 * self.unknowns.moving].reshape(-1, 6))

    def to_frames(self, H: Array, x: Array) -> None:
        """Inverse of :meth:`to_unknowns`."""
        if self.unknowns.guided:
            self._system.supports.turn_back(H, x[: 6 * self.unknowns.moving].reshape(-1, 6))

    # --- consistent values ---

    def check_velocities(self, step: float) -> None:
        """Check the initial velocities of the bodies against clamps and joints.

        Args:
            step: Step size; velocities may be wrong by what is not felt in one.

        Raises:
            ValueError: They break a clamp or a joint; the message names it.
        """
        consistent.check_velocities(self._system, step)

    def accelerations(
        self, solver: DirectSolver, H: Array, v: Array, time: float, step: float
    ) -> tuple[Array, Array]:
        """See :func:`~fem_lie.system.equations.consistent.accelerations`."""
        return consistent.accelerations(self._system, solver, H, v, time, step)

    def allowed_velocities(
        self, solver: DirectSolver, H: Array, v: Array, time: float, step: float
    ) -> Array:
        """See :func:`~fem_lie.system.equations.consistent.allowed_velocities`."""
        return consistent.allowed_velocities(self._system, solver, H, v, time, step)

    def across_joints(self, solver: DirectSolver, H: Array, rates: Array, step: float) -> Array:
        """See :func:`~fem_lie.system.equations.consistent.across_joints`."""
        return consistent.across_joints(self._system, solver, H, rates, step)

    # --- what is told of a state ---

    def all_frames(self, H: Array) -> Array:
        """Frames of all nodes, those that follow others included, (N, 4, 3)."""
        return self._system.numbering.attachment.frames(H)

    def all_twists(self, H: Array, v: Array) -> Array:
        """Velocities (n, 6) as twists of all nodes along the rows of ``H``, (N, 6)."""
        shown = np.empty_like(v)
        shown_all(self._system.kinds, H, np.ascontiguousarray(v), shown)
        return self._system.numbering.attachment.twists(shown)

    def energy(self, H: Array) -> float:
        """Energy of elements, and of springs that are not among :attr:`tables`."""
        found = self._terms.energy(H)
        return found + self._connections.other_spring_energy(H) if self._many_sets else found

    def reactions(self, state: Instant, *, carried: bool = True) -> Array:
        """Force and moment of supports on what is held, about it, global components, (s, 6).

        ``carried``: see :meth:`residual`.
        """
        if not carried:
            self._terms.settle(state.H)
        return reports.reactions(self._system, state)

    def report_joints(self, H: Array, v: Array, weights: Array) -> tuple[Array, Array, Array]:
        """Forces, coordinates and violations of joints, see results."""
        return reports.joints(self._system, H, v, weights)

    def books(self) -> Books:
        """Books of what loads, drives and supports do, empty."""
        return Books(self._system)

    def check_turns(self, H: Array, when: str) -> None:
        """Warn where an element turns nearly as far as it may.

        Raises:
            FoldedElementError: One turns farther.
        """
        self._system.turns.check(self.all_frames(H), when)

    def judge_turn(self, found: tuple[int, float], time: float) -> None:
        """:meth:`check_turns` for the element and the turn that a row of results has found."""
        self._system.turns.judge(found, time)

    def turn_hint(self, H: Array) -> str:
        """What to say of the element that turns most, after a failure, if that may be why."""
        return self._system.turns.hint(self.all_frames(H))

    # --- what they are like ---

    @cached_property
    def has_potential(self) -> bool:
        """Whether all loads have one."""
        return symmetry.has_potential(self._system)

    @cached_property
    def symmetric(self) -> bool:
        """Whether the static equations have a symmetric matrix in every state."""
        return symmetry.symmetric(self._system)

    def small_motions(self, rotation: Rotation) -> SmallMotions:
        """The linear equations beside the initial frames, in a frame that turns."""
        return SmallMotions(self._system, rotation)

    def rigid_motions(self, H: Array, weight: Array) -> list[Any]:
        """See :func:`~fem_lie.system.small_motions.rigid_motions.rigid_motions`."""
        return rigid_motions(self._system, H, weight)

    def contents(self) -> list[tuple[str, Any, str]]:
        """All that they depend on but functions of time: name, value, what errors call it."""
        system, numbering = self._system, self._system.numbering
        found: list[tuple[str, Any, str]] = []
        pairs = zip(numbering.members, numbering.assemblies, strict=True)
        for k, (members, (_, assembly)) in enumerate(pairs, start=1):
            others = f" and {len(members) - 1} others" if len(members) > 1 else ""
            shown = f"energy of the elements of {members[0].label}{others}"
            found.append((f"energy of assembly {k}", assembly.contents, shown))
        groups = system.kinds, system.held, numbering.supports
        sums = {
            "inertia": tuple(system.inertia),
            "damping of mass": system.terms.rates,
            "loads": system.load_cases.contents,
            "groups and supports": groups,
        }
        return found + [(name, value, name) for name, value in sums.items()]
