"""What drilling is worth, where it has no stress, and whose frames are carried along."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from tests.assembled import Assembled

MATERIAL = fl.Material(100.0, 0.3, 2.0)
SHEAR = 100.0 / 2.6


def plate(
    thickness: float, drilling: bool | None = True, *, convected_axes: bool = False
) -> fl.Shell:
    """Of size 1, four by four cells."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (4, 4))
    return fl.Shell(
        mesh,
        fl.ShellSection.layer(thickness, MATERIAL),
        drilling=drilling,
        convected_axes=convected_axes,
    )


@pytest.mark.parametrize("over_cell", [0.04, 0.4, 4.0, 40.0])
def test_drilling_is_below_bending_and_never_above_the_membrane(over_cell):
    t = over_cell / 4
    found = plate(t).model.drilling_stiffness([])
    expected = min(0.01 * SHEAR * t * over_cell**2, SHEAR * t)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("corners", "stiff"),
    [
        ({"00": "one"}, 1),
        ({"00": "one", "11": "one"}, 0),  # forces on an arm take its moment
        ({"00": "one", "11": "other"}, 2),
        ({"00": "one", "11": "one", "10": "other"}, 1),
    ],
)
def test_cells_where_a_node_alone_takes_a_moment_are_as_stiff_as_the_membrane(corners, stiff):
    scene, shell = fl.Scene(), plate(0.01)
    scene.add(shell)
    bodies = {name: scene.add(fl.RigidBody(1.0, [1.0] * 3)) for name in sorted({*corners.values()})}
    for corner, body in corners.items():
        scene.add(
            fl.joints.Fixed(
                shell.point(corner), bodies[body].point("centre"), at=shell.point(corner).position
            )
        )
    drills, found = shell.model.drilling_for(scene.held_rotations()[shell.model])
    assert drills
    membrane = np.isclose(found, SHEAR * 0.01, rtol=1e-12)
    assert membrane.sum() == stiff
    assert found[~membrane].max() < 1e-3 * SHEAR * 0.01


@pytest.mark.parametrize("law", [fl.contact.Penalty, fl.contact.Impact])
@pytest.mark.parametrize(
    ("radius", "friction", "stiff"), [(0.01, 0.3, 1), (0.01, 0.0, 0), (0.0, 0.3, 0)]
)
def test_cells_resist_moments_of_friction_at_a_node(law, radius, friction, stiff):
    """Forces on a ball about a node have a moment about it, forces at the node itself none."""
    scene, shell = fl.Scene(), plate(0.01)
    scene.add(shell)
    balls = fl.contact.Vertices([shell.point("00")], radius)
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, -1))
    scene.add(fl.contact.Contact(balls, floor, law(friction=friction)))
    for each in (scene, scene.without_impacts()):
        drills, found = shell.model.drilling_for(each.held_rotations().get(shell.model, ()))
        assert drills
        assert np.isclose(found, SHEAR * 0.01, rtol=1e-12).sum() == stiff


def test_five_parameters_do_for_contacts_at_nodes():
    scene, shell = fl.Scene(), plate(0.01, None)
    scene.add(shell)
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, -1))
    ball = fl.contact.Sphere(shell.point("00"), 0.01)
    scene.add(fl.contact.Contact(ball, floor, fl.contact.Impact(friction=0.3)))
    assert not scene.has_drilling(shell)


def test_an_unloaded_shell_of_warped_cells_has_no_drilling_stress():
    mesh = fl.mesh.parametric_surface(
        lambda a, b: (a + 0.2 * b * b, b + 0.1 * a * a, 0.8 * a * b), (3, 2)
    )
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.1, MATERIAL), drilling=True, kink_angle=1.5)
    scene = fl.Scene()
    scene.add(shell)
    system = Assembled(scene, dynamics=False)
    assert np.abs(system.residual(system.start)).max() <= 1e-13 * SHEAR


def test_frames_with_joints_are_not_carried_along():
    """The axes of the joint are written in them."""
    scene, shell = fl.Scene(), plate(0.1, None, convected_axes=True)
    scene.add(shell)
    scene.add(fl.joints.Spherical(shell.point("00"), fl.ground()))
    system = Assembled(scene, dynamics=False)
    joint = system.equations.unknowns.bodies[shell][shell.point("00").node]
    motion = lie.se3_exp(np.array([0.1, 0.2, 0.3, 0.5, -0.4, 2.0]))
    moved = lie.se3_compose(motion, system.start[: system.count])
    wrong = moved.copy()
    wrong[:, 1], wrong[:, 2] = moved[:, 2], -moved[:, 1]  # a quarter of a turn ahead
    before = wrong[joint].copy()
    system.equations.history_variables.rotate_axes(wrong)
    others = np.arange(system.count) != joint
    np.testing.assert_allclose(wrong[others], moved[others], atol=1e-13)
    np.testing.assert_array_equal(wrong[joint], before)
