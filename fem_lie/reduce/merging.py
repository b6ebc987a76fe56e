"""A motion whose inactive regions move with one frame each until they become active.

A region keeps the deformation that it has when it is merged, with the energy of that; its nodes
follow one of them rigidly. Which nodes need frames of their own is asked now and then, see
:class:`Looking`: a stretch counts up to where no merged node stirs, and the next one has those that
do free. Merging projects velocities by mass, which keeps both momenta; what it would take of the
kinetic energy is bounded, and nodes wait until they have been quiet for a while.

What regions with one frame each would miss of the next moments of a motion.

Within a time ``τ`` from twists ``v`` and forces ``r`` nodes move by ``d``, with matrices of small
motions beside the state, as if accelerations were constant::

    A d = b,     A = 2 M / τ² + C / τ + K,     b = −r + (2 M / τ + C) v

and with frames merged, so that twists are ``E w``, by ``E d_E`` with ``Eᵀ A E d_E = Eᵀ b``. What
is missed is the difference: large where a wave comes, or where forces find no balance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, instance, positive
from fem_lie.adapt.following.transfer import Transferred, mass_matrix
from fem_lie.lie.node_types import NodeType
from fem_lie.linear.direct import ConvergenceError
from fem_lie.reduce.merged_motion import MergedMotion, RegionStretch
from fem_lie.results.history import Result
from fem_lie.scene import Scene
from fem_lie.scene.scene import Began, require_scene
from fem_lie.solve.alpha.generalised_alpha import GeneralisedAlpha
from fem_lie.solve.motion.integrator import Integrator
from fem_lie.system.equations import Equations, TimeState
from fem_lie.system.small_motions import linearised

_ROUNDS = 20


class Looking:
    """A state of a scene without merged frames.

    Attributes:
        H: Frames of all rows.
        v: Twists of the nodes that lead, shape (n, 6).
        mass: Matrix of these twists, (6 n, 6 n).
        kinetic: Energy.
    """

    def __init__(
        self, equations: Equations, frames: Array, twists: Array, times: Array, ahead: float
    ) -> None:
        """Find what moves, and how far.

        Args:
            equations: Of the scene.
            frames: Of all nodes, shape (N, 4, 3).
            twists: Likewise, shape (N, 6).
            times: At which loads are asked for, the present one first.
            ahead: τ.
        """
        unknowns, system = equations.unknowns, equations.system
        self._held: Flags = np.asarray(unknowns.held.any(axis=1))
        self.H = equations.start.frames.copy()
        self.H[: unknowns.moving] = frames[unknowns.masters]
        self.v = np.ascontiguousarray(twists[unknowns.masters])
        equations.prescribed(times[0]).act()
        system.terms.reset_stress(self.H)
        r = np.empty(unknowns.size)
        state = TimeState(self.H, self.v, np.zeros_like(self.v), np.zeros(0))
        equations.residual(state, np.zeros(0), r)
        M, C, K = (self._matrix(equations, b) for b in linearised(system, *state[:2], state[3]))
        self._free = ~unknowns.held.ravel()
        v = self.v.ravel()
        self._A = (2.0 / ahead**2 * M + C / ahead + K).tocsr()
        steady = np.where(self._free, -r + 2.0 / ahead * (M @ v) + C @ v, 0.0)
        loads = [equations.prescribed(each).loads(self.H) for each in times]
        self._b = steady[:, np.newaxis] + (np.array(loads) - loads[0]).T
        some = self._A[self._free][:, self._free].tocsc()
        self._d = np.zeros_like(self._b)
        self._d[self._free] = splu(some).solve(self._b[self._free])
        self.mass: sp.csr_matrix = mass_matrix(equations, self.H)
        self.kinetic = float(0.5 * v @ (self.mass @ v))
        matrix = equations.matrix
        count = unknowns.moving
        ones = np.ones(len(matrix.indices))
        self._graph = sp.csr_matrix((ones, matrix.indices, matrix.indptr), shape=(count, count))

    @staticmethod
    def _matrix(equations: Equations, blocks: Array) -> sp.csr_matrix:
        size = 6 * equations.unknowns.moving
        kkt = equations.matrix
        return sp.bsr_matrix((blocks, kkt.indices, kkt.indptr), shape=(size, size)).tocsr()

    def merged(self, active: Flags) -> Indices:
        """The node whose frame each follows, itself if it is active, shape (n,).

        What hangs together of the others is a region; one node alone is none, and what is held
        follows nobody.
        """
        root = np.arange(len(active))
        quiet = np.flatnonzero(~active & ~self._held)
        count, region = connected_components(self._graph[quiet][:, quiet], directed=False)
        first = np.full(count, len(active))
        np.minimum.at(first, region, quiet)
        root[quiet] = first[region]
        return root

    def beside(self, nodes: Flags) -> Flags:
        """These nodes and those that share a cell with them, (n,)."""
        return np.asarray(self._graph @ nodes > 0.0)

    def spread(self, root: Indices) -> sp.csr_matrix:
        """``E``: twists of all nodes from those of the nodes that others follow, (6 n, 6 l)."""
        leads, number = np.unique(root, return_inverse=True)
        offset = lie.se3_compose(lie.se3_inverse(self.H[root]), self.H[: len(root)])
        blocks = lie.se3_adjoint(lie.se3_inverse(offset))
        shape = (6 * len(root), 6 * len(leads))
        return sp.bsr_matrix((blocks, number, np.arange(len(root) + 1)), shape=shape).tocsr()

    def missed(self, root: Indices) -> Array:
        """How far each node goes elsewhere within τ under the worst of the loads, shape (n,)."""
        if (root == np.arange(len(root))).all():
            return np.zeros(len(root))
        E = self.spread(root)
        free = np.asarray(abs(E[self._free]).sum(axis=0)).ravel() > 0.0
        E = E[:, free]
        own = splu((E.T @ self._A @ E).tocsc()).solve(E.T @ self._b)
        away = (self._d - E @ own).reshape(-1, 6, self._d.shape[1])
        return np.asarray(np.linalg.norm(away[:, :3], axis=1).max(axis=1))

    def active(self, tolerance: float) -> Flags:
        """Nodes that need frames of their own, so that no other one goes elsewhere by more."""
        found: Flags = self._held.copy()
        for _ in range(_ROUNDS):
            away = self.missed(self.merged(found))
            more = ~found & (away > tolerance)
            if not more.any():
                break
            found[more] = True
        return found

    def projected(self, root: Indices) -> tuple[Array, float]:
        """Twists with merged frames that are nearest by mass, and the kinetic energy lost.

        Both momenta stay as they are, for rigid motions are among those of merged frames.
        """
        E, v = self.spread(root), self.v.ravel()
        own = splu((E.T @ self.mass @ E).tocsc()).solve(E.T @ (self.mass @ v))
        kept = E @ own
        lost = v - kept
        return kept.reshape(-1, 6), float(0.5 * lost @ (self.mass @ lost))


_QUIET = 0.1  # of the tolerance: what splits a region is larger than what lets it merge again
_AHEAD = 2.0  # stretches
_INSTANTS = 5  # at which loads are asked for between two looks
_LONGEST = 16  # of the shortest stretches, while nothing changes
_WAITING = 5  # shortest stretches for which what is merged has been quiet
_TRIES = 20  # for one stretch
_PART = 0.1  # of what is left of that, for one merging
_LOST = 1e-8  # of the kinetic energy: what all mergings together may take of it


class _State(NamedTuple):
    """Where a stretch begins: frames and twists of all nodes."""

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
    """Integrate with frames of quiet regions merged.

    Args:
        build: Makes the scene, each time anew: bodies whose nodes are frames, without joints.
        duration: End time.
        step: Of time.
        every: Shortest time between two changes, a multiple of the step.
        tolerance: How far a merged node may go elsewhere within two such times, a length.
        scheme: Default: ``GeneralisedAlpha()``.

    Raises:
        ValueError: The scene has joints, contacts or nodes that are no frames.
        ConvergenceError: A stretch failed.
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
        """Nothing has moved yet."""
        self._build, self._scheme, self._step = build, scheme, step
        self._every, self._tolerance = every, tolerance
        self._whole = _whole(build())
        self._again, self._lost = 0, 0.0

    def until(self, duration: float) -> MergedMotion:
        """From the beginning."""
        whole, start = self._whole, self._whole.start
        master_map = whole.system.numbering.master_map
        frames, twists = master_map.frames(start.frames), master_map.twists(start.velocities)
        look = self._looking(_State(whole.scene.began.time, frames, twists))
        end, span = look.state.time + duration, self._every
        active = look.active(self._tolerance)
        stretches: list[RegionStretch] = []
        while end - look.state.time > 0.5 * self._step:
            found = self._quiet(look, active, min(span, end - look.state.time))
            root = look.merged(found.active)
            stretches.append(_stretch(found, root, look.state.time, stretches))
            look, merged = found.look, not active.any()
            active = self._next(found)
            longer = min(2.0 * span, _LONGEST * self._every)
            span = longer if merged and not active.any() else _WAITING * self._every
        return MergedMotion(tuple(stretches), whole.unknowns.moving, self._again)

    def _quiet(self, look: _Look, active: Flags, span: float) -> _Found:
        """A stretch in which no merged node stirs, as far as there is none."""
        for _ in range(_TRIES):
            root = look.merged(active)
            result = self._moved(look, root, span)
            found = self._quiet_part(look, result, root, active)
            if found.rows:
                return found
            active, span = active | found.stirs, self._every
            self._again += 1
        raise ConvergenceError(f"no regions are quiet after time {look.state.time:g}")

    def _quiet_part(self, look: _Look, result: Result, root: Indices, active: Flags) -> _Found:
        """Up to the last look at which nothing merged has stirred."""
        found = _Found(result, 0, look, active, np.ones_like(active), np.zeros_like(active))
        every, last = round(self._every / self._step), len(result.times) - 1
        for row in [*range(every, last, every), last]:
            time = look.state.time + float(result.times[row])
            state = _State(time, result.frames[row], result.velocities[row])
            after = self._looking(state)
            stirred = (after.missed(root) > self._tolerance) & (root != np.arange(len(root)))
            if stirred.any():
                return found._replace(stirs=after.beside(stirred))
            if active.any():
                found = found._replace(calm=found.calm & ~after.active(_QUIET * self._tolerance))
            found = found._replace(rows=row, look=after)
        return found

    def _next(self, found: _Found) -> Flags:
        """Which nodes have frames of their own from now on."""
        look, active = found.look, found.active
        needed = look.active(self._tolerance) | found.stirs
        if found.rows * self._step < (_WAITING - 0.5) * self._every:
            return needed | active
        fewer = needed | (active & ~found.calm)
        _, lost = look.projected(look.merged(fewer))
        if lost > _PART * (_LOST - self._lost) * look.kinetic:
            return needed | active
        self._lost += lost / look.kinetic if lost > 0.0 else 0.0
        return fewer

    def _looking(self, state: _State) -> _Look:
        return _Look(self._whole, state, self._every)

    def _moved(self, look: _Look, root: Indices, span: float) -> Result:
        """From a state on, with merged frames."""
        scene, unknowns = self._build(), self._whole.unknowns
        master_map = self._whole.system.numbering.master_map
        twists = master_map.twists(look.projected(root)[0])
        masters = unknowns.masters[root[master_map.master]]
        for body, nodes in zip(scene.bodies, unknowns.bodies.values(), strict=True):
            place = np.full(unknowns.total, -1)
            place[nodes] = np.arange(len(nodes))
            body.masters = place[masters[nodes]]
            body.start_frames = look.state.frames[nodes]
            body.velocities[:] = twists[nodes]
        scene.began = Began(look.state.time)
        return self._scheme.run(scene, duration=span, step=self._step, progress=False)


