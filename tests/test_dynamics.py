"""Generalised-α: order, invariants, policies, start, and the joint forces."""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fem_lie as fl
from fem_lie import lie

G = 9.81
LENGTH, MASS, INERTIA = 0.5, 2.0, 0.3
INERTIA_ABOUT_PIVOT = INERTIA + MASS * LENGTH**2


groups = pytest.mark.parametrize("group", list(fl.lie.Group))
EXP = fl.lie.Parametrisation.EXPONENTIAL
maps = pytest.mark.parametrize("parametrisation", list(fl.lie.Parametrisation))


def pendulum(
    angle: float = 0.0, speed: float = 0.0, group: fl.lie.Group = fl.lie.Group.SE3
) -> tuple[fl.Scene, fl.RigidBody]:
    """Compound pendulum about y through the origin, at rest along the x axis."""
    scene = fl.Scene(gravity=(0, 0, -G))
    point_at = LENGTH * np.array([np.cos(angle), 0, -np.sin(angle)])
    R = lie.so3_exp([0, angle, 0])
    body = scene.add(fl.RigidBody(MASS, (0.1, INERTIA, 0.25), point_at, R).set_group(group))
    scene.add(
        fl.joints.Revolute(
            fl.ground(), body.point("centre"), at=(0, 0, 0), axis=(0, 1, 0), name="pivot"
        )
    )
    body.add_velocity(omega=(0, speed, 0), about=(0, 0, 0))
    return scene, body


