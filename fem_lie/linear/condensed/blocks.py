"""Elimination of nodes and solution with their blocks, compiled.

See :mod:`fem_lie.linear.condensed` for the formulas. For each node the array of blocks has its own
block (n, n), then ``U`` (n, w) and ``L`` (w, n), with the ``w`` unknowns of all its neighbours.
"""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie._jit.stack import matrix_at, stack, vector_at
from fem_lie.linear.condensed.elimination import MOST, Left, Numbers, Plan

_SINGULAR = 1e-12
"""Ratio of pivot to largest entry of a block below which it counts as singular."""


@inlined_uncounted
def _find(near: Numbers, e: int, v: int) -> int:
    s = 0
    while near[e, s] != v:
        s += 1
    return s


@inlined_uncounted
def _block_left(left: Left, i: int, j: int) -> int:
    """Start of the block of two remaining nodes."""
    low, high = left.pointers[i], left.pointers[i + 1]
    while high - low > 1:
        middle = (low + high) // 2
        if left.indices[middle] <= j:
            low = middle
        else:
            high = middle
    return left.start[low]


@inlined_uncounted
def _upper(plan: Plan, e: int) -> int:
    """Start of ``U`` of a node; its rows have the unknowns of all neighbours."""
    size = plan.sizes[plan.order[e]]
    return plan.start[e] + size * size


@inlined_uncounted
def _lower(plan: Plan, e: int) -> int:
    """Start of ``L``; its rows have the node's own unknowns."""
    return _upper(plan, e) + plan.sizes[plan.order[e]] * plan.first[e, MOST]


@uncounted
def scatter(plan: Plan, values: Array, columns: Numbers, pointers: Numbers, store: Array) -> None:
    """Copy the blocks of all pairs with an eliminated node from the matrix.

    Args:
        plan: Plan of the elimination.
        values: Values of the matrix by rows.
        columns: Column indices of the matrix.
        pointers: Row pointers of the matrix.
        store: The blocks.
    """
    store[:] = 0.0
    n = plan.sizes.shape[0]
    for v in range(n):
        e, size = plan.position[v], plan.sizes[v]
        for k in range(size):
            row = 6 * v + plan.free[v, k]
            for p in range(pointers[row], pointers[row + 1]):
                u, c = columns[p] // 6, columns[p]
                if u >= n:
                    continue
                other = plan.position[u]
                if u == v:
                    if e >= 0:
                        store[plan.start[e] + size * k + plan.rank[c]] = values[p]
                elif e >= 0 and (other < 0 or other > e):
                    s = _find(plan.near, e, u)
                    at = _upper(plan, e) + plan.first[e, MOST] * k
                    store[at + plan.first[e, s] + plan.rank[c]] = values[p]
                elif other >= 0:
                    s = _find(plan.near, other, v)
                    at = _lower(plan, other) + plan.sizes[u] * (plan.first[other, s] + k)
                    store[at + plan.rank[c]] = values[p]


@inlined_uncounted
def _invert(A: Array, n: int, swapped: Array) -> bool:
    """Invert a block (n, n) in place by Gauss–Jordan with pivoting; whether it is regular."""
    largest = 0.0
    for i in range(n):
        for j in range(n):
            largest = max(largest, abs(A[i, j]))
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[pivot, k]):
                pivot = i
        if not abs(A[pivot, k]) > _SINGULAR * largest:
            return False
        swapped[k] = pivot
        if pivot != k:
            for j in range(n):
                A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
        factor, A[k, k] = 1.0 / A[k, k], 1.0
        for j in range(n):
            A[k, j] *= factor
        for i in range(n):
            if i != k:
                factor, A[i, k] = A[i, k], 0.0
                for j in range(n):
                    A[i, j] -= factor * A[k, j]
    for k in range(n - 1, -1, -1):
        pivot = int(swapped[k])
        if pivot != k:
            for i in range(n):
                A[i, k], A[i, pivot] = A[i, pivot], A[i, k]
    return True


class Front(NamedTuple):
    """Dense blocks of a node during its elimination.

    Attributes:
        own: Block of the node, shape (6, 6).
        above: ``U``, shape (6, w).
        product: ``L U``, shape (w, w).
        swapped: Rows of the pivots, shape (6,).
    """

    own: Array
    above: Array
    product: Array
    swapped: Array


@uncounted
def factorise(plan: Plan, left: Left, store: Array, schur: Array) -> int:
    """Eliminate all nodes in order; returns the first whose block is singular, or −1.

    Args:
        plan: Plan of the elimination.
        left: Pairs of remaining nodes that obtain blocks.
        store: The blocks, overwritten by their factors.
        schur: Blocks of ``left``, to be added to the remaining matrix.
    """
    most = 6 * MOST
    own, above = matrix_at(stack(36), 6, 6), matrix_at(stack(6 * most), 6, most)
    front = Front(own, above, matrix_at(stack(most * most), most, most), vector_at(stack(6), 6))
    schur[:] = 0.0
    for e in range(plan.order.shape[0]):
        n = plan.sizes[plan.order[e]]
        # loops of known length are unrolled: most nodes of cables are positions
        if not (
            _eliminate(plan, e, 3, store, front) if n == 3 else _eliminate(plan, e, n, store, front)
        ):
            return plan.order[e]
        for s in range(MOST):
            i = plan.near[e, s]
            if i < 0:
                break
            for t in range(MOST):
                j = plan.near[e, t]
                if j < 0:
                    break
                at, stride = _destination(plan, left, i, j)
                row, column, size = plan.first[e, s], plan.first[e, t], plan.sizes[j]
                target = store if at >= 0 else schur
                at = at if at >= 0 else -1 - at
                for r in range(plan.sizes[i]):
                    for c in range(size):
                        target[at + stride * r + c] -= front.product[row + r, column + c]
    return -1


