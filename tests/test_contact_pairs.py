"""Every surface with every other by penalty: laws of the forces, and both families of schemes.

The lower surface is below the plane z = 0, which it touches at the origin, the upper one above it.
Both bodies are free. The upper one is turned about the vertical, so that nothing is symmetric.
"""

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import fem_lie as fl
from fem_lie.extend import GAP_SIGNATURE, GapSurface, callback, compiled, evaluate

SOFT = fl.Material(E=1e6, nu=0.3, density=1000.0)
RUBBER = fl.sections.NeoHooke(1e6, 0.3, 1000.0)
SECTION = fl.Section.circle(0.05, SOFT)
LAYER = fl.ShellSection.layer(0.02, SOFT)
RADIUS, HALF, DEPTH, TURN = 0.05, 0.25, 2e-3, 0.4
ROUND, WIDE = 20.0, 2000.0
AT = np.array([0.003, 0.004, 0.0])
"""Horizontal position of the upper surface."""


@compiled
def outside_ball(X, parameters):
    """Signed distance from a ball."""
    return math.sqrt(X[0] * X[0] + X[1] * X[1] + X[2] * X[2]) - parameters[0]


@callback(GAP_SIGNATURE)
def ball_gap(out, X, parameters):
    """The same with its derivatives."""
    evaluate(outside_ball, (0.0,), out, X, parameters)


class Knob(GapSurface):
    """A ball with a gap function."""

    gap = ball_gap

    def __init__(self, point, radius):
        """About a point."""
        self.point, self.parameters = point, (radius,)


class Part(NamedTuple):
    """A body with a surface, and the stiffness of the contact over the power of lengths."""

    body: fl.extend.Body
    surface: fl.contact.ContactSurface


Place = Callable[[float, float, float], np.ndarray]
"""Position for local coordinates of which the third is the height into the body."""


def rigid(position: Place, height: float) -> fl.RigidBody:
    """A body whose centre is in the surface's body."""
    return fl.RigidBody(0.5, np.diag([2e-3, 3e-3, 4e-3]), position(0, 0, height), _axes(position))


def _axes(position: Place) -> np.ndarray:
    origin = position(0, 0, 0)
    return np.column_stack([position(*row) - origin for row in np.eye(3)])


def ball(position: Place) -> Part:
    body = rigid(position, RADIUS)
    return Part(body, fl.contact.Sphere(body.point("centre"), RADIUS))


def plane(position: Place) -> Part:
    body = rigid(position, 0.1)
    out = position(0, 0, 0) - position(0, 0, 1)
    return Part(body, fl.contact.Plane(body.point("centre"), out, at=position(0, 0, 0)))


def hollow(position: Place) -> Part:
    body = rigid(position, 0.1)
    return Part(body, fl.contact.Sphere(body.point(position(0, 0, -WIDE)), WIDE, hollow=True))


def knob(position: Place) -> Part:
    body = rigid(position, 0.1)
    return Part(body, Knob(body.point(position(0, 0, ROUND)), ROUND))


def box(position: Place) -> Part:
    body = rigid(position, 0.1)
    return Part(body, fl.contact.Box(body.point("centre"), (0.3, 0.36, 0.2)))


def bar(position: Place) -> Part:
    body = rigid(position, RADIUS)
    along = position(0.5, 0, 0) - position(0, 0, 0)
    return Part(body, fl.contact.Cylinder(body.point("centre"), along, RADIUS))


def beam(position: Place, cells: int) -> fl.Beam:
    points = position(-HALF, 0, RADIUS), position(HALF, 0, RADIUS)
    return fl.Beam.straight(*points, fl.Section.circle(RADIUS, SOFT), cells=cells)


def line(position: Place) -> Part:
    body = beam(position, 3)
    return Part(body, fl.contact.Line(body, RADIUS))


def thread(position: Place, of: Callable[[fl.mesh.LineMesh], fl.extend.Body]) -> Part:
    """A line along another body, with a small curvature."""

    def axis(s: float) -> np.ndarray:
        return position(2 * HALF * (s - 0.5), 0.02 * (s - 0.5) ** 2, RADIUS)

    body = of(fl.mesh.curve(axis, 3))
    return Part(body, fl.contact.Line(body, RADIUS))


def spline(mesh: fl.mesh.LineMesh) -> fl.SplineCable:
    return fl.SplineCable.through(mesh.points, SECTION)


def net(mesh: fl.mesh.LineMesh) -> fl.Net:
    """A cable, and one through its first node that does not touch anything."""
    away = (
        mesh.points[0]
        + (mesh.points[0] - mesh.points[1]) @ Rotation.from_rotvec([0, 0, 1.0]).as_matrix()
    )
    return fl.Net(np.vstack([mesh.points, away]), [[0, 1, 2, 3], [0, 4]], SECTION)


