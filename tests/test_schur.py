"""Positive definite matrices with few dense rows: solutions, pivots, and what is refused."""

import gc

import numpy as np
import pytest
import scipy.sparse as sp

import fem_lie as fl
from fem_lie.linear.choice import Solutions
from fem_lie.linear.condensed import schur
from fem_lie.linear.condensed.schur import MOST, dense_rows_of
from fem_lie.linear.equilibrated import Equilibrated
from fem_lie.linear.low_rank import LowRank
from fem_lie.linear.packages import BySchurComplement
from fem_lie.linear.pivots import inertia
from fem_lie.linear.saddle_point import KKT, Incidences

BY_SCHUR = BySchurComplement("cholesky", "cholmod")
COUNT, M = 30, 5


def matrix(rng, *, frames=(), indefinite=False, joints=M) -> tuple[KKT, np.ndarray]:
    """Matrix of a chain of nodes with some constraints; those of ``frames`` are unsymmetric."""
    nodes = np.arange(COUNT)
    pairs = (np.append(nodes[:-1], nodes[1:]), np.append(nodes[1:], nodes[:-1]))
    touched = [set(rng.integers(0, COUNT, 8).tolist()) for _ in range(joints)]
    held = np.zeros((COUNT, 6), dtype=bool)
    held[0], held[5, 3:] = True, True
    incidences = Incidences.of(touched, COUNT)
    scales = {"units": np.ones(6 * COUNT), "length": 1.0, "angular": np.zeros(joints, dtype=bool)}
    kkt = KKT([pairs], incidences, held, **scales)
    rows = np.repeat(nodes, np.diff(kkt.indptr))
    whole = rng.normal(size=(COUNT, 6, COUNT, 6))
    whole = 0.1 * (whole + whole.transpose(2, 3, 0, 1))
    for i in nodes:
        whole[i, :, i] += 8.0 * np.eye(6)
    for i in frames:
        whole[i, :, i] += rng.normal(size=(6, 6))
        whole[i, :, i + 1] += rng.normal(size=(6, 6))
    if indefinite:
        whole[7, :, 7] -= 20.0 * np.eye(6)
    blocks = np.array([whole[i, :, j] for i, j in zip(rows, kkt.indices, strict=True)])
    rows = rng.normal(size=(len(incidences.nodes), 6))
    kkt.fill(blocks, rows.copy(), rows.copy(), np.ones(joints))
    return kkt, sp.csr_matrix(kkt.csr).toarray()


def solved(kkt: KKT, methods) -> tuple[fl.extend.DirectSolver, np.ndarray]:
    solver = fl.extend.DirectSolver(kkt, "test_border_", methods)
    solver.factorise()
    solver.right_hand_side[:] = np.arange(1.0, len(solver.solution) + 1.0)
    solver.solve()
    return solver, solver.solution.copy()


@pytest.mark.parametrize("frames", [(), (4,), (4, 11)])
def test_solutions_are_those_of_the_whole(rng, frames):
    kkt, A = matrix(rng, frames=frames)
    solver, found = solved(kkt, [BY_SCHUR])
    wanted = np.linalg.solve(A, np.arange(1.0, len(A) + 1.0))
    assert solver._methods == (BY_SCHUR,)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12 * np.abs(wanted).max())
    own = Equilibrated(kkt)
    own.take()
    dense = dense_rows_of(own, 6 * COUNT)
    nodes = np.flatnonzero(dense[: 6 * COUNT].reshape(-1, 6).any(axis=1))
    assert dense[6 * COUNT :].all()
    assert set(nodes) == set(frames)


def test_negative_pivots_are_those_of_the_whole(rng):
    kkt, A = matrix(rng)
    solver, _ = solved(kkt, [BY_SCHUR])
    assert solver.negative_pivots() == inertia(sp.csr_matrix(A))[0] == M
    kkt, A = matrix(rng, frames=(4,))
    solver, _ = solved(kkt, [BY_SCHUR])
    # B and Cᵀ differ: the number of negative pivots is unknown
    assert solver.negative_pivots() is None


