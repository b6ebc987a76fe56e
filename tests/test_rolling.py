"""Velocity constraints: properties, and a sledge with a known closed-form motion."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fem_lie as fl
from fem_lie import lie
from fem_lie.system.constraints import Connections
from fem_lie.system.nodes.numbering import Numbering

seeds = st.integers(0, 2**32 - 1)
JOINTS = {
    "edge": lambda a, b: fl.joints.KnifeEdge(a, b, at=(0.2, 0.1, 0), axis=(0, 1, 1)),
    "disc": lambda a, b: fl.joints.RollingDisc(a, b, axis=(0.2, 1, 0.3), radius=0.4),
}


@cache
def connections_of(name: str) -> Connections:
    """Connections between two free bodies."""
    scene = fl.Scene()
    a = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    b = scene.add(fl.RigidBody(1.0, (1, 1, 1), position=(0.3, 0.5, 0.8)))
    scene.add(JOINTS[name](a.point("centre"), b.point("centre")))
    numbering = Numbering(scene.bodies)
    frames = np.concatenate([numbering.frames, [lie.frame(np.zeros(3), np.eye(3))]])
    return Connections(scene, numbering, frames, np.zeros((2, 6), dtype=bool))


def state(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Random frames and twists of two nodes."""
    rng = np.random.default_rng(seed)
    return lie.se3_exp(rng.normal(size=(2, 6)) * [1, 1, 1, 0.5, 0.5, 0.5]), rng.normal(size=(2, 6))


def bound(connections: Connections, H: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The constrained velocities."""
    first = np.zeros(connections.m)
    connections.sets[1].values(H, v, first)
    return first[len(connections.table.targets) :]


def dense(connections: Connections, H: np.ndarray) -> np.ndarray:
    """Rows of the velocity constraints."""
    incidences = connections.incidences
    blocks, rows = np.zeros((len(incidences.nodes), 6)), np.zeros((connections.m, 2, 6))
    connections.sets[1].jacobian(H, blocks)
    rows[incidences.rows, incidences.nodes] = blocks
    return rows.reshape(-1, 12)[len(connections.table.targets) :]


@pytest.mark.parametrize("name", JOINTS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_rows_forces_and_rates(name, seed):
    connections = connections_of(name)
    H, v = state(seed)
    W, m = dense(connections, H), connections.m
    # identities of sums of a dozen numbers of order 1
    np.testing.assert_allclose(bound(connections, H, v), W @ v.ravel(), atol=1e-13)
    weights = np.random.default_rng(seed).normal(size=m)
    r = np.zeros(12 + m)
    connections.sets[1].evaluate(H, v, weights, np.ones(m), 2, r)
    k = len(connections.table.targets)
    np.testing.assert_allclose(r[:12], W.T @ weights[k:], atol=1e-13)
    np.testing.assert_allclose(r[12 + k :], W @ v.ravel(), atol=1e-13)
    total = sum(
        np.linalg.inv(lie.se3_adjoint(F)).T @ f
        for F, f in zip(H, r[:12].reshape(2, 6), strict=True)
    )
    assert np.abs(total).max() < 1e-12
    second = np.zeros(m)
    connections.sets[1].rates(H, v, np.zeros(m), second)
    h = 1e-6
    ahead, behind = (bound(connections, lie.se3_retract(H, s * v), v) for s in (h, -h))
    # central differences: h² · 10³ and 1e-16/h
    np.testing.assert_allclose(second[k:], (ahead - behind) / (2 * h), atol=1e-6)


def test_rows_of_an_edge_are_constant_in_its_frame():
    connections = connections_of("edge")
    rows = [dense(connections, state(seed)[0])[:, 6:] for seed in range(3)]
    np.testing.assert_allclose(rows[1:], [rows[0]] * 2, atol=1e-15)


def sledge(step: float) -> tuple[float, fl.Result, fl.joints.KnifeEdge]:
    """Chaplygin's sledge: largest error of the velocities in 2 s."""
    ahead, inertia, mass, v0, w0 = 0.3, 0.05, 1.5, -0.5, 2.0
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(mass, (inertia,) * 3, name="sledge"))
    scene.add(fl.joints.Planar(fl.ground(), body.point("centre")))
    blade = scene.add(
        fl.joints.KnifeEdge(fl.ground(), body.point("centre"), at=(-ahead, 0, 0), axis=(0, 1, 0))
    )
    body.add_velocity(omega=(0, 0, w0), about=(-ahead, 0, 0))
    body.add_velocity((v0, 0, 0))
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)
    result = scheme.run(scene, duration=2.0, step=step)
    # dv/dt = a ω², v² + b² ω² = E²
    b = np.sqrt(inertia / mass + ahead**2)
    E = np.hypot(v0, b * w0)
    phase = ahead * E / b**2 * result.times + np.arctanh(v0 / E)
    velocity = result.velocity(body.point("centre"))
    errors = velocity[:, 0] - E * np.tanh(phase), velocity[:, 5] - E / b / np.cosh(phase)
    return float(np.abs(errors).max()), result, blade


def test_sledge_is_of_second_order_and_keeps_its_energy():
    coarse, fine = sledge(1e-2), sledge(5e-3)
    assert fine[0] < 2e-5
    assert 3.9 < coarse[0] / fine[0] < 4.1
    assert fine[1].energy_error < 3e-6
    assert 3.9 < coarse[1].energy_error / fine[1].energy_error < 4.1
    # a velocity over the tolerance of 1e-10 of a step's motion
    assert fine[1].joint_violation(fine[2]).max() < 1e-8


def test_blade_pushes_the_ground_as_the_sledge_is_pushed():
    """The reported force acts on the ground, in its axes and about the point there."""
    _, result, blade = sledge(5e-3)
    R, axes = result.rotation("sledge.centre"), blade.frame()[1:]
    velocity = np.einsum("tij,tj->ti", R, result.velocity("sledge.centre")[:, :3])
    force, moment = (result.joint_force(blade)[:, k : k + 3] @ axes for k in (0, 3))
    inner = slice(2, -2)
    push = -1.5 * np.gradient(velocity, result.times, axis=0)
    # differences over two steps: 3e-4 of 3 N
    np.testing.assert_allclose(force[inner], push[inner], atol=2e-3)
    assert np.abs(np.diff(R[:, 0, 0])).max() > 0.01
    place = result.position("sledge.centre") + R @ (-0.3, 0, 0) - (-0.3, 0, 0)
    np.testing.assert_allclose(moment, np.cross(place, force), atol=1e-9)


def test_velocities_that_slip_are_refused():
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    scene.add(fl.joints.KnifeEdge(fl.ground(), body.point("centre"), axis=(0, 1, 0), name="blade"))
    body.add_velocity((0, 1, 0))
    with pytest.raises(ValueError, match="velocities break blade"):
        fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.1)
    with pytest.raises(ValueError, match="constrain velocities: use dynamics"):
        fl.statics(scene)
