"""A body by itself: forces, matrix and postures of its term on its own nodes."""

import numpy as np

from fem_lie.extend import node_types


class BodyAlone:
    """A body and what its kind assembles of it.

    Attributes:
        size: Of the increments that deform it.
    """

    size = 0.1

    def __init__(self, body, term):
        self.body, self.term, self.kinds = body, term, body.model.node_types
        self.count = len(self.kinds)
        self.rng = np.random.default_rng(1)

    def follow(self, H, h):
        out = np.empty_like(H)
        node_types.retract_all(self.kinds, H, h, out)
        return out

    def deformed(self):
        return self.follow(self.body.frames, self.size * self.rng.normal(size=(self.count, 6)))

    def forces(self, H):
        out = np.zeros((self.count, 6))
        self.term.add_forces(H, out)
        return out

    def matrix(self, H):
        self.term.reset_stress(H)
        K, (rows, columns) = np.zeros((self.count, 6, self.count, 6)), self.term.pairs
        K[rows, :, columns] = self.term.tangent(H, np.empty((0, 6)))
        return K.reshape(6 * self.count, -1)

    def turned(self, H, motion):
        """Moved rigidly, the axes as the body turns them then."""
        moved = H @ motion[1:]
        moved[:, 0] += motion[0]
        # row 3 of the second nodes of plates is no vector: the body sets it
        self.body.model.axes_update()(moved)
        return moved
