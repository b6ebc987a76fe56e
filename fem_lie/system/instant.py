"""What the equations are given and what they find: instants, plans of matrices, forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.forms.abilities import Ends
from fem_lie.forms.fixed_arrays import FixedArrays
from fem_lie.scene.choices import Choices

ALL = Choices(gyroscopic=True, geometric=True)
"""Nothing is left out."""


class Instant(NamedTuple):
    """A scene at one time.

    Attributes:
        H: Frames of all rows.
        v: Local velocities of the moving nodes, shape (≥ n, 6).
        a: Their rates, shape (≥ n, 6).
        weights: Multipliers (forces and moments), shape (m,).
    """

    H: Array
    v: Array
    a: Array
    weights: Array


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
        border_only: Whether all but the constraints stays what it was made last.
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
    border_only: bool = False
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
