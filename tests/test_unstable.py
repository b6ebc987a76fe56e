"""Equilibrium that is unstable says so; loads without potential are tested by the determinant."""

from dataclasses import replace

import numpy as np
import pytest
from test_paths import arch, column

import fem_lie as fl
from benchmarks.levels import cantilever, frame


def test_an_unstable_equilibrium_says_so():
    """A straight column under twice Euler's load, and Lee's frame below its limit load of 18557."""
    column = fl.Beam.straight(
        (0, 0, 0), (0, 0, 1), fl.Section.circle(0.01, fl.Material(2e11, 0.3, 7850.0)), cells=8
    )
    scene, euler = fl.Scene(), np.pi**2 / 4 * column.model.stiffness[0, 4, 4]
    scene.add(column)
    scene.add(fl.Clamp(column.point("start")))
    scene.add(fl.PointLoad(column.point("end"), (0, 0, -2 * euler)))
    with pytest.warns(
        fl.stability.UnstableEquilibriumWarning, match="unstable at load factor 1"
    ) as caught:
        result = fl.statics(scene)
    assert len(caught) == 1
    np.testing.assert_array_equal(result.negative_pivots, [2])  # one in each plane
    assert not result.stable.any()
    below = fl.statics(frame(18000.0), levels=(0.5, 1.0))  # warnings are errors
    np.testing.assert_array_equal(below.negative_pivots, [0, 0])


def test_a_load_beyond_its_limit_arrives_at_a_stable_state_and_says_that_it_snapped():
    """Lee's frame at P = 20000, beyond its limit load of 18557."""
    with pytest.warns(
        fl.stability.UnstableEquilibriumWarning, match=r"maximum near 0\.9[23]"
    ) as caught:
        result = fl.statics(frame(20000.0))
    assert len(caught) == 1 and result.stable.all()


def test_a_limit_load_on_the_way_is_reported_though_the_end_is_stable():
    scene, _ = arch(24)
    with pytest.warns(
        fl.stability.UnstableEquilibriumWarning, match=r"maximum near 0\.8"
    ) as caught:
        result = fl.follow_loads(scene)
    assert len(caught) == 1
    assert result.stable.all() and len(result.load_maxima) == 1


def test_constraints_do_not_count_as_instability():
    """A hinge by a joint has five multipliers, a hinge by supports none: the same pivots."""
    for load, negative in ((0.9, 0), (1.1, 1)):
        scene, _, _ = column("pinned-pinned", 8, factor=load)
        with pytest.warns(fl.stability.UnstableEquilibriumWarning) if negative else _silent():
            result = fl.statics(scene, load_steps=1)
        np.testing.assert_array_equal(result.negative_pivots, [negative])


def _silent():
    from contextlib import nullcontext

    return nullcontext()


def right_angle(moment: float) -> fl.Scene:
    """Hinged right-angle frame under end couples, Argyris et al., CMAME 20 (1979) 105.

    One foot slides towards the other; the frame buckles out of its plane.
    """
    side, foot = 240.0, 240.0 / np.sqrt(2)
    section = fl.Section.rectangle(30.0, 0.6, fl.Material(71240.0, 0.31, 1e-9))
    corners = [(-foot, 0, 0), (0, foot, 0), (foot, 0, 0)]
    assert np.isclose(np.linalg.norm(np.subtract(*corners[:2])), side)
    left, right = (
        fl.Beam.straight(*ends, section, cells=10, up=(0, 0, 1))
        for ends in (corners[:2], corners[1:])
    )
    scene = fl.Scene()
    for body in left, right:
        scene.add(body)
    start, end, axis = left.point("start"), right.point("end"), (0, 0, 1)
    scene.add(fl.joints.Fixed(left.point("end"), right.point("start")))
    scene.add(fl.joints.Revolute(fl.ground(), start, axis=axis))
    scene.add(fl.joints.Planar(fl.ground(), end, axis=axis))
    scene.add(fl.joints.InPlane(fl.ground(), end, axis=(0, 1, 0)))
    scene.add(fl.PointLoad(start, moment=(0, 0, moment)))
    scene.add(fl.PointLoad(end, moment=(0, 0, -moment)))
    return scene


def test_moments_about_the_axes_of_hinges_have_a_potential():
    """The frame buckles at ±622 (Argyris); with couples that open it, twice before -640.

    Both eigenvalues are counted though moments about fixed axes have no potential in space.
    """
    for moment, negative in ((610.0, 0), (640.0, 1), (-610.0, 0), (-640.0, 2)):
        with pytest.warns(fl.stability.UnstableEquilibriumWarning) if negative else _silent():
            result = fl.statics(right_angle(moment), load_steps=2)
        assert result.negative_pivots.tolist() == [0, negative]
    for sign in 1, -1:
        path = fl.follow_path(right_angle(sign * 700.0), 1.0)
        assert 700.0 * path.critical[0].factor == pytest.approx(622.2, rel=5e-3)
        assert path.critical[0].negative_pivots == (0, 1)
    assert path.critical[1].negative_pivots == (1, 2)


