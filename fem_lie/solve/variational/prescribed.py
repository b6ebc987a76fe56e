"""Loads, drives and prescribed motions of one step."""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie.system.equations import Equations


def prescribe(
    equations: Equations,
    H: Array,
    start: float,
    h: float,
    rows: tuple[Array, Array, Array, Array],
    given: tuple[Array, Array],
) -> None:
    """Set loads of the middle of the step, drives and prescribed motions at its end, too.

    Args:
        equations: Of the scene; their time becomes that of the middle.
        H: All rows at the start, shape (N, 4, 3).
        start: When it begins.
        h: Step size.
        rows: Their change, mean, those at the end and half-way; prescribed ones are set.
        given: By how much drives go on, shape (m,), and twists, shape (N, 6), whose prescribed ones
            are set; results.
    """
    n, (driven, twists) = equations.unknowns.moving, given
    end, between = start + h, equations.prescribed(start + 0.5 * h, h)
    if equations.unknowns.driven:
        at = [equations.prescribed(time).targets for time in (start, end)]
        driven[:] = at[1] - at[0]
    if len(H) > n + 1:
        delta, mean, last, half_way = rows
        after = equations.prescribed(end)
        delta[n + 1 :] = after.frames - H[n + 1 :]
        mean[n + 1 :] = 0.5 * (after.frames + H[n + 1 :])
        last[n + 1 :], half_way[n + 1 :] = after.frames, between.frames
        twists[n + 1 :] = between.velocities
    between.act()
