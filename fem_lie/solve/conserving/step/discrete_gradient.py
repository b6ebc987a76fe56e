"""Elastic forces of a step that do exactly the work by which the stored energy changes.

For *any* element with an objective energy ``W``, known by its energy and its nodal forces at both
ends of the step alone. Nodal forces and moments conjugate to ``(Δx, ψ)`` are, for one element::

    f = P [ C ½ (Q f₀ + Qᵀ f₁) ] + (ΔW − f·s)/|s|² M s

1. *Mean.* The element's rigid part of the step, translation and rotation ω, is fitted to its nodes
   in a metric ``M`` (1 on translations, a length squared on rotations). ``Q = cay(ω)^½`` turns the
   forces of both ends half-way. Means of positions and directors that turn are shrunk by ``C = ½(Q
   + Qᵀ)``, and what is left of an increment beside a rotation of the mean is ``C⁻¹`` times the
   deformation; so forces are shrunk (moments, whose ψ has ``C⁻¹`` and ``1 + ¼|ω|²``, get both), and
   the work of the mean is exact to third order in the *deformation* of the step, whatever its
   rotation. Else it had an error of second order, as large as ``|ω|²/4`` of the whole.
2. *Balance.* ``P`` takes out what net force and moment the mean has: ``M`` times a rigid motion, so
   the sum of forces, and of moments about the mean configuration, is zero to round-off.
3. *Energy.* ``s`` is the step without its rigid part: ``M s`` has no net force and no net moment,
   and the factor, Gonzalez' discrete gradient (J. Nonlinear Sci. 6 (1996) 449) in the quotient by
   rigid motions, makes the work ``ΔW``. It is of third order, zero for quadratic energies of
   strains without rotation in the element, and regular where ``s`` vanishes.

So linear and angular momentum and energy are exact for every element. For strains quadratic in the
nodes' coordinates, the mean is that of Simo, Tarnow & Doblaré (IJNME 38 (1995) 1431), stress from
both ends, lever from the mean configuration, to third order.

``W`` itself has round-off: the ulp of positions times the force; and of the scene's energy no less
can be told than the element's part of an ulp. Below that the factor would be noise, and the
iteration would not settle. So it acts on what is beyond, and each element has an account of the
work that was done on it: when energy and account differ by more than round-off at the start of a
step, the step makes that up. Nothing adds up. Where an element deforms much less in a step than
others do, or by less than positions can show, its part of round-off waits for a step in which it
deforms more: divided by a small ``s``, whose sign is open, it would be no function of the motion.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.forms.cells import CellTable
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
    scaled,
    store,
)
from fem_lie.solve.conserving.step.cayley import half, turned

ROUND_OFF = 16 * float(np.finfo(np.float64).eps)
"""Relative error of positions and energies."""
KNOWN = 16.0
"""Errors of energies from which the energy of a single step counts as known."""


class Ends(NamedTuple):
    """Both ends of a step.

    Attributes:
        H0: Frames of all nodes at the start, (N, 4, 3).
        H1: At the end.
        F0: Forces of all elements at the start, in the frames of their nodes, (places, 6).
        F1: At the end.
    """

    H0: Array
    H1: Array
    F0: Array
    F1: Array


class Path(NamedTuple):
    """What is between the ends, of all nodes.

    Attributes:
        mean: Means of (x, d₁, d₂, d₃), (N, 4, 3).
        delta: Increments of them.
        step: Spatial translations and rotations ψ, (N, 6).
    """

    mean: Array
    delta: Array
    step: Array


class Energies(NamedTuple):
    """Of all elements, each of shape (M,).

    Attributes:
        start: Stored at the start of the step.
        end: At its end.
        account: Work done on them up to its start.
    """

    start: Array
    end: Array
    account: Array


class RigidPart(NamedTuple):
    """Of an element's step.

    Attributes:
        centre: Mean of its nodes.
        ρ2: Their mean square distance from it: what rotations are measured by.
        shift: Translation.
        ω: Rotation, as a vector of Cayley's map.
    """

    centre: Vector
    ρ2: float
    shift: Vector
    ω: Vector


class Memory(NamedTuple):
    """Work for one element after the other.

    Attributes:
        A: Metric of rotations, (3, 3).
        f: Forces on its nodes, (k, 6), as the next two.
        s: The step without its rigid part.
        Ms: That in the metric.
    """

    A: Array
    f: Array
    s: Array
    Ms: Array


@inlined
def _add_to(A: Array, s: float, v: Vector) -> None:
    """``A += s (|v|² I − v vᵀ)``."""
    square = dot(v, v)
    for i in range(3):
        A[i, i] += s * square
        for j in range(3):
            A[i, j] -= s * v[i] * v[j]


@inlined
def solve_symmetric(A: Array, b: Vector) -> Vector:
    """``A⁻¹ b`` of a symmetric positive definite matrix (3, 3)."""
    c00 = A[1, 1] * A[2, 2] - A[1, 2] * A[1, 2]
    c01 = A[0, 2] * A[1, 2] - A[0, 1] * A[2, 2]
    c02 = A[0, 1] * A[1, 2] - A[0, 2] * A[1, 1]
    c11 = A[0, 0] * A[2, 2] - A[0, 2] * A[0, 2]
    c12 = A[0, 1] * A[0, 2] - A[0, 0] * A[1, 2]
    c22 = A[0, 0] * A[1, 1] - A[0, 1] * A[0, 1]
    s = 1.0 / (A[0, 0] * c00 + A[0, 1] * c01 + A[0, 2] * c02)
    return (
        s * (c00 * b[0] + c01 * b[1] + c02 * b[2]),
        s * (c01 * b[0] + c11 * b[1] + c12 * b[2]),
        s * (c02 * b[0] + c12 * b[1] + c22 * b[2]),
    )


@inlined
def _resisting(director: bool, ρ2: float, t: Vector, w: Vector) -> Vector:
    """The metric on rotations: ``ρ² w``, or ``ρ² t×(w×t)`` for a node that is a director."""
    return scaled(ρ2, cross(t, cross(w, t))) if director else scaled(ρ2, w)


@inlined
def _shrunk(ω: Vector, v: Vector) -> Vector:
    """``C v`` with ``C`` the mean of ``cay(ω)^½`` and its transpose."""
    k = sqrt(1.0 + 0.25 * dot(ω, ω))
    return combined(1.0 / k, v, 0.25 * dot(ω, v) / (k * (1.0 + k)), ω)


@inlined
def _unshrunk(ω: Vector, v: Vector) -> Vector:
    """``C⁻¹ v``."""
    k = sqrt(1.0 + 0.25 * dot(ω, ω))
    return combined(k, v, -0.25 * dot(ω, v) / (1.0 + k), ω)


@inlined
def metric_and_fit(nodes: Indices, director: bool, path: Path, A: Array) -> RigidPart:
    """The rigid part of an element's step; ``A`` (3, 3) gets the metric of rotations about it."""
    mean, delta, step = path
    share = 1.0 / nodes.shape[0]
    centre, shift = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for i in nodes:
        centre = plus(centre, scaled(share, load_row(mean[i], 0)))
        shift = plus(shift, scaled(share, load_row(delta[i], 0)))
    A[:] = 0.0
    b, ρ2 = (0.0, 0.0, 0.0), 0.0
    for i in nodes:
        r = minus(load_row(mean[i], 0), centre)
        _add_to(A, 1.0, r)
        ρ2 += share * dot(r, r)
        b = plus(b, cross(r, minus(load_row(delta[i], 0), shift)))
    for i in nodes:
        t, ψ = load_row(mean[i], 3), load(step[i], 3)
        b = plus(b, _resisting(director, ρ2, t, ψ))
        if director:
            _add_to(A, ρ2, t)
        else:
            for k in range(3):
                A[k, k] += ρ2
    return RigidPart(centre, ρ2, shift, solve_symmetric(A, b))