def test_what_is_indefinite_inside_or_wide_goes_to_the_next(rng):
    kkt, A = matrix(rng, indefinite=True)
    solver, found = solved(kkt, [BY_SCHUR, fl.extend.Method("lu", "mumps")])
    assert solver._methods == (fl.extend.Method("lu", "mumps"),)
    wanted = np.linalg.solve(A, np.arange(1.0, len(A) + 1.0))
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
    wide = range(0, COUNT - 1, 2)
    assert 6 * len(wide) + M > MOST
    kkt, A = matrix(rng, frames=wide)
    solver, found = solved(kkt, [BY_SCHUR, fl.extend.Method("lu", "mumps")])
    assert solver._methods == (fl.extend.Method("lu", "mumps"),)
    wanted = np.linalg.solve(A, np.arange(1.0, len(A) + 1.0))
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())


def test_errors_within_petsc_survive_a_collection_of_garbage(rng):
    """PETSc for Python lost them, and the process ended with a segmentation fault."""
    kkt, A = matrix(rng, indefinite=True)
    last = fl.extend.Method("lu", "mumps")
    before = gc.get_threshold()
    gc.freeze()
    gc.set_threshold(1, 1, 1)
    try:
        solver, found = solved(kkt, [BY_SCHUR, last])
    finally:
        gc.set_threshold(*before)
        gc.unfreeze()
    assert solver._methods == (last,) and gc.isenabled()
    wanted = np.linalg.solve(A, np.arange(1.0, len(A) + 1.0))
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())


def test_a_matrix_without_dense_rows_goes_to_the_next(rng):
    """CHOLMOD refuses to solve for no columns."""
    kkt, A = matrix(rng, joints=0)
    last = fl.extend.Method("lu", "mumps")
    solver, found = solved(kkt, [BY_SCHUR, last])
    assert solver._methods == (last,)
    assert not BY_SCHUR.fits(kkt, solver._own)
    wanted = np.linalg.solve(A, np.arange(1.0, len(A) + 1.0))
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())


def test_a_method_that_reads_one_half_is_passed_over_where_the_border_fails(rng):
    """Frames make it unsymmetric, and ``K`` is indefinite."""
    kkt, A = matrix(rng, frames=(4,), indefinite=True)
    half, last = fl.extend.Method("cholesky", "mumps"), fl.extend.Method("lu", "mumps")
    solver, found = solved(kkt, [BY_SCHUR, half, last])
    assert solver._methods == (last,) and half not in solver._solvers
    wanted = np.linalg.solve(A, np.arange(1.0, len(A) + 1.0))
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())


def test_the_inside_keeps_its_factors_while_the_border_changes(rng, monkeypatch):
    kkt, _ = matrix(rng)
    blocks = np.zeros((len(kkt.indices), 6, 6))
    solver, _ = solved(kkt, [BY_SCHUR])
    made = []
    factorise = schur.SchurComplement._factorise

    def counted(self, parts):
        before = self._made
        factorise(self, parts)
        made.append(self._made != before)

    monkeypatch.setattr(schur.SchurComplement, "_factorise", counted)
    A = sp.csr_matrix(kkt.csr).toarray()
    inside = A[: 6 * COUNT, : 6 * COUNT].reshape(COUNT, 6, COUNT, 6)
    rows = np.repeat(np.arange(COUNT), np.diff(kkt.indptr))
    blocks = np.ascontiguousarray(inside[rows, :, kkt.indices])
    for anew in (False, True):
        rows = rng.normal(size=(len(kkt.incidences.nodes), 6))
        kkt.fill(blocks, rows.copy(), rows.copy(), np.ones(M), anew=anew)
        solver.factorise()
        solver.right_hand_side[:] = 1.0
        solver.solve()
        wanted = np.linalg.solve(sp.csr_matrix(kkt.csr).toarray(), np.ones(len(A)))
        np.testing.assert_allclose(solver.solution, wanted, atol=1e-12 * np.abs(wanted).max())
    assert made == [False, True]


