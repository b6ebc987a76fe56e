"""Stability: inertia of the tangent, linear buckling, critical points, branches, imperfections."""

import numpy as np
import pytest
import ufl
from scipy.special import ellipk
from test_paths import column

import fem_lie as fl
from tests.assembled import Assembled
from tests.random_scenes import PROPORTIONAL, random_scene
from tests.scene_builder import build


@pytest.mark.parametrize("ends", ["fixed-free", "pinned-pinned"])
def test_linear_buckling_and_path_find_eulers_load(ends):
    scene, _, _ = column(ends, 16)
    modes = fl.buckling(scene, 3)
    # the next ones are 9 and 25, or 4 and 9 times as high
    ratios = [1.0, 9.0, 25.0] if ends == "fixed-free" else [1.0, 4.0, 9.0]
    np.testing.assert_allclose(modes.factors, ratios, rtol=3e-3)
    path = fl.follow_path(scene, 1.2)
    (point,) = path.critical
    assert point.kind is fl.stability.CriticalPointType.BIFURCATION
    assert point.negative_pivots == (0, 1)
    assert path.complete and path.negative_pivots[-1] == 1
    assert abs(modes.factors[0] - 1.0) <= 1e-3
    assert abs(point.factor - modes.factors[0]) <= 1e-3
    low, high = point.bracket
    assert 0 < high - low <= 1e-6 * point.factor  # located as promised
    # the mode of the path is that of linear theory
    a, b = modes.shape(1)[:, 0], point.shapes[0][:, 0]
    across = modes.shape(1)[:, :3], point.shapes[0][:, :3]
    cosine = abs(np.sum(across[0] * across[1])) / np.linalg.norm(across[0])
    assert cosine / np.linalg.norm(across[1]) == pytest.approx(1.0, abs=1e-6), (a, b)


def test_branches_of_a_column_are_the_elastica_on_both_sides():
    scene, beam, _ = column("fixed-free", 16)
    point = fl.follow_path(scene, 1.1).bifurcations[0]
    tips = []
    for side in (1, -1):
        start = fl.stability.switch_branch(scene, point, side=side)
        path = fl.follow_path(scene, 1.2, start=start)
        assert path.complete and path.stable.all()
        tips.append(path.position(beam.point("end"))[-1])
    np.testing.assert_allclose(tips[0] * [-1, 1, 1], tips[1], atol=1e-7)
    m = _modulus(path.factors[-1] / point.factor)
    assert abs(tips[0][0]) == pytest.approx(2 * np.sqrt(m) / ellipk(m), rel=1e-4)


def _modulus(over: float) -> float:
    from scipy.optimize import brentq

    return brentq(lambda m: (2 * ellipk(m) / np.pi) ** 2 - over, 1e-9, 0.99)


def test_imperfect_column_bends_into_the_branch():
    """The smaller the imperfection, the nearer it comes, and there is no critical point."""
    scene, _, _ = column("fixed-free", 16)
    modes = fl.buckling(scene, 1)
    point = fl.follow_path(scene, 1.1).bifurcations[0]
    exact = fl.follow_path(scene, 1.2, start=fl.stability.switch_branch(scene, point))
    gaps = []
    for size in (1e-2, 1e-3):
        path = fl.follow_path(
            fl.stability.apply_imperfections(scene, fl.stability.ModeImperfection(modes, 1, size)),
            1.2,
        )
        assert path.complete and not path.critical and path.stable.all()
        ends = [abs(p.position("column.end")[-1, 0]) for p in (path, exact)]
        gaps.append(abs(ends[0] - ends[1]))
    assert gaps[1] <= 0.15 * gaps[0]  # of first order away from the bifurcation


def test_flat_plate_buckles_at_the_load_of_a_column_and_of_bryan():
    """A simply supported square: N = 4 pi² D/a²; Poisson's ratio does not matter."""
    t, nu, n = 0.01, 0.3, 12
    plate = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (n, n)),
        fl.ShellSection.layer(t, fl.Material(1.0, nu, 1.0)),
        name="plate",
    )
    z = plate.model.held
    for name in ("a=0", "a=1", "b=0", "b=1"):
        z[[p.node for p in plate.points(name)], 2] = True
    z[[p.node for p in plate.points("a=0")], 0] = True
    z[plate.point("00").node, 1] = True
    scene = fl.Scene()
    scene.add(plate)
    bryan = 4 * np.pi**2 * t**3 / (12 * (1 - nu**2))
    scene.add(fl.loads.EdgeLoad(plate, "a=1", force=(-bryan, 0, 0)))
    modes = fl.buckling(scene, 2)
    assert modes.factors[0] == pytest.approx(1.0, rel=0.02)  # the mesh; shear takes 1e-3
    # two half waves along the load: (2 + 1/2)² over 4
    assert modes.factors[1] == pytest.approx(6.25 / 4, rel=0.04)
    point = fl.follow_path(scene, fl.stability.PathEnds(1.2, critical_points=1)).critical[0]
    assert point.factor == pytest.approx(modes.factors[0], rel=1e-3)
    assert point.negative_pivots == (0, 1)


