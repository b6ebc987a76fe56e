"""Shells as bodies of a scene: meshes, directors, supports, loads, statics."""

from mpi4py import MPI

import dolfinx
import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

SOFT = fl.Material(100.0, 0.3, 2.0)
LAYER = fl.ShellSection.layer(0.1, SOFT)


def square(a: float, b: float) -> tuple[float, float, float]:
    return (2.0 * a, b, 0.0)


def arch(a: float, b: float) -> tuple[float, float, float]:
    """Quarter of a cylinder about y, of radius 1 and length 1."""
    angle = 0.5 * np.pi * a
    return (np.cos(angle), 1.0 - b, np.sin(angle))


def outward(x: np.ndarray) -> np.ndarray:
    return x * [1, 0, 1] / np.hypot(x[0], x[2])


def arch_shell(cells=(6, 3), **options) -> fl.Shell:
    """Its normal points outward."""
    return fl.Shell(fl.mesh.parametric_surface(arch, cells), LAYER, director=outward, **options)


def scene_with(*items) -> fl.Scene:
    scene = fl.Scene()
    for item in items:
        scene.add(item)
    return scene


# --- meshes ---


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
@pytest.mark.parametrize("degree", [1, 2])
def test_areas_masses_and_edges_are_those_of_the_surface(cell, degree):
    shell = fl.Shell(
        fl.mesh.parametric_surface(square, (3, 2), cell=cell, degree=degree),
        LAYER,
        formulation=fl.elements.DisplacementBased(
            fl.elements.MITC3_PLUS if (cell, degree) == ("triangle", 1) else None
        ),
    )
    assert shell.model.areas().sum() == pytest.approx(2.0)
    edges = shell.model.edge_quadrature("a=1")
    assert edges.lengths.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(shell.frames[edges.nodes, 0, 0], 2.0)
    np.testing.assert_allclose(edges.positions[..., 0], 2.0)
    mass = shell.model.element_inertia()
    assert mass[:, :, 0, :, 0].sum() == pytest.approx(2.0 * 0.1 * 2.0)
    assert mass[:, :, 3, :, 3].sum() == pytest.approx(2.0 * 0.1**3 / 12 * 2.0)


def test_directors_are_means_of_the_cells_normals():
    """Of second order inside; on a free edge one-sided and of first order."""
    errors = []
    for count in (8, 16):
        mesh = fl.mesh.parametric_surface(arch, (count, 2))
        exact = np.array([outward(x) for x in mesh.points])
        inside = (mesh.points[:, 0] > 1e-9) & (mesh.points[:, 2] > 1e-9)
        assert np.abs(mesh.directors() - exact)[inside].max() <= 1e-12  # by symmetry
        errors.append(np.abs(mesh.directors() - exact).max())
    assert errors[1] == pytest.approx(errors[0] / 2, rel=0.05)


GEO = """
DefineConstant[ size = 0.4 ];
Point(1) = {1, 0, 0, size}; Point(2) = {0, 0, 1, size}; Point(3) = {0, 0, 0, size};
Circle(1) = {1, 3, 2};
out[] = Extrude {0, 1, 0} { Line{1}; };
Physical Surface("roof") = {out[1]};
Physical Curve("start") = {1};
Physical Point("corner") = {1};
"""


@pytest.mark.parametrize(
    ("command", "cell"),
    [
        ("", "triangle"),
        ("Transfinite Surface{out[1]}; Recombine Surface{out[1]};\n", "quadrilateral"),
    ],
)
def test_gmsh_surface_has_names_and_the_normals_of_the_cad(tmp_path, command, cell):
    (tmp_path / "roof.geo").write_text(GEO + command)
    mesh = fl.mesh.read_gmsh_surface(fl.mesh.run_gmsh_script(tmp_path / "roof.geo", {"size": 0.2}))
    assert mesh.cell == cell
    assert len(mesh.group("roof")) == len(mesh.cells)
    np.testing.assert_allclose(mesh.points[mesh.nodes("start"), 1], 0.0, atol=1e-12)
    np.testing.assert_allclose(mesh.points[mesh.nodes("corner")], [[1, 0, 0]], atol=1e-12)
    exact = np.array([outward(x) for x in mesh.points])
    directors = mesh.directors()
    side = np.sign((directors[0] * exact[0]).sum())
    np.testing.assert_allclose(side * directors, exact, atol=1e-7)  # gmsh's own digits


