"""The iteration matrix in twists of moved nodes, and what is factorised of it."""

import numpy as np
import pytest
import scipy.sparse as sp

import fem_lie as fl
from fem_lie.extend import DirectSolver, Equations, Plan, TimeState, node_types
from fem_lie.schemes import MatrixTerms, SkewPart

RUBBER = fl.Material(1e8, 0.3, 1000.0)
SECTION = fl.Section.circle(0.01, RUBBER)
H = 1e-2
MASS, DAMPING = 4.0 / H**2, 2.0 / H
BARE = MatrixTerms(gyroscopic=False, geometric=False)


def mechanism(group):
    """Two beams and a rigid body on joints, one of them to the ground."""
    scene, section = fl.Scene(), fl.Section.rectangle(0.02, 0.01, RUBBER)
    one = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=3)
    two = fl.Beam.straight((1, 0, 0), (1, 1, 0), section, cells=3)
    body = fl.RigidBody(0.3, (0.01, 0.02, 0.02), (1, 1, 0))
    for each in (one, two, body):
        scene.add(each.set_group(group))
    scene.add(fl.joints.Revolute(fl.ground(), one.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=(1, 0, 0)))
    scene.add(fl.joints.Spherical(two.point("end"), body.point("centre")))
    return scene


class Step:
    """End of a step of random increments, with accelerations and velocities linear in them."""

    def __init__(self, scene, size):
        self.equations = Equations(scene, dynamics=True)
        rng, unknowns = np.random.default_rng(4), self.equations.unknowns
        self.n, self.kinds = unknowns.moving, unknowns.kinds
        self.begin = self.equations.start.frames.copy()
        self.d, self.multipliers = size * rng.normal(size=(self.n, 6)), np.zeros(unknowns.m)
        self.held = self.equations.matrix.held
        self.d[self.held] = 0.0

    def state(self, d):
        """State after increments ``d`` of the group."""
        frames, twist, rate = self.begin.copy(), np.zeros((self.n, 6)), np.zeros((self.n, 6))
        node_types.move_all(self.kinds, self.begin, d, frames)
        for i, kind in enumerate(self.kinds):
            node_types.to_local(kind, frames[i], DAMPING * d[i], MASS * d[i], twist[i], rate[i])
        return TimeState(frames, twist, rate, self.multipliers)

    def residual(self, d):
        r = np.empty(6 * self.n + len(self.multipliers))
        return r, self.equations.residual(self.state(d), np.ones_like(self.multipliers), r)

    def matrix(self, terms):
        now, (_, forces) = self.state(self.d), self.residual(self.d)
        ones = np.ones_like(self.multipliers)
        plan = Plan(self.d, ones, MASS, DAMPING, stressed=now.H, matrix_terms=terms)
        self.equations.fill(now, forces, plan)
        values, columns, pointers = self.equations.matrix.csr
        return sp.csr_matrix((values.copy(), columns, pointers))


groups = pytest.mark.parametrize("group", fl.lie.Group, ids=lambda group: group.name)


@groups
def test_it_is_the_derivative_of_the_residual_along_twists(group):
    """Far from the start of the step, with gyroscopic terms: ``S h = dr`` for ``δd = T⁻¹ h``."""
    step = Step(mechanism(group), 0.1)
    matrix, rng, ε = step.matrix(MatrixTerms(True, True)), np.random.default_rng(1), 1e-6
    h = np.where(step.held, 0.0, rng.normal(size=step.held.shape))
    change, now, inverse = h.copy(), step.state(step.d).H, np.empty((6, 6))
    for i, kind in enumerate(step.kinds):
        node_types.tangent_inverse(kind, step.d[i], inverse)
        change[i] = np.where(step.held[i], 0.0, inverse @ h[i])
        node_types.to_group(kind, now[i], change[i])
    ahead, behind = (step.residual(step.d + s * ε * change)[0] for s in (1, -1))
    numeric = (ahead - behind) / (2 * ε)
    x = np.append(h.ravel(), np.zeros_like(step.multipliers))
    free = np.append(~step.held.ravel(), np.ones(len(step.multipliers), dtype=bool))
    found = (matrix @ x)[free]
    np.testing.assert_allclose(found, numeric[free], atol=1e-7 * np.abs(found).max())


