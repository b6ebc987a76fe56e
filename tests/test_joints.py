"""Joints: derivatives, invariance, and invalid arguments."""

import re
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

import fem_lie as fl
from fem_lie import lie
from fem_lie.joints.equations import functions, terms
from fem_lie.joints.equations.relative_motion import relative_motion
from fem_lie.solve.alpha.run import Run
from fem_lie.system.constraints import Connections
from fem_lie.system.nodes.numbering import Numbering

seeds = st.integers(0, 2**32 - 1)
PLACE, AXIS, ACROSS = (0.3, -0.2, 0.5), (0.6, 0.0, 0.8), (-0.8, 0.0, 0.6)


def joint_of(kind: type[fl.joints.Joint], **options):
    return lambda a, b: [kind(a.point("centre"), b.point("centre"), at=PLACE, axis=AXIS, **options)]


def spring(a, b):
    pin = fl.joints.Cylindrical(a.point("centre"), b.point("centre"), at=PLACE, axis=AXIS)
    return [
        fl.joints.Spring(pin.angle, stiffness=3.0, damping=0.4, rest=0.2),
        fl.joints.Spring(pin.displacement, stiffness=2.0, damping=0.3),
        fl.joints.Spring(
            fl.joints.Distance(a.point("centre"), b.point("centre"), to=PLACE).length,
            stiffness=5.0,
            rest=0.7,
        ),
    ]


def drives(a, b):
    cross = fl.joints.Universal(
        a.point("centre"), b.point("centre"), at=PLACE, axis=AXIS, second=ACROSS
    )
    planar = fl.joints.Planar(
        a.point("centre"), b.point("centre"), at=PLACE, axis=AXIS, second=ACROSS
    )
    distance = fl.joints.Distance(a.point("centre"), b.point("centre"), at=(0, 0, 1), to=PLACE)
    coordinates = (cross.second_angle, cross.angle, planar.displacements[1], distance.length)
    return [fl.joints.Drive(coordinate) for coordinate in coordinates]


def gear(a, b):
    """Two hinges on one carrier ``a``, which both definitions share."""
    wheel = fl.joints.Revolute(a.point("centre"), b.point("centre"), at=PLACE, axis=AXIS)
    rack = fl.joints.Prismatic(b.point("centre"), a.point("centre"), at=(1, 1, 0), axis=(0, 1, 0))
    return [fl.joints.Gear(wheel.angle, rack.displacement, -1.7)]


CONNECTIONS = {
    kind.__name__: joint_of(kind)
    for kind in (
        fl.joints.Fixed,
        fl.joints.Spherical,
        fl.joints.Revolute,
        fl.joints.InPlane,
        fl.joints.Prismatic,
        fl.joints.Cylindrical,
        fl.joints.Planar,
    )
} | {
    "Universal": joint_of(fl.joints.Universal, second=ACROSS),
    "Screw": joint_of(fl.joints.Screw, pitch=0.4),
    "Spring": spring,
    "Drive": drives,
    "Gear": gear,
}


@cache
def connections_of(name: str) -> Connections:
    """A connection between two free bodies."""
    scene = fl.Scene()
    a = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    b = scene.add(fl.RigidBody(1.0, (1, 1, 1), position=(1, 0.5, 0), rotation=lie.so3_exp(TURNED)))
    for item in CONNECTIONS[name](a, b):
        # what acts along a joint's coordinate stands here without the joint's own constraints
        (scene.joints if isinstance(item, fl.joints.Joint) else scene.connections).append(item)
    numbering = Numbering(scene.bodies)
    frames = np.concatenate([numbering.frames, [lie.frame(np.zeros(3), np.eye(3))]])
    return Connections(scene, numbering, frames, np.zeros((2, 6), dtype=bool))


TURNED = np.array([0.4, 0.2, -0.7])


