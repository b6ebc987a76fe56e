"""Terms: what adds forces, energy and a matrix to the equations of nodes, inertia and joints apart.

Elements, pressure, springs and damping are terms. Nobody who sums them up asks which they are: they
say themselves what they have, and how they may be summed.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from math import ceil
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.forms.cell_forms import FormTable

Pairs: TypeAlias = tuple[Indices, Indices]
"""First and second node of each pair that a matrix couples."""


@compiled
def add_at(target: Array, place: Indices, blocks: Array) -> None:
    """``target[place] += blocks``, of any square blocks.

    Raises:
        ValueError: There are not as many places as blocks: pairs have changed since these were
            found, and compiled code would read what is not there.
    """
    if place.shape[0] != blocks.shape[0]:
        raise ValueError("there must be a place for each block: the pairs of a term have changed")
    size = blocks.shape[1]
    for b in range(place.shape[0]):
        for k in range(size):
            for n in range(size):
                target[place[b], k, n] += blocks[b, k, n]


class PassedThroughError(ArithmeticError):
    """Surfaces went through each other within a step."""

    def __init__(self, who: str, moved: float, thickness: float) -> None:
        """Say who did, and what helps.

        Args:
            who: Name of the contact, or of both bodies.
            moved: Relative displacement in the step, m.
            thickness: Of both surfaces together, m.
        """
        times = ceil(2.0 * moved / thickness)
        helps = "a higher stiffness, for what presses on them is more than they can hold"
        if times > 1:
            helps = f"steps {times} times smaller, AdaptiveStep, or thicker surfaces"
        super().__init__(
            f"{who}: one side went through the other within a step (it moved by {moved:.2g}, both "
            f"together are {thickness:.2g} thick): take {helps}"
        )


class PushedPieces(NamedTuple):
    """Straight pieces on which ``(x_j − x_i) × ½ (R_i + R_j) w`` acts, half of it on each end.

    Attributes:
        nodes: i and j of each piece, shape (s, 2).
        across: ``w`` at present, shape (s, 3).
    """

    nodes: Indices
    across: Array


class Ends(NamedTuple):
    """Both ends of a step of nodes, and what is between them, each of shape (≥ nodes, 4, 3).

    Attributes:
        start: Rows (x, d₁, d₂, d₃) at the start.
        end: At the end.
        mean: Means of both.
        delta: Increments.
    """

    start: Array
    end: Array
    mean: Array
    delta: Array


class Done(NamedTuple):
    """What forces over a step have done.

    Attributes:
        stored: Energy at the end.
        work: Done on the term, as it was stored or lost.
        lost: Of that.
    """

    stored: float
    work: float
    lost: float


class StiffRows(NamedTuple):
    """Part ``Σ k b bᵀ`` of a tangent.

    Attributes:
        nodes: Of each ``b``, −1 where there is none, shape (m, s).
        rows: ``b`` in the twists of these, shape (m, s, 6).
        stiffness: ``k``, shape (m,).
    """

    nodes: Indices
    rows: Array
    stiffness: Array


class FollowingTable(NamedTuple):
    """Forces as a sum over cells, on nodes that follow those of the equations.

    Attributes:
        table: Of the cells.
        leader: Of each node that the table numbers, shape (k,).
        offset: Frames of these in their leaders' frames, shape (k, 4, 3).
    """

    table: FormTable
    leader: Indices
    offset: Array


class NearCells(Protocol):
    """Forces of the cells that some nodes have."""

    def add_forces(self, H: Array, out: Array) -> None:
        """Add all forces on these nodes, and some on others, to ``out`` (≥ nodes that move, 6)."""


class CellMatrices(Protocol):
    """Matrices summed over cells, see :class:`~fem_lie.forms.cell_sums.CellSum`."""

    cells: npt.NDArray[np.integer[Any]]
    own_only: bool

    def choose(self, cells: Flags) -> None:
        """See there."""


_ASKED_BY = {
    "stiff_rows": "apart",
    "add_of_ground": "on_ground",
    "add_viscous_forces": "viscous",
    "viscous_tangent": "viscous",
    "carry": "carries",
    "restore": "carries",
    "settle": "settles",
    "accept": "rubs or parts",
    "check_passage": "watches",
    "watch": "watches",
    "watch_again": "watches",
    "clear_stress": "carries",
    "reset_stress": "carries",
    "add_over_step": "secant",
    "tangent_over_step": "secant",
    "overlaps": "secant",
}
"""Traits of terms that ask for methods which others need not define."""


class Term(ABC):
    """Forces on nodes, with the sign of a residual: those of an energy are its gradient.

    Forces and twists have components along the nodes' axes; nodes are rows of frames ``H``, of
    which the first may move.

    Attributes:
        label: What messages call it.
        version: Of :attr:`pairs`; another number means other pairs. They may change when forces
            are asked for, and the tangent that is asked for afterwards has them; with
            :attr:`tables` they stay.
        load: Whether it acts from outside: it does work and stores no energy.
        viscous: Whether there are forces that depend on twists.
        in_space: Whether these oppose rigid motions, too.
        of_bodies: Whether it acts within bodies or on them, and not between them.
        carries: Whether it carries stress, or unknowns of its own, from iterate to iterate.
        settles: Whether forces depend on unknowns of its own that have to be settled before.
        within_joints: Whether the sums over all joints have its forces, their power, and what
            :meth:`geometric` is, but not its tangents.
        conserved: Whether conserving schemes have its forces over a step.
        secant: Whether they have them by :meth:`add_over_step`.
        within_frames: Whether its energy is one of coordinates within frames of bodies, of which
            conserving schemes know by the bodies.
        steady: Whether these are as they are, and their size makes up for no round-off.
        turning: Whether a load turns with nodes or is a moment, and so has no potential.
        on_ground: Whether ground is the other side of some of the forces.
        apart: Whether a matrix that is kept may do without the tangent, beside which
            :meth:`stiff_rows` are taken in.
        rubs: Whether forces depend on how nodes have moved since the last accepted frames.
        parts: Whether it is to be told of accepted frames for other reasons.
        watches: Whether accepted steps are to be checked: surfaces might go through each other in
            one, or a step might not resolve how long they touch.
        amplitude: Factor of a load, which may be changed.
    """

    label: str = "forces"
    version: int = 0
    amplitude: float = 1.0
    load = viscous = in_space = of_bodies = turning = False
    carries = settles = within_joints = within_frames = False
    conserved = secant = steady = on_ground = rubs = watches = parts = apart = False

    def _undefined(self, method: Callable[..., Any]) -> NotImplementedError:
        """The error of a method that this class does not define, though its traits ask for it."""
        name = method.__name__
        return NotImplementedError(
            f"{type(self).__name__} ({self.label}) does not define {name}(), which is expected of "
            f"a Term whose class sets {_ASKED_BY[name]} = True"
        )

    # --- forces ---

    @property
    @abstractmethod
    def pairs(self) -> Pairs:
        """Nodes of the blocks of :meth:`tangent`, which move."""

    def room(self) -> Array:
        """For those of the forces that :meth:`tangent` takes; default: none."""
        return np.empty((0, 6))

    @abstractmethod
    def add_forces(self, H: Array, out: Array, kept: Array | None = None) -> None:
        """Add the forces at frames ``H``.

        Args:
            H: Frames.
            out: Shape (≥ nodes that move, 6).
            kept: See :meth:`room`, overwritten.
        """

    @abstractmethod
    def tangent(self, H: Array, kept: Array) -> Array:
        """Derivative of the forces in the twists of the nodes, (pairs, 6, 6).

        What is carried is in it as it is carried.

        Args:
            H: Frames.
            kept: What :meth:`add_forces` kept at these frames.
        """

    def linear_forces(self, H: Array, kept: Array, h: Array) -> Array:
        """The forces of :meth:`room` that increments ``h`` (n, 6) add, to first order.

        Args:
            H: Frames, the stress of which is carried.
            kept: What :meth:`add_forces` kept at these frames.
            h: Local increments of the nodes.
        """
        forces = self.room()
        if len(forces):
            rows, columns = self.pairs
            np.add.at(forces, rows, np.einsum("pij,pj->pi", self.tangent(H, kept), h[columns]))
        return forces

    def add_tangent(self, H: Array, kept: Array, place: Indices, K: Array) -> None:
        """Add :meth:`tangent` to blocks of a larger matrix.

        Args:
            H: Frames.
            kept: As there.
            place: Of each pair among the blocks, shape (pairs,).
            K: Blocks, shape (any, 6, 6).
        """
        add_at(K, place, self.tangent(H, kept))

    def stiff_rows(self, H: Array) -> StiffRows:
        """What counts of the tangent, by few rows; asked of terms that are apart."""
        raise self._undefined(self.stiff_rows)

    def near(self, nodes: Flags) -> NearCells | None:
        """The same forces on some nodes alone, if that is less work.

        Args:
            nodes: Which, shape (≥ nodes that move,).
        """
        return None

    def geometric(self, H: Array) -> Array | None:
        """What the derivative has beside :meth:`tangent`, of forces that are not carried."""
        return None

    def energy(self, H: Array) -> float:
        """Stored energy, of which the forces are the gradient; of loads zero."""
        return 0.0

    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """Add those of all forces, at twists ``v``, that ground is the other side of."""
        raise self._undefined(self.add_of_ground)

    @property
    def tables(self) -> tuple[FormTable, FormTable] | None:
        """Forces and energy as sums over cells, to be joined to others, if they are just that."""
        return None

    @property
    def over_cells(self) -> tuple[FormTable, FormTable] | None:
        """The same for schemes that take cells one by one; default: :attr:`tables`."""
        return self.tables

    @property
    def following(self) -> FollowingTable | None:
        """Forces as such a sum over nodes that follow those of the equations."""
        return None

    @property
    def matrices(self) -> Sequence[CellMatrices]:
        """The sums over the same cells that tangents are, if they are just that."""
        return ()

    # --- forces that depend on twists: asked of terms that say they are viscous ---

    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the forces at twists ``v`` (≥ nodes that move, 6)."""
        raise self._undefined(self.add_viscous_forces)

    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """Their derivatives in the twists, and in those of frames if that is not left out.

        The second is at constant velocities of the nodes' groups, as
        :func:`~fem_lie.lie.kinds.at_rest` has them.
        """
        raise self._undefined(self.viscous_tangent)

    @property
    def rates(self) -> tuple[Indices, Indices, Array] | None:
        """Rows, columns and blocks (nnz, 4, 4) of ``D``, if they are ``Lᵀ D q̇`` with constant D.

        ``q`` are (x, d₁, d₂, d₃) of the nodes.
        """
        return None

    # --- what is carried from iterate to iterate: asked of terms that carry, or settle ---

    @property
    def carried(self) -> Array:
        """Stress, or unknowns of the term's own; flat."""
        return np.empty(0)

    @property
    def contents(self) -> object:
        """All that the forces are made of, but for the amplitude."""
        return None

    def carry(self, H: Array, h: Array) -> None:
        """Carry the stress on to the end of the increment ``h`` (n, 6), from frames ``H``."""
        raise self._undefined(self.carry)

    def restore(self, carried: Array) -> None:
        """Carry again what was carried when it was copied."""
        raise self._undefined(self.restore)

    def settle(self, H: Array) -> None:
        """Make what the forces need of the term's own unknowns that of frames ``H``."""
        raise self._undefined(self.settle)

    def accept(self, H: Array) -> None:
        """Go on from frames ``H``; asked of terms that rub or part."""
        raise self._undefined(self.accept)

    def check_passage(self, start: Array, end: Array) -> None:
        """Look whether surfaces went through each other; asked of terms that watch.

        Args:
            start: Frames at the start of a step.
            end: At its end.

        Raises:
            PassedThroughError: They did.
        """
        raise self._undefined(self.check_passage)

    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Note a step of a scheme that does not conserve energy; asked of terms that watch.

        Args:
            start: Frames at the start of the step.
            end: At its end.
            h: Its size.
            middle: Where forces act in the step; None: at both ends.
        """
        raise self._undefined(self.watch)

    @property
    def watched(self) -> Array:
        """What :meth:`watch` has noted, flat; default: nothing."""
        return np.empty(0)

    def watch_again(self, watched: Array) -> None:
        """Have noted again what was :attr:`watched` once."""
        raise self._undefined(self.watch_again)

    def clear_stress(self) -> None:
        """Carry none: a tangent without geometric stiffness."""
        raise self._undefined(self.clear_stress)

    def reset_stress(self, H: Array) -> None:
        """Carry that of frames ``H``."""
        raise self._undefined(self.reset_stress)

    # --- what pairs follow from: asked of terms whose pairs change ---

    @property
    def seen(self) -> Array:
        """The places for which :attr:`pairs` were found; default: they stay."""
        return np.empty((0, 3))

    def see_again(self, seen: Array) -> None:
        """Have the pairs again that there were when :attr:`seen` was copied."""
        assert not len(seen)

    # --- over a step ---

    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """Add forces that do exactly the work by which the stored energy changes.

        Asked of terms that have secants.

        Args:
            ends: Of the step.
            out: Forces and moments about the mean places of nodes, global components, (nodes, 6).
            ground: Force and moment about the origin on ground, (6,).
        """
        raise self._undefined(self.add_over_step)

    def tangent_over_step(self, ends: Ends, H: Array) -> Array:
        """Twice the derivative of these in the twists at the end, in frames ``H`` half-way.

        Of the shape of :meth:`tangent`; ``mean`` and ``delta`` of ``ends`` are those of all nodes.
        """
        raise self._undefined(self.tangent_over_step)

    def overlaps(self, H: Array) -> bool:
        """Whether there are any such forces at frames ``H``; asked of the same."""
        raise self._undefined(self.overlaps)

    @property
    def pieces(self) -> PushedPieces | None:
        """The forces as conserving schemes have those of pressure, on nodes of bodies."""
        return None
