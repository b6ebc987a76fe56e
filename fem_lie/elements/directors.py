"""Beam in positions and directors, ``R³ × SO(3)``: strain measures in UFL.

``Γ = Rᵀ x′ − Γ₀``, ``κ = axial(Rᵀ R′) − κ₀`` with ``R = [d₁ d₂ d₃]`` interpolated as it is (Simo &
Vu-Quoc, CMAME 58 (1986) 79; Romero & Armero, IJNME 54 (2002) 1683). With one-point quadrature on
two nodes, or two-point on three, there is no shear locking. Both measures are invariant under
superposed rigid motion, as products of vectors that turn together.
"""

from __future__ import annotations

import ufl
from ufl.core.expr import Expr

from fem_lie.frames import NodalFrames


def arc_derivative(f: Expr, domain: ufl.Mesh) -> Expr:
    """``f′ = df/ds`` along the mesh line, for ``f`` of shape ``(3,)``."""
    J = ufl.Jacobian(domain)
    tangent = ufl.as_vector([J[i, 0] for i in range(3)])
    return ufl.dot(ufl.grad(f), tangent / ufl.sqrt(ufl.dot(tangent, tangent)))


def director_strains(q: NodalFrames) -> tuple[Expr, Expr]:
    """``(Rᵀ x′, axial(Rᵀ R′))``, each of shape ``(3,)``, components along the directors.

    Subtract the values of the unloaded configuration to get Γ and κ. (Simo & Vu-Quoc 1986, eq. 2.)

    Args:
        q: Frames on a line mesh.
    """
    domain = q.function.function_space.mesh
    x, d = q.position, q.directors
    dx, dd = arc_derivative(x, domain), [arc_derivative(a, domain) for a in d]

    def turn(a: int, b: int) -> Expr:
        return (ufl.dot(d[a], dd[b]) - ufl.dot(d[b], dd[a])) / 2

    stretch = ufl.as_vector([ufl.dot(a, dx) for a in d])
    return stretch, ufl.as_vector([turn(2, 1), turn(0, 2), turn(1, 0)])
