"""Numbering of the nodes of the equations, master nodes, and the setup that scenes share.

Rigidly attached nodes make kinks, branches and rigid links without constraints. Each node of a body
has the frame ``H = H_master C`` with a constant ``C``. Its twist is ``Ad(C⁻¹)`` times that of its
master node, a force on it is ``Ad⁻ᵀ(C)`` times the force on the master node, and its ``q = (x, d₁,
d₂, d₃)`` is a constant linear function of that of the master node. Nothing is linearised.

Scenes that differ in loads and drives only share the numbering of nodes, the assembled forms of all
elements and their inertia, which do not depend on loads. The family of scenes stores two setups;
one set of equations after the other uses each, and resets it to its initial state.
"""

from __future__ import annotations

import weakref
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.canonical import CanonicalBytes, data_of_body
from fem_lie.bodies.catalogue import BodyInfo
from fem_lie.bodies.initial_state import InitialState
from fem_lie.bodies.model import NO_HOLDS, Holds
from fem_lie.bodies.points import require_node
from fem_lie.forms.assembly import BodyTerm
from fem_lie.joints.rigid_link import RigidLink
from fem_lie.lie.node_types import TRAITS, NodeType
from fem_lie.scene import Scene
from fem_lie.scene.load import strained_bodies


@compiled
def expand(H: Array, master: Indices, C: Array, out: Array) -> None:
    """Frames ``out`` of all nodes from those of their master nodes."""
    for i in range(master.shape[0]):
        lie.compose(H[master[i]], C[i], out[i])


@compiled
def expand_twists(v: Array, master: Indices, C: Array, out: Array) -> None:
    """Twists ``out`` of all nodes from those of their master nodes."""
    for i in range(master.shape[0]):
        lie.apply_adjoint_inverse(C[i], v[master[i]], out[i])


@compiled
def expand_motion(
    H: Array, v: Array, master: Indices, C: Array, frames: Array, twists: Array
) -> None:
    """Frames and twists of all nodes; no twists if ``twists`` has no rows."""
    expand(H, master, C, frames)
    if twists.shape[0] > 0:
        expand_twists(v, master, C, twists)


@compiled
def collect(f: Array, master: Indices, C: Array, out: Array) -> None:
    """Add forces on all nodes, in their frames, to those on their master nodes, ``out``."""
    moved = np.empty(6)
    for i in range(master.shape[0]):
        lie.apply_adjoint_inverse_transposed(C[i], f[i], moved)
        for k in range(6):
            out[master[i], k] += moved[k]


class MasterMap:
    """Master node of each node.

    Attributes:
        trivial: Whether every node is a master node.
        count: Number of master nodes.
        master: Number of each node's master node among the master nodes, shape (N,).
        offset: Frame ``C`` of each node in the frame of its master node, shape (N, 4, 3).
        masters: Numbers of the master nodes among all, shape (count,).
    """

    def __init__(self, frames: Array, pairs: Iterable[tuple[int, int]]) -> None:
        """Find the master nodes.

        Args:
            frames: Initial frames of all nodes, shape (N, 4, 3).
            pairs: Pairs of linked nodes; the second is attached to the master node of the first.
        """
        root = np.arange(len(frames))

        def find(node: int) -> int:
            while root[node] != node:
                root[node] = root[root[node]]
                node = int(root[node])
            return node

        linked = list(pairs)
        for a, b in linked:
            root[find(b)] = find(a)
        roots: Indices = np.arange(len(frames), dtype=np.int64)
        some = sorted({node for pair in linked for node in pair})
        roots[some] = [find(node) for node in some]
        self.masters: Indices = np.flatnonzero(roots == np.arange(len(frames)))
        self.master: Indices = np.searchsorted(self.masters, roots)
        self.count = len(self.masters)
        self.trivial = self.count == len(frames)
        self.offset = np.tile(lie.frame(np.zeros(3), np.eye(3)), (len(frames), 1, 1))
        attached = roots != np.arange(len(frames))
        # nodes with equal frames stay equal to the last bit
        attached &= (frames != frames[roots]).any(axis=(1, 2))
        inverse = lie.se3_inverse(frames[roots[attached]])
        self.offset[attached] = lie.se3_compose(inverse, frames[attached])

    def frames(self, H: Array) -> Array:
        """Frames of all nodes, (N, 4, 3), from those of the master nodes (``H``)."""
        if self.trivial:
            return H[: self.count]
        out = np.empty((len(self.master), 4, 3))
        expand(H, self.master, self.offset, out)
        return out

    def twists(self, v: Array) -> Array:
        """Twists of all nodes from those of the master nodes, shape (N, 6)."""
        if self.trivial:
            return v[: self.count]
        out = np.empty((len(self.master), 6))
        expand_twists(v, self.master, self.offset, out)
        return out

    def collect(self, forces: Array, out: Array) -> None:
        """Add forces on all nodes (N, 6), in their frames, to those on master nodes, ``out``."""
        collect(forces, self.master, self.offset, out)

    def linear(self) -> Array:
        """``W`` with ``q = W q_master`` for each node, shape (N, 4, 4)."""
        W = np.zeros((len(self.master), 4, 4))
        W[:, 0, 0] = 1.0
        W[:, :, 1:] = self.offset
        return W


