"""Isotropic elastic materials, and linear damping."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, instance, number, numbers, positive, positive_or_zero


@dataclass(frozen=True)
class Material:
    """Isotropic elastic material, linear in the strains of beams and shells.

    Strains of shells are Green's: at 1 % of extension the force is 1.5 % larger than by Hooke's law
    in engineering strain.

    Attributes:
        E: Young's modulus, force per area.
        nu: Poisson's ratio, -1 < nu <= 0.5.
        density: Mass per volume; 0 for statics without gravity.

    Raises:
        ValueError: A number is outside its range.
    """

    E: float
    nu: float
    density: float

    def __post_init__(self) -> None:
        positive(self.E, "Young's modulus E")
        positive_or_zero(self.density, "density")
        if not -1.0 < number(self.nu, "Poisson's ratio nu") <= 0.5:
            raise ValueError(f"Poisson's ratio nu must satisfy -1 < nu <= 0.5, got {self.nu!r}")

    @property
    def G(self) -> float:
        """Shear modulus ``E / (2 (1 + ν))``."""
        return self.E / (2.0 * (1.0 + self.nu))


def require_material(value: object) -> None:
    """Raise ``TypeError`` if ``value`` is not an isotropic material."""
    instance(value, Material, "material", "a Material(E, nu, density)")


@dataclass(frozen=True)
class Damping:
    """Linear damping; Rayleigh damping uses both parts.

    Attributes:
        mass: Damping force per momentum, 1/time: it opposes motion in space, mainly of low modes.
        stiffness: Kelvin-Voigt relaxation time: viscosity over stiffness; one for all strains or,
            for beams, six for (Γ₁, Γ₂, Γ₃, κ₁, κ₂, κ₃). Rigid motion is not damped.

    Raises:
        ValueError: A number is negative or not finite.
    """

    mass: float = 0.0
    stiffness: float | tuple[float, ...] = 0.0

    def __post_init__(self) -> None:
        factors = self.factors()
        number(self.mass, "mass damping")
        if factors.shape != (6,) or not (np.isfinite(factors) & (factors >= 0)).all():
            raise ValueError(
                f"stiffness damping must be one or six times ≥ 0, got {self.stiffness!r}"
            )
        if not 0.0 <= self.mass < np.inf:
            raise ValueError(f"mass damping must be a rate ≥ 0, got {self.mass!r}")

    def factors(self) -> Array:
        """Relaxation time of each strain, shape (6,)."""
        given = numbers(self.stiffness, "stiffness damping")
        return np.full(6, given) if given.ndim == 0 else given

    @classmethod
    def _checked(cls, given: Damping | None, what: str) -> Damping:
        instance(given, cls | None, f"{what}: damping", "a Damping or None")
        return cls() if given is None else given

    @classmethod
    def of_mass(cls, given: Damping | None, what: str) -> Damping:
        """Damping of a body that has none of strain.

        Args:
            given: Damping; ``None``: none.
            what: Name of the body, for messages.

        Raises:
            ValueError: It damps strain.
            TypeError: It is not a :class:`Damping`.
        """
        found = cls._checked(given, what)
        if found.relaxation_time:
            raise ValueError(f"{what} has damping with mass only, got Damping(stiffness=…)")
        return found

    @classmethod
    def of_body(cls, given: Damping | None, what: str) -> Damping:
        """Damping of a body that has one relaxation time for all strains.

        Args:
            given: Damping; ``None``: none.
            what: Name of the body, for messages.

        Raises:
            ValueError: It has several.
            TypeError: It is not a :class:`Damping`.
        """
        found = cls._checked(given, what)
        if np.ptp(found.factors()):
            raise ValueError(
                f"{what} has one relaxation time for all strains, got Damping(stiffness="
                f"{found.stiffness!r})"
            )
        return found

    @property
    def relaxation_time(self) -> float:
        """The relaxation time of all strains, or the largest of six."""
        return float(self.factors().max())

    def viscosity(self, stiffness: Array) -> Array:
        """Viscosity ``√(τᵢ τⱼ) D_ij`` of each cell, shape (m, 6, 6).

        Args:
            stiffness: Section stiffness of each cell, shape (m, 6, 6).
        """
        root = np.sqrt(self.factors())
        return np.asarray(stiffness * np.outer(root, root))
