"""Frequency response: closed forms of rigid bodies and springs, reduction, and wrong uses."""

import numpy as np
import pytest

import fem_lie as fl

OMEGA = np.array([0.5, 3.0, 20.0])
UP = (0.0, 0.0, 1.0)


def oscillator(stiffness: float, damping: float) -> tuple[fl.Scene, fl.RigidBody]:
    """A mass of 2 on a spring and a damper along z."""
    body = fl.RigidBody(2.0, (1.0, 1.0, 1.0), name="mass")
    scene = fl.Scene()
    scene.add(body)
    slide = scene.add(fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=UP))
    scene.add(fl.joints.Spring(slide.displacement, stiffness=stiffness, damping=damping))
    return scene, body


def cantilever(tau: float = 1e-2) -> tuple[fl.Scene, fl.Rod]:
    section = fl.Section.from_stiffness([1e4, 1e4, 1e4, 1.0, 2.0, 1.0], mass=1.0, polar=0.1)
    damping = fl.sections.Damping(stiffness=tau, mass=0.1)
    rod = fl.Rod.straight((0, 0, 0), (1, 0, 0), section, cells=6, damping=damping, name="rod")
    scene = fl.Scene()
    scene.add(rod)
    scene.add(fl.Clamp(rod.point("start")))
    return scene, rod


def test_a_damped_oscillator():
    k, c = 50.0, 3.0
    scene, body = oscillator(k, c)
    centre = body.point("centre")
    load = fl.PointLoad(centre, force=(0.3, 0.0, 1.5))
    found = fl.post.frequency_response(scene, load, OMEGA).displacement(centre)
    dynamic = k + 1j * OMEGA * c - 2.0 * OMEGA**2
    np.testing.assert_allclose(found[:, 2], 1.5 / dynamic, rtol=1e-12)
    np.testing.assert_allclose(found[:, :2], 0.0, atol=1e-14)
    shaken = fl.post.frequency_response(scene, fl.post.BaseExcitation((0, 0, 4.0)), OMEGA)
    np.testing.assert_allclose(shaken.displacement("mass.centre")[:, 2], -8.0 / dynamic, rtol=1e-12)
    both = [load, fl.post.BaseExcitation((0, 0, 4.0))]
    sum_of_both = fl.post.frequency_response(scene, both, OMEGA).displacement(centre)[:, 2]
    np.testing.assert_allclose(sum_of_both, (1.5 - 8.0) / dynamic, rtol=1e-12)


def test_loads_in_quadrature_lead_by_a_quarter_of_a_period():
    scene, body = oscillator(50.0, 3.0)
    load = fl.PointLoad(body.point("centre"), force=UP)
    ahead = fl.post.frequency_response(scene, (), OMEGA, in_quadrature=load)
    in_phase = fl.post.frequency_response(scene, load, OMEGA)
    np.testing.assert_allclose(ahead.shapes, 1j * in_phase.shapes, rtol=1e-12, atol=1e-16)


def test_a_free_body_is_accelerated_and_has_no_response_at_zero():
    body = fl.RigidBody(2.0, (1.0, 3.0, 2.0))
    scene = fl.Scene()
    scene.add(body)
    load = fl.PointLoad(body.point("centre"), force=UP, moment=(0.0, 5.0, 0.0))
    found = fl.post.frequency_response(scene, load, OMEGA).shapes[:, 0]
    expected = -np.array([0, 0, 1 / 2.0, 0, 5.0 / 3.0, 0]) / OMEGA[:, np.newaxis] ** 2
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)
    with pytest.raises(fl.ConvergenceError, match="angular frequency 0 is unbounded"):
        fl.post.frequency_response(scene, load, [0.0])


def test_an_undamped_resonance_is_no_response():
    scene, body = oscillator(50.0, 0.0)
    load = fl.PointLoad(body.point("centre"), force=UP)
    for modes in (None, 1):
        with pytest.raises(fl.ConvergenceError, match="angular frequency 5 is unbounded"):
            fl.post.frequency_response(scene, load, [1.0, 5.0], modes=modes)


def test_statics_is_the_response_at_zero():
    scene, rod = cantilever()
    load = fl.PointLoad(rod.point("end"), force=(0.0, 1e-7, 2e-7), moment=(1e-7, 0.0, 0.0))
    found = fl.post.frequency_response(scene, load, [0.0]).displacement("rod.end")[0]
    scene.add(load)
    np.testing.assert_allclose(found, fl.statics(scene).displacement("rod.end")[-1], atol=1e-13)


