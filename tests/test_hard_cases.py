"""Numerical stability: each case converges to its reference, or fails with the announced error."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fem_lie as fl
from tests.interruption import interrupted

# with the errors that interpolation leaves over the length, on a circle that closes and on an arc;
# that of degree 1 is a polygon whose sides have the length of their arcs
FORMULATIONS = {
    "geodesic": (fl.elements.GeodesicBeam(), 1e-9, 1e-9),
    "geodesic, plain": (fl.elements.GeodesicBeam(False), 1e-9, 1e-9),
    "director 1": (fl.elements.DirectorBeam(1), 1e-9, 0.05),
    "director 2": (fl.elements.DirectorBeam(2), 1e-2, 1e-2),
}
formulations = pytest.mark.parametrize(
    ("formulation", "closed", "bound"), FORMULATIONS.values(), ids=FORMULATIONS
)
MATERIAL = fl.Material(E=70e9, nu=0.3, density=2700.0)


def cantilever(section, cells=8, length=1.0, **options):
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), section, cells=cells, **options))
    scene.add(fl.Clamp(beam.point("start")))
    return scene, beam


@formulations
@pytest.mark.parametrize("slenderness", [1e1, 1e3, 1e5])
@pytest.mark.parametrize("load_steps", [1, 4])
def test_roll_up_to_a_full_circle_at_any_slenderness(
    formulation, closed, bound, slenderness, load_steps
):
    """In one load step every section past the middle turns by more than π."""
    EI, EA = 1.0, slenderness**2
    section = fl.Section.from_stiffness([EA, EA / 3, EA / 3, EI, EI, EI])
    scene, beam = cantilever(section, formulation=formulation)
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, 2 * np.pi * EI)))
    result = fl.statics(scene, load_steps=load_steps)
    np.testing.assert_allclose(result.position(beam.point("end"))[-1], 0.0, atol=closed)
    # an axis that bends within its element stretches in iterates of so large a step
    bends = getattr(formulation, "bending_flexibility", False) and formulation.degree == 1
    assert result.failed_iterations <= (25 if bends and load_steps == 1 else 0)


@formulations
def test_two_turns_in_one_load_step(formulation, closed, bound):
    section = fl.Section.from_stiffness([1e4, 1e4, 1e4, 1.0, 1.0, 1.0])
    scene, beam = cantilever(section, cells=16, formulation=formulation)
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, 4 * np.pi)))
    result = fl.statics(scene)
    middle = result.position(beam.point(4))[-1]  # half a turn: opposite to the clamp
    np.testing.assert_allclose(middle, (0, 1 / (2 * np.pi), 0), atol=bound)


@pytest.mark.parametrize("order", ["soft first", "stiff first"])
@pytest.mark.parametrize("ratio", [1e3, 1e6])
def test_stiffness_ratio_between_neighbours(ratio, order):
    """Large deflections; the stiff half stays straight and turns with the end of the soft one."""
    soft = fl.Section.from_stiffness([1e6, 1e6, 1e6, 1.0, 1.0, 1.0])
    stiff = fl.Section.from_stiffness(ratio * np.array([1e6, 1e6, 1e6, 1.0, 1.0, 1.0]))
    points = np.linspace((0, 0, 0), (1, 0, 0), 9)
    halves = {"first": [0, 1, 2, 3], "second": [4, 5, 6, 7]}
    cells = [(i, i + 1) for i in range(8)]
    mesh = fl.mesh.LineMesh.from_cells(
        points, cells, groups=halves, named_points={"start": [0], "end": [8]}
    )
    first, second = (soft, stiff) if order == "soft first" else (stiff, soft)
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, {"first": first, "second": second}))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, np.pi)))
    tip = fl.statics(scene).position(beam.point("end"))[-1]
    # half a length bends to a quarter of a turn with radius 1/π
    arc = np.array([1 / np.pi, 1 / np.pi, 0])
    straight = np.array([0, 0.5, 0]) if order == "soft first" else np.array([0.5, 0, 0])
    np.testing.assert_allclose(tip, arc + straight, atol=3 / ratio)


@pytest.mark.parametrize("ratio", [1e-6, 1e6])
def test_mass_ratio_of_a_double_pendulum(ratio):
    """Two point-like bodies in a plane, against the equations in angles.

    The heavy body tightens the chain, in which the light one then vibrates with up to 5000 rad/s.
    """
    masses, length, g = np.array([1.0, ratio]), 1.0, 9.81
    scene = fl.Scene(gravity=(0, 0, -g))
    bodies = [
        scene.add(fl.RigidBody(m, np.full(3, 1e-6 * m), position=(k + 1.0, 0, 0)))
        for k, m in enumerate(masses)
    ]
    scene.add(fl.joints.Spherical(fl.ground(), bodies[0].point("centre"), at=(0, 0, 0)))
    scene.add(
        fl.joints.Spherical(bodies[0].point("centre"), bodies[1].point("centre"), at=(1, 0, 0))
    )
    result = fl.GeneralisedAlpha(radius=0.9).run(scene, duration=0.2, step=1e-4)

    def rates(t, y):
        a, b, wa, wb = y  # angles below the horizontal
        m1, m2 = masses
        M = np.array(
            [[m1 + m2, m2 * np.cos(a - b)], [m2 * np.cos(a - b), m2]]
        ) * length + 1e-6 * np.diag(masses)
        f = np.array(
            [
                -m2 * length * wb**2 * np.sin(a - b) + (m1 + m2) * g * np.cos(a),
                m2 * length * wa**2 * np.sin(a - b) + m2 * g * np.cos(b),
            ]
        )
        return [wa, wb, *np.linalg.solve(M, f)]

    a, b = solve_ivp(rates, (0, 0.2), np.zeros(4), method="Radau", rtol=1e-8, atol=1e-10).y[:2, -1]
    tip = [np.cos(a) + np.cos(b), 0, -np.sin(a) - np.sin(b)]
    np.testing.assert_allclose(result.position(bodies[1].point("centre"))[-1], tip, atol=1e-6)


def test_beam_that_spins_about_its_axis():
    """150 rad/s about e₁ is steady: nothing may happen, and one matrix must do."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.02, 0.02, MATERIAL)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), section, cells=6))
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(1, 0, 0)))
    beam.add_velocity(omega=(150, 0, 0), about=(0, 0, 0))
    result = fl.GeneralisedAlpha().run(scene, duration=0.05, step=1e-3)
    assert np.abs(result.position(beam.point("end")) - (0.5, 0, 0)).max() < 1e-9
    np.testing.assert_allclose(result.velocity(beam.point("end"))[:, 3], 150, rtol=1e-9)
    assert result.factorisations == 1


