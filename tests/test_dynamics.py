"""Generalised-α: order, invariants, policies, start, and the joint forces."""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fem_lie as fl
from fem_lie import lie
from fem_lie.solve.generalised_alpha import _Run
from fem_lie.system import System

G = 9.81
LENGTH, MASS, INERTIA = 0.5, 2.0, 0.3


def pendulum(angle: float = 0.0, speed: float = 0.0) -> tuple[fl.Scene, fl.RigidBody]:
    """Compound pendulum about y through the origin, at rest along the x axis."""
    scene = fl.Scene(gravity=(0, 0, -G))
    place = LENGTH * np.array([np.cos(angle), 0, -np.sin(angle)])
    R = lie.so3_exp([0, angle, 0])
    body = scene.add(fl.RigidBody(MASS, (0.1, INERTIA, 0.25), place, R))
    scene.add(fl.Revolute(fl.ground(), body.centre, at=(0, 0, 0), axis=(0, 1, 0), name="pivot"))
    body.turn((0, speed, 0), about=(0, 0, 0))
    return scene, body


def exact_pendulum(times: np.ndarray, angle: float, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Angle below the horizontal and its rate."""
    moment = MASS * G * LENGTH / (INERTIA + MASS * LENGTH**2)
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


@pytest.mark.parametrize("radius", [0.0, 0.6, 0.8])
def test_start_stands_for_the_acceleration_before_the_first_step(radius):
    """``a₀`` is ``v̇`` at ``(α_m − α_f) h`` to second order; ``v̇₀`` in its place is first order."""
    angle, speed = 0.3, 1.0
    moment = MASS * G * LENGTH / (INERTIA + MASS * LENGTH**2)
    errors = []
    for step in (2e-2, 1e-2):
        scene, _ = pendulum(angle, speed)
        run = _Run(fl.GeneralisedAlpha(radius=radius), System(scene, dynamics=True), step)
        run.start()
        # time runs backwards: the pendulum with the opposite speed
        before = exact_pendulum(np.array([0.0, (run.p.af - run.p.am) * step]), angle, -speed)
        errors.append(abs(run.s.a[0, 4] - moment * np.cos(before[0][-1])))
    assert np.log2(errors[0] / errors[1]) > 1.9, errors


def pivot_force(angle: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Force of the body on ground, ``m (g − a)``, global components, shape (T, 3)."""
    rate = MASS * G * LENGTH / (INERTIA + MASS * LENGTH**2) * np.cos(angle)
    along = np.stack([np.cos(angle), 0 * angle, -np.sin(angle)], 1)
    across = np.stack([-np.sin(angle), 0 * angle, -np.cos(angle)], 1)
    a = LENGTH * (rate[:, None] * across - speed[:, None] ** 2 * along)
    return MASS * (np.array([0, 0, -G]) - a)


@pytest.mark.parametrize("radius", [0.0, 0.6, 0.8, 1.0])
def test_order_of_configuration_velocity_and_multipliers(radius):
    angle, speed = 0.3, 1.0
    errors = []
    for step in (1e-2, 5e-3, 2.5e-3):
        scene, body = pendulum(angle, speed)
        scheme = fl.GeneralisedAlpha(radius=radius, tolerance=1e-10)
        result = scheme.run(scene, duration=0.6, step=step)
        phi, rate = exact_pendulum(result.times, angle, speed)
        position = LENGTH * np.stack([np.cos(phi), 0 * phi, -np.sin(phi)], 1)
        force = result.joint_force("pivot")[:, :3]
        # components along the joint's axes on ground, e₃ = y
        frame = scene.joints[0].frame()[1:]
        half = len(result.times) // 2  # multipliers also in the first half: no transient allowed
        errors.append(
            [
                np.abs(result.position(body.centre) - position).max(),
                np.abs(result.velocity(body.centre)[:, 4] - rate).max(),
                np.abs(force - pivot_force(phi, rate) @ frame.T)[1:half].max(),
                np.abs(force - pivot_force(phi, rate) @ frame.T)[half:].max(),
            ]
        )
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 1.9, orders


@pytest.mark.parametrize(("step", "bound"), [(5e-4, 6e-3), (2.5e-4, 1.5e-3)])
def test_fast_heavy_top_keeps_one_matrix(step, bound):
    """Brüls & Cardona's top at 150 rad/s: in its own frame nothing turns, so nothing is renewed.

    Reference: centre of mass at 0.2 s, ten digits by two formulations in coordinates. Bounds:
    second order from 2.2e-2 at 1e-3, what SE(3) costs on a fast spin about a distant point.
    """
    scene = fl.Scene(gravity=(0, 0, -9.81))
    top = scene.add(fl.RigidBody(15.0, (0.234375, 0.46875, 0.234375), (0, 1, 0)))
    scene.add(fl.Spherical(fl.ground(), top.centre, at=(0, 0, 0)))
    top.turn((0, 150, -4.61538), about=(0, 0, 0))
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=0.2, step=step)
    end = [0.60555056138, 0.5989576818, -0.52398302743]
    assert np.linalg.norm(result.position(top.centre)[-1] - end) < bound
    assert result.factorisations == 1
    # the joint's force on the ground, in fixed axes: weight and inertia of the centre of mass
    force = result.joint_force(scene.joints[0])[:, :3] @ scene.joints[0].frame()[1:]
    x = result.position(top.centre)
    a = (x[2:] - 2 * x[1:-1] + x[:-2]) / step**2
    exact = 15.0 * (np.array([0, 0, -9.81]) - a)
    assert np.abs(force[1:-1] - exact).max() < 0.05 * np.abs(exact).max()


