"""Angles beyond half a turn in statics and along paths: prescribed, driven, of springs."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import prescribed_turns
from benchmarks.prescribed_turns import AXES, FREE
from fem_lie import lie

SECTION = fl.Section.circle(0.1, fl.Material(1.2e6, 0.25, 1.0))
TURN = 2.0 * np.pi


@pytest.mark.parametrize("degrees", [80, 360])
@pytest.mark.parametrize("body", FREE)
def test_free_bodies_rotate_as_prescribed(body, degrees):
    assert prescribed_turns.free(FREE[body], AXES[2], degrees) < 1e-10


@pytest.mark.parametrize("kind", [fl.Beam, fl.Rod])
@pytest.mark.parametrize("degrees", [80, 180, 360, 1080])
def test_a_shaft_is_twisted_by_the_prescribed_angle(kind, degrees):
    assert prescribed_turns.shaft(kind, degrees) < 1e-10


@pytest.mark.parametrize("degrees", [100, 720])
def test_springs_in_series_divide_the_prescribed_angle(degrees):
    assert prescribed_turns.springs(AXES[2], degrees) < 1e-10


def test_a_solid_is_twisted_as_by_a_driven_joint():
    assert prescribed_turns.bar(270) < 1e-10


def test_turns_are_followed_that_a_few_samples_do_not_show():
    """16 turns forward: samples at sixteenths of the step see none."""
    assert prescribed_turns.springs(AXES[0], 16 * 360) < 1e-10


def test_turns_forward_and_back_end_where_they_began():
    scene, body = fl.Scene(), fl.Beam.straight((0, 0, 0), (4, 0, 0), SECTION, cells=8)
    scene.add(body)
    held = scene.add(fl.Clamp(body.point("start")))
    start = body.point("end").frame.copy()

    def motion(t):
        angle = np.array([TURN * np.sin(np.pi * t), 0.0, 0.0])
        return np.vstack([start[:1], start[1:] @ lie.so3_exp(angle).T])

    scene.add(fl.PrescribedMotion(body.point("end"), motion))
    found = fl.statics(scene, levels=(0.5, 1.0))
    half = int(np.flatnonzero(found.factors == 0.5)[0])
    moments = found.reaction(held)[:, 3]
    assert moments[half] == pytest.approx(-TURN * SECTION.stiffness[3, 3] / 4, rel=1e-10)
    assert abs(moments[-1]) < 1e-10 * abs(moments[half])


# --- springs ---


def lever(moment: float, stiffness: float = 2.0, rest: float | None = None):
    """A rigid lever on a torsion spring, its scene and the spring."""
    scene, body = fl.Scene(), fl.RigidBody(1.0, (1, 1, 1))
    scene.add(body)
    hinge = scene.add(fl.joints.Revolute(fl.ground(), body.point("centre")))
    spring = scene.add(fl.joints.Spring(hinge.angle, stiffness=stiffness, rest=rest))
    if moment:
        scene.add(fl.PointLoad(body.point("centre"), moment=(0, 0, moment)))
    return scene, body, spring


@pytest.mark.parametrize("rest", [0.5, TURN, -3 * TURN])
def test_a_preload_of_whole_turns_on_an_elastic_shaft(rest):
    """The spring is as stiff as the shaft: each takes half of the rest angle."""
    stiffness = SECTION.stiffness[3, 3] / 4
    scene = fl.Scene()
    shaft = scene.add(fl.Beam.straight((0, 0, 0), (4, 0, 0), SECTION, cells=16))
    scene.add(fl.Clamp(shaft.point("start")))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), shaft.point("end"), axis=(1, 0, 0)))
    spring = scene.add(fl.joints.Spring(hinge.angle, stiffness=stiffness, rest=rest))
    moment = fl.statics(scene).joint_force(spring)[-1][5]
    assert abs(moment) == pytest.approx(stiffness * abs(rest) / 2, rel=1e-10)


@pytest.mark.parametrize("angle", [1.0, 4.0, -7.0, 60.0])
@pytest.mark.parametrize("solve", [fl.statics, fl.follow_path], ids=["statics", "path"])
def test_a_lever_on_a_torsion_spring(angle, solve):
    scene, body, spring = lever(2.0 * angle)
    found = solve(scene)
    assert found.factors[-1] == 1.0
    assert found.joint_force(spring)[-1][5] == pytest.approx(2.0 * angle, rel=1e-9)
    expected = lie.so3_exp(np.array([0.0, 0.0, angle]))
    np.testing.assert_allclose(found.rotation(body.point("centre"))[-1], expected, atol=1e-8)


def test_a_path_begins_with_the_preload():
    """The lever is held by two springs that strain each other by several turns."""
    scene, _, first = lever(0.0, 2.0, rest=20.0)
    hinge = scene.joints[0]
    second = scene.add(fl.joints.Spring(hinge.angle, stiffness=3.0, rest=-5.0, name="second"))
    scene.add(fl.PointLoad(scene.bodies[0].point("centre"), moment=(0, 0, 10.0)))
    path = fl.follow_path(scene)
    # 2 (φ − 20) + 3 (φ + 5) = 10 λ
    angles = 5.0 + 2.0 * path.factors
    np.testing.assert_allclose(path.joint_force(first)[:, 5], 2 * (angles - 20), rtol=1e-9)
    np.testing.assert_allclose(path.joint_force(second)[:, 5], 3 * (angles + 5), rtol=1e-9)
    end = fl.statics(scene).joint_force(first)[-1][5]
    assert end == pytest.approx(2 * (7.0 - 20.0), rel=1e-10)


def test_levels_have_the_whole_preload():
    scene, _, spring = lever(4.0, 2.0, rest=10.0)
    found = fl.statics(scene, levels=(0.25, 0.5, 1.0))
    np.testing.assert_allclose(found.joint_force(spring)[:, 5], 4.0 * found.factors, atol=1e-9)


def test_an_overshoot_ends_at_the_angle_that_is_connected_with_no_load():
    """``k φ = F ℓ cos φ`` has solutions on many turns; the first one is meant."""
    scene, body, spring = lever(0.0, 1.0)
    scene.add(fl.PointLoad(body.point((1, 0, 0)), force=(0, 30.0, 0)))
    angle = 0.0
    for _ in range(200):
        angle -= (angle - 30.0 * np.cos(angle)) / (1.0 + 30.0 * np.sin(angle)) if angle else -1.0
    assert 0.0 < angle < np.pi / 2
    assert fl.statics(scene).joint_force(spring)[-1][5] == pytest.approx(angle, rel=1e-9)


# --- screws, gears, drives ---


@pytest.mark.parametrize("turns", [0.3, 5.0])
def test_a_screw_is_pushed_through_many_turns(turns):
    scene, body = fl.Scene(), fl.RigidBody(1.0, (1, 1, 1))
    scene.add(body)
    screw = scene.add(fl.joints.Screw(fl.ground(), body.point("centre"), axis=(1, 0, 0), pitch=0.1))
    scene.add(fl.joints.Spring(screw.displacement, stiffness=10.0))
    twisted = scene.add(fl.joints.Spring(screw.angle, stiffness=1e-3))
    # 10 · 0.1 turns and the moment of the other spring over the pitch
    force = turns + 1e-3 * TURN * turns * TURN / 0.1
    scene.add(fl.PointLoad(body.point("centre"), force=(force, 0, 0)))
    found = fl.statics(scene)
    assert found.position(body.point("centre"))[-1][0] == pytest.approx(0.1 * turns, rel=1e-9)
    assert found.joint_force(twisted)[-1][5] == pytest.approx(1e-3 * TURN * turns, rel=1e-9)


@pytest.mark.parametrize("by", ["drive", "moment"])
def test_a_gear_multiplies_turns(by):
    scene = fl.Scene()
    slow, fast = (scene.add(fl.RigidBody(1.0, (1, 1, 1), position=(x, 0, 0))) for x in (0.0, 3.0))
    first, second = (
        scene.add(fl.joints.Revolute(fl.ground(), w.point("centre"))) for w in (slow, fast)
    )
    scene.add(fl.joints.Gear(first.angle, second.angle, ratio=0.1))
    spring = scene.add(fl.joints.Spring(second.angle, stiffness=2.0))
    if by == "drive":
        scene.add(fl.joints.Drive(first.angle, lambda t: 3.0 * t))
    else:
        # the slow wheel has ten times the moment of the spring
        scene.add(fl.PointLoad(slow.point("centre"), moment=(0, 0, 600.0)))
    moment = fl.statics(scene).joint_force(spring)[-1][5]
    assert moment == pytest.approx(-60.0, rel=1e-9)


@pytest.mark.parametrize("degrees", [100, 360, 1080])
def test_a_driven_angle_of_many_turns(degrees):
    angle = np.radians(degrees)
    scene, _, spring = lever(0.0)
    scene.add(fl.joints.Drive(scene.joints[0].angle, lambda t: angle * t))
    found = fl.statics(scene)
    assert found.joint_force(spring)[-1][5] == pytest.approx(2.0 * angle, rel=1e-10)
    # the steps are those that are prescribed: none fails
    assert found.failed_iterations == 0


# --- what is refused ---


def test_an_arc_length_needs_translations():
    scene, _, _ = lever(2.0)
    with pytest.raises(fl.ConvergenceError, match="turns nodes on the spot"):
        fl.follow_loads(scene)


def test_displacement_control_across_the_load_is_refused():
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=4))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 1.0)))
    control = fl.stability.DisplacementControl(beam.point("end"), (0, 1, 0), 0.1)
    with pytest.raises(ValueError, match="does not move the point in that direction"):
        fl.follow_path(scene, control=control)


# --- the branch that is meant ---
