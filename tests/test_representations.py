"""What ``repr`` shows of scenes, bodies, meshes and results: a few lines, and a table."""

import numpy as np
import pytest

import fem_lie as fl

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
SECTION = fl.Section.rectangle(0.02, 0.03, STEEL)


def cantilever() -> fl.Scene:
    """A beam clamped at its start, with a force at its end."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=8, name="arm"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, -10.0)))
    return scene


SCENE = cantilever()
STATIC = fl.statics(SCENE)
MESH = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (9, 9))
SHOWN = {
    "scene": SCENE,
    "empty scene": fl.Scene(),
    "beam": SCENE.bodies[0],
    "point": SCENE.bodies[0].point("end"),
    "rigid body": fl.RigidBody(1.0, (0.1, 0.1, 0.1)),
    "joint": fl.joints.Revolute(SCENE.bodies[0].point("end"), fl.ground(), axis=(0, 0, 1)),
    "section": SECTION,
    "surface": MESH,
    "shell": fl.Shell(MESH, fl.ShellSection.layer(0.01, STEEL)),
    "statics": STATIC,
    "motion": fl.GeneralisedAlpha().run(SCENE, duration=2e-3, step=1e-3),
    "vibrations": fl.vibrations(SCENE, 3),
    "section forces": fl.post.section_forces(STATIC, SCENE.bodies[0], SCENE),
}


def bent_bodies() -> dict[str, object]:
    """Stresses of a shell, a thin shell and a solid under their weight."""
    patch = fl.mesh.smooth_patch(lambda a, b: np.array([a, b, 0.0]), (2, 2))
    layer = fl.ShellSection.layer(0.01, STEEL)
    elastic = fl.sections.SaintVenantKirchhoff(2.1e11, 0.3, 7800.0)
    bodies = (
        fl.Shell(MESH, layer),
        fl.ThinShell(patch, layer),
        fl.Solid.brick((1, 1, 1), elastic, cells=(1, 1, 1)),
    )
    scene = fl.Scene(gravity=(0, 0, -9.81))
    for body in bodies:
        body.clamp("a=0")
        scene.add(body)
    result = fl.statics(scene)
    shell, thin, solid = bodies
    return {
        "resultants": fl.post.resultants(result, shell),
        "thin resultants": fl.post.thin_resultants(result, thin),
        "stresses": fl.post.solid_stresses(result, solid),
    }


def bounced() -> object:
    """Statistics of contacts with impacts."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    ball = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0, 0, 0.11)))
    sphere, floor = (
        fl.contact.Sphere(ball.point("centre"), 0.1),
        fl.contact.Plane(fl.ground(), (0, 0, 1)),
    )
    scene.add(fl.contact.Contact(sphere, floor, fl.contact.Impact()))
    contacts = fl.GeneralisedAlpha().run(scene, duration=0.1, step=1e-2).contacts
    assert contacts is not None
    return contacts


