"""Mortar contact along lines: patch test, derivatives, invariants, closed forms, refusals."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import mortar
from fem_lie import lie
from tests.test_friction import moved, on_nodes

RADIUS = 0.01
SECTION = fl.Section.circle(RADIUS, fl.Material(1e9, 0.3, 1000.0))


def straight(start, end, cells: int) -> fl.Beam:
    return fl.Beam.straight(start, end, SECTION, cells=cells)


def on_line(friction: float = 0.0) -> fl.contact.Contact:
    """Meshes that do not match, askew; the first line ends within the second."""
    one, other = straight((0, 0, 0.0199), (1, 0, 0.0199), 7), straight((-0.1, 0, 0), (1.1, 0, 0), 5)
    lines = fl.contact.Line(one, RADIUS), fl.contact.Line(other, RADIUS)
    return fl.contact.Contact(*lines, fl.contact.MortarPenalty(1e6, friction))


def on_shell(friction: float = 0.0) -> fl.contact.Contact:
    """A line across faces of a shell."""
    one = straight((0, -0.05, 0.0199), (1, 0.12, 0.0199), 7)
    mesh = fl.mesh.parametric_surface(
        lambda a, b: np.array([1.2 * a - 0.1, 0.4 * b - 0.2, 0]), (5, 3)
    )
    sheet = fl.Shell(mesh, fl.ShellSection.layer(0.02, fl.Material(5e8, 0.3, 1000.0)))
    surfaces = fl.contact.Line(one, RADIUS), fl.contact.ShellSurface(sheet)
    return fl.contact.Contact(*surfaces, fl.contact.MortarPenalty(1e6, friction))


PAIRS = {"line": on_line, "shell": on_shell}
every_pair = pytest.mark.parametrize("pair", PAIRS)


def term_of(pair: str, friction: float = 0.0):
    """The term, and initial frames."""
    contact = PAIRS[pair](friction)
    nodes, H = contact.pair.numbered()
    return contact.pair.term(nodes), H


def forces(term, H: np.ndarray) -> np.ndarray:
    out = np.zeros((len(H), 6))
    term.add_forces(H, out)
    return out


def bent(H: np.ndarray) -> np.ndarray:
    size = 2e-4 * np.array([1, 1, 1, 20, 20, 20])
    return lie.se3_retract(H, size * np.random.default_rng(0).standard_normal((len(H), 6)))


@every_pair
def test_an_even_pressure_has_consistent_forces_on_both_sides(pair):
    """Forces of a straight line with an even overlap: integrals of shape functions, exactly."""
    term, H = term_of(pair)
    np.testing.assert_allclose(term.pressures(H), 100.0, rtol=1e-10)
    f = forces(term, H)[:, 2]
    length = np.hypot(1.0, 0.17) if pair == "shell" else 1.0
    lengths = np.full(8, length / 7)
    lengths[[0, -1]] *= 0.5
    np.testing.assert_allclose(f[:8], -100.0 * lengths, rtol=1e-10)
    # what the second surface has balances force and moment
    np.testing.assert_allclose(f[8:].sum(), 100.0 * length, rtol=1e-10)
    F, X = f[:, np.newaxis] * [0, 0, 1], H[:, 0]
    moment = np.cross(X, F) + np.einsum("nij,ni->nj", H[:, 1:], forces(term, H)[:, 3:])
    assert np.abs(moment.sum(axis=0)).max() < 1e-11


@every_pair
def test_forces_are_the_derivative_of_the_energy_and_the_tangent_theirs(pair):
    """Ends of segments move with the nodes: their quadrature errors are not in derivatives."""
    term, H = term_of(pair)
    H, rng = bent(H), np.random.default_rng(1)
    term.multipliers[:] = rng.uniform(0, 100, len(term.multipliers))
    d, e = rng.standard_normal((len(H), 6)), 1e-6
    there, back = lie.se3_retract(H, e * d), lie.se3_retract(H, -e * d)
    slope = (term.energy(there) - term.energy(back)) / (2 * e)
    assert slope == pytest.approx((forces(term, H) * d).sum(), rel=1e-4)
    change = (forces(term, there) - forces(term, back)) / (2 * e)
    tangent, (rows, columns) = np.zeros_like(change), term.pairs
    np.add.at(tangent, rows, np.einsum("pij,pj->pi", term.tangent(H, None), d[columns]))
    np.testing.assert_allclose(tangent, change, atol=1e-5 * np.abs(change).max())


def cable_on_line(friction: float) -> fl.contact.Contact:
    """The first line of :func:`on_line` without rotations."""
    one = fl.Cable.straight((0, 0, 0.0199), (1, 0, 0.0199), SECTION, cells=7)
    lines = fl.contact.Line(one, RADIUS), on_line().b
    return fl.contact.Contact(*lines, fl.contact.MortarPenalty(1e6, friction))


def cable_on_plane(friction: float) -> fl.contact.Contact:
    """On ground, so that springs are constant in space."""
    plane = fl.contact.Plane(fl.ground((0, 0, 0.0099)), (0, 0, 1))
    return fl.contact.Contact(cable_on_line(0.0).a, plane, fl.contact.MortarPenalty(1e6, friction))


@pytest.mark.parametrize("make", [on_line, on_shell, cable_on_line, cable_on_plane])
@pytest.mark.parametrize("friction", [0.01, 10.0])
def test_the_tangent_of_friction_is_the_derivative_of_the_forces(make, friction):
    """Where nodes slip and where they stick, also with the springs of an accepted state."""
    contact = make(friction)
    (nodes, H), rng = contact.pair.numbered(), np.random.default_rng(1)
    term, types = contact.pair.term(nodes), contact.pair.node_types(nodes)
    size = 2e-4 * np.array([1, 1, 1, 20, 20, 20])
    H = moved(types, H, size * np.random.default_rng(0).standard_normal((len(H), 6)))
    d, e = rng.standard_normal((len(H), 6)), 1e-8
    for springs in (False, True):
        if springs:
            before = on_nodes(types, H, forces(term, H))[0]
            term.accept(H)
            F, M = on_nodes(types, H, forces(term, H))
            # tractions are kept, and act at other points
            np.testing.assert_allclose(F, before, atol=2e-2 * np.abs(F).max())
            if make is not cable_on_plane:
                assert np.abs(F.sum(axis=0)).max() < 1e-11
                assert np.abs(M.sum(axis=0)).max() < 1e-11
            H = moved(types, H, 0.3 * size * rng.standard_normal((len(H), 6)))
        change = forces(term, moved(types, H, e * d)) - forces(term, moved(types, H, -e * d))
        change /= 2 * e
        tangent, (rows, columns) = np.zeros_like(change), term.pairs
        np.add.at(tangent, rows, np.einsum("pij,pj->pi", term.tangent(H, None), d[columns]))
        np.testing.assert_allclose(tangent, change, atol=1e-5 * np.abs(change).max())


@every_pair
def test_rigid_motions_change_no_pressure_and_forces_balance(pair):
    term, H = term_of(pair)
    H = bent(H)
    pressures = term.pressures(H)
    assert pressures.max() > 100.0
    f, X = forces(term, H), H[:, 0]
    F, M = (np.einsum("nij,ni->nj", H[:, 1:], part) for part in (f[:, :3], f[:, 3:]))
    assert np.abs(F.sum(axis=0)).max() < 1e-11
    assert np.abs((M + np.cross(X, F)).sum(axis=0)).max() < 1e-11
    turned = lie.se3_compose(lie.se3_exp(np.array([0.3, -2, 1, 0.5, 1.2, -0.7])), H)
    np.testing.assert_allclose(term.pressures(turned), pressures, rtol=1e-9, atol=1e-9)


def test_pressed_beams_have_an_even_pressure():
    """Multipliers to round-off whatever the stiffness, which a penalty along lines does not."""
    for stiffness in (1e4, 1e6):
        found = mortar.pressed(fl.contact.Mortar(stiffness))
        assert found["uneven"] < 1e-10
        assert found["force"] == pytest.approx(found["expected"], rel=1e-6)
    assert mortar.pressed(fl.contact.MortarPenalty(1e5))["uneven"] < 1e-10
    for law in (fl.contact.Mortar(1e5), fl.contact.MortarPenalty(1e5)):
        assert mortar.askew(law) < 1e-10
    assert mortar.pressed(fl.contact.Penalty(1e5))["uneven"] > 1e-6


def test_a_belt_has_the_pressure_of_its_tension_over_the_radius():
    """Newton's method on the saddle point takes few iterations whatever the stiffness."""
    for stiffness in (1e7, 1e9):
        found = mortar.belt(fl.contact.Mortar(stiffness))
        assert abs(found["mean"]) < 5e-4
        assert found["largest"] < 5e-3
        assert found["iterations"] < 12


