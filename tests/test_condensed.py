"""Static condensation of chains: the solutions equal those of the whole matrix."""

import numpy as np
import pytest
import scipy.sparse as sp

import fem_lie as fl
from demos.space_net import square_net
from fem_lie.linear import choice
from fem_lie.linear.choice import CHAINS, Solutions, choose
from fem_lie.linear.condensed import preconditioner
from fem_lie.linear.condensed.elimination import plan_of
from fem_lie.linear.packages import Alone, ByChains
from fem_lie.linear.saddle_point import KKT, Incidences


def chain(count: int, reach: int) -> np.ndarray:
    """Pairs of nodes in a row that are coupled up to a distance ``reach``."""
    k = np.arange(count)
    return np.concatenate([np.stack([k[r:], k[:-r]], axis=1) for r in range(1, reach + 1)])


def ring(count: int) -> np.ndarray:
    """The same, closed."""
    k = np.arange(count)
    return np.stack([k, (k + 1) % count], axis=1)


def star(arms: int, length: int) -> np.ndarray:
    """Chains attached to node 0."""
    found = [np.append(0, np.arange(length) + 1 + arm * length) for arm in range(arms)]
    return np.concatenate([np.stack([nodes[1:], nodes[:-1]], axis=1) for nodes in found])


def grid(side: int, cells: int) -> np.ndarray:
    """A net: junctions with cables of some nodes between."""
    knots, pairs, more = np.arange(side * side).reshape(side, side), [], side * side
    for a, b in ((knots[1:], knots[:-1]), (knots[:, 1:], knots[:, :-1])):
        for one, two in zip(a.ravel(), b.ravel(), strict=True):
            nodes = np.concatenate([[one], np.arange(more, more + cells - 1), [two]])
            pairs.append(np.stack([nodes[1:], nodes[:-1]], axis=1))
            more += cells - 1
    return np.concatenate(pairs)


def crowd(count: int) -> np.ndarray:
    """Random pairs."""
    rng = np.random.default_rng(5)
    pairs = rng.integers(0, count, (2 * count, 2))
    return pairs[pairs[:, 0] != pairs[:, 1]]


# pairs, nodes that two constraints touch, and how many nodes are left
CASES = {
    "chain": (chain(30, 1), (), 0),
    "chain that bends": (chain(30, 2), (), 0),
    "chain on constraints": (chain(30, 2), (0, 29), 2),
    "closed ring": (ring(20), (), 0),
    "star of eight": (star(8, 5), (), 0),
    "net": (grid(4, 6), (0, 15), None),
    "crowd": (crowd(40), (3, 7), None),
}


