"""Statics against closed forms."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie

MATERIAL = fl.Material(2.1e11, 0.3, 7850.0)
SECTION = fl.Section.rectangle(0.02, 0.01, MATERIAL)


FORMULATIONS = [
    fl.elements.GeodesicBeam(),
    fl.elements.DirectorBeam(1),
    fl.elements.DirectorBeam(2),
]
every_formulation = pytest.mark.parametrize("formulation", FORMULATIONS, ids=str)


def stiffness(EA=1e4, GA=1e4, EI=100.0) -> fl.Section:
    return fl.Section.from_stiffness(np.diag([EA, GA, GA, EI, EI, EI]))


def cantilever(section: fl.Section, length: float, cells: int, formulation=None, **options):
    scene = fl.Scene(**options)
    line = fl.Beam.straight(
        (0, 0, 0), (length, 0, 0), section, cells=cells, formulation=formulation
    )
    beam = scene.add(line)
    scene.add(fl.Clamp(beam.point("start")))
    return scene, beam


@every_formulation
@pytest.mark.parametrize("slenderness", [1e1, 1e2, 1e3, 1e4, 1e5])
def test_one_element_is_timoshenko(slenderness, formulation):
    """Tip load on a straight beam: PL³/3EI + PL/GA with one element, at any slenderness."""
    L, EA, GA, EI = slenderness, 1.0, 5 / 12, 1 / 12  # section of height 1
    scene, beam = cantilever(stiffness(EA, GA, EI), L, 1, formulation)
    P = 1e-6 * EI / L**2
    scene.add(fl.PointLoad(beam.point("end"), force=(0, P, 0)))
    tip = fl.statics(scene).position(beam.point("end"))[-1]
    exact = P * L**3 / (3 * EI) + P * L / GA
    # the load bends by 1e-6 of a radian: nonlinear terms are its square
    assert abs(tip[1] / exact - 1) < 1e-6


@pytest.mark.parametrize("slender", [1e4, 1e8])
@pytest.mark.parametrize("case", ["load", "following load", "prescribed rotation", "by a joint"])
def test_roll_up_to_a_circle(case, slender):
    """Pure bending is exact in every element: a circle to round-off, by any way of driving it."""
    L, EI = 10.0, 100.0
    section = stiffness(slender * EI / L**2, slender * EI / L**2 / 2, EI)
    if case == "by a joint":
        scene = fl.Scene()
        beam = scene.add(fl.Beam.straight((0, 0, 0), (L, 0, 0), section, cells=8))
        scene.add(fl.joints.Fixed(fl.ground(), beam.point("start")))
    else:
        scene, beam = cantilever(section, L, 8)
    moment = (0, 0, 2 * np.pi * EI / L)
    if case == "prescribed rotation":
        start = beam.point("end").frame

        def motion(factor: float) -> np.ndarray:
            angle = 2 * np.pi * factor
            curvature = angle / L
            x = np.array([np.sin(angle), 1 - np.cos(angle), 0]) / curvature if factor else start[0]
            return lie.frame(x, lie.so3_exp([0, 0, angle]))

        scene.add(fl.PrescribedMotion(beam.point("end"), motion))
    else:
        following = case == "following load"
        scene.add(fl.PointLoad(beam.point("end"), moment=moment, following=following))
    result = fl.statics(scene, load_steps=6)
    assert np.linalg.norm(result.position(beam.point("end"))[-1]) < 1e-9 * L
    # a prescribed end also moves against the axial stiffness in each step: more iterations
    most = 9 if case == "prescribed rotation" else 4.5
    assert result.iterations[-1] <= most * len(result.factors)
    if case == "prescribed rotation":
        assert abs(abs(result.joint_forces[-1, -1, 5]) - moment[2]) < 1e-6 * moment[2]
    if case == "by a joint":
        assert abs(abs(result.joint_forces[-1, -1, 5]) - moment[2]) < 1e-6 * moment[2]


@pytest.mark.parametrize("slender", [1e4, 1e8])
@pytest.mark.parametrize(
    ("formulation", "cells", "bound"),
    # degree 1: a polygon that turns by 45° at each node, to the cut-off fraction of the angle;
    # degree 2: plain interpolation of 45° and 22.5° per element, of fourth order
    [
        (fl.elements.DirectorBeam(1), 8, 1e-10),
        (fl.elements.DirectorBeam(2), 8, 6e-3),
        (fl.elements.DirectorBeam(2), 16, 4e-4),
    ],
    ids=str,
)
def test_roll_up_by_directors(formulation, cells, bound, slender):
    L, EI = 10.0, 100.0
    section = stiffness(slender * EI / L**2, slender * EI / L**2 / 2, EI)
    scene, beam = cantilever(section, L, cells, formulation)
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, 2 * np.pi * EI / L)))
    result = fl.statics(scene, load_steps=6)
    assert np.linalg.norm(result.position(beam.point("end"))[-1]) < bound * L
    assert result.iterations[-1] / len(result.factors) <= 4.5


@pytest.mark.parametrize(
    ("formulation", "order"),
    [
        (fl.elements.GeodesicBeam(), 2),
        (fl.elements.DirectorBeam(1), 2),
        (fl.elements.DirectorBeam(1, False), 2),
        (fl.elements.DirectorBeam(2), 4),
    ],
    ids=str,
)
def test_observed_order(formulation, order):
    """45° bend: how the error falls with the element size (reference by shooting)."""
    reference = np.array([47.15043857, 15.68480053, 53.47485879])
    section = stiffness(1e7, 5e6, 1e7 / 12)
    errors = []
    for cells in (8, 16, 32) if order == 4 else (4, 8, 16, 32):
        scene = fl.Scene()
        arc = fl.Beam.curve(
            lambda s: (100 * np.sin(s * np.pi / 4), 100 * (1 - np.cos(s * np.pi / 4)), 0.0),
            section,
            cells=cells,
            formulation=formulation,
        )
        scene.add(arc)
        scene.add(fl.Clamp(arc.point("start")))
        scene.add(fl.PointLoad(arc.point("end"), force=(0, 0, 600)))
        tip = fl.statics(scene, load_steps=3).position(arc.point("end"))[-1]
        errors.append(np.linalg.norm(tip - reference))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > order - 0.1, orders


def helix(s: float) -> tuple[float, float, float]:
    return 3 * np.cos(4 * s), 3 * np.sin(4 * s), 5 * s


@every_formulation
def test_curved_and_twisted_beam_is_free_of_stress_unloaded(formulation):
    """Forces of round-off: stiffness 1e4 times 1e-15."""
    beam = fl.Beam.curve(
        helix,
        stiffness(),
        cells=5,
        formulation=formulation,
        up=fl.sections.Twisted(lambda s: 0.3 * s),
    )
    assembly = beam.model.assemble([beam.model])
    H, forces = np.empty_like(beam.frames), np.zeros(6 * len(beam.frames))
    H[assembly.order] = beam.frames
    assembly.add_forces(H, forces)
    assert np.abs(forces).max() < 1e-10
    assert assembly.energy(H) < 1e-20


@every_formulation
def test_viscous_forces_are_those_of_the_tangent(formulation):
    """Kelvin and Voigt: τ K v while unloaded; nothing in rigid motion, however deformed."""
    tau, rng = 0.1, np.random.default_rng(1)
    beam = fl.Beam.curve(
        helix,
        stiffness(),
        cells=3,
        formulation=formulation,
        damping=fl.sections.Damping(stiffness=tau),
    )
    assembly = beam.model.assemble([beam.model])
    count = len(beam.frames)
    H, v = np.empty_like(beam.frames), rng.normal(size=(count, 6))
    H[assembly.order] = beam.frames
    assembly.reset_stress(H)
    rows = np.repeat(np.arange(count), np.diff(assembly.indptr))
    expected, forces = np.zeros((count, 6)), np.zeros(6 * count)
    blocks = assembly.tangent(H, np.zeros((count, 6)))
    products = np.einsum("kij,kj->ki", blocks, v[assembly.indices])
    np.add.at(expected, rows, tau * products)
    assembly.add_viscous_forces(H, v, forces)
    scale = np.abs(forces).max()
    assert np.abs(forces - expected.ravel()).max() < 1e-12 * scale
    H = lie.se3_retract(H, 0.2 * v)
    w, velocity = rng.normal(size=(2, 3))
    rigid = np.concatenate([velocity + np.cross(w, H[:, 0]), np.tile(w, (count, 1))]).reshape(
        2, -1, 3
    )
    local = np.einsum("nai,kni->nka", H[:, 1:], rigid).reshape(count, 6)
    forces[:] = 0
    assembly.add_viscous_forces(H, local, forces)
    assert np.abs(forces).max() < 1e-11 * scale


@every_formulation
def test_consistent_inertia_of_a_curved_beam(formulation):
    """Momentum of a beam that moves without turning: all its mass, m = ρA times the arc."""
    beam = fl.Beam.curve(helix, SECTION, cells=5, formulation=formulation)
    assembly = beam.model.assemble([beam.model])
    mass = assembly.inertia.mass
    assert abs(mass[:, 0, 0].sum() / (SECTION.inertia[0, 0] * beam.model.lengths.sum()) - 1) < 1e-12
    # and the shares of a line load are the row sums of the mass
    rows = np.repeat(np.arange(len(beam.frames)), np.diff(assembly.indptr))
    nodal = np.bincount(rows, mass[:, 0, 0])[assembly.order]
    at = beam.model.line_quadrature()
    carried = np.bincount(at.nodes.ravel(), at.lengths.ravel())
    np.testing.assert_allclose(nodal, SECTION.inertia[0, 0] * carried, rtol=1e-12)


@every_formulation
def test_eigenstrain_bends_to_a_circle(formulation):
    """κ₃ = 1/r without stress: the tip of an arc of length L and angle L/r."""
    L, cells, curvature = 10.0, 8, 0.1
    scene, beam = cantilever(stiffness(), L, cells, formulation)
    scene.add(fl.loads.Eigenstrain(beam, (0, 0, 0, 0, 0, curvature)))
    result = fl.statics(scene, load_steps=2)
    tip, R = result.position(beam.point("end"))[-1], result.rotation(beam.point("end"))[-1]
    angle = curvature * L
    exact = np.array([np.sin(angle), 1 - np.cos(angle), 0]) / curvature
    turned = np.arctan2(R[1, 0], R[0, 0])
    # the geodesic is the arc itself; (1/8)²/24 of an arc over its chord; fourth order
    bound = {
        fl.elements.GeodesicBeam(): 1e-9,
        fl.elements.DirectorBeam(1): 1e-3,
        fl.elements.DirectorBeam(2): 2e-6,
    }[formulation]
    assert np.linalg.norm(tip - exact) < bound * L
    assert abs(turned - angle) < (2e-6 if formulation.degree == 2 else 1e-9)


@every_formulation
def test_line_load_in_consistent_shares(formulation):
    """wL⁴/8EI + wL²/2GA at the tip; a half and a half, or a sixth, two thirds, a sixth."""
    L, cells, w = 10.0, 4, 1e-6
    scene, beam = cantilever(stiffness(), L, cells, formulation)
    scene.add(fl.LineLoad(beam, force=(0, w, 0)))
    tip = fl.statics(scene).position(beam.point("end"))[-1]
    exact = w * L**4 / 800 + w * L**2 / 2e4
    # shares of two nodes without end moments: (1/cells)²/3; with them, or of three, it is exact
    exact_at_nodes = formulation.bows or formulation.degree == 2
    assert abs(tip[1] / exact - 1) < (1e-6 if exact_at_nodes else 0.021)


def test_own_weight_and_line_load():
    """wL⁴/8EI + wL²/2GA from gravity, as good as exact, and from a line load."""
    L, cells = 1.0, 16
    EI, GA = SECTION.stiffness[4, 4], SECTION.stiffness[2, 2]
    w = 1e-3 * EI
    g = w / SECTION.inertia[0, 0]
    exact = w * L**4 / (8 * EI) + w * L**2 / (2 * GA)
    tips = []
    for gravity, line in ((g, 0.0), (0.0, -w), (g, w)):
        scene, beam = cantilever(SECTION, L, cells, gravity=(0, 0, -gravity))
        if line:
            scene.add(fl.LineLoad(beam, force=(0, 0, line)))
        tips.append(fl.statics(scene).position(beam.point("end"))[-1, 2])
    # both come with the axis of the inertia, a parabola
    assert abs(-tips[0] / exact - 1) < 1e-6
    assert abs(-tips[1] / exact - 1) < 1e-6
    # and cancel to round-off
    assert abs(tips[2]) < 1e-12 * abs(exact)


def test_following_force_against_dead_force():
    """A force that turns with the tip keeps its full lever: it bends further than a dead one."""
    tips = {}
    for following in (False, True):
        scene, beam = cantilever(stiffness(), 10.0, 16)
        scene.add(fl.PointLoad(beam.point("end"), force=(0, 8.0, 0), following=following))
        result = fl.statics(scene, load_steps=4)
        tips[following] = result.position(beam.point("end"))[-1]
    assert tips[True][0] < tips[False][0]


@pytest.mark.parametrize("kind", ["force", "moment"])
def test_line_loads_following_and_dead_agree_while_little_turns(kind):
    """Following pressure and dead weight, following and dead moments: equal to first order."""
    ends = []
    for following in (False, True):
        scene, beam = cantilever(stiffness(), 10.0, 8)
        load = {kind: (0, 0, 1e-6) if kind == "force" else (0, 1e-6, 0)}
        scene.add(fl.LineLoad(beam, following=following, **load))
        ends.append(fl.statics(scene).position(beam.point("end"))[-1])
    # rotations are 1e-6: they change the load by their square in the tip's direction
    assert np.abs(ends[1] - ends[0]).max() < 1e-5 * abs(ends[0][2])
    if kind == "moment":  # m per length: w = m L³/3EI
        assert abs(-ends[0][2] / (1e-6 * 1000 / 300) - 1) < 5e-3


def test_load_on_a_group_of_cells():
    """Half a beam loaded from a named group: the resultant at the clamp says how much."""
    mesh = fl.mesh.LineMesh.from_cells(
        [(x, 0, 0) for x in range(5)],
        [(i, i + 1) for i in range(4)],
        groups={"outer": [2, 3]},
        named_points={"root": [0], "tip": [4]},
    )
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, stiffness()))
    joint = scene.add(fl.joints.Fixed(fl.ground(), beam.point("root")))
    scene.add(fl.LineLoad(beam, force=(0, 0, -0.5), cells="outer"))
    force = fl.statics(scene).joint_force(joint)[-1]
    # the joint's e₃ is global z: 0.5 per length on two lengths, pulling ground down; lever 3
    assert abs(force[2] + 1.0) < 1e-9
    assert abs(np.linalg.norm(force[3:5]) - 3.0) < 1e-2


def test_rigid_body_hangs_on_a_beam():
    """A weight fixed to the tip: P L³/3EI, and the joint carries the weight."""
    L, mass = 1.0, 0.5
    scene, beam = cantilever(stiffness(1e8, 1e8, 1e4), L, 2)
    weight = scene.add(fl.RigidBody(mass, (1e-3, 1e-3, 1e-3), (L, 0, 0)))
    joint = scene.add(fl.joints.Fixed(beam.point("end"), weight.point("centre")))
    scene.add(fl.PointLoad(weight.point("centre"), force=(0, 0, -mass * 10)))
    result = fl.statics(scene)
    exact = mass * 10 * (L**3 / (3 * 1e4) + L / 1e8)
    assert abs(-result.position(beam.point("end"))[-1, 2] / exact - 1) < 1e-6
    force = result.joint_force(joint)[-1]
    assert abs(np.linalg.norm(force[:3]) - mass * 10) < 1e-9


def test_plain_newton_and_linearised_stress_agree():
    ends = []
    for carried in (True, False):
        scene, beam = cantilever(stiffness(), 10.0, 8)
        scene.add(fl.PointLoad(beam.point("end"), force=(0, 5.0, 2.0)))
        ends.append(
            fl.statics(
                scene, load_steps=4, newton=fl.schemes.Newton(linearised_stress=carried)
            ).position(beam.point("end"))[-1]
        )
    assert np.abs(ends[0] - ends[1]).max() < 1e-8


def test_cut_back_recovers_and_says_so():
    """One step of plain Newton is too much for the roll-up; halved steps arrive all the same."""
    scene, beam = cantilever(stiffness(), 10.0, 8)
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, 20 * np.pi)))
    result = fl.statics(scene, load_steps=2, newton=fl.schemes.Newton(linearised_stress=False))
    assert result.failed_iterations > 0
    assert result.factors[-1] == 1.0
    assert np.linalg.norm(result.position(beam.point("end"))[-1]) < 1e-8


def test_failure_names_step_residual_and_remedy():
    scene, beam = cantilever(stiffness(1e6, 1e6), 10.0, 8)
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, 20 * np.pi)))
    with pytest.raises(
        fl.ConvergenceError, match=r"load factor 0 to .*residual.*linearised_stress"
    ):
        fl.statics(scene, newton=fl.schemes.Newton(linearised_stress=False, smallest_step=0.5))


def test_failure_keeps_the_states_before():
    """A load that becomes absurd at half its factor: the way up to there is not lost."""
    scene, beam = cantilever(stiffness(), 10.0, 4)
    scene.add(
        fl.PointLoad(beam.point("end"), force=(0, 1, 0), history=lambda f: f if f <= 0.5 else 1e12)
    )
    with pytest.raises(fl.ConvergenceError, match=r"load factor 0\.5") as info:
        fl.statics(scene, load_steps=4, newton=fl.schemes.Newton(smallest_step=0.05))
    result = info.value.result
    assert result.factors.tolist() == [0.25, 0.5]
    assert result.position(beam.point("end")).shape == (2, 3)
    assert result.failed_iterations > 0


def test_singular_structure_is_reported():
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), stiffness(), cells=2))
    scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 1, 0)))
    with pytest.raises(fl.ConvergenceError, match=r"held by clamps or joints|singular"):
        fl.statics(scene)


def weightless(density: float) -> dict[str, fl.extend.Body]:
    """Bodies of one material, held at their starts."""
    soft = fl.Material(1e6, 0.3, density)
    section, layer = fl.Section.circle(0.05, soft), fl.ShellSection.layer(0.1, soft)
    rubber = fl.sections.NeoHooke(1e6, 0.3, density)
    ends = (0, 0, 0), (1, 0, 0)
    bodies: dict[str, fl.extend.Body] = {
        "beam": fl.Beam.straight(*ends, section, cells=2),
        "rod": fl.Rod.straight(*ends, section, cells=2),
        "ancf": fl.AncfBeam.straight(*ends, section, cells=2),
        "shell": fl.Shell(
            fl.mesh.parametric_surface(lambda a, b: (a, 0.5 * b, 0.0), (2, 1)), layer
        ),
        "solid": fl.Solid.brick((1.0, 0.2, 0.2), rubber, cells=(2, 1, 1)),
    }
    return bodies


@pytest.mark.parametrize("name", weightless(1.0))
def test_statics_without_gravity_needs_no_density(name):
    found = []
    for density in (0.0, 7.0):
        body = weightless(density)[name]
        scene = fl.Scene()
        scene.add(body)
        if name == "ancf":
            body.clamp(body.point("start"))
            tip = body.point("end")
        elif name in ("shell", "solid"):
            body.clamp("a=0")
            tip = body.point("11") if name == "shell" else body.point("111")
        else:
            scene.add(fl.Clamp(body.point("start")))
            tip = body.point("end")
        scene.add(fl.PointLoad(tip, force=(0, 0, 1e-2)))
        found.append(fl.statics(scene).position(tip)[-1])
        if density == 0.0:
            with pytest.raises(ValueError, match="density"):
                fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.1)
    np.testing.assert_array_equal(*found)
    assert found[0][2] > 1e-9


def test_pictures_magnify_displacements_and_rotations(monkeypatch, tmp_path):
    """From the undeformed configuration, with the paths of points."""
    drawn = {}

    def draw(info, frames, path, *, paths, **_):
        drawn.update(frames=frames, paths=paths)

    monkeypatch.setattr("fem_lie.results.equilibrium.bodies.draw", draw)
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.from_stiffness([1e3] * 6), cells=4)
    )
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, 1.0)))
    result = fl.statics(scene)
    result.picture(tmp_path / "beam.png", [-1], trace=["beam 1.end"], magnified=50.0)
    start, moved = drawn["frames"]
    turn, way = lie.so3_log(moved[-1, 1:].T @ start[-1, 1:]), moved[-1, 0] - start[-1, 0]
    # a curvature of 1e-3 turns the end by 1e-3 rad
    np.testing.assert_allclose(turn, [0.0, 0.0, 50e-3], atol=1e-9)
    np.testing.assert_allclose(way, 50.0 * result.displacement("beam 1.end")[-1], rtol=1e-12)
    np.testing.assert_allclose(drawn["paths"][0][-1], moved[-1, 0], rtol=1e-12)
