"""Faces of shells by penalty: pressures, invariants, how even forces are, what is refused."""

import numpy as np
import pytest

import fem_lie as fl

THICK, K = 0.05, 1e9
MATERIAL = fl.Material(1e7, 0.3, 1000.0)
LAYER = fl.ShellSection.layer(THICK, MATERIAL)


def plate(z, cells, start=0.0, length=1.0, cell="quadrilateral", degree=1) -> fl.Shell:
    def position(a, b):
        return np.array([start + length * a, start + length * b, z])

    element = fl.elements.DisplacementBased() if degree == 2 else None
    mesh = fl.mesh.parametric_surface(position, cells, cell=cell, degree=degree)
    return fl.Shell(mesh, LAYER, formulation=element)


def arch(cells: int, radius: float = 1.0) -> fl.Shell:
    """A part of a cylinder about the y axis."""

    def position(a, b):
        φ = 1.2 * (a - 0.5)
        return np.array([radius * np.sin(φ), b - 0.5, radius * np.cos(φ)])

    return fl.Shell(fl.mesh.parametric_surface(position, (cells, 2)), LAYER)


def forces_of(contact: fl.contact.Contact) -> tuple[np.ndarray, np.ndarray]:
    """Frames of all nodes in the beginning, and forces on them."""
    bodies = contact.bodies
    first = np.cumsum([0, *(len(body.frames) for body in bodies)])
    numbers = {b: np.arange(len(b.frames)) + k for b, k in zip(bodies, first, strict=False)}
    H = np.concatenate([body.frames for body in bodies])
    out = np.zeros((len(H), 6))
    contact.term(numbers.__getitem__).add_forces(H, out)
    return H, out


