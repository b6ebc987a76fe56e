"""Arguments and results of the equations: frames, states, plans of matrices, forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, diameter
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie.forms.abilities import Ends
from fem_lie.joints.histories import declared, difference_step
from fem_lie.lie.motions import Group, Parametrisation
from fem_lie.lie.node_types import node_types_of
from fem_lie.scene import Scene
from fem_lie.scene.matrix_terms import MatrixTerms
from fem_lie.system.nodes.numbering import Numbering


class NodalData:
    """Initial frames of nodes, ground and prescribed motions; properties of the moving nodes.

    Attributes:
        kinds: Type of each moving node, shape (n,), see :mod:`fem_lie.lie.node_types`.
        frames: Initial frames, shape (n + 1 + p, 4, 3).
        start_frames: Current frames at the start of a run, at the time of the scene.
        velocities: Initial local velocities, same rows, (…, 6).
        held: Unknowns of the moving nodes that are zero, shape (n, 6).
        lengths: Whether the first and the last three unknowns of the moving nodes are lengths,
            shape (n, 2); others have no dimension.
        turning: Unknowns whose forces rotate with the node, unlike reactions of supports.
        supported: Moving nodes that clamps and bodies support, shape (s,).
        length: Largest distance of two nodes, or size of a body.
    """

    def __init__(
        self,
        scene: Scene,
        numbering: Numbering,
        parametrisation: Parametrisation,
        group: Group | None,
    ) -> None:
        """Collect the data.

        Args:
            scene: The scene.
            numbering: Numbering of its nodes.
            parametrisation: Parametrisation of increments.
            group: Group of all frames; ``None``: that of each body.
        """
        self._motions = scene.motions
        self._breaks = declared([motion.motion for motion in scene.motions], kinks=True)
        fixed = np.array([lie.frame(np.zeros(3), np.eye(3)), *self.prescribed(0.0)])
        self.frames = np.concatenate([numbering.frames, fixed])
        self.start_frames = self.frames
        if numbering.start_frames is not numbering.frames or scene.motions:
            now = np.concatenate([fixed[:1], self.prescribed(scene.began.time)])
            self.start_frames = np.concatenate([numbering.start_frames, now])
        self.velocities = np.concatenate([numbering.velocities, np.zeros((len(fixed), 6))])
        # supports along fixed axes are exact where translations are along fixed axes
        guided = np.isfinite(numbering.supports[:, 0, 0])
        groups = numbering.groups if group is None else np.full_like(numbering.groups, int(group))
        groups = np.where(guided, int(Group.R3xSO3), groups)
        self.kinds: Indices = node_types_of(numbering.kinds, groups, parametrisation)
        self.held: Flags = numbering.held.copy()
        clamped = [numbering.node(clamp.point) for clamp in scene.clamps]
        self.held[clamped] |= numbering.clamp_holds[clamped]
        self.supported: Indices = np.union1d(numbering.supported, clamped).astype(np.int64)
        # reactions of supports in a node's own axes rotate with them
        self.turning: Flags = ~self.held
        self.turning[guided, :3] = True
        lengths: Flags = np.zeros((numbering.total, 2), dtype=np.bool_)
        for body, nodes in numbering.nodes.items():
            lengths[nodes] = body.model.node_lengths
        self.lengths: Flags = lengths[numbering.master_map.masters]
        positions = self.frames[: numbering.count, 0]
        self.length = max(diameter(positions), *(body.model.size for body in scene.bodies))

    def prescribed(self, time: float) -> Array:
        """Frames of the prescribed motions at ``time``, shape (p, 4, 3).

        Raises:
            ValueError: The value of a motion is not a frame.
        """
        frames = [motion.frame(time) for motion in self._motions]
        return np.array(frames).reshape(-1, 4, 3)

    def difference_step(self, time: float, step: float, count: int, last: float) -> float:
        """Interval of differences of prescribed motions, see :func:`.histories.difference_step`."""
        return difference_step(self._breaks, time, step, count, last)


ALL = MatrixTerms(gyroscopic=True, geometric=True)
"""All terms of the matrix."""


class TimeState(NamedTuple):
    """State of a scene at one time.

    Attributes:
        H: Frames of all nodes, ground and prescribed motions.
        v: Local velocities of the moving nodes, shape (≥ n, 6).
        a: Their rates, shape (≥ n, 6).
        multipliers: Lagrange multipliers (forces and moments), shape (m,).
    """

    H: Array
    v: Array
    a: Array
    multipliers: Array


class Plan(NamedTuple):
    """Which derivative of the residual a matrix is, and where the constraints are linearised.

    Attributes:
        d: Increments that led to the frames, shape (n, 6); zero where unknowns are twists anyway.
        scale: Scale factor of each constraint, shape (m,); default: one that fits the rest of the
            matrix and the Jacobian.
        mass: Derivative ∂a/∂d of accelerations in increments.
        damping: Derivative ∂v/∂d of twists in increments.
        joint_frames: Frames of the constraint Jacobian; default: those of the state.
        forces_at: Frames of the constraint forces; default: ``joint_frames``.
        motions: Maps (n, k, 3, 3) from the unknowns of each node to its translations, and to its
            rotations if k = 2, along its axes in ``H``; default: unknowns are these motions.
        end_motions: The same maps to motions of nodes in ``joint_frames``, the end of a step.
        start_forces: Transposes of the maps from forces on nodes in ``forces_at``, the start of a
            step, to rows of the matrix, of the same shape. Inertia with gyroscopic terms is then
            the change of momenta there by motions at the end. Default: rows are along the axes of
            the nodes.
        inertial: Whether components are along axes fixed in space instead of those of the nodes.
        stressed: Frames at which the stress of the geometric stiffness is evaluated; default: the
            independent stress.
        matrix_terms: Terms that are included, none of them undecided.
        constraints_only: Whether all but the constraint Jacobian stays as it was filled last.
        steady: Whether it is the stiffness in a frame in which all nodes move steadily. The plan
            then needs ``scale``, and has no other effect.
        at_rest: Step size ``h`` of a matrix for accelerations and impulses, ``M + h² K/4``, at rest
            with the current stress and a fitting scale; zero: the mass matrix. The plan then has no
            other effect.
        ends: Ends of a step, of all nodes, for terms with forces over a step; default: none.
        without_low_rank: Whether terms that can be separate low-rank corrections are left out.
        low_rank_only: Whether only the low-rank correction of these terms is filled; needs
            ``scale``.
        spread: Overwritten where a scale is found: change of each constraint of a vector under
            forces of the size of their scales, shape of ``vectors`` of the unknowns; default: not
            needed.
    """

    d: Array
    scale: Array | None = None
    mass: float = 0.0
    damping: float = 0.0
    joint_frames: Array | None = None
    forces_at: Array | None = None
    motions: Array | None = None
    end_motions: Array | None = None
    start_forces: Array | None = None
    inertial: bool = False
    stressed: Array | None = None
    matrix_terms: MatrixTerms = ALL
    constraints_only: bool = False
    steady: bool = False
    at_rest: float | None = None
    ends: Ends | None = None
    without_low_rank: bool = False
    low_rank_only: bool = False
    spread: Array | None = None


class Forces:
    """Forces of a residual, as its derivative needs them.

    Attributes:
        on_rows: Forces on (x, d₁, d₂, d₃): ``G q̈`` and mass-proportional damping minus dead loads,
            shape (n, 4, 3).
        outer: Forces on the nodes in their axes from inertia, loads, joints and springs, shape (n,
            6).
        inner: Forces of all other terms, shape (n, 6).
        own: Forces of each term whose derivative needs them.
        work: Two arrays of the shape of ``on_rows``, which is the second.
        addresses: Addresses of the arrays for compiled functions, if all forces are one sum.
    """

    def __init__(self, count: int, own: Sequence[Array], constant: Sequence[Any] | None) -> None:
        """Allocate the arrays.

        Args:
            count: Number n of moving nodes.
            own: Arrays for the forces of terms.
            constant: Fixed arrays for forces that are one sum, with ``None`` in the place of
                ``work``; ``None``: forces are not one sum.
        """
        self.work = np.zeros((2, count, 4, 3))
        self.on_rows = self.work[1]
        self.outer, self.inner = np.zeros((2, count, 6))
        self.own = own
        self.addresses: Indices | None = None
        if constant is not None:
            self._fixed = PackedArrays(self.work if a is None else a for a in constant)
            self.addresses = self._fixed.addresses
