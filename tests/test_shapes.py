"""Geometry of pictures: surfaces of bodies, their corners on pages, and what is in sight."""

import numpy as np
import pytest
import pyvista
from PIL import Image

import fem_lie as fl
from fem_lie import lie
from fem_lie.bodies.catalogue import BodyInfo, SceneInfo
from fem_lie.pictures import bodies
from fem_lie.pictures.bodies import _surfaces, draw
from fem_lie.pictures.page.content import Corners, _thinned
from fem_lie.pictures.shapes import joint_positions, scene_size, shapes
from fem_lie.pictures.stage import Canvas, _round_step
from tests.test_pages import array, content, pendulum
from tests.test_results import NODES, SQUARE, rod_with_tip


@pytest.fixture(autouse=True)
def no_display(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)


def cantilever(direction=(1.0, 0, 0)):
    """A bar that is bent in eleven steps."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.1, 0.06, fl.Material(1e6, 0.3, 1.0))
    beam = scene.add(fl.Beam.straight((0, 0, 0), direction, section, cells=6, name="bar"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 4.0, 0)))
    return scene, beam


@pytest.fixture(scope="module")
def bent():
    return fl.statics(cantilever()[0], load_steps=11)


@pytest.fixture
def drawn(monkeypatch):
    """What is given to be drawn instead of a picture."""
    given = []
    monkeypatch.setattr(bodies, "draw", lambda info, frames, *a, **k: given.append(frames))
    return given


@pytest.mark.parametrize(
    ("at", "states"),
    [
        (None, [0, 2, 3, 5, 7, 8, 10]),
        ([0, -1], [0, 10]),
        ([0.55, 1.0], [5, 10]),
        ([3, 0.1], [3, 0]),
        ([], []),
    ],
)
def test_pictures_of_statics_show_the_wanted_states(bent, drawn, at, states):
    """The unloaded one and at most seven others, or those asked for by number or load factor."""
    bent.picture("none.png", at)
    (frames,) = drawn
    np.testing.assert_array_equal(frames[0], bent.info.undeformed)
    np.testing.assert_array_equal(frames[1:], bent.frames[states])


def test_states_that_do_not_exist_are_refused(bent):
    with pytest.raises(ValueError, match="there are 11 states, got the index 11"):
        bent.picture("none.png", [11])
    with pytest.raises(ValueError, match="load factor must be a finite number, got nan"):
        bent.picture("none.png", [np.nan])


def _arc(angle, cells, outline):
    """A beam along an arc of length 1, and its frames, shape (N, 4, 3)."""
    s = np.linspace(0, 1, cells + 1)[:, np.newaxis]
    frames = lie.se3_retract(lie.frame(np.zeros(3), np.eye(3)), s * [1.0, 0, 0, 0, 0, angle])
    node = np.arange(cells + 1)
    pairs = np.column_stack([node[:-1], node[1:]])
    return SceneInfo((BodyInfo("arc", "Beam", node, pairs, outline),)), frames


@pytest.mark.parametrize(("angle", "cells"), [(0.0, 3), (1.5, 1), (6.0, 4)])
def test_a_swept_section_is_closed_and_has_the_volume_of_pappus(angle, cells):
    info, frames = _arc(angle, cells, SQUARE)
    (shape,) = shapes(info, frames[np.newaxis])
    surface = pyvista.PolyData(shape.points(frames), shape.faces).clean(tolerance=1e-7)
    assert surface.triangulate().is_manifold
    # each piece spans an angle and is cut square at its ends: sin δ / δ of the arc's volume
    shortening = np.sinc(angle / (cells * shape.steps) / np.pi)
    assert shape.steps == 1 if angle == 0 else shortening > 0.998
    assert surface.triangulate().volume == pytest.approx(0.04**2 * shortening, rel=1e-4)


def _surface(scene):
    """Surface of the only body of a scene as the pictures have it, closed at all its edges."""
    (body,) = scene.bodies
    info = SceneInfo((BodyInfo.of(body, np.arange(len(body.frames))),))
    (shape,) = shapes(info, body.frames[np.newaxis])
    (surface,) = _surfaces(info, [shape], body.frames)
    return surface.clean().triangulate()


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_every_cell_has_its_own_section_whatever_its_corners(size):
    """A square, a slimmer rectangle, a tube and a cell without outline: their volumes."""
    m = fl.Material(1.0, 0.3, 1.0)
    sections = [
        fl.Section.rectangle(0.2 * size, 0.2 * size, m),
        fl.Section.rectangle(0.1 * size, 0.2 * size, m),
        fl.Section.circle(0.1 * size, m),
        fl.Section.from_stiffness([1.0] * 6),
    ]
    mesh = fl.mesh.LineMesh.from_cells(
        [(k * size, 0, 0) for k in range(5)],
        [(k, k + 1) for k in range(4)],
        groups={str(k): [k] for k in range(4)},
    )
    scene = fl.Scene()
    scene.add(fl.Beam(mesh, {str(k): section for k, section in enumerate(sections)}))
    surface = _surface(scene)
    assert surface.is_manifold
    # polygons of 32 and of 16 corners; what has no outline gets a circle of 0.004 of the scene
    circle, thin = (0.5 * n * np.sin(2 * np.pi / n) * r**2 for n, r in ((32, 0.1), (16, 0.016)))
    assert surface.volume / size**3 == pytest.approx(0.04 + 0.02 + circle + thin, rel=1e-4)


def test_tapered_and_twisted_beams_are_drawn_so():
    """Steps of sections have the volume of the taper, and twist keeps it."""
    m, cells = fl.Material(1.0, 0.3, 1.0), 4
    for twist in (None, lambda s: 0.5 * np.pi * s):
        scene = fl.Scene()
        scene.add(
            fl.Beam.straight(
                (0, 0, 0),
                (1, 0, 0),
                lambda s: fl.Section.rectangle(0.2 - 0.1 * s, 0.1, m),
                cells=cells,
                up=fl.sections.Twisted(twist),
            )
        )
        # sides of a twisted piece are folded outward: a third of its angle, 4 degrees at most
        tolerance = 1e-4 if twist is None else 0.025
        assert _surface(scene).volume == pytest.approx(0.15 * 0.1, rel=tolerance)
        if twist is not None:
            frame = scene.bodies[0].point("end").frame
            np.testing.assert_allclose(frame[1:], [[1, 0, 0], [0, 0, 1], [0, -1, 0]], atol=1e-15)


def test_thin_members_stay_visible_and_thick_ones_true():
    for thickness, drawn in ((1e-5, 0.004), (1.0, 0.02 * np.sqrt(2))):
        info, frames = _arc(0.0, 2, SQUARE * thickness)
        (shape,) = shapes(info, frames[np.newaxis])
        assert np.linalg.norm(shape.offset, axis=-1).max() == pytest.approx(drawn)


@pytest.mark.parametrize("extent", [0.03, 1.0, 1.3, 2.0, 3.0, 3.7, 4.0, 4.6, 6.0, 9.9, 350.0])
def test_labels_of_axes_stand_where_they_belong(extent):
    """VTK takes our labels in its own distances where these are larger: they never are."""
    step = _round_step(extent)
    for low in np.linspace(-0.95 * step, 0, 7):
        first, last = np.floor(low / step + 0.1), np.ceil((low + extent) / step - 0.1)
        length = step * (last - first)
        power = 10.0 ** np.floor(np.log10(length) + 1e-9)
        number = int(length / power + 1e-9) + 1
        own = power / (5 if number <= 2 else 2 if number < 5 else 1)
        assert own <= step * (1 + 1e-9)


def test_a_single_configuration_in_a_plane_is_seen_from_its_front(tmp_path):
    info, frames = _arc(3.0, 4, SQUARE)
    draw(info, frames, tmp_path / "arc.png", canvas=Canvas(size=(400, 300)))
    image = np.asarray(Image.open(tmp_path / "arc.png").convert("RGB"), dtype=int)
    blue = np.ptp(image, axis=-1) > 60
    rows, columns = np.nonzero(blue)
    # the arc is 0.33 wide (from x = 0 on) and 0.66 high; both grow by the section
    assert np.ptp(rows) / np.ptp(columns) == pytest.approx(0.7 / 0.36, rel=0.05)


def test_shapes_move_with_their_frames():
    rod = rod_with_tip()
    motion = lie.frame([1.0, -2, 3], lie.so3_exp([1.0, 2, -0.5]))
    frames = rod.frames[3]
    moved = lie.se3_compose(motion, frames)
    for shape in shapes(rod.info, rod.frames):
        expected = lie.position(motion) + shape.points(frames) @ lie.rotation(motion).T
        np.testing.assert_allclose(shape.points(moved), expected, atol=1e-14)
    np.testing.assert_allclose(
        joint_positions(rod.info, frames)[1], frames[NODES - 1, 0], atol=1e-15
    )


def test_positions_are_those_of_pictures():
    """To a ten thousandth of the scene, less than a pixel."""
    result = fl.GeneralisedAlpha().run(pendulum()[0], step=2e-3, duration=0.4)
    shown = content(result.page(states=7))
    rows = result._instants(7)
    frames = result.frames[rows]
    size = scene_size(frames)
    for body, shape in zip(shown["bodies"], shapes(result.info, frames), strict=True):
        ring, offset = array(body["ring"]), array(body["offset"])
        x = array(body["places"]).reshape(len(rows), -1, 3) * shown["unit"]
        directors = array(body["directors"]).reshape(*x.shape[:2], -1, 3) / 32767
        offset = offset.reshape(len(ring), -1)
        found = x[:, ring] + np.einsum("ck,tckj->tcj", offset, directors[:, ring])
        corners = Corners.of(shape, frames[0])
        wanted = np.array([shape.points(step)[corners.points] for step in frames]) / size
        assert np.ptp((found - wanted).reshape(-1, 3), axis=0).max() < 1e-4
        triangles = array(body["triangles"]).reshape(-1, 3)
        assert triangles.max() < len(ring) == len(corners.points)
    assert shown["states"] == pytest.approx(result.times[rows], rel=1e-6)


def test_triangles_cover_the_bodies():
    """A bar's surface, of sides and ends, as it is in closed form."""
    result = fl.GeneralisedAlpha().run(pendulum()[0], step=2e-3, duration=2e-3)
    (shape, _) = shapes(result.info, result.frames[:1])
    points, triangles = Corners.of(shape, result.frames[0])
    a, b, c = shape.points(result.frames[0])[points][triangles].transpose(1, 0, 2)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    assert area == pytest.approx(4 * 0.02 * 1.0 + 2 * 0.02**2, rel=1e-12)


