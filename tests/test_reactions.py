"""Reactions of clamps, guides and prescribed motions: balance, closed forms, equivalent joints."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

STEEL = fl.Material(2.1e11, 0.3, 7850.0)
LENGTH, MASS = 1.3, 7850.0 * 0.02 * 0.03 * 1.3


def cantilever(*, joint: bool = False, gravity=(0, 0, -9.81)):
    """A steel bar held at its start by a clamp, or by a joint that does the same."""
    scene = fl.Scene(gravity=gravity)
    section = fl.Section.rectangle(0.02, 0.03, STEEL)
    beam = scene.add(
        fl.Beam.straight((0.4, 0.1, 0), (0.4 + LENGTH, 0.1, 0), section, cells=8, name="bar")
    )
    if joint:
        return (
            scene,
            beam,
            scene.add(fl.joints.Fixed(fl.ground(), beam.point("start"), name="weld")),
        )
    return scene, beam, scene.add(fl.Clamp(beam.point("start")))


def bent(**options):
    """Under forces and a moment that bend it far."""
    scene, beam, held = cantilever(**options)
    scene.add(fl.PointLoad(beam.point("end"), force=(-3e3, 4e3, 6e3), moment=(50.0, 0, 80.0)))
    scene.add(fl.PointLoad(beam.point(4), force=(0, 900.0, 0), following=True))
    return scene, beam, held


STATICS = {
    "load steps": lambda scene: fl.statics(scene, load_steps=4),
    "arc length": lambda scene: fl.follow_loads(scene, (0.5, 1.0)),
    "path": lambda scene: fl.follow_path(
        scene, resolution=0.3, options=fl.stability.PathOptions(locate=None)
    ),
}


@pytest.mark.parametrize("way", STATICS)
def test_static_reactions_balance_all_loads(way):
    scene, beam, clamp = bent()
    result = STATICS[way](scene)
    found = result.reaction(clamp)
    assert found.shape == (len(result.factors), 6)
    for k, factor in enumerate(result.factors):
        x, R = (f(beam.point("end"))[k] for f in (result.position, result.rotation))
        middle = result.position(beam.point(4))[k]
        tip, push = np.array([-3e3, 4e3, 6e3]), result.rotation(beam.point(4))[k] @ [0, 900.0, 0]
        nodes = result.frames[k, result.info.body("bar").nodes]
        share = np.full(9, MASS / 8)
        share[[0, -1]] /= 2
        weight = share[:, np.newaxis] * [0, 0, -9.81]
        force = tip + push + weight.sum(axis=0)
        origin = clamp.point.position
        moment = np.array([50.0, 0, 80.0])
        moment = moment + np.cross(x - origin, tip) + np.cross(middle - origin, push)
        moment += np.cross(nodes[:, 0] - origin, weight).sum(axis=0)
        assert R.shape == (3, 3)
        np.testing.assert_allclose(found[k, :3], -factor * force, atol=1e-6 * np.abs(force).max())
        # the bow of the elements has weight, too
        np.testing.assert_allclose(found[k, 3:], -factor * moment, atol=3e-4 * np.abs(moment).max())


def on_bar(result: fl.Result | fl.StaticResult) -> np.ndarray:
    """Force of the joint on the bar: the joint's axes on the ground are its own, e₃ along z."""
    force = -result.joint_force("weld").reshape(-1, 2, 3)
    axes = fl.joints.Fixed(fl.ground(), cantilever()[1].point("start")).frame()[1:]
    return np.einsum("ij,tki->tkj", axes, force).reshape(-1, 6)


@pytest.mark.parametrize("way", STATICS)
def test_a_clamp_has_the_force_of_a_joint_that_does_the_same(way):
    results = [STATICS[way](bent(joint=joint)[0]) for joint in (False, True)]
    forces = on_bar(results[1])[-1]
    np.testing.assert_allclose(
        results[0].reaction("bar.start")[-1], forces, atol=1e-6 * np.abs(forces).max()
    )


SCHEMES = {
    "generalised-α": fl.GeneralisedAlpha,
    "energy-momentum": fl.EnergyMomentum,
    "energy-decaying": fl.EnergyDecaying,
}


def swinging(**options):
    """Let go under its weight, with a push that comes and goes."""
    scene, beam, held = cantilever(**options)
    scene.add(
        fl.PointLoad(beam.point("end"), force=(0, 40.0, 0), history=lambda t: np.sin(60.0 * t) ** 2)
    )
    return scene, beam, held


