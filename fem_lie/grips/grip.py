"""A grip: a frame that moves with nodes of a body, and its derivative in what the nodes do.

Joints, springs, drives, prescribed motions and loads hold on to grips and see nothing but their
frames and twists. A node with a frame is its own grip and is none here. A kind of grip is a file of
two compiled functions of one grip, see :class:`GripKind`; :func:`locate` and :func:`bend` go over
many.

The motion ``hₖ`` of a node is in its own axes, as its velocity and forces are: a frame's twist;
of other kinds of node what they say.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled

_SAME = 1e-12  # of numbers of order one


class MeanCoordinates(NamedTuple):
    """Few sums over the nodes, linear in their motions, of which a frame is a function.

    Attributes:
        size: How many there are, r.
        spread: ``spread(X, data, S)`` sets ``S`` (k, r, 6), so that ``Σ Sₖ hₖ`` are their rates.
        core: ``core(X, data, f, L, C)`` sets ``L`` (6, r), so that the twist is ``L Σ Sₖ hₖ``, and
            ``C`` (r, r), so that the derivative of ``Jᵀf`` in the motions is ``Sᵀ C S``.
    """

    size: int
    spread: Callable[..., None]
    core: Callable[..., None]


class GripKind(NamedTuple):
    """How frames of a kind follow from those of their nodes: compiled functions of one grip.

    Attributes:
        locate: ``locate(X, data, H, J)`` sets the frame ``H`` (4, 3), and ``J`` (k, 6, 6) with its
            twist ``Σ Jₖ hₖ``, from the rows ``X`` (k, 4, 3) of its nodes.
        bend: ``bend(X, data, f, K)`` sets ``K`` (k, 6, k, 6), the derivative of the forces ``Jᵀf``
            on the nodes in their motions, for a force ``f`` (6,) that is constant in the frame.
        rigid: Whether the frame is fixed to that of its only node: what holds on to it may hold on
            to the node.
        summed: Whether its place is a sum over rows of nodes that are no frames, with constant
            factors.
        turns: Whether it turns with these rows about any axis.
        means: Coordinates that keep matrices of many nodes sparse, for kinds that have any.
    """

    locate: Callable[..., None]
    bend: Callable[..., None]
    rigid: bool = False
    summed: bool = False
    turns: bool = False
    means: MeanCoordinates | None = None


class Grip(NamedTuple):
    """A frame that moves with some nodes of one body.

    Attributes:
        kind: How.
        nodes: Of the body, k of them, as many for all grips of a kind.
        data: Numbers that the kind wants, as many for all grips of a kind and number of nodes.
    """

    kind: GripKind
    nodes: tuple[int, ...]
    data: tuple[float, ...]

    def frame(self, frames: Array) -> Array:
        """Where it is, shape (…, 4, 3), if these are the rows of the body's nodes, (…, n, 4, 3)."""
        found, _ = self._located(frames)
        return found.reshape(*frames.shape[:-3], 4, 3)

    def twist(self, frames: Array, v: Array) -> Array:
        """Its twist, shape (…, 6), if the nodes have these twists, shape (…, n, 6)."""
        _, J = self._located(frames)
        own = v[..., list(self.nodes), :].reshape(len(J), -1, 6)
        return np.einsum("gkij,gkj->gi", J, own).reshape(*frames.shape[:-3], 6)

    def spins(self, frames: Array) -> Array:
        """Angular velocity of the frame by the motions of its nodes, shape (k, 3, 6)."""
        _, J = self._located(frames)
        return J[0, :, 3:]

    def _located(self, frames: Array) -> tuple[Array, Array]:
        chosen = frames[..., list(self.nodes), :, :]
        X = np.ascontiguousarray(chosen.reshape(-1, len(self.nodes), 4, 3))
        return locate(self.kind, X, np.tile(np.array(self.data, dtype=np.float64), (len(X), 1)))

    def same(self, other: Grip | None) -> bool:
        """Whether it is the same place."""
        if other is None or self.kind is not other.kind or self.nodes != other.nodes:
            return False
        return bool(np.allclose(self.data, other.data, rtol=0.0, atol=_SAME))