# --- equilibrium ---


def positions(result: fl.StaticResult, step: int = -1) -> np.ndarray:
    """Positions and directors; how frames turn about them depends on the path."""
    return result.frames[step][:, [0, 3]]


def loaded(formulation: fl.elements.ShellFormulation | None = None, cells=(6, 3)) -> fl.Scene:
    shell = arch_shell(cells, formulation=formulation, name="arch")
    shell.clamp("a=0")
    shell.symmetry("b=0", (0, 1, 0))
    load = fl.loads.EdgeLoad(shell, "a=1", force=(0.02, 0, -0.02))
    return scene_with(shell, load, fl.AreaLoad(shell, force=(0, 0, -0.01)))


@pytest.mark.parametrize(
    "formulation",
    [fl.elements.HellingerReissner(), fl.elements.HuWashizu(), fl.elements.DisplacementBased()],
)
def test_load_steps_and_arc_length_find_the_same_state(formulation):
    followed = fl.follow_loads(loaded(formulation))
    stepped = fl.statics(loaded(formulation), load_steps=4)
    difference = np.abs(positions(followed) - positions(stepped)).max()
    assert difference <= 1e-7
    assert np.abs(followed.frames[-1, :, 0] - followed.info.undeformed[:, 0]).max() > 0.3


def test_states_between_are_those_of_the_load_that_they_belong_to():
    both = fl.follow_loads(loaded(), [0.5, 1.0])
    half = fl.follow_loads(loaded(), [0.5])
    np.testing.assert_allclose(both.factors, [0.5, 1.0])
    np.testing.assert_allclose(positions(both, 0), positions(half), atol=1e-7)


def test_half_a_shell_with_a_plane_of_symmetry_is_half_of_the_whole():
    def middle(whole: bool) -> np.ndarray:
        reach = 1.0 if whole else 0.5
        shell = fl.Shell(
            fl.mesh.parametric_surface(
                lambda a, b: (np.cos(a), reach * (1 - b), np.sin(a)), (4, 4 if whole else 2)
            ),
            LAYER,
            director=outward,
            name="arch",
        )
        shell.clamp("a=0")
        scene = scene_with(shell)
        if not whole:
            shell.symmetry("b=0", (0, 1, 0))
        for name in ("10", "11") if whole else ("11",):
            scene.add(fl.PointLoad(shell.point(name), force=(0.01, 0, -0.02)))
        result = fl.follow_loads(scene)
        return result.position("arch.11")[-1]

    np.testing.assert_allclose(middle(True), middle(False), atol=1e-7)


def test_guide_holds_a_direction_in_space_as_a_joint_does():
    def state(guided: bool) -> np.ndarray:
        scene = loaded()
        shell = scene.bodies[0]
        if guided:
            shell.roller("11", (1, 0, 1))
        else:
            scene.add(fl.joints.InPlane(fl.ground(), shell.point("11"), axis=(1, 0, 1)))
        return positions(fl.follow_loads(scene))

    held, joined = state(True), state(False)
    np.testing.assert_allclose(held, joined, atol=1e-7)


def test_two_shells_are_one_assembly_and_do_not_feel_each_other():
    alone = fl.follow_loads(loaded())
    scene = loaded()
    other = scene.add(arch_shell((2, 2)))
    other.clamp("a=0")
    together = fl.follow_loads(scene)
    shell = together.info.body("arch").nodes
    single = alone.info.body("arch").nodes
    np.testing.assert_allclose(positions(together)[shell], positions(alone)[single], atol=1e-7)
    other_nodes = together.info.body(other.name).nodes
    np.testing.assert_allclose(together.frames[-1][other_nodes], other.frames, atol=1e-9)