@pytest.mark.parametrize("scheme", ["generalised-α"])
@pytest.mark.parametrize(
    "steps", [None, fl.schemes.ConstantStep(5e-4), fl.schemes.AdaptiveStep(1e-3)]
)
def test_a_moving_clamp_has_the_force_of_a_joint(scheme, steps):
    results = []
    for joint in (False, True):
        scene, _, _ = swinging(joint=joint)
        step = 5e-4 if steps is None else steps
        results.append(SCHEMES[scheme]().run(scene, duration=0.02, step=step))
    assert np.ptp(results[0].reaction("bar.start")[:, 2]) > 50.0
    # accelerations at the start are means over the first step: system/equations/consistent
    times = np.linspace(0.002, 0.02, 9)
    clamp, weld = (result.resampled(times) for result in results)
    forces = on_bar(weld)
    found = clamp.reaction("bar.start")
    assert np.abs(found - forces).max() <= 1e-4 * np.abs(forces).max()


@pytest.mark.parametrize("scheme", SCHEMES)
def test_impulse_of_the_reaction_changes_the_momentum(scheme):
    scene, _, clamp = swinging()
    gaps = []
    for h in (4e-4, 2e-4):
        result = SCHEMES[scheme]().run(scene, duration=0.04, step=h)
        push = 40.0 * np.sin(60.0 * result.times) ** 2
        force = result.reaction(clamp)[:, :3] + np.outer(push, [0, 1.0, 0])
        force[:, 2] -= 9.81 * MASS
        impulse = np.cumsum(0.5 * h * (force[1:] + force[:-1]), axis=0)
        gap = np.abs(impulse - (result.momentum[1:] - result.momentum[0])).max()
        gaps.append(gap / np.abs(result.momentum).max())
    assert gaps[1] <= 1e-3
    # of second order but for waves that no step resolves, of the weight that comes at once
    assert gaps[1] <= 0.5 * gaps[0]


@pytest.mark.parametrize("scheme", ["energy-momentum", "energy-decaying"])
@pytest.mark.parametrize("kept", [1, 4, "variable"])
def test_conserving_schemes_have_the_reactions_of_generalised_alpha(scheme, kept):
    """At the ends of steps, of second order, whatever is kept."""
    scene, beam, clamp = cantilever(gravity=(0, 0, 0))
    # gently, or waves that no step resolves go on in the scheme that loses nothing
    scene.add(
        fl.PointLoad(beam.point("end"), force=(0, 0, 30.0), history=lambda t: np.sin(40 * t) ** 6)
    )
    exact = fl.GeneralisedAlpha().run(scene, duration=0.08, step=5e-5)
    gaps = []
    for h in (4e-4, 2e-4):
        step = fl.schemes.ConstantStep(h) if kept == "variable" else h
        every = 4 if kept == 4 else 1
        result = SCHEMES[scheme]().run(scene, duration=0.08, step=step, save_every=every)
        at = np.array([0.016, 0.04, 0.0736, 0.08])
        rows = [result.index(t) for t in at]
        found, wanted = result.reaction(clamp)[rows], exact.reaction(clamp)
        gaps.append(np.abs(found - wanted[[exact.index(t) for t in at]]).max())
    assert gaps[1] <= 0.01 * np.abs(wanted).max()
    assert gaps[1] <= 0.35 * gaps[0]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_reactions_on_both_sides_of_a_jump(scheme):
    """A clamped body beside one that swings: the load that jumps goes straight to the clamp."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    block = scene.add(fl.RigidBody(2.0, 3 * [0.1], name="block"))
    clamp = scene.add(fl.Clamp(block.point("centre")))
    other = scene.add(fl.RigidBody(1.0, 3 * [0.1], position=(1.0, 0, 0), name="other"))
    scene.add(
        fl.joints.Revolute(fl.ground(), other.point("centre"), at=(0.5, 0, 0), axis=(0, 1, 0))
    )
    scene.add(
        fl.PointLoad(
            block.point("centre"), force=(7.0, 0, 0), history=lambda t: 1.0 if t > 0.05 else 0.0
        )
    )
    steps = fl.schemes.AdaptiveStep(1e-3, events=(0.05,))
    result = SCHEMES[scheme]().run(scene, duration=0.1, step=steps)
    after = np.searchsorted(result.times, 0.05, side="right")
    found = result.reaction(clamp)
    np.testing.assert_allclose(found[: after - 1, 0], 0.0, atol=1e-9)
    np.testing.assert_allclose(found[after - 1 :, 0], -7.0, rtol=1e-9)
    np.testing.assert_allclose(found[:, 2], 2.0 * 9.81, rtol=1e-9)


def test_a_prescribed_motion_has_the_force_that_drives_it():
    """A rigid body that is carried along a curve: m (a − g), and its moment about its centre."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    body = scene.add(fl.RigidBody(3.0, (0.2, 0.3, 0.4), position=(1, 0, 0), name="load"))

    def motion(t):
        spin = lie.so3_exp(np.array([0, 0, 2.0 * t]))
        return lie.frame(np.array([np.cos(2 * t), np.sin(2 * t), 0.3 * t**2]), spin)

    body.add_velocity(omega=(0, 0, 2.0), about=(0, 0, 0))
    held = scene.add(fl.PrescribedMotion(body.point("centre"), motion))
    result = fl.GeneralisedAlpha().run(scene, duration=0.5, step=1e-3)
    t = result.times
    expected = np.zeros((len(t), 6))
    expected[:, :3] = 3.0 * np.column_stack(
        [-4 * np.cos(2 * t), -4 * np.sin(2 * t), 0.6 + 9.81 + 0 * t]
    )
    np.testing.assert_allclose(result.reaction(held)[5:], expected[5:], atol=2e-3)
    np.testing.assert_allclose(result.reaction(held)[:, 3:], 0.0, atol=2e-3)


