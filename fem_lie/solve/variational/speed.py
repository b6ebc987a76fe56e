"""Kinetic energy over a step from its increments and momenta, compiled."""

from __future__ import annotations

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT
from fem_lie.lie.tuples import combined, cross, dot, load, minus, plus


@compiled
def kinetic(
    kinds: Indices, step: Array, h: float, before: Array, after: Array
) -> tuple[float, float]:
    """``2 T̄ = q̇·p̄`` and ``2 ΔT = 2 q̇·Δp`` of a step, with ``q̇ = Δq/h`` and ``p̄ = ½ (p₀ + p₁)``.

    Angular momenta of frames are about their positions, which move: the power of a frame with the
    momentum ``p`` and the angular momentum ``l`` is ``v·ṗ + ω·(l̇ + v × p)``.

    Args:
        kinds: Types of the nodes, (n,).
        step: Increments in global components, see :func:`~.kinematics.between`, (n, 6).
        h: Step size.
        before: Momenta at the start, (n, 6).
        after: Momenta at the end, (n, 6).
    """
    double = work = 0.0
    for i in range(kinds.shape[0]):
        p = combined(0.5, load(before[i], 0), 0.5, load(after[i], 0))
        for at in (0, 3):
            moved, start, end = load(step[i], at), load(before[i], at), load(after[i], at)
            force = minus(end, start)
            if at == 3 and kinds[i] < POSITION_GRADIENT:
                force = plus(force, cross(load(step[i], 0), p))
            double += 0.5 * dot(moved, plus(start, end)) / h
            work += dot(moved, force) / h
    return double, 2.0 * work
