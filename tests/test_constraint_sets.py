"""Properties that every set of constraints must have; only the list of types knows the sets."""

import ast
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fem_lie as fl
from fem_lie import lie
from fem_lie.extend import node_types
from fem_lie.joints.connection import LostBranchError
from fem_lie.system import System, constraints
from fem_lie.system.constraint_sets import bushings, relative_motions, rolls, slides, ties

seeds = st.integers(0, 2**32 - 1)
SECTION = fl.Section.circle(0.01, fl.Material(2e9, 0.3, 1000.0))
HERE = (0.35, 0, 0)


def rail(scene: fl.Scene, element: fl.elements.BeamFormulation | None = None, **moved) -> fl.Beam:
    start, end = moved.get("along", ((0, 0, 0), (1, 0, 0)))
    return scene.add(fl.Beam.straight(start, end, SECTION, cells=3, formulation=element))


def body(scene: fl.Scene, position=(0.4, 0.3, 0.1)) -> fl.RigidBody:
    return scene.add(fl.RigidBody(1.0, (1, 1.2, 1.4), position))


def hinge_spring_drive(scene: fl.Scene, a: fl.extend.Point, b: fl.extend.Point) -> None:
    """A hinge with a spring and damper, and a driven distance of both points."""
    hinge = scene.add(fl.joints.Revolute(a, b, at=HERE, axis=(0.2, 0.3, 1)))
    scene.add(fl.joints.Spring(hinge.angle, stiffness=3.0, damping=0.7, rest=0.2))
    reach = scene.add(fl.joints.Distance(a, b, at=(0.4, 0.2, 0), to=(0.9, 0.4, 0.3)))
    scene.add(fl.joints.Spring(reach.length, stiffness=2.0, damping=0.4))
    scene.add(fl.joints.Screw(fl.ground(), b, at=(0, 0.5, 0.2), axis=(1, 0.2, 0), pitch=0.3))


def joints(scene):
    hinge_spring_drive(scene, body(scene, (0.1, 0, 0)).point("centre"), body(scene).point("centre"))


def joints_on(element):
    def build(scene):
        beam = rail(scene, element)
        hinge_spring_drive(scene, beam.point((0.42, 0, 0)), body(scene).point("centre"))
        other = rail(scene, element, along=((0.2, -0.5, 0), (0.2, 0.5, 0)))
        scene.add(
            fl.joints.Spherical(
                beam.point((0.2, 0, 0)), other.point((0.2, 0.07, 0)), at=(0.2, 0, 0)
            )
        )

    return build


def joints_on_branch(scene):
    """Attached nodes: those at a branch, and two of one element that are linked."""
    ends = [(0, 0, 0), (0.3, 0, 0), (0.4, 0.3, 0), (0.5, 0, 0.3), (0.9, 0, 0.3)]
    mesh = fl.mesh.LineMesh.from_cells(ends, [(0, 1), (1, 2), (1, 3), (3, 4)])
    tree = scene.add(fl.Beam(mesh, SECTION))
    hinge_spring_drive(scene, tree.point_in_cell(1, 0.4), body(scene).point("centre"))
    scene.add(
        fl.joints.RigidLink(
            tree.point(int(tree.model.elements[3, 0])), tree.point(int(tree.model.elements[3, 1]))
        )
    )
    scene.add(
        fl.joints.Spherical(
            tree.point_in_cell(2, 0.3), tree.point_in_cell(3, 0.6), at=(0.5, 0, 0.2)
        )
    )


def blocks_on_averages(scene):
    """A body on an averaging attachment, which is joined to that of another solid."""
    law = fl.sections.SaintVenantKirchhoff(1e6, 0.3, 1000.0)
    solid, other = (
        scene.add(fl.Solid.brick((0.4, 0.2, 0.1), law, cells=(1, 1, 1), name=name))
        for name in ("one", "other")
    )
    hinge_spring_drive(scene, solid.point("a=1"), body(scene).point("centre"))
    ends = solid.point("a=1"), other.point("b=0")
    scene.add(fl.joints.Revolute(*ends, at=(0.35, 0.05, 0.05), axis=(0.1, 1, 0)))


