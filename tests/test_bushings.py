"""Bushings: one-cell beams, closed forms, schemes, messages."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

LENGTH = 0.4
STIFFNESS = np.diag([2e4, 1e4, 1.2e4, 3.0, 4.0, 5.0])
STIFFNESS[1, 5] = STIFFNESS[5, 1] = 60.0
FORCE, MOMENT = (3.0, -4.0, 2.0), (1.0, 2.0, -3.0)


def test_bushing_is_a_beam_of_one_cell():
    """Large rotations under force and moment, with coupling of shear and bending."""
    plain = fl.elements.GeodesicBeam(bending_flexibility=False)
    section = fl.Section.from_stiffness(STIFFNESS)
    cell = fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=1, formulation=plain)
    beam, mount = fl.Scene(), fl.Scene()
    beam.add(cell)
    beam.add(fl.Clamp(cell.point("start")))
    root, tip = (mount.add(fl.RigidBody(1.0, (1, 1, 1), position=(x, 0, 0))) for x in (0.0, LENGTH))
    mount.add(fl.Clamp(root.point("centre")))
    ends = root.point("centre"), tip.point("centre")
    axes = cell.frames[0, 1:].T
    bushing = mount.add(fl.joints.Bushing(*ends, STIFFNESS / LENGTH, rotation=axes))
    newton = fl.schemes.Newton(tolerance=1e-13)
    results = []
    for scene, point in ((beam, cell.point("end")), (mount, tip.point("centre"))):
        scene.add(fl.PointLoad(point, force=FORCE, moment=MOMENT))
        results.append(fl.statics(scene, load_steps=8, newton=newton))
    a, b = (result.frames[-1] for result in results)
    turned = lie.so3_log(lie.rotation(a[1]) @ axes.T)
    assert np.linalg.norm(turned) > 0.3
    np.testing.assert_allclose(b[1, 0], a[1, 0], atol=1e-13)
    np.testing.assert_allclose(lie.rotation(b[1]), lie.rotation(a[1]) @ axes.T, atol=1e-13)
    # equilibrium: force of the bushing on its first point, in the axes there
    force = axes @ results[1].joint_force(bushing)[-1, :3]
    np.testing.assert_allclose(force, FORCE, rtol=1e-9)


@pytest.mark.parametrize("axis", range(6))
def test_damped_oscillation_along_each_component(axis):
    """q = exp(−δt) (cos ωt + δ/ω sin ωt) for a mass, or a moment of inertia, of 2."""
    k, c, step = 50.0, 0.8, 2e-3
    delta, omega = c / 4.0, np.sqrt(k / 2.0 - (c / 4.0) ** 2)
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, (2.0, 2.0, 2.0)))
    speed = np.zeros(6)
    speed[axis] = 0.3
    centre = body.point("centre")
    body.add_velocity(speed[:3], omega=speed[3:], about=centre)
    scene.add(fl.joints.Bushing(fl.ground(), centre, k * np.ones(6), c * np.ones(6)))
    result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=1.0, step=step)
    turn = lie.so3_log(lie.rotation(result.frames[-1, 0]))
    found = np.concatenate([result.position(centre)[-1], turn])
    exact = 0.3 / omega * np.exp(-delta) * np.sin(omega) * np.eye(6)[axis]
    np.testing.assert_allclose(found, exact, atol=2e-6)
    assert result.energy_error < 1e-4


def mounted(damping=None):
    scene = fl.Scene(gravity=(0, 0, -9.81))
    body = scene.add(fl.RigidBody(2.0, (0.1, 0.2, 0.3), position=(0.1, 0.2, 0.3)))
    body.add_velocity(omega=(1.0, 2.0, -1.0), about=(0.1, 0.2, 0.3))
    corner = body.point((0.2, 0.3, 0.1))
    scene.add(fl.joints.Bushing(fl.ground(), corner, (900, 800, 700, 3, 4, 5), damping))
    return scene


def test_schemes_that_keep_the_energy_and_agree():
    ends = []
    for scheme in (fl.GeneralisedAlpha(radius=1.0), fl.schemes.Variational(), fl.Explicit()):
        result = scheme.run(mounted(), duration=0.5, step=5e-4)
        assert result.elastic.max() > 0.1
        assert result.energy_error < 2e-4
        ends.append(result.frames[-1])
    np.testing.assert_allclose(ends[1], ends[0], atol=2e-5)
    np.testing.assert_allclose(ends[2], ends[0], atol=2e-5)


def test_other_schemes_say_what_they_do_not_take():
    with pytest.raises(ValueError, match=r"does not support springs of bushings \(Bushing\)"):
        fl.EnergyMomentum().run(mounted(), duration=0.1, step=1e-3)
    with pytest.raises(ValueError, match="damping by strain rates and dampers"):
        fl.Explicit().run(mounted(np.ones(6)), duration=0.1, step=1e-3)


def test_resumed_to_the_last_bit(tmp_path):
    plan = {"duration": 0.2, "step": 1e-3, "checkpoint_every": 50}
    scheme, path = fl.GeneralisedAlpha(), tmp_path / "run.h5"
    whole = scheme.run(mounted(np.ones(6)), file=path, **plan)
    again = scheme.resume(mounted(np.ones(6)), path)
    np.testing.assert_array_equal(again.frames, whole.frames)
    with pytest.raises(ValueError, match="bushing of Bushing"):
        scheme.resume(mounted(2.0 * np.ones(6)), path)


def test_half_a_turn_is_refused():
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0)))
    body.add_velocity(omega=(0.0, 0.0, 3.0), about=(0, 0, 0))
    weak = 1e-3 * np.ones(6)
    scene.add(fl.joints.Bushing(fl.ground(), body.point("centre"), weak, name="mount"))
    with pytest.raises(fl.ConvergenceError, match=r"mount is rotated by 2\.99") as error:
        fl.GeneralisedAlpha().run(scene, duration=2.0, step=1e-3)
    assert error.value.result.times[-1] == pytest.approx(0.99, abs=0.02)


ASYMMETRIC = np.eye(6)
ASYMMETRIC[0, 1] = 0.5
WRONG = {
    "five values": ({"stiffness": np.ones(5)}, "six values or a matrix of shape"),
    "negative": ({"stiffness": -np.ones(6)}, "positive semidefinite"),
    "not symmetric": ({"stiffness": ASYMMETRIC}, "must be symmetric"),
    "zeros": ({"stiffness": np.zeros(6)}, "expected a stiffness or a damping, got zeros only"),
    "damping": ({"stiffness": np.ones(6), "damping": (1, 2)}, "damping must be six values"),
    "axes": ({"stiffness": np.ones(6), "rotation": 2 * np.eye(3)}, "rotation must be a proper"),
    "at": ({"stiffness": np.ones(6), "at": (1, 2)}, "at must be 3"),
}


@pytest.mark.parametrize(("how", "match"), WRONG.values(), ids=WRONG)
def test_wrong_bushings(how, match):
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    with pytest.raises(ValueError, match=match):
        scene.add(fl.joints.Bushing(fl.ground(), body.point("centre"), name="mount", **how))


def test_wrong_points():
    body = fl.RigidBody(1.0, (1, 1, 1))
    scene, centre = fl.Scene(), body.point("centre")
    scene.add(body)
    with pytest.raises(ValueError, match="joins a point to itself"):
        scene.add(fl.joints.Bushing(centre, centre, np.ones(6)))
    with pytest.raises(ValueError, match="both points are ground"):
        scene.add(fl.joints.Bushing(fl.ground(), fl.ground(), np.ones(6)))
    with pytest.raises(TypeError, match="Bushing: a must be a point"):
        fl.joints.Bushing(3.0, centre, np.ones(6))
