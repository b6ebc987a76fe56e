"""Solid bodies: names, supports, loads, motion in time, meshes of gmsh and DOLFINx, bad input."""

from mpi4py import MPI

import gmsh
import numpy as np
import pytest
import pyvista
from dolfinx import mesh as dmesh
from dolfinx.io import VTXWriter

import fem_lie as fl
from tests.assembled import Assembled
from tests.drawn import empty_model

RUBBER = fl.sections.NeoHooke(1e4, 0.3, 1.0)
SECTION = fl.Section.from_stiffness([1e3, 1e3, 1e3, 10, 10, 10], mass=1.0, rotary=(0.01, 0.01))


def brick(cells=(4, 2, 2), lengths=(1.0, 0.4, 0.2), material=RUBBER, **options):
    return fl.Solid.brick(lengths, material, cells=cells, **options)


def scene_of(*bodies, **options):
    scene = fl.Scene(**options)
    for body in bodies:
        scene.add(body)
    return scene


# --- statics ---


@pytest.mark.parametrize(
    ("cell", "degree", "error"),
    [
        ("hexahedron", 1, 1e-6),
        ("hexahedron", 2, 1e-6),
        ("tetrahedron", 2, 1e-6),
        ("tetrahedron", 1, 0.1),
    ],
)
def test_a_bar_under_its_weight(cell, degree, error):
    """Small strains without Poisson's effect: ``ρ g ℓ²/2E`` at the end, exactly but in tetrahedra
    of degree 1, which bend under their own weight.
    """
    bar = brick(material=fl.sections.SaintVenantKirchhoff(1e8, 0.0, 1.0), cell=cell, degree=degree)
    bar.clamp("a=0")
    found = fl.statics(scene_of(bar, gravity=(9.81, 0, 0)))
    end = bar.point("100")
    moved, wanted = found.position(end)[-1] - end.position, 9.81 / 2e8
    assert moved[0] == pytest.approx(wanted, rel=error)
    assert np.abs(moved[1:]).max() < 2 * error * wanted
    held = [found.reaction(point)[-1] for point in bar.points("a=0")]
    np.testing.assert_allclose(np.sum(held, axis=0)[:3], (-9.81 * 0.08, 0, 0), atol=1e-9)


def test_a_slender_brick_of_degree_two_bends_as_a_beam():
    bar = brick((10, 1, 1), (1.0, 0.1, 0.1), fl.sections.SaintVenantKirchhoff(1e6, 0.0), degree=2)
    bar.clamp("a=0")
    scene = scene_of(bar)
    nodes = bar.points("a=1")
    for node in nodes:
        scene.add(fl.PointLoad(node, (0, 0, 0.01 / len(nodes))))
    found = fl.statics(scene)
    end = bar.point((1, 0.05, 0.05))
    inertia = 0.1**4 / 12
    beam = 0.01 / (3e6 * inertia) + 0.01 / (5 / 6 * 0.5e6 * 0.01)
    assert found.position(end)[-1, 2] - end.position[2] == pytest.approx(beam, rel=5e-3)


def test_guides_hold_one_direction_each():
    """A cube pulled along x, on three planes of symmetry: uniform, for finite strains."""
    cube = brick((2, 2, 2), (1.0, 1.0, 1.0))
    for face, normal in (("a=0", (1, 0, 0)), ("b=0", (0, 1, 0)), ("c=0", (0, 0, 1))):
        cube.roller(face, normal)
    scene = scene_of(cube)
    for node in cube.points("a=1"):
        inside = int((np.abs(node.position[1:] - 0.5) < 0.1).sum())
        scene.add(fl.PointLoad(node, (2e3 * 2**inside / 16, 0, 0)))
    found = fl.statics(scene)
    x, first = found.frames[-1, :, 0], cube.frames[:, 0]
    stretches = [x[first[:, k] > 0.1, k] / first[first[:, k] > 0.1, k] for k in range(3)]
    for stretch in stretches:
        np.testing.assert_allclose(stretch, stretch[0], rtol=1e-9)
    along, across = stretches[0][0], stretches[1][0]
    λ, μ = RUBBER.parameters
    log = np.log(along * across**2)
    assert (μ * (along - 1 / along) + λ * log / along) == pytest.approx(2e3, rel=1e-8)
    assert abs(μ * (across - 1 / across) + λ * log / across) < 1e-5


