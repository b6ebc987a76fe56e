"""Tree of a scene: links, their joints, and the motion at the start.

The graph has the nodes of the scene and the ground, and an edge for each joint. It must be a
forest; the first body of each tree without a joint to the ground moves freely. A joint is a
sequence of subgroups of SE(3), each with constant columns in the frame of its link: a universal
joint is two hinges with a link without mass between them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.joints import kinds
from fem_lie.joints.equations.joint_arrays import JointArrays, views
from fem_lie.joints.joint import Joint
from fem_lie.solve.motion.integrator import refuse
from fem_lie.solve.trees.elimination import BALL, COMMUTING, FREE, GROUP, Links
from fem_lie.system.equations import Equations


class Subgroup(NamedTuple):
    """Relative motions of two frames.

    Attributes:
        motion: Their type.
        columns: Their twists, (k, 6).
    """

    motion: int
    columns: Array


_E = np.eye(6)
_FREE, _BALL = Subgroup(FREE, _E), Subgroup(BALL, _E[3:])
_ABOUT_X, _ABOUT_Z = Subgroup(COMMUTING, _E[3:4]), Subgroup(COMMUTING, _E[5:])
_IN_PLANE = Subgroup(COMMUTING, _E[:2])
_MOTIONS: dict[type[Joint], tuple[Subgroup, ...]] = {
    kinds.Fixed: (Subgroup(COMMUTING, _E[:0]),),
    kinds.Spherical: (_BALL,),
    kinds.Revolute: (_ABOUT_Z,),
    kinds.Prismatic: (Subgroup(COMMUTING, _E[2:3]),),
    kinds.Cylindrical: (Subgroup(COMMUTING, _E[[2, 5]]),),
    kinds.Planar: (Subgroup(GROUP, _E[[0, 1, 5]]),),
    kinds.Universal: (_ABOUT_Z, _ABOUT_X),
    kinds.InPlane: (_IN_PLANE, _BALL),
}
"""Motions of B relative to A by type of joint."""


class Tree(NamedTuple):
    """A tree, and its motion at the start.

    Attributes:
        links: Its constants.
        X: Frames of the links in those before, (k, 4, 3).
        w: Rates of the free columns, (d,).
        link: Link of each moving node, (n,).
        own: Frames of the nodes in those of their links, (n, 4, 3).
        joints: Pairs of joint frames with constraints, (j,).
        wrenches: Link on which the force of each of them acts, and the side of this link, (j, 2).
    """

    links: Links
    X: Array
    w: Array
    link: Indices
    own: Array
    joints: Indices
    wrenches: Indices


class _Edge(NamedTuple):
    """A joint from the side of one of its nodes: the node and the motions behind it.

    Attributes:
        to: Node behind the joint.
        pair: Pair of frames.
        near: Side of the pair from which the joint is seen.
        label: Name of the joint.
        parts: Motions of side B relative to side A.
    """

    to: int
    pair: int
    near: int
    label: str
    parts: tuple[Subgroup, ...]


def tree_of(equations: Equations, gravity: Array) -> Tree:
    """The tree of a scene, with uniform ``gravity`` (3,), or zero.

    Raises:
        ValueError: There is a loop of joints, or a joint that is not made of subgroups.
    """
    return _Builder(equations).build(gravity)


class _Builder:
    """Appends links in the order in which they are found."""

    def __init__(self, equations: Equations) -> None:
        self._equations, self._n = equations, equations.unknowns.moving
        self._arrays: JointArrays = views(equations.arrays.joints)
        self._H, self._v = equations.start.frames, equations.start.velocities
        self._edges = self._graph()
        self._parent: list[int] = []
        self._of: list[Subgroup] = []
        self._frames: list[Array] = []  # of the links, in space
        self._X: list[Array] = []
        self._w: list[Array] = []
        self._node: list[int] = []  # −1: no body
        self._link = np.full(self._n + 1, -1, dtype=np.int64)
        self._wrenches: list[tuple[int, int, int]] = []

    def _graph(self) -> list[list[_Edge]]:
        arrays, m = self._arrays, len(self._arrays.targets)
        scene = self._equations.scene
        items = [*scene.joints, *scene.connections]
        found: list[list[_Edge]] = [[] for _ in range(self._n + 1)]
        for pair in range(len(arrays.nodes)):
            a, b = (int(node) for node in arrays.nodes[pair])
            rows = arrays.rows[arrays.first[pair] : arrays.first[pair + 1]]
            for owner in np.unique(self._equations.arrays.owner[rows[rows < m]]):
                joint = items[int(owner)]
                assert isinstance(joint, Joint)
                parts = _subgroups(joint)
                found[a].append(_Edge(b, pair, 0, joint.label, parts))
                found[b].append(_Edge(a, pair, 1, joint.label, parts))
        return found

    def build(self, gravity: Array) -> Tree:
        """All links, from the ground and then from the first body of each tree without ground."""
        used: set[int] = set()
        self._walk(self._n, used)
        for node in range(self._n):
            if self._link[node] < 0:
                self._append(-1, _FREE, self._H[node], node)
                self._w.append(self._v[node])
                self._X.append(self._H[node])
                self._walk(node, used)
        count, node_of = len(self._parent), np.array(self._node, dtype=np.int64)
        first = np.cumsum([0, *(len(each.columns) for each in self._of)])
        columns = np.concatenate([np.empty((0, 6)), *(each.columns for each in self._of)])
        link = self._link[: self._n].copy()
        frames = np.array(self._frames).reshape(count, 4, 3)
        own = lie.se3_compose(lie.se3_inverse(frames[link]), self._H[: self._n])
        body = np.zeros((count, 10))
        body[link] = _inertia(self._equations.arrays.inertia.blocks, own)
        assert (node_of[link] == np.arange(self._n)).all()
        motions = np.array([each.motion for each in self._of], dtype=np.int64)
        parent = np.array(self._parent, dtype=np.int64)
        links = Links(parent, motions, first, columns, body, np.array(gravity, dtype=np.float64))
        w, X = np.concatenate([np.empty(0), *self._w]), np.array(self._X).reshape(count, 4, 3)
        ends = np.array(self._wrenches, dtype=np.int64).reshape(-1, 3)
        joints = np.ascontiguousarray(ends[:, 0])
        return Tree(links, X, w, link, own, joints, np.ascontiguousarray(ends[:, 1:]))

    def _walk(self, root: int, used: set[int]) -> None:
        """Append all links behind the node ``root``, in order of their distance."""
        queue = deque([root])
        while queue:
            node = queue.popleft()
            for edge in self._edges[node]:
                if edge.pair in used:
                    continue
                used.add(edge.pair)
                if edge.to == self._n or self._link[edge.to] >= 0:
                    raise ValueError(
                        f"MuntheKaas moves trees of bodies, and {edge.label} closes a loop: "
                        "open it there by a stiff spring, or use GeneralisedAlpha"
                    )
                self._join(node, edge)
                queue.append(edge.to)

    def _join(self, node: int, edge: _Edge) -> None:
        """Append the links of a joint."""
        far = 1 - edge.near
        frame = self._arrays.frames[edge.pair]
        near, end = (
            lie.se3_compose(self._H[at], frame[side])
            for at, side in ((node, edge.near), (edge.to, far))
        )
        parts = edge.parts
        relative = lie.se3_compose(lie.se3_inverse(near), end)
        between = _split(relative, parts) if far else _split(lie.se3_inverse(relative), parts)
        if not far:
            parts = parts[::-1]
            between = [lie.se3_inverse(each) for each in reversed(between)]
        base = self._link[node]
        start = np.vstack([np.zeros(3), np.eye(3)]) if node == self._n else self._frames[base]
        offset = lie.se3_compose(lie.se3_inverse(start), near)
        self._w.append(self._rates(node, edge.to, end, parts, between))
        at, parent = near, int(base)
        for k, (part, step) in enumerate(zip(parts, between, strict=True)):
            at = lie.se3_compose(at, step)
            X = lie.se3_compose(offset, step) if k == 0 else step
            last = k == len(parts) - 1
            parent = self._append(parent, part, end if last else at, edge.to if last else -1)
            self._X.append(X)
        self._wrenches.append((edge.pair, parent, far))

    def _append(self, parent: int, part: Subgroup, frame: Array, node: int) -> int:
        self._parent.append(parent)
        self._of.append(part)
        self._frames.append(np.asarray(frame))
        self._node.append(node)
        index = len(self._parent) - 1
        if node >= 0:
            self._link[node] = index
        return index

    def _rates(
        self, node: int, to: int, end: Array, parts: Sequence[Subgroup], between: Sequence[Array]
    ) -> Array:
        """Rates along all columns of a joint, from the velocities of its nodes."""
        twists = []
        for each in (node, to):
            moved = lie.se3_compose(lie.se3_inverse(end), self._H[each])
            v = self._v[each] if each < self._n else np.zeros(6)
            twists.append(lie.se3_adjoint(moved) @ v)
        ahead, columns = np.vstack([np.zeros(3), np.eye(3)]), []
        for part, step in zip(reversed(parts), reversed(between), strict=True):
            columns.append(lie.se3_adjoint(lie.se3_inverse(ahead)) @ part.columns.T)
            ahead = lie.se3_compose(step, ahead)
        S = np.hstack(columns[::-1])
        return np.asarray(np.linalg.lstsq(S, twists[1] - twists[0], rcond=None)[0])


def _subgroups(joint: Joint) -> tuple[Subgroup, ...]:
    """Subgroups of a joint, known by what it constrains.

    Raises:
        ValueError: It constrains something else.
    """
    for kind, motions in _MOTIONS.items():
        same = np.array_equal(kind.selection, joint.selection)
        if same and not joint.functions.any():
            return motions
    if isinstance(joint, kinds.Screw):
        column = np.array([[0.0, 0.0, joint.pitch / (2.0 * np.pi), 0.0, 0.0, 1.0]])
        return (Subgroup(COMMUTING, column),)
    known = ", ".join([*(kind.__name__ for kind in _MOTIONS), kinds.Screw.__name__])
    refuse("MuntheKaas", {f"{joint.label}, which is none of {known}": True})
    raise AssertionError


def _split(G: Array, parts: Sequence[Subgroup]) -> list[Array]:
    """Relative frame of a joint as a product of one frame of each subgroup."""
    if len(parts) == 1:
        return [np.asarray(G)]
    if parts[1] is _BALL:
        moved = np.vstack([G[0], np.eye(3)])
        return [moved, np.vstack([np.zeros(3), G[1:]])]
    Q = G[1:].T
    angle, second = np.arctan2(Q[1, 0], Q[0, 0]), np.arctan2(Q[2, 1], Q[2, 2])
    return [lie.se3_exp(angle * parts[0].columns[0]), lie.se3_exp(second * parts[1].columns[0])]


def _inertia(G: Array, own: Array) -> Array:
    """Mass, first moment and moments of inertia of bodies in the frames of their links, (n, 10).

    Args:
        G: Mass matrices on (x, d₁, d₂, d₃), (n, 4, 4).
        own: Frames of the bodies in those of their links, (n, 4, 3).
    """
    moved = np.einsum("naj,nab,nbk->njk", own, G, own)  # second moments about the link
    m, s = G[:, 0, 0], np.einsum("na,naj->nj", G[:, 0], own)
    J = np.trace(moved, axis1=1, axis2=2)[:, None, None] * np.eye(3) - moved
    rows, columns = np.triu_indices(3)
    return np.column_stack([m, s, J[:, rows, columns]])
