"""A cable hangs from one end with a mass at the other, and swings: its frequencies.

L = 10, weight w = 10 per length. With a point mass M = w L/(10 g) at its end it swings
across with frequencies of Bessel's functions of p = 2 omega sqrt(M/(rho g)) and
q = 2 omega sqrt(M/(rho g) + L/g), if it does not stretch (EA = 1e7 here):
Y_2(p) J_0(q) = J_2(p) Y_0(q). frequency_error is that of the first three. Without the mass the free
end would have no tension, and turn against its bending alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import one_of, run
from reference.catenary import GRAVITY, LENGTH, STRETCH, exact_frequencies

import fem_lie as fl

ELEMENTS = {"cable": fl.elements.HermiteCable(), "discrete": fl.elements.DiscreteCable()}


def main(element: str = "cable", elements: int = 32) -> dict[str, Any]:
    one_of("element", element, ELEMENTS)
    bending = 1e-10 * STRETCH * LENGTH**2
    section = fl.Section.from_stiffness([1e7] * 3 + [bending] * 3, mass=1.0)
    mesh = fl.mesh.curve(lambda s: (0.0, 0.0, -LENGTH * s), elements)
    cable = fl.Cable(mesh, section, formulation=ELEMENTS[element])
    mass = fl.RigidBody(0.1 * LENGTH, (1e-3,) * 3, position=(0, 0, -LENGTH))
    mass.model.held[0, 3:] = True
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    for body in (cable, mass):
        scene.add(body)
    scene.add(fl.joints.Spherical(cable.point("end"), mass.point("centre")))
    cable.pin(cable.point("start"))
    found = fl.vibrations(scene, 6, at=fl.statics(scene)).frequencies
    error = np.abs(found / np.repeat(exact_frequencies(), 2) - 1).max()
    return {"frequency_error": float(error)}


if __name__ == "__main__":
    run(main, show=True)