@pytest.mark.parametrize(
    "direction", [(0, 0, 1.0), (1.0, 0, 0), (1e-3, 0, 0), (300.0, 40.0, 70.0), (0.2, 0.3, 5.0)]
)
@pytest.mark.parametrize("small", [False, True], ids=["picture", "beside a curve"])
def test_nothing_is_cut_off_at_the_borders(tmp_path, direction, small):
    """Bodies, numbers and titles of axes, from all sides and for any proportions."""
    scene, _ = cantilever(direction)
    info = fl.extend.Equations(scene, dynamics=False).info
    file = tmp_path / "bar.png"
    canvas = Canvas(units=fl.post.Units(length="a long unit"))
    if small:
        canvas = canvas._replace(size=(900, 700), text=20)
    draw(info, scene.bodies[0].frames, file, canvas=canvas)
    pixels = np.asarray(Image.open(file).convert("L"), dtype=float)
    border = 6
    edges = [pixels[:border], pixels[-border:], pixels[:, :border], pixels[:, -border:]]
    assert min(edge.min() for edge in edges) > 250
    ink = np.argwhere(pixels < 250)
    # and it is not small, either
    assert (np.ptp(ink, axis=0) / pixels.shape).max() > 0.5


def test_numbers_beside_a_path_are_as_large_as_those_of_the_curve(tmp_path, monkeypatch):
    """Nine points where a tenth of an inch is 7.2: at least 8, and not 5."""
    given = []
    real = bodies.draw

    def watched(info, frames, path, **options):
        given.append(options)
        real(info, frames, path, **options)

    monkeypatch.setattr(bodies, "draw", watched)
    path = fl.follow_path(cantilever()[0], fl.stability.PathEnds(steps=3))
    figure = path.plot_path(path.displacement("bar.end")[:, 2], tmp_path / "path.png")
    shape = figure.axes[1].get_window_extent()
    canvas = given[0]["canvas"]
    # pixels of the picture per pixel of the figure, and those per point
    shrunk = max(np.array(canvas.size) / (shape.width, shape.height))
    assert canvas.text / shrunk / (figure.dpi / 72) >= 8.0