def discrete_rod(mesh: fl.mesh.LineMesh) -> fl.Rod:
    return fl.Rod(mesh, SECTION, formulation=fl.elements.DiscreteRod())


def vertices(position: Place) -> Part:
    body = beam(position, 2)
    return Part(body, fl.contact.Vertices([fl.extend.Point(body, k) for k in range(3)], RADIUS))


def sheet(position: Place, smooth: bool, cell: str = "quadrilateral") -> Part:
    mesh = fl.mesh.parametric_surface(
        lambda a, b: position(a - 0.5, b - 0.47, 0.01), (3, 3), cell=cell
    )
    shell = fl.Shell(mesh, LAYER)
    return Part(shell, fl.contact.ShellSurface(shell, smooth=smooth))


def block(position: Place, cell: str, degree: int = 1) -> Part:
    mesh = fl.mesh.parametric_volume(
        lambda a, b, c: position(0.6 * a - 0.3, 0.6 * b - 0.28, 0.005 + 0.2 * c),
        (2, 2, 1),
        cell=cell,
    )
    body = fl.Solid(mesh, RUBBER, degree=degree)
    return Part(body, fl.contact.Facets(body, 0.01))


def smooth_sheet(position: Place, of: type) -> Part:
    patch = fl.mesh.smooth_patch(lambda a, b: position(a - 0.5, b - 0.47, 0.01), (3, 3))
    body = of(patch, LAYER)
    return Part(body, fl.contact.Facets(body))


SURFACES: dict[str, Callable[[Place], Part]] = {
    "ball": ball,
    "nodes of a beam": vertices,
    "plane": plane,
    "hollow": hollow,
    "knob": knob,
    "box": box,
    "bar": bar,
    "line": line,
    "cable": lambda position: thread(position, lambda mesh: fl.Cable(mesh, SECTION)),
    "spline cable": lambda position: thread(position, spline),
    "net": lambda position: thread(position, net),
    "discrete rod": lambda position: thread(position, discrete_rod),
    "shell": lambda position: sheet(position, smooth=True),
    "bilinear shell": lambda position: sheet(position, smooth=False),
    "triangles of a shell": lambda position: sheet(position, smooth=False, cell="triangle"),
    "hexahedra": lambda position: block(position, "hexahedron"),
    "tetrahedra": lambda position: block(position, "tetrahedron", 2),
    "thin shell": lambda position: smooth_sheet(position, fl.ThinShell),
    "ANCF shell": lambda position: smooth_sheet(position, fl.AncfShell),
}
REFUSED = {
    frozenset(names): message
    for message, pairs in {
        "planes touch points, not each other": [("plane",)],
        "two of these have no points": [
            ("plane", "hollow"),
            ("plane", "knob"),
            ("hollow",),
            ("hollow", "knob"),
            ("knob",),
        ],
        "no points to touch a surface with a gap function": [("box", "knob")],
        "force of a Penalty would jump": [("box",)],
    }.items()
    for names in pairs
}
"""Pairs that cannot touch, and why."""


def lower(a: float, b: float, height: float) -> np.ndarray:
    return np.array([a, -b, -height])


def upper(a: float, b: float, height: float) -> np.ndarray:
    c, s = math.cos(TURN), math.sin(TURN)
    return AT + np.array([c * a - s * b, s * a + c * b, height])


def meeting(one: str, two: str, gap: float, **law: float) -> fl.Scene:
    """Both bodies, the second above the first one with a gap."""
    scene = fl.Scene()
    a = SURFACES[one](lower)
    b = SURFACES[two](lambda *x: upper(*x) + np.array([0.0, 0.0, gap]))
    for part in (a, b):
        scene.add(part.body)
    stiffness = 1e3
    contact = fl.contact.Contact(a.surface, b.surface, fl.contact.Penalty(stiffness))
    k = stiffness * 10.0**contact.pair.power
    law_ = fl.contact.Penalty(k, **law)
    scene.add(fl.contact.Contact(a.surface, b.surface, law_))
    return scene


NAMES = list(SURFACES)
PAIRS = [
    (one, two)
    for k, one in enumerate(NAMES)
    for two in NAMES[k:]
    if frozenset((one, two)) not in REFUSED
]
# a body in a hollow is above it
PAIRS = [(two, one) if two == "hollow" else (one, two) for one, two in PAIRS]
every_pair = pytest.mark.parametrize(("one", "two"), PAIRS, ids=map(" on ".join, PAIRS))


