"""Strain energy of an element in flat coordinates, in UFL."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import basix.ufl
import ufl
from dolfinx import fem
from ufl.core.expr import Expr
from ufl.variable import Variable

from fem_lie import _compat


class Forces(NamedTuple):
    """Kernel that computes the forces on the nodes of a cell.

    Attributes:
        kernel: Compiled function of UFCx's signature. Its coefficients are the nodal coordinates,
            space for the flat coordinates if a map computes them, then ``reads``.
        reads: Coefficients that the kernel reads, without the state.
        energy: One of these, a number, to which the kernel writes the energy of the cell; or
            ``None``.
    """

    kernel: Any
    reads: Sequence[fem.Function] = ()
    energy: fem.Function | None = None


@dataclass(frozen=True)
class StrainEnergy:
    """Strain energy ``∫ weight · law(ε) dx`` as strain measure and law.

    The separation allows an independent stress in the tangent, see
    :mod:`fem_lie.forms.local_forms`.

    Attributes:
        strain: Strain measure ``ε(y)``, shape ``(n,)``, in UFL.
        law: Energy density as a UFL function of the strain.
        dx: Cell measure with an explicit ``quadrature_degree`` in its metadata.
        weight: Factor of the density, independent of ``y``.
        viscosity: Viscosity ``η``, a matrix of shape ``(n, n)``, of Kelvin-Voigt damping ``σ(ε) + η
            ε̇``; or ``None``.
        through: Vector ``z(y)`` made by :func:`ufl.variable`, if ``strain`` depends on ``y`` only
            through it. Derivatives are then formed by the chain rule, ``ε'(z) z'(y)``, instead of
            being expanded in ``y``: for a complicated ``ε(z)`` with a simple ``z(y)`` the compiled
            tangent is smaller by an order of magnitude.
        forces: Kernel of the forces in closed form, if those derived from ``strain`` are more
            expensive.
    """

    strain: Expr
    law: Callable[[Expr], Expr]
    dx: ufl.Measure
    weight: Expr | float = 1.0
    viscosity: Expr | None = None
    through: Variable | None = None
    forces: Forces | None = None

    def change(self, y: fem.Function, dy: fem.Function | ufl.Argument) -> Expr:
        """Variation of the strain, ``ε'(y) dy``.

        Args:
            y: Flat coordinates of the cell.
            dy: Change of the flat coordinates.
        """
        z = self.through
        if z is None:
            return ufl.derivative(self.strain, y, dy)
        return ufl.dot(ufl.diff(self.strain, z), _derivative(z, y, dy))

    def rate(self, y: fem.Function, dy: fem.Function | ufl.Argument) -> Expr:
        """Strain rate for damping; it must vanish in rigid motions.

        Args:
            y: Flat coordinates of the cell.
            dy: Change of the flat coordinates.
        """
        return self.change(y, dy)

    def stiffness(
        self, stress: Expr, moduli: Expr, y: fem.Function, dy: ufl.Argument, by: ufl.Argument
    ) -> Expr:
        """``ε'(y) dy · C ε'(y) by + N · ε''(y)[dy, by]`` for moduli ``C`` and a stress ``N``.

        Args:
            stress: Stress, shape (n,).
            moduli: Tangent moduli, shape (n, n).
            y: Flat coordinates of the cell.
            dy: Change of the flat coordinates.
            by: Second change of the flat coordinates.
        """
        z = self.through
        if z is None:
            change = self.change(y, dy)
            geometric = ufl.derivative(ufl.inner(stress, change), y, by)
            return ufl.inner(change, moduli * self.change(y, by)) + geometric
        slope, force = ufl.diff(self.strain, z), ufl.diff(ufl.inner(stress, self.strain), z)
        matrix = ufl.transpose(slope) * moduli * slope + ufl.diff(force, z)
        dz, bz = _derivative(z, y, dy), _derivative(z, y, by)
        return ufl.inner(dz, matrix * bz) + ufl.inner(force, ufl.derivative(dz, y, by))

    def form(self) -> ufl.Form:
        """Strain energy as a UFL form."""
        return self.weight * self.law(self.strain) * self.dx

    def quadrature_element(self) -> basix.ufl._ElementBase:
        """Quadrature element of the stress.

        Raises:
            ValueError: The measure has no quadrature degree, or the strain is not a vector.
        """
        metadata = self.dx.metadata() or {}
        if metadata.get("quadrature_degree") is None:
            raise ValueError(
                "the measure of a StrainEnergy needs a quadrature degree: "
                'ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": 1})'
            )
        if len(self.strain.ufl_shape) != 1:
            raise ValueError(
                f"the strain must be a vector of shape (n,), got {self.strain.ufl_shape}: "
                "put its components into ufl.as_vector([...])"
            )
        return basix.ufl.quadrature_element(
            _compat.cell_name(ufl.domain.extract_unique_domain(self.strain)),
            value_shape=self.strain.ufl_shape,
            scheme=metadata.get("quadrature_rule", "default"),
            degree=metadata["quadrature_degree"],
        )


def _derivative(z: Variable, y: fem.Function, dy: fem.Function | ufl.Argument) -> Expr:
    """``z'(y) dy``."""
    (expression, _) = z.ufl_operands
    return ufl.derivative(expression, y, dy)
