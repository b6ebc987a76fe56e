"""One step of generalised-α on all nodes, compiled: prediction, correction, acceptance.

Each node moves on its own group, see :mod:`fem_lie.lie.node_types`. Velocities and accelerations
are those of the group; the twists in the nodes' frames, which enter the equations of motion, are
computed from them.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie.lie.node_types import (
    POSITION_GRADIENT,
    Written,
    all_from_local,
    move,
    tangent_inverse,
    to_group,
    to_local,
)
from fem_lie.lie.tuples import dot, load
from fem_lie.solve.alpha.step import node
from fem_lie.solve.alpha.step.node import PlainScheme, Scheme


class Motion(NamedTuple):
    """Parts of :attr:`State.motion`, each of shape (n, 6); at the end of the step with index 1.

    Attributes:
        v: Velocities of the group.
        vdot: Accelerations.
        a: Algorithmic accelerations.
        d: Increment of the step.
        v1: Velocities.
        vdot1: Accelerations.
        twist1: Twists in the nodes' frames.
        rate1: Rates of the twists.
    """

    v: Array
    vdot: Array
    a: Array
    d: Array
    v1: Array
    vdot1: Array
    twist1: Array
    rate1: Array


_RATES = {"vdot": "v", "a": "v", "vdot1": "v1", "rate1": "twist1"}

WRITTEN = Written(
    local=np.isin(Motion._fields, ("twist1", "rate1")),
    rate_of=np.array(
        [Motion._fields.index(_RATES[f]) if f in _RATES else -1 for f in Motion._fields]
    ),
)
"""How :attr:`State.motion` is written."""

TWISTS: Indices = np.flatnonzero(WRITTEN.local)
"""Which of :attr:`State.motion` are twists on any group."""


class State(NamedTuple):
    """Start of a step, and its end with index 1.

    Attributes:
        H: Frames of all nodes, ground and prescribed motions, (rows, 4, 3).
        H1: Those of the end.
        motion: :class:`Motion`, shape (8, n, 6); one array, because a compiled function takes the
            longer to call the more there are.
        kinds: What each node is, see :mod:`fem_lie.lie.node_types`, shape (n,).
        scaling: Weights in the size of increments, see :func:`~.convergence.node_scaling`, (n, 2).
        inverse: ``T⁻¹`` of each node, see :func:`to_increments`, (n, 6, 6).
    """

    H: Array
    H1: Array
    motion: Array
    kinds: Indices
    scaling: Array
    inverse: Array

    @classmethod
    def start(cls, frames: Array, kinds: Indices, scaling: Array) -> State:
        """At rest at ``frames``."""
        n = len(kinds)
        motion, inverse = np.zeros((len(Motion._fields), n, 6)), np.zeros((n, 6, 6))
        return cls(frames.copy(), frames.copy(), motion, kinds, scaling, inverse)

    def copy(self) -> State:
        """With arrays of its own, of the same nodes."""
        moved = self.H.copy(), self.H1.copy(), self.motion.copy()
        return self._replace(H=moved[0], H1=moved[1], motion=moved[2])

    @property
    def plain(self) -> PlainState:
        """As compiled functions are quicker to call with."""
        return (*self,)

    @property
    def v(self) -> Array:
        """Velocities of the group."""
        return self.motion[0]

    @property
    def vdot(self) -> Array:
        """Accelerations."""
        return self.motion[1]

    @property
    def a(self) -> Array:
        """Algorithmic accelerations."""
        return self.motion[2]

    @property
    def d(self) -> Array:
        """Increment of the step."""
        return self.motion[3]

    @property
    def v1(self) -> Array:
        """Velocities at the end of the step."""
        return self.motion[4]

    @property
    def twist1(self) -> Array:
        """Twists in the nodes' frames at the end of the step, or of the last one accepted."""
        return self.motion[6]

    @property
    def rate1(self) -> Array:
        """Rates of the twists at the end of the step."""
        return self.motion[7]

    def set_start(self, twist: Array, rate: Array) -> None:
        """Set ``v`` and ``v̇ = a`` from twists and their rates in the frames ``H``, (n, 6)."""
        all_from_local(self.kinds, self.H, twist, rate, self.v, self.vdot)
        self.twist1[:], self.rate1[:], self.a[:] = twist, rate, self.vdot

    def change_end(self, frames: Array, twists: Array, rates: tuple[Array, Array]) -> None:
        """Let an accepted step end otherwise.

        Args:
            frames: Of nodes, ground and prescribed motions, shape (r, 4, 3).
            twists: In the nodes' axes, shape (n, 6).
            rates: Rates of the twists that belong to the end as it is and to the other one, by
                whose difference accelerations change, each of shape (n, 6).
        """
        n = len(self.kinds)
        velocity, before, after = np.empty((3, n, 6))
        all_from_local(self.kinds, self.H, self.twist1, rates[0], velocity, before)
        all_from_local(self.kinds, frames, twists, rates[1], velocity, after)
        self.motion[0] = self.motion[4] = velocity
        for k in (1, 2, 5):
            self.motion[k] += after - before
        self.twist1[:] = twists
        self.rate1[:] += rates[1] - rates[0]
        self.H[:n] = self.H1[:n] = frames[:n]