def sleeve(scene):
    beam, b = rail(scene), body(scene)
    scene.add(fl.joints.Sleeve(beam, b.point("centre"), at=HERE, travel=lambda t: 0.35))


def collar_on_beam(scene):
    other = rail(scene, along=((0.35, -0.4, 0), (0.35, 0.6, 0)))
    scene.add(
        fl.joints.Collar(rail(scene), other.point((0.35, 0.07, 0)), at=HERE, travel=lambda t: 0.35)
    )


def disc(scene):
    a, b = body(scene, (0, 0, 0)), body(scene, (0.3, 0.5, 0.8))
    scene.add(
        fl.joints.RollingDisc(a.point("centre"), b.point("centre"), axis=(0.2, 1, 0.3), radius=0.4)
    )


def edge_on_beam(scene):
    a, beam = body(scene, (0, 0.2, 0)), rail(scene)
    scene.add(
        fl.joints.KnifeEdge(
            a.point("centre"), beam.point((0.47, 0, 0)), at=(0.4, 0.1, 0), axis=(0, 1, 1)
        )
    )


def coupling(scene):
    """Nodes of a solid and of a beam that move with a rigid body away from them."""
    rubber = fl.sections.NeoHooke(1e6, 0.3, 1000.0)
    block = scene.add(fl.Solid.brick((0.2, 0.1, 0.1), rubber, cells=(1, 1, 1), name="block"))
    beam, a = rail(scene), body(scene, (0.1, 0, 0)).point("centre")
    scene.add(fl.joints.KinematicCoupling(a, [*block.points("a=1"), beam.point("start")]))


def tie(scene):
    """Faces with different meshes; a support holds corners of the first one."""
    rubber, size = fl.sections.NeoHooke(1e6, 0.3, 1000.0), (0.2, 0.1, 0.1)
    first = scene.add(fl.Solid.brick(size, rubber, cells=(1, 2, 2), name="first"))
    at = (0.2, 0, 0)
    second = scene.add(fl.Solid.brick(size, rubber, cells=(1, 1, 1), origin=at, name="second"))
    first.roller("b=0", normal=(0, 1, 0))
    scene.add(fl.joints.Tie(first, "a=1", second, "a=0"))


BUSHING = np.diag([30.0, 20.0, 25.0, 1.0, 2.0, 1.5])
BUSHING[1, 5] = BUSHING[5, 1] = 2.0


def mounts(scene):
    """Bushings between points apart, on ground, and at a position away from both points."""
    a, b = body(scene, (0.1, 0, 0)).point("centre"), body(scene).point("centre")
    scene.add(fl.joints.Bushing(a, b, BUSHING, 0.1 * BUSHING, rotation=lie.so3_exp([0.3, 0.1, 1])))
    scene.add(fl.joints.Bushing(fl.ground(), b, BUSHING, np.ones(6)))
    scene.add(fl.joints.Bushing(b, a, np.ones(6), at=HERE))


def mounts_on_beam(scene):
    beam, b = rail(scene), body(scene).point("centre")
    scene.add(fl.joints.Bushing(beam.point((0.47, 0, 0)), b, BUSHING, 0.1 * BUSHING))


