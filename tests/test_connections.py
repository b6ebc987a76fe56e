"""Joints, springs, drives and gears in motion, against closed forms."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from tests.assembled import Assembled

Z = (0, 0, 1)
SCHEME = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)


def body(scene: fl.Scene, position=(0, 0, 0), inertia=(0.1, 0.2, 0.3), mass=2.0) -> fl.RigidBody:
    return scene.add(fl.RigidBody(mass, inertia, position))


def test_a_nut_falls_on_its_thread():
    """m a = −m g + F, J α = −F p/2π, a = α p/2π."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    nut = body(scene)
    screw = scene.add(fl.joints.Screw(fl.ground(), nut.point("centre"), axis=Z, pitch=0.5))
    result = SCHEME.run(scene, duration=2.0, step=1e-2)
    lead = 0.5 / (2 * np.pi)
    a = -9.81 * 2.0 * lead**2 / (2.0 * lead**2 + 0.3)
    # constant accelerations are exact in generalised-α, many turns are counted
    np.testing.assert_allclose(
        result.coordinate(screw, "displacement"), 0.5 * a * result.times**2, atol=1e-8
    )
    angle = result.coordinate(screw, "angle")
    assert angle[-1] < -3 * np.pi
    np.testing.assert_allclose(angle * lead, result.coordinate(screw, "displacement"), atol=1e-9)
    assert result.energy_error < 1e-9


def test_wheels_on_a_gear_turn_against_each_other():
    """The torque of a weight rotates both wheels: inertia J₁ + J₂/i²; motor and rack, too."""
    scene = fl.Scene()
    one, two = body(scene), body(scene, (1, 0, 0), (0.3, 0.3, 0.5))
    first = scene.add(fl.joints.Revolute(fl.ground(), one.point("centre"), axis=Z))
    second = scene.add(fl.joints.Revolute(fl.ground(), two.point("centre"), axis=Z, name="second"))
    gear = scene.add(fl.joints.Gear(first.angle, second.angle, ratio=2.0))
    scene.add(fl.PointLoad(one.point("centre"), moment=(0, 0, 0.7)))
    result = SCHEME.run(scene, duration=3.0, step=1e-2)
    alpha = 0.7 / (0.3 + 0.5 / 4)
    turned = 0.5 * alpha * result.times**2
    np.testing.assert_allclose(result.coordinate(first), turned, rtol=0, atol=1e-7)
    np.testing.assert_allclose(result.coordinate("second"), -turned / 2, rtol=0, atol=1e-7)
    # on point a of the first joint acts what keeps the first wheel back
    moment = result.joint_force(gear)[5:, 5]
    np.testing.assert_allclose(moment, 0.7 - 0.3 * alpha, atol=1e-6)
    assert result.coordinate(gear, "angle").shape == result.times.shape


def test_a_pinion_drives_a_rack():
    """Angle and displacement on one gear: (J + m r²) α = M."""
    radius, moment = 0.2, 0.7
    scene = fl.Scene()
    pinion, rack = body(scene), body(scene, (0, radius, 0))
    wheel = scene.add(fl.joints.Revolute(fl.ground(), pinion.point("centre"), axis=Z))
    guide = scene.add(fl.joints.Prismatic(fl.ground(), rack.point("centre"), axis=(1, 0, 0)))
    gear = scene.add(fl.joints.Gear(wheel.angle, guide.displacement, ratio=1 / radius))
    scene.add(fl.PointLoad(pinion.point("centre"), moment=(0, 0, moment)))
    result = SCHEME.run(scene, duration=2.0, step=1e-2)
    turned = 0.5 * moment / (0.3 + 2.0 * radius**2) * result.times**2
    np.testing.assert_allclose(result.coordinate(wheel), turned, rtol=0, atol=1e-7)
    np.testing.assert_allclose(result.coordinate(guide), -radius * turned, rtol=0, atol=1e-7)
    for name, joint in (("angle", wheel), ("displacement", guide)):
        np.testing.assert_array_equal(result.coordinate(gear, name), result.coordinate(joint))


