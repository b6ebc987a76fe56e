"""Scenes whose speed is that of the linear solver: against the fastest package, in turns."""

from __future__ import annotations

import math
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path

from mpi4py import MPI
from petsc4py import PETSc

import dolfinx.fem.petsc
import numpy as np
import ufl

import fem_lie as fl
from benchmarks.everyday_rows.row import Outcome, Row, in_turns
from fem_lie.linear.choice import Solutions
from fem_lie.linear.direct import DirectSolver

ROOT = Path(__file__).parents[2]
PACKAGES = "mumps", "umfpack"  # KLU takes minutes where there is fill
PREFIXES = "fem_lie_statics_", "fem_lie_dynamics_"
BESIDE = 1.3
FACTOR, SOLVER, ATTACHED, GROWTH = 1.3, 1.1, 1.1, 2.1  # targets
STATICS, STEPS, LARGEST = 4.0, 4.0, 60.0  # seconds


# --- scenes ---


def cube(cells: int) -> fl.Scene:
    """1 m, one face clamped, 1 kPa of shear on the opposite one."""
    scene = fl.Scene()
    mesh = fl.mesh.parametric_volume(lambda a, b, c: (a, b, c), (cells,) * 3)
    material = fl.sections.SaintVenantKirchhoff(1e9, 0.3, 1000.0)
    solid = scene.add(fl.Solid(mesh, material, formulation=fl.elements.Isoparametric()))
    for node in solid.points("a=0"):
        scene.add(fl.Clamp(node))
    scene.add(fl.loads.FaceLoad(solid, "a=1", (0.0, 0.0, 1e3)))
    return scene


def pantograph(across: int = 48, along: int = 24, pitch: float = 0.01) -> fl.Scene:
    """Two layers of fibres at ±45°, pinned where they cross, stretched by a force on a bar."""
    material = fl.Material(E=2e9, nu=0.35, density=1000.0)
    section = fl.Section.rectangle(0.001, 0.001, material)
    scene = fl.Scene()
    at: dict[tuple[int, int], list[fl.extend.Point]] = {}
    for slope in (1, -1):
        for i in range(across + 1):
            for j in range(along + 1):
                inside = 0 <= i - 1 and 0 <= j - slope <= along
                if (i + j) % 2 or inside:
                    continue
                fibre = _fibre(i, j, slope, across, along)
                if len(fibre) < 2:
                    continue
                ends = [(pitch * x, pitch * y, 0.0) for x, y in (fibre[0], fibre[-1])]
                cells = 2 * (len(fibre) - 1)
                beam = fl.Beam.straight(*ends, section, cells=cells, up=(0, 0, 1))
                scene.add(beam)
                for k, position in enumerate(fibre):
                    at.setdefault(position, []).append(beam.point(2 * k))
    for nodes in at.values():
        if len(nodes) == 2:
            scene.add(fl.joints.Revolute(*nodes, axis=(0, 0, 1)))
    bar = fl.RigidBody(0.1, (1e-5,) * 3, position=(across * pitch, along * pitch / 2, 0))
    scene.add(bar)
    for (i, _), nodes in at.items():
        if i == 0:
            scene.add(fl.Clamp(nodes[0]))
        if i == across:
            scene.add(fl.joints.RigidLink(bar.point("centre"), nodes[0]))
    scene.add(fl.PointLoad(bar.point("centre"), force=(5.0, 0, 0)))
    return scene


def _fibre(i: int, j: int, slope: int, across: int, along: int) -> list[tuple[int, int]]:
    found = []
    while i <= across and 0 <= j <= along:
        found.append((i, j))
        i, j = i + 1, j + slope
    return found


@cache
def _mount_mesh() -> fl.mesh.VolumeMesh:
    """A cylinder of 40 mm × 30 mm with a hole of 10 mm, quadratic tetrahedra of 5 mm."""
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    outer, hole = (occ.addCylinder(0, 0, 0, 0, 0, 30, radius) for radius in (20, 5))
    occ.cut([(3, outer)], [(3, hole)])
    occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 5)
    for dim, tag in gmsh.model.getEntities(2):
        z = occ.getCenterOfMass(dim, tag)[2]
        for name, height in (("bottom", 0.0), ("top", 30.0)):
            if abs(z - height) < 1e-6:
                gmsh.model.addPhysicalGroup(2, [tag], name=name)
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="rubber")
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mount.msh"
        gmsh.write(str(file))
        gmsh.finalize()
        return fl.mesh.read_gmsh_volume(file)


