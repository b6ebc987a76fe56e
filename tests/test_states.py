"""What all results have in common: where points are, what is drawn, what is refused."""

import numpy as np
import pytest
from test_paths import column

import fem_lie as fl


@pytest.fixture(scope="module")
def results():
    """One of each kind; a column beyond its critical load."""
    scene, _, _ = column("fixed-free", 4)
    seen = []
    path = fl.follow_path(scene, 1.1, observe={"state": lambda s: seen.append(s) or 0.0})
    (critical,) = path.critical
    section = fl.Section.rectangle(0.1, 0.06, fl.Material(1e6, 0.3, 1.0))
    moving = fl.Scene(gravity=(0, 0, -9.81))
    beam = moving.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4, name="column"))
    moving.add(fl.Clamp(beam.point("start")))
    return {
        "statics": fl.statics(moving, load_steps=9),
        "loads": fl.follow_loads(moving, [0.5, 1.0]),
        "path": path,
        "state": seen[-1],
        "critical": critical,
        "dynamics": fl.GeneralisedAlpha(0.8).run(moving, duration=0.1, step=0.01),
        "buckling": fl.buckling(scene, 2),
        "vibrations": fl.vibrations(moving, 2),
    }


PLACED = ("statics", "loads", "path", "state", "critical", "dynamics")
SERIES = ("statics", "loads", "path", "dynamics")
MODES = ("buckling", "vibrations")


@pytest.mark.parametrize("kind", PLACED)
def test_points_are_looked_up_by_name_or_number(results, kind):
    """One state has a position and a rotation, a series has them in each of its states."""
    result = results[kind]
    node = int(result.info.body("column").nodes[-1])
    for point in ("column.end", node, np.int64(node)):
        np.testing.assert_array_equal(result.position(point), result.frames[..., node, 0, :])
        R = result.rotation(point)
        np.testing.assert_array_equal(R[..., :, 1], result.frames[..., node, 2, :])
    for look in (result.position, result.rotation):
        with pytest.raises(ValueError, match=r"there is no point 'column\.top'"):
            look("column.top")


@pytest.mark.parametrize("kind", PLACED)
def test_displacements_are_from_the_undeformed_configuration(results, kind):
    """One state has a displacement (3,), a series one in each of its states."""
    result = results[kind]
    node = result.info.node("column.end")
    for point in ("column.end", node):
        moved = result.displacement(point)
        assert moved.shape == (*result.frames.shape[:-3], 3) and np.abs(moved).max() > 1e-6
        rest = result.info.undeformed[node, 0]
        np.testing.assert_allclose(rest + moved, result.position(node), rtol=0, atol=1e-15)
    with pytest.raises(ValueError, match=r"there is no point 'column\.top'"):
        result.displacement("column.top")


@pytest.mark.parametrize("kind", MODES)
def test_modes_displace_points(results, kind):
    """A row for each mode, global components; the state itself has positions and rotations."""
    result = results[kind]
    node = result.info.node("column.end")
    np.testing.assert_array_equal(result.position("column.end"), result.frames[node, 0])
    np.testing.assert_array_equal(result.rotation("column.end"), result.frames[node, 1:].T)
    moved = result.displacement("column.end")
    assert moved.shape == (len(result), 3) and moved.dtype == result.shapes.dtype
    local = result.shapes[:, node, :3]
    np.testing.assert_allclose(moved, local @ result.frames[node, 1:], rtol=0, atol=1e-12)
    along = result.frames[node, 0] - result.frames[0, 0]
    np.testing.assert_allclose(moved @ along, 0.0, atol=1e-2 * np.abs(moved).max())
    with pytest.raises(ValueError, match=r"there is no point 'column\.top'"):
        result.displacement("column.top")


def test_a_point_within_an_element_is_displaced_by_modes():
    """Of a cantilever by its first mode, whose shape Euler and Bernoulli know."""
    steel = fl.Material(2.1e11, 0.3, 7800.0)
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.rectangle(0.01, 0.02, steel), cells=16)
    )
    scene.add(fl.Clamp(beam.point("start")))
    modes = fl.vibrations(scene, 1)
    k = 1.8751040687119611

    def shape(x):
        c = (np.cosh(k) + np.cos(k)) / (np.sinh(k) + np.sin(k))
        return np.cosh(k * x) - np.cos(k * x) - c * (np.sinh(k * x) - np.sin(k * x))

    part, whole = (modes.displacement(beam.point((x, 0, 0)))[0] for x in (0.53, 1.0))
    ratio = np.linalg.norm(part) / np.linalg.norm(whole)
    assert ratio == pytest.approx(shape(0.53) / shape(1.0), rel=2e-3)


