"""Cables of positions and slopes: closed forms, published values, and laws of mechanics."""

import warnings
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve
from scipy.special import jn_zeros

import fem_lie as fl
from benchmarks import swinging_cable
from fem_lie import lie
from fem_lie.extend import node_types
from tests.unit_systems import METRES, OTHER_SYSTEMS, UnitSystem

GRAVITY = 9.81


def section(EA: float, EI: float, mass: float = 1.0) -> fl.Section:
    return fl.Section.from_stiffness(np.array([EA, EA, EA, EI, EI, EI]), mass=mass)


# --- statics --------------------------------------------------------------------------------------


def heavy_cantilever(cells: int) -> np.ndarray:
    """Displacement of the tip."""
    cable = fl.Cable.straight((0, 0, 0), (2, 0, 0), section(1e6, 2500 / 3, 78.0), cells=cells)
    scene = fl.Scene(gravity=(0, -GRAVITY, 0))
    scene.add(cable)
    scene.add(fl.Clamp(cable.point("start")))
    return (fl.statics(scene).position(cable.point("end"))[-1] - (2, 0, 0))[:2]


SLACK = fl.elements.HermiteCable(slack=1e-4)

PUBLISHED = np.array([-0.501305855, -1.232510073])
"""Of Exudyn's ANCF cable, converged (L = 2, EA = 1e6, EI = 833.33, w = 78 · 9.81)."""


def test_heavy_cantilever_is_of_fourth_order():
    errors = [np.abs(heavy_cantilever(cells) - PUBLISHED).max() for cells in (4, 8, 16, 32)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 3.6).all() and errors[-1] < 2e-7


def sagging_and_swinging(u: UnitSystem) -> tuple[np.ndarray, int]:
    """The tip of a clamped cable at rest and after a while of swinging, in metres; matrices."""
    stretch, bending = u.force(1e4), u.bending(1.0)
    own = fl.Section.from_stiffness(
        np.array([stretch] * 3 + [bending] * 3), mass=float(u.line_density(0.5))
    )
    cable = fl.Cable.straight(u.length([0, 0, 0]), u.length([2, 0, 0]), own, cells=6)
    scene = fl.Scene(gravity=u.acceleration([0, -GRAVITY, 0]))
    scene.add(cable)
    scene.add(fl.Clamp(cable.point("start")))
    rest = fl.statics(scene).position(cable.point("end"))[-1:]
    scheme = fl.GeneralisedAlpha(radius=0.8)
    result = scheme.run(scene, duration=u.time(0.1), step=u.time(1e-3))
    moved = np.concatenate([rest, result.position(cable.point("end"))])
    return u.inverse.length(moved), result.k_updates


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_units_do_not_matter(u):
    (found, matrices), (expected, wanted) = sagging_and_swinging(u), sagging_and_swinging(METRES)
    np.testing.assert_allclose(found, expected, atol=1e-8)
    assert matrices == wanted


LENGTH, END, WEIGHT = 10.0, np.array([8.0, 1.0]), 10.0


def elastic_catenary(EA: float):
    """Positions (k, 2) at arc lengths of a hanging cable without bending stiffness, and end forces.

    H. M. Irvine, Cable Structures (1981), §1.3: tension over EA is the strain.
    """

    def positions(s, H, V):
        x = H / WEIGHT * (np.arcsinh(V / H) - np.arcsinh((V - WEIGHT * s) / H)) + H * s / EA
        tension = np.hypot(H, V - WEIGHT * s)
        z = (tension - np.hypot(H, V)) / WEIGHT - (V * s - 0.5 * WEIGHT * s**2) / EA
        return np.stack([x, z], axis=-1)

    H, V = fsolve(lambda f: positions(LENGTH, *f) - END, (34.0, 44.0), xtol=1e-13)
    return (lambda s: positions(s, H, V)), (H, V)


def hung(cells: int, EA: float, EI: float) -> tuple[fl.Scene, fl.Cable]:
    """A cable laid along a parabola of its length between its ends, which are pinned."""

    def parabola(depth, t):
        return np.stack([8 * t, t - 4 * depth * t * (1 - t), 0 * t], axis=-1)

    t = np.linspace(0, 1, 4001)

    def length(depth):
        return np.linalg.norm(np.diff(parabola(depth, t), axis=0), axis=1).sum()

    depth = brentq(lambda depth: length(depth) - LENGTH, 0.1, 10.0)
    arc = np.cumsum(np.linalg.norm(np.diff(parabola(depth, t), axis=0), axis=1))
    arc = np.concatenate([[0.0], arc]) / arc[-1]
    curve = lambda s: parabola(depth, np.interp(s, arc, t))  # noqa: E731
    points = np.array([curve(s) for s in np.linspace(0, 1, cells + 1)])
    mesh = fl.mesh.LineMesh.from_cells(
        points,
        np.column_stack([np.arange(cells), np.arange(1, cells + 1)]),
        named_points={"start": [0], "end": [cells]},
        kink_angle=1.5,
    )
    cable = fl.Cable(mesh, section(EA, EI), length=LENGTH)
    scene = fl.Scene(gravity=(0, -WEIGHT, 0))
    scene.add(cable)
    cable.pin(cable.point("start"), cable.point("end"))
    return scene, cable