def test_a_guide_across_the_axes():
    """Held along a slope, a node moves along it."""
    cube = brick((1, 1, 1), (1.0, 1.0, 1.0))
    slope = np.array([0.6, 0.0, 0.8])
    cube.roller("c=0", slope)
    cube.roller("b=0", (0, 1, 0))
    cube.clamp("000")
    scene = scene_of(cube)
    scene.add(fl.PointLoad(cube.point("111"), (0.0, 0.0, -50.0)))
    found = fl.statics(scene)
    moved = found.frames[-1, :, 0] - cube.frames[:, 0]
    below = cube.nodes("c=0")
    assert np.abs(moved[below] @ slope).max() < 1e-12
    assert np.abs(moved[below]).max() > 1e-4
    assert np.abs(moved[cube.nodes("b=0"), 1]).max() < 1e-12


# --- loads and joints ---


def test_a_face_carries_a_force_per_area():
    """Also as a function of the position; moments about the origin of what is not uniform."""
    body = brick((3, 2, 2), lengths=(1.0, 2.0, 3.0), cell="tetrahedron", degree=2)
    forces = fl.loads.FaceLoad(body, "a=1", lambda x: (x[1], 0.0, x[2])).nodal()
    np.testing.assert_allclose(forces.sum(axis=0)[:3], (6.0, 0, 9.0), atol=1e-12)
    moment = np.cross(body.model.positions, forces[:, :3]).sum(axis=0)
    # ∫ (y z, z y − x z, −y²) dA with x = 1
    np.testing.assert_allclose(moment, (4.5 * 2, 4.5 * 2 - 9.0, -8.0), atol=1e-12)
    bulk = fl.loads.BulkLoad(body, lambda x: (x[0], 1.0, 0.0)).nodal().sum(axis=0)
    np.testing.assert_allclose(bulk[:3], (3.0, 6.0, 0.0), atol=1e-12)


@pytest.mark.parametrize("degree", (1, 2))
def test_pressure_compresses_a_cube(degree):
    """Of current area: ``σ = −p``, to finite strains."""
    cube = brick((2, 2, 2), (1.0, 1.0, 1.0), degree=degree)
    scene = scene_of(cube)
    for name, normal in (("a", (1, 0, 0)), ("b", (0, 1, 0)), ("c", (0, 0, 1))):
        cube.roller(f"{name}=0", normal)
        scene.add(fl.loads.FacePressure(cube, f"{name}=1", 3e3))
    found = fl.statics(scene)
    stretch = found.position(cube.point("111"))[-1]
    np.testing.assert_allclose(stretch, stretch[0], rtol=1e-10)
    λ, μ = RUBBER.parameters
    s = stretch[0]
    assert (μ * (s - 1 / s) + 3 * λ * np.log(s) / s) / s**2 == pytest.approx(-3e3, rel=1e-8)


def test_pressure_follows_a_body_that_has_turned():
    """The forces of a face, in its axes, are the same in any position."""
    body = brick((2, 2, 2))
    scene = scene_of(body)
    scene.add(fl.loads.FacePressure(body, "b=1", 7.0))
    system = Assembled(scene, dynamics=True)
    H = system.start.copy()
    angle = 0.7
    c, s = np.cos(angle), np.sin(angle)
    Q = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    before = system.residual(H)
    H[: system.count, 0] = H[: system.count, 0] @ Q.T + 5.0
    system.equations.history_variables.rotate_axes(H)
    after = system.residual(H)
    np.testing.assert_allclose(after, before, atol=1e-10)
    total = before.reshape(-1, 6).sum(axis=0)[:3]
    np.testing.assert_allclose(total, (0, 7.0 * 1.0 * 0.2, 0), atol=1e-10)


