"""Cantilevers of every element without rotations: no locking from slenderness 10 to 10 000."""

import numpy as np
import pytest

import fem_lie as fl
from demos.elastica import BENDING, FORCE, LENGTH, elastica

SLENDER = [1e1, 1e2, 1e4]
"""Of a square section: EA L²/EI is twelve times its square."""


def section(slenderness: float) -> fl.Section:
    EA = 12 * slenderness**2 * BENDING / LENGTH**2
    return fl.Section.from_stiffness([EA] * 3 + [BENDING] * 3)


def hermite(cells: int, slenderness: float) -> fl.Cable:
    return fl.Cable.straight((0, 0, 0), (LENGTH, 0, 0), section(slenderness), cells=cells)


def spline(cells: int, slenderness: float) -> fl.SplineCable:
    """With a parameter that is not arc length."""
    u = np.linspace(1.0, 2.0, cells + 1)
    along, rate = (u**1.2 - 1) / (2**1.2 - 1), 1.2 * u**0.2 / (2**1.2 - 1)
    x, axis = LENGTH * along, (1.0, 0.0, 0.0)
    return fl.SplineCable(u, np.outer(x, axis), np.outer(LENGTH * rate, axis), section(slenderness))


def discrete(cells: int, slenderness: float) -> fl.Cable:
    mesh = fl.mesh.straight_line((0, 0, 0), (LENGTH, 0, 0), cells)
    return fl.Cable(mesh, section(slenderness), formulation=fl.elements.DiscreteCable())


def rolled_up(make, cells: int, slenderness: float) -> tuple[float, float]:
    """Distance of the tip from the root over the length, and iterations per step.

    A body that holds the tangent of the tip has the moment that makes a circle.
    """
    cable, scene = make(cells, slenderness), fl.Scene()
    tip = fl.RigidBody(1.0, (1, 1, 1), position=(LENGTH, 0, 0))
    tip.model.held[0, 3] = True  # about the tangent
    for body in (cable, tip):
        scene.add(body)
    scene.add(fl.Clamp(cable.point("start")))
    scene.add(fl.joints.Revolute(tip.point("centre"), cable.point("end"), axis=(1, 0, 0)))
    scene.add(fl.PointLoad(tip.point("centre"), moment=(0, 0, 2 * np.pi * BENDING / LENGTH)))
    # what has no torsion turns out of its plane under a moment fixed in space, if it is let
    with pytest.warns(fl.stability.UnstableEquilibriumWarning):
        result = fl.statics(scene, load_steps=10)
    gap = np.linalg.norm(result.position(cable.point("end"))[-1]) / LENGTH
    return float(gap), result.iterations[-1] / len(result.factors) + result.failed_iterations


@pytest.mark.parametrize("slenderness", SLENDER)
@pytest.mark.parametrize("make", [hermite, spline])
def test_full_circle(make, slenderness):
    (coarse, _), (fine, iterations) = (rolled_up(make, n, slenderness) for n in (8, 16))
    assert fine < 2e-4 and coarse / fine > 12
    assert iterations <= 5.5


def pushed(make, cells: int, slenderness: float) -> tuple[np.ndarray, float]:
    """Displacement of the tip over the length, and iterations per step."""
    cable, scene = make(cells, slenderness), fl.Scene()
    scene.add(cable)
    cable.clamp(cable.point("start"))
    scene.add(fl.PointLoad(cable.point("end"), (0, 0, FORCE)))
    result = fl.statics(scene, load_steps=10)
    moved = result.position(cable.point("end"))[-1] - (LENGTH, 0, 0)
    return moved / LENGTH, result.iterations[-1] / len(result.factors) + result.failed_iterations


@pytest.mark.parametrize("slenderness", SLENDER)
@pytest.mark.parametrize(("make", "bound"), [(hermite, 1e-6), (spline, 2e-6), (discrete, 1e-3)])
def test_elastica(make, bound, slenderness):
    """Thick ones stretch, by what fine meshes tell: about the square of the slenderness less."""
    moved, iterations = pushed(make, 16, slenderness)
    stretched = 3.0 / (12 * slenderness**2) * FORCE * LENGTH**2 / BENDING
    assert np.linalg.norm(moved - elastica(FORCE) / LENGTH) <= bound + stretched
    assert iterations <= 5
