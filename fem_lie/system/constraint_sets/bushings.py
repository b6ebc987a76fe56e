"""Springs and dampers of six components between two frames: a set without constraints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.joints.connection import LostBranchError
from fem_lie.joints.equations import bushings
from fem_lie.joints.equations.bushings import BushingArrays
from fem_lie.linear.saddle_point import Incidences
from fem_lie.system.constraint_sets.constraint_set import (
    ConstrainedFrames,
    ConstraintSet,
    Numbered,
    Place,
    Start,
    initial_frames,
    places,
    relative_frames,
    stacked,
)

_LARGEST = 0.95 * np.pi
"""Relative rotation, rad, beyond which the next step may choose the other rotation vector."""


class Bushings(ConstraintSet):
    """Set of bushings, see :mod:`fem_lie.joints.equations.bushings`.

    Attributes:
        arrays: Packed arrays of all of them.
    """

    what = "bushings (Bushing)"

    def __init__(
        self, items: Sequence[Numbered], constrained: ConstrainedFrames, start: Start
    ) -> None:
        """Build the arrays of all bushings."""
        found = [
            (given, definition)
            for given in items
            if (definition := given.item.bushing_definition()) is not None
        ]
        self.start, self._count = start, constrained.count
        self._items: Indices = np.array([given.number for given, _ in found], dtype=np.int64)
        self._labels = [given.item.label for given, _ in found]
        definitions = [definition for _, definition in found]
        none = np.empty(0, dtype=np.int64)
        self.owner, self.angular = none, np.empty(0, dtype=bool)
        self.incidences, self.targets = Incidences.of([], constrained.count), np.empty(0)
        nodes = np.array(
            [(constrained.of(each.a), constrained.of(each.b)) for each in definitions],
            dtype=np.int64,
        ).reshape(-1, 2)
        frames = np.array([each.frames for each in definitions]).reshape(-1, 2, 4, 3)
        points = [point for each in definitions for point in (each.a, each.b)]
        self.arrays = BushingArrays(
            nodes=nodes,
            frames=relative_frames(constrained, points, frames),
            rest=np.zeros((len(nodes), 6)),
            stiffness=stacked([each.stiffness[np.newaxis] for each in definitions], 0, 6, 6),
            damping=stacked([each.damping[np.newaxis] for each in definitions], 0, 6, 6),
        )
        if not self.empty:
            pairs = self.arrays._replace(nodes=np.arange(2 * len(nodes)).reshape(-1, 2))
            bushings.relative_motions(initial_frames(constrained, points), pairs, pairs.rest)
        self._rest = self.arrays.rest.copy()
        sides = np.stack(list(nodes.T), axis=1) if len(nodes) else nodes
        self.pairs = (
            np.repeat(sides[:, :, np.newaxis], 2, axis=2),
            np.repeat(sides[:, np.newaxis], 2, axis=1),
        )

    @property
    def empty(self) -> bool:
        """Whether there is no bushing."""
        return len(self.arrays.nodes) == 0

    def evaluate(
        self, H: Array, v: Array, multipliers: Array, scale: Array, count: int, r: Array
    ) -> None:
        """Add the forces to ``r``."""
        bushings.evaluate(H, v, self.arrays, count, r)

    def values(self, H: Array, v: Array, out: Array) -> None:
        """Set nothing: there are no constraints."""

    def jacobian(self, H: Array, rows: Array) -> None:
        """Add nothing: there are no constraints."""

    def geometric(self, H: Array, multipliers: Array, index: Indices, K: Array) -> None:
        """Add the derivative of the forces at constant ``N``, without stiffness and damping."""
        bushings.geometric(H, self.arrays, index, K)

    def rates(self, H: Array, v: Array, first: Array, second: Array) -> None:
        """Set nothing: there are no constraints."""

    @property
    def springs(self) -> Array:
        """Largest stiffness, largest damping and 0 of each bushing, shape (j, 3)."""
        arrays = self.arrays
        sizes = [np.abs(each).max(axis=(1, 2)) for each in (arrays.stiffness, arrays.damping)]
        return np.column_stack([*sizes, np.zeros(len(arrays.nodes))])

    def stiffen(
        self, H: Array, v: Array, index: Indices, stiff: float, damp: float, K: Array
    ) -> None:
        """Add ``Dᵀ (stiff K + damp C) D`` to blocks, as :meth:`geometric`."""
        bushings.stiffen(H, self.arrays, index, stiff, damp, K)

    def stretch_springs(self, H: Array, h: Array) -> None:
        """Change the relative motions without force by those along ``h`` (n, 6)."""
        changes = np.empty_like(self._rest)
        bushings.relative_rates(H, h, self.arrays, changes)
        self.arrays.rest[:] = self._rest - changes

    def spring_energy(self, H: Array) -> float:
        """Energy ``½ (d − d₀)·K (d − d₀)``."""
        d = self._motions(H) - self.arrays.rest
        return float(0.5 * np.einsum("ji,jik,jk->", d, self.arrays.stiffness, d))

    def damper_loss(self, H: Array, v: Array, multipliers: Array) -> float:
        """Power ``ḋ·C ḋ`` dissipated by the dampers."""
        rates = np.empty((len(self.arrays.nodes), 6))
        bushings.relative_rates(H, v, self.arrays, rates)
        return float(np.einsum("ji,jik,jk->", rates, self.arrays.damping, rates))

    def _motions(self, H: Array) -> Array:
        found = np.empty((len(self.arrays.nodes), 6))
        bushings.relative_motions(H, self.arrays, found)
        return found

    def check_branch(self, H: Array) -> None:
        """Refuse a state in which a bushing is rotated by almost half a turn."""
        angles = np.linalg.norm(self._motions(H)[:, 3:], axis=1)
        k = int(angles.argmax())
        if angles[k] > _LARGEST:
            raise LostBranchError(
                f"{self._labels[k]} is rotated by {angles[k]:.3g} rad; a rotation vector is unique "
                f"up to half a turn, expected less than {_LARGEST:.3g} rad: let a bushing that is "
                "the bearing of a rotor carry a light body, and join the rotor to it by a Revolute"
            )

    def accept(self, H: Array) -> None:
        """Refuse a state in which a bushing is rotated by almost half a turn."""
        self.check_branch(H)

    def wrenches(self, H: Array, v: Array, multipliers: Array, out: Array) -> None:
        """Add force and moment on side A of each item, in its axes there, to the rows of items."""
        found = np.empty((len(self.arrays.nodes), 2, 6))
        bushings.wrenches(H, v, self.arrays, found)
        out[self._items] -= found[:, 0]

    def places(self) -> dict[int, Place]:
        """Position on side A of each item, or on side B if A is ground, and axes of its force."""
        return places(self._items, self.arrays.nodes, self.arrays.frames, self._count)

    @property
    def outward(self) -> bool:
        """Whether there are dampers, or connections to ground or prescribed motions."""
        arrays = self.arrays
        return bool((arrays.nodes >= self._count).any() or arrays.damping.any())