def test_factorisations_are_counted():
    scene, _, _ = column("pinned-pinned", 8, factor=0.5)
    stepped, followed = fl.statics(scene), fl.follow_loads(scene)
    assert stepped.factorisations == stepped.total_iterations
    assert followed.factorisations == followed.total_iterations
    path = fl.follow_path(scene)
    assert path.factorisations >= path.total_iterations > len(path)


def coil(turns: float) -> fl.Scene:
    """A moment about a fixed axis and a little force along it."""
    return cantilever(
        32, [1e4] * 3 + [1e2] * 3, moment=(0, 0, 20 * np.pi * turns), force=(0, 0, 5 * turns)
    )


def test_critical_points_without_potential_are_marked_and_have_the_modes_of_the_whole_tangent():
    """Euler's column with a little torque about a fixed axis: by the determinant, the same load."""
    scene, beam, _ = column("pinned-pinned", 16)
    scene.add(fl.PointLoad(beam.point("start"), moment=(0, 0, 1e-3)))
    path = fl.follow_path(scene, 1.1)
    (point,) = path.critical
    assert not point.has_potential and "by the determinant" in str(point)
    assert point.kind is fl.stability.CriticalPointType.BIFURCATION and point.negative_pivots == (
        0,
        1,
    )
    assert point.factor == pytest.approx(1.0, rel=3e-3)
    shape = point.shapes[0]
    wave = np.sin(np.pi * np.linspace(0, 1, 17))
    across = np.einsum("nij,ni->nj", point.frames[:17, 1:], shape[:17, :3])[:, 0]
    np.testing.assert_allclose(np.abs(across), wave, atol=2e-3)
    aside = fl.stability.switch_branch(scene, point)
    assert np.abs(aside.positions[:, 0]).max() > 1e-3
    plain, _, _ = column("pinned-pinned", 16)
    assert fl.follow_path(plain, 1.1).critical[0].has_potential


def test_branch_refuses_to_come_back_on_the_path_it_leaves():
    """A state of a path that is no bifurcation, with the path's own tangent for a mode."""
    scene, _ = arch(12)
    path = fl.follow_path(scene, fl.stability.PathEnds(critical_points=1), resolution=0.1)
    station = path.stations[4]
    nodes = path.frames.shape[1]
    tangent = station.response[: 6 * nodes].reshape(nodes, 6)
    tangent = tangent / np.linalg.norm(tangent[:, :3], axis=1).max()
    false = replace(
        path.critical[0],
        kind=fl.stability.CriticalPointType.BIFURCATION,
        station=station,
        frames=path.frames[4],
        shapes=tangent[np.newaxis],
        rotation_only=np.array([False]),
    )
    with pytest.raises(fl.ConvergenceError, match="leads back onto its own path"):
        fl.stability.switch_branch(scene, false)


def test_path_says_where_it_ends_by_default():
    scene, _ = arch(12)
    scene.loads[:] = [
        replace(load, force=tuple(0.5 * f for f in load.force)) for load in scene.loads
    ]
    assert "until=" in fl.follow_path(scene).reason
    beyond = fl.follow_path(scene, fl.stability.PathEnds(2.0, critical_points=1))
    assert beyond.limits and "until=" not in beyond.reason


def test_levels_of_statics_find_the_temperature_at_which_a_clamped_column_buckles():
    """``4π²EI/L² = EA α T``; paths and buckling say that they do not follow temperatures."""
    strip = fl.Section.rectangle(0.03, 0.01, fl.Material(E=2.1e11, nu=0.3, density=7800.0))
    column = fl.Rod.straight((5, 2, 1), (5, 2, 2), strip, cells=16, name="column")
    expansion, stiffness = 1.2e-5, strip.stiffness
    critical = 4 * np.pi**2 * stiffness[4, 4] / (stiffness[0, 0] * expansion)
    scene = fl.Scene()
    scene.add(column)
    for end in "start", "end":
        scene.add(fl.Clamp(column.point(end)))
    scene.add(fl.loads.Temperature(column, rise=critical, expansion=expansion))
    with pytest.warns(fl.stability.UnstableEquilibriumWarning):
        found = fl.statics(scene, levels=(0.99, 1.01))
    np.testing.assert_array_equal(found.negative_pivots, [0, 1])
    for follow in fl.buckling, fl.follow_path, fl.follow_loads:
        with pytest.raises(ValueError, match=r"Temperature on column: use load steps, fl\.statics"):
            follow(scene)
