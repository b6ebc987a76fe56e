"""Bodies along lines whose elements have sections, whatever nodes and elements are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fem_lie._arrays import Array, Indices, instance, number, text
from fem_lie.bodies.body import Body, Point
from fem_lie.sections.section import Section


class Sectioned(Body):
    """A body of elements with sections, which go by the names of groups of cells of its line.

    Attributes:
        elements: Nodes of each element, shape (m, k).
        lengths: Arc length of each element, unloaded, shape (m,).
        stiffness: Section stiffness of each element, shape (m, 6, 6).
        density: Gram matrix of inertia per length of each element, shape (m, 4, 4).
        has_mass: Whether all sections have inertia.
        sections: Of each element.
    """

    elements: Indices
    lengths: Array

    def _take(self, sections: Sequence[Section], groups: Mapping[str, Indices]) -> None:
        """Sections of all elements, and elements by the names of groups."""
        self.sections, self._groups = sections, dict(groups)
        # many elements have few sections: of one alone there is one matrix
        known = list({id(section): section for section in sections}.values())
        self.has_mass = all(section.inertia is not None for section in known)
        stiffness = np.array([section.stiffness for section in known])
        none = np.zeros((4, 4))
        density = np.array([none if s.inertia is None else s.inertia for s in known])
        if len(known) == 1:
            count = len(sections)
            self.stiffness = np.broadcast_to(stiffness[0], (count, 6, 6))
            self.density = np.broadcast_to(density[0], (count, 4, 4))
        else:
            number = {id(section): k for k, section in enumerate(known)}
            which = [number[id(section)] for section in sections]
            self.stiffness, self.density = stiffness[which], density[which]

    @property
    def start(self) -> Point:
        """The point named "start"."""
        return self["start"]

    @property
    def end(self) -> Point:
        """The point named "end"."""
        return self["end"]

    def cells_of(self, group: str | None = None) -> Indices:
        """Elements of a named group (default: all).

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        if group is None:
            return np.arange(len(self.elements))
        text(group, f"the name of a group of cells of {self.label}")
        if group not in self._groups:
            known = ", ".join(sorted(self._groups)) or "none"
            raise ValueError(f"{self.label} has no group of cells {group!r}; it has: {known}")
        return self._groups[group]

    def _check_place(self, element: int, part: float) -> None:
        """Raise ``ValueError`` if there is no such element, or the part is not one of it."""
        instance(element, int | np.integer, f"the number of an element of {self.label}", "whole")
        last = len(self.elements) - 1
        if not 0 <= element <= last:
            raise ValueError(f"{self.label} has elements 0 … {last}, got {element}")
        if not 0.0 <= number(part, f"the part of an element of {self.label}") <= 1.0:
            raise ValueError(f"a part of an element is 0 to 1, got {part}")