def test_a_moment_on_a_face_bends_a_brick():
    """Spread over the nodes of the end, it does what the beam's does."""
    bar = brick((10, 1, 1), (1.0, 0.1, 0.1), fl.sections.SaintVenantKirchhoff(1e6, 0.0), degree=2)
    bar.clamp("a=0")
    scene = scene_of(bar)
    end = bar.point("a=1")
    scene.add(fl.PointLoad(end, moment=(0, 0.5, 0)))
    found = fl.statics(scene, load_steps=2)
    angle = 0.5 / (1e6 * 0.1**4 / 12)
    along = found.rotation(end)[-1, :, 0]
    np.testing.assert_allclose(along, (np.cos(angle), 0, -np.sin(angle)), atol=2e-3)
    wanted = np.sin(angle) / angle, 0.05, 0.05 - (1 - np.cos(angle)) / angle
    np.testing.assert_allclose(found.position(end)[-1], wanted, atol=2e-3)


def test_a_joint_to_a_face_holds_what_a_clamp_holds():
    """Of a pendulum of one brick: the joint's forces are its weight."""
    bar = brick((4, 1, 1), (1.0, 0.1, 0.1))
    scene = scene_of(bar, gravity=(0, 0, -9.81))
    joint = scene.add(fl.joints.Fixed(fl.ground(), bar.point("a=0")))
    found = fl.statics(scene)
    wrench = found.joint_force(joint)[-1]
    weight = 9.81 * 0.01
    np.testing.assert_allclose(np.linalg.norm(wrench[:3]), weight, rtol=1e-9)
    assert np.linalg.norm(wrench[3:]) == pytest.approx(weight * 0.5, rel=2e-2)


def test_a_pendulum_swings_about_a_face():
    """Stiff: as a rigid body about the middle of its end, and it keeps few matrices."""
    stiff = fl.sections.NeoHooke(1e7, 0.3, 1.0)
    bar = brick((4, 1, 1), (1.0, 0.1, 0.1), stiff)
    scene = scene_of(bar, gravity=(0, 0, -9.81))
    bar.add_velocity(omega=(0, -2.0, 0), about=(0, 0.05, 0.05))
    scene.add(fl.joints.Revolute(fl.ground(), bar.point("a=0"), axis=(0, 1, 0)))
    found = fl.GeneralisedAlpha(radius=0.6).run(scene, duration=0.2, step=1e-3)
    rigid = fl.RigidBody(0.01, 0.01 / 12 * np.array([0.02, 1.01, 1.01]), (0.5, 0.05, 0.05))
    other = scene_of(rigid, gravity=(0, 0, -9.81))
    rigid.add_velocity(omega=(0, -2.0, 0), about=(0, 0.05, 0.05))
    other.add(fl.joints.Revolute(fl.ground(), rigid.point((0, 0.05, 0.05)), axis=(0, 1, 0)))
    wanted = fl.GeneralisedAlpha(radius=0.6).run(other, duration=0.2, step=1e-3)
    middle = found.frames[:, bar.nodes("a=1"), 0].mean(axis=1)
    np.testing.assert_allclose(
        (middle + found.frames[:, bar.nodes("a=0"), 0].mean(axis=1))[-1] / 2,
        wanted.frames[-1, 0, 0],
        atol=2e-3,
    )
    assert found.factorisations <= 4


# --- time ---


@pytest.mark.parametrize("degree", (1, 2))
def test_a_tumbling_brick_keeps_its_matrix(degree):
    """Claim 5: one matrix where axes follow, many with fixed ones, to the same motion."""
    body = brick((2, 1, 1), degree=degree)
    body.add_velocity(omega=(1.0, 6.0, 0.3), about=(0.5, 0.2, 0.1))
    body.add_velocity((1.0, 0.0, 0.0))
    scene = scene_of(body, gravity=(0, 0, -9.81))
    scheme = fl.GeneralisedAlpha(radius=0.9)
    found = scheme.run(scene, duration=1.0, step=1e-3)
    fixed = fl.GeneralisedAlpha(radius=0.9, matrix_frame=fl.schemes.MatrixFrame.INERTIAL).run(
        scene, duration=1.0, step=1e-3
    )
    assert found.factorisations == 1
    assert fixed.factorisations >= 10
    np.testing.assert_allclose(found.frames[-1, :, 0], fixed.frames[-1, :, 0], atol=1e-5)


