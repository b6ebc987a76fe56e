"""Whirl of rotors in the fixed frame: closed forms, damping in and about the rotor, wrong uses."""

import numpy as np
import pytest

import fem_lie as fl
from demos.reference.whirling_shaft import massless
from demos.whirl import ACROSS, EI, MASS, POLAR, rotor
from fem_lie.stability import CampbellDiagram, Unbalance, campbell, unbalance_response

X = (1.0, 0.0, 0.0)
DISC = MASS, POLAR, ACROSS


def overhung(*, damping: fl.sections.Damping | None = None, stiffness=(EI, EI)):
    """A short scene of the same rotor, with its disc."""
    section = fl.Section.from_stiffness([1e7] * 3 + [EI, *stiffness], mass=1e-3, polar=2e-9)
    shaft = fl.Rod.straight((0, 0, 0), X, section, cells=4, damping=damping, name="shaft")
    disc = fl.RigidBody(MASS, (POLAR, ACROSS, ACROSS), position=X, name="disc")
    scene = fl.Scene()
    for item in (shaft, disc, fl.joints.RigidLink(shaft.point("end"), disc.point("centre"))):
        scene.add(item)
    scene.add(fl.Clamp(shaft.point("start")))
    return scene, shaft, disc


@pytest.mark.parametrize("name", ["overhung", "jeffcott"])
def test_a_shaft_without_mass(name):
    """Second-order polynomials in the whirl frequency and the speed."""
    scene, _, exact = rotor(name, 1e-7, 16)
    speeds = np.array([0.0, 0.3, 0.8, 1.7, 4.0]) * exact.whirl([0.0], 1, 1)[0, 0]
    found = campbell(scene, X, speeds)
    both = np.sort(np.concatenate([found.forward.imag, found.backward.imag], axis=1), axis=1)
    expected = [massless(EI, DISC, speed, name == "overhung") for speed in speeds]
    np.testing.assert_allclose(both, expected, rtol=1e-6)
    assert np.abs(found.forward.real).max() < 1e-8
    assert not found.unstable.any()
    k = 48.0 if name == "jeffcott" else None
    if k is not None:
        np.testing.assert_allclose(found.critical_speeds[0], np.sqrt(k * EI / MASS), rtol=1e-6)


def test_the_axis_has_any_direction_and_the_sense_of_the_spin_counts():
    """Reversed, forward whirl is what was backward only in space: frequencies are equal."""
    scene, _, _ = overhung()
    there = campbell(scene, X, [30.0])
    back = campbell(scene, (-2.0, 0.0, 0.0), [30.0], about=(0.3, 0.0, 0.0))
    np.testing.assert_allclose(there.forward, back.forward, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(there.backward, back.backward, rtol=1e-9, atol=1e-9)
    assert (there.forward.imag > -there.backward.imag).all()


def test_friction_in_the_shaft_makes_it_unstable_above_the_critical_speed():
    """Internal damping: F. Kimball 1924. Friction in space never does."""
    inside, _, _ = overhung(damping=fl.sections.Damping(stiffness=1e-4))
    critical = campbell(overhung()[0], X, [10.0, 30.0], 1).critical_speeds[0]
    speeds = np.array([0.0, 0.97, 1.03, 2.0]) * critical
    found = campbell(inside, X, speeds, 1)
    assert found.unstable.tolist() == [False, False, True, True]
    assert (found.backward.real < 0).all()
    np.testing.assert_allclose(found.critical_speeds, [critical], rtol=1e-4)
    outside, _, _ = overhung(damping=fl.sections.Damping(mass=100.0))
    assert not campbell(outside, X, speeds, 1).unstable.any()


def test_few_lines_are_the_first_of_many():
    scene, _, _ = overhung()
    few, many = campbell(scene, X, [40.0], 1), campbell(scene, X, [40.0], 4)
    np.testing.assert_allclose(few.forward, many.forward[:, :1], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(few.backward, many.backward[:, :1], rtol=1e-8, atol=1e-8)


def test_an_unbalance_in_any_direction_of_a_rotor_without_damping():
    """A spring of 3 EI/L³ with a disc that does not tilt: e W²/(w² − W²)."""
    body = fl.RigidBody(2.0, (0.1, 0.1, 0.1), name="disc")
    scene = fl.Scene()
    scene.add(body)
    centre = body.point("centre")
    section = fl.Section.from_stiffness([1e4, 1e4, 1e4, 1e4, 1e4, 1e4], mass=1e-6, polar=1e-7)
    for end in ((-1.0, 0, 0), (1.0, 0, 0)):
        wire = scene.add(fl.Rod.straight(end, (0, 0, 0), section, cells=4))
        scene.add(fl.Clamp(wire.point("start")))
        scene.add(fl.joints.RigidLink(centre, wire.point("end")))
    stiffness, speeds = 2 * 12 * 1e4, np.array([0.0, 100.0, 500.0])
    eccentricity = np.array([0.0, 3e-6, 4e-6])
    unbalances = [Unbalance(centre, 2.0 * eccentricity * [0, 1, 0])]
    unbalances.append(Unbalance(centre, 2.0 * eccentricity * [0, 0, 1]))
    found = unbalance_response(scene, X, unbalances, speeds).displacement("disc.centre")
    size = speeds**2 / (stiffness / 2.0 - speeds**2)
    turned = np.cross(X, eccentricity)
    expected = size[:, np.newaxis] * (eccentricity - 1j * turned)
    np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


def test_it_is_saved_tabled_and_drawn(tmp_path):
    scene, _, _ = overhung()
    found = campbell(scene, X, [0.0, 10.0, 30.0], 1)
    found.save(tmp_path / "campbell.h5")
    again = CampbellDiagram.load(tmp_path / "campbell.h5")
    np.testing.assert_array_equal(again.forward, found.forward)
    np.testing.assert_array_equal(again.critical_speeds, found.critical_speeds)
    assert str(again) == str(found) and "critical speeds: 17.7" in str(found)
    found.write_csv(tmp_path / "campbell.csv")
    read = np.genfromtxt(tmp_path / "campbell.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(read["forward_1_frequency"], found.forward[:, 0].imag)
    np.testing.assert_array_equal(read["backward_1_growth"], found.backward[:, 0].real)
    axes = found.picture(tmp_path / "campbell.png").axes[0]
    assert (tmp_path / "campbell.png").stat().st_size > 10_000
    assert [line.get_label() for line in axes.lines][-2:] == ["synchronous", "critical"]


def elliptic():
    return overhung(stiffness=(EI, 1.1 * EI))


def blade() -> fl.Scene:
    scene, _, _ = overhung()
    scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), position=(0.5, 0.2, 0.0)))
    return scene