_SAME_FRAME = lie.frame(np.zeros(3), np.eye(3))
_INDEPENDENT = 1e-9  # relative tolerance of axes that should agree


class Assembled(NamedTuple):
    """Assembled forms of all elements, which do not depend on motion and on attached nodes.

    Attributes:
        nodes: Numbers of the nodes of each body.
        assemblies: Slice of the nodes of each assembly, and the assembly.
        members: Bodies of each assembly, in its order.
        has_drilling: Whether the nodes of each body have drilling rotations.
        total: Number of all nodes.
    """

    nodes: dict[Body, Indices]
    assemblies: list[tuple[slice, BodyTerm]]
    members: list[list[Body]]
    has_drilling: dict[Body, bool]
    total: int


def assembled(
    bodies: Sequence[Body], holds: Holds = NO_HOLDS, strained: Collection[str] = ()
) -> Assembled:
    """Assemblies of bodies; for the arguments see :class:`Numbering`."""
    for body in bodies:
        body.model.check()
    has_drilling = {body: body.model.has_drilling(holds.get(body.model, ())) for body in bodies}
    pieces = [
        (body, (model.assembly_key, has_drilling[body]), model, nodes)
        for body in bodies
        for model, nodes in body.model.pieces(holds.get(body.model, ()))
    ]
    found = Assembled(
        {body: np.empty(len(body.frames), dtype=np.int64) for body in bodies},
        [],
        [],
        has_drilling,
        0,
    )
    start = 0
    for kind in dict.fromkeys(key for _, key, *_ in pieces):
        members = [(body, model, nodes) for body, key, model, nodes in pieces if key == kind]
        total = sum(len(nodes) for *_, nodes in members)
        order: Indices = np.arange(total)
        models = [
            model.with_strains() if body.name in strained else model for body, model, _ in members
        ]
        assembly = models[0].assemble(models, holds)
        if assembly is not None:
            order = assembly.order
            found.assemblies.append((slice(start, start + total), assembly))
            found.members.append([body for body, *_ in members])
        first = 0
        for body, _, nodes in members:
            found.nodes[body][nodes] = start + order[first : first + len(nodes)]
            first += len(nodes)
        start += total
    return found._replace(total=start)