def exact_pendulum(times: np.ndarray, angle: float, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Angle below the horizontal and its rate."""
    moment = MASS * G * LENGTH / INERTIA_ABOUT_PIVOT
    solution = solve_ivp(
        lambda t, y: [y[1], moment * np.cos(y[0])],
        (0, times[-1]),
        [angle, speed],
        t_eval=times,
        method="DOP853",
        rtol=1e-12,
        atol=1e-13,
    )
    return solution.y[0], solution.y[1]


def pivot_force(angle: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Force of the body on ground, ``m (g − a)``, global components, shape (T, 3)."""
    rate = MASS * G * LENGTH / INERTIA_ABOUT_PIVOT * np.cos(angle)
    along = np.stack([np.cos(angle), 0 * angle, -np.sin(angle)], 1)
    across = np.stack([-np.sin(angle), 0 * angle, -np.cos(angle)], 1)
    a = LENGTH * (rate[:, None] * across - speed[:, None] ** 2 * along)
    return MASS * (np.array([0, 0, -G]) - a)


@groups
@pytest.mark.parametrize(
    ("radius", "parametrisation"),
    [(0.0, EXP), (0.6, EXP), (0.8, EXP), (1.0, EXP), (0.8, fl.lie.Parametrisation.CAYLEY)],
)
def test_order_of_configuration_velocity_and_multipliers(radius, parametrisation, group):
    angle, speed = 0.3, 1.0
    errors = []
    for step in (1e-2, 5e-3, 2.5e-3):
        scene, body = pendulum(angle, speed, group)
        scheme = fl.GeneralisedAlpha(
            radius=radius, tolerance=1e-10, parametrisation=parametrisation
        )
        result = scheme.run(scene, duration=0.6, step=step)
        phi, rate = exact_pendulum(result.times, angle, speed)
        position = LENGTH * np.stack([np.cos(phi), 0 * phi, -np.sin(phi)], 1)
        force = result.joint_force("pivot")[:, :3]
        # components along the joint's axes on ground, e₃ = y
        frame = scene.joints[0].frame()[1:]
        half = len(result.times) // 2  # multipliers also in the first half: no transient allowed
        errors.append(
            [
                np.abs(result.position(body.point("centre")) - position).max(),
                np.abs(result.velocity(body.point("centre"))[:, 4] - rate).max(),
                np.abs(result.velocity(body.point("centre"))[:, 2] + LENGTH * rate).max(),
                np.abs(force - pivot_force(phi, rate) @ frame.T)[1:half].max(),
                np.abs(force - pivot_force(phi, rate) @ frame.T)[half:].max(),
            ]
        )
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    # with radius 1 nothing damps what starts in the multipliers, and it grows like n h³: only where
    # the joint's motions are a subgroup is there nothing (Arnold, Brüls & Cardona 2015)
    undamped = radius == 1.0 and group is fl.lie.Group.R3xSO3
    assert orders[:, :3].min() > 1.9, orders
    assert orders[:, 3:].min() > (0.9 if undamped else 1.9), orders


def heavy_top(group: fl.lie.Group) -> tuple[fl.Scene, fl.RigidBody]:
    """Brüls & Cardona's top at 150 rad/s, its frame at the centre of mass."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    top = scene.add(
        fl.RigidBody(15.0, (0.234375, 0.46875, 0.234375), (0, 1, 0), name="top").set_group(group)
    )
    scene.add(fl.joints.Spherical(fl.ground(), top.point("centre"), at=(0, 0, 0), name="tip"))
    top.add_velocity(omega=(0, 150, -4.61538), about=(0, 0, 0))
    return scene, top


def force_on_ground(
    scene: fl.Scene, result: fl.Result, step: float
) -> tuple[np.ndarray, np.ndarray]:
    """Of the top, global components, from joint and from its path, without first and last time."""
    x = result.position("top.centre")
    a = (x[2:] - 2 * x[1:-1] + x[:-2]) / step**2
    axes = scene.joints[0].frame()[1:]
    return result.joint_force("tip")[1:-1, :3] @ axes, 15.0 * (np.array([0, 0, -G]) - a)


@pytest.mark.parametrize(
    ("group", "step", "bound"),
    [
        (fl.lie.Group.SE3, 5e-4, 6e-3),
        (fl.lie.Group.SE3, 2.5e-4, 1.5e-3),
        (fl.lie.Group.R3xSO3, 1e-3, 2e-3),
        (fl.lie.Group.R3xSO3, 5e-4, 5e-4),
    ],
)
def test_fast_heavy_top_keeps_one_matrix(group, step, bound):
    """In its own frame nothing turns, so nothing is renewed.

    Reference: centre of mass at 0.2 s, ten digits by two formulations in coordinates. Bounds:
    second order from 2.2e-2 at 1e-3 on SE(3), where the velocity of the centre of mass turns with
    150 rad/s in the body's frame, and from 1.7e-3 on R³×SO(3).
    """
    scene, top = heavy_top(group)
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=0.2, step=step)
    end = [0.60555056138, 0.5989576818, -0.52398302743]
    assert np.linalg.norm(result.position(top.point("centre"))[-1] - end) < bound
    assert result.factorisations == 1
    # full Newton takes two as well: the frozen matrix is as good as a new one
    assert result.iterations[-1] < 2.1 * (len(result.times) - 1)
    force, exact = force_on_ground(scene, result, step)
    assert np.abs(force - exact).max() < 0.01 * np.abs(exact).max()


@groups
@maps
def test_joint_force_of_the_top_is_of_second_order_from_the_first_step(group, parametrisation):
    """R³×SO(3) has a transient of first order in it without ``velocity_defect``."""
    errors = []
    for step in (5e-4, 2.5e-4):
        scheme = fl.GeneralisedAlpha(radius=0.9, parametrisation=parametrisation)
        scene, _ = heavy_top(group)
        result = scheme.run(scene, duration=0.02, step=step)
        force, exact = force_on_ground(scene, result, step)
        errors.append(np.abs(force - exact).max() / np.abs(exact).max())
    assert np.log2(errors[0] / errors[1]) > 1.9, errors
    assert errors[1] < 4e-3


@groups
@maps
def test_full_newton_converges_quadratically_at_any_spin(group, parametrisation):
    """0.15 rad in a step: with ``(BT)ᵀ`` as columns the rate is 0.075, and 6 iterations."""
    scheme = fl.GeneralisedAlpha(
        radius=0.9, policy=fl.schemes.EveryIteration(), parametrisation=parametrisation
    )
    result = scheme.run(heavy_top(group)[0], duration=0.02, step=1e-3)
    assert np.diff(result.iterations).max() <= 3


def mixed_scene(group: fl.lie.Group, turned: np.ndarray | None = None) -> fl.Scene:
    """A beam and a rigid body in space, the body on the other group, all turned first."""
    R = np.eye(3) if turned is None else turned
    other = fl.lie.Group(1 - group)
    section = fl.Section.rectangle(0.02, 0.01, fl.Material(1e8, 0.3, 1000))
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), R[:, 0], section, cells=3, up=R[:, 2]).set_group(group)
    )
    body = scene.add(fl.RigidBody(0.3, (1e-3, 2e-3, 2.5e-3), R @ [1.1, 0.2, 0], R).set_group(other))
    scene.add(
        fl.joints.Revolute(
            beam.point("end"), body.point("centre"), at=R[:, 0], axis=R @ [0, 0.6, 0.8]
        )
    )
    for item in (beam, body):
        item.add_velocity(R @ [1, 2, 3])
        item.add_velocity(omega=R @ [8, -6, 10], about=(0, 0, 0))
    body.add_velocity(omega=R @ [0, 12, 16], about=R[:, 0])
    return scene


@groups
@maps
def test_motion_does_not_depend_on_the_axes(group, parametrisation):
    R = lie.so3_exp([0.7, -1.9, 2.2])
    scheme = fl.GeneralisedAlpha(tolerance=1e-11, parametrisation=parametrisation)
    one, two = (
        scheme.run(mixed_scene(group, turned), duration=0.05, step=1e-3) for turned in (None, R)
    )
    # tolerance times the speed of errors of a stiff body over 50 steps
    np.testing.assert_allclose(two.frames, one.frames @ R.T, atol=1e-8)
    np.testing.assert_allclose(two.velocities, one.velocities, atol=1e-5)


@groups
def test_recorded_velocities_are_those_of_the_frames(group):
    """Twists in the nodes' frames, whatever the integrator keeps; h² of third derivatives."""
    step = 1e-4
    result = fl.GeneralisedAlpha().run(mixed_scene(group), duration=0.02, step=step)
    difference = lie.se3_relative(result.frames[:-2], result.frames[2:]) / (2 * step)
    scale = np.abs(result.velocities).max()
    assert np.abs(result.velocities[1:-1] - difference).max() < 4e-3 * scale
    assert np.abs(result.velocities[0] - result.velocities[1]).max() < 0.02 * scale


@maps
def test_free_flight_is_exact_in_translation_with_translations_apart(parametrisation):
    """A parabola, in 20 large steps of a spinning body."""
    scene = fl.Scene(gravity=(0, 0, -G))
    body = scene.add(fl.RigidBody(2.0, (0.1, 0.2, 0.25), (0, 0, 1)))
    assert body.model.group is fl.lie.Group.R3xSO3
    body.add_velocity((1, 2, 3))
    body.add_velocity(omega=(0.3, 6, 0.2), about=body.point("centre"))
    scheme = fl.GeneralisedAlpha(parametrisation=parametrisation)
    result = scheme.run(scene, duration=1.0, step=0.05)
    t = result.times[:, np.newaxis]
    parabola = [0, 0, 1] + t * [1, 2, 3] - 0.5 * G * t**2 * [0, 0, 1]
    np.testing.assert_allclose(result.position(body.point("centre")), parabola, atol=1e-13)
    velocity = np.einsum(
        "tij,ti->tj", lie.rotation(result.frames[:, 0]), [1, 2, 3] - G * t * [0, 0, 1]
    )
    np.testing.assert_allclose(result.velocity(body.point("centre"))[:, :3], velocity, atol=1e-12)


@groups
@pytest.mark.parametrize("policy", [fl.schemes.Automatic(), fl.schemes.IterationLimit(4)])
def test_components_of_the_matrix_change_nothing_but_its_life(group, policy):
    runs = [
        fl.GeneralisedAlpha(radius=0.9, policy=policy, matrix_frame=components).run(
            heavy_top(group)[0], duration=0.1, step=5e-4
        )
        for components in fl.schemes.MatrixFrame
    ]
    local, inertial = runs
    assert np.abs(local.frames - inertial.frames).max() < 1e-6  # tolerance times 200 steps
    assert inertial.factorisations > 20 * local.factorisations


@groups
def test_components_for_bodies_that_are_held(group):
    """Clamps, joints between bodies and the rescue of a step, in both components."""

    def motion(components: fl.schemes.MatrixFrame) -> np.ndarray:
        section = fl.Section.rectangle(0.02, 0.01, fl.Material(1e9, 0.3, 1000))
        scene = fl.Scene(gravity=(0, 0, -G))
        one = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=3).set_group(group))
        two = scene.add(fl.Beam.straight((1, 0, 0), (1, 1, 0), section, cells=3).set_group(group))
        scene.add(fl.Clamp(one.point("start")))
        scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=(1, 0, 0)))
        two.add_velocity(omega=(20, 0, 0), about=two.point("start"))
        scheme = fl.GeneralisedAlpha(tolerance=1e-10, matrix_frame=components)
        return scheme.run(scene, duration=0.2, step=1e-3).frames

    local, inertial = (motion(components) for components in fl.schemes.MatrixFrame)
    np.testing.assert_allclose(local, inertial, atol=1e-7)