@inlined
def _half_way(H0: Array, H1: Array, f0: Vector, f1: Vector, φ: Vector) -> Vector:
    """``½ (Q R₀ f₀ + Qᵀ R₁ f₁)`` of forces in the node's frames."""
    a = rotate(load_row(H0, 1), load_row(H0, 2), load_row(H0, 3), f0)
    b = rotate(load_row(H1, 1), load_row(H1, 2), load_row(H1, 3), f1)
    back = scaled(-1.0, φ)
    return combined(0.5, turned(φ, a), 0.5, turned(back, b))


@inlined
def _on_director(f: Array) -> Vector:
    """Force along the frame's axes on its third director that is the moment ``f[3:5]``."""
    return f[4], -f[3], 0.0


@inlined
def mean_forces(
    nodes: Indices,
    director: bool,
    ends: Ends,
    mean: Array,
    fit: RigidPart,
    A: Array,
    out: Array,
) -> None:
    """Mean of the forces (k, 6) at both ends, freed of its net force and moment; into ``out``.

    The forces in ``ends`` are those of the element alone.
    """
    H0, H1, F0, F1 = ends
    centre, ρ2, ω = fit.centre, fit.ρ2, fit.ω
    φ = half(ω)
    force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for a in range(nodes.shape[0]):
        i = nodes[a]
        t, r = load_row(mean[i], 3), minus(load_row(mean[i], 0), centre)
        f = _shrunk(ω, _half_way(H0[i], H1[i], load(F0[a], 0), load(F1[a], 0), φ))
        if director:
            g = _half_way(H0[i], H1[i], _on_director(F0[a]), _on_director(F1[a]), φ)
            m = cross(t, _shrunk(ω, g))
        else:
            g = _half_way(H0[i], H1[i], load(F0[a], 3), load(F1[a], 3), φ)
            m = scaled(1.0 / (1.0 + 0.25 * dot(ω, ω)), _unshrunk(ω, g))
        store(out[a], 0, f)
        store(out[a], 3, m)
        force = plus(force, f)
        moment = plus(moment, plus(cross(r, f), m))
    c, w = scaled(1.0 / nodes.shape[0], force), solve_symmetric(A, moment)
    for a in range(nodes.shape[0]):
        i = nodes[a]
        t, r = load_row(mean[i], 3), minus(load_row(mean[i], 0), centre)
        store(out[a], 0, minus(load(out[a], 0), plus(c, cross(w, r))))
        store(out[a], 3, minus(load(out[a], 3), _resisting(director, ρ2, t, w)))