class Numbering:
    """Nodes of the system; each type of body has a slice of them.

    Attributes:
        total: Number of all nodes; ``count`` of them are master nodes and have unknowns.
        nodes: Numbers of the nodes of each body.
        assemblies: Slice of the nodes of each assembly, and the assembly.
        members: Bodies of each assembly, in its order.
        has_drilling: Whether the nodes of each body have drilling rotations.
        master_map: Master node of each node.
        frames: Initial frames of the master nodes, shape (count, 4, 3).
        start_frames: Current frames of the master nodes at the start of a run, which differ from
            the initial frames for bodies in a deformed configuration.
        velocities: Initial local velocities of the master nodes, shape (count, 6).
        groups: Group of each master node, shape (count,).
        kinds: :class:`~fem_lie.lie.node_types.NodeType` of each master node, shape (count,).
        clamp_holds: Unknowns of each master node that a clamp holds, shape (count, 6).
        held: Unknowns of the master nodes that their bodies hold, shape (count, 6).
        missing_unknowns: Unknowns that nodes with fewer than six do not have, (count, 6); they are
            held as well.
        supported: Master nodes that their bodies support, in ascending order.
        supports: Axes fixed in space of the master nodes' translations, nan if local, (count, 3,
            3).
        separates_director: Master nodes that statics moves by ``x + R u``, tilts and then drills,
            shape (count,).
        separates_rotation: Other nodes that move by ``x + R u``, with one rotation, shape (count,).
    """

    def __init__(
        self,
        bodies: Sequence[Body],
        links: Sequence[RigidLink] = (),
        holds: Holds = NO_HOLDS,
        state: InitialState | None = None,
        strained: Collection[str] = (),
        given: Assembled | None = None,
    ) -> None:
        """Build the assemblies and number their nodes.

        Args:
            bodies: All bodies.
            links: Rigid links between points.
            holds: Items that act on the rotations of the bodies' nodes.
            state: State of the bodies from which solvers start; default: their own.
            strained: Names of bodies with stress-free strains.
            given: The assemblies, if they are known.

        Raises:
            ValueError: Frames or velocities of a body are invalid; initial velocities of linked
                nodes contradict each other, or supports of an attached node have no counterpart in
                the unknowns of its master node.
        """
        found = assembled(bodies, holds, strained) if given is None else given
        self.nodes, self.assemblies, self.members, self.has_drilling, self.total = found
        for body in bodies:
            body.model.check()
        self._attach(links, state)

    def _attach(self, links: Sequence[RigidLink], state: InitialState | None) -> None:
        frames, velocities = np.empty((self.total, 4, 3)), np.empty((self.total, 6))
        # one array for both if they are equal
        moved = any(body.model.start_frames is not None for body in self.nodes)
        elsewhere = moved or state is not None
        start_frames = np.empty_like(frames) if elsewhere else frames
        groups, kinds = np.empty((2, self.total), dtype=np.int64)
        supports, own = np.empty((self.total, 3, 3)), np.empty(self.total, dtype=bool)
        held, separates_director = (
            np.empty((self.total, 6), dtype=bool),
            np.empty(self.total, dtype=bool),
        )
        separates_rotation, missing_unknowns = (
            np.empty(self.total, dtype=bool),
            np.empty((self.total, 6), dtype=bool),
        )
        pairs = [(self._of_all(link.a), self._of_all(link.b)) for link in links]
        for body, nodes in self.nodes.items():
            frames[nodes], velocities[nodes] = body.frames, body.velocities
            start_frames[nodes] = (
                body.frames if body.model.start_frames is None else body.model.start_frames
            )
            if state is not None:
                rows = state.nodes[body]
                start_frames[nodes] = state.path[-1, rows]
                velocities[nodes] = state.velocities[rows]
            groups[nodes], kinds[nodes] = body.model.group, body.model.node_types
            held[nodes], separates_director[nodes] = body.model.held, body.model.separates_director
            own[nodes], separates_rotation[nodes] = (
                body.model.held.any(axis=1),
                body.model.separates_rotation,
            )
            held[nodes, 5] |= not self.has_drilling[body]
            missing_unknowns[nodes] = body.model.missing_unknowns
            supports[nodes] = body.model.supports
            attached_nodes = np.flatnonzero(body.model.masters != np.arange(len(nodes)))
            masters = body.model.masters[attached_nodes]
            pairs += [
                (int(nodes[a]), int(nodes[b])) for a, b in zip(masters, attached_nodes, strict=True)
            ]
        # attached nodes follow from the current configuration at the start, which may be deformed
        self.master_map = MasterMap(start_frames, pairs)
        self.count = self.master_map.count
        self.frames = frames[self.master_map.masters]
        self.start_frames = start_frames[self.master_map.masters] if elsewhere else self.frames
        # length scale of translations against rotations; arbitrary for one node
        self._size = float(np.linalg.norm(np.ptp(frames[:, 0], axis=0))) or 1.0
        self.velocities = velocities[self.master_map.masters]
        self.groups: Indices = groups[self.master_map.masters]
        self.kinds: Indices = kinds[self.master_map.masters]
        known, which = np.unique(self.kinds, return_inverse=True)
        traits = [TRAITS[NodeType(kind)] for kind in known]
        self.clamp_holds: Flags = np.array([each.clamp_holds for each in traits])[which]
        self.held = held[self.master_map.masters]
        self.supported: Indices = np.unique(self.master_map.master[own])
        self.separates_director = np.zeros(self.count, dtype=bool)
        np.logical_or.at(self.separates_director, self.master_map.master, separates_director)
        self.separates_rotation: Flags = separates_rotation[self.master_map.masters]
        self.supports = supports[self.master_map.masters]
        self._hold_masters(held, np.isfinite(supports[:, 0, 0]))
        # unknowns that a node type does not have are not coupled in the matrix
        self.missing_unknowns = (
            np.arange(6) >= np.array([[each.unknowns] for each in traits])[which]
        )
        self.missing_unknowns |= missing_unknowns[self.master_map.masters]
        self.held |= self.missing_unknowns
        self._check_velocities(velocities)

    def _hold_masters(self, held: Flags, fixed: Flags) -> None:
        """Hold the unknowns of master nodes that correspond to supports of attached nodes."""
        # nodes with the frame of their master node that hold no more than it add nothing
        adds = fixed | (self.master_map.offset != _SAME_FRAME).any(axis=(1, 2))
        adds |= (held & ~self.held[self.master_map.master]).any(axis=1)
        adds[self.master_map.masters] = False
        for node in np.flatnonzero(adds & held.any(axis=1)):
            master, offset = self.master_map.master[node], self.master_map.offset[node].copy()
            offset[0] /= self._size
            # constraints on the unknowns of the master node
            rows = np.vstack(
                [np.eye(6)[self.held[master]], lie.se3_adjoint(lie.se3_inverse(offset))[held[node]]]
            )
            reach = rows.T @ np.linalg.pinv(rows.T, rcond=_INDEPENDENT)
            whole = np.abs(np.diag(reach) - 1.0) < _INDEPENDENT
            moved = fixed[node] or np.isfinite(self.supports[master, 0, 0])
            if round(np.trace(reach)) > whole.sum() or (moved and not whole.all()):
                body = next(body for body, nodes in self.nodes.items() if node in nodes)
                raise ValueError(
                    f"a node of {body.label} has supports and is attached by a rigid link to one "
                    "whose unknowns are along other axes: support that node instead, or link the "
                    "other way round"
                )
            self.held[master] = whole

    def _check_velocities(self, given: Array) -> None:
        units = np.repeat([self._size, 1.0], 3)
        away = np.abs(self.master_map.twists(self.velocities) - given) / units
        gap = away.max(axis=1, initial=0.0)
        if gap.max(initial=0.0) > 1e-9 * np.abs(given / units).max(initial=0.0):
            node = int(gap.argmax())
            body = next(body for body, nodes in self.nodes.items() if node in nodes)
            raise ValueError(
                f"the initial velocities of {body.label} contradict a rigid link: linked nodes "
                "need the velocities of one rigid motion"
            )

    def _of_all(self, point: Point) -> int:
        assert point.body is not None
        require_node(point, "what holds unknowns")
        return int(self.nodes[point.body][point.node])

    def node(self, point: Point) -> int:
        """Number of a point's master node; ``count`` for ground."""
        if point.body is None:
            return self.count
        return int(self.master_map.master[self._of_all(point)])

    def bodies(self) -> tuple[BodyInfo, ...]:
        """Records of the bodies for results, in the numbering of all nodes."""
        return tuple(BodyInfo.of(body, nodes) for body, nodes in self.nodes.items())