@pytest.mark.parametrize("law", [fl.contact.Mortar(1e6), fl.contact.MortarPenalty(1e6)])
def test_a_cylinder_on_an_elastic_foundation(law):
    """Force and largest pressure of the parabola; one of the equilibria has delayed pivots."""
    found = mortar.hertz(law)
    assert abs(found["force"]) < 2e-3
    assert abs(found["pressure"]) < 1e-3


@pytest.mark.parametrize("thick", [2e-4, 5e-3])
def test_a_belt_that_slips_has_the_tensions_of_a_capstan(thick):
    found = mortar.capstan(fl.contact.MortarPenalty(1e6, 0.3), 20, thick)
    assert abs(found["error"]) < 3e-3


def thrown(velocity: tuple[float, float, float], friction: float) -> fl.Scene:
    """A beam that rests on a plane by its weight, with a velocity."""
    stiffness, weight = 1e5, 9.81 * 1000.0 * np.pi * RADIUS**2
    z = RADIUS - weight / stiffness
    beam = straight((0, 0, z), (0.5, 0, z), 5)
    beam.add_velocity(velocity)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(beam)
    plane = fl.contact.Plane(fl.ground(), (0, 0, 1))
    law = fl.contact.MortarPenalty(stiffness, friction)
    scene.add(fl.contact.Contact(fl.contact.Line(beam, RADIUS), plane, law))
    return scene