def test_weight_is_that_of_the_mass():
    """Gravity and the same force per area."""
    results = []
    for gravity in (True, False):
        shell = arch_shell()
        shell.clamp("a=0")
        scene = fl.Scene(gravity=(0, 0, -0.1) if gravity else (0, 0, 0))
        scene.add(shell)
        # a load that is not zero is asked for
        force = 0.0 if gravity else -0.1 * 2.0 * 0.1
        scene.add(fl.AreaLoad(shell, force=(0, 0, force)))
        results.append(positions(fl.follow_loads(scene)))
    np.testing.assert_allclose(results[0], results[1], atol=1e-7)


# --- dynamics ---


@pytest.mark.parametrize(
    "formulation", [fl.elements.HellingerReissner(), fl.elements.DisplacementBased()]
)
@pytest.mark.parametrize("group", list(fl.lie.Group))
def test_free_shell_tumbles_with_its_momentum(formulation, group):
    """It keeps its momentum, of second order in the step.

    It starts without the stretch that its spin makes; those vibrations, 2 % of its energy, are too
    fast for the steps and damped by the scheme.
    """
    shell = arch_shell((4, 2), formulation=formulation).set_group(group)
    shell.add_velocity(omega=(0.2, 0.1, 0.3), about=(0, 0, 0))
    shell.add_velocity((0.1, 0, 0))
    result = fl.GeneralisedAlpha(radius=0.9).run(scene_with(shell), duration=2.0, step=0.05)
    # exact on R³×SO(3) up to the iteration; of second order in the step on SE(3)
    assert result.momentum_error <= (1e-4 if group == fl.lie.Group.SE3 else 1e-7)
    assert result.angular_momentum_error <= 5e-4  # of second order in the step
    assert result.energy_error <= 1e-3
    turned = lie.so3_log(result.rotation(f"{shell.name}.node 0")[-1] @ shell.frames[0, 1:])
    assert np.linalg.norm(turned) > 0.5
    # what is left out of the matrix at a state out of balance does not stop convergence
    assert result.iterations[-1] <= 8 * len(result.times)


