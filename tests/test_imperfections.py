"""Amplitudes of imperfections and branches are displacements, in any scene and any units."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

LENGTHS = {"m": 1.0, "µm": 1e6, "km": 1e-3}


def column(cells: int, *, length: float = 1.0, far: bool = False):
    """Pinned at both ends under Euler's load; perhaps with a clamped body ten lengths away."""
    stiff = 1e6 * np.array([1, 1, 1, 1e-2 * length**2, 1e-6 * length**2, 1e-2 * length**2])
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight(
            (0, 0, 0),
            (0, 0, length),
            fl.Section.from_stiffness(stiff),
            cells=cells,
            up=(1, 0, 0),
            name="column",
        )
    )
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.InPlane(fl.ground(), beam.point("end"), axis=(1, 0, 0)))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, -(np.pi**2))))
    if far:
        other = scene.add(fl.RigidBody(1.0, 3 * [length**2], position=(10 * length, 0, 0)))
        scene.add(fl.Clamp(other.point("centre")))
    return scene, beam


def amplitude(perfect: fl.Scene, other: fl.Scene) -> float:
    """Largest displacement of all nodes."""
    moved = [
        np.linalg.norm(b.frames[:, 0] - a.frames[:, 0], axis=1).max()
        for a, b in zip(perfect.bodies, other.bodies, strict=True)
    ]
    return max(moved)


@pytest.mark.parametrize("unit", LENGTHS)
@pytest.mark.parametrize("far", [False, True], ids=["alone", "beside another"])
def test_amplitude_of_a_mode_is_the_displacement_on_the_nodes(far, unit):
    length = 1.0 / LENGTHS[unit]
    scene, _ = column(28, length=length, far=far)
    modes = fl.buckling(scene, 7)
    np.testing.assert_allclose(modes.factors, np.arange(1, 8) ** 2, rtol=0.04)
    assert not modes.rotation_only.any()
    for mode in (1, 4, 7):
        wanted = 1e-3 * length
        other = fl.stability.apply_imperfections(
            scene, fl.stability.ModeImperfection(modes, mode, wanted)
        )
        assert amplitude(scene, other) == pytest.approx(wanted, rel=1e-10)


def plate(waves: int, cells: int) -> fl.Scene:
    """A strip of so many buckles, simply supported, pushed along."""
    t, nu = 0.01, 0.3
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (waves * a, b, 0.0), (cells * waves, cells)),
        fl.ShellSection.layer(t, fl.Material(1.0, nu, 1.0)),
        name="plate",
    )
    for name in ("a=0", "a=1", "b=0", "b=1"):
        shell.model.held[[p.node for p in shell.points(name)], 2] = True
    shell.model.held[[p.node for p in shell.points("a=0")], 0] = True
    shell.model.held[shell.point("00").node, 1] = True
    scene = fl.Scene()
    scene.add(shell)
    bryan = 4 * np.pi**2 * t**3 / (12 * (1 - nu**2))
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(-bryan, 0, 0)))
    return scene


def test_amplitude_of_short_buckles_of_a_shell_is_the_displacement_on_the_nodes():
    scene = plate(8, 5)
    modes = fl.buckling(scene, 1)
    other = fl.stability.apply_imperfections(scene, fl.stability.ModeImperfection(modes, 1, 0.02))
    assert amplitude(scene, other) == pytest.approx(0.02, rel=1e-10)
    # the normals are those of the surface that the nodes lie on
    (shell,) = other.bodies
    x, normals = shell.frames[:, 0].reshape(41, 6, 3), shell.frames[:, 3].reshape(41, 6, 3)
    along, across = x[2:, 1:-1] - x[:-2, 1:-1], x[1:-1, 2:] - x[1:-1, :-2]
    expected = np.cross(along, across)
    expected /= np.linalg.norm(expected, axis=-1)[..., np.newaxis]
    tilt = np.abs(expected[..., :2]).max()
    assert tilt > 0.04
    # secants over two cells of a wave of five
    np.testing.assert_allclose(normals[1:-1, 1:-1], expected, atol=0.35 * tilt)
    assert np.sum(normals[1:-1, 1:-1, :2] * expected[..., :2]) > 0


