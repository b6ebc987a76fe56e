"""Sections of any shape: torsion, shear and bending from a finite element solution of the section.

A beam needs a 6×6 stiffness. For bending, integrals over the section are enough. Torsion makes it
warp, u = kappa_1 omega(y, z), and equilibrium along the axis gives Laplace's equation

    integral G (grad omega + t) . grad eta dA = 0,    t = (-z, y),
    G J = integral G (grad omega + t) . t dA;

a shear force makes it warp, too, and the mean of that is the shear strain of the beam. The theory
stands in fem_lie/sections/warping.py; shear factors are those of G. R. Cowper, J. Appl.
Mech. 33 (1966) 335.

The table compares shapes with closed forms: Saint-Venant's torsion of rectangle, triangle, ellipse
and tube; Cowper's factors; and, for the channel, the shear centre of thin walls,

    e = 3 b^2 t_f / (h t_w + 6 b t_f) from the middle of the web,

which is no more than an approximation, here 1.6 % off. The picture is of the channel with a lining
of wood at its web: a composite.
"""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

WOOD = fl.Material(E=11e9, nu=0.3, density=450.0)
ELLIPSE_POINTS = 128


def ellipse(a: float, b: float) -> fl.sections.SectionShape:
    """A polygon of the same area."""
    turn = 2 * pi / ELLIPSE_POINTS
    angle, scale = turn * np.arange(ELLIPSE_POINTS), sqrt(turn / np.sin(turn))
    points = scale * np.column_stack([a * np.cos(angle), b * np.sin(angle)])
    return fl.sections.SectionShape.polygon(points)


def torsion_of_rectangle(a: float, b: float) -> float:
    """Torsion constant: the torsional stiffness where the shear modulus is 1."""
    return float(fl.Section.rectangle(a, b, fl.Material(2.0, 0.0, 1.0)).stiffness[3, 3])


def cowper_ellipse(n: float, nu: float) -> float:
    """Shear factor; n is the semi-axis along the force over the other one."""
    return (12 * (1 + nu) * n**2 * (3 * n**2 + 1)) / (
        (40 + 37 * nu) * n**4 + (16 + 10 * nu) * n**2 + nu
    )


def closed_forms(nu: float) -> dict[str, tuple[fl.sections.SectionShape, float, float | None]]:
    """Shape, torsion constant and shear factor along e_2 of each name."""
    rectangle = 10 * (1 + nu) / (12 + 11 * nu)
    q, m2 = (1 + 0.9**2) ** 2, 0.9**2
    tube = 6 * (1 + nu) * q / ((7 + 6 * nu) * q + (20 + 12 * nu) * m2)
    shape = fl.sections.SectionShape
    triangle = shape.polygon([(0, 0), (1, 0), (0.5, sqrt(3) / 2)])
    return {
        "square": (shape.rectangle(1, 1), torsion_of_rectangle(1.0, 1.0), rectangle),
        "rectangle 1:4": (shape.rectangle(1, 4), torsion_of_rectangle(1.0, 4.0), rectangle),
        "circle": (shape.circle(1), pi / 2, 6 * (1 + nu) / (7 + 6 * nu)),
        "tube 0.9": (shape.tube(0.9, 1), pi / 2 * (1 - 0.9**4), tube),
        "ellipse 2:1": (ellipse(2, 1), pi * 8 / 5, cowper_ellipse(2, nu)),
        "triangle": (triangle, sqrt(3) / 80, None),
    }


def lined_channel(steel: fl.Material, pictures: bool) -> fl.Section:
    """Stiffness about its shear centre, so that a force there does not twist it."""
    shape = fl.sections.SectionShape.joined(
        {
            "steel": fl.sections.SectionShape.channel(0.08, 0.2, 0.0085, 0.011),
            "wood": fl.sections.SectionShape.rectangle(0.02, 0.178).moved(0.0185, 0.0),
        }
    )
    warping = shape.warping({"steel": steel, "wood": WOOD})
    if pictures:
        path = in_results("section_properties.png")
        warping.picture(path)
    return warping.section(at=warping.properties.shear_centre)


def main(nu: float = 0.3, refinement: float = 1.0, pictures: bool = True) -> dict[str, Any]:
    steel = fl.Material(E=210e9, nu=nu, density=7850.0)
    record: dict[str, Any] = {"nu": nu, "refinement": refinement}
    errors = []
    for shape, torsion, factor in closed_forms(nu).values():
        warping = shape.refined(refinement).warping(steel)
        p = warping.properties
        errors.append(abs(p.torsion_constant / torsion - 1))
        k = p.shear_factors[0, 0]
        if factor is not None:
            errors.append(abs(k / factor - 1))
    record["largest_error"] = float(max(errors))
    b, h, web, flange = 0.08 - 0.0085 / 2, 0.2 - 0.011, 0.0085, 0.011
    channel = fl.sections.SectionShape.channel(0.08, 0.2, web, flange).refined(refinement)
    centre = channel.warping(steel).properties.shear_centre[0]
    thin = web / 2 - 3 * b**2 * flange / (h * web + 6 * b * flange)
    record |= {"channel_shear_centre": float(centre), "channel_shear_centre_of_thin_walls": thin}
    section = lined_channel(steel, pictures)
    coupling = np.abs(section.stiffness[3, 1:3]).max() / sqrt(
        section.stiffness[3, 3] * section.stiffness[2, 2]
    )
    return record | {"coupling_at_shear_centre": float(coupling)}


if __name__ == "__main__":
    run(main, show=True)