JOINTS, SLIDES, ROLLS = relative_motions.RelativeMotions.what, slides.Slides.what, rolls.Rolls.what
BUSHINGS = bushings.Bushings.what
ON_ATTACHMENTS = "{} on points that are not nodes".format
SETS = {
    "joints": (joints, JOINTS),
    "kinematic coupling": (coupling, JOINTS),
    "joints on geodesics": (joints_on(None), ON_ATTACHMENTS(JOINTS)),
    "joints on two directors": (joints_on(fl.elements.DirectorBeam(1)), ON_ATTACHMENTS(JOINTS)),
    "joints on three directors": (joints_on(fl.elements.DirectorBeam(2)), ON_ATTACHMENTS(JOINTS)),
    "joints on branches": (joints_on_branch, ON_ATTACHMENTS(JOINTS)),
    "joints on averages": (blocks_on_averages, ON_ATTACHMENTS(JOINTS)),
    "slides": (sleeve, SLIDES),
    "slides on an attachment": (collar_on_beam, ON_ATTACHMENTS(SLIDES)),
    "bushings": (mounts, BUSHINGS),
    "bushings on an attachment": (mounts_on_beam, ON_ATTACHMENTS(BUSHINGS)),
    "tie": (tie, ties.Ties.what),
    "rolls": (disc, ROLLS),
    "rolls on an attachment": (edge_on_beam, ON_ATTACHMENTS(ROLLS)),
}
"""Scenes and which of their sets is looked at: adding one here tests it."""

every_set = pytest.mark.parametrize("name", SETS)


def friction(beam):
    """Joints with friction between a body, or a beam between its nodes, and three bodies."""

    def build(scene):
        others = [body(scene, (0.1 * k, 0.3, 0.1)).point("centre") for k in range(1, 4)]
        first = rail(scene).point((0.42, 0, 0)) if beam else body(scene).point("centre")
        law = {"coefficient": 0.2, "stiction_speed": 0.5, "static": 0.5, "stribeck_speed": 1.5}
        bearing = {"radius": 0.3, "length": 0.4, "preload": 0.7}
        kinds = fl.joints.Prismatic, fl.joints.Revolute, fl.joints.Cylindrical
        for kind, other in zip(kinds, others, strict=True):
            joint = scene.add(kind(first, other, at=HERE, axis=(0.2, 0.3, 1)))
            more = {"collar": 0.2} if kind is fl.joints.Revolute else {}
            scene.add(fl.joints.JointFriction(joint, **law, **bearing, **more))
        if not beam:
            joint = scene.add(fl.joints.Prismatic(fl.ground(), first, at=HERE, axis=(0, 1, 1)))
            scene.add(fl.joints.JointFriction(joint, **law, **bearing))

    return build


WITH_FRICTION = {
    "friction": (friction(False), JOINTS),
    "friction on a beam": (friction(True), ON_ATTACHMENTS(JOINTS)),
}
"""Scenes whose forces depend on twists and multipliers."""


@cache
def system_of(name: str) -> System:
    scene = fl.Scene()
    (SETS | WITH_FRICTION)[name][0](scene)
    return System(scene, dynamics=True)


class Case:
    """A set in a random state."""

    def __init__(self, name: str, seed: int) -> None:
        rng, system = np.random.default_rng(seed), system_of(name)
        what = (SETS | WITH_FRICTION)[name][1]
        (self.set,) = (each for each in system.connections.sets if each.what == what)
        self.n, self.incidences = system.count, system.connections.incidences
        self.start, self.m = self.set.start.row, system.m
        near = rng.normal(size=(self.n, 6)) * [0.02, 0.02, 0.02, 0.12, 0.12, 0.12]
        self.positions = np.flatnonzero(
            system.kinds == node_types.POSITION
        )  # their axes do not turn
        near[self.positions, 3:] = 0.0
        self.H = system.frames.copy()
        self.H[: self.n] = lie.se3_retract(self.H[: self.n], near)
        self.weights = rng.normal(size=self.m)
        self.v = np.zeros((len(self.H), 6))
        self.v[: self.n] = rng.normal(size=(self.n, 6))
        self.v[self.positions, 3:] = 0.0
        self.rng, self.own = rng, self.set.own

    def forces(self, H, v=None, weights=None, rows=None):
        """Forces on ``rows`` rows (all moving ones), and the violations."""
        count = self.n if rows is None else rows
        r = np.zeros(6 * count + self.m)
        v = np.zeros_like(self.v) if v is None else v
        weights = self.weights if weights is None else weights
        self.set.evaluate(H, v, weights, np.ones(self.m), count, r)
        return r[: 6 * count], r[6 * count :][self.own]

    def values(self, H, v=None):
        out = np.zeros(self.m)
        self.set.values(H, np.zeros_like(self.v) if v is None else v, out)
        return out[self.own]

    def jacobian(self):
        blocks = np.zeros((len(self.incidences.nodes), 6))
        self.set.jacobian(self.H, blocks)
        rows = np.zeros((self.m, self.n, 6))
        rows[self.incidences.rows, self.incidences.nodes] = blocks
        return rows.reshape(self.m, 6 * self.n)[self.own]

    def stiffness(self, fill):
        """Matrix on all nodes of the blocks that ``fill(position, K)`` adds."""
        K, n = np.zeros((self.n**2, 6, 6)), self.n
        rows, columns = self.set.pairs
        fill(np.where((rows < n) & (columns < n), rows * n + columns, -1), K)
        return K.reshape(n, n, 6, 6).transpose(0, 2, 1, 3).reshape(6 * n, 6 * n)

    def moved(self, h):
        return lie.se3_retract(self.H, h)

    def along(self, function):
        """A random direction ``h`` of all nodes, and the derivative of a function along it."""
        h = np.zeros_like(self.v)
        h[: self.n] = self.rng.normal(size=(self.n, 6))
        h[self.positions, 3:] = 0.0
        near, far = (
            function(self.moved(s * h)) - function(self.moved(-s * h)) for s in (1e-4, 2e-4)
        )
        return h[: self.n].ravel(), (8.0 * near - far) / 12e-4