def locate(kind: GripKind, X: Array, data: Array) -> tuple[Array, Array]:
    """Frames (g, 4, 3) and Jacobians (g, k, 6, 6) of grips of one kind.

    Args:
        kind: Of all of them.
        X: Rows of their nodes, shape (g, k, 4, 3).
        data: Of each, shape (g, d).
    """
    frames, J = np.empty((len(X), 4, 3)), np.zeros((len(X), X.shape[1], 6, 6))
    _loop(_locate_each, kind.locate)(X, data, frames, J)
    return frames, J


def bend(kind: GripKind, X: Array, data: Array, forces: Array) -> Array:
    """Derivatives of ``Jᵀf`` in the motions of the nodes, (g, k, 6, k, 6), forces (g, 6)."""
    k = X.shape[1]
    K = np.zeros((len(X), k, 6, k, 6))
    _loop(_bend_each, kind.bend)(X, data, forces, K)
    return K


def spread(means: MeanCoordinates, X: Array, data: Array) -> Array:
    """Rates of mean coordinates by motions of the nodes, (g, k, r, 6)."""
    S = np.zeros((*X.shape[:2], means.size, 6))
    _loop(_spread_each, means.spread)(X, data, S)
    return S


def cores(means: MeanCoordinates, X: Array, data: Array, forces: Array) -> tuple[Array, Array]:
    """``L`` (g, 6, r) and, for forces (g, 6), ``C`` (g, r, r): see :class:`MeanCoordinates`."""
    g, r = len(X), means.size
    L, C = np.zeros((g, 6, r)), np.zeros((g, r, r))
    _loop(_core_each, means.core)(X, data, forces, L, C)
    return L, C


def changes(kind: GripKind, X: Array, data: Array, h: Array) -> Array:
    """How twists change along constant motions ``h`` (g, k, 6) of the nodes: ``J̇ h``, (g, 6).

    A force ``f`` has the power ``f·J h``, so that ``f·J̇ h = h·(∂(Jᵀf)/∂h) h``.
    """
    found, units = np.empty((len(X), 6)), np.eye(6)
    if kind.means is not None:
        s = np.einsum("gkri,gki->gr", spread(kind.means, X, data), h)
        for i, unit in enumerate(units):
            _, C = cores(kind.means, X, data, np.tile(unit, (len(X), 1)))
            found[:, i] = np.einsum("gr,grs,gs->g", s, C, s)
        return found
    for i, unit in enumerate(units):
        K = bend(kind, X, data, np.tile(unit, (len(X), 1)))
        found[:, i] = np.einsum("gai,gaibj,gbj->g", h, K, h)
    return found


@cache
def _loop(template: FunctionType, kernel: Callable[..., None]) -> Any:
    """Compiled loop of ``kernel``, a global name of it: the disk cache knows no closures.

    It stands in the kernel's file, whose content decides whether its machine code is still right.
    """
    file = inspect.getfile(inspect.unwrap(kernel))
    namespace = {"_kernel": kernel, "__name__": kernel.__module__}
    loop = FunctionType(template.__code__.replace(co_filename=file), namespace, template.__name__)
    loop.__qualname__ = f"{kernel.__name__}_loop"
    return compiled(loop)


def _locate_each(X: Array, data: Array, frames: Array, J: Array) -> None:
    for g in range(X.shape[0]):
        _kernel(X[g], data[g], frames[g], J[g])


def _bend_each(X: Array, data: Array, forces: Array, K: Array) -> None:
    for g in range(X.shape[0]):
        _kernel(X[g], data[g], forces[g], K[g])


def _spread_each(X: Array, data: Array, S: Array) -> None:
    for g in range(X.shape[0]):
        _kernel(X[g], data[g], S[g])


def _core_each(X: Array, data: Array, forces: Array, L: Array, C: Array) -> None:
    for g in range(X.shape[0]):
        _kernel(X[g], data[g], forces[g], L[g], C[g])


def _kernel(*views: Array) -> None:
    """Stands in the loops for the function that :func:`_loop` puts there."""
