"""Force and moment at an attachment frame, as a term on the nodes that the frame depends on.

A load that is fixed in space has the components ``f = (RᵀF, RᵀM)`` in the attachment frame. A
follower load has constant components ``f``. The nodal forces are ``Jᵀf``.
"""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.attachments.attachment import AttachmentFrame, bend, locate
from fem_lie.forms.term import Pairs, Term


class AttachmentLoad(Term):
    """A force and moment at one attachment frame."""

    label, load, of_bodies = "loads on points that are not nodes", True, True

    def __init__(
        self, attachment: AttachmentFrame, nodes: Indices, wrench: Array, *, following: bool
    ) -> None:
        """Store the load.

        Args:
            attachment: Where the load acts.
            nodes: Numbers of the nodes of the attachment in the scene, shape (k,).
            wrench: Force and moment, shape (6,), in global components, or in those of the
                attachment frame for a follower load.
            following: Whether the load rotates with the frame.
        """
        self._kind, self._nodes = attachment.kind, nodes
        self._data = np.array(attachment.data, dtype=np.float64)[np.newaxis]
        self._wrench, self._following = np.array(wrench, dtype=np.float64), following
        self.turning = following or bool(self._wrench[3:].any())
        # a force fixed in space on a mean of positions is the same on its nodes wherever they are
        self._constant = attachment.kind.means is not None and not self.turning
        coupled = nodes[:0] if self._constant else nodes
        k = len(coupled)
        self._pairs = np.repeat(coupled, k), np.tile(coupled, k)

    @property
    def pairs(self) -> Pairs:
        """All pairs of nodes of the attachment; none if the nodal forces are constant."""
        return self._pairs

    @property
    def contents(self) -> object:
        """All that defines the load, for the fingerprint of the scene."""
        return self._nodes, self._data, self._wrench, self._following

    def _local(self, frame: Array) -> Array:
        """Force and moment in the attachment frame, shape (6,)."""
        if self._following:
            return self._wrench
        return np.asarray(frame[1:] @ self._wrench.reshape(2, 3).T).T.ravel()

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Subtract the nodal forces ``Jᵀf`` from the residual ``out``."""
        (frame,), (J,) = locate(self._kind, H[self._nodes][np.newaxis], self._data)
        pulled = np.einsum("kij,i->kj", J, self._local(frame))
        np.subtract.at(out, self._nodes, self.amplitude * pulled)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Derivative of ``−Jᵀf`` in the nodal motions, shape (k², 6, 6)."""
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