PlainState: TypeAlias = tuple[Array, Array, Array, Indices, Array, Array]
"""A :class:`State` at the door from Python."""


@inlined
def parts(motion: Array) -> Motion:
    """Unpack ``motion`` (8, n, 6)."""
    return Motion(
        motion[0],
        motion[1],
        motion[2],
        motion[3],
        motion[4],
        motion[5],
        motion[6],
        motion[7],
    )


@compiled
def extrapolate(
    time: float, H: Array, motion: Array, kinds: Indices, later: Array, twist: Array
) -> None:
    """Frames and twists after ``time`` at constant accelerations, shapes (≥ n, 4, 3), (≥ n, 6)."""
    v, vdot = parts(motion).v, parts(motion).vdot
    d, w, rate = np.empty(6), np.empty(6), np.empty(6)
    for i in range(kinds.shape[0]):
        for k in range(6):
            d[k] = time * v[i, k] + 0.5 * time * time * vdot[i, k]
            w[k] = v[i, k] + time * vdot[i, k]
        move(kinds[i], H[i], d, later[i])
        to_local(kinds[i], later[i], w, vdot[i], twist[i], rate)


@uncounted
def predict(scheme: PlainScheme, state: PlainState) -> float:
    """Start a step with the old ``v̇``; returns the size of the largest motion of a node."""
    H, H1, motion, kinds, scaling, _ = state
    v, vdot, a, d, v1, vdot1, twist, rate = parts(motion)
    p, largest = Scheme(*scheme), 0.0
    for i in range(d.shape[0]):
        before, after = (v[i], vdot[i], a[i]), (H1[i], v1[i], vdot1[i])
        size = node.predict(p, kinds[i], scaling[i], H[i], *before, d[i], *after)
        largest = max(largest, size)
        to_local(kinds[i], H1[i], v1[i], vdot1[i], twist[i], rate[i])
    return largest


@compiled
def refer_to(d: Array, kinds: Indices, held: Indices, nodes: Indices, inverse: Array) -> None:
    """Set ``T⁻¹(d)`` of some nodes, by which corrections of their increments follow from twists.

    Of held unknowns the increments are zero. Zero twists instead would be a constraint that depends
    on the path, on the iterates of a step.

    Args:
        d: Increments, shape (n, 6).
        kinds: Types of the nodes.
        held: Which increments are held, shape (n, 6).
        nodes: The nodes; those with vector coordinates, whose ``T = 1``, are left out.
        inverse: ``T⁻¹`` of all nodes, shape (n, 6, 6), with zero rows of held increments.
    """
    for i in nodes:
        if kinds[i] < POSITION_GRADIENT:
            tangent_inverse(kinds[i], d[i], inverse[i])
            for k in range(6):
                if held[i, k]:
                    for j in range(6):
                        inverse[i, k, j] = 0.0


