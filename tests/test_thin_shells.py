"""Thin shells of bicubic patches: laws of the element, supports, statics against closed forms."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie.extend import node_types
from tests.assembled import Assembled
from tests.body_alone import BodyAlone

STEEL = fl.Material(1e3, 0.3, 2.0)
LAYER = fl.ShellSection.layer(0.1, STEEL)
UNSYMMETRIC = fl.ShellSection.laminate(
    [fl.sections.Ply(0.04, fl.Material(3e3, 0.2, 1.0)), fl.sections.Ply(0.06, STEEL)]
)
ELEMENTS = {
    "default": fl.elements.BicubicHermite(),
    "3×3 shear": fl.elements.BicubicHermite(share=0.0, shear=3),
    "not assumed": fl.elements.BicubicHermite(share=1.0),
    "plate with shear": fl.elements.AncfPlate(),
    "plain plate with shear": fl.elements.AncfPlate(bending_flexibility=False, share=1.0),
}
every_element = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS.keys())


def wavy(a, b):
    return np.array([a, b * (1 + 0.3 * a), 0.2 * a * b + 0.1 * np.sin(2 * a)])


def flat(a, b):
    return np.array([2.0 * a, b, 0.0])


class Shell(BodyAlone):
    """A thin shell by itself."""

    size = 0.03

    def __init__(self, function=wavy, cells=(2, 2), element=None, section=UNSYMMETRIC):
        make = fl.AncfShell if isinstance(element, fl.elements.AncfPlate) else fl.ThinShell
        body = make(fl.mesh.smooth_patch(function, cells), section, formulation=element)
        super().__init__(body, body.model.assemble([body.model]))


@every_element
def test_forces_are_the_gradient_of_the_energy(element):
    shell, step = Shell(element=element), 1e-5
    H, d = shell.deformed(), np.random.default_rng(2).normal(size=(shell.count, 6))
    ahead, behind = (shell.term.energy(shell.follow(H, s * step * d)) for s in (1, -1))
    assert np.vdot(shell.forces(H), d) == pytest.approx((ahead - behind) / (2 * step), rel=1e-7)


@every_element
def test_tangent_is_the_derivative_of_the_forces(element):
    shell, step = Shell(element=element), 1e-5
    H, d = shell.deformed(), np.random.default_rng(2).normal(size=(shell.count, 6))
    ahead, behind = (shell.forces(shell.follow(H, s * step * d)) for s in (1, -1))
    numeric = ((ahead - behind) / (2 * step)).ravel()
    K = shell.matrix(H)
    np.testing.assert_allclose(K @ d.ravel(), numeric, atol=1e-7 * np.abs(numeric).max())
    np.testing.assert_allclose(K, K.T, atol=1e-13 * np.abs(K).max())


def test_linearised_stress_is_linear_along_the_increment():
    """That of the next state to first order, and exactly where the increment is zero."""
    shell, step = Shell(), 1e-4
    H, d = shell.deformed(), np.random.default_rng(2).normal(size=(shell.count, 6))
    shell.term.update_stress(H, step * d)
    values = shell.term.linearised_values
    shell.term.reset_stress(shell.follow(H, step * d))
    here = shell.term.linearised_values
    shell.term.reset_stress(H)
    gap, change = np.abs(values - here).max(), np.abs(here - shell.term.linearised_values).max()
    assert 0.0 < gap < 0.01 * change


@every_element
def test_rigid_motion_changes_nothing_in_local_axes(element):
    """Claim 5: no energy, forces that turn along, and the same matrix to round-off."""
    shell = Shell(element=element)
    H = shell.turned(shell.deformed(), np.eye(4, 3, -1))
    moved = shell.turned(H, lie.se3_exp(np.array([3.0, -2.0, 1.0, 2.0, 0.5, -1.5])))
    rest = shell.turned(shell.body.frames, lie.se3_exp(np.array([1.0, 2.0, 3.0, -1.0, 2.0, 1.0])))
    assert shell.term.energy(rest) < 1e-25
    force, K = shell.forces(H), shell.matrix(H)
    np.testing.assert_allclose(shell.forces(moved), force, atol=1e-12 * np.abs(K).max())
    np.testing.assert_allclose(shell.matrix(moved), K, atol=1e-12 * np.abs(K).max())


@every_element
@pytest.mark.parametrize("function", [flat, wavy])
def test_only_rigid_motions_have_no_energy(element, function):
    shell = Shell(function, (1, 1), element)
    K = shell.matrix(shell.body.frames)
    stiffness = np.linalg.eigvalsh(K)
    assert np.abs(stiffness[:6]).max() < 1e-12 * stiffness[-1]
    assert stiffness[6] > 1e-8 * stiffness[-1]
    rigid = node_types.rigid_motions(shell.kinds, shell.body.frames, np.zeros(3)).reshape(-1, 6)
    np.testing.assert_allclose(K @ rigid, 0.0, atol=1e-12 * stiffness[-1])


def test_constant_strains_are_in_equilibrium():
    """Patch test on parallelograms: all of a plate is strained and bent alike."""

    def skew(a, b):
        return np.array([2.0 * a + 0.7 * b, 1.5 * b, 0.0])

    shell, strain = Shell(skew, (3, 2)), np.array([[1.01, 0.02, 0], [-0.01, 0.98, 0], [0, 0, 1.0]])
    H = shell.body.frames.copy()
    count = shell.body.model.points_count
    H[:count, :2] @= strain.T
    H[count:, 1:3] @= strain.T
    E = shell.term.strains(H)
    C = strain.T @ strain
    wanted = [0.5 * (C[0, 0] - 1), 0.5 * (C[1, 1] - 1), C[0, 1], 0, 0, 0]
    np.testing.assert_allclose(E, np.broadcast_to(wanted, E.shape), atol=1e-11)
    edge = np.unique(np.concatenate([e.points for e in shell.body.model._edges.values()]))
    inner = np.setdiff1d(np.arange(count), edge)
    residual = shell.forces(H)[np.concatenate([inner, inner + count])]
    assert len(inner) == 2
    np.testing.assert_allclose(residual, 0.0, atol=1e-10 * np.abs(shell.forces(H)).max())


def test_curvature_of_a_rolled_plate():
    """A plate rolled up without stretch has ``K₁₁ = −1/R`` of its normals, to the order four."""
    gaps = []
    for cells in (4, 8):
        shell = Shell(flat, (cells, 1))
        rolled = fl.mesh.smooth_patch(
            lambda a, b: [np.sin(2 * a), b, 1 - np.cos(2 * a)], (cells, 1)
        )
        other = fl.ThinShell(rolled, LAYER)
        strains = shell.term.strains(other.frames)
        gaps.append(np.abs(strains - [0, 0, 0, -1, 0, 0]).max(axis=(0, 1)))
    assert gaps[1][0] < 1e-4 and gaps[0][3] / gaps[1][3] > 3.5
    assert gaps[1][[1, 2, 4, 5]].max() < 1e-9


def strip(cells, thickness, **options):
    """A cantilever of length 10 and width 1, without contraction."""
    section = fl.ShellSection.layer(thickness, fl.Material(1.2e6, 0.0, 1.0))
    patch = fl.mesh.smooth_patch(lambda a, b: [10 * a, b, 0.0], (cells, 1))
    body = fl.ThinShell(patch, section, name="strip", **options)
    body.clamp("a=0")
    return body


@pytest.mark.parametrize("thickness", [1e-1, 1e-2, 1e-3])
def test_elastica(thickness):
    """End force P ℓ² = 4 EI, deflections 0.67 ℓ and 0.329 ℓ, whatever the slenderness."""
    body, scene = strip(8, thickness), fl.Scene()
    scene.add(body)
    load = 4 * 1.2e6 * thickness**3 / 12 / 100
    for point in ("10", "11"):
        scene.add(fl.PointLoad(body.point(point), force=(0, 0, load / 2)))
    end = fl.statics(scene).position("strip.10")[-1]
    # Bisshopp & Drucker (1945)
    assert end[2] / 10 == pytest.approx(0.66996, rel=2e-3)
    assert 1 - end[0] / 10 == pytest.approx(0.32894, rel=4e-3)


def hemisphere(cells, thickness, load):
    """A quarter of a pinched hemisphere with a hole, see demos/hemisphere.py."""

    def position(a, b):
        azimuth, height = a * np.pi / 2, b * np.radians(72)
        level = np.cos(height)
        return [10 * level * np.cos(azimuth), 10 * level * np.sin(azimuth), 10 * np.sin(height)]

    section = fl.ShellSection.layer(thickness, fl.Material(6.825e7, 0.3, 1.0))
    body = fl.ThinShell(fl.mesh.smooth_patch(position, (cells, cells)), section, name="hemisphere")
    body.symmetry("a=0", (0, 1, 0))
    body.symmetry("a=1", (1, 0, 0))
    body.roller("00", (0, 0, 1))
    scene = fl.Scene()
    scene.add(body)
    scene.add(fl.PointLoad(body.point("00"), force=(load / 2, 0, 0)))
    scene.add(fl.PointLoad(body.point("10"), force=(0, -load / 2, 0)))
    return scene


def test_pinched_hemisphere():
    result = fl.statics(hemisphere(8, 0.04, 400.0))
    outward = result.position("hemisphere.00")[-1][0] - 10
    inward = 10 - result.position("hemisphere.10")[-1][1]
    assert outward == pytest.approx(4.0753, rel=0.012)
    assert inward == pytest.approx(8.1524, rel=0.008)
    assert result.total_iterations <= 16


def test_held_components_stay_exactly():
    """Planes of symmetry hold what they say in all states, with axes that stay."""
    scene = hemisphere(4, 0.04, 400.0)
    body = scene.bodies[0]
    result = fl.statics(scene)
    for name, k in (("a=0", 1), ("a=1", 0)):
        points = body.model.edge(name).points
        first, second = (
            result.frames[-1][points],
            result.frames[-1][points + body.model.points_count],
        )
        assert np.abs(first[:, :1, k]).max() < 1e-10
        others = [i for i in range(3) if i != k]
        assert np.abs(first[:, 1][:, others]).max() < 1e-10  # ∂u is across
        assert np.abs(second[:, 2, k]).max() < 1e-10  # ∂v is within
    moved = body.model.axes_update()
    assert body.model.axes_are_held()[body.model.edge("a=0").points].all()
    rows = result.frames[-1].copy()
    moved(rows)
    np.testing.assert_array_equal(rows, result.frames[-1])


def test_patches_joined_are_one_surface():
    """Half a cylinder of two patches against one of one."""

    def half(start, end):
        def position(a, b):
            angle = start + (end - start) * a
            return [np.cos(angle), np.sin(angle), 2.0 * b]

        return position

    def pinched(patches, corner):
        body = fl.ThinShell(patches, LAYER, name="half")
        for name in ("a=0", "left.a=0"):
            if name in body.model._edges:
                body.clamp(name)
        scene = fl.Scene()
        scene.add(body)
        scene.add(fl.PointLoad(body.point(corner), force=(0.0, 0.05, 0.0)))
        return fl.statics(scene).position(f"half.{corner}")[-1]

    two = {
        "left": fl.mesh.smooth_patch(half(0, np.pi / 2), (3, 2)),
        "right": fl.mesh.smooth_patch(half(np.pi / 2, np.pi), (3, 2)),
    }
    one = pinched(fl.mesh.smooth_patch(half(0, np.pi), (6, 2)), "10")
    np.testing.assert_allclose(pinched(two, "right.10"), one, atol=1e-6)
    assert np.linalg.norm(one - [-1, 0, 0]) > 0.1


def test_a_closed_cylinder_is_joined_to_itself():
    def round_(a, b):
        return [np.cos(2 * np.pi * a), np.sin(2 * np.pi * a), b]

    patch = fl.mesh.smooth_patch(round_, (6, 2))
    assert fl.ThinShell(patch, LAYER).model.points_count == 7 * 3
    assert fl.ThinShell(patch, LAYER, joined=True).model.points_count == 6 * 3


def test_gravity_is_the_weight_of_all():
    """Of reactions the sum; the consistent share of slopes has none."""
    body, scene = strip(4, 0.1), fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    result = fl.statics(scene)
    total = sum(result.reaction(point)[-1][2] for point in body.points("a=0"))
    assert total == pytest.approx(9.81 * 10 * 1 * 0.1, rel=1e-9)


def test_edge_load_bends_as_two_forces_at_corners_do():
    """Of a strip without contraction; the total is what is asked for."""
    tips = []
    for spread in (True, False):
        body, scene = strip(4, 0.1), fl.Scene()
        scene.add(body)
        if spread:
            scene.add(fl.loads.EdgeLoad(body, "a=1", force=(0, 0, 0.4)))
        else:
            for point in ("10", "11"):
                scene.add(fl.PointLoad(body.point(point), force=(0, 0, 0.2)))
        result = fl.statics(scene)
        tips.append(result.position("strip.10")[-1][2])
        held = sum(result.reaction(point)[-1][2] for point in body.points("a=0"))
        assert held == pytest.approx(-0.4, rel=1e-9)
    assert tips[0] == pytest.approx(tips[1], rel=1e-4)
    # 0.4 · 10³ / (3 · 100), less what is bent back
    assert 1.2 < tips[0] < 4 / 3


def weighed(load):
    body, scene = strip(4, 0.1), fl.Scene()
    scene.add(body)
    scene.add(load(body))
    return fl.statics(scene).position("strip.10")[-1]


def test_loads_on_the_surface_are_each_other():
    """Gravity, a force per mass, per volume and per area."""
    body, scene = strip(4, 0.1), fl.Scene(gravity=(0, 0, -0.3))
    scene.add(body)
    end = fl.statics(scene).position("strip.10")[-1]
    assert end[2] < -0.2
    for load in (
        lambda shell: fl.loads.MassLoad(shell, force=(0, 0, -0.3)),
        lambda shell: fl.loads.VolumeLoad(shell, force=(0, 0, -0.3)),
        lambda shell: fl.AreaLoad(shell, force=lambda x: (0, 0, -0.03)),
    ):
        np.testing.assert_allclose(weighed(load), end, atol=1e-9)


def test_pressure_on_a_closed_cylinder():
    """It stays round, and ``E t (r² − 1)/2 = p``: what is pushed is the ring as it is now."""

    def round_(a, b):
        angle = 2 * np.pi * a
        return [np.cos(angle), np.sin(angle), 0.5 * b]

    section = fl.ShellSection.layer(0.01, fl.Material(1e4, 0.0, 1.0))
    body = fl.ThinShell(fl.mesh.smooth_patch(round_, (16, 2)), section, joined=True, name="tube")
    body.roller("b=0", (0, 0, 1))
    body.roller("00", (0, 1, 0))
    body.roller("10", (1, 0, 0))
    scene = fl.Scene()
    scene.add(body)
    # nor does it turn about the corner
    across = (
        np.abs(body.frames[: body.model.points_count, 0] - (-1.0, 0.0, 0.0)).sum(axis=1).argmin()
    )
    scene.add(fl.joints.InPlane(fl.ground(), body.point(int(across)), axis=(0, 1, 0)))
    scene.add(fl.loads.SurfacePressure(body, 1.0))
    positions = fl.statics(scene).frames[-1][: body.model.points_count, 0]
    middle = positions[:, :2].mean(axis=0)
    radius = np.linalg.norm(positions[:, :2] - middle, axis=1)
    assert np.ptp(radius) < 1e-10
    assert 1e4 * 0.01 * (radius.mean() ** 2 - 1) / 2 == pytest.approx(1.0, rel=5e-4)


def test_derivative_of_pressure():
    body, step, rng = Shell().body, 1e-5, np.random.default_rng(2)
    scene, bare = fl.Scene(), fl.Scene()
    for each in (scene, bare):
        each.add(body)
    scene.add(fl.loads.SurfacePressure(body, 3.0, gradient=(0.45, -0.3, 0.75)))
    system, without = (Assembled(each, dynamics=True) for each in (scene, bare))
    H = system.moved(system.start, 0.1 * rng.normal(size=(system.count, 6)))
    d = rng.normal(size=(system.count, 6))

    def loads(rows):
        return system.equations.prescribed(0.0).loads(rows)

    ahead, behind = (loads(system.moved(H, sign * step * d)) for sign in (1, -1))
    assert np.abs(ahead - behind).max() > 1e-6
    # the stress of the state is the same without pressure
    found = (system.matrix(H) - without.matrix(H)) @ d.ravel()
    np.testing.assert_allclose(found, -(ahead - behind) / (2 * step), atol=1e-8)


def test_moments_balance_the_load():
    """Of a cantilever under an end force as it is bent: ``M₁₁`` is the force times its arm."""
    body, scene = strip(8, 0.1), fl.Scene()
    scene.add(body)
    scene.add(fl.loads.EdgeLoad(body, "a=1", force=(0, 0, 0.4)))
    result = fl.statics(scene)
    found = fl.post.thin_resultants(result, body)
    arms = result.position("strip.10")[-1][0] - found.positions[..., 0]
    # a force upwards at the end bends the normals back
    np.testing.assert_allclose(np.abs(found.raw("M11")), 0.4 * arms, atol=0.02)
    mean = found.mean("M11")
    np.testing.assert_allclose(np.abs(mean), 0.4 * arms.mean(axis=1), rtol=3e-3, atol=4e-3)
    assert (np.sign(mean) == np.sign(mean[0])).all()


def test_a_joint_holds_the_surface():
    """A strip hung by a fixed joint within a cell, against a clamp; moments balance."""
    body, scene = strip(4, 0.1), fl.Scene()
    body.model.held[:] = False
    scene.add(body)
    at = body.point_in_cell(0, 0.3, 0.5)
    joint = scene.add(fl.joints.Fixed(at, fl.ground(), name="hold"))
    scene.add(fl.loads.EdgeLoad(body, "a=1", force=(0, 0, 0.1)))
    result = fl.statics(scene)
    force = result.joint_force(joint)[-1]
    tip = result.position("strip.10")[-1]
    assert np.abs(force[:3]).max() == pytest.approx(0.1, rel=1e-9)
    arm = tip[0] - at.position[0]
    assert np.abs(force[3:]).max() == pytest.approx(0.1 * arm, rel=1e-2)


def kinked():
    return {
        "floor": fl.mesh.smooth_patch(lambda a, b: [a, b, 0], (2, 2)),
        "wall": fl.mesh.smooth_patch(lambda a, b: [1, b, a], (2, 2)),
    }


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: fl.mesh.smooth_patch(flat, (0, 2)), "cells along a must be at least 1, got 0"),
        (lambda: fl.mesh.smooth_patch(lambda a, b: [a, 0, 0], (2, 2)), "neither zero nor parallel"),
        (lambda: fl.mesh.smooth_patch(lambda a, b: [a, np.nan, 0], (2, 2)), "the position at"),
        (lambda: fl.ThinShell(kinked(), LAYER), "parametrisations do not agree"),
        (lambda: fl.ThinShell({}, LAYER), "at least one patch"),
        (lambda: Shell().body.clamp("c=0"), "no edge or corner 'c=0'; it has: a=0"),
        (lambda: Shell(flat).body.symmetry("a=0", (0, 1, 0)), "not on a plane of symmetry"),
        (lambda: Shell(flat).body.symmetry("00", (0, 1, 0)), "needs an edge"),
        (lambda: Shell(wavy).body.model.cells_of("roof"), "no patch 'roof'"),
        (
            lambda: fl.ThinShell(fl.mesh.smooth_patch(flat, (1, 1)), LAYER, along=(0, 0, 1)),
            "normal to",
        ),
        (lambda: fl.ThinShell(kinked(), {"floor": LAYER}, joined=False), "no section"),
        (lambda: fl.elements.BicubicHermite(share=2.0), "between 0 and 1"),
        (lambda: fl.elements.BicubicHermite(across=2), "across must be at least 3"),
    ],
)
def test_bad_input(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_directions_that_cannot_be_held_together():
    body = Shell(flat).body
    body.roller("00", (1, 1, 0))
    with pytest.raises(ValueError, match="neither parallel nor perpendicular"):
        body.roller("00", (1, 0, 0))


def loaded_point(load, *, on_body: bool):
    """Points of a bent strip with a load at a point, or on a rigid body that is fixed there."""
    body, scene = strip(3, 0.1), fl.Scene()
    scene.add(body)
    at = body.points("a=1")[0]
    if on_body:
        other = fl.RigidBody(1.0, (1, 1, 1), at.position, at.frame[1:].T)
        scene.add(other)
        scene.add(fl.joints.Fixed(at, other.point("centre")))
        at = other.point("centre")
    scene.add(fl.PointLoad(at, **load))
    return fl.statics(scene).frames[-1][: body.model.points_count, 0]


@pytest.mark.parametrize(
    "load",
    [
        {"moment": (0.2, -4.0, 0.1)},
        {"moment": (0.2, -4.0, 0.1), "following": True},
        {"force": (0.02, 0.1, 0.5), "following": True},
    ],
    ids=["moment", "following moment", "following force"],
)
def test_loads_at_a_point_are_those_on_a_body_that_is_fixed_there(load):
    found, expected = (loaded_point(load, on_body=given) for given in (False, True))
    moved = np.abs(expected - strip(3, 0.1).frames[: len(expected), 0]).max()
    assert moved > 0.5
    np.testing.assert_allclose(found, expected, atol=1e-8 * moved)


def test_clamps_of_single_points_are_refused():
    body, scene = strip(2, 0.1), fl.Scene()
    scene.add(body)
    with pytest.raises(ValueError, match="ThinShell"):
        scene.add(fl.Clamp(body.point("00")))


PLATE = 1.0, 0.7, 0.01
"""Sides and thickness of a plate."""


def plate(cells):
    a, b, thickness = PLATE
    section = fl.ShellSection.layer(thickness, fl.Material(2e11, 0.3, 7800.0))
    patch = fl.mesh.smooth_patch(lambda s, t: [a * s, b * t, 0.0], (cells, cells))
    return fl.ThinShell(patch, section, name="plate")


def test_frequencies_of_a_hinged_plate():
    """Kirchhoff's ``π² (1/a² + 1/b²) √(D/ρt)``, to the order four."""
    errors = []
    for cells in (2, 4, 8):
        body, scene = plate(cells), fl.Scene()
        for name in ("a=0", "a=1", "b=0", "b=1"):
            body.hinge(name)
        scene.add(body)
        a, b, thickness = PLATE
        D = 2e11 * thickness**3 / 12 / (1 - 0.3**2)
        wanted = np.pi**2 * (1 / a**2 + 1 / b**2) * np.sqrt(D / 7800 / thickness)
        errors.append(fl.vibrations(scene, count=1).frequencies[0] / wanted - 1)
    assert 0 < errors[2] < 2e-5
    assert errors[0] / errors[1] > 14 and errors[1] / errors[2] > 14


