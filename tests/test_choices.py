"""Terms that a scene leaves out of the matrix: logs, overrides, and an unchanged motion."""

import logging

import numpy as np
import pytest

import fem_lie as fl

SECTION = fl.Section.rectangle(0.01, 0.01, fl.Material(E=1e9, nu=0.3, density=1000.0))


def pendulum(matrix_terms=None, spin=2.0, **options):
    scene = fl.Scene((0, 0, -9.81), matrix_terms=matrix_terms)
    points = np.linspace((0, 0, 0), (0.4, 0, 0), 5)
    ends = {"start": [0], "end": [4]}
    mesh = fl.mesh.LineMesh.from_cells(points, [(i, i + 1) for i in range(4)], named_points=ends)
    bar = scene.add(fl.Beam(mesh, SECTION, **options))
    body = scene.add(fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4), (0.4, 0.1, 0)))
    scene.add(fl.joints.RigidLink(bar.point("end"), body.point("centre")))
    scene.add(fl.joints.Spherical(fl.ground(), bar.point("start")))
    for item in (bar, body):
        item.add_velocity(omega=(0, 0, spin), about=bar.point("start"))
    return scene, bar.point("end")


def run(scene, step=1e-3):
    return fl.GeneralisedAlpha(tolerance=1e-10).run(scene, duration=20 * step, step=step)


@pytest.mark.parametrize(
    "matrix_terms", [fl.schemes.MatrixTerms(g, k) for g in (True, False) for k in (True, False)]
)
def test_choices_change_the_iterations_and_not_the_motion(matrix_terms):
    scene, tip = pendulum(matrix_terms)
    reference, point = pendulum()
    here, there = run(scene).position(tip)[-1], run(reference).position(point)[-1]
    # twenty steps of 20 mm/s · 1e-3 s, each converged to 1e-10 of that
    np.testing.assert_allclose(here, there, rtol=0, atol=1e-10)


@pytest.mark.parametrize(
    ("matrix_terms", "spin", "said"),
    [
        (None, 2.0, "gyroscopic terms in the matrix: no"),
        (None, 20.0, "gyroscopic terms in the matrix: yes"),
        (fl.schemes.MatrixTerms(gyroscopic=True), 0.0, "gyroscopic terms in the matrix: yes"),
        (fl.schemes.MatrixTerms(geometric=False), 0.0, "geometric stiffness: no"),
        (None, 0.0, "6 nodes, 1 of them rigidly attached, 3 constraints"),
        (None, 0.0, "5 nodes on SE(3), 0 on R³×SO(3), all with three rotations"),
        (None, 0.0, "matrix: Automatic"),
    ],
)
def test_the_scene_says_what_it_chose(matrix_terms, spin, said, caplog):
    scene, _ = pendulum(matrix_terms, spin)
    with caplog.at_level(logging.INFO, logger="fem_lie"):
        run(scene)
    assert any(said in message for message in caplog.messages), caplog.messages


def test_without_rotary_inertia_slow_motions_stay():
    """A slender beam: its second moments are 1/200 of what its mass does at that length."""
    tips = [
        run(scene).position(point)[-1]
        for scene, point in (pendulum(), pendulum(rotary_inertia=False))
    ]
    np.testing.assert_allclose(*tips, rtol=0, atol=1e-5)
    assert np.abs(tips[0] - tips[1]).max() > 1e-12