def error_of_catenary(cells: int, EA: float = 1e6) -> float:
    scene, cable = hung(cells, EA, 1e-6)
    H = fl.statics(scene).frames[-1]
    shape, _ = elastic_catenary(EA)
    s = np.concatenate([[0.0], np.cumsum(cable.model.lengths)])
    return float(np.abs(H[:, 0, :2] - shape(s)).max())


def test_hung_cable_is_the_catenary():
    errors = np.array([error_of_catenary(cells) for cells in (4, 8, 16)])
    assert (np.log2(errors[:-1] / errors[1:]) > 3.0).all() and errors[-1] < 1e-5


def test_published_forces_of_an_elastic_catenary():
    """H = 33.73586, V = 43.99520 for EA = 1e4, from the reactions of the pins."""
    _, forces = elastic_catenary(1e4)
    np.testing.assert_allclose(forces, (33.73586, 43.99520), atol=1e-5)
    scene, cable = hung(8, 1e4, 1e-4)
    found = fl.statics(scene).reactions[-1]
    np.testing.assert_allclose(found[0, :2], (-forces[0], forces[1]), rtol=1e-4)
    np.testing.assert_allclose(found[:, :3].sum(axis=0), (0, WEIGHT * LENGTH, 0), atol=1e-7)
    assert cable.model.size == pytest.approx(LENGTH)


@pytest.mark.parametrize(("formulation", "left"), [(None, 1e-3), ("edges", 2e-3)])
def test_tension_of_a_catenary(formulation, left, tmp_path):
    """That of Irvine, √(H² + (V − w s)²); without the damping and the bending of the cable."""
    _, (H, V) = elastic_catenary(1e4)
    scene, cable = hung(32, 1e4, 1e-4)
    if formulation:
        nodes = cable.frames[:, 0]
        edges = np.column_stack([np.arange(32), np.arange(1, 33)])
        mesh = fl.mesh.LineMesh.from_cells(nodes, edges, kink_angle=1.5)
        element = fl.elements.DiscreteCable()
        cable = fl.Cable(mesh, section(1e4, 1e-4), length=LENGTH, formulation=element, name="rope")
        cable.pin(cable.point(0), cable.point(-1))
        scene = fl.Scene(gravity=(0, -WEIGHT, 0))
        scene.add(cable)
    result = fl.statics(scene)
    forces = fl.post.cable_forces(result, cable)
    s = (np.arange(32) + 0.5) * LENGTH / 32
    wanted = np.hypot(H, V - WEIGHT * s)
    np.testing.assert_allclose(forces.mean("N")[-1], wanted, rtol=left)
    assert forces.names == (("N",) if formulation else ("N", "M"))
    assert forces.raw("N").shape == (len(result.frames), 32, 2)
    middle = forces.at(cable.point(16), "N")[-1]
    assert middle == pytest.approx(np.hypot(H, V - WEIGHT * 0.5 * LENGTH), rel=2 * left)
    assert forces.colours("N").values.shape == (len(result.frames), 33)
    forces.write_vtk(tmp_path / "forces.pvd")
    with pytest.raises(ValueError, match="no quantity 'Q'"):
        forces.raw("Q")


def test_bending_moment_of_a_cable():
    """A cantilever under a small force at its tip, and a slack rope, which has no tension."""
    stiff = section(1e6, 100.0)
    cable = fl.Cable.straight((0, 0, 0), (2, 0, 0), stiff, cells=8)
    cable.clamp(cable.point("start"))
    scene = fl.Scene()
    scene.add(cable)
    scene.add(fl.PointLoad(cable.point("end"), force=(0, 0, 0.1)))
    forces = fl.post.cable_forces(fl.statics(scene), cable, states=[-1])
    x = (np.arange(8) + 0.5) / 4
    np.testing.assert_allclose(forces.mean("M")[0], 0.1 * (2 - x), rtol=1e-3)
    slack = fl.elements.HermiteCable(slack=1e-3)
    rope = fl.Cable.straight((0, 0, 0), (2, 0, 0), stiff, cells=4, length=2.1, formulation=slack)
    rope.pin(rope.point("start"), rope.point("end"))
    still = fl.Scene()
    still.add(rope)
    loose = fl.GeneralisedAlpha().run(still, duration=1e-6, step=1e-6, progress=False)
    assert np.abs(fl.post.cable_forces(loose, rope).raw("N")[0]).max() < 2e-3 * 1e6


def test_line_load_is_that_of_gravity():
    cable = fl.Cable.straight((0, 0, 0), (2, 0, 0), section(1e6, 833.0, 78.0), cells=4)
    weight = (0, -78 * GRAVITY, 0)
    scene = fl.Scene()
    scene.add(cable)
    scene.add(fl.Clamp(cable.point("start")))
    scene.add(fl.LineLoad(cable, weight))
    loaded = fl.statics(scene).position(cable.point("end"))
    heavy = fl.statics(scene.with_loads(gravity=(0, -GRAVITY, 0))).position(cable.point("end"))
    np.testing.assert_allclose(loaded[-1], heavy[-1], rtol=1e-9)


