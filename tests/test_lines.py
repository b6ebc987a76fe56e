"""Line contact of beams by penalty: how even forces are, invariants, closed forms, refusals."""

import numpy as np
import pytest

import fem_lie as fl

RADIUS, CELL = 0.01, 0.1
SECTION = fl.Section.circle(RADIUS, fl.Material(1e9, 0.3, 1000.0))
LAW = fl.contact.Penalty(1e6)


def straight(start, end, cells=8, **options) -> fl.Beam:
    return fl.Beam.straight(start, end, SECTION, cells=cells, **options)


def force_at(contact: fl.contact.Contact, bodies: list[fl.Beam]) -> np.ndarray:
    """Total force on the first line in the beginning."""
    count = np.cumsum([0, *(len(body.frames) for body in bodies)])
    numbers = {b: np.arange(len(b.frames)) + k for b, k in zip(bodies, count, strict=False)}
    H = np.concatenate([body.frames for body in bodies])
    return contact.term(numbers.__getitem__).touching(H, np.zeros((len(H), 6)))[3].sum(axis=0)


@pytest.mark.parametrize("degrees", [0.1, 1, 5, 10, 20, 45, 90])
def test_the_force_is_even_along_elements(degrees):
    """It changes by less than a thousandth as the other beam is moved over an element."""
    angle, deep = np.radians(degrees), 0.05
    along = 4 * np.array([np.cos(angle), np.sin(angle), 0])
    sizes = []
    for x in np.linspace(-0.5, 0.5, 13) * CELL:
        one = straight((-2, 0, 0), (2, 0, 0), cells=40)
        middle = np.array([x, 0, 2 * RADIUS * (1 - deep)])
        other = straight(middle - along, middle + along, cells=61)
        contact = fl.contact.Contact(
            fl.contact.Line(one, RADIUS), fl.contact.Line(other, RADIUS), LAW
        )
        found = force_at(contact, [one, other])
        assert np.abs(found[:2]).max() < 4e-3 * abs(found[2])
        sizes.append(-found[2])
    assert np.ptp(sizes) < 1e-3 * np.mean(sizes)


def test_lines_find_all_others_whatever_the_cells():
    """A beam across a bundle: as much force as on each of the bundle by itself."""
    one = straight((0, -0.2, 0), (0, 0.2, 0), cells=6)
    bundle = [
        straight((-0.3, y, 0.0195), (0.3, y, 0.0195), cells=4) for y in np.linspace(-0.15, 0.15, 5)
    ]
    each = [
        force_at(
            fl.contact.Contact(fl.contact.Line(one, RADIUS), fl.contact.Line(b, RADIUS), LAW),
            [one, b],
        )
        for b in bundle
    ]
    # the exact integral of the overlap of two crossing cylinders
    s = np.linspace(-1, 1, 20001) * np.sqrt(0.02**2 - 0.0195**2)
    d = np.hypot(0.0195, s)
    wanted = 1e6 * np.trapezoid((0.02 - d) * 0.0195 / d, s)
    np.testing.assert_allclose([-f[2] for f in each], wanted, rtol=1e-3)


def test_a_beam_that_falls_on_a_plane_keeps_its_energy():
    """And a free pair that collides its momenta, too."""
    one = straight((-0.4, 0, 0.03), (0.4, 0, 0.03))
    other = straight((0.05, -0.4, 0), (-0.05, 0.4, 0))
    one.add_velocity((0, 0, -0.5))
    scene = fl.Scene()
    for item in (one, other):
        scene.add(item)
    law = fl.contact.Penalty(2e5)
    contact = scene.add(
        fl.contact.Contact(fl.contact.Line(one, RADIUS), fl.contact.Line(other, RADIUS), law)
    )
    scheme = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-9)
    result = scheme.run(scene, duration=0.1, step=1e-4, progress=False)
    forces = fl.post.contact_forces(result, contact)
    assert forces.penetration.max() > 1e-4
    assert result.energy_error < 1e-2
    np.testing.assert_allclose(result.momentum[-1], result.momentum[0], atol=1e-9)
    turning = result.angular_momentum
    np.testing.assert_allclose(turning[-1], turning[0], atol=1e-9)