def resultants(H: np.ndarray, out: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Forces in space and their moments about the origin."""
    F = np.einsum("nij,ni->nj", H[:, 1:], out[:, :3])
    return F, np.einsum("nij,ni->nj", H[:, 1:], out[:, 3:]) + np.cross(H[:, 0], F)


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize(
    ("start", "smooth"), [(0.0, True), (0.13, True), (0.4, True), (0.13, False)]
)
def test_pressure_between_plates_is_even_whatever_the_meshes(cell, start, smooth, degree):
    """The force is that of the overlap over the whole area, without tangential force or moment."""
    one = plate(0.998 * THICK, (3, 3), start, 0.5, cell, degree)
    two = plate(0, (7, 5), cell=cell, degree=degree)
    a, b = fl.contact.ShellSurface(one, smooth=smooth), fl.contact.ShellSurface(two, smooth=smooth)
    H, out = forces_of(fl.contact.Contact(a, b, fl.contact.Penalty(K)))
    F, M = resultants(H, out)
    n, wanted = len(one.frames), K * 0.002 * THICK * 0.25
    np.testing.assert_allclose(F[:n].sum(axis=0), [0, 0, -wanted], atol=1e-9 * wanted)
    middle = start + 0.25
    np.testing.assert_allclose(
        M[:n].sum(axis=0), wanted * np.array([-middle, middle, 0]), atol=1e-9 * wanted
    )
    np.testing.assert_allclose(F.sum(axis=0), 0, atol=1e-12 * wanted)
    np.testing.assert_allclose(M.sum(axis=0), 0, atol=1e-12 * wanted)


def test_a_plane_acts_on_a_plate_in_the_same_way():
    one = plate(0.499 * THICK, (3, 3))
    H, out = forces_of(
        fl.contact.Contact(
            fl.contact.Plane(fl.ground(), (0, 0, 1)),
            fl.contact.ShellSurface(one),
            fl.contact.Penalty(K),
        )
    )
    F, _ = resultants(H, out)
    wanted = K * 0.001 * THICK
    np.testing.assert_allclose(F.sum(axis=0), [0, 0, -wanted], atol=1e-9 * wanted)


def test_a_ball_feels_no_edges_of_cells():
    """Force on a ball that goes along an arch: its size and that it points to the axis."""
    shell, sizes, aside = arch(12), [], []
    for φ in np.linspace(-0.11, 0.11, 23):
        out = np.array([np.sin(φ), 0.03, np.cos(φ)])
        across = out * np.array([1, 0, 1])
        ball = fl.RigidBody(1.0, np.eye(3), 1.0 * across + 0.1249 * across + [0, 0.03, 0])
        touch = fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), 0.1),
            fl.contact.ShellSurface(shell),
            fl.contact.Penalty(K),
        )
        H, forces = forces_of(touch)
        F, _ = resultants(H, forces)
        push = -F[0] if len(H) == 1 else -F[: 1 if touch.bodies[0] is ball else None].sum(axis=0)
        sizes.append(np.linalg.norm(push))
        aside.append(push @ [np.cos(φ), 0, -np.sin(φ)] / sizes[-1])
    assert np.ptp(sizes) < 1e-2 * np.mean(sizes)
    assert np.abs(aside).max() < 1e-3


def bent(turn: float, cells: int = 24) -> fl.Shell:
    """A strip that is bent to a part of a circle with a small pitch."""

    def position(a, b):
        φ, r = 2 * np.pi * turn * a, 0.2 + 0.6 * THICK * a
        return np.array([r * np.cos(φ), r * np.sin(φ), 0.1 * b])

    return fl.Shell(fl.mesh.parametric_surface(position, (cells, 1)), LAYER)


def test_a_sheet_that_comes_round_touches_itself_and_else_does_not():
    for turn, touches in ((0.6, False), (1.3, True)):
        surface = fl.contact.ShellSurface(bent(turn), 0.61 * THICK)
        H, out = forces_of(fl.contact.Contact(surface, surface, fl.contact.Penalty(K)))
        F, M = resultants(H, out)
        size = np.abs(F).sum()
        assert (size > 0.0) == touches
        np.testing.assert_allclose(F.sum(axis=0), 0, atol=1e-12 * max(size, 1.0))
        np.testing.assert_allclose(M.sum(axis=0), 0, atol=1e-12 * max(size, 1.0))


def test_a_bilinear_shell_surface_rotates_no_node():
    """A ball on a cell whose corners are not in a plane: forces on positions only."""
    shell = arch(3)
    ball = fl.RigidBody(1.0, np.eye(3), (0.03, 0.02, 1.1))
    surface = fl.contact.ShellSurface(shell, smooth=False)
    H, out = forces_of(
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), 0.1), surface, fl.contact.Penalty(K)
        )
    )
    F, M = resultants(H, out)
    size = np.abs(F).max()
    assert size > 0.0
    assert np.all(out[:, 3:] == 0.0)
    np.testing.assert_allclose(F.sum(axis=0), 0, atol=1e-12 * size)
    np.testing.assert_allclose(M.sum(axis=0), 0, atol=1e-12 * size)


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
def test_a_ball_next_to_a_straight_edge_is_repelled_by_its_closest_point(cell):
    shell = plate(0, (1, 1), cell=cell)
    ball = fl.RigidBody(1.0, np.eye(3), (1.1, 0.3, 0))
    surface = fl.contact.ShellSurface(shell, smooth=False)
    H, out = forces_of(
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), 0.1), surface, fl.contact.Penalty(K)
        )
    )
    F, M = resultants(H, out)
    wanted = K * 0.5 * THICK
    np.testing.assert_allclose(F[0], [-wanted, 0, 0], atol=1e-9 * wanted)
    np.testing.assert_allclose(F.sum(axis=0), 0, atol=1e-9 * wanted)
    np.testing.assert_allclose(M.sum(axis=0), 0, atol=1e-9 * wanted)


def test_what_shell_surfaces_refuse():
    one, two = plate(0, (2, 2)), plate(THICK, (2, 2))
    ball = fl.RigidBody(1.0, np.eye(3), (0.5, 0.5, 1))
    beam = fl.Beam.straight((0, 0, 1), (1, 0, 1), fl.Section.circle(0.01, MATERIAL), cells=2)
    law, surface = fl.contact.Penalty(K), fl.contact.ShellSurface(one)
    with pytest.raises(TypeError, match="ShellSurface: shell must be a Shell"):
        fl.contact.ShellSurface(beam)
    with pytest.raises(ValueError, match="ShellSurface: thickness must be a positive"):
        fl.contact.ShellSurface(one, -0.1)
    with pytest.raises(ValueError, match="ShellSurface: gauss"):
        fl.contact.ShellSurface(one, gauss=0)
    with pytest.raises(TypeError, match="ShellSurface: smooth"):
        fl.contact.ShellSurface(one, smooth=1)
    for a, b, how, message in (
        (
            surface,
            fl.contact.ShellSurface(two),
            fl.contact.Impact(),
            "touch by Penalty, not by Impact",
        ),
        (
            surface,
            fl.contact.Line(beam, 0.01),
            fl.contact.Impact(),
            "Line and ShellSurface touch by Penalty|ShellSurface and Line touch by Penalty",
        ),
        (surface, fl.contact.ShellSurface(one), law, "touches itself by one surface, given twice"),
        (
            surface,
            fl.contact.Box(ball.point("centre"), (0.1, 0.1, 0.1)),
            fl.contact.Impact(),
            "ShellSurface and Box touch by Penalty, not by Impact",
        ),
        (surface, fl.contact.ShellSurface(two, 1.2 * THICK), law, "they overlap by 0.005"),
    ):
        with pytest.raises(ValueError, match=message):
            fl.contact.Contact(a, b, how).check()
    five = fl.Shell(one.model.mesh, LAYER, drilling=False)
    scene = fl.Scene()
    scene.add(five)
    scene.add(ball)
    round_one = fl.contact.Sphere(ball.point("centre"), 0.1)
    for how in (
        fl.contact.Contact(fl.contact.ShellSurface(five), round_one, law),
        fl.contact.Contact(
            fl.contact.ShellSurface(five, smooth=False),
            round_one,
            fl.contact.Penalty(K, friction=0.2),
        ),
    ):
        with pytest.raises(ValueError, match="needs nodes that rotate about all axes"):
            scene.add(how)
    scene.add(fl.contact.Contact(fl.contact.ShellSurface(five, smooth=False), round_one, law))


# --- friction ---


def sliding_with_friction(
    start: float, drop: float = -1e-4 * THICK, friction: float = 0.2
) -> fl.Scene:
    """A sheet that lies on another one, or falls, between edges of its cells, and slides aslant."""
    lower, upper = plate(0, (4, 3)), plate(THICK + drop, (2, 2), 0.21, 0.4)
    lower.clamp("a=0")
    lower.clamp("a=1")
    upper.add_velocity((start, 0.2 * start, 0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(lower)
    scene.add(upper)
    scene.add(
        fl.contact.Contact(
            fl.contact.ShellSurface(upper),
            fl.contact.ShellSurface(lower),
            fl.contact.Penalty(1e7, friction=friction),
        )
    )
    return scene


@pytest.mark.parametrize(("speed", "drop", "friction"), [(1e-3, -5e-6, 0.2), (0.0, 1e-3, 0.4)])
def test_tractions_do_not_drill(speed, drop, friction):
    """A sheet that lies, or falls, on another: tractions have no moment arms along the sheets."""
    scene = sliding_with_friction(speed, drop, friction)
    scheme = fl.GeneralisedAlpha(radius=0.8)
    result = scheme.run(scene, duration=0.025, step=2.5e-4, progress=False)
    turned = result.frames[:, :, 1] @ [0, 1, 0]
    assert np.abs(turned).max() < 1e-3
    assert result.iterations[-1] < 8 * (len(result.times) - 1)


@pytest.mark.parametrize(("degrees", "sticks"), [(20, True), (26, True), (27.2, False)])
def test_a_sheet_sticks_or_slides_on_a_slope(degrees, sticks):
    """By Coulomb's law with μ = 0.5, whose limit is 26.57°, on a sheet that hardly sags."""
    angle, k, g, stiff = np.radians(degrees), 1e8, 9.81, fl.Material(1e10, 0.3, 1000.0)
    layer = fl.ShellSection.layer(THICK, stiff)
    rests = THICK * (1 - 1e3 * g * np.cos(angle) / k)
    lower = fl.Shell(plate(0, (4, 3)).model.mesh, layer)
    upper = fl.Shell(plate(rests, (2, 2), 0.21, 0.4).model.mesh, layer)
    for edge in ("a=0", "a=1", "b=0", "b=1"):
        lower.clamp(edge)
    scene = fl.Scene(gravity=(g * np.sin(angle), 0, -g * np.cos(angle)))
    scene.add(lower)
    scene.add(upper)
    law = fl.contact.Penalty(k, damping=3e4, ramp=1e-6, friction=0.5)
    scene.add(
        fl.contact.Contact(fl.contact.ShellSurface(upper), fl.contact.ShellSurface(lower), law)
    )
    scheme = fl.GeneralisedAlpha(radius=0.8)
    result = scheme.run(scene, duration=0.15, step=1e-3, progress=False)
    x = np.mean([result.position(fl.extend.Point(upper, k))[75:, 0] for k in range(9)], axis=0)
    if sticks:
        assert np.ptp(x) < 1e-7
    else:
        found = 2 * np.polyfit(result.times[75:], x, 2)[0]
        assert found == pytest.approx(g * (np.sin(angle) - 0.5 * np.cos(angle)), rel=2e-3)


@pytest.mark.parametrize("start", [0.5, 1e-3])
def test_a_restart_during_slip_and_stick_agrees_to_the_last_bit(tmp_path, start):
    """From a checkpoint between steps in which it slides, or begins to."""
    scheme = fl.GeneralisedAlpha(radius=0.8)
    options = {"duration": 5e-3, "step": 2.5e-4, "checkpoint_every": 13, "progress": False}
    whole = scheme.run(sliding_with_friction(start), **options, file=tmp_path / "whole.h5")
    scheme.run(sliding_with_friction(start), **options, file=tmp_path / "run.h5")
    resumed = scheme.resume(sliding_with_friction(start), tmp_path / "run.h5", progress=False)
    for name in ("frames", "velocities", "balance", "iterations"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))