def test_a_gear_is_measured_by_its_first_coordinate():
    """The ratio converts the second coordinate, and depends on units."""
    scene = fl.Scene()
    one, two, three = body(scene), body(scene, (1, 0, 0)), body(scene, (2, 0, 0))
    wheel = scene.add(fl.joints.Revolute(fl.ground(), one.point("centre"), axis=Z))
    guide = scene.add(fl.joints.Prismatic(fl.ground(), two.point("centre"), axis=Z))
    scene.add(fl.joints.Screw(fl.ground(), three.point("centre"), axis=Z, pitch=0.1))
    scene.add(fl.joints.Gear(wheel.angle, guide.displacement, ratio=3e6))
    angular = fl.extend.Equations(scene, dynamics=True).unknowns.angular
    of_wheel, of_guide, of_screw = [0, 0, 0, 1, 1], [0, 0, 1, 1, 1], [0, 0, 1, 1, 0]
    assert angular.tolist() == [bool(k) for k in (*of_wheel, *of_guide, *of_screw, 1)]
    scene.connections[:] = [fl.joints.Gear(guide.displacement, wheel.angle, ratio=3e-6)]
    assert not fl.extend.Equations(scene, dynamics=True).unknowns.angular[-1]


def test_full_turns_are_history_variables():
    """A restored state has all of its full turns, and none of later ones."""
    scene = fl.Scene()
    wheel = body(scene)
    hinge = scene.add(fl.joints.Revolute(fl.ground(), wheel.point("centre"), axis=Z))
    scene.add(fl.joints.Spring(hinge.angle, stiffness=2.0))
    system = Assembled(scene, dynamics=True)
    equations = system.equations
    H = equations.start.frames.copy()

    def turn_to(*angles: float) -> None:
        for angle in angles:
            H[0, 1:] = lie.so3_exp(np.array([0, 0, angle])).T
            equations.history_variables.accept(H)

    turn_to(2.0, 4.0, 6.0)
    history = equations.history_variables.saved_state()
    turn_to(8.0, 10.0, 12.0)
    equations.history_variables.restore(history)
    turn_to(7.0)
    np.testing.assert_allclose(equations.report(H).joints.coordinates, 7.0, rtol=1e-12)
    assert system.residual(H)[5] == pytest.approx(2.0 * 7.0, rel=1e-12)


@pytest.mark.parametrize("index", fl.schemes.ConstraintIndex)
def test_shafts_on_a_universal_joint(index):
    """tan φ₂ = tan φ₁ / cos β with the first fork in the plane of the shafts, over two turns."""
    bend, speed = np.radians(30.0), 2 * np.pi
    scene = fl.Scene()
    axis = np.array([np.cos(bend), np.sin(bend), 0])
    one, two = body(scene, (-0.5, 0, 0)), body(scene, 0.5 * axis, (0.2,) * 3)
    first = scene.add(
        fl.joints.Revolute(fl.ground(), one.point("centre"), at=(-1, 0, 0), axis=(1, 0, 0))
    )
    # the axis fixed to the first shaft is across it and in the plane of both
    cross = fl.joints.Universal(
        one.point("centre"), two.point("centre"), at=(0, 0, 0), axis=(0, 1, 0), second=Z
    )
    scene.add(cross)
    # a bearing at the end of the second shaft that lets it slide
    for across in (Z, (-np.sin(bend), np.cos(bend), 0)):
        scene.add(fl.joints.InPlane(fl.ground(), two.point("centre"), at=axis, axis=across))
    scene.add(fl.joints.Drive(first.angle, lambda t: speed * t))
    one.add_velocity(omega=(speed, 0, 0), about=(0, 0, 0))
    two.add_velocity(omega=speed / np.cos(bend) * axis, about=(0, 0, 0))
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10, index=index)
    result = scheme.run(scene, duration=2.0, step=2e-3)
    phi = speed * result.times
    turns = np.round(phi / np.pi) * np.pi
    known = turns + np.arctan(np.tan(phi - turns) / np.cos(bend))
    arm = result.rotation(two.point("centre"))[:, :, 2]
    second = np.unwrap(np.arctan2(-arm @ np.cross(Z, axis), arm[:, 2]))
    np.testing.assert_allclose(second, known, rtol=0, atol=1e-8)
    swing = np.abs(result.coordinate(cross, "angle")).max()
    assert swing == pytest.approx(bend, abs=1e-4)


@pytest.mark.parametrize("name, axis", [("angle", Z), ("second angle", (1.0, 0.0, 0.0))])
def test_angles_of_a_universal_joint_are_right_handed(name, axis):
    """A ball that spins about one of the two axes changes that coordinate only."""
    scene = fl.Scene()
    ball = body(scene)
    joint = scene.add(
        fl.joints.Universal(fl.ground(), ball.point("centre"), axis=Z, second=(1.0, 0.0, 0.0))
    )
    ball.add_velocity(omega=2.0 * np.array(axis), about=ball.point("centre").position)
    result = SCHEME.run(scene, duration=0.1, step=0.01)
    for other in ("angle", "second angle"):
        expected = 0.2 if other == name else 0.0
        assert result.coordinate(joint, other)[-1] == pytest.approx(expected, abs=1e-9)


