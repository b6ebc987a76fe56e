"""An attachment frame: a frame that depends on nodes of a body, with its Jacobian.

Joints, springs, drives, prescribed motions and loads act on attachment frames and use only their
frames and twists. A node that has a frame of its own needs no attachment frame. A kind of
attachment frame is a file with two compiled functions for a single attachment, see
:class:`AttachmentKind`; :func:`locate` and :func:`bend` evaluate many attachments at once.

The velocity (or variation) ``hₖ`` of a node has components along the node's own axes, as its force
has. For a node with a frame it is the twist; other node types define their own components.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Scalar
from fem_lie._jit import compiled

_SAME = 1e-12  # of numbers of order one


class MeanCoordinates(NamedTuple):
    """A few linear functionals of the nodal motions that determine the attachment frame.

    Attributes:
        size: Number of mean coordinates, r.
        spread: ``spread(X, data, S)`` sets the Jacobian ``S`` (k, r, 6) of the mean coordinates, so
            that ``Σ Sₖ hₖ`` are their rates.
        core: ``core(X, data, f, L, C)`` sets ``L`` (6, r), so that the twist of the frame is
            ``L Σ Sₖ hₖ``, and ``C`` (r, r), so that ``Sᵀ C S`` is the derivative of the nodal
            forces ``Jᵀf`` in the nodal motions.
    """

    size: int
    spread: Callable[..., None]
    core: Callable[..., None]


class AttachmentKind(NamedTuple):
    """How frames of one kind depend on their nodes: compiled functions for one attachment.

    Attributes:
        locate: ``locate(X, data, H, J)`` sets the frame ``H`` (4, 3) and the Jacobian ``J`` (k, 6,
            6), with which its twist is ``Σ Jₖ hₖ``, from the nodal coordinates ``X`` (k, 4, 3).
        bend: ``bend(X, data, f, K)`` sets the geometric stiffness ``K`` (k, 6, k, 6): the
            derivative of the nodal forces ``Jᵀf`` in the nodal motions, for a force and moment
            ``f`` (6,) that is constant in the attachment frame.
        rigid: Whether the frame is rigidly fixed to the frame of its only node. Joints may then act
            on the node directly.
        summed: Whether the position is a linear combination of nodal coordinate vectors, with
            constant coefficients, of nodes that have no frame.
        turns: Whether a rigid rotation of these nodal vectors about any axis rotates the frame.
        means: Mean coordinates that keep the matrix sparse when the attachment has many nodes, or
            ``None``.
    """

    locate: Callable[..., None]
    bend: Callable[..., None]
    rigid: bool = False
    summed: bool = False
    turns: bool = False
    means: MeanCoordinates | None = None


class AttachmentFrame(NamedTuple):
    """A frame that depends on some nodes of one body.

    Attributes:
        kind: How the frame depends on the nodes.
        nodes: Numbers of the k nodes in the body. All attachments that are evaluated together have
            as many nodes.
        data: Parameters of the kind, such as shape function values. Their number depends only on
            the kind and the number of nodes.
    """

    kind: AttachmentKind
    nodes: tuple[int, ...]
    data: tuple[float, ...]

    def frame(self, frames: Array) -> Array:
        """Frame, shape (…, 4, 3), for nodal coordinates of the body, shape (…, n, 4, 3)."""
        found, _ = self._located(frames)
        return found.reshape(*frames.shape[:-3], 4, 3)

    def twist(self, frames: Array, v: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
        """Twist of the frame, shape (…, 6), for nodal twists, shape (…, n, 6)."""
        _, J = self._located(frames)
        own = v[..., list(self.nodes), :].reshape(len(J), -1, 6)
        return np.asarray(np.einsum("gkij,gkj->gi", J, own)).reshape(*frames.shape[:-3], 6)

    def spins(self, frames: Array) -> Array:
        """Angular velocity of the frame per unit motion of each node, shape (k, 3, 6)."""
        _, J = self._located(frames)
        return J[0, :, 3:]

    def _located(self, frames: Array) -> tuple[Array, Array]:
        chosen = frames[..., list(self.nodes), :, :]
        X = np.ascontiguousarray(chosen.reshape(-1, len(self.nodes), 4, 3))
        return locate(self.kind, X, np.tile(np.array(self.data, dtype=np.float64), (len(X), 1)))

    def same(self, other: AttachmentFrame | None) -> bool:
        """Whether both depend on the same nodes in the same way."""
        if other is None or self.kind is not other.kind or self.nodes != other.nodes:
            return False
        return bool(np.allclose(self.data, other.data, rtol=0.0, atol=_SAME))


def locate(kind: AttachmentKind, X: Array, data: Array) -> tuple[Array, Array]:
    """Frames, shape (g, 4, 3), and Jacobians, shape (g, k, 6, 6), of g attachments of one kind.

    Args:
        kind: The kind of all of them.
        X: Nodal coordinates, shape (g, k, 4, 3).
        data: Parameters of the kind, shape (g, …).
    """
    frames, J = np.empty((len(X), 4, 3)), np.zeros((len(X), X.shape[1], 6, 6))
    _loop(_locate_each, kind.locate)(X, data, frames, J)
    return frames, J


def bend(kind: AttachmentKind, X: Array, data: Array, forces: Array) -> Array:
    """Geometric stiffness of g attachments, the derivative of ``Jᵀf``, shape (g, k, 6, k, 6).

    Args:
        kind: The kind of all of them.
        X: Nodal coordinates, shape (g, k, 4, 3).
        data: Parameters of the kind, shape (g, …).
        forces: Force and moment in each attachment frame, shape (g, 6).
    """
    k = X.shape[1]
    K = np.zeros((len(X), k, 6, k, 6))
    _loop(_bend_each, kind.bend)(X, data, forces, K)
    return K


def spread(means: MeanCoordinates, X: Array, data: Array) -> Array:
    """Jacobian of the mean coordinates in the nodal motions, shape (g, k, r, 6)."""
    S = np.zeros((*X.shape[:2], means.size, 6))
    _loop(_spread_each, means.spread)(X, data, S)
    return S


def cores(means: MeanCoordinates, X: Array, data: Array, forces: Array) -> tuple[Array, Array]:
    """``L`` (g, 6, r) and, for forces (g, 6), ``C`` (g, r, r): see :class:`MeanCoordinates`."""
    g, r = len(X), means.size
    L, C = np.zeros((g, 6, r)), np.zeros((g, r, r))
    _loop(_core_each, means.core)(X, data, forces, L, C)
    return L, C


def changes(kind: AttachmentKind, X: Array, data: Array, h: Array) -> Array:
    """Acceleration of each frame at constant nodal motions ``h`` (g, k, 6): ``J̇ h``, shape (g, 6).

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
    """Compile the loop ``template`` over ``kernel``, which it calls as a global name.

    The disk cache of Numba does not cover closures. The loop is compiled as if it were in the file
    of the kernel, so that the cache is renewed when that file changes.
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
    """Placeholder for the kernel that :func:`_loop` inserts into the loops."""
