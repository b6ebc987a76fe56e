"""States between the recorded ones: laws that hold for every type of node."""

from dataclasses import fields, replace

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

STEEL = fl.Material(2e11, 0.3, 7800.0)
SPIN, CENTRE = np.array([0.8, -0.5, 1.1]), np.array([0.5, 0.1, 0.0])
STEP, KEPT = 0.01, 8


def arc(s):
    return s, 0.3 * s * (1 - s), 0.0


def bar() -> fl.Section:
    return fl.Section.rectangle(0.05, 0.04, STEEL)


def wire() -> fl.Section:
    return fl.Section.circle(0.02, STEEL)


def plate(cells):
    return fl.mesh.smooth_patch(lambda a, b: (a, 0.4 * b, 0.1 * a * a), cells)


def reduced():
    scene = fl.Scene()
    full = scene.add(fl.Beam(fl.mesh.curve(arc, 4), bar(), up=(0, 0, 1), name="full"))
    return fl.reduction.reduced_order_body(
        scene, [full.point("start"), full.point("end")], 3, name="body"
    )


def solid():
    mesh = fl.mesh.parametric_volume(
        lambda a, b, c: (a, 0.2 * b, 0.2 * c), (2, 1, 1), cell="hexahedron"
    )
    return fl.Solid(mesh, fl.sections.NeoHooke(2e11, 0.3, 7800.0), name="body")


BODIES = {
    "beam": lambda: fl.Beam(fl.mesh.curve(arc, 3), bar(), up=(0, 0, 1), name="body"),
    "discrete rod": lambda: fl.Rod(
        fl.mesh.curve(arc, 4),
        bar(),
        up=(0, 0, 1),
        formulation=fl.elements.DiscreteRod(),
        name="body",
    ),
    "cable": lambda: fl.Cable.straight((0, 0, 0), (1, 0.2, 0), wire(), cells=2, name="body"),
    "discrete cable": lambda: fl.Cable(
        fl.mesh.straight_line((0, 0, 0), (1, 0.2, 0), 1),
        wire(),
        formulation=fl.elements.DiscreteCable(),
        name="body",
    ),
    "thin shell": lambda: fl.ThinShell(
        plate((2, 2)), fl.ShellSection.layer(0.03, STEEL), name="body"
    ),
    "gradient shell": lambda: fl.AncfShell(
        plate((2, 2)), fl.ShellSection.layer(0.03, STEEL), name="body"
    ),
    "gradient beam": lambda: fl.AncfBeam(fl.mesh.curve(arc, 2), bar(), up=(0, 0, 1), name="body"),
    "solid": solid,
    "reduced": reduced,
    "rigid": lambda: fl.RigidBody(2.0, (0.1, 0.2, 0.3), (0.2, 0.3, 0.1), name="body"),
}


def scene_of(name: str) -> fl.Scene:
    """A stiff body that turns freely about a point near it: it hardly deforms."""
    scene = fl.Scene()
    scene.add(BODIES[name]()).add_velocity(omega=tuple(SPIN), about=tuple(CENTRE))
    return scene


def thinned(result: fl.Result, every: int) -> fl.Result:
    rows = {
        field.name: value[::every]
        for field in fields(result)
        if isinstance(value := getattr(result, field.name), np.ndarray)
    }
    return replace(result, **rows)


def points_of(result: fl.Result) -> tuple[np.ndarray, np.ndarray]:
    """Positions and velocities of all nodes that move, global components."""
    x, rows = result.frames[..., 0, :], result.frames[..., 1:, :]
    moves = np.abs(result.velocities[0, :, :3]).max(axis=-1) > 1e-3
    v = np.einsum("tni,tnij->tnj", result.velocities[..., :3], rows)
    return x[:, moves], v[:, moves]