def test_column_buckles_as_eulers_does():
    """π² EI/4L², alike in both planes, and the mode is a quarter of a cosine."""
    cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), section(1e5, 1.0), cells=8)
    scene = fl.Scene()
    scene.add(cable)
    scene.add(fl.Clamp(cable.point("start")))
    scene.add(fl.PointLoad(cable.point("end"), (-1.0, 0, 0)))
    modes = fl.buckling(scene, 2)
    np.testing.assert_allclose(modes.factors, np.pi**2 / 4, rtol=2e-5)
    moved = np.linalg.norm(modes.shapes[0][:, :3], axis=1)
    wave = 1.0 - np.cos(np.pi / 2 * cable.frames[:, 0, 0])
    np.testing.assert_allclose(moved, wave, atol=1e-4)


def test_load_steps_converge_at_once_with_linearised_stress():
    """A cantilever that bends by more than a right angle in one step, on any mesh."""
    for cells in (4, 32):
        cable = fl.Cable.straight((0, 0, 0), (2, 0, 0), section(1e6, 833.0, 78.0), cells=cells)
        scene = fl.Scene(gravity=(0, -GRAVITY, 0))
        scene.add(cable)
        scene.add(fl.Clamp(cable.point("start")))
        assert fl.statics(scene).iterations[-1] <= 6


def weight_on_a_cable(cells: int) -> float:
    """Distance of the joint from where it hangs in the closed form, of two equal pieces.

    Each piece is an elastic catenary; the vertical force jumps by a weight.
    """
    EA, weights, ends = 1e4, (20.0, 0.0), (LENGTH / 2, LENGTH)

    def joints(H, V):
        s, x, at = 0.0, np.zeros(2), []
        for end, load in zip(ends, weights, strict=True):
            T, D = V - WEIGHT * (end - s), V
            along = H / WEIGHT * (np.arcsinh(D / H) - np.arcsinh(T / H)) + H * (end - s) / EA
            down = (np.hypot(H, T) - np.hypot(H, D)) / WEIGHT - 0.5 * (D + T) * (end - s) / EA
            x = x + np.array([along, down])
            at.append(x)
            s, V = end, T - load
        return np.array(at)

    expected = joints(*fsolve(lambda f: joints(*f)[-1] - END, (50.0, 50.0), xtol=1e-13))
    scene = fl.Scene(gravity=(0, -WEIGHT, 0))
    corners = np.array([[0.0, 0, 0], [4, -2.9, 0], [8, 1, 0]])
    pieces = [
        fl.Cable(fl.mesh.straight_line(a, b, cells), section(EA, 1e-6), length=LENGTH / 2)
        for a, b in pairwise(corners)
    ]
    for piece in pieces:
        scene.add(piece)
    for (a, b), load in zip(pairwise(pieces), weights, strict=False):
        scene.add(fl.joints.Spherical(a.point("end"), b.point("start")))
        scene.add(fl.PointLoad(a.point("end"), (0, -load, 0)))
    pieces[0].pin(pieces[0].point("start"))
    pieces[-1].pin(pieces[-1].point("end"))
    result = fl.statics(scene)
    found = np.array([result.position(piece.point("end"))[-1, :2] for piece in pieces])
    return float(np.abs(found - expected).max())


def test_weight_on_a_cable():
    errors = np.array([weight_on_a_cable(cells) for cells in (2, 4, 8)])
    assert (np.log2(errors[:-1] / errors[1:]) > 3.0).all() and errors[-1] < 1e-5


# --- slack ----------------------------------------------------------------------------------------


def tension(strain: float, EA: float, slack: float) -> float:
    """Of a cable that goes slack."""
    weak, beyond = slack / (1 + slack), np.clip(strain / slack - 1, -0.5, 0.5) + 0.5
    more = max(0.5 * slack * beyond**2, strain - slack)
    return float(EA * (weak * (1 + strain) + (1 - weak) * more))


@pytest.mark.parametrize("strain", [-0.3, 0.0, 0.45e-4, 0.9e-4, 1.45e-4, 1.55e-4, 0.1])
def test_tension_of_a_slack_cable(strain):
    """Of a straight one, from its nodes' forces."""
    cable = fl.Cable(
        fl.mesh.straight_line((0, 0, 0), (1 + strain, 0, 0), 2),
        section(1e4, 1e-3),
        length=1.0,
        formulation=SLACK,
    )
    assembly = cable.model.assemble([cable.model])
    forces, H = np.zeros((3, 6)), np.empty((3, 4, 3))
    H[assembly.order] = cable.frames
    assembly.add_forces(H, forces.reshape(-1))
    expected = tension(strain, 1e4, 1e-4)
    np.testing.assert_allclose(forces[assembly.order][2, 0], expected, rtol=1e-11)


def test_a_cable_shorter_laid_than_long_is_named(caplog):
    """Laid straight it is compressed, and does not hang in statics; a tension-only one hangs."""
    sags = []
    for formulation in (None, SLACK):
        cable = fl.Cable.straight(
            (0, 0, 0),
            (8, 0, 0),
            section(1e5, 1e-6),
            cells=16,
            length=LENGTH,
            formulation=formulation,
            name="rope",
        )
        scene = fl.Scene(gravity=(0, -WEIGHT, 0))
        scene.add(cable)
        cable.pin(cable.point("start"), cable.point("end"))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", fl.stability.UnstableEquilibriumWarning)
            sags.append(-fl.statics(scene).displacement(cable.point(8))[-1, 1])
        assert ("compressed at the start: rope" in caplog.text) == (formulation is None)
        caplog.clear()
    a = brentq(lambda a: 2 * a * np.sinh(4 / a) - LENGTH, 1.0, 100.0)
    sag = a * (np.cosh(4 / a) - 1)
    assert sags[0] < 0.1 and abs(sags[1] / sag - 1) < 2e-3