def mount(*, attached: bool) -> fl.Scene:
    """Rubber, clamped below: pushed by a rigid mass on an attachment, or by a traction."""
    scene = fl.Scene()
    rubber = fl.Solid(_mount_mesh(), fl.sections.NeoHooke(3.0, 0.45, 1e-9), degree=2)
    scene.add(rubber)
    for node in rubber.points("bottom"):
        scene.add(fl.Clamp(node))
    force, area = np.array((50.0, 0.0, -100.0)), math.pi * (20.0**2 - 5.0**2)
    if attached:
        mass = scene.add(fl.RigidBody(1e-3, (0.1,) * 3, position=(0, 0, 50)))
        scene.add(fl.joints.Fixed(rubber.point("top"), mass.point("centre"), at=(0, 0, 30)))
        scene.add(fl.PointLoad(mass.point("centre"), force=tuple(force)))
    else:
        scene.add(fl.loads.FaceLoad(rubber, "top", tuple(force / area)))
    return scene


def pendulum_alone_or_not(*, cable: bool) -> fl.Scene:
    """The double pendulum, perhaps with a cable that rests elsewhere."""
    sys.path.insert(0, str(ROOT / "demos"))
    from demos.double_pendulum import pendulum

    scene, *_ = pendulum(1, 10)
    if cable:
        section = fl.Section.circle(0.002, fl.Material(E=70e9, nu=0.3, density=2700.0))
        resting = scene.add(fl.Cable.straight((5, 0, 0), (6, 0, 0), section, cells=2))
        resting.clamp(resting.point("start"))
    return scene


# --- measurements ---


def seconds_of(what: Callable[[], object]) -> float:
    """Processor time of a call."""
    began = time.process_time()
    what()
    return time.process_time() - began


@contextmanager
def package(name: str | None) -> Iterator[None]:
    """Factorise by a package meanwhile, or by what is chosen."""
    options = PETSc.Options()
    keys = [f"{prefix}pc_factor_mat_solver_type" for prefix in PREFIXES] if name else []
    for key in keys:
        options[key] = name
    try:
        yield
    finally:
        for key in keys:
            options.delValue(key)


def plain_matrix(cells: int) -> PETSc.Mat:
    """What DOLFINx assembles for the cube: linear elasticity, the clamped face as unit rows."""
    mesh = dolfinx.mesh.create_unit_cube(
        MPI.COMM_SELF, *(cells,) * 3, dolfinx.mesh.CellType.hexahedron
    )
    V = dolfinx.fem.functionspace(mesh, ("Lagrange", 1, (3,)))
    facets = dolfinx.mesh.locate_entities_boundary(mesh, 2, lambda x: np.isclose(x[0], 0.0))
    dofs = dolfinx.fem.locate_dofs_topological(V, 2, facets)
    held = dolfinx.fem.dirichletbc(np.zeros(3), dofs, V)
    u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    strain = ufl.sym(ufl.grad(u))
    λ, μ = 1e9 * 0.3 / (1.3 * 0.4), 1e9 / 2.6
    stress = λ * ufl.tr(strain) * ufl.Identity(3) + 2.0 * μ * strain
    form = dolfinx.fem.form(ufl.inner(stress, ufl.sym(ufl.grad(v))) * ufl.dx)
    matrix = dolfinx.fem.petsc.assemble_matrix(form, bcs=[held])
    matrix.assemble()
    return matrix


def factor_seconds(matrix: PETSc.Mat, kind: str, name: str) -> float:
    """Of a first factorisation with its analysis."""
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, kind == "cholesky")
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setOperators(matrix)
    pc.setType(kind)
    pc.setFactorSolverType(name)
    return seconds_of(pc.setUp)


def cube_factor(cells: int) -> Outcome:
    """Ours, with the choice of the package, over the fastest package on DOLFINx's matrix."""
    from fem_lie.solve.statics.follow import SceneEquilibrium

    model = SceneEquilibrium(cube(cells), "everyday_")
    plain = plain_matrix(cells)

    def ours() -> float:
        def factorise() -> None:
            solver = DirectSolver(model.equations.matrix, "everyday_", solutions=Solutions.FEW)
            solver.factorise()

        return seconds_of(factorise)

    small = cells <= 12  # KLU takes minutes for others
    ways = [("cholesky", "cholmod"), ("cholesky", "mumps"), ("lu", "mumps"), ("lu", "umfpack")]
    ways += [("lu", "klu")] if small else []
    peers = [partial(factor_seconds, plain, *way) for way in ways]
    least, *others = in_turns(ours, *peers)
    best = min(others)
    _, name = ways[others.index(best)]
    return Outcome(
        f"{least:.3f} s", f"{best:.3f} s by {name}, {least / best:.2f}", least <= FACTOR * best
    )


