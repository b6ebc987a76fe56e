"""Bad input: an error that says what was given and what is wanted, before anything is computed."""

import numpy as np
import pytest

import fem_lie as fl

SECTION = fl.Section.circle(0.01, fl.Material(1e9, 0.3, 1000.0))
NAN = float("nan")


def bar(**options) -> fl.Beam:
    return fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2, **options)


def scene_with(*items) -> fl.Scene:
    scene = fl.Scene()
    for item in items:
        scene.add(item)
    return scene


def run(scene: fl.Scene, *, radius=0.8, tolerance=1e-8, **options) -> fl.Result:
    settings = {"duration": 1.0, "step": 0.1} | options
    return fl.GeneralisedAlpha(radius=radius, tolerance=tolerance).run(scene, **settings)


def attached(load_of_point):
    """A scene with a clamped bar and what the function makes of it."""
    body = bar()
    return scene_with(body, fl.Clamp(body.point("start")), load_of_point(body))


def with_bar(item_of_bar):
    """A scene with a bar and what the function makes of it."""
    body = bar()
    return scene_with(body, item_of_bar(body))


def branch() -> fl.mesh.LineMesh:
    points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (1, 1, 0)]
    return fl.mesh.LineMesh.from_cells(points, [(0, 1), (1, 2), (1, 3)])


def kink() -> fl.mesh.LineMesh:
    return fl.mesh.LineMesh.from_cells([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 1), (1, 2)])


