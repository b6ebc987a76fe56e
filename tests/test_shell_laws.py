"""A user's own strain energy on shells in scenes, and mixed elements on triangles."""

import numpy as np
import pytest
import ufl
from scipy.optimize import brentq

import fem_lie as fl
from tests.assembled import Assembled

MODULUS, THICKNESS, CUBIC = 100.0, 0.1, 40.0
LAYER = fl.ShellSection.layer(THICKNESS, fl.Material(MODULUS, 0.0, 2.0))


def stiffening(e):
    """The section of LAYER, and cubic terms of all kinds; in tension along e₁ it is E₁₁³ alone."""
    D = ufl.as_matrix(LAYER.stiffness.tolist())
    cubic = CUBIC / 3 * e[0] ** 3 - 0.002 * e[3] ** 3 + 20 * e[6] ** 3 + 30 * e[0] * e[2] ** 2
    return 0.5 * ufl.inner(e, D * e) + cubic


LAWS = {
    "Hu-Washizu": ("quadrilateral", 1, lambda law: fl.elements.HuWashizu(law=law)),
    "Hu-Washizu, triangles": ("triangle", 1, lambda law: fl.elements.HuWashizu(law=law)),
    "displacement": ("quadrilateral", 1, lambda law: fl.elements.DisplacementBased(law=law)),
}


def strip(name: str, law, cells=(2, 1)) -> tuple[fl.Scene, fl.Shell]:
    cell, degree, make = LAWS[name]
    mesh = fl.mesh.parametric_surface(lambda a, b: (2 * a, b, 0.0), cells, cell=cell, degree=degree)
    shell = fl.Shell(mesh, LAYER, along=(1, 0, 0), formulation=make(law), name="strip")
    scene = fl.Scene()
    scene.add(shell)
    return scene, shell


@pytest.mark.parametrize("name", LAWS)
def test_forces_are_the_derivative_of_the_energy(name):
    """At large strains, where one solution for the cells' own unknowns is not enough."""
    scene, _ = strip(name, stiffening)
    system = Assembled(scene, dynamics=False)
    rng, step = np.random.default_rng(1), 1e-5
    first, second = rng.normal(size=(2, system.count, 5))
    increment, direction = (np.pad(h, [(0, 0), (0, 1)]) for h in (0.1 * first, second))
    H = system.tilted(system.start, increment)
    forces = system.residual(H)
    energies = [
        system.equations.report(system.tilted(H, sign * step * direction), linearised=False).elastic
        for sign in (1, -1)
    ]
    work = forces @ direction.ravel()
    assert (energies[0] - energies[1]) / (2 * step) == pytest.approx(work, rel=1e-6)


def stretch(load: float) -> float:
    """Of a strip with the law of :func:`stiffening` under a force per unloaded width."""

    def excess(x: float) -> float:
        E = 0.5 * (x**2 - 1)
        return x * (MODULUS * THICKNESS * E + CUBIC * E**2) - load

    return float(brentq(excess, 0.5, 3.0))


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("solve", [fl.statics, fl.follow_loads])
def test_uniaxial_tension(name, solve):
    """Homogeneous without Poisson's ratio: exact on any mesh."""
    scene, shell = strip(name, stiffening)
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(8.0, 0, 0)))
    result = solve(scene)
    expected = stretch(8.0)
    assert expected > 1.25
    assert result.position("strip.11")[-1, 0] == pytest.approx(2 * expected, rel=1e-8)
    assert result.iterations[-1] <= 16


@pytest.mark.parametrize("name", ["Hu-Washizu", "Hu-Washizu, triangles"])
def test_small_strains_are_those_of_the_section(name):
    """The cubic term is a part of the load, smaller than it as the strain is."""
    gaps = []
    for load in (1e-3, 5e-4):
        tips = []
        for law in (stiffening, None):
            scene, shell = strip(name, law)
            shell.clamp("a=0")
            scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(load, 0, load / 100)))
            tips.append(fl.statics(scene).position("strip.11")[-1] - (2, 1, 0))
        gaps.append(np.abs(tips[0] - tips[1]).max() / np.abs(tips[1]).max())
    assert 1e-4 <= gaps[0] <= 5e-3
    assert gaps[1] <= gaps[0] / 1.6


@pytest.mark.parametrize("name", ["Hu-Washizu", "displacement"])
def test_a_stretched_strip_swings_with_its_energy(name):
    """One cell: both elements have the same strain, and the same motion to the tolerance."""
    scene, shell = strip(name, stiffening, cells=(1, 1))
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(8.0, 0, 0)))
    result = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-10).run(scene, duration=1.0, step=0.01)
    # one degree of freedom: a third of the mass, ½ m ẋ² + W = P (x − 2)
    x, lengths = result.position("strip.11")[:, 0], np.array([2.0])
    E = 0.5 * ((x / lengths) ** 2 - 1)
    stored = 2 * (0.5 * MODULUS * THICKNESS * E**2 + CUBIC / 3 * E**3)
    np.testing.assert_allclose(result.elastic, stored, atol=1e-8)
    assert x.max() > 2.8
    assert result.energy_error <= 2e-3  # of second order in the step


def test_vibrations_about_a_stretched_state_know_its_stiffness():
    """``ω² = K/m`` along the strip, one cell: mass ρ t ℓ/3, stiffness ``d(λN)/dλ/ℓ``."""
    scene, shell = strip("Hu-Washizu", stiffening, cells=(1, 1))
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(8.0, 0, 0)))
    modes = fl.vibrations(scene, 10)
    x = stretch(8.0)
    E = 0.5 * (x**2 - 1)
    N, slope = MODULUS * THICKNESS * E + CUBIC * E**2, MODULUS * THICKNESS + 2 * CUBIC * E
    omega = np.sqrt((N + x**2 * slope) / 2.0 / (2.0 * THICKNESS * 2.0 / 3))
    assert np.abs(np.abs(modes.eigenvalues) / omega - 1).min() <= 1e-6


@pytest.mark.parametrize("formulation", [fl.elements.HellingerReissner, fl.elements.HuWashizu])
@pytest.mark.parametrize("given", [True, False])
def test_no_mixed_element_on_six_nodes(formulation, given):
    """Before anything is assembled."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (1, 1), cell="triangle", degree=2)
    with pytest.raises(ValueError, match=r"is for|no mixed element"):
        fl.Shell(mesh, LAYER, formulation=formulation(fl.elements.MITC6 if given else None))


@pytest.mark.parametrize("formulation", [fl.elements.HellingerReissner(), fl.elements.HuWashizu()])
def test_triangles_are_mixed_elements_in_a_scene(formulation):
    """A clamped plate under its load as the quadrilaterals find it, in statics and in time."""
    found = []
    for cell in ("triangle", "quadrilateral"):
        mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (8, 8), cell=cell)
        shell = fl.Shell(mesh, LAYER, formulation=formulation, name="plate")
        shell.clamp("a=0")
        scene = fl.Scene()
        scene.add(shell)
        scene.add(fl.AreaLoad(shell, (0, 0, 0.05)))
        bent = fl.statics(scene).position("plate.10")[-1, 2]
        moved = fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.1).position("plate.10")
        found.append((bent, moved[-1, 2]))
    assert min(found[0]) > 0.1
    np.testing.assert_allclose(found[0], found[1], rtol=0.02)
