"""State of a run of generalised-α: start and end of a step, matrices."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from typing import ClassVar

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import attributes, put_back, saved
from fem_lie.lie.node_types import all_to_global_components, all_to_nodal_components, retract_all
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.low_rank import MOST
from fem_lie.solve.alpha.options import DAMPED, ConstraintIndex, MatrixFrame, Options
from fem_lie.solve.alpha.staleness import back_to_twists, staleness
from fem_lie.solve.alpha.start import Outputs, set_start
from fem_lie.solve.alpha.step.loop import PROGRESS
from fem_lie.solve.alpha.step.node import parameters
from fem_lie.solve.alpha.step.nodes import (
    State,
    accept,
    correct,
    extrapolate,
    predict,
    refer_to,
)
from fem_lie.solve.alpha.violation import ViolationWarning
from fem_lie.solve.convergence import (
    constraint_scaling,
    estimate,
    explained,
    node_scaling,
)
from fem_lie.solve.motion.consistent import allowed_velocities, check_velocities
from fem_lie.solve.motion.integration import DividedIntegration
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.recording.whole_state import MovingState
from fem_lie.solve.refactorisation import Refactorisation
from fem_lie.solve.secants import Secants
from fem_lie.system.equations import Equations, Plan, TimeState

_LARGE = 20_000
"""Number of nodes above which a matrix only for compilation costs more than the compilation."""


def _nodes_of_elements(equations: Equations) -> Indices:
    """Moving nodes that are of elements, or have nodes of elements attached."""
    n, arrays = equations.unknowns.moving, equations.arrays
    found: Array = np.zeros((n, 6))
    for where, _ in arrays.assemblies:
        nodes = arrays.master[where]
        found[nodes[nodes < n]] = 1.0
    equations.shared.sum(found)
    return np.flatnonzero(found[:, 0])


class RunState(DividedIntegration[Recorder]):
    """State of a run of generalised-α.

    Attributes:
        options: Options of the scheme.
        p: Parameters of the scheme.
        s: Start and end of a step.
        multipliers: Lagrange multipliers.
        impulses: Their impulses at the end of the last step, which change velocities so that they
            satisfy the constraints, see :func:`~fem_lie.solve.impacts.impulses.project`.
        progress: See :data:`fem_lie.solve.alpha.step.loop.PROGRESS`.
        solver: Linear solver of the iteration.
        balance: Energy balance: work and impulses of loads, drives and supports.
        forces: Forces of the last residual.
    """

    STATE = attributes(
        "s.H",
        "s.H1",
        "s.motion",
        "_factorised",
        "multipliers",
        "scale",
        "spread",
        "progress",
        "balance",
        "_born",
        "_corrects",
        "_outgrown",
        "solver",
    )

    _refreshes: ClassVar[bool] = True
    """Whether the constraint Jacobian of the frozen matrix may be updated separately."""

    feedback: Outputs | None = None
    """Sets the outputs of continuous controllers at a state, if there are any."""

    _uses_correction: ClassVar[bool] = True
    """Whether intermittent stiffness may be a low-rank correction of the frozen matrix."""

    def __init__(self, options: Options, equations: Equations, step: float) -> None:
        """Allocate all arrays without computing anything.

        Args:
            options: Options of the scheme.
            equations: Equations of the scene.
            step: Step size.
        """
        unknowns = equations.unknowns
        m = unknowns.m
        bound = self._refreshes and unknowns.constraints > 0
        super().__init__(options.policy, equations, step, bound=bound)
        self.options, self.p = options, parameters(options.radius, step)
        scaling = node_scaling(unknowns)
        held = equations.matrix.held.copy()
        held[equations.supports.nodes, :3] = False  # along other axes, in which T = 1
        self._fixed: Indices = held.astype(np.int64)
        self._elastic = _nodes_of_elements(equations)
        self._factorised: Array = np.zeros((unknowns.moving, 6))
        self.s = State.start(equations.start.frames, unknowns.kinds, scaling)
        self._violation = ViolationWarning(scaling, options.radius)
        self._guided, self._moving = bool(equations.supports), unknowns.moving
        self._changing = unknowns.time_dependent
        # compiled loops set the time of force laws that are in their sum
        self._prescribes = unknowns.prescribes or not equations.arrays.in_one_sum
        stabilised = options.index_for(equations.scene) == ConstraintIndex.STABILISED_TWO
        self._projects = stabilised and unknowns.constraints > 0
        self._turned = options.matrix_frame == MatrixFrame.INERTIAL
        if self._turned and self._guided:
            raise ValueError("supports along fixed axes (Shell.roller) need MatrixFrame.LOCAL")
        self._plain = self.p.plain, self.s.plain
        self.multipliers: Array = np.zeros(m)
        self.scale: Array = np.ones(m)
        self.impulses: Array = np.zeros(m)
        self._first, s = np.zeros(m), self.s
        self._accepted = TimeState(s.H, s.twist1, s.rate1, self.multipliers)
        self._end_instant = self._accepted._replace(H=s.H1)
        self.measure: Array = constraint_scaling(unknowns)
        joined: Indices = unknowns.joined.astype(np.int64)
        self.spread: Array = np.zeros(unknowns.vectors.shape)
        self._sizes = self.scale, self.spread, joined
        prefix = options.petsc_options_prefix
        self.solver = self._starter = DirectSolver(
            equations.matrix, prefix, skew_part=options.skew_part
        )
        self.solver.take_low_rank()
        self.r, self.dx = self.solver.right_hand_side, self.solver.solution
        self.forces = equations.residual(self._accepted, self.scale, self.r)
        self.progress = PROGRESS()
        self.progress.ratio = 1.0
        self._born, self._end = 0, 0.0
        whole = self._projects or self._turned or self._guided or self.decisions.rule is None
        # matrices of rigid bodies cost less than iterations without the derivative of contact
        # normals
        self._may_correct = (
            unknowns.has_low_rank and self._uses_correction and not (whole or unknowns.rigid)
        )
        self._corrects, self._outgrown = self._may_correct, False
        self.balance = equations.energy_balance()
        self._secants: Secants | None = None
        if options.policy.secants > 0:
            sizes = np.append(np.repeat(scaling, 3), np.zeros(m))
            self._secants = Secants(options.policy.secants, sizes, equations.shared)

    # --- start ---

    def start(self) -> None:
        """Compute consistent accelerations and multipliers; scale the constraints."""
        equations, p, s = self.equations, self.p, self.s
        check_velocities(equations, p.h)
        self.multipliers[:] = set_start(equations, self.solver, p, s, feedback=self.feedback)
        equations.prescribed(0.0).act()
        self._scale_constraints()
        self.balance.open(0.0, *self._accepted)
        self._warm_up()
        self.solver.factorisations = self.solver.refreshes = 0

    def _scale_constraints(self) -> None:
        """Scale constraints for steps of the current size from the current state."""
        self._find(self._accepted)
        self.scale[:] = self._fill(self.s.H, self.s.H, None, turned=False)

    def _warm_up(self) -> None:
        """Compile what a step needs on a copy of the state: run times exclude compilation."""
        scheme, s = self.p.plain, self.s
        moved = s.H[:1].copy(), s.H1[:1].copy(), s.motion[:, :1].copy()
        state = State._make([*moved, *(each[:1] for each in s[3:])]).plain
        predict(scheme, state)
        zero, multipliers = np.zeros(6 + len(self.multipliers)), self.multipliers.copy()
        correct(scheme, state, zero, *self._sizes, multipliers)
        accept(scheme, state)
        estimate(1.0, np.inf, 1.0)
        self._compile()
        if self._moving > _LARGE:
            return
        # the first iteration factorises the matrix that is counted
        p, turned, ahead = self.p, self._turned, self._ahead()
        plan = Plan(p.h * s.v, self.scale, p.mass, p.damping, joint_frames=ahead)
        plan = plan._replace(inertial=turned, matrix_terms=self.matrix_terms)
        self.equations.fill(self._end_instant, self.forces, plan)
        if turned:
            all_to_global_components(s.kinds[:1], s.H, zero)
            all_to_nodal_components(s.kinds[:1], s.H, zero)
        else:
            again = plan._replace(joint_frames=self._ahead(), constraints_only=True)
            self.equations.fill(self._end_instant, self.forces, again)

    @abstractmethod
    def _compile(self) -> None:
        """Compile everything else, without making a step."""

    # --- the size of the step ---

    def _set_size(self, h: float) -> None:
        radius = self.options.radius
        self.p = parameters(min(radius, DAMPED) if self.division.level else radius, h)
        self._plain = self.p.plain, self.s.plain

    def resize(self, time: float, size: float) -> None:
        """Start steps of another size at ``time``, see :class:`~fem_lie.solve.division.Divisible`.

        A step that failed has not resolved fast oscillations, which its accelerations contain. They
        are therefore made consistent again, and the sub-steps damp the remaining oscillations of
        velocities.
        """
        s = self.s
        self._set_size(size)
        # loads at the start: the failed step has changed them
        extrapolate(0.0, s.H, s.motion, s.kinds, s.H.copy(), s.twist1)
        computed = s.twist1.copy()
        self._make_consistent(time)
        self._violation.check(time, computed, s.twist1)
        s.H1[:] = s.H  # not the end of the failed step
        self._scale_constraints()
        self.balance.look(time, *self._accepted)
        self._outgrown = True

    def _make_consistent(self, time: float, restitution: Array | None = None) -> None:
        """Compute admissible velocities and consistent accelerations at ``time``."""
        equations, s = self.equations, self.s
        s.H[self._moving + 1 :] = equations.prescribed(time).frames
        v = equations.start.velocities.copy()
        v[: self._moving] = s.twist1
        v = allowed_velocities(equations, self._starter, s.H, v, time, self.p.h, restitution)
        self.multipliers[:] = set_start(equations, self._starter, self.p, s, v, time, self.feedback)
        equations.prescribed(time).act()

    # --- time ---

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return self.s.H

    @property
    def index(self) -> int:
        """Number of steps made, including the current one."""
        return int(self.progress.step)

    def _go_to_time(self, time: float) -> None:
        """Evaluate loads, targets and prescribed frames at the end of the step."""
        if self._changing:
            now = self.equations.prescribed(time)
            now.act()
            self.s.H1[self._moving + 1 :] = now.frames

    @property
    def _finest(self) -> float:
        """Largest iteration error of a step, whatever the motion."""
        return np.inf

    @property
    def _factor(self) -> float:
        """Factor of corrections with the frozen matrix."""
        return 1.0

    # --- residual and matrices ---

    def _find(self, state: TimeState, *, linearised: bool = False) -> None:
        """Evaluate the residual; velocity constraints are treated like position constraints."""
        given, factor = (self.scale, self.r, self.forces), 1.0 / self.p.damping
        self.equations.residual(state, *given, linearised=linearised, per_increment=factor)
        if self._corrects:
            self._fill_correction()

    def _fill_correction(self) -> None:
        """Set the low-rank correction of the frozen matrix to the current end of the step."""
        plan = Plan(self.s.d, self.scale, low_rank_only=True)
        self.equations.fill(self._end_instant, self.forces, plan)
        self._outgrown = self._correction_rank > MOST

    @property
    def _correction_rank(self) -> int:
        correction = self.equations.matrix.correction
        return 0 if correction is None else len(correction.stiffness)

    def _contradicts(self, tolerance: float, stagnant: bool) -> bool:
        """Whether the remaining constraint violation is not due to unfinished iteration."""
        values = self.r[6 * self._moving :] / self.scale
        # increments of a stagnant iteration explain no violation
        allowed = tolerance if stagnant else max(tolerance, float(self.progress.increment))
        bound = explained(allowed)
        if float((np.abs(values) * self.measure).max(initial=0.0)) <= bound:
            return False
        # with a tolerance near round-off, further increments may still reduce the violation
        self.reason = self.equations.constraints(self.s.H1).contradiction(values, bound)
        return bool(self.reason)

    def _staleness(self) -> float:
        """Staleness of mass and stiffness, see :mod:`fem_lie.solve.alpha.staleness`.

        It is measured in the direction of the last correction.
        """
        x = self.dx.copy()
        d = self._factorised.copy()
        d[self._elastic] = self.s.d[self._elastic]
        back_to_twists(self.s, d, x)
        return staleness(
            self.equations, self.solver, self.p.plain, self.s, self.multipliers, self._sizes, x
        )

    def _solve(self, solve: Callable[[], None]) -> None:
        """Solve by a method of the solver; residual and solution are in local components."""
        H1, kinds = self.s.H1, self.s.kinds
        if self._turned:
            all_to_global_components(kinds, H1, self.r)
        solve()
        if self._turned:
            all_to_nodal_components(kinds, H1, self.dx)
        if self._guided:
            nodes = self.dx[: 6 * self._moving].reshape(-1, 6)
            self.equations.supports.rotate_back(H1, nodes)
        if self._secants is not None:
            if self.progress.iteration == 1:
                self._secants.forget()
            self._secants.improve(self.dx)

    @property
    def _missing(self) -> bool:
        """Whether there is no usable iteration matrix."""
        return self.solver.factorisations == 0 or self._outgrown

    def _refactorise(self, update: Refactorisation, stressed: Array | None) -> None:
        """Refactorise the requested part; without a matrix that is all of it."""
        if self._secants is not None:
            self._secants.forget()
        if update == Refactorisation.CONSTRAINTS and not self._missing:
            self._refresh()
        else:
            self._corrects = self._may_correct and stressed is not None and not self._outgrown
            self._factorise(stressed)
            self._outgrown = False
        if self._corrects:
            self._fill_correction()

    def _factorise(self, stressed: Array | None) -> None:
        """Assemble and factorise the matrix.

        ``stressed``: frames whose stress it contains, ``None`` for the linearly updated stress.
        """
        self._fill(stressed, self._ahead_of_this(), self.scale, turned=self._turned)
        self.solver.factorise()

    def _refresh(self) -> None:
        """Update the constraint Jacobian of the frozen matrix."""
        if self._turned:
            self._factorise(self.s.H1)
            return
        frames = self._ahead_of_this()
        plan = Plan(self.s.d, self.scale, joint_frames=frames, constraints_only=True)
        self.equations.fill(self._end_instant, self.forces, plan)
        self.solver.refresh()

    def _fill(
        self, stressed: Array | None, joint_frames: Array, scale: Array | None, *, turned: bool
    ) -> Array:
        """Assemble the matrix with the given scale of its constraints, or choose a suitable scale.

        The norm weights of scaled multipliers change with the chosen scale.
        """
        p = self.p
        found = self.spread if scale is None else None
        plan = Plan(self.s.d, scale, p.mass, p.damping, joint_frames=joint_frames, spread=found)
        plan = plan._replace(inertial=turned, stressed=stressed, matrix_terms=self.matrix_terms)
        plan = plan._replace(without_low_rank=self._corrects)
        made = self.equations.fill(self._end_instant, self.forces, plan)
        self._factorised[:] = self.s.d
        self._refer_to(self._factorised, np.arange(self._moving))
        if found is not None:
            found *= self.measure[:, np.newaxis]
        return made

    def _refer_to(self, d: Array, nodes: Indices) -> None:
        """Let solutions of some nodes be corrections of increments ``d``, shape (n, 6)."""
        refer_to(d, self.s.kinds, self._fixed, nodes, self.s.inverse)

    def _ahead(self) -> Array:
        """Frames at the midpoint of the time for which the matrix is likely to stay frozen.

        Only the constraint Jacobian is evaluated there: it rotates with the bodies, the rest does
        not.
        """
        steps = (self.index - self._born) // 2
        s, frames = self.s, self.s.H1.copy()
        # along a screw motion, whatever the group: joints stay closed
        retract_all(s.kinds, s.H1, steps * self.p.h * s.twist1, frames)
        return frames

    def _ahead_of_this(self) -> Array:
        """The same frames for a matrix that is assembled in the current step."""
        frames, self._born = self._ahead(), self.index
        return frames

    # --- checkpoints ---

    def divided_state(self) -> dict[str, Array]:
        """See the base class; motion is that of all nodes as in ``s.motion``."""
        s, n = self.s, self._moving
        moving = MovingState(s.H[:n], s.motion, self.multipliers[np.newaxis], self.balance.so_far)
        return saved(self, self._common) | moving._asdict()

    _common: ClassVar[tuple[str, ...]] = ("decisions", "division", "progress")
    """State that all ranks of a divided scene have in common."""

    @property
    def _now(self) -> float:
        """Time of the accepted state."""
        return self.index * self.h

    def restart(self, state: MovingState, common: Mapping[str, Array]) -> None:
        """Restart from the state of a scene that was divided, with a new matrix."""
        put_back(self, self._common, common)
        s, n, time = self.s, self._moving, self._now
        now = self.equations.prescribed(time)
        now.act()
        s.H[:n], s.H[n + 1 :], s.motion[:] = state.frames, now.frames, state.motion
        s.H1[:] = s.H
        self.multipliers[:] = state.multipliers[0]
        self.equations.history_variables.update_stress(s.H)
        self._set_size(self.h / self.division.parts)
        self._scale_constraints()
        self.balance.restart(state.balance, time, *self._accepted)
        self._born, self._outgrown = self.index, True

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned."""
        super().restore(kept)
        self._refer_to(self._factorised, np.arange(self._moving))
        if self.equations.unknowns.time_dependent:
            self.equations.prescribed(self.index * self.h).act()
        self._set_size(self.h / self.division.parts)
