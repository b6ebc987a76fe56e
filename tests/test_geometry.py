"""Frames along lines: no twist where none is asked for, directions, pre-twist, taper, forks."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

import fem_lie as fl
from fem_lie import lie

FRAME = Path(__file__).parents[1] / "meshes" / "frame.geo"
SECTION = fl.Section.from_stiffness([1e4, 5e3, 4e3, 50.0, 100.0, 70.0])
PLANE = lie.so3_exp([0.3, -0.5, 0.7])


def successive(beam: fl.Beam) -> np.ndarray:
    """Relative motion of the ends of each element, shape (m, 6)."""
    a, b = beam.frames[beam.model.elements[:, :2]].transpose(1, 0, 2, 3)
    return lie.se3_relative(a, b)


def arc(angle: float, radius: float = 2.0):
    return lambda s: radius * PLANE @ [np.sin(angle * s), 1 - np.cos(angle * s), 0.0]


# --- frames without twist -------------------------------------------------------------------------


def test_frames_are_tangent_orthonormal_and_begin_nearest_to_z():
    beam = fl.Beam.curve(lambda s: (s, s**2, np.sin(s)), SECTION, cells=5)
    R = beam.frames[:, 1:]
    np.testing.assert_allclose(R @ R.transpose(0, 2, 1), np.tile(np.eye(3), (6, 1, 1)), atol=1e-15)
    s = np.linspace(0, 1, 6)
    along = np.column_stack([np.ones(6), 2 * s, np.cos(s)])
    tangent = along / np.linalg.norm(along, axis=1, keepdims=True)
    np.testing.assert_allclose(R[:, 0], tangent, atol=1e-11)
    # e₃ is z less its part along e₁
    e3 = np.array([0, 0, 1.0]) - tangent[0, 2] * tangent[0]
    np.testing.assert_allclose(R[0, 2], e3 / np.linalg.norm(e3), atol=1e-11)
    along_z = fl.Beam.straight((0, 0, 0), (0, 0, 1), SECTION, cells=1)
    np.testing.assert_allclose(along_z.frames[:, 3], [[1, 0, 0]] * 2, atol=1e-15)


@pytest.mark.parametrize("cells", [1, 3, 10])
def test_on_circles_they_do_not_twist_at_all_and_lengths_are_arcs(cells):
    """Double reflection is exact on circles, in a plane that has nothing to do with the axes."""
    beam = fl.Beam.curve(arc(2.5), SECTION, cells=cells)
    d = successive(beam)
    # tangents are differences: 1e-11
    np.testing.assert_allclose(d[:, 3], 0.0, atol=1e-10)
    np.testing.assert_allclose(np.linalg.norm(d[:, 3:], axis=1), 2.5 / cells, rtol=1e-10)
    np.testing.assert_allclose(beam.model.lengths, 5.0 / cells, rtol=1e-10)


def test_on_a_helix_they_turn_against_the_torsion_with_fourth_order():
    """Relative to Frenet's frame they turn by −∫τ ds = −c φ/√(r² + c²) (Bishop 1975)."""
    radius, climb, angle = 1.0, 0.4, 6.0
    errors = []
    for cells in (16, 32, 64):
        beam = fl.Beam.curve(
            lambda s: (radius * np.cos(angle * s), radius * np.sin(angle * s), climb * angle * s),
            SECTION,
            cells=cells,
        )
        turns = []
        for phi, frame in ((0.0, beam.frames[0]), (angle, beam.frames[cells])):
            normal = np.array([-np.cos(phi), -np.sin(phi), 0.0])
            binormal = np.cross(frame[1], normal)
            turns.append(np.arctan2(frame[2] @ binormal, frame[2] @ normal))
        exact = -climb * angle / np.hypot(radius, climb)
        errors.append(abs((turns[1] - turns[0] - exact + np.pi) % (2 * np.pi) - np.pi))
    assert errors[0] < 1e-3
    assert np.log2(np.array(errors[:-1]) / errors[1:]).min() > 3.8, errors


def closed(function, cells: int) -> fl.mesh.LineMesh:
    phi = 2 * np.pi * np.arange(cells) / cells
    pairs = np.column_stack([np.arange(cells), (np.arange(cells) + 1) % cells])
    return fl.mesh.LineMesh.from_cells(
        [function(p) for p in phi], pairs, kink_angle=np.radians(40.0)
    )


