"""Scenes that differ in loads and drives alone are set up once, and give what new ones give."""

from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl
from tests.combinations import BODIES
from tests.combined_loads import loaded
from tests.scene_builder import build

SOFT = fl.Material(2e7, 0.3, 1200.0)


def beams() -> tuple[fl.Scene, fl.Beam, fl.joints.Drive]:
    """A driven bar with viscosity and a second one on a hinge."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    section = fl.Section.rectangle(0.02, 0.02, SOFT)
    damping = fl.sections.Damping(mass=1.0, stiffness=1e-3)
    one = scene.add(fl.Beam.straight((0, 0, 0), (0.3, 0, 0), section, cells=2, damping=damping))
    two = scene.add(fl.Beam.straight((0.3, 0, 0), (0.3, 0.5, 0), section, cells=2))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), one.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Fixed(one.point("end"), two.point("start")))
    drive = scene.add(fl.joints.Drive(hinge.angle, lambda t: t * t))
    return scene, two, drive


def loads(two: fl.Beam, k: float) -> list[fl.extend.Load]:
    return [
        fl.PointLoad(two.point("end"), (k, 0, 0.5), following=True, history=lambda t: 1.0 + k * t),
        fl.loads.PressureLoad(two, 0.1 * k),
        fl.loads.Eigenstrain(two, (0, 0, 0, 0, 0.01 * k, 0), history=lambda t: t),
    ]


def shells(cells: int = 2, formulation=None) -> tuple[fl.Scene, fl.Shell]:
    """A plate with fields of its own in each cell, clamped on one side."""
    scene = fl.Scene()
    section = fl.ShellSection.layer(0.01, fl.Material(1e6, 0.3, 1000.0))
    mesh = fl.mesh.parametric_surface(lambda u, v: (u, v, 0.02 * u * v), (cells, cells))
    plate = scene.add(fl.Shell(mesh, section, formulation=formulation))
    for node in np.flatnonzero(plate.frames[:, 0, 0] == 0.0):
        scene.add(fl.Clamp(plate.point(int(node))))
    return scene, plate


def same(a, b) -> None:
    for name in ("frames", "velocities", "joint_forces", "elastic", "kinetic", "balance"):
        if hasattr(b, name):
            np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)


SOLUTIONS = {
    "generalised alpha": lambda s: fl.GeneralisedAlpha().run(s, duration=0.02, step=2e-3),
    "adaptive": lambda s: fl.GeneralisedAlpha().run(
        s, duration=0.02, step=fl.schemes.AdaptiveStep(1e-2)
    ),
    "conserving": lambda s: fl.EnergyMomentum(1e-8).run(s, duration=0.01, step=1e-3),
    "statics": fl.statics,
}


@pytest.mark.parametrize("solution", SOLUTIONS)
def test_a_sweep_gives_to_the_last_bit_what_new_scenes_give(solution):
    solve = SOLUTIONS[solution]
    base, two, _ = beams()
    swept = [solve(base.with_loads(*loads(two, k))) for k in (0.1, 1.0, 0.2)]
    assert base.family.setup.made <= 2, "one more while the equations of the run before live"
    for k, result in zip((0.1, 1.0, 0.2), swept, strict=True):
        scene, two, _ = beams()
        for load in loads(two, k):
            scene.add(load)
        same(result, solve(scene))


@pytest.mark.parametrize("kind", BODIES)
def test_bodies_of_any_kind_forget_the_load_before(kind):
    """A second load on rods and cables with springs between elements was a NotImplementedError."""

    def solve(scene):
        return fl.GeneralisedAlpha().run(scene, duration=3e-4, step=1e-4)

    base = build(loaded(kind, "force")).scene
    (load,) = base.loads
    solve(base.with_loads(replace(load, force=-3 * np.array(load.force))))
    again = solve(base.with_loads(load))
    assert base.family.setup.made == 1
    same(again, solve(build(loaded(kind, "force")).scene))


@pytest.mark.parametrize(
    "formulation",
    [
        None,
        fl.elements.DisplacementBased(),
        fl.elements.HuWashizu(law=lambda e: 50 * sum(x * x for x in e)),
    ],
)
def test_shells_forget_the_load_before(formulation):
    base, plate = shells(formulation=formulation)
    for solve in (fl.statics, lambda s: fl.GeneralisedAlpha().run(s, duration=0.1, step=0.01)):
        swept = [
            solve(base.with_loads(fl.PointLoad(plate.point(-1), (0, 0, f)))) for f in (0.02, 1e-3)
        ]
        for f, result in zip((0.02, 1e-3), swept, strict=True):
            scene, own = shells(formulation=formulation)
            scene.add(fl.PointLoad(own.point(-1), (0, 0, f)))
            same(result, solve(scene))
    assert base.family.setup.made == 1


def test_a_moment_makes_a_shell_drill_in_its_own_scene_only():
    base, plate = shells()
    turned = base.with_loads(fl.PointLoad(plate.point(-1), moment=(0, 0, 1e-4)))
    pushed = base.with_loads(fl.PointLoad(plate.point(-1), (0, 0, 1e-3)))
    assert turned.has_drilling(plate) and not pushed.has_drilling(plate)
    results = [fl.statics(scene) for scene in (turned, pushed, turned)]
    assert base.family.setup.made == 2
    same(results[2], results[0])
    scene, own = shells()
    scene.add(fl.PointLoad(own.point(-1), (0, 0, 1e-3)))
    same(results[1], fl.statics(scene))


def test_drives_change_alone():
    base, two, drive = beams()
    base.add(fl.PointLoad(two.point("end"), (0.1, 0, 0)))
    scheme = fl.GeneralisedAlpha()
    for rate in (1.0, 3.0):
        scene = base.with_drives({drive: lambda t, rate=rate: rate * t * t})
        result = scheme.run(scene, duration=0.02, step=1e-3)
        assert result.coordinate(drive)[-1] == pytest.approx(rate * 4e-4, abs=1e-9)
    assert base.family.setup.made == 1 and drive.function(1.0) == 1.0
    new, two, other = beams()
    new.add(fl.PointLoad(two.point("end"), (0.1, 0, 0)))
    new.connections[new.connections.index(other)] = fl.joints.Drive(
        other.coordinate, lambda t: 3.0 * t * t
    )
    same(result, scheme.run(new, duration=0.02, step=1e-3))


def test_forms_are_assembled_anew_for_other_bodies_but_not_for_other_velocities():
    base = fl.Scene()
    section = fl.Section.rectangle(0.02, 0.02, SOFT)
    bar = base.add(fl.Beam.straight((0, 0, 0), (0.3, 0, 0), section, cells=2))
    first = fl.GeneralisedAlpha().run(base.with_loads(), duration=2e-3, step=1e-3)
    bar.add_velocity((0.0, 0.0, 0.3))
    second = fl.GeneralisedAlpha().run(base.with_loads(), duration=2e-3, step=1e-3)
    assert base.family.setup.made == 1
    assert np.abs(first.velocities - second.velocities).max() > 0.1
    bar.model.damping = fl.sections.Damping(mass=100.0)
    third = fl.GeneralisedAlpha().run(base.with_loads(), duration=2e-3, step=1e-3)
    assert base.family.setup.made == 2
    assert np.abs(third.velocities - second.velocities).max() > 0.01


def test_bad_sweeps_are_named():
    base, two, drive = beams()
    _, strange, other = beams()
    with pytest.raises(ValueError, match="not in the scene"):
        base.with_loads(fl.PointLoad(strange.point("end"), (1, 0, 0)))
    with pytest.raises(ValueError, match="not in the scene"):
        base.with_drives({other: None})
    with pytest.raises(ValueError, match="must start at"):
        base.with_drives({drive: lambda t: 1.0})
    with pytest.raises(TypeError, match="load"):
        base.with_loads(two)
