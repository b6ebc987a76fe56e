"""What overlaps in the beginning is left out until it has parted."""

import numpy as np
import pytest

import fem_lie as fl

LAWS = [
    fl.contact.Penalty(1e5),
    fl.contact.Penalty(1e5, friction=0.3),
    fl.contact.Impact(friction=0.3, restitution=1.0),
]
GRAVITY = 9.81


def thrown_up(
    law: fl.contact.Penalty | fl.contact.Impact, jointed: bool = False
) -> tuple[fl.Scene, fl.RigidBody]:
    """A ball that is half in the floor at first, beside one that lies on it."""
    balls = [fl.RigidBody(1.0, 4e-3 * np.eye(3), (x, 0, z)) for x, z in ((0, 0.0), (1, 0.1))]
    balls[0].add_velocity((0.5, 0, 3))
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    for ball in balls:
        scene.add(ball)
    if jointed:
        bob = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (50.0, 0, 0)))
        scene.add(fl.joints.Spherical(fl.ground(), bob.point((50.0, 0, 1.0))))
    pile = fl.contact.Vertices([ball.point("centre") for ball in balls], 0.1)
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    scene.add(fl.contact.Contact(pile, floor, law, ignore_initial=True))
    return scene, balls[0]


def run(scene: fl.Scene, **options) -> fl.Result:
    scheme = fl.GeneralisedAlpha(radius=0.8)
    return scheme.run(scene, duration=0.8, step=1e-3, progress=False, **options)


@pytest.mark.parametrize("jointed", [False, True])
@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_it_leaves_freely_and_touches_when_it_comes_back(law, jointed):
    scene, ball = thrown_up(law, jointed)
    result = run(scene)
    z, t = result.position(ball.point("centre"))[:, 2], result.times
    back = (3 + np.sqrt(9 - 2 * GRAVITY * 0.1)) / GRAVITY
    before = t < back - 2e-3
    np.testing.assert_allclose(z[before], (3 * t - GRAVITY * t**2 / 2)[before], atol=1e-4)
    assert 0.08 < z.min(initial=1.0, where=t > back - 1e-2)
    assert z[-1] > 0.2
    found = fl.post.contact_forces(result, scene.contacts[0])
    pushed = np.unique(found.states[found.points[:, 0] == 0])
    assert len(pushed)
    assert t[pushed.min()] > back - 5e-3


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_each_pair_parts_by_itself(law):
    """One ball leaves the floor and comes back; one that began in it, too, falls on through it."""
    balls = [fl.RigidBody(1.0, 4e-3 * np.eye(3), (x, 0, 0.05)) for x in (0, 1)]
    balls[0].add_velocity((0, 0, 1))
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    for ball in balls:
        scene.add(ball)
    pile, floor = (
        fl.contact.Vertices([ball.point("centre") for ball in balls], 0.1),
        fl.contact.Plane(fl.ground(), (0, 0, 1)),
    )
    scene.add(fl.contact.Contact(pile, floor, law, ignore_initial=True))
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=0.3, step=1e-3, progress=False)
    back, falls = (result.position(ball.point("centre"))[:, 2] for ball in balls)
    assert back.max() > 0.1 and back[-1] > 0.09
    np.testing.assert_allclose(falls, 0.05 - GRAVITY * result.times**2 / 2, atol=1e-4)


def test_without_it_is_refused():
    scene, _ = thrown_up(fl.contact.Penalty(1e5))
    (contact,) = scene.contacts
    with pytest.raises(ValueError, match=r"overlap by 0\.1 .* or give ignore_initial=True"):
        fl.contact.Contact(contact.a, contact.b, contact.law).check()


@pytest.mark.parametrize("law", LAWS[1:], ids=repr)
@pytest.mark.parametrize("every", [20, 500])
def test_a_restart_agrees_to_the_last_bit(tmp_path, law, every):
    """From a checkpoint while it is still ignored, and from one after it has parted."""
    whole, file = run(thrown_up(law)[0]), tmp_path / "run.h5"
    run(thrown_up(law)[0], file=file, checkpoint_every=every)
    resumed = fl.GeneralisedAlpha(radius=0.8).resume(thrown_up(law)[0], file, progress=False)
    np.testing.assert_array_equal(resumed.frames, whole.frames)
    np.testing.assert_array_equal(resumed.velocities, whole.velocities)


def test_is_refused():
    sheet = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2)),
        fl.ShellSection.layer(0.01, fl.Material(1e9, 0.3, 1e3)),
    )
    surface = fl.contact.ShellSurface(sheet)
    with pytest.raises(ValueError, match="ignore_initial is for points, balls, boxes and planes"):
        fl.contact.Contact(surface, surface, fl.contact.Penalty(1e6), ignore_initial=True).check()
    with pytest.raises(ValueError, match="ignore what overlaps in the beginning"):
        fl.EnergyMomentum().run(
            thrown_up(fl.contact.Penalty(1e5))[0], duration=0.1, step=1e-2, progress=False
        )
