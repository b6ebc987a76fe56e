"""Frames of regions merged and split: what is missed is seen, momenta are kept, errors."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import regions as net_benchmark

PLASTIC = fl.Material(E=2e9, nu=0.3, density=1100.0)


def rod(force=0.0, cells=8):
    """It tumbles, and is struck at its end from 0.1 to 0.12 s."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.02, PLASTIC)
    damping = fl.sections.Damping(stiffness=0.02)
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=cells, damping=damping, name="rod")
    scene.add(beam)
    beam.add_velocity(omega=(0.5, 2.0, 1.0), about=(0.5, 0, 0))
    beam.add_velocity((0.1, 0.2, 0.3))
    if force:
        pulse = lambda t: np.sin(np.pi * (t - 0.1) / 0.02) * (0.1 < t < 0.12)  # noqa: E731
        scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, force), history=pulse))
    return scene


def test_merged_nodes_keep_the_deformation_at_the_start():
    scene = rod()
    (body,) = scene.bodies
    bent = np.zeros((9, 6))
    bent[:, 1] = 0.02 * np.linspace(0.0, 1.0, 9) ** 2
    body.model.start_frames = fl.lie.se3_retract(body.frames, bent)
    body.velocities[:] = 0.0
    free = fl.GeneralisedAlpha().run(scene, duration=1e-3, step=1e-3, progress=False)
    body.model.masters = np.zeros(9, dtype=int)
    tied = fl.GeneralisedAlpha().run(scene, duration=1e-2, step=1e-3, progress=False)
    assert free.elastic[0] > 0.0
    np.testing.assert_allclose(tied.elastic, free.elastic[0], rtol=1e-9)
    np.testing.assert_allclose(tied.frames[-1], tied.frames[0], atol=1e-12)


def test_heated_rigid_rod_stores_energy():
    """Its ends cannot move away from each other, so the energy is that of the prevented strain."""
    scene = rod()
    (body,) = scene.bodies
    body.model.masters = np.zeros(9, dtype=int)
    heat = fl.loads.Eigenstrain(body, (1e-3, 0, 0, 0, 0, 0), history=lambda t: t / 0.01)
    scene.add(heat)
    result = fl.GeneralisedAlpha().run(scene, duration=1e-2, step=1e-3, progress=False)
    wanted = 0.5 * 2e9 * 2e-4 * (1e-3 * result.times / 0.01) ** 2
    np.testing.assert_allclose(result.elastic, wanted, rtol=1e-9, atol=1e-12)


def test_a_struck_rod_is_split_and_merged_again():
    build = lambda: rod(force=20.0)  # noqa: E731
    found = fl.reduction.merged_motion(build, duration=1.0, step=2e-3, every=0.01, tolerance=1e-4)
    full = fl.GeneralisedAlpha().run(build(), duration=1.0, step=2e-3, progress=False)
    assert found.times[-1] == pytest.approx(1.0)
    frames = [part.frames for part in found.segments]
    assert frames[0] == frames[-1] == 1
    assert max(frames) > 5
    assert found.active_fraction < 0.7
    assert [part.change is None for part in found.segments] == [True] + [False] * (len(frames) - 1)
    assert found.momentum_error < 1e-12
    kinetic = full.kinetic[-1]
    assert abs(found.energy_change) < 1e-8 * kinetic
    rows = np.rint(found.times / 2e-3).astype(int)
    wanted, bent = (
        np.linalg.norm(H[:, 4, 0] - 0.5 * (H[:, 0, 0] + H[:, -1, 0]), axis=1)
        for H in (full.frames[rows], found.frames)
    )
    assert wanted.max() > 5e-3
    np.testing.assert_allclose(bent, wanted, atol=0.02 * wanted.max())
    assert "of 9 frames" in str(found)


def test_a_segment_with_activity_at_the_first_check_is_repeated():
    """A blow soon after a stretch has begun, but not so soon that it was seen before."""

    def build():
        scene = rod()
        blow = lambda t: np.sin(np.pi * (t - 0.013) / 0.02) * (0.013 < t < 0.033)  # noqa: E731
        scene.add(fl.PointLoad(scene.bodies[0].point("end"), force=(0, 0, 20.0), history=blow))
        return scene

    found = fl.reduction.merged_motion(build, duration=0.06, step=2e-3, every=0.01, tolerance=1e-4)
    full = fl.GeneralisedAlpha().run(build(), duration=0.06, step=2e-3, progress=False)
    assert found.repeated > 0
    assert found.segments[0].frames > 1
    ends = [H[-1, :, 0] for H in (found.frames, full.frames)]
    bent = np.linalg.norm(ends[1][4] - 0.5 * (ends[1][0] + ends[1][-1]))
    assert bent > 5e-4
    np.testing.assert_allclose(*ends, atol=0.1 * bent)


