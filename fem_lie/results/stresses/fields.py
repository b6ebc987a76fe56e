"""Quantities of a body by name: the interface of section forces, stress resultants and stresses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._summary import Summarised

if TYPE_CHECKING:
    from fem_lie.bodies.body import Body, Point


class Fields(Summarised, ABC):
    """Quantities that are computed from the state of a body, by name.

    Names of components are symbols: "N11", "My", "xy". Names of other scalars are the same for all
    bodies: "von Mises" (followed by "top" or "bottom" where it is that of an outer side),
    "pressure", and a symbol followed by "max" or "min" for extreme values.
    """

    @property
    @abstractmethod
    def _body(self) -> Body:
        """The body."""

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

    def at(self, point: Point, name: str) -> Any:
        """A quantity at a node of the body, from :meth:`smooth`: a number, or an array over time.

        Args:
            point: A point of the body at a node, such as ``body.point((x, y, z))``.
            name: One of :attr:`names`.

        Raises:
            ValueError: There is no such quantity, the point is not a node of the body, or values
                differ from side to side there, as at a kink.
        """
        values = self.smooth(name)
        if point.body is not self._body:
            raise ValueError(f"{point.label} is not a point of {self._body.label}")
        if point.attachment is not None and not point.attachment.kind.rigid:
            raise ValueError(
                f"{point.label} is no node of {self._body.label}, and {name!r} is known at nodes: "
                f"expected a point such as {self._body.label}.point({point.node})"
            )
        masters = self._body.model.masters
        found = self._values_at(np.flatnonzero(masters == masters[point.node]))
        if len(found) != 1:
            raise ValueError(
                f"{name!r} has {len(found)} values at {point.label}, one for each side: take them "
                "from raw(), smooth() or mean()"
            )
        return values.reshape(*values.shape[: -self._axes], -1)[..., found[0]]

    _axes: ClassVar[int] = 1
    """Number of the last axes of :meth:`smooth` that belong to places on the body."""

    def _values_at(self, nodes: Indices) -> Indices:
        """Places in these axes, flattened, of the values at nodes that are one point."""
        return nodes


def check_name(name: str, names: Iterable[str], body: str) -> None:
    """Raise ``ValueError`` with all names if a body has no such quantity."""
    known = tuple(names)
    if name not in known:
        raise ValueError(f"{body} has no quantity {name!r}; it has: {', '.join(known)}")
