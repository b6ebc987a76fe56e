"""Points of ground with a position: joints, bushings, contact surfaces, and results there."""

import numpy as np
import pytest

import fem_lie as fl

PLACE = (0.3, -0.2, 0.5)


def stone() -> fl.RigidBody:
    return fl.RigidBody.ball(1.0, 0.1, (1.0, 0.0, 0.5), name="stone")


def swing(**given) -> fl.Result:
    """A stone on a ball joint to ground at a place."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    body = scene.add(stone())
    ground, point, own = given["ground"], body.point(given.get("point", PLACE)), {}
    if "at" in given:
        own["at"], point = given["at"], body.point("centre")
    scene.add(fl.joints.Spherical(ground, point, **own))
    return fl.GeneralisedAlpha().run(scene, duration=0.2, step=1e-2)


def test_a_joint_to_a_place_is_there():
    wanted = swing(ground=fl.ground(), at=PLACE)
    found = swing(ground=fl.ground(PLACE))
    np.testing.assert_allclose(found.frames, wanted.frames, atol=1e-12)
    assert np.abs(found.frames[-1] - found.frames[0]).max() > 0.01


def test_a_joint_whose_points_are_apart_is_refused():
    with pytest.raises(ValueError, match=r"ground at \(0.3, -0.2, 0.5\).* are 0.1 apart"):
        swing(ground=fl.ground(PLACE), point=(0.3, -0.2, 0.6))


def test_distances_and_bushings_begin_at_the_place():
    body = stone()
    distance = fl.joints.Distance(fl.ground(PLACE), body.point("centre"))
    A, B = distance.frames()
    np.testing.assert_array_equal(A[0], PLACE)
    np.testing.assert_array_equal(B[0], (1.0, 0.0, 0.5))
    bushing = fl.joints.Bushing(fl.ground(PLACE), body.point("centre"), (1,) * 6)
    np.testing.assert_array_equal(bushing.bushing_definition().frames[0][0], PLACE)
    everywhere = fl.joints.Bushing(fl.ground(), body.point("centre"), (1,) * 6)
    np.testing.assert_array_equal(everywhere.bushing_definition().frames[0][0], (1.0, 0.0, 0.5))


SURFACES = {
    "sphere": lambda: fl.contact.Sphere(fl.ground((0, 0, -0.3)), 0.3),
    "cylinder": lambda: fl.contact.Cylinder(fl.ground((0, 0, -0.3)), (0, 1, 0), 0.3),
    "box": lambda: fl.contact.Box(fl.ground((0, 0, -0.3)), (1, 1, 0.6)),
    "plane": lambda: fl.contact.Plane(fl.ground((5, 2, 0)), (0, 0, 1)),
}


@pytest.mark.parametrize("make", SURFACES.values(), ids=SURFACES.keys())
def test_what_stands_on_a_surface_of_ground_is_carried(make):
    """Its top is at the height 0: a ball rests above it, on the compliance of the contact."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    body = scene.add(fl.RigidBody.ball(1.0, 0.1, (0, 0, 0.0999)))
    scene.add(fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=(0, 0, 1)))
    ball, stiffness = fl.contact.Sphere(body.point("centre"), 0.1), 1e5
    if isinstance(make(), fl.contact.Cylinder):
        ball = fl.contact.Cylinder(body.point("centre"), (0.2, 0, 0), 0.1)
    contact = scene.add(fl.contact.Contact(ball, make(), fl.contact.Penalty(stiffness)))
    result = fl.statics(scene)
    force = np.abs(fl.post.contact_forces(result, contact).total[-1, 2])
    assert force == pytest.approx(9.81, rel=1e-8)


def test_a_place_of_another_shape_is_refused():
    with pytest.raises(ValueError, match="ground: position"):
        fl.ground((1, 2))


def test_runs_of_other_places_are_not_resumed(tmp_path):
    def scene(place) -> fl.Scene:
        made = fl.Scene(gravity=(0, 0, -9.81))
        body = made.add(stone())
        made.add(fl.joints.Distance(fl.ground(place), body.point("centre"), name="rope"))
        joint = made.joints[-1]
        made.add(fl.joints.Spring(joint.length, stiffness=10.0))
        return made

    file = tmp_path / "stone.h5"
    fl.GeneralisedAlpha().run(scene(PLACE), duration=0.1, step=1e-2, file=file)
    with pytest.raises(ValueError, match="cannot resume"):
        fl.GeneralisedAlpha().resume(scene((0.3, -0.2, 0.6)), file)
