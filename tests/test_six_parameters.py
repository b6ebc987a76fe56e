"""Six-parameter shells in scenes: drilling, joints, links, beams, kinks and branches."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from tests.assembled import Assembled

SOFT = fl.Material(100.0, 0.3, 2.0)
LAYER = fl.ShellSection.layer(0.1, SOFT)
BAR = fl.Section.rectangle(0.1, 0.15, SOFT)


def fold(a: float, b: float) -> tuple[float, float, float]:
    """A strip of length 1.5 and width 1 that is bent up by 90° after two thirds."""
    return (min(2 * a, 1.0), b, 0.5 * max(2 * a - 1.0, 0.0))


def flat(a: float, b: float) -> tuple[float, float, float]:
    return (2.0 * a, b, 0.0)


def folded(cells=(4, 2), **options) -> fl.Shell:
    return fl.Shell(fl.mesh.parametric_surface(fold, cells), LAYER, name="fold", **options)


def scene_with(*items) -> fl.Scene:
    scene = fl.Scene()
    for item in items:
        scene.add(item)
    return scene


def nearest(shell: fl.Shell, position) -> fl.extend.Point:
    return shell.point(int(np.linalg.norm(shell.model.mesh.points - position, axis=1).argmin()))


def machine(*, clamped: bool, links: bool = True, loaded: bool = False) -> fl.Scene:
    """A folded plate, a beam on its middle and a rigid body at a corner."""
    shell = folded()
    plain = fl.elements.GeodesicBeam(
        bending_flexibility=False
    )  # Newton without the carried stress converges
    ends = (0.5, 0.5, 0), (0.5, 0.5, 1)
    beam = fl.Beam.straight(*ends, BAR, cells=2, formulation=plain, name="beam")
    ball = fl.RigidBody(0.1, 0.01 * np.eye(3), position=(1.2, 0.0, 0.6), name="ball")
    scene = scene_with(shell, beam, ball)
    middle = nearest(shell, [0.5, 0.5, 0])
    if links:
        scene.add(fl.joints.RigidLink(beam.point("start"), middle))  # the beam leads
        scene.add(fl.joints.RigidLink(shell.point("10"), ball.point("centre")))
    else:
        scene.add(fl.joints.Fixed(beam.point("start"), middle))
        scene.add(fl.joints.Fixed(shell.point("10"), ball.point("centre"), at=(1.2, 0, 0.6)))
    if clamped:
        shell.clamp("a=0")
    if loaded:
        scene.add(fl.PointLoad(beam.point("end"), (0.002, 0.001, -0.001), (2e-4, 2e-4, 5e-4)))
        scene.add(fl.PointLoad(shell.point("11"), (0.002, 0.001, -0.001), (1e-3, 2e-3, 1e-3)))
    return scene


# --- nodes and patches ---


def test_both_sides_of_a_kink_have_directors_of_their_own():
    shell = folded()
    assert shell.model.has_drilling()
    assert len(shell.frames) == len(shell.model.mesh.points) + 3
    at = np.flatnonzero(np.abs(shell.frames[:, 0, 0] - 1) + shell.frames[:, 0, 2] < 1e-12)
    directors = np.unique(np.round(shell.frames[at, 3], 12), axis=0)
    np.testing.assert_allclose(directors, [[-1, 0, 0], [0, 0, 1]], atol=1e-12)
    # a fold of less than the angle is smooth
    smooth = folded(kink_angle=np.pi / 1.9)
    assert len(smooth.frames) == len(smooth.model.mesh.points) and not smooth.model.has_drilling()


def tee(cell="quadrilateral") -> fl.mesh.SurfaceMesh:
    """A flange in the plane of x and y, a web below its middle; four cells along y."""
    y = np.linspace(0, 1, 5)
    x = [(a, b, 0) for b in y for a in (-0.5, 0, 0.5)] + [(0, b, -0.5) for b in y]
    cells = []
    for i in range(4):
        for left, right in ((0, 1), (1, 2)):
            cells.append([3 * i + left, 3 * i + right, 3 * i + 3 + left, 3 * i + 3 + right])
        cells.append([3 * i + 1, 15 + i, 3 * i + 4, 16 + i])
    root = [(0, 1), (1, 2), (1, 15)]
    if cell == "triangle":
        cells = [c for q in cells for c in (np.array(q)[[0, 1, 3]], np.array(q)[[0, 3, 2]])]
    return fl.mesh.SurfaceMesh.from_cells(
        x, cells, cell, curves={"root": root}, named_points={"end": [13], "foot": [19]}
    )


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
def test_a_flange_continues_through_the_branch(cell):
    shell = fl.Shell(tee(cell), LAYER)
    assert shell.model.has_drilling()
    assert len(shell.frames) == 20 + 5  # the web has nodes of its own along the branch
    joint = np.abs(shell.frames[:, 0, [0, 2]]).max(axis=1) < 1e-12
    np.testing.assert_allclose(np.abs(shell.frames[joint, 3].sum(axis=0)), [5, 0, 5], atol=1e-12)
    np.testing.assert_array_equal(shell.model.mesh.nodes("root"), [0, 1, 2, 15])


def test_flipped_cells_are_refused_on_smooth_sides_only():
    mesh = fl.mesh.parametric_surface(fold, (2, 1))
    cells = mesh.cells.copy()
    cells[1] = cells[1][[1, 0, 3, 2]]
    shell = fl.Shell(fl.mesh.SurfaceMesh.from_cells(mesh.points, cells, "quadrilateral"), LAYER)
    assert len(shell.frames) == len(mesh.points) + 2
    with pytest.raises(ValueError, match="opposite sides"):
        fl.Shell(shell.model.mesh, LAYER, kink_angle=np.pi / 1.9)


def test_automatic_is_five_until_something_takes_hold_of_a_rotation():
    def drills(item_of_shell, **options):
        shell = fl.Shell(fl.mesh.parametric_surface(flat, (2, 1)), LAYER, **options)
        return scene_with(shell, item_of_shell(shell)).has_drilling(shell)

    assert not drills(lambda s: fl.PointLoad(s.point("00"), force=(1, 2, 3)))
    assert not drills(lambda s: fl.joints.Spherical(s.point("00"), fl.ground()))
    assert not drills(lambda s: fl.joints.InPlane(fl.ground(), s.point("00")))
    assert not drills(lambda s: fl.PointLoad(s.point("00"), moment=(1, 2, 0)), drilling=False)
    assert drills(lambda s: fl.PointLoad(s.point("00"), moment=(1, 2, 0)))
    assert drills(
        lambda s: fl.joints.InPlane(s.point("00"), fl.ground())
    )  # its axis turns with the node
    assert drills(lambda s: fl.joints.Spherical(s.point("00"), fl.ground(), at=(1, 1, 1)))
    assert drills(lambda s: fl.joints.Revolute(s.point("00"), fl.ground()))
    assert drills(lambda s: fl.PointLoad(s.point("00"), force=(1, 2, 3)), drilling=True)


# --- equations ---


def test_rigid_motion_of_kink_and_links_costs_nothing_and_turns_forces():
    of = Assembled(machine(clamped=False), dynamics=False)
    n, rng = of.count, np.random.default_rng(2)
    motion = lie.se3_exp(np.array([0.3, -0.2, 0.5, 1.0, -2.0, 0.7]))
    stiffness = np.abs(of.matrix(of.start)).max()

    def everywhere(H):
        found = of.start.copy()
        found[:n] = H
        return found

    unloaded = of.start[:n]
    carried = everywhere(lie.se3_compose(motion, unloaded))
    assert np.abs(of.residual(carried)).max() <= 1e-13 * stiffness
    assert abs(of.equations.report(carried).elastic) <= 1e-13 * stiffness
    bent = lie.se3_retract(unloaded, 0.1 * rng.normal(size=(n, 6)))
    r = of.residual(everywhere(bent))
    assert np.abs(r).max() > 0.01
    # in local frames they do not turn at all
    turned = of.residual(everywhere(lie.se3_compose(motion, bent)))
    np.testing.assert_allclose(turned, r, atol=1e-12 * stiffness)


def test_links_and_fixed_joints_are_the_same():
    states = [
        fl.statics(machine(clamped=True, links=links, loaded=True)).position("beam.end")[-1]
        for links in (True, False)
    ]
    assert np.linalg.norm(states[0] - [0.5, 0.5, 1]) > 0.1
    np.testing.assert_allclose(states[0], states[1], atol=1e-9)


# --- drilling ---


def hemisphere(drilling, *, scale=1.0, cell="quadrilateral", degree=1, cells=16):
    """Deflections of the pinched hemisphere with an 18° hole, t = 0.04, P = 400."""

    def position(a, b):
        azimuth, height = a * np.pi / 2, b * np.radians(72)
        return 10 * np.array(
            [np.cos(height) * np.cos(azimuth), np.cos(height) * np.sin(azimuth), np.sin(height)]
        )

    shell = fl.Shell(
        fl.mesh.parametric_surface(position, (cells, cells), cell=cell, degree=degree),
        fl.ShellSection.layer(0.04, fl.Material(6.825e7, 0.3, 1.0)),
        director=lambda x: x / 10,
        formulation=fl.elements.HellingerReissner()
        if degree == 1
        else fl.elements.DisplacementBased(),
        drilling=drilling,
    )
    default = shell.model.drilling_stiffness
    shell.model.drilling_stiffness = lambda holds: scale * default(holds)
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (1, 0, 0))
    shell.roller("00", (0, 0, 1))
    loads = [
        fl.PointLoad(shell.point("00"), force=(200, 0, 0)),
        fl.PointLoad(shell.point("10"), force=(0, -200, 0)),
    ]
    result = fl.follow_loads(scene_with(shell, *loads))
    assert result.total_iterations <= 18
    return [
        result.position(f"{shell.name}.00")[-1, 0] - 10,
        10 - result.position(f"{shell.name}.10")[-1, 1],
    ]


def test_six_parameters_are_five_over_ten_decades_of_the_drilling_stiffness():
    """The default is right to 1e-5, and a hundred times more of it to 5e-4."""
    five = hemisphere(False)
    for scale in (1.0, 1e-2, 1e-4, 1e-6, 1e-8):
        np.testing.assert_allclose(hemisphere(True, scale=scale), five, rtol=1e-5)
    np.testing.assert_allclose(hemisphere(True, scale=10.0), five, rtol=1e-4)
    np.testing.assert_allclose(hemisphere(True, scale=100.0), five, rtol=1e-3)


@pytest.mark.parametrize(
    ("cell", "degree", "cells"), [("triangle", 1, 16), ("triangle", 2, 8), ("quadrilateral", 2, 8)]
)
def test_six_parameters_are_five_on_all_cells(cell, degree, cells):
    five, six = (hemisphere(p, cell=cell, degree=degree, cells=cells) for p in (False, True))
    np.testing.assert_allclose(six, five, rtol=1e-5)


@pytest.mark.parametrize("t", [0.1, 0.001])
def test_moment_at_a_node_meets_a_patch_of_the_size_of_the_cells(t):
    """``M = 4π G t r² φ`` of a rigid disc of radius r in a large plate; r is 0.27 cells."""
    n = 8
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (n, n)),
        fl.ShellSection.layer(t, fl.Material(2.6, 0.3, 1.0)),
    )
    for edge in ("a=0", "a=1", "b=0", "b=1"):
        shell.clamp(edge)
    middle = nearest(shell, [0.5, 0.5, 0])
    moment = 1e-3 * t / n**2
    result = fl.statics(scene_with(shell, fl.PointLoad(middle, moment=(0, 0, moment))))
    turned = lie.so3_log(middle.frame[1:] @ result.rotation(middle)[-1])[2]
    radius = np.sqrt(moment / (4 * np.pi * t * turned))
    assert radius * n == pytest.approx(0.27, abs=0.02)


def test_plate_follows_a_motor_that_spins_about_its_normal():
    """A prescribed motion turns its middle by a right angle; nothing resists."""
    shell = fl.Shell(fl.mesh.parametric_surface(flat, (4, 2)), LAYER, name="plate")
    middle = nearest(shell, [1, 0.5, 0])
    start = middle.frame.copy()

    def motion(time):
        H = start.copy()
        H[1:] = start[1:] @ lie.so3_exp(np.array([0, 0, time * np.pi / 2])).T
        return H

    result = fl.statics(scene_with(shell, fl.PrescribedMotion(middle, motion)), load_steps=4)
    corner = result.position("plate.11")[-1]
    np.testing.assert_allclose(corner, [1 - 0.5, 0.5 + 1, 0], atol=1e-9)


# --- kinks, branches, links ---


def parts_of(mesh: fl.mesh.SurfaceMesh, groups) -> list[fl.Shell]:
    shells = []
    for cells in groups:
        used, local = np.unique(mesh.cells[cells], return_inverse=True)
        part = fl.mesh.SurfaceMesh.from_cells(
            mesh.points[used], local.reshape(-1, mesh.cells.shape[1]), mesh.cell
        )
        shells.append(fl.Shell(part, LAYER, drilling=True))
    return shells


@pytest.mark.parametrize(
    "mesh", [fl.mesh.parametric_surface(fold, (4, 2)), tee()], ids=["kink", "branch"]
)
def test_one_mesh_is_its_parts_with_rigid_links(mesh):
    middle = mesh.points[mesh.cells].mean(axis=1)
    upright = middle[:, 2] > 1e-9 if middle[:, 2].max() > 0 else middle[:, 2] < -1e-9
    whole = fl.Shell(mesh, LAYER, name="whole")
    clamped = {p for p in range(len(mesh.points)) if mesh.points[p, 1] < 1e-9}
    far = nearest(whole, [1, 1, 0.5] if middle[:, 2].max() > 0 else [0, 1, -0.5])
    force = (0.01, 0.02, 0.005)
    scene = scene_with(whole, fl.PointLoad(far, force=force))
    for p in clamped:
        scene.add(fl.Clamp(whole.point(p)))
    one = fl.follow_loads(scene).position(far)[-1]

    parts = parts_of(mesh, [np.flatnonzero(~upright), np.flatnonzero(upright)])
    scene = scene_with(*parts)
    for i, x in enumerate(parts[0].frames[:, 0]):
        gap = np.linalg.norm(parts[1].frames[:, 0] - x, axis=1)
        if gap.min() < 1e-9:
            scene.add(fl.joints.RigidLink(parts[0].point(i), parts[1].point(int(gap.argmin()))))
    for part in parts:
        for i in np.flatnonzero(part.frames[:, 0, 1] < 1e-9):
            scene.add(fl.Clamp(part.point(int(i))))
    point = nearest(parts[1], far.position)
    # where one thing holds many nodes there is no patch about each
    for part in parts:
        part.model.drilling_stiffness = lambda holds, own=part.model.drilling_stiffness: own(())
    scene.add(fl.PointLoad(point, force=force))
    two = fl.follow_loads(scene).position(point)[-1]
    assert np.linalg.norm(one - far.position) > 0.05
    np.testing.assert_allclose(two, one, atol=1e-8)


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
def test_bent_frame_of_plates_is_that_of_beams(cell):
    """Two strips at a right angle without Poisson's ratio, in their plane, through 1.6 %.

    Linear theory: tip ``F (ℓ³/EI) (1 + 1/3)`` along x, ``−F ℓ³/2EI`` along z; the beams are exact.
    """
    steel, b, t = fl.Material(1e9, 0.0, 1000.0), 0.1, 0.01

    def position(a, c):
        return (min(2 * a, 1.0), (c - 0.5) * b, max(2 * a - 1.0, 0.0))

    shell = fl.Shell(
        fl.mesh.parametric_surface(position, (20, 2), cell=cell),
        fl.ShellSection.layer(t, steel),
        name="frame",
    )
    shell.clamp("a=0")
    load = fl.loads.EdgeLoad(shell, "a=1", force=(0.1 / b, 0, 0))
    tip = nearest(shell, [1, 0, 1])
    found = fl.follow_loads(scene_with(shell, load)).position(tip)[-1] - [1, 0, 1]

    x = [(i / 10, 0, 0) for i in range(11)] + [(1, 0, i / 10) for i in range(1, 11)]
    lines = fl.mesh.LineMesh.from_cells(
        x,
        [(i, i + 1) for i in range(20)],
        groups={"x": range(10), "z": range(10, 20)},
        named_points={"root": [0], "tip": [20]},
    )
    up = {"x": (0, 0, 1), "z": (-1, 0, 0)}
    beam = fl.Beam(lines, fl.Section.rectangle(b, t, steel), up=up, name="beam")
    frame = scene_with(
        beam, fl.Clamp(beam.point("root")), fl.PointLoad(beam.point("tip"), force=(0.1, 0, 0))
    )
    wanted = fl.follow_loads(frame).position("beam.tip")[-1] - [1, 0, 1]
    assert wanted[0] == pytest.approx(0.0159, rel=0.01)
    # triangles are not symmetric across the strip
    np.testing.assert_allclose(found, wanted, rtol=2e-3, atol=5e-6)


def test_a_strip_continues_as_a_beam():
    """A shell welded to a beam of the same section through a rigid cross piece, bent and twisted.

    Without Poisson's ratio; the strip's warping is held at both ends, which makes it stiffer in
    torsion: that load is compared with a strip alone by the other test, here it is bending only.
    """
    steel, b, t = fl.Material(1e9, 0.0, 1000.0), 0.1, 0.01
    section = fl.Section.rectangle(b, t, steel)
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, c: (a, (c - 0.5) * b, 0.0), (10, 2)),
        fl.ShellSection.layer(t, steel),
    )
    shell.clamp("a=0")
    beam = fl.Beam.straight((1, 0, 0), (2, 0, 0), section, up=(0, 0, 1), cells=5, name="beam")
    scene = scene_with(shell, beam, fl.PointLoad(beam.point("end"), force=(0, 0.3, 0.1)))
    for point in shell.points("a=1"):
        scene.add(fl.joints.RigidLink(beam.point("start"), point))
    whole = fl.Beam.straight((0, 0, 0), (2, 0, 0), section, up=(0, 0, 1), cells=20, name="whole")
    alone = scene_with(
        whole, fl.Clamp(whole.point("start")), fl.PointLoad(whole.point("end"), force=(0, 0.3, 0.1))
    )
    found = fl.follow_loads(scene).position("beam.end")[-1] - [2, 0, 0]
    wanted = fl.follow_loads(alone).position("whole.end")[-1] - [2, 0, 0]
    assert abs(wanted[2]) > 0.03
    np.testing.assert_allclose(found[1:], wanted[1:], rtol=0.01)


def test_supports_hold_all_sides_of_a_kink():
    """Half a folded plate with a plane of symmetry across the fold is half of the whole."""

    def tip(whole):
        reach = 1.0 if whole else 0.5
        position = lambda a, b: fold(a, reach * b)  # noqa: E731
        shell = fl.Shell(
            fl.mesh.parametric_surface(position, (4, 4 if whole else 2)), LAYER, name="fold"
        )
        shell.clamp("a=0")
        scene = scene_with(shell)
        if not whole:
            shell.symmetry("b=1", (0, 1, 0))
        for name in ("10", "11") if whole else ("10",):
            scene.add(fl.PointLoad(shell.point(name), force=(0.005, 0, -0.01)))
        return fl.follow_loads(scene).position("fold.10")[-1]

    assert np.linalg.norm(tip(True) - [1, 0, 0.5]) > 0.05
    np.testing.assert_allclose(tip(True), tip(False), atol=1e-8)


def test_hinge_along_a_kink_lets_both_sides_turn_together():
    def turned(*curves):
        mesh = fl.mesh.parametric_surface(fold, (4, 2))
        edge = np.flatnonzero(np.abs(mesh.points[:, 0] - 1) + mesh.points[:, 2] < 1e-12)
        mesh = fl.mesh.SurfaceMesh.from_cells(
            mesh.points, mesh.cells, mesh.cell, curves={"kink": np.stack([edge[:-1], edge[1:]], 1)}
        )
        shell = fl.Shell(mesh, LAYER)
        for curve in curves:
            getattr(shell, curve)("kink")
        scene = scene_with(shell, fl.PointLoad(nearest(shell, [1, 0, 0.5]), force=(1e-3, 0, 0)))
        if curves == ("hinge",):
            for point in (nearest(shell, [0, 0, 0]), nearest(shell, [0, 1, 0])):
                scene.add(fl.joints.InPlane(fl.ground(), point))
        result = fl.statics(scene)
        nodes = result.info.body(shell.name).nodes
        return np.linalg.norm(result.frames[-1][nodes, 0] - shell.frames[:, 0], axis=1), shell

    moved, shell = turned("hinge")
    flat_side = shell.frames[:, 0, 0] < 0.9
    assert moved[flat_side].max() > 1e-3
    moved, shell = turned("clamp")
    assert moved[flat_side].max() < 1e-12 and moved.max() > 1e-3


def test_supports_of_a_node_that_follows_are_those_of_its_master():
    shell = folded()
    shell.clamp("a=0")
    beam = fl.Beam.straight((0, 0, 0), (0, 0, 1), BAR, cells=1)
    scene = scene_with(beam, shell, fl.joints.RigidLink(beam.point("start"), shell.point("00")))
    unknowns = fl.extend.Equations(scene, dynamics=False).unknowns
    (row,) = np.flatnonzero(unknowns.masters == unknowns.bodies[beam][0])
    assert unknowns.held[row].all()
    hinged = folded()
    hinged.hinge("a=0")
    aside = fl.Beam.straight((0, 0, 1), (0, 0, 2), BAR, cells=1)
    scene = scene_with(aside, hinged, fl.joints.RigidLink(aside.point("start"), hinged.point("00")))
    with pytest.raises(ValueError, match="supports and is attached by a rigid link"):
        fl.extend.Equations(scene, dynamics=False)


# --- dynamics ---


@pytest.mark.parametrize("links", [True, False])
def test_free_flight_of_shell_beam_and_body_keeps_momentum(links):
    scene = machine(clamped=False, links=links)
    for body in scene.bodies:
        body.add_velocity(omega=(0.2, 0.1, 0.3), about=(0, 0, 0))
        body.add_velocity((0.1, 0, 0))
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=2.0, step=0.02)
    # of second order in the step, as on beams; a third of a turn
    assert result.momentum_error <= 1e-5
    assert result.angular_momentum_error <= 5e-5
    assert result.energy_error <= 1e-4
    assert result.iterations[-1] <= 4 * len(result.times)
    assert result.factorisations <= 5


@pytest.mark.parametrize("options", [{"convected_axes": True}, {"drilling": True}])
def test_frames_that_follow_the_spin_keep_the_matrix(options):
    """A plate that tumbles fast: the motion is that of five parameters, the matrix is kept."""

    def run(**options):
        shell = fl.Shell(
            fl.mesh.parametric_surface(lambda a, b: (a - 0.5, 0.5 * (b - 0.5), 0.0), (4, 2)),
            fl.ShellSection.layer(0.02, fl.Material(1e9, 0.3, 1000.0)),
            **options,
            name="plate",
        )
        shell.add_velocity(omega=(20.0, 3.0, 10.0), about=(0, 0, 0))
        scheme = fl.GeneralisedAlpha(radius=0.9)
        return scheme.run(scene_with(shell), duration=0.5, step=0.002)

    five, other = run(drilling=False), run(**options)
    gap = five.position("plate.11") - other.position("plate.11")
    assert np.abs(gap).max() <= 1e-4  # both of second order in the step; 12 turns per time
    assert five.factorisations > 3 * other.factorisations
    assert five.iterations[-1] > 1.5 * other.iterations[-1]


def test_carried_frames_are_those_of_the_rigid_motion():
    """After a rigid motion in statics, which five parameters alone do not follow."""
    shell = fl.Shell(fl.mesh.parametric_surface(flat, (3, 2)), LAYER, convected_axes=True)
    equations = fl.extend.Equations(scene_with(shell), dynamics=False)
    n = equations.unknowns.moving
    motion = lie.se3_exp(np.array([0.1, 0.2, 0.3, 0.5, -0.4, 2.0]))
    moved = lie.se3_compose(motion, equations.start.frames)
    wrong = moved.copy()
    # a quarter of a turn ahead
    wrong[:n, 1], wrong[:n, 2] = moved[:n, 2], -moved[:n, 1]
    equations.history_variables.rotate_axes(wrong)
    np.testing.assert_allclose(wrong, moved, atol=1e-13)


def test_frequencies_of_six_parameters_are_those_of_five():
    """Drilling has no mass, and brings no modes."""

    def frequencies(drilling):
        shell = fl.Shell(
            fl.mesh.parametric_surface(lambda a, b: (a, 0.4 * b, 0.0), (8, 3)),
            fl.ShellSection.layer(0.01, fl.Material(1e6, 0.3, 10.0)),
            drilling=drilling,
        )
        shell.clamp("a=0")
        return np.abs(fl.vibrations(scene_with(shell), count=4).eigenvalues)

    five, six = (frequencies(p) for p in (False, True))
    np.testing.assert_allclose(six, five, rtol=1e-4)