def test_momentum_in_free_flight():
    body = brick((2, 2, 1))
    body.add_velocity(omega=(2.0, 5.0, 1.0), about=(0.5, 0.2, 0.1))
    found = fl.GeneralisedAlpha(radius=0.9).run(scene_of(body), duration=0.5, step=1e-3)
    for what in (found.momentum, found.angular_momentum):
        drift = np.linalg.norm(what - what[0], axis=1).max()
        assert drift < 3e-5 * np.linalg.norm(found.angular_momentum[0])
    assert found.energy_error < 1e-4


def test_damping_with_mass_slows_a_brick_down():
    body = brick((1, 1, 1), damping=fl.sections.Damping(mass=2.0))
    body.add_velocity((1.0, 0.0, 0.0))
    found = fl.GeneralisedAlpha().run(scene_of(body), duration=0.5, step=1e-2)
    np.testing.assert_allclose(found.velocities[:, :, :3].mean(axis=1)[-1, 0], np.exp(-1.0), 1e-4)


def test_vibrations_of_a_bar():
    """Axial ones, ``(2k − 1)/4 √(E/ρ)/ℓ`` without Poisson's effect; six rigid ones when free."""
    bar = brick(
        (20, 1, 1), (1.0, 0.2, 0.2), fl.sections.SaintVenantKirchhoff(100.0, 0.0, 1.0), degree=2
    )
    assert fl.vibrations(scene_of(bar), 8).frequencies[:6].max() < 1e-3
    bar.clamp("a=0")
    for face, normal in (("b=0", (0, 1, 0)), ("b=1", (0, 1, 0)), ("c=0", (0, 0, 1))):
        bar.roller(face, normal)
    found = fl.vibrations(scene_of(bar), 2).frequencies / (2 * np.pi)
    np.testing.assert_allclose(found, np.array([0.25, 0.75]) * 10, rtol=1e-4)


# --- stresses, pictures, files ---


def pulled_cube(cell, degree):
    """Uniform Cauchy stress ``(σ, 0, 0)``, by a force on the face as it will be."""
    cube = brick((2, 2, 2), (1.0, 1.0, 1.0), cell=cell, degree=degree)
    scene = scene_of(cube)
    for name, normal in (("a", (1, 0, 0)), ("b", (0, 1, 0)), ("c", (0, 0, 1))):
        cube.roller(f"{name}=0", normal)
    scene.add(fl.loads.FaceLoad(cube, "a=1", (2e3, 0, 0)))
    return cube, fl.statics(scene)


@pytest.mark.parametrize("degree", (1, 2))
@pytest.mark.parametrize("cell", ("hexahedron", "tetrahedron"))
def test_cauchy_stress_of_a_pulled_cube(cell, degree):
    cube, found = pulled_cube(cell, degree)
    stresses = fl.post.solid_stresses(found, cube)
    _, b, c = found.position(cube.point("111"))[-1]
    wanted = np.zeros((3, 3))
    wanted[0, 0] = 2e3 / (b * c)
    np.testing.assert_allclose(
        stresses.at_points, np.broadcast_to(wanted, stresses.at_points.shape), atol=1e-5
    )
    np.testing.assert_allclose(stresses.nodal - wanted, 0.0, atol=1e-5)
    np.testing.assert_allclose(stresses.smooth("von Mises"), wanted[0, 0], rtol=1e-7)
    np.testing.assert_allclose(stresses.smooth("pressure"), -wanted[0, 0] / 3, rtol=1e-7)
    assert (stresses.points.max(axis=(0, 1)) < found.position(cube.point("111"))[-1]).all()
    with pytest.raises(ValueError, match="no quantity 'mises'; it has: von Mises, press"):
        stresses.smooth("mises")


def test_stress_in_bending_is_linear():
    bar = brick((8, 1, 2), (1.0, 0.1, 0.1), fl.sections.SaintVenantKirchhoff(1e6, 0.0), degree=2)
    bar.clamp("a=0")
    scene = scene_of(bar)
    scene.add(fl.PointLoad(bar.point("a=1"), moment=(0, 1e-3, 0)))
    stresses = fl.post.solid_stresses(fl.statics(scene), bar)
    node = bar.point((0.5, 0.05, 0.1)).node
    assert stresses.nodal[node, 0, 0] == pytest.approx(1e-3 * 0.05 / (0.1**4 / 12), rel=1e-3)


