"""Positions on rigid bodies: what is held, loaded or looked at there is as if there were a node."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

TURN = lie.so3_exp(np.array([0.3, -0.5, 0.2]))
CENTRE, PLACE = np.array([0.1, 0.2, -0.3]), np.array([0.5, -0.2, 0.4])
FORCE, MOMENT = np.array([0.3, -0.7, 0.4]), np.array([0.1, 0.2, -0.05])
SCHEMES = {
    "alpha": fl.GeneralisedAlpha(radius=0.9, tolerance=1e-11),
    "conserving": fl.EnergyMomentum(tolerance=1e-11),
}


def stone(name: str = "stone") -> fl.RigidBody:
    return fl.RigidBody(2.0, (0.1, 0.2, 0.25), CENTRE, TURN, name=name)


def plate() -> fl.RigidBody:
    """A massless body, all but, with its centre at the position."""
    return fl.RigidBody(1e-9, (1e-11,) * 3, PLACE, TURN, name="plate")


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES.keys())
@pytest.mark.parametrize("following", [False, True], ids=["fixed", "following"])
def test_a_load_beside_the_centre_is_one_on_a_body_that_is_linked_there(scheme, following):
    found = []
    for linked in (False, True):
        scene, body = fl.Scene(), stone()
        scene.add(body)
        point = body.point(PLACE)
        if linked:
            point = scene.add(plate()).point("centre")
            scene.add(fl.joints.RigidLink(body.point("centre"), point))
        scene.add(fl.PointLoad(point, FORCE, MOMENT, following=following))
        result = scheme.run(scene, duration=0.5, step=1e-2)
        found.append(result.position(body.point("centre")))
        assert result.balance_error < 1e-3
    # what the second body weighs
    np.testing.assert_allclose(*found, atol=1e-8)
    assert np.abs(found[0][-1] - CENTRE).max() > 0.01


def test_results_know_the_position():
    scene, body = fl.Scene(), stone()
    scene.add(body)
    body.add_velocity(omega=(0.3, 1.0, -0.6), about=(0, 0, 0))
    position = body.point(PLACE)
    result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=0.2, step=1e-3)
    np.testing.assert_allclose(result.position(position)[0], PLACE, atol=1e-15)
    away = np.linalg.norm(result.position(position) - result.position(body.point("centre")), axis=1)
    np.testing.assert_allclose(away, np.linalg.norm(PLACE - CENTRE), rtol=1e-14)
    np.testing.assert_array_equal(result.rotation(position), result.rotation(body.point("centre")))
    velocity = np.einsum("tij,tj->ti", result.rotation(position), result.velocity(position)[:, :3])
    middle = (result.position(position)[2:] - result.position(position)[:-2]) / 2e-3
    np.testing.assert_allclose(velocity[1:-1], middle, atol=1e-6)


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES.keys())
def test_joints_there_are_joints_of_the_body(scheme):
    """A body that hangs on a position, by the position and by where that is."""
    found = []
    for at in (None, PLACE):
        scene, body = fl.Scene(gravity=(0, 0, -9.81)), stone()
        scene.add(body)
        point = body.point("centre") if at is not None else body.point(PLACE)
        scene.add(fl.joints.Spherical(fl.ground(), point, at=at, name="hook"))
        result = scheme.run(scene, duration=0.2, step=5e-3)
        found.append((result.frames, result.joint_force("hook")))
    # the position in the body's axes is rounded once more
    np.testing.assert_allclose(found[0][0], found[1][0], atol=1e-12)
    np.testing.assert_allclose(found[0][1], found[1][1], atol=1e-9)


def test_a_clamp_there_holds_the_body_and_has_its_moment_there():
    scene, body = fl.Scene(), stone()
    scene.add(body)
    clamp = scene.add(fl.Clamp(body.point(PLACE)))
    scene.add(fl.PointLoad(body.point("centre"), FORCE))
    reaction = fl.statics(scene).reaction(clamp)[-1]
    np.testing.assert_allclose(reaction[:3], -FORCE, atol=1e-12)
    np.testing.assert_allclose(reaction[3:], -np.cross(CENTRE - PLACE, FORCE), atol=1e-12)


def test_a_position_is_three_numbers():
    with pytest.raises(
        ValueError, match="position of a point of RigidBody must be 3 finite numbers"
    ):
        fl.RigidBody(1.0, (1, 1, 1)).point((1, 2))
