"""Beam sections: stiffness and inertia per length, from a shape and a material.

The section lies in the plane of e₂ and e₃, with coordinates y along e₂ and z along e₃; e₁ is the
beam's axis. Stiffness acts on strains ``(Γ₁, Γ₂, Γ₃, κ₁, κ₂, κ₃)``: axial strain, two shears,
twist, two curvatures. Inertia is the mass matrix of ``q = (x, d₁, d₂, d₃)`` per length: a point of
the section is ``x + y d₂ + z d₃``, so its kinetic energy is ``½ Σ G_ab q̇_a·q̇_b`` with
``G = ∫ρ (1, 0, y, z) ⊗ (1, 0, y, z) dA`` (:mod:`fem_lie.lie.node_types.inertia`).

The section's matrices refer to its reference point, where the beam's axis runs, and to its axes:
:meth:`Section.offset` and :meth:`Section.rotated` change them by exact congruences. Sections of any
shape come from :class:`fem_lie.sections.shape.SectionShape`.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, number, numbers, positive
from fem_lie._summary import Summarised
from fem_lie.sections.properties import SectionProperties, rectangle, ring, rotation

if TYPE_CHECKING:
    from fem_lie.sections.material import Material

_SYMMETRY = 1e-8  # tables of stiffness are given with at least as many digits


def _symmetric(value: Array, size: int, what: str) -> Array:
    matrix = numbers(value, what)
    if matrix.shape != (size, size) or not np.isfinite(matrix).all():
        raise ValueError(
            f"{what} must be a finite matrix of shape ({size}, {size}), got\n{value!r}"
        )
    scale = np.sqrt(np.abs(np.diag(matrix)))
    if (np.abs(matrix - matrix.T) > _SYMMETRY * np.outer(scale, scale)).any():
        raise ValueError(f"{what} must be symmetric, got\n{matrix}")
    return 0.5 * (matrix + matrix.T)


def _scaled_eigenvalues(matrix: Array) -> Array:
    """Eigenvalues after scaling the diagonal to one, since entries have different units."""
    scale = np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), 1.0))
    return np.asarray(np.linalg.eigvalsh(matrix / np.outer(scale, scale)), dtype=np.float64)


def definite(value: Array, size: int, what: str) -> Array:
    """Symmetric positive definite matrix, shape (size, size), read-only.

    Raises:
        ValueError: It has another shape, is not finite, not symmetric or not positive definite.
        TypeError: It is not an array of numbers.
    """
    matrix = _symmetric(value, size, what)
    if not (np.diag(matrix) > 0).all() or not _scaled_eigenvalues(matrix)[0] > 1e-14:
        raise ValueError(f"{what} must be positive definite, got\n{matrix}")
    matrix.setflags(write=False)
    return matrix


def semidefinite(value: Array, size: int, what: str) -> Array:
    """Symmetric positive semidefinite mass matrix; raises as :func:`definite`."""
    matrix = _symmetric(value, size, what)
    if (np.diag(matrix) < 0).any() or not _scaled_eigenvalues(matrix)[0] > -1e-12:
        raise ValueError(f"{what} must be positive semidefinite, got\n{matrix}")
    matrix.setflags(write=False)
    return matrix


def section_mass_matrix(
    mass_matrix: npt.ArrayLike | None,
    mass: float | None,
    polar: float | None,
    rotary: npt.ArrayLike | None,
) -> Array | None:
    """Mass matrix of (x, d₁, d₂, d₃) per length, or ``None`` without arguments.

    Args:
        mass_matrix: The matrix itself, shape (4, 4).
        mass: Mass per length.
        polar: Moment of inertia per length about e₁, half of it about e₂ and e₃ each.
        rotary: Moments of inertia per length about e₂ and e₃, shape (2,).

    Raises:
        ValueError: More than one of them is given, moments are given without a mass, or a shape is
            wrong.
    """
    if mass_matrix is not None:
        matrix = numbers(mass_matrix, "mass_matrix")
        if mass is not None or polar is not None or rotary is not None:
            raise ValueError("give mass_matrix=, or mass= with polar= or rotary=, not both")
        if matrix.shape != (4, 4):
            raise ValueError(
                f"the mass matrix of (x, d₁, d₂, d₃) must have shape (4, 4), got {matrix.shape}; a "
                "section of which the mass and moments of inertia per length are known has mass=…, "
                "polar=J₁ or mass=…, rotary=(J₂, J₃)"
            )
        return matrix
    if mass is None:
        if polar is not None or rotary is not None:
            raise ValueError("polar= and rotary= need mass=, the mass per length")
        return None
    if polar is not None and rotary is not None:
        raise ValueError("give polar= or rotary=; the polar moment is the sum of the other two")
    about = (0.0 if polar is None else number(polar, "polar") / 2) * np.ones(2)
    if rotary is not None:
        about = numbers(rotary, "rotary")
        if about.shape != (2,):
            raise ValueError(
                f"rotary must be the moments of inertia about e₂ and e₃, 2 numbers, got {rotary!r}"
            )
    # rotation about e₂ moves points along e₃
    return np.diag([number(mass, "mass"), 0.0, about[1], about[0]])


_CIRCLE_POINTS = 32


@dataclass(frozen=True, eq=False, repr=False)
class Section(Summarised):
    """Stiffness and inertia of a beam per length, in the local frame of its points.

    Attributes:
        stiffness: Symmetric positive definite, shape (6, 6), on (Γ₁, Γ₂, Γ₃, κ₁, κ₂, κ₃).
        inertia: Mass matrix of (x, d₁, d₂, d₃) per length, shape (4, 4), or ``None`` for statics
            only.
        outline: Corners (y, z) of the outer boundary, shape (k, 2), for drawing; or ``None``.
        properties: Area, moments and so on, if they are known: ``print(section.properties)``.

    Raises:
        ValueError: A matrix has the wrong shape, is not symmetric or not positive.
    """

    stiffness: Array
    inertia: Array | None = None
    outline: Array | None = None
    properties: SectionProperties | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "stiffness", definite(self.stiffness, 6, "stiffness"))
        if self.inertia is not None:
            object.__setattr__(self, "inertia", _inertia(self.inertia))
        if self.outline is not None:
            object.__setattr__(self, "outline", _outline(self.outline))

    @classmethod
    def rectangle(
        cls,
        width: float,
        height: float,
        material: Material,
        *,
        shear_factor: float | None = None,
        torsion_constant: float | None = None,
    ) -> Section:
        """Solid rectangle.

        Args:
            width: Side along e₂.
            height: Side along e₃.
            material: Isotropic material.
            shear_factor: Effective over true shear area; default: Cowper's 10 (1 + ν) / (12 + 11
                ν), which is 5/6 for ν = 0.
            torsion_constant: Length⁴; default: Saint-Venant's solution, 0.140577 b⁴ for a square.

        Raises:
            ValueError: A size or factor is not positive.
        """
        properties = rectangle(width, height, material, shear_factor, torsion_constant)
        y, z = 0.5 * width, 0.5 * height
        corners = np.array([[-y, -z], [y, -z], [y, z], [-y, z]])
        return _from_closed_form(properties, material.density, corners)

    @classmethod
    def circle(
        cls, radius: float, material: Material, *, shear_factor: float | None = None
    ) -> Section:
        """Solid circle; default shear factor: Cowper's 6 (1 + ν) / (7 + 6 ν).

        Args:
            radius: Radius.
            material: The material.
            shear_factor: Shear correction factor; default: that of Cowper.

        Raises:
            ValueError: The radius or factor is not positive.
        """
        positive(radius, "radius")
        properties = ring(0.0, radius, material, shear_factor)
        return _from_closed_form(properties, material.density, _circle(radius))

    @classmethod
    def tube(
        cls,
        inner_radius: float,
        outer_radius: float,
        material: Material,
        *,
        shear_factor: float | None = None,
    ) -> Section:
        """Circular tube; default shear factor: Cowper's for a hollow circle of any thickness.

        With m the ratio of the radii it is
        ``6 (1 + ν)(1 + m²)² / ((7 + 6ν)(1 + m²)² + (20 + 12ν) m²)``.

        Args:
            inner_radius: Inner radius.
            outer_radius: Outer radius.
            material: The material.
            shear_factor: Shear correction factor; default: that of Cowper.

        Raises:
            ValueError: Not 0 < inner_radius < outer_radius, or the factor is not positive.
        """
        positive(inner_radius, "inner_radius")
        positive(outer_radius, "outer_radius")
        if inner_radius >= outer_radius:
            raise ValueError(
                f"inner_radius must be less than outer_radius, got {inner_radius!r} and "
                f"{outer_radius!r}"
            )
        properties = ring(inner_radius, outer_radius, material, shear_factor)
        return _from_closed_form(properties, material.density, _circle(outer_radius))

    @classmethod
    def from_stiffness(
        cls,
        stiffness: npt.ArrayLike,
        mass_matrix: npt.ArrayLike | None = None,
        *,
        mass: float | None = None,
        polar: float | None = None,
        rotary: npt.ArrayLike | None = None,
        outline: npt.ArrayLike | None = None,
    ) -> Section:
        """Section with known stiffness and inertia; without inertia it is for statics only.

        Args:
            stiffness: Symmetric positive definite, shape (6, 6), or its diagonal, shape (6,).
            mass_matrix: Mass matrix of (x, d₁, d₂, d₃) per length, shape (4, 4): positive
                semidefinite with a positive mass. For mass m per length and inertia J about the
                centroid ``centre`` it is ``fl.sections.director_mass_matrix(m, J, centre)``.
            mass: Or mass per length, on the axis.
            polar: With ``mass``, moment of inertia per length about e₁, half of it about e₂ and e₃
                each; default: no rotary inertia.
            rotary: Or moments of inertia per length about e₂ and e₃, shape (2,); about e₁ it is
                their sum.
            outline: Corners (y, z) of the outer boundary, shape (k, 2), for drawing.

        Raises:
            ValueError: A matrix has the wrong shape, is not symmetric or not positive; inertia is
                given in two ways, or without mass.
        """
        D = numbers(stiffness, "stiffness")
        return cls(
            np.diag(D) if D.ndim == 1 else D,
            section_mass_matrix(mass_matrix, mass, polar, rotary),
            None if outline is None else numbers(outline, "outline"),
        )

    def offset(self, y: float, z: float) -> Section:
        """Section with its reference point, where the beam's axis runs, at (y, z).

        With ``r = (0, y, z)`` the strains there are ``Γ + κ × r`` and κ, and stiffness and inertia
        follow by congruence; ``section.offset(y, z).offset(-y, -z)`` is the original section.

        Args:
            y: Coordinate along e₂ of the new reference point.
            z: Coordinate along e₃ of the new reference point.

        Raises:
            ValueError: A coordinate is not finite.
        """
        r = np.array([number(y, "y"), number(z, "z")])
        # strains at the old point from those at the new one
        T = np.eye(6)
        T[:3, 3:] = [[0.0, -z, y], [z, 0.0, 0.0], [-y, 0.0, 0.0]]
        S = np.eye(4)
        S[2:, 0] = -r
        return Section(
            T.T @ self.stiffness @ T,
            None if self.inertia is None else S @ self.inertia @ S.T,
            None if self.outline is None else self.outline - r,
            None if self.properties is None else self.properties.offset(y, z),
        )

    def rotated(self, angle: float) -> Section:
        """Section rotated about its reference point by ``angle``, from e₂ to e₃.

        Args:
            angle: Angle, rad.

        Raises:
            ValueError: The angle is not finite.
        """
        R = np.eye(3)
        R[1:, 1:] = rotation(number(angle, "angle"))
        T, S = np.eye(6), np.eye(4)
        T[:3, :3] = T[3:, 3:] = S[1:, 1:] = R
        return Section(
            T @ self.stiffness @ T.T,
            None if self.inertia is None else S @ self.inertia @ S.T,
            None if self.outline is None else self.outline @ R[1:, 1:].T,
            None if self.properties is None else self.properties.rotated(angle),
        )

    def axial_stress(self, points: npt.ArrayLike | None = None) -> Array:
        """Axial stress at points of a homogeneous section by unit N, M_y and M_z, shape (k, 3).

        ``σ = N/A + (y, z)·I⁻¹ (−M_z, M_y)``, with ``I = ∫r⊗r dA`` and all of it about the centroid;
        moments are about the reference point. In a composite it is the axial strain times the mean
        of Young's modulus.

        Args:
            points: (y, z) from the reference point, shape (k, 2); default: corners of the outline.

        Raises:
            ValueError: The section has no properties, or ``points`` is missing and there is no
                outline.
        """
        p = self.properties
        if p is None:
            raise ValueError("axial stress needs a section that knows its properties")
        if points is None and self.outline is None:
            raise ValueError("the section has no outline: give points (y, z)")
        given = np.asarray(self.outline if points is None else points, dtype=np.float64)
        bending = (given.reshape(-1, 2) - p.centroid) @ np.linalg.inv(p.second_moments)
        y, z = p.centroid
        extension = 1.0 / p.area - bending @ [y, z]
        return np.column_stack([extension, bending[:, 1], -bending[:, 0]])


def _from_closed_form(properties: SectionProperties, density: float, outline: Array) -> Section:
    """Section of one material, with its centroid on the axis."""
    (yy, _), (_, zz) = properties.second_moments
    inertia = np.diag([density * properties.area, 0.0, density * yy, density * zz])
    return Section(properties.stiffness, inertia if density else None, outline, properties)


def _circle(radius: float) -> Array:
    """Corners of the outline of a circle."""
    angle = 2.0 * pi * np.arange(_CIRCLE_POINTS) / _CIRCLE_POINTS
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def _inertia(value: Array) -> Array:
    matrix = semidefinite(value, 4, "inertia")
    if not matrix[0, 0] > 0:
        raise ValueError(f"inertia must have a positive mass per length, got {matrix[0, 0]!r}")
    return matrix


def _outline(value: Array) -> Array:
    points = numbers(value, "outline")
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 3 or not np.isfinite(points).all():
        raise ValueError(f"outline must be at least 3 finite points (y, z), got\n{value!r}")
    points.setflags(write=False)
    return points
