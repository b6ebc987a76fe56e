"""Rotations and strains of elements from end to end, and their limits.

Every element that interpolates between nodes has a rotation beyond which it folds: its bending
moment has a maximum over the rotation, and equilibrium states beyond it are no solutions of the
beam or shell. Logarithms of relative motions end at π.

| element | limit |
| --- | --- |
| geodesic, directors of two nodes | π, where the rotation has two logarithms |
| directors of three nodes | 2.7312: the inner node moves to one end |
| shells with two nodes along an edge | π/2: the moment goes with the sine; π if decoupled |
| shells with three | 3.0: nearly π, where their directors are opposite |

Beams and rods have a linear constitutive law of their section, and an axis that is nearly straight
in the axes of their mean frame: their axial strain (10 %) and the angle between both (0.3 rad) are
checked as well. These limits cause warnings only, as the element remains a continuous function of
its nodes.

A slack arc extends by straightening, for which its element has a compliance in proportion to the
force. A chain of such elements in tension, a cable modelled by beams, is too soft once they are
straight.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import uncounted
from fem_lie.bodies.model import FoldedElementError

if TYPE_CHECKING:
    from fem_lie.system.nodes.numbering import Numbering

_NEAR, _SUSPECT = 0.9, 0.7  # fraction of the limit
_STRETCH, _SHEAR = 0.1, 0.3  # axial strain, angle between axis and mean frame in rad


Found: TypeAlias = tuple[int, float, bool]
"""Result of :func:`nearest`."""


class CoarseElementsWarning(UserWarning):
    """Elements rotate almost to their limit, or strain beyond the range of their law.

    A strain of 10 % is the range of the linear law of sections. It is reported for elements with a
    law of their own, too: with a law that holds further, filter the warning.
    """


class Rotation(NamedTuple):
    """The element closest to its limit.

    Attributes:
        body: Label of its body.
        element: Its number there.
        angle: Rotation from end to end, rad.
        limit: Largest admissible rotation, rad.
    """

    body: str
    element: int
    angle: float
    limit: float

    def __str__(self) -> str:
        """Problem and remedy."""
        return (
            f"element {self.element} of {self.body} rotates by {self.angle:.3g} rad from end to "
            f"end; elements of this type fold at {self.limit:.3g} rad: use at least "
            f"{max(2, int(np.ceil(2 * self.angle / self.limit)))} elements in its place"
        )


class Strains(NamedTuple):
    """The beam elements with the largest strains.

    Attributes:
        stretched: Row with the largest axial strain.
        stretch: That strain.
        leaning: Row with the largest angle between its axis and its mean frame.
        angle: That angle, rad.
        excessive: Whether one of them is too large.
    """

    stretched: int
    stretch: float
    leaning: int
    angle: float
    excessive: bool


class ElementRotations:
    """Rotations and strains of all elements of a scene; it warns of each once."""

    def __init__(self, numbering: Numbering) -> None:
        """Collect the elements of all bodies."""
        self._bodies: list[str] = []
        rows, numbers, limits, whole = [], [], [], []
        lengths, frames, elongations = [], [], []
        for body, nodes in numbering.nodes.items():
            turning = body.model.rotation_limit()
            if turning is None:
                continue
            along, count = nodes[turning.nodes], len(turning.nodes)
            rows.append(along[:, [0, -1, -1]] if along.shape[1] == 2 else along)
            limits.append(np.full(count, turning.limit))
            whole.append(np.full(count, int(turning.whole)))
            lengths.append(np.zeros(count) if turning.lengths is None else turning.lengths)
            frames.append(body.frames[turning.nodes[:, [0, -1]]])
            none_such = np.full(count, np.inf)
            elongations.append(none_such if turning.elongations is None else turning.elongations)
            self._bodies += [body.label] * count
            numbers.append(turning.elements)
        none = np.empty(0, dtype=np.int64)
        self._nodes: Indices = np.concatenate([np.empty((0, 3), dtype=np.int64), *rows])
        self._limits: Array = np.concatenate([np.empty(0), *limits])
        self._whole: Indices = np.concatenate([none, *whole])
        self._numbers: Indices = np.concatenate([none, *numbers])
        self._lengths: Array = np.concatenate([np.empty(0), *lengths])
        ends: Array = np.concatenate([np.empty((0, 2, 4, 3)), *frames])
        self._chords = 0.5 * np.einsum("wnkj,wj->wk", ends[:, :, 1:], ends[:, 1, 0] - ends[:, 0, 0])
        self._any, self._warned = bool(rows), False
        self._warned_of_stretch = self._warned_of_shear = self._warned_of_arcs = False
        self._elongations: Array = np.concatenate([np.empty(0), *elongations])
        self._arcs = np.flatnonzero(np.isfinite(self._elongations))
        reach = ends[self._arcs, 1, 0] - ends[self._arcs, 0, 0]
        self._reach: Array = np.linalg.norm(reach, axis=1)

    @property
    def elements(self) -> tuple[Array, Indices, Indices, Array, Array]:
        """Limits (w,), nodes from end to end (w, 3), and whether whole frames rotate (w,).

        Then lengths (w,), zero for elements whose strain is not checked, and unloaded chords along
        the mean axes of both ends (w, 3).
        """
        return self._limits, self._nodes, self._whole, self._lengths, self._chords

    def largest(self, frames: Array) -> Rotation | None:
        """The element closest to its limit at frames of all nodes, (n, 4, 3), or ``None``."""
        if not self._any:
            return None
        row, angle, _ = nearest(frames, self._nodes, self._limits, self._whole)
        return self._rotation(row, angle)

    def _rotation(self, row: int, angle: float) -> Rotation:
        return Rotation(self._bodies[row], int(self._numbers[row]), angle, float(self._limits[row]))

    def hint(self, frames: Array) -> str:
        """Hint about the element closest to its limit for the message of a failure, or empty."""
        rotation = self.largest(frames)
        if rotation is None or rotation.angle <= _SUSPECT * rotation.limit:
            return ""
        return f" There {rotation}."

    def check(self, frames: Array, when: str | float) -> None:
        """Warn once if an element is close to its limit.

        Args:
            frames: Frames of all nodes, shape (n, 4, 3).
            when: Description of the state for messages; a number is a time.

        Raises:
            FoldedElementError: An element is beyond it.
        """
        state = when if isinstance(when, str) else f"at time {when:g}"
        self._check_strains(frames, state)
        row, angle, near = nearest(frames, self._nodes, self._limits, self._whole)
        if not near:
            return
        rotation = self._rotation(row, angle)
        if rotation.angle > rotation.limit:
            raise FoldedElementError(f"{state} {rotation}")
        if not self._warned:
            self._warned = True
            warnings.warn(f"{state} {rotation}", CoarseElementsWarning, stacklevel=2)

    def _check_strains(self, frames: Array, state: str) -> None:
        """Warn once of elements that strain, or lean, beyond their range."""
        found = Strains(*most_strained(frames, self._nodes, self._lengths, self._chords))
        if abs(found.stretch) > _STRETCH and not self._warned_of_stretch:
            self._warned_of_stretch = True
            verb = "stretched" if found.stretch > 0 else "compressed"
            self._warn(
                f"{state} {self._name(found.stretched)} is {verb} by {abs(found.stretch):.0%}, and "
                f"the law of its section is meant for less than {_STRETCH:.0%}: check units, "
                "stiffness and loads, or take a Solid"
            )
        if found.angle > _SHEAR and not self._warned_of_shear:
            self._warned_of_shear = True
            self._warn(
                f"{state} the axis of {self._name(found.leaning)} leans by {found.angle:.2g} rad "
                f"from its mean frame, and elements are accurate below {_SHEAR:.2g}: "
                "use more elements"
            )
        if len(self._arcs) and not self._warned_of_arcs:
            self._check_arcs(frames, state)

    def _check_arcs(self, frames: Array, state: str) -> None:
        """Warn once if an arc extends by more than it can by straightening."""
        a, b = self._nodes[self._arcs, 0], self._nodes[self._arcs, -1]
        extended = np.linalg.norm(frames[b, 0] - frames[a, 0], axis=1) / self._reach - 1.0
        most = int(np.argmax(extended / self._elongations[self._arcs]))
        row, extension = int(self._arcs[most]), float(extended[most])
        if extension > self._elongations[row]:
            self._warned_of_arcs = True
            self._warn(
                f"{state} {self._name(row)} is stretched by {extension:.2g}; it is curved, and its "
                "bending stiffness is so small that its axial stiffness holds up to "
                f"{self._elongations[row]:.2g} only: it is too soft. Use fl.Rod, fl.Cable, "
                "formulation=fl.elements.GeodesicBeam(bending_flexibility=False), or more elements"
            )

    def _name(self, row: int) -> str:
        return f"element {self._numbers[row]} of {self._bodies[row]}"

    def _warn(self, message: str) -> None:
        warnings.warn(message, CoarseElementsWarning, stacklevel=3)


@uncounted
def most_strained(
    H: Array, nodes: Indices, lengths: Array, chords: Array
) -> tuple[int, float, int, float, bool]:
    """Fields of :class:`Strains`.

    An axis is at least as long as its chord, and hardly longer than the arc with this chord and the
    angle between both ends: an extension is that of the chord, a compression that of the arc.

    Args:
        H: Frames of all nodes, (N, 4, 3).
        nodes: Nodes from end to end, (w, 3).
        lengths: Unloaded arc lengths, zero for rows that are not checked, (w,).
        chords: Unloaded chords along the mean axes of both ends, (w, 3).
    """
    stretched, largest, leaning, angle = 0, 0.0, 0, 0.0
    for w in range(nodes.shape[0]):
        if lengths[w] == 0.0:
            continue
        a, b = nodes[w, 0], nodes[w, 2]
        square, cosine, across = 0.0, -1.0, 0.0
        for k in range(3):
            along = 0.0
            for j in range(3):
                c = H[b, 0, j] - H[a, 0, j]
                along += 0.5 * (H[a, 1 + k, j] + H[b, 1 + k, j]) * c
                cosine += H[a, 1 + k, j] * H[b, 1 + k, j]
            square += (H[b, 0, k] - H[a, 0, k]) ** 2
            across += (along - chords[w, k]) ** 2 if k > 0 else 0.0
        stretch = np.sqrt(square) / lengths[w] - 1.0
        if stretch < 0.0:
            half = 0.5 * np.arccos(min(1.0, max(-1.0, 0.5 * cosine)))
            arc = half / np.sin(half) if half > 1e-4 else 1.0
            stretch = min(0.0, (stretch + 1.0) * arc - 1.0)
        if abs(stretch) > abs(largest):
            stretched, largest = w, stretch
        if across > (angle * lengths[w]) ** 2:
            leaning, angle = w, np.sqrt(across) / lengths[w]
    return stretched, largest, leaning, angle, abs(largest) > _STRETCH or angle > _SHEAR


@uncounted
def nearest(H: Array, nodes: Indices, limits: Array, whole: Indices) -> Found:
    """Row with the largest rotation over its limit, that rotation, and whether to check it.

    0, 0 and false if there is no row.
    """
    worst, row, angle = -1.0, 0, 0.0
    for w in range(nodes.shape[0]):
        rotation = 0.0
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
            rotation += np.arccos(min(1.0, max(-1.0, cosine)))
        if rotation > worst * limits[w]:
            worst, row, angle = rotation / limits[w], w, rotation
    # NaN is checked as well
    return row, angle, limits.shape[0] > 0 and not angle <= _NEAR * limits[row]
