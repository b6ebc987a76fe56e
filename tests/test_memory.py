"""Memory of equilibria. A factorisation without enough does not say that a matrix is singular."""

import subprocess
import sys
import tracemalloc
from pathlib import Path

from petsc4py import PETSc

import numpy as np
import pytest
import scipy.sparse as sp

import fem_lie as fl
from demos.hemisphere import pinched, quarter
from fem_lie.linear.pivots import inertia
from fem_lie.solve.statics.follow import SceneEquilibrium

ROOT = Path(__file__).parents[1]

LITTLE = """
import resource
from demos.hemisphere import pinched, quarter
import fem_lie as fl
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.packages import Method
from fem_lie.solve.statics.follow import SceneEquilibrium

def solver(cells):
    shell = pinched(0.04, quarter(cells), fl.elements.HellingerReissner())
    matrix = SceneEquilibrium(shell, "test_").equations.system.kkt
    return DirectSolver(matrix, "test_little_", [Method("{kind}", "{package}")])

def free():
    # what is free within the process, in pieces of 64 kB or more
    pieces, size = [], 2**20
    while size >= 2**16:
        try:
            pieces.append(bytearray(size))
        except MemoryError:
            size //= 2
    return pieces

solver(4).factorise()  # with all code that it needs
large = solver(32)
with open("/proc/self/status") as status:
    kilobytes = next(int(line.split()[1]) for line in status if line.startswith("VmSize"))
limit = 1024 * kilobytes + {room}
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
pieces = free() if {room} < 2**30 else []
del pieces[: {room} // 2**20]
try:
    large.factorise()
except MemoryError as error:
    print("lacks memory:", error)
else:
    print("enough")
"""


# the ordering of MUMPS, which is asked after KLU too, may end the process itself
@pytest.mark.parametrize(
    ("kind", "package", "room", "said"),
    [
        ("lu", "umfpack", 4_000_000, "lacks memory: "),
        ("cholesky", "cholmod", 4_000_000, "lacks memory: "),
        *(("lu", package, 2**32, "enough") for package in ("umfpack", "klu", "mumps")),
        ("cholesky", "cholmod", 2**32, "enough"),
    ],
)
def test_a_package_that_gets_no_memory_says_so(kind, package, room, said):
    script = LITTLE.format(kind=kind, package=package, room=room)
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert said in done.stdout, done.stdout + done.stderr


@pytest.fixture
def little_for_mumps():
    """Options of PETSc by which MUMPS may use one megabyte."""
    names = [
        "mat_mumps_icntl_23",
        "test_memory_mat_mumps_icntl_23",
        "test_memory_st_mat_mumps_icntl_23",
    ]
    options = PETSc.Options()
    for name in names:
        options[name] = 1
    yield
    for name in names:
        del options[name]


def solver(cells, method):
    model = SceneEquilibrium(
        pinched(0.04, quarter(cells), fl.elements.HellingerReissner()), "test_"
    )
    return fl.extend.DirectSolver(model.equations.system.kkt, "test_memory_", [method])


@pytest.mark.parametrize("kind", ["lu", "cholesky"])
def test_a_limit_of_mumps_is_no_singular_matrix(little_for_mumps, kind):
    with pytest.raises(MemoryError, match=r"the matrix of \d+ unknowns by mumps"):
        solver(24, fl.extend.Method(kind, "mumps")).factorise()


def laplacian(n):
    """Of a cube of n³ points; its factors take some megabytes."""
    A, one = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(n, n)), sp.eye(n)
    plane = sp.kron(A, one) + sp.kron(one, A)
    return sp.csr_matrix(sp.kron(plane, one) + sp.kron(sp.kron(one, one), A))


def test_pivots_are_not_counted_without_memory(little_for_mumps):
    with pytest.raises(MemoryError, match="the matrix of 8000 unknowns"):
        inertia(laplacian(20))


def test_eigenvalues_without_memory_say_so(little_for_mumps):
    from slepc4py import SLEPc

    from fem_lie.linear.spectra.free_unknowns import ON_ONE_RANK
    from fem_lie.linear.spectra.pencil import set_up

    eigen = SLEPc.EPS().create(PETSc.COMM_SELF)
    matrix = ON_ONE_RANK.matrix(laplacian(20), 8000)
    eigen.setOperators(matrix.matrix)
    eigen.setTarget(0.0)
    with pytest.raises(MemoryError, match="the matrix of 8000 unknowns"):
        set_up(eigen, 2, SLEPc.EPS, "test_memory_", ON_ONE_RANK)


def test_a_singular_matrix_is_still_called_so():
    made = solver(4, fl.extend.Method("lu", "klu"))
    made._kkt.csr[0][:] = 0.0
    made._kkt.matrix.assemble()
    with pytest.raises((fl.extend.SingularMatrixError, FloatingPointError, ValueError)):
        made.factorise()
        made.right_hand_side[:] = np.ones(len(made.solution))
        made.solve()


def most_memory(cells):
    """Most memory of arrays in an equilibrium of a pinched hemisphere, and its nodes."""
    scene = pinched(0.04, quarter(cells), fl.elements.HellingerReissner())
    tracemalloc.start()
    try:
        fl.statics(scene)
        return tracemalloc.get_traced_memory()[1], len(scene.bodies[0].frames)
    finally:
        tracemalloc.stop()


def test_arrays_of_statics_take_less_than_16_kilobytes_a_node():
    """Blocks of the stiffness that stay, a mass matrix or three copies of the cells' data miss it.

    Factors, and what DOLFINx has, are not arrays of numpy.
    """
    small, large = most_memory(16), most_memory(48)
    assert (large[0] - small[0]) / (large[1] - small[1]) < 16e3
