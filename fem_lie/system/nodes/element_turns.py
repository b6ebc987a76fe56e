"""How far elements turn from end to end, and how far they may.

Every element that is interpolated between nodes has a turn beyond which it folds: its bending
moment has a maximum over the turn, and states beyond it, though in equilibrium, are no solutions of
the beam or shell. Logarithms of relative motions end at π.

| element | turn |
| --- | --- |
| geodesic, directors of two nodes | π, where the rotation has two logarithms |
| directors of three nodes | 1.5266: the node inside runs away to one end |
| shells with two nodes along an edge | π/2: the moment goes with the sine; π if decoupled |
| shells with three | 3.0: nearly π, where their directors are opposite |
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import uncounted
from fem_lie.bodies.turning import FoldedElementError

if TYPE_CHECKING:
    from fem_lie.system.nodes.numbering import Numbering

_NEAR, _SUSPECT = 0.9, 0.7  # of the limit


Found: TypeAlias = tuple[int, float, bool]
"""What :func:`nearest` finds."""


class CoarseElementsWarning(UserWarning):
    """Elements turn almost as far as they may: results are not to be trusted much farther."""


class Turn(NamedTuple):
    """The element that is nearest to its limit.

    Attributes:
        body: Label of its body.
        element: Its number there.
        angle: From end to end, rad.
        limit: Largest angle that it may have, rad.
    """

    body: str
    element: int
    angle: float
    limit: float

    def __str__(self) -> str:
        """What is wrong, and the remedy."""
        return (
            f"element {self.element} of {self.body} turns by {self.angle:.3g} rad from end to end; "
            f"elements of this kind fold at {self.limit:.3g} rad: use at least "
            f"{max(2, int(np.ceil(2 * self.angle / self.limit)))} elements in its place"
        )


class ElementTurns:
    """The turns of all elements of a scene; it warns of them once."""

    def __init__(self, numbering: Numbering) -> None:
        """Collect the elements of all bodies."""
        self._bodies: list[str] = []
        rows, numbers, limits, whole = [], [], [], []
        for body, nodes in numbering.nodes.items():
            turning = body.turning()
            if turning is None:
                continue
            along, count = nodes[turning.nodes], len(turning.nodes)
            rows.append(along[:, [0, -1, -1]] if along.shape[1] == 2 else along)
            limits.append(np.full(count, turning.limit))
            whole.append(np.full(count, int(turning.whole)))
            self._bodies += [body.label] * count
            numbers.append(turning.elements)
        none = np.empty(0, dtype=np.int64)
        self._nodes: Indices = np.concatenate([np.empty((0, 3), dtype=np.int64), *rows])
        self._limits: Array = np.concatenate([np.empty(0), *limits])
        self._whole: Indices = np.concatenate([none, *whole])
        self._numbers: Indices = np.concatenate([none, *numbers])
        self._any, self._warned = bool(rows), False

    @property
    def elements(self) -> tuple[Array, Indices, Indices]:
        """Limits (w,), nodes from end to end (w, 3), and whether whole frames turn (w,)."""
        return self._limits, self._nodes, self._whole

    def largest(self, frames: Array) -> Turn | None:
        """The element nearest to its limit at frames of all nodes, (n, 4, 3); none if none turn."""
        if not self._any:
            return None
        row, angle, _ = nearest(frames, self._nodes, self._limits, self._whole)
        return self._turn(row, angle)

    def _turn(self, row: int, angle: float) -> Turn:
        return Turn(self._bodies[row], int(self._numbers[row]), angle, float(self._limits[row]))

    def hint(self, frames: Array) -> str:
        """What to say of the element nearest to its limit after a failure, if it is near."""
        turn = self.largest(frames)
        if turn is None or turn.angle <= _SUSPECT * turn.limit:
            return ""
        return f" There {turn}."

    def check(self, frames: Array, when: str | float) -> None:
        """Warn, once, where an element is near its limit.

        Args:
            frames: Of all nodes, shape (n, 4, 3).
            when: Of which state, for messages; a number is a time.

        Raises:
            FoldedElementError: An element is beyond it.
        """
        row, angle, near = nearest(frames, self._nodes, self._limits, self._whole)
        if not near:
            return
        turn, state = self._turn(row, angle), when if isinstance(when, str) else f"at time {when:g}"
        if turn.angle > turn.limit:
            raise FoldedElementError(f"{state} {turn}")
        if not self._warned:
            self._warned = True
            warnings.warn(f"{state} {turn}", CoarseElementsWarning, stacklevel=2)


@uncounted
def nearest(H: Array, nodes: Indices, limits: Array, whole: Indices) -> Found:
    """Row whose turn is the largest part of its limit, that turn, and whether it is to be judged.

    0, 0 and not if there is none.
    """
    worst, row, angle = -1.0, 0, 0.0
    for w in range(nodes.shape[0]):
        turn = 0.0
        for k in range(2):
            a, b = nodes[w, k], nodes[w, k + 1]
            if a == b:
                continue
            cosine, first = 0.0, 1 if whole[w] else 3
            for d in range(first, 4):
                for j in range(3):
                    cosine += H[a, d, j] * H[b, d, j]
            if whole[w]:
                cosine = 0.5 * (cosine - 1.0)
            turn += np.arccos(min(1.0, max(-1.0, cosine)))
        if turn > worst * limits[w]:
            worst, row, angle = turn / limits[w], w, turn
    # what is not a number is judged, too
    return row, angle, limits.shape[0] > 0 and not angle <= _NEAR * limits[row]