@pytest.mark.parametrize("degree", (1, 2))
@pytest.mark.parametrize("cell", ("hexahedron", "tetrahedron"))
def test_pictures_and_files(cell, degree, tmp_path):
    cube, found = pulled_cube(cell, degree)
    stresses = fl.post.solid_stresses(found, cube)
    stresses.write_vtk(tmp_path / "cube.vtu")
    grid = pyvista.read(tmp_path / "cube.vtu")
    assert grid.volume == pytest.approx(np.prod(found.position(cube.point("111"))[-1]), rel=1e-6)
    np.testing.assert_allclose(grid.point_data["von Mises"], stresses.smooth("von Mises"))
    for name in ("displacement", "stress", "von Mises"):
        with VTXWriter(MPI.COMM_SELF, tmp_path / f"{name}.bp", stresses.function(name)) as file:
            file.write(0.0)
    f = stresses.function("displacement")
    assert f.x.array.max() == pytest.approx(stresses.displacements.max())
    if cell == "hexahedron":
        stresses.picture(tmp_path / "stress.png")
        found.picture(tmp_path / "states.png")
        assert (tmp_path / "stress.png").stat().st_size > 10_000
        assert (tmp_path / "states.png").stat().st_size > 5_000


def different(picture, other):
    """Part of the pixels that differ visibly; two drawings of one scene differ in few last bits."""
    return (np.abs(picture.astype(float) - other).max(axis=-1) > 30).mean()


def test_a_picture_has_the_edges_of_the_body_not_those_of_its_cells(tmp_path):
    """Facets of gmsh's tetrahedra turn either way; a uniform stress looks like that of a brick."""
    pictures = []
    with empty_model() as session:
        session.model.occ.addBox(0, 0, 0, 1, 1, 1)
        session.model.occ.synchronize()
        session.option.setNumber("Mesh.MeshSizeMax", 0.5)
        session.model.mesh.generate(3)
        faces = {f"{'abc'[k]}=0": lambda x, k=k: abs(x[k]) < 1e-9 for k in range(3)}
        faces["a=1"] = lambda x: abs(x[0] - 1) < 1e-9
        tetrahedra = fl.Solid(fl.mesh.read_gmsh_volume().named(faces=faces), RUBBER, degree=2)
    for cube in (tetrahedra, brick((2, 2, 2), (1, 1, 1), degree=2)):
        for name, normal in (("a", (1, 0, 0)), ("b", (0, 1, 0)), ("c", (0, 0, 1))):
            cube.roller(f"{name}=0", normal)
        scene = scene_of(cube)
        scene.add(fl.loads.FaceLoad(cube, "a=1", (2e3, 0, 0)))
        stresses = fl.post.solid_stresses(fl.statics(scene), cube)
        stresses.picture(tmp_path / "cube.png", "xx", title="cube", view=(2, -1, 1))
        pictures.append(pyvista.read(tmp_path / "cube.png").point_data["PNGImage"])
    assert different(*pictures) < 1e-4


def test_a_view_from_the_front_is_that_of_a_plane_scene(tmp_path):
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0.5), SECTION, cells=2)
    scene, pictures = scene_of(beam), {}
    for view in (None, (0, -2, 0), (0, 0, 1)):
        scene.picture(tmp_path / "beam.png", view=view)
        pictures[view] = pyvista.read(tmp_path / "beam.png").point_data["PNGImage"]
    assert different(pictures[None], pictures[0, -2, 0]) < 1e-4
    assert different(pictures[None], pictures[0, 0, 1]) > 1e-2
    with pytest.raises(ValueError, match="view must not be zero"):
        scene.picture(tmp_path / "beam.png", view=(0, 0, 0))


def test_motions_are_drawn_and_written(tmp_path):
    body, beam = brick((1, 1, 1)), fl.Beam.straight((2, 0, 0), (3, 0, 0), SECTION, cells=2)
    body.add_velocity(omega=(0, 1, 0), about=(0, 0, 0))
    found = fl.GeneralisedAlpha().run(scene_of(body, beam), duration=0.02, step=0.01)
    found.write_vtk(tmp_path / "motion.pvd")
    files = sorted((tmp_path / "motion").iterdir())
    assert len(files) == 3
    grid = pyvista.read(files[-1])
    np.testing.assert_allclose(grid.points[:8], found.frames[-1, :8, 0], atol=1e-6)
    found.picture(tmp_path / "motion.png")
    assert (tmp_path / "motion.png").stat().st_size > 5_000


