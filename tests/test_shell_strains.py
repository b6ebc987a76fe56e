"""Stress-free strains of shells: temperature, eigenstrain, prestress."""

from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl

YOUNG, THICKNESS, EXPANSION, RISE = 7e10, 0.01, 2e-5, 50.0
LONGER = EXPANSION * RISE
WIDTH = 0.2
ELEMENTS = {
    "Hellinger-Reissner": (None, "quadrilateral", 1),
    "Hu-Washizu": (fl.elements.HuWashizu(), "quadrilateral", 1),
    "MITC4": (fl.elements.DisplacementBased(), "quadrilateral", 1),
    "triangles": (None, "triangle", 1),
    "second order": (None, "triangle", 2),
}


def sheet(element="Hellinger-Reissner", cells=(8, 2), nu=0.3):
    """A strip along x of length 1."""
    formulation, cell, degree = ELEMENTS[element]
    mesh = fl.mesh.parametric_surface(
        lambda a, b: np.array([a, WIDTH * b, 0.0 * a]), cells, cell=cell, degree=degree
    )
    section = fl.ShellSection.layer(THICKNESS, fl.Material(YOUNG, nu, 2700.0))
    return fl.Shell(mesh, section, formulation=formulation, along=(1, 0, 0), name="strip")


def strip(*options, **named):
    """Such a strip and its scene, held at the plane x = 0 without stress."""
    scene, shell = fl.Scene(), sheet(*options, **named)
    scene.add(shell)
    shell.symmetry("a=0", normal=(1, 0, 0))
    for name, axis in (("00", (0, 1, 0)), ("00", (0, 0, 1)), ("01", (0, 0, 1))):
        scene.add(fl.joints.InPlane(fl.ground(), shell.point(name), axis=axis))
    return scene, shell


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_free_shell_expands_without_stress(element):
    scene, shell = strip(element)
    scene.add(fl.loads.Temperature(shell, RISE, EXPANSION))
    result = fl.statics(scene)
    moved = result.displacement(shell.point("11"))[-1]
    np.testing.assert_allclose(moved, [LONGER, LONGER * WIDTH, 0.0], atol=1e-8 * LONGER)
    stress = fl.post.resultants(result, shell, scene=scene)
    assert abs(stress.at_points[..., :3]).max() < 1e-7 * YOUNG * THICKNESS * LONGER


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_shell_bends_to_a_cylinder_without_stress(element):
    """Of any stress-free curvature about one axis, with the order of the chords."""
    scene, shell = strip(element)
    scene.add(fl.loads.Eigenstrain(shell, (0, 0, 0, 0.5, 0, 0, 0, 0)))
    x, _, z = fl.statics(scene).position(shell.point("10"))[-1]
    np.testing.assert_allclose([x, -z], [2 * np.sin(0.5), 2 * (1 - np.cos(0.5))], rtol=4e-4)


def test_a_temperature_gradient_bends_a_shell_to_a_sphere():
    """The warmer side, to which the director points, is outside."""
    scene, shell = strip(cells=(20, 4))
    scene.add(fl.loads.Temperature(shell, 0.0, EXPANSION, gradient=1e3))
    result = fl.statics(scene)
    radius = 1 / (EXPANSION * 1e3)
    across = [result.position(shell.point(name))[-1] for name in ("10", "11")]
    np.testing.assert_allclose(np.mean(across, axis=0)[2], -0.5 / radius, rtol=0.02)
    assert across[0][2] < 0.0


@pytest.mark.parametrize("element", ["Hellinger-Reissner", "MITC4"])
def test_a_clamped_plate_is_under_the_stress_of_its_expansion(element):
    scene, shell = fl.Scene(), sheet(element)
    for edge in ("a=1", "b=0", "b=1", "a=0"):
        shell.clamp(edge)
    scene.add(shell)
    scene.add(fl.loads.Temperature(shell, RISE, EXPANSION, gradient=200.0))
    stress = fl.post.resultants(fl.statics(scene), shell, scene=scene)
    N = -YOUNG * THICKNESS / 0.7 * (LONGER + LONGER**2 / 2)
    M = -YOUNG * THICKNESS**3 / 12 / 0.7 * (1 + LONGER) * EXPANSION * 200.0
    expected = np.array([N, N, 0, M, M, 0, 0, 0])
    given = np.broadcast_to(expected, stress.at_points.shape)
    np.testing.assert_allclose(stress.at_points, given, atol=1e-9 * abs(N))


