"""Shell elements on small meshes, and a statics model that stands between them and the solvers."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

import basix.ufl
import dolfinx
import numpy as np
import scipy.sparse as sp
import ufl
from dolfinx import fem

import fem_lie as fl
from fem_lie.elements.shells import element as shell
from fem_lie.elements.shells.cells import ShellCells
from fem_lie.lie.motions import retract
from fem_lie.linear.packages import NEGATIVE


def section(E: float, nu: float, t: float) -> np.ndarray:
    """Stiffness of a homogeneous layer, shear factor 5/6."""
    C = E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    D = np.zeros((8, 8))
    D[:3, :3], D[3:6, 3:6] = C * t, C * t**3 / 12
    D[6:, 6:] = np.eye(2) * 5 / 6 * E / (2 + 2 * nu) * t
    return D


def grid(
    shape: tuple[int, int], position: Callable, cell: str = "quadrilateral", degree: int = 1
) -> dolfinx.mesh.Mesh:
    """Mesh of the unit square, put into space by ``position(a, b)``; two triangles per square."""
    n, m = degree * shape[0], degree * shape[1]
    a, b = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1), indexing="ij")
    number = np.arange(a.size).reshape(n + 1, m + 1)
    cells = []
    for i in range(0, n, degree):
        for j in range(0, m, degree):
            s = number[i : i + degree + 1, j : j + degree + 1]
            corners = s[0, 0], s[-1, 0], s[0, -1], s[-1, -1]
            if cell == "quadrilateral":
                middles = s[1, 0], s[0, 1], s[-1, 1], s[1, -1], s[1, 1]
                cells.append([*corners, *(middles if degree == 2 else ())])
            else:
                lower = s[-1, 1], s[1, 1], s[1, 0]
                upper = s[1, -1], s[0, 1], s[1, 1]
                for vertices, middles in (((0, 1, 3), lower), ((0, 3, 2), upper)):
                    chosen = [corners[k] for k in vertices]
                    cells.append([*chosen, *(middles if degree == 2 else ())])
    element = basix.ufl.element("Lagrange", cell, degree, shape=(3,))
    points = np.column_stack(position(a.ravel(), b.ravel()))
    return dolfinx.mesh.create_mesh(
        MPI.COMM_SELF, cells=np.array(cells, dtype=np.int64), x=points, e=element
    )


def with_normals(
    mesh: dolfinx.mesh.Mesh, normal: Callable, first: Callable, degree: int = 1
) -> fl.NodalFrames:
    """Frames with given third and first directors as functions of position."""
    q = fl.NodalFrames(mesh, degree)
    H = q.frames
    H[:, 3], H[:, 1] = normal(H[:, 0]), first(H[:, 0])
    H[:, 2] = np.cross(H[:, 3], H[:, 1])
    return q


@dataclass(frozen=True)
class Element:
    """A shell element under test."""

    name: str
    measures: fl.elements.StrainMeasures = fl.elements.MITC4
    formulation: str = "HR"
    drilling: float | None = None
    distortion: float = 1.0  # of the cells of a patch
    geometry: int = 1  # degree of the cells of a patch

    @property
    def cell(self) -> str:
        return self.measures.cell.name

    @property
    def degree(self) -> int:
        return self.measures.degree

    def cells(self, q: fl.NodalFrames) -> ShellCells:
        return ShellCells(q, self.measures, drilling_stiffness=self.drilling)

    def forms(self, cells: ShellCells, D: np.ndarray, law: Callable | None = None):
        count = len(cells.y.function_space.dofmap.list)

        def same(A: np.ndarray) -> fem.Function:
            return cells.cellwise(np.repeat(A[np.newaxis], count, 0))

        if self.formulation == "HR":
            return shell.hellinger_reissner(cells, same(np.linalg.inv(D)))
        law = shell.linear_law(same(D)) if law is None else law
        make = {"HW": shell.hu_washizu, "displacement": shell.displacement}[self.formulation]
        return make(cells, law)


HR = Element("HR")
HW = Element("HW", formulation="HW")
DISPLACEMENT = Element("MITC4", formulation="displacement")
PLUS = Element("HR, MITC4+", fl.elements.MITC4_PLUS)
PLUS_DISPLACEMENT = Element("MITC4+", fl.elements.MITC4_PLUS, "displacement")
BENT = Element("HR, decoupled bending", fl.elements.DECOUPLED)
SIX = Element("HR, six parameters", drilling=0.3)
SIX_DISPLACEMENT = Element("MITC4, six parameters", formulation="displacement", drilling=0.3)
TRIANGLE = Element("MITC3+", fl.elements.MITC3_PLUS)
TRIANGLE_6 = Element("MITC6", fl.elements.MITC6, "displacement")
# it passes the patch test for parallelograms only; its form takes minutes to compile, and with this
# geometry it is that of the bodies in other tests
QUADRILATERAL_9 = Element("MITC9", fl.elements.MITC9, "displacement", distortion=0.0, geometry=2)


@dataclass
class Statics(fl.stability.Equilibrium):
    """:class:`fem_lie.stability.Equilibrium` of one shell with dead point loads.

    ``held`` names unknowns (node, component) that are zero; ``springs`` are (node, axis, stiffness)
    that hold rigid motions without a force.
    """

    frames: fl.NodalFrames
    forms: fl.extend.LocalFrameForms
    held: np.ndarray
    loads: list[tuple[int, np.ndarray]]
    springs: list[tuple[int, np.ndarray, float]] = field(default_factory=list)
    moments: list[tuple[int, np.ndarray]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.unloaded = self.frames.frames.copy()
        self.diameter = float(np.linalg.norm(np.ptp(self.unloaded[:, 0], axis=0)))
        self.free = np.flatnonzero(~self.held.ravel())
        self.matrix = fem.create_matrix(self.forms.tangent)
        bs, blocks = self.matrix.block_size[0], len(self.matrix.indices)
        size = bs * len(self.unloaded)
        numbers = np.arange(1.0, blocks * bs * bs + 1).reshape(blocks, bs, bs)
        pattern = sp.bsr_matrix(
            (numbers, self.matrix.indices, self.matrix.indptr), shape=(size, size)
        ).tocsr()[self.free][:, self.free]
        pattern.sort_indices()
        self.take = (pattern.data - 0.5).astype(np.int64)
        self.rows = pattern.indptr, pattern.indices
        self.A = PETSc.Mat().createAIJ(pattern.shape, csr=(*self.rows, 0 * pattern.data))
        self.A.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self.ksp = PETSc.KSP().create()
        self.ksp.setType("preonly")
        self.ksp.getPC().setType("cholesky")
        self.ksp.getPC().setFactorSolverType("mumps")
        self.x, self.b = self.A.createVecs()

    def forces(self) -> tuple[np.ndarray, np.ndarray]:
        H, shape = self.frames.frames, self.held.shape
        r = fem.assemble_vector(self.forms.residual).array.reshape(shape).copy()
        f = np.zeros(shape)
        for i, force in self.loads:
            f[i, :3] += H[i, 1:] @ force
        for i, moment in self.moments:  # local components
            f[i, 3:] += moment
        for i, axis, k in self.springs:
            r[i, :3] += H[i, 1:] @ axis * k * ((H[i, 0] - self.unloaded[i, 0]) @ axis)
        return r.ravel()[self.free], f.ravel()[self.free]

    def factorise(self, factor: float) -> None:
        self.matrix.set_value(0.0)
        fem.assemble_matrix(self.matrix, self.forms.tangent)
        bs = self.matrix.block_size[0]
        blocks = self.matrix.data.reshape(-1, bs, bs)
        for i, axis, k in self.springs:
            a = self.frames.frames[i, 1:] @ axis
            start, end = self.matrix.indptr[i : i + 2]
            (at,) = np.flatnonzero(self.matrix.indices[start:end] == i)
            blocks[start + at, :3, :3] += k * np.outer(a, a)
        self.A.setValuesCSR(*self.rows, self.matrix.data[self.take])
        self.A.assemble()
        self.ksp.setOperators(self.A)
        self.ksp.setUp()

    def solve(self, b: np.ndarray) -> np.ndarray:
        self.b.array[:] = b
        self.ksp.solve(self.b, self.x)
        return self.x.array.copy()

    def _full(self, dx: np.ndarray) -> np.ndarray:
        h = np.zeros(self.held.size)
        h[self.free] = dx
        return h.reshape(self.held.shape)

    def move(self, dx: np.ndarray) -> None:
        h = self._full(dx)
        self.forms.increment.x.array[:] = h.ravel()
        self.forms.update_stress()
        retract(self.frames.frames, h)

    def positions(self) -> np.ndarray:
        return self.frames.frames[:, 0].copy()

    def translations(self, dx: np.ndarray) -> np.ndarray:
        return np.einsum("nij,ni->nj", self.frames.frames[:, 1:], self._full(dx)[:, :3])

    def twists(self, dx: np.ndarray) -> np.ndarray:
        full = self._full(dx)
        return np.hstack([full[:, :3], self.diameter * full[:, 3:]])

    def negative_pivots(self) -> int:
        return self.ksp.getPC().getFactorMatrix().getMumpsInfog(NEGATIVE)

    def check_rotations(self, factor: float) -> None:
        """Cells of these shells are fine enough for their turns."""

    def check_passage(self, before) -> None:
        """Nothing touches."""

    def rotation_hint(self) -> str:
        return ""

    def _carried(self) -> fem.Function:
        return self.forms.stress if self.forms.local is None else self.forms.local

    def state(self) -> Any:
        return self.frames.frames.copy(), self._carried().x.array.copy()

    def restore(self, state: Any) -> None:
        self.frames.frames[:], self._carried().x.array[:] = state

    def linear(self) -> np.ndarray:
        """Displacements (n, 3) of the linear problem."""
        self.factorise(1.0)
        internal, load = self.forces()
        return self.translations(self.solve(load - internal))


def hemisphere(element: Element, count: int, t: float, force: float) -> tuple[Statics, int, int]:
    """A quarter of the hemisphere with an 18° hole; the model and the nodes under the forces."""

    def position(a, b):
        azimuth, height = a * np.pi / 2, b * np.radians(72)
        return [
            10 * np.cos(height) * np.cos(azimuth),
            10 * np.cos(height) * np.sin(azimuth),
            10 * np.sin(height),
        ]

    def azimuthal(X):
        φ = np.arctan2(X[:, 1], X[:, 0])
        return np.column_stack([-np.sin(φ), np.cos(φ), 0 * φ])

    mesh = grid((count, count), position, element.cell, element.degree)
    q = with_normals(mesh, lambda X: X / 10, azimuthal, element.degree)
    q.frames[:, 3] /= np.linalg.norm(q.frames[:, 3], axis=1)[:, np.newaxis]
    forms = element.forms(element.cells(q), section(6.825e7, 0.3, t))
    X = q.frames[:, 0]
    held = np.zeros((len(X), 5 if element.drilling is None else 6), dtype=bool)
    # on both planes of symmetry e₁ is the normal
    on_planes = (abs(X[:, 0]) < 1e-9) | (abs(X[:, 1]) < 1e-9)
    for component in (0, 4, 5)[: held.shape[1] - 3]:
        held[on_planes, component] = True
    a, b = (np.linalg.norm(X - point, axis=1).argmin() for point in ([10, 0, 0], [0, 10, 0]))
    loads = [(a, np.array([force / 2, 0, 0])), (b, np.array([0, -force / 2, 0]))]
    spring = (a, np.array([0, 0, 1.0]), 1e-3 * force)
    return Statics(q, forms, held, loads, [spring]), a, b


def strip(
    element: Element, cells: tuple[int, int], t: float, radius: float, distortion: float = 0.0
) -> Statics:
    """Quarter circle of width 1 in the xz plane, E = 1e6, ν = 0, clamped at one end.

    A unit force towards the centre is spread over the other end, by the trapezoidal rule.
    """
    n = element.degree * cells[1]

    def position(a, b):
        skew = distortion / cells[0] * np.sin(np.pi * a) * (2 * b - 1)
        φ = (a + skew) * np.pi / 2
        return [radius * np.sin(φ), b, radius * np.cos(φ)]

    def normal(X):
        r = np.column_stack([X[:, 0], 0 * X[:, 1], X[:, 2]])
        return r / np.linalg.norm(r, axis=1)[:, np.newaxis]

    def along(X):
        return np.cross([0.0, 1.0, 0.0], normal(X))

    mesh = grid(cells, position, element.cell, element.degree)
    q = with_normals(mesh, normal, along, element.degree)
    X = q.frames[:, 0]
    held = np.zeros((len(X), 5 if element.drilling is None else 6), dtype=bool)
    held[abs(X[:, 0]) < 1e-9] = True
    (end,) = np.nonzero(abs(X[:, 2]) < 1e-9)
    weights = np.where((X[end, 1] < 1e-9) | (X[end, 1] > 1 - 1e-9), 0.5, 1.0) / n
    loads = [(i, np.array([-w, 0, 0])) for i, w in zip(end, weights, strict=True)]
    return Statics(q, element.forms(element.cells(q), section(1e6, 0.0, t)), held, loads)


@cache
def patch(element: Element, flat: bool = False, law: Callable | None = None):
    """2×2 distorted cells, in a plane or not: frames, forms."""

    def position(a, b):
        bump = element.distortion * np.sin(np.pi * a) * np.sin(np.pi * b)
        x, y = a + 0.18 * bump + 0.1 * b, b - 0.13 * bump + 0.2 * a
        return [x, y, 0 * a if flat else 0.3 * np.sin(1.5 * x) + 0.2 * x * y]

    mesh = grid((2, 2), position, element.cell, element.geometry)
    q = fl.NodalFrames(mesh, element.degree)
    if not flat:
        rng = np.random.default_rng(4)
        x, y, _ = q.frames[:, 0].T
        n = np.column_stack([-0.45 * np.cos(1.5 * x) - 0.2 * y, -0.2 * x, 1 + 0 * x])
        n /= np.linalg.norm(n, axis=1)[:, np.newaxis]
        first = np.cross(rng.normal(size=n.shape), n)  # frames may drill from node to node
        q.frames[:, 3], q.frames[:, 1] = n, first / np.linalg.norm(first, axis=1)[:, np.newaxis]
        q.frames[:, 2] = np.cross(n, q.frames[:, 1])
    D = section(100.0, 0.3, 0.1)
    if not flat:  # a general 8×8 section; its axes differ from cell to cell
        scale = np.sqrt(np.diag(D))
        D += 0.02 * np.cos(np.add.outer(np.arange(8), np.arange(8))) * np.outer(scale, scale)
    return q, element.forms(element.cells(q), D, law), D


def quartic(e):
    """A law that is no quadratic form."""
    return 40 * ufl.inner(e, e) + 300 * (e[0] ** 2 + e[3] ** 2 + e[7] ** 2) ** 2 + 10 * e[0] * e[1]
