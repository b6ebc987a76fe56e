"""Reissner-Mindlin shells: the same strains as displacement, Hellinger-Reissner and Hu-Washizu.

Each formulation is a few lines of energy; differentiation, condensation of the element's own
parameters, local frames and the carried stress are those of :mod:`fem_lie.kernel`::

    frames = NodalFrames(mesh)                       # third director normal to the surface
    cells = ShellCells(frames)
    forms = hellinger_reissner(cells, compliance)    # five unknowns per node

Membrane and bending stress of the mixed four-node elements are those of Gruttmann & Wagner, CMAME
194 (2005) 4279; Hu-Washizu: Wagner & Gruttmann, IJNME 64 (2005) 635.
"""

from __future__ import annotations

from collections.abc import Callable

import ufl
from ufl.core.expr import Expr

from fem_lie.elements.shell_cells import ShellCells
from fem_lie.elements.shell_modes import STRAINS, strain
from fem_lie.kernel import LocalFrameForms, StrainEnergy

Law = Callable[[Expr], Expr]
"""Energy per area as a UFL function of the eight strains."""


def linear_law(stiffness: Expr) -> Law:
    """``½ ε·Dε`` with the section stiffness ``D``, shape (8, 8)."""
    return lambda e: 0.5 * ufl.inner(e, stiffness * e)


def displacement(cells: ShellCells, law: Law) -> LocalFrameForms:
    """``∫ W(ε)`` with the stress carried at the points of integration.

    With the default measures this is MITC4.

    Args:
        cells: Any cells without a bubble.
        law: Energy per area, any UFL function of the eight strains.

    Raises:
        ValueError: The cells have a bubble.
    """
    if cells.has_bubble:
        raise ValueError("cells with a bubble need a mixed element: use hellinger_reissner")
    if cells.drilling is None:
        return cells.forms(StrainEnergy(cells.strain, law, cells.dx))
    strains = ufl.as_vector([*cells.strain, cells.drilling])

    def with_drilling(e: Expr) -> Expr:
        shell = law(ufl.as_vector([e[i] for i in range(8)]))
        return shell + 0.5 * cells.drilling_stiffness * e[8] ** 2

    return cells.forms(StrainEnergy(strains, with_drilling, cells.dx))


def hellinger_reissner(cells: ShellCells, compliance: Expr) -> LocalFrameForms:
    """``∫ S·ε − ½ S·D⁻¹S`` with 14 stress parameters per cell, 15 on triangles.

    Args:
        cells: Four-node quadrilaterals or three-node triangles.
        compliance: ``D⁻¹``, shape (8, 8).
    """
    mixed = cells.mixed(cells.stresses.size)
    S = cells.stress(mixed.groups[0])
    density = ufl.inner(S, mixed.strain) - 0.5 * ufl.inner(S, compliance * S)
    return cells.forms((density + mixed.density) * cells.dx, mixed.local)


def hu_washizu(cells: ShellCells, law: Law) -> LocalFrameForms:
    """``∫ W(e) + S·(ε − e)`` with 24 strain parameters and those of the stress per cell.

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