def test_a_beam_slides_to_rest_along_its_axis():
    """After v²/2μg, less the first half of a step; its energy is dissipated, by contact forces."""
    friction, speed, step = 0.2, 0.5, 1e-3
    scene = thrown((speed, 0, 0), friction)
    (beam,), (contact,) = scene.bodies, scene.contacts
    result = fl.GeneralisedAlpha().run(scene, duration=0.3, step=step, progress=False)
    expected = speed**2 / (2 * friction * 9.81)
    way = result.displacement(beam.point(2))[-1, 0]
    assert way == pytest.approx(expected, abs=speed * step)
    weight = 9.81 * 1000.0 * np.pi * RADIUS**2 * 0.5
    assert result.balance[-1, 1] == pytest.approx(0.5 * weight / 9.81 * speed**2, rel=2e-3)
    total = fl.post.contact_forces(result, contact).total[100]
    np.testing.assert_allclose(total[[0, 2]], [-friction * weight, weight], rtol=1e-2)


def test_a_beam_that_slides_sideways_rolls_with_two_thirds_of_the_speed():
    result = fl.GeneralisedAlpha().run(
        thrown((0, 0.2, 0), 0.2), duration=0.1, step=1e-3, progress=False
    )
    y = result.frames[-21:, 2, 0, 1]
    assert (y[-1] - y[0]) / 0.02 == pytest.approx(0.2 * 2 / 3, rel=1e-3)


def test_a_restart_during_slip_agrees_to_the_last_bit(tmp_path):
    scheme, options = fl.GeneralisedAlpha(), {"duration": 0.02, "step": 1e-3, "progress": False}
    options["checkpoint_every"] = 13

    def scene() -> fl.Scene:
        return thrown((0.05, 0.03, 0), 0.2)

    whole = scheme.run(scene(), **options, file=tmp_path / "whole.h5")
    scheme.run(scene(), **options, file=tmp_path / "run.h5")
    resumed = scheme.resume(scene(), tmp_path / "run.h5", progress=False)
    np.testing.assert_array_equal(resumed.frames, whole.frames)
    np.testing.assert_array_equal(resumed.balance, whole.balance)
    np.testing.assert_array_equal(resumed.friction.each, whole.friction.each)


def test_crossed_cables():
    """Penalty and multipliers; the latter may slide off, with a warning."""
    assert abs(mortar.crossed(fl.contact.Penalty(1e8))["error"]) < 1e-3
    with pytest.warns(fl.stability.UnstableEquilibriumWarning):
        assert abs(mortar.crossed(fl.contact.Mortar(1e7))["error"]) < 1e-3


def test_multipliers_never_pull_and_go_when_surfaces_part():
    """A beam on a plane that is lifted at one end, as far as its weight allows."""
    lift, weight, bending = 0.6, 9.81 * 1000.0 * np.pi * RADIUS**2, 1e9 * np.pi * RADIUS**4 / 4
    free = 2 * lift / weight
    beam = straight((0, 0, RADIUS), (1, 0, RADIUS), 20)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, lift)))
    plane = fl.contact.Plane(fl.ground(), (0, 0, 1))
    law = fl.contact.Mortar(1e8)
    contact = scene.add(fl.contact.Contact(fl.contact.Line(beam, RADIUS), plane, law))
    rest = fl.statics(scene)
    found = fl.post.contact_forces(rest, contact)
    last = found.states == found.count - 1
    assert found.forces[last, 2].min() > 0.0
    assert abs(found.positions[last, 0].max() - (1 - free)) < 0.1
    height = lift * free**3 / (12 * bending)
    assert rest.displacement(beam.point("end"))[-1, 2] == pytest.approx(height, rel=0.05)