def pushed_plate(cells):
    body, scene = plate(cells), fl.Scene()
    for name in ("a=0", "a=1", "b=0", "b=1"):
        body.roller(name, (0, 0, 1))
    body.roller("a=0", (1, 0, 0))
    body.roller("b=0", (0, 1, 0))
    scene.add(body)
    a, b, thickness = PLATE
    D = 2e11 * thickness**3 / 12 / (1 - 0.3**2)
    critical = np.pi**2 * D * (2 / a + a / 2 / b**2) ** 2
    scene.add(fl.loads.EdgeLoad(body, "a=1", force=(-critical, 0, 0)))
    return scene


def test_buckling_of_a_plate():
    """Two waves along it (Timoshenko & Gere), by linear buckling and on the path."""
    assert fl.buckling(pushed_plate(8), count=1).factors[0] == pytest.approx(1.0, rel=1e-3)
    path = fl.follow_path(pushed_plate(4), until=1.2)
    assert path.bifurcations[0].factor == pytest.approx(1.0, rel=0.02)


def tumbling(steps, *, follows):
    """A sheet thrown with a turn about its diagonal, without gravity; axes may stay in space."""
    patch = fl.mesh.smooth_patch(lambda a, b: [0.3 * a - 0.15, 0.15 * b - 0.075, 0.0], (3, 2))
    section = fl.ShellSection.layer(1e-3, fl.Material(3e9, 0.3, 1200.0))
    body = fl.ThinShell(patch, section, name="sheet")
    if not follows:
        body.model.axes_update = lambda: None
    body.add_velocity(omega=(3.0, 30.0, 5.0), about=(0, 0, 0))
    scene = fl.Scene()
    scene.add(body)
    scheme = fl.GeneralisedAlpha(radius=0.8, policy=fl.schemes.Automatic())
    return scheme.run(scene, duration=1e-3 * steps, step=1e-3)