def with_sums(rng, kkt: KKT, *, symmetric: bool) -> np.ndarray:
    """Add a low-rank part, some of whose sums are zero; return the whole matrix."""
    nodes, r = np.arange(8, 20), 7
    rows, columns = (
        each.ravel() for each in np.meshgrid(6 * nodes[:, None] + np.arange(3), range(r))
    )
    left = rng.normal(size=len(rows)) * (columns < r - 1)
    core = rng.normal(size=(r, r))
    core = core + core.T if symmetric else core
    scale = np.full(r, 3.0)
    kkt.low_rank = LowRank(rows, columns, left, left.copy(), core, scale)
    kkt.version += 1
    U = np.zeros((len(kkt.units), r))
    U[rows, columns] = left
    return sp.csr_matrix(kkt.csr).toarray() + U @ core @ U.T


@pytest.mark.parametrize(
    "method", [BY_SCHUR, fl.extend.Method("lu", "mumps"), fl.extend.Method("lu", "umfpack")]
)
@pytest.mark.parametrize("symmetric", [True, False])
def test_parts_of_low_rank_are_in_the_matrix(rng, method, symmetric):
    kkt, _ = matrix(rng)
    A = with_sums(rng, kkt, symmetric=symmetric)
    solver, found = solved(kkt, [method])
    wanted = np.linalg.solve(A, np.arange(1.0, len(A) + 1.0))
    assert solver._methods == (method,) and len(found) == len(A)
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
    x = rng.normal(size=len(A))
    np.testing.assert_allclose(kkt.whole.toarray(), A, atol=1e-13 * np.abs(A).max())
    for product in (kkt.times(x), solver.times(x)):
        np.testing.assert_allclose(product, A @ x, atol=1e-12 * np.abs(A @ x).max())
    if symmetric and method is BY_SCHUR:
        assert solver.negative_pivots() == inertia(sp.csr_matrix(A))[0]


def test_columns_that_follow_from_others_are_not_solved_for(rng):
    C = sp.random(50, 3, 0.4, random_state=1).tocsr()
    sums = sp.csr_matrix(rng.normal(size=(3, 9)) * 10.0 ** np.arange(-4, 5))
    whole = sp.hstack([C @ sums, sp.csr_matrix((50, 2))], format="csr")
    columns, T = schur._independent(whole)
    assert len(columns) == 3
    size = np.linalg.norm(whole.toarray(), axis=0)
    error = np.linalg.norm(whole[:, columns].toarray() @ T - whole.toarray(), axis=0)
    assert (error <= 1e-14 * size).all()


def block_on_a_mass(cells: int) -> fl.Scene:
    """A block, clamped below, with a rigid mass on an averaging attachment of its top."""
    scene = fl.Scene()
    mesh = fl.mesh.parametric_volume(lambda a, b, c: (a, b, 0.5 * c), (cells,) * 3)
    block = scene.add(fl.Solid(mesh, fl.sections.NeoHooke(1e6, 0.3, 1000.0)))
    for node in block.points("c=0"):
        scene.add(fl.Clamp(node))
    mass = scene.add(fl.RigidBody(1.0, (0.1,) * 3, position=(0.5, 0.5, 1.0)))
    scene.add(fl.joints.Fixed(block.point("c=1"), mass.point("centre"), at=(0.5, 0.5, 0.5)))
    scene.add(fl.PointLoad(mass.point("centre"), force=(2e4, 0.0, -4e4), moment=(0.0, 0.0, 3e3)))
    return scene


