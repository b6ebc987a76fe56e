"""Shell sections: stiffness and inertia per area, from plies of isotropic or orthotropic material.

Stiffness acts on the strains of :mod:`fem_lie.elements.shells.strains`, ``(E₁₁, E₂₂, 2E₁₂, K₁₁,
K₂₂, 2K₁₂, γ₁, γ₂)``, of the reference surface; at the height ``z`` along the director the strain is
``E + z K``, in plane stress. Inertia is the mass matrix of ``(x, t)`` per area: a point is
``x + z t``, so its kinetic energy is ``½ Σ G_ab q̇_a·q̇_b`` with ``G = ∫ρ (1, z) ⊗ (1, z) dz``.

Lamination theory: R. M. Jones, *Mechanics of Composite Materials* (1999), ch. 2 and 4. Transverse
shear: stresses in equilibrium with bending along either axis, and their complementary energy (K.
Rohwer, *Improved transverse shear stiffnesses for layered finite elements*, DFVLR-FB 88-32, 1988).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, radians, sin

import numpy as np

from fem_lie._arrays import Array, instance, number, positive, positive_or_zero
from fem_lie._summary import Summarised
from fem_lie.sections.material import Material
from fem_lie.sections.section import definite, semidefinite

SHEAR_FACTOR = 5.0 / 6.0


@dataclass(frozen=True)
class Orthotropic:
    """Orthotropic ply material with fibres along its axis 1.

    Attributes:
        E1: Young's modulus along the fibres, force per area.
        E2: Young's modulus across them.
        nu12: Transverse contraction under axial strain along the fibres; nu12² < E1/E2.
        G12: Shear modulus in the plane.
        G13: Transverse shear modulus along the fibres.
        G23: Transverse shear modulus across them.
        density: Mass per volume; 0 for statics without gravity.

    Raises:
        ValueError: A modulus is not positive, the density negative, or nu12 is too large.
    """

    E1: float
    E2: float
    nu12: float
    G12: float
    G13: float
    G23: float
    density: float

    def __post_init__(self) -> None:
        for name in ("E1", "E2", "G12", "G13", "G23"):
            positive(getattr(self, name), name)
        positive_or_zero(self.density, "density")
        if not number(self.nu12, "nu12") ** 2 < self.E1 / self.E2:
            raise ValueError(
                f"nu12 must satisfy nu12² < E1/E2 = {self.E1 / self.E2:g}, got {self.nu12!r}"
            )


@dataclass(frozen=True)
class Ply:
    """Layer of a laminate.

    Attributes:
        thickness: Thickness, length.
        material: Isotropic or orthotropic material.
        angle: Angle from e₁ of the section to the fibres, about the director, in degrees.

    Raises:
        ValueError: The thickness is not positive, or the angle is a multiple of π/12, as only
            angles in rad are.
    """

    thickness: float
    material: Material | Orthotropic
    angle: float = 0.0

    def __post_init__(self) -> None:
        positive(self.thickness, "thickness of a ply")
        turns = number(self.angle, "angle of a ply") / (pi / 12.0)
        if turns != 0.0 and abs(turns - round(turns)) < 1e-9 * abs(turns):
            raise ValueError(
                f"angle of a ply: expected degrees, got {self.angle!r}, which are "
                f"{15 * round(turns)}° in rad"
            )
        expected = "a Material or Orthotropic"
        instance(self.material, Material | Orthotropic, "material of a ply", expected)

    def stiffness(self) -> tuple[Array, Array]:
        """Plane-stress moduli on ``(E₁₁, E₂₂, 2E₁₂)``, shear moduli on ``(γ₁, γ₂)``.

        Both are along the section axes.
        """
        m = _orthotropic(self.material)
        nu21 = m.nu12 * m.E2 / m.E1
        factor = 1.0 / (1.0 - m.nu12 * nu21)
        Q = np.array(
            [
                [m.E1 * factor, nu21 * m.E1 * factor, 0.0],
                [nu21 * m.E1 * factor, m.E2 * factor, 0.0],
                [0.0, 0.0, m.G12],
            ]
        )
        c, s = cos(radians(self.angle)), sin(radians(self.angle))
        # strains along the fibres from those of the section
        T = np.array(
            [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]]
        )
        R = np.array([[c, s], [-s, c]])
        return T.T @ Q @ T, R.T @ np.diag([m.G13, m.G23]) @ R


@dataclass(frozen=True, eq=False, repr=False)
class ShellSection(Summarised):
    """Stiffness and inertia of a shell per area.

    Attributes:
        stiffness: Symmetric positive definite, shape (8, 8).
        inertia: Mass matrix of (x, t) per area, shape (2, 2).
        thickness: Total thickness of the plies, length.
    """

    stiffness: Array
    inertia: Array
    thickness: float

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` for an invalid matrix or thickness."""
        object.__setattr__(self, "stiffness", definite(self.stiffness, 8, "stiffness"))
        object.__setattr__(self, "inertia", semidefinite(self.inertia, 2, "inertia"))
        positive(self.thickness, "thickness")

    @classmethod
    def layer(
        cls, thickness: float, material: Material, *, shear_factor: float = SHEAR_FACTOR
    ) -> ShellSection:
        """Homogeneous isotropic shell section.

        Args:
            thickness: Thickness, length.
            material: Isotropic material.
            shear_factor: Effective over true transverse shear stiffness.

        Raises:
            ValueError: A number is not positive, or Poisson's ratio is 1/2.
        """
        return cls.laminate([Ply(thickness, material)], shear_factor=shear_factor)

    @classmethod
    def laminate(
        cls,
        plies: Sequence[Ply],
        *,
        reference: float = 0.5,
        shear_factor: float | None = None,
    ) -> ShellSection:
        """Laminate of plies from bottom to top, along the director.

        Args:
            plies: Plies, at least one.
            reference: Height of the reference surface over the thickness: 0 bottom, 1 top.
            shear_factor: Effective transverse shear stiffness over the sum of that of the plies.
                Default: the stiffness with the energy of the shear stresses that are in equilibrium
                with bending: 5/6 of the sum if plies are equal, and ``G d²/c`` of a sandwich with a
                soft core of thickness c and a distance d between the middles of its faces.

        Raises:
            ValueError: There is no ply, or a number is out of range.
        """
        if not plies:
            raise ValueError("a laminate needs at least one ply")
        for ply in plies:
            instance(ply, Ply, "a layer of a laminate", "a Ply")
        if not 0.0 <= number(reference, "reference") <= 1.0:
            raise ValueError(f"reference must lie between 0 and 1, got {reference!r}")
        if shear_factor is not None:
            positive(shear_factor, "shear_factor")
        heights = np.cumsum([0.0, *(ply.thickness for ply in plies)])
        thickness = float(heights[-1])
        heights = heights - reference * thickness
        D, G = np.zeros((8, 8)), np.zeros((2, 2))
        for ply, low, high in zip(plies, heights[:-1], heights[1:], strict=True):
            # ∫ z^n dz
            moments = [(high ** (n + 1) - low ** (n + 1)) / (n + 1) for n in range(3)]
            plane, shear = ply.stiffness()
            powers = np.array([[moments[0], moments[1]], [moments[1], moments[2]]])
            D[:6, :6] += np.kron(powers, plane)
            D[6:, 6:] += moments[0] * shear
            G += ply.material.density * powers
        if shear_factor is None:
            D[6:, 6:] = _shear_stiffness(plies, heights, D[:6, :6])
        else:
            D[6:, 6:] *= shear_factor
        return cls(D, G, thickness)


