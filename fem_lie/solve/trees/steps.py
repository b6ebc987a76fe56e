r"""Steps of Munthe-Kaas' Runge-Kutta scheme of order four on a tree of links, compiled.

The relative frame of each link moves along the group, ``X(t) = X_n exp(S θ)``, with::

    θ̇ = dexp⁻¹(θ) q̇        q̈ = q̈(X, q̇, t)

and ``θ``, ``q̇`` are integrated by the classical scheme of order four from ``θ = 0``. Joints with
columns that commute have ``θ̇ = q̇``. The first stage of the next step is the acceleration at the
end, and replaces the fourth stage in the embedded scheme of order three: with the slopes ``k`` the
two differ by ``h (k₄ − k₅)/6`` (Munthe-Kaas, Appl. Numer. Math. 29 (1999) 115; Hairer, Nørsett &
Wanner, Solving ODEs I, section II.4).
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, inlined_uncounted, linked, uncounted
from fem_lie._jit.copies import copy_vector
from fem_lie._jit.packed_arrays import (
    Frames,
    Integers1,
    Integers2,
    Numbers1,
    Numbers2,
    Numbers3,
    Sixes,
    unpacking,
)
from fem_lie._jit.stack import stack, vector_at
from fem_lie.bodies.balances import BY_LOADS, LOADS, REACTIONS
from fem_lie.joints.equations import terms
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays
from fem_lie.lie.series import Coefficients, blend, dual_blend, exponential
from fem_lie.lie.tuples import (
    Vector,
    add_wrench,
    combined,
    dot,
    load,
    load_frame,
    load_row,
    plus,
    rotate,
    store,
    store_row,
)
from fem_lie.solve.trees.elimination import (
    BALL,
    COMMUTING,
    FREE,
    Links,
    Motion,
    accelerations,
    inward,
    outward,
    wrench,
)
from fem_lie.system.nodes.sums import residual
from fem_lie.system.outer_forces import look_at

STAGES = 4
"""Number of stages; the one after them is the first of the next step."""

_TABLEAU = np.array(
    [
        [0.0, 0.0, 0.0, 0.0],
        [0.5, 0.0, 0.0, 0.0],
        [0.0, 0.5, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    ]
)
TIMES = 0.0, 0.5, 0.5, 1.0, 1.0
"""Times of the stages, over the step size."""


PlainOptions: TypeAlias = tuple[bool, bool, bool, bool, bool, bool]
"""Plain tuple of :class:`Options`."""


class Options(NamedTuple):
    """What a step has to do.

    Attributes:
        summed: Whether forces are one compiled sum.
        forced: Whether there are other forces than uniform gravity.
        balance: Whether external work and impulses are summed up.
        loads: Whether loads contribute to it.
        joints: Whether connections to ground and dampers do.
        turns: Whether joints count their turns.
    """

    summed: bool
    forced: bool
    balance: bool
    loads: bool
    joints: bool
    turns: bool


class Run(NamedTuple):
    """Arrays of a run; ``k`` links, ``d`` free columns, ``n`` nodes.

    Attributes:
        links: See :class:`~fem_lie.solve.trees.elimination.Links`.
        now: State of the present stage.
        X: Relative frames at the start of the step, (k, 4, 3).
        w: Rates ``q̇`` there, (d,).
        angle: ``θ`` of the present stage, (d,).
        zero: Zeros, (d,).
        slopes: ``θ̇`` and ``q̈`` of all stages, (5, 2, d).
        link: Link of each node, (n,).
        own: Frames of the nodes in those of their links, (n, 4, 3).
        spatial: Frames of the links in space, (k, 4, 3).
        H: Frames of all nodes and ground.
        v: Twists of the nodes, (n, 6).
        a: Their rates, (n, 6).
        rest: Zeros, (n, 6).
        none: Zeros, (m,).
        r: Residual, (6 n + m,).
        joints: Joint constraints and springs.
        probes: Coordinates in results.
        forces: Packed residual, see :func:`~fem_lie.system.nodes.sums.residual`.
        actions: See :func:`~fem_lie.system.outer_forces.look_at`.
        rows: External power, dissipation and resultants of all stages, (5, 14).
        ground: Workspace, forces on ground, (1, 6).
        total: Energy balance and impulses so far.
        pairs: Pairs of frames with constraints, (j,).
        wrenches: Link and side on which the force of each of them acts, (j, 2).
    """

    links: Links
    now: Motion
    X: Frames
    w: Numbers1
    angle: Numbers1
    zero: Numbers1
    slopes: Numbers3
    link: Integers1
    own: Frames
    spatial: Frames
    H: Frames
    v: Sixes
    a: Sixes
    rest: Sixes
    none: Numbers1
    r: Numbers1
    joints: PackedJoints
    probes: PackedJoints
    forces: Integers2
    actions: Integers2
    rows: Numbers2
    ground: Sixes
    total: Numbers1
    pairs: Integers1
    wrenches: Integers2


run_of = unpacking(Run)


@inlined
def twist_of(links: Links, q: Array, i: int) -> tuple[Vector, Vector]:
    """Combination of the columns of link ``i`` by the numbers ``q`` (d,)."""
    u = ω = (0.0, 0.0, 0.0)
    for k in range(links.first[i], links.first[i + 1]):
        s = links.columns[k]
        u, ω = combined(1.0, u, q[k], load(s, 0)), combined(1.0, ω, q[k], load(s, 3))
    return u, ω


@inlined_uncounted
def _move(links: Links, X0: Array, θ: Array, X: Array) -> None:
    """``X = X₀ exp(S θ)`` of all links."""
    for i in range(links.parent.shape[0]):
        x = load_row(X0[i], 0)
        d1, d2, d3 = load_row(X0[i], 1), load_row(X0[i], 2), load_row(X0[i], 3)
        if links.motion[i] == BALL:
            u, ω = (0.0, 0.0, 0.0), load(θ, links.first[i])
        elif links.motion[i] == FREE:
            u, ω = load(θ, links.first[i]), load(θ, links.first[i] + 3)
        else:
            u, ω = twist_of(links, θ, i)
        moved, r1, r2, r3 = exponential(u, ω)
        store_row(X[i], 0, plus(x, rotate(d1, d2, d3, moved)))
        store_row(X[i], 1, rotate(d1, d2, d3, r1))
        store_row(X[i], 2, rotate(d1, d2, d3, r2))
        store_row(X[i], 3, rotate(d1, d2, d3, r3))


@inlined
def _coefficients(x: float) -> tuple[Coefficients, Coefficients]:
    """Coefficients of ``dexp⁻¹`` and their derivatives, up to the fifth power of the angle.

    The scheme needs them up to the second; beyond a radian a step is inaccurate anyway.
    """
    e = 1.0 / 12.0 + x * (1.0 / 720.0 + x / 30240.0)
    de = 1.0 / 720.0 + x / 15120.0
    return (1.0 - x * e, 0.5, e), (-e - x * de, 0.0, de)


@inlined_uncounted
def _pull_back(links: Links, θ: Array, w: Array, out: Array) -> None:
    """``θ̇ = dexp⁻¹(θ) q̇`` of all links."""
    for i in range(links.parent.shape[0]):
        start, end = links.first[i], links.first[i + 1]
        if links.motion[i] == BALL:
            ω = load(θ, start)
            factors, _ = _coefficients(dot(ω, ω))
            store(out, start, blend(factors, ω, load(w, start)))
        elif links.motion[i] == COMMUTING:
            for k in range(start, end):
                out[k] = w[k]
        else:
            u, ω = twist_of(links, θ, i)
            v, spin = twist_of(links, w, i)
            both = _coefficients(dot(ω, ω))
            turned, moved = dual_blend(both[0], both[1], ω, u, spin, v)
            for k in range(start, end):
                s = links.columns[k]
                # columns of these subgroups are unit vectors
                out[k] = dot(load(s, 0), moved) + dot(load(s, 3), turned)


@inlined_uncounted
def _combine(slopes: Array, part: int, weights: Array, h: float, start: Array, out: Array) -> None:
    """``out = start + h Σ a k``."""
    for k in range(out.shape[0]):
        total = 0.0
        for stage in range(STAGES):
            total += weights[stage] * slopes[stage, part, k]
        out[k] = start[k] + h * total


@uncounted
def move_nodes(this: Run) -> None:
    """Frames of links and nodes in space, and twists of the nodes."""
    links, now = this.links, this.now
    for i in range(links.parent.shape[0]):
        p = links.parent[i]
        if p < 0:
            for k in range(4):
                store_row(this.spatial[i], k, load_row(now.X[i], k))
        else:
            lie.compose(this.spatial[p], now.X[i], this.spatial[i])
    for node in range(this.link.shape[0]):
        i = this.link[node]
        lie.compose(this.spatial[i], this.own[node], this.H[node])
        lie.apply_adjoint_inverse(this.own[node], now.v[i], this.v[node])


@uncounted
def _load(this: Run) -> None:
    """Forces of the nodes at rest, from their residual, on the links."""
    work = vector_at(stack(6), 6)
    for node in range(this.link.shape[0]):
        i, own = this.link[node], this.own[node]
        lie.apply_adjoint_inverse_transposed(own, this.r[6 * node : 6 * node + 6], work)
        for k in range(6):
            this.now.p[i, k] += work[k]


@uncounted
def place(table: Indices, how: PlainOptions, stage: int, h: float) -> None:
    """Frames and velocities of a stage; with other forces than gravity also those of all nodes."""
    this, options = run_of(table), Options(*how)
    links, now, weights = this.links, this.now, _TABLEAU[stage]
    _combine(this.slopes, 1, weights, h, this.w, now.w)
    _combine(this.slopes, 0, weights, h, this.zero, this.angle)
    _move(links, this.X, this.angle, now.X)
    _pull_back(links, this.angle, now.w, this.slopes[stage, 0])
    outward(links, now, not options.forced)
    if options.forced or options.balance:
        move_nodes(this)


@uncounted
def solve(table: Indices, how: PlainOptions, stage: int) -> None:
    """Accelerations of a stage, whose residual is known if the sum of forces is not compiled."""
    this, options = run_of(table), Options(*how)
    links, now, none = this.links, this.now, this.none
    if options.forced:
        if options.summed:
            residual(this.H, this.v, this.rest, none, none, this.r, this.forces)
        _load(this)
    inward(links, now)
    accelerations(links, now)
    copy_vector(now.rate, this.slopes[stage, 1])
    if options.balance:
        row, looks = this.rows[stage], (options.loads, options.joints)
        look_at(this.H, this.v, none, looks, row, this.ground, this.actions)
        _add_ground(this, row)


@uncounted
def _add_ground(this: Run, row: Array) -> None:
    """Add the forces of joints between ground and the first links."""
    links = this.links
    for i in range(links.parent.shape[0]):
        if links.parent[i] < 0 and links.first[i + 1] - links.first[i] < 6:
            f, m = wrench(this.now, i)
            x, d1, d2, d3 = load_frame(this.spatial[i])
            add_wrench(row, REACTIONS, x, rotate(d1, d2, d3, f), rotate(d1, d2, d3, m))


@linked
def add_ground(table: Indices, stage: int) -> None:
    """Add the forces of joints between ground and the first links to the row of a stage."""
    this = run_of(table)
    _add_ground(this, this.rows[stage])


@uncounted
def close(table: Indices, how: PlainOptions, h: float) -> None:
    """Make the last stage the start of the next step."""
    this, options = run_of(table), Options(*how)
    now, slopes = this.now, this.slopes
    for i in range(now.X.shape[0]):
        lie.reorthonormalise(now.X[i])
        for k in range(4):
            store_row(this.X[i], k, load_row(now.X[i], k))
    copy_vector(now.w, this.w)
    copy_vector(now.w, slopes[0, 0])
    copy_vector(slopes[STAGES, 1], slopes[0, 1])
    for k in range(this.rows.shape[1]):
        total = 0.0
        for stage in range(STAGES):
            total += _TABLEAU[STAGES, stage] * this.rows[stage, k]
        this.total[k if k < LOADS else k + BY_LOADS - LOADS] += h * total
    copy_vector(this.rows[STAGES], this.rows[0])
    if options.turns:
        move_nodes(this)
        terms.unwrap(this.H, joint_arrays(this.joints))
        terms.unwrap(this.H, joint_arrays(this.probes))


@linked
def advance(table: Indices, how: PlainOptions, h: float, count: int) -> None:
    """Make ``count`` steps of size ``h``, whose forces are a compiled sum."""
    for _ in range(count):
        for stage in range(1, STAGES + 1):
            place(table, how, stage, h)
            solve(table, how, stage)
        close(table, how, h)
