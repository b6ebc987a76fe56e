"""What equations are given and what they find: frames, states, plans of matrices, forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, diameter
from fem_lie.forms.abilities import Ends
from fem_lie.forms.fixed_arrays import FixedArrays
from fem_lie.joints.histories import declared, until_next
from fem_lie.lie.motions import Group, Parametrisation
from fem_lie.lie.node_types import node_types_of
from fem_lie.scene import Scene
from fem_lie.scene.choices import Choices
from fem_lie.system.nodes.numbering import Numbering


class FrameRows:
    """What is in which row at the start.

    Attributes:
        kinds: What each moving node is, shape (n,), see :mod:`fem_lie.lie.node_types`.
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
        self.kinds: Indices = node_types_of(numbering.kinds, groups, parametrisation)
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
        self.lengths: Flags = lengths[numbering.master_map.masters]
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


ALL = Choices(gyroscopic=True, geometric=True)
"""Nothing is left out."""


class TimeState(NamedTuple):
    """A scene at one time.

    Attributes:
        H: Frames of all rows.
        v: Local velocities of the moving nodes, shape (≥ n, 6).
        a: Their rates, shape (≥ n, 6).
        multipliers: Multipliers (forces and moments), shape (m,).
    """

    H: Array
    v: Array
    a: Array
    multipliers: Array


class Plan(NamedTuple):
    """What a matrix is to be the derivative in, and where its constraints are taken.

    Attributes:
        d: Increments that led to the frames, shape (n, 6).
        scale: Factor of each constraint, shape (m,); default: what suits the rest of the matrix
            with the Jacobian that is taken.
        mass: ∂a/∂d.
        damping: ∂v/∂d.
        joint_frames: Where the constraints' Jacobian is taken; default: at the state.
        forces_at: Where it is for their forces; default: the same.
        lag: Rotations by which the axes of the unknowns are behind those of the frames, along which
            nodes are moved, rotation vectors (n, 3); default: none.
        inertial: Whether components are along fixed axes, not along those of the nodes.
        stressed: Frames whose stress it has; default: the stress that is carried.
        choices: What is taken in, nothing left open.
        constraints_only: Whether all but the constraints stays what it was made last.
        steady: Whether it is the stiffness in a frame in which all nodes move steadily; nothing of
            this plan counts then but the scale, which must be given.
        at_rest: Step size ``h`` of a matrix that finds accelerations, and impulses in joints:
            ``M + h² K/4``, at rest with the true stress, with a scale that suits it. Nothing else
            of this plan counts then.
        ends: Of a step, of all nodes, for terms whose forces are those over a step; default: none.
        apart: Whether terms that may be apart are left out.
        beside: Whether nothing is filled but what is then beside the matrix for them; the scale
            must be given.
        spread: Overwritten where a scale is found: by how much constraints that are one vector
            change each with forces of the size of their scales, shape of ``vectors`` of the
            unknowns; default: not asked for.
    """

    d: Array
    scale: Array | None = None
    mass: float = 0.0
    damping: float = 0.0
    joint_frames: Array | None = None
    forces_at: Array | None = None
    lag: Array | None = None
    inertial: bool = False
    stressed: Array | None = None
    choices: Choices = ALL
    constraints_only: bool = False
    steady: bool = False
    at_rest: float | None = None
    ends: Ends | None = None
    apart: bool = False
    beside: bool = False
    spread: Array | None = None


class Forces:
    """What a residual has found of the forces, as its derivative needs it.

    Attributes:
        on_rows: On (x, d₁, d₂, d₃): ``G q̈`` and mass damping minus dead loads, shape (n, 4, 3).
        outer: On the nodes in their axes: inertia, loads, joints and springs, shape (n, 6).
        inner: The same of all other terms, shape (n, 6).
        own: Of each term whose derivative takes its forces.
        work: Two arrays of the shape of ``on_rows``, of which that is the second.
        table: For compiled functions, where all forces are one sum.
    """

    def __init__(self, count: int, own: Sequence[Array], constant: Sequence[Any] | None) -> None:
        """Nothing is found yet.

        Args:
            count: Moving nodes ``n``.
            own: Room for the forces of terms.
            constant: Arrays that stay where they are, with ``None`` in the place of ``work``, for
                forces that are one sum.
        """
        self.work = np.zeros((2, count, 4, 3))
        self.on_rows = self.work[1]
        self.outer, self.inner = np.zeros((2, count, 6))
        self.own = own
        self.table: Indices | None = None
        if constant is not None:
            self._fixed = FixedArrays(self.work if a is None else a for a in constant)
            self.table = self._fixed.table