def test_slack_cables_find_the_only_equilibrium_from_anywhere():
    """Laid straight and a quarter too short, or along arches: the catenary below."""
    EA = 1e4
    for height in (0.0, 1.0, 8.0):
        mesh = fl.mesh.curve(lambda s, h=height: (8 * s, s + h * s * (1 - s), 0.0), 16)
        cable = fl.Cable(mesh, section(EA, 1e-6), length=LENGTH, formulation=SLACK)
        scene = fl.Scene(gravity=(0, -WEIGHT, 0))
        scene.add(cable)
        cable.pin(cable.point("start"), cable.point("end"))
        result = fl.statics(scene)
        s = np.concatenate([[0.0], np.cumsum(cable.model.lengths)])
        error = np.abs(result.frames[-1][:, 0, :2] - elastic_catenary(EA)[0](s)).max()
        assert error < 1e-5 and (result.negative_pivots == 0).all()


def test_one_of_two_guys_goes_slack():
    """A mast pushed along x: the other guy holds it, and this one is a weak spring."""
    EA, slack, push = 1e3, 1e-3, 3.0
    scene = fl.Scene()
    mast = scene.add(fl.RigidBody(1.0, (1, 1, 1), position=(0, 0, 1)))
    foot = fl.joints.Spherical(fl.ground(), mast.point((0, 0, 0)))
    scene.add(foot)
    mast.model.held[0, [3, 5]] = True
    for side in (-1.0, 1.0):
        guy = fl.Cable(
            fl.mesh.straight_line((side, 0, 0), (0, 0, 1), 4),
            section(EA, 1e-4),
            formulation=fl.elements.HermiteCable(slack=slack),
        )
        scene.add(guy)
        guy.pin(guy.point("start"))
        scene.add(fl.joints.Spherical(guy.point("end"), mast.point("centre")))
    scene.add(fl.PointLoad(mast.point("centre"), (push, 0, 0)))
    angle = fl.statics(scene).position(mast.point("centre"))[-1]

    def moment(turn):
        top, total = np.array([np.sin(turn), np.cos(turn)]), push * np.cos(turn)
        for side in (-1.0, 1.0):
            guy = np.array([side, 0.0]) - top
            length = np.linalg.norm(guy)
            pull = tension(length / np.sqrt(2) - 1, EA, slack) * guy / length
            total += pull @ (np.cos(turn), -np.sin(turn))
        return total

    turn = brentq(moment, 0.0, 0.5)
    np.testing.assert_allclose(angle, (np.sin(turn), 0, np.cos(turn)), atol=1e-9)
    assert turn > 5e-3


@pytest.mark.parametrize("element", [fl.elements.HermiteCable(), SLACK], ids=["pushed", "slack"])
def test_loose_cable_falls_and_is_caught(element):
    """It lies along an arch without tension; the energy stays in the books."""
    arch = fl.mesh.curve(lambda s: (s, 0, 0.6 * s * (1 - s)), 8)
    cable = fl.Cable(arch, section(1e3, 1e-2, 0.5), formulation=element)
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(cable)
    cable.pin(cable.point("start"), cable.point("end"))
    scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-8)
    result = scheme.run(scene, duration=0.5, step=1e-3)
    assert result.frames[:, 4, 0, 2].min() < -0.14
    assert result.balance_error < 0.05


# --- laws of the element --------------------------------------------------------------------------


class Bent:
    """A cable in any state, and its assembly."""

    def __init__(self) -> None:
        rng = np.random.default_rng(2)
        self.cable = fl.Cable.straight((0, 0, 0), (3, 1, 2), section(1e3, 10.0), cells=3)
        self.assembly = self.cable.model.assemble([self.cable.model])
        self.kinds = np.full(4, fl.extend.node_types.POSITION_GRADIENT)
        start = np.empty((4, 4, 3))
        start[self.assembly.order] = self.cable.frames
        self.H = self.moved(start, 0.2 * rng.normal(size=(4, 6)))
        self.h = rng.normal(size=(4, 6))

    def moved(self, H, h):
        out = np.empty_like(H)
        node_types.retract_all(self.kinds, H, h, out)
        return out

    def forces(self, H):
        out = np.zeros(24)
        self.assembly.add_forces(np.ascontiguousarray(H), out)
        return out


def test_forces_and_tangent_are_derivatives_of_the_energy():
    bent, step = Bent(), 1e-6
    ahead, behind = (bent.moved(bent.H, s * step * bent.h) for s in (1, -1))
    slope = (bent.assembly.energy(ahead) - bent.assembly.energy(behind)) / (2 * step)
    forces = bent.forces(bent.H)
    assert forces @ bent.h.ravel() == pytest.approx(slope, rel=1e-7)
    change = (bent.forces(ahead) - bent.forces(behind)) / (2 * step)
    bent.assembly.reset_stress(bent.H)
    blocks, product = bent.assembly.tangent(bent.H, forces.reshape(-1, 6)), np.zeros((4, 6))
    rows = np.repeat(np.arange(4), np.diff(bent.assembly.indptr))
    for row, column, block in zip(rows, bent.assembly.indices, blocks, strict=True):
        product[row] += block @ bent.h[column]
    np.testing.assert_allclose(product.ravel(), change, atol=1e-6 * np.abs(change).max())