def test_matrices_are_kept_in_axes_that_follow():
    """Claim 5: the same motion with a fraction of the matrices, momenta and energy as they were."""
    follows, stays = (tumbling(200, follows=each) for each in (True, False))
    assert 5 * follows.factorisations <= stays.factorisations
    gap = follows.position("sheet.10") - stays.position("sheet.10")
    assert np.abs(gap).max() < 1e-6
    energy = follows.kinetic + follows.elastic
    assert abs(energy[-1] / energy[0] - 1) < 1e-3
    momentum = follows.angular_momentum
    np.testing.assert_allclose(momentum[-1], momentum[0], atol=1e-3 * np.abs(momentum[0]).max())


def test_damping_with_mass_slows_a_sheet_down():
    """At its own rate in each of two that are assembled together; the balance includes the loss."""
    scene, sheets = fl.Scene(), []
    section = fl.ShellSection.layer(1e-3, fl.Material(3e9, 0.3, 1200.0))
    for k, rate in enumerate((2.0, 0.0)):
        patch = fl.mesh.smooth_patch(lambda a, b, k=k: [a, b, float(k)], (2, 1))
        sheets.append(
            fl.ThinShell(patch, section, damping=fl.sections.Damping(mass=rate), name=f"{k}")
        )
        sheets[k].add_velocity((1.0, 0.0, 0.0))
        scene.add(sheets[k])
    found = fl.GeneralisedAlpha().run(scene, duration=0.5, step=1e-2)
    gone = [found.position(f"{k}.00")[-1, 0] for k in range(2)]
    np.testing.assert_allclose(gone, [0.5 * (1 - np.exp(-1.0)), 0.5], rtol=1e-4)
    lost = 0.5 * 1.2 * (1 - np.exp(-2.0))
    assert found.kinetic[0] - found.kinetic[-1] == pytest.approx(lost, rel=1e-4)
    assert abs(found.balance_error) < 1e-4
    with pytest.raises(ValueError, match="damping with mass only"):
        fl.ThinShell(patch, section, damping=fl.sections.Damping(stiffness=1e-3))


def test_a_run_restarts_from_its_file(tmp_path):
    """And pictures show faces of positions alone."""
    result = tumbling(5, follows=True)
    result.picture(tmp_path / "sheet.png")
    assert (tmp_path / "sheet.png").stat().st_size > 1000
    result.save(tmp_path / "sheet.npz")
    again = fl.Result.load(tmp_path / "sheet.npz")
    np.testing.assert_array_equal(again.position("sheet.11"), result.position("sheet.11"))
