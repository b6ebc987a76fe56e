"""Elastic forces of a step whose work is exactly the change of the stored energy.

They apply to *any* element with an objective energy ``W``, and need only its energy and nodal
forces at both ends of the step. Nodal forces and moments conjugate to ``(Δx, ψ)`` are, for one
element::

    f = P [ C ½ (Q f₀ + Qᵀ f₁) ] + (ΔW − f·s)/|s|² M s

1. *Mean.* The rigid part of the element's increment, translation and rotation ω, is fitted to its
   nodes in a metric ``M`` (1 on translations, a length squared on rotations). ``Q = cay(ω)^½``
   rotates the forces of both ends to the midpoint. Means of rotating positions and directors are
   shrunk by ``C = ½(Q + Qᵀ)``, and the deviation of an increment from a rotation of the mean is
   ``C⁻¹`` times the deformation. So forces are shrunk, too (moments, whose ψ has ``C⁻¹`` and
   ``1 + ¼|ω|²``, get both factors), and the work of the mean is exact to third order in the
   *deformation* of the step, whatever its rotation. Otherwise the error would be of second order,
   as large as ``|ω|²/4`` of the whole.
2. *Balance.* ``P`` removes the resultant and the moment of the mean: ``M`` times a rigid motion, so
   that the sum of forces, and of moments about the mean configuration, is zero to round-off.
3. *Energy.* ``s`` is the increment without its rigid part: ``M s`` has no resultant and no moment,
   and the factor, Gonzalez' discrete gradient (J. Nonlinear Sci. 6 (1996) 449) in the quotient by
   rigid motions, makes the work equal to ``ΔW``. It is of third order, zero for quadratic energies
   of strains without rotation in the element, and regular where ``s`` vanishes.

So linear and angular momentum and energy are exact for every element. For strains quadratic in the
nodal coordinates, the mean is that of Simo, Tarnow & Doblaré (IJNME 38 (1995) 1431), stress from
both ends, moment arm from the mean configuration, to third order.

``W`` itself has round-off: the ulp of positions times the force, and the element's share of the ulp
of the scene's energy. A factor below this level would be round-off, and the iteration would not
converge. So the factor corrects only the excess, and each element has an account of the work done
on it: if energy and account differ by more than round-off at the start of a step, the step corrects
this. Errors do not accumulate. If an element deforms much less in a step than others do, or less
than positions can resolve, its round-off is corrected in a later step with more deformation:
divided by a small ``s`` of undetermined sign, the factor would not be a function of the motion.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, uncounted
from fem_lie._jit.stack import blocks_at, stack
from fem_lie.forms.cells import CellArrays
from fem_lie.forms.fixed_arrays import as_frames, as_sixes
from fem_lie.solve.conserving.midpoint.mean_forces import (
    Ends,
    Path,
    deformation,
    mean_forces,
    metric_and_fit,
)

ROUND_OFF = 16 * float(np.finfo(np.float64).eps)
"""Relative error of positions and energies."""
KNOWN = 16.0
"""Factor on round-off above which the energy change of a single step counts as known."""


class Energies(NamedTuple):
    """Energies of all elements, each of shape (M,).

    Attributes:
        start: Stored energy at the start of the step.
        end: Stored energy at its end.
        account: Work done on the elements up to its start.
    """

    start: Array
    end: Array
    account: Array


class Filtered(NamedTuple):
    """Force changes ``F₁ − F₀`` of all elements and their filter state, both balanced.

    Attributes:
        wanted: Whether these forces are computed.
        filter_state: Filter state: forces in the frames of the nodes, (cell nodes, 6).
        out: Both, as forces and moments on all nodes, global components, (≥ 2, N, 6), overwritten.
    """

    wanted: bool
    filter_state: Array
    out: Array


@inlined
def _work(f: Array, s: Array) -> float:
    work = 0.0
    for a in range(f.shape[0]):
        for k in range(6):
            work += f[a, k] * s[a, k]
    return work


@inlined
def beyond(value: float, bound: float) -> float:
    """The part of ``value`` outside of ``±bound``."""
    return value - bound if value > bound else value + bound if value < -bound else 0.0


@inlined
def factor_of(missing: float, round_off_level: float, square: float, least: float) -> float:
    """``missing/|s|²``, bounded where ``|s|²`` is below ``least`` and ``missing`` is round-off."""
    if missing == 0.0 or square == 0.0:
        return 0.0
    share = round_off_level / (abs(missing) + round_off_level)
    return missing / (square + share * share * least)


@inlined
def round_off(F: Array, reach: float) -> float:
    """Expected round-off of the energy of an element with forces ``F`` (k, 6)."""
    size = 0.0
    for a in range(F.shape[0]):
        size += reach * max(abs(F[a, 0]), abs(F[a, 1]), abs(F[a, 2]))
        size += max(abs(F[a, 3]), abs(F[a, 4]), abs(F[a, 5]))
    return ROUND_OFF * size


@uncounted
def add_elastic(
    cells: CellArrays,
    ends: Ends,
    path: Path,
    energies: Energies,
    work: Array,
    factors: tuple[float, float, float],
    filtered: Filtered,
    out: Array,
) -> tuple[float, float, float]:
    """Add the elastic forces of a step to ``out``.

    Args:
        cells: All cells.
        ends: Nodes and forces at both ends of the step.
        path: Means and increments.
        energies: Energies of the cells.
        work: Work done on each element in this step, shape (M,), overwritten.
        factors: Factor of ``M s`` in further forces, whose work is not accounted for; mean ``|s|²``
            of an element in the previous iteration; and the energy of an element that the round-off
            of the scene's energy hides.
        filtered: Further forces that are balanced.
        out: Forces and moments on all nodes, global components, (N, 6), updated.

    Returns:
        The sum of ``|s|²``, and the works of the further forces.
    """
    unknowns, first, nodes = cells.unknowns, cells.first, cells.nodes
    H0, H1 = as_frames(ends.H0), as_frames(ends.H1)
    F0, F1, out = as_sixes(ends.F0), as_sixes(ends.F1), as_sixes(out)
    path = Path(as_frames(path.mean), as_frames(path.delta), as_sixes(path.step))
    W, W1, account = energies
    repay, typical, unknown = factors
    most = 1
    for e in range(unknowns.shape[0]):
        most = max(most, first[e + 1] - first[e])
    size = 6 * most
    workspace = blocks_at(stack(4 * size), 4, most, 6)
    f, s, Ms, change = workspace[0], workspace[1], workspace[2], workspace[3]
    squares = by_change = by_filter = 0.0
    if filtered.wanted:
        for i in range(out.shape[0]):
            for k in range(6):
                filtered.out[0, i, k] = filtered.out[1, i, k] = 0.0
    for e in range(unknowns.shape[0]):
        begin, end = first[e], first[e + 1]
        mine, director, count = nodes[begin:end], unknowns[e] == 5, end - begin
        fit = metric_and_fit(mine, director, path)
        own = Ends(H0, H1, F0[begin:end], F1[begin:end])
        mean_forces(mine, director, own, path.mean, fit, f[:count])
        square = deformation(mine, director, path, fit, s[:count], Ms[:count])
        done = _work(f[:count], s[:count])
        round_off_level, debt = round_off(own.F0, sqrt(fit.ρ2)) + unknown, W[e] - account[e]
        missing = beyond(W1[e] - W[e] - done, KNOWN * round_off_level)
        missing += debt if abs(debt) > round_off_level else 0.0
        # below the second bound a round-off factor would be as large as a stiffness by current
        # forces
        least = max(0.01 * typical, ROUND_OFF * fit.ρ2)
        factor = factor_of(missing, KNOWN * round_off_level, square, least)
        work[e] = done + factor * square
        squares += square
        for a in range(count):
            for k in range(6):
                out[mine[a], k] += f[a, k] + (factor + repay) * Ms[a, k]
        if not filtered.wanted:
            continue
        for a in range(count):
            for k in range(6):
                change[a, k] = F1[begin + a, k] - F0[begin + a, k]
        both = Ends(H0, H1, change[:count], change[:count])
        mean_forces(mine, director, both, path.mean, fit, f[:count])
        by_change += _work(f[:count], s[:count])
        _add_on_nodes(mine, f, filtered.out[0])
        filter_state = filtered.filter_state[begin:end]
        both = Ends(H0, H1, filter_state, filter_state)
        mean_forces(mine, director, both, path.mean, fit, f[:count])
        by_filter += _work(f[:count], s[:count])
        _add_on_nodes(mine, f, filtered.out[1])
    return squares, by_change, by_filter


@inlined
def _add_on_nodes(nodes: Indices, f: Array, out: Array) -> None:
    """``out += f`` of one element, (k, 6) and (N, 6)."""
    for a in range(nodes.shape[0]):
        for k in range(6):
            out[nodes[a], k] += f[a, k]
