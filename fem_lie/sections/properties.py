"""Area, moments and torsion constant of beam sections; mass matrix of rigid ones.

Sections with properties in closed form, about their centroid.

Shear factors: G. R. Cowper, J. Appl. Mech. 33 (1966) 335, doi:10.1115/1.3625046. Torsion of the
rectangle: S. Timoshenko & J. N. Goodier, *Theory of Elasticity* (1970), §109.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, exp, pi, sin, sqrt

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, numbers, positive
from fem_lie.sections.material import Material, require_material

_ROUNDING = 1e-13
_ISOTROPY = 1e-7  # of principal moments: between rounding and the errors of a mesh


@dataclass(frozen=True, eq=False)
class SectionProperties:
    """Geometric properties of a section, in its axes and from its reference point.

    A composite has the moduli ``E`` and ``G`` averaged over its area, so that ``E A``, ``E I``,
    ``G J`` and ``G A k`` are its stiffnesses for any materials.

    Attributes:
        E: Young's modulus, mean over the area, force per area.
        G: Shear modulus, mean over the area, force per area.
        area: Area, length².
        centroid: Point where an axial force does not bend, (y, z).
        second_moments: ``∫r ⊗ r dA`` about the centroid, [[∫y², ∫yz], [∫yz, ∫z²]], length⁴;
            weighted by E in a composite.
        torsion_constant: Saint-Venant's torsion constant, length⁴; weighted by G in a composite.
        shear_centre: Point where a shear force does not twist, (y, z).
        shear_factors: Effective over true shear area, symmetric, shape (2, 2).
        warping_constant: ``I_ω = ∫ω² dA`` of the warping function about the shear centre, length⁶,
            weighted by E in a composite; ``None`` if it is not known.
    """

    E: float
    G: float
    area: float
    centroid: Array
    second_moments: Array
    torsion_constant: float
    shear_centre: Array
    shear_factors: Array
    warping_constant: float | None = None

    @property
    def warping_length(self) -> float:
        """Decay length ``√(E I_ω/(G J))`` of restrained warping along a beam; 0 if unknown."""
        warping = self.E * (self.warping_constant or 0.0)
        return sqrt(warping / (self.G * self.torsion_constant))

    @property
    def polar_radius(self) -> float:
        """Radius of gyration about the centroid, length."""
        return sqrt(float(np.trace(self.second_moments)) / self.area)

    @property
    def stiffness(self) -> Array:
        """Section stiffness on (Γ₁, Γ₂, Γ₃, κ₁, κ₂, κ₃) at the reference point, shape (6, 6).

        Extension and bending act about the centroid, shear and torsion about the shear centre.
        """
        # strains (Γ₁, κ₂, κ₃) at the centroid and (Γ₂, Γ₃, κ₁) at the shear centre
        (y, z), (ys, zs) = self.centroid, self.shear_centre
        bending, shear = np.zeros((3, 6)), np.zeros((3, 6))
        bending[[0, 1, 2], [0, 4, 5]] = shear[[0, 1, 2], [1, 2, 3]] = 1.0
        bending[0, 4:] = z, -y
        shear[:2, 3] = -zs, ys
        (yy, yz), (_, zz) = self.second_moments
        D_bending, D_shear = np.zeros((3, 3)), np.zeros((3, 3))
        D_bending[0, 0] = self.E * self.area
        # curvature about e₂ is axial strain along z, about e₃ along y
        D_bending[1:, 1:] = self.E * np.array([[zz, -yz], [-yz, yy]])
        D_shear[:2, :2] = self.G * self.shear_factors * self.area
        D_shear[2, 2] = self.G * self.torsion_constant
        return np.asarray(bending.T @ D_bending @ bending + shear.T @ D_shear @ shear)

    @property
    def principal_moments(self) -> Array:
        """Second moments ``∫η²``, ``∫ζ²`` in the principal axes (η, ζ), the larger one first."""
        return np.asarray(np.linalg.eigvalsh(self.second_moments)[::-1], dtype=np.float64)

    @property
    def principal_angle(self) -> float:
        """Angle from e₂ to the principal axis η of the larger ``∫η²``, in (-π/2, π/2].

        It is 0 if all axes are principal axes.
        """
        (yy, yz), (_, zz) = self.second_moments
        if np.hypot(0.5 * (yy - zz), yz) < _ISOTROPY * (yy + zz):
            return 0.0
        if abs(yz) < _ROUNDING * (yy + zz):
            return 0.0 if yy > zz else 0.5 * pi
        return float(0.5 * np.arctan2(2.0 * yz, yy - zz))

    def offset(self, y: float, z: float) -> SectionProperties:
        """Properties for a reference point at (y, z).

        Args:
            y: Coordinate along e₂ of the new reference point.
            z: Coordinate along e₃ of the new reference point.
        """
        r = np.array([y, z])
        return replace(self, centroid=self.centroid - r, shear_centre=self.shear_centre - r)

    def rotated(self, angle: float) -> SectionProperties:
        """Properties of the section rotated about its reference point, from e₂ to e₃ by ``angle``.

        Args:
            angle: Angle, rad.
        """
        R = rotation(angle)
        return replace(
            self,
            centroid=R @ self.centroid,
            second_moments=R @ self.second_moments @ R.T,
            shear_centre=R @ self.shear_centre,
            shear_factors=R @ self.shear_factors @ R.T,
        )

    def __str__(self) -> str:
        (yy, yz), (_, zz) = self.second_moments
        (k2, k23), (_, k3) = self.shear_factors
        large, small = self.principal_moments
        rows = [
            ("area", f"{self.area:.6g}"),
            ("centroid (y, z)", "{:.6g}, {:.6g}".format(*self.centroid)),
            ("∫y², ∫z², ∫yz", f"{yy:.6g}, {zz:.6g}, {yz:.6g}"),
            ("principal moments", f"{large:.6g}, {small:.6g}"),
            ("principal angle", f"{np.degrees(self.principal_angle):.4f}°"),
            ("torsion constant", f"{self.torsion_constant:.6g}"),
            ("shear centre (y, z)", "{:.6g}, {:.6g}".format(*self.shear_centre)),
            ("shear factors 22, 33, 23", f"{k2:.6g}, {k3:.6g}, {k23:.6g}"),
        ]
        if self.warping_constant is not None:
            rows.append(("warping constant", f"{self.warping_constant:.6g}"))
        return "\n".join(f"{name:<26}{value}" for name, value in rows)


def rotation(angle: float) -> Array:
    """Rotation matrix from components in axes rotated by ``angle`` to those in the original axes.

    A quarter turn is exact, without couplings of the size of round-off.
    """
    quarters = angle / (0.5 * pi)
    if quarters == round(quarters):
        c, s = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
    else:
        c, s = cos(angle), sin(angle)
    return np.array([[c, -s], [s, c]])


_ZETA_5 = 1.0369277551433699263  # Riemann's ζ(5)


def rectangle(
    width: float,
    height: float,
    material: Material,
    shear_factor: float | None,
    torsion_constant: float | None,
) -> SectionProperties:
    """Properties of a solid rectangle; arguments as of :meth:`~fem_lie.Section.rectangle`."""
    positive(width, "width")
    positive(height, "height")
    require_material(material)
    if shear_factor is None:
        shear_factor = 10.0 * (1.0 + material.nu) / (12.0 + 11.0 * material.nu)
    if torsion_constant is None:
        torsion_constant = rectangle_torsion_constant(width, height)
    second_moments = height * width**3 / 12.0, width * height**3 / 12.0
    return _centred(material, width * height, second_moments, shear_factor, torsion_constant)


def ring(
    inner: float, outer: float, material: Material, shear_factor: float | None
) -> SectionProperties:
    """Properties of the area between two circles; the inner radius may be zero."""
    require_material(material)
    nu, m2 = material.nu, (inner / outer) ** 2
    if shear_factor is None:
        q = (1.0 + m2) ** 2
        shear_factor = 6.0 * (1.0 + nu) * q / ((7.0 + 6.0 * nu) * q + (20.0 + 12.0 * nu) * m2)
    # factored so that thin walls lose no digits
    area = pi * (outer - inner) * (outer + inner)
    second = 0.25 * area * (outer**2 + inner**2)
    return _centred(material, area, (second, second), shear_factor, 2.0 * second)


def _centred(
    material: Material,
    area: float,
    second_moments: tuple[float, float],
    shear_factor: float,
    torsion_constant: float,
) -> SectionProperties:
    """Properties with the centroid on the axis; ``second_moments`` are ∫y² and ∫z²."""
    positive(shear_factor, "shear_factor")
    positive(torsion_constant, "torsion_constant")
    return SectionProperties(
        E=material.E,
        G=material.G,
        area=area,
        centroid=np.zeros(2),
        second_moments=np.diag(second_moments),
        torsion_constant=torsion_constant,
        shear_centre=np.zeros(2),
        shear_factors=shear_factor * np.eye(2),
    )


def rectangle_torsion_constant(width: float, height: float) -> float:
    """Saint-Venant torsion constant of a rectangle, length⁴, to machine precision.

    ``J = a b³/3 (1 − 192 b/(π⁵ a) Σ tanh(nπa/2b)/n⁵)`` over odd n, with a ≥ b. The slowly
    converging part ``Σ 1/n⁵ = 31/32 ζ(5)`` is summed in closed form; the rest falls by e⁻²π a term.
    """
    positive(width, "width")
    positive(height, "height")
    a, b = max(width, height), min(width, height)
    # exp overflows for very flat rectangles, where the term is nothing anyway
    rest = sum(2.0 / (n**5 * (1.0 + exp(min(n * pi * a / b, 700.0)))) for n in range(1, 15, 2))
    series = 31.0 / 32.0 * _ZETA_5 - rest
    return a * b**3 / 3.0 * (1.0 - 192.0 * b / (pi**5 * a) * series)


def director_mass_matrix(
    mass: float, inertia: npt.ArrayLike, centre: npt.ArrayLike = (0.0, 0.0, 0.0)
) -> Array:
    """Mass matrix of (x, d₁, d₂, d₃) of a rigid body, or of a section (then all per length).

    ``G_xx = m``, ``G_xk = m c_k``, ``G_kl = ½ tr(J) δ_kl − J_kl + m c_k c_l``, the second moments
    of the mass distribution about the frame's origin.

    Args:
        mass: Mass.
        inertia: Inertia tensor J about the centre of mass, in the body's axes, shape (3, 3), or its
            diagonal, shape (3,).
        centre: Centre of mass c relative to the frame's origin, in the body's axes.

    Returns:
        Symmetric positive semidefinite matrix, shape (4, 4).

    Raises:
        ValueError: The mass is not positive, or J is not symmetric positive definite, or one
            principal value exceeds the sum of the others: no body has such a tensor.
    """
    J = numbers(inertia, "inertia")
    J = np.diag(J) if J.shape == (3,) else J
    c = numbers(centre, "centre")
    positive(mass, "mass")
    if c.shape != (3,) or not np.isfinite(c).all():
        raise ValueError(f"centre must be 3 finite numbers, got {centre!r}")
    if J.shape != (3, 3) or not np.isfinite(J).all() or np.abs(J - J.T).max() > 1e-8 * J.max():
        raise ValueError(f"inertia must be a symmetric 3×3 tensor, got\n{inertia!r}")
    principal = np.linalg.eigvalsh(J)
    if principal[0] <= 0.0 or principal[2] > (principal[0] + principal[1]) * (1.0 + 1e-9):
        small = "" if principal.any() else "; RigidBody.ball(mass, radius) has some"
        raise ValueError(
            "inertia must have positive principal values, none greater than the sum of the others, "
            f"got {principal}{small}"
        )
    G = np.empty((4, 4))
    G[0, 0] = mass
    G[0, 1:] = G[1:, 0] = mass * c
    E = 0.5 * np.trace(J) * np.eye(3) - 0.5 * (J + J.T)
    own, axes = np.linalg.eigh(E)
    if own[0] < 0.0:  # that of a flat section is zero along its normal, or round-off
        E = axes @ np.diag(own.clip(0.0)) @ axes.T
    G[1:, 1:] = E + mass * np.outer(c, c)
    return G