@pytest.mark.parametrize("cells", [14, 28, 56])
def test_directors_turn_with_the_axis_of_an_imperfect_beam(cells):
    """The tangent of the curve that the nodes lie on, to second order, and signs with it."""
    scene, _ = column(cells)
    other = fl.stability.apply_imperfections(
        scene, fl.stability.ModeImperfection(fl.buckling(scene, 2), 2, 0.005)
    )
    H = other.bodies[0].frames
    secants = H[2:, 0] - H[:-2, 0]
    secants /= np.linalg.norm(secants, axis=1)[:, np.newaxis]
    slope = np.abs(secants[:, 0]).max()
    assert slope > 0.03
    step = 2 * np.pi / cells
    np.testing.assert_allclose(H[1:-1, 1], secants, atol=0.5 * step**2 * slope)
    steep = np.abs(secants[:, 0]) > 0.5 * slope
    assert np.all(H[1:-1, 1, 0][steep] * secants[steep, 0] > 0)


def kinked(up=(0, 1, 0)):
    """A frame with a corner, clamped at its foot, and a rigid body linked to its end."""
    section = fl.Section.from_stiffness([1e6, 1e6, 1e6, 1e2, 1, 1e2])
    points = [(0, 0, k / 6) for k in range(7)] + [(k / 6, 0, 1) for k in range(1, 7)]
    mesh = fl.mesh.LineMesh.from_cells(points, [(k, k + 1) for k in range(12)])
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, section, up=up, name="frame"))
    block = scene.add(fl.RigidBody(1.0, 3 * [0.01], position=(1.1, 0.2, 1.0), name="block"))
    scene.add(fl.Clamp(beam.point(0)))
    scene.add(fl.joints.RigidLink(beam.point(12), block.point("centre")))
    scene.add(fl.PointLoad(beam.point(12), force=(0, 0, -1.0)))
    return scene, beam


@pytest.mark.parametrize("imperfection", ["mode", "field"])
def test_what_follows_an_imperfect_node_goes_with_it(imperfection):
    """Other directions at a corner: the same position, and turned as much."""
    scene, beam = kinked()
    given: fl.stability.Imperfection = fl.stability.FieldImperfection(
        lambda x: (0.05 * x[2] ** 2, 0.0, 0.0)
    )
    if imperfection == "mode":
        given = fl.stability.ModeImperfection(fl.buckling(scene, 1), 1, 0.05)
    frames = fl.stability.apply_imperfections(scene, given).bodies[0].frames
    (attached,) = np.nonzero(beam.model.masters != np.arange(len(beam.frames)))
    assert len(attached) == 1
    masters = beam.model.masters[attached]
    moved = np.linalg.norm(frames[masters, 0] - beam.frames[masters, 0])
    assert moved > 0.02
    before, after = (
        lie.se3_compose(lie.se3_inverse(H[masters]), H[attached]) for H in (beam.frames, frames)
    )
    np.testing.assert_allclose(after, before, atol=1e-14)
    assert np.abs(frames[attached, 1:] - beam.frames[attached, 1:]).max() > 0.02
    if imperfection == "mode":
        return
    # the column leans as it rises
    middle = np.flatnonzero(np.abs(beam.frames[:, 0] - [0, 0, 0.5]).max(axis=1) < 1e-9)
    assert frames[middle, 0, 0] * frames[middle, 1, 0] > 0


def topheavy(length: float = 1.0):
    """A shaft whose mass lies above its axis, which bearings hold: under gravity it tips over."""
    GJ, mass, height = 3.0 * length**2, 2.0, 0.1 * length
    mass_matrix = mass * np.diag([1.0, 0.0, 1e-3 * length**2, 0.0])
    mass_matrix[0, 3] = mass_matrix[3, 0] = mass * height
    mass_matrix[3, 3] = mass * (height**2 + 1e-3 * length**2)
    stiff = [1e4, 1e4, 1e4, GJ, 1e3 * length**2, 1e3 * length**2]
    section = fl.Section.from_stiffness(stiff, mass_matrix)
    # GJ (π/2L)² = m g h
    scene = fl.Scene(gravity=(0, 0, -GJ * (np.pi / 2 / length) ** 2 / (mass * height)))
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (length, 0, 0), section, cells=20, up=(0, 0, 1), name="shaft")
    )
    beam.model.held[:, 1:3] = True
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(1.0, 0, 0)))
    return scene, beam


