"""Materials of solids: strain energy per unloaded volume, in UFL, without cancellation.

The energy is a function of the right Cauchy-Green tensor ``C = FᵀF`` of the deformation gradient
``F``, so that it is invariant under rotations of the body; the stress is ``S = 2 ∂W/∂C``.

At small strains ``C`` is nearly one, and an energy that is a difference of numbers of order one,
such as ``tr C − 3 − ln det C``, is dominated by round-off: at a strain of 1e-6 its relative error
is 1e-4. Written in ``C − 1`` and with the functions of this module it is as accurate as the
strains. UFL itself has neither ``log1p`` nor ``expm1``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import ufl
from ufl.core.expr import Expr

from fem_lie._arrays import instance, number, positive, positive_or_zero

_NEAR, _TERMS = 0.1, 6
"""Argument up to which the series is used, and its terms: the next is 2e-18 of the first."""


def log1p(x: Expr) -> Expr:
    """``ln(1 + x)``, accurate to round-off of ``x``, also for small ``x``.

    Args:
        x: A scalar above −1.

    Returns:
        ``2 artanh(x/(2 + x))`` by its series for ``|x| < 0.1``, otherwise the logarithm.
    """
    z = x / (2.0 + x)
    series: Expr | float = 1.0 / (2 * _TERMS + 1)
    for k in reversed(range(_TERMS)):
        series = 1.0 / (2 * k + 1) + z**2 * series
    return ufl.conditional(ufl.lt(abs(x), _NEAR), 2.0 * z * series, ufl.ln(1.0 + x))


def expm1(x: Expr) -> Expr:
    """``eˣ − 1``, accurate to round-off, also for small ``x``: ``tanh(x/2) (eˣ + 1)``.

    Args:
        x: A scalar.
    """
    return ufl.tanh(0.5 * x) * (ufl.exp(x) + 1.0)


def det_minus_one(C: Expr) -> Expr:
    """``det C − 1``, accurate to round-off of strains.

    Args:
        C: A symmetric matrix (3, 3), near one or not.

    Returns:
        ``I₁ + I₂ + I₃`` of the principal invariants of ``A = C − 1``.
    """
    A = C - ufl.Identity(3)
    return ufl.tr(A) + 0.5 * (ufl.tr(A) ** 2 - ufl.inner(A, A)) + ufl.det(A)


_SMALL = 1e-3  # strain


class SolidMaterial(ABC):
    """Constitutive law of a solid: subclass it as a frozen dataclass.

    Attributes:
        density: Mass per unloaded volume; ``None`` or 0 for statics without gravity.
    """

    density: float | None

    @property
    @abstractmethod
    def parameters(self) -> tuple[float, ...]:
        """Parameters of :meth:`energy`, in which groups of cells may differ.

        Their number is the same for all materials of a class.
        """

    @property
    def law(self) -> object:
        """Key that materials in one solid must have in common: by default their class."""
        return type(self)

    @abstractmethod
    def energy(self, C: Expr, *parameters: Expr) -> Expr:
        """Strain energy per unloaded volume, zero and stress-free at ``C = 1``.

        Args:
            C: Right Cauchy-Green tensor, a symmetric matrix (3, 3).
            parameters: :attr:`parameters` of each cell.
        """

    def incompressibility(self) -> float:
        """Ratio of bulk to shear modulus at small strains; 2.2 for ν = 0.3, 50 for ν = 0.49."""

        def stored(*stretches: float) -> float:
            C = ufl.as_matrix(np.diag(np.square(stretches)).tolist())
            return float(self.energy(C, *self.parameters)(()))

        # 9 K e²/2 and 2 μ e² on either side
        ε = _SMALL
        bulk = sum(stored(1 + s, 1 + s, 1 + s) for s in (-ε, ε)) / 9.0
        shear = sum(stored(1 + s, 1 / (1 + s), 1.0) for s in (-ε, ε)) / 4.0
        return bulk / shear

    def _check_density(self) -> None:
        if self.density is not None:
            positive_or_zero(self.density, "density")


@dataclass(frozen=True)
class _Isotropic(SolidMaterial):
    """Material with two elastic constants.

    Attributes:
        E: Young's modulus at small strains, force per area.
        nu: Poisson's ratio at small strains, -1 < nu < 0.5.
        density: Mass per unloaded volume; ``None`` or 0 for statics without gravity.

    Raises:
        ValueError: A number is outside its range.
    """

    E: float
    nu: float
    density: float | None = None

    def __post_init__(self) -> None:
        """Check the numbers."""
        positive(self.E, "Young's modulus E")
        if not -1.0 < number(self.nu, "Poisson's ratio nu") < 0.5:
            raise ValueError(
                f"Poisson's ratio nu of a solid must satisfy -1 < nu < 0.5, got {self.nu!r}"
            )
        self._check_density()

    @property
    def parameters(self) -> tuple[float, float]:
        """Lamé's constants λ and μ."""
        μ = self.E / (2.0 * (1.0 + self.nu))
        return 2.0 * μ * self.nu / (1.0 - 2.0 * self.nu), μ


@dataclass(frozen=True)
class SaintVenantKirchhoff(_Isotropic):
    """``W = ½ λ (tr E)² + μ E:E`` with ``E = ½ (C − 1)``: small strains, any rotations.

    It loses its stiffness in compression beyond about forty per cent.
    """

    def energy(self, C: Expr, *parameters: Expr) -> Expr:
        """Strain energy per unloaded volume."""
        λ, μ = parameters
        E = 0.5 * (C - ufl.Identity(3))
        return 0.5 * λ * ufl.tr(E) ** 2 + μ * ufl.inner(E, E)


@dataclass(frozen=True)
class NeoHooke(_Isotropic):
    """``W = ½ μ (tr C − 3 − 2 ln J) + ½ λ (ln J)²``: large strains, ``J = √det C``."""

    def energy(self, C: Expr, *parameters: Expr) -> Expr:
        """Strain energy per unloaded volume in changes of ``C``, without cancellation."""
        λ, μ = parameters
        log = 0.5 * log1p(det_minus_one(C))
        return 0.5 * μ * (ufl.tr(C - ufl.Identity(3)) - 2.0 * log) + 0.5 * λ * log**2


@dataclass(frozen=True)
class Hyperelastic(SolidMaterial):
    """Any other strain energy, anisotropic ones included.

    Attributes:
        function: Energy per unloaded volume as a UFL function of ``C``, and of ``parameters`` if
            there are any; it must vanish, with zero derivative, at ``C = 1``. If it is a difference
            of larger numbers, as ``tr C − 3 − ln det C``, it is dominated by round-off at small
            strains, and energy is conserved to that accuracy only; :func:`~fem_lie.sections.log1p`,
            :func:`~fem_lie.sections.expm1` and :func:`~fem_lie.sections.det_minus_one` avoid this.
        density: Mass per unloaded volume; ``None`` or 0 for statics without gravity.
        parameters: Parameters of the function; groups of cells of one solid may differ in these.

    Raises:
        TypeError: ``function`` is not a function.
        ValueError: A number is outside its range.
    """

    function: Callable[..., Expr]
    density: float | None = None
    parameters: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        """Check the arguments."""
        instance(self.function, Callable, "Hyperelastic: function", "a UFL function of C")
        for value in self.parameters:
            number(value, "a parameter of a Hyperelastic material")
        self._check_density()

    @property
    def law(self) -> object:
        """Key of the law: the function."""
        return self.function

    def energy(self, C: Expr, *parameters: Expr) -> Expr:
        """Strain energy per unloaded volume."""
        return self.function(C, *parameters)
