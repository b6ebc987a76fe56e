"""Properties of sections of which they are known in closed form, about their centroid.

Shear factors: G. R. Cowper, J. Appl. Mech. 33 (1966) 335, doi:10.1115/1.3625046. Torsion of the
rectangle: S. Timoshenko & J. N. Goodier, *Theory of Elasticity* (1970), §109.
"""

from __future__ import annotations

from math import exp, pi

import numpy as np

from fem_lie._arrays import positive
from fem_lie.sections.material import Material, require_material
from fem_lie.sections.properties import SectionProperties

_ZETA_5 = 1.0369277551433699263  # Riemann's ζ(5)


def rectangle(
    width: float,
    height: float,
    material: Material,
    shear_factor: float | None,
    torsion_constant: float | None,
) -> SectionProperties:
    """Of a solid rectangle; arguments as of :meth:`~fem_lie.Section.rectangle`."""
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
    """Of what lies between two circles, the inner one perhaps of no size."""
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
    """With the centroid on the axis; ``second_moments`` are ∫y² and ∫z²."""
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