def _shear_stiffness(plies: Sequence[Ply], heights: Array, D: Array) -> Array:
    """Transverse shear stiffness by the complementary energy of shear in equilibrium with bending.

    Args:
        plies: Plies.
        heights: Their boundaries, one more than plies.
        D: Stiffness on membrane and bending strains, shape (6, 6).

    Returns:
        The stiffness, shape (2, 2).
    """
    # strains of M₁₁,₁ = 1 and of M₂₂,₂ = 1; σ₁₁,₁ and σ₁₂,₁ of the former, σ₁₂,₂ and σ₂₂,₂ of the
    # latter are balanced by τ₁₃,₃ and τ₂₃,₃
    ε, κ = np.split(np.linalg.inv(D)[:, 3:5], 2)
    balanced = np.array([[0, 2], [2, 1]])
    points, weights = np.polynomial.legendre.leggauss(3)
    # (τ₁₃, τ₂₃) of both, in columns
    τ: Array = np.zeros((2, 2))
    flexibility = np.zeros((2, 2))
    for ply, low, high in zip(plies, heights[:-1], heights[1:], strict=True):
        plane, shear = ply.stiffness()
        S = np.linalg.inv(shear)
        a, b = (
            np.stack([(plane @ strains)[balanced[k], k] for k in range(2)], axis=1)
            for strains in (ε, κ)
        )
        half = 0.5 * (high - low)
        for z, weight in zip(low + half * (1.0 + points), weights, strict=True):
            at = τ - (z - low) * a - 0.5 * (z * z - low * low) * b
            flexibility += half * weight * at.T @ S @ at
        τ = τ - (high - low) * a - 0.5 * (high * high - low * low) * b
    K = np.linalg.inv(flexibility)
    return np.asarray(0.5 * (K + K.T))


def _orthotropic(m: Material | Orthotropic) -> Orthotropic:
    if isinstance(m, Orthotropic):
        return m
    if not m.nu < 0.5:
        raise ValueError(f"a shell needs a Poisson's ratio below 1/2, got {m.nu!r}")
    return Orthotropic(m.E, m.E, m.nu, m.G, m.G, m.G, m.density)