def every_kind() -> dict[str, fl.Cable]:
    """Bent ones whose closed forces differ: law, parameter, the way that cells run."""
    own, bow = section(1e3, 10.0), fl.mesh.curve(lambda s: (3 * s, 0.3 * s * s, 0.2 * s**3), 3)
    points = bow.points[[0, 2]]
    back = fl.mesh.LineMesh.from_cells(points, [(1, 0)], named_points={"a": [0], "b": [1]})
    slopes = [(2.0, 1.0, 0.0), (1.5, 0.1, 0.0), (1.0, 0.3, 0.4)]
    spline = fl.SplineCable([0.0, 0.5, 2.0], [(0, 0, 0), (1, 0.3, 0), (3, 0.1, 0.2)], slopes, own)
    return {
        "pushed": fl.Cable(bow, own),
        "slack": fl.Cable(bow, own, formulation=fl.elements.HermiteCable(slack=0.1)),
        "backwards": fl.Cable(back, own),
        "spline": spline,
    }


@pytest.mark.parametrize("name", every_kind())
def test_closed_forces_are_those_of_the_energy(name):
    cable, rng = every_kind()[name], np.random.default_rng(3)
    assembly, n = cable.model.assemble([cable.model]), len(cable.frames)
    start, H = np.empty((2, n, 4, 3))
    start[assembly.order] = cable.frames
    slopes = np.full(n, fl.extend.node_types.POSITION_GRADIENT)
    node_types.retract_all(slopes, start, 0.2 * rng.normal(size=(n, 6)), H)
    forces, numeric, step, moved = np.zeros((n, 6)), np.zeros((n, 6)), 1e-5, np.empty_like(H)
    assembly.add_forces(H, forces)
    for i, j in np.ndindex(n, 6):
        for sign in (1, -1):
            h = sign * step * np.eye(1, 6 * n, 6 * i + j).reshape(n, 6)
            node_types.retract_all(slopes, H, h, moved)
            numeric[i, j] += sign * assembly.energy(moved) / (2 * step)
    np.testing.assert_allclose(forces, numeric, rtol=0, atol=1e-8 * np.abs(forces).max())


def test_energy_is_objective_and_forces_turn_along():
    bent = Bent()
    turn = lie.se3_exp(np.array([1.0, -2, 3, 0.8, -2.0, 1.1]))
    H = bent.H @ lie.rotation(turn).T
    H[:, 0] += turn[0]
    assert bent.assembly.energy(H) == pytest.approx(bent.assembly.energy(bent.H), rel=1e-12)
    np.testing.assert_allclose(bent.forces(H), bent.forces(bent.H), rtol=1e-9, atol=1e-9)


def test_direction_of_the_cells_does_not_matter():
    """A line whose mesh runs the other way hangs alike."""
    ends = []
    for turned in (False, True):
        points = [(0, 0, 0), (1, 0, 0), (2, 0, 0)]
        cells = [(1, 0), (2, 1)] if turned else [(0, 1), (1, 2)]
        mesh = fl.mesh.LineMesh.from_cells(points, cells, named_points={"a": [0], "b": [2]})
        cable = fl.Cable(mesh, section(1e6, 833.0, 78.0))
        scene = fl.Scene(gravity=(0, -GRAVITY, 0))
        scene.add(cable)
        scene.add(fl.Clamp(cable.point("a")))
        ends.append(fl.statics(scene).position(cable.point("b"))[-1])
    np.testing.assert_allclose(*ends, rtol=1e-9)


# --- dynamics -------------------------------------------------------------------------------------


def test_swinging_of_a_hanging_chain():
    """ω = ½ j₀ₖ √(g/L), zeros of Bessel's function; twice each, in both planes."""
    length = 2.0
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    cable = scene.add(
        fl.Cable.straight((0, 0, 0), (0, 0, -length), section(1e7, 1e-4, 0.3), cells=12)
    )
    cable.pin(cable.point("start"))
    found = fl.vibrations(scene, 4, at=fl.statics(scene)).frequencies
    expected = np.repeat(0.5 * jn_zeros(0, 2) * np.sqrt(GRAVITY / length), 2)
    np.testing.assert_allclose(found, expected, rtol=1e-3)


MOVED = {
    "swinging": (8, (1.3367817479, 0, -1.3972654484), 5e-5),
    "whirling": (8, (-1.8793747059, -0.0117409869, -0.7142141856), 2e-4),
    "taut": (3, (0.7469297667, 0, 0.1436628601), 3e-4),
    "slack": (3, (0.7764066740, 0, -0.1610843585), 2e-3),
}
"""Positions of an independent program after half a second (``benchmarks/swinging_cable.py``)."""