def test_traces_have_no_points_that_nobody_sees():
    """Of ten thousand points those are drawn that are two thousandths of the scene apart."""
    turn = np.linspace(0.0, 2.0 * np.pi, 10001)
    circle = 0.5 * np.column_stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)])
    kept = _thinned(circle)
    np.testing.assert_array_equal(kept[[0, -1]], circle[[0, -1]])
    steps = np.linalg.norm(np.diff(kept, axis=0), axis=1)
    assert len(kept) < 1700 and steps.max() < 3e-3
    few = circle[::500]
    np.testing.assert_array_equal(_thinned(few), few)


@pytest.mark.parametrize(("radius", "corners"), [(0.005, 16), (0.05, 32)])
def test_thin_tubes_have_fewer_corners(radius, corners):
    """Where a quarter of a pixel would not show them."""
    section = fl.Section.circle(radius, fl.Material(2e11, 0.3, 7800.0))
    bar = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=1, name="bar")
    (shape,) = shapes(SceneInfo.of([bar]), bar.frames[np.newaxis])
    assert len(shape.offset) == 2 * corners


@pytest.mark.parametrize(
    ("body", "volume"),
    [
        (fl.RigidBody.ball(1.0, 0.3), 4.0 / 3.0 * np.pi * 0.3**3),
        (fl.RigidBody.cylinder(1.0, 0.2, (0, 0, 0), (0, 3, 4)), np.pi * 0.2**2 * 5.0),
        (fl.RigidBody.box(1.0, (0.1, 0.2, 0.3)), 0.1 * 0.2 * 0.3),
        (fl.RigidBody(1.0, (1.0, 1.0, 1.0)), 6.0**1.5),
        (fl.RigidBody(1.0, (1e-12, 1.0, 1.0)), None),
    ],
    ids=["ball", "cylinder", "box", "inertia", "rod"],
)
def test_rigid_bodies_are_drawn_with_their_volume(body, volume):
    """By the divergence theorem, so that all faces point outwards; a thin rod stays visible."""
    scene = fl.Scene()
    scene.add(body)
    info = fl.extend.Equations(scene, dynamics=True).info
    (shape,) = shapes(info, info.undeformed[np.newaxis])
    a, b, c = np.moveaxis(shape.points(info.undeformed)[shape.faces.reshape(-1, 4)[:, 1:]], 1, 0)
    enclosed = np.einsum("fi,fi->", a, np.cross(b, c)) / 6.0
    if volume is None:
        assert 0.0 < enclosed < 1e-3
    else:
        # circles are drawn as polygons with 24 corners
        assert enclosed == pytest.approx(volume, rel=0.05)
        assert enclosed < volume * (1.0 + 1e-12)
