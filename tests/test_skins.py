"""Faces of shells by penalty: pressures, invariants, how even forces are, what is refused."""

import numpy as np
import pytest

import fem_lie as fl

THICK, K = 0.05, 1e9
MATERIAL = fl.Material(1e7, 0.3, 1000.0)
LAYER = fl.ShellSection.layer(THICK, MATERIAL)


def plate(z, cells, start=0.0, length=1.0, cell="quadrilateral") -> fl.Shell:
    def place(a, b):
        return np.array([start + length * a, start + length * b, z])

    return fl.Shell(fl.surface(place, cells, cell=cell), LAYER)


def arch(cells: int, radius: float = 1.0) -> fl.Shell:
    """A part of a cylinder about the y axis."""

    def place(a, b):
        φ = 1.2 * (a - 0.5)
        return np.array([radius * np.sin(φ), b - 0.5, radius * np.cos(φ)])

    return fl.Shell(fl.surface(place, (cells, 2)), LAYER)


def forces_of(contact: fl.Contact) -> tuple[np.ndarray, np.ndarray]:
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
@pytest.mark.parametrize("start", [0.0, 0.13, 0.4])
def test_pressure_between_plates_is_even_whatever_the_meshes(cell, start):
    """Force is that of the overlap on the whole area, and pushes neither aside nor round."""
    one, two = plate(0.998 * THICK, (3, 3), start, 0.5, cell), plate(0, (7, 5), cell=cell)
    H, out = forces_of(fl.Contact(fl.Skin(one), fl.Skin(two), fl.Penalty(K)))
    F, M = resultants(H, out)
    n, wanted = len(one.frames), K * 0.002 * THICK * 0.25
    np.testing.assert_allclose(F[:n].sum(axis=0), [0, 0, -wanted], atol=1e-9 * wanted)
    middle = start + 0.25
    np.testing.assert_allclose(
        M[:n].sum(axis=0), wanted * np.array([-middle, middle, 0]), atol=1e-9 * wanted
    )
    np.testing.assert_allclose(F.sum(axis=0), 0, atol=1e-12 * wanted)
    np.testing.assert_allclose(M.sum(axis=0), 0, atol=1e-12 * wanted)


def test_a_plane_pushes_a_plate_likewise():
    one = plate(0.499 * THICK, (3, 3))
    H, out = forces_of(fl.Contact(fl.Plane(fl.ground(), (0, 0, 1)), fl.Skin(one), fl.Penalty(K)))
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
        touch = fl.Contact(fl.Sphere(ball.centre, 0.1), fl.Skin(shell), fl.Penalty(K))
        H, forces = forces_of(touch)
        F, _ = resultants(H, forces)
        push = -F[0] if len(H) == 1 else -F[: 1 if touch.bodies[0] is ball else None].sum(axis=0)
        sizes.append(np.linalg.norm(push))
        aside.append(push @ [np.cos(φ), 0, -np.sin(φ)] / sizes[-1])
    assert np.ptp(sizes) < 1e-2 * np.mean(sizes)
    assert np.abs(aside).max() < 1e-3


def bent(turn: float, cells: int = 24) -> fl.Shell:
    """A strip that is bent to a part of a turn with a little pitch."""

    def place(a, b):
        φ, r = 2 * np.pi * turn * a, 0.2 + 0.6 * THICK * a
        return np.array([r * np.cos(φ), r * np.sin(φ), 0.1 * b])

    return fl.Shell(fl.surface(place, (cells, 1)), LAYER)


def test_a_sheet_that_comes_round_touches_itself_and_else_does_not():
    for turn, touches in ((0.6, False), (1.3, True)):
        skin = fl.Skin(bent(turn), 0.61 * THICK)
        H, out = forces_of(fl.Contact(skin, skin, fl.Penalty(K)))
        F, M = resultants(H, out)
        size = np.abs(F).sum()
        assert (size > 0.0) == touches
        np.testing.assert_allclose(F.sum(axis=0), 0, atol=1e-12 * max(size, 1.0))
        np.testing.assert_allclose(M.sum(axis=0), 0, atol=1e-12 * max(size, 1.0))


def test_what_skins_refuse():
    one, two = plate(0, (2, 2)), plate(THICK, (2, 2))
    ball = fl.RigidBody(1.0, np.eye(3), (0.5, 0.5, 1))
    beam = fl.Beam.straight((0, 0, 1), (1, 0, 1), fl.Section.circle(0.01, MATERIAL), cells=2)
    law, skin = fl.Penalty(K), fl.Skin(one)
    with pytest.raises(TypeError, match="Skin: shell must be a Shell"):
        fl.Skin(beam)
    with pytest.raises(ValueError, match="Skin: thickness must be a positive"):
        fl.Skin(one, -0.1)
    with pytest.raises(ValueError, match="Skin: gauss"):
        fl.Skin(one, gauss=0)
    for a, b, how, message in (
        (skin, fl.Skin(two), fl.Impact(), "touch by Penalty, not by Impact"),
        (skin, fl.Line(beam, 0.01), law, "touch skins, balls and planes, not lines"),
        (skin, fl.Skin(one), law, "touches itself by one skin, given twice"),
        (skin, fl.Box(ball.centre, (0.1, 0.1, 0.1)), law, "corners of a box do not touch skins"),
        (skin, fl.Sphere(ball.centre, 3.0, hollow=True), law, "do not touch what is around"),
        (skin, fl.Skin(two, 1.2 * THICK), law, "they overlap by 0.005"),
    ):
        with pytest.raises(ValueError, match=message):
            fl.Contact(a, b, how).check()
    five = fl.Shell(one.mesh, LAYER, parameters=fl.Parameters.FIVE)
    scene = fl.Scene()
    scene.add(five)
    scene.add(ball)
    with pytest.raises(ValueError, match="needs nodes that turn about all axes"):
        scene.add(fl.Contact(fl.Skin(five), fl.Sphere(ball.centre, 0.1), law))


def rubbing(start: float) -> fl.Scene:
    """A sheet that lies on another one, between edges of its cells, and slides aslant."""
    lower, upper = plate(0, (4, 3)), plate(0.9999 * THICK, (2, 2), 0.21, 0.4)
    lower.clamp("a=0")
    lower.clamp("a=1")
    upper.move((start, 0.2 * start, 0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(lower)
    scene.add(upper)
    scene.add(fl.Contact(fl.Skin(upper), fl.Skin(lower), fl.Penalty(1e7, friction=0.2)))
    return scene


def test_goes_on_to_the_last_bit_from_the_middle_of_slip(tmp_path):
    """From a checkpoint between steps in which it slides."""
    scheme = fl.GeneralisedAlpha(radius=0.8)
    options = {"duration": 5e-3, "step": 2.5e-4, "checkpoint_every": 13, "progress": False}
    whole = scheme.run(rubbing(0.5), **options, file=tmp_path / "whole.h5")
    scheme.run(rubbing(0.5), **options, file=tmp_path / "run.h5")
    resumed = scheme.resume(rubbing(0.5), tmp_path / "run.h5", progress=False)
    for name in ("frames", "velocities", "balance", "iterations"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))