def damped_bearing() -> fl.Scene:
    scene, shaft, _ = overhung()
    joint = scene.add(fl.joints.Distance(fl.ground(), shaft.point("end"), at=(1.0, 1.0, 0.0)))
    scene.add(fl.joints.Spring(joint.length, damping=1.0))
    return scene


def free() -> fl.Scene:
    section = fl.Section.circle(0.01, fl.Material(2e11, 0.3, 7800.0))
    scene = fl.Scene()
    scene.add(fl.Rod.straight((0, 0, 0), X, section, cells=4))
    return scene


def heavy() -> fl.Scene:
    scene, _, _ = overhung()
    return scene.with_loads(gravity=(0.0, 0.0, -9.81))


def in_balls() -> tuple[fl.Scene, fl.RigidBody]:
    """A bearing in which the shaft rotates freely about its axis."""
    section = fl.Section.from_stiffness([1e7] * 3 + [EI] * 3, mass=1.0, polar=2e-6)
    shaft = fl.Rod.straight((0, 0, 0), X, section, cells=4)
    scene = fl.Scene()
    scene.add(shaft)
    scene.add(fl.joints.Spherical(fl.ground(), shaft.point("start")))
    for axis in np.eye(3)[1:]:
        scene.add(fl.joints.InPlane(fl.ground(), shaft.point("end"), axis=axis))
    return scene, shaft


def test_a_shaft_that_rotates_freely_whirls_but_needs_a_hold_for_its_unbalance():
    scene, shaft = in_balls()
    found = campbell(scene, X, [0.0], 1)
    np.testing.assert_allclose(found.forward.imag, np.pi**2 * np.sqrt(EI), rtol=1e-3)
    unbalance = Unbalance(shaft.point(2), (0, 1e-5, 0))
    with pytest.raises(fl.ConvergenceError, match="free to move along or about its axis"):
        unbalance_response(scene, X, unbalance, [10.0])


WRONG = {
    "elliptic": (lambda: campbell(elliptic()[0], X, [0.0]), "no circular motion"),
    "elliptic fast": (lambda: campbell(elliptic()[0], X, [30.0]), "no circular motion"),
    "blade": (lambda: campbell(blade(), X, [0.0]), "all nodes on its axis"),
    "other axis": (lambda: campbell(overhung()[0], (0, 1, 0), [0.0]), "all nodes on its axis"),
    "bearing": (lambda: campbell(damped_bearing(), X, [0.0]), "damps the motion between the rotor"),
    "free": (lambda: campbell(free(), X, [0.0]), "moves freely across its axis"),
    "free spinning": (lambda: campbell(free(), X, [10.0]), "moves freely across its axis"),
    "gravity": (lambda: campbell(heavy(), X, [0.0]), "gravity is fixed in space"),
    "negative": (lambda: campbell(overhung()[0], X, [-1.0]), "angular velocities ≥ 0"),
    "descending": (lambda: campbell(overhung()[0], X, [2.0, 1.0]), "ascending"),
    "no speed": (lambda: campbell(overhung()[0], X, []), "angular velocities ≥ 0"),
    "pairs": (lambda: campbell(overhung()[0], X, [0.0], 500), "pairs must be 1 … "),
    "no pairs": (lambda: campbell(overhung()[0], X, [0.0], 0), "pairs"),
    "no axis": (lambda: campbell(overhung()[0], (0, 0, 0), [0.0]), "axis"),
    "empty": (lambda: campbell(fl.Scene(), X, [0.0]), "the scene has no body"),
    "ground": (lambda: Unbalance(fl.ground(), (0, 1, 0)), "got ground"),
    "balanced": (lambda: Unbalance(overhung()[2].point("centre"), (0, 0, 0)), "must not be zero"),
}


@pytest.mark.parametrize("use", WRONG)
def test_wrong_uses(use):
    call, message = WRONG[use]
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize(
    ("made", "moment", "message"),
    [
        (overhung, (1.0, 0.0, 0.0), "across the axis"),
        (elliptic, (0.0, 1.0, 0.0), "bends differently"),
    ],
)
def test_wrong_unbalances(made, moment, message):
    scene, _, disc = made()
    with pytest.raises(ValueError, match=message):
        unbalance_response(scene, X, Unbalance(disc.point("centre"), moment), [10.0])
    with pytest.raises(ValueError, match="got none"):
        unbalance_response(scene, X, [], [10.0])
