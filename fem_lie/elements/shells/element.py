"""Shell elements as options of a body: strain measures and the energy."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import basix.ufl
import numpy as np
import ufl
from ufl.core.expr import Expr

from fem_lie._arrays import Array
from fem_lie.elements.shells.cells import ShellCells
from fem_lie.elements.shells.measures import MITC3_PLUS, MITC4, MITC6, MITC9, StrainMeasures
from fem_lie.elements.shells.stress_modes import STRAINS, strain
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.local_forms import LocalFrameForms

_MIXED = {("quadrilateral", 1): MITC4, ("triangle", 1): MITC3_PLUS}
_PLAIN = {("quadrilateral", 1): MITC4, ("triangle", 2): MITC6, ("quadrilateral", 2): MITC9}


@dataclass(frozen=True)
class ShellFormulation(ABC):
    """Shell element; use one of the subclasses.

    Attributes:
        measures: Strain measures; default: the usual ones for the cells of the mesh.
        whole_frames: Whether cells have six unknowns per node; otherwise five, and the drilling
            rotation is a term of its own.
        takes_eigenstrain: Whether the energy is a function of the strains of
            :class:`~fem_lie.elements.shells.cells.ShellCells`, from which stress-free strains are
            subtracted.
    """

    measures: StrainMeasures | None = None
    whole_frames: ClassVar[bool] = False
    takes_eigenstrain: ClassVar[bool] = False

    def require_eigenstrain(self, what: str) -> None:
        """Raise ``ValueError`` if the element does not take stress-free strains.

        Args:
            what: What the user asked for, for the message.
        """
        if not self.takes_eigenstrain:
            raise ValueError(
                f"{what} is not available for {type(self).__name__}: use HellingerReissner(), "
                "HuWashizu() or DisplacementBased()"
            )

    @property
    def quadratic(self) -> bool:
        """Whether the energy is a quadratic function of the strains."""
        return True

    @abstractmethod
    def defaults(self) -> dict[tuple[str, int], StrainMeasures]:
        """Default strain measures for each cell type and degree."""

    @abstractmethod
    def forms(self, cells: ShellCells, stiffness: Array) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent.

        Args:
            cells: Geometry and strains.
            stiffness: Section stiffness of each cell, shape (m, 8, 8).
        """

    def stress(self, cells: ShellCells, forms: LocalFrameForms, stiffness: Array) -> Expr:
        """Stress resultants ``(N, M, Q)`` at the quadrature points, shape (8,).

        They are the independent stress of the forms: reset it to the frames before.

        Args:
            cells: The argument of :meth:`forms`.
            forms: Forms returned by :meth:`forms`.
            stiffness: The argument of :meth:`forms`.
        """
        stress = forms.stress
        assert stress is not None
        return ufl.as_vector([stress[i] for i in range(8)])

    def measures_for(self, cell: str, degree: int) -> StrainMeasures:
        """Strain measures for these cells.

        Args:
            cell: Name of the cell, such as "quadrilateral".
            degree: Degree of the cell.

        Raises:
            ValueError: There are none, or the user's measures are for other cells or have no stress
                fields where they are needed.
        """
        if self.measures is None:
            found = self.defaults().get((cell, degree))
            if found is None:
                known = ", ".join(f"{c}s of degree {d}" for c, d in self.defaults())
                given = f"{cell}s of degree {degree}"
                raise ValueError(
                    f"{type(self).__name__} is for {known}; the mesh has {given}, for which there "
                    f"is {_elements_for(cell, degree)}: give it as formulation="
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
    """Mixed element with independent stress: the default.

    Stress resultants have 14 parameters per quadrilateral, 15 per triangle.
    """

    takes_eigenstrain: ClassVar[bool] = True

    def defaults(self) -> dict[tuple[str, int], StrainMeasures]:
        """Assumed strains for an independent stress field."""
        return _MIXED

    def forms(self, cells: ShellCells, stiffness: Array) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent with independent stress, inverse law."""
        return hellinger_reissner(
            cells, cells.cellwise(np.asarray(np.linalg.inv(stiffness), dtype=np.float64))
        )

    def stress(self, cells: ShellCells, forms: LocalFrameForms, stiffness: Array) -> Expr:
        """Independent stress field."""
        return cells.stress(_group(forms, 0))


@dataclass(frozen=True)
class _OfAnyLaw(ShellFormulation):
    """Shell element with an optional user energy.

    Attributes:
        law: Energy per area as a UFL function of the eight strains; default: that of the section.
    """

    takes_eigenstrain: ClassVar[bool] = True
    law: Law | None = None

    @property
    def quadratic(self) -> bool:
        """Whether the law is that of the section; a user's law need not be quadratic."""
        return self.law is None

    def law_for(self, cells: ShellCells, stiffness: Array) -> Law:
        """Law of the user, or that of the section.

        Args:
            cells: Geometry and strains.
            stiffness: Section stiffness of each cell, shape (m, 8, 8).
        """
        return self.law or linear_law(cells.cellwise(stiffness))


@dataclass(frozen=True)
class HuWashizu(_OfAnyLaw):
    """Mixed element with independent strains and stress resultants, for any law."""

    def defaults(self) -> dict[tuple[str, int], StrainMeasures]:
        """Assumed strains for an independent stress field."""
        return _MIXED

    def forms(self, cells: ShellCells, stiffness: Array) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent with independent strain and stress."""
        return hu_washizu(cells, self.law_for(cells, stiffness))

    def stress(self, cells: ShellCells, forms: LocalFrameForms, stiffness: Array) -> Expr:
        """Independent stress field."""
        return cells.stress(_group(forms, 1))


@dataclass(frozen=True)
class DisplacementBased(_OfAnyLaw):
    """Element with strains from the nodes only; by default MITC4, MITC6 or MITC9."""

    def defaults(self) -> dict[tuple[str, int], StrainMeasures]:
        """Assumed strains that do not lock without independent stress."""
        return _PLAIN

    def forms(self, cells: ShellCells, stiffness: Array) -> LocalFrameForms:
        """DOLFINx forms of energy, forces and tangent with the law at strains from the nodes."""
        return displacement(cells, self.law_for(cells, stiffness))


def _elements_for(cell: str, degree: int) -> str:
    """Elements that have strain measures for these cells, for messages."""
    elements = HellingerReissner(), HuWashizu(), DisplacementBased()
    found = [f"{type(e).__name__}()" for e in elements if (cell, degree) in e.defaults()]
    return " or ".join(found) or "none"


def _group(forms: LocalFrameForms, number: int) -> Expr:
    """Group of the cells' local unknowns."""
    assert forms.local is not None
    element = forms.local.function_space.ufl_element()
    several = isinstance(element, basix.ufl._MixedElement)
    return ufl.split(forms.local)[number] if several else forms.local


Law = Callable[[Expr], Expr]
"""Energy per area as a UFL function of the eight strains."""


def linear_law(stiffness: Expr) -> Law:
    """Energy ``½ ε·Dε`` with the section stiffness ``D``, shape (8, 8)."""
    return lambda e: 0.5 * ufl.inner(e, stiffness * e)


def displacement(cells: ShellCells, law: Law) -> LocalFrameForms:
    """Forms of ``∫ W(ε)`` with an independent stress at the quadrature points.

    With the default measures this is MITC4.

    Args:
        cells: Any cells without a bubble.
        law: Energy per area, any UFL function of the eight strains.

    Raises:
        ValueError: The cells have a bubble.
    """
    if cells.has_bubble:
        raise ValueError(
            "cells with a bubble need a mixed element: use fl.elements.HellingerReissner()"
        )
    if cells.drilling is None:
        return cells.forms(StrainEnergy(cells.strain, law, cells.dx))
    strains = ufl.as_vector([*cells.strain, cells.drilling])

    def with_drilling(e: Expr) -> Expr:
        shell = law(ufl.as_vector([e[i] for i in range(8)]))
        return shell + 0.5 * cells.drilling_stiffness * e[8] ** 2

    return cells.forms(StrainEnergy(strains, with_drilling, cells.dx))


def hellinger_reissner(cells: ShellCells, compliance: Expr) -> LocalFrameForms:
    """Forms of ``∫ S·ε − ½ S·D⁻¹S`` with 14 stress parameters per cell, 15 on triangles.

    Args:
        cells: Four-node quadrilaterals or three-node triangles.
        compliance: ``D⁻¹``, shape (8, 8).
    """
    mixed = cells.mixed(cells.stresses.size)
    S = cells.stress(mixed.groups[0])
    density = ufl.inner(S, mixed.strain) - 0.5 * ufl.inner(S, compliance * S)
    return cells.forms((density + mixed.density) * cells.dx, mixed.local)


def hu_washizu(cells: ShellCells, law: Law) -> LocalFrameForms:
    """Forms of ``∫ W(e) + S·(ε − e)`` with 24 strain parameters and those of the stress.

    With a quadratic law it is :func:`hellinger_reissner`.

    Args:
        cells: Four-node quadrilaterals or three-node triangles.
        law: Energy per area, any UFL function of the eight strains.
    """
    mixed = cells.mixed(STRAINS, cells.stresses.size)
    a, s = mixed.groups
    S, e = cells.stress(s), strain(list(a), cells.point, cells.centroid)
    density = law(e) + ufl.inner(S, mixed.strain - e)
    return cells.forms((density + mixed.density) * cells.dx, mixed.local)