@pytest.mark.parametrize("exponent", range(-7, 0))
def test_step_sizes(exponent):
    """Ten steps of a stiff pendulum that turns at one rate: the solution is a rigid rotation."""
    h = 10.0**exponent
    omega = 0.1
    scene = fl.Scene()
    section = fl.Section.rectangle(0.05, 0.05, MATERIAL)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4))
    scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    beam.add_velocity(omega=(0, 0, omega), about=(0, 0, 0))
    result = fl.GeneralisedAlpha().run(scene, duration=10 * h, step=h)
    angle = 10 * h * omega
    # the bar stretches by ρω²L³/3E = 1e-10 under its centrifugal force
    np.testing.assert_allclose(
        result.position(beam.point("end"))[-1], (np.cos(angle), np.sin(angle), 0), atol=3e-10
    )
    assert np.abs(result.position(beam.point("start"))).max() < 1e-12


@formulations
@pytest.mark.parametrize("gap", [1e-4, 1e-6, 1e-8])
def test_nearly_coincident_nodes(formulation, closed, bound, gap):
    """One cell is ``gap`` long: the roll-up still closes, and bends everywhere alike."""
    x = np.sort([0, 0.2, 0.5, 0.5 + gap, 0.8, 1.0])
    points = np.column_stack([x, 0 * x, 0 * x])
    ends = {"start": [0], "end": [5]}
    mesh = fl.mesh.LineMesh.from_cells(points, [(i, i + 1) for i in range(5)], named_points=ends)
    section = fl.Section.from_stiffness([1e6, 1e6, 1e6, 1.0, 1.0, 1.0])
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, section, formulation=formulation))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, np.pi)))
    tip = fl.statics(scene, load_steps=2).position(beam.point("end"))[-1]
    # strain in the short cell is a difference of positions, good to 1e-16, over the gap
    np.testing.assert_allclose(tip, (0, 2 / np.pi, 0), atol=max(bound, 1e-15 / gap))


