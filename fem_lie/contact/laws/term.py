"""What every term of contact forces has, whatever surfaces it is of."""

from __future__ import annotations

from abc import abstractmethod

from fem_lie._arrays import Array, Indices
from fem_lie.forms.term import Term


class ContactTerm(Term):
    """Forces of a contact by penalty.

    Attributes:
        ignores: Whether pairs that overlap at the start are ignored until they part.
    """

    ignores: bool = False

    @abstractmethod
    def accept(self, H: Array) -> None:
        """Accept the state with frames ``H``."""

    @abstractmethod
    def touching(self, H: Array, v: Array) -> tuple[Indices, Array, Array, Array]:
        """Pairs of points that touch, and how.

        Args:
            H: Frames of all nodes, shape (n, 4, 3).
            v: Their twists, shape (n, 6).

        Returns:
            Pairs of points (k, 2), gaps (k,), closest points of the first surface (k, 3), and
            forces on it (k, 3), global components.
        """
