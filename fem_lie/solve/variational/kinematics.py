"""Unknowns of a step along the axes of its midpoint, and its kinematics; compiled.

A frame moves in a step by a translation ``u`` and the rotation ``cay(ψ)``, both in global
components, and a node with vector coordinates by increments of these, the *step* (n, 6). With the
half rotation ``a``, ``cay(a)² = cay(ψ)``, midpoint frames are::

    x̄ = x₀ + ½ u,   R̄ = cay(a) R₀,      φ̄ = ½ (φ₀ + φ₁) + ¼ a × (φ₀ − φ₁)

for rotations φ at the ends. The unknowns of the iteration are twice the motions of the midpoint
along its axes, ``R̄ᵀ(δu, 2 δφ̄)``. Forces act on midpoint frames and depend on these only, so that
the stiffness in these unknowns is that of the elements in their own axes, which does not change
while a body rotates, however far it rotates in a step. The equations of a node are multiplied by
the inverse of the map by which moments on the midpoint act at the start, and are along the same
axes: the matrix is as symmetric as the stiffness. Along axes of the start of the step, which lag
behind by half of the rotation in a step, stiff directions of a slender beam get a fraction of it in
soft ones, and a free beam needs a new matrix in each step. With midpoints of screw motions, of
which elements that rotate steadily are not extended, the matrix is as constant, but steps of the
spin-up of Simo & Vu-Quoc (J. Appl. Mech. 53 (1986) 855) do not converge: 2759 of 4000 were divided,
with exact matrices as well.

The motion is predicted from the twists of the last two steps along the axes of their midpoints,
which are constant if a body rotates steadily. Coordinate vectors of other nodes are extrapolated in
global components.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.lie.node_types.node_type import (
    POSITION_GRADIENT,
    add_increment,
    axes,
    axes_spin,
    first_vector,
    vector_count,
)
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.solve.conserving.midpoint.cayley import half, mean_of, span, turned


@inlined
def is_frame(kind: int) -> bool:
    """Whether nodes of this type are frames."""
    return kind < POSITION_GRADIENT


@inlined
def free_components(a: Vector, held: Flags | Indices, at: int) -> Vector:
    """Components along the axes of a node without those that are held."""
    return (
        0.0 if held[at] else a[0],
        0.0 if held[at + 1] else a[1],
        0.0 if held[at + 2] else a[2],
    )


@inlined
def free_part(kind: int, H: Array, held: Flags | Indices, at: int, a: Vector) -> Vector:
    """A vector in global components without those along held axes of the node ``H``."""
    if not (held[at] or held[at + 1] or held[at + 2]):
        return a
    d1, d2, d3 = axes(kind, H)
    return rotate(d1, d2, d3, free_components(rotate_back(d1, d2, d3, a), held, at))


@compiled
def hold(kinds: Indices, H: Array, held: Flags | Indices, step: Array) -> None:
    """Remove components that are held along the axes of the nodes ``H`` from steps (n, 6)."""
    for i in range(step.shape[0]):
        for at in (0, 3):
            store(step[i], at, free_part(kinds[i], H[i], held[i], at, load(step[i], at)))


@compiled
def between(
    kinds: Indices,
    H: Array,
    step: Array,
    coordinates: tuple[Array, Array, Array, Array],
    h: float,
    twists: Array,
) -> None:
    """Kinematics over a step, and the velocities at its midpoint.

    Args:
        kinds: Types of the nodes, (n,).
        H: Nodes at the start, (≥ n, 4, 3).
        step: Translation and rotation of each frame in global components, increments of both
            coordinate vectors of other nodes, (n, 6).
        coordinates: Increments, means, ends and midpoint nodes, (≥ n, 4, 3), overwritten.
        h: Step size.
        twists: Velocities, (≥ n, 6); those of the moving nodes are overwritten.
    """
    delta, mean, end, middle = coordinates
    span(H, step, delta, mean, end, middle)
    for i in range(step.shape[0]):
        if not is_frame(kinds[i]):
            _span_vectors(kinds[i], H[i], step[i], (delta[i], mean[i], end[i], middle[i]))
        d1, d2, d3 = axes(kinds[i], middle[i])
        for at in (0, 3):
            store(twists[i], at, rotate_back(d1, d2, d3, scaled(1.0 / h, load(step[i], at))))


@compiled
def _span_vectors(
    kind: int, H: Array, step: Array, coordinates: tuple[Array, Array, Array, Array]
) -> None:
    """Increments, mean, end and midpoint of one node with vector coordinates."""
    delta, mean, end, middle = coordinates
    half, at = 0.5 * step, first_vector(kind)
    add_increment(kind, H, half, middle)
    add_increment(kind, H, step, end)
    mean[:], delta[:] = middle, 0.0
    for k in range(vector_count(kind)):
        store_row(delta, at + k, load(step, 3 * k))


# --- rates: twists of the last two steps, which predict the next one ---


@compiled
def set_rates(
    kinds: Indices, H: Array, v: Array, acceleration: Array, h: float, rates: Array
) -> None:
    """Set the rates of the last two steps to those of a uniform acceleration.

    Args:
        kinds: Types of the nodes, (n,).
        H: Nodes, (≥ n, 4, 3).
        v: Their twists along their axes, (n, 6).
        acceleration: Rates of the twists, (n, 6).
        h: Step size.
        rates: Twists of frames along their axes, rates of the coordinate vectors of other nodes in
            global components, of the last step and the one before, (2, n, 6), overwritten.
    """
    for i in range(kinds.shape[0]):
        d1, d2, d3 = axes(kinds[i], H[i])
        spin = axes_spin(kinds[i], H[i], load(v[i], 3))
        for at in (0, 3):
            w, a = load(v[i], at), load(acceleration[i], at)
            if not is_frame(kinds[i]):
                a = rotate(d1, d2, d3, plus(a, cross(spin, w)))
                w = rotate(d1, d2, d3, w)
            store(rates[0, i], at, combined(1.0, w, -0.5 * h, a))
            store(rates[1, i], at, combined(1.0, w, -1.5 * h, a))


@compiled
def keep_rates(kinds: Indices, step: Array, twists: Array, h: float, rates: Array) -> None:
    """Make the rates of the current step the last ones.

    Args:
        kinds: Types of the nodes, (n,).
        step: The step, (n, 6).
        twists: Velocities at its midpoint, see :func:`between`.
        h: Step size.
        rates: See :func:`set_rates`; updated.
    """
    for i in range(kinds.shape[0]):
        for k in range(6):
            rates[1, i, k] = rates[0, i, k]
            rates[0, i, k] = twists[i, k] if is_frame(kinds[i]) else step[i, k] / h


@compiled
def predict(
    kinds: Indices, H: Array, held: Flags | Indices, rates: Array, h: float, step: Array
) -> None:
    """Step with linearly extrapolated rates, (n, 6).

    Args:
        kinds: Types of the nodes, (n,).
        H: Nodes at the start, (≥ n, 4, 3).
        held: Which unknowns are zero, (n, 6).
        rates: See :func:`set_rates`.
        h: Step size.
        step: See :func:`between`; overwritten.
    """
    for i in range(kinds.shape[0]):
        u = combined(2.0 * h, load(rates[0, i], 0), -h, load(rates[1, i], 0))
        ψ = combined(2.0 * h, load(rates[0, i], 3), -h, load(rates[1, i], 3))
        if is_frame(kinds[i]):
            d1, d2, d3 = axes(kinds[i], H[i])
            # the rotation vector has the same components in frames at the start and midpoint
            ψ = rotate(d1, d2, d3, ψ)
            u = turned(half(ψ), rotate(d1, d2, d3, u))
        store(step[i], 0, u)
        store(step[i], 3, ψ)
    hold(kinds, H, held, step)


@compiled
def at_end(
    kinds: Indices,
    H: Array,
    held: Flags | Indices,
    rates: Array,
    h: float,
    out: tuple[Array, Array],
) -> None:
    """Twists and their rates at the end of the last step, of a line through the last two.

    Args:
        kinds: Types of the nodes, (n,).
        H: Nodes at the end, (≥ n, 4, 3).
        held: Which unknowns are zero, (n, 6).
        rates: See :func:`set_rates`.
        h: Step size.
        out: Twists along the axes of the nodes, and their rates, (n, 6); overwritten.
    """
    v, change = out
    for i in range(kinds.shape[0]):
        d1, d2, d3 = axes(kinds[i], H[i])
        for at in (0, 3):
            last, earlier = load(rates[0, i], at), load(rates[1, i], at)
            w = combined(1.5, last, -0.5, earlier)
            a = scaled(1.0 / h, minus(last, earlier))
            if not is_frame(kinds[i]):
                w, a = rotate_back(d1, d2, d3, w), rotate_back(d1, d2, d3, a)
            store(v[i], at, free_components(w, held[i], at))
            store(change[i], at, free_components(a, held[i], at))
        if not is_frame(kinds[i]):
            spin = axes_spin(kinds[i], H[i], load(v[i], 3))
            for at in (0, 3):
                turning = cross(spin, load(v[i], at))
                store(change[i], at, minus(load(change[i], at), turning))


@compiled
def rotate_axes(kinds: Indices, before: Array, after: Array, rates: Array) -> None:
    """Rotate rates of frames together with their axes; positions keep their velocities.

    Args:
        kinds: Types of the nodes, (n,); other nodes are left unchanged.
        before: Nodes with their old axes, (≥ n, 4, 3).
        after: The same with their new axes.
        rates: See :func:`set_rates`; updated.
    """
    for i in range(kinds.shape[0]):
        if is_frame(kinds[i]):
            d1, d2, d3 = axes(kinds[i], before[i])
            e1, e2, e3 = axes(kinds[i], after[i])
            for k in range(2):
                u = rotate(d1, d2, d3, load(rates[k, i], 0))
                store(rates[k, i], 0, rotate_back(e1, e2, e3, u))


# --- unknowns ---


@inlined
def to_midpoint(kind: int, middle: Array, ψ: Vector, at: int, a: Vector) -> Vector:
    """An equation of the momenta at the start, in global components, in that of the unknowns.

    Args:
        kind: Type of the node.
        middle: The node at the midpoint, (4, 3).
        ψ: Its rotation in the step; only that of frames is used.
        at: 0 for translations or the first coordinate vector, 3 for rotations or the second.
        a: Force or moment.
    """
    if at == 3 and is_frame(kind):
        a = mean_of(half(ψ), a)
    d1, d2, d3 = axes(kind, middle)
    return rotate_back(d1, d2, d3, a)


@inlined
def _rotation_of(ψ: Vector, x: Vector) -> Vector:
    """Change of ``ψ`` if the midpoint frame rotates by ``½ x``, all in global components."""
    a = half(ψ)
    quarter = 0.25 * dot(a, a)
    s = 1.0 / (1.0 - quarter)
    along = (0.25 + 0.5 * s * (1.0 + quarter)) * dot(a, x)
    return scaled(s, plus(combined(1.0, x, -0.5, cross(a, x)), scaled(along, a)))


@compiled
def correct(
    kinds: Indices, H: Array, middle: Array, held: Flags | Indices, x: Array, step: Array
) -> None:
    """Subtract a solution from the step.

    Args:
        kinds: Types of the nodes, (n,).
        H: Nodes at the start, (≥ n, 4, 3).
        middle: Nodes at the midpoint of the step, (≥ n, 4, 3).
        held: Which unknowns are zero, (n, 6).
        x: Twice the motion of the midpoint along its axes, (≥ 6 n,).
        step: See :func:`between`; updated.
    """
    for i in range(step.shape[0]):
        d1, d2, d3 = axes(kinds[i], middle[i])
        u, ψ = load(step[i], 0), load(step[i], 3)
        moved = rotate(d1, d2, d3, load(x, 6 * i))
        rotated = rotate(d1, d2, d3, load(x, 6 * i + 3))
        if is_frame(kinds[i]):
            rotated = _rotation_of(ψ, rotated)
        store(step[i], 0, minus(u, moved))
        store(step[i], 3, minus(ψ, rotated))
    hold(kinds, H, held, step)


@compiled
def maps(kinds: Indices, nodes: Array, middle: Array, out: Array) -> None:
    """Maps from the unknowns to the motions of the nodes at one end of a step, along their axes.

    With ``C`` between the axes of the midpoint and of the end they are ``C`` for translations and
    coordinate vectors, and ``½ (1 + C)`` for rotations. For the start they are the transposes of
    the maps from forces on the nodes there to rows of the equations.

    Args:
        kinds: Types of the nodes, (n,).
        nodes: Nodes at the end, or at the start, (≥ n, 4, 3).
        middle: Nodes at the midpoint, (≥ n, 4, 3).
        out: The maps, (n, 2, 3, 3), overwritten.
    """
    for i in range(kinds.shape[0]):
        d1, d2, d3 = axes(kinds[i], nodes[i])
        e1, e2, e3 = axes(kinds[i], middle[i])
        for k, own in enumerate((d1, d2, d3)):
            row = rotate_back(e1, e2, e3, own)
            store_row(out[i, 0], k, row)
            store_row(out[i, 1], k, row)
        if is_frame(kinds[i]):
            out[i, 1] *= 0.5
            for k in range(3):
                out[i, 1, k, k] += 0.5


@inlined
def shares(ψ: Vector, m: Vector) -> tuple[Vector, Vector]:
    """Twice the moments at both ends that are equivalent to a moment on the midpoint frame.

    It rotates by ``½(φ₀ + φ₁) + ¼ a × (φ₀ − φ₁)``.
    """
    across = scaled(0.5, cross(half(ψ), m))
    return combined(1.0, m, -1.0, across), plus(m, across)


@inlined
def shares_of_director(start: Array, middle: Array, end: Array, m: Vector) -> tuple[Vector, Vector]:
    """The same for a director node, ``d̄ = (d₀ + d₁)/|d₀ + d₁|``."""
    d0, d, d1 = load_row(start, 3), load_row(middle, 3), load_row(end, 3)
    whole = plus(d0, d1)
    g = scaled(2.0 / np.sqrt(dot(whole, whole)), cross(m, d))
    return cross(d0, g), cross(d1, g)