def test_a_heated_strip_buckles_between_clamps():
    """At α ΔT = 4 π² D/(E t L²), without transverse contraction."""
    scene, shell = fl.Scene(), sheet(cells=(24, 1), nu=0.0)
    scene.add(shell)
    shell.clamp("a=1")
    shell.clamp("a=0")
    critical = np.pi**2 * THICKNESS**2 / 3
    scene.add(fl.loads.Temperature(shell, critical / EXPANSION, EXPANSION))
    with pytest.warns(fl.stability.UnstableEquilibriumWarning):
        result = fl.statics(scene, levels=(0.97, 1.03))
    np.testing.assert_array_equal(result.negative_pivots > 0, [False, True])


def test_prestress_tunes_a_strip():
    """A taut strip has the frequencies of a string, with a small correction by its bending."""
    scene, shell = fl.Scene(), sheet(cells=(24, 1), nu=0.0)
    scene.add(shell)
    for edge in ("a=0", "a=1"):
        shell.hinge(edge)
    tension = 1e6
    scene.add(fl.loads.PreStress(shell, (tension, 0, 0, 0, 0, 0, 0, 0)))
    found = fl.vibrations(scene, 1, at=fl.statics(scene)).frequencies[0]
    bending = np.pi**2 * YOUNG * THICKNESS**3 / 12
    exact = np.pi * np.sqrt((tension + bending) / (2700.0 * THICKNESS))
    np.testing.assert_allclose(found, exact, rtol=3e-3)


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.GeneralisedAlpha()])
def test_a_sudden_gradient_starts_an_oscillation_that_resumes(scheme, tmp_path):
    """Energy is conserved where the scheme does so; waves in the plane are not resolved."""
    file, options = tmp_path / "run.h5", {"duration": 2e-3, "step": 1e-4}

    def heated(rise=0.0):
        scene, shell = strip(cells=(4, 1))
        scene.add(fl.loads.Temperature(shell, rise, EXPANSION, gradient=200.0))
        return scene

    result = scheme.run(heated(), **options, file=file, checkpoint_every=10)
    again = scheme.resume(heated(), file)
    np.testing.assert_array_equal(again.frames, result.frames)
    assert np.ptp(result.kinetic) > 0.03 * result.elastic[0] > 0.0
    if isinstance(scheme, fl.EnergyMomentum):
        assert result.balance_error < 1e-8
    assert fl.Result.load(file).info.strained == ("strip",)
    with pytest.raises(ValueError, match="rise of load 1"):
        replace(scheme).resume(heated(1.0), file)


def test_what_is_not_possible_is_refused():
    scene, shell = strip()
    scene.add(fl.loads.Temperature(shell, RISE, EXPANSION))
    result = fl.statics(scene)
    with pytest.raises(ValueError, match=r"stresses need scene=.*strip has stress-free"):
        fl.post.resultants(result, shell)
    with pytest.raises(ValueError, match="errors of shells cannot be estimated: strip has"):
        fl.adaptivity.space_error(result, shell, scene)
    section = fl.ShellSection.layer(0.1, fl.Material(1e9, 0.3, 1.0))
    geodesic = fl.Shell(shell.model.mesh, section, formulation=fl.elements.GeodesicShell())
    with pytest.raises(ValueError, match="not available for GeodesicShell: use Hellinger"):
        fl.loads.Temperature(geodesic, RISE, EXPANSION)
    for load, message in (
        (fl.loads.Temperature(shell, RISE, EXPANSION, gradient=(1, 2)), "gradient of the Temp"),
        (fl.loads.Eigenstrain(shell, (1e-3, 0, 0)), "strain of the Eigenstrain on strip must be 8"),
    ):
        wrong = fl.Scene()
        wrong.add(shell)
        with pytest.raises((TypeError, ValueError), match=message):
            wrong.add(load)
