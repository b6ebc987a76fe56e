"""Shells of positions and three slopes: shear, slender strips, supports, motion."""

import numpy as np
import pytest

import fem_lie as fl
from demos import semi_cylinder
from studies import linear_shells


def strip(cells: int, thickness: float, **options) -> fl.AncfShell:
    """A cantilever of length 10 and width 1, without contraction."""
    section = fl.ShellSection.layer(thickness, fl.Material(1.2e6, 0.0, 1.0), shear_factor=1.0)
    patch = fl.mesh.smooth_patch(lambda a, b: [10 * a, b, 0.0], (cells, 1))
    body = fl.AncfShell(patch, section, name="strip", **options)
    body.clamp("a=0")
    return body


def pushed(body: fl.AncfShell, force: float) -> fl.StaticResult:
    scene = fl.Scene()
    scene.add(body)
    for point in ("10", "11"):
        scene.add(fl.PointLoad(body.point(point), force=(0, 0, force / 2)))
    return fl.statics(scene)


@pytest.mark.parametrize("cells", [1, 3])
def test_a_thick_strip_bends_and_shears_as_a_beam(cells):
    """``F ℓ³/3EI + F ℓ/GA``, exactly for any cells, by the residual bending flexibility."""
    E, t, force = 1.2e6, 4.0, 1e-3
    body = strip(cells, t)
    moved = pushed(body, force).position("strip.10")[-1][2]
    exact = force * (10**3 / (3 * E * t**3 / 12) + 10 / (E / 2 * t))
    assert moved == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("thickness", [1e-1, 1e-2, 1e-3])
def test_elastica(thickness):
    """End force P ℓ² = 4 EI, deflections 0.67 ℓ and 0.329 ℓ, whatever the slenderness."""
    result = pushed(strip(16, thickness), 4 * 1.2e6 * thickness**3 / 12 / 100)
    end = result.position("strip.10")[-1]
    # Bisshopp & Drucker (1945)
    assert end[2] / 10 == pytest.approx(0.66996, rel=3e-3)
    assert 1 - end[0] / 10 == pytest.approx(0.32894, rel=6e-3)
    assert result.total_iterations <= 25


def test_semi_cylinder_has_the_shear_that_thin_shells_lack():
    """At a tenth of the load, where these are 2 % too stiff."""
    layers = semi_cylinder.section("isotropic")
    result = fl.follow_loads(semi_cylinder.pinched(16, layers, "ancf"), [0.1])
    found = semi_cylinder.RADIUS - result.position("shell.11")[-1, 2]
    assert found == pytest.approx(semi_cylinder.REFERENCE["isotropic"][0.1], rel=0.01)


@pytest.mark.parametrize(("name", "bound"), [("scordelis_lo", 8e-3), ("twisted_in", 2e-3)])
def test_linear_shells(name, bound):
    case = linear_shells.CASES[name]
    found = linear_shells.deflection(case, 8 if name == "scordelis_lo" else 4, "ancf")
    assert found == pytest.approx(case.value, rel=bound)


def test_a_hinged_plate_vibrates_with_rotary_inertia_and_shear():
    """Mindlin's, bent along one direction, a tenth as thick as long: first frequency."""
    E, ν, ρ, t, κ, k = 1.0, 0.3, 1.0, 0.1, 5 / 6, np.pi
    D, S, J = E * t**3 / 12 / (1 - ν**2), κ * E / 2.6 * t, ρ * t**3 / 12
    # (D k² + S − J ω²) (S k² − ρ t ω²) = (S k)²
    a, b, c = J * ρ * t, ρ * t * (D * k**2 + S) + J * S * k**2, S * k**2 * D * k**2
    ω = np.sqrt((b - np.sqrt(b**2 - 4 * a * c)) / (2 * a))
    section = fl.ShellSection.layer(t, fl.Material(E, ν, ρ), shear_factor=κ)
    body = fl.AncfShell(fl.mesh.smooth_patch(lambda a, b: [a, 0.5 * b, 0.0], (8, 2)), section)
    for edge in ("a=0", "a=1"):
        body.hinge(edge)
    for edge in ("b=0", "b=1"):
        body.symmetry(edge, (0, 1, 0))
    scene = fl.Scene()
    scene.add(body)
    assert fl.vibrations(scene, 1).frequencies[0] == pytest.approx(ω, rel=2e-3)


def test_a_plate_that_is_thrown_keeps_its_energy():
    patch = fl.mesh.smooth_patch(lambda a, b: [a, b, 0.1 * a * a], (2, 2))
    body = fl.AncfShell(patch, fl.ShellSection.layer(0.05, fl.Material(1e4, 0.3, 10.0)))
    body.add_velocity((0.3, 0, 0), omega=(1.0, 2.0, 0.5), about=(0, 0, 0))
    scene = fl.Scene()
    scene.add(body)
    result = fl.EnergyMomentum().run(scene, duration=0.02, step=1e-3)
    energy = result.total_energy
    assert np.ptp(energy) < 1e-10 * energy[0]


def test_bad_input():
    patch = fl.mesh.smooth_patch(lambda a, b: [a, b, 0.0], (1, 1))
    section = fl.ShellSection.layer(0.1, fl.Material(1.0, 0.3, 1.0))
    with pytest.raises(TypeError, match="AncfPlate"):
        fl.AncfShell(patch, section, formulation=fl.elements.BicubicHermite())
    with pytest.raises(ValueError, match="between 0 and 1"):
        fl.elements.AncfPlate(share=2.0)
    with pytest.raises(ValueError, match="normal to the surface"):
        fl.AncfShell(patch, section, along=(0, 0, 1))
