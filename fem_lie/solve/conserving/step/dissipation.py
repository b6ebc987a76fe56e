"""Mean velocities of a step: those of the midpoint rule, or with numerical dissipation.

::

    (q₁ − q)/h = V̄ + g,      V̄ = ½ (V + V₁),      g = ½ χ Π (ΔV − β w),      w ← w + μ (ΔV − w)

With ``χ = 0`` there is no dissipation. Otherwise ``w`` is the state of a filter of the changes
``ΔV = V₁ − V``, so that ``ΔV − w`` is of second order in h if the step resolves the motion. With
the same filter for elastic forces, linear problems are integrated by a two-step method of second
order that is A-stable, with the eigenvalues −ρ and 0 at infinite frequency for
``χ = (1 − ρ)/(3 + ρ)``, ``μ = 1 − χ``: the trapezoidal rule for ρ = 1, BDF2 for ρ = 0.

The kinetic energy loses ``ΔV·G g``. ``Π`` removes the best fit of a rotation ``Ω × V̄`` from its
argument, in the metric of inertia: then ``Σ V̄ × G g = 0``, which conserves angular momentum, and a
body that rotates steadily is not damped.

With changes ``Δ`` of velocities and of elastic forces as one vector, in the norm of inertia and
compliance, the dissipated energy is ``½ χ Δ·(Δ − β w)``. ``β w`` is the filter state, limited to
the length of the change, or, if it has the opposite direction, to up to twice the change::

    β = min(1, (|Δ| + max(−Δ·w, 0)/|w|)/|w|)

By the Cauchy-Schwarz inequality no single step gains energy; and ``β w`` is a Lipschitz continuous
function of the change that vanishes with it, so it is defined where nothing deforms.
``|Δ − β w| ≤ 2 |Δ − w|``: the order is not reduced. ``|w|²`` of elastic forces follows from the
rule for ``w``. Elements whose forces decrease with deformation would have negative dissipation;
this is limited to the dissipation of the velocities.

All of this is sums ``Σ X_r (G Y)_s`` over the nodes, 3×3 numbers for each pair of V, w and
``δ = Δq/h − V``: with ``ΔV = a + χ P × V̄`` the means are ``V̄ = (I − ½ χ P̂)⁻¹ (V + ½ a)``, one
matrix times known quantities, and P and β are computed from these sums without the nodes.

(Relaxed variables for second order: Armero & Romero, CMAME 190 (2001) 6783. The energy of two-step
methods: Dahlquist, BIT 18 (1978) 384.)
"""

from __future__ import annotations

from math import sqrt

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, uncounted
from fem_lie._jit.call_back import call_back
from fem_lie._jit.records import Record
from fem_lie._jit.stack import blocks_at, matrix_at, stack, vector_at
from fem_lie.lie.node_types.forces import add_along_increments
from fem_lie.lie.node_types.node_type import axes
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load,
    load_row,
    plus,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.solve.conserving.midpoint.cayley import mean_of
from fem_lie.solve.conserving.midpoint.mean_forces import solve_symmetric
from fem_lie.solve.conserving.step.products import (
    TURNS,
    changes,
    make_means,
    make_squares,
    nearest,
    product,
    resistance,
    times,
    trace,
    turn,
    turning,
)
from fem_lie.solve.conserving.step.ranks import Ranks
from fem_lie.solve.conserving.step.records import TURNINGS, Products

_EXACT = 1e-14


@uncounted
def set_velocities(V: Array, w: Array, δ: Array, χ: float, β: float, ψ: Vector, V1: Array) -> None:
    """Velocities ``V₁`` at the end: ``ΔV = a + ψ × V̄``; (n, 4, 3)."""
    (_, k, kept), _, _ = changes(χ, β)
    for i in range(V.shape[0]):
        for j in range(4):
            a = plus(scaled(k, load_row(δ[i], j)), scaled(kept, load_row(w[i], j)))
            v = load_row(V[i], j)
            mean = mean_of(ψ, plus(v, scaled(0.5, a)))
            store_row(V1[i], j, plus(plus(v, a), cross(ψ, mean)))


