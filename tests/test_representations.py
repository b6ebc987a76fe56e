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
    assert "nodes=9" in repr(SCENE.bodies[0]) and "'end'" in repr(SCENE.bodies[0])
    u = np.linalg.norm(STATIC.displacement(SCENE.bodies[0].point("end"))[-1])
    assert f"largest_displacement={u:.8g}" in repr(STATIC)
    assert "array of shape (100, 3)" in repr(MESH)


def test_a_result_without_a_record_is_shown():
    run = fl.GeneralisedAlpha().run(
        SCENE, duration=1e-3, step=1e-3, record=fl.schemes.Record.FRAMES
    )
    assert "states=2" in repr(run)