class Case:
    """A connection in a random configuration, with random frames in its nodes."""

    def __init__(self, name: str, seed: int) -> None:
        self.rng = rng = np.random.default_rng(seed)
        self.connections = connections_of(name)
        table = self.connections.table
        frames = np.repeat(random_frames(rng, 2)[np.newaxis], len(table.nodes), axis=0)
        # of two definitions with exchanged sides: each node keeps its frame
        frames = np.take_along_axis(frames, table.nodes[:, :, np.newaxis, np.newaxis], axis=1)
        self.table = table._replace(frames=frames, turned=np.zeros(len(table.nodes)))
        # joint frames apart from each other, but not with axes against each other: no angle there
        apart = lie.se3_exp(rng.normal(size=6) * [1, 1, 1, 0.5, 0.5, 0.5])
        spin = lie.se3_exp(np.array([0, 0, 0, 0, 0, rng.uniform(-3, 3)]))
        A, B = frames[0][np.argsort(table.nodes[0])]
        one = random_frames(rng, 1)[0]
        other = lie.se3_compose(lie.se3_compose(lie.se3_compose(one, A), apart), spin)
        self.H = np.array([one, lie.se3_compose(other, lie.se3_inverse(B))])
        terms.unwrap(self.H, self.table)
        self.m = len(table.targets)
        self.weights, self.v = rng.normal(size=self.m), rng.normal(size=(2, 6))

    def evaluate(self, H: np.ndarray, v: np.ndarray | None = None) -> np.ndarray:
        """Forces on both nodes (12,), then Φ."""
        r, still = np.zeros(12 + self.m), np.zeros((2, 6))
        v = still if v is None else v
        terms.evaluate(H, v, self.table, self.weights, np.ones(self.m), 2, r)
        return r

    def jacobian(self) -> np.ndarray:
        incidences = self.connections.incidences
        blocks, rows = np.zeros((len(incidences.nodes), 6)), np.zeros((self.m, 2, 6))
        terms.jacobian(self.H, self.table, blocks)
        rows[incidences.rows, incidences.nodes] = blocks
        return rows.reshape(self.m, 12)

    def blocks(self, fill) -> np.ndarray:
        """Matrix on both nodes of the blocks that ``fill(position, K)`` adds."""
        K, nodes = np.zeros((4, 6, 6)), self.table.nodes
        position = 2 * nodes[:, :, np.newaxis] + nodes[:, np.newaxis]
        fill(position, K)
        return K.reshape(2, 2, 6, 6).transpose(0, 2, 1, 3).reshape(12, 12)


def random_frames(rng: np.random.Generator, count: int) -> np.ndarray:
    return lie.se3_exp(rng.normal(size=(count, 6)) * [2, 2, 2, 1.5, 1.5, 1.5])


