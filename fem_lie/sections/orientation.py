"""Frames along a line mesh: e₁ along the tangent, e₂ and e₃ by a direction or without twist.

Every *end of a cell* gets a frame. Ends that meet at a point share a node if their frames agree. At
a kink, at a branch, or where the direction of the section changes they do not, and the other nodes
of the point are rigidly attached to its first one (:mod:`fem_lie.system.nodes.numbering`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Indices, direction, instance
from fem_lie._jit import compiled
from fem_lie._jit.copies import copy_vector

if TYPE_CHECKING:
    from fem_lie.mesh.lines import LineMesh

Up = npt.ArrayLike | Mapping[str, npt.ArrayLike]


@dataclass(frozen=True)
class Twisted:
    """Direction of sections that rotates along the line.

    Attributes:
        angle: Rotation of the section about e₁, rad, as a function of arc length.
        up: Direction that e₃ is closest to before rotation; default: frames without twist.
    """

    angle: Callable[[float], float] | None
    up: Up | None = None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if ``angle`` is not a function."""
        instance(self.angle, Callable | None, "Twisted: angle", "a function of arc length")


_SAME_FRAME = 1e-6  # rad, between tangents that count as equal
_ALONG = 1e-6  # sine below which a direction is along the line


class Chains:
    """Smooth pieces of a line mesh.

    Attributes:
        order: Cells of all pieces, each cell after its predecessor, shape (m,).
        first: Index in ``order`` of the first cell of each piece.
        arc: Arc length at both ends of each cell from the start of its piece, shape (m, 2). The
            length of a cell is that of the circle with its tangents.
    """

    def __init__(self, mesh: LineMesh) -> None:
        """Find the pieces: cells continue each other if only they meet, with one tangent."""
        following = _smooth_successors(mesh)
        m = len(mesh.cells)
        has_predecessor = np.zeros(m, dtype=bool)
        has_predecessor[following[following >= 0]] = True
        done = np.zeros(m, dtype=bool)
        order: list[int] = []
        first: list[int] = []
        # closed pieces have no first cell: start them at the lowest number
        for start in [*np.flatnonzero(~has_predecessor), *range(m)]:
            if done[start]:
                continue
            first.append(len(order))
            cell = int(start)
            while cell >= 0 and not done[cell]:
                done[cell] = True
                order.append(cell)
                cell = int(following[cell])
        self.order, self.first = np.array(order), np.array(first)
        chord = np.linalg.norm(np.diff(mesh.points[mesh.cells], axis=1)[:, 0], axis=1)
        half = np.linalg.norm(mesh.tangents[:, 1] - mesh.tangents[:, 0], axis=1) / 2  # sin θ/2
        angle = np.arcsin(np.minimum(half, 1.0))
        lengths = chord * np.where(half > 0, angle / np.where(half > 0, half, 1.0), 1.0)
        self.arc = np.empty((m, 2))
        for begin, end in zip(first, [*first[1:], m], strict=True):
            cells = self.order[begin:end]
            s = np.concatenate([[0.0], np.cumsum(lengths[cells])])
            self.arc[cells, 0], self.arc[cells, 1] = s[:-1], s[1:]

    def require_one(self, what: str) -> None:
        """Raise ``ValueError`` if there are several pieces, so that arc length is not unique."""
        if len(self.first) > 1:
            raise ValueError(
                f"{what} as a function of arc length needs one smooth line, got "
                f"{len(self.first)} pieces (kinks or branches); make one beam of each"
            )


def _smooth_successors(mesh: LineMesh) -> Indices:
    """Cell that continues each cell smoothly, or −1, shape (m,)."""
    n, m = len(mesh.points), len(mesh.cells)
    meeting = np.bincount(mesh.cells.ravel(), minlength=n) == 2
    starts = np.full(n, -1, dtype=np.int64)
    starts[mesh.cells[:, 0]] = np.arange(m)
    node = mesh.cells[:, 1]
    following = np.where(meeting[node], starts[node], -1)
    gap = np.linalg.norm(mesh.tangents[:, 1] - mesh.tangents[following, 0], axis=1)
    return np.where(gap <= _SAME_FRAME, following, -1)


def cell_frames(
    mesh: LineMesh, chains: Chains, up: Up | None, twist: Callable[[float], float] | None
) -> Array:
    """Frames at both ends of each cell, shape (m, 2, 4, 3).

    Args:
        mesh: Line mesh.
        chains: Its smooth pieces.
        up: Direction that e₃ is closest to, for all cells or for named groups of cells. Other cells
            have frames without twist (Bishop, Am. Math. Mon. 82 (1975) 246), starting with e₃
            closest to global z, or to x if the piece starts along z.
        twist: Additional angle of the sections about e₁, rad, as a function of arc length.

    Raises:
        ValueError: ``up`` is along the line somewhere, or names a group that does not exist; or
            twist is given for several pieces.
    """
    frames = np.empty((len(mesh.cells), 2, 4, 3))
    frames[:, :, 0] = mesh.points[mesh.cells]
    tangents = mesh.tangents / np.linalg.norm(mesh.tangents, axis=-1, keepdims=True)
    frames[:, :, 1] = tangents
    directions = _directions(mesh, up)
    free = np.isnan(directions[:, 0])
    e2 = np.cross(directions[~free, np.newaxis], tangents[~free])
    sine = np.linalg.norm(e2, axis=-1, keepdims=True)
    if sine.min(initial=1.0) <= _ALONG:
        position = frames[~free, :, 0][np.unravel_index(sine.argmin(), sine.shape[:2])]
        raise ValueError(f"up = {up!r} is along the line at {position}: expected another direction")
    frames[~free, :, 2] = e2 / sine
    frames[~free, :, 3] = np.cross(tangents[~free], frames[~free, :, 2])
    _transport(chains.order, chains.first, free, frames)
    if twist is not None:
        chains.require_one("twist")
        angle = np.array([[float(twist(float(s))) for s in ends] for ends in chains.arc])
        if not np.isfinite(angle).all():
            raise ValueError("the twist must be finite along the whole line")
        c, s = np.cos(angle)[..., np.newaxis], np.sin(angle)[..., np.newaxis]
        e2, e3 = frames[:, :, 2].copy(), frames[:, :, 3].copy()
        frames[:, :, 2], frames[:, :, 3] = c * e2 + s * e3, c * e3 - s * e2
    return frames