# --- meshes ---


@pytest.fixture
def model():
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    yield gmsh
    gmsh.finalize()


def gmsh_box(model, hexahedra, order):
    tag = model.model.occ.addBox(0, 0, 0, 1, 2, 3)
    model.model.occ.synchronize()
    model.model.addPhysicalGroup(3, [tag], name="all")
    model.model.addPhysicalGroup(2, [1], name="left")
    model.model.addPhysicalGroup(1, [1], name="edge")
    model.model.addPhysicalGroup(0, [1], name="corner")
    if hexahedra:
        for curve in model.model.getEntities(1):
            model.model.mesh.setTransfiniteCurve(curve[1], 3)
        for face in model.model.getEntities(2):
            model.model.mesh.setTransfiniteSurface(face[1])
            model.model.mesh.setRecombine(2, face[1])
        model.model.mesh.setTransfiniteVolume(tag)
    else:
        model.option.setNumber("Mesh.MeshSizeMax", 1.0)
    model.model.mesh.generate(3)
    model.model.mesh.setOrder(order)


@pytest.mark.parametrize("order", (1, 2))
@pytest.mark.parametrize("hexahedra", (True, False))
def test_named_groups_of_gmsh(model, hexahedra, order):
    gmsh_box(model, hexahedra, order)
    body = fl.Solid(fl.mesh.read_gmsh_volume(), {"all": RUBBER})
    assert body.model.degree == order
    assert body.model.volume == pytest.approx(6.0, rel=1e-12)
    x = body.frames[:, 0]
    np.testing.assert_array_equal(body.nodes("left"), np.flatnonzero(x[:, 0] < 1e-12))
    on_edge = (x[:, 0] < 1e-12) & (x[:, 1] < 1e-12)
    np.testing.assert_array_equal(body.nodes("edge"), np.flatnonzero(on_edge))
    assert body.point("corner").position[:2] == pytest.approx((0, 0), abs=1e-12)
    faces = body.model.facets("left")
    assert faces.consistent_areas(x).sum() == pytest.approx(6.0, rel=1e-12)
    normals = faces.outward[:, None] * faces.rule.normals(x, faces.nodes).sum(axis=1)
    np.testing.assert_allclose(normals.sum(axis=0), (-6.0, 0, 0), atol=1e-12)


def test_two_materials_by_groups_of_cells():
    mesh = dmesh.create_box(
        MPI.COMM_SELF, [[0, 0, 0], [2, 1, 1]], [2, 1, 1], dmesh.CellType.hexahedron
    )
    middle = dmesh.compute_midpoints(mesh, 3, np.arange(2, dtype=np.int32))[:, 0]
    tags = dmesh.meshtags(
        mesh, 3, np.arange(2, dtype=np.int32), (1 + (middle > 1)).astype(np.int32)
    )
    volume = fl.mesh.volume_from_dolfinx(mesh, tags, groups={"soft": 1, "stiff": 2})
    given = {
        "soft": fl.sections.NeoHooke(1.0, 0.0, 2.0),
        "stiff": fl.sections.NeoHooke(5.0, 0.0, 3.0),
    }
    body = fl.Solid(volume, given)
    assert body.model.mesh.mesh is mesh
    assert (body.model.density * body.model.rule.volumes.sum(axis=1)).sum() == pytest.approx(5.0)
    assert body.model.parameters[volume.group("stiff"), 1] == pytest.approx(2.5)


# --- bad input ---