def random_matrix(pairs: np.ndarray, touched: tuple[int, ...], seed: int = 0) -> KKT:
    """Unsymmetric, with held unknowns; three constraints on each touched node."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(int(pairs.max()) + 1)
    pairs, touched = order[pairs], tuple(order[list(touched)]) if touched else ()
    count = len(order)
    held = rng.random((count, 6)) < 0.4
    held[list(touched), :3] = False
    incidences = Incidences.of([{int(node)} for node in touched for _ in range(3)], count)
    both = [(pairs[:, 0], pairs[:, 1]), (pairs[:, 1], pairs[:, 0])]
    m = len(incidences.ptr) - 1
    angular = np.zeros(m, dtype=bool)
    units = np.tile(np.repeat([2.0, 1.0], 3), count)
    kkt = KKT(both, incidences, held, units=units, length=2.0, angular=angular)
    blocks = rng.normal(size=(len(kkt.indices), 6, 6))
    own = np.repeat(np.arange(count), np.diff(kkt.indptr)) == kkt.indices
    blocks[own] += 25.0 * np.eye(6)
    rows = np.zeros((m, 6))
    rows[np.arange(m), np.arange(m) % 3] = 1.0
    kkt.fill(blocks, rows.copy(), rows.copy(), np.ones(m))
    return kkt


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", CASES)
def test_solutions_are_those_of_the_whole_matrix(name, seed):
    pairs, touched, left = CASES[name]
    kkt = random_matrix(pairs, touched, seed)
    count = len(kkt.indptr) - 1
    plan = plan_of(kkt)
    if left is None:
        assert len(touched) <= count - len(plan.order) < count
    else:
        free = ~kkt.unit_rows[: 6 * count].reshape(-1, 6).all(axis=1)
        assert free.sum() - len(plan.order) == left
    A = sp.csr_matrix(kkt.csr).toarray()
    solver = fl.extend.DirectSolver(kkt, "test_condensed_", CHAINS)
    for _ in range(2):  # refactorised in the same memory
        solver.factorise()
        b = np.random.default_rng(seed).normal(size=len(A))
        solver.right_hand_side[:] = b
        solver.solve()
        wanted = np.linalg.solve(A, b)
        np.testing.assert_allclose(solver.solution, wanted, atol=1e-11 * np.abs(wanted).max())
    assert isinstance(solver._methods[0], ByChains)


@pytest.mark.parametrize("name", ["chain on constraints", "net"])
def test_chains_keep_their_factors_while_constraints_change(name, monkeypatch):
    pairs, touched, _ = CASES[name]
    kkt = random_matrix(pairs, touched)
    n = len(kkt.indptr) - 1
    nodes = sp.csr_matrix(kkt.csr).toarray()[: 6 * n, : 6 * n].reshape(n, 6, n, 6)
    blocks = nodes[np.repeat(np.arange(n), np.diff(kkt.indptr)), :, kkt.indices]
    made = []
    factors = preconditioner.factorise
    monkeypatch.setattr(
        preconditioner, "factorise", lambda *args: made.append(args) or factors(*args)
    )
    solver = fl.extend.DirectSolver(kkt, "test_condensed_", CHAINS)
    m, rng = len(kkt.measure), np.random.default_rng(1)
    for factor, anew, times in ((1.0, True, 1), (1.0, False, 1), (2.0, True, 2), (2.0, False, 2)):
        rows = np.zeros((m, 6))
        rows[:, :3] = np.eye(3)[np.arange(m) % 3] + 0.3 * rng.normal(size=(m, 3))
        kkt.fill(factor * blocks, rows.copy(), rows.copy(), np.ones(m), anew=anew)
        solver.refresh()
        b = rng.normal(size=6 * n + m)
        solver.right_hand_side[:] = b
        solver.solve()
        wanted = np.linalg.solve(sp.csr_matrix(kkt.csr).toarray(), b)
        np.testing.assert_allclose(solver.solution, wanted, atol=1e-11 * np.abs(wanted).max())
        assert len(made) == times
    assert isinstance(solver._methods[0], ByChains)


def test_where_a_node_alone_is_singular_the_whole_is_factorised():
    """Two nodes that are stiff only relative to each other, and one of them to the ground."""
    kkt = random_matrix(chain(4, 1), ())
    values, columns, pointers = kkt.csr
    free = np.flatnonzero(~kkt.unit_rows)
    row = free[0]
    inside = np.flatnonzero(columns[pointers[row] : pointers[row + 1]] // 6 == row // 6)
    values[pointers[row] + inside] = 0.0  # regular by its neighbours alone
    A = sp.csr_matrix(kkt.csr).toarray()
    solver = fl.extend.DirectSolver(kkt, "test_condensed_", CHAINS)
    solver.factorise()
    b = np.arange(1.0, len(A) + 1.0)
    solver.right_hand_side[:] = b
    solver.solve()
    assert not isinstance(solver._methods[0], ByChains)
    np.testing.assert_allclose(A @ solver.solution, b, atol=1e-9 * np.abs(b).max())


def methods(equations: fl.extend.Equations) -> tuple[fl.extend.Method, ...]:
    return choose(equations.matrix, "test_condensed_", Solutions.MANY).methods


def test_a_net_moves_as_with_factors_of_the_whole(monkeypatch):
    """Junctions remain of a large net; chains of bodies on joints keep their method."""
    scheme = fl.GeneralisedAlpha(radius=0.5, policy=fl.schemes.EveryIteration())

    def run() -> fl.Result:
        return scheme.run(square_net(2, 10), duration=3e-3, step=1e-3, progress=False)

    wanted = run()
    equations = fl.extend.Equations(square_net(2, 10), dynamics=True)
    assert methods(equations)[0].package == "umfpack"
    monkeypatch.setattr(choice, "LARGE", 10)
    assert methods(equations) == CHAINS
    plan = plan_of(equations.matrix)
    assert len(plan.sizes) - len(plan.order) <= 4 * 9 + 4  # nine knots, four masses
    found = run()
    np.testing.assert_array_equal(found.iterations, wanted.iterations)
    size = np.abs(wanted.frames[-1, :, 0]).max()
    np.testing.assert_allclose(
        found.frames[-1, :, 0], wanted.frames[-1, :, 0], atol=1e-12 * size, rtol=0
    )

    scene, last = fl.Scene(gravity=(0, 0, -9.81)), fl.ground()
    for k in range(20):
        body = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (k + 0.5, 0, 0)))
        scene.add(fl.joints.Spherical(last, body.point("centre"), at=(k, 0, 0)))
        last = body.point("centre")
    assert methods(fl.extend.Equations(scene, dynamics=True)) == (Alone("lu", "klu"),)