@groups
@pytest.mark.parametrize("radius", [0.0, 0.8])
def test_waves_that_no_step_resolves_do_not_spoil_the_start(group, radius):
    """A load on steel at once, in steps of a hundred periods: extrapolated ``a₀`` was nonsense."""
    section = fl.Section.rectangle(0.02, 0.02, fl.Material(2e11, 0.3, 7800))
    scene = fl.Scene(gravity=(0, 0, -G))
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=8).set_group(group))
    body = scene.add(fl.RigidBody(5.0, (0.1, 0.1, 0.1), (1.3, 0.2, 0)).set_group(group))
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Fixed(beam.point("end"), body.point("centre"), at=(1, 0, 0)))
    result = fl.GeneralisedAlpha(radius=radius).run(scene, duration=0.1, step=4e-3)
    assert result.energy_error < 0.05


@groups
def test_rigid_double_pendulum(group):
    """Two bars falling from the horizontal on spherical joints, 1 s; the free end to 1e-9.

    Reference: Runge-Kutta on the group in minimal coordinates (Pinocchio 3, h = 1e-4; MuJoCo).
    """
    scene, side = fl.Scene(gravity=(0, 0, -G)), 5e-3
    bodies = []
    for start, length in ((0.0, 0.3), (0.3, 0.5)):
        mass = 2700 * side**2 * length
        moments = mass / 12 * np.array([2 * side**2, length**2 + side**2, length**2 + side**2])
        point_at = (start + length / 2, 0, 0)
        bodies.append(scene.add(fl.RigidBody(mass, moments, point_at).set_group(group)))
    one, two = bodies
    scene.add(fl.joints.Spherical(fl.ground(), one.point("centre"), at=(0, 0, 0)))
    scene.add(fl.joints.Spherical(one.point("centre"), two.point("centre"), at=(0.3, 0, 0)))
    errors = []
    for step in (1e-3, 5e-4):
        result = fl.GeneralisedAlpha(tolerance=1e-10).run(scene, duration=1.0, step=step)
        x, e1 = result.frames[-1, result.info.node(two.point("centre")), :2]
        errors.append(np.linalg.norm(x + 0.25 * e1 - [-0.5857718307, 0.0, -0.01018573161]))
    assert errors[1] < 2e-5
    assert np.log2(errors[0] / errors[1]) > 1.9, errors


