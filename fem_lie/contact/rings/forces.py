"""Contact forces of rings on a rope, as a term: springs of zero length that slide on it."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.laws.anchors import CoulombLaw
from fem_lie.contact.laws.law import ContactTerm
from fem_lie.contact.rings import kernels
from fem_lie.contact.rings.curves import Ropes
from fem_lie.contact.rings.surfaces import Rings, Rope
from fem_lie.contact.sides.curves import weights
from fem_lie.contact.sides.table import GROUND, Nodes, number_of
from fem_lie.forms.abilities import (
    Done,
    Ends,
    GroundForces,
    LinearisedStress,
    PathDependence,
    StepForces,
)
from fem_lie.forms.term import Pairs

_BEYOND = 2
"""Number of nodes in the sparsity pattern on either side of those that a position depends on."""


class RingForces(ContactTerm, LinearisedStress, PathDependence, StepForces, GroundForces):
    """Contact forces of one rope that runs through rings.

    The positions of the rings on the rope at the last accepted frames are part of the state, with
    the friction springs. The closest point is searched from there, so that rings do not jump to
    another part of the rope.
    """

    label = "rings on a rope"
    conserved = steady = friction = True

    def __init__(
        self,
        rope: Rope,
        rings: Rings,
        law: CoulombLaw,
        nodes: Nodes,
        types: Indices,
        H: Array,
    ) -> None:
        """Find the positions of the rings on the rope.

        Args:
            rope: The rope.
            rings: The rings.
            law: Constants of the contact law.
            nodes: Gives the numbers of the nodes of a body in the scene.
            types: Types of all nodes, shape (n,).
            H: Initial frames of all nodes, shape (n, 4, 3).
        """
        self._law, self._ropes = law, _ropes_of(rope, rings, nodes, types)
        self._path = nodes(rope.body)[rope.path]
        count = len(rings.of)
        self._feet: Array = np.empty(count)
        kernels.set_feet(H, self._ropes, _near(rope, rings), self._feet)
        self._springs: Array = np.zeros(count)
        self._found, self._over = kernels.held(count), kernels.held(count)
        self._ahead: Array | None = None
        self._dissipated = 0.0
        self._grounded = bool((self._ropes.rings == GROUND).any())
        self._size = min(4 + 2 * _BEYOND, len(self._path))
        self._first = np.full(count, -1, dtype=np.int64)
        slots, _ = rope.controls()
        self._reach = np.column_stack([slots[:, 0], slots.max(axis=1)])
        self._look(self._feet)

    @property
    def stress_update(self) -> LinearisedStress:
        """State: positions on the rope, and friction springs."""
        return self

    @property
    def path(self) -> PathDependence:
        """Path dependence by the same state."""
        return self

    @property
    def over_step(self) -> StepForces:
        """Forces of a step."""
        return self

    @property
    def ground(self) -> GroundForces | None:
        """Forces on ground, if a ring is fixed to ground."""
        return self if self._grounded else None

    # --- the pattern ---

    def _look(self, feet: Array) -> None:
        """Extend the sparsity pattern to the nodes that positions depend on."""
        last = len(self._path) - self._size
        low, high = self._reach[self._pieces(feet)].T
        first = self._first
        separation = (first < 0) | (low < first) | (high >= first + self._size)
        if separation.any():
            first[separation] = np.clip(low - _BEYOND, 0, last)[separation]
            self.version += 1

    def _pieces(self, feet: Array) -> Indices:
        """Segments of the rope that positions are on."""
        inner = self._ropes.starts[1:-1]
        return np.searchsorted(inner, feet, side="right").astype(np.int64)

    @property
    def _windows(self) -> Indices:
        """Nodes of the rope and the ring, −1 for ground, shape (r, c)."""
        along = self._path[self._first[:, np.newaxis] + np.arange(self._size)]
        return np.column_stack([along, self._ropes.rings])

    @property
    def pairs(self) -> Pairs:
        """Pairs of nodes; another node stands in for a ring on ground."""
        windows = self._windows
        windows[:, -1] = np.where(windows[:, -1] < 0, windows[:, 0], windows[:, -1])
        count = windows.shape[1]
        return (
            np.repeat(windows, count, axis=1).ravel(),
            np.tile(windows, (1, count)).ravel(),
        )

    @property
    def pair_positions(self) -> Array:
        """State of the sparsity pattern, for checkpoints."""
        return np.repeat(self._first[:, np.newaxis].astype(np.float64), 3, axis=1)

    def restore_pairs(self, pair_positions: Array) -> None:
        """Restore the sparsity pattern."""
        self._first[:] = pair_positions[:, 0].astype(np.int64)
        self.version += 1

    # --- forces ---

    def _forces(self, H: Array, out: Array, *, grounded: bool = False) -> None:
        given = H, self._ropes, self._law, self._feet, self._springs
        kernels.add_forces(*given, grounded, self._found, out)

    def energy(self, H: Array) -> float:
        """Energy stored in normal and friction springs."""
        self._forces(H, np.zeros((len(H), 6)))
        return self._stored

    @property
    def _stored(self) -> float:
        """Energy of the springs at the frames of the last evaluation."""
        d, τ = self._found.distances, self._found.tractions
        return 0.5 * self._law.normal.k * float(d @ d) + 0.5 / self._law.holding * float(τ @ τ)

    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the contact forces to the residual."""
        self._forces(H, out)
        self._look(self._found.positions)

    def tangent(self, H: Array, kept: Array) -> Array:
        """Tangent stiffness of each pair of nodes."""
        self._forces(H, np.zeros((len(H), 6)))
        return self._tangents(H, self._found, 1.0)

    def _tangents(self, H: Array, found: kernels.Held, factor: float) -> Array:
        windows = self._windows
        blocks = np.zeros((windows.size * windows.shape[1], 6, 6))
        given = H, self._ropes, self._law, found
        kernels.tangents(*given, factor, windows, blocks)
        return blocks

    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """Add the contact forces on ground."""
        self._forces(H, out, grounded=True)

    # --- over a step ---

    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """Add the forces of a step whose work is the change of the stored energy."""
        given = ends, self._ropes, self._law, self._feet, self._springs
        stored, work = kernels.add_over_step(*given, self._over, out, ground)
        self._look(self._over.positions)
        τ, slip = self._over.tractions, self._over.slips
        holding = self._law.holding
        self._ahead = np.asarray(τ / holding)
        held, before = (
            0.5 / holding * float(τ @ τ),
            0.5 * holding * float(self._springs @ self._springs),
        )
        by_friction = float(τ @ slip)
        return Done(stored + held, work + by_friction, max(0.0, by_friction - (held - before)))

    def tangent_over_step(self, ends: Ends, H: Array) -> Array:
        """Tangent stiffness of the forces of a step."""
        return self._tangents(H, self._over, 2.0)

    def overlaps(self, H: Array) -> bool:
        """True: a rope is always in its rings."""
        return True

    def keep_gaps(self) -> None:
        """Do nothing."""

    @property
    def contents(self) -> tuple[Array | Indices, ...]:
        """All that the contact forces depend on."""
        return *self._ropes, self._path

    # --- state ---

    @property
    def linearised_values(self) -> Array:
        """State: dissipated energy, positions on the rope, and friction springs."""
        return np.concatenate([[self._dissipated], self._feet, self._springs])

    def restore(self, values: Array) -> None:
        """Restore the state that :attr:`linearised_values` returned."""
        self._dissipated = float(values[0])
        self._feet, self._springs = (part.copy() for part in np.split(values[1:], 2))

    def accept(self, H: Array, start: Array | None = None) -> None:
        """Accept frames; after a step, with the positions at which its forces have done work."""
        if self._ahead is not None:
            self._feet, self._springs = self._over.ends.copy(), self._ahead
            self._ahead = None
            return
        self._forces(H, np.zeros((len(H), 6)))
        τ, holding = self._found.tractions, self._law.holding
        springs = np.asarray(τ / holding)
        slip = self._springs + self._found.slips - springs
        self._dissipated += 0.5 * float((holding * self._springs + τ) @ slip)
        self._springs, self._feet = springs, self._found.ends.copy()

    @property
    def dissipated(self) -> float:
        """Energy dissipated by friction, by the trapezoidal rule."""
        return self._dissipated

    def friction_forces(self, H: Array, v: Array) -> Array:
        """Friction forces on the rope in the last accepted state, shape (k, 9)."""
        pairs, gaps, positions, _ = self._touching(H)
        forces = np.empty((len(gaps), 3))
        kernels.set_friction(H, self._ropes, self._feet, self._law.holding * self._springs, forces)
        rows: Array = np.column_stack([pairs, gaps, positions, forces])
        return rows[forces.any(axis=1)]

    def update_stress(self, H: Array, h: Array) -> None:
        """Do nothing: positions change when frames are accepted."""

    def reset_stress(self, H: Array) -> None:
        """Do nothing: positions change when frames are accepted."""

    def clear_stress(self) -> None:
        """Do nothing: positions change when frames are accepted."""

    # --- results ---

    @property
    def feet(self) -> Array:
        """Undeformed length of the rope before each ring, at the last accepted frames, (r,)."""
        return self._feet

    def touching(self, H: Array, v: Array) -> tuple[Indices, Array, Array, Array]:
        """Contact forces of the rings; positions are followed from one set of frames to the next.

        Returns:
            Pairs (segment, ring), distances as negative gaps, positions, and forces on the rope
            without friction, (r, …).
        """
        self.accept(H)
        return self._touching(H)

    def _touching(self, H: Array) -> tuple[Indices, Array, Array, Array]:
        """Contact forces of the rings in the last accepted state, with frames ``H``."""
        count = len(self._feet)
        X, positions = np.empty((2, count, 3))
        kernels.set_positions(H, self._ropes, self._feet, X, positions)
        pairs = np.stack([self._pieces(self._feet), np.arange(count)], axis=1)
        Δ = X - positions
        gaps: Array = -np.linalg.norm(Δ, axis=1)
        return pairs, gaps, positions, self._law.normal.k * Δ


