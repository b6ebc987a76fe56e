"""Shells in motion: supports along fixed axes, starts, moving loads."""

import numpy as np
import pytest

import fem_lie as fl

SOFT = fl.Material(100.0, 0.3, 2.0)
LAYER = fl.ShellSection.layer(0.1, SOFT)
AXIS = np.array([0.6, 0.0, 0.8])


def spinning(
    guided: bool, group: fl.lie.Group, *, joint: bool = False
) -> tuple[fl.Scene, fl.Shell]:
    """A plate that turns about z; one corner, which moves along y, is held along x and z."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (1.0 + a, b, 0.0), (3, 3)), LAYER, name="plate"
    ).set_group(group)
    scene = fl.Scene(gravity=(0.0, 0.0, -0.1))
    scene.add(shell)
    shell.add_velocity(omega=(0, 0, 0.5), about=(0, 0, 0))
    for axis in (AXIS, np.cross(AXIS, [0, 1, 0])):
        if guided:
            shell.roller("00", axis)
        else:
            scene.add(fl.joints.InPlane(fl.ground(), shell.point("00"), axis=axis))
    if joint:
        block = scene.add(fl.RigidBody(0.5, (0.1, 0.1, 0.1), shell.point("11").position))
        block.add_velocity(omega=(0, 0, 0.5), about=(0, 0, 0))
        scene.add(fl.joints.Spherical(block.point("centre"), shell.point("11")))
    return scene, shell


def run(scene: fl.Scene, step: float = 0.05, **options) -> fl.Result:
    return fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10, **options).run(
        scene, duration=1.0, step=step
    )


@pytest.mark.parametrize("joint", [False, True])
@pytest.mark.parametrize("cayley", [False, True])
def test_guides_in_time_are_joints_without_multipliers(joint, cayley):
    """The same motion; what the start does to waves that no step resolves is of second order."""
    options = {"parametrisation": fl.lie.Parametrisation(int(cayley))}
    gaps = []
    for step in (0.05, 0.025):
        guided, _ = spinning(True, fl.lie.Group.R3xSO3, joint=joint)
        joined, _ = spinning(False, fl.lie.Group.R3xSO3, joint=joint)
        held, bound = run(guided, step, **options), run(joined, step, **options)
        gaps.append(np.abs(held.frames[:, :, 0] - bound.frames[:, :, 0]).max())
        path = held.position("plate.00") - held.position("plate.00")[0]
        assert np.abs(path @ AXIS).max() <= 1e-14
        assert np.abs(path[:, 1]).max() > 0.1
    assert gaps[0] <= 1e-4
    assert gaps[1] <= gaps[0] / 3


def test_guided_nodes_move_on_their_own_group():
    """On SE(3) for all others the motion is the same, of second order in the step."""
    gaps = []
    for step in (0.05, 0.025):
        apart, _ = spinning(True, fl.lie.Group.R3xSO3)
        screw, _ = spinning(True, fl.lie.Group.SE3)
        first, second = run(apart, step), run(screw, step)
        gaps.append(np.abs(first.frames[-1, :, 0] - second.frames[-1, :, 0]).max())
        path = second.position("plate.00") - second.position("plate.00")[0]
        assert np.abs(path[:, [0, 2]]).max() <= 1e-14
    assert gaps[1] <= gaps[0] / 3


def test_vibrations_of_guided_shells():
    """At rest and about a loaded state, as with joints."""

    def eigenvalues(guided: bool, loaded: bool) -> np.ndarray:
        shell = fl.Shell(fl.mesh.parametric_surface(lambda a, b: (2 * a, b, 0.0), (4, 2)), LAYER)
        shell.hinge("a=0")
        scene = fl.Scene()
        scene.add(shell)
        if guided:
            shell.roller("10", AXIS)
        else:
            scene.add(fl.joints.InPlane(fl.ground(), shell.point("10"), axis=AXIS))
        if loaded:
            scene.add(fl.AreaLoad(shell, (0, 0, -0.01)))
        modes = fl.vibrations(scene, 4)
        # the part of the guided corner along the axis
        corner = modes.shapes[:, modes.info.node(shell.point("10"))]
        frame = modes.frames[modes.info.node(shell.point("10")), 1:]
        assert np.abs(corner[:, :3] @ frame @ AXIS).max() <= 1e-9
        return np.abs(modes.eigenvalues)

    for loaded in (False, True):
        held, bound = (eigenvalues(guided, loaded) for guided in (True, False))
        np.testing.assert_allclose(held, bound, rtol=1e-6)


def test_inertial_components_know_no_fixed_axes():
    scene, _ = spinning(True, fl.lie.Group.SE3)
    with pytest.raises(ValueError, match=r"MatrixFrame\.LOCAL"):
        run(scene, matrix_frame=fl.schemes.MatrixFrame.INERTIAL)


def test_velocities_of_what_is_held_are_refused():
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2)), LAYER, name="plate"
    )
    shell.clamp("a=0")
    shell.add_velocity((0, 0, 1.0))
    scene = fl.Scene()
    scene.add(shell)
    with pytest.raises(ValueError, match="node 0 of plate is held"):
        run(scene)
    guided, shell = spinning(True, fl.lie.Group.SE3)
    shell.add_velocity((0.1, 0, 0))
    with pytest.raises(ValueError, match="node 0 of plate is held"):
        run(guided)
