"""Pictures: which states are drawn, and that nothing is cut off at the borders."""

import numpy as np
import pytest
from PIL import Image

import fem_lie as fl
from fem_lie.pictures.bodies import draw
from fem_lie.pictures.stage import Canvas


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
    monkeypatch.setattr(
        "fem_lie.pictures.bodies.draw", lambda info, frames, *a, **k: given.append(frames)
    )
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


@pytest.mark.parametrize(
    "direction", [(0, 0, 1.0), (1.0, 0, 0), (1e-3, 0, 0), (300.0, 40.0, 70.0), (0.2, 0.3, 5.0)]
)
@pytest.mark.parametrize("small", [False, True], ids=["picture", "beside a curve"])
def test_nothing_is_cut_off_at_the_borders(tmp_path, bent, direction, small):
    """Bodies, numbers and titles of axes, from all sides and for any proportions."""
    scene, _ = cantilever(direction)
    file = tmp_path / "bar.png"
    canvas = Canvas(units=fl.post.Units(length="a long unit"))
    if small:
        canvas = canvas._replace(size=(900, 700), text=20)
    draw(bent.info, scene.bodies[0].frames, file, canvas=canvas)
    pixels = np.asarray(Image.open(file).convert("L"), dtype=float)
    border = 6
    edges = [pixels[:border], pixels[-border:], pixels[:, :border], pixels[:, -border:]]
    assert min(edge.min() for edge in edges) > 250
    ink = np.argwhere(pixels < 250)
    # and it is not small, either
    assert (np.ptp(ink, axis=0) / pixels.shape).max() > 0.5


def test_numbers_beside_a_path_are_as_large_as_those_of_the_curve(tmp_path, monkeypatch):
    """Nine points where a tenth of an inch is 7.2: at least 8, and not 5."""
    from fem_lie.pictures import bodies

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
