"""Redundant constraints: mechanisms that move, that cannot, and the joint forces of both."""

import re

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp
from scipy.integrate import solve_ivp

import fem_lie as fl
from fem_lie.linear.redundancy import IdleMultipliers, redundant_constraints
from tests.interruption import interrupted
from tests.unit_systems import METRES, UNIT_SYSTEMS, UnitSystem

Z = (0.0, 0.0, 1.0)


def four_bar(tilt: float, u: UnitSystem = METRES) -> fl.Scene:
    """Rigid bars, hinged about z; one of the hinges is tilted, and the first is driven."""
    scene = fl.Scene(redundant=fl.joints.RedundantConstraints.MINIMUM_NORM)

    def bar(x: float, y: float, upright: bool, name: str) -> fl.RigidBody:
        across, along = (0.1, 1e-3) if upright else (1e-3, 0.2)
        inertia = u.inertia([across, along, 0.1 if upright else 0.2])
        return scene.add(fl.RigidBody(u.mass(1.0), inertia, u.length([x, y, 0]), name=name))

    crank, coupler = bar(0.0, 0.5, True, "crank"), bar(0.75, 1.0, False, "coupler")
    rocker = bar(1.5, 0.5, True, "rocker")
    axis = (np.sin(tilt), 0.0, np.cos(tilt))
    root = scene.add(
        fl.joints.Revolute(fl.ground(), crank.point("centre"), at=(0, 0, 0), axis=Z, name="A")
    )
    at = u.length([0, 1, 0])
    scene.add(
        fl.joints.Revolute(crank.point("centre"), coupler.point("centre"), at=at, axis=Z, name="B")
    )
    at = u.length([1.5, 1, 0])
    scene.add(
        fl.joints.Revolute(
            coupler.point("centre"), rocker.point("centre"), at=at, axis=axis, name="C"
        )
    )
    at = u.length([1.5, 0, 0])
    scene.add(fl.joints.Revolute(rocker.point("centre"), fl.ground(), at=at, axis=Z, name="D"))
    second = u.time(1.0)
    scene.add(fl.joints.Drive(root.angle, lambda t: 1.0 - np.cos(t / second), name="motor"))
    return scene


STEPS = {
    "constant": lambda u: u.time(1e-2),
    "adaptive": lambda u: fl.schemes.AdaptiveStep(u.length(1e-4)),
}


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("tilt", [0.02, 0.5])
def test_a_driven_loop_that_cannot_move_fails_and_names_its_joints(tilt, steps, u):
    names = r"A, B, C, D(, motor)? contradict each other"
    with pytest.raises(fl.ConvergenceError, match=names) as caught:
        fl.GeneralisedAlpha().run(four_bar(tilt, u), duration=u.time(0.5), step=STEPS[steps](u))
    violations = caught.value.result.joint_violations
    # lengths and angles: those of lengths in metres
    assert violations.max() / max(1.0, u.metre) < 1e-5


@pytest.mark.parametrize("steps", STEPS)
def test_the_same_loop_with_parallel_hinges_moves(steps):
    result = fl.GeneralisedAlpha().run(four_bar(0.0), duration=0.5, step=STEPS[steps](METRES))
    assert result.joint_violations.max() < 1e-8
    np.testing.assert_allclose(result.joint_coordinates[-1, 0], 1.0 - np.cos(0.5), atol=1e-9)