@pytest.mark.parametrize("name", MOVED)
def test_moves_as_an_independent_program_has_it(name):
    (make, _), (part, expected, bound) = swinging_cable.SCENES[name], MOVED[name]
    found = swinging_cable.positions(make(16, "cable"), np.array([0.5]), 1e-3)[0, part]
    assert np.linalg.norm(found - expected) < bound * swinging_cable.LENGTH


def free_flight(step: float, save_every: int = 1, **options) -> fl.Result:
    """A bent cable that tumbles without anything that acts."""
    cable = fl.Cable.curve(lambda s: (2 * s, 0.3 * s * s, 0.1 * s), section(1e3, 1.0, 0.5), cells=4)
    cable.add_velocity((1, 2, 3))
    cable.add_velocity(omega=(1.0, 2.0, 0.5), about=cable.point(0))
    scene = fl.Scene()
    scene.add(cable)
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10, **options)
    return scheme.run(scene, duration=0.4, step=step, save_every=save_every)


def test_free_flight():
    """Momentum to the tolerance, angular momentum and energy to second order."""
    results = [free_flight(step) for step in (4e-3, 2e-3)]
    errors = []
    for result in results:
        momentum = result.momentum
        np.testing.assert_allclose(momentum, momentum[:1] + 0 * momentum, rtol=1e-6)
        spin, energy = result.angular_momentum, result.total_energy
        errors.append([np.abs(x - x[0]).max() / np.abs(x[0]).max() for x in (spin, energy)])
    assert (np.array(errors[0]) / errors[1] > 3.0).all() and max(errors[1]) < 1e-2


def test_damping_with_strain():
    """A bending mode decays at ½ τ ω², and the books have what is lost."""
    factor, EI = 2e-2, 1.0
    cable = fl.Cable.straight(
        (0, 0, 0),
        (1, 0, 0),
        section(1e5, EI),
        cells=4,
        damping=fl.sections.Damping(stiffness=factor),
    )
    scene = fl.Scene()
    scene.add(cable)
    scene.add(fl.Clamp(cable.point("start")))
    modes, step = fl.vibrations(scene, 1), 4e-3
    omega = np.abs(modes.eigenvalues[0])
    np.testing.assert_allclose(modes.damping_ratios, 0.5 * factor * omega, rtol=1e-3)
    scene.add(fl.PointLoad(cable.point("end"), (0, 0, 1e-3), history=lambda t: float(t < 0.2)))
    scheme = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12)
    result = scheme.run(scene, duration=4.0, step=step)
    free, period = result.times > 1.5, 2 * np.pi / omega
    energy = result.total_energy[free]
    later = round(period / step)
    decay = np.log(energy[0] / energy[later]) / (2 * later * step)
    assert decay == pytest.approx(0.5 * factor * omega**2, rel=2e-2)
    assert result.balance_error < 1e-3


def test_between_the_times_that_were_kept():
    """Positions, slopes with lengths and velocities of every second state, from the others."""
    result = free_flight(1e-3)
    found = free_flight(1e-3, save_every=2).resampled(result.times[1:-1:2])
    wanted = result.frames[1:-1:2]
    np.testing.assert_allclose(found.frames[:, :, 0], wanted[:, :, 0], atol=1e-4)
    lengths = [np.linalg.norm(frames[:, :, 1], axis=-1) for frames in (found.frames, wanted)]
    amplitude = np.abs(lengths[1] - 1.0).max()
    assert amplitude > 1e-3
    np.testing.assert_allclose(*lengths, atol=0.1 * amplitude)
    linear = [
        np.einsum("tni,tnij->tnj", velocities[:, :, :3], frames[:, :, 1:])
        for velocities, frames in (
            (found.velocities, found.frames),
            (result.velocities[1:-1:2], wanted),
        )
    ]
    np.testing.assert_allclose(*linear, atol=0.02 * np.abs(linear[1]).max())


def test_velocities_of_results_are_those_of_positions():
    result = free_flight(2e-3)
    node, k, h = 2, 100, 2e-3
    moved = (result.frames[k + 1, node, 0] - result.frames[k - 1, node, 0]) / (2 * h)
    reported = result.velocities[k, node, :3] @ result.frames[k, node, 1:]
    np.testing.assert_allclose(reported, moved, rtol=1e-3)


def test_steps_that_change_follow_the_same_motion():
    cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), section(1e3, 1e-2, 0.5), cells=4)
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(cable)
    cable.pin(cable.point("start"))
    scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-8)
    fixed = scheme.run(scene, duration=0.2, step=5e-4)
    adaptive = scheme.run(scene, duration=0.2, step=fl.schemes.AdaptiveStep(tolerance=1e-4))
    ends = [result.position(cable.point("end"))[-1] for result in (fixed, adaptive)]
    np.testing.assert_allclose(*ends, atol=1e-3)


OPTIONS = {
    "fixed axes": {"matrix_frame": fl.schemes.MatrixFrame.INERTIAL},
    "stabilised": {"index": fl.schemes.ConstraintIndex.STABILISED_TWO},
    "Cayley": {"parametrisation": fl.lie.Parametrisation.CAYLEY},
    "every iteration": {"policy": fl.schemes.EveryIteration()},
}