class Model:
    """The contact of a pair, with surfaces that overlap, and nodes moved at random."""

    def __init__(self, one: str, two: str) -> None:
        scene = meeting(one, two, 1e-5)
        first, second = scene.bodies
        n, self.count = len(first.frames), len(first.frames) + len(second.frames)
        numbers = {first: np.arange(n), second: np.arange(n, self.count)}
        self.term = scene.contacts[0].term(numbers.__getitem__)
        self.kinds = np.concatenate([body.model.node_types for body in (first, second)]).astype(
            np.int64
        )
        self.rng = np.random.default_rng(5)
        down = np.concatenate([first.frames, second.frames])
        down[n:, 0, 2] -= DEPTH
        self.H = self.moved(down, self.increment(), 1e-5)

    def increment(self) -> np.ndarray:
        found = self.rng.normal(size=(self.count, 6))
        found[self.kinds == fl.extend.NodeType.POSITION, 3:] = 0.0
        return found

    def moved(self, H: np.ndarray, h: np.ndarray, size: float) -> np.ndarray:
        there = H.copy()
        fl.extend.node_types.retract_all(self.kinds, H, size * h, there)
        return there

    def forces(self, H: np.ndarray) -> np.ndarray:
        out = np.zeros((self.count, 6))
        self.term.add_forces(H, out, None)
        return out


@cache
def model(one: str, two: str) -> Model:
    return Model(one, two)


STEP = 1e-6
THREADS = {"cable", "spline cable", "net", "discrete rod"}
LINES, POINTS = {"bar", "line", *THREADS}, {"ball", "nodes of a beam", "hollow", "knob", "plane"}


def parts_move(one: str, two: str) -> bool:
    """Whether the overlapping parts of a line have ends that the quadrature does not follow."""
    return bool({one, two} & LINES) and not {one, two} & POINTS


@every_pair
def test_forces_are_the_gradient_of_the_energy(one, two):
    of = model(one, two)
    forces = of.forces(of.H)
    assert of.term.energy(of.H) > 0.0
    h = of.increment()
    ahead, back = (of.term.energy(of.moved(of.H, h, s * STEP)) for s in (1, -1))
    difference = (ahead - back) / (2 * STEP)
    part = 1e-2 if parts_move(one, two) else 1e-5
    assert abs(difference - np.vdot(forces, h)) <= part * np.abs(forces * h).sum()


@every_pair
def test_tangent_is_the_derivative_of_the_forces(one, two):
    of = model(one, two)
    of.forces(of.H)
    rows, columns = of.term.pairs
    blocks, h = of.term.tangent(of.H, of.term.workspace()), of.increment()
    found = np.zeros((of.count, 6))
    np.add.at(found, rows, np.einsum("pij,pj->pi", blocks, h[columns]))
    ahead, back = (of.forces(of.moved(of.H, h, s * STEP)) for s in (1, -1))
    difference = (ahead - back) / (2 * STEP)
    part = 1e-2 if parts_move(one, two) else 1e-4
    np.testing.assert_allclose(found, difference, rtol=0, atol=part * np.abs(difference).max())


@every_pair
def test_a_rigid_motion_of_both_changes_nothing(one, two):
    """Gaps, and so the energy; forces along the axes of frames stay, too."""
    of = model(one, two)
    R, u = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix(), np.array([0.5, -2.0, 1.0])
    there = of.H @ R.T
    there[:, 0] += u
    assert of.term.energy(there) == pytest.approx(of.term.energy(of.H), rel=1e-9)


OTHERS = {"triangles of a shell", "tetrahedra", "thin shell", "ANCF shell", "shell", *THREADS}
"""Patches and lines whose laws are those of others: they run against few surfaces."""
RUN = [pair for pair in PAIRS if not OTHERS & {*pair} or {"ball", "line", "box"} & {*pair}]