@uncounted
def set_turnings(
    products: Products,
    frames: tuple[Indices, Array, Array],
    held: Indices,
    χ: float,
    h: float,
    out: Array,
    ranks: Ranks,
) -> None:
    """Contribution of P to the matrix: ``Y Zᵀ``; the columns of ``Z`` are forces ``e × G V``.

    That of ``ΔV`` is ``χ P × V̄``, and ``P`` the best fit of a rotation to increments of V.

    Args:
        products: Products at the start of the step.
        frames: Types of the nodes, means, and midpoint configurations.
        held: Which unknowns are zero, (n, 6).
        χ: Dissipation parameter.
        h: Step size.
        out: ``Z`` and ``Y``, (2, 3, 6 n), overwritten.
        ranks: Ranks whose parts of ``Z`` are added up.
    """
    kinds, mean, middle = frames
    work, f, forces = matrix_at(stack(9), 3, 3), matrix_at(stack(12), 4, 3), vector_at(stack(6), 6)
    resistance(products.sums[0, 0], work)
    least = 1e-12 * trace(work)
    out[:] = 0.0
    if least == 0.0:
        return
    for i in range(held.shape[0]):
        (d1, d2, d3), at = axes(kinds[i], middle[i]), 6 * i
        for c in range(3):
            e = (1.0 if c == 0 else 0.0, 1.0 if c == 1 else 0.0, 1.0 if c == 2 else 0.0)
            for k in range(6):
                forces[k] = 0.0
            for k in range(4):
                store_row(f, k, cross(e, load_row(products.GV[i], k)))
            add_along_increments(kinds[i], mean[i], f, forces)
            store(out[0, c], at, rotate_back(d1, d2, d3, load(forces, 0)))
            store(out[0, c], at + 3, rotate_back(d1, d2, d3, load(forces, 3)))
            for k in range(6):
                if held[i, k]:
                    out[0, c, at + k] = 0.0
    if ranks.addresses[TURNINGS] != 0:
        call_back(ranks.addresses[TURNINGS])
    for c in range(3):
        work[c, c] += least
    factor = 4.0 * χ / ((1.0 + χ) * h) ** 2
    for k in range(out.shape[2]):
        y = solve_symmetric(work, (out[0, 0, k], out[0, 1, k], out[0, 2, k]))
        out[1, 0, k], out[1, 1, k], out[1, 2, k] = scaled(factor, y)


@uncounted
def choose_filter_gain(sums: Array, χ: float, filter_state: Record) -> Vector:
    """β and the filtered fraction of elastic forces, consistent with the velocities.

    Returns their ψ.
    """
    ψ = (0.0, 0.0, 0.0)
    for _ in range(TURNS):
        β, share = filter_state.gain, filter_state.elastic
        ψ = turning(sums, χ, β, ψ)
        _choose_once(sums, χ, ψ, filter_state)
        if abs(filter_state.gain - β) <= _EXACT and abs(filter_state.elastic - share) <= _EXACT:
            break
    return turning(sums, χ, filter_state.gain, ψ)


@uncounted
def _choose_once(sums: Array, χ: float, ψ: Vector, filter_state: Record) -> None:
    """The same for velocities with the previous β, and their ψ."""
    work = blocks_at(stack(36), 4, 3, 3)
    W, A, shifted, X = work[0], work[1], work[2], work[3]
    a, p, _ = changes(χ, filter_state.gain)
    w = (0.0, 0.0, 1.0)
    product(sums, p, p, W)
    make_squares(ψ, W)
    resistance(W, A)
    product(sums, p, a, X)
    make_means(ψ, X)
    by_a, by_turn = turn(X), times(A, ψ)
    by_change = plus(by_a, by_turn)
    product(sums, p, w, X)
    make_means(ψ, X)
    by_w = turn(X)
    product(sums, a, a, X)
    square = trace(X) + 2.0 * dot(ψ, by_a) + dot(ψ, by_turn)
    product(sums, a, w, X)
    common = trace(X) + dot(ψ, by_w)
    by_nearest = nearest(A, shifted, by_w)
    change = max(square - dot(nearest(A, shifted, by_change), by_change), 0.0)
    common -= dot(by_nearest, by_change)
    filter_square = max(trace(sums[2, 2]) - dot(by_nearest, by_w), 0.0)
    elastic = filter_state.all_change_work
    share = change / -elastic if -elastic > change else 1.0
    change, common = change + share * elastic, common + share * filter_state.all_filter_work
    filter_state.elastic = share
    filter_state.gain = _filter_gain(
        max(change, 0.0), common, filter_square + share * filter_state.length
    )


@inlined
def _filter_gain(change: float, common: float, square: float) -> float:
    """β from ``|Δ|²``, ``Δ·w`` and ``|w|²``."""
    most = sqrt(change * square)
    if common <= 0.0:
        return min(1.0, (most - common) / square) if square > 0.0 else 1.0
    # metrics change between steps: the Cauchy-Schwarz inequality is enforced
    return min(1.0, change / max(most, common))


@inlined
def remember(filter_state: Record, μ: float) -> None:
    """``|w|²`` of elastic forces after the step."""
    keep = 1.0 - μ
    square = keep * keep * filter_state.length + μ * (
        2.0 * keep * filter_state.all_filter_work + μ * filter_state.all_change_work
    )
    filter_state.length = max(square, 0.0)


@uncounted
def velocity_loss(V: Array, V1: Array, delta: Array, h: float, rates: Array) -> float:
    """``ΔV·G g`` with ``g = (q₁ − q)/h − V̄``: the exact loss of kinetic energy.

    ``rates`` is ``G ΔV/h``, (n, 4, 3).
    """
    loss = 0.0
    for i in range(V.shape[0]):
        for k in range(4):
            for j in range(3):
                g = delta[i, k, j] - 0.5 * h * (V[i, k, j] + V1[i, k, j])
                loss += g * rates[i, k, j]
    return loss