def random_rows(seed: int, m: int, n: int, rank: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return rng.normal(size=(m, rank)) @ rng.normal(size=(rank, n)) / n


@pytest.mark.parametrize("seed", range(3))
def test_the_filter_is_the_projection(seed):
    """Against the null space by singular values, in the measure that was asked for."""
    B, rng = random_rows(seed, 9, 12, 6), np.random.default_rng(seed)
    measure, x = rng.uniform(0.2, 5.0, 9), rng.normal(size=9)
    found = IdleMultipliers.of(sp.csr_matrix(B), np.ones(12), measure).remove(x)
    idle = scipy.linalg.null_space((B / measure[:, np.newaxis]).T, rcond=1e-8)
    scaled = measure * x
    np.testing.assert_allclose(found, (scaled - idle @ (idle.T @ scaled)) / measure, atol=1e-8)
    np.testing.assert_allclose(B.T @ found, B.T @ x, atol=1e-8)


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
def test_minimum_norm_measures_moments_by_the_length_of_the_model(u):
    """One body, held by a ball and by a clamp: of all forces that hold it, the smallest.

    The length of the model is what a moment counts: joint forces are those of a least squares
    problem that is solved here with all forces and moments of both joints.
    """
    length = 4.0
    scene = fl.Scene(
        gravity=u.acceleration([0, 0, -10.0]), redundant=fl.joints.RedundantConstraints.MINIMUM_NORM
    )
    mass, inertia = u.mass(2.0), u.inertia([0.1, 0.1, 0.1])
    body = scene.add(fl.RigidBody(mass, inertia, (0, 0, 0), name="body"))
    far = scene.add(fl.RigidBody(mass, inertia, u.length([length, 0, 0]), name="far"))
    positions = np.array([[-1.0, 0, 0], [0.5, 0, 0]])
    scene.add(
        fl.joints.Spherical(
            fl.ground(), body.point("centre"), at=u.length(positions[0]), name="ball"
        )
    )
    scene.add(
        fl.joints.Fixed(fl.ground(), body.point("centre"), at=u.length(positions[1]), name="clamp")
    )
    scene.add(fl.joints.Fixed(fl.ground(), far.point("centre"), name="other"))
    result = fl.GeneralisedAlpha().run(scene, duration=u.time(0.1), step=u.time(0.01))
    forces = u.inverse.wrench(result.joint_forces[-1, :2]).reshape(2, 2, 3)
    axes = [joint.frame()[1:] for joint in scene.joints[:2]]
    found = np.concatenate([[f @ e for f, e in zip(forces, axes, strict=True)]]).reshape(2, 6)
    # unknowns: force of the ball, force and moment of the clamp over the length
    B = np.zeros((6, 9))
    for k, position in enumerate(positions):
        B[:3, 3 * k : 3 * k + 3] = np.eye(3)
        x, y, z = position
        B[3:, 3 * k : 3 * k + 3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    B[3:, 6:] = length * np.eye(3)
    least = np.linalg.lstsq(B, np.array([0, 0, 20.0, 0, 0, 0]), rcond=None)[0]
    expected = np.zeros((2, 6))
    expected[0, :3], expected[1, :3] = least[:3], least[3:6]
    expected[1, 3:] = length * least[6:]
    # joints act on the ground with the opposite
    np.testing.assert_allclose(found, -expected, atol=1e-4)


@pytest.mark.parametrize("seed", range(8))
def test_rows_that_follow_from_others_are_found_in_a_sparse_matrix(seed):
    rng = np.random.default_rng(seed)
    free, extra = sp.random(60, 120, 0.08, random_state=rng), seed
    mixed = sp.random(extra, 60, 0.08, random_state=rng)
    rows = sp.vstack([free, mixed @ free]).tocsr()[rng.permutation(60 + extra)]
    found = redundant_constraints(rows, np.ones(120), np.ones(60 + extra))
    rank = np.linalg.matrix_rank(rows.toarray())
    kept = np.delete(rows.toarray(), found, axis=0)
    assert len(found) == 60 + extra - rank
    assert np.linalg.matrix_rank(kept) == rank


@pytest.mark.parametrize("count", [4, 300])
def test_one_constraint_too_many_of_a_long_ring_is_found(count):
    """A ring of hinged bodies in a plane: three of its constraints follow from the others."""
    scene, angle = fl.Scene(), 2.0 * np.pi / count
    radius = 0.5 / np.sin(0.5 * angle)
    middles = [(radius * np.cos(k * angle), radius * np.sin(k * angle), 0) for k in range(count)]
    bodies = [scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), x)) for x in middles]
    for k, body in enumerate(bodies):
        position = 0.5 * (np.array(middles[k - 1]) + middles[k])
        scene.add(
            fl.joints.Revolute(bodies[k - 1].point("centre"), body.point("centre"), at=position)
        )
    with pytest.raises(ValueError, match=f"3 of {5 * count} constraints are redundant"):
        fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.1)