def test_the_net_of_the_benchmark():
    record = net_benchmark.main(count=4, duration=1.8, force=10.0)
    assert record["share"] < 0.6
    assert record["momentum_error"] < 1e-12
    assert record["energy_change"] < 1e-8
    assert record["deflection_error"] < 0.01


def chain(force=0.0):
    """Two rods on a hinge that fly freely; the second is struck at its end from 0.1 to 0.12 s."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.02, PLASTIC)
    damping = fl.sections.Damping(stiffness=0.02)
    first, second = (
        fl.Beam.straight((x, 0, 0), (x + 1, 0, 0), section, cells=4, damping=damping)
        for x in (0, 1)
    )
    for rod in (first, second):
        scene.add(rod)
        rod.add_velocity(omega=(0, 0, 0.7), about=(0.5, 0, 0))
        rod.add_velocity((0.1, 0.2, 0.3))
    scene.add(fl.joints.Revolute(first.point("end"), second.point("start"), axis=(0, 0, 1)))
    pulse = lambda t: np.sin(np.pi * (t - 0.1) / 0.02) * (0.1 < t < 0.12)  # noqa: E731
    scene.add(fl.PointLoad(second.point("end"), force=(0, force, 0), history=pulse))
    return scene


def test_regions_end_at_joints():
    build = lambda: chain(force=5.0)  # noqa: E731
    found = fl.reduction.merged_motion(build, duration=1.5, step=2e-3, every=0.01, tolerance=1e-4)
    full = fl.GeneralisedAlpha().run(build(), duration=1.5, step=2e-3, progress=False)
    frames = [part.frames for part in found.segments]
    assert frames[0] == 2 and frames[-1] <= 3
    assert max(frames) > 5
    assert found.momentum_error < 1e-12
    moved = full.frames[:, :, 0] - full.frames[0, :, 0]
    rows = np.rint(found.times / 2e-3).astype(int)
    away = found.frames[:, :, 0] - full.frames[rows, :, 0]
    assert np.abs(away).max() < 1e-3 * np.abs(moved).max()


def test_joints_count_their_turns_across_segments():
    """A drive turns a rod thrice, against a spring on the hinge whose energy counts turns."""

    def build():
        scene = rod(force=20.0)
        (body,) = scene.bodies
        body.velocities[:] = 0.0
        body.add_velocity(omega=(0, 0, 20.0), about=(0, 0, 0))
        hinge = scene.add(fl.joints.Revolute(fl.ground(), body.point("start"), axis=(0, 0, 1)))
        scene.add(fl.joints.Drive(hinge.angle, lambda t: 20.0 * t))
        scene.add(fl.joints.Spring(hinge.angle, stiffness=1e-3))
        return scene

    found = fl.reduction.merged_motion(build, duration=1.0, step=2e-3, every=0.01, tolerance=1e-4)
    last = found.segments[-1].result
    assert len(found.segments) > 2
    np.testing.assert_allclose(found.frames[-1, 0, 1, :2], [np.cos(20.0), np.sin(20.0)], atol=1e-6)
    assert last.elastic[-1] == pytest.approx(0.5 * 1e-3 * 20.0**2, abs=0.1)


def test_what_cannot_be_merged_is_said():
    def with_contact():
        scene = rod()
        ball = fl.contact.Sphere(scene.bodies[0].point("end"), radius=0.1)
        floor = fl.contact.Plane(fl.ground((0, 0, -1)), normal=(0, 0, 1))
        scene.add(fl.contact.Contact(ball, floor, fl.contact.Penalty(1e3)))
        return scene

    options = {"duration": 0.1, "step": 1e-3, "every": 0.01, "tolerance": 1e-3}
    with pytest.raises(ValueError, match="without contacts"):
        fl.reduction.merged_motion(with_contact, **options)
    with pytest.raises(TypeError, match="makes a Scene"):
        fl.reduction.merged_motion(rod(), **options)
    with pytest.raises(ValueError, match="multiple of the step"):
        fl.reduction.merged_motion(rod, **(options | {"every": 1.5e-3}))
    for name in options:
        with pytest.raises(ValueError, match=name):
            fl.reduction.merged_motion(rod, **(options | {name: 0.0}))
