"""Interrupted runs of solids and thin shells go on to the last bit, driven by attachments, too."""

import numpy as np
import pytest

import fem_lie as fl
from tests.test_resume import same, stopped

LAW = fl.sections.NeoHooke(2e5, 0.3, 1000.0)


def free_brick() -> fl.Scene:
    """Whose axes have turned far when it goes on."""
    body = fl.Solid.brick((0.2, 0.1, 0.1), LAW, cells=(2, 1, 1), name="brick")
    body.add_velocity(omega=(3.0, 2.0, 30.0), about=(0, 0, 0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    return scene


def driven_brick() -> fl.Scene:
    """By an attachment in the mean, which a drive turns."""
    scene = fl.Scene()
    body = scene.add(fl.Solid.brick((0.2, 0.1, 0.1), LAW, cells=(2, 1, 1), name="brick"))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), body.point("a=0"), axis=(0, 0, 1)))
    scene.add(fl.joints.Drive(hinge.angle, lambda t: 400.0 * t**2))
    return scene


def mass_on_a_block() -> fl.Scene:
    """Large enough that the attachment of the mass is not in the pattern of the matrix."""
    scene = fl.Scene()
    mesh = fl.mesh.parametric_volume(lambda a, b, c: (0.1 * a, 0.1 * b, 0.05 * c), (8, 8, 8))
    block = scene.add(fl.Solid(mesh, LAW, name="block"))
    for node in block.points("c=0"):
        scene.add(fl.Clamp(node))
    mass = scene.add(fl.RigidBody(1.0, (1e-3,) * 3, position=(0.05, 0.05, 0.1)))
    scene.add(fl.joints.Fixed(block.point("c=1"), mass.point("centre"), at=(0.05, 0.05, 0.05)))
    scene.add(fl.PointLoad(mass.point("centre"), force=(150.0, 0.0, -50.0), moment=(0.0, 0.0, 2.0)))
    return scene


def sheet(**options) -> fl.ThinShell:
    patch = fl.mesh.smooth_patch(lambda a, b: [0.3 * a, 0.2 * b, 0.02 * a * b], (2, 1))
    section = fl.ShellSection.layer(1e-3, fl.Material(3e9, 0.3, 1200.0))
    return fl.ThinShell(patch, section, name="sheet", **options)


def free_sheet() -> fl.Scene:
    scene, body = fl.Scene(), sheet()
    body.add_velocity(omega=(3.0, 30.0, 5.0), about=(0.1, 0.1, 0))
    scene.add(body)
    return scene


def driven_sheet() -> fl.Scene:
    """By an attachment within a cell."""
    scene = fl.Scene()
    body = scene.add(sheet())
    hinge = scene.add(
        fl.joints.Revolute(fl.ground(), body.point_in_cell(0, 0.2, 0.4), axis=(0, 1, 0))
    )
    scene.add(fl.joints.Drive(hinge.angle, lambda t: 400.0 * t**2))
    return scene


MADE = free_brick, driven_brick, mass_on_a_block, free_sheet, driven_sheet
SCENES = {make.__name__: make for make in MADE}


@pytest.mark.parametrize("name", SCENES)
def test_resumed_is_uninterrupted_to_the_last_bit(tmp_path, name):
    scheme = fl.GeneralisedAlpha(
        radius=0.8, tolerance=1e-8, policy=fl.schemes.Automatic(cost=2, refresh=8)
    )
    plan = {"duration": 0.04, "step": 1e-3}
    whole = scheme.run(SCENES[name](), **plan)
    file = tmp_path / "run.h5"
    stopped(scheme, SCENES[name](), file, 27, **plan)
    again = scheme.resume(SCENES[name](), file)
    same(again, whole)
    np.testing.assert_array_equal(again.balance, whole.balance)
    turned = np.abs(whole.frames[27, :, 0] - whole.frames[0, :, 0]).max()
    assert turned > 0.01  # so that there is something to be remembered
