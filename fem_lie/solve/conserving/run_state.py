"""State of a run of a conserving scheme: start of a step, loads in time, matrices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie._state import ChangingArrays, attributes, put_back, saved
from fem_lie.bodies.balances import WORK
from fem_lie.forms.cells import Cells, evaluate
from fem_lie.lie.node_types import POSITION_GRADIENT, push_all_forward, retract_all
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.factors import Factors, factorise
from fem_lie.solve.conserving.divided import AllRanks
from fem_lie.solve.conserving.midpoint.any_node import span_from_python, spatial_rates, twists
from fem_lie.solve.conserving.midpoint.cayley import midpoint_frames
from fem_lie.solve.conserving.midpoint.products import product_rates, stored_energies
from fem_lie.solve.conserving.model import (
    assemblies_of_frames,
    end_forces_of,
    incidences_of,
    model_of,
    segments_of,
    start_state,
    step_workspace,
    vector_cells_of,
)
from fem_lie.solve.conserving.python_forces.constraints import OtherConstraints
from fem_lie.solve.conserving.python_forces.forces import PythonForces
from fem_lie.solve.conserving.python_forces.joints import Joints
from fem_lie.solve.conserving.step import corrections
from fem_lie.solve.conserving.step.balance import packed_residual
from fem_lie.solve.conserving.step.joints import border_at
from fem_lie.solve.conserving.step.packing import Packed
from fem_lie.solve.conserving.step.records import Scheme, Span, State, Step
from fem_lie.solve.conserving.step.series import set_inverse
from fem_lie.solve.conserving.vector_cells.cell_arrays import VectorCells
from fem_lie.solve.conserving.vector_cells.cells import energies_at
from fem_lie.solve.conserving.vector_cells.force_changes import forces_at
from fem_lie.solve.motion.consistent import accelerations, check_velocities
from fem_lie.solve.motion.integration import DividedIntegration
from fem_lie.solve.motion.policies import RefactorisationPolicy
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.recording.result_row import ResultRow
from fem_lie.solve.rotations import Rotations, by_rates
from fem_lie.solve.secants import Secants
from fem_lie.system.equations import Equations, Plan, TimeState

PREFIX = "fem_lie_dynamics_"


@dataclass(frozen=True)
class Options:
    """Options of a conserving scheme.

    Attributes:
        tolerance: See :class:`~fem_lie.solve.conserving.energy_momentum.EnergyMomentum`.
        policy: When to refactorise the iteration matrix.
        max_iterations: Largest number of iterations of a step.
        dissipation: Dissipation parameter χ, see :mod:`fem_lie.solve.conserving.step.dissipation`.
        filter_gain: Filter gain μ.
    """

    tolerance: float
    policy: RefactorisationPolicy
    max_iterations: int
    dissipation: float = 0.0
    filter_gain: float = 1.0


_ARRAYS = ("s", "progress")
"""Arrays and records that a step changes."""

_PARTS = ("cells", "_python_forces.joints")
"""Further objects whose state a step changes."""


class RunState(DividedIntegration[History]):
    """State of a run of a conserving scheme.

    Attributes:
        s: State between steps.
        this: The current step.
        size: Size of the next step or sub-step.
        unpredicted: Number of steps to come that begin without a prediction.
        current_jacobian: Whether solutions use the current constraint Jacobian, whatever the matrix
            contains.
    """

    STATE = attributes(
        *("this.V1", "this.r", "model.scale", "counts", "size", "unpredicted", "_end_forces"),
        *(*_ARRAYS, *_PARTS),
    )

    current_jacobian = True
    _framed: slice | Indices
    _framed_rows: slice | Indices

    def __init__(
        self,
        options: Options,
        equations: Equations,
        step: float,
        shared: RunState | None = None,
    ) -> None:
        """Allocate all arrays without computing anything.

        Args:
            options: Options of the scheme.
            equations: Equations of the scene.
            step: Step size.
            shared: A run of the same equations with which this one shares its state; default: none.
        """
        super().__init__(options.policy, equations, step)
        self.options, self.rule, self.size = options, options.policy.rule(), self.h
        self.moving, self._changing = equations.unknowns.moving, equations.unknowns.time_dependent
        self._held = len(equations.unknowns.supported) > 0
        several = equations.shared.several
        # constraints of other parts are none of these
        self.current_jacobian = self.current_jacobian and not several
        kinds = equations.arrays.kinds
        self._kinds, self._vectors = kinds, np.flatnonzero(kinds >= POSITION_GRADIENT)
        of_all = kinds[equations.arrays.master] < POSITION_GRADIENT
        # a full slice makes no copy
        self._framed = self._framed_rows = slice(None)
        if len(self._vectors):
            self._framed, self._framed_rows = (
                np.flatnonzero(k) for k in (kinds < POSITION_GRADIENT, of_all)
            )
        self.cells: Cells = (
            Cells(assemblies_of_frames(equations)) if shared is None else shared.cells
        )
        self.vector_cells: VectorCells = (
            vector_cells_of(equations) if shared is None else shared.vector_cells
        )
        self._strained = equations.unknowns.strains_change
        incidences = incidences_of(equations, self.current_jacobian)
        parts, dissipates = (
            (equations, self.cells, self.vector_cells, incidences),
            options.dissipation > 0.0,
        )
        self.s: State = start_state(*parts, dissipates=dissipates) if shared is None else shared.s
        self.this: Step = (
            step_workspace(*parts, dissipates=dissipates) if shared is None else shared.this
        )
        self._end_forces, self._rotations = end_forces_of(equations), Rotations(by_rates)
        scheme = Scheme(self.size, options.dissipation, options.filter_gain)
        self.model = model_of(equations, self.cells, self.vector_cells, scheme, incidences)
        python_forces = None if shared is None else shared._python_forces
        self._python_forces: PythonForces = PythonForces(
            equations, self, self._end_forces, python_forces
        )
        self._ranks = AllRanks(equations, self.model, self.this, PREFIX) if several else None
        # convected axes are rotated after each step, and constraint violations of joints are
        # reduced
        known, turns = equations.arrays, self.model.vectors
        turns &= known.drills or len(known.around[0]) > 0
        each = turns or self._python_forces.between or options.policy.secants > 0
        self._each: bool = equations.shared.any(each)
        self._renews = equations.shared.any(self._python_forces.joints is not None)
        if options.policy.secants > 0:
            given = options.policy.secants, self._node_measure, equations.shared
            self._python_forces.learn(Secants(*given))
        self._packed = Packed(self.model, self.s, self.this)
        self.progress = corrections.PROGRESS()
        self._progress_at = PackedArrays((self.progress,)).addresses
        self.counts, self.unpredicted = np.zeros(2, dtype=np.int64), 0
        self._factors: Factors | None = None
        self._kept = -1  # last step whose row the compiled loop has filled in
        self._lost = False  # whether each iteration of the current step refactorises
        self._filled = ResultRow(equations)
        self._r, still = np.empty(equations.unknowns.size), np.zeros((self.moving, 6))
        now = TimeState(*equations.start[:2], still, self.s.multipliers)
        self._found = equations.residual(now, self.model.scale, self._r)
        self._end = 0.0

    @property
    def _node_measure(self) -> Array:
        """Norm weights of unknowns, in lengths of the model, zero for multipliers, (6 n + m,)."""
        measure = self.model.measure.copy()
        measure[6 * self.moving :] = 0.0
        return measure

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return self.s.H

    @property
    def index(self) -> int:
        """Number of steps made, including the current one."""
        return int(self.progress.steps)

    def local(self, V: Any, H: Array) -> Array:
        """Velocities (n, 6) along the axes of nodes ``H`` from coordinate rates (n, 4, 3).

        These are twists of frames, and rates of the coordinate vectors of other nodes.
        """
        out, unused, still = np.zeros((3, len(V), 6))
        turning = self.equations.arrays.turning
        twists(self._kinds, turning, H, np.ascontiguousarray(V), still, out, unused)
        return out

    @property
    def asks(self) -> bool:
        """Whether Python has something to do before and after each step."""
        return self._each

    @property
    def joints(self) -> Joints | OtherConstraints | None:
        """Joints whose forces are evaluated in Python, if there are any."""
        return self._python_forces.joints

    def spatial(self, H: Array, v: Array, rates: Array) -> Array:
        """Accelerations of increments (n, 6), from twists ``v`` and their ``rates`` along axes."""
        out = np.empty((self.moving, 6))
        spatial_rates(self._kinds, H, np.ascontiguousarray(v), np.ascontiguousarray(rates), out)
        return out

    # --- start ---

    def start(self) -> None:
        """Compute initial velocities, multipliers, energies and constraints.

        Scale the constraints.
        """
        equations, s, n = self.equations, self.s, self.moving
        frames, v = equations.start[:2]
        check_velocities(equations, self.size)
        push_all_forward(self._kinds, frames[:n], np.ascontiguousarray(v[:n]), s.V[:n])
        self._push_products(s.H, s.V)
        solver = DirectSolver(equations.matrix, PREFIX)
        vdot, s.multipliers[:] = accelerations(equations, solver, s.H, v, 0.0, self.size)
        s.rates[:] = self.spatial(s.H, v, vdot)
        self._set_loads(0.0)
        s.account[:] = self._evaluate_start()
        self._end_forces.at_rest(s.H)
        now = TimeState(s.H, v, vdot, s.multipliers)
        equations.residual(now, np.ones(len(s.multipliers)), self._r, self._found)
        s.gap[:] = self._r[6 * n :]
        self.model.scale[:] = self._fill(s.H, v[:n], vdot, scale=None)
        self.progress.excess = np.inf

    def _push_products(self, H: Array, V: Array) -> None:
        """Set the rates of products, which come last in ``V`` (n + p, 4, 3)."""
        n = self.moving
        if len(V) > n:
            found = np.empty((2, *V[n:].shape))
            product_rates(*self.model.bodies, (H, V[:n], np.zeros_like(V[:n])), found)
            V[n:] = found[0]

    def _evaluate_start(self) -> Array:
        """Forces and energies of the cells at the start of a step; returns the energies."""
        frames = self.equations.report(self.s.H).frames
        s, framed = self.s, self.cells.count
        others = framed + len(self.vector_cells.sees)
        evaluate(self.cells.table, frames, np.zeros_like(frames), s.F, s.W[:framed])
        energies_at(self.vector_cells, s.H, s.rest, s.W[framed:others])
        if len(s.W) > others:
            stored_energies(*self.model.bodies, s.H, s.W[others:])
        if len(s.cell_forces[0]):
            forces_at(self.vector_cells, s.H, s.rest, s.cell_forces[0])
        return s.W

    # --- steps that are taken back ---

    @cached_property
    def _arrays(self) -> ChangingArrays:
        return ChangingArrays(self, _ARRAYS)

    def saved(self) -> dict[str, Array]:
        """A copy of the state that a step changes."""
        return self._arrays.saved_state() | saved(self, (*_PARTS, "equations.history_variables"))

    def take_back(self, state: Mapping[str, Array]) -> None:
        """Restore a :meth:`saved` state."""
        self._arrays.restore(state)
        put_back(self, (*_PARTS, "equations.history_variables"), state)

    def _resize(self, h: float) -> None:
        """Set the state as the start of a step of another size, see :mod:`.variable`."""
        s, r = self.s, h / self.size
        s.w[:], s.w_F[:], s.last_residual[:] = r * s.w, r * s.w_F, s.last_residual / r
        s.cell_forces[1, :], s.within[:] = r * s.cell_forces[1], r * s.within
        s.filter_state.length *= r * r
        self.progress.motion *= r
        # round-off of a larger step is not that of a smaller one
        self.progress.floor = 0.0
        self._set_size(h)

    def _set_size(self, h: float) -> None:
        self.size = h
        self.model = self.model._replace(scheme=self.model.scheme._replace(h=h))
        self._packed.set_scheme(self.model)

    # --- loads ---

    def _set_time(self, start: float, end: float) -> None:
        """Set loads at the midpoint of the next step, and prescribed motions at its end."""
        equations, coordinates, n = self.equations, Span(*self.this.coordinates), self.moving
        self._set_loads(0.5 * (start + end))
        if equations.unknowns.driven:
            targets = [equations.prescribed(time).targets for time in (start, end)]
            self.model.driven[:] = targets[1] - targets[0]
        if len(coordinates.end) > n + 1:
            before, after = self.s.H[n + 1 :], equations.prescribed(end).frames
            coordinates.end[n + 1 :], coordinates.middle[n + 1 :] = after, after
            coordinates.mean[n + 1 :], coordinates.delta[n + 1 :] = (
                0.5 * (before + after),
                after - before,
            )

    def _take_loads(self) -> None:
        # the weight of products is constant
        for array, value in zip(self.model.loads, self.equations.arrays.loads, strict=True):
            array[: self.moving] = value

    def _set_loads(self, time: float) -> None:
        """Forces of the loads at ``time``; initial strains do work when they change."""
        self.equations.prescribed(time).act()
        self._take_loads()
        self.model.pressure.across[:] = segments_of(self.equations.arrays.terms).across
        if self._strained:
            before = self.s.W.copy()
            self.cells.pack()
            gain = self._evaluate_start() - before
            self.s.account[:] += gain
            self.s.balance[WORK] += gain.sum()

    # --- matrix ---

    def _factorise(self) -> None:
        """Assemble and factorise the matrix of the current step."""
        if self._python_forces.learns is not None:
            self._python_forces.learns.forget()
        self._fill_here(self.model.scale)
        if self._ranks is None:
            self._factors = self._with_inverse(factorise(self.equations.matrix))
        else:
            self._factors = self._ranks.factorise()
        self.counts[:] = self.counts[0] + 1, self.index
        within = self.progress.iteration > 1
        self.progress.fewest = corrections.NEW if within else corrections.UNKNOWN
        self.progress.excess = 0.0

    def _with_inverse(self, factors: Factors) -> Factors:
        """The factors, with the columns of the inverse for :mod:`.step.series`."""
        ends = self.model.ends
        if len(ends.unknowns):
            set_inverse(factors.plain, ends, self.this.r)
        return factors

    def _fill_here(self, scale: Array | None) -> Array:
        """Assemble the matrix at the midpoint of the current iterate, or at the start of the step.

        A predicted end may have stresses that do not occur.

        Args:
            scale: Scale of the constraints; ``None``: choose one at the start of the step.

        Returns:
            The scale of the constraints in the matrix.
        """
        s, this, n = self.s, self.this, self.moving
        if self.progress.iteration > 1:
            packed, end, ahead = self._packed, Span(*this.coordinates).end, 0.0
            packed_residual(packed.model, packed.state, packed.step)
            H = at = self._midpoint_frames(end)
            V, V1 = s.V[:n], this.V1[:n]
            v, a = self.local(0.5 * (V + V1), H), self.local((V1 - V) / self.size, H)
        else:
            H, at, end, v, ahead = self._at_start(), s.H, s.H, self.local(s.V[:n], s.H), 1.0
            a = 2.0 * np.einsum("nij,nkj->nki", H[:n, 1:], s.trend.reshape(n, 2, 3)).reshape(n, 6)
        a[:, :3] -= np.cross(v[:, 3:], v[:, :3])
        a[self._vectors] = 0.0
        age = self._age()
        joints_at = s.H if scale is None else self._moved(end, v, ahead + age)
        forces_at = self._moved(at, v, 0.5 * ahead + age)
        if self.current_jacobian:
            axes = self._moved(joints_at, v, -0.5)
            joints, held, incidences = self.model.joints, self.model.held, self.model.incidences
            border_at(joints, incidences, self._kinds, held, (joints_at, axes, forces_at), s.border)
        return self._fill(H, v, a, joints_at, forces_at, scale=scale)

    def _age(self) -> float:
        """Number of steps to the midpoint of the likely life of the matrix: that of the last one.

        No low-rank correction of the matrix accounts for joints that are evaluated in Python, and
        extrapolating them this far is inaccurate: with such joints the matrix is that of the
        current step.
        """
        if self._lost or self._renews:
            return 0.0
        return float((self.index - self.counts[1]) // 2)

    def _at_start(self) -> Array:
        """Frames at the start of the step, other nodes at the midpoint of the predicted step."""
        s, along, own = self.s, Span(*self.this.coordinates), self._vectors
        if not len(own):
            return s.H
        coordinates = along.delta, along.mean, along.end, along.middle
        span_from_python(self._kinds, s.H, self.this.step, coordinates)
        H = s.H.copy()
        H[own] = along.middle[own]
        return H

    def _midpoint_frames(self, end: Array) -> Array:
        """Nodes at the midpoint of the step: frames along screw motions, others along lines."""
        H = midpoint_frames(self.s.H, end, self.moving)
        H[self._vectors] = Span(*self.this.coordinates).middle[self._vectors]
        return H

    def _moved(self, H: Array, v: Array, steps: float) -> Array:
        """Nodes extrapolated by this number of steps."""
        n, ahead, own = self.moving, H.copy(), self._vectors
        ahead[:n] = lie.se3_retract(H[:n], steps * self.size * v)
        if len(own):
            moved = np.empty((len(own), 4, 3))
            retract_all(self._kinds[own], H[own], steps * self.size * v[own], moved)
            ahead[own] = moved
        return ahead

    def _fill(
        self,
        H: Array,
        v: Array,
        a: Array,
        joints_at: Array | None = None,
        forces_at: Array | None = None,
        *,
        scale: Array | None,
    ) -> Array:
        """Assemble the matrix at frames ``H``; returns the scale of its constraints.

        Constraints are evaluated at the end of a step, ``joints_at``; their forces act at its mean.
        """
        equations, n = self.equations, self.moving
        now = TimeState(H, np.zeros_like(equations.start.velocities), a, self.s.multipliers)
        now.v[:n] = v
        now.v[self._vectors] = 0.0
        equations.residual(now, self.model.scale, self._r, self._found)
        # the first step conserves, see filtered forces
        h, still = (
            (1.0 + self.options.dissipation * self.s.filter_state.active) * self.size,
            np.zeros((n, 6)),
        )
        plan = Plan(still, scale, 4.0 / h**2, 2.0 / h, joints_at, forces_at)
        if self._python_forces.touching and self.progress.iteration > 1:
            plan = plan._replace(ends=self._end_forces.ends)
        # unknowns are along midpoint axes, elements and constraints are differentiated at the end
        lag = 0.5 * self.size * v[:, 3:]
        lag[self._vectors] = 0.0
        back = np.ascontiguousarray(lie.so3_exp(-lag))[:, np.newaxis]
        plan = plan._replace(motions=back, end_motions=back)
        plan = plan._replace(stressed=H, matrix_terms=self.matrix_terms)
        return equations.fill(now, self._found, plan)