@pytest.mark.parametrize("conserving", [False, True], ids=["generalised-α", "conserving"])
@pytest.mark.parametrize(("one", "two"), RUN, ids=map(" on ".join, RUN))
def test_bodies_push_each_other_and_keep_their_momenta(one, two, conserving):
    scene = meeting(one, two, 1e-5)
    scene.bodies[1].add_velocity((0.05, 0.02, -0.5))
    scheme = fl.EnergyMomentum() if conserving else fl.GeneralisedAlpha(radius=1.0)
    result = scheme.run(scene, duration=2e-3, step=1e-4, progress=False)
    found = fl.post.contact_forces(result, scene.contacts[0])
    assert found.touching[-1] > 0
    # nodes of a smooth surface rotate, too, and have little inertia against that
    assert 1e-5 < found.penetration[-1] < 2e-3
    assert result.momentum_error < (1e-12 if conserving else 1e-8)
    assert result.angular_momentum_error < (1e-11 if conserving else 1e-5)
    assert result.balance_error < (1e-10 if conserving else 1e-2)


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_a_bar_crosses_an_edge_anywhere_on_it_with_the_same_force(turn):
    """Not only at its integration points: it lies on the edge of a box and moves along itself."""
    law, forces = fl.contact.Penalty(1e4), []
    for along in np.linspace(-0.21, 0.21, 9):
        scene = fl.Scene()
        box = scene.add(fl.RigidBody(1.0, np.eye(3), rotation=_about((0, 1, 0), np.pi / 4)))
        direction = np.array([np.cos(turn), np.sin(turn), 0.0])
        top = np.array([0.0, 0.0, 0.1 * np.sqrt(2.0) + RADIUS - 1e-3])
        bar = scene.add(fl.RigidBody(1.0, np.eye(3), top + along * direction))
        scene.add(
            fl.contact.Contact(
                fl.contact.Box(box.point("centre"), (0.2, 0.6, 0.2)),
                fl.contact.Cylinder(bar.point("centre"), 0.5 * direction, RADIUS),
                law,
            )
        )
        result = fl.GeneralisedAlpha().run(scene, duration=1e-6, step=1e-6, progress=False)
        found = fl.post.contact_forces(result, scene.contacts[0])
        forces.append(np.linalg.norm(found.total[0]))
    assert min(forces) > 0.0
    assert np.ptp(forces) < 1e-4 * max(forces)


GROUND = {
    "bar": lambda: fl.contact.Cylinder(fl.ground(), (1, 0, 0), RADIUS),
    "box": lambda: fl.contact.Box(fl.ground(), (1, 1, 2 * RADIUS)),
    "ball": lambda: fl.contact.Sphere(fl.ground(), RADIUS),
    "plane": lambda: fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, RADIUS)),
}


@pytest.mark.parametrize("name", GROUND)
def test_ground_receives_the_force_that_a_ball_gets_from_it(name):
    """The momenta of bodies and ground together stay: with both ends of a bar on ground, too."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, 1e-3 * np.eye(3), (0.02, 0, 2 * RADIUS + 1e-3)))
    body.add_velocity((0.3, 0, -0.5))
    ball = fl.contact.Sphere(body.point("centre"), RADIUS)
    scene.add(fl.contact.Contact(ball, GROUND[name](), fl.contact.Penalty(1e4)))
    result = fl.EnergyMomentum().run(scene, duration=0.05, step=1e-3, progress=False)
    assert result.velocity(body.point("centre"))[-1, 2] > 0.2
    assert result.momentum_error < 1e-13
    assert result.angular_momentum_error < 1e-13


def _about(axis: tuple[float, ...], angle: float) -> np.ndarray:
    return Rotation.from_rotvec(angle * np.array(axis)).as_matrix()


@pytest.mark.parametrize("names", REFUSED, ids=lambda names: " on ".join(sorted(names)))
def test_surfaces_that_cannot_touch_say_why(names):
    one, two = (sorted(names) * 2)[:2]
    with pytest.raises(ValueError, match=REFUSED[names]):
        meeting(one, two, 1e-5)


def test_a_cantilever_on_the_edge_of_a_prism_has_the_reaction_of_beam_theory():
    """``R = P (3 L − a)/(2 a) − 3 EI δ/a³``: a load at the end, an edge at ``a``, an overlap δ."""
    L, a, r, load = 1.0, 0.45, 0.005, 0.05
    section = fl.Section.circle(r, fl.Material(2e9, 0.3, 1e3))
    beam = fl.Beam.straight((0, 0, 0), (L, 0, 0), section, cells=7)
    ridge = [(a, y, -r) for y in (-0.1, 0.15)]
    foot = [(a + x, y, -r - 0.1) for x in (-0.1, 0.1) for y in (-0.1, 0.15)]
    prism = fl.contact.ConvexPolyhedron(fl.ground(), [*ridge, *foot])
    touch = fl.contact.Contact(fl.contact.Line(beam, r), prism, fl.contact.Penalty(1e7))
    scene = fl.Scene()
    for item in (
        beam,
        fl.Clamp(beam.point("start")),
        fl.PointLoad(beam.point("end"), (0, 0, -load)),
        touch,
    ):
        scene.add(item)
    found = fl.post.contact_forces(fl.statics(scene), touch)
    sinks = 3.0 * section.stiffness[4, 4] * found.penetration[-1] / a**3
    assert found.total[-1, 2] == pytest.approx(load * (3 * L - a) / (2 * a) - sinks, rel=2e-3)
