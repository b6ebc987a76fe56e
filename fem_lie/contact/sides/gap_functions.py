"""Gap functions: gaps of points to surfaces, with derivatives by forward differentiation; compiled.

With ``X = Rᵀ (P − O)`` the position of a point in the axes of the frame that a surface is fixed to,
from its origin, the gap is ``g(X)``: the signed distance, positive outside of the solid. Its
gradient is the unit normal, as friction and results expect. Without friction, another function that
vanishes on the surface is equally valid. A plane is ``g = m·X``. A gap function takes a tuple of
three coordinates and a tuple of parameters, and is plain arithmetic with functions of :mod:`math`::

    @compiled
    def around_cylinder(X, parameters):
        return math.sqrt(X[0] * X[0] + X[1] * X[1]) - parameters[0]

    @callback(GAP_SIGNATURE)
    def gap(out, X, parameters):
        evaluate(around_cylinder, (0.0,), out, X, parameters)
"""

from __future__ import annotations

from typing import Any

from numba import types

from fem_lie._arrays import Array
from fem_lie._jit import inlined, inlined_uncounted, uncounted
from fem_lie._jit.stack import stack, vector_at
from fem_lie.contact.sides.table import GROUND, Side
from fem_lie.forms.kernels.addresses import Pointer, call_kernel, double_pointer
from fem_lie.forms.small_energy.jets import numbers_at, second_order, store_parts
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.tuples import Vector, combined, load

GAP_SIGNATURE = types.void(double_pointer, double_pointer, double_pointer)
"""Signature of gap functions: value, gradient and upper half of the Hessian (10,), position,
parameters."""

_THREE = (0.0, 0.0, 0.0)


@inlined
def evaluate(function: Any, like: Any, out: Pointer, X: Pointer, parameters: Pointer) -> None:
    """Evaluate a gap function with its derivatives.

    Args:
        function: Function of the tuples of coordinates and parameters.
        like: A tuple as long as that of the parameters.
        out: Overwritten, see :data:`GAP_SIGNATURE`.
        X: Position.
        parameters: Parameters of the surface.
    """
    jet = function(second_order(numbers_at(X, _THREE)), numbers_at(parameters, like))
    store_parts((jet,), out)


@uncounted
def local_gap(side: Side, j: int, X: Vector) -> tuple[float, Vector, Vector, Vector]:
    """Value, gradient, diagonal of the Hessian, and its entries 23, 13, 12; in the local frame."""
    at, out, q = stack(3), stack(10), stack(max(1, side.level.parameters.shape[1]))
    position, found = vector_at(at, 3), vector_at(out, 10)
    parameters = vector_at(q, max(1, side.level.parameters.shape[1]))
    for k in range(3):
        position[k] = X[k]
    for k in range(side.level.parameters.shape[1]):
        parameters[k] = side.level.parameters[j, k]
    call_kernel(side.level.address, out, at, q, q)
    diagonal, others = (found[4], found[7], found[9]), (found[8], found[6], found[5])
    return found[0], load(found, 1), diagonal, others


@inlined_uncounted
def position_in(H: Array, side: Side, j: int, separation: Vector) -> Vector:
    """Local position ``X`` of a point with the offset ``separation`` from the origin."""
    node = side.nodes[j, 0]
    return separation if node == GROUND else local_components(H[node], separation)


@inlined_uncounted
def turned(H: Array, side: Side, j: int, m: Vector) -> Vector:
    """Global components of a vector in the frame of a surface."""
    node = side.nodes[j, 0]
    return m if node == GROUND else global_components(H[node], m)


@inlined_uncounted
def bent(diagonal: Vector, others: Vector, X: Vector) -> Vector:
    """Product of the Hessian and a vector."""
    (a, b, c), (f, e, d), (x, y, z) = diagonal, others, X
    return a * x + d * y + e * z, d * x + b * y + f * z, e * x + f * y + c * z


@uncounted
def mean_gradient(side: Side, j: int, X0: Vector, X1: Vector, change: Vector) -> Vector:
    """Discrete gradient ``G`` of a gap over a step: ``G·ΔX = g(X₁) − g(X₀)``.

    It is the gradient at the midpoint, corrected along ``ΔX`` (O. Gonzalez, J. Nonlinear Sci. 6
    (1996) 449), unless the correction is round-off of the gaps.

    Args:
        side: The surface.
        j: Its number.
        X0: Position of the point at the start.
        X1: Position at the end.
        change: ``ΔX``, computed without cancellation.
    """
    g0, _, _, _ = local_gap(side, j, X0)
    g1, _, _, _ = local_gap(side, j, X1)
    middle = combined(0.5, X0, 0.5, X1)
    _, m, _, _ = local_gap(side, j, middle)
    square = change[0] ** 2 + change[1] ** 2 + change[2] ** 2
    along = m[0] * change[0] + m[1] * change[1] + m[2] * change[2]
    missing = g1 - g0 - along
    size = abs(middle[0]) + abs(middle[1]) + abs(middle[2]) + abs(g0) + abs(g1)
    if abs(missing) <= _KNOWN * size or square == 0.0:
        return m
    return combined(1.0, m, missing / square, change)


_KNOWN = 1e-15
"""Round-off level of gaps relative to lengths."""
