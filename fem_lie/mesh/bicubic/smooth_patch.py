"""Smooth patches for thin shells: from functions, and from bicubic splines.

Between its knots a bicubic spline is a bicubic polynomial; with single or double inner knots it has
continuous gradients. So a thin shell with its positions, gradients and mixed derivatives at the
knots represents it exactly; with double knots there are as many unknowns as control points. Knot
insertion does not change the surface.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.interpolate import BSpline, make_interp_spline

from fem_lie._arrays import Array, instance, numbers, vector, whole
from fem_lie._summary import Summarised

Surface = Callable[[float, float], npt.ArrayLike]
"""Smooth function of the position (3,) at parameters (a, b) between 0 and 1."""

_STEP, _STENCIL = 0.01, 9
"""Step and number of points of finite differences; one-sided at the edges."""


@dataclass(frozen=True, eq=False, repr=False)
class SmoothPatch(Summarised):
    """Surface over a rectangle of parameters, by positions and derivatives at a grid of nodes.

    Parameters are lengths: those of the middle lines along a and along b.

    Attributes:
        nodal_vectors: Position, ∂u, ∂v and ∂u∂v at the nodes, shape (na + 1, nb + 1, 4, 3).
        sizes: Sizes of the cells along u (na,) and along v (nb,).
    """

    nodal_vectors: Array
    sizes: tuple[Array, Array]


def smooth_patch(function: Surface, cells: tuple[int, int]) -> SmoothPatch:
    """Patch of ``cells`` equal cells on the surface of a function of a and b, from 0 to 1.

    Between the nodes the surface is the bicubic with the positions and derivatives at the nodes;
    derivatives are finite differences of eighth order.

    Args:
        function: ``function(a, b)``, shape (3,).
        cells: Numbers of cells along a and along b.

    Raises:
        ValueError: There are no cells, a position is not finite, or the gradients at a node are
            zero or parallel.
        TypeError: ``function`` is not a function, or the numbers of cells are not whole.
    """
    position, grids = grid(function, cells, "smooth_patch")
    nodal_vectors = np.array([[derivatives_of(position, a, b) for b in grids[1]] for a in grids[0]])
    return from_nodal_vectors(nodal_vectors, (np.diff(grids[0]), np.diff(grids[1])))


def grid(
    function: Surface, cells: tuple[int, int], what: str
) -> tuple[Callable[[float, float], Array], tuple[Array, Array]]:
    """The function with checked values, and the parameters of the nodes.

    Args:
        function: See :func:`smooth_patch`.
        cells: See :func:`smooth_patch`.
        what: Name of the caller, for messages.
    """
    instance(function, Callable, f"{what}: function", "a function of (a, b)")
    for name, count in zip("ab", cells, strict=True):
        whole(count, f"{what}: cells along {name}")

    def position(a: float, b: float) -> Array:
        return vector(function(a, b), 3, f"the position at ({a:g}, {b:g})")

    nodes: list[Array] = [np.arange(count + 1.0) / count for count in cells]
    return position, (nodes[0], nodes[1])


def from_nodal_vectors(nodal_vectors: Array, spans: tuple[Array, Array]) -> SmoothPatch:
    """Patch with parameters that are lengths.

    Args:
        nodal_vectors: Position, ∂a, ∂b and ∂a∂b at the nodes, shape (na + 1, nb + 1, 4, 3).
        spans: Parameter intervals of the cells in a (na,) and in b (nb,).

    Raises:
        ValueError: Gradients at a node are zero or parallel.
    """
    lengths = [
        float(np.linalg.norm(nodal_vectors[..., 1 + k, :], axis=-1).mean()) or 1.0 for k in range(2)
    ]
    nodal_vectors = (
        nodal_vectors / np.array([1.0, *lengths, lengths[0] * lengths[1]])[:, np.newaxis]
    )
    _check_slopes(nodal_vectors)
    return SmoothPatch(nodal_vectors, (lengths[0] * spans[0], lengths[1] * spans[1]))


def derivatives_of(position: Callable[[float, float], Array], a: float, b: float) -> Array:
    """Position and ∂a, ∂b, ∂a∂b, shape (4, 3)."""
    (x, first), (y, second) = _stencil(a), _stencil(b)
    values = np.array([[position(s, t) for t in y] for s in x])
    mixed = np.einsum("i,j,ijk->k", first, second, values)
    at_a, at_b = int(np.abs(x - a).argmin()), int(np.abs(y - b).argmin())
    return np.array([position(a, b), first @ values[:, at_b], second @ values[at_a], mixed])


def _stencil(at: float) -> tuple[Array, Array]:
    """Points within (0, 1), and the weights of the first derivative at ``at``."""
    last = _STENCIL - 1
    # centred, as far as the interval permits
    low, high = round(at / _STEP), last - round((1.0 - at) / _STEP)
    before = min(max(last // 2, high), low)
    offsets = np.arange(_STENCIL) - float(before)
    powers = np.vander(offsets, increasing=True).T
    weights = np.linalg.solve(powers, np.eye(_STENCIL)[1]) / _STEP
    return np.clip(at + _STEP * offsets, 0.0, 1.0), weights


def _check_slopes(nodal_vectors: Array) -> None:
    first, second = nodal_vectors[..., 1, :], nodal_vectors[..., 2, :]
    sizes = np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1)
    sine = np.linalg.norm(np.cross(first, second), axis=-1)
    bad = np.argwhere(~(sine > 1e-6 * np.maximum(*sizes) ** 2))
    if len(bad):
        i, j = bad[0]
        raise ValueError(
            "a smooth patch needs gradients along a and b that are neither zero nor parallel; "
            f"at {nodal_vectors[i, j, 0]} they are {first[i, j]} and {second[i, j]} (of "
            "parameters that are lengths)"
        )


_DEGREE = 3
_SMOOTH = 2
"""Largest multiplicity of an inner knot with continuous gradients."""


def bspline_patch(
    knots_a: npt.ArrayLike,
    knots_b: npt.ArrayLike,
    controls: npt.ArrayLike,
    *,
    pieces: tuple[int, int] = (1, 1),
) -> SmoothPatch:
    """Patch that represents a bicubic spline surface exactly.

    Args:
        knots_a: Knots of the first parameter, increasing, with multiplicity four at both ends,
            shape (k,).
        knots_b: Knots of the second parameter, shape (l,).
        controls: Control points, shape (k − 4, l − 4, 3).
        pieces: Numbers of equal cells in each knot span, along a and along b.

    Raises:
        ValueError: Knots do not increase, end knots do not have multiplicity four, an inner knot
            has multiplicity three, which is a kink, the number of control points does not match, or
            gradients are zero or parallel.
    """
    points = numbers(controls, "bspline_patch: controls")
    knots, cuts = [], []
    for name, given, count in zip("ab", (knots_a, knots_b), pieces, strict=True):
        knots.append(numbers(given, f"bspline_patch: knots_{name}"))
        cuts.append(whole(count, f"bspline_patch: pieces along {name}"))
        _check_knots(knots[-1], name)
    expected = tuple(len(each) - _DEGREE - 1 for each in knots)
    if points.shape != (*expected, 3):
        raise ValueError(
            f"a bicubic spline of {len(knots[0])} and {len(knots[1])} knots has control points of "
            f"shape {(*expected, 3)}, got {points.shape}"
        )
    at = [_cut(np.unique(each), count) for each, count in zip(knots, cuts, strict=True)]
    nodal_vectors = [
        _evaluated(knots, points, at, orders) for orders in ((0, 0), (1, 0), (0, 1), (1, 1))
    ]
    return from_nodal_vectors(np.stack(nodal_vectors, axis=2), (np.diff(at[0]), np.diff(at[1])))


def spline_patch(function: Surface, cells: tuple[int, int]) -> SmoothPatch:
    """Bicubic spline through points of a surface, with its gradients at the edges.

    Curvatures are continuous, as for a surface from CAD; :func:`~fem_lie.mesh.smooth_patch` uses
    the gradients at all nodes.

    Args:
        function: ``function(a, b)``, shape (3,), a and b from 0 to 1.
        cells: Numbers of cells along a and along b.

    Raises:
        ValueError: As :func:`~fem_lie.mesh.smooth_patch`.
        TypeError: As :func:`~fem_lie.mesh.smooth_patch`.
    """
    position, (a, b) = grid(function, cells, "spline_patch")
    given = np.empty((len(a) + 2, len(b) + 2, 3))
    inner = np.array([[position(s, t) for t in b] for s in a])
    given[1:-1, 1:-1] = inner
    for i, s in ((0, a[0]), (-1, a[-1])):
        found = np.array([derivatives_of(position, s, t) for t in b])
        given[i, 1:-1], given[i, [0, -1]] = found[:, 1], found[[0, -1], 3]
    for j, t in ((0, b[0]), (-1, b[-1])):
        given[1:-1, j] = [derivatives_of(position, s, t)[2] for s in a]
    along = _through(a, given)
    both = _through(b, along.c.swapaxes(0, 1))
    return bspline_patch(along.t, both.t, both.c.swapaxes(0, 1))


def _through(at: Array, given: Array) -> Any:
    """Spline along the first axis from slope, positions and slope in ``given``."""
    ends = [(1, given[0])], [(1, given[-1])]
    return make_interp_spline(at, given[1:-1], k=_DEGREE, bc_type=ends)


def _evaluated(
    knots: list[Array], points: Array, at: list[Array], orders: tuple[int, int]
) -> Array:
    """Derivative of given orders on a grid, shape (i, j, 3)."""
    first = BSpline(knots[0], points, _DEGREE)(at[0], nu=orders[0])
    second = BSpline(knots[1], first.swapaxes(0, 1), _DEGREE)(at[1], nu=orders[1])
    return np.asarray(second.swapaxes(0, 1))


def _cut(knots: Array, count: int) -> Array:
    """Knots with each span divided into ``count`` equal parts."""
    inner = knots[:-1, np.newaxis] + np.diff(knots)[:, np.newaxis] * np.arange(count) / count
    return np.append(inner.ravel(), knots[-1])


def _check_knots(knots: Array, name: str) -> None:
    if knots.ndim != 1 or len(knots) < 2 * (_DEGREE + 1) or (np.diff(knots) < 0).any():
        raise ValueError(
            f"knots of a cubic spline are eight or more that do not decrease, got {knots} along "
            f"{name}"
        )
    found, times = np.unique(knots, return_counts=True)
    if len(found) < 2 or times[0] != _DEGREE + 1 or times[-1] != _DEGREE + 1:
        raise ValueError(f"end knots along {name}: expected multiplicity four, got {knots}")
    kinks = found[1:-1][times[1:-1] > _SMOOTH]
    if len(kinks):
        raise ValueError(
            f"inner knots along {name}: expected multiplicity one or two, for continuous "
            f"gradients, got three or more at {kinks}, where the surface may have a kink; divide "
            "it there"
        )