def deflected(unit):
    """Tip of a bar, in multiples of its length: in equilibrium, and after a hundred steps."""
    section = fl.Section.rectangle(0.02 * unit, 0.01 * unit, MATERIAL)
    scene, beam = cantilever(section, length=unit)
    EI = MATERIAL.E * 0.02 * 0.01**3 / 12 * unit**4
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 0.2 * EI / unit**2)))
    static = fl.statics(scene)
    # time scales with length, as the speed of sound is that of the material
    swing = fl.GeneralisedAlpha().run(scene, duration=0.02 * unit, step=2e-4 * unit)
    return [result.position(beam.point("end"))[-1] / unit for result in (static, swing)]


@pytest.mark.parametrize("unit", [1e-6, 1e3])
def test_micrometres_and_kilometres_give_the_same_picture(unit):
    np.testing.assert_allclose(deflected(unit), deflected(1.0), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("gap", [1e-13, 1e-15])
def test_coincident_nodes_fail_with_the_announced_error(gap):
    """Strain would be round-off: no equilibrium at 1e-13, no mesh at 1e-15 of its size."""
    x = np.array([0, 1 / 3, 1 / 3 + gap, 1.0])
    points = np.column_stack([x, 0 * x, 0 * x])

    def solve():
        mesh = fl.mesh.LineMesh.from_cells(points, [(0, 1), (1, 2), (2, 3)])
        section = fl.Section.from_stiffness([1e6, 1e6, 1e6, 1.0, 1.0, 1.0])
        scene = fl.Scene()
        beam = scene.add(fl.Beam(mesh, section, formulation=fl.elements.GeodesicBeam(False)))
        scene.add(fl.Clamp(beam.point(0)))
        scene.add(fl.PointLoad(beam.point(3), moment=(0, 0, np.pi)))
        fl.statics(scene, load_steps=2)

    error, message = (
        (ValueError, "no length") if gap < 1e-14 else (fl.ConvergenceError, "no equilibrium")
    )
    with pytest.raises(error, match=message):
        solve()


END = (-0.25256159, -0.71726153, 0.22332468)  # h = 1e-4, and independent codes to 1e-5


def violent(step, scheme=None):
    """A stiff double pendulum that starts with a turn; its axial vibrations have 1e-4 s."""
    scene = fl.Scene()
    section = fl.Section.rectangle(5e-3, 5e-3, MATERIAL)
    one = scene.add(fl.Beam.straight((0, 0, 0), (0.3, 0, 0), section, cells=10))
    two = scene.add(fl.Beam.straight((0.3, 0, 0), (0.3, 0.5, 0), section, cells=10))
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Spherical(one.point("end"), two.point("start")))
    two.add_velocity(omega=(3, 0, -4), about=two.point("start"))
    result = (scheme or fl.GeneralisedAlpha()).run(scene, duration=1.0, step=step)
    return result.position(two.point("end"))[-1] - END


def test_unresolved_vibrations_leave_second_order():
    """Steps of up to two hundred periods: they are damped, and the motion does not feel them."""
    errors = [np.linalg.norm(violent(step)) for step in (2e-2, 1e-2, 5e-3)]
    assert errors[0] < 4e-3
    assert np.log2(np.array(errors[:-1]) / errors[1:]).min() > 1.8


@pytest.mark.parametrize(
    ("scheme", "step", "bound"),
    [
        # a fifth of a revolution in one step
        (fl.GeneralisedAlpha, 0.1, 0.2),
        (fl.GeneralisedAlpha, 0.05, 0.05),
        (fl.schemes.Variational, 0.05, 1e-4),
        (fl.EnergyMomentum, 0.05, 2e-3),
    ],
)
def test_too_large_a_step_is_made_in_parts(scheme, step, bound, caplog):
    """Parts are as small as it takes; policies that make no matrix fail."""
    assert np.linalg.norm(violent(step, scheme())) < bound
    assert "steps were divided into up to" in caplog.text
    with pytest.raises(fl.ConvergenceError, match="smaller step") as info:
        violent(step, scheme(policy=fl.schemes.FactoriseOnce()))
    assert info.value.result.times[0] == 0.0