def flexible_pendulum(
    policy: fl.schemes.RefactorisationPolicy | None = None,
    cells: int = 4,
    max_iterations: int = 30,
    **options,
) -> fl.Result:
    material = fl.Material(70e9, 0.3, 2700)
    section = fl.Section.rectangle(5e-3, 5e-3, material)
    scene = fl.Scene()
    one = scene.add(fl.Beam.straight((0, 0, 0), (0.3, 0, 0), section, cells=cells))
    two = scene.add(fl.Beam.straight((0.3, 0, 0), (0.3, 0.5, 0), section, cells=cells))
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=(1, 0, 0)))
    two.add_velocity(omega=(3, 0, 0), about=two.point("start"))
    scheme = fl.GeneralisedAlpha(
        policy=policy or fl.schemes.Automatic(), max_iterations=max_iterations
    )
    return scheme.run(scene, duration=0.05, step=1e-4, **options)


@pytest.mark.parametrize(
    "policy",
    [
        fl.schemes.EveryIteration(),
        fl.schemes.IterationLimit(4),
        fl.schemes.Automatic(),
        fl.schemes.Automatic(cost=5),
        fl.schemes.FactoriseOnce(),
    ],
)
def test_policies_give_the_same_motion(policy):
    """The iteration matrix changes the way, not the end."""
    reference = flexible_pendulum(fl.schemes.EveryIteration())
    result = flexible_pendulum(policy)
    # tolerance 2e-8 of the motion in a step, added up over 500 steps of 0.3 mm
    assert np.abs(result.frames[-1] - reference.frames[-1]).max() < 1e-7
    assert result.energy_error < 1e-6
    assert result.angular_momentum_error < 1e-6
    if isinstance(policy, fl.schemes.FactoriseOnce):
        assert result.factorisations == 1
    if isinstance(policy, fl.schemes.EveryIteration):
        assert result.factorisations >= len(result.times) - 1