@inlined
def deformation(
    nodes: Indices, director: bool, path: Path, fit: RigidPart, s: Array, Ms: Array
) -> float:
    """The step without its rigid part, ``s`` and ``M s`` (k, 6); returns ``|s|²``."""
    mean, delta, step = path
    centre, ρ2, shift, ω = fit
    square = 0.0
    for a in range(nodes.shape[0]):
        i = nodes[a]
        t, r = load_row(mean[i], 3), minus(load_row(mean[i], 0), centre)
        u = minus(minus(load_row(delta[i], 0), shift), cross(ω, r))
        w = minus(load(step[i], 3), ω)
        m = _resisting(director, ρ2, t, w)
        store(s[a], 0, u)
        store(s[a], 3, w)
        store(Ms[a], 0, u)
        store(Ms[a], 3, m)
        square += dot(u, u) + dot(w, m)
    return square


@inlined
def _work(f: Array, s: Array) -> float:
    work = 0.0
    for a in range(f.shape[0]):
        for k in range(6):
            work += f[a, k] * s[a, k]
    return work


@inlined
def beyond(value: float, bound: float) -> float:
    """What ``value`` exceeds ``±bound`` by."""
    return value - bound if value > bound else value + bound if value < -bound else 0.0


@inlined
def _factor(missing: float, noise: float, square: float, least: float) -> float:
    """``missing/|s|²``, bounded where ``|s|²`` is below ``least`` and what is missing is noise."""
    if missing == 0.0 or square == 0.0:
        return 0.0
    share = noise / (abs(missing) + noise)
    return missing / (square + share * share * least)


@inlined
def round_off(F: Array, reach: float) -> float:
    """Error of an energy that forces ``F`` (k, 6) in the frames of an element let one expect."""
    size = 0.0
    for a in range(F.shape[0]):
        size += reach * max(abs(F[a, 0]), abs(F[a, 1]), abs(F[a, 2]))
        size += max(abs(F[a, 3]), abs(F[a, 4]), abs(F[a, 5]))
    return ROUND_OFF * size


