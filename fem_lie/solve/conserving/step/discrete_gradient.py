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
from fem_lie.solve.conserving.step.mean_forces import (
    Ends,
    Path,
    deformation,
    mean_forces,
    metric_and_fit,
)

ROUND_OFF = 16 * float(np.finfo(np.float64).eps)
"""Relative error of positions and energies."""
KNOWN = 16.0
"""Errors of energies from which the energy of a single step counts as known."""


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
def factor_of(missing: float, noise: float, square: float, least: float) -> float:
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
        factor = factor_of(missing, KNOWN * noise, square, least)
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
        out: Both, forces and moments on all nodes, global components, (≥ 2, N, 6), overwritten.

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