def _ropes_of(rope: Rope, rings: Rings, nodes: Nodes, types: Indices) -> Ropes:
    """Rope and rings as packed arrays."""
    slots, controls = rope.controls()
    path, factors = nodes(rope.body)[rope.path], rings.factors()
    starts = np.concatenate([[0.0], np.cumsum(rope.lengths)])
    owners = np.array([number_of(p.body, p.node, nodes) for p in rings.of], dtype=np.int64)
    factors[owners == GROUND, 0] = 1.0
    return Ropes(np.where(slots < 0, -1, path[slots]), controls, starts, owners, factors, types)


def _near(rope: Rope, rings: Rings) -> Array:
    """The closest of sampled positions, which are a fraction of an element apart."""
    slots, controls = rope.controls()
    lengths, H = rope.lengths, rope.body.frames[rope.path]
    starts = np.cumsum(lengths) - lengths
    s = np.linspace(0.0, 1.0, 17)
    W = np.einsum("makq,sq->smak", controls, [weights(float(part)) for part in s])
    rows = np.where(slots[:, :, np.newaxis, np.newaxis] < 0, 0.0, H[slots][:, :, :2])
    curve = np.einsum("smak,makj->msj", W, rows)
    found = np.empty(len(rings.of))
    for k, position in enumerate(rings.positions):
        distance = np.linalg.norm(curve - position, axis=2)
        piece, part = np.unravel_index(distance.argmin(), distance.shape)
        found[k] = starts[piece] + s[part] * lengths[piece]
    return found