def test_runs_repeat_bit_for_bit():
    one, two = flexible_pendulum(), flexible_pendulum()
    assert (one.frames == two.frames).all()
    assert (one.iterations == two.iterations).all()


def free_flight(step: float, formulation: fl.elements.BeamFormulation) -> fl.Result:
    """Two beams and a body joined in space, no supports."""
    section = fl.Section.rectangle(0.02, 0.01, fl.Material(1e9, 0.3, 1000))
    scene = fl.Scene()
    one, two = (
        scene.add(fl.Beam.straight(*ends, section, cells=4, formulation=formulation))
        for ends in (((0, 0, 0), (1, 0, 0)), ((1, 0, 0), (1, 1, 0)))
    )
    body = scene.add(fl.RigidBody(0.3, (1e-3, 2e-3, 2.5e-3), (1, 1, 0)))
    scene.add(fl.joints.Spherical(one.point("end"), two.point("start")))
    scene.add(fl.joints.Fixed(two.point("end"), body.point("centre")))
    for item in (one, two, body):
        item.add_velocity((1, 2, 3))
        item.add_velocity(omega=(2, 0, 1), about=(0, 0, 0))
    two.add_velocity(omega=(4, 0, 0), about=two.point("start"))
    body.add_velocity(omega=(4, 0, 0), about=two.point("start"))
    # far below the errors that are compared
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)
    return scheme.run(scene, duration=0.1, step=step)


@pytest.mark.parametrize(
    "formulation",
    [
        fl.elements.GeodesicBeam(),
        fl.elements.DirectorBeam(1),
        fl.elements.DirectorBeam(2),
        fl.elements.KirchhoffRod(),
    ],
    ids=str,
)
def test_free_flight_conserves_momenta_to_second_order(formulation):
    """Whatever happens inside; the scheme itself conserves them only as h² → 0."""
    coarse, fine = free_flight(2e-4, formulation), free_flight(1e-4, formulation)
    for name in ("momentum_error", "angular_momentum_error"):
        assert getattr(fine, name) < 1e-6
        assert getattr(coarse, name) > 3.0 * getattr(fine, name)


def test_prescribed_rotation_and_its_driving_moment():
    """A body driven about a fixed axis: J α in the joint, and the centripetal force."""
    scene = fl.Scene()
    offset = 0.4
    body = scene.add(fl.RigidBody(MASS, (0.1, 0.2, INERTIA), (offset, 0, 0)))
    hub = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (0, 0, 0)))
    scene.add(fl.joints.Fixed(hub.point("centre"), body.point("centre"), at=(0, 0, 0)))

    def motion(t: float) -> np.ndarray:
        return lie.frame(np.zeros(3), lie.so3_exp([0, 0, 0.5 * 3.0 * t**2]))

    scene.add(fl.PrescribedMotion(hub.point("centre"), motion))
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=0.5, step=1e-3)
    t = result.times
    point_at = offset * np.stack([np.cos(1.5 * t**2), np.sin(1.5 * t**2), 0 * t], 1)
    assert np.abs(result.position(body.point("centre")) - point_at).max() < 1e-5
    drive = result.joint_forces[:, -1, 5]
    inertia = INERTIA + 0.1 + MASS * offset**2
    assert np.abs(drive - inertia * 3.0)[1:].max() < 1e-3 * inertia * 3.0
    pull = np.linalg.norm(result.joint_force(scene.joints[0])[:, :3], axis=1)
    exact = MASS * offset * np.hypot((3.0 * t) ** 2, 3.0)
    assert np.abs(pull - exact)[1:].max() < 1e-3 * exact.max()