def largest(B):
    return np.abs(B).max(initial=0.0)


def some(test):
    return every_set(given(seed=seeds)(settings(max_examples=5, deadline=None)(test)))


@some
def test_the_jacobian_is_the_derivative_of_the_violations(name, seed):
    case = Case(name, seed)
    B = case.jacobian()
    if case.set.of_velocities:
        np.testing.assert_allclose(case.values(case.H, case.v), B @ case.v[: case.n].ravel())
        return
    h, numeric = case.along(case.values)
    np.testing.assert_allclose(B @ h, numeric, atol=3e-8 * (1 + largest(B)))


@some
def test_forces_are_those_of_the_jacobian(name, seed):
    case = Case(name, seed)
    B = case.jacobian()
    forces, values = case.forces(case.H, case.v)
    without, _ = case.forces(case.H, case.v, np.zeros(case.m))
    own = case.weights[case.own]
    np.testing.assert_allclose(forces - without, B.T @ own, atol=1e-12 * (1 + largest(B)))
    np.testing.assert_allclose(values, case.values(case.H, case.v), atol=1e-14)


@some
def test_geometric_stiffness_is_the_derivative_of_the_forces(name, seed):
    case = Case(name, seed)
    if case.set.of_velocities:
        pytest.skip("forces that bind velocities have no stiffness in the matrix")
    K = case.stiffness(lambda position, K: case.set.geometric(case.H, case.weights, position, K))
    K += case.stiffness(lambda position, K: case.set.stiffen(case.H, case.v, position, 1.0, 0.0, K))
    h, numeric = case.along(lambda H: case.forces(H)[0])
    np.testing.assert_allclose(K @ h, numeric, atol=1e-6 * (1 + np.abs(K).max()))


@some
def test_dampers_resist_velocities_and_take_what_they_lose(name, seed):
    case = Case(name, seed)
    C = case.stiffness(lambda position, K: case.set.stiffen(case.H, case.v, position, 0.0, 1.0, K))
    moving, still = (case.forces(case.H, v)[0] for v in (case.v, np.zeros_like(case.v)))
    twists = case.v[: case.n].ravel()
    np.testing.assert_allclose(moving - still, C @ twists, atol=1e-11 * (1 + np.abs(C).max()))
    loss = case.set.damper_loss(case.H, case.v[: case.n], case.weights)
    np.testing.assert_allclose(loss, twists @ C @ twists, rtol=1e-11, atol=1e-13)
    assert (loss > 0.0) == ("joints" in name or "bushings" in name)