@pytest.mark.parametrize("drills", [False, True], ids=["five parameters", "six"])
def test_guides_and_edges_of_a_shell_carry_what_loads_it(drills):
    """A quarter of a plate: two planes of symmetry, one edge on rollers, the other free."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (2 * a, b, 0.0), (6, 4)),
        fl.ShellSection.layer(0.02, fl.Material(2.1e11, 0.3, 7850.0)),
        drilling=drills,
        name="plate",
    )
    shell.symmetry("a=0", (1, 0, 0))
    shell.symmetry("b=0", (0, 1, 0))
    edge = shell.roller("a=1", (0, 0, 3.0))
    scene = fl.Scene()
    scene.add(shell)
    load = 4e3
    scene.add(fl.AreaLoad(shell, force=(0, 0, -load)))
    result = fl.statics(scene)
    total = result.reaction(*edge)[-1]
    # its corner is held by the plane of symmetry, too: along it
    np.testing.assert_allclose(total[[0, 2]], [0, 2 * load], atol=1e-6 * load)
    planes = result.reaction(*shell.points("a=0"))[-1]
    assert abs(planes[2]) <= 1e-6 * load
    # the bending moment of half a beam under a uniform load, about the position of the first point
    assert abs(planes[4]) == pytest.approx(load * 2.0**2 / 2, rel=2e-2)


def test_a_clamp_of_an_attached_node_is_about_its_own_position():
    scene, beam, _ = cantilever()
    scene.clamps.clear()
    block = scene.add(fl.RigidBody(1.0, 3 * [1e-3], position=(0.4, 0.1, -0.5), name="block"))
    scene.add(fl.joints.RigidLink(beam.point("start"), block.point("centre")))
    clamp = scene.add(fl.Clamp(block.point("centre")))
    result = fl.statics(scene)
    found = result.reaction(clamp)[-1]
    weight = 9.81 * np.array([MASS, 1.0])
    np.testing.assert_allclose(found[:3], [0, 0, weight.sum()], rtol=1e-6, atol=1e-6)
    assert found[4] == pytest.approx(-weight[0] * LENGTH / 2, rel=1e-3)
    # named together they count once
    np.testing.assert_array_equal(result.reaction(clamp, beam.point("start"))[-1], found)


def test_reactions_are_saved_and_named_when_there_is_none(tmp_path):
    scene, beam, clamp = swinging()
    result = fl.GeneralisedAlpha().run(scene, duration=1e-3, step=5e-4)
    result.save(tmp_path / "r.h5")
    again = fl.Result.load(tmp_path / "r.h5")
    np.testing.assert_array_equal(again.reaction(clamp), result.reaction("bar.start"))
    with pytest.raises(ValueError, match=r"bar\.end is not held; 1 nodes are.*bar\.start"):
        result.reaction(beam.point("end"))
    with pytest.raises(ValueError, match="at least one"):
        result.reaction()
    with pytest.raises(ValueError, match="ground"):
        result.reaction(fl.ground())
    with pytest.raises(ValueError, match=r"motion of bar\.start"):
        result.reaction(
            fl.PrescribedMotion(beam.point("start"), lambda t: beam.point("start").frame)
        )
