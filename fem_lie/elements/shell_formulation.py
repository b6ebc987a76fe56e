"""Which shell element a body has: strain measures and the energy made of them, as options."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import basix
import basix.ufl
import numpy as np
import ufl
from ufl.core.expr import Expr

from fem_lie._jit import Array
from fem_lie.elements.shell import (
    Law,
    displacement,
    hellinger_reissner,
    hu_washizu,
    linear_law,
)
from fem_lie.elements.shell_cells import ShellCells
from fem_lie.elements.shell_measures import MITC3_PLUS, MITC4, MITC6, MITC9, StrainMeasures
from fem_lie.kernel import LocalFrameForms

_MIXED = {("quadrilateral", 1): MITC4, ("triangle", 1): MITC3_PLUS}
_PLAIN = {("quadrilateral", 1): MITC4, ("triangle", 2): MITC6, ("quadrilateral", 2): MITC9}


@dataclass(frozen=True)
class ShellFormulation(ABC):
    """A shell element; use one of the subclasses.

    Attributes:
        measures: Strain measures; default: those that are usual for the cells of the mesh.
    """

    measures: StrainMeasures | None = None

    @property
    def quadratic(self) -> bool:
        """Whether the energy is a quadratic function of the strains."""
        return True

    @abstractmethod
    def defaults(self) -> dict[tuple[str, int], StrainMeasures]:
        """Strain measures for each kind of cell and degree."""

    @abstractmethod
    def forms(self, cells: ShellCells, stiffness: Array) -> LocalFrameForms:
        """Energy, forces and tangent.

        Args:
            cells: Geometry and strains.
            stiffness: Section stiffness of each cell, shape (m, 8, 8).
        """

    def stress(self, cells: ShellCells, forms: LocalFrameForms) -> Expr:
        """Stress resultants ``(N, M, Q)`` at the points of integration, shape (8,).

        They are those that the forms carry: reset them to the frames before.

        Args:
            cells: Those that :meth:`forms` was given.
            forms: What it made of them.
        """
        carried = forms.stress
        assert carried is not None
        return ufl.as_vector([carried[i] for i in range(8)])

    def measures_for(self, cell: str, degree: int) -> StrainMeasures:
        """The strain measures for these cells.

        Raises:
            ValueError: There are none, or those that were given are for other cells or have no
                stress fields where some are needed.
        """
        if self.measures is None:
            found = self.defaults().get((cell, degree))
            if found is None:
                known = ", ".join(f"{c}s of degree {d}" for c, d in self.defaults())
                raise ValueError(
                    f"{type(self).__name__} is for {known}; the mesh has {cell}s of degree {degree}"
                )
            return found
        if (self.measures.cell, self.measures.degree) != (basix.CellType[cell], degree):
            raise ValueError(
                f"these strain measures are for {self.measures.cell.name}s of degree "
                f"{self.measures.degree}, the mesh has {cell}s of degree {degree}"
            )
        if self.defaults() is _MIXED and self.measures.stresses is None:
            raise ValueError(
                f"there is no mixed element with the strain measures for {cell}s of degree "
                f"{degree}: use Displacement"
            )
        return self.measures


@dataclass(frozen=True)
class HellingerReissner(ShellFormulation):
    """Stress resultants with 14 parameters per quadrilateral, 15 per triangle: the default."""

    def defaults(self) -> dict[tuple[str, int], StrainMeasures]:
        """See the base class."""
        return _MIXED

    def forms(self, cells: ShellCells, stiffness: Array) -> LocalFrameForms:
        """See the base class."""
        return hellinger_reissner(
            cells, cells.cellwise(np.asarray(np.linalg.inv(stiffness), dtype=np.float64))
        )

    def stress(self, cells: ShellCells, forms: LocalFrameForms) -> Expr:
        """See the base class."""
        return cells.stress(_group(forms, 0))


@dataclass(frozen=True)
class _OfAnyLaw(ShellFormulation):
    """With an energy that the user may give.

    Attributes:
        law: Energy per area as a UFL function of the eight strains; default: that of the section.
    """

    law: Law | None = None

    @property
    def quadratic(self) -> bool:
        """See the base class; nothing is known of a user's law."""
        return self.law is None

    def law_for(self, cells: ShellCells, stiffness: Array) -> Law:
        """The user's, or that of the section."""
        return self.law or linear_law(cells.cellwise(stiffness))


@dataclass(frozen=True)
class HuWashizu(_OfAnyLaw):
    """Strains and stress resultants with parameters of their own, for any law."""

    def defaults(self) -> dict[tuple[str, int], StrainMeasures]:
        """See the base class."""
        return _MIXED

    def forms(self, cells: ShellCells, stiffness: Array) -> LocalFrameForms:
        """See the base class."""
        return hu_washizu(cells, self.law_for(cells, stiffness))

    def stress(self, cells: ShellCells, forms: LocalFrameForms) -> Expr:
        """See the base class."""
        return cells.stress(_group(forms, 1))


@dataclass(frozen=True)
class Displacement(_OfAnyLaw):
    """Strains from the nodes alone; with the default measures MITC4, MITC6 or MITC9."""

    def defaults(self) -> dict[tuple[str, int], StrainMeasures]:
        """See the base class."""
        return _PLAIN

    def forms(self, cells: ShellCells, stiffness: Array) -> LocalFrameForms:
        """See the base class."""
        return displacement(cells, self.law_for(cells, stiffness))


def _group(forms: LocalFrameForms, number: int) -> Expr:
    """A group of the cells' own unknowns."""
    assert forms.local is not None
    element = forms.local.function_space.ufl_element()
    several = isinstance(element, basix.ufl._MixedElement)
    return ufl.split(forms.local)[number] if several else forms.local
