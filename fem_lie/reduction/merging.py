"""Motion with inactive regions: each moves as a rigid body until it becomes active.

A region keeps the deformation that it has when it is merged, and its elastic energy; its nodes are
rigidly attached to one of them. From time to time :class:`ActivityCheck` determines which nodes
need independent frames: a segment is accepted up to the last check at which no merged node is
active, and the next segment has the active nodes free. Velocities of merged nodes are projected
with the mass matrix, which conserves linear and angular momentum. The loss of kinetic energy is
bounded, and nodes are merged only after they have been inactive for some time.

*Error estimate of merged regions.* Within a time ``τ`` from twists ``v`` and forces ``r`` nodes
move by ``d``, with matrices linearised about the state, constant accelerations, and joints ``B``
whose rates ``φ`` drives prescribe::

    A d + Bᵀ λ = b,     B d = τ φ,     A = 2 M / τ² + C / τ + K,     b = −r + (2 M / τ + C) v

With merged frames, for which twists are ``E w``, they move by ``E d_E``, from the same equations
with ``Eᵀ A E``. The error is the difference; it is large where a wave arrives, or where forces are
not in equilibrium. Regions end at joints.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import SuperLU, splu

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, instance, positive
from fem_lie.adaptivity.following.transfer import Transferred, mass_matrix
from fem_lie.lie.node_types import NodeType
from fem_lie.linear.direct import ConvergenceError
from fem_lie.reduction.merged_result import MergedMotion, RegionSegment
from fem_lie.results.history import Result
from fem_lie.scene import Scene
from fem_lie.scene.scene import Began, require_scene
from fem_lie.solve.alpha.generalised_alpha import GeneralisedAlpha
from fem_lie.solve.motion.integrator import Integrator
from fem_lie.system.equations import Equations, TimeState
from fem_lie.system.small_motions import linearised

_ROUNDS = 20
_DIFFERENCE = 1e-3  # difference quotients of drives over τ


class MotionMatrices:
    """Matrices of small motions about rest in given frames, with factors that checks share.

    They are in local axes: a rigid motion does not change them, so one factorisation serves all
    checks until nodes deform. Gyroscopic forces within τ are those of its start, in ``b``.

    Attributes:
        equations: Equations of the scene.
        ahead: τ.
        held: Whether each node has held unknowns, or a joint with a node of the same body, (n,).
        graph: Nodes that share a cell, (n, n).
    """

    def __init__(self, equations: Equations, frames: Array, ahead: float) -> None:
        """Linearise about rest.

        Args:
            equations: Equations of the scene.
            frames: Frames of all nodes, shape (N, 4, 3).
            ahead: τ.
        """
        unknowns, system = equations.unknowns, equations.system
        self.equations, self.ahead = equations, ahead
        self._free = ~unknowns.held.ravel()
        self._H = self.in_order(frames)
        system.terms.reset_stress(self._H)
        rest = np.zeros((unknowns.moving, 6))
        none = np.zeros(unknowns.m)
        M, C, K = (self._matrix(each) for each in linearised(system, self._H, rest, none))
        self._by_twists = (2.0 / ahead * M + C).tocsr()
        self._A = (2.0 / ahead**2 * M + C / ahead + K).tocsr()
        self._factors = _factorised(self._A[self._free][:, self._free])
        self._of_regions: dict[bytes, _MergedMotions] = {}
        pairs, count = system.elastic.pairs, unknowns.moving
        rows, columns = (np.concatenate([each[k] for each in pairs]) for k in range(2))
        self.graph = sp.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(count, count))
        self.held = unknowns.held.any(axis=1) | self._joined_within()

    def _joined_within(self) -> Flags:
        """Nodes that a joint connects with nodes of the same connected cells, (n,)."""
        _, part = connected_components(self.graph, directed=False)
        B = self.jacobian(self._H)
        row, node = np.repeat(np.arange(B.shape[0]), np.diff(B.indptr)), B.indices // 6
        pairs = np.unique(np.column_stack([row, part[node], node]), axis=0)
        twice = (np.diff(pairs[:, :2], axis=0) == 0).all(axis=1)
        found = np.zeros(len(part), dtype=bool)
        found[pairs[:-1, 2][twice]] = found[pairs[1:, 2][twice]] = True
        return found

    def _matrix(self, blocks: Array) -> sp.csr_matrix:
        kkt = self.equations.matrix
        size = 6 * self.equations.unknowns.moving
        return sp.bsr_matrix((blocks, kkt.indices, kkt.indptr), shape=(size, size)).tocsr()

    def in_order(self, frames: Array) -> Array:
        """Frames of the independent nodes, ground and prescribed motions, from those of all."""
        H, unknowns = self.equations.start.frames.copy(), self.equations.unknowns
        H[: unknowns.moving] = frames[unknowns.masters]
        return H

    def forces(self, r: Array, v: Array) -> Array:
        """``b`` for residuals ``r`` (6 n,) and twists ``v`` (n, 6)."""
        return np.where(self._free, -r + self._by_twists @ v.ravel(), 0.0)

    def jacobian(self, H: Array) -> sp.csr_matrix:
        """``B``, the constraint Jacobian at frames ``H``, (m, 6 n)."""
        return self.equations.system.tangent.jacobian(H)

    def motion(self, b: Array, B: sp.csr_matrix, c: Array) -> Array:
        """Motion of all nodes within τ for columns ``b`` and ``B d = c``, shape (6 n, k)."""
        d = np.zeros_like(b)
        B = B[:, self._free]
        d[self._free] = _constrained(self._factors, b[self._free], B, c)
        return d

    def merged_motion(self, b: Array, B: sp.csr_matrix, c: Array, root: Indices) -> Array:
        """The same with merged frames."""
        key = root.tobytes()
        if key not in self._of_regions:
            E = expansion(self._H, root)
            E = E[:, np.asarray(abs(E[self._free]).sum(axis=0)).ravel() > 0.0]
            self._of_regions[key] = _MergedMotions(E, _factorised(E.T @ self._A @ E))
        E, factors = self._of_regions[key]
        return np.asarray(E @ _constrained(factors, E.T @ b, B @ E, c))


def _factorised(A: sp.csr_matrix) -> SuperLU:
    """Factors of a matrix that is nearly symmetric and positive definite."""
    symmetric = {"SymmetricMode": True}
    return splu(A.tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options=symmetric)


def _constrained(factors: SuperLU, b: Array, B: sp.csr_matrix, c: Array) -> Array:
    """Solution ``d`` of ``A d + Bᵀ λ = b``, ``B d = c``; ``B`` may have dependent rows."""
    d = factors.solve(b)
    if not B.shape[0]:
        return np.asarray(d)
    Y = factors.solve(B.T.toarray())
    multipliers = np.linalg.pinv(B @ Y, hermitian=True) @ (B @ d - c)
    return np.asarray(d - Y @ multipliers)


class _MergedMotions(NamedTuple):
    """Twists of all nodes from those of independent nodes, and factors of ``Eᵀ A E``."""

    expansion: sp.csr_matrix
    factors: SuperLU


def expansion(H: Array, root: Indices) -> sp.csr_matrix:
    """``E``: twists of all nodes from those of the independent nodes, (6 n, 6 l)."""
    leads, number = np.unique(root, return_inverse=True)
    offset = lie.se3_compose(lie.se3_inverse(H[root]), H[: len(root)])
    blocks = lie.se3_adjoint(lie.se3_inverse(offset))
    shape = (6 * len(root), 6 * len(leads))
    return sp.bsr_matrix((blocks, number, np.arange(len(root) + 1)), shape=shape).tocsr()


class ActivityCheck:
    """A state of a scene without merged frames, and the nodes that need independent frames.

    Attributes:
        H: Frames of all nodes, ground and prescribed motions.
        v: Twists of the independent nodes, shape (n, 6).
    """

    def __init__(
        self, matrices: MotionMatrices, frames: Array, twists: Array, times: Array
    ) -> None:
        """Compute the motion of all nodes within τ.

        Args:
            matrices: Matrices of small motions, in a state as deformed as this one.
            frames: Frames of all nodes, shape (N, 4, 3).
            twists: Twists of all nodes, shape (N, 6).
            times: Times from the start at which loads are evaluated, the present one first.
        """
        equations, ahead = matrices.equations, matrices.ahead
        unknowns, system = equations.unknowns, equations.system
        self._matrices = matrices
        self.H = matrices.in_order(frames)
        self.v = np.ascontiguousarray(twists[unknowns.masters])
        equations.prescribed(times[0]).act()
        system.terms.reset_stress(self.H)
        r, none = np.empty(unknowns.size), np.zeros(unknowns.m)
        state = TimeState(self.H, self.v, np.zeros_like(self.v), none)
        equations.residual(state, none, r)
        loads = np.array([equations.prescribed(each).loads(self.H) for each in times])
        later = loads - loads[0]
        differs = later.any(axis=1)
        differs[0] = True
        b = matrices.forces(r[: self.v.size], self.v)[:, np.newaxis] + later[differs].T
        self._B = matrices.jacobian(self.H)
        self._rates = equations.prescribed(times[0], _DIFFERENCE * ahead).target_rates[0]
        self._given = b, self._B, ahead * self._rates[:, np.newaxis]
        self._d = matrices.motion(*self._given)

    @cached_property
    def mass(self) -> sp.csr_matrix:
        """Mass matrix of the twists, (6 n, 6 n)."""
        return mass_matrix(self._matrices.equations, self.H)

    @cached_property
    def kinetic(self) -> float:
        """Kinetic energy."""
        v = self.v.ravel()
        return float(0.5 * v @ (self.mass @ v))

    def merged(self, active: Flags) -> Indices:
        """The node to which each node is attached, itself if it is active, shape (n,).

        Connected components of inactive nodes are regions. A single node is no region, and fixed
        nodes are not attached.
        """
        root = np.arange(len(active))
        inactive = np.flatnonzero(~active & ~self._matrices.held)
        count, region = connected_components(
            self._matrices.graph[inactive][:, inactive], directed=False
        )
        first = np.full(count, len(active))
        np.minimum.at(first, region, inactive)
        root[inactive] = first[region]
        return root

    def neighbourhood(self, nodes: Flags) -> Flags:
        """These nodes and those that share a cell with them, (n,)."""
        return np.asarray(self._matrices.graph @ nodes > 0.0)

    def missed(self, root: Indices) -> Array:
        """Position error of each node within τ for the worst of the loads, shape (n,)."""
        if (root == np.arange(len(root))).all():
            return np.zeros(len(root))
        away = self._d - self._matrices.merged_motion(*self._given, root)
        apart = away.reshape(-1, 6, away.shape[1])[:, :3]
        return np.asarray(np.linalg.norm(apart, axis=1).max(axis=1))

    def active(self, tolerance: float) -> Flags:
        """Nodes that need independent frames, so that merged nodes are within the tolerance."""
        found: Flags = self._matrices.held.copy()
        for _ in range(_ROUNDS):
            away = self.missed(self.merged(found))
            more = ~found & (away > tolerance)
            if not more.any():
                break
            found[more] = True
        return found

    def projected(self, root: Indices) -> tuple[Array, float]:
        """Twists with merged frames, closest in the mass norm, and the loss of kinetic energy.

        Joints are satisfied. Linear and angular momentum are conserved, if joints to ground allow,
        for rigid motions are possible with merged frames.
        """
        E, v = expansion(self.H, root), self.v.ravel()
        factors, momenta = _factorised(E.T @ self.mass @ E), E.T @ (self.mass @ v)
        kept = E @ _constrained(factors, momenta, self._B @ E, self._rates)
        lost = v - kept
        return kept.reshape(-1, 6), float(0.5 * lost @ (self.mass @ lost))


_INACTIVE = 0.1  # tolerance for merging over the tolerance for splitting a region
_AHEAD = 2.0  # τ over the time between two checks
_INSTANTS = 5  # evaluations of the loads between two checks
_FIRST = 16  # first segment over the shortest, while all nodes are merged; then it doubles
_WAITING = 5  # shortest segments for which nodes have to be inactive before they are merged
_TRIES = 20  # attempts at one segment
_PART = 0.1  # fraction of the remaining loss that one merging may use
_LOST = 1e-8  # largest loss of kinetic energy by all mergings, relative


class _State(NamedTuple):
    """Start of a segment: frames and twists of all nodes."""

    time: float
    frames: Array
    twists: Array


def merged_motion(
    build: Callable[[], Scene],
    *,
    duration: float,
    step: float,
    every: float,
    tolerance: float,
    scheme: Integrator | None = None,
) -> MergedMotion:
    """Integrate in time with the frames of inactive regions merged.

    Args:
        build: Creates the scene, a new one in each call: bodies whose nodes have frames, with
            joints, drives, springs and loads.
        duration: End time.
        step: Step size.
        every: Shortest time between two changes of regions, a multiple of the step.
        tolerance: Largest position error of a merged node within two such times, a length.
        scheme: Time integration; default: ``GeneralisedAlpha()``.

    Raises:
        ValueError: The scene has nodes without frames, contacts, prescribed motions, rigid links,
            events, controllers, or friction or velocity constraints of joints.
        ConvergenceError: A segment failed.
    """
    instance(build, Callable, "build", "a function that makes a Scene")
    instance(scheme, Integrator | None, "scheme", "a scheme such as GeneralisedAlpha, or None")
    for value, what in ((duration, "duration"), (step, "step"), (every, "every")):
        positive(value, what)
    positive(tolerance, "tolerance")
    if abs(every / step - max(1, round(every / step))) > 1e-9:
        raise ValueError(f"every must be a multiple of the step {step!r}, got {every!r}")
    run = _Run(build, step, every, tolerance, GeneralisedAlpha() if scheme is None else scheme)
    return run.until(duration)


class _Run:
    """One motion."""

    def __init__(
        self,
        build: Callable[[], Scene],
        step: float,
        every: float,
        tolerance: float,
        scheme: Integrator,
    ) -> None:
        """Store the options and the equations without regions."""
        self._scheme, self._step = scheme, step
        self._every, self._tolerance = every, tolerance
        self._whole, self._scene = _whole(build()), build()
        self._repeated, self._lost = 0, 0.0

    def until(self, duration: float) -> MergedMotion:
        """Integrate from the start to ``duration``."""
        whole, start = self._whole, self._whole.start
        master_map = whole.system.numbering.master_map
        frames, twists = master_map.frames(start.frames), master_map.twists(start.velocities)
        state = _State(whole.scene.began.time, frames, twists)
        self._matrices = MotionMatrices(whole, frames, _AHEAD * self._every)
        check = self._check(state, whole.system.connections.history_variables)
        end, span = check.state.time + duration, _FIRST * self._every
        active = check.active(self._tolerance)
        segments: list[RegionSegment] = []
        while end - check.state.time > 0.5 * self._step:
            found = self._inactive_segment(check, active, min(span, end - check.state.time))
            root = check.merged(found.active)
            segments.append(_segment(found, root, check.state.time, segments))
            check, before = found.check, active
            active = self._next(found)
            first, most = (_WAITING, 2 * _WAITING) if active.any() else (_FIRST, np.inf)
            same = (active == before).all()
            span = min(2.0 * span, most * self._every) if same else first * self._every
            if before.any():
                self._matrices = MotionMatrices(whole, check.state.frames, _AHEAD * self._every)
        return MergedMotion(tuple(segments), whole.unknowns.moving, self._repeated)

    def _inactive_segment(self, check: _Check, active: Flags, span: float) -> _Found:
        """Integrate a segment in which no merged node becomes active, with repetitions."""
        for _ in range(_TRIES):
            root = check.merged(active)
            result = self._moved(check, root, span)
            found = self._inactive_part(check, result, root, active)
            if found.rows:
                return found
            active, span = active | found.activated, self._every
            self._repeated += 1
        raise ConvergenceError(f"no regions are inactive after time {check.state.time:g}")

    def _inactive_part(self, check: _Check, result: Result, root: Indices, active: Flags) -> _Found:
        """The segment up to the last check at which all merged nodes are inactive."""
        found = _Found(result, 0, check, active, np.ones_like(active), np.zeros_like(active))
        every, last = round(self._every / self._step), len(result.times) - 1
        rows = [*range(every, last, every), last]
        states = [
            result.info.renumbered(values[rows], self._whole.unknowns.bodies)
            for values in (result.frames, result.velocities)
        ]
        for row, frames, velocities in zip(rows, *states, strict=True):
            time = check.state.time + float(result.times[row])
            state = _State(time, frames, velocities)
            after = self._check(state, found.check.turned)
            newly_active = (after.missed(root) > self._tolerance) & (root != np.arange(len(root)))
            if newly_active.any():
                return found._replace(activated=after.neighbourhood(newly_active))
            if active.any():
                found = found._replace(
                    inactive=found.inactive & ~after.active(_INACTIVE * self._tolerance)
                )
            found = found._replace(rows=row, check=after)
        return found

    def _next(self, found: _Found) -> Flags:
        """Which nodes have independent frames in the next segment."""
        check, active = found.check, found.active
        needed = check.active(self._tolerance) | found.activated
        if found.rows * self._step < (_WAITING - 0.5) * self._every:
            return needed | active
        fewer = needed | (active & ~found.inactive)
        _, lost = check.projected(check.merged(fewer))
        if lost > _PART * (_LOST - self._lost) * check.kinetic:
            return needed | active
        self._lost += lost / check.kinetic if lost > 0.0 else 0.0
        return fewer

    def _check(self, state: _State, turned: Array) -> _Check:
        return _Check(self._matrices, state, self._every, turned)

    def _moved(self, check: _Check, root: Indices, span: float) -> Result:
        """Result from a state on, with merged frames."""
        scene, unknowns = self._scene.with_loads(*self._scene.loads), self._whole.unknowns
        master_map = self._whole.system.numbering.master_map
        twists = master_map.twists(check.projected(root)[0])
        masters = unknowns.masters[root[master_map.master]]
        for body, nodes in zip(scene.bodies, unknowns.bodies.values(), strict=True):
            index = np.full(unknowns.total, -1)
            index[nodes] = np.arange(len(nodes))
            body.model.masters = index[masters[nodes]]
            body.model.start_frames = check.state.frames[nodes]
            body.velocities[:] = twists[nodes]
        scene.began = Began(check.state.time, turned=check.turned)
        return self._scheme.run(scene, duration=span, step=self._step, progress=False)


class _Check(ActivityCheck):
    """An activity check with its state, and the full turns of joints in it."""

    def __init__(
        self, matrices: MotionMatrices, state: _State, every: float, turned: Array
    ) -> None:
        """Check a state, with the loads until the next check; ``turned`` is that of the last."""
        since = state.time - matrices.equations.scene.began.time
        times = since + every * np.linspace(0.0, 1.0, _INSTANTS)
        connections = matrices.equations.system.connections
        connections.remember(turned)
        connections.accept(matrices.in_order(state.frames))
        super().__init__(matrices, state.frames, state.twists, times)
        self.state, self.turned = state, connections.history_variables


class _Found(NamedTuple):
    """The accepted part of a segment.

    Attributes:
        result: Result of the whole segment.
        rows: Index of the last accepted state; 0: there is none.
        check: Check at that state.
        active: Whether each node had an independent frame.
        inactive: Whether each node was inactive at all checks.
        activated: Merged nodes that became active after that state, and their neighbours.
    """

    result: Result
    rows: int
    check: _Check
    active: Flags
    inactive: Flags
    activated: Flags


def _segment(
    found: _Found, root: Indices, begin: float, before: Sequence[RegionSegment]
) -> RegionSegment:
    """The segment, with the change of momenta and energies at its start."""
    change, result = None, found.result
    if before:
        last, row = before[-1].result, before[-1].rows
        change = Transferred(
            (float(last.kinetic[row]), float(result.kinetic[0])),
            (float(last.elastic[row]), float(result.elastic[0])),
            np.array([last.momentum[row], result.momentum[0]]),
            np.array([last.angular_momentum[row], result.angular_momentum[0]]),
        )
    return RegionSegment(begin, result, found.rows, len(np.unique(root)), change)


def _whole(scene: Scene) -> Equations:
    """Equations without merged frames, or ``ValueError``."""
    require_scene(scene)
    equations = Equations(scene, dynamics=True)
    unknowns = equations.unknowns
    reasons = {
        "contacts": bool(scene.contacts),
        "reduced-order bodies": bool(unknowns.floating),
        "bodies whose nodes have no frames": any(
            body.model.node_type is not NodeType.FRAME for body in scene.bodies
        ),
        "rigid links": bool(scene.links),
        "prescribed motions": bool(scene.motions),
        "supports along axes fixed in space": bool(equations.supports),
        "friction in joints": unknowns.joint_friction,
        "velocity constraints": bool(unknowns.of_velocities),
        "events, sensors, controllers or limits of joints": scene.happens,
    }
    found = [reason for reason, given in reasons.items() if given]
    if found:
        raise ValueError(f"expected a scene to merge frames without {' and '.join(found)}")
    return equations