@some
def test_springs_have_an_energy(name, seed):
    case = Case(name, seed)
    h, numeric = case.along(case.set.spring_energy)
    forces, _ = case.forces(case.H, None, np.zeros(case.m))
    np.testing.assert_allclose(forces @ h, numeric, atol=1e-7)


@some
def test_rates_are_derivatives_in_time(name, seed):
    case = Case(name, seed)
    first, second = np.zeros(case.m), np.zeros(case.m)
    case.set.rates(case.H, case.v, first, second)
    first, second, B, t = first[case.own], second[case.own], case.jacobian(), 1e-4
    np.testing.assert_allclose(first, B @ case.v[: case.n].ravel(), atol=1e-11)
    bound = case.values if not case.set.of_velocities else lambda H: case.values(H, case.v)
    behind, now, ahead = (bound(case.moved(s * t * case.v)) for s in (-1, 0, 1))
    numeric = (ahead - 2 * now + behind) / t**2
    if case.set.of_velocities:
        numeric = (ahead - behind) / (2 * t)
    speed = np.abs(case.v).max()
    np.testing.assert_allclose(second, numeric, atol=1e-4 * (1 + largest(B) * speed**3))


@some
def test_forces_are_in_balance_and_turn_with_all(name, seed):
    if name == "tie":
        pytest.skip("axes of its constraints are fixed in space; tests/test_tie.py rotates all")
    case = Case(name, seed)
    rows = len(case.H)
    forces, values = case.forces(case.H, case.v, rows=rows)
    f = forces.reshape(rows, 6)
    total = sum(np.linalg.inv(lie.se3_adjoint(A)).T @ a for A, a in zip(case.H, f, strict=True))
    bound = 1e-11 * (1 + np.abs(f).max())
    assert np.abs(total).max() < bound
    moved = lie.se3_compose(lie.se3_exp(np.arange(6) / 3.0), case.H)
    again, same = case.forces(moved, case.v, rows=rows)
    np.testing.assert_allclose(again, forces, atol=10 * bound)
    np.testing.assert_allclose(same, values, atol=1e-12)


@every_set
def test_what_is_remembered_does_not_change_the_state_it_is_of(name):
    case = Case(name, 1)
    before = case.forces(case.H, case.v)
    kept = [part.copy() for part in case.set.history_variables]
    case.set.accept(case.H)
    after = case.forces(case.H, case.v)
    for part, was in zip(case.set.history_variables, kept, strict=True):
        part[:] = was
    np.testing.assert_allclose(after[0], before[0], atol=1e-10)
    np.testing.assert_allclose(after[1], before[1], atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_what_averages_couple_is_of_low_rank(seed):
    case = Case("joints on averages", seed)
    whole = case.stiffness(
        lambda position, K: case.set.geometric(case.H, case.weights, position, K)
    )
    sparse, n, means = len(case.set.sparse[0]), case.n, case.set.means
    rest = case.stiffness(
        lambda position, K: case.set.geometric(case.H, case.weights, position[:sparse], K)
    )
    S, core = case.set.mean_stiffness(case.H, case.weights)
    w, r = core.shape[:2]
    rates = np.zeros((w, r, n, 6))
    np.add.at(rates.transpose(0, 2, 1, 3), (means.of, means.nodes), S)
    rates = rates.reshape(w * r, 6 * n)
    assert w == 2 and r < len(means.nodes) / w * 6
    found = rates.T @ core.reshape(w * r, w * r) @ rates
    assert np.abs(found).max() > 0.01 * np.abs(whole).max()
    np.testing.assert_allclose(rest + found, whole, atol=1e-12 * np.abs(whole).max())


@every_set
def test_owners_angles_and_pairs_are_of_its_constraints(name):
    case = Case(name, 1)
    assert len(case.set.owner) == len(case.set.angular) == len(case.set.targets) == case.set.m
    assert len(case.set.incidences.ptr) == case.set.m + 1
    rows, columns = case.set.pairs
    assert rows.shape == columns.shape


def test_what_goes_over_the_sets_names_none_of_them():
    source = Path(constraints.__file__).read_text(encoding="utf-8")
    imported = {
        name
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.ImportFrom)
        for name in (node.module, *(f"{node.module}.{alias.name}" for alias in node.names))
    }
    compiled = "sliding", "rolling", "bushings", "terms"
    known = {f"fem_lie.joints.equations.{name}" for name in compiled}
    assert not imported & known
    words = "sliding", "rolling", "Slides", "Rolls", "ushing"
    assert not {word for word in words if word in source}