def differences(function, H: np.ndarray, step: float = 1e-6) -> np.ndarray:
    """Derivative of ``function(H)`` in the twelve local increments of two nodes."""
    columns = []
    for j in range(12):
        h = np.zeros((2, 6))
        h[j // 6, j % 6] = step
        columns.append(function(lie.se3_retract(H, h)) - function(lie.se3_retract(H, -h)))
    return np.array(columns).T / (2 * step)


# central differences with a step of 1e-6 of quantities of order 10: 1e-6² · 10 + 1e-16 · 10 / 1e-6;
# angles and distances have derivatives that grow where they are hard to tell
DIFFERENCE = 1e-7


@pytest.mark.parametrize("name", CONNECTIONS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_jacobian_is_derivative(name, seed):
    case = Case(name, seed)
    rows = case.jacobian()
    numeric = differences(lambda F: case.evaluate(F)[12:], case.H)
    assert np.abs(rows - numeric).max(initial=0.0) < DIFFERENCE * (1 + np.abs(rows).max(initial=0))


@pytest.mark.parametrize("name", CONNECTIONS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_forces_are_transposed_jacobian_and_geometric_their_derivative(name, seed):
    case = Case(name, seed)
    H, table = case.H, case.table
    rows, f = case.jacobian(), case.evaluate(case.H)[:12]
    if not len(table.springs):
        # an identity: only round-off of sums of a dozen numbers of order 10
        assert np.abs(f - rows.T @ case.weights).max() < 1e-12 * (1 + np.abs(rows).max())
    K = case.blocks(
        lambda position, K: terms.geometric(H, table, case.weights, position, K)
    ) + case.blocks(lambda position, K: terms.add_springs(H, case.v, table, position, 1.0, 0.0, K))
    numeric = differences(lambda F: case.evaluate(F)[:12], H)
    assert np.abs(K - numeric).max() < 10 * DIFFERENCE * (1 + np.abs(K).max())


@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_springs_have_an_energy_and_dampers_take_it(seed):
    case = Case("Spring", seed)
    f = case.evaluate(case.H)[:12]
    energy = differences(lambda F: np.array([terms.spring_energy(F, case.table)]), case.H)
    assert np.abs(energy[0] - f).max() < 10 * DIFFERENCE * (1 + np.abs(f).max())
    viscous = case.evaluate(case.H, case.v)[:12] - f
    assert viscous @ case.v.ravel() > 0.0
    given = case.H, case.v, case.table
    D = case.blocks(lambda position, K: terms.add_springs(*given, position, 0.0, 1.0, K))
    # linear in the velocities: an identity but for round-off
    assert np.abs(D @ case.v.ravel() - viscous).max() < 1e-12 * (1 + np.abs(D).max())


@pytest.mark.parametrize("name", CONNECTIONS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_rates_are_time_derivatives(name, seed):
    case = Case(name, seed)
    H, v, m = case.H, case.v, case.m
    first, second = np.zeros(m), np.zeros(m)
    terms.rates(H, v, case.table, first, second)

    def at(time: float) -> np.ndarray:
        return case.evaluate(lie.se3_retract(H, time * v))[12:]

    step = 1e-4
    scale = 1 + np.abs(v).max() ** 3 + np.abs(second).max(initial=0.0) ** 2
    # errors of central differences: step² v³ for the first, eps/step² + step² v⁴ for the second
    assert np.abs(first - (at(step) - at(-step)) / (2 * step)).max(initial=0.0) < 1e-6 * scale
    numeric = (at(step) - 2 * at(0) + at(-step)) / step**2
    error = np.abs(second - numeric).max(initial=0.0)
    assert error < 1e-5 * scale * (1 + np.abs(v).max())


@pytest.mark.parametrize("name", CONNECTIONS)
@given(seed=seeds)
@settings(max_examples=25, deadline=None)
def test_internal_forces_balance_and_are_invariant(name, seed):
    """Forces on A and B have no resultant, and are invariant under a rigid motion of both."""
    case = Case(name, seed)
    local = case.evaluate(case.H, case.v)[:12].reshape(2, 6)
    # to the origin: forces transform by Ad⁻ᵀ, and the adjoint of the inverse is the inverse
    total = sum(np.linalg.inv(lie.se3_adjoint(F)).T @ f for F, f in zip(case.H, local, strict=True))
    bound = 1e-12 * (1 + np.abs(local).max()) * (1 + np.abs(case.jacobian()).max(initial=0.0))
    assert np.abs(total).max() < 10 * bound
    moved = lie.se3_compose(random_frames(case.rng, 1)[0], case.H)
    again = case.evaluate(moved, case.v)[:12].reshape(2, 6)
    assert np.abs(again - local).max() < bound


def forbidden(definition, A: np.ndarray, B: np.ndarray) -> np.ndarray:
    """Values of the selection and functions of a definition for two frames."""
    z, of_z = np.empty(12), np.empty(3)
    relative_motion(A, B, z)
    functions.values(z, definition.angle, 0.0, of_z)
    return definition.selection @ z + definition.functions[:, :3] @ of_z


def allowed(definition, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Two frames with a random relative motion that the definition allows."""
    A = random_frames(rng, 1)[0]
    found = least_squares(
        lambda twist: forbidden(definition, A, lie.se3_compose(A, lie.se3_exp(twist))),
        rng.uniform(-0.5, 0.5, 6),
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-15,
    )
    return A, lie.se3_compose(A, lie.se3_exp(found.x))


REVERSIBLE = {
    fl.joints.Fixed,
    fl.joints.Spherical,
    fl.joints.Revolute,
    fl.joints.Prismatic,
    fl.joints.Cylindrical,
    fl.joints.Screw,
}
NO_JOINTS = {"Spring", "Drive", "Gear"}


@settings(max_examples=10)
@given(seeds)
@pytest.mark.parametrize("name", [name for name in CONNECTIONS if name not in NO_JOINTS])
def test_reversible_joint_forbids_the_same_with_its_sides_exchanged(name, seed):
    """A joint that is not reversible keeps its sides."""
    kind = getattr(fl.joints, name)
    assert kind.reversible == (kind in REVERSIBLE)
    a, b = fl.RigidBody(1.0, (1, 1, 1)), fl.RigidBody(1.0, (1, 1, 1))
    (definition,) = CONNECTIONS[name](a, b)[0].definitions()
    A, B = allowed(definition, np.random.default_rng(seed))
    assert np.abs(forbidden(definition, A, B)).max() < 1e-11
    left = np.abs(forbidden(definition.exchanged(), B, A)).max()
    if kind.reversible:
        assert left < 1e-11
    elif kind is not fl.joints.Planar:  # what it forbids is the same, its displacements are not
        assert left > 1e-6


def rod(start, end, **options) -> fl.Beam:
    material = fl.Material(1e9, 0.3, 1000.0)
    return fl.Beam.straight(start, end, fl.Section.circle(0.01, material), cells=2, **options)


def closed_chain(last: type[fl.joints.Joint]) -> fl.Scene:
    """A planar four-bar linkage of rigid bodies with axes along z."""
    scene = fl.Scene()
    corners = [(0.0, 0, 0), (0.0, 1, 0), (1.0, 1, 0), (1.0, 0, 0)]
    bars = []
    for a, b in pairwise(corners):
        centre = 0.5 * (np.array(a) + np.array(b))
        bars.append(scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), centre)))
    points = [fl.ground()] + [bar.point("centre") for bar in bars] + [fl.ground()]
    for k, corner in enumerate(corners):
        kind = last if k == 3 else fl.joints.Revolute
        name = "the last one" if k == 3 else f"joint {k}"
        scene.add(kind(points[k], points[k + 1], at=corner, axis=(0, 0, 1), name=name))
    return scene


def test_redundant_constraints_are_counted_and_named():
    """A planar loop of four revolute joints has three redundant constraints (Grübler)."""
    with pytest.raises(ValueError, match=r"3 of 20 constraints are redundant.*(joint|last)"):
        fl.extend.Equations(closed_chain(fl.joints.Revolute), dynamics=True)


def test_joint_given_twice_is_redundant():
    scene = fl.Scene()
    bar = scene.add(rod((0, 0, 0), (1, 0, 0)))
    scene.add(fl.joints.Spherical(fl.ground(), bar.point("start"), name="one"))
    scene.add(fl.joints.Spherical(fl.ground(), bar.point("start"), name="two"))
    with pytest.raises(ValueError, match=r"3 of 6 constraints are redundant.*(one|two)"):
        fl.extend.Equations(scene, dynamics=True)


def test_joint_to_a_clamped_point_is_redundant():
    scene = fl.Scene()
    bar = scene.add(rod((0, 0, 0), (1, 0, 0)))
    scene.add(fl.Clamp(bar.point("start")))
    scene.add(fl.joints.Spherical(fl.ground(), bar.point("start"), name="useless"))
    with pytest.raises(ValueError, match="useless"):
        fl.extend.Equations(scene, dynamics=True)


def held_twice(redundant: fl.joints.RedundantConstraints) -> fl.Scene:
    """A body on two fixed joints to the ground."""
    scene = fl.Scene(gravity=(0, 0, -10.0), redundant=redundant)
    body = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), (0, 0, 0)))
    for x in (-1.0, 1.0):
        scene.add(
            fl.joints.Fixed(fl.ground(), body.point("centre"), at=(x, 0, 0), name=f"at {x:+.0f}")
        )
    return scene


def test_redundant_joint_forces_are_the_smallest():
    """Each of two equal supports takes half the weight, and no moment is needed."""
    with pytest.raises(ValueError, match="6 of 12 constraints are redundant"):
        fl.statics(held_twice(fl.joints.RedundantConstraints.REFUSE))
    scene = held_twice(fl.joints.RedundantConstraints.MINIMUM_NORM)
    for forces in (
        fl.statics(scene).joint_forces[-1],
        fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.01).joint_forces[-1],
    ):
        axes = scene.joints[0].frame()[1:]
        # what the small softness of redundant constraints leaves
        np.testing.assert_allclose(forces[:, :3] @ axes, [[0, 0, -10.0]] * 2, atol=1e-5)
        # the moments of both shear forces about their joints cancel in the body
        assert np.abs(forces[:, 3:].sum(axis=0)).max() < 1e-5


@pytest.mark.parametrize("flexible", [False, True])
def test_condition_of_matrix_does_not_depend_on_step(flexible):
    """From 1e-1 to 1e-7; unscaled it would grow like 1/h⁴ for the rigid body."""
    conditions = []
    for step in 10.0 ** np.arange(-1, -8, -1):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        if flexible:
            body = scene.add(rod((0, 0, 0), (1, 0, 0)))
            scene.add(fl.joints.Revolute(fl.ground(), body.point("start"), axis=(0, 1, 0)))
        else:
            body = scene.add(fl.RigidBody(2.0, (0.1, 0.2, 0.2), (0.5, 0, 0)))
            scene.add(
                fl.joints.Revolute(fl.ground(), body.point("centre"), at=(0, 0, 0), axis=(0, 1, 0))
            )
        run = Run(fl.GeneralisedAlpha(), fl.extend.Equations(scene, dynamics=True), step)
        run.start()
        s = run.s
        now = fl.extend.TimeState(s.H, s.twist1, s.rate1, run.multipliers)
        run.equations.residual(now, run.scale, run.r, run.forces)
        run._factorise(s.H)
        matrix = run.equations.matrix.matrix.convert("dense").getDenseArray()
        conditions.append(np.linalg.cond(matrix))
    # between stiffness and mass that make up a flexible body's matrix lies a factor of its own
    assert max(conditions) / min(conditions) < (10 if flexible else 1.01), conditions


def test_a_gap_between_joined_points_is_closed_by_the_advice():
    """Points that coincide to seven digits, as in a file: the message contains the remedy."""
    section = fl.Section.circle(0.1, fl.Material(1e6, 0.3, 1.0))
    scene = fl.Scene()
    first = scene.add(fl.Beam.straight((0, 0, 0), (1 / 3, 0, 0), section, cells=1))
    second = scene.add(fl.Beam.straight((0.3333333, 0, 0), (1, 0, 0), section, cells=1))
    with pytest.raises(ValueError, match="more than 1e-09 of the size") as caught:
        scene.add(fl.joints.Fixed(first.point("end"), second.point("start")))
    advised = re.search(r"at=\(([^)]*)\)", str(caught.value))
    assert advised is not None
    at = [float(x) for x in advised[1].split(",")]
    np.testing.assert_allclose(at, (1 / 3, 0, 0), atol=1e-7)
    scene.add(fl.joints.Fixed(first.point("end"), second.point("start"), at=at))
    scene.add(fl.Clamp(first.point("start")))
    scene.add(fl.PointLoad(second.point("end"), force=(0, 0, 1e-3)))
    assert fl.statics(scene).position(second.point("end"))[-1][2] > 0.0