def swinging_on_a_joint(**options) -> fl.Result:
    """With damping, too."""
    cable = fl.Cable.straight(
        (0, 0, 0), (1, 0, 0), section(1e3, 0.1, 0.5), cells=3, damping=fl.sections.Damping(mass=1.0)
    )
    scene = fl.Scene(gravity=(0, 1, -GRAVITY))
    scene.add(cable)
    scene.add(fl.joints.Spherical(fl.ground(), cable.point("start")))
    scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-10, **options)
    return scheme.run(scene, duration=0.1, step=1e-3)


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS.keys())
def test_options_of_the_scheme_do_not_matter(options):
    plain, other = swinging_on_a_joint(), swinging_on_a_joint(**options)
    np.testing.assert_allclose(other.frames[:, :, 0], plain.frames[:, :, 0], atol=1e-8)
    assert plain.balance_error < 1e-4


def test_file_and_resume(tmp_path):
    """To the last bit, and read back."""
    cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), section(1e3, 1e-2, 0.5), cells=3)
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    scene.add(cable)
    scene.add(fl.Clamp(cable.point("start")))
    scheme, path = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-8), tmp_path / "cable.h5"
    plain = scheme.run(scene, duration=0.05, step=1e-3)
    scheme.run(scene, duration=0.05, step=1e-3, file=path, checkpoint_every=20)
    resumed = scheme.resume(scene, path)
    np.testing.assert_array_equal(resumed.frames, plain.frames)
    plain.picture(tmp_path / "cable.png")
    assert (tmp_path / "cable.png").stat().st_size > 1000


# --- with other bodies ----------------------------------------------------------------------------


def test_joints_hold_a_cable_as_pins_do():
    """Spherical joints to the ground at both ends, against positions that are held."""
    scene, cable = hung(8, 1e6, 1e-3)
    pinned = fl.statics(scene)
    cable.model.held[:] = False
    jointed = fl.Scene(gravity=(0, -WEIGHT, 0))
    jointed.add(cable)
    joints = [
        jointed.add(fl.joints.Spherical(fl.ground(), point))
        for point in (cable.point("start"), cable.point("end"))
    ]
    found = fl.statics(jointed)
    np.testing.assert_allclose(found.frames[-1][:, 0], pinned.frames[-1][:, 0], atol=1e-8)
    forces = [found.joint_force(joint)[-1][:3] for joint in joints]
    assert np.linalg.norm(np.sum(forces, axis=0)) == pytest.approx(WEIGHT * LENGTH, rel=1e-8)


def test_revolute_joint_about_the_tangent_is_a_clamp():
    """A joint that holds position and tangent to ground, against a clamp."""
    tips = []
    for clamped in (True, False):
        cable = fl.Cable.straight((0, 0, 0), (2, 0, 0), section(1e6, 833.0, 78.0), cells=4)
        scene = fl.Scene(gravity=(0, -GRAVITY, 0))
        scene.add(cable)
        held = fl.joints.Revolute(fl.ground(), cable.point("start"), axis=(1, 0, 0))
        scene.add(fl.Clamp(cable.point("start")) if clamped else held)
        tips.append(fl.statics(scene).position(cable.point("end"))[-1])
    np.testing.assert_allclose(*tips, rtol=1e-8)


def bent_by(load, cells: int = 16):
    """Displacement and direction of the tip of a clamped cable under a load at its end."""
    cable = fl.Cable.straight((0, 0, 0), (2, 0, 0), section(1e6, 833.0, 78.0), cells=cells)
    scene = fl.Scene()
    scene.add(cable)
    scene.add(fl.Clamp(cable.point("start")))
    scene.add(fl.PointLoad(cable.point("end"), **load))
    tip = fl.statics(scene).frames[-1][-1]
    return tip[0], tip[1] / np.linalg.norm(tip[1])


def test_a_moment_bends_a_cable_to_a_circle():
    """The component about the tangent does no work."""
    angle, tangential = 1.0, 50.0
    axes = fl.Cable.straight((0, 0, 0), (2, 0, 0), section(1, 1), cells=1).point("end").frame[1:]
    moment = axes @ (tangential, 0.0, 833.0 * angle / 2)
    tip, tangent = bent_by({"moment": moment, "following": True})
    np.testing.assert_allclose(tangent, [np.cos(angle), np.sin(angle), 0], atol=1e-5)
    closed = np.array([np.sin(angle), 1 - np.cos(angle), 0]) * 2 / angle
    np.testing.assert_allclose(tip, closed, atol=2e-4)


def test_a_force_that_follows_a_cable_is_that_on_a_body_at_its_tangent():
    """Against the same force on a rigid body without spin that the tangent of the tip carries."""
    force = np.array([3.0, 100.0, 0.0])
    cable = fl.Cable.straight((0, 0, 0), (2, 0, 0), section(1e6, 833.0, 78.0), cells=16)
    body = fl.RigidBody(1e-3, (1e-6, 1e-6, 1e-6), position=(2, 0, 0))
    scene = fl.Scene()
    scene.add(cable)
    scene.add(body)
    scene.add(fl.Clamp(cable.point("start")))
    scene.add(fl.joints.Revolute(cable.point("end"), body.point("centre"), axis=(1, 0, 0)))
    hinge = scene.add(
        fl.joints.Planar(fl.ground(), body.point("centre"), axis=(0, 0, 1), second=(1, 0, 0))
    )
    assert hinge is not None
    scene.add(fl.PointLoad(body.point("centre"), force, following=True))
    expected = fl.statics(scene).position(cable.point("end"))[-1]
    axes = cable.point("end").frame[1:]
    tip, _ = bent_by({"force": axes @ force, "following": True})
    np.testing.assert_allclose(tip, expected, atol=1e-7 * np.linalg.norm(expected))