# --- what goes through ---


def shot(speed: float) -> tuple[fl.Scene, fl.RigidBody]:
    """A ball above a sheet."""
    sheet = plate(0, (4, 3))
    sheet.clamp("a=0")
    sheet.clamp("a=1")
    ball = fl.RigidBody(1.0, 1e-2 * np.eye(3), (0.43, 0.52, 0.3), name="ball")
    ball.add_velocity((0, 0, -speed))
    scene = fl.Scene()
    scene.add(sheet)
    scene.add(ball)
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), 0.05),
            fl.contact.ShellSurface(sheet),
            fl.contact.Penalty(1e6),
        )
    )
    return scene, ball


@pytest.mark.parametrize("step", [1.5e-2, 2e-2])
def test_a_ball_that_goes_through_a_sheet_fails_the_step(step):
    """In 1.5e-2 s it gets as far as the middle surface."""
    scene, _ = shot(20.0)
    with pytest.raises(
        fl.ConvergenceError, match=r"on ball; ShellSurface .* passed through the other"
    ):
        fl.GeneralisedAlpha(radius=0.8).run(scene, duration=3 * step, step=step, progress=False)


def test_a_sheet_that_goes_through_a_sheet_fails_the_step():
    lower, upper = plate(0, (4, 3)), plate(0.2, (2, 2), 0.21, 0.4)
    upper.add_velocity((30, 0, -100))
    scene = fl.Scene()
    scene.add(lower)
    scene.add(upper)
    scene.add(
        fl.contact.Contact(
            fl.contact.ShellSurface(upper), fl.contact.ShellSurface(lower), fl.contact.Penalty(1e7)
        )
    )
    with pytest.raises(fl.ConvergenceError, match=r"failed: .* moved by 0.31, .* 0.05 thick"):
        fl.GeneralisedAlpha(radius=0.8).run(scene, duration=6e-3, step=3e-3, progress=False)