def numbering_for(scene: Scene, user: object) -> Numbering:
    """Numbering of a scene's nodes, with the assembled forms of the elements, for ``user``.

    Scenes that differ in loads and drives only share it.

    Raises:
        ValueError: Two bodies were given the same name after they were added.
    """
    if scene.family is None:
        return numbered(scene)
    if scene.family.setup is None:
        scene.family.setup = SharedSetup()
    found: SharedSetup = scene.family.setup
    return found.numbering(scene, user)


_USERS = 2
"""Setups that a family keeps: an analysis finds an equilibrium, and uses the scene at it."""


@dataclass(eq=False)
class _Setup:
    """A setup and its user.

    Attributes:
        assembled: Assembled forms.
        forms: Mark of all on which they depend.
        numbering: Numbering with these forms.
        motion: Mark of all on which it depends.
        stresses: Independent stresses at the start.
        user: Who has reserved it.
    """

    assembled: Assembled
    forms: bytes
    numbering: Numbering
    motion: bytes
    stresses: list[Array]
    user: weakref.ref[Any]

    @classmethod
    def of(cls, scene: Scene, marks: tuple[bytes, bytes], user: object) -> _Setup:
        """A new setup."""
        found = _assembled(scene)
        stresses = [each.stress_values for _, each in found.assemblies]
        forms, motion = marks
        return cls(found, forms, numbered(scene, found), motion, stresses, weakref.ref(user))

    def taken(self, scene: Scene, motion: bytes, user: object) -> Numbering:
        """The numbering at the start, reserved for ``user``."""
        for (_, each), values in zip(self.assembled.assemblies, self.stresses, strict=True):
            each.reset(values)
        if motion != self.motion:
            self.numbering, self.motion = numbered(scene, self.assembled), motion
        self.user = weakref.ref(user)
        return self.numbering