@pytest.mark.parametrize("unit", LENGTHS)
def test_a_mode_that_only_turns_is_one_of_its_own(unit):
    scene, beam = topheavy(1.0 / LENGTHS[unit])
    modes = fl.buckling(scene, 1)
    assert modes.factors[0] == pytest.approx(1.0, rel=2e-3)
    assert modes.rotation_only.tolist() == [True]
    assert "rotations only" in str(modes)
    assert np.linalg.norm(modes.shape(1)[:, 3:], axis=1).max() == pytest.approx(1.0)
    with pytest.raises(ValueError, match="only turns: give angle="):
        fl.stability.ModeImperfection(modes, 1, 1e-3)
    other = fl.stability.apply_imperfections(
        scene, fl.stability.ModeImperfection(modes, 1, angle=0.01)
    ).bodies[0]
    turns = lie.so3_log(lie.rotation(beam.frames).transpose(0, 2, 1) @ lie.rotation(other.frames))
    assert np.linalg.norm(turns, axis=1).max() == pytest.approx(0.01, rel=1e-10)
    (point,) = fl.follow_path(scene, 1.1).critical
    assert point.rotation_only[0]
    with pytest.raises(ValueError, match="mode 1 has rotations only"):
        fl.stability.switch_branch(scene, point)
    with pytest.raises(ValueError, match="mode 1 has rotations only"):
        point.moved(1, 0.1)


def test_amplitude_and_angle_exclude_each_other():
    modes = fl.buckling(column(8)[0], 1)
    for bad in ({}, {"angle": 0.1}, {"amplitude": 0.1, "angle": 0.1}):
        with pytest.raises(ValueError, match="has displacements: give amplitude="):
            fl.stability.ModeImperfection(modes, 1, **bad)
    with pytest.raises(ValueError, match="amplitude must be a finite number, got nan"):
        fl.stability.ModeImperfection(modes, 1, amplitude=np.nan)


@pytest.mark.parametrize("unit", LENGTHS)
@pytest.mark.parametrize("far", [False, True], ids=["alone", "beside another"])
def test_amplitude_of_a_branch_is_the_displacement_on_the_nodes(far, unit):
    """Short waves: the third mode, which the first two are kept from by a support each."""
    length = 1.0 / LENGTHS[unit]
    scene, beam = column(24, length=length, far=far)
    for node in (8, 16):
        scene.add(
            fl.joints.InPlane(
                fl.ground(), beam.point(node), at=beam.point(node).position, axis=(1, 0, 0)
            )
        )
    point = fl.follow_path(scene, fl.stability.PathEnds(9.5, critical_points=1)).critical[0]
    wanted = 2e-3 * length
    moved = {}
    for given in (None, wanted):
        station = fl.stability.switch_branch(scene, point, amplitude=given)
        path = fl.follow_path(scene, fl.stability.PathEnds(9.6, steps=1), start=station)
        u = path.frames[0][:, 0] - point.frames[:, 0]
        moved[given] = np.abs(u[:, 0]).max()
    assert moved[wanted] == pytest.approx(wanted, rel=1e-4)
    # what it takes by itself does not depend on the size of the scene
    assert moved[None] == pytest.approx(1 / 60 / (3 * np.pi) * length, rel=1e-2)
    shape = np.einsum("nij,ni->nj", point.frames[:, 1:], point.shapes[0][:, :3])
    beside = point.moved(1, wanted)[:, 0] - point.frames[:, 0]
    # along a screw, of second order in the rotation
    np.testing.assert_allclose(beside, wanted * shape, atol=1e-2 * wanted)


def test_critical_points_know_where_points_are():
    """Nodes of the system are in another order than those of a body."""
    scene, beam = column(12)
    points = [beam.point("start"), beam.point(5), beam.point("end"), "column.end"]
    path = fl.follow_path(scene, fl.stability.PathEnds(1.1, critical_points=1))
    (point,) = path.critical
    for where in points:
        np.testing.assert_array_equal(point.position(where), path.position(where)[point.index])
        np.testing.assert_array_equal(
            point.displacement(where), path.displacement(where)[point.index]
        )
        np.testing.assert_array_equal(point.rotation(where), path.rotation(where)[point.index])
    assert point.position(beam.point(5))[2] == pytest.approx(5 / 12, abs=1e-4)
