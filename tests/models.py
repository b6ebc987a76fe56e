"""The elements that test_kernel.py and test_elements.py put through the same laws.

To test another element or energy, write a function ``name(comm) -> Model`` and add it to a list.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property

from mpi4py import MPI

import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from hypothesis import Phase, settings

import fem_lie as fl
from fem_lie import _compat, lie
from fem_lie._form_cache import compile_expression
from fem_lie.elements.beams.directors import midpoint_strains
from fem_lie.elements.beams.element import with_bending_flexibility
from fem_lie.elements.beams.geodesic import GEODESIC, geodesic_energy
from fem_lie.elements.rods.kirchhoff import rod_energy

few = settings(
    max_examples=8,
    deadline=None,
    # a smaller seed is no simpler: do not look for one when a test fails
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
)
"""For laws that hold at random configurations; hypothesis prints the seed of a failure."""

# a full section stiffness: every strain is coupled to every other
D = np.diag([90.0, 40, 30, 8, 6, 7]) + 1.5 * np.cos(np.add.outer(np.arange(6), np.arange(6)))
STRAIN_0 = np.array([1.0, 0.02, -0.03, 0.1, 0.2, -0.15])


@dataclass
class Model:
    """An element on a small mesh, with its unloaded frames."""

    frames: fl.NodalFrames
    forms: fl.extend.LocalFrameForms
    energy: fl.extend.StrainEnergy | ufl.Form
    coordinates: fem.Function | None = None
    unloaded: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        self.unloaded = self.frames.frames.copy()

    def at(self, H: np.ndarray) -> "Model":
        self.frames.frames[:] = H
        return self

    def settle(self) -> None:
        """Make the linearised stress, or the local fields, stationary at the present frames."""
        self.forms.increment.x.array[:] = 0.0
        for _ in range(1 if self.forms.local is None else 12):
            self.forms.update_stress()

    def energy_value(self) -> float:
        return fem.assemble_scalar(self.forms.energy)

    @cached_property
    def stress(self) -> fem.Expression:
        """σ(ε) at the points of the linearised stress, which DOLFINx evaluates."""
        energy, mesh = self.energy, self.frames.function.function_space.mesh
        strain = ufl.variable(energy.strain)
        degree = energy.dx.metadata()["quadrature_degree"]
        points = basix.make_quadrature(mesh.basix_cell(), degree)[0]
        return compile_expression(ufl.diff(energy.law(strain), strain), points)

    def residual(self) -> np.ndarray:
        return fem.assemble_vector(self.forms.residual).array.copy()

    def tangent(self) -> np.ndarray:
        return fem.assemble_matrix(self.forms.tangent).to_dense()

    def random(self, seed: int, size: float = 0.4) -> np.ndarray:
        """Large random displacements of every node, then a rotation of all by up to π."""
        rng = np.random.default_rng(seed)
        H = lie.se3_retract(self.unloaded, size * rng.normal(size=(len(self.unloaded), 6)))
        return superpose(H, rng.normal(size=3), rng.normal(size=3))


def superpose(H: np.ndarray, rotation: np.ndarray, translation: np.ndarray) -> np.ndarray:
    """Rigid motion after ``H``."""
    out = H @ lie.so3_exp(rotation).T
    out[:, 0] += translation
    return out


def make_mesh(comm, cell: str, degree: int, points, cells) -> dolfinx.mesh.Mesh:
    """Mesh in space, given on rank 0; with ghost cells, which DOLFINx does not make by default."""
    element = basix.ufl.element("Lagrange", cell, degree, shape=(3,))
    points, cells = np.array(points, dtype=np.float64), np.array(cells, dtype=np.int64)
    if comm.rank > 0:
        points, cells = points[:0], cells[:0]
    ghosts = _compat.ghost_options()
    return dolfinx.mesh.create_mesh(comm, cells=cells, x=points, e=element, **ghosts)


def line(comm, degree: int, count: int = 4) -> dolfinx.mesh.Mesh:
    """Unequal cells along a curve; of degree 2 with midpoints off the middle."""
    s = np.linspace(0, 1, count + 1) ** 1.2 * 3
    if degree == 2:
        s = np.concatenate([s, 0.45 * s[:-1] + 0.55 * s[1:]])
    points = np.column_stack([s, 0.1 * s**2, 0.2 * np.sin(s)])
    cells = [[i, i + 1, count + 1 + i][: degree + 1] for i in range(count)]
    return make_mesh(comm, "interval", degree, points, cells)


def straight(comm, length: float, count: int) -> dolfinx.mesh.Mesh:
    points = np.outer(np.linspace(0, length, count + 1), [1, 0, 0])
    return make_mesh(comm, "interval", 1, points, [[i, i + 1] for i in range(count)])


def surface(comm, cell: str, count: int = 4) -> dolfinx.mesh.Mesh:
    """``count`` × 1 distorted squares out of plane, or twice as many triangles."""
    n = count + 1
    x, y = np.meshgrid(np.arange(n), [0.0, 1.0])
    x, y = (x + 0.15 * y * x).ravel(), (y - 0.1 * x).ravel()
    points = np.column_stack([x, y, 0.2 * np.sin(x + 2 * y)])
    squares = [[i, i + 1, n + i, n + i + 1] for i in range(count)]
    if cell == "triangle":
        cells = [c for a, b, d, e in squares for c in ([a, b, e], [a, e, d])]
    else:
        cells = squares
    return make_mesh(comm, cell, 1, points, cells)


def measure(mesh, degree: int) -> ufl.Measure:
    return ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": degree})


def linear_law(strain):
    return 0.5 * ufl.inner(strain, ufl.as_matrix(D.tolist()) * strain)


def nonlinear_law(strain):
    return linear_law(strain) + 5.0 * strain[4] ** 4 + 2.0 * strain[0] ** 2 * strain[5] ** 2


def director_energy(
    q: fl.NodalFrames, law: Callable = nonlinear_law, degree: int = 1
) -> fl.extend.StrainEnergy:
    stretch, curvature = fl.elements.director_strains(q)
    strain = ufl.as_vector([*stretch, *curvature]) - ufl.as_vector(STRAIN_0.tolist())
    return fl.extend.StrainEnergy(strain, law, measure(q.function.function_space.mesh, degree))


def _director_beam(comm, degree: int, carried: bool) -> Model:
    q = fl.NodalFrames(line(comm, degree), degree)
    # one or two points: the degree to which 1 and 2 Gauss points are exact
    energy = director_energy(q, degree=2 * degree - 1)
    given = energy if carried else energy.form()
    return Model(q, fl.local_frame_forms(given, q), given)


def director_beam_1(comm=MPI.COMM_SELF) -> Model:
    return _director_beam(comm, 1, False)


def director_beam_2(comm=MPI.COMM_SELF) -> Model:
    return _director_beam(comm, 2, False)


def director_beam_1_carried(comm=MPI.COMM_SELF) -> Model:
    return _director_beam(comm, 1, True)


def director_beam_2_carried(comm=MPI.COMM_SELF) -> Model:
    return _director_beam(comm, 2, True)


def director_beam_midpoint(comm=MPI.COMM_SELF) -> Model:
    """Strains of the middle, by the chain rule."""
    q = fl.NodalFrames(line(comm, 1))
    stretch, curvature, through = midpoint_strains(q)
    strain = ufl.as_vector([*stretch, *curvature]) - ufl.as_vector(STRAIN_0.tolist())
    dx = measure(q.function.function_space.mesh, 1)
    energy = fl.extend.StrainEnergy(strain, nonlinear_law, dx, through=through)
    return Model(q, fl.local_frame_forms(energy, q), energy)


def cellwise(mesh, values: np.ndarray) -> fem.Function:
    element = basix.ufl.element("DG", mesh.basix_cell(), 0, shape=values.shape[1:])
    f = fem.Function(fem.functionspace(mesh, element))
    f.x.array[:] = values.ravel()
    return f


def _geodesic_beam(mesh, stiffness=None, law=None, rest: bool = True) -> Model:
    """Section stiffness from the lengths; law or quadratic energy; curved at rest, or straight."""
    q = fl.NodalFrames(mesh)
    if rest:
        x = q.frames[:, 0]
        q.update(np.column_stack([0 * x, 0.3 * np.sin(x + 1)]))
    ends = q.frames[q.function.function_space.dofmap.list]
    relative = lie.se3_relative(ends[:, 0], ends[:, 1])
    length = np.linalg.norm(relative[:, :3], axis=1)
    d, d0, ell = (cellwise(mesh, a) for a in (relative, relative, length))
    section = np.repeat(D[np.newaxis], len(length), axis=0)
    if stiffness is not None:
        section = stiffness(section, relative)
    energy = geodesic_energy(d, d0, ell, cellwise(mesh, section), mesh)
    if law is not None:
        energy = fl.extend.StrainEnergy(energy.strain, law, energy.dx, energy.weight)
    forms = fl.extend.LocalFrameForms(energy, q.function, q.increment, GEODESIC, coordinates=d)
    return Model(q, forms, energy, d)


def geodesic_beam(comm=MPI.COMM_SELF) -> Model:
    return _geodesic_beam(line(comm, 1))


def geodesic_beam_flexible(comm=MPI.COMM_SELF) -> Model:
    return _geodesic_beam(line(comm, 1), with_bending_flexibility)


def geodesic_beam_nonlinear(comm=MPI.COMM_SELF) -> Model:
    return _geodesic_beam(line(comm, 1), law=nonlinear_law)


def kirchhoff_rod(comm=MPI.COMM_SELF) -> Model:
    mesh = line(comm, 1)
    q = fl.NodalFrames(mesh)
    x = q.frames[:, 0]
    q.update(np.column_stack([0 * x, 0.3 * np.sin(x + 1)]))
    ends = q.frames[q.function.function_space.dofmap.list]
    relative = lie.se3_relative(ends[:, 0], ends[:, 1])
    d, length = (cellwise(mesh, a) for a in (relative, np.linalg.norm(relative[:, :3], axis=1)))
    energy = rod_energy(d, length, cellwise(mesh, np.tile(D, (len(ends), 1, 1))))
    forms = fl.extend.LocalFrameForms(energy, q.function, q.increment, GEODESIC, coordinates=d)
    return Model(q, forms, energy, d)


def _shell(comm, cell: str, degree: int) -> Model:
    """Membrane, transverse shear, bending by d₃, and d₁, d₂ bound to the surface."""
    mesh = surface(comm, cell)
    q = fl.NodalFrames(mesh, degree)
    d1, d2, d3 = q.directors
    F, B = ufl.grad(q.position), ufl.grad(d3)
    E = 0.5 * (F.T * F - ufl.Identity(3))
    K = 0.5 * (F.T * B + B.T * F)
    shear = F.T * d3
    drill = ufl.dot(F * ufl.as_vector([1, 0, 0]), d2) - ufl.dot(F * ufl.as_vector([0, 1, 0]), d1)
    density = (
        10.0 * ufl.tr(E) ** 2 + 20.0 * ufl.inner(E, E) + 2.0 * ufl.inner(K, K)
        + 8.0 * ufl.dot(shear, shear) + drill**2
    )  # fmt: skip
    energy = density * measure(mesh, 2)
    return Model(q, fl.local_frame_forms(energy, q), energy)


def shell_triangles(comm=MPI.COMM_SELF) -> Model:
    return _shell(comm, "triangle", 1)


def shell_quadrilaterals(comm=MPI.COMM_SELF) -> Model:
    return _shell(comm, "quadrilateral", 1)


def shell_quadrilaterals_2(comm=MPI.COMM_SELF) -> Model:
    return _shell(comm, "quadrilateral", 2)


def _with_local(q: fl.NodalFrames, element, energy_of: Callable) -> Model:
    s = fem.Function(fem.functionspace(q.function.function_space.mesh, element))
    energy = energy_of(s)
    return Model(q, fl.local_frame_forms(energy, q, local=s), energy)


def hellinger_reissner(comm=MPI.COMM_SELF) -> Model:
    """``s·ε − ½ s·D⁻¹s`` with constant ``s``: the linear director beam with one point."""
    q = fl.NodalFrames(line(comm, 1))
    element = basix.ufl.element("DG", "interval", 0, shape=(6,))
    C = ufl.as_matrix(np.linalg.inv(D).tolist())
    base = director_energy(q)
    return _with_local(
        q, element, lambda s: (ufl.inner(s, base.strain) - 0.5 * ufl.inner(s, C * s)) * base.dx
    )


def hu_washizu(comm=MPI.COMM_SELF) -> Model:
    """``w(e) + s·(ε − e)``, constant ``s`` and ``e``: the nonlinear director beam with one point.

    ``∂²W/∂s²`` has a zero diagonal block, so that its elimination must exchange rows.
    """
    q = fl.NodalFrames(line(comm, 1))
    part = basix.ufl.element("DG", "interval", 0, shape=(6,))
    base = director_energy(q)

    def energy(local):
        s, e = ufl.split(local)
        return (nonlinear_law(e) + ufl.inner(s, base.strain - e)) * base.dx

    return _with_local(q, basix.ufl.mixed_element([part, part]), energy)


def hellinger_reissner_linear(mesh, section: np.ndarray, rest: np.ndarray) -> Model:
    """Moments ``M̄ − s e₁×N`` in equilibrium with the constant forces, on one-point strains."""
    q = fl.NodalFrames(mesh)
    base = director_energy(q, linear_law)
    strain = base.strain + ufl.as_vector((STRAIN_0 - rest).tolist())
    # arc length from the middle of each cell, as a linear function
    ends = mesh.geometry.x[_compat.geometry_dofmap(mesh)]
    half = 0.5 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    arc = fem.Function(fem.functionspace(mesh, ("DG", 1)))
    arc.x.array[arc.function_space.dofmap.list] = np.column_stack([-half, half])
    C = ufl.as_matrix(np.linalg.inv(section).tolist())

    def energy(s):
        local = ufl.as_vector([s[0], s[1], s[2], s[3], s[4] + arc * s[2], s[5] - arc * s[1]])
        complementary = 0.5 * ufl.inner(local, C * local) * measure(mesh, 2)
        return ufl.inner(s, strain) * base.dx - complementary

    return _with_local(q, basix.ufl.element("DG", "interval", 0, shape=(6,)), energy)


BEAMS = [
    director_beam_1,
    director_beam_2,
    director_beam_1_carried,
    director_beam_2_carried,
    director_beam_midpoint,
    geodesic_beam,
    geodesic_beam_flexible,
    geodesic_beam_nonlinear,
    kirchhoff_rod,
    hellinger_reissner,
    hu_washizu,
]
SHELLS = [shell_triangles, shell_quadrilaterals, shell_quadrilaterals_2]
ELEMENTS = BEAMS + SHELLS
CARRIED = [
    director_beam_1_carried,
    director_beam_2_carried,
    director_beam_midpoint,
    geodesic_beam,
    geodesic_beam_nonlinear,
    kirchhoff_rod,
]


@cache
def built(make: Callable[..., Model]) -> Model:
    """The model, made once; whoever takes it sets the frames it wants."""
    return make()
