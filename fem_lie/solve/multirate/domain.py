"""Domains of different steps: what they have in common, subscenes, and joints between them.

Joints between bodies of different step sizes act over a whole step as over a single one.
Constraints are bilinear in ``q = (x, d₁, d₂, d₃)`` of their nodes, so that with the means ``q̄``
and increments ``Δq`` of a whole step ``Φ(q₁) − Φ(q₀) = Φ'(q̄) Δq``, whatever number of steps a body
has made. Multipliers ``λ`` act over the whole step by constant forces on ``q``, with the force and
the moment of ``Φ'(q̄)ᵀ λ``::

    P = (f, a × d̄₁, a × d̄₂, a × d̄₃),            Σ d̄ₖ × (a × d̄ₖ) = m

The work of ``P`` in all steps of a body is ``P·Δq``, and that on all bodies ``λ·(Φ(q₁) − Φ(q₀))``,
which is zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, TypeVar

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie._state import HasState
from fem_lie.bodies.body import Body
from fem_lie.joints.equations.joint_arrays import PackedJoints
from fem_lie.joints.joint import Joint
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.lie.tuples import Vector, combined, cross, dot, load, load_row, plus, scaled, store_row
from fem_lie.scene import Scene
from fem_lie.solve.conserving.step.joints import add_joints
from fem_lie.system.equations import Equations

K = TypeVar("K")


class Domain(HasState, Protocol):
    """Bodies with steps of one scheme and one size; a whole step can be repeated from its start.

    Attributes:
        rows: Indices of its moving nodes among those of the scene.
        count: Number of steps in a whole step.
        h: Size of each.
    """

    rows: Indices
    count: int
    h: float

    def start(self) -> None:
        """Make the state consistent at time 0."""

    def begin(self) -> None:
        """Save the current state: whole steps start from it until the next call."""

    def go_back(self) -> None:
        """Restore the saved state."""

    def go(self, forces: Array, start: float) -> bool:
        """Make a whole step from the saved state; return whether it was made.

        Args:
            forces: Constant forces on ``(x, d₁, d₂, d₃)`` of all moving nodes of the scene, (n, 4,
                3). Their work enters the energy balance.
            start: Time of that state.
        """

    def resize_whole(self, size: float) -> None:
        """Set the state as the start of a whole step of another size."""

    @property
    def now(self) -> Array:
        """Frames of the current state, (n, 4, 3)."""

    @property
    def before(self) -> Array:
        """Frames of the saved state, (n, 4, 3)."""

    @property
    def rates(self) -> Array:
        """Rates of (x, d₁, d₂, d₃), then those of products of reduced bodies, (≥ n, 4, 3)."""

    @property
    def twists(self) -> Array:
        """Velocities along the axes of the nodes, (n, 6)."""

    @property
    def so_far(self) -> Array:
        """Energy balance and impulses up to the current state, (15,)."""

    @property
    def stored(self) -> float:
        """Stored energy of cells and contacts."""

    @property
    def matrices(self) -> int:
        """Number of matrices factorised."""


def domains(scene: Scene, of: Mapping[Body, K]) -> tuple[dict[K, Scene], Scene]:
    """Subscenes of the bodies with each sort of steps, and that of the joints between them.

    Args:
        scene: The scene.
        of: Sort of the steps of each body.

    Raises:
        ValueError: A connection between two subscenes is not a joint.
    """
    parts = {sort: _empty(scene) for sort in of.values()}
    between = _empty(scene)
    for body in scene.bodies:
        parts[of[body]].add(body)
        between.add(body)
    for item, bodies in scene.items():
        touched = {of[body] for body in bodies if body is not None}
        if len(touched) == 1:
            parts[touched.pop()].add(item)
        elif isinstance(item, Joint):
            between.add(item)
        else:
            named = ", ".join(body.label for body in bodies if body is not None)
            raise ValueError(
                f"MultiRate: expected only joints between bodies with steps of their own, got "
                f"{type(item).__name__} between {named}; give these steps of one size"
            )
    for item in scene.links:
        between.add(item)
    return parts, between


def _empty(scene: Scene) -> Scene:
    part = Scene(scene.gravity, matrix_terms=scene.matrix_terms, redundant=scene.redundant)
    part.began = scene.began._replace(turned=None)
    return part


def rows_of(part: Equations, whole: Equations) -> Indices:
    """Indices of the moving nodes of a domain among those of the scene."""
    node = np.empty(part.unknowns.total, dtype=np.int64)
    for body, own in part.unknowns.bodies.items():
        node[own] = whole.unknowns.bodies[body]
    number = np.full(whole.unknowns.total, -1, dtype=np.int64)
    number[whole.unknowns.masters] = np.arange(whole.unknowns.moving)
    return np.asarray(number[node[part.unknowns.masters]])


@compiled
def joined(
    kinds: Indices,
    H: Array,
    moved: Array,
    joints: PackedJoints,
    multipliers: Array,
    out: tuple[Array, Array],
) -> None:
    """Changes of the constraints over a whole step, and constant forces in it.

    Args:
        kinds: Types of the moving nodes, (n,); for nodes other than frames positions are joined.
        H: Nodes at its start, (≥ n + 1, 4, 3); the ground is not involved.
        moved: Increments of the moving nodes, (n, 4, 3).
        joints: Packed arrays of the joints.
        multipliers: Lagrange multipliers, (m,).
        out: The changes, (m,), and forces on nodal coordinates, (n, 4, 3); overwritten.
    """
    change, forces = out
    n = moved.shape[0]
    delta, mean = np.zeros_like(H), H.copy()
    for i in range(n):
        for k in range(4 if kinds[i] < POSITION_GRADIENT else 1):
            for j in range(3):
                delta[i, k, j] = moved[i, k, j]
                mean[i, k, j] += 0.5 * moved[i, k, j]
    acting, ground = np.zeros((n, 6)), np.zeros(6)
    add_joints(
        mean, delta, joints, multipliers, np.zeros_like(multipliers), 1.0, change, acting, ground
    )
    for i in range(n):
        # of a residual
        store_row(forces[i], 0, scaled(-1.0, load(acting[i], 0)))
        for k in range(1, 4):
            store_row(forces[i], k, (0.0, 0.0, 0.0))
        if kinds[i] >= POSITION_GRADIENT:
            continue
        a = _turning(mean[i], scaled(-1.0, load(acting[i], 3)))
        for k in range(1, 4):
            store_row(forces[i], k, cross(a, load_row(mean[i], k)))


@compiled
def _turning(d: Array, m: Vector) -> Vector:
    """``a`` with ``Σ d_k × (a × d_k) = m``."""
    K = np.zeros((3, 3))
    for k in range(1, 4):
        row = load_row(d, k)
        for i in range(3):
            K[i, i] += dot(row, row)
            for j in range(3):
                K[i, j] -= row[i] * row[j]
    x, y, z = load_row(K, 0), load_row(K, 1), load_row(K, 2)
    whole = 1.0 / dot(x, cross(y, z))
    # K is symmetric: its rows are its columns
    first = combined(m[0], cross(y, z), m[1], cross(z, x))
    return scaled(whole, plus(first, scaled(m[2], cross(x, y))))