def test_a_solid_on_a_joint_is_solved_by_its_border(caplog):
    caplog.set_level("INFO")
    found = fl.statics(block_on_a_mass(8))
    assert "by cholmod (cholesky), mumps (cholesky), mumps (lu)" in caplog.text
    from petsc4py import PETSc

    PETSc.Options("test_by_mumps_")["pc_factor_mat_solver_type"] = "mumps"
    wanted = fl.statics(block_on_a_mass(8), petsc_options_prefix="test_by_mumps_")
    np.testing.assert_allclose(found.frames, wanted.frames, rtol=0, atol=1e-11)
    np.testing.assert_array_equal(found.negative_pivots, wanted.negative_pivots)
    assert found.factorisations == wanted.factorisations
    assert Solutions.FEW.value in caplog.text


def test_attachments_may_be_on_nodes_that_are_held(monkeypatch):
    def result():
        scene = block_on_a_mass(8)
        (block,) = (body for body in scene.bodies if isinstance(body, fl.Solid))
        mass = scene.add(fl.RigidBody(1.0, (0.1,) * 3, position=(0.5, 0.5, -1.0)))
        scene.add(fl.joints.Fixed(block.point("c=0"), mass.point("centre"), at=(0.5, 0.5, 0.0)))
        scene.add(fl.PointLoad(mass.point("centre"), force=(1e3, 0.0, 0.0)))
        return fl.statics(scene)

    found = result()
    monkeypatch.setattr(fl.extend.DirectSolver, "take_low_rank", lambda _: None)
    wanted = result()
    np.testing.assert_allclose(found.frames, wanted.frames, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.joint_forces, wanted.joint_forces, rtol=1e-10, atol=1e-6)


def test_a_force_on_an_averaging_attachment_is_a_traction():
    """The weights of its nodes are their areas; the matrix has no more entries."""
    mesh = fl.mesh.parametric_volume(lambda a, b, c: (a, b + 0.1 * a * b, 0.5 * c), (3, 3, 2))

    def entries_and_result(loaded):
        scene = fl.Scene()
        block = scene.add(fl.Solid(mesh, fl.sections.NeoHooke(1e6, 0.3, 1000.0)))
        for node in block.points("c=0"):
            scene.add(fl.Clamp(node))
        loaded(scene, block, np.array([2e4, -1e4, -6e4]))
        return fl.extend.Equations(scene, dynamics=False).matrix.csr[0].size, fl.statics(scene)

    def at_the_mean(scene, block, force):
        scene.add(fl.PointLoad(block.point("c=1"), force=force))

    def spread(scene, block, force):
        scene.add(fl.loads.FaceLoad(block, "c=1", force / 1.05))

    size, found = entries_and_result(at_the_mean)
    same, wanted = entries_and_result(spread)
    assert size == same
    np.testing.assert_allclose(found.frames, wanted.frames, rtol=0, atol=1e-11)
    np.testing.assert_array_equal(found.iterations, wanted.iterations)


def test_the_pattern_of_an_averaging_attachment_stays_sparse(monkeypatch):
    """In statics and dynamics; the low-rank part changes neither iterations nor results."""
    entries, filled = [], KKT.fill

    def counted(self, *args, **options):
        entries.append((len(self.csr[0]), self.low_rank is not None))
        filled(self, *args, **options)

    monkeypatch.setattr(KKT, "fill", counted)
    plan = {"duration": 0.01, "step": 1e-3, "progress": False}

    def results():
        entries.clear()
        found = (
            fl.statics(block_on_a_mass(8)),
            fl.GeneralisedAlpha().run(block_on_a_mass(8), **plan),
        )
        assert len(set(entries)) == 1
        return *found, *entries[0]

    state, motion, sparse, apart = results()
    monkeypatch.setattr(fl.extend.DirectSolver, "take_low_rank", lambda _: None)
    same, again, dense, within = results()
    assert apart and not within
    assert dense - sparse > 2 * (3 * 81) ** 2 / 3
    np.testing.assert_allclose(state.frames, same.frames, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(state.iterations, same.iterations)
    np.testing.assert_array_equal(state.negative_pivots, same.negative_pivots)
    np.testing.assert_allclose(motion.frames, again.frames, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(motion.iterations, again.iterations)
