"""Laws of joints: derivatives, invariance, and what is refused."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fem_lie as fl
from fem_lie import constraints, lie
from fem_lie.constraints import JointTable
from fem_lie.solve.generalised_alpha import _Run
from fem_lie.system import System

JOINTS = [fl.Fixed, fl.Spherical, fl.Revolute]
seeds = st.integers(0, 2**32 - 1)


def random_frames(rng: np.random.Generator, count: int) -> np.ndarray:
    return lie.se3_exp(rng.normal(size=(count, 6)) * [2, 2, 2, 1.5, 1.5, 1.5])


def random_table(kind: type[fl.Joint], rng: np.random.Generator) -> JointTable:
    """One joint between nodes 0 and 1, with random frames in both."""
    m = len(kind.selection)
    return JointTable(
        np.array([[0, 1]]), random_frames(rng, 2)[np.newaxis], np.array([0, m]), kind.selection
    )


def evaluate(H: np.ndarray, table: JointTable, weights: np.ndarray) -> np.ndarray:
    m = len(weights)
    r = np.zeros(12 + m)
    constraints.evaluate(H, table, weights, np.ones(m), 2, r)
    return r


def differences(function, H: np.ndarray, step: float = 1e-6) -> np.ndarray:
    """Derivative of ``function(H)`` in the twelve local increments of two nodes."""
    columns = []
    for j in range(12):
        h = np.zeros((2, 6))
        h[j // 6, j % 6] = step
        columns.append(function(lie.se3_retract(H, h)) - function(lie.se3_retract(H, -h)))
    return np.array(columns).T / (2 * step)


# central differences with a step of 1e-6 of quantities of order 10: 1e-6² · 10 + 1e-16 · 10 / 1e-6
DIFFERENCE = 1e-7


@pytest.mark.parametrize("kind", JOINTS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_jacobian_is_derivative(kind, seed):
    rng = np.random.default_rng(seed)
    H, table = random_frames(rng, 2), random_table(kind, rng)
    m = len(kind.selection)
    rows = np.zeros((m, 2, 6))
    constraints.jacobian(H, table, rows)
    numeric = differences(lambda F: evaluate(F, table, np.zeros(m))[12:], H)
    assert np.abs(rows.reshape(m, 12) - numeric).max() < DIFFERENCE


@pytest.mark.parametrize("kind", JOINTS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_forces_are_transposed_jacobian_and_geometric_their_derivative(kind, seed):
    rng = np.random.default_rng(seed)
    H, table = random_frames(rng, 2), random_table(kind, rng)
    m = len(kind.selection)
    weights = rng.normal(size=m)
    rows = np.zeros((m, 2, 6))
    constraints.jacobian(H, table, rows)
    force = evaluate(H, table, weights)[:12]
    # an identity: only round-off of sums of a dozen numbers of order 10
    assert np.abs(force - rows.reshape(m, 12).T @ weights).max() < 1e-12
    K = np.zeros((4, 6, 6))
    constraints.geometric(H, table, weights, np.array([[[0, 1], [2, 3]]]), K)
    blocks = K.reshape(2, 2, 6, 6).transpose(0, 2, 1, 3).reshape(12, 12)
    numeric = differences(lambda F: evaluate(F, table, weights)[:12], H)
    assert np.abs(blocks - numeric).max() < 10 * DIFFERENCE


@pytest.mark.parametrize("kind", JOINTS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_rates_are_time_derivatives(kind, seed):
    rng = np.random.default_rng(seed)
    H, table, v = random_frames(rng, 2), random_table(kind, rng), rng.normal(size=(2, 6))
    m = len(kind.selection)
    first, second = np.zeros(m), np.zeros(m)
    constraints.rates(H, v, table, first, second)

    def at(time: float) -> np.ndarray:
        return evaluate(lie.se3_retract(H, time * v), table, np.zeros(m))[12:]

    step = 1e-4
    scale = 1 + np.abs(v).max() ** 3
    # errors of central differences: step² v³ for the first, eps/step² + step² v⁴ for the second
    assert np.abs(first - (at(step) - at(-step)) / (2 * step)).max() < 1e-6 * scale
    numeric = (at(step) - 2 * at(0) + at(-step)) / step**2
    assert np.abs(second - numeric).max() < 1e-5 * scale * (1 + np.abs(v).max())


@pytest.mark.parametrize("kind", JOINTS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_internal_forces_balance_and_are_invariant(kind, seed):
    """Forces on A and B have no resultant, and do not see a rigid motion of both."""
    rng = np.random.default_rng(seed)
    H, table = random_frames(rng, 2), random_table(kind, rng)
    weights = rng.normal(size=len(kind.selection))
    local = evaluate(H, table, weights)[:12].reshape(2, 6)
    # to the origin: forces transform by Ad⁻ᵀ, and the adjoint of the inverse is the inverse
    total = sum(np.linalg.inv(lie.se3_adjoint(F)).T @ f for F, f in zip(H, local, strict=True))
    assert np.abs(total).max() < 1e-12 * (1 + np.abs(local).max()) * 10
    moved = lie.se3_compose(random_frames(rng, 1)[0], H)
    again = evaluate(moved, table, weights)[:12].reshape(2, 6)
    assert np.abs(again - local).max() < 1e-12 * (1 + np.abs(local).max())


def rod(start, end, **options) -> fl.Beam:
    material = fl.Material(1e9, 0.3, 1000.0)
    return fl.Beam.straight(start, end, fl.Section.circle(0.01, material), cells=2, **options)


def closed_chain(last: type[fl.Joint]) -> fl.Scene:
    """A planar four-bar linkage of rigid bodies with axes along z."""
    scene = fl.Scene()
    corners = [(0.0, 0, 0), (0.0, 1, 0), (1.0, 1, 0), (1.0, 0, 0)]
    bars = []
    for a, b in pairwise(corners):
        centre = 0.5 * (np.array(a) + np.array(b))
        bars.append(scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), centre)))
    points = [fl.ground()] + [bar.centre for bar in bars] + [fl.ground()]
    for k, corner in enumerate(corners):
        kind = last if k == 3 else fl.Revolute
        name = "the last one" if k == 3 else f"joint {k}"
        scene.add(kind(points[k], points[k + 1], at=corner, axis=(0, 0, 1), name=name))
    return scene


def test_redundant_constraints_are_counted_and_named():
    """A planar loop of four revolutes has three constraints too many (Grübler)."""
    with pytest.raises(ValueError, match=r"3 of 20 constraints are redundant.*(joint|last)"):
        System(closed_chain(fl.Revolute), dynamics=True)


def test_joint_given_twice_is_redundant():
    scene = fl.Scene()
    bar = scene.add(rod((0, 0, 0), (1, 0, 0)))
    scene.add(fl.Spherical(fl.ground(), bar.start, name="one"))
    scene.add(fl.Spherical(fl.ground(), bar.start, name="two"))
    with pytest.raises(ValueError, match=r"3 of 6 constraints are redundant.*(one|two)"):
        System(scene, dynamics=True)


def test_joint_to_a_clamped_point_is_redundant():
    scene = fl.Scene()
    bar = scene.add(rod((0, 0, 0), (1, 0, 0)))
    scene.add(fl.Clamp(bar.start))
    scene.add(fl.Spherical(fl.ground(), bar.start, name="useless"))
    with pytest.raises(ValueError, match="useless"):
        System(scene, dynamics=True)


@pytest.mark.parametrize("flexible", [False, True])
def test_condition_of_matrix_does_not_depend_on_step(flexible):
    """From 1e-1 to 1e-7; unscaled it would grow like 1/h⁴ for the rigid body."""
    conditions = []
    for step in 10.0 ** np.arange(-1, -8, -1):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        if flexible:
            body = scene.add(rod((0, 0, 0), (1, 0, 0)))
            scene.add(fl.Revolute(fl.ground(), body.start, axis=(0, 1, 0)))
        else:
            body = scene.add(fl.RigidBody(2.0, (0.1, 0.2, 0.2), (0.5, 0, 0)))
            scene.add(fl.Revolute(fl.ground(), body.centre, at=(0, 0, 0), axis=(0, 1, 0)))
        run = _Run(fl.GeneralisedAlpha(), System(scene, dynamics=True), step)
        run.start()
        s = run.s
        run.system.residual(s.H, s.twist1, s.rate1, run.weights, run.scale, run.r)
        run._factorise(s.H)
        matrix = run.system.kkt.matrix.convert("dense").getDenseArray()
        conditions.append(np.linalg.cond(matrix))
    # between stiffness and mass that make up a flexible body's matrix lies a factor of its own
    assert max(conditions) / min(conditions) < (10 if flexible else 1.01), conditions