@groups
@pytest.mark.parametrize("size", [0.01, 0.3])
def test_without_gyroscopic_and_geometric_terms_it_is_symmetric(group, size):
    """Whatever the increments, joints included; the derivative in increments was not, by 1e-2."""
    matrix = Step(mechanism(group), size).matrix(BARE)
    assert abs(matrix - matrix.T).max() < 1e-14 * abs(matrix).max()


def net(omega):
    """Twelve bars of three cells, rigidly connected where they meet, in free flight."""
    i, j = (each.ravel() for each in np.mgrid[:13, :13])
    number = np.full((13, 13), -1)
    on_line = (i % 3 == 0) | (j % 3 == 0)
    number[i[on_line], j[on_line]] = np.arange(on_line.sum())
    points = np.column_stack([i, j, 0 * i])[on_line] / 12
    lines = number[:, ::3], number.T[:, ::3]
    cells = [np.stack([n[:-1], n[1:]], axis=-1).reshape(-1, 2) for n in lines]
    body = fl.Beam(
        fl.mesh.LineMesh.from_cells(points, np.concatenate(cells)),
        SECTION,
    )
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    body.add_velocity((3, 0, 1))
    body.add_velocity(omega=omega, about=(0.5, 0.5, 0))
    return scene


@pytest.fixture
def factorised(monkeypatch):
    """Kinds of the factorisations of a run, and whether their matrices are symmetric."""
    found = []
    plain = DirectSolver.factorise

    def observed(solver):
        plain(solver)
        found.append((solver._methods[0].kind, solver._own.is_symmetric()))

    monkeypatch.setattr(DirectSolver, "factorise", observed)
    return found


@pytest.mark.parametrize("group", fl.lie.Group, ids=lambda group: group.name)
def test_a_symmetric_package_solves_the_same_equations(group, factorised):
    """As often, with as many iterations."""
    runs = []
    for choice, kind in ((SkewPart.KEPT, "lu"), (SkewPart.DROPPED_IF_SMALL, "cholesky")):
        scene = net((1, 2, 1))
        scene.bodies[0].set_group(group)
        scheme = fl.GeneralisedAlpha(skew_part=choice)
        runs.append(scheme.run(scene, duration=0.1, step=2e-3))
        assert factorised[-1] == (kind, kind == "cholesky")
        factorised.clear()
    kept, dropped = runs
    assert dropped.factorisations == kept.factorisations
    assert dropped.iterations[-1] <= 1.02 * kept.iterations[-1]
    np.testing.assert_allclose(dropped.frames, kept.frames, atol=1e-8)


def test_a_large_skew_part_is_kept(factorised):
    """Gyroscopic terms, which are in the matrix where something rotates by 0.2 rad in a step."""
    fl.GeneralisedAlpha().run(net((0, 0, 40)), duration=0.05, step=5e-3)
    assert factorised[-1] == ("lu", False)


def test_small_scenes_keep_the_skew_part(factorised):
    """One package is the fastest for them whatever the values."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=12))
    scene.add(fl.Clamp(beam.point("start")))
    fl.GeneralisedAlpha().run(scene, duration=0.02, step=2e-3)
    assert factorised[-1] == ("lu", False)


def test_held_unknowns_are_increments():
    """Without drilling rotations frames depend on the step alone, not on its iterates."""

    def frames(tolerance):
        mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.3 * a * b), (3, 3))
        plate = fl.Shell(mesh, fl.ShellSection.layer(0.01, RUBBER))
        plate.clamp("a=0")
        scene = fl.Scene(gravity=(0, 3, -9.81))
        scene.add(plate)
        scheme = fl.GeneralisedAlpha(tolerance=tolerance)
        return scheme.run(scene, duration=0.2, step=1e-2).frames

    np.testing.assert_allclose(frames(1e-10), frames(1e-13), atol=1e-8)


def test_iterations_of_a_beam_that_swings():
    """Stiffness refers to twists: with the increments of the factorisation it takes 3.4 a step."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    cord = fl.Section.circle(0.005, fl.Material(E=1e9, nu=0.3, density=1000.0))
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), cord, cells=12))
    scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=0.4, step=1e-3)
    assert result.iterations[-1] < 2.6 * 400


def test_wrong_choice():
    with pytest.raises(ValueError, match="skew_part"):
        fl.GeneralisedAlpha(skew_part=7)
