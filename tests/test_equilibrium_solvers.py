"""Parts of statics and stability: inertia, pencils, directions of paths, derivatives, rates."""

import numpy as np
import pytest
import scipy.sparse as sp
from test_paths import arch

import fem_lie as fl
from benchmarks.levels import PROBLEMS
from fem_lie.lie.motions import add_turning
from fem_lie.linear.pivots import inertia, negative_determinant
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.stability.branches import _step_off_the_path
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.statics.arc_length import Passed
from fem_lie.solve.statics.load_steps import LoadSteps, SingularStartError, move
from fem_lie.solve.statics.statics import _first_that_arrives
from fem_lie.solve.statics.unstable import maxima
from tests.test_six_parameters import machine
from tests.test_statics import cantilever, stiffness
from tests.test_unstable import coil


def test_maxima_of_the_load_are_where_it_turns_back():
    assert maxima([0.5, 1.0]) == ()
    assert maxima([0.5, 0.9, 0.3, 0.4, 0.2, 1.0]) == (0.9, 0.4)


def dense(model: StableEquilibrium, factor: float) -> np.ndarray:
    """Tangent on what the constraints leave free."""
    import scipy.linalg

    model._fill(factor)
    K, B = model.pencil()
    Z = scipy.linalg.null_space(B.toarray()) if B.shape[0] else np.eye(K.shape[0])
    return Z.T @ K.toarray() @ Z


def test_inertia_is_that_of_the_eigenvalues():
    import scipy.sparse as sp

    random = np.random.default_rng(0)
    A = random.standard_normal((30, 30))
    A = A + A.T
    negative, zero = inertia(sp.csr_matrix(A))
    assert (negative, zero) == ((np.linalg.eigvalsh(A) < 0).sum(), 0)
    B = A.copy()
    B[:, 3] = B[:, 7]
    B[3] = B[7]
    assert inertia(sp.csr_matrix(B))[1] == 1