def crane(step: float) -> fl.Result:
    """A beam that bends, at its tip a cable whose tangent is clamped, below it a swinging body."""
    scene = fl.Scene(gravity=(3, 1, -GRAVITY))
    steel = fl.Section.rectangle(0.02, 0.02, fl.Material(1e9, 0.3, 1000.0))
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), steel, cells=2))
    cable = scene.add(fl.Cable.straight((1, 0, 0), (1, 0, -1), section(1e4, 0.1, 0.1), cells=4))
    load = scene.add(fl.RigidBody(0.5, (1e-2, 1e-2, 1e-2), position=(1, 0, -1)))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.joints.Revolute(beam.point("end"), cable.point("start"), axis=(0, 0, 1)))
    scene.add(fl.joints.Spherical(cable.point("end"), load.point("centre")))
    return fl.GeneralisedAlpha(radius=0.9, tolerance=1e-8).run(scene, duration=0.2, step=step)


def test_beam_cable_and_body_together():
    """Positions to second order, joints closed, and the books of the energy balanced."""
    coarse, middle, fine = (crane(step) for step in (4e-3, 2e-3, 1e-3))
    ends = [result.position("rigidbody 1.centre")[-1] for result in (coarse, middle, fine)]
    first, second = np.abs(ends[0] - ends[1]).max(), np.abs(ends[1] - ends[2]).max()
    assert first / second > 2.8 and second < 1e-3
    assert np.abs(fine.joint_violations).max() < 1e-8
    tangent = fine.frames[:, fine.info.node("cable 1.start"), 1]
    axis = fine.frames[:, fine.info.node("beam 1.end"), 3]
    assert np.abs(np.cross(tangent, axis)).max() < 1e-7


# --- what cannot be -------------------------------------------------------------------------------


def cable_in_a_scene():
    cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), section(1e3, 1.0), cells=2)
    scene = fl.Scene()
    scene.add(cable)
    return scene, cable


def added(make):
    def run():
        scene, cable = cable_in_a_scene()
        scene.add(make(cable))

    return run


def straight_line():
    return fl.mesh.LineMesh.from_cells([(0, 0, 0), (1, 0, 0)], [(0, 1)])


def corner():
    return fl.mesh.LineMesh.from_cells([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 1), (1, 2)])


REFUSED = {
    "moment": (added(lambda c: fl.PointLoad(c.point("end"), moment=(1, 0, 0))), "no rotation"),
    "line moment": (added(lambda c: fl.LineLoad(c, moment=(1, 0, 0))), "moment"),
    "rigid link": (
        added(lambda c: fl.joints.RigidLink(c.point("start"), c.point("end"))),
        "positions and position gradients",
    ),
    "motion": (
        added(lambda c: fl.PrescribedMotion(c.point("end"), lambda t: c.point("end").frame)),
        "prescribed motion",
    ),
    "corner": (lambda: fl.Cable(corner(), section(1.0, 1.0)), "smooth"),
    "unlike bending": (
        lambda: fl.Cable.straight(
            (0, 0, 0), (1, 0, 0), fl.Section.from_stiffness([1.0, 1, 1, 1, 1, 2]), cells=1
        ),
        "alike",
    ),
    "unlike damping": (
        lambda: fl.Cable.straight(
            (0, 0, 0),
            (1, 0, 0),
            section(1, 1),
            cells=1,
            damping=fl.sections.Damping(stiffness=(0, 0, 0, 0, 1, 2)),
        ),
        "damped alike",
    ),
    "no strain to go slack at": (lambda: fl.elements.HermiteCable(slack=0.0), "positive"),
    "no strain": (lambda: fl.elements.HermiteCable(slack="much"), "slack"),
    "element of beams": (
        lambda: fl.Cable(straight_line(), section(1, 1), formulation=fl.elements.DirectorBeam()),
        "positions and position gradients",
    ),
    "element of cables": (
        lambda: fl.Beam(straight_line(), section(1, 1), formulation=fl.elements.HermiteCable()),
        "whose nodes are frames",
    ),
    "group of cells": (added(lambda c: fl.LineLoad(c, (0, 0, 1), cells="all")), "group"),
    "pin of another": (
        lambda: cable_in_a_scene()[1].pin(cable_in_a_scene()[1].point("end")),
        "of another body",
    ),
    "spin": (lambda: fl.statics(cable_in_a_scene()[0], spin=(0, 0, 1)), "steady rotation"),
    "imperfection": (
        lambda: fl.stability.apply_imperfections(
            cable_in_a_scene()[0], fl.stability.FieldImperfection(lambda x: (0.0, 0.0, 1e-3 * x[0]))
        ),
        "an imperfection",
    ),
}


@pytest.mark.parametrize("case", REFUSED.values(), ids=REFUSED.keys())
def test_refused(case):
    call, words = case
    with pytest.raises((ValueError, TypeError), match=words):
        call()
