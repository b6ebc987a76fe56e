"""Errors of scenes and their items, and invalid prescribed motions."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from tests.assembled import Assembled

SECTION = fl.Section.circle(0.01, fl.Material(1e9, 0.3, 1000.0))
LAYER = fl.ShellSection.layer(0.01, fl.Material(1e9, 0.3, 1000.0))


def plate() -> fl.Shell:
    return fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2)), LAYER, name="plate"
    )


def two_bodies():
    scene = fl.Scene()
    a = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    b = scene.add(fl.RigidBody(1.0, (1, 1, 1), position=(1, 0, 0)))
    return scene, a, b


# --- a body that is in two scenes -----------------------------------------------------------------


def test_a_shell_has_five_parameters_in_one_scene_and_six_in_another():
    shell = plate()
    plain, jointed = fl.Scene(), fl.Scene()
    plain.add(shell)
    first = Assembled(plain, dynamics=True)
    jointed.add(shell)
    jointed.add(fl.joints.Revolute(shell.point("00"), fl.ground()))
    again = Assembled(plain, dynamics=True)
    other = Assembled(jointed, dynamics=True)
    assert not plain.has_drilling(shell) and jointed.has_drilling(shell)
    np.testing.assert_array_equal(again.held, first.held)
    assert not other.held[:, 5].any() and first.held[:, 5].all()


def test_two_shells_of_one_kind_may_differ_in_parameters():
    scene = fl.Scene()
    five, six = scene.add(plate()), scene.add(fl.Shell(plate().model.mesh, LAYER, name="other"))
    scene.add(fl.PointLoad(six.point("11"), moment=(0, 0, 1)))
    unknowns = fl.extend.Equations(scene, dynamics=True).unknowns
    held = unknowns.held[:, 5]
    assert held[unknowns.bodies[five]].all()
    assert not held[unknowns.bodies[six]].any()


# --- coordinates ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "item",
    [
        lambda joint: fl.joints.Spring(joint.angle, stiffness=1.0),
        lambda joint: fl.joints.Drive(joint.angle),
        lambda joint: fl.joints.Gear(
            fl.joints.Distance(joint.a, joint.b).length, joint.angle, ratio=2.0
        ),
    ],
)
def test_what_acts_along_a_joint_needs_it_in_the_scene(item):
    scene, a, b = two_bodies()
    joint = fl.joints.Revolute(a.point("centre"), b.point("centre"), at=(0, 0, 0), name="hinge")
    with pytest.raises(ValueError, match="angle of hinge, which is not in the scene; add"):
        scene.add(item(joint))
    scene.add(joint)
    scene.add(item(joint))
    assert len(scene.connections) == 1


def test_a_distance_binds_nothing_and_need_not_be_in_the_scene():
    scene, a, b = two_bodies()
    scene.add(
        fl.joints.Spring(
            fl.joints.Distance(a.point("centre"), b.point("centre")).length, stiffness=1.0
        )
    )
    assert not scene.joints


def test_a_gear_wants_two_coordinates():
    scene, a, b = two_bodies()
    pin = scene.add(fl.joints.Cylindrical(a.point("centre"), b.point("centre"), at=(0, 0, 0)))
    rod, back = (
        fl.joints.Distance(a.point("centre"), b.point("centre")),
        fl.joints.Distance(b.point("centre"), a.point("centre")),
    )
    for first, second in ((pin.angle, pin.angle), (rod.length, back.length)):
        with pytest.raises(ValueError, match="same coordinate"):
            scene.add(fl.joints.Gear(first, second, ratio=2.0))
    scene.add(fl.joints.Gear(pin.displacement, pin.angle, ratio=2.0))


# --- prescribed motions ---------------------------------------------------------------------------


def mirrored(frame):
    frame[3] *= -1.0


def stretched(frame):
    frame[1] *= 1.0 + 1e-6


def sheared(frame):
    frame[1] += 1e-6 * frame[2]


def lost(frame):
    frame[0, 1] = np.nan


FAULTS = {
    "right-handed orthonormal": (mirrored, stretched, sheared),
    "finite frame": (lost,),
}


@pytest.mark.parametrize(
    ("fault", "message"), [(f, message) for message, faults in FAULTS.items() for f in faults]
)
@pytest.mark.parametrize("run", ["dynamics", "statics"])
def test_a_motion_that_ends_to_be_one_is_refused_at_that_time(fault, message, run):
    scene = fl.Scene()
    bar = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2))
    start = bar.point("start").frame.copy()

    def motion(time):
        frame = lie.se3_retract(start, 0.1 * time**2 * np.array([0, 0, 1, 0, 1, 0]))
        if time > 0.5:
            fault(frame)
        return frame

    scene.add(fl.PrescribedMotion(bar.point("start"), motion))
    # statics samples the motion within its steps
    when = "0.6" if run == "dynamics" else r"0\.5\d*"
    with pytest.raises(ValueError, match=f"(?s)beam 1.start must be.*{message}.*at time {when}"):
        if run == "dynamics":
            fl.GeneralisedAlpha(radius=0.8).run(scene, duration=1.0, step=0.1)
        else:
            fl.statics(scene, load_steps=5)


def test_a_motion_of_another_shape_is_refused():
    scene = fl.Scene()
    bar = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2))
    start = bar.point("start").frame.copy()
    motion = scene.add(
        fl.PrescribedMotion(bar.point("start"), lambda t: start if t == 0 else start.reshape(3, 4))
    )
    with pytest.raises(ValueError, match=r"shape \(4, 3\).*time 0.5"):
        motion.frame(0.5)


# --- what is set by hand --------------------------------------------------------------------------


def no_velocity(scene, bar):
    bar.velocities[1, 0] = np.nan


def one_velocity_for_all(scene, bar):
    bar.velocities = np.zeros(6)


def no_place(scene, bar):
    bar.frames[1, 0, 2] = np.inf


def longer_director(scene, bar):
    bar.frames[1, 1] *= 1.1


def turned_director(scene, bar):
    bar.frames[1, 1] *= -1.0


def no_gravity(scene, bar):
    scene.gravity = 9.81


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (no_velocity, "velocities of bar must be finite"),
        (one_velocity_for_all, r"velocities of bar .*shape \(3, 6\)"),
        (no_place, "frames of bar .*of node 1 is"),
        (longer_director, "frames of bar .*of node 1 is"),
        (turned_director, "frames of bar .*right-handed"),
        (no_gravity, r"gravity must be 3 finite numbers, got 9\.81"),
    ],
)
@pytest.mark.parametrize("solve", ["dynamics", "statics"])
def test_what_is_set_by_hand_is_seen_before_anything_is_computed(spoil, message, solve):
    scene = fl.Scene()
    bar = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2, name="bar"))
    scene.add(fl.Clamp(bar.point("start")))
    with pytest.raises(ValueError, match=f"(?s){message}"):
        spoil(scene, bar)
        fl.extend.Equations(scene, dynamics=solve == "dynamics")


def test_a_point_needs_a_node_that_is_there():
    bar = fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2, name="bar")
    for node in (3, -1):
        with pytest.raises(ValueError, match=f"bar has nodes 0 … 2, got {node}"):
            fl.extend.Point(bar, node)
    with pytest.raises(TypeError, match="body must be a body, or None for ground, got 'bar'"):
        fl.extend.Point("bar")


def test_bodies_that_are_given_the_same_name_later_are_refused():
    scene = fl.Scene()
    one = scene.add(fl.RigidBody(1.0, (1, 1, 1), name="one"))
    scene.add(fl.RigidBody(1.0, (1, 1, 1), (1, 0, 0), name="two"))
    one.name = "two"
    with pytest.raises(ValueError, match="several bodies named 'two'"):
        fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.1)
