"""Cells of bodies, as loads ask for them."""

from __future__ import annotations

from abc import ABC, abstractmethod

from fem_lie._arrays import Array, Indices


class Loadable(ABC):
    """What may have cells that loads act on. Those that have none refuse.

    Attributes:
        label: For messages.
    """

    @property
    @abstractmethod
    def label(self) -> str:
        """For messages."""

    def cells_of(self, group: str | None = None) -> Indices:
        """Elements of a named group (default: all).

        Raises:
            ValueError: The body has no elements, or no such group.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")

    def consistent_shares(self) -> tuple[Indices, Array]:
        """Nodes of each element, shape (m, k), and the length that each of them carries, (m, k).

        Raises:
            ValueError: The body has no elements.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")

    def consistent_levers(self) -> Array:
        """What a unit line force on each element does on the directors of its nodes, (m, k, 3).

        Raises:
            ValueError: The body has no elements.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")
