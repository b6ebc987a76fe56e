"""Loss of stability under loads without a potential, and with one."""

import numpy as np
import pytest

import fem_lie as fl
from demos.flutter import EXACT, column
from fem_lie.stability import Instability, StabilityLimit, flutter


def compressed(following: bool, **options) -> fl.Scene:
    scene, rod = column(8, 4.0, **options)
    load = fl.PointLoad(rod.point("end"), force=(-1.0, 0, 0), following=True)
    return scene.with_loads(load if following else fl.PointLoad(rod.point("end"), (0, 0, -1.0)))


@pytest.mark.parametrize("unit", [pytest.param(1e-3, marks=pytest.mark.slow), 1e5])
def test_becks_column_in_any_unit_of_the_load(unit):
    scene, rod = column(8, 4.0)
    load = fl.PointLoad(rod.point("end"), force=(-unit, 0, 0), following=True)
    found = flutter(scene.with_loads(load), 4)
    assert found.instability is Instability.FLUTTER
    assert abs(unit * found.factor / EXACT["beck"] - 1) < 1e-3
    assert abs(found.frequency / 11.016 - 1) < 1e-3


def test_a_dead_load_makes_the_column_diverge():
    found = flutter(compressed(False), 4)
    assert found.instability is Instability.DIVERGENCE and found.frequency == 0.0
    assert abs(found.factor / (np.pi**2 / 4) - 1) < 1e-4


@pytest.mark.slow
def test_small_damping_lowers_the_load_of_flutter():
    """Ziegler's paradox: internal damping, however small, destabilises; V. Bolotin 1963."""
    section = fl.Section.from_stiffness([1e6] * 4 + [1.0, 4.0], mass=1.0, polar=1e-6)
    damping = fl.sections.Damping(stiffness=(0, 0, 0, 0, 1e-3, 1e-3))
    rod = fl.Rod.straight((0, 0, 0), (0, 0, 1), section, cells=8, damping=damping)
    scene = fl.Scene()
    scene.add(rod)
    scene.add(fl.Clamp(rod.point("start")))
    scene.add(fl.PointLoad(rod.point("end"), force=(-1.0, 0, 0), following=True))
    assert abs(flutter(scene, 4).factor / 10.94 - 1) < 2e-3


def test_zieglers_pendulum_of_two_degrees_of_freedom():
    """H. Ziegler 1952: masses 2m and m, equal springs: (7/2 − √2) k/l; two modes by default."""
    scene, small = fl.Scene(), (1e-6,) * 3
    first = scene.add(fl.RigidBody(2.0, small, position=(1, 0, 0), name="first"))
    second = scene.add(fl.RigidBody(1.0, small, position=(2, 0, 0), name="second"))
    points = fl.ground(), first.point("centre"), second.point("centre")
    for k in range(2):
        hinge = fl.joints.Revolute(points[k], points[k + 1], at=(k, 0, 0), axis=(0, 0, 1))
        scene.add(hinge)
        scene.add(fl.joints.Spring(hinge.angle, 1.0))
    scene.add(fl.PointLoad(second.point("centre"), force=(-1, 0, 0), following=True))
    found = flutter(scene)
    assert found.instability is Instability.FLUTTER
    assert abs(found.factor / (3.5 - np.sqrt(2)) - 1) < 1e-5
    assert len(fl.vibrations(scene)) == 2


def test_it_is_saved(tmp_path):
    found = flutter(compressed(True), 4)
    found.save(tmp_path / "flutter.h5")
    again = StabilityLimit.load(tmp_path / "flutter.h5")
    assert str(again) == str(found) and str(found).startswith("flutter at load factor 20.0")
    np.testing.assert_array_equal(again.eigenvalues, found.eigenvalues)
    assert (np.diff(found.factors) > 0).all()
    assert (found.eigenvalues[:-1].real <= 1e-4).all() and found.eigenvalues[-1].real.max() > 0


def test_buckling_refuses_it_and_names_the_way():
    with pytest.raises(ValueError, match=r"fl\.stability\.flutter"):
        fl.buckling(compressed(True), 1)


def moved() -> fl.Scene:
    scene, rod = column(4, 4.0)
    scene.add(fl.PointLoad(rod.point("end"), (-1.0, 0, 0), following=True, history=np.sin))
    return scene


def loose() -> fl.Scene:
    scene, rod = column(4, 4.0)
    scene.clamps.clear()
    return scene.with_loads(fl.PointLoad(rod.point("end"), (-1.0, 0, 0), following=True))


WRONG = {
    "history": (lambda: flutter(moved()), ValueError, "in proportion to the load factor"),
    "no load": (lambda: flutter(column(4, 4.0)[0]), ValueError, "load"),
    "loose": (lambda: flutter(loose()), ValueError, "singular"),
    "until": (lambda: flutter(compressed(True), until=-1.0), ValueError, "until"),
    "count": (lambda: flutter(compressed(True), 500), ValueError, "count must be 1"),
    "early": (lambda: flutter(compressed(True), until=5.0), fl.ConvergenceError, "stable up to"),
}


@pytest.mark.parametrize("use", WRONG)
def test_wrong_uses(use):
    call, kind, message = WRONG[use]
    with pytest.raises(kind, match=message):
        call()
