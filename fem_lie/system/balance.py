"""External actions on a scene, and the energy and momentum balance of a run.

Support reactions are the residual of the equations of motion of supported nodes. The balance needs
them after each step; for a scene supported at a few nodes only the cells, joints and masses around
these are evaluated.

The balance of a run of generalised-α collects the work and impulses of loads, drives and supports,
and the dissipation of damping, as defined in :mod:`fem_lie.bodies.balances`. Powers and forces at
the ends of steps are integrated by the trapezoidal rule, of second order as is the scheme.
Increments of drives and prescribed motions are exact; the mean of their forces does work on them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie._state import Stateful, attributes
from fem_lie.bodies.balances import (
    BY_REACTIONS,
    DAMPING,
    LOADS,
    LOSS,
    POWER,
    REACTIONS,
    SIZE,
    TOTAL,
    WORK,
)
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays
from fem_lie.joints.equations.terms import wrenches
from fem_lie.lie.node_types import acceleration, pull_back
from fem_lie.lie.node_types.inertia import Inertia, PlainInertia, PlainMotion, multiply_row
from fem_lie.system import outer_forces
from fem_lie.system.nodes.masses import PlainLoads
from fem_lie.system.nodes.sums import add_moments
from fem_lie.system.outer_forces import (
    LastState,
    PlainScene,
    add_local,
    look_and_sum_up,
    sum_up,
)
from fem_lie.system.system import System
from fem_lie.system.terms.near import NearTerms
from fem_lie.system.time_state import TimeState


@compiled
def _add_nodal(
    kinds: Indices,
    motion: PlainMotion,
    mass: PlainInertia,
    loads: PlainLoads,
    nodes_of: tuple[Indices, Indices],
    work: Array,
    r: Array,
) -> None:
    """Add :func:`~fem_lie.system.nodes.sums.nodal_residual` of some nodes to ``r`` (n, 6).

    ``nodes_of`` are these nodes, and those whose accelerations are coupled with them.
    """
    (H, v, a), (indptr, indices, blocks), (nodes, felt) = motion, mass, nodes_of
    dead, moment, following = loads
    local = np.empty((4, 3))
    for i in felt:
        acceleration(kinds[i], H[i], v[i], a[i], local, work[0, i])
    for i in nodes:
        multiply_row(i, indptr, indices, blocks, work[0], work[1, i])
        for k in range(4):
            for j in range(3):
                work[1, i, k, j] -= dead[i, k, j]
        pull_back(kinds[i], H[i], work[1, i], 1.0, r[i])
        add_moments(H[i], moment[i], following[i], r[i])


@compiled
def _add_joints(
    H: Array,
    v: Array,
    joints: PackedJoints,
    multipliers: Array,
    ends: tuple[Indices, Indices],
    forces: Array,
    r: Array,
) -> None:
    """Add joint forces of some ends, given by pairs and sides, to ``r`` (n, 6)."""
    (pairs, sides), table, moved = ends, joint_arrays(joints), np.empty(6)
    wrenches(H, v, table, multipliers, pairs, sides, np.arange(len(pairs)), forces)
    for e in range(len(pairs)):
        pair, side = pairs[e], sides[e]
        lie.apply_adjoint_inverse_transposed(table.frames[pair, side], forces[e], moved)
        for k in range(6):
            r[table.nodes[pair, side], k] -= moved[k]


class HeldForces:
    """Support reactions: forces and moments of clamps and sliding supports.

    Attributes:
        nodes: Supported nodes, shape (s,).
        near: Whether only their neighbourhood is evaluated.
    """

    def __init__(self, system: System, held: Flags) -> None:
        """Find the neighbourhood of the supported nodes.

        Args:
            system: The equations.
            held: Unknowns held from outside, shape (n, 6).
        """
        self._system, self._held = system, held
        chosen: Flags = np.asarray(held.any(axis=1))
        self.nodes: Indices = np.flatnonzero(chosen)
        self._values = np.zeros((system.count, 6))
        alone = system.connections.of_joints_only and not system.terms.viscous
        alone = alone and not system.floating.integers[0]
        self._terms = system.terms.near(chosen) if alone else None
        self.near = self._terms is not None
        of, to = system.inertia.pairs
        self._nodes_of = self.nodes, np.unique(to[chosen[of]])
        table = system.table
        outer = np.append(chosen, np.zeros(len(system.frames) - system.count, dtype=bool))
        pairs, sides = np.nonzero(outer[table.nodes])
        self._ends, self._of_ends = (pairs, sides), np.empty((len(pairs), 6))
        self._work = np.zeros((2, system.count, 4, 3))

    def find(self, H: Array, v: Array, a: Array, multipliers: Array) -> Array:
        """Reactions in the axes of :attr:`nodes`, shape (s, 6).

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists, shape (≥ n, 6).
            a: Their rates.
            multipliers: Lagrange multipliers, shape (m,).
        """
        system, r = self._system, self._values
        if self._terms is None:
            every = np.empty(system.size)
            system.terms.condense(H)
            system.with_reactions(TimeState(H, v, a, multipliers), np.ones(system.m), every)
            r[:] = every[: 6 * system.count].reshape(-1, 6)
        else:
            self._look_near(self._terms, TimeState(H, v, a, multipliers))
        if not system.supports:
            return np.where(self._held[self.nodes], r[self.nodes], 0.0)
        found = np.where(self._held, r, 0.0)
        system.supports.rotate_back(H, found)
        return np.asarray(found[self.nodes])

    def _look_near(self, terms: NearTerms, state: TimeState) -> None:
        """Evaluate all forces on the supported nodes, and some forces on others."""
        system, r, (H, v, a, multipliers) = self._system, self._values, state
        r[:] = 0.0
        mass, loads = system.inertia.plain, system.loads.plain
        _add_nodal(system.kinds, (H, v, a), mass, loads, self._nodes_of, self._work, r)
        if len(self._of_ends):
            joints = system.connections.packed
            _add_joints(H, v, joints, multipliers, self._ends, self._of_ends, r)
        terms.add_forces(H, r)
        if system.supports:
            system.supports.rotate(H, r)


def supported(system: System) -> Flags:
    """Unknowns held from outside, shape (n, 6).

    The drilling rotations that a shell holds are no supports, and neither are
    missing unknowns.
    """
    held = system.held & ~system.numbering.missing_unknowns
    inner = system.separates_director.copy()
    inner[[system.numbering.node(clamp.point) for clamp in system.scene.clamps]] = False
    held[inner, 5] = False
    return held


class Acting:
    """External actions on the bodies of a scene; true if there are any.

    Attributes:
        strained: Whether stress-free strains change.
        plain: Whether :func:`~fem_lie.system.outer_forces.look` evaluates all of them.
        plain_but_held: Whether it evaluates all but support reactions.
        looks: Whether it evaluates loads, and whether joints.
        scene: Its argument for the scene.
    """

    def __init__(self, system: System) -> None:
        """Find the actions of a system."""
        self._system, held = system, supported(system)
        self._held = HeldForces(system, held) if held.any() else None
        self.strained = system.load_cases.strains_change
        connections = system.connections
        self._loaded, rates = system.load_cases.any_nodal, system.terms.rates
        joined = connections.outward
        self._others = joined and not connections.of_joints_only
        self._pushed = len(system.terms.loads) > 0
        # the compiled function includes damping by a constant matrix, and dampers
        self._viscous = system.terms.chosen(
            lambda term: term.viscosity is None or term.viscosity.rates is None
        )
        separate = self._pushed or self._viscous.viscous
        self._grounded = [term.ground for term in system.terms if term.ground is not None]
        separate = separate or bool(self._grounded)
        moved = self._others or separate or self.strained
        special = moved or self._held is not None
        self._any = special or self._loaded or joined or rates is not None or connections.driven
        self.plain, self.plain_but_held = self._any and not special, not moved
        damping = Inertia.none().plain if rates is None else rates
        self.looks = self._loaded, joined and not self._others
        constant = system.load_cases.constant, damping, connections.packed, system.floating.plain
        loads = system.lasting_loads.plain
        self.scene: PlainScene = (system.kinds, loads, *constant, *self.looks)

    def __bool__(self) -> bool:
        """Whether there are external actions."""
        return self._any

    @property
    def arrays(self) -> list[Any]:
        """Arrays of :attr:`scene` in a list."""
        kinds, loads, conservative, damping, joints, bodies, *_ = self.scene
        return [kinds, *loads, conservative, *damping, *joints, *bodies]

    def look(
        self, H: Array, v: Array, a: Array, multipliers: Array, row: Array, wrenches: Array
    ) -> None:
        """Evaluate external actions at the current time of the equations.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists, shape (n, 6).
            a: Their rates.
            multipliers: Lagrange multipliers, shape (m,).
            row: Power, dissipation and resultants, see :mod:`fem_lie.system.outer_forces`, shape
                (14,), overwritten.
            wrenches: Forces and moments of ground and prescribed frames, in these frames, shape (p
                + 1, 6), overwritten.
        """
        system, n = self._system, self._system.count
        outer_forces.look(H, v, multipliers, self.scene, row, wrenches)
        if self._pushed:
            forces = system.terms.of_loads(H)
            add_local(system.kinds, H, forces, LOADS, 1.0, row)
            row[POWER] += np.sum(forces * v)
        if self._viscous.viscous:
            forces = np.zeros(6 * n)
            self._viscous.add_viscous_forces(H, v, forces)
            row[LOSS] += forces @ v.ravel()
        for term in self._grounded:
            forces = np.zeros((n, 6))
            term.add_of_ground(H, v, forces)
            add_local(system.kinds, H, forces, REACTIONS, -1.0, row)
        if self._others:
            wrenches[:], loss = system.connections.reactions(H, v, multipliers)
            row[LOSS] += loss
            fixed = np.zeros(len(wrenches), dtype=np.int64)  # frames, all of them
            add_local(fixed, H[n:], wrenches, REACTIONS, 1.0, row)
        if self._held is not None:
            nodes, forces = self._held.nodes, self._held.find(H, v, a, multipliers)
            add_local(system.kinds[nodes], H[nodes], forces, REACTIONS, 1.0, row)


class EnergyBalance(Stateful):
    """Energy and momentum balance up to the current time.

    Attributes:
        total: Work, damping, numerical dissipation (unknown: 0), impulses of loads and of
            reactions, shape (15,).
        empty: Whether there is nothing to account for, or nobody asks.
        compiled: Whether :meth:`add` is :func:`~fem_lie.system.outer_forces.look_and_sum_up` alone.
        compiled_but_held: Whether it is that function but for impulses of supports.
        looks: Whether that function evaluates loads, and whether joints.
        table: Arguments of that function.
    """

    STATE = attributes("total", "_stored", "_time", "_last", "_dissipated")

    def __init__(self, system: System) -> None:
        """Start an empty balance of the equations ``system``."""
        self._system, self._acting = system, Acting(system)
        self.total = np.zeros(TOTAL)
        rows, z = len(system.frames) - system.count, np.zeros
        self._last = LastState(
            row=z(SIZE),
            wrenches=z((rows, 6)),
            H=system.frames.copy(),
            v=z((system.count, 6)),
            multipliers=z(system.m),
            targets=z(system.m),
        )
        self._start = self._last.plain
        self._fixed = PackedArrays([*self._acting.arrays, *self._last, self.total])
        # events compare with the last state on all ranks
        self.empty = not system.shared.any(bool(self._acting))
        self.compiled = self._acting.plain
        self._idle = False
        self.compiled_but_held = self._acting.plain_but_held
        self.looks, self.addresses = self._acting.looks, self._fixed.addresses
        self._row, self._wrenches = z(SIZE), z((rows, 6))
        self._undriven = z(system.m)
        self._stored, self._time = z(1), z(1)
        self._dissipated = z(1)

    def rest(self) -> None:
        """Switch the balance off, as no result asks for it."""
        self.empty = self._idle = True

    def open(self, time: float, H: Array, v: Array, a: Array, multipliers: Array) -> None:
        """Restart the balance with the actions at the current time of the equations.

        Args:
            time: That time; at a jump the later side.
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists, shape (n, 6).
            a: Their rates.
            multipliers: Lagrange multipliers, shape (m,).
        """
        self.restart(np.zeros(TOTAL), time, H, v, a, multipliers)

    @property
    def so_far(self) -> Array:
        """:attr:`total` with what friction has dissipated up to the accepted state, (15,)."""
        dissipated = self._system.terms.dissipated
        self.total[DAMPING] += dissipated - self._dissipated[0]
        self._dissipated[0] = dissipated
        return self.total

    def restart(
        self, so_far: Array, time: float, H: Array, v: Array, a: Array, multipliers: Array
    ) -> None:
        """Continue the balance from an accepted state.

        Args:
            so_far: The value of :attr:`so_far` there, shape (15,).
            time: Time; other arguments are those of :meth:`open`.
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists, shape (n, 6).
            a: Their rates.
            multipliers: Lagrange multipliers, shape (m,).
        """
        self.total[:] = so_far
        self._dissipated[0] = self._system.terms.dissipated
        self.look(time, H, v, a, multipliers)

    def look(self, time: float, H: Array, v: Array, a: Array, multipliers: Array) -> None:
        """Evaluate the actions at the current time of the equations."""
        if self.empty:
            return
        last = self._last
        self._acting.look(H, v, a, multipliers, last.row, last.wrenches)
        last.H[:], last.v[:], last.multipliers[:], last.targets[:] = H, v, multipliers, self.targets
        self._note(time, H)

    def _note(self, time: float, H: Array) -> None:
        self._time[0] = time
        if self._acting.strained:
            self._stored[0] = self._system.elastic.energy(H)

    @property
    def targets(self) -> Array:
        """Targets of all constraints, shape (m,)."""
        connections = self._system.connections
        if not connections.driven:
            return self._undriven
        if connections.of_joints_only:
            return connections.table.targets
        return connections.present_targets

    def rates(self, state: TimeState, row: Array) -> None:
        """Rates of the balance at the current time of the equations, for a quadrature.

        Args:
            state: Frames, twists, their rates and multipliers.
            row: Power, dissipation and resultants, shape (14,), overwritten.
        """
        self._acting.look(*state, row, self._wrenches)

    def add(self, h: float, time: float, H: Array, v: Array, a: Array, multipliers: Array) -> None:
        """Add a step, whose end is the current time of the equations and the given state.

        Args:
            h: Step size.
            time: Time of its end; at a jump the earlier side.
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists, shape (n, 6).
            a: Their rates.
            multipliers: Lagrange multipliers, shape (m,).
        """
        acting, total = self._acting, self.total
        if self.empty:
            return
        end = H, v, multipliers, self.targets
        if self.compiled:
            look_and_sum_up(h, end, *self.looks, self.addresses)
            return
        if acting.strained:
            total[POWER] += self._strain_work(time, H)
        acting.look(H, v, a, multipliers, self._row, self._wrenches)
        sum_up(h, end, self._row, self._wrenches, self._start, total)
        self._note(time, H)

    def _strain_work(self, time: float, H: Array) -> float:
        """Work of stress-free strains: their change of the energy at each end, on the average."""
        system, elastic = self._system, self._system.elastic
        ahead = elastic.energy(self._last.H) - self._stored[0]
        behind = elastic.energy(H)
        began = system.scene.began.time
        system.set_time(began + float(self._time[0]))
        behind -= elastic.energy(H)
        system.set_time(began + time)
        return float(0.5 * (ahead + behind))

    def jump(self, time: float, H: Array, v: Array, a: Array, multipliers: Array) -> None:
        """Add an instantaneous event: a change of velocities and of strains.

        Arguments are those of :meth:`open`.
        """
        if self._idle:
            return
        system, last, before, after = self._system, self._last, np.empty(7), np.empty(7)
        system.report(last.H, last.v, before)
        system.report(H, v, after)
        stored = float(self._stored[0])
        self.look(time, H, v, a, multipliers)
        self.total[POWER] += after[0] - before[0] + float(self._stored[0]) - stored
        self.total[BY_REACTIONS:] += after[1:] - before[1:]

    def project(self, H: Array, before: Array, after: Array) -> None:
        """Add a projection of velocities onto the constraints at the end of a step.

        Impulses of constraints that neither a drive nor a prescribed motion moves do no work on the
        velocities after it, which satisfy them.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            before: Twists before it, shape (n, 6).
            after: Twists after it.
        """
        if self.empty:
            return
        system, (old, new, change) = self._system, np.empty((3, 7))
        for v, invariants in ((before, old), (after, new), (after - before, change)):
            system.report(H, v, invariants)
        if system.connections.driven or system.scene.motions:
            # (v after)·M (change of v), by kinetic energies
            self.total[WORK] += new[0] - old[0] + change[0]
        self.total[BY_REACTIONS:] += new[1:] - old[1:]

    def collide(self, time: float, before: TimeState, after: TimeState, work: float) -> float:
        """Add impacts at the end of a step that was added without them.

        Args:
            time: The end of the step.
            before: State without impacts.
            after: Current state.
            work: Work of drives and prescribed motions by their impulses.

        Returns:
            Energy dissipated by the impacts, which is part of that of damping.
        """
        system, last = self._system, (np.empty(7), np.empty(7))
        energies = [
            system.report(state.H, state.v, invariants) + system.terms.energy(state.H)
            for state, invariants in zip((before, after), last, strict=True)
        ]
        lost = float(last[0][0] + energies[0] - last[1][0] - energies[1]) + work
        self.total[DAMPING] += lost
        self.total[WORK] += work
        self.total[BY_REACTIONS:] += last[1][1:] - last[0][1:]
        self.look(time, *after)
        return lost