@pytest.mark.parametrize(
    ("formulation", "cells"),
    [
        (fl.elements.GeodesicBeam(), 16),
        (fl.elements.DirectorBeam(1), 16),
        (fl.elements.DirectorBeam(2), 5),
    ],
    ids=str,
)
def test_clamped_beam_vibrates_at_its_frequency(formulation, cells):
    """First bending mode of a cantilever by its free vibration: 1.8751² √(EI/ρA)/L² / 2π."""
    section = fl.Section.rectangle(0.01, 0.01, fl.Material(2e11, 0.3, 7800))
    EI, mass, L = section.stiffness[4, 4], section.inertia[0, 0], 1.0
    scene = fl.Scene()
    line = fl.Beam.straight((0, 0, 0), (L, 0, 0), section, cells=cells, formulation=formulation)
    beam = scene.add(line)
    scene.add(fl.Clamp(beam.point("start")))
    s = beam.frames[:, 0, 0] / L
    k = 1.875104068711961
    shape = np.cosh(k * s) - np.cos(k * s)
    shape -= (np.cosh(k) + np.cos(k)) / (np.sinh(k) + np.sin(k)) * (np.sinh(k * s) - np.sin(k * s))
    slope = np.sinh(k * s) + np.sin(k * s)
    slope -= (np.cosh(k) + np.cos(k)) / (np.sinh(k) + np.sin(k)) * (np.cosh(k * s) - np.cos(k * s))
    slope *= k / L
    beam.velocities[:, 2], beam.velocities[:, 4] = 1e-3 * shape, -1e-3 * slope
    beam.velocities[0] = 0.0
    frequency = k**2 * np.sqrt(EI / mass) / L**2 / (2 * np.pi)
    step = 1 / frequency / 200
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=(4 * 200) * step, step=step)
    z = result.position(beam.point("end"))[:, 2]
    up = np.flatnonzero((z[:-1] < 0) & (z[1:] >= 0))
    crossing = result.times[up] - z[up] * step / (z[up + 1] - z[up])
    measured = (len(crossing) - 1) / (crossing[-1] - crossing[0])
    # space (1/16)², or (1/5)⁴, and time (2π/200)²/12, rotary inertia and shear are below 1e-3
    assert abs(measured / frequency - 1) < 3e-3


def test_save_every_keeps_the_last_step_and_total_iterations():
    full, part = flexible_pendulum(), flexible_pendulum(save_every=7)
    assert part.times[-1] == full.times[-1]
    assert len(part.times) == 500 // 7 + 2
    assert (part.frames[-1] == full.frames[-1]).all()
    assert part.iterations[-1] == full.iterations[-1]


def test_progress_bar_shows_time_energy_and_iterations(capsys):
    result = flexible_pendulum(progress=True)
    bar = capsys.readouterr().err
    assert "500/500" in bar
    # as much as fits the width of a terminal beside the rate
    assert re.search(r"t=0\.05 energy \d\.\de-\d\d it/step \d\.\d", bar), bar
    assert (result.frames == flexible_pendulum(progress=False).frames).all()
    assert capsys.readouterr().err == ""


def test_new_matrices_in_each_iteration_end_where_others_do():
    """In a first step, too, whose rate of convergence is not known yet."""

    def joint_forces(limit: int) -> np.ndarray:
        section = fl.Section.rectangle(0.02, 0.02, fl.Material(2e9, 0.3, 1500.0))
        scene = fl.Scene(gravity=(0, 0, -9.81))
        beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4))
        scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0)))
        scheme = fl.GeneralisedAlpha(max_iterations=limit)
        return scheme.run(scene, duration=0.02, step=0.02, progress=False).joint_forces

    expected, found = joint_forces(30), joint_forces(4)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    with pytest.raises(fl.ConvergenceError, match="did not converge in 1 iterations"):
        joint_forces(1)


def test_failure_keeps_what_was_computed():
    scene, _ = pendulum()
    scene.add(
        fl.PointLoad(scene.bodies[0].point("centre"), force=(0, 0, 1e9), history=lambda t: t > 0.05)
    )
    scheme = fl.GeneralisedAlpha(max_iterations=2, tolerance=1e-14)
    with pytest.raises(fl.ConvergenceError, match=r"step .*did not converge.*residual") as info:
        scheme.run(scene, duration=1.0, step=1e-2)
    assert 0 < len(info.value.result.times) < 101