def _directions(mesh: LineMesh, up: Up | None) -> Array:
    """Direction ``up`` of each cell as a unit vector, nan where it is not given, shape (m, 3)."""
    found = np.full((len(mesh.cells), 3), np.nan)
    if up is None:
        return found
    everywhere = np.arange(len(mesh.cells))
    given = (
        [(mesh.group(group), value) for group, value in up.items()]
        if isinstance(up, Mapping)
        else [(everywhere, up)]
    )
    for cells, value in given:
        found[cells] = direction(value, "up")
    return found


@compiled
def _transport(order: Indices, first: Indices, free: Array, frames: Array) -> None:
    """Rotation-minimising frames of the cells without ``up``, by double reflection.

    Wang, Jüttler, Zheng & Liu, ACM Trans. Graph. 27 (2008) 2: fourth order, exact on circles.
    """
    e3 = np.empty(3)
    for chain in range(first.shape[0]):
        end = first[chain + 1] if chain + 1 < first.shape[0] else order.shape[0]
        before = False
        for k in range(first[chain], end):
            cell = frames[order[k]]
            if not free[order[k]]:
                before = False
                continue
            if not before:
                axis = 2 if abs(cell[0, 1, 2]) < 0.99 else 0
                for c in range(3):
                    e3[c] = (c == axis) - cell[0, 1, axis] * cell[0, 1, c]
            before = True
            _complete(cell[0], e3)
            chord = cell[1, 0] - cell[0, 0]
            factor = 2.0 / np.dot(chord, chord)
            turned = e3 - factor * np.dot(chord, e3) * chord
            tangent = cell[0, 1] - factor * np.dot(chord, cell[0, 1]) * chord
            gap = cell[1, 1] - tangent
            along = 2.0 * np.dot(gap, turned) / np.dot(gap, gap)
            for c in range(3):
                e3[c] = turned[c] - along * gap[c]
            _complete(cell[1], e3)


@compiled
def _complete(frame: Array, e3: Array) -> None:
    """Set e₂ and e₃ of a frame with known e₁; ``e3`` is made orthonormal to it."""
    e3 -= np.dot(e3, frame[1]) * frame[1]
    e3 /= np.sqrt(np.dot(e3, e3))
    copy_vector(e3, frame[3])
    frame[2, 0] = e3[1] * frame[1, 2] - e3[2] * frame[1, 1]
    frame[2, 1] = e3[2] * frame[1, 0] - e3[0] * frame[1, 2]
    frame[2, 2] = e3[0] * frame[1, 1] - e3[1] * frame[1, 0]


def shared_nodes(mesh: LineMesh, frames: Array) -> tuple[Array, Indices, Indices]:
    """Merge ends of cells with the same position and frame into one node.

    Args:
        mesh: Line mesh.
        frames: See :func:`cell_frames`.

    Returns:
        Frames of the nodes (N, 4, 3), the first ones at the points of the mesh in their order;
        nodes of each cell (m, 2); and the master node of each node, itself if independent, (N,).
    """
    ends = frames.reshape(-1, 4, 3)
    point = mesh.cells.ravel()
    n = len(mesh.points)
    order = np.argsort(point, kind="stable")
    first = order[np.searchsorted(point[order], np.arange(n))]
    nodes = [frame for frame in ends[first]]
    node_of_end = point.copy()
    masters = list(range(n))
    others: dict[int, list[int]] = {}
    apart = np.linalg.norm(ends[:, 1:] - ends[first[point], 1:], axis=(1, 2))
    for end in np.flatnonzero(apart > _SAME_FRAME):
        corner = int(point[end])
        known = others.setdefault(corner, [])
        match = [i for i in known if np.abs(nodes[i] - ends[end])[1:].max() <= _SAME_FRAME]
        if not match:
            match = [len(nodes)]
            known.append(len(nodes))
            nodes.append(ends[end])
            masters.append(corner)
        node_of_end[end] = match[0]
    return np.array(nodes), node_of_end.reshape(-1, 2), np.array(masters, dtype=np.int64)


def middle_frames(a: Array, b: Array) -> Array:
    """Midpoints of the geodesics between frames (m, 4, 3)."""
    return np.asarray(lie.se3_retract(a, 0.5 * lie.se3_relative(a, b)))
