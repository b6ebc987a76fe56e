"""Munthe-Kaas' scheme on trees: order, joints, forces, balances, adaptive steps, bad input."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fem_lie as fl
from demos import heavy_top
from fem_lie import joints
from tests.test_composed import resumed_as_whole
from tests.test_contact import RADIUS, dropped, flight

SCHEME = fl.schemes.MuntheKaas()
QUIET = {"progress": False}


def turned(vector, R):
    return tuple(R @ np.asarray(vector, dtype=float))


def tree(R=None, shift=(0.0, 0.0, 0.0), *, springs=True):
    """A body on each type of joint, in branches and both orders, with springs and dampers.

    All of it is rotated by ``R`` and moved by ``shift``.
    """
    R = np.eye(3) if R is None else R
    rng, ground = np.random.default_rng(3), fl.ground()
    scene = fl.Scene(gravity=turned((1.0, -2.0, -9.81), R))
    made = {}

    def at(x):
        return tuple(R @ np.asarray(x, dtype=float) + shift)

    def join(kind, before, place, centre, **options):
        directions = {k: turned(v, R) if k != "pitch" else v for k, v in options.items()}
        body = fl.RigidBody(1.0 + rng.random(), np.diag((0.1, 0.15, 0.2)), at(centre), rotation=R)
        scene.add(body)
        near = ground if before is None else before.point("centre")
        ends = near, body.point("centre")
        if rng.random() < 0.5:
            ends = ends[::-1]
        made[kind.__name__] = scene.add(kind(*ends, at=at(place), **directions))
        return body

    b1 = join(joints.Spherical, None, (0, 0, 0), (0.5, 0, 0))
    b2 = join(joints.Revolute, b1, (0.8, 0.1, 0), (1, 0.3, 0), axis=(1, 2, 3))
    across = {"axis": (1, 0, 0), "second": (0, 0, 1)}
    b3 = join(joints.Universal, b2, (1, 0.6, 0), (1, 0.9, 0.1), **across)
    b4 = join(joints.Fixed, b3, (1, 1, 0.1), (1, 1.3, 0.1))
    b5 = join(joints.Cylindrical, b1, (0.5, -0.2, 0), (0.5, -0.5, 0), axis=(1, 1, 0))
    b6 = join(joints.Screw, b5, (0.5, -0.8, 0), (0.5, -1, 0.2), axis=(0, 1, 2), pitch=0.3)
    b7 = join(joints.Planar, b6, (0.3, -1.2, 0.1), (0.2, -1.4, 0.2), axis=(1, 0, 2))
    b8 = join(joints.Prismatic, b7, (0.1, -1.4, 0.5), (0.1, -1.4, 0.8), axis=(0, 1, 1))
    for _ in range(2):
        join(joints.InPlane, None, (0, 0.8, 0), (0, 1, 0), axis=(0, 1, 1))
    free = fl.RigidBody(1.0, np.diag((0.1, 0.2, 0.3)), at((5, 0, 0)), rotation=R)
    scene.add(free)
    free.add_velocity(omega=turned((1, 2, 3), R), about=at((4.5, 0, 0)))
    for _ in range(2):
        across = {"axis": (0, 1, 0), "second": (1, 0, 0)}
        free = join(joints.Universal, free, (5, 0.2, 0), (5, 0.5, 0), **across)
        free.add_velocity(omega=turned((1, 2, 3), R), about=at((4.5, 0, 0)))
    if springs:
        hinge, slider = made["Revolute"].angle, made["Prismatic"].displacement
        scene.add(joints.Spring(hinge, stiffness=5.0, damping=0.3))
        scene.add(joints.Spring(slider, stiffness=50.0, damping=1.0))
        rope = joints.Distance(b4.point("centre"), b8.point("centre"))
        anchor = joints.Distance(ground, free.point("centre"), at=at((4, 0, 0)))
        for each in (rope, anchor):
            scene.add(each)
            scene.add(joints.Spring(each.length, stiffness=20.0, damping=1.0))
    return scene


@pytest.mark.parametrize("springs", [False, True])
def test_all_joints_as_generalised_alpha(springs):
    plan = {"duration": 0.2, "save_every": 50} | QUIET
    scene = tree(springs=springs)
    result = SCHEME.run(scene, step=2e-3, **plan | {"save_every": 25})
    alpha = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-10)
    coarse, fine = (
        alpha.run(tree(springs=springs), step=h, **plan | {"save_every": round(0.05 / h)})
        for h in (1e-3, 5e-4)
    )
    for name in ("frames", "velocities"):
        other = (4.0 * getattr(fine, name) - getattr(coarse, name)) / 3.0
        assert np.abs(getattr(result, name) - other).max() < 3e-7, name
    force = (4.0 * fine.joint_forces - coarse.joint_forces) / 3.0
    assert np.abs(result.joint_forces[1:] - force[1:]).max() < 1e-3 * np.abs(force).max()
    assert result.energy_error < 1e-8
    assert result.momentum_error < 1e-9
    assert result.angular_momentum_error < 1e-9
    assert max(result.joint_violation(j).max() for j in scene.joints) < 1e-13


def test_order_four():
    ends = [
        SCHEME.run(tree(), duration=0.4, step=h, save_every=1000, **QUIET).frames[-1]
        for h in (2e-2, 1e-2, 5e-3)
    ]
    errors = [np.abs(end - ends[-1]).max() for end in ends[:2]]
    # the last one has an error of its own: 255/15 for order four
    assert 14.0 < errors[0] / errors[1] < 21.0


def test_objective():
    R, shift = Rotation.from_rotvec((0.4, -1.2, 2.0)).as_matrix(), np.array([3.0, -2.0, 1.0])
    plan = {"duration": 0.2, "step": 1e-2} | QUIET
    here, there = SCHEME.run(tree(), **plan), SCHEME.run(tree(R, shift), **plan)
    moved = np.einsum("ij,tnkj->tnki", R, here.frames)
    moved[:, :, 0] += shift
    assert np.abs(moved - there.frames).max() < 1e-12
    assert np.abs(here.velocities - there.velocities).max() < 1e-11
    # their axes across that of the joint are arbitrary
    sizes = [
        np.linalg.norm(each.joint_forces.reshape(21, -1, 2, 3), axis=3) for each in (here, there)
    ]
    assert np.abs(sizes[0] - sizes[1]).max() < 1e-9


def test_restarts_from_a_state_in_motion():
    first = SCHEME.run(tree(), duration=0.2, step=2e-3, **QUIET)
    second = tree()
    fl.adaptivity.transfer(first, tree(), second)
    whole = SCHEME.run(tree(), duration=0.4, step=2e-3, **QUIET)
    after = SCHEME.run(second, duration=0.2, step=2e-3, **QUIET)
    assert np.abs(after.frames[-1] - whole.frames[-1]).max() < 1e-11
    assert np.abs(after.velocities[-1] - whole.velocities[-1]).max() < 1e-10
    # the joints go on counting their turns
    assert np.abs(after.joint_forces[-1] - whole.joint_forces[-1]).max() < 1e-8


def test_heavy_top():
    """Published initial values; the reference has ten digits."""
    errors = []
    for step in (1e-3, 5e-4):
        result = SCHEME.run(heavy_top.top(fl.lie.Group.SE3), duration=0.2, step=step, **QUIET)
        errors.append(heavy_top.errors(result)[0])
    assert errors[1] < 4e-6
    assert 13.0 < errors[0] / errors[1] < 19.0
    assert result.energy_error < 1e-6


def two_arms(kind, **options):
    scene = fl.Scene(gravity=(0, 0, -9.81))
    upper = scene.add(fl.RigidBody(1.0, (1e-3, 0.09, 0.09), (0.5, 0, 0)))
    lower = scene.add(fl.RigidBody(1.0, (1e-3, 0.09, 0.09), (1.0, 0.5, 0), name="lower"))
    scene.add(joints.Revolute(fl.ground(), upper.point("centre"), at=(0, 0, 0), axis=(0, 1, 0)))
    ends = upper.point("centre"), lower.point("centre")
    scene.add(kind(*ends, at=(1, 0, 0), **options))
    return scene


@pytest.mark.parametrize(
    ("kind", "options"),
    [
        (joints.Revolute, {"axis": (1, 0, 0)}),
        (joints.Universal, {"axis": (1, 0, 0), "second": (0, 0, 1)}),
    ],
)
def test_double_pendulum_as_the_conserving_scheme(kind, options):
    plan = {"duration": 0.5, "save_every": 1000} | QUIET
    result = SCHEME.run(two_arms(kind, **options), step=5e-3, **plan)
    coarse, fine = (
        fl.EnergyMomentum().run(two_arms(kind, **options), step=h, **plan) for h in (5e-4, 2.5e-4)
    )
    exact = (4.0 * fine.frames[-1] - coarse.frames[-1]) / 3.0
    assert np.abs(result.frames[-1] - exact).max() < 1e-7


def test_energy_drifts_with_the_fourth_power_or_better():
    drift = [
        SCHEME.run(two_arms(joints.Spherical), duration=2.0, step=h, **QUIET).energy_error
        for h in (2e-2, 1e-2)
    ]
    assert drift[1] < 1e-4
    assert drift[0] / drift[1] > 14.0


def test_angles_count_turns():
    scene = fl.Scene()
    wheel = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1)))
    hinge = scene.add(joints.Revolute(fl.ground(), wheel.point("centre"), axis=(0, 0, 1)))
    wheel.add_velocity(omega=(0, 0, 20.0), about=(0, 0, 0))
    scene.add(joints.Spring(hinge.angle, stiffness=0.01))
    result = SCHEME.run(scene, duration=2.0, step=0.05, save_every=40, **QUIET)
    rate = np.sqrt(0.1)
    exact = 20.0 / rate * np.sin(rate * 2.0)
    assert abs(result.coordinate(hinge, "angle")[-1] - exact) < 1e-5


# --- forces that need Python ---


def loaded(history):
    scene = tree()
    body = scene.bodies[3]
    scene.add(fl.PointLoad(body.point("centre"), force=(3.0, 0.0, 1.0), history=history))
    return scene


def test_loads_that_change_in_time():
    def history(t):
        return np.sin(20.0 * t)

    ends = [
        SCHEME.run(loaded(history), duration=0.2, step=h, save_every=1000, **QUIET)
        for h in (1e-2, 5e-3, 2.5e-3)
    ]
    errors = [np.abs(end.frames[-1] - ends[-1].frames[-1]).max() for end in ends[:2]]
    assert 13.0 < errors[0] / errors[1] < 22.0
    assert ends[-1].energy_error < 1e-9


def test_loads_that_jump():
    """Steps end at the jump, so that the order remains."""
    history = fl.loads.PiecewiseLinear((0.0, 0.0503, 0.0503, 1.0), (0.0, 0.0, 1.0, 1.0))
    ends = [
        SCHEME.run(loaded(history), duration=0.2, step=h, save_every=1000, **QUIET)
        for h in (1e-2, 5e-3, 1.25e-3)
    ]
    errors = [np.abs(end.frames[-1] - ends[-1].frames[-1]).max() for end in ends[:2]]
    assert errors[0] < 1e-6
    assert errors[0] / errors[1] > 10.0


def bouncing(law):
    return dropped(law)[0]


def test_contact_by_penalty():
    result = SCHEME.run(bouncing(fl.contact.Penalty(1e3)), duration=2.0, step=5e-4, **QUIET)
    height = result.frames[:, 0, 0, 2] - RADIUS
    assert np.abs(height - flight(result.times, 1e3)).max() < 1e-4
    assert result.energy_error < 1e-4
    assert result.momentum_error < 1e-4


# --- the general driver ---


def test_adaptive_steps():
    exact = SCHEME.run(tree(), duration=0.4, step=1e-3, save_every=400, **QUIET).frames[-1]
    errors, counts = [], []
    for tolerance in (1e-3, 1e-5):
        choice = fl.schemes.AdaptiveStep(tolerance=tolerance, refinement=2)
        result = SCHEME.run(tree(), duration=0.4, step=choice, **QUIET)
        errors.append(np.abs(result.frames[-1] - exact).max())
        counts.append(len(result.steps.sizes))
        ratio = result.steps.translation / result.steps.sizes
        assert ratio.max() <= tolerance
        # an upper estimate: that of the scheme of order three
        assert np.median(result.steps.measured_translation / result.steps.translation) < 1.0
    assert errors[0] < 1e-3
    assert errors[1] < 1e-5
    # error per step size of order three: 4.6 times as many
    assert 2.5 < counts[1] / counts[0] < 7.0


@pytest.mark.parametrize(
    "step", [4e-3, fl.schemes.AdaptiveStep(tolerance=1e-3)], ids=["equal", "adaptive"]
)
@pytest.mark.parametrize("scene", [tree, lambda: loaded(np.sin)], ids=["constant", "in time"])
def test_resumed_to_the_last_bit(tmp_path, scene, step):
    plan = {"duration": 0.12, "step": step}
    resumed_as_whole(SCHEME, scene, plan, tmp_path / "run.h5")


def test_too_large_steps():
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    slider = scene.add(joints.Prismatic(fl.ground(), body.point("centre"), axis=(1, 0, 0)))
    scene.add(joints.Spring(slider.displacement, stiffness=1e6, rest=0.1))
    with pytest.raises(fl.ConvergenceError, match="must resolve the fastest motion"):
        SCHEME.run(scene, duration=50.0, step=0.1, **QUIET)


# --- bad input ---


def test_loop():
    scene = two_arms(joints.Spherical)
    lower = scene.bodies[1].point("centre")
    scene.add(joints.InPlane(fl.ground(), lower, at=(1, 0.5, 0), axis=(0, 0, 1), name="table"))
    with pytest.raises(ValueError, match=r"trees of bodies, and .* closes a loop"):
        SCHEME.run(scene, duration=1.0, step=0.01)


def test_flexible_bodies():
    section = fl.Section.circle(0.01, fl.Material(2e11, 0.3, 7800.0))
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2, name="blade")
    scene = fl.Scene()
    scene.add(beam)
    with pytest.raises(ValueError, match=r"MuntheKaas does not support flexible bodies.*blade"):
        SCHEME.run(scene, duration=1.0, step=0.01)


def with_drive():
    scene = two_arms(joints.Spherical)
    scene.add(joints.Drive(scene.joints[0].angle, lambda t: t, name="motor"))
    return scene


def with_clamp():
    scene = two_arms(joints.Spherical)
    scene.add(fl.Clamp(scene.bodies[0].point("centre")))
    return scene


def with_edge():
    scene = fl.Scene()
    sledge = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    scene.add(joints.KnifeEdge(fl.ground(), sledge.point("centre"), axis=(0, 1, 0)))
    return scene


def with_impact():
    return bouncing(fl.contact.Impact(restitution=0.5))


def own_joint():
    class OnLine(joints.Joint):
        selection = fl.extend.rows({0: 1.0}, {1: 1.0})

    scene = fl.Scene()
    bead = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    scene.add(OnLine(fl.ground(), bead.point("centre"), name="bead on a wire"))
    return scene


@pytest.mark.parametrize(
    ("scene", "what"),
    [
        (with_drive, r"drives and gears.*motor"),
        (with_clamp, r"clamps"),
        (with_edge, r"velocity constraints.*KnifeEdge"),
        (with_impact, r"contact with impacts or friction"),
        (own_joint, r"bead on a wire, which is none of Fixed, Spherical"),
    ],
)
def test_unsupported_scenes(scene, what):
    with pytest.raises(ValueError, match=f"MuntheKaas does not support {what}"):
        SCHEME.run(scene(), duration=1.0, step=0.01)