def test_fast_sheets_that_do_not_meet_are_let_go():
    """One goes past the edge of the other, which moves with it."""
    lower, upper = plate(0, (4, 3)), plate(0.2, (2, 2), 1.1, 0.4)
    lower.add_velocity((100, 0, 0))
    upper.add_velocity((100, 0, -100))
    scene = fl.Scene()
    scene.add(lower)
    scene.add(upper)
    scene.add(
        fl.contact.Contact(
            fl.contact.ShellSurface(upper), fl.contact.ShellSurface(lower), fl.contact.Penalty(1e7)
        )
    )
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=6e-3, step=3e-3, progress=False)
    assert result.position(fl.extend.Point(upper, 0))[-1, 2] == pytest.approx(-0.4)


def test_adaptive_steps_shrink_before_a_ball_goes_through():
    scene, ball = shot(2.0)
    choice = fl.schemes.AdaptiveStep(
        tolerance=1.0, rotation_tolerance=100.0, first=0.16, largest=0.16
    )
    scheme = fl.GeneralisedAlpha(radius=0.8)
    result = scheme.run(scene, duration=0.16, step=choice, progress=False)
    assert result.steps.rejected[0] == pytest.approx(0.16)
    assert result.position(ball.point("centre"))[:, 2].min() > 0.05


def test_statics_divide_a_step_that_goes_through():
    """A ball on a rail is driven down on a sheet, in one step to the other side of it."""
    sheet = plate(0, (4, 3))
    sheet.clamp("a=0")
    sheet.clamp("a=1")
    ball = fl.RigidBody(1.0, 1e-2 * np.eye(3), (0.43, 0.52, 0.2))
    scene = fl.Scene()
    scene.add(sheet)
    scene.add(ball)
    rail = scene.add(fl.joints.Prismatic(fl.ground(), ball.point("centre"), axis=(0, 0, 1)))
    scene.add(fl.joints.Drive(rail.displacement, lambda t: -0.22 * t))
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(ball.point("centre"), 0.05),
            fl.contact.ShellSurface(sheet),
            fl.contact.Penalty(1e6),
        )
    )
    result = fl.statics(scene, load_steps=1)
    assert len(result.factors) > 1
    assert fl.post.contact_forces(result, scene.contacts[0]).total[-1, 2] > 1e3