def test_bad_input():
    flat = dmesh.create_unit_square(MPI.COMM_SELF, 1, 1)
    with pytest.raises(ValueError, match=r"tetrahedra or hexahedra .* got triangle"):
        fl.Solid(flat, RUBBER)
    with pytest.raises(ValueError, match="inverted"):
        fl.mesh.parametric_volume(lambda a, b, c: (a * (1 - 3 * b), b, c), (1, 1, 1))
    with pytest.raises(ValueError, match="no volume"):
        fl.mesh.parametric_volume(lambda a, b, c: (a, b, 0.0), (1, 1, 1))
    with pytest.raises(ValueError, match="'hexahedron' or 'tetrahedron', got 'prism'"):
        fl.mesh.parametric_volume(lambda a, b, c: (a, b, c), (1, 1, 1), cell="prism")
    with pytest.raises(ValueError, match="three numbers"):
        fl.mesh.parametric_volume(lambda a, b, c: (a, b, c), (1, 1))
    body = brick((1, 1, 1))
    with pytest.raises(ValueError, match=r"no face, curve, point or group 'top'; it has: .*a=0"):
        body.clamp("top")
    with pytest.raises(ValueError, match="no group of cells"):
        fl.Solid(body.model.mesh, {"stiff": RUBBER})
    with pytest.raises(ValueError, match="for hexahedra of degree 1"):
        brick((1, 1, 1), cell="tetrahedron", formulation=fl.elements.MeanDilatation())
    with pytest.raises(ValueError, match="degree must be 1 or 2"):
        brick((1, 1, 1), degree=3)
    with pytest.raises(ValueError, match="one relaxation time for all strains"):
        brick((1, 1, 1), damping=fl.sections.Damping(stiffness=(1, 2, 3, 4, 5, 6)))
    with pytest.raises(ValueError, match=r"-1 < nu < 0\.5"):
        fl.sections.NeoHooke(1.0, 0.5)
    with pytest.raises(TypeError, match="SolidMaterial"):
        brick((1, 1, 1), material=fl.Material(1.0, 0.3, 1.0))
    with pytest.raises(ValueError, match="nodes with frames"):
        scene_of(body).add(fl.PointLoad(body.point("111"), moment=(1, 0, 0)))


def test_loads_and_attachments_refuse():
    body = brick((2, 1, 1))
    scene = scene_of(body)
    with pytest.raises(ValueError, match="no face 'a=2'; it has: a=0"):
        scene.add(fl.loads.FacePressure(body, "a=2", 1.0))
    with pytest.raises(TypeError, match="a Solid"):
        fl.loads.FaceLoad("body", "a=1", (1, 0, 0))
    with pytest.raises(ValueError, match="FaceLoad on"):
        scene.add(fl.loads.FaceLoad(body, "a=1", (1, 0)))
    inside = fl.mesh.VolumeMesh(body.model.mesh.mesh, faces={"cut": inner_facets(body)})
    with pytest.raises(ValueError, match="lies between cells"):
        cut = fl.Solid(inside, RUBBER)
        scene_of(cut).add(fl.loads.FacePressure(cut, "cut", 1.0))
    with pytest.raises(ValueError, match="not collinear"):
        body.point("a=0,b=0")
    with pytest.raises(ValueError, match="right-handed"):
        body.point("a=0", axes=np.diag([1.0, 1.0, -1.0]))
    with pytest.raises(ValueError, match="nodes with frames"):
        scene.add(fl.joints.RigidLink(body.point("000"), body.point("111")))


def inner_facets(body):
    mesh = body.model.mesh.mesh
    mesh.topology.create_connectivity(2, 3)
    count = mesh.topology.index_map(2).size_local
    cells = mesh.topology.connectivity(2, 3)
    return np.array([f for f in range(count) if len(cells.links(f)) == 2])


def test_motion_needs_a_density():
    body = brick((1, 1, 1), material=fl.sections.NeoHooke(1.0, 0.3))
    with pytest.raises(ValueError, match="densit"):
        fl.GeneralisedAlpha().run(scene_of(body), duration=0.1, step=0.1)


def test_laws_may_not_differ_in_one_solid():
    mesh = fl.mesh.brick((2, 1, 1), (2, 1, 1))
    mesh = fl.mesh.VolumeMesh(mesh.mesh, {"one": np.array([0]), "two": np.array([1])})
    with pytest.raises(ValueError, match="one law"):
        fl.Solid(mesh, {"one": RUBBER, "two": fl.sections.SaintVenantKirchhoff(1.0, 0.3)})


def test_linear_tetrahedra_are_warned_of(caplog):
    brick((1, 1, 1), cell="tetrahedron")
    assert "too stiff in bending" in caplog.text


