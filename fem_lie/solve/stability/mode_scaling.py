"""How modes are scaled: by their largest displacement, or by rotation where they only turn.

Which of them only turn is decided node by node: a node that turns by θ, with cells of length l
around it, moves by a good part of l θ in any wave that the mesh can show, be it as short as it may,
and be the scene as large. What is left of a mode that only turns is round-off.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Body

Shape = npt.NDArray[np.float64] | npt.NDArray[np.complex128]

_NIL = 1e-5  # displacement over length of the cells and rotation: below, it is round-off


def node_lengths(nodes: Mapping[Body, Indices]) -> Array:
    """Length of the longest edge at each node, or the size of a body without cells, shape (N,).

    Args:
        nodes: Numbers of the nodes of each body among all.
    """
    lengths = np.zeros(sum(map(len, nodes.values())))
    for body, numbers in nodes.items():
        edges = _edges(body)
        along = np.linalg.norm(np.diff(body.frames[edges, 0], axis=1)[:, 0], axis=1)
        own = np.zeros(len(numbers))
        for end in edges.T:
            np.maximum.at(own, end, along)
        lengths[numbers] = np.where(own > 0, own, body.size)
    return lengths


def largest_elongation(nodes: Mapping[Body, Indices], frames: Array, twists: Array) -> float:
    """Largest elongation of an edge of a cell over its length, to first order; 0 without cells.

    Args:
        nodes: Numbers of the nodes of each body among all.
        frames: Of all nodes, shape (N, 4, 3).
        twists: Increments (translation, rotation) of all nodes along them, shape (N, 6).
    """
    moved, largest = np.einsum("nij,ni->nj", frames[:, 1:], twists[:, :3]), 0.0
    for body, numbers in nodes.items():
        edges = numbers[_edges(body)]
        chord, change = (np.diff(x[edges], axis=1)[:, 0] for x in (frames[:, 0], moved))
        elongation = np.abs((chord * change).sum(axis=1)) / (chord * chord).sum(axis=1)
        largest = max(largest, float(elongation.max(initial=0.0)))
    return largest


def _edges(body: Body) -> Indices:
    """Nodes at both ends of each edge of the cells, shape (e, 2)."""
    corners = body.faces
    pairs = np.stack([corners, np.roll(corners, 1, axis=1)], axis=-1).reshape(-1, 2)
    return np.concatenate([body.cells, pairs])


def scaled(shape: Shape, lengths: Array) -> tuple[Shape, bool]:
    """A mode with the largest component of its largest displacement at +1, and False.

    Or with that of its largest rotation there, and True, if it only turns.

    Args:
        shape: Increments (translation, rotation) of all nodes, (N, 6).
        lengths: See :func:`node_lengths`.
    """
    shift, turn = (np.linalg.norm(shape[:, part], axis=1) for part in (slice(3), slice(3, 6)))
    turns_only = bool(shift.max() <= _NIL * (lengths * turn).max())
    size = turn if turns_only else shift
    node = int(size.argmax())
    vector = shape[node, 3:] if turns_only else shape[node, :3]
    largest = vector[np.abs(vector).argmax()]
    return np.asarray(shape * (np.abs(largest) / largest) / size[node]), turns_only
