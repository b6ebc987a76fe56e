"""Slow modes beside rigid ones: what is zero is zero, and what is soft has its frequency."""

import numpy as np
import pytest

import fem_lie as fl
from tests.unit_systems import METRES, UNIT_SYSTEMS, UnitSystem

X = (1.0, 0.0, 0.0)


def rod(u: UnitSystem, cells: int, formulation: fl.elements.BeamFormulation | None = None) -> tuple:
    """One metre of steel, 10 × 10 mm: a mass of 0.78 kg."""
    steel = fl.Material(u.stress(2e11), 0.3, u.density(7800.0))
    section = fl.Section.rectangle(u.length(0.01), u.length(0.01), steel)
    scene, ends = fl.Scene(), (u.length([0, 0, 0]), u.length([1, 0, 0]))
    options = {} if formulation is None else {"formulation": formulation}
    return scene, scene.add(fl.Beam.straight(*ends, section, cells=cells, **options))


SPRINGS = [(10, k, u) for k in (1.0, 1e-3, 1e-6) for u in UNIT_SYSTEMS]
SPRINGS += [(400, k, METRES) for k in (10.0, 1e-3)]


@pytest.mark.parametrize(("cells", "k", "u"), SPRINGS, ids=str)
def test_a_rod_on_a_soft_spring_swings(cells, k, u):
    """It slides along its axis: √(k/m), however stiff its elements are."""
    scene, beam = rod(u, cells)
    slide = scene.add(fl.joints.Prismatic(fl.ground(), beam.point("start"), axis=X))
    scene.add(fl.joints.Spring(slide.displacement, stiffness=u.stiffness(k)))
    found = u.inverse.rate(fl.vibrations(scene, 2).frequencies)
    assert found[0] == pytest.approx(np.sqrt(k / 0.78), rel=1e-6)
    assert found[1] > 10.0


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
@pytest.mark.parametrize(
    "formulation",
    [
        fl.elements.GeodesicBeam(),
        fl.elements.DirectorBeam(1),
        fl.elements.DirectorBeam(2),
        fl.elements.KirchhoffRod(),
    ],
)
def test_a_free_rod_has_six_zeros_and_no_more(formulation, u):
    scene, _ = rod(u, 16, formulation)
    modes = fl.vibrations(scene, 8)
    found = u.inverse.rate(modes.frequencies)
    assert (modes.eigenvalues[:6] == 0.0).all()
    # 22.3733 √(EI/(ρ A L⁴))
    assert found[6] == pytest.approx(22.3733 * np.sqrt(2e11 * 1e-8 / 12 / 0.78), rel=5e-3)


def test_slow_modes_beside_zeros():
    """Two springs of different softness on a rod that is free otherwise: four zeros beside."""
    k = 1e-4
    scene, beam = rod(METRES, 20)
    for end, factor in ((beam.point("start"), 1.0), (beam.point("end"), 4.0)):
        far = end.position + np.array([0.0, 1.0, 0.0])
        joint = fl.joints.Distance(fl.ground(), end, at=far)
        scene.add(fl.joints.Spring(joint.length, stiffness=factor * k))
    modes = fl.vibrations(scene, 7)
    # in the plane: displacement y and turn about z of a rigid rod
    m, J = 0.78, 0.78 / 12
    K = k * np.array([[5.0, 1.5], [1.5, 1.25]])
    expected = np.sqrt(np.linalg.eigvals(K / np.array([m, J])[:, np.newaxis]))
    assert (modes.eigenvalues[:4] == 0.0).all()
    np.testing.assert_allclose(modes.frequencies[4:6], np.sort(expected), rtol=1e-4)
    assert modes.frequencies[6] > 100.0


def test_a_damped_slow_mode():
    """``m ẍ + c ẋ + k x``: eigenvalue and damping ratio."""
    k, c, m = 1e-3, 2e-3, 0.78
    scene, beam = rod(METRES, 10)
    slide = scene.add(fl.joints.Prismatic(fl.ground(), beam.point("start"), axis=X))
    scene.add(fl.joints.Spring(slide.displacement, stiffness=k, damping=c))
    modes = fl.vibrations(scene, 2)
    expected = -c / (2 * m) + 1j * np.sqrt(k / m - (c / (2 * m)) ** 2)
    assert modes.eigenvalues[0] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
def test_what_is_left_free_is_counted(u):
    """A free beam has six motions, on a hinge one."""
    for joint, message in (
        (None, "6 rigid motions"),
        (fl.joints.Revolute, "1 rigid motion"),
    ):
        scene, beam = rod(u, 4)
        if joint is not None:
            scene.add(joint(fl.ground(), beam.point("start"), axis=(0, 0, 1)))
        scene.add(fl.PointLoad(beam.point("end"), force=u.force([1.0, 0, 0])))
        with pytest.raises(ValueError, match=f"singular: nothing resists {message} of beam 1"):
            fl.follow_path(scene)


def test_frequencies_say_in_which_units_they_are():
    scene, _ = rod(METRES, 4)
    modes = fl.vibrations(scene, 7)
    assert "[rad/s]       [Hz]  damping" in modes.table()
    assert "[rad/ms]  [cycles/ms]  damping" in modes.table(units=fl.post.Units(time="ms"))