def test_what_motions_can_mend_is_no_contradiction():
    """Violations along a motion of the loop's bodies are those of an unfinished iteration."""
    equations = fl.extend.Equations(four_bar(0.0), dynamics=True)
    constraints = equations.constraints(equations.start.frames)
    B = constraints.jacobian
    motion = np.random.default_rng(0).normal(size=B.shape[1])
    mended = 1e-6 * (B @ motion)
    assert np.abs(mended).max() > 1e-6
    assert constraints.contradiction(mended, 1e-9) == ""
    idle = scipy.linalg.null_space(B.toarray().T, rcond=1e-9)
    assert idle.shape[1]
    said = constraints.contradiction(mended + 3e-8 * idle[:, 0] / np.abs(idle[:, 0]).max(), 1e-9)
    assert "contradict each other" in said
    # what motions can mend, a hundred times as large, is not in the number
    number = re.search(r"violation of (\S+) ", said)
    assert number is not None
    assert 1e-8 < float(number[1]) < 3.1e-8


@pytest.mark.parametrize("seed", range(3))
def test_rows_of_round_off_are_redundant(seed):
    """Where both sides are on one body a row is what is left of terms that cancel."""
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(5, 12))
    noise = 1e-15 * rng.normal(size=(2, 12))
    B = sp.csr_matrix(np.vstack([rows[:2], noise[:1], rows[2:], noise[1:]]))
    np.testing.assert_array_equal(redundant_constraints(B, np.ones(12), np.ones(7)), [2, 6])


def test_a_joint_within_one_rigid_body_is_redundant():
    """Two positions of one body, far from its centre: its rows are round-off."""
    scene, body = fl.Scene(), fl.RigidBody(1.0, (1, 1, 1), (1 / 3, 0.1, -0.7))
    scene.add(body)
    at = (1 / 7, 1 / 9, 1 / 11)
    scene.add(fl.joints.Fixed(body.point(at), body.point("centre"), at=at, name="within"))
    with pytest.raises(ValueError, match=r"6 of 6 constraints are redundant.*Remove within"):
        fl.statics(scene)


def test_what_binds_nothing_that_is_free_is_to_be_removed():
    scene = fl.Scene()
    steel = fl.Material(2.1e11, 0.3, 7850.0)
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.circle(0.01, steel), cells=2)
    )
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.joints.Fixed(fl.ground(), beam.point("start"), name="twice"))
    with pytest.raises(ValueError, match="Remove twice: the others suffice") as caught:
        fl.statics(scene)
    assert "Spherical" not in str(caught.value)


def parallelograms(count: int, gravity: float) -> tuple[fl.Scene, fl.RigidBody]:
    """N-four-bar mechanism of the IFToMM benchmarks: equal bars, upright at first, 1 m/s."""
    scene = fl.Scene(
        gravity=(0, -gravity, 0), redundant=fl.joints.RedundantConstraints.MINIMUM_NORM
    )
    across, along = 1.0 / 12.0, 1e-4

    def bar(x: float, y: float, inertia: tuple[float, float, float]) -> fl.RigidBody:
        return scene.add(fl.RigidBody(1.0, inertia, (x, y, 0)))

    upright = [bar(i, 0.5, (across, along, across)) for i in range(count + 1)]
    level = [bar(i + 0.5, 1.0, (along, across, across)) for i in range(count)]
    for i, each in enumerate(upright):
        each.add_velocity((0.5, 0, 0), omega=(0, 0, -1), about=each.frames[0, 0])
        root = fl.joints.Revolute(fl.ground(), each.point("centre"), at=(i, 0, 0), axis=Z)
        scene.add(root)
    for i, each in enumerate(level):
        each.add_velocity((1.0, 0, 0))
        for k in (i, i + 1):
            ends = upright[k].point("centre"), each.point("centre")
            scene.add(fl.joints.Revolute(*ends, at=(k, 1, 0), axis=Z))
    return scene, upright[0]