def cube_growth() -> Outcome:
    """Exponent of a factor in the unknowns from 12³ to 24³, and all of the statics of 24³."""
    from fem_lie.solve.statics.follow import SceneEquilibrium

    def factor(cells: int) -> float:
        model = SceneEquilibrium(cube(cells), "everyday_")
        solver = DirectSolver(model.equations.matrix, "everyday_", solutions=Solutions.FEW)
        return seconds_of(solver.factorise)

    small, large = in_turns(partial(factor, 12), partial(factor, 24))
    unknowns = [3 * n * (n + 1) ** 2 for n in (12, 24)]
    exponent = math.log(large / small) / math.log(unknowns[1] / unknowns[0])
    (statics,) = in_turns(lambda: seconds_of(partial(fl.statics, cube(24))), rounds=1)
    return Outcome(
        f"exponent {exponent:.2f}; {statics:.1f} s", "", exponent <= GROWTH and statics <= LARGEST
    )


def by_packages(what: Callable[[], object], limit: float) -> Outcome:
    """What is chosen over each package by option."""

    def by(name: str | None) -> float:
        with package(name):
            return seconds_of(what)

    what()
    ours, *others = in_turns(partial(by, None), *(partial(by, name) for name in PACKAGES))
    best = min(others)
    ratio = ours / best
    return Outcome(
        f"{ours:.2f} s",
        f"{best:.2f} s by {PACKAGES[others.index(best)]}, {ratio:.2f}",
        ours <= limit and ratio <= SOLVER,
    )


def pantograph_statics() -> Outcome:
    """The sheet is stretched."""
    return by_packages(lambda: fl.statics(pantograph()), STATICS)


def pantograph_steps() -> Outcome:
    """A hundred steps."""

    def steps() -> object:
        scheme = fl.GeneralisedAlpha()
        return scheme.run(pantograph(), duration=0.02, step=2e-4, progress=False)

    return by_packages(steps, STEPS)


def mount_attached() -> Outcome:
    """With the averaging attachment over without."""

    def seconds(attached: bool) -> float:
        return seconds_of(lambda: fl.statics(mount(attached=attached)))

    # the mass bends the rubber more than the traction does, which may take an iteration more
    with_it, alone = (
        int(fl.statics(mount(attached=each)).iterations[-1]) for each in (True, False)
    )
    ours, without = in_turns(partial(seconds, True), partial(seconds, False))
    ratio = ours / without
    return Outcome(
        f"{ours:.2f} s, {with_it} iterations",
        f"{without:.2f} s, {alone} iterations without, {ratio:.2f}; "
        f"of an iteration {ratio * alone / with_it:.2f}",
        ratio <= ATTACHED,
    )


def pendulum_with_cable() -> Outcome:
    """A step of energy-momentum with a resting cable over one without."""

    def per_step(cable: bool) -> float:
        """Milliseconds, without what a run costs before its steps."""

        def seconds(steps: int) -> float:
            scene = pendulum_alone_or_not(cable=cable)
            options = {"duration": steps * 1e-4, "step": 1e-4, "progress": False}
            return seconds_of(lambda: fl.EnergyMomentum().run(scene, **options))

        return 1e3 * (seconds(2500) - seconds(500)) / 2000

    for cable in (True, False):
        per_step(cable)
    ours, alone = in_turns(partial(per_step, True), partial(per_step, False))
    ratio = ours / alone
    return Outcome(f"{ours:.3f} ms", f"{alone:.3f} ms alone, {ratio:.2f}", ratio <= BESIDE)


ROWS = (
    *(
        Row(
            f"cube of {cells}³ bricks, a factor",
            f"≤ {FACTOR} times the fastest package on DOLFINx's matrix",
            partial(cube_factor, cells),
        )
        for cells in (12, 16, 20)
    ),
    Row(
        "cube of 12³ to 24³ bricks, growth of a factor; statics of 24³",
        f"exponent ≤ {GROWTH}; ≤ {LARGEST:.0f} s",
        cube_growth,
    ),
    Row(
        "pantograph of 17 993 unknowns, statics",
        f"≤ {STATICS:.0f} s; ≤ {SOLVER} times the fastest package by option",
        pantograph_statics,
    ),
    Row(
        "pantograph of 17 993 unknowns, 100 steps",
        f"≤ {STEPS:.0f} s; ≤ {SOLVER} times the fastest package by option",
        pantograph_steps,
    ),
    Row(
        "energy-momentum, a step of a pendulum with a resting cable",
        f"≤ {BESIDE} times without",
        pendulum_with_cable,
    ),
    Row(
        "rubber mount with an averaging attachment, statics",
        f"≤ {ATTACHED} times without",
        mount_attached,
    ),
)