@pytest.mark.parametrize("name", BODIES)
def test_motion_between_recorded_states_is_that_of_all_steps(name):
    """The cubic's error is (ωΔ)⁴/384, its rate's (ωΔ)³/72, and ẋ − v of a step (ωh)²/12."""
    scheme = fl.GeneralisedAlpha(tolerance=1e-10, radius=0.5)
    # waves of the sudden start die out in the first interval
    every = scheme.run(scene_of(name), duration=3 * KEPT * STEP, step=STEP)
    times = every.times[KEPT:]
    found, every = thinned(every, KEPT).resampled(times), every.resampled(times)
    speed, size = np.linalg.norm(SPIN), 1.5
    angle, own = speed * KEPT * STEP, (speed * STEP) ** 2 / 12
    (x, v), (wanted, rates) = points_of(found), points_of(every)
    np.testing.assert_allclose(x, wanted, atol=(angle**4 / 384 + angle * own) * size)
    np.testing.assert_allclose(v, rates, atol=(angle**3 / 72 + 4 * own) * size * speed)
    # steady rotation of axes and gradients: an angular acceleration is at most ω²
    wanted = every.frames[:, :, 1:]
    scale = np.abs(wanted).max()
    np.testing.assert_allclose(found.frames[:, :, 1:], wanted, atol=angle**2 / 8 * scale)
    assert np.abs(found.velocities[..., 3:] - every.velocities[..., 3:]).max() < 2e-2 * speed


@pytest.mark.parametrize("name", ["thin shell", "solid", "reduced", "discrete rod"])
def test_states_at_asked_times_are_those_between_all_steps(name, tmp_path):
    scheme, times = fl.GeneralisedAlpha(), [0.0, 0.013, 0.055, 0.06]
    every = scheme.run(scene_of(name), duration=0.06, step=STEP)
    kept = scheme.run(scene_of(name), duration=0.06, step=STEP, save_at=times)
    every.save(tmp_path / "every.h5")
    for found in (every, fl.Result.load(tmp_path / "every.h5")):
        same = found.resampled(times)
        np.testing.assert_array_equal(same.times, times)
        np.testing.assert_array_equal(kept.frames, same.frames)
        np.testing.assert_array_equal(kept.velocities, same.velocities)


@pytest.mark.parametrize("name", ["thin shell", "gradient shell"])
def test_both_nodes_of_a_surface_point_have_the_same_axes_between_states(name):
    result = fl.GeneralisedAlpha().run(scene_of(name), duration=0.06, step=STEP)
    kinds, found = result.info.node_types, result.resampled([0.013, 0.055])
    for state in found.frames:
        of_points, of_others = np.split(
            fl.extend.node_types.all_axes(kinds, np.ascontiguousarray(state)), 2
        )
        np.testing.assert_allclose(of_others, of_points, atol=1e-12)


def test_a_file_that_does_not_say_what_nodes_are_is_read_but_not_interpolated(tmp_path):
    result = fl.GeneralisedAlpha().run(scene_of("rigid"), duration=0.02, step=STEP)
    bodies = tuple(replace(body, node_types=None) for body in result.info.bodies)
    replace(result, info=replace(result.info, bodies=bodies)).save(tmp_path / "old.h5")
    old = fl.Result.load(tmp_path / "old.h5")
    np.testing.assert_array_equal(old.frames, result.frames)
    with pytest.raises(ValueError, match="RigidBody 'body' has no recorded node types"):
        old.resampled([0.01])


def with_rows(scene, times, frames, velocities) -> fl.Result:
    """A result of three states with other times, frames and velocities."""
    result = fl.GeneralisedAlpha().run(scene, duration=2e-4, step=1e-4)
    return replace(result, times=times, frames=frames, velocities=velocities)


