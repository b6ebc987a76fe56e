"""Rows of frames that all equations share: moving nodes, ground, prescribed motions."""

from __future__ import annotations

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, diameter
from fem_lie.joints.histories import declared, until_next
from fem_lie.lie.kinds import kinds_of
from fem_lie.lie.motions import Group, Parametrisation
from fem_lie.scene import Scene
from fem_lie.system.nodes.numbering import Numbering


class FrameRows:
    """What is in which row at the start.

    Attributes:
        kinds: What each moving node is, shape (n,), see :mod:`fem_lie.lie.kinds`.
        frames: Initial frames, shape (n + 1 + p, 4, 3).
        begins_at: Those from which solvers go on, at the scene's time.
        velocities: Initial local velocities, same rows, (…, 6).
        held: Which unknowns of the moving nodes are zero, shape (n, 6).
        lengths: Which halves of the unknowns of the moving nodes are lengths, shape (n, 2); others
            have no dimension.
        turning: Which unknowns have forces that turn with the node, as reactions of others do.
        supported: Moving nodes that clamps and bodies hold, shape (s,).
        length: Largest distance of two nodes, or a body's size.
    """

    def __init__(
        self,
        scene: Scene,
        numbering: Numbering,
        parametrisation: Parametrisation,
        group: Group | None,
    ) -> None:
        """Put them together.

        Args:
            scene: What there is.
            numbering: Of its nodes.
            parametrisation: Of increments.
            group: On which all frames move; ``None``: each on that of its body.
        """
        self._motions = scene.motions
        self._breaks = declared([motion.motion for motion in scene.motions], kinks=True)
        fixed = np.array([lie.frame(np.zeros(3), np.eye(3)), *self.prescribed(0.0)])
        self.frames = np.concatenate([numbering.frames, fixed])
        self.begins_at = self.frames
        if numbering.begins_at is not numbering.frames or scene.motions:
            now = np.concatenate([fixed[:1], self.prescribed(scene.began.time)])
            self.begins_at = np.concatenate([numbering.begins_at, now])
        self.velocities = np.concatenate([numbering.velocities, np.zeros((len(fixed), 6))])
        # what is held along fixed axes is held exactly where translations are along fixed axes
        guided = np.isfinite(numbering.supports[:, 0, 0])
        groups = numbering.groups if group is None else np.full_like(numbering.groups, int(group))
        groups = np.where(guided, int(Group.R3xSO3), groups)
        self.kinds: Indices = kinds_of(numbering.kinds, groups, parametrisation)
        self.held: Flags = numbering.held.copy()
        clamped = [numbering.node(clamp.point) for clamp in scene.clamps]
        self.held[clamped] |= numbering.clamped[clamped]
        self.supported: Indices = np.union1d(numbering.supported, clamped).astype(np.int64)
        # reactions of what is held in a node's own axes turn with them
        self.turning: Flags = ~self.held
        self.turning[guided, :3] = True
        lengths: Flags = np.zeros((numbering.total, 2), dtype=np.bool_)
        for body, nodes in numbering.nodes.items():
            lengths[nodes] = body.node_lengths
        self.lengths: Flags = lengths[numbering.attachment.leaders]
        places = self.frames[: numbering.count, 0]
        self.length = max(diameter(places), *(body.size for body in scene.bodies))

    def prescribed(self, time: float) -> Array:
        """Frames of the prescribed motions at ``time``, shape (p, 4, 3).

        Raises:
            ValueError: One of them is not a frame then.
        """
        frames = [motion.frame(time) for motion in self._motions]
        return np.array(frames).reshape(-1, 4, 3)

    def until_break(self, time: float) -> float:
        """How long it is to the next time at which a prescribed motion says that it jumps."""
        return until_next(self._breaks, time)
