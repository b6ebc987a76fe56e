"""Subdomains: their matrices sum up to that of the scene, and what cannot be divided is refused."""

from petsc4py import PETSc

import numpy as np
import parallel_domains
import pytest
import scipy.sparse as sp
from ranks import on_ranks

import fem_lie as fl
from fem_lie.system.equations import Equations, Instant, Plan

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
BAR = fl.Section.rectangle(0.02, 0.03, STEEL)


def joined_beams():
    """Two beams and a spring, swinging."""
    upper = fl.Beam.straight((0, 0, 0), (1, 0, 0), BAR, cells=6)
    lower = fl.Beam.straight((1, 0, 0), (2, 0, 0), BAR, cells=6)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(upper)
    scene.add(lower)
    scene.add(fl.Revolute(fl.ground(), upper.start, axis=(0, 1, 0)))
    scene.add(fl.Revolute(upper.end, lower.start, axis=(0, 1, 0)))
    return scene


def sheet():
    """A curved strip."""
    mesh = fl.surface(lambda a, b: (a, 0.4 * b, 0.1 * a * a), (6, 4))
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.01, STEEL))
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.PointLoad(shell["11"], force=(0.0, 300.0, 2e3)))
    return scene


def whole(equations):
    values, columns, pointers = equations.matrix.csr
    return sp.csr_matrix((values.copy(), columns, pointers)).toarray()


def parts(equations, state, plan, count):
    """The sum of the matrices of all domains, and how many have each unknown."""
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
    equations = Equations(make(), dynamics=dynamics)
    unknowns, rng = equations.unknowns, np.random.default_rng(3)
    H = equations.start.frames.copy()
    n = unknowns.moving
    H[:n, 0] += 1e-3 * rng.standard_normal((n, 3))
    v, a = (rng.standard_normal((n, 6)) for _ in range(2))
    d = 1e-2 * rng.standard_normal((n, 6))
    if not dynamics:
        v[:] = a[:] = d[:] = 0.0
    state = Instant(H, v, a, rng.standard_normal(unknowns.m))
    mass, damping = (1e6, 1e3) if dynamics else (0.0, 0.0)
    plan = Plan(d, np.ones(unknowns.m), mass, damping)
    equations.residual(state, plan.scale, np.zeros(unknowns.size))
    total, have = parts(equations, state, plan, count)
    K = whole(equations)
    free = ~equations.matrix.unit_rows
    assert (have[free] >= 1).all() and (have[free] > 1).any()
    assert (have[6 * n :] == 1).all()
    off = np.abs((total - K)[np.ix_(free, free)]).max()
    assert off <= 1e-12 * np.abs(K[np.ix_(free, free)]).max()


def test_refuses_a_matrix_without_those_of_its_domains():
    equations = Equations(joined_beams(), dynamics=True)
    saved, tangent = equations.memory.saved(matrix=True), equations.system.tangent
    tangent.divide(tangent.division(2), 0)
    with pytest.raises(ValueError, match="goes on without subdomains"):
        equations.memory.restore(saved)


def test_refuses_more_domains_than_parts_between_joints():
    equations = Equations(joined_beams(), dynamics=True)
    with pytest.raises(ValueError, match="subdomains need 40 parts between which there are no"):
        equations.system.tangent.division(40)


@pytest.fixture(scope="module")
def alone():
    found, told = parallel_domains.results()
    assert told == (None, None)
    return found


@pytest.mark.parametrize("way", ["bddc", "fetidp"])
def test_two_subdomains_find_what_one_rank_finds(alone, tmp_path, way):
    out = tmp_path / "found.npz"
    on_ranks(parallel_domains, 2, out, way)
    with np.load(out) as found:
        for name, wanted in alone.items():
            size = np.abs(wanted).max()
            np.testing.assert_allclose(found[name], wanted, rtol=0, atol=1e-7 * size, err_msg=name)
        for count, interface, made, solutions, iterations in found["told"]:
            assert count == 2
            assert interface > 0
            assert solutions >= made > 0
            assert iterations <= 10 * solutions


@pytest.mark.parametrize(
    ("given", "message"),
    [("gamg", "wanted bddc or fetidp, got 'gamg'"), ("bddc", "several ranks are wanted, got one")],
)
def test_refuses_other_names_and_one_rank(given, message):
    PETSc.Options("test_domains_")["domains"] = given
    with pytest.raises(ValueError, match=message):
        fl.GeneralisedAlpha(petsc_options_prefix="test_domains_").run(
            joined_beams(), duration=2e-3, step=1e-3
        )