def test_rates_of_a_stretched_gradient_are_those_of_its_position():
    """A steady motion of a node whose gradient has another length at each time."""
    times, velocity = np.array([0.0, 0.5, 1.5]), np.array([0.3, -1.0, 2.0])
    spin = np.array([0.4, 0.3, -0.2])
    length = np.array([1.5, 0.7, 2.2])
    frames, rates = np.empty((3, 1, 4, 3)), np.empty((3, 1, 6))
    for k, t in enumerate(times):
        R = lie.so3_exp(spin * t)
        frames[k, 0, 0], frames[k, 0, 1:] = velocity * t, R.T
        rates[k, 0] = [*(velocity @ R), *spin]
        frames[k, 0, 1] *= length[k]
        rates[k, 0, 0] /= length[k]
    scene = fl.Scene()
    scene.add(fl.Cable.straight((0, 0, 0), (1, 0, 0), wire(), cells=1, name="cable"))
    at = np.array([0.1, 0.25, 0.7, 1.2])
    result = with_rows(scene, times, np.repeat(frames, 2, axis=1), np.repeat(rates, 2, axis=1))
    kinds = result.info.body("cable").node_types
    assert (kinds == fl.extend.NodeType.POSITION_GRADIENT).all()
    found = result.resampled(at)
    stretch = np.linalg.norm(found.frames[:, 0, 1], axis=-1)
    np.testing.assert_allclose(stretch, np.interp(at, times, length), rtol=1e-12)
    moved = np.einsum("ki,kij->kj", found.velocities[:, 0, :3], found.frames[:, 0, 1:])
    np.testing.assert_allclose(moved, np.tile(velocity, (4, 1)), atol=2e-3)
    np.testing.assert_allclose(found.velocities[:, 0, 3:], np.tile(spin, (4, 1)), atol=2e-3)


def test_modal_coordinates_are_interpolated_by_cubics():
    times = np.array([0.0, 0.5, 2.0])
    c = np.random.default_rng(0).normal(size=(4, 6))

    def cubic(t):
        return np.polynomial.polynomial.polyval(t, c).T

    def rate(t):
        return np.polynomial.polynomial.polyval(t, np.polynomial.polynomial.polyder(c)).T

    alone, scene = fl.Scene(), fl.Scene()
    beam = alone.add(fl.Beam(fl.mesh.curve(arc, 4), bar()))
    body = fl.reduction.reduced_order_body(alone, [beam.point("start")], 6)
    scene.add(body)
    kinds = fl.extend.Equations(scene, dynamics=True).info.bodies[0].node_types
    modal = kinds == fl.extend.NodeType.MODAL
    assert modal.any()

    def rows_of(t):
        frames, rates = np.zeros((len(t), len(kinds), 4, 3)), np.zeros((len(t), len(kinds), 6))
        frames[:, ~modal, 1:] = np.eye(3)
        frames[:, modal, 1:3] = cubic(t).reshape(-1, 1, 2, 3)
        rates[:, modal] = rate(t)[:, np.newaxis]
        return frames, rates

    at = np.array([0.2, 0.9, 1.7])
    found, (frames, rates) = with_rows(scene, times, *rows_of(times)).resampled(at), rows_of(at)
    np.testing.assert_allclose(found.frames, frames, atol=1e-12)
    np.testing.assert_allclose(found.velocities, rates, atol=1e-12)


def test_at_a_jump_the_later_side_counts_and_before_it_the_earlier_one():
    """A force that jumps from −1 N to 5 N on a clamped body: so does the reaction."""

    def force(t: float) -> float:
        return -1.0 if t < 0.05 else 5.0

    def scene() -> fl.Scene:
        scene = fl.Scene()
        body = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), name="body"))
        scene.add(fl.Clamp(body.point("centre")))
        scene.add(fl.PointLoad(body.point("centre"), (1.0, 0, 0), history=force))
        return scene

    choice, jump = fl.schemes.ConstantStep(0.02, events=(0.05,)), 0.05
    result = fl.GeneralisedAlpha().run(scene(), duration=0.1, step=choice)
    assert (result.times == jump).sum() == 2
    times = [jump - 1e-3, jump, jump + 1e-3]
    kept = fl.GeneralisedAlpha().run(scene(), duration=0.1, step=choice, save_at=times)
    for found in (result.resampled(times), kept):
        x = found.reactions[:, 0, 0]
        np.testing.assert_allclose(x, [1.0, -5.0, -5.0], rtol=1e-9)
