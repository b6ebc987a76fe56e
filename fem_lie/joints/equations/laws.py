"""Force laws along coordinates in compiled code: functions called by their addresses.

A law is a C callback that takes a record of numbers, the data of the law, and the order of what is
computed: the force, its derivatives, or the potential. Laws of users have no data.
"""

from __future__ import annotations

from numba import types

from fem_lie._arrays import Array
from fem_lie._jit import uncounted
from fem_lie._jit.by_address import call_with_arrays
from fem_lie._jit.stack import stack, vector_at
from fem_lie.joints.equations.joint_arrays import JointArrays

TIME, COORDINATE, RATE, FORCE, BY_COORDINATE, BY_RATE, POTENTIAL = range(7)
"""Numbers in the record of a call: three arguments and four results."""

SIZE = 7
"""Length of this record."""

OF_FORCE, OF_DERIVATIVES, OF_POTENTIAL = range(3)
"""Orders: what a call computes."""

SIGNATURE = types.void(types.CPointer(types.float64), types.CPointer(types.float64), types.int64)
"""Signature of a law: record, data, order."""


@uncounted
def _call(arrays: JointArrays, k: int, q: float, rate: float, order: int, out: Array) -> None:
    """Call the law of spring ``k``, which sets ``out`` (7,)."""
    address, first, end = arrays.laws[k, 0], arrays.laws[k, 1], arrays.laws[k, 2]
    out[TIME], out[COORDINATE], out[RATE] = arrays.clock[0], q - arrays.springs[k, 2], rate
    call_with_arrays(address, (out, arrays.data[first:end]), (order,))


@uncounted
def force(arrays: JointArrays, k: int, q: float, rate: float) -> float:
    """Force of the law of spring ``k`` at coordinate ``q`` and its rate."""
    out = vector_at(stack(SIZE), SIZE)
    _call(arrays, k, q, rate, OF_FORCE, out)
    return float(arrays.springs[k, 0] * out[FORCE])


@uncounted
def derivatives(arrays: JointArrays, k: int, q: float, rate: float) -> tuple[float, float]:
    """Derivatives of the force of spring ``k`` in the coordinate and in its rate."""
    out = vector_at(stack(SIZE), SIZE)
    _call(arrays, k, q, rate, OF_DERIVATIVES, out)
    return out[BY_COORDINATE], out[BY_RATE]


@uncounted
def potential(arrays: JointArrays, k: int, q: float) -> float:
    """Potential of the law of spring ``k``; 0 if it has none."""
    out = vector_at(stack(SIZE), SIZE)
    _call(arrays, k, q, 0.0, OF_POTENTIAL, out)
    return float(arrays.springs[k, 0] * out[POTENTIAL])


_SMALL = 1e-4
"""Change of the potential in a step, relative to it, below which its quotient loses digits."""


@uncounted
def mean_force(arrays: JointArrays, k: int, q: float, change: float) -> float:
    """Force of spring ``k`` over a step from ``q``, whose work is the change of the potential.

    In small steps Simpson's rule takes the place of the quotient ``ΔW/Δq``, whose round-off would
    exceed the error of the rule.
    """
    first, middle = force(arrays, k, q, 0.0), force(arrays, k, q + 0.5 * change, 0.0)
    last, before = force(arrays, k, q + change, 0.0), potential(arrays, k, q)
    mean = (first + 4.0 * middle + last) / 6.0
    if abs(mean * change) <= _SMALL * abs(before):
        return mean
    return (potential(arrays, k, q + change) - before) / change
