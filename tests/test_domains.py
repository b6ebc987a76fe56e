"""Subdomains: their matrices sum up to that of the scene, and refusals."""

from petsc4py import PETSc

import divided_scenes
import numpy as np
import parallel_domains
import pytest
import scipy.sparse as sp
from ranks import on_ranks

import fem_lie as fl
from fem_lie.linear.domains.division import Links, divided
from fem_lie.linear.domains.interface import Interface
from fem_lie.linear.packages import ByMinimumDegree
from fem_lie.parts.part_scene import connections_of, part_of

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
BAR = fl.Section.rectangle(0.02, 0.03, STEEL)


def joined_beams():
    """Two swinging beams with a spring between nodes that are in no common cell."""
    upper = fl.Beam.straight((0, 0, 0), (1, 0, 0), BAR, cells=6)
    lower = fl.Beam.straight((1, 0, 0), (2, 0, 0), BAR, cells=6)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(upper)
    scene.add(lower)
    scene.add(fl.joints.Revolute(fl.ground(), upper.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Revolute(upper.point("end"), lower.point("start"), axis=(0, 1, 0)))
    scene.add(
        fl.joints.Spring(fl.joints.Distance(upper.point(3), lower.point(3)).length, stiffness=1e6)
    )
    return scene


def sheet():
    """A curved strip."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.4 * b, 0.1 * a * a), (6, 4))
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.01, STEEL))
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.PointLoad(shell.point("11"), force=(0.0, 300.0, 2e3)))
    return scene


def whole(equations):
    values, columns, pointers = equations.matrix.csr
    return sp.csr_matrix((values.copy(), columns, pointers)).toarray()


def parts(equations, state, plan, count):
    """Sum of the matrices of all subdomains, and number of subdomains of each unknown."""
    size = equations.unknowns.size
    total, have = np.zeros((size, size)), np.zeros(size)
    division = equations.system.tangent.division(count)
    for rank in range(count):
        equations.system.tangent.divide(division, rank)
        equations.fill(state, equations.residual(state, plan.scale, np.zeros(size)), plan)
        part, (_, columns, pointers) = equations.matrix.part, equations.matrix.csr
        own = np.concatenate([part.inside, part.interface])
        K = sp.csr_matrix((part.values, columns, pointers)).toarray()
        total[np.ix_(own, own)] += K[np.ix_(own, own)]
        have[own] += 1
    return total, have


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("make", [joined_beams, sheet])
@pytest.mark.parametrize("dynamics", [False, True])
def test_parts_sum_up_to_the_matrix(make, count, dynamics):
    equations = fl.extend.Equations(make(), dynamics=dynamics)
    unknowns, rng = equations.unknowns, np.random.default_rng(3)
    H = equations.start.frames.copy()
    n = unknowns.moving
    H[:n, 0] += 1e-3 * rng.standard_normal((n, 3))
    v, a = (rng.standard_normal((n, 6)) for _ in range(2))
    d = 1e-2 * rng.standard_normal((n, 6))
    if not dynamics:
        v[:] = a[:] = d[:] = 0.0
    state = fl.extend.TimeState(H, v, a, rng.standard_normal(unknowns.m))
    mass, damping = (1e6, 1e3) if dynamics else (0.0, 0.0)
    plan = fl.extend.Plan(d, np.ones(unknowns.m), mass, damping)
    equations.residual(state, plan.scale, np.zeros(unknowns.size))
    total, have = parts(equations, state, plan, count)
    K = whole(equations)
    free = ~equations.matrix.unit_rows
    assert (have[free] >= 1).all() and (have[free] > 1).any()
    assert (have[6 * n :] == 1).all()
    off = np.abs((total - K)[np.ix_(free, free)]).max()
    assert off <= 1e-12 * np.abs(K[np.ix_(free, free)]).max()


@pytest.mark.parametrize("make", [joined_beams, sheet])
def test_what_several_domains_have_is_their_interface(make):
    equations = fl.extend.Equations(make(), dynamics=True)
    tangent, free = equations.system.tangent, ~equations.matrix.unit_rows
    division, have, mine = tangent.division(3), np.zeros(equations.unknowns.size), []
    for rank in range(3):
        tangent.divide(division, rank)
        mine.append(equations.matrix.part)
        have[np.concatenate([mine[-1].inside, mine[-1].interface])] += 1
    for part in mine:
        assert (have[part.inside] == 1).all()
        assert (have[part.interface] > 1).all()
        np.testing.assert_array_equal(part.interfaces[part.at], part.interface)
        np.testing.assert_array_equal(part.interfaces, np.flatnonzero((have > 1) & free))


@pytest.mark.parametrize("inertial", [False, True])
@pytest.mark.parametrize("make", [joined_beams, sheet])
def test_motions_of_the_interface_are_rigid(make, inertial):
    """Motions of frames under a small rigid motion, along both types of axes."""
    equations = fl.extend.Equations(make(), dynamics=True)
    tangent, n = equations.system.tangent, equations.unknowns.moving
    H = fl.lie.se3_compose(
        fl.lie.se3_exp(np.array([1.0, -2.0, 0.5, 0.4, 0.3, -0.8])), np.array(equations.start.frames)
    )
    tangent.divide(tangent.division(2), 1)
    tangent.domain.see(H, equations.unknowns.kinds, inertial=inertial)
    found, interfaces = tangent.domain.part.motions, tangent.domain.part.interfaces
    assert len(found) == 6 and len(interfaces) > 0
    for small, motion in zip(1e-7 * np.eye(6), found, strict=True):
        ahead, behind = (fl.lie.se3_compose(fl.lie.se3_exp(s * small), H[:n]) for s in (1, -1))
        moved = fl.lie.se3_log(fl.lie.se3_compose(fl.lie.se3_inverse(behind), ahead)) / 2e-7
        if inertial:
            moved = np.einsum("nki,nhk->nhi", H[:n, 1:], moved.reshape(n, 2, 3)).reshape(n, 6)
        np.testing.assert_allclose(motion, moved.ravel()[interfaces], atol=1e-8)


def quarters(long, wide):
    """Cells of a grid, and columns of its nodes."""
    column, row = np.divmod(np.arange(long * wide), wide)
    first = column * (wide + 1) + row
    cells = np.stack([first, first + 1, first + wide + 1, first + wide + 2], axis=1)
    return cells, np.repeat(np.arange(long + 1), wide + 1)


def links(rows):
    return Links(np.repeat(np.arange(len(rows)), rows.shape[1]), rows.ravel(), len(rows))


NONE = links(np.empty((0, 2), dtype=np.int64))


@pytest.mark.parametrize("rich", [6, 36])
def test_domains_have_as_many_unknowns_and_meet_in_few(rich):
    """A strip with more unknowns at one end is cut transversely."""
    cells, column = quarters(48, 4)
    free = np.where(column < 12, rich, 6)
    found = divided(links(cells), NONE, NONE, free, 3)
    sharing = found.nodes.sum(axis=1)
    unknowns = (free / sharing) @ found.nodes
    assert np.abs(unknowns / unknowns.mean() - 1).max() < 0.12
    assert found.shared.sum() <= 2 * 5 + 2
    for rank in range(3):
        own = np.isin(np.arange(len(free)), cells[found.cells == rank])
        np.testing.assert_array_equal(own, found.nodes[:, rank])


def test_what_is_joined_is_of_one_domain():
    """Nodes of a joint, and of a pair that is in no cell, at both ends of a strip."""
    cells, column = quarters(24, 2)
    ends = np.array([[0, len(column) - 1]])
    for joints, others in ((links(ends), NONE), (NONE, links(ends))):
        found = divided(links(cells), joints, others, np.full(len(column), 6), 2)
        at = found.cells[np.isin(cells, ends).any(axis=1)]
        assert len(np.unique(at)) == 1 and len(np.unique(found.cells)) == 2
        assert (found.constraints == at[0]).all()


def test_refuses_a_matrix_without_those_of_its_domains():
    equations = fl.extend.Equations(joined_beams(), dynamics=True)
    history, tangent = equations.history_variables.with_matrix, equations.system.tangent
    saved = history.saved_state()
    tangent.divide(tangent.division(2), 0)
    with pytest.raises(ValueError, match="restarts without subdomains"):
        history.restore(saved)


def test_refuses_more_domains_than_parts_between_joints():
    equations = fl.extend.Equations(joined_beams(), dynamics=True)
    with pytest.raises(ValueError, match="subdomains need 40 parts between which there are no"):
        equations.system.tangent.division(40)


@pytest.fixture(scope="module")
def alone():
    found, statistics = parallel_domains.results()
    assert statistics == (None, None)
    return found


@pytest.mark.parametrize("way", ["bddc", "fetidp"])
def test_two_subdomains_find_what_one_rank_finds(alone, tmp_path, way):
    out = tmp_path / "found.npz"
    on_ranks(parallel_domains, 2, out, way)
    with np.load(out) as found:
        for name, wanted in alone.items():
            size = np.abs(wanted).max()
            np.testing.assert_allclose(found[name], wanted, rtol=0, atol=1e-7 * size, err_msg=name)
        for count, interface, made, solutions, iterations in found["statistics"]:
            assert count == 2
            assert interface > 0
            assert solutions >= made > 0
            assert iterations <= 10 * solutions
        assert found["statistics"][0][3] == found["asked"]  # of statics, none is refined


@pytest.mark.parametrize(
    ("given", "message"),
    [("gamg", "expected bddc or fetidp, got 'gamg'"), ("bddc", "expected several ranks, got one")],
)
def test_refuses_other_names_and_one_rank(given, message):
    PETSc.Options("test_domains_")["domains"] = given
    with pytest.raises(ValueError, match=message):
        fl.GeneralisedAlpha(petsc_options_prefix="test_domains_").run(
            joined_beams(), duration=2e-3, step=1e-3
        )


@pytest.mark.parametrize("given", [0.0, -1e-3, 2.0])
def test_the_least_diagonal_is_a_part_of_the_largest(given):
    options = PETSc.Options("given_interface_")
    options["softest"] = given
    with pytest.raises(ValueError, match=r"given_interface_softest must be in \(0, 1\], got"):
        Interface(None, None, "given_", "bddc")
    options.delValue("softest")


# --- scenes divided among ranks ---

PARTS = 3


class Ranks:
    """Communicator of ranks that are asked one after the other."""

    def __init__(self, rank, given):
        self.rank, self.size, self._given = rank, PARTS, given

    def bcast(self, value):
        if self.rank == 0:
            self._given.append(value)
        return self._given[-1]


def parts_of(scene):
    given = []
    return [part_of(scene, Ranks(rank, given)) for rank in range(PARTS)]


@pytest.mark.parametrize("build", divided_scenes.MOTIONS.values(), ids=divided_scenes.MOTIONS)
def test_parts_have_all_nodes_and_no_rank_has_all(build):
    scene, _ = build()
    found = parts_of(scene)
    own = [np.unique(np.concatenate(list(part.nodes.values()))) for part in found]
    count = sum(len(body.frames) for body in scene.bodies)
    assert sorted(set(np.concatenate(own))) == list(range(count))
    assert max(map(len, own)) < count
    for rank, part in enumerate(found):
        for other, shared in part.sharers.items():
            np.testing.assert_array_equal(shared, found[other].sharers[rank])
            assert np.isin(shared, own[rank]).all() and np.isin(shared, own[other]).all()


@pytest.mark.parametrize("build", divided_scenes.MOTIONS.values(), ids=divided_scenes.MOTIONS)
def test_each_connection_and_each_point_load_is_in_one_part(build):
    scene, _ = build()
    found = parts_of(scene)
    numbers = np.concatenate([part.connections for part in found])
    assert sorted(numbers) == list(range(len(connections_of(scene))))
    at_points = [
        sum(isinstance(load, fl.PointLoad) for load in one.loads)
        for one in (scene, *(part.scene for part in found))
    ]
    assert at_points[0] == sum(at_points[1:])


def test_an_ordering_of_mumps_is_an_option_while_it_factorises_unless_given():
    method, options = ByMinimumDegree("cholesky", "mumps"), PETSc.Options("test_ordering_")
    with method.options("test_ordering_"):
        assert options.getInt("mat_mumps_icntl_7") == 6
    assert "mat_mumps_icntl_7" not in options
    options["mat_mumps_icntl_7"] = 2
    try:
        with method.options("test_ordering_"):
            assert options.getInt("mat_mumps_icntl_7") == 2
        assert "mat_mumps_icntl_7" in options
    finally:
        options.delValue("mat_mumps_icntl_7")