def test_a_closed_circle_closes_and_another_ring_has_one_step():
    """In a plane frames come back; in space they have turned, and one node more follows."""
    flat = fl.Beam(closed(lambda p: PLANE @ [np.cos(p), np.sin(p), 0], 12), SECTION)
    assert len(flat.frames) == 12
    np.testing.assert_allclose(flat.model.lengths.sum(), 2 * np.pi, rtol=1e-12)
    bent = closed(lambda p: [np.cos(p), np.sin(p), 0.3 * np.sin(2 * p) + 0.2 * np.cos(3 * p)], 48)
    ring = fl.Beam(bent, SECTION)
    assert len(ring.frames) == 49
    (follower,) = np.flatnonzero(ring.model.masters != np.arange(49))
    step = lie.se3_relative(ring.frames[ring.model.masters[follower]], ring.frames[follower])
    # about the tangent alone, and by a real angle
    assert abs(step[3]) > 0.01 and np.abs(np.delete(step, 3)).max() < 1e-9


# --- given directions -----------------------------------------------------------------------------


def test_up_is_nearest_to_e3_for_all_or_for_groups():
    mesh = fl.mesh.LineMesh.from_cells(
        [arc(2.0)(s) for s in np.linspace(0, 1, 9)],
        [(i, i + 1) for i in range(8)],
        groups={"first": [0, 1, 2], "second": [3, 4, 5]},
        kink_angle=np.radians(40.0),
    )
    up = {"first": (0.2, 1, 1), "second": (1, -1, 0.3)}
    beam = fl.Beam(mesh, SECTION, up=up)
    for group, direction in up.items():
        frames = beam.frames[beam.model.elements[mesh.group(group)]]
        np.testing.assert_allclose(frames[:, :, 2] @ direction, 0.0, atol=1e-14)
        assert (frames[:, :, 3] @ direction > 0).all()
    # two changes of direction at one tangent each: two nodes more
    assert beam.model.masters.tolist() == [*range(9), 3, 6]
    # the rest has no direction and does not twist
    np.testing.assert_allclose(successive(beam)[6:, 3], 0.0, atol=1e-12)
    with pytest.raises(ValueError, match=r"no group of cells 'third'; it has: first, second"):
        fl.Beam(mesh, SECTION, up={"third": (0, 0, 1)})
    with pytest.raises(ValueError, match="must not be zero"):
        fl.Beam(mesh, SECTION, up=(0, 0, 0))


# --- twist and taper ------------------------------------------------------------------------------


def test_twist_is_a_rate_along_straight_bars_and_comes_on_top_on_others():
    rate = 0.8
    bar = fl.Beam.straight(
        (0, 0, 0), (1, 2, 2), SECTION, cells=4, up=fl.sections.Twisted(lambda s: rate * s)
    )
    strain = successive(bar) / bar.model.lengths[:, np.newaxis]
    np.testing.assert_allclose(strain, [[1, 0, 0, rate, 0, 0]] * 4, atol=1e-14)
    plain, twisted = (
        fl.Beam.curve(arc(2.0), SECTION, cells=6, up=fl.sections.Twisted(twist))
        for twist in (None, lambda s: 0.3 * s)
    )
    turn = lie.se3_relative(plain.frames, twisted.frames)
    np.testing.assert_allclose(turn[:, 3], 0.3 * np.linspace(0, 4, 7), atol=1e-9)
    np.testing.assert_allclose(turn[:, [0, 1, 2, 4, 5]], 0.0, atol=1e-14)
    with pytest.raises(ValueError, match="twist must be finite"):
        fl.Beam.straight(
            (0, 0, 0), (1, 0, 0), SECTION, cells=2, up=fl.sections.Twisted(lambda s: float("nan"))
        )


def tip_displacement(beam: fl.Beam, force) -> np.ndarray:
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=force))
    return fl.statics(scene).position(beam.point("end"))[-1] - beam.point("end").position


def test_a_tapered_cantilever_gives_way_as_the_integral_says_with_second_order():
    """``w = ∫ P (L − x)²/EI(x) + P/GA(x) dx`` for a height that falls to half."""
    L, P = 2.0, 1e-4

    def at(x: float) -> np.ndarray:
        h = 1 - 0.5 * x / L
        return np.array([1e4 * h, 5e3 * h, 5e3 * h, 50 * h**3, 100 * h**3, 100 * h])

    exact = P * quad(lambda x: (L - x) ** 2 / at(x)[4] + 1 / at(x)[2], 0, L, epsabs=1e-14)[0]
    errors = []
    for cells in (4, 8, 16):
        beam = fl.Beam.straight(
            (0, 0, 0), (L, 0, 0), lambda x: fl.Section.from_stiffness(at(x)), cells=cells
        )
        errors.append(abs(tip_displacement(beam, (0, 0, P))[2] / exact - 1))
    assert errors[-1] < 2e-3
    assert np.log2(np.array(errors[:-1]) / errors[1:]).min() > 1.9, errors