def test_springs_swing_and_dampers_damp():
    """Frequency √(k/m), decay c/2m, and a static displacement; the energy includes the spring."""
    k, c, m = 50.0, 0.8, 2.0
    scene = fl.Scene(gravity=(0, 0, -9.81))
    slide = scene.add(fl.joints.Prismatic(fl.ground(), body(scene, mass=m).point("centre"), axis=Z))
    spring = scene.add(fl.joints.Spring(slide.displacement, stiffness=k, damping=c, name="spring"))
    static = fl.statics(scene)
    assert static.position("rigidbody 1.centre")[-1, 2] == pytest.approx(-m * 9.81 / k)
    assert static.joint_force(spring)[-1, 2] == pytest.approx(-m * 9.81)
    (s,) = fl.vibrations(scene, 1).eigenvalues
    decay = c / (2 * m)
    omega = np.sqrt(k / m - decay**2)
    assert abs(s.real) == pytest.approx(decay) and abs(s.imag) == pytest.approx(omega)
    result = SCHEME.run(scene, duration=2.0, step=1e-3)
    t = result.times
    swing = np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    known = -m * 9.81 / k * (1 - swing)
    np.testing.assert_allclose(result.coordinate(spring), known, rtol=0, atol=1e-5)
    stored = 0.5 * k * result.coordinate(slide) ** 2
    np.testing.assert_allclose(result.elastic, stored, atol=1e-12)


def test_planar_joint_keeps_to_its_plane():
    """A puck moves uniformly and rotates; its coordinates refer to the axes of the plane."""
    scene = fl.Scene(gravity=(0, -9.81, 0))
    puck = body(scene)
    floor = scene.add(
        fl.joints.Planar(fl.ground(), puck.point("centre"), axis=(0, 1, 0), second=(0, 0, 1))
    )
    puck.add_velocity(omega=(0, 3.0, 0), about=(0, 0, 0))
    puck.add_velocity((0.4, 0, 0.3))
    result = SCHEME.run(scene, duration=3.0, step=1e-2)
    t = result.times
    np.testing.assert_allclose(result.coordinate(floor, "displacement 1"), 0.3 * t, atol=1e-9)
    np.testing.assert_allclose(result.coordinate(floor, "displacement 2"), 0.4 * t, atol=1e-9)
    np.testing.assert_allclose(result.coordinate(floor, "angle"), 3.0 * t, atol=1e-9)
    # what the ground feels across the plane: the weight
    np.testing.assert_allclose(result.joint_force(floor)[:, 2], -2.0 * 9.81, atol=1e-6)


def test_massless_rod_is_a_pendulum():
    """A constant distance, against the reference of a point mass on a rod (IFToMM A01)."""
    scene = fl.Scene(gravity=(0, -9.81, 0))
    ball = body(scene, (-1, 0, 0), (1e-6,) * 3, 1.0)
    rod = fl.joints.Distance(fl.ground(), ball.point("centre"), at=(0, 0, 0))
    keep = scene.add(fl.joints.Drive(rod.length, name="rod"))
    result = SCHEME.run(scene, duration=1.0, step=1e-3)
    np.testing.assert_allclose(
        result.position(ball.point("centre"))[-1, :2], [0.9862917511, -0.1650108531], atol=1e-5
    )
    assert result.coordinate(keep) == pytest.approx(1.0, abs=1e-12)


