"""Stress-free strains of solids: temperature and eigenstrain."""

from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl

YOUNG, EXPANSION, RISE = 7e10, 2e-5, 50.0
LONGER = EXPANSION * RISE
LENGTHS = np.array([1.0, 0.2, 0.1])
LINEAR, NEO = fl.sections.SaintVenantKirchhoff, fl.sections.NeoHooke
TIGHT = fl.schemes.Newton(tolerance=1e-13)
ELEMENTS = {
    "hexahedra": (LINEAR, {}),
    "second order": (NEO, {"cell": "tetrahedron", "degree": 2}),
}


def block(law=LINEAR, *, lengths=LENGTHS, cells=(2, 1, 1), nu=0.3, young=YOUNG, **options):
    """A block along x, held at three planes without stress, and its scene."""
    scene = fl.Scene()
    solid = fl.Solid.brick(lengths, law(young, nu, 2700.0), cells=cells, name="block", **options)
    for face, axis in zip(("a=0", "b=0", "c=0"), np.eye(3), strict=True):
        solid.roller(face, normal=axis)
    scene.add(solid)
    return scene, solid


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_free_solid_expands_without_stress(element):
    law, options = ELEMENTS[element]
    scene, solid = block(law, **options)
    scene.add(fl.loads.Temperature(solid, RISE, EXPANSION))
    result = fl.statics(scene, newton=TIGHT)
    moved = result.displacement(solid.point("111"))[-1]
    np.testing.assert_allclose(moved, LONGER * LENGTHS, rtol=1e-10)
    stress = fl.post.solid_stresses(result, solid, scene=scene)
    assert abs(stress.at_points).max() < 1e-9 * YOUNG * LONGER
    assert abs(stress.mean("xx")).max() < 1e-9 * YOUNG * LONGER


def test_a_stress_free_strain_of_any_direction():
    """Its components are along the global axes, those of shears twice that of the tensor."""
    given = np.array([0.05, -0.1, 0.02, 0.04, -0.06, 0.08])
    solid = fl.Solid.brick(LENGTHS, LINEAR(YOUNG, 0.3), cells=(2, 1, 1))
    scene = fl.Scene()
    scene.add(solid)
    for name, axes in (("000", np.eye(3)), ("100", np.eye(3)[1:]), ("010", np.eye(3)[2:])):
        for axis in axes:
            scene.add(fl.joints.InPlane(fl.ground(), solid.point(name), axis=axis))
    scene.add(fl.loads.Eigenstrain(solid, given))
    result = fl.statics(scene, newton=TIGHT)
    corners = [result.position(solid.point(name))[-1] for name in ("000", "100", "010", "001")]
    F = ((np.array(corners[1:]) - corners[0]) / LENGTHS[:, np.newaxis]).T
    strain = (F.T @ F - np.eye(3)) / 2
    expected = [*np.diag(strain), 2 * strain[0, 1], 2 * strain[0, 2], 2 * strain[1, 2]]
    np.testing.assert_allclose(expected, given, atol=1e-9)


def test_a_bar_between_walls_is_under_the_stress_of_its_expansion():
    """``N = −E A α ΔT`` to first order; the stress is that of the stretch ``1/(1 + α ΔT)``."""
    scene, solid = block()
    solid.roller("a=1", normal=(1, 0, 0))
    scene.add(fl.loads.Temperature(solid, RISE, EXPANSION))
    result = fl.statics(scene, newton=TIGHT)
    stress = fl.post.solid_stresses(result, solid, scene=scene).at_points
    stretch = 1 / (1 + LONGER)
    strain = (stretch**2 - 1) / 2
    expected = np.zeros((3, 3))
    expected[0, 0] = YOUNG * strain * stretch / (1 - 2 * 0.3 * strain)
    np.testing.assert_allclose(stress - expected, 0.0, atol=1e-9 * YOUNG * LONGER)
    force = sum(result.reaction(point)[-1][0] for point in solid.points("a=0"))
    area = LENGTHS[1] * LENGTHS[2]
    np.testing.assert_allclose(force, YOUNG * area * LONGER, rtol=3 * LONGER)


