"""Force and moment on a place that is no node: a term on the nodes that move it.

Fixed in space they are ``f = (RᵀF, RᵀM)`` in the frame of the place, or ``f`` itself is constant if
they follow it. What the nodes feel is ``Jᵀf``.
"""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.forms.term import Pairs, Term
from fem_lie.grips.grip import Grip, bend, locate


class HeldLoad(Term):
    """A load on one grip."""

    label, load, of_bodies = "loads on points that are not nodes", True, True

    def __init__(self, grip: Grip, nodes: Indices, wrench: Array, *, following: bool) -> None:
        """Keep the load.

        Args:
            grip: Where.
            nodes: Those of the grip among all, shape (k,).
            wrench: Force and moment, global components, or of the place's frame, shape (6,).
            following: Whether they turn with that.
        """
        self._kind, self._nodes = grip.kind, nodes
        self._data = np.array(grip.data, dtype=np.float64)[np.newaxis]
        self._wrench, self._following = np.array(wrench, dtype=np.float64), following
        self.turning = following or bool(self._wrench[3:].any())
        # a force fixed in space on a mean of positions is the same on its nodes wherever they are
        self._constant = grip.kind.means is not None and not self.turning
        coupled = nodes[:0] if self._constant else nodes
        k = len(coupled)
        self._pairs = np.repeat(coupled, k), np.tile(coupled, k)

    @property
    def pairs(self) -> Pairs:
        """All of its nodes with all, or none if the forces on them are constant."""
        return self._pairs

    @property
    def contents(self) -> object:
        """See the base class."""
        return self._nodes, self._data, self._wrench, self._following

    def _local(self, frame: Array) -> Array:
        """In the frame of the place, shape (6,)."""
        if self._following:
            return self._wrench
        return np.asarray(frame[1:] @ self._wrench.reshape(2, 3).T).T.ravel()

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """See the base class."""
        (frame,), (J,) = locate(self._kind, H[self._nodes][np.newaxis], self._data)
        pulled = np.einsum("kij,i->kj", J, self._local(frame))
        np.subtract.at(out, self._nodes, self.amplitude * pulled)

    def tangent(self, H: Array, kept: Array) -> Array:
        """The change of the Jacobian, and of a load in the frame if it is fixed in space."""
        if self._constant:
            return np.zeros((0, 6, 6))
        X = H[self._nodes][np.newaxis]
        (frame,), (J,) = locate(self._kind, X, self._data)
        f = self._local(frame)
        (K,) = bend(self._kind, X, self._data, f[np.newaxis])
        if not self._following:
            turned = np.zeros((6, 6))
            turned[:3, 3:], turned[3:, 3:] = lie.hat(f[:3]), lie.hat(f[3:])
            K += np.einsum("aki,kl,blj->aibj", J, turned, J)
        blocks = K.transpose(0, 2, 1, 3).reshape(-1, 6, 6)
        return np.asarray(-self.amplitude * blocks)