# --- one element ----------------------------------------------------------------------------------


def test_one_element_is_castiglianos_quarter_circle():
    """Tip forces on a cantilevered arc: ``πR³/4EI`` and its like, with one element."""
    R, P = 2.0, 1e-6
    EA, GA2, GA3, GJ, EI2, EI3 = 1e4, 5e3, 4e3, 50.0, 100.0, 70.0
    straight = np.pi * R / 4
    exact = {
        # towards the tip's tangent −> lever R (1 − cos), along the start's −> lever R sin
        0: R**3 * straight / R / EI3 + straight * (1 / EA + 1 / GA2),
        1: R**3 * (3 * np.pi / 4 - 2) / EI3 + straight * (1 / EA + 1 / GA2),
        2: R**3 * (np.pi / 4 / EI2 + (3 * np.pi / 4 - 2) / GJ) + np.pi * R / 2 / GA3,
    }
    for axis, compliance in exact.items():
        beam = fl.Beam.curve(
            lambda s: (R * np.sin(s * np.pi / 2), R * (1 - np.cos(s * np.pi / 2)), 0),
            SECTION,
            cells=1,
        )
        moved = tip_displacement(beam, P * np.eye(3)[axis])[axis]
        # the load turns by 1e-7
        assert moved == pytest.approx(P * compliance, rel=1e-6), axis


def test_one_element_is_a_twisted_bar():
    """Any pre-twist: the exact integral over the turning section, for a force askew to its axes."""
    L, total, P = 2.0, 2.5, 1e-6
    C = np.linalg.inv(SECTION.stiffness)

    def energy(x: float) -> float:
        R = lie.so3_exp([total * x / L, 0, 0])
        force = np.array([0, 0.6, 0.8])
        moment = np.cross([L - x, 0, 0], force)
        wrench = np.concatenate([R.T @ force, R.T @ moment])
        return wrench @ C @ wrench

    beam = fl.Beam.straight(
        (0, 0, 0),
        (L, 0, 0),
        SECTION,
        cells=1,
        up=fl.sections.Twisted(lambda s: total * s / L, (0, 0, 1)),
    )
    force = np.array([0, 0.6, 0.8])
    moved = tip_displacement(beam, P * force) @ force
    assert moved == pytest.approx(P * quad(energy, 0, L)[0], rel=1e-6)


# --- branches -------------------------------------------------------------------------------------


def test_a_fork_with_one_tangent_is_one_node():
    """A line that splits like a railway needs no node that follows; it is beams with joints."""
    points = [arc(0.5)(s) for s in (0.0, 0.5, 1.0)]
    mirror = PLANE @ np.diag([1.0, -1, 1]) @ PLANE.T
    start, t = -PLANE[:, 0], PLANE[:, 0]
    ends = [PLANE @ [np.cos(a), np.sin(a), 0] for a in (0.25, 0.5)]
    x = np.array([start, *points, mirror @ points[1], mirror @ points[2]])
    tangents = [[t, t], [t, ends[0]], ends, [t, mirror @ ends[0]], [mirror @ e for e in ends]]
    cells = np.array([[0, 1], [1, 2], [2, 3], [1, 4], [4, 5]])
    parts = {"stem": [0], "left": [1, 2], "right": [3, 4]}
    names = {"root": [0], "fork": [1], "left": [3], "right": [5]}
    mesh = fl.mesh.LineMesh(x, cells, np.array(tangents), parts, names)
    tips = []
    for joints in (False, True):
        scene = fl.Scene()
        if joints:
            beams = {g: scene.add(fl.Beam(mesh.part(g), SECTION, up=PLANE[:, 2])) for g in parts}
            for g in ("left", "right"):
                scene.add(fl.joints.Fixed(beams["stem"].point("fork"), beams[g].point("fork")))
        else:
            whole = scene.add(fl.Beam(mesh, SECTION, up=PLANE[:, 2]))
            assert len(whole.frames) == 6, "no follower"
            beams = dict.fromkeys(parts, whole)
        scene.add(fl.Clamp(beams["stem"].point("root")))
        scene.add(fl.PointLoad(beams["left"].point("left"), force=(3.0, 5, -8)))
        result = fl.statics(scene, load_steps=2, newton=fl.schemes.Newton(tolerance=1e-13))
        tips.append(result.position(beams["right"].point("right"))[-1])
    assert np.linalg.norm(tips[0] - x[5]) > 1e-3
    np.testing.assert_allclose(tips[0], tips[1], rtol=0, atol=1e-12)


