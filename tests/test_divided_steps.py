"""Steps that have no solution are made of smaller ones, in schemes that are made of others, too."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.hamel import rolling
from tests.test_coupled_impacts import bouncing_beam
from tests.test_multi_rate import chain, pushed
from tests.test_resume import same, stopped

COMPOSED = {"mean": fl.schemes.Composed(), "momenta": fl.schemes.Composed(fl.schemes.Variational())}


def bouncing() -> tuple[fl.Scene, fl.extend.Body]:
    """A beam whose nodes meet the floor one after the other."""
    scene = bouncing_beam()
    return scene, scene.bodies[0]


def spinning() -> tuple[fl.Scene, fl.extend.Body]:
    """A free body that turns by 0.7 rad in a step."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 2, 2.5)))
    body.add_velocity(omega=(3, 4, 5), about=body.point("centre"))
    return scene, body


def tumbling() -> tuple[fl.Scene, fl.extend.Body]:
    """Free bodies that spin, slide with friction and bounce on the floor and on each other."""
    scene, centres, law = fl.Scene(gravity=(0, 0, -9.81)), [], fl.contact.Impact(0.3, 0.5)
    for k in range(3):
        body = scene.add(fl.RigidBody(1.0, (1e-3, 2e-3, 2.5e-3), (0.21 * k, 0, 0.12)))
        body.add_velocity(omega=(15, -24, 36), about=body.point("centre"))
        body.add_velocity((-0.5 * k, 0, -0.5))
        centres.append(body.point("centre"))
    balls = fl.contact.Vertices(centres, 0.1)
    scene.add(fl.contact.Contact(balls, balls, law))
    scene.add(fl.contact.Contact(balls, fl.contact.Plane(fl.ground(), (0, 0, 1)), law))
    return scene, scene.bodies[0]


def revolving() -> tuple[fl.Scene, fl.extend.Body]:
    """A stiff beam that rotates by 3° in a step: along it vibrations grow in whole steps."""
    section = fl.Section.rectangle(0.02, 0.03, fl.Material(2.1e11, 0.3, 7850.0))
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=10))
    beam.add_velocity(omega=(0, 0, np.radians(3.0) / 1e-3), about=(0.3, 0, 0))
    return scene, beam


TWO = fl.GeneralisedAlpha(max_iterations=2)
DIVIDED = {
    "composed": (lambda two: COMPOSED["mean"], pushed, 2e-2, 10, 1e-11),
    # their energy goes up and down
    "composed of momenta": (lambda two: COMPOSED["momenta"], chain, 4e-2, 10, 0.05),
    "momenta": (lambda beam: fl.schemes.Variational(), revolving, 1e-3, 60, 5e-3),
    "multi-rate": (lambda two: fl.schemes.MultiRate({two: 3}), pushed, 2e-2, 3, 1e-11),
    "Hamel": (lambda disc: fl.schemes.Hamel(), rolling, 0.2, 6, 0.05),
    "free bodies": (lambda body: TWO, spinning, 0.1, 10, 1e-3),
    "impacts of free bodies": (lambda body: TWO, tumbling, 1e-2, 40, 1e-3),
    "impacts of flexible bodies": (lambda beam: TWO, bouncing, 2e-3, 50, 1e-4),
    "impacts by momenta": (
        lambda body: fl.schemes.Variational(tolerance=1e-8, max_iterations=3),
        tumbling,
        1e-2,
        40,
        1e-9,
    ),
}
"""Schemes, scenes, sizes and numbers of steps, and errors of the balance of energy."""


@pytest.mark.parametrize("name", DIVIDED)
def test_steps_without_a_solution_are_divided(tmp_path, name):
    """These runs had ended: forces change by their size within a step, or bodies turn far."""
    scheme_of, scene_of, h, steps, error = DIVIDED[name]
    scene, body = scene_of()
    scheme, file = scheme_of(body), tmp_path / "run.h5"
    plan = {"duration": steps * h, "step": h}
    result = scheme.run(scene, **plan)
    assert 0 < result.divided <= steps
    np.testing.assert_allclose(result.times, h * np.arange(steps + 1))
    assert result.joint_violations.max(initial=0.0) <= 1e-11
    assert result.balance_error <= error
    if result.contacts is not None:
        assert result.contacts.penetration.max() <= 1e-11
        assert np.diff(result.total_energy).max() <= error * result.total_energy[0]
        assert result.contacts.impact_loss.sum() > 1e-3 * result.total_energy[0]
    stopped(scheme, scene, file, steps - 1, **plan)
    same(scheme.resume(scene, file), result)
