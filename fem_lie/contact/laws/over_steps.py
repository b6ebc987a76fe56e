"""Contact forces of a step whose work equals the change of the potential exactly.

With ``U`` the potential of a gap, an overline for the mean of both ends of the step and ``Δ`` for
differences over the step, distances and gaps are quadratic or bilinear in the nodal coordinates, so
that these relations are exact::

    balls    d₁² − d₀² = 2 Δ̄·δΔ,  Δg = ±(d₁² − d₀²)/(d₀ + d₁),  F = ± σ 2 Δ̄/(d₀ + d₁)
    plane    Δg = n̄·δΔ + δn·Δ̄,                                  F = σ n̄
    surface  Δg = G·ΔX,  ΔX = R̄ᵀ δΔ + δRᵀ Δ̄,                    F = σ R̄ G
    all      σ = ΔU/Δg = ½ k (g₀ + g₁) where both ends overlap, else (U₁ − U₀)/Δg

``G`` is the discrete gradient of a gap function; it is constant for a plane. A force ``F`` with the
moment arms of the mean configuration has zero resultant and zero moment, and does the work ``ΔU``.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, inlined_uncounted, uncounted
from fem_lie.contact.sides.gap_functions import mean_gradient, position_in, turned
from fem_lie.contact.sides.kinematics import contact_point, displacement, position, sign_of
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import (
    GROUND,
    LEVEL,
    ROUND,
    UNUSED,
    ContactPoints,
    Side,
    contact_points_of,
)
from fem_lie.forms.abilities import Ends
from fem_lie.lie.motions import global_components
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.lie.tuples import Vector, cross, dot, load, load_row, minus, plus, scaled, store

_KNOWN = 1e-13
"""Relative difference of potentials that is larger than round-off."""

_MOST = 1.0
"""Largest relative change of a force that corrects the work of a step: none becomes a tension."""


class Secant(NamedTuple):
    """Secant of the potential of one pair of points over a step.

    Attributes:
        σ: ``ΔU/Δg`` for unit stiffness.
        by_gap: Twice its derivative in the gap at the end.
        start: Potential at the start for unit stiffness.
        end: Potential at the end for unit stiffness.
        change: Change of the gap.
    """

    σ: float
    by_gap: float
    start: float
    end: float
    change: float


class Secants(NamedTuple):
    """Secants of all pairs of points, the fields of :class:`Secant`, each of shape (m,)."""

    σ: Array
    by_gap: Array
    start: Array
    end: Array
    change: Array


Both: TypeAlias = tuple[ContactPoints, ...]
"""Contact points at the start of a step, and at its end if these are other material points."""


@inlined
def secants(space: Array) -> Secants:
    """Secants of ``m`` pairs in a space of shape (5, m)."""
    return Secants(space[0], space[1], space[2], space[3], space[4])


def empty_secants(m: int) -> Secants:
    """Uninitialised secants of ``m`` pairs."""
    return Secants(*np.empty((5, m)))


_OPEN, _NONE = Secant(0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
"""Secant and vectors of a pair without contact at either end."""


@inlined_uncounted
def secant(g0: float, g1: float, change: float) -> Secant:
    """Secant between gaps ``g0`` and ``g1`` that differ by ``change``."""
    a, b = min(g0, 0.0), min(g1, 0.0)
    U0, U1 = 0.5 * a * a, 0.5 * b * b
    if a < 0.0 and b < 0.0:
        return Secant(0.5 * (a + b), 1.0, U0, U1, change)
    if change == 0.0:
        return Secant(0.0, 0.0, U0, U1, change)
    if b < 0.0:
        return Secant(U1 / change, 2.0 * (b - U1 / change) / change, U0, U1, change)
    return Secant(-U0 / change, 2.0 * U0 / (change * change), U0, U1, change)


@inlined_uncounted
def _between(ends: Ends, at: ContactPoints, e: int) -> tuple[Secant, Vector, Vector]:
    """Secant of a pair, direction ``F/σ``, and mean position of the point of the first side."""
    i, j = at.pairs[e]
    g0 = contact_point(ends.start, at.a, at.b, i, j, at.kind).gap
    g1 = contact_point(ends.end, at.a, at.b, i, j, at.kind).gap
    if g0 >= 0.0 and g1 >= 0.0:
        return _OPEN, _NONE, _NONE
    P, Q = position(ends.mean, at.a, i), position(ends.mean, at.b, j)
    moved = minus(displacement(ends.delta, at.a, i), displacement(ends.delta, at.b, j))
    separation = minus(P, Q)
    if at.kind == ROUND:
        sign, reach = sign_of(at.b, j), at.a.radii[i] + at.b.radii[j]
        n = scaled(2.0 * sign / (sign * (g0 + g1 + 2.0 * reach)), separation)
        return secant(g0, g1, dot(n, moved)), n, P
    m = load_row(at.b.normals, j)
    if at.kind == LEVEL:
        m = _mean_normal(ends, at, i, j, moved, separation)
    n, change = turned(ends.mean, at.b, j, m), 0.0
    if at.b.nodes[j, 0] != GROUND:
        change = dot(turned(ends.delta, at.b, j, m), separation)
    return secant(g0, g1, dot(n, moved) + change), n, P


@uncounted
def _mean_normal(
    ends: Ends, at: ContactPoints, i: int, j: int, moved: Vector, separation: Vector
) -> Vector:
    """Discrete gradient of a gap function, in the frame of the surface."""
    before = minus(position(ends.start, at.a, i), position(ends.start, at.b, j))
    after = minus(position(ends.end, at.a, i), position(ends.end, at.b, j))
    change = position_in(ends.mean, at.b, j, moved)
    if at.b.nodes[j, 0] != GROUND:
        change = plus(change, position_in(ends.delta, at.b, j, separation))
    X0, X1 = position_in(ends.start, at.b, j, before), position_in(ends.end, at.b, j, after)
    return mean_gradient(at.b, j, X0, X1, change)


@inlined_uncounted
def add_force(
    mean: Array,
    types: Indices,
    side: Side,
    i: int,
    foot: tuple[bool, Vector],
    F: Vector,
    out: Array,
    ground: Array,
) -> None:
    """Add a force on a point to forces and moments of nodes, or of ground about the origin.

    Args:
        mean: Mean nodal coordinates.
        types: Types of all nodes.
        side: The side.
        i: The point.
        foot: Whether the force acts at another position on the first node, and this position.
        F: The force.
        out: Updated.
        ground: Updated.
    """
    for k in range(MOST_NODES):
        node = side.nodes[i, k]
        if node == UNUSED:
            break
        c, at_foot = load_row(side.arms[i], k), foot[0]
        f = F if at_foot else scaled(side.weights[i, k], F)
        if node == GROUND:
            store(ground, 0, plus(load(ground, 0), f))
            store(ground, 3, plus(load(ground, 3), cross(foot[1] if at_foot else c, F)))
            continue
        turning = scaled(c[0], F)
        if types[node] < POSITION_GRADIENT:
            x = load_row(mean[node], 0)
            arm = minus(foot[1], x) if at_foot else global_components(mean[node], c)
            turning = cross(arm, F)
        store(out[node], 0, plus(load(out[node], 0), f))
        store(out[node], 3, plus(load(out[node], 3), turning))


@inlined_uncounted
def _store(secant: Secant, out: Secants, e: int) -> None:
    out.σ[e], out.by_gap[e] = secant.σ, secant.by_gap
    out.start[e], out.end[e], out.change[e] = secant.start, secant.end, secant.change


@uncounted
def _set_secants(ends: Ends, at: ContactPoints, out: Secants) -> None:
    for e in range(at.pairs.shape[0]):
        secant, _, _ = _between(ends, at, e)
        _store(secant, out, e)


@uncounted
def _energies(at: ContactPoints, found: Secants) -> tuple[float, float]:
    """Potentials at the start and at the end for unit stiffness."""
    start, end = 0.0, 0.0
    for e in range(at.pairs.shape[0]):
        start += at.weight[e] * found.start[e]
        end += at.weight[e] * found.end[e]
    return start, end


@uncounted
def _work(at: ContactPoints, found: Secants) -> tuple[float, float, float]:
    """Work of forces for unit stiffness, its square over pairs, and the largest of a pair."""
    work, square, most = 0.0, 0.0, 0.0
    for e in range(at.pairs.shape[0]):
        own = at.weight[e] * found.σ[e] * found.change[e]
        work, square, most = work + own, square + own * own, max(most, abs(own))
    return work, square, most


@uncounted
def _scale(found: Secants, factor: float, at: ContactPoints, part: float) -> None:
    """Multiply forces by a factor, and change them in proportion to the works they have then."""
    for e in range(at.pairs.shape[0]):
        own = factor * at.weight[e] * found.σ[e] * found.change[e]
        factors = factor * (1.0 + part * own)
        found.σ[e] *= factors
        found.by_gap[e] *= factors


@uncounted
def _weigh(both: Both, found: tuple[Secants, ...]) -> None:
    """Multiply forces at the contact points of both ends by factors, so that they do the work.

    Along curves and patches the closest points at the end differ from the material points that were
    closest at the start, so a secant at fixed material points underestimates the overlap at one
    end: at the end of the step for the closest points of the start, and at the start for the
    closest points of the end. A weighted mean of both sets of forces does exactly the work
    ``U₁ − U₀``, with moment arms of actual material points.

    Where parts of curves begin or cease to overlap, integration points of one end are not those of
    the least overlap at the other one, and a mean may not do. Then the forces are changed in
    proportion to their works, which is the smallest change that does the missing work. The
    resultant and the moment of each pair of forces vanish, so any factors conserve momenta.
    """
    last = len(both) - 1
    U0, lower_end = _energies(both[0], found[0])
    lower_start, U1 = _energies(both[last], found[last])
    by_start, by_end = U0 - lower_start, U1 - lower_end
    fraction = 0.5
    if by_start + by_end > _KNOWN * (U0 + U1):
        fraction = min(1.0, max(0.0, by_start / (by_start + by_end)))
    a, b = fraction, 1.0 - fraction
    work, square, most = _work(both[0], found[0])
    of_end, square_of_end, most_of_end = _work(both[last], found[last])
    missing = U1 - U0 - (a * work + b * of_end)
    square = a * a * square + b * b * square_of_end
    most = abs(missing) * max(a * most, b * most_of_end)
    little = abs(missing) <= _KNOWN * (U0 + U1)
    part = 0.0 if little or most >= _MOST * square else missing / square
    _scale(found[0], a, both[0], part)
    _scale(found[last], b, both[last], part)


@uncounted
def _set_all(ends: Ends, both: Both, found: tuple[Secants, ...]) -> None:
    for n in range(len(both)):
        _set_secants(ends, both[n], found[n])
    if len(both) > 1:
        _weigh(both, found)


@uncounted
def _add(
    ends: Ends, types: Indices, at: ContactPoints, k: float, found: Secants, out: Array, on: Array
) -> None:
    for e in range(at.pairs.shape[0]):
        if found.σ[e] == 0.0:
            continue
        _, n, P = _between(ends, at, e)
        F = scaled(at.weight[e] * k * found.σ[e], n)
        i, j = at.pairs[e]
        add_force(ends.mean, types, at.a, i, (False, P), F, out, on)
        foot = at.kind != ROUND, P
        add_force(ends.mean, types, at.b, j, foot, scaled(-1.0, F), out, on)


@uncounted
def _add_forces(
    ends: Ends,
    types: Indices,
    both: Both,
    k: float,
    found: tuple[Secants, ...],
    out: Array,
    ground: Array,
) -> tuple[float, float]:
    """Set secants, add forces, and return the stored energy and the work."""
    _set_all(ends, both, found)
    work, last = 0.0, len(both) - 1
    for n in range(len(both)):
        _add(ends, types, both[n], k, found[n], out, ground)
        work += k * _work(both[n], found[n])[0]
    return k * _energies(both[last], found[last])[1], work


@compiled
def add_of_start(
    ends: Ends,
    types: Indices,
    tables: tuple[Indices, ...],
    k: float,
    out: Array,
    ground: Array,
) -> tuple[float, float]:
    """Add the contact forces of the step to the residual.

    Args:
        ends: Both ends of the step.
        types: Types of all nodes.
        tables: Table of the contact points, which are the same material points at the end.
        k: Stiffness.
        out: Forces and moments about the mean positions of all nodes, global components, (N, 6).
        ground: Force and moment about the origin on ground, (6,).

    Returns:
        The energy that is stored at the end, and the work that is stored over the step.
    """
    at = contact_points_of(tables[0])
    found = secants(np.empty((5, at.pairs.shape[0])))
    return _add_forces(ends, types, (at,), k, (found,), out, ground)


@compiled
def add_of_both_ends(
    ends: Ends,
    types: Indices,
    tables: tuple[Indices, ...],
    k: float,
    out: Array,
    ground: Array,
) -> tuple[float, float]:
    """As :func:`add_of_start`, with other material points at the end.

    ``tables`` are those of the contact points at the start and at the end.
    """
    both = contact_points_of(tables[0]), contact_points_of(tables[1])
    start = secants(np.empty((5, both[0].pairs.shape[0])))
    end = secants(np.empty((5, both[1].pairs.shape[0])))
    return _add_forces(ends, types, both, k, (start, end), out, ground)


@compiled
def set_secants(ends: Ends, both: Both, found: tuple[Secants, ...]) -> None:
    """Set the secants of all pairs for unit stiffness, with the factors of the forces."""
    _set_all(ends, both, found)