class SharedSetup:
    """Setups shared by the scenes of a family, each by one user at a time.

    Attributes:
        made: Number of times that forms were assembled.
    """

    def __init__(self) -> None:
        """Start without a setup."""
        self.made = 0
        self._setups: list[_Setup] = []

    def numbering(self, scene: Scene, user: object) -> Numbering:
        """Numbering of a scene of the family, reserved for ``user`` as long as it lives.

        It is rebuilt if links, attached nodes or the start have changed, forms are assembled anew
        if bodies have, and both for a third user while two others live.
        """
        forms, motion = marks = _marks(scene)
        free = [each for each in self._setups if each.user() is None]
        for each in free:
            if each.forms == forms:
                return each.taken(scene, motion, user)
        if len(self._setups) == _USERS:
            if not free:
                return numbered(scene)
            self._setups.remove(free[0])
        self.made += 1
        self._setups.append(_Setup.of(scene, marks, user))
        return self._setups[-1].numbering


def _assembled(scene: Scene) -> Assembled:
    return assembled(scene.bodies, scene.held_rotations(), strained_bodies(scene.loads))


def numbered(scene: Scene, given: Assembled | None = None) -> Numbering:
    """New numbering of a scene's nodes, with the assembled forms of the elements.

    Args:
        scene: The scene.
        given: The forms, if they are assembled.

    Raises:
        ValueError: Two bodies were given the same name after they were added.
    """
    twice = [name for name, count in Counter(b.name for b in scene.bodies).items() if count > 1]
    if twice:
        raise ValueError(f"the scene has several bodies named {twice[0]!r}")
    of_scene = scene.bodies, scene.links, scene.held_rotations(), scene.began.state
    return Numbering(*of_scene, strained_bodies(scene.loads), given)


_OF_MOTION = "masters", "start_frames", "velocities"


def _marks(scene: Scene) -> tuple[bytes, bytes]:
    """Fingerprints of all on which assemblies depend, and on which the numbering depends, too."""
    bytes_of, holds = CanonicalBytes(scene.bodies), scene.held_rotations()
    data = [data_of_body(body) for body in scene.bodies]
    bodies = [
        (
            type(body),
            [each for each in values if each[0] not in _OF_MOTION],
            body.model.drilling_for(holds.get(body.model, ())),
        )
        for body, values in zip(scene.bodies, data, strict=True)
    ]
    strained = strained_bodies(scene.loads)
    # most assemblies take such strains in any case
    other = [b.name in strained and b.model.with_strains() is not b.model for b in scene.bodies]
    motion = [[each for each in values if each[0] in _OF_MOTION] for values in data]
    return bytes_of.of((bodies, other)), bytes_of.of((motion, scene.links))
