"""Abilities of a term beyond forces and a tangent; a term returns an object for each, or ``None``.

Most terms are these objects themselves: their class derives from :class:`~fem_lie.forms.term.Term`
and from the abilities.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from math import ceil
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices

FRICTION_COLUMNS = 9
"""Columns of :meth:`PathDependence.friction_forces`."""


class PassedThroughError(ArithmeticError):
    """Surfaces went through each other within a step."""

    def __init__(self, who: str, moved: float, thickness: float) -> None:
        """Compose the message, with a remedy.

        Args:
            who: Name of the contact, or of both bodies.
            moved: Relative displacement in the step, m.
            thickness: Sum of the thicknesses of both surfaces, m.
        """
        times = ceil(2.0 * moved / thickness)
        helps = "a higher stiffness, since the load exceeds the contact force"
        if times > 1:
            helps = f"steps {times} times smaller, AdaptiveStep, or thicker surfaces"
        super().__init__(
            f"{who}: one side passed through the other within a step (it moved by {moved:.2g}, "
            f"both together are {thickness:.2g} thick): use {helps}"
        )


class Ends(NamedTuple):
    """Nodal coordinates of a step, each of shape (≥ nodes, 4, 3).

    Attributes:
        start: Coordinates (x, d₁, d₂, d₃) at the start.
        end: Coordinates at the end.
        mean: Their means.
        delta: Their increments.
    """

    start: Array
    end: Array
    mean: Array
    delta: Array


class Done(NamedTuple):
    """Energy and work of forces over a step.

    Attributes:
        stored: Stored energy at the end, J.
        work: Work done on the term, stored or dissipated, J.
        lost: Dissipated part of the work, J.
    """

    stored: float
    work: float
    lost: float


class StiffRows(NamedTuple):
    """Tangent ``Σ k b bᵀ`` of low rank.

    Attributes:
        nodes: Nodes of each ``b``, −1 where there is none, shape (m, s).
        rows: ``b`` in the twists of these nodes, shape (m, s, 6).
        stiffness: ``k``, shape (m,).
    """

    nodes: Indices
    rows: Array
    stiffness: Array


class ViscousForces(ABC):
    """Forces that depend on twists.

    Attributes:
        in_space: Whether they oppose rigid motions, too.
    """

    in_space: bool = False

    @abstractmethod
    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the viscous forces at twists ``v`` (≥ moving nodes, 6) to ``out``."""

    @abstractmethod
    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """Derivatives of the viscous forces in the twists, and in frames or ``None`` if neglected.

        The second is at constant velocities of the nodes' groups, as
        :func:`~fem_lie.lie.node_types.at_rest` defines them.
        """

    @property
    def rates(self) -> tuple[Indices, Indices, Array] | None:
        """Rows, columns and blocks (nnz, 4, 4) of ``D`` if the forces are ``Lᵀ D q̇``, D constant.

        ``q`` are the coordinates (x, d₁, d₂, d₃) of the nodes.
        """
        return None


class LinearisedStress(ABC):
    """Independent stress, or other local unknowns, updated linearly between iterates."""

    @property
    @abstractmethod
    def linearised_values(self) -> Array:
        """Current values, flat."""

    @abstractmethod
    def restore(self, values: Array) -> None:
        """Set the values to an earlier copy of :attr:`linearised_values`."""

    @abstractmethod
    def update_stress(self, H: Array, h: Array) -> None:
        """Update the values linearly for the increment ``h`` (n, 6), from frames ``H``."""

    @abstractmethod
    def reset_stress(self, H: Array) -> None:
        """Set the values to those of frames ``H``."""

    @abstractmethod
    def clear_stress(self) -> None:
        """Set the values to zero, so that the tangent has no geometric stiffness."""