BOUND = {
    "fixed": lambda b: fl.joints.Fixed(fl.ground(), b),
    "prismatic": lambda b: fl.joints.Prismatic(fl.ground(), b, axis=(0, 0, 1)),
    "revolute": lambda b: fl.joints.Revolute(fl.ground(), b, axis=(0, 0, 1)),
    "cylindrical": lambda b: fl.joints.Cylindrical(fl.ground(), b, axis=(0, 0, 1)),
}


@pytest.mark.parametrize("joint", BOUND)
def test_half_a_turn_across_the_axis_closes_a_joint_and_is_refused(joint):
    """The constrained components of the rotation vanish there as well."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1.0, 1.2, 1.4), (0, 0, 0)))
    scene.add(BOUND[joint](body.point("centre")))
    system = System(scene, dynamics=False)
    (joints,) = system.connections.sets
    for axis, degrees, lost in (((0, 0, 1), 30, False), ((1, 0, 0), 180, True)):
        H = system.frames.copy()
        H[0] = lie.se3_retract(H[0], np.r_[np.zeros(3), np.radians(degrees) * np.array(axis)])
        if not lost:
            joints.check_branch(H)
            continue
        violations = np.ones(joints.m)
        joints.values(H, np.zeros((len(H), 6)), violations)
        np.testing.assert_allclose(violations, 0.0, atol=1e-15)
        with pytest.raises(LostBranchError, match="is half a turn away from where its axes are"):
            joints.check_branch(H)


def differences(function, values):
    """Derivatives of a function in all entries of an array."""
    columns, h = [], 1e-6
    for k in np.ndindex(values.shape):
        ahead, behind = values.copy(), values.copy()
        ahead[k], behind[k] = ahead[k] + h, behind[k] - h
        columns.append((function(ahead) - function(behind)) / (2.0 * h))
    return np.array(columns).T


@pytest.mark.parametrize("name", WITH_FRICTION)
@pytest.mark.parametrize("seed", range(3))
def test_tangents_of_friction_are_derivatives_of_the_forces(name, seed):
    case = Case(name, seed)
    H, v, weights, n = case.H, case.v, case.weights, case.n
    in_twists = case.stiffness(
        lambda position, K: case.set.add_friction(H, v, weights, position, 2.0, K)
    )
    exact = differences(lambda u: case.forces(H, np.concatenate([u, v[n:]]))[0], v[:n])
    np.testing.assert_allclose(in_twists, 2.0 * exact, atol=1e-7)
    found = np.zeros((len(case.incidences.nodes), 6))
    case.set.add_friction_columns(H, v, weights, found)
    columns = np.zeros((case.m, n, 6))
    columns[case.incidences.rows, case.incidences.nodes] = found
    in_multipliers = case.jacobian() + columns.reshape(case.m, -1)[case.own]
    exact = differences(lambda given: case.forces(H, v, given)[0], weights)
    np.testing.assert_allclose(in_multipliers.T, exact[:, case.own], atol=1e-7)
    assert np.abs(in_twists).max() > 0.1 and np.abs(found).max() > 0.1


@pytest.mark.parametrize("name", WITH_FRICTION)
def test_friction_dissipates_the_power_of_its_forces(name):
    case = Case(name, 5)
    forces, still = (case.forces(case.H, v)[0] for v in (case.v, 0.0 * case.v))
    loss = case.set.damper_loss(case.H, case.v[: case.n], case.weights)
    assert loss > 0.1
    np.testing.assert_allclose(loss, (forces - still) @ case.v[: case.n].ravel(), rtol=1e-11)
