"""Forces of joints along global axes: by the weight that hangs on a body, and by Newton's laws."""

import numpy as np
import pytest

import fem_lie as fl

SOFT = fl.Material(2e7, 0.3, 1000.0)
CIRCLE, LAYER = fl.Section.circle(0.02, SOFT), fl.ShellSection.layer(0.02, SOFT)
RUBBER = fl.sections.NeoHooke(2e6, 0.3, 1000.0)
MIDDLE = np.array([0.15, 0.1, 0.0])
AXIS, WEIGHT = np.array([0.48, 0.6, 0.64]), 0.3


def beam(formulation=None):
    body = fl.Beam.straight((0, 0, 0), (1, 0, 0), CIRCLE, cells=4, formulation=formulation)
    return body, body.point("start"), body.point((0.9, 0, 0) if formulation else "end")


def shell():
    surface = fl.mesh.parametric_surface(lambda a, b: np.array([a, 0.3 * b, 0.0]), (4, 1))
    body = fl.Shell(surface, LAYER)
    return body, "a=0", body.point("10")


def solid():
    body = fl.Solid.brick((1.0, 0.1, 0.1), RUBBER, cells=(4, 1, 1))
    return body, "a=0", body.point("111")


def held(make):
    """A scene with a body that is held at one end, and the point at the other."""
    body, end, point = make()
    scene = fl.Scene(gravity=(0, 0, -10))
    scene.add(body)
    if isinstance(end, str):
        body.clamp(end)
    else:
        scene.add(fl.Clamp(end))
    return scene, point


@pytest.mark.parametrize(
    "make",
    [beam, lambda: beam(fl.elements.DirectorBeam(1)), shell, solid],
    ids=["beam", "within an element", "shell", "solid"],
)
def test_a_weight_pulls_downwards_on_what_it_hangs_on(make, tmp_path):
    """Moments vanish, as the joint is at the centre of mass."""
    scene, point = held(make)
    weight = scene.add(fl.RigidBody(WEIGHT / 10.0, (1e-5,) * 3, point.position, name="weight"))
    hook = scene.add(fl.joints.Fixed(point, weight.point("centre"), name="hook"))
    result = fl.statics(scene)
    wanted = (0, 0, -WEIGHT, 0, 0, 0)
    np.testing.assert_allclose(result.joint_force(hook, axes="global")[-1], wanted, atol=1e-9)
    if not isinstance(point.body, fl.Solid):  # an attachment to one node of it does not rotate
        assert np.abs(result.joint_force(hook)[-1] - wanted).max() > 0.01 * WEIGHT
    result.save(tmp_path / "hangs.h5")
    loaded = type(result).load(tmp_path / "hangs.h5")
    np.testing.assert_allclose(loaded.joint_force(hook, axes="global")[-1], wanted, atol=1e-9)
    with pytest.raises(ValueError, match=r"fl\.StaticResult\.load reads it"):
        fl.Result.load(tmp_path / "hangs.h5")
    if point.any_attachment is None:
        named = loaded.joint_force("hook", axes="global")
        np.testing.assert_allclose(named[-1], wanted, atol=1e-9)
    else:
        with pytest.raises(ValueError, match="the joint itself instead of its name"):
            loaded.joint_force("hook", axes="global")


def swing(first: str) -> tuple[fl.Result, fl.joints.Joint, np.ndarray]:
    """A ball on an arm that turns about an axis through the origin at 3 rad/s, and its place."""
    arm = np.cross(AXIS, (0.5, 0.0, 0.0))
    scene = fl.Scene()
    ball = scene.add(fl.RigidBody(2.0, (0.01,) * 3, arm))
    ball.add_velocity(omega=3.0 * AXIS, about=(0, 0, 0))
    sides = fl.ground(), ball.point("centre")
    sides = sides if first == "ground" else sides[::-1]
    hinge = scene.add(fl.joints.Revolute(*sides, at=(0, 0, 0), axis=AXIS))
    result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=1.0, step=1e-3)
    return result, hinge, result.position(ball.point("centre"))


