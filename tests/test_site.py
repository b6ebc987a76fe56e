"""What the site shows as worked examples does what it says."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import fem_lie as fl
from tests.interruption import interrupted

DOCS = Path(__file__).parents[1] / "docs"
SCENES = sorted((DOCS / "scenes").glob("*.py"))


def test_an_element_of_ones_own():
    found = runpy.run_path(str(DOCS / "how_to" / "element.py"))
    assert found["errors"][1] <= 5e-3
    assert 1.9 <= found["order"] <= 2.2


def test_an_element_of_ones_own_on_position_gradient_nodes():
    found = runpy.run_path(str(DOCS / "how_to" / "gradient_element.py"))
    assert found["errors"][1] <= 5e-6
    assert 3.9 <= found["order"] <= 4.2


def test_a_contact_surface_of_ones_own():
    found = runpy.run_path(str(DOCS / "how_to" / "contact_surface.py"))
    assert max(found["errors"].values()) <= 3e-5
    assert found["energy"] <= 1e-12
    assert found["moment"] <= 1e-5
    body = fl.RigidBody(1.0, np.eye(3), (1.0, 0.0, -0.1))
    torus = found["Torus"](fl.ground(), 1.0, 0.3)
    fl.contact.Contact(
        fl.contact.Box(body.point("centre"), (0.1, 0.1, 0.1)), torus, fl.contact.Penalty(1e3)
    ).check()
    with pytest.raises(ValueError, match=r"overlap by 0\.0[0-9]+ at"):
        fl.contact.Contact(
            fl.contact.Sphere(body.point("centre"), 0.25), torus, fl.contact.Penalty(1e3)
        ).check()
    with pytest.raises(ValueError, match="touch by Penalty, not Impact"):
        fl.contact.Contact(
            fl.contact.Sphere(body.point("centre"), 0.05), torus, fl.contact.Impact()
        ).check()


def test_a_load_of_ones_own():
    """It converges, and its arguments are checked without a line of its own."""
    found = runpy.run_path(str(DOCS / "how_to" / "load.py"))
    assert found["errors"][1] <= 2e-3
    assert 1.8 <= found["order"] <= 2.2
    ramp, section = found["RampLoad"], fl.Section.circle(0.01, fl.Material(1e9, 0.3, 1e3))
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2)
    with pytest.raises(TypeError, match="RampLoad: beam must be a Beam, got 3"):
        ramp(3, (0, 0, 1))
    with pytest.raises(TypeError, match="RampLoad: history"):
        ramp(beam, (0, 0, 1), history="slow")
    with pytest.raises(ValueError, match="force of the RampLoad on Beam must be 3 finite numbers"):
        ramp(beam, (0, 1)).check()


def test_an_error_estimate_of_ones_own():
    found = runpy.run_path(str(DOCS / "how_to" / "estimate.py"))
    assert abs(found["effectivity"] - 1.0) <= 1e-5
    assert found["adapted"].relative[-1] <= 0.01
    assert 50 <= len(found["adapted"].mesh.cells) <= 64


def test_a_composition_of_ones_own():
    found = runpy.run_path(str(DOCS / "how_to" / "composition.py"))
    assert 3.9 <= found["order"] <= 4.1


@pytest.fixture(scope="module")
def own_scheme():
    """What the file of a whole scheme defines."""
    return runpy.run_path(str(DOCS / "how_to" / "scheme.py"))


def test_a_scheme_of_ones_own(own_scheme):
    assert 1.9 <= own_scheme["order"] <= 2.1
    scheme, plan = own_scheme["Newmark"](), {"duration": 0.1, "step": 1e-3, "progress": False}
    found = scheme.run(own_scheme["pendulum"](), **plan)
    known = fl.GeneralisedAlpha(radius=1.0).run(own_scheme["pendulum"](), **plan)
    assert np.abs(found.frames - known.frames)[:, :, 0].max() < 1e-4 * 0.5
    assert found.energy_error < 1e-3


def test_a_scheme_of_ones_own_resumes_to_the_last_bit(own_scheme, tmp_path):
    scheme, plan = own_scheme["Newmark"](gamma=0.6), {"duration": 0.04, "step": 1e-3}
    whole, file = scheme.run(own_scheme["pendulum"](), **plan), tmp_path / "run.h5"
    with interrupted():
        scheme.run(own_scheme["pendulum"](), **plan, file=file, checkpoint_every=17)
    resumed = scheme.resume(own_scheme["pendulum"](), file)
    for name in ("times", "frames", "velocities", "joint_forces", "kinetic", "iterations"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name), err_msg=name)


def test_steps_of_a_scheme_of_ones_own_are_divided(own_scheme):
    """A step of most of a swing has no solution in full."""
    scheme = own_scheme["Newmark"](gamma=0.6)
    found = scheme.run(own_scheme["pendulum"](), duration=1.2, step=0.3, progress=False)
    assert found.divided >= 1
    fine = scheme.run(own_scheme["pendulum"](), duration=1.2, step=1e-3, progress=False)
    assert found.energy_error < 0.2 and fine.divided == 0


def test_a_joint_of_ones_own():
    assert runpy.run_path(str(DOCS / "how_to" / "joint.py"))["error"] <= 1e-9


PARTS = "composition", "contact_surface", "element", "estimate", "gradient_element", "joint", "load"


@pytest.mark.parametrize("part", PARTS)
def test_a_part_of_ones_own_is_one_short_file(part):
    """With its body, where it has one; ``test_public_names`` holds them to public names."""
    lines = (DOCS / "how_to" / f"{part}.py").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 150


@pytest.mark.parametrize("scene", [pytest.param(file, id=file.stem) for file in SCENES])
def test_scenes_of_the_first_page(scene, tmp_path, monkeypatch):
    """Each makes its picture and its page in a few lines."""
    monkeypatch.chdir(tmp_path)
    lines = scene.read_text(encoding="utf-8").splitlines()
    runpy.run_path(str(scene))
    assert sum(line != "" for line in lines[1:]) <= 20
    assert (tmp_path / f"{scene.stem}.png").stat().st_size > 10_000
    assert 500_000 < (tmp_path / f"{scene.stem}.html").stat().st_size < 5_000_000


def test_there_are_eight_scenes():
    assert len(SCENES) == 8