def test_first_frequency_of_a_strip_is_that_of_a_beam():
    """``ω = 1.8751² √(EI/ρA)/ℓ²`` without Poisson's ratio; shear and the mesh make 1 %."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (a, 0.1 * b, 0.0), (20, 1)),
        fl.ShellSection.layer(0.01, fl.Material(1e6, 0.0, 10.0)),
    )
    shell.clamp("a=0")
    modes = fl.vibrations(scene_with(shell), count=1)
    omega = 1.87510407**2 * np.sqrt(1e6 * 0.01**2 / 12 / 10.0)
    assert abs(modes.eigenvalues[0]) == pytest.approx(omega, rel=0.01)


def test_stretched_strip_vibrates_as_a_stretched_beam():
    """The tension is ten times EI/ℓ²; loads and elements must leave out the same."""
    steel, tension = fl.Material(1e6, 0.0, 10.0), 10 * 1e6 * 0.1 * 0.01**3 / 12
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (a, 0.1 * b, 0.0), (20, 1)),
        fl.ShellSection.layer(0.01, steel),
    )
    shell.clamp("a=0")
    strip = scene_with(shell, fl.loads.EdgeLoad(shell, "a=1", force=(tension / 0.1, 0, 0)))
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.rectangle(0.1, 0.01, steel), cells=20)
    rod = scene_with(
        beam, fl.Clamp(beam.point("start")), fl.PointLoad(beam.point("end"), force=(tension, 0, 0))
    )
    found, wanted = (np.abs(fl.vibrations(scene, count=2).eigenvalues) for scene in (strip, rod))
    np.testing.assert_allclose(found, wanted, rtol=0.01)


# --- bad input ---


def flipped() -> fl.mesh.SurfaceMesh:
    mesh = fl.mesh.parametric_surface(square, (2, 1))
    cells = mesh.cells.copy()
    cells[1] = cells[1][[1, 0, 3, 2]]
    return fl.mesh.SurfaceMesh.from_cells(mesh.points, cells, "quadrilateral")


def kinked(**options) -> fl.Shell:
    position = lambda a, b: (min(a, 0.5), b, max(a - 0.5, 0.0))  # noqa: E731
    return fl.Shell(fl.mesh.parametric_surface(position, (2, 1)), LAYER, **options)


def branched(**options) -> fl.Shell:
    points = [(0, 0, 0), (0, 1, 0), (1, 0, 0), (-1, 0, 0), (0, 0, 1)]
    cells = [(0, 1, 2), (1, 0, 3), (0, 1, 4)]
    return fl.Shell(fl.mesh.SurfaceMesh.from_cells(points, cells, "triangle"), LAYER, **options)


FIVE = {"drilling": False}


def joined(item_of_shell, **options):
    shell = arch_shell(**options)
    return scene_with(shell, item_of_shell(shell))


def beside_beam(item):
    beam = fl.Beam.straight(
        (1, 1, 0), (1, 2, 0), fl.Section.circle(0.1, fl.Material(1.0, 0.3, 1.0)), cells=1
    )
    shell = arch_shell(**FIVE)
    return scene_with(shell, beam, item(shell.point("00"), beam.point("start")))


CASES = {
    "no thickness": (lambda: fl.ShellSection.layer(0.0, SOFT), "thickness"),
    "Poisson ratio 1/2": (
        lambda: fl.ShellSection.layer(0.1, fl.Material(1.0, 0.5, 1.0)),
        r"below 1/2, got 0\.5",
    ),
    "Poisson ratio -1": (
        lambda: fl.ShellSection.layer(0.1, fl.Material(1.0, -1.0, 1.0)),
        r"-1",
    ),
    "line mesh": (
        lambda: fl.mesh.surface_from_dolfinx(dolfinx.mesh.create_unit_interval(MPI.COMM_SELF, 2)),
        "interval",
    ),
    "lines for cells": (
        lambda: fl.mesh.SurfaceMesh.from_cells(np.eye(3), [(0, 1), (1, 2)], "triangle"),
        r"triangles must have \[3, 6\] points",
    ),
    "unknown cell": (
        lambda: fl.mesh.SurfaceMesh.from_cells(np.eye(3), [(0, 1, 2)], "tri"),
        "'tri'",
    ),
    "no area": (
        lambda: fl.mesh.SurfaceMesh.from_cells(
            [(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)], "triangle"
        ),
        "cell 0 .* no area",
    ),
    "flipped normals": (flipped, r"cells 0 and 1 point to opposite sides"),
    "flipped director": (
        lambda: fl.Shell(
            fl.mesh.parametric_surface(arch, (2, 1)), LAYER, director=lambda x: -outward(x)
        ),
        "to the side of the cells' normals",
    ),
    "director that is no unit vector": (
        lambda: fl.Shell(
            fl.mesh.parametric_surface(arch, (2, 1)), LAYER, director=lambda x: 2 * outward(x)
        ),
        "unit vector",
    ),
    "kink with five parameters": (
        lambda: kinked(**FIVE),
        r"kink or branch at .*drilling=False",
    ),
    "branch with five parameters": (lambda: branched(**FIVE), r"branch at .*drilling=False"),
    "kink for means of normals": (
        lambda: kinked().model.mesh.directors(),
        "a kink of more than 40°",
    ),
    "one director for a branch": (lambda: branched(director=lambda x: (0, 0, 1)), "branches"),
    "sharp tip": (
        lambda: fl.Shell(
            fl.mesh.SurfaceMesh.from_cells(
                [(0, 0, 1), *((np.cos(a), np.sin(a), 0) for a in np.arange(12) * np.pi / 6)],
                [(0, 1 + i, 1 + (i + 1) % 12) for i in range(12)],
                "triangle",
            ),
            LAYER,
        ),
        r"tip at \[0\. 0\. 1\.\], where normals are 4.°",
    ),
    "a cell twice": (
        lambda: fl.mesh.SurfaceMesh.from_cells(np.eye(3), [(0, 1, 2), (1, 2, 0)], "triangle"),
        "2 cells have the same corners",
    ),
    "unknown curve": (lambda: arch_shell().clamp("c"), r"'c'; it has: 00, 01, 10, 11, a=0"),
    "unknown curve of a load": (
        lambda: joined(lambda shell: fl.loads.EdgeLoad(shell, "c")),
        "no curve 'c'",
    ),
    "unknown point": (lambda: arch_shell().point("c"), "no point 'c'"),
    "section of an unknown group": (
        lambda: fl.Shell(fl.mesh.parametric_surface(square, (1, 1)), {"skin": LAYER}),
        "no group of cells 'skin'",
    ),
    "no plane of symmetry": (
        lambda: arch_shell().symmetry("a=0", (0, 1, 0)),
        "not on a plane of symmetry",
    ),
    "guided along nothing": (
        lambda: arch_shell().roller("00", (0, 0, 0)),
        "direction of roller '00' must not be zero",
    ),
    "triangles of degree 2 in a mixed element": (
        lambda: fl.Shell(
            fl.mesh.parametric_surface(square, (1, 1), cell="triangle", degree=2),
            LAYER,
            formulation=fl.elements.HellingerReissner(),
        ),
        "HellingerReissner is for",
    ),
    "measures of other cells": (
        lambda: arch_shell(formulation=fl.elements.HellingerReissner(fl.elements.MITC3_PLUS)),
        "triangles of degree 1, the mesh has quadrilaterals",
    ),
    "beam on five parameters": (lambda: beside_beam(fl.joints.RigidLink), "drilling=False"),
    "fixed joint on five parameters": (lambda: beside_beam(fl.joints.Fixed), "drilling=False"),
    "moving support on five parameters": (
        lambda: joined(
            lambda shell: fl.PrescribedMotion(shell.point("00"), lambda t: shell.frames[0]), **FIVE
        ),
        "PrescribedMotion needs nodes that rotate",
    ),
    "moment about the normal": (
        lambda: joined(lambda shell: fl.PointLoad(shell.point("00"), moment=(1, 1, 1)), **FIVE),
        "the moment at .*00 needs nodes",
    ),
    "following moment about the normal": (
        lambda: joined(
            lambda shell: fl.PointLoad(shell.point("00"), moment=(0, 0, 1), following=True), **FIVE
        ),
        "the moment at .*00 needs nodes",
    ),
    "nothing to follow": (lambda: fl.follow_loads(scene_with(arch_shell())), "a load that is not"),
    "load with a history on a path": (
        lambda: fl.follow_loads(
            joined(lambda shell: fl.AreaLoad(shell, (1, 0, 0), history=lambda t: t))
        ),
        "with a history",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_bad_input(case):
    make, message = CASES[case]
    with pytest.raises(ValueError, match=message):
        make()


def test_a_gmsh_mesh_may_be_mixed(tmp_path):
    path = tmp_path / "mixed.geo"
    path.write_text(
        "Point(1)={0,0,0,1}; Point(2)={1,0,0,1}; Point(3)={1,1,0,1}; Point(4)={0,1,0,1};"
        "Point(5)={2,0,0,1}; Point(6)={2,1,0,1};"
        "Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1};"
        "Line(5)={2,5}; Line(6)={5,6}; Line(7)={6,3};"
        "Curve Loop(1)={1,2,3,4}; Plane Surface(1)={1};"
        "Curve Loop(2)={5,6,7,-2}; Plane Surface(2)={2};"
        "Transfinite Surface{1}; Recombine Surface{1};\n"
    )
    mesh = fl.mesh.read_gmsh_surface(fl.mesh.run_gmsh_script(path))
    assert [part.mesh.cell for part in mesh.parts] == ["triangle", "quadrilateral"]
