"""Along which nodes the elements of a body turn."""

from __future__ import annotations

from dataclasses import dataclass

from fem_lie._arrays import Array, Indices


class FoldedElementError(ArithmeticError):
    """An element turns farther than it may."""


@dataclass(frozen=True, eq=False)
class Turning:
    """Along which nodes the elements of a body turn, and how far they may.

    Attributes:
        nodes: Nodes from end to end, shape (w, 2 or 3).
        elements: Number of the element of each of these rows, shape (w,).
        limit: Largest sum of the turns from node to node, rad.
        whole: Whether whole frames turn, or third directors.
        lengths: Unloaded arc length of each row, if its axial strain and shear are to be judged.
    """

    nodes: Indices
    elements: Indices
    limit: float
    whole: bool
    lengths: Array | None = None
