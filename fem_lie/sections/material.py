"""Materials of sections."""

from __future__ import annotations

from dataclasses import dataclass

from fem_lie._arrays import instance, number, positive, positive_or_zero


@dataclass(frozen=True)
class Material:
    """Isotropic elastic material.

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
    """Raise ``TypeError`` if it is no isotropic material."""
    instance(value, Material, "material", "a Material(E, nu, density)")