@uncounted
def to_increments(kinds: Indices, inverse: Array, x: Array) -> None:
    """Corrections of increments, in the nodes' axes, from a solution (≥ 6 n,), in place.

    The matrix refers to twists of the nodes, along which stiffness is what it is: ``T⁻¹(d)`` is
    that of the current increments for nodes of elements. Inertia is constant along increments:
    ``T⁻¹(d₀)`` is that of the factorisation for all others, of which it stays exact however fast
    they rotate later.
    """
    for i in range(kinds.shape[0]):
        if kinds[i] < POSITION_GRADIENT:
            T = inverse[i]
            u, w = load(x, 6 * i), load(x, 6 * i + 3)
            for k in range(3):
                x[6 * i + k] = dot(load(T[k], 0), u) + dot(load(T[k], 3), w)
                x[6 * i + 3 + k] = dot(load(T[3 + k], 3), w)


@uncounted
def correct(
    scheme: PlainScheme,
    state: PlainState,
    dx: Array,
    scale: Array,
    spread: Array,
    joined: Indices,
    multipliers: Array,
) -> float:
    """Apply a Newton correction, twists in the nodes' frames; returns the size of its largest part.

    Twists become corrections of increments in ``dx``, see :func:`to_increments`.
    """
    H, H1, motion, kinds, scaling, inverse = state
    _, _, _, d, v1, vdot1, twist, rate = parts(motion)
    p, largest = Scheme(*scheme), 0.0
    to_increments(kinds, inverse, dx)
    for i in range(d.shape[0]):
        x = dx[6 * i : 6 * i + 6]
        to_group(kinds[i], H1[i], x)
        size = node.correct(p, kinds[i], scaling[i], x, H[i], d[i], H1[i], v1[i], vdot1[i])
        if size > largest or size != size:  # nan stays
            largest = size
        to_local(kinds[i], H1[i], v1[i], vdot1[i], twist[i], rate[i])
    at, m, squares, first = 6 * d.shape[0], multipliers.shape[0], 0.0, 0
    for c in range(m):
        multipliers[c] -= scale[c] * dx[at + c]
        first = first if joined[c] else c
        # what the joint's forces move, by the matrix of the start
        part = 0.0
        for j in range(min(spread.shape[1], m - first)):
            part += spread[c, j] * dx[at + first + j]
        squares = part * part + (squares if joined[c] else 0.0)
        size = np.sqrt(squares)
        if size > largest or size != size:
            largest = size
    return largest


@uncounted
def change_velocities(state: PlainState, dx: Array) -> None:
    """Subtract ``dx`` (6 n,), in the nodes' frames, from the velocities at the end of the step."""
    _, H1, motion, kinds, _, _ = state
    _, _, _, _, v1, vdot1, twist, rate = parts(motion)
    for i in range(v1.shape[0]):
        x = dx[6 * i : 6 * i + 6]
        to_group(kinds[i], H1[i], x)
        for k in range(6):
            v1[i, k] -= x[k]
        to_local(kinds[i], H1[i], v1[i], vdot1[i], twist[i], rate[i])


@uncounted
def accept(scheme: PlainScheme, state: PlainState) -> None:
    """Make the end of the step the start of the next."""
    H, H1, motion, kinds, _, _ = state
    v, vdot, a, _, v1, vdot1, _, _ = parts(motion)
    p = Scheme(*scheme)
    for i in range(v.shape[0]):
        node.accept(p, kinds[i], v[i], vdot[i], a[i], H1[i], v1[i], vdot1[i])
    # with the prescribed frames; slices of arrays that might overlap are copied
    for i in range(H.shape[0]):
        for k in range(4):
            for j in range(3):
                H[i, k, j] = H1[i, k, j]
