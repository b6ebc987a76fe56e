"""What steps of nodes of any kind start from, and what they are made with."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.balances import TOTAL
from fem_lie.forms.cells import evaluate
from fem_lie.forms.term import Ends
from fem_lie.lie.kinds import SLOPE, inertia, push_all
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.factors import Factors, factorise, solve
from fem_lie.solve.conserving.between.pushes import Pushes
from fem_lie.solve.conserving.between.screws import half_way
from fem_lie.solve.conserving.between.turning import Turning
from fem_lie.solve.conserving.rows.cells import energies_at
from fem_lie.solve.conserving.rows.changes import forces_at
from fem_lie.solve.conserving.step.dissipation import REMEMBERS
from fem_lie.solve.conserving.straight import nodes as motion
from fem_lie.solve.conserving.straight import step as steps
from fem_lie.solve.conserving.straight.joints import Joints
from fem_lie.solve.conserving.straight.records import State, Step
from fem_lie.solve.conserving.straight.scene import cells_of_frames, model_of, viscous_terms
from fem_lie.solve.motion.consistent import accelerations, check_velocities
from fem_lie.solve.motion.convergence import node_scaling
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.policies import Policy
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.secants import Secants
from fem_lie.system.equations import Equations, Instant, Plan

_PREFIX = "fem_lie_dynamics_"


class AnyState(Integration[Recorder]):
    """State of a run: its start, its loads in time, its matrices.

    Attributes:
        s: Between steps.
        this: The present step.
        model: What steps see of the scene.
        joints: Over a step.
        framed: Cells of frames.
        size: Of the present step: of a part, where one is made in parts.
    """

    def __init__(self, policy: Policy, equations: Equations, step: float, loss: float) -> None:
        """Allocate everything; nothing is computed yet.

        Args:
            policy: When to factorise.
            equations: Of the scene.
            step: Step size.
            loss: χ of :mod:`fem_lie.solve.conserving.step.dissipation`.
        """
        super().__init__(policy, equations, step)
        unknowns, z = equations.unknowns, np.zeros
        n, m = unknowns.moving, unknowns.m
        self._changing, self._n, self.size = unknowns.time_dependent, n, self.h
        self.framed, self.joints = cells_of_frames(equations), Joints(equations)
        self.model = model_of(equations, self.framed, loss)
        self._frames = np.flatnonzero(self.model.kinds < SLOPE)
        cells, places = len(self.model.cells.calls) + self.framed.count, self.framed.places
        others = len(self.model.cells.nodes) if loss > 0.0 else 0
        self.s = State(
            H=equations.start.frames.copy(),
            rest=z((n, 4, 3)),
            V=z((n, 4, 3)),
            trend=z((n, 6)),
            carry=z((n, 6)),
            F=z((places, 6)),
            W=z(cells),
            account=z(cells),
            books=z(TOTAL),
            told=z(4),
            weights=z(m),
            earlier=z((2, m)),
            gap=z(m),
            scale=np.ones(m),
            lag=z(11),
            w=z((n, 4, 3)),
            w_F=z((places, 6)),
            lasting=z((2, others, 2, 3)),
        )
        self.this = Step(
            step=z((n, 6)),
            delta=z((n, 4, 3)),
            mean=self.s.H[:n].copy(),
            middle=self.s.H[:n].copy(),
            end=self.s.H[:n].copy(),
            V1=z((n, 4, 3)),
            F1=z((places, 6)),
            W1=z(cells),
            work=z(cells),
            forces=z((n, 6)),
            losses=z(TOTAL),
            told=z(2),
            r=z(6 * n + m),
            q=z((2, n, 4, 3)),
            outer=z((n, 6)),
            change=z(m),
            lasting=z((3, others, 2, 3)),
            filtered=z((2, n, 6)),
            own=z((3, n, 4, 3)),
            sums=z((3, 3, 3, 3)),
        )
        # mean accelerations of the last two steps, twice their trends, and sizes of the last three
        self._rates, self._sizes = z((2, n, 6)), z(3)
        self._measure = np.repeat(node_scaling(unknowns), 3)
        self._x, self._y = z((2, 6 * n + m))
        self._still, self._work = z((n, 6)), z(unknowns.size)
        at_rest = Instant(*equations.start[:2], self._still, self.s.weights)
        self._found = equations.residual(at_rest, self.s.scale, self._work)
        self._viscous = viscous_terms(equations)
        self._twists, self._viscous_forces = z((2, n, 6))
        known = equations.tables
        self._pushes = Pushes(known.terms, known.leader, known.offset, n)
        self._pushed = self._pushes.room(n)
        self._turning = Turning()
        self._factors: Factors | None = None
        self._made = self._factorisations = 0
        self._secants: Secants | None = None
        if policy.secants > 0:
            self._secants = Secants(policy.secants, np.append(self._measure, np.zeros(m)))

    @property
    def frames(self) -> Array:
        """See the base class."""
        return self.s.H

    @property
    def index(self) -> int:
        """See the base class."""
        return self._made

    # --- start ---

    def start(self) -> None:
        """See the base class."""
        equations, s, n, kinds = self.equations, self.s, self._n, self.model.kinds
        frames, v = equations.start[:2]
        check_velocities(equations, self.h)
        rate = np.empty((n, 6))
        push_all(kinds, frames[:n], np.ascontiguousarray(v[:n]), s.V)
        solver = DirectSolver(equations.matrix, _PREFIX)
        rates, s.weights[:] = accelerations(equations, solver, s.H, v, 0.0, self.h)
        motion.spatial_rates(self.model, s, rates, rate)
        s.trend[:], self._rates[:] = 0.5 * rate, rate
        self._sizes[:] = self.h
        self._set_time(0.0)
        alone = len(self.model.cells.calls)
        energies_at(self.model.cells, s.H, s.rest, s.W[:alone])
        if self.framed.count:
            evaluate(self.framed.table, s.H, np.zeros_like(s.H), s.F, s.W[alone:])
        s.account[:] = s.W
        self._pushes.at_rest(s.H)
        if len(s.lasting[0]):
            forces_at(self.model.cells, s.H, s.rest, s.lasting[0])

    def _set_time(self, time: float) -> None:
        """Let loads and targets of a time act."""
        self.equations.prescribed(time).act()
        loads = self.equations.tables.loads
        self.model.dead[:], self.model.following[:] = loads.dead, loads.following
        self.model.moment[:] = loads.moment

    # --- a step ---

    def _evaluate(self) -> None:
        """Balance and constraints of the present step."""
        s, this, model = self.s, self.this, self.model
        motion.move(model, s, this, self.size)
        if self.joints.any:
            self.joints.add_forces(s, this, self.size)
        for term in self._viscous:
            motion.mean_rates(model, this, self.size, self._twists)
            self._viscous_forces[:] = 0.0
            term.add_viscous_forces(this.middle, self._twists, self._viscous_forces)
            steps.add_viscous(model, this, self.size, self._twists, self._viscous_forces)
        if self._pushes:
            ends = Ends(s.H, this.end, this.mean, this.delta)
            self._pushes.set_between(ends, self._pushed)
            steps.add_pushed(this, self._pushed)
        steps.residual(model, s, this, self.size)

    def _solve(self) -> None:
        """The correction, into ``_x``."""
        assert self._factors is not None
        solve(self._factors.plain, self.this.r, self._y, self._x)
        if self._secants is not None:
            self._secants.improve(self._x)

    def _factorise(self) -> None:
        """With the matrix in the middle of the step."""
        equations, s, n = self.equations, self.s, self._n
        H, v = s.H.copy(), np.zeros_like(equations.start.velocities)
        H[:n] = self.this.middle
        a: Array = self._still
        h = (1.0 + self.model.loss * s.lag[REMEMBERS]) * self.size
        plan = Plan(self._still, None, 4.0 / h**2, 2.0 / h, choices=self.choices)
        if len(self._frames):
            a, plan = self._of_frames(H, v, plan)
        if self._pushes:
            plan = plan._replace(ends=self._pushes.ends)
        now = Instant(H, v, a, s.weights)
        equations.residual(now, s.scale, self._work, self._found)
        s.scale[:] = equations.fill(now, self._found, plan._replace(stressed=H))
        self.this.r[6 * n :] = s.scale * (s.gap + self.this.change)
        self._factors = factorise(equations.matrix)
        self._factorisations += 1
        if self._secants is not None:
            self._secants.forget()

    def _of_frames(self, H: Array, v: Array, plan: Plan) -> tuple[Array, Plan]:
        """What frames have beside: velocities, accelerations, axes behind those of the end.

        Args:
            H: Of all rows in the middle of the step; frames are set half-way along screws, for
                means of what turns are strained.
            v: Of all rows, those of frames are set.
            plan: Of the matrix.

        Returns:
            Accelerations, and the plan with constraints at the end of the step.
        """
        s, this, n, own = self.s, self.this, self._n, self._frames
        end = s.H.copy()
        end[:n], end[n + 1 :] = this.end, self.joints.moved[1]
        forces_at = H.copy()
        H[own] = half_way(s.H, end, n)[own]
        found, rates = np.empty((2, n, 6))
        for V, out in ((0.5 * (s.V + this.V1), found), ((this.V1 - s.V) / self.size, rates)):
            inertia.local_twists(H, np.asarray(V), self.model.turning, out)
        rates[:, :3] -= np.cross(found[:, 3:], found[:, :3])
        a, lag = np.zeros((n, 6)), np.zeros((n, 3))
        a[own], v[own], lag[own] = rates[own], found[own], 0.5 * self.size * found[own, 3:]
        return a, plan._replace(joint_frames=end, forces_at=forces_at, lag=lag)
