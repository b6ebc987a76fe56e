"""What a term may have beside forces and a tangent; a term has an object for each, or none.

Most terms are these objects themselves: a class derives from :class:`~fem_lie.forms.term.Term` and
from what it has, and returns itself where it has it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import ceil
from typing import NamedTuple

from fem_lie._arrays import Array, Indices


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


class Ends(NamedTuple):
    """Both ends of a step of nodes, and what is between them, each of shape (≥ nodes, 4, 3).

    Attributes:
        start: Nodal coordinates (x, d₁, d₂, d₃) at the start.
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
        lost: Dissipated part of the work.
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


class ViscousForces(ABC):
    """Forces that depend on twists.

    Attributes:
        in_space: Whether they oppose rigid motions, too.
    """

    in_space: bool = False

    @abstractmethod
    def add_viscous_forces(self, H: Array, v: Array, out: Array) -> None:
        """Add the forces at twists ``v`` (≥ nodes that move, 6)."""

    @abstractmethod
    def viscous_tangent(self, H: Array, v: Array) -> tuple[Array, Array | None]:
        """Their derivatives in the twists, and in those of frames if that is not left out.

        The second is at constant velocities of the nodes' groups, as
        :func:`~fem_lie.lie.node_types.at_rest` has them.
        """

    @property
    def rates(self) -> tuple[Indices, Indices, Array] | None:
        """Rows, columns and blocks (nnz, 4, 4) of ``D``, if they are ``Lᵀ D q̇`` with constant D.

        ``q`` are (x, d₁, d₂, d₃) of the nodes.
        """
        return None


class LinearisedStress(ABC):
    """Stress, or unknowns of the term's own, that is updated linearly from iterate to iterate."""

    @property
    @abstractmethod
    def carried(self) -> Array:
        """Present values, flat."""

    @abstractmethod
    def restore(self, carried: Array) -> None:
        """Have the values again that :attr:`carried` had when it was copied."""

    @abstractmethod
    def carry(self, H: Array, h: Array) -> None:
        """Update to the end of the increment ``h`` (n, 6), from frames ``H``."""

    @abstractmethod
    def reset_stress(self, H: Array) -> None:
        """Have the values of frames ``H``."""

    @abstractmethod
    def clear_stress(self) -> None:
        """Have none: a tangent without geometric stiffness."""


class LocalUnknowns(ABC):
    """Unknowns of cells on which forces depend."""

    @abstractmethod
    def condense(self, H: Array) -> None:
        """Solve for them at frames ``H``."""


class PathDependence(ABC):
    """Forces that depend on the states accepted before.

    Attributes:
        friction: Whether they depend on how nodes have moved since the last one, too.
    """

    friction: bool = False

    @abstractmethod
    def accept(self, H: Array) -> None:
        """Accept the state with frames ``H``."""


class PassageCheck(ABC):
    """Steps that are checked: surfaces may pass through each other, or touch too shortly."""

    @abstractmethod
    def check_passage(self, start: Array, end: Array) -> None:
        """Look whether surfaces went through each other.

        Args:
            start: Frames at the start of a step.
            end: At its end.

        Raises:
            PassedThroughError: They did.
        """

    @abstractmethod
    def watch(self, start: Array, end: Array, h: float, middle: Array | None) -> None:
        """Note a step of a scheme that does not conserve energy.

        Args:
            start: Frames at the start of the step.
            end: At its end.
            h: Its size.
            middle: Where forces act in the step; None: at both ends.
        """

    @property
    @abstractmethod
    def watched(self) -> Array:
        """What :meth:`watch` has noted, flat."""

    @abstractmethod
    def watch_again(self, watched: Array) -> None:
        """Have noted again what was :attr:`watched` once."""


class StepForces(ABC):
    """Forces over a step that do exactly the work by which the stored energy changes.

    Attributes:
        steady: Whether their size makes up for no round-off.
    """

    steady: bool = False

    @abstractmethod
    def add_over_step(self, ends: Ends, out: Array, ground: Array) -> Done:
        """Add the forces.

        Args:
            ends: Of the step.
            out: Forces and moments about the mean positions of nodes, global components,
                (nodes, 6).
            ground: Force and moment about the origin on ground, (6,).
        """

    @abstractmethod
    def tangent_over_step(self, ends: Ends, H: Array) -> Array:
        """Twice the derivative of these in the twists at the end, in frames ``H`` at the midpoint.

        Of the shape of the tangent; ``mean`` and ``delta`` of ``ends`` are those of all nodes.
        """

    @abstractmethod
    def overlaps(self, H: Array) -> bool:
        """Whether there are any such forces at frames ``H``."""


class LowRankTangent(ABC):
    """A tangent that a frozen matrix may do without, for a low-rank correction has it."""

    @abstractmethod
    def stiff_rows(self, H: Array) -> StiffRows:
        """What counts of the tangent, by few rows."""


class GroundForces(ABC):
    """Forces of which some have ground as their other side."""

    @abstractmethod
    def add_of_ground(self, H: Array, v: Array, out: Array) -> None:
        """Add those on nodes, at twists ``v``, whose other side is ground."""