@pytest.mark.parametrize(
    ("scheme", "drift"),
    [
        pytest.param(fl.GeneralisedAlpha(), 3e-4, id="generalised-alpha"),
        pytest.param(fl.EnergyMomentum(), 1e-6, id="energy-momentum"),
        pytest.param(fl.EnergyDecaying(), 1e-5, id="energy-decaying"),
        pytest.param(fl.schemes.Variational(), 3e-4, id="variational"),
    ],
)
def test_parallelograms_swing_through_the_singular_posture(scheme, drift):
    """One pendulum, whose bars are all in line on the way: 3 (2 N + 1) constraints too many."""
    count, gravity, duration = 2, 9.81, 1.6
    scene, bar = parallelograms(count, gravity)
    result = scheme.run(scene, duration=duration, step=2e-3, progress=False)
    inertia, weight = (count + 1) / 3 + count, ((count + 1) / 2 + count) * gravity
    exact = solve_ivp(
        lambda _, y: (y[1], -weight / inertia * np.cos(y[0])),
        (0.0, duration),
        (np.pi / 2, -1.0),
        rtol=1e-10,
        atol=1e-12,
        t_eval=result.times,
    )
    way = 0.5 * np.column_stack([np.cos(exact.y[0]), np.sin(exact.y[0])])
    assert exact.y[0].min() < -0.5 * np.pi
    assert np.abs(result.position(bar.point("centre"))[:, :2] - way).max() < 2e-4
    energy = result.kinetic + result.potential
    assert np.abs(energy - energy[0]).max() < drift * result.kinetic.max()


ALPHA = np.radians(60.0)


def creases(fold: float) -> np.ndarray:
    """Creases of a vertex of Miura's fold from the angle of the first one, unit vectors (4, 3).

    The sectors between them are α, π − α, π − α and α.
    """
    b = 0.5 * fold
    side = np.array([np.cos(ALPHA), np.sin(ALPHA) * np.cos(b), np.sin(ALPHA) * np.sin(b)])
    t = 2.0 * np.arctan(np.tan(ALPHA) * np.sin(b))
    return np.array([(1, 0, 0), side, (-np.cos(t), 0, -np.sin(t)), side * (1, -1, 1)])


def folds(fold: float) -> np.ndarray:
    """Angles of all four creases, (4,)."""
    c = creases(fold)
    normals = np.cross(c, np.roll(c, -1, axis=0))
    normals /= np.linalg.norm(normals, axis=1)[:, np.newaxis]
    before = np.roll(normals, 1, axis=0)
    sines = np.einsum("ij,ij->i", np.cross(before, normals), c)
    return np.arctan2(sines, np.einsum("ij,ij->i", before, normals))


FIRST = np.radians(40.0)
"""Angle of the first crease at the start."""


def miura() -> tuple[fl.Scene, list[fl.joints.Revolute]]:
    """Four rigid panels around a vertex, one of them held, and their hinges; the first is driven.

    Their axes meet: three constraints are redundant at the ends of steps, not at midpoints, where
    conserving schemes have their forces.
    """
    scene = fl.Scene(gravity=(0, 0, -9.81), redundant=fl.joints.RedundantConstraints.MINIMUM_NORM)
    c, panels = creases(FIRST), []
    for p, q in zip(c, np.roll(c, -1, axis=0), strict=True):
        normal = np.cross(p, q) / np.linalg.norm(np.cross(p, q))
        axes = np.column_stack([p, np.cross(normal, p), normal])
        panel = fl.RigidBody.box(1.0, (1.0, 0.8, 0.01), position=0.5 * (p + q), rotation=axes)
        panels.append(scene.add(panel).point("centre"))
    hinges = [
        scene.add(fl.joints.Revolute(panels[i - 1], panels[i], at=(0, 0, 0), axis=c[i]))
        for i in range(4)
    ]
    scene.add(fl.joints.Fixed(fl.ground(), panels[0]))
    scene.add(fl.joints.Drive(hinges[0].angle, lambda t: 0.6 * (1 - np.cos(2 * t))))
    return scene, hinges


