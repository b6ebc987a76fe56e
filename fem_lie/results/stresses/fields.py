"""Quantities of a body by name: the interface of section forces, stress resultants and stresses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable

from fem_lie._arrays import Array
from fem_lie._summary import Summarised


class Fields(Summarised, ABC):
    """Quantities that are computed from the state of a body, by name.

    Names of components are symbols: "N11", "My", "xy". Names of other scalars are the same for all
    bodies: "von Mises" (followed by "top" or "bottom" where it is that of an outer side),
    "pressure", and a symbol followed by "max" or "min" for extreme values.
    """

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Names of the quantities that this body has."""

    @abstractmethod
    def raw(self, name: str) -> Array:
        """A quantity where the element computes it: at integration points or ends of cells.

        Args:
            name: One of :attr:`names`.

        Raises:
            ValueError: There is no such quantity; likewise in the following methods.
        """

    @abstractmethod
    def mean(self, name: str) -> Array:
        """A quantity of the mean components of each cell.

        Args:
            name: One of :attr:`names`.
        """

    @abstractmethod
    def smooth(self, name: str) -> Array:
        """A quantity of components that are averaged over the cells that meet at a node.

        Args:
            name: One of :attr:`names`.
        """


def check_name(name: str, names: Iterable[str], body: str) -> None:
    """Raise ``ValueError`` with all names if a body has no such quantity."""
    known = tuple(names)
    if name not in known:
        raise ValueError(f"{body} has no quantity {name!r}; it has: {', '.join(known)}")