def test_a_gmsh_frame_has_its_sections_points_and_nodes(tmp_path):
    """Kinks at the corners, a branch in the middle: one node more for each further direction."""
    mesh = fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(FRAME, {"cells": 3}))
    sections = {"columns": SECTION, "girder": _scaled(2), "outrigger": _scaled(3)}
    beam = fl.Beam(mesh, sections, up={"outrigger": (0, 0, 1)})
    np.testing.assert_array_equal(mesh.branching_points, mesh.named("middle"))
    assert len(mesh.points) == 16 and len(beam.frames) == 19
    attached = np.flatnonzero(beam.model.masters != np.arange(19))
    positions = [beam.point(name).node for name in ("left corner", "right corner", "middle")]
    assert sorted(beam.model.masters[attached]) == sorted(positions)
    np.testing.assert_array_equal(
        beam.frames[attached, 0], mesh.points[beam.model.masters[attached]]
    )
    for k, group in enumerate(sections):
        cells = beam.model.cells_of(group)
        assert len(cells) == (6, 6, 3)[k]
        np.testing.assert_array_equal(
            beam.model.stiffness[cells], [(k + 1) * SECTION.stiffness] * len(cells)
        )
        # every element of the group lies along its own frames
        relative = successive(beam)[cells]
        np.testing.assert_allclose(relative[:, 0], beam.model.lengths[cells], rtol=1e-12)
        np.testing.assert_allclose(relative[:, 1:], 0.0, atol=1e-12)
    np.testing.assert_allclose(beam.point("end").position, [2, 2, 3], atol=1e-12)
    with pytest.raises(ValueError, match="6 cells have no section, the first is cell 3"):
        fl.Beam(mesh, {"columns": SECTION, "outrigger": SECTION})
    with pytest.raises(ValueError, match=r"no point 'roof'; it has: end, left corner"):
        beam.point("roof")


def _scaled(factor: float) -> fl.Section:
    return fl.Section.from_stiffness(factor * SECTION.stiffness)


def test_without_rotary_inertia_mass_and_its_centre_stay():
    """Only what turns about e₂ and e₃ through the centre of mass is gone."""
    inertia = fl.Section.rectangle(0.2, 0.1, fl.Material(1.0, 0.3, 100.0)).inertia.copy()
    centre, mass = np.array([0.0, 0.03, -0.02]), inertia[0, 0]
    inertia[1:, 1:] += mass * np.outer(centre, centre)
    inertia[0, 1:] = inertia[1:, 0] = mass * centre
    section = fl.Section.from_stiffness(SECTION.stiffness, inertia)
    mesh = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 1)
    (reduced,) = fl.Beam(mesh, section, rotary_inertia=False).model.density
    np.testing.assert_allclose(reduced[0], inertia[0], atol=1e-15)
    about_centre = reduced[1:, 1:] - mass * np.outer(centre, centre)
    # J = tr(G) I − G
    J = np.trace(about_centre) * np.eye(3) - about_centre
    polar = 100.0 * 0.2 * 0.1 * (0.2**2 + 0.1**2) / 12
    np.testing.assert_allclose(J, np.diag([polar, 0, 0]), atol=1e-12)


# --- size of a scene ------------------------------------------------------------------------------


@pytest.mark.parametrize("turn", [(0, 0, 0), (0.4, -1.1, 2.0)])
def test_the_diameter_is_that_of_the_farthest_points_however_they_lie(turn):
    rng, R = np.random.default_rng(1), lie.so3_exp(np.array(turn, dtype=float))
    box = np.array([[x, y, z] for x in (0, 3) for y in (0, 4) for z in (0, 12)], dtype=float)

    def diameter(points: np.ndarray) -> float:
        scene = fl.Scene()
        for x in points:
            scene.add(fl.RigidBody(1.0, [1e-6] * 3, x))
        return fl.extend.Equations(scene, dynamics=True).unknowns.length

    assert diameter(box @ R.T) == pytest.approx(13.0, rel=1e-14)
    assert diameter(np.outer(np.linspace(0, 2, 7), R[0]) + 5.0) == pytest.approx(2.0, rel=1e-14)
    cloud = rng.normal(size=(200, 3))
    exact = np.linalg.norm(cloud[:, np.newaxis] - cloud, axis=2).max()
    assert diameter(cloud) <= exact * (1 + 1e-14)
    assert diameter(cloud @ R.T) == pytest.approx(diameter(cloud), rel=1e-12)