def test_imperfections_are_free_of_stress_and_keep_supports():
    scene, _, _ = column("pinned-pinned", 8)
    wave = fl.stability.FieldImperfection(lambda x: (0.01 * np.sin(np.pi * x[2]), 0.0, 0.0))
    random = fl.stability.RandomImperfection(0.005, 0.5, seed=3)
    other = fl.stability.apply_imperfections(scene, wave, random)
    again = fl.stability.apply_imperfections(
        scene, wave, fl.stability.RandomImperfection(0.005, 0.5, seed=3)
    )
    assert scene.bodies[0].frames[4, 0, 0] == 0.0  # the perfect one stays
    np.testing.assert_array_equal(other.bodies[0].frames, again.bodies[0].frames)
    assert np.abs(other.bodies[0].frames[:, 0, 0]).max() > 5e-3
    of = Assembled(other, dynamics=False)
    of.equations.prescribed(0.0).act(0.0)
    assert np.abs(of.residual(of.start)[: 6 * of.count]).max() <= 1e-9  # EA is 1e6
    slope = np.pi * 0.01
    tangent = fl.stability.apply_imperfections(scene, wave).bodies[0].frames[0, 1]
    assert tangent[0] / tangent[2] == pytest.approx(slope, rel=1e-3)


def test_shell_normals_follow_the_field_and_symmetry_stays():
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (8, 8)),
        fl.ShellSection.layer(0.01, fl.Material(1.0, 0.3, 1.0)),
        name="plate",
    )
    shell.symmetry("a=0", (1, 0, 0))
    scene = fl.Scene()
    scene.add(shell)
    bump = fl.stability.FieldImperfection(lambda x: (0.0, 0.0, 0.01 * (x[0] + np.sin(x[1]))))
    H = fl.stability.apply_imperfections(scene, bump).bodies[0].frames
    inside = shell.frames[:, 0, 0] > 0
    x = shell.frames[:, 0]
    normal = np.column_stack([-0.01 + 0 * x[:, 0], -0.01 * np.cos(x[:, 1]), 1 + 0 * x[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, np.newaxis]
    np.testing.assert_allclose(H[inside, 3], normal[inside], atol=1e-8)
    np.testing.assert_allclose(H[~inside, 3, 0], 0.0, atol=1e-15)  # no tilt out of the plane


def test_modes_that_do_not_exist_are_refused():
    scene, _, _ = column("fixed-free", 4)
    modes = fl.buckling(scene, 2)
    with pytest.raises(ValueError, match="modes are 1 … 2, got 3"):
        modes.shape(3)
    with pytest.raises(ValueError, match="modes are 1 … 2, got 0"):
        fl.stability.apply_imperfections(scene, fl.stability.ModeImperfection(modes, 0, 0.1))
    point = fl.follow_path(scene, 1.1).bifurcations[0]
    with pytest.raises(ValueError, match="modes are 1"):
        fl.stability.switch_branch(scene, point, mode=9)
    with pytest.raises(ValueError, match="side 1 or −1"):
        fl.stability.switch_branch(scene, point, side=2)
    with pytest.raises(ValueError, match="degrees of freedom"):
        fl.buckling(scene, 1000)
    with pytest.raises(ValueError, match="at least one imperfection"):
        fl.stability.apply_imperfections(scene)


@pytest.mark.parametrize("seed", [60, 148])
def test_round_off_is_no_load_factor(seed):
    """Constraints bring zeros that are defective: they came out as factors of 1e9 and above."""
    scene = build(random_scene(seed, PROPORTIONAL), static=True).scene
    found = fl.buckling(scene, 1).factors
    with pytest.raises(fl.ConvergenceError, match="found 1 of 2 positive") as caught:
        fl.buckling(scene, 2)
    np.testing.assert_allclose(caught.value.result.factors, found, rtol=1e-8)


def test_rigid_bodies_buckle():
    """A post of length l on a hinge with the spring k, under its weight: ``m g l = k``."""
    scene = fl.Scene((0, 0, -9.81))
    post = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), (0, 0, 0.7)))
    hinge = scene.add(
        fl.joints.Revolute(fl.ground(), post.point("centre"), axis=(0, 1, 0), at=(0, 0, 0))
    )
    scene.add(fl.joints.Spring(hinge.angle, 30.0))
    found = fl.buckling(scene, 1).factors
    np.testing.assert_allclose(found, 30.0 / (2.0 * 9.81 * 0.7), rtol=1e-10)


class Plain(fl.elements.DirectorBeam):
    """Its energy as a form, without a stress to be carried."""

    def forms(self, nodal, cells):
        mesh = nodal.function.function_space.mesh
        stretch, curvature = fl.elements.director_strains(nodal)
        strain = ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *curvature])
        energy = 0.5 * ufl.inner(strain, fl.extend.cellwise(mesh, cells.stiffness) * strain)
        dx = ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": 1})
        return fl.local_frame_forms(energy * dx, nodal)


def test_elements_that_carry_no_stress_are_no_structure_to_buckle_linearly():
    """Their tangent in the unloaded frames knows nothing of loads: any factor would be wrong."""
    scene, section = fl.Scene(), fl.Section.circle(0.01, fl.Material(1e9, 0.3, 1e3))
    for name, formulation in (("bar", fl.elements.DirectorBeam(1)), ("own", Plain(1))):
        scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4, formulation=formulation))
        scene.bodies[-1].name = name
        scene.add(fl.Clamp(scene.bodies[-1].point("start")))
        scene.add(fl.PointLoad(scene.bodies[-1].point("end"), force=(-1, 0, 0)))
    with pytest.raises(ValueError, match="the elements of own have no stress"):
        fl.buckling(scene, 1)