class _Look(Looking):
    """With the state that is looked at."""

    def __init__(self, whole: Equations, state: _State, every: float) -> None:
        """See the base class; loads are those until the next look."""
        times = state.time + every * np.linspace(0.0, 1.0, _INSTANTS)
        super().__init__(whole, state.frames, state.twists, times, _AHEAD * every)
        self.state = state


class _Found(NamedTuple):
    """The quiet part of a stretch.

    Attributes:
        result: Of all of it.
        rows: Its last state in this part; 0: there is none.
        look: At that.
        active: Which nodes had frames of their own.
        calm: Which have been quiet at all looks.
        stirs: Merged ones that stirred behind it, and those beside them.
    """

    result: Result
    rows: int
    look: _Look
    active: Flags
    calm: Flags
    stirs: Flags


def _stretch(
    found: _Found, root: Indices, begin: float, before: Sequence[RegionStretch]
) -> RegionStretch:
    """With what the change did at its begin."""
    change, result = None, found.result
    if before:
        last, row = before[-1].result, before[-1].rows
        change = Transferred(
            (float(last.kinetic[row]), float(result.kinetic[0])),
            (float(last.elastic[row]), float(result.elastic[0])),
            np.array([last.momentum[row], result.momentum[0]]),
            np.array([last.angular_momentum[row], result.angular_momentum[0]]),
        )
    return RegionStretch(begin, result, found.rows, len(np.unique(root)), change)


def _whole(scene: Scene) -> Equations:
    """Equations without merged frames, or ``ValueError``."""
    require_scene(scene)
    equations = Equations(scene, dynamics=True)
    unknowns = equations.unknowns
    if unknowns.m or scene.contacts or unknowns.floating:
        raise ValueError("frames are merged in scenes without joints, contacts and reduced bodies")
    if any(body.node_type is not NodeType.FRAME for body in scene.bodies):
        raise ValueError("frames are merged, and nodes of some bodies are none")
    if equations.supports or scene.motions:
        raise ValueError("frames are merged in scenes without prescribed motions and turned axes")
    return equations