class ContactState(ABC):
    """State of a contact that a file has under the number of the contact in the scene."""

    @abstractmethod
    def contact_state(self, numbers: Indices) -> dict[str, Array]:
        """State by name, which names nodes by their numbers in the scene.

        Args:
            numbers: Number in the scene of each node of the bodies, shape (n,).
        """

    @abstractmethod
    def restore_contact(self, kept: Mapping[str, Array], nodes: Indices) -> None:
        """Restore the state of :meth:`contact_state`.

        Args:
            kept: That state.
            nodes: Node of each number in the scene, shape (N,).
        """


class LocalUnknowns(ABC):
    """Unknowns of cells on which forces depend."""

    @abstractmethod
    def condense(self, H: Array) -> None:
        """Solve for the local unknowns at frames ``H``."""


class PathDependence(ABC):
    """Forces that depend on earlier accepted states.

    Attributes:
        friction: Whether they also depend on the motion of nodes since the last accepted state.
        key: Number that identifies the contact in results.
    """

    friction: bool = False
    key: int = 0

    @property
    def dissipated(self) -> float:
        """Energy dissipated by friction in all accepted steps, J; default: none.

        Conserving schemes account for it by :class:`StepForces` instead.
        """
        return 0.0

    def friction_forces(self, H: Array, v: Array) -> Array:
        """Friction forces in the last accepted state, with ``H`` and twists ``v``, shape (k, 9).

        Numbers of both points, gap, position and force on the first side (3 each), global
        components; default: none.
        """
        return np.empty((0, FRICTION_COLUMNS))

    @abstractmethod
    def accept(self, H: Array, start: Array | None = None) -> None:
        """Accept the state with frames ``H``.

        Args:
            H: Frames of all nodes at the end of a step, shape (n, 4, 3).
            start: Those at its start, if there was a step.
        """


class PassageCheck(ABC):
    """Check of steps in which surfaces may pass through each other, or touch too briefly."""

    @abstractmethod
    def check_passage(self, start: Array, end: Array) -> None:
        """Check whether surfaces passed through each other.

        Args:
            start: Frames at the start of a step.
            end: Frames at its end.

        Raises:
            PassedThroughError: They did.
        """

    @abstractmethod
    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Record a step of a scheme that does not conserve energy.

        Args:
            start: Frames at the start of the step.
            end: Frames at its end.
            h: Step size.
            middle: Frames at which forces act in the step; ``None``: at both ends.
        """

    @property
    @abstractmethod
    def watched(self) -> Array:
        """Record of :meth:`watch`, flat."""

    @abstractmethod
    def watch_again(self, watched: Array) -> None:
        """Set the record to an earlier copy of :attr:`watched`."""


class StepForces(ABC):
    """Forces over a step whose work is exactly the change of the stored energy.

    Attributes:
        steady: Whether the forces contain no correction of round-off.
    """

    steady: bool = False

    @abstractmethod
    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """Add the forces.

        Args:
            ends: Coordinates of the step.
            out: Forces, and moments about the mean positions of nodes, global components, (nodes,
                6).
            ground: Force, and moment about the origin, on ground, (6,).
        """

    @abstractmethod
    def tangent_over_step(self, ends: Ends, H: Array) -> Array:
        """Twice the derivative of the forces in the twists at the end.

        It has the shape of the tangent and is along the axes of the midpoint frames ``H``; ``mean``
        and ``delta`` of ``ends`` are those of all nodes.
        """

    @abstractmethod
    def overlaps(self, H: Array) -> bool:
        """Whether there are such forces at frames ``H``."""

    @abstractmethod
    def keep_gaps(self) -> None:
        """Keep what the last :meth:`overlaps` found for later steps."""


class LowRankTangent(ABC):
    """Tangent that a frozen matrix may omit, because a low-rank correction adds it."""

    @abstractmethod
    def stiff_rows(self, H: Array) -> StiffRows:
        """Dominant part of the tangent as a sum of few rank-one matrices."""


class GroundForces(ABC):
    """Forces some of which act between nodes and ground."""

    @abstractmethod
    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """Add forces on nodes at twists ``v`` whose reaction is on ground to ``out``."""