def test_drive_in_statics_follows_the_load_factor():
    section = fl.Section.circle(0.01, fl.Material(1e9, 0.3, 1000.0))
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=Z))
    scene.add(fl.joints.Drive(hinge.angle, lambda t: 2.0 * np.pi * 0.75 * t))
    result = fl.statics(scene, load_steps=6)
    np.testing.assert_allclose(result.position(beam.point("end"))[-1], [0, -1, 0], atol=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda j: fl.joints.Spring(j.angle), "not both 0"),
        (lambda j: fl.joints.Spring(j.angle, stiffness=-1.0), r"≥ 0.*-1"),
        (lambda j: fl.joints.Drive(j.angle, lambda t: 1.0 + t), "must start at 0, got 1"),
        (lambda j: fl.joints.Gear(j.angle, j.angle, ratio=0.0), "ratio"),
        (lambda j: fl.joints.Screw(j.a, j.b), "pitch"),
        (lambda j: fl.joints.Universal(j.a, j.b, axis=Z, second=(0, 1, 1)), "across the axis"),
        (
            lambda j: fl.joints.Universal(j.a, j.b, axis=Z),
            r"expected second=\.\.\., a direction across",
        ),
        (
            lambda j: fl.joints.Spring(fl.joints.Planar(j.a, j.b, axis=Z).displacements[0], 1.0),
            r"expected second=\.\.\., .*, got none: the directions of the two displacements",
        ),
        (lambda j: fl.joints.Distance(j.a, j.b), "a distance needs two different positions"),
        (lambda j: fl.joints.RollingDisc(j.a, j.b, axis=(1, 0, 0)), "radius must be a positive"),
        (lambda j: fl.joints.RollingDisc(j.a, j.b, axis=Z, radius=1.0), "the normal of the plane"),
    ],
)
def test_bad_input_says_what_is_wrong(make, message):
    scene = fl.Scene()
    joint = fl.joints.Revolute(fl.ground(), body(scene).point("centre"), axis=Z)
    with pytest.raises(ValueError, match=message):
        scene.add(make(joint))


def test_springs_on_one_coordinate_need_names():
    """Without names the force of the first one would be returned for both."""
    for names in (("soft", "stiff"), ("", "")):
        scene = fl.Scene()
        hinge = scene.add(
            fl.joints.Revolute(fl.ground(), body(scene).point("centre"), axis=Z, name="hinge")
        )
        soft, stiff = (
            scene.add(fl.joints.Spring(hinge.angle, stiffness, rest=0.1, name=name))
            for stiffness, name in zip((2.0, 50.0), names, strict=True)
        )
        result = SCHEME.run(scene, duration=1e-6, step=1e-6)
        if names[0]:
            moments = [np.abs(result.joint_force(s)[0]).max() for s in (soft, stiff)]
            np.testing.assert_allclose(moments, [0.2, 5.0], rtol=1e-9)
            continue
        for ask in (result.joint_force, result.coordinate, result.joint_violation):
            with pytest.raises(ValueError, match=r"2 joints or .*'Spring\(.* its own name"):
                ask(stiff)


def test_unknown_coordinate_names_those_that_exist():
    scene = fl.Scene()
    joint = scene.add(
        fl.joints.Cylindrical(fl.ground(), body(scene).point("centre"), axis=Z, name="pin")
    )
    result = SCHEME.run(scene, duration=0.1, step=0.1)
    with pytest.raises(ValueError, match=r"pin has no coordinate 'turn'.*angle, displacement"):
        result.coordinate(joint, "turn")


def test_double_four_bar_passes_its_flat_positions():
    """IFToMM A02: planar loops of hinges are redundant, and singular where all bars lie flat."""
    scene = fl.Scene(gravity=(0, -9.81, 0), redundant=fl.joints.RedundantConstraints.MINIMUM_NORM)
    across = 1.0 / 12.0
    upright = [body(scene, (x, 0.5, 0), (across, 1e-9, across), 1.0) for x in (0, 1, 2)]
    flat = [body(scene, (x + 0.5, 1, 0), (1e-9, across, across), 1.0) for x in (0, 1)]
    for x, bar in enumerate(upright):
        scene.add(fl.joints.Revolute(fl.ground(), bar.point("centre"), at=(x, 0, 0)))
        bar.add_velocity(omega=(0, 0, -1.0), about=(x, 0, 0))
    for x, bar in enumerate(flat):
        scene.add(fl.joints.Revolute(upright[x].point("centre"), bar.point("centre"), at=(x, 1, 0)))
        scene.add(
            fl.joints.Revolute(
                bar.point("centre"), upright[x + 1].point("centre"), at=(x + 1, 1, 0)
            )
        )
        bar.add_velocity((1, 0, 0))
    result = SCHEME.run(scene, duration=1.0, step=1e-3)
    bar = upright[0].point("centre")
    top = result.position(bar) + 0.5 * result.rotation(bar)[:, :, 1]
    for time, point_at in (
        (0.5, (0.6952866332, 0.7187325634)),
        (1.0, (-0.1950203019, -0.9807992057)),
    ):
        # of second order: 2.3e-5 at 1 s with this step, 5.8e-6 with half of it
        np.testing.assert_allclose(top[result.index(time), :2], point_at, atol=3e-5)
    assert result.joint_violations.max() < 1e-11