def test_a_damped_motion_comes_to_the_displacement_of_statics():
    """And from there to the same one again: displacements do not start at the first state."""
    rubber = fl.Material(1e6, 0.3, 1000.0)
    damping = fl.sections.Damping(mass=4.0, stiffness=0.02)
    section = fl.Section.rectangle(0.05, 0.05, rubber)
    beam = fl.Beam.straight((0, 0, 0), (0.3, 0, 0), section, cells=4, damping=damping, name="strip")
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    rest = fl.statics(scene)
    motion = fl.GeneralisedAlpha().run(scene, duration=6.0, step=0.02)
    wanted = rest.displacement("strip.end")[-1]
    np.testing.assert_allclose(motion.displacement("strip.end")[-1], wanted, rtol=1e-4)
    again = fl.Scene(gravity=(0, 0, -9.81))
    again.add(beam)
    again.add(fl.Clamp(beam.point("start")))
    fl.adaptivity.transfer(motion, scene, again)
    resting = fl.GeneralisedAlpha().run(again, duration=0.1, step=0.02)
    np.testing.assert_allclose(
        resting.displacement("strip.end"), np.tile(wanted, (6, 1)), rtol=1e-4, atol=1e-9
    )


@pytest.mark.parametrize("kind", SERIES)
def test_iterations_are_counted_from_the_start(results, kind):
    """Of accepted steps, one number for each state; the total has rejected steps, too."""
    result = results[kind]
    assert result.iterations.shape == (len(result.frames),)
    assert result.iterations.dtype == np.int64 and (np.diff(result.iterations) >= 0).all()
    others = getattr(result, "failed_iterations", 0) + getattr(result, "locating_iterations", 0)
    assert result.total_iterations == result.iterations[-1] + others
    assert result.factorisations > 0 and result.seconds > 0.0
    assert f"iterations={result.total_iterations}" in repr(result)


def test_iterations_of_linear_statics_are_two_for_each_step():
    """A solution, and one that confirms it; the same in every way to ask for the states."""
    scene, _, _ = column("fixed-free", 4)
    found = fl.statics(scene, load_steps=4)
    assert found.load_steps == 4 and found.failed_steps == 0
    np.testing.assert_array_equal(found.iterations, 2 * np.arange(1, 5))


@pytest.fixture
def drawn(monkeypatch):
    """What is given to be drawn instead of a moving picture."""
    given = []
    monkeypatch.setattr(
        "fem_lie.pictures.bodies.animate",
        lambda info, frames, path, **options: given.append((frames, options["paths"])),
    )
    return given


@pytest.mark.parametrize("kind", SERIES)
@pytest.mark.parametrize("images", [1, 2, 5, 100])
def test_every_series_of_states_can_be_animated(results, drawn, kind, images):
    """A motion evenly in time, other states once each at most; from the first to the last."""
    result = results[kind]
    result.animate("none.gif", images=images, trace=["column.end"])
    ((frames, (trace,)),) = drawn
    assert len(frames) == (images if kind == "dynamics" else min(images, len(result.frames)))
    np.testing.assert_array_equal(frames[0], result.frames[0])
    if images > 1:
        np.testing.assert_array_equal(frames[-1], result.frames[-1])
    np.testing.assert_array_equal(trace[-len(result.frames) :], result.position("column.end"))
    if kind != "dynamics":
        start = result.info.frame("column.end", result.info.undeformed)[0]
        np.testing.assert_array_equal(trace[0], start)


@pytest.mark.parametrize("kind", [*SERIES, "vibrations"])
def test_an_animation_has_an_image(results, kind):
    modes = (1,) if kind == "vibrations" else ()
    with pytest.raises(ValueError, match="images must be at least 1, got 0"):
        results[kind].animate("none.gif", *modes, images=0)
    with pytest.raises(TypeError, match=r"images must be a whole number, got 2\.5"):
        results[kind].animate("none.gif", *modes, images=2.5)


@pytest.mark.parametrize("kind", ["state", "critical", "buckling", "vibrations"])
def test_stresses_are_those_of_a_series_of_states(results, kind):
    """What has frames of a single state is named, and not taken for as many states as nodes."""
    scene, beam, _ = column("fixed-free", 4)
    with pytest.raises(TypeError, match="expected a result of statics, a path or dynamics, got"):
        fl.post.section_forces(results[kind], beam, scene)


@pytest.mark.parametrize("kind", ["critical", "buckling", "vibrations"])
def test_modes_that_do_not_exist_are_refused(results, kind):
    for number in (0, 99):
        with pytest.raises(ValueError, match=f"modes are 1 … \\d, got {number}"):
            results[kind].picture("none.png", number)
    with pytest.raises(TypeError, match=r"mode must be a whole number, got 1\.0"):
        results[kind].picture("none.png", 1.0)


@pytest.mark.parametrize("kind", ["critical", "buckling", "vibrations"])
def test_an_amplitude_is_a_number(results, kind):
    with pytest.raises(ValueError, match=r"amplitude must be .*, got nan"):
        results[kind].picture("none.png", 1, amplitude=np.nan)
    if kind == "critical":
        with pytest.raises(ValueError, match="amplitude must be a finite number, got inf"):
            results[kind].moved(1, np.inf)


def test_a_time_is_a_number(results):
    """And not that of the first state if it is none."""
    for look in (results["dynamics"].index, lambda t: results["dynamics"].picture("a.png", [t])):
        with pytest.raises(ValueError, match="time must be a finite number, got nan"):
            look(np.nan)