CASES = {
    "negative modulus": (lambda: fl.Material(-1.0, 0.3, 1.0), r"-1"),
    "negative density": (lambda: fl.Material(1.0, 0.3, -0.5), r"-0\.5"),
    "impossible Poisson ratio": (lambda: fl.Material(1.0, 0.7, 1.0), r"0\.7"),
    "negative width": (lambda: fl.Section.rectangle(-1, 1, fl.Material(1, 0, 1)), r"-1"),
    "tube inside out": (lambda: fl.Section.tube(2, 1, fl.Material(1, 0, 1)), r"2"),
    "indefinite stiffness": (
        lambda: fl.Section.from_stiffness(np.diag([1.0, 1, 1, -1, 1, 1])),
        "positive",
    ),
    "nan stiffness": (lambda: fl.Section.from_stiffness(np.diag([NAN] + [1.0] * 5)), "nan|finite"),
    "zero-length beam": (
        lambda: fl.Beam.straight((1, 0, 0), (1, 0, 0), SECTION, cells=2),
        "length",
    ),
    "zero-length cell": (
        lambda: fl.mesh.LineMesh.from_cells([(0, 0, 0), (0, 0, 0), (1, 0, 0)], [(0, 1), (1, 2)]),
        "length",
    ),
    "director element of degree 3": (lambda: fl.elements.DirectorBeam(3), r"1 or 2, got 3"),
    "no cells": (lambda: fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=0), "0"),
    "unknown group of cells": (
        lambda: fl.Beam(
            kink().__class__.from_cells([(0, 0, 0), (1, 0, 0)], [(0, 1)]), {"arc": SECTION}
        ),
        "'arc'",
    ),
    "unknown group of a line load": (
        lambda: attached(lambda b: fl.LineLoad(b, force=(0, 0, 1), cells="deck")),
        "'deck'",
    ),
    "missing point": (lambda: bar().point("middle"), "'middle'.*start"),
    "missing node": (lambda: bar().point(7), "7"),
    "curve with a kink": (
        lambda: fl.Beam.curve(lambda s: (s, abs(s - 0.3), 0), SECTION, cells=8),
        r"kink at s = 0\.3",
    ),
    "taper of a branching line": (lambda: fl.Beam(branch(), lambda s: SECTION), "one smooth line"),
    "twist of a line with a kink": (
        lambda: fl.Beam(kink(), SECTION, up=fl.sections.Twisted(lambda s: s)),
        "one smooth line",
    ),
    "link to ground": (
        lambda: with_bar(lambda b: fl.joints.RigidLink(fl.ground(), b.point("end"))),
        "ground",
    ),
    "pressure along the axis": (
        lambda: attached(lambda b: fl.loads.PressureLoad(b, 1.0, direction=(1, 0, 1))),
        "across the axis",
    ),
    "eigenstrain of three numbers": (
        lambda: attached(lambda b: fl.loads.Eigenstrain(b, (1, 0, 0))),
        "6",
    ),
    "negative damping": (lambda: bar(damping=fl.sections.Damping(stiffness=-1.0)), "≥ 0"),
    "up along the line": (lambda: bar(up=(1, 0, 0)), "along the line"),
    "nan load": (
        lambda: attached(lambda b: fl.PointLoad(b.point("end"), force=(0, NAN, 0))),
        "nan",
    ),
    "load of two numbers": (
        lambda: attached(lambda b: fl.PointLoad(b.point("end"), force=(0, 1))),
        "3",
    ),
    "load on ground": (lambda: fl.Scene().add(fl.PointLoad(fl.ground())), "ground"),
    "nan gravity": (lambda: fl.Scene(gravity=(0, 0, NAN)), "nan"),
    "joint to a body that is not there": (
        lambda: scene_with(fl.joints.Spherical(fl.ground(), bar(name="stray").point("start"))),
        "stray is not in the scene",
    ),
    "joint between points apart": (
        lambda: with_bar(lambda b: fl.joints.Fixed(b.point("start"), b.point("end"))),
        r"1 apart.*more than 1e-09 of the size 1.*at=\(0\.5, 0, 0\)",
    ),
    "joint without direction": (
        lambda: scene_with(
            *(lambda b: (b, fl.joints.Revolute(fl.ground(), b.point("end"), axis=(0, 0, 0))))(bar())
        ),
        "axis",
    ),
    "joint of ground to ground": (
        lambda: scene_with(fl.joints.Fixed(fl.ground(), fl.ground())),
        "ground",
    ),
    "body twice": (lambda: (lambda b: scene_with(b, b))(bar()), "already"),
    "name twice": (lambda: scene_with(bar(name="a"), bar(name="a")), "'a' already"),
    "massless body": (lambda: fl.RigidBody(0.0, (1, 1, 1)), "mass"),
    "inertia of no body": (lambda: fl.RigidBody(1.0, (1, 1, 5)), "inertia|triangle|principal"),
    "left-handed rotation": (
        lambda: fl.RigidBody(1.0, (1, 1, 1), rotation=np.diag([1, 1, -1])),
        "rotation",
    ),
    "motion that starts elsewhere": (
        lambda: attached(lambda b: fl.PrescribedMotion(b.point("end"), lambda t: np.zeros((4, 3)))),
        "start at its frame",
    ),
    "empty scene": (lambda: fl.extend.Equations(fl.Scene(), dynamics=True), "no body"),
    "step zero": (lambda: run(scene_with(bar()), step=0.0), "positive.*0"),
    "negative duration": (lambda: run(scene_with(bar()), duration=-1.0), "positive.*-1"),
    "nan step": (lambda: run(scene_with(bar()), step=NAN), "nan"),
    "duration not a multiple": (lambda: run(scene_with(bar()), duration=0.25), "multiple"),
    "radius above one": (lambda: run(scene_with(bar()), radius=1.2), r"\[0, 1\].*1\.2"),
    "negative radius": (lambda: run(scene_with(bar()), radius=-0.1), r"\[0, 1\].*-0\.1"),
    "tolerance zero": (lambda: run(scene_with(bar()), tolerance=0.0), "tolerance"),
    "save every zero": (lambda: run(scene_with(bar()), save_every=0), "save_every"),
    "no load steps": (lambda: fl.statics(scene_with(bar()), load_steps=0), "load_steps"),
    "limit of one": (lambda: fl.schemes.IterationLimit(1), "2"),
    "free policy": (lambda: fl.schemes.Automatic(cost=0), "cost"),
    "dynamics without inertia": (
        lambda: run(
            scene_with(
                fl.Beam.straight(
                    (0, 0, 0), (1, 0, 0), fl.Section.from_stiffness(np.eye(6)), cells=1
                )
            )
        ),
        "inertia",
    ),
    "velocities against a joint": (
        lambda: run(
            (
                lambda b: (
                    b.add_velocity((1, 0, 0)),
                    scene_with(b, fl.joints.Spherical(fl.ground(), b.point("start"))),
                )[1]
            )(bar())
        ),
        "velocities break Spherical",
    ),
    "velocity of a clamped point": (
        lambda: run(
            (lambda b: (b.add_velocity((1, 0, 0)), scene_with(b, fl.Clamp(b.point("end"))))[1])(
                bar()
            )
        ),
        "end is clamped, but has the initial velocity",
    ),
    "load history of nan": (
        lambda: run(
            attached(lambda b: fl.PointLoad(b.point("end"), force=(1, 0, 0), history=lambda t: NAN))
        ),
        "history of load 1 is nan",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_error_says_what_is_wrong(name):
    make, message = CASES[name]
    with pytest.raises(ValueError, match=f"(?s){message}"):
        make()


def test_scene_refuses_what_is_not_a_part_of_one():
    with pytest.raises(TypeError, match="bodies, joints, links, contacts, loads"):
        fl.Scene().add(SECTION)