@pytest.mark.parametrize(("first", "sign"), [("ground", 1.0), ("ball", -1.0)])
def test_a_ball_that_turns_pulls_outwards(first, sign):
    """The force on the axis is m ω² r, on the ball the opposite, in whatever frame it is kept."""
    result, hinge, place = swing(first)
    force = result.joint_force(hinge, axes="global")
    np.testing.assert_allclose(force[:, :3], sign * 2.0 * 9.0 * place, atol=5e-3)
    np.testing.assert_allclose(force[:, 3:], 0.0, atol=1e-4)


CONNECTIONS = {
    "fixed": lambda a, b: fl.joints.Fixed(a, b, at=MIDDLE),
    "revolute": lambda a, b: fl.joints.Revolute(a, b, at=MIDDLE, axis=AXIS),
    "universal": lambda a, b: fl.joints.Universal(
        a, b, at=MIDDLE, axis=(1, 0, 0), second=(0, 1, 0)
    ),
    "prismatic": lambda a, b: fl.joints.Prismatic(a, b, at=MIDDLE, axis=AXIS),
    "spherical": lambda a, b: fl.joints.Spherical(a, b, at=MIDDLE),
    "bushing": lambda a, b: fl.joints.Bushing(a, b, stiffness=(50, 60, 70, 1, 2, 3)),
    "knife edge": lambda a, b: fl.joints.KnifeEdge(a, b, at=MIDDLE, axis=AXIS),
}


@pytest.mark.parametrize("first", ["one", "two"])
@pytest.mark.parametrize("make", CONNECTIONS.values(), ids=CONNECTIONS.keys())
def test_the_force_of_a_joint_is_mass_times_acceleration(make, first):
    """Of two bodies, on which nothing acts but the joint."""
    scene = fl.Scene()
    bodies = {
        name: scene.add(fl.RigidBody(2.0, inertia, place, name=name))
        for name, inertia, place in (
            ("one", (0.1, 0.2, 0.15), (0.0, 0.0, 0.0)),
            ("two", (0.03, 0.03, 0.02), (0.3, 0.2, 0.0)),
        )
    }
    for body in bodies.values():
        body.add_velocity(velocity=(0.6, -0.48, 0.0), omega=(1.0, 0.5, 2.0), about=MIDDLE)
    a, b = (bodies[name].point("centre") for name in sorted(bodies, reverse=first == "two"))
    joint = scene.add(make(a, b))
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-11)
    result = scheme.run(scene, duration=0.5, step=2e-3)
    x = result.position(a)
    accelerations = (x[2:] - 2.0 * x[1:-1] + x[:-2]) / 2e-3**2
    force = result.joint_force(joint, axes="global")[1:-1, :3]
    size = np.abs(force).max()
    assert size > 0.01
    # the first steps have the transients of multipliers
    np.testing.assert_allclose(force[5:], 2.0 * accelerations[5:], atol=3e-4 * size)


def test_a_joint_that_slides_has_the_axes_of_the_section_only():
    body, end, _ = beam()
    scene = fl.Scene(gravity=(0, 0, -10))
    scene.add(body)
    scene.add(fl.Clamp(end))
    bead = scene.add(fl.RigidBody(0.01, (1e-5,) * 3, (0.4, 0, 0)))
    slide = scene.add(fl.joints.Sliding(body, bead.point("centre"), name="slide"))
    result = fl.GeneralisedAlpha().run(scene, duration=0.01, step=1e-3)
    with pytest.raises(ValueError, match="slides; expected axes='joint'"):
        result.joint_force(slide, axes="global")
    with pytest.raises(ValueError, match="expected 'joint' or 'global', got 'space'"):
        result.joint_force(slide, axes="space")


def test_tables_have_global_components_where_they_are_known():
    """Readers took columns Fx for global ones, when they were those of the joint."""
    result, hinge, _ = swing("ball")
    table = result.to_dataframe()
    force = result.joint_force(hinge, axes="global")
    np.testing.assert_array_equal(table[f"{hinge.label} Fx"], force[:, 0])
    np.testing.assert_array_equal(table[f"{hinge.label} Mz"], force[:, 5])