@compiled
def add_elastic(
    cells: CellTable,
    ends: Ends,
    path: Path,
    energies: Energies,
    work: Array,
    factors: tuple[float, float, float],
    out: Array,
) -> float:
    """Add the elastic forces of a step to ``out``.

    Args:
        cells: All cells.
        ends: Of the step.
        path: Between them.
        energies: Of the cells.
        work: Done on each element in this step, shape (M,), overwritten.
        factors: Of ``M s`` in forces beside, whose work is on no account; ``|s|²`` of an element on
            the average, before; and what of its energy cannot be seen in that of the scene.
        out: Forces and moments on all nodes, global components, (N, 6), updated.

    Returns:
        The sum of ``|s|²``.
    """
    unknowns, first, nodes = cells.unknowns, cells.first, cells.nodes
    H0, H1, F0, F1 = ends
    W, W1, account = energies
    repay, typical, unknown = factors
    A, f, s, Ms = _memory(first)
    squares = 0.0
    for e in range(unknowns.shape[0]):
        here = slice(first[e], first[e + 1])
        mine, director = nodes[here], unknowns[e] == 5
        count = mine.shape[0]
        fit = metric_and_fit(mine, director, path, A)
        own = Ends(H0, H1, F0[here], F1[here])
        mean_forces(mine, director, own, path.mean, fit, A, f[:count])
        square = deformation(mine, director, path, fit, s[:count], Ms[:count])
        done = _work(f[:count], s[:count])
        noise, debt = round_off(F0[here], sqrt(fit.ρ2)) + unknown, W[e] - account[e]
        missing = beyond(W1[e] - W[e] - done, KNOWN * noise)
        missing += debt if abs(debt) > noise else 0.0
        # below the second a factor of noise would be as large as a stiffness by present forces
        least = max(0.01 * typical, ROUND_OFF * fit.ρ2)
        factor = _factor(missing, KNOWN * noise, square, least)
        work[e] = done + factor * square
        squares += square
        for a in range(count):
            for k in range(6):
                out[mine[a], k] += f[a, k] + (factor + repay) * Ms[a, k]
    return squares


@compiled
def filtered_forces(
    cells: CellTable,
    ends: Ends,
    path: Path,
    memory: Array,
    out: Array,
) -> tuple[float, float]:
    """Forces ``F₁ − F₀`` of all elements and those of the memory, balanced as elastic forces are.

    Args:
        cells: See :func:`add_elastic`.
        ends: See :func:`add_elastic`.
        path: See :func:`add_elastic`.
        memory: Forces in the frames of the nodes, (places, 6).
        out: Both, forces and moments on all nodes, global components, (2, N, 6), overwritten.

    Returns:
        The works of ``F₁ − F₀`` and of the memory.
    """
    unknowns, first, nodes = cells.unknowns, cells.first, cells.nodes
    H0, H1, F0, F1 = ends
    A, f, s, Ms = _memory(first)
    change, kept = np.empty_like(f), np.empty_like(f)
    by_change = by_memory = 0.0
    out[:] = 0.0
    for e in range(unknowns.shape[0]):
        here = slice(first[e], first[e + 1])
        mine, director = nodes[here], unknowns[e] == 5
        count = mine.shape[0]
        fit = metric_and_fit(mine, director, path, A)
        deformation(mine, director, path, fit, s[:count], Ms[:count])
        for a in range(count):
            for k in range(6):
                f[a, k] = F1[first[e] + a, k] - F0[first[e] + a, k]
        changes = Ends(H0, H1, f[:count], f[:count])
        mean_forces(mine, director, changes, path.mean, fit, A, change[:count])
        before = Ends(H0, H1, memory[here], memory[here])
        mean_forces(mine, director, before, path.mean, fit, A, kept[:count])
        by_change += _work(change[:count], s[:count])
        by_memory += _work(kept[:count], s[:count])
        for a in range(count):
            for k in range(6):
                out[0, mine[a], k] += change[a, k]
                out[1, mine[a], k] += kept[a, k]
    return by_change, by_memory


@compiled
def _memory(first: Indices) -> Memory:
    """For the largest cell."""
    most = 1
    for e in range(first.shape[0] - 1):
        most = max(most, first[e + 1] - first[e])
    room = np.empty((3, 3)), np.empty((most, 6)), np.empty((most, 6)), np.empty((most, 6))
    return Memory(*room)
