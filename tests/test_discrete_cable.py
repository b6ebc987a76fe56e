"""Discrete rods without twist, and nets: closed forms, and laws of mechanics."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

import fem_lie as fl
from benchmarks import nets
from demos.elastica import BENDING, FORCE, LENGTH, elastica
from fem_lie import lie
from fem_lie.extend import node_types


def section(EA: float, EI: float, mass: float = 1.0) -> fl.Section:
    return fl.Section.from_stiffness([EA] * 3 + [EI] * 3, mass=mass)


def straight_cable(cells: int, ratio: float) -> tuple[fl.Scene, fl.Cable]:
    """The cantilever of the elastica."""
    own = section(ratio * BENDING / LENGTH**2, BENDING)
    cable = fl.Cable(
        fl.mesh.straight_line((0, 0, 0), (LENGTH, 0, 0), cells),
        own,
        formulation=fl.elements.DiscreteCable(),
    )
    scene = fl.Scene()
    scene.add(cable)
    cable.clamp(cable.point("start"))
    scene.add(fl.PointLoad(cable.point("end"), (0, 0, FORCE)))
    return scene, cable


@pytest.mark.parametrize("ratio", [1e4, 1e10])
def test_elastica_is_of_second_order_however_slender(ratio):
    """Extension of the order of 1/ratio is not in the closed form."""
    errors = []
    for cells in (8, 16, 32):
        scene, cable = straight_cable(cells, ratio)
        result = fl.statics(scene)
        assert result.iterations[-1] <= 10 and result.failed_iterations == 0
        moved = result.position(cable.point("end"))[-1] - (LENGTH, 0, 0)
        errors.append(np.linalg.norm(moved - elastica(FORCE)) / LENGTH)
    assert errors[-1] < 4e-4
    assert errors[0] / errors[2] > 10 or ratio < 1e6


def test_load_steps_take_few_iterations():
    scene, _ = straight_cable(32, 1e10)
    assert fl.statics(scene, load_steps=10).iterations[-1] <= 50


def ring(cells: int, natural: bool) -> tuple[fl.Net, float]:
    """A closed cable along a circle, and its energy."""
    angle = 2 * np.pi * np.arange(cells) / cells
    points = 2.0 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    net = fl.Net(
        points,
        [[*range(cells), 0]],
        section(1e4, 3.0),
        formulation=fl.elements.DiscreteCable(natural=natural),
    )
    assembly = net.model.assemble([net.model])
    H = np.empty_like(net.frames)
    H[assembly.order] = net.frames
    (springs,) = assembly.further_terms
    return net, assembly.energy(H) + springs.energy(H)


def test_energy_of_a_ring():
    """``π EI/R`` of a straight cable that is bent to it; nothing if it is naturally so."""
    errors = [ring(cells, False)[1] / (np.pi * 3.0 / 2.0) - 1 for cells in (16, 32, 64)]
    assert errors[0] / errors[2] == pytest.approx(16, rel=0.1) and errors[2] < 3e-3
    assert ring(32, True)[1] == pytest.approx(0, abs=1e-20)


def test_frequencies_of_a_cantilever():
    """β²√(EI/ρA), βL = 1.875104 and 4.694091."""
    errors = []
    for cells in (8, 16, 32):
        scene, _ = straight_cable(cells, 1e6)
        found = fl.vibrations(scene.with_loads(), 4).frequencies[::2]
        exact = np.array([1.875104068711961, 4.694091132974175]) ** 2 * np.sqrt(BENDING) / LENGTH**2
        errors.append(np.abs(found / exact - 1).max())
    assert errors[0] / errors[1] > 3.4 and errors[1] / errors[2] > 3.6 and errors[2] < 5e-3


# --- nets -----------------------------------------------------------------------------------------


def cross(slack: float | None = None) -> fl.Net:
    """Two cables over each other in their middle; four arms of unit length in three edges."""
    s = np.linspace(-1, 1, 7)
    points = np.vstack([np.outer(s, (1, 0, 0)), np.outer(np.delete(s, 3), (0, 1, 0))])
    cables = [range(7), [7, 8, 9, 3, 10, 11, 12]]
    element = fl.elements.DiscreteCable(slack=slack)
    return fl.Net(points, cables, section(100.0, 1e-9), formulation=element)


def test_load_on_a_knot():
    """``P = 4 N sin``, with the strain of arms that have gone down by ``d``."""
    net, load = cross(), 2.0
    scene = fl.Scene()
    scene.add(net)
    net.pin(*(net.point(k) for k in (0, 6, 7, 12)))
    scene.add(fl.PointLoad(net.point(3), (0, 0, -load)))
    found = fl.statics(scene).position(net.point(3))[-1]
    length = lambda d: np.hypot(1.0, d)  # noqa: E731
    d = brentq(lambda d: 4 * 100 * (length(d) - 1) * d / length(d) - load, 0.0, 1.0, xtol=1e-14)
    np.testing.assert_allclose(found, (0, 0, -d), atol=1e-7)


def test_slack_net_hangs():
    """Laid wider than its supports are apart; forces on these carry its weight."""
    net = fl.Net(
        *grid(4, 2.0),
        section(1e3, 1e-6),
        stretch=0.8,
        formulation=fl.elements.DiscreteCable(slack=1e-4),
    )
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(net)
    net.pin(*(net.point(k) for k in (0, 4, 20, 24)))
    result = fl.statics(scene)
    weight = 9.81 * net.model.lengths.sum()
    np.testing.assert_allclose(result.reactions[-1][:, :3].sum(axis=0), (0, 0, weight), atol=1e-6)
    positions = np.array([result.position(net.point(k))[-1] for k in range(25)]).reshape(5, 5, 3)
    np.testing.assert_allclose(positions[:, :, 2], positions[::-1, :, 2], atol=1e-7)
    np.testing.assert_allclose(positions[:, :, 2], positions.transpose(1, 0, 2)[:, :, 2], atol=1e-7)
    assert positions[2, 2, 2] < -0.5


def grid(cells: int, edge: float) -> tuple[np.ndarray, list[list[int]]]:
    """Points and cables of a square net."""
    n = cells + 1
    s = np.linspace(0, edge, n)
    x, y = np.meshgrid(s, s, indexing="ij")
    number = np.arange(n * n).reshape(n, n)
    points = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    return points, [*number.tolist(), *number.T.tolist()]


def test_fall_of_a_net():
    """Momentum by gravity alone, energy and angular momentum to the order of the step."""
    net = fl.Net(*grid(4, 1.0), section(1e3, 1e-3, 0.2))
    net.add_velocity(omega=(1.0, 2.0, 3.0), about=net.point(0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(net)
    scheme = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)
    result = scheme.run(scene, duration=0.2, step=1e-3)
    change = result.momentum - result.momentum[:1]
    weight = 9.81 * 0.2 * net.model.lengths.sum()
    expected = np.outer(result.times, (0, 0, -weight))
    np.testing.assert_allclose(change, expected, atol=1e-6 * weight)
    assert result.energy_error < 1e-4


# --- laws of the springs --------------------------------------------------------------------------


class Bent:
    """A cable with a clamped end in any state, and the springs on its nodes."""

    def __init__(self, natural: bool) -> None:
        rng = np.random.default_rng(3)
        line = fl.mesh.curve(lambda s: (3 * s, s * s, 0.5 * s**3), 5)
        element = fl.elements.DiscreteCable(natural=natural)
        self.cable = fl.Cable(line, section(1e3, 10.0), formulation=element)
        self.cable.clamp(self.cable.point("start"), self.cable.point("end"))
        assembly = self.cable.model.assemble([self.cable.model])
        (self.springs,) = assembly.further_terms
        H = np.empty_like(self.cable.frames)
        H[assembly.order] = self.cable.frames
        self.h = rng.normal(size=(6, 6)) * (1, 1, 1, 0, 0, 0)
        self.H = self.moved(H, 0.2 * rng.normal(size=(6, 6)))

    def moved(self, H, h):
        out = np.empty_like(H)
        node_types.retract_all(np.full(6, fl.extend.node_types.POSITION), H, h, out)
        return out

    def forces(self, H):
        out = np.zeros((6, 6))
        self.springs.add_forces(H, out)
        return out


@pytest.mark.parametrize("natural", [False, True], ids=["straight", "as laid"])
def test_forces_and_matrix_are_derivatives_of_the_energy(natural):
    bent, step = Bent(natural), 1e-6
    ahead, behind = (bent.moved(bent.H, s * step * bent.h) for s in (1, -1))
    slope = (bent.springs.energy(ahead) - bent.springs.energy(behind)) / (2 * step)
    assert np.vdot(bent.forces(bent.H), bent.h) == pytest.approx(slope, rel=1e-7)
    change = (bent.forces(ahead) - bent.forces(behind)) / (2 * step)
    blocks, product = bent.springs.tangent(bent.H, bent.springs.workspace()), np.zeros((6, 6))
    for row, column, block in zip(*bent.springs.pairs, blocks, strict=True):
        product[row] += block @ bent.h[column]
    np.testing.assert_allclose(product, change, atol=1e-6 * np.abs(change).max())


def test_springs_do_not_feel_rigid_motions():
    """Those between edges; what is clamped is so in space."""
    net, _ = ring(7, True)
    assembly = net.model.assemble([net.model])
    (springs,) = assembly.further_terms
    H = np.empty_like(net.frames)
    H[assembly.order] = net.frames
    H[:, 0] += 0.3 * np.random.default_rng(1).normal(size=(7, 3))
    turn = lie.se3_exp(np.array([1.0, -2, 3, 0.8, -2.0, 1.1]))
    turned = H @ lie.rotation(turn).T
    turned[:, 0] += turn[0]
    assert springs.energy(turned) == pytest.approx(springs.energy(H), rel=1e-12)
    forces = [np.zeros((7, 6)) for _ in range(2)]
    for state, out in zip((H, turned), forces, strict=True):
        springs.add_forces(state, out)
    np.testing.assert_allclose(*forces, atol=1e-10)


# --- what cannot be -------------------------------------------------------------------------------

POINTS = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0.5, 0, 0)]


def cable() -> fl.Cable:
    return fl.Cable(
        fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 3),
        section(1, 1),
        formulation=fl.elements.DiscreteCable(),
    )


def clamped():
    scene, line = fl.Scene(), cable()
    scene.add(line)
    scene.add(fl.Clamp(line.point("start")))


def revolute():
    scene, line = fl.Scene(), cable()
    scene.add(line)
    scene.add(fl.joints.Revolute(fl.ground(), line.point("start"), axis=(1, 0, 0)))


REFUSED = {
    "kink of π": (lambda: fl.Net(POINTS, [[0, 2, 3, 1]], section(1, 1)), "goes back"),
    "edge without length": (
        lambda: fl.Net([(0, 0, 0), (0, 0, 0)], [[0, 1]], section(1, 1)),
        "distinct points",
    ),
    "one point": (lambda: fl.Net(POINTS, [[0]], section(1, 1)), "two points"),
    "no cable": (lambda: fl.Net(POINTS, [], section(1, 1)), "one cable"),
    "point without a cable": (lambda: fl.Net(POINTS, [[0, 1]], section(1, 1)), "point"),
    "edge twice": (
        lambda: fl.Net(POINTS, [[0, 1, 2], [1, 0, 3]], section(1, 1)),
        "twice",
    ),
    "other element": (
        lambda: fl.Net(POINTS, [[0, 1]], section(1, 1), formulation=fl.elements.HermiteCable()),
        "DiscreteCable",
    ),
    "stretch": (lambda: fl.Net(POINTS[:3], [[0, 1, 2]], section(1, 1), stretch=0.0), "stretch"),
    "stretches": (
        lambda: fl.Net(POINTS[:3], [[0, 1], [1, 2]], section(1, 1), stretch=[1.0]),
        "2, one for each cable",
    ),
    "damping": (
        lambda: fl.Net(
            POINTS[:3], [[0, 1, 2]], section(1, 1), damping=fl.sections.Damping(stiffness=1.0)
        ),
        "mass only",
    ),
    "slack": (lambda: fl.elements.DiscreteCable(slack=-1.0), "positive"),
    "clamp in the middle": (lambda: (line := cable()).clamp(line.point(1)), "at ends"),
    "clamp of another": (lambda: cable().clamp(cable().point("start")), "of another body"),
    "clamp of a scene": (clamped, r"clamp\(point\)"),
    "direction by a joint": (revolute, "no directions"),
}


@pytest.mark.parametrize("case", REFUSED.values(), ids=REFUSED.keys())
def test_refused(case):
    call, words = case
    with pytest.raises((ValueError, TypeError), match=words):
        call()


def test_a_net_that_is_hit_converges():
    """Three unknowns at each node that is not pinned."""
    runs = [nets.run(parts, 2.5e-3) for parts in (1, 2, 4)]
    assert runs[0].unknowns == 3 * 11 * 11
    moved = [nets.distance(*pair) for pair in pairwise(runs)]
    assert moved[1] < 8e-4 and moved[1] < 0.6 * moved[0]


@pytest.mark.parametrize("cells", [4, 5, 6])
def test_cables_that_are_naturally_as_laid_move_freely(cells):
    """Along oblique straight lines curvature is round-off, and must not become a direction."""
    turns = np.exp(1j * np.pi / 3 * np.arange(7))
    corners = np.column_stack([turns.real, turns.imag])
    parts = np.arange(cells)[:, np.newaxis] / cells
    flat = np.vstack([a + parts * (b - a) for a, b in pairwise(corners)])
    points = np.column_stack([flat, np.full(len(flat), 0.31)])
    cord = fl.Section.circle(1e-3, fl.Material(E=1e8, nu=0.3, density=1000.0))
    natural = fl.elements.DiscreteCable(natural=True)
    net = fl.Net(points, [[*range(len(points)), 0]], cord, formulation=natural)
    net.add_velocity((0.0, 0.0, -10.0))
    scene = fl.Scene()
    scene.add(net)
    result = fl.EnergyMomentum().run(scene, duration=5e-3, step=2.5e-4, progress=False)
    moved = result.frames[-1, result.info.body(net.name).nodes, 0] - points
    np.testing.assert_allclose(moved, np.tile([0.0, 0.0, -0.05], (len(points), 1)), atol=1e-14)
