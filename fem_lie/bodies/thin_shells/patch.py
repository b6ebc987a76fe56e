"""Smooth patches: what a thin shell lies on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, instance, vector, whole

Surface = Callable[[float, float], npt.ArrayLike]
"""A place (3,) for parameters (a, b) between 0 and 1, smooth."""

_STEP, _STENCIL = 0.01, 9
"""Of differences, in the parameters: at the edges they look to the inside."""


@dataclass(frozen=True, eq=False)
class SmoothPatch:
    """A surface over a rectangle of parameters, by its places and derivatives at a grid of nodes.

    Parameters are lengths: those of the middle lines along a and along b.

    Attributes:
        rows: Place, ∂u, ∂v and ∂u∂v at the nodes, shape (na + 1, nb + 1, 4, 3).
        sizes: Of the cells along u (na,) and along v (nb,).
    """

    rows: Array
    sizes: tuple[Array, Array]


def smooth_patch(function: Surface, cells: tuple[int, int]) -> SmoothPatch:
    """A patch of ``cells`` equal cells on a surface given as a function, a and b from 0 to 1.

    The surface between the nodes is the bicubic with the places and derivatives there; these are
    found by differences of eighth order.

    Args:
        function: ``function(a, b)``, shape (3,).
        cells: Along a and along b.

    Raises:
        ValueError: There is no cell, a place is not finite, or the slopes at a node are zero or
            along each other.
        TypeError: The function is none, or the numbers of cells are not whole.
    """
    place, grids = grid(function, cells, "smooth_patch")
    rows = np.array([[derivatives_of(place, a, b) for b in grids[1]] for a in grids[0]])
    return from_rows(rows, (np.diff(grids[0]), np.diff(grids[1])))


def grid(
    function: Surface, cells: tuple[int, int], what: str
) -> tuple[Callable[[float, float], Array], tuple[Array, Array]]:
    """The function with its values checked, and the parameters of the nodes.

    Args:
        function: See :func:`smooth_patch`.
        cells: Likewise.
        what: Is to be made, for messages.
    """
    instance(function, Callable, f"{what}: function", "a function of (a, b)")
    for name, count in zip("ab", cells, strict=True):
        whole(count, f"{what}: cells along {name}")

    def place(a: float, b: float) -> Array:
        return vector(function(a, b), 3, f"the place at ({a:g}, {b:g})")

    nodes: list[Array] = [np.arange(count + 1.0) / count for count in cells]
    return place, (nodes[0], nodes[1])


def from_rows(rows: Array, spans: tuple[Array, Array]) -> SmoothPatch:
    """A patch with parameters that are lengths.

    Args:
        rows: Place, ∂a, ∂b and ∂a∂b at the nodes, shape (na + 1, nb + 1, 4, 3).
        spans: Of the cells in a (na,) and in b (nb,).

    Raises:
        ValueError: Slopes at a node are zero or along each other.
    """
    lengths = [float(np.linalg.norm(rows[..., 1 + k, :], axis=-1).mean()) or 1.0 for k in range(2)]
    rows = rows / np.array([1.0, *lengths, lengths[0] * lengths[1]])[:, np.newaxis]
    _check_slopes(rows)
    return SmoothPatch(rows, (lengths[0] * spans[0], lengths[1] * spans[1]))


def derivatives_of(place: Callable[[float, float], Array], a: float, b: float) -> Array:
    """Place and ∂a, ∂b, ∂a∂b, shape (4, 3)."""
    (x, first), (y, second) = _stencil(a), _stencil(b)
    values = np.array([[place(s, t) for t in y] for s in x])
    mixed = np.einsum("i,j,ijk->k", first, second, values)
    at_a, at_b = int(np.abs(x - a).argmin()), int(np.abs(y - b).argmin())
    return np.array([place(a, b), first @ values[:, at_b], second @ values[at_a], mixed])


def _stencil(at: float) -> tuple[Array, Array]:
    """Places within (0, 1) and the weights of a derivative at one of them."""
    last = _STENCIL - 1
    # as many on either side as there is room for
    low, high = round(at / _STEP), last - round((1.0 - at) / _STEP)
    before = min(max(last // 2, high), low)
    offsets = np.arange(_STENCIL) - float(before)
    powers = np.vander(offsets, increasing=True).T
    weights = np.linalg.solve(powers, np.eye(_STENCIL)[1]) / _STEP
    return np.clip(at + _STEP * offsets, 0.0, 1.0), weights


def _check_slopes(rows: Array) -> None:
    first, second = rows[..., 1, :], rows[..., 2, :]
    sizes = np.linalg.norm(first, axis=-1), np.linalg.norm(second, axis=-1)
    sine = np.linalg.norm(np.cross(first, second), axis=-1)
    bad = np.argwhere(~(sine > 1e-6 * np.maximum(*sizes) ** 2))
    if len(bad):
        i, j = bad[0]
        raise ValueError(
            "a smooth patch needs slopes along a and b that are neither zero nor along each other; "
            f"at {rows[i, j, 0]} they are {first[i, j]} and {second[i, j]} (of parameters that are "
            "lengths)"
        )