def test_an_expanded_solid_is_as_a_larger_one():
    """Of the same material, under the same dead load, in one family of scenes."""
    grown, pull = 0.3, 1e9

    def moved(lengths, **expansion):
        scene, solid = block(NEO, lengths=lengths, cell="tetrahedron", degree=2)
        first = scene.with_loads(fl.loads.FaceLoad(solid, "a=1", (pull, 0, 0)))
        fl.statics(first)
        if not expansion:
            return fl.statics(first, newton=TIGHT).position(solid.point("111"))[-1]
        # the same force on the unloaded face
        loads = fl.loads.FaceLoad(solid, "a=1", (pull * (1 + grown) ** 2, 0, 0))
        warm = fl.loads.Temperature(solid, **expansion)
        found = fl.statics(scene.with_loads(loads, warm), newton=TIGHT)
        return found.position(solid.point("111"))[-1]

    np.testing.assert_allclose(
        moved(LENGTHS, rise=grown, expansion=1.0), moved((1 + grown) * LENGTHS), rtol=1e-8
    )


def test_a_strip_of_two_metals_bends_as_timoshenko_found():
    """Timoshenko, J. Opt. Soc. Am. 11 (1925) 233, for layers of equal thickness."""
    mesh = fl.mesh.brick((1.0, 0.02, 0.05), (16, 1, 2), cell="tetrahedron")
    points = mesh.mesh.geometry.x[mesh.mesh.geometry.dofmap]
    upper = points[..., 2].mean(axis=1) > 0.025
    groups = {"upper": np.flatnonzero(upper), "lower": np.flatnonzero(~upper)}
    mesh, ratio = replace(mesh, groups=groups), 2.0
    metals = {"upper": NEO(YOUNG, 0.0, 1.0), "lower": NEO(ratio * YOUNG, 0.0, 1.0)}
    strip, scene = fl.Solid(mesh, metals, degree=2), fl.Scene()
    for face, axis in (("a=0", (1, 0, 0)), ("b=0", (0, 1, 0))):
        strip.roller(face, normal=axis)
    scene.add(strip)
    scene.add(fl.joints.InPlane(fl.ground(), strip.point("000"), axis=(0, 0, 1)))
    scene.add(fl.loads.Temperature(strip, RISE, EXPANSION, cells="lower"))
    found = fl.statics(scene).displacement(strip.point("100"))[-1]
    curvature = 24 * LONGER / (0.05 * (14 + ratio + 1 / ratio))
    np.testing.assert_allclose(found[2], (1 - np.cos(curvature)) / curvature, rtol=0.02)


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.GeneralisedAlpha()])
def test_a_sudden_temperature_starts_an_oscillation_that_resumes(scheme, tmp_path):
    """Energy is conserved where the scheme does so, also while the temperature rises."""
    file, options = tmp_path / "run.h5", {"duration": 4e-4, "step": 2e-5}

    def heated(history=None):
        scene, solid = block(nu=0.0)
        scene.add(fl.loads.Temperature(solid, RISE, EXPANSION))
        scene.add(fl.loads.Eigenstrain(solid, (LONGER, 0, 0, 0, 0, 0), history=history))
        return scene

    result = scheme.run(heated(), **options, file=file, checkpoint_every=10)
    np.testing.assert_array_equal(scheme.resume(heated(), file).frames, result.frames)
    assert np.ptp(result.kinetic) > 0.3 * result.elastic[0] > 0.0
    rising = scheme.run(heated(lambda t: 1e3 * t), **options)
    if isinstance(scheme, fl.EnergyMomentum):
        assert max(result.balance_error, rising.balance_error) < 1e-8
    assert fl.Result.load(file).info.strained == ("block",)


def test_what_is_not_possible_is_refused():
    scene, solid = block()
    with pytest.raises(TypeError, match="PreStress: loaded must be a Beam or a Shell"):
        fl.loads.PreStress(solid, (1e6, 0, 0, 0, 0, 0))
    for load, message in (
        (fl.loads.Temperature(solid, RISE, EXPANSION, gradient=1.0), "which a Solid does not have"),
        (fl.loads.Eigenstrain(solid, (1e-3, 0, 0)), "strain of the Eigenstrain on block must be 6"),
        (fl.loads.Eigenstrain(solid, (-0.5, 0, 0, 0, 0, 0)), "block must be that of a stretch"),
    ):
        with pytest.raises(ValueError, match=message):
            scene.add(load)
    scene.add(fl.loads.Temperature(solid, RISE, EXPANSION))
    result = fl.statics(scene)
    with pytest.raises(ValueError, match=r"stresses need scene=.*block has stress-free"):
        fl.post.solid_stresses(result, solid)
    with pytest.raises(ValueError, match="errors of solids cannot be estimated: block has"):
        fl.adaptivity.space_error(result, solid, scene)