def test_two_beams_that_collide_keep_their_momenta():
    """With a penalty on mean gaps; multipliers are refused in motion."""
    one = straight((-0.4, 0, 0.0201), (0.4, 0, 0.0201), 8)
    other = straight((-0.3, 0, 0), (0.5, 0, 0), 5)
    one.add_velocity((0, 0, -0.2))
    lines = fl.contact.Line(one, RADIUS), fl.contact.Line(other, RADIUS)
    scene = fl.Scene()
    for body in (one, other):
        scene.add(body)
    contact = scene.add(fl.contact.Contact(*lines, fl.contact.MortarPenalty(1e5)))
    options = {"duration": 2e-3, "step": 5e-5, "progress": False}
    result = fl.Explicit().run(scene, **options)
    assert fl.post.contact_forces(result, contact).total[-1, 2] > 0.1
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-12
    with pytest.raises(ValueError, match="does not support mortar contacts"):
        fl.EnergyMomentum().run(scene, **options)


def test_what_is_refused():
    one = straight((0, 0, RADIUS), (1, 0, RADIUS), 2)
    line, law = fl.contact.Line(one, RADIUS), fl.contact.Mortar(1e6)
    plane = fl.contact.Plane(fl.ground(), (0, 0, 1))
    scene = fl.Scene()
    scene.add(one)
    scene.add(fl.contact.Contact(line, plane, law))
    with pytest.raises(ValueError, match="Mortar is for statics"):
        fl.GeneralisedAlpha().run(scene, duration=1e-3, step=1e-3, progress=False)
    with pytest.raises(ValueError, match="a line touches itself by Penalty, not by Mortar"):
        fl.contact.Contact(line, line, law).check()
    ball = fl.contact.Sphere(one.point("end"), 0.1)
    with pytest.raises(ValueError, match="no contact pair of Sphere and Plane"):
        fl.contact.Contact(ball, plane, law).check()
    with pytest.raises(ValueError, match="Mortar: stiffness must be a positive"):
        fl.contact.Mortar(-1.0)
    with pytest.raises(ValueError, match="MortarPenalty: friction must not be negative"):
        fl.contact.MortarPenalty(1.0, -0.1)
    cables = [fl.Cable.straight((0, 0, z), (1, 0, z), SECTION, cells=2) for z in (0.0, 0.02)]
    slipping = fl.contact.MortarPenalty(1e6, 0.3)
    with pytest.raises(ValueError, match="friction acts on surfaces"):
        fl.contact.Contact(*(fl.contact.Line(each, RADIUS) for each in cables), slipping).check()
    for scheme in (fl.EnergyMomentum(), fl.schemes.Variational()):
        scene = fl.Scene()
        scene.add(one)
        scene.add(fl.contact.Contact(line, plane, slipping))
        with pytest.raises(ValueError, match="friction"):
            scheme.run(scene, duration=1e-3, step=1e-4, progress=False)


def test_explicit_steps_have_the_friction_of_implicit_ones():
    """A soft beam slides across a plane, and begins to roll."""
    section, found = fl.Section.circle(0.02, fl.Material(1e7, 0.3, 1000.0)), []
    for scheme, step in ((fl.GeneralisedAlpha(radius=0.9), 1e-4), (fl.Explicit(), 2e-5)):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        beam = scene.add(fl.Beam.straight((0, 0, 0.02), (1, 0, 0.02), section, cells=4))
        beam.add_velocity((0, 0.5, 0))
        plane, law = fl.contact.Plane(fl.ground(), (0, 0, 1)), fl.contact.MortarPenalty(1e6, 0.3)
        scene.add(fl.contact.Contact(fl.contact.Line(beam, 0.02), plane, law))
        result = scheme.run(scene, duration=0.05, step=step, progress=False)
        lost = result.total_energy[0] - result.total_energy[-1]
        assert lost == pytest.approx(result.balance[-1, 1], rel=1e-6)
        found.append((lost, *result.velocity(beam.point("end"))[-1, 1::2][:2]))
    assert found[0][0] > 0.1 * 0.4
    np.testing.assert_allclose(found[0], found[1], rtol=1e-3)