SCHEMES = {
    "generalised-alpha": fl.GeneralisedAlpha(),
    "energy-momentum": fl.EnergyMomentum(),
    "energy-decaying": fl.EnergyDecaying(),
    "variational": fl.schemes.Variational(),
}


@pytest.mark.parametrize("scheme", SCHEMES)
def test_rigid_panels_fold_like_the_vertex_of_miura(scheme):
    scene, hinges = miura()
    result = SCHEMES[scheme].run(scene, duration=1.5, step=5e-3, progress=False)
    found = np.column_stack([result.coordinate(hinge).ravel() for hinge in hinges])
    exact = [folds(FIRST + q) - folds(FIRST) for q in found[:, 0]]
    np.testing.assert_allclose(found, exact, atol=1e-9)
    assert np.ptp(found[:, 1]) > 1.0
    assert result.iterations[-1] < 10 * (len(result.times) - 1)


@pytest.mark.parametrize("scheme", [*SCHEMES, "composed"])
def test_rigid_panels_resume_to_the_last_bit(tmp_path, scheme):
    one = (SCHEMES | {"composed": fl.schemes.Composed()})[scheme]
    plan = {"duration": 0.1, "step": 5e-3, "checkpoint_every": 10, "progress": False}
    whole = one.run(miura()[0], file=tmp_path / "whole.h5", **plan)
    file = tmp_path / "run.h5"
    with interrupted():
        one.run(miura()[0], file=file, **plan)
    resumed = one.resume(miura()[0], file)
    np.testing.assert_array_equal(resumed.frames, whole.frames)
    np.testing.assert_array_equal(resumed.iterations, whole.iterations)


@pytest.mark.parametrize("solve", [fl.statics, fl.follow_loads, fl.follow_path])
def test_equilibrium_with_redundant_joints_of_a_shell_converges(solve):
    """A strip bent by a body at its end, which holds a node whose rotation is held already.

    A rigid body has no stiffness in statics, and nodes of shells none about their normals: the
    compliance of redundant constraints must not follow what little of it a state has.
    """
    rule = fl.joints.RedundantConstraints.MINIMUM_NORM
    young, nu, length, width, height, moment = 2e5, 0.3, 30.0, 10.0, 1.0, 1500.0
    scene = fl.Scene(redundant=rule)
    sheet = fl.mesh.parametric_surface(lambda a, b: (length * a, width * b, 0.0), (8, 2))
    section = fl.ShellSection.layer(height, fl.Material(E=young, nu=nu, density=7.85e-9))
    strip = scene.add(fl.Shell(sheet, section, name="strip"))
    strip.clamp("a=0")
    strip.symmetry("b=0", normal=(0, 1, 0))
    end = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), (length, 0, 0), name="end")).point("centre")
    scene.add(fl.joints.Planar(fl.ground(), end, axis=(0, 1, 0)))
    for point in strip.points("a=1"):
        scene.add(fl.joints.Planar(end, point, at=point.position, axis=(1, 0, 0)))
    scene.add(fl.joints.InPlane(end, strip.point("10"), axis=Z))
    scene.add(fl.PointLoad(end, moment=(0, -moment, 0)))
    result = solve(scene)
    angle = np.arcsin(result.rotation(end)[-1][2, 0])
    bending = young * width * height**3 / 12.0
    assert (1.0 - nu**2) * moment * length / bending < angle < moment * length / bending
    assert result.failed_steps == 0