def test_all_modes_are_the_direct_solution():
    """Also about a loaded state that spins, where damping and stiffness couple the modes."""
    scene, rod = cantilever()
    scene.add(fl.PointLoad(rod.point("end"), force=(0, 0.3, 0), following=True))
    at = fl.statics(scene, spin=(0, 0, 2.0), newton=fl.schemes.Newton(tolerance=1e-12))
    load = fl.PointLoad(rod.point("end"), force=UP, moment=(0.1, 0, 0), following=True)
    direct = fl.post.frequency_response(scene, load, OMEGA, at=at)
    modal = fl.post.frequency_response(scene, load, OMEGA, modes=30, at=at)
    few = fl.post.frequency_response(scene, load, OMEGA, modes=8, at=at)
    size = np.abs(direct.shapes).max()
    assert np.abs(modal.shapes - direct.shapes).max() < 1e-9 * size
    assert 1e-9 * size < np.abs(few.shapes - direct.shapes).max() < 1e-2 * size
    np.testing.assert_allclose(few.shapes[0], direct.shapes[0], atol=1e-9 * size)
    assert np.abs(direct.shapes.imag).max() > 1e-3 * size


def test_a_moment_on_rotations_that_a_shell_holds_otherwise():
    """The harmonic load decides on drilling rotations as a load of the scene does."""
    layer = fl.ShellSection.layer(0.1, fl.Material(1e4, 0.3, 1.0))
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (3, 3))
    shell = fl.Shell(mesh, layer, name="plate")
    scene = fl.Scene()
    scene.add(shell)
    for node in np.flatnonzero(shell.frames[:, 0, 0] < 1e-9):
        scene.add(fl.Clamp(shell.point(int(node))))
    corner = int(np.flatnonzero((shell.frames[:, 0, :2] > 1 - 1e-9).all(axis=1))[0])
    load = fl.PointLoad(shell.point(corner), moment=(0, 0, 1e-6))
    found = fl.post.frequency_response(scene, load, [0.0]).displacement(f"plate.node {corner}")[0]
    scene.add(load)
    expected = fl.statics(scene).displacement(f"plate.node {corner}")[-1]
    assert np.abs(expected).max() > 0.0
    np.testing.assert_allclose(found, expected, atol=1e-5 * np.abs(expected).max())


def test_text_and_picture(tmp_path):
    scene, rod = cantilever()
    load = fl.PointLoad(rod.point("end"), force=UP)
    found = fl.post.frequency_response(scene, load, OMEGA)
    assert len(str(found).splitlines()) == 1 + len(OMEGA)
    np.testing.assert_allclose(found.hertz * 2 * np.pi, OMEGA)
    figure = found.picture("rod.end", tmp_path / "response.png")
    assert (tmp_path / "response.png").stat().st_size > 10_000
    above, below = figure.axes
    assert [line.get_label() for line in above.lines] == ["$u_z$"]
    np.testing.assert_allclose(
        above.lines[0].get_ydata(), np.abs(found.displacement("rod.end")[:, 2])
    )
    assert len(below.lines) == 1


def wrong_uses():
    scene, rod = cantilever()
    other, _ = cantilever()
    tip = rod.point("end")
    load = fl.PointLoad(tip, force=UP)
    moving = fl.PointLoad(tip, force=UP, history=np.sin)
    strain = fl.loads.Eigenstrain(rod, (0, 0, 0, 0, 0.1, 0))
    respond = fl.post.frequency_response
    value, kind = ValueError, TypeError
    return {
        "history": (
            value,
            "expected amplitudes.*with a history",
            lambda: respond(scene, moving, [1.0]),
        ),
        "strain": (value, "expected forces, got a strain", lambda: respond(scene, strain, [1.0])),
        "other body": (value, "is not in the scene", lambda: respond(other, load, [1.0])),
        "no load": (value, "expected a load", lambda: respond(scene, [], [1.0])),
        "number": (kind, "loads must be loads or base", lambda: respond(scene, [3.0], [1.0])),
        "negative": (value, "angular frequencies ≥ 0", lambda: respond(scene, load, [1.0, -1.0])),
        "no frequency": (value, "angular frequencies ≥ 0", lambda: respond(scene, load, [])),
        "no array": (value, "angular frequencies ≥ 0", lambda: respond(scene, load, 1.0)),
        "modes": (value, "modes must be 1", lambda: respond(scene, load, [1.0], modes=1000)),
        "no modes": (value, "modes", lambda: respond(scene, load, [1.0], modes=0)),
        "clamped": (
            value,
            "act on nothing that can move",
            lambda: respond(scene, fl.PointLoad(rod.point("start"), force=UP), [1.0]),
        ),
        "fixed in space": (
            value,
            "parallel to the spin",
            lambda: respond(scene, load, [1.0], spin=(1.0, 0.0, 0.0)),
        ),
        "shaken across": (
            value,
            "parallel to the spin",
            lambda: respond(
                scene, fl.post.BaseExcitation((0, 0, 1.0)), [1.0], spin=(1.0, 0.0, 0.0)
            ),
        ),
        "no base": (value, "must not be zero", lambda: fl.post.BaseExcitation((0, 0, 0))),
        "no scene": (kind, "Scene", lambda: respond(rod, load, [1.0])),
    }


@pytest.mark.parametrize("use", wrong_uses())
def test_wrong_uses(use):
    kind, message, call = wrong_uses()[use]
    with pytest.raises(kind, match=message):
        call()
