"""A UFL energy of an element in flat coordinates."""

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
    """What makes the forces on the nodes of a cell.

    Attributes:
        kernel: Of UFCx's signature. Behind the rows of the nodes is room for the coordinates, where
            a map computes them, then what it reads.
        reads: What that is, without the state.
        energy: One of these, if it writes the energy of the cell there: a number.
    """

    kernel: Any
    reads: Sequence[fem.Function] = ()
    energy: fem.Function | None = None


@dataclass(frozen=True)
class StrainEnergy:
    """A stored energy ``∫ weight · law(ε) dx`` as strain and law, so that stress can be carried.

    Attributes:
        strain: The strain measure ``ε(y)``, shape ``(n,)``, in UFL.
        law: Energy density as a UFL function of the strain.
        dx: Cell measure with an explicit ``quadrature_degree`` in its metadata.
        weight: Factor of the density, without dependence on ``y``.
        viscosity: Stress per strain rate, a matrix of shape ``(n, n)``: Kelvin and Voigt's damping
            ``σ(ε) + η ε̇``; or ``None``.
        through: A vector ``z(y)`` made by :func:`ufl.variable`, if ``strain`` is written in it and
            depends on ``y`` by it alone. Derivatives then go by the chain rule, ``ε'(z) z'(y)``,
            instead of being written out in ``y``: the compiled tangent of an intricate ``ε(z)``
            with a simple ``z(y)`` shrinks by an order of magnitude.
        forces: In closed form, where those that are derived from ``strain`` cost more.
    """

    strain: Expr
    law: Callable[[Expr], Expr]
    dx: ufl.Measure
    weight: Expr | float = 1.0
    viscosity: Expr | None = None
    through: Variable | None = None
    forces: Forces | None = None

    def change(self, y: fem.Function, dy: fem.Function | ufl.Argument) -> Expr:
        """``ε'(y) dy``.

        Args:
            y: Flat coordinates of the cell.
            dy: Change of the flat coordinates.
        """
        z = self.through
        if z is None:
            return ufl.derivative(self.strain, y, dy)
        return ufl.dot(ufl.diff(self.strain, z), _derivative(z, y, dy))

    def rate(self, y: fem.Function, dy: fem.Function | ufl.Argument) -> Expr:
        """Of the strain, as it is damped: nil in rigid motions.

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
        """The energy as a UFL form."""
        return self.weight * self.law(self.strain) * self.dx

    def quadrature_element(self) -> basix.ufl._ElementBase:
        """Element of the stress: its values at the quadrature points.

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