def other_results() -> dict[str, object]:
    """Results of everything else that is solved, and what they consist of."""
    column = fl.Scene()
    beam = column.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=8, name="column"))
    column.add(fl.Clamp(beam.point("start")))
    column.add(fl.PointLoad(beam.point("end"), force=(-3e4, 0, 0)))
    seen: list[fl.stability.PathState] = []
    path = fl.follow_path(column, 1.1, observe={"seen": lambda s: seen.append(s) or 0.0})
    scheme, step = fl.GeneralisedAlpha(), fl.schemes.AdaptiveStep(tolerance=1.0)
    steps = scheme.run(SCENE, duration=2e-3, step=step).steps
    basis = fl.reduction.craig_bampton(SCENE, [], 2, at=STATIC)
    line = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 4)

    def build(mesh: fl.mesh.LineMesh) -> fl.Scene:
        scene = fl.Scene()
        arm = scene.add(fl.Beam(mesh, SECTION, name="arm"))
        scene.add(fl.Clamp(arm.point("start")))
        scene.add(fl.PointLoad(arm.point("end"), force=(0, 0, -10.0)))
        return scene

    loads = fl.adaptivity.adapt_loads(build, line, [0.5, 1.0], tolerance=0.2)
    motion = fl.adaptivity.adapt_motion(
        build, line, duration=2e-3, every=1e-3, tolerance=0.5, size=1.0
    )
    resting = fl.Scene()
    ball = resting.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), name="ball"))
    sphere = fl.contact.Sphere(ball.point("centre"), 0.1)
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, -0.1))
    contact = resting.add(fl.contact.Contact(sphere, floor, fl.contact.Penalty(1e6)))
    run = scheme.run(resting, duration=2e-3, step=1e-3)
    return {
        "loads": fl.follow_loads(SCENE),
        "path": path,
        "path state": seen[-1],
        "critical point": path.critical[0],
        "station": path.stations[0],
        "buckling": fl.buckling(column, 2),
        "steps": steps,
        "basis": basis,
        "reduced states": basis.project(STATIC),
        "reduced equilibrium": fl.reduction.reduced_statics(SCENE, basis),
        "adapted loads": loads,
        "load segment": loads.segments[-1],
        "adapted motion": motion,
        "motion segment": motion.segments[-1],
        "space error": fl.adaptivity.space_error(STATIC, SCENE.bodies[0], SCENE),
        "adapted": fl.adaptivity.adapt(build, line, tolerance=0.2),
        "contact forces": fl.post.contact_forces(run, contact),
        "info": STATIC.info,
        "info of a body": STATIC.info.bodies[0],
        "info of supports": STATIC.info.supports,
        "impacts": bounced(),
    }


SHOWN |= bent_bodies() | other_results()


@pytest.mark.parametrize("name", SHOWN)
def test_a_representation_has_one_to_ten_short_lines(name):
    lines = repr(SHOWN[name]).splitlines()
    assert 1 <= len(lines) <= 10
    assert max(map(len, lines)) <= (400 if name == "joint" else 120)
    assert " at 0x" not in repr(SHOWN[name])


@pytest.mark.parametrize("name", ["scene", "beam", "surface", "statics", "motion", "vibrations"])
def test_a_notebook_shows_a_table(name):
    html = SHOWN[name]._repr_html_()
    assert html.startswith("<table><caption>") and html.endswith("</table>")
    assert html.count("<tr>") >= 3


def test_a_representation_says_what_matters():
    assert "loads=1" in repr(SCENE) and "'arm'" in repr(SCENE)
    assert "frames=array of shape (9, 4, 3)" in repr(SCENE.bodies[0]) and "'end'" in repr(
        SCENE.bodies[0]
    )
    u = np.linalg.norm(STATIC.displacement(SCENE.bodies[0].point("end"))[-1])
    assert f"largest_displacement[-1]={u:.8g}" in repr(STATIC)
    assert "array of shape (100, 3)" in repr(MESH)


@pytest.mark.parametrize("name", SHOWN)
def test_what_is_shown_can_be_asked(name):
    """Each name is an expression for the value, or for the list whose length or names it shows."""
    shown = SHOWN[name]
    for key, value in getattr(shown, "_summary", tuple)():
        asked = eval(f"shown.{key}", {"shown": shown})
        assert not callable(asked)
        if isinstance(value, int | float | str):
            expected = len(asked) if isinstance(asked, list) else asked
            assert value == expected or value != value  # not a number
        else:
            assert len(value) == len(asked) if isinstance(value, list) else value is asked


def test_largest_displacement_of_thin_shells_is_of_their_points():
    """Slopes at points of a thin shell are no displacements."""
    patch = fl.mesh.smooth_patch(lambda a, b: np.array([0.01 * a, 0.01 * b, 0.0]), (2, 2))
    shell = fl.ThinShell(patch, fl.ShellSection.layer(1e-4, STEEL), name="roof")
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.AreaLoad(shell, force=(0, 0, 1e3)))
    result = fl.statics(scene)
    moved = np.linalg.norm(result.displacements(shell), axis=-1).max(axis=-1)
    np.testing.assert_array_equal(result.largest_displacement, moved)
    assert moved[-1] == pytest.approx(result.displacement("roof.10")[-1, 2], rel=0.05)


def test_a_result_without_a_record_is_shown():
    run = fl.GeneralisedAlpha().run(
        SCENE, duration=1e-3, step=1e-3, record=fl.schemes.Record.FRAMES
    )
    assert "times[-1]=0.001" in repr(run)