@inlined_uncounted
def _eliminate(plan: Plan, e: int, n: int, store: Array, front: Front) -> bool:
    """Factorise the blocks of a node with ``n`` unknowns, and compute ``L U``.

    Returns:
        Whether its own block is regular.
    """
    width = plan.first[e, MOST]
    own = plan.start[e]
    upper = own + n * n
    lower = upper + n * width
    A, above, product = front.own, front.above, front.product
    for k in range(n):
        for m in range(n):
            A[k, m] = store[own + n * k + m]
    if not _invert(A, n, front.swapped):
        return False
    for k in range(n):
        for m in range(n):
            store[own + n * k + m] = A[k, m]
    for c in range(width):
        for k in range(n):
            total = 0.0
            for m in range(n):
                total += A[k, m] * store[upper + width * m + c]
            above[k, c] = total
    for k in range(n):
        for c in range(width):
            store[upper + width * k + c] = above[k, c]
    for r in range(width):
        for c in range(width):
            total = 0.0
            for k in range(n):
                total += store[lower + n * r + k] * above[k, c]
            product[r, c] = total
    return True


@inlined_uncounted
def _destination(plan: Plan, left: Left, i: int, j: int) -> tuple[int, int]:
    """Position and row length of the block of two neighbours.

    If both remain it is −1 minus the position among those.
    """
    a, b = plan.position[i], plan.position[j]
    if i == j:
        if a >= 0:
            return plan.start[a], plan.sizes[i]
    elif a >= 0 and (b < 0 or b > a):
        return _upper(plan, a) + plan.first[a, _find(plan.near, a, j)], plan.first[a, MOST]
    elif b >= 0:
        own = plan.sizes[j]
        return _lower(plan, b) + own * plan.first[b, _find(plan.near, b, i)], own
    return -1 - _block_left(left, i, j), plan.sizes[j]


@uncounted
def forward(plan: Plan, store: Array, x: Array) -> None:
    """Eliminate the right-hand side ``x`` (6 n + m,) in place."""
    y = vector_at(stack(6), 6)
    for e in range(plan.order.shape[0]):
        n = plan.sizes[plan.order[e]]
        if n == 3:
            _forward(plan, e, 3, store, x, y)
        else:
            _forward(plan, e, n, store, x, y)


@inlined_uncounted
def _forward(plan: Plan, e: int, n: int, store: Array, x: Array, y: Array) -> None:
    """Elimination at a node with ``n`` unknowns; ``y`` is workspace."""
    v, own = plan.order[e], plan.start[e]
    lower = own + n * n + n * plan.first[e, MOST]
    for k in range(n):
        y[k] = x[6 * v + plan.free[v, k]]
    for k in range(n):
        total = 0.0
        for m in range(n):
            total += store[own + n * k + m] * y[m]
        x[6 * v + plan.free[v, k]] = total
    for k in range(n):
        y[k] = x[6 * v + plan.free[v, k]]
    for s in range(MOST):
        i = plan.near[e, s]
        if i < 0:
            break
        for r in range(plan.sizes[i]):
            at, total = lower + n * (plan.first[e, s] + r), 0.0
            for k in range(n):
                total += store[at + k] * y[k]
            x[6 * i + plan.free[i, r]] -= total


@uncounted
def backward(plan: Plan, store: Array, x: Array) -> None:
    """Compute the unknowns of all eliminated nodes from the remaining ones, in place."""
    known, y = vector_at(stack(6 * MOST), 6 * MOST), vector_at(stack(6), 6)
    for back in range(plan.order.shape[0]):
        e = plan.order.shape[0] - 1 - back
        n = plan.sizes[plan.order[e]]
        if n == 3:
            _backward(plan, e, 3, store, x, known, y)
        else:
            _backward(plan, e, n, store, x, known, y)


@inlined_uncounted
def _backward(plan: Plan, e: int, n: int, store: Array, x: Array, known: Array, y: Array) -> None:
    """Back substitution at a node with ``n`` unknowns; ``known`` and ``y`` are workspace."""
    v, width = plan.order[e], plan.first[e, MOST]
    upper = plan.start[e] + n * n
    for s in range(MOST):
        i = plan.near[e, s]
        if i < 0:
            break
        for r in range(plan.sizes[i]):
            known[plan.first[e, s] + r] = x[6 * i + plan.free[i, r]]
    for k in range(n):
        y[k] = 0.0
    # all rows at once, as each sum waits for its last term
    for c in range(width):
        for k in range(n):
            y[k] += store[upper + width * k + c] * known[c]
    for k in range(n):
        x[6 * v + plan.free[v, k]] -= y[k]