@pytest.mark.parametrize("scheme", [fl.GeneralisedAlpha, fl.EnergyMomentum])
@pytest.mark.parametrize(
    "policy", [fl.schemes.Automatic(), fl.schemes.EveryIteration(), fl.schemes.FactoriseOnce()]
)
def test_a_failure_advises_what_can_help(scheme, policy):
    """Steps that fail are done again with full iteration by all policies that may do so."""
    scene = fl.Scene()
    bar = scene.add(
        fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.circle(0.01, MATERIAL), cells=2)
    )
    scene.add(fl.joints.Spherical(fl.ground(), bar.point("start")))
    bar.add_velocity(omega=(0, 0, 300), about=bar.point("start"))
    with pytest.raises(fl.ConvergenceError, match="Try a smaller step") as info:
        scheme(policy=policy, max_iterations=2).run(scene, duration=0.5, step=0.1, progress=False)
    text = str(info.value)
    assert ("policy" in text) == isinstance(
        policy, fl.schemes.FactoriseOnce
    ) and "EveryIteration" not in text
    loose = "a tolerance such as 1e-10" if scheme is fl.EnergyMomentum else "a larger tolerance"
    assert loose in text
    assert ("radius=0.5" in text) == (scheme is fl.GeneralisedAlpha)


def chain(links):
    """Rigid links on ball joints, 2 m in all, horizontal at first; and the last one."""
    scene, before = fl.Scene(gravity=(0, 0, -9.81)), fl.ground()
    a, m, r = 2.0 / links, 3.0 / links, 0.2 / links
    thick = m * (a * a / 12 + r * r / 4)
    for k in range(links):
        rod = fl.RigidBody(m, (m * r * r / 2, thick, thick), ((k + 0.5) * a, 0, 0))
        scene.add(rod)
        scene.add(fl.joints.Spherical(before, rod.point("centre"), at=(k * a, 0, 0)))
        before = rod.point("centre")
    return scene, before


@pytest.mark.parametrize(
    ("options", "remedy"),
    [
        ({}, "use radius=0.5 or index=fl.schemes.ConstraintIndex.STABILISED_TWO"),
        ({"radius": 0.5}, ""),
        ({"index": fl.schemes.ConstraintIndex.STABILISED_TWO}, ""),
    ],
    ids=["default", "damped", "stabilised"],
)
def test_violated_velocity_constraints_are_reported_once(options, remedy, caplog):
    """A hundred links with index 3: steps fail, and sub-steps do not remove the cause."""
    result = fl.GeneralisedAlpha(**options).run(
        chain(100)[0], duration=0.5, step=2e-3, progress=False
    )
    found = [each.getMessage() for each in caplog.records if "violate" in each.getMessage()]
    assert (result.divided > 0) == bool(remedy)
    assert len(found) == bool(remedy)
    assert all(remedy in each and "at time 0.46 " in each for each in found)


@pytest.mark.parametrize("options", [{"radius": 0.5}, {}], ids=["damped", "default"])
def test_a_long_chain_arrives(options, caplog):
    """A hundred links that fall for 0.7 s: with less damping in parts of the steps at its end."""
    scene, end = chain(100)
    result = fl.GeneralisedAlpha(**options).run(scene, duration=0.7, step=1e-3, progress=False)
    assert (result.divided > 0) == (not options) == ("steps were divided into up to" in caplog.text)
    # steps of 1e-4, whose energy is balanced to 7e-5
    assert np.linalg.norm(result.position(end)[-1] - (-0.45682, 0.0, -1.69518)) < 0.01
    with pytest.raises(fl.ConvergenceError, match="Try a smaller step"):
        fl.GeneralisedAlpha(policy=fl.schemes.FactoriseOnce()).run(
            scene, duration=0.7, step=1e-3, progress=False
        )


def test_a_run_restarts_between_sub_steps(tmp_path):
    """Resumed where steps are made in parts, to the last bit."""
    options = {"duration": 0.7, "step": 1e-3, "progress": False, "save_every": 10}
    whole = fl.GeneralisedAlpha().run(chain(100)[0], **options)
    scene, file = chain(100)[0], tmp_path / "chain.h5"
    # after step 660, in the middle of those that are made in parts
    with interrupted(33):
        fl.GeneralisedAlpha().run(scene, file=file, checkpoint_every=20, **options)
    again = fl.GeneralisedAlpha().resume(scene, file, progress=False)
    assert again.divided == whole.divided > 0
    assert np.array_equal(again.frames, whole.frames)
    assert np.array_equal(again.balance, whole.balance)