def test_a_beam_lies_on_a_plane():
    """Along all of it by its weight."""
    beam = straight((-0.4, 0, RADIUS), (0.4, 0, RADIUS))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(beam)
    contact = scene.add(
        fl.contact.Contact(
            fl.contact.Plane(fl.ground(), (0, 0, 1)),
            fl.contact.Line(beam, RADIUS),
            fl.contact.Penalty(1e6, 5e2),
        )
    )
    scheme = fl.GeneralisedAlpha(radius=0.5, tolerance=1e-9)
    result = scheme.run(scene, duration=0.2, step=1e-3, progress=False)
    weight = 9.81 * 1000.0 * np.pi * RADIUS**2
    forces = fl.post.contact_forces(result, contact, [-1])
    np.testing.assert_allclose(forces.total[0], (0, 0, 0.8 * weight), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(forces.gaps, -weight / 1e6, rtol=1e-4)


def test_stretches_are_seen_again():
    """Axes are stretched as their beams are, by steps that a checkpoint has to know."""
    one, other = straight((-0.4, 0, 0), (0.4, 0, 0)), straight((0, -0.4, 0), (0, 0.4, 0))
    bent = np.concatenate([one.frames, other.frames])
    bent[:, 0, 2] = 0.2 * (bent[:, 0, 0] ** 2 - bent[:, 0, 1] ** 2)
    bent[len(one.frames) :, 0, 2] += 0.0195
    term = fl.contact.Contact(
        fl.contact.Line(one, RADIUS), fl.contact.Line(other, RADIUS), LAW
    ).term({one: np.arange(9), other: np.arange(9, 18)}.__getitem__)

    def forces(stretch: float) -> np.ndarray:
        H, out = bent.copy(), np.zeros((18, 6))
        H[:, 0, :2] *= stretch
        term.add_forces(H, out)
        return out

    forces(1.0)
    before, pair_positions = forces(1.00009), term.pair_positions.copy()
    after = forces(1.2)
    assert np.abs(after[:, :3]).max() > 0.0
    assert not np.array_equal(forces(1.00009), before)
    term.restore_pairs(pair_positions)
    np.testing.assert_array_equal(forces(1.00009), before)


def crossing(law: fl.contact.Penalty | fl.contact.Impact, z: float = 0.02) -> fl.contact.Contact:
    one, other = straight((-1, 0, 0), (1, 0, 0)), straight((0, -1, z), (0, 1, z))
    return fl.contact.Contact(
        fl.contact.Line(one, RADIUS), fl.contact.Line(other, RADIUS), law, name="two"
    )


def refuse_twice() -> None:
    beam = straight((-1, 0, 0), (1, 0, 0))
    lines = (fl.contact.Line(beam, RADIUS) for _ in range(2))
    fl.contact.Contact(*lines, LAW).check()


def refuse_ball() -> None:
    line = fl.contact.Line(straight((-1, 0, 0), (1, 0, 0)), RADIUS)
    fl.contact.Contact(fl.contact.Sphere(fl.ground(), 0.1), line, LAW).check()


def refuse_kink() -> None:
    beam = fl.Beam.polyline([(0, 0, 0), (1, 0, 0), (1, 1, 0)], SECTION, cells=2)
    frames = beam.frames
    frames[0, 1:] = [[0.9, 0, np.sqrt(0.19)], [0, 1, 0], [-np.sqrt(0.19), 0, 0.9]]
    fl.contact.Line(beam, RADIUS).check()


def refuse_curl() -> None:
    """A ring as thick as it is wide: positions on the axis nearest to others are not unique."""
    beam = fl.Beam.curve(
        lambda s: 0.01 * np.array([np.cos(5 * s), np.sin(5 * s), 0.0]), SECTION, cells=40
    )
    fl.contact.Line(beam, RADIUS).check()


REFUSED = {
    "curl": (refuse_curl, "are not unique"),
    "impact": (
        lambda: crossing(fl.contact.Impact()).check(),
        "two: Line and Line touch by Penalty",
    ),
    "overlap": (lambda: crossing(LAW, 0.018).check(), r"two: they overlap by 0.0019"),
    "itself": (refuse_twice, "touches itself by one Line, given twice"),
    "ball": (refuse_ball, r"Sphere on ground.* they overlap by 0\.1"),
    "kink": (refuse_kink, "e₁ of node 0 is more than 10° off"),
    "ramp": (lambda: fl.contact.Penalty(1.0, 1.0, ramp=-1.0), "ramp must not be negative"),
    "radius": (lambda: fl.contact.Line(straight((-1, 0, 0), (1, 0, 0)), 0.0), "Line: radius"),
    "bar": (
        lambda: fl.contact.Cylinder(fl.ground(), (0, 0, 0), 1.0),
        "Cylinder: along must have a length",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused(name):
    make, message = REFUSED[name]
    with pytest.raises(ValueError, match=message):
        make()


def test_soft_penalties_are_reported(caplog):
    """With the name of the contact, how deep, and the stiffness; once."""
    one, other = straight((-1, 0, 0.03), (1, 0, 0.03)), straight((0, -1, 0), (0, 1, 0))
    one.add_velocity((0, 0, -1))
    scene = fl.Scene()
    scene.add(one)
    scene.add(other)
    scene.add(
        fl.contact.Contact(
            fl.contact.Line(one, RADIUS),
            fl.contact.Line(other, RADIUS),
            fl.contact.Penalty(1e3),
            name="two",
        )
    )
    with caplog.at_level("WARNING"):
        fl.GeneralisedAlpha(radius=0.8).run(scene, duration=0.02, step=1e-3, progress=False)
    (message,) = [m for m in caplog.messages if "overlap" in m]
    assert message.startswith("two: overlap is")
    assert "of a radius (stiffness 1000). In motion smaller steps show" in message
    assert "raise" not in message