@pytest.mark.parametrize("joint", [False, True], ids=["clamped", "hinged by a joint"])
def test_tangent_is_symmetric_at_equilibrium_and_its_pivots_count_eigenvalues(joint):
    """Beams couple rotations; in local increments that vanishes where forces balance."""
    scene, _ = arch(12, hinged=joint)
    path = fl.follow_path(
        scene, 0.95, resolution=0.1, options=fl.stability.PathOptions(locate=None)
    )
    model = StableEquilibrium(scene, "test_")
    for station in path.stations[:: max(1, len(path) // 6)]:
        model.restore(station.state)
        K = dense(model, station.factor)
        assert np.abs(K - K.T).max() <= 1e-6 * np.abs(K).max()
        assert station.negative == (np.linalg.eigvalsh(K + K.T) < 0).sum()


def test_sign_of_the_determinant():
    random = np.random.default_rng(0)
    for size in (5, 6, 11):
        A = random.standard_normal((size, size))
        assert negative_determinant(sp.csr_matrix(A)) == (np.linalg.det(A) < 0)


def test_moments_about_fixed_axes_make_no_bifurcations():
    """The symmetric part of the tangent is indefinite there; the determinant does not change."""
    scene = coil(2.0)
    path = fl.follow_path(scene, 1.0, resolution=0.2)
    assert path.complete and not path.critical
    model = StableEquilibrium(scene, "test_")
    model.restore(path.stations[-1].state)
    model._fill(1.0)
    K, _ = model.pencil()
    K = K.toarray()
    assert np.abs(K - K.T).max() > 10.0  # EI is 100
    assert (np.linalg.eigvalsh(K + K.T) < 0).any()
    assert np.linalg.slogdet(K)[0] > 0


def test_beside_a_crossed_branch_modes_and_response_are_measured_in_one_unit():
    """What is left of the response has no part along the mode: displacements over the diameter."""
    scene, _ = arch(12)
    path = fl.follow_path(scene, 0.5, resolution=0.1, options=fl.stability.PathOptions(locate=None))
    model = StableEquilibrium(scene, "test_")
    station = path.stations[3]
    model.restore(station.state)
    h = np.random.default_rng(0).standard_normal(model.equations.unknowns.size)
    rest, _ = _step_off_the_path(model, station, h)
    n = model.equations.unknowns.moving
    unit = np.array([model.diameter] * 3 + [1.0] * 3)
    a, b = (x[: 6 * n].reshape(n, 6) / unit for x in (rest, h))
    assert abs(np.sum(a * b)) <= 1e-10 * np.linalg.norm(a) * np.linalg.norm(b)
    assert np.linalg.norm(model.translations(rest), axis=1).max() == pytest.approx(1.0)


def along(s: float) -> np.ndarray:
    """A path of two nodes that bends."""
    return np.array([[np.sin(s), 1 - np.cos(s), 0.0], [0.0, s, 0.2 * s * s]])


def walk(positions: list[np.ndarray], factors: list[float], turned: int = 99) -> list[bool]:
    """``turned``: from this step on the twists are against the displacements."""
    passed = Passed(positions[0])
    steps = enumerate(zip(factors[1:], positions[1:], positions[:-1], strict=True))
    return [
        passed.again(factor, here, (here - before) * (1 if k < turned else -1))
        for k, (factor, here, before) in steps
    ]


def test_running_back_is_noticed_and_a_limit_point_is_not():
    up = np.linspace(0.0, 1.0, 11)
    back = np.linspace(0.97, 0.17, 9)
    states = [along(s) for s in (*up, *back)]
    assert any(walk(states, [*up, *back]))
    # a loop that passes the same positions in the same sense goes on
    assert not any(walk(states, [*up, *back], turned=10))
    # the load goes down while the nodes go on
    beyond = [along(s) for s in (*up, *(2.0 - back))]
    assert not any(walk(beyond, [*up, *back]))
    # and where most nodes go back on another way
    aside = [along(s) + np.array([[0, 0, 0.3 * (1 - s)], [0, 0, 0]]) for s in back]
    assert not any(walk([*states[:11], *aside], [*up, *back]))


def test_ways_are_tried_in_turn_and_their_solutions_counted():
    scene = PROBLEMS["three turns by a moment"]()
    good = fl.statics(scene)

    def fails(kind=fl.ConvergenceError):
        raise kind("no equilibrium here", good)

    found = _first_that_arrives([fails, fails, lambda: good])
    assert found.failed_iterations == good.failed_iterations + 2 * good.total_iterations
    with pytest.raises(fl.ConvergenceError, match=r"2 methods were tried: \(1\) no .* \(2\) no"):
        _first_that_arrives([fails, fails])
    with pytest.raises(SingularStartError, match=r"^no equilibrium here$"):
        _first_that_arrives([lambda: fails(SingularStartError), lambda: good])


def test_increment_that_is_nan_anywhere_is_seen():
    """One nan, followed by numbers, must come out: the step has failed."""
    scene, _ = cantilever(stiffness(), 10.0, 2)
    equations = fl.extend.Equations(scene, dynamics=False)
    dx = np.full(equations.unknowns.size, 1e-3)
    dx[8] = np.nan
    assert np.isnan(move(equations, equations.start.frames.copy(), dx, linearised=False))


@pytest.mark.parametrize("links", [True, False])
def test_matrix_is_the_derivative_of_the_residual(links):
    scene = machine(clamped=True, links=links, loaded=True)
    scene.add(fl.joints.Revolute(scene.bodies[0].point("11"), fl.ground(), axis=(1, 2, 3)))
    rng, equations = np.random.default_rng(4), fl.extend.Equations(scene, dynamics=False)
    unknowns = equations.unknowns
    assert unknowns.separates_director.sum() >= 15
    equations.prescribed(1.0).act(1.0)
    H, weights = equations.start.frames.copy(), 0.1 * rng.normal(size=unknowns.m)
    dx = 0.1 * rng.normal(size=unknowns.size)
    dx[: 6 * unknowns.moving][unknowns.held.ravel()] = 0.0
    fl.extend.node_types.advance(unknowns.kinds, H, dx, *ways_of(unknowns))
    assert derivative_error(equations, H, weights, along_motion=False) <= 1e-7

    newton = LoadSteps(
        scene,
        Rotation.of((0, 0, 0), (0, 0, 0)),
        fl.schemes.Newton(1e-14, linearised_stress=False),
        "six_",
    )
    assert newton.solve(1.0)
    assert np.abs(newton.H - newton.equations.start.frames).max() > 0.1
    error = derivative_error(newton.equations, newton.H, newton.multipliers, along_motion=True)
    assert error <= 1e-7


def test_newton_converges_quadratically_and_needs_few_steps_with_linearised_stress():
    scene = machine(clamped=True, loaded=True)
    system = LoadSteps(
        scene,
        Rotation.of((0, 0, 0), (0, 0, 0)),
        fl.schemes.Newton(1e-14, linearised_stress=False),
        "six_",
    )
    system.equations.prescribed(1.0).act()
    system._factor, increments = 1.0, []
    while len(increments) < 20 and (not increments or increments[-1] > 1e-12):
        system.evaluate(1)
        system.refactorise(fl.extend.Refactorisation.ALL)
        increments.append(system.correct())
    logs = np.log(increments[-5:-1])
    # a rate of two; with the turning of unbalanced forces left in at equilibrium it would be one
    assert increments[-1] <= 1e-12
    assert (np.diff(logs)[1:] / np.diff(logs)[:-1]).max() > 1.5
    assert fl.statics(scene, load_steps=1).iterations[-1] <= 6


def ways_of(unknowns) -> tuple[np.ndarray, ...]:
    """What is held, moves uncoupled, and straight otherwise."""
    return unknowns.held, unknowns.separates_director, unknowns.separates_rotation


def derivative_error(equations: fl.extend.Equations, H, weights, *, along_motion: bool) -> float:
    """Of the matrix against differences of the residual, relative.

    Out of balance the matrix is the derivative along the motion of statics: what that has beyond
    the derivative of the forces is linear in the forces out of balance, and is taken out here.
    """
    unknowns = equations.unknowns
    n, zero, ones = unknowns.moving, np.zeros((unknowns.moving, 6)), np.ones(unknowns.m)
    rng, step = np.random.default_rng(3), 1e-5

    def residual(H, weights):
        r = np.empty(unknowns.size)
        found = equations.residual(fl.extend.TimeState(H, zero, zero, weights), ones, r)
        return r, found

    _, parts = residual(H, weights)
    forces = parts.outer + parts.inner
    state = fl.extend.TimeState(H, zero, zero, weights)
    equations.fill(state, parts, fl.extend.Plan(zero, ones, stressed=H))
    values, columns, pointers = equations.matrix.csr
    A, free = sp.csr_matrix((values, columns, pointers)).toarray(), ~unknowns.held
    if not along_motion:
        for i in np.flatnonzero(unknowns.separates_director):
            block = np.zeros((6, 6))
            add_turning(forces[i], 1.0, block)
            at = slice(6 * i, 6 * i + 6)
            A[at, at] -= block * np.outer(free[i], free[i])
    worst = 0.0
    for _ in range(4):
        dx = rng.normal(size=unknowns.size)
        dx[: 6 * n][unknowns.held.ravel()] = 0.0
        ends = []
        for sign in (1, -1):
            moved = H.copy()
            fl.extend.node_types.advance(
                unknowns.kinds, moved, -sign * step * dx, *ways_of(unknowns)
            )
            ends.append(residual(moved, weights + sign * step * dx[6 * n :])[0])
        found = (ends[0] - ends[1]) / (2 * step)
        worst = max(worst, np.abs(A @ dx - found).max() / np.abs(found).max())
    return worst
