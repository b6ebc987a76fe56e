"""Which node of the system is which: all bodies, kind by kind, and which of their nodes lead."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.body import NO_HOLDS, Body, Holds, Point
from fem_lie.bodies.catalogue import BodyInfo
from fem_lie.bodies.points import require_node
from fem_lie.forms.body_term import BodyTerm
from fem_lie.joints import RigidLink
from fem_lie.lie.kinds import TRAITS, NodeKind
from fem_lie.system.nodes.attachment import Attachment

_INDEPENDENT = 1e-9  # relative, as axes that are meant to agree


class Numbering:
    """Nodes of the system; each kind of body has a slice of them. Some follow others rigidly.

    Attributes:
        total: Number of all nodes; ``count`` of them lead and have unknowns.
        nodes: Nodes of each body among all.
        assemblies: The nodes of each assembly, and the assembly.
        members: The bodies of each assembly, in its order.
        drills: Whether the nodes of each body turn about their third directors.
        attachment: Which node follows which.
        frames: Initial frames of the leaders, shape (count, 4, 3).
        begins_at: Frames from which solvers go on, of the leaders; the initial ones but of bodies
            that begin elsewhere.
        velocities: Initial local velocities of the leaders, shape (count, 6).
        groups: The group of each leader, shape (count,).
        kinds: The :class:`~fem_lie.lie.kinds.NodeKind` of each leader, shape (count,).
        clamped: What a clamp holds of each leader, shape (count, 6).
        held: Which unknowns of the leaders their bodies hold, shape (count, 6).
        absent: Which of them are not there, of nodes with fewer; they are held, too.
        supported: Leaders that something holds but that they do not drill, in increasing order.
        supports: Axes fixed in space of the leaders' translations, nan if local, (count, 3, 3).
        uncoupled: Which leaders move by ``x + R u`` in statics, tilted and then drilled, (count,).
        straight: Which of the others do, turned at once, shape (count,).
    """

    def __init__(
        self, bodies: Sequence[Body], links: Sequence[RigidLink] = (), holds: Holds = NO_HOLDS
    ) -> None:
        """Build the assemblies and number their nodes as they do.

        Args:
            bodies: All of them.
            links: Points that follow each other.
            holds: What takes hold of the rotations of the bodies' nodes.

        Raises:
            ValueError: Frames or velocities of a body are none; initial velocities of nodes that
                are tied together contradict each other, or supports of a node have no counterpart
                in the unknowns of the node it follows.
        """
        self.nodes: dict[Body, Indices] = {}
        self.assemblies: list[tuple[slice, BodyTerm]] = []
        self.members: list[list[Body]] = []
        for body in bodies:
            body.check()
        self.drills = {body: body.drills(holds.get(body, ())) for body in bodies}
        start = 0
        for kind in dict.fromkeys((body.kind, self.drills[body]) for body in bodies):
            members = [body for body in bodies if (body.kind, self.drills[body]) == kind]
            total = sum(len(body.frames) for body in members)
            order: Indices = np.arange(total)
            assembly = members[0].assemble(members, holds)
            if assembly is not None:
                order = assembly.order
                self.assemblies.append((slice(start, start + total), assembly))
                self.members.append(members)
            first = 0
            for body in members:
                self.nodes[body] = start + order[first : first + len(body.frames)]
                first += len(body.frames)
            start += total
        self.total = start
        self._tie(links)

    def _tie(self, links: Sequence[RigidLink]) -> None:
        frames, velocities = np.empty((self.total, 4, 3)), np.empty((self.total, 6))
        # one array for both, unless they differ
        elsewhere = any(body.begins_at is not None for body in self.nodes)
        begins_at = np.empty_like(frames) if elsewhere else frames
        groups, kinds = np.empty((2, self.total), dtype=np.int64)
        supports, own = np.empty((self.total, 3, 3)), np.empty(self.total, dtype=bool)
        held, uncoupled = np.empty((self.total, 6), dtype=bool), np.empty(self.total, dtype=bool)
        straight, absent = np.empty(self.total, dtype=bool), np.empty((self.total, 6), dtype=bool)
        pairs = [(self._of_all(link.a), self._of_all(link.b)) for link in links]
        for body, nodes in self.nodes.items():
            frames[nodes], velocities[nodes] = body.frames, body.velocities
            begins_at[nodes] = body.frames if body.begins_at is None else body.begins_at
            groups[nodes], kinds[nodes] = body.group, body.node_kinds
            held[nodes], uncoupled[nodes] = body.held, body.uncoupled
            own[nodes], straight[nodes] = body.held.any(axis=1), body.goes_straight
            held[nodes, 5] |= not self.drills[body]
            absent[nodes] = body.absent
            supports[nodes] = body.supports
            follows = np.flatnonzero(body.leaders != np.arange(len(nodes)))
            leaders = body.leaders[follows]
            pairs += [(int(nodes[a]), int(nodes[b])) for a, b in zip(leaders, follows, strict=True)]
        # what follows does so from where solvers begin, perhaps deformed
        self.attachment = Attachment(begins_at, pairs)
        self.count = self.attachment.count
        self.frames = frames[self.attachment.leaders]
        self.begins_at = begins_at[self.attachment.leaders] if elsewhere else self.frames
        # lengths beside rotations: of one node anything will do
        self._size = float(np.linalg.norm(np.ptp(frames[:, 0], axis=0))) or 1.0
        self.velocities = velocities[self.attachment.leaders]
        self.groups: Indices = groups[self.attachment.leaders]
        self.kinds: Indices = kinds[self.attachment.leaders]
        known, which = np.unique(self.kinds, return_inverse=True)
        traits = [TRAITS[NodeKind(kind)] for kind in known]
        self.clamped: Flags = np.array([each.clamped for each in traits])[which]
        self.held = held[self.attachment.leaders]
        self.supported: Indices = np.unique(self.attachment.leader[own])
        self.uncoupled = np.zeros(self.count, dtype=bool)
        np.logical_or.at(self.uncoupled, self.attachment.leader, uncoupled)
        self.straight: Flags = straight[self.attachment.leaders]
        self.supports = supports[self.attachment.leaders]
        self._hold_leaders(held, np.isfinite(supports[:, 0, 0]))
        # unknowns that a kind does not have couple with nothing in the matrix
        self.absent = np.arange(6) >= np.array([[each.unknowns] for each in traits])[which]
        self.absent |= absent[self.attachment.leaders]
        self.held |= self.absent
        self._check_velocities(velocities)

    def _hold_leaders(self, held: Flags, fixed: Flags) -> None:
        """Hold the unknowns of leaders that the supports of their followers hold."""
        follows = np.ones(self.total, dtype=bool)
        follows[self.attachment.leaders] = False
        for node in np.flatnonzero(follows & held.any(axis=1)):
            leader, offset = self.attachment.leader[node], self.attachment.offset[node].copy()
            offset[0] /= self._size
            # rows of zero motion in the leader's unknowns
            rows = np.vstack(
                [np.eye(6)[self.held[leader]], lie.se3_adjoint(lie.se3_inverse(offset))[held[node]]]
            )
            reach = rows.T @ np.linalg.pinv(rows.T, rcond=_INDEPENDENT)
            whole = np.abs(np.diag(reach) - 1.0) < _INDEPENDENT
            moved = fixed[node] or np.isfinite(self.supports[leader, 0, 0])
            if round(np.trace(reach)) > whole.sum() or (moved and not whole.all()):
                body = next(body for body, nodes in self.nodes.items() if node in nodes)
                raise ValueError(
                    f"a node of {body.label} has supports and follows another node by a rigid "
                    "link, whose unknowns are along other axes: support that node instead, or link "
                    "the other way round"
                )
            self.held[leader] = whole

    def _check_velocities(self, given: Array) -> None:
        units = np.repeat([self._size, 1.0], 3)
        away = np.abs(self.attachment.twists(self.velocities) - given) / units
        gap = away.max(axis=1, initial=0.0)
        if gap.max(initial=0.0) > 1e-9 * np.abs(given / units).max(initial=0.0):
            node = int(gap.argmax())
            body = next(body for body, nodes in self.nodes.items() if node in nodes)
            raise ValueError(
                f"the initial velocities of {body.label} contradict a rigid link: give all that is "
                "linked the velocities of one rigid motion"
            )

    def _of_all(self, point: Point) -> int:
        assert point.body is not None
        require_node(point, "what holds unknowns")
        return int(self.nodes[point.body][point.node])

    def node(self, point: Point) -> int:
        """Number of a point's leader; of ground it is ``count``."""
        if point.body is None:
            return self.count
        return int(self.attachment.leader[self._of_all(point)])

    def bodies(self) -> tuple[BodyInfo, ...]:
        """What results must know of the bodies, in the numbering of all nodes."""
        return tuple(BodyInfo.of(body, nodes) for body, nodes in self.nodes.items())