def test_linear_tetrahedra_of_rubber_are_refused():
    """Unless they are asked for, whatever the law."""
    rubber = fl.sections.NeoHooke(1.0, 0.49)
    law = fl.sections.Hyperelastic(rubber.energy, parameters=rubber.parameters)
    assert rubber.incompressibility() == pytest.approx(2 * 1.49 / (3 * 0.02), rel=1e-3)
    for material in (rubber, law):
        with pytest.raises(ValueError, match=r"tetrahedra of degree 1 lock .* 50 times"):
            brick((1, 1, 1), material=material, cell="tetrahedron")
    given = {"cell": "tetrahedron", "formulation": fl.elements.Isoparametric()}
    plain = brick((1, 1, 1), material=rubber, **given)
    assert plain.model.formulation == fl.elements.Isoparametric()
    assert brick((1, 1, 1), material=rubber, cell="tetrahedron", degree=2).model.degree == 2
    mesh = fl.mesh.parametric_volume(lambda a, b, c: (a, b, c), (2, 1, 1), cell="tetrahedron")
    assert (
        fl.Solid(mesh, fl.sections.NeoHooke(1.0, 0.45)).model.formulation
        == fl.elements.Isoparametric()
    )


# --- closed forms ---


def test_a_moment_rolls_a_bar_to_a_circle():
    """By a patch of its end, ``M = 2π EI/ℓ``: the end comes back to the clamp."""
    length, width = 10.0, 0.2
    bar = brick(
        (24, 1, 1), (length, width, width), fl.sections.SaintVenantKirchhoff(1e6, 0.0), degree=2
    )
    bar.clamp("a=0")
    scene, end = scene_of(bar), bar.point("a=1")
    moment = 2 * np.pi * 1e6 * width**4 / 12 / length
    scene.add(fl.PointLoad(end, moment=(0, -moment, 0)))
    found = fl.statics(scene, load_steps=10)
    np.testing.assert_allclose(found.displacement(end)[-1], (-length, 0, 0), atol=0.005 * length)
    np.testing.assert_allclose(found.rotation(end)[-1], np.eye(3), atol=0.02)


def test_a_bar_is_twisted():
    """Saint-Venant's torsion of a square, ``0.1406 G b⁴``; one end is free to warp."""
    bar = brick((4, 4, 16), (1.0, 1.0, 5.0), fl.sections.NeoHooke(1e6, 0.3), degree=2)
    bar.clamp("c=0")
    scene, top = scene_of(bar), bar.point("c=1")
    stiffness = 0.1406 * 1e6 / 2.6 / 5.0
    scene.add(fl.PointLoad(top, moment=(0, 0, 0.05 * stiffness)))
    turned = fl.statics(scene).rotation(top)[-1]
    assert np.arctan2(turned[1, 0], turned[0, 0]) == pytest.approx(0.05, rel=5e-3)


def test_rubber_swells_without_locking():
    """A thick tube, nearly incompressible, under pressure within: plane strain, one quarter.

    ``u = p a² b² / (2 μ (b² − a²) r)`` for small strains.
    """
    a, b, pressure = 1.0, 2.0, 1e-4
    material = fl.sections.NeoHooke(3 * (1 - 1e-5), 0.5 - 5e-6)

    def position(r, angle, c):
        radius, turn = a + (b - a) * r, 0.5 * np.pi * angle
        return radius * np.cos(turn), radius * np.sin(turn), 0.1 * c

    found = {}
    for formulation in (fl.elements.MeanDilatation(), fl.elements.Isoparametric()):
        tube = fl.Solid(
            fl.mesh.parametric_volume(position, (10, 16, 1)), material, formulation=formulation
        )
        for part, normal in (("b=0", (0, 1, 0)), ("b=1", (1, 0, 0)), ("c=0", (0, 0, 1))):
            tube.roller(part, normal)
        tube.roller("c=1", (0, 0, 1))
        scene = scene_of(tube)
        scene.add(fl.loads.FacePressure(tube, "a=0", pressure))
        inner = tube.point((a, 0, 0))
        found[formulation] = fl.statics(scene).displacement(inner)[-1, 0]
    μ = material.parameters[1]
    exact = pressure * a * b**2 / (2 * μ * (b**2 - a**2))
    assert found[fl.elements.MeanDilatation()] == pytest.approx(exact, rel=1e-2)
    assert found[fl.elements.Isoparametric()] < 0.2 * exact