def flexible_pendulum(policy: fl.Policy | None = None, cells: int = 4, **options) -> fl.Result:
    material = fl.Material(70e9, 0.3, 2700)
    section = fl.Section.rectangle(5e-3, 5e-3, material)
    scene = fl.Scene()
    one = scene.add(fl.Beam.straight((0, 0, 0), (0.3, 0, 0), section, cells=cells))
    two = scene.add(fl.Beam.straight((0.3, 0, 0), (0.3, 0.5, 0), section, cells=cells))
    scene.add(fl.Spherical(fl.ground(), one.start))
    scene.add(fl.Revolute(one.end, two.start, axis=(1, 0, 0)))
    two.turn((3, 0, 0), about=two.start)
    scheme = fl.GeneralisedAlpha(policy=policy or fl.Automatic())
    return scheme.run(scene, duration=0.05, step=1e-4, **options)


@pytest.mark.parametrize(
    "policy", [fl.EveryIteration(), fl.Limit(4), fl.Automatic(), fl.Automatic(cost=5), fl.Never()]
)
def test_policies_give_the_same_motion(policy):
    """The iteration matrix changes the way, not the end."""
    reference = flexible_pendulum(fl.EveryIteration())
    result = flexible_pendulum(policy)
    # tolerance 2e-8 of the motion in a step, added up over 500 steps of 0.3 mm
    assert np.abs(result.frames[-1] - reference.frames[-1]).max() < 1e-7
    assert result.energy_error < 1e-6
    assert result.angular_momentum_error < 1e-6
    if isinstance(policy, fl.Never):
        assert result.factorisations == 1
    if isinstance(policy, fl.EveryIteration):
        assert result.factorisations >= len(result.times) - 1


def test_runs_repeat_bit_for_bit():
    one, two = flexible_pendulum(), flexible_pendulum()
    assert (one.frames == two.frames).all()
    assert (one.iterations == two.iterations).all()


def free_flight(step: float, formulation: fl.Formulation) -> fl.Result:
    """Two beams and a body joined in space, no supports."""
    section = fl.Section.rectangle(0.02, 0.01, fl.Material(1e9, 0.3, 1000))
    scene = fl.Scene()
    one, two = (
        scene.add(fl.Beam.straight(*ends, section, cells=4, formulation=formulation))
        for ends in (((0, 0, 0), (1, 0, 0)), ((1, 0, 0), (1, 1, 0)))
    )
    body = scene.add(fl.RigidBody(0.3, (1e-3, 2e-3, 2.5e-3), (1, 1, 0)))
    scene.add(fl.Spherical(one.end, two.start))
    scene.add(fl.Fixed(two.end, body.centre))
    for item in (one, two, body):
        item.move((1, 2, 3))
        item.turn((2, 0, 1), about=(0, 0, 0))
    two.turn((4, 0, 0), about=two.start)
    body.turn((4, 0, 0), about=two.start)
    return fl.GeneralisedAlpha(radius=0.9).run(scene, duration=0.1, step=step)


@pytest.mark.parametrize("formulation", [fl.Geodesic(), fl.Director(1), fl.Director(2)], ids=str)
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
    scene.add(fl.Fixed(hub.centre, body.centre, at=(0, 0, 0)))

    def motion(t: float) -> np.ndarray:
        return lie.frame(np.zeros(3), lie.so3_exp([0, 0, 0.5 * 3.0 * t**2]))

    scene.add(fl.PrescribedMotion(hub.centre, motion))
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=0.5, step=1e-3)
    t = result.times
    place = offset * np.stack([np.cos(1.5 * t**2), np.sin(1.5 * t**2), 0 * t], 1)
    assert np.abs(result.position(body.centre) - place).max() < 1e-5
    drive = result.joint_forces[:, -1, 5]
    inertia = INERTIA + 0.1 + MASS * offset**2
    assert np.abs(drive - inertia * 3.0)[1:].max() < 1e-3 * inertia * 3.0
    pull = np.linalg.norm(result.joint_force(scene.joints[0])[:, :3], axis=1)
    exact = MASS * offset * np.hypot((3.0 * t) ** 2, 3.0)
    assert np.abs(pull - exact)[1:].max() < 1e-3 * exact.max()


@pytest.mark.parametrize(
    ("formulation", "cells"),
    [(fl.Geodesic(), 16), (fl.Director(1), 16), (fl.Director(2), 5)],
    ids=str,
)
def test_clamped_beam_vibrates_at_its_frequency(formulation, cells):
    """First bending mode of a cantilever by its free vibration: 1.8751² √(EI/ρA)/L² / 2π."""
    section = fl.Section.rectangle(0.01, 0.01, fl.Material(2e11, 0.3, 7800))
    EI, mass, L = section.stiffness[4, 4], section.inertia[0, 0], 1.0
    scene = fl.Scene()
    line = fl.Beam.straight((0, 0, 0), (L, 0, 0), section, cells=cells, formulation=formulation)
    beam = scene.add(line)
    scene.add(fl.Clamp(beam.start))
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
    z = result.position(beam.end)[:, 2]
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
    assert re.search(r"t=0\.05 energy \d\.\de-\d\d it/step \d\.\d\d", bar), bar
    assert (result.frames == flexible_pendulum(progress=False).frames).all()
    assert capsys.readouterr().err == ""


def test_failure_keeps_what_was_computed():
    scene, _ = pendulum()
    scene.add(
        fl.PointLoad(scene.bodies[0]["centre"], force=(0, 0, 1e9), history=lambda t: t > 0.05)
    )
    scheme = fl.GeneralisedAlpha(max_iterations=2, tolerance=1e-14)
    with pytest.raises(fl.ConvergenceError, match=r"step .*did not converge.*residual") as info:
        scheme.run(scene, duration=1.0, step=1e-2)
    assert 0 < len(info.value.result.times) < 101
