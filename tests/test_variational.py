"""The variational scheme: momenta, energy over long times, order, dissipation, bad input."""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from tests.combinations import free, joined
from tests.scene_builder import build
from tests.test_composed import driven, flying, resumed_as_whole, rigid_pendulum
from tests.test_energy_momentum import BEAMS, SHELLS, bars, plate

SCHEME = fl.schemes.Variational()


@pytest.mark.parametrize(
    "joint", [fl.joints.Spherical, fl.joints.Revolute, fl.joints.Fixed, fl.joints.InPlane]
)
@pytest.mark.parametrize("formulation", BEAMS.values(), ids=BEAMS)
def test_angular_momentum_of_beams_and_joints(formulation, joint):
    """It is that about the joint with the ground; the energy goes up and down."""
    result = SCHEME.run(bars(formulation, joint)[0], duration=0.1, step=1e-3, save_every=5)
    assert result.angular_momentum_error <= 1e-12
    assert result.joint_violations.max() <= 1e-13
    assert result.elastic.max() > 1e-3 * result.kinetic[0]
    assert 1e-9 <= result.energy_error <= 1e-2


@pytest.mark.parametrize("name", SHELLS)
def test_momenta_of_shells(name):
    """Of directors, half a rotation is half the way along the sphere."""
    result = SCHEME.run(plate(name)[0], duration=0.02, step=1e-3, save_every=5)
    assert result.momentum_error <= 1e-12
    assert result.angular_momentum_error <= 1e-12


def spinning() -> fl.Scene:
    """A free rigid body."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, (0.1, 0.2, 0.25), position=(1, 0, 0)))
    body.velocities[:] = [[1, 2, 3, 2, 0.1, 3]]
    return scene


def test_a_free_body_keeps_energy_too():
    """Two quadratic invariants, as Moser and Veselov have it."""
    result = SCHEME.run(spinning(), duration=10.0, step=1e-2, save_every=10)
    assert result.energy_error <= 1e-13
    assert result.momentum_error <= 1e-13
    assert result.angular_momentum_error <= 1e-13


def test_energy_does_not_drift():
    """Of a swinging double pendulum, over some 50 periods."""
    plan = {"duration": 40.0, "step": 5e-3, "save_every": 10, "record": fl.schemes.Record.ENERGIES}
    result = SCHEME.run(rigid_pendulum(), **plan)
    energy = result.total_energy
    swing = np.ptp(energy)
    slope, _ = np.polyfit(result.times, energy, 1)
    assert abs(slope) * result.times[-1] <= 0.2 * swing
    halves = np.split(energy[: len(energy) // 2 * 2], 2)
    # the motion is chaotic: round-off decides how large the oscillations of either half are
    assert np.ptp(halves[1]) <= 2.0 * np.ptp(halves[0])
    assert swing <= 0.1 * np.ptp(result.kinetic)


CASES = {
    "rigid": (spinning, 0.5, 50, ("frames", "velocities")),
    "beam": (flying, 0.01, 40, ("frames", "velocities")),
    "joints": (rigid_pendulum, 0.4, 80, ("frames", "velocities", "joint_forces")),
    "loads and drives": (driven, 0.1, 100, ("frames", "reactions")),
}


@pytest.mark.parametrize("case", CASES)
def test_second_order(case):
    """Against the composed scheme, which is of fourth order."""
    scene, duration, steps, names = CASES[case]
    plan = {"duration": duration, "save_every": 10**6}
    exact = fl.schemes.Composed().run(scene(), step=duration / steps, **plan)
    errors = []
    for parts in (2, 4):
        result = SCHEME.run(scene(), step=duration / steps / parts, **plan)
        errors.append(
            [np.abs(getattr(result, name)[-1] - getattr(exact, name)[-1]).max() for name in names]
        )
    np.testing.assert_allclose(np.log2(np.divide(*errors)), 2.0, atol=0.1)


def damped() -> fl.Scene:
    """A body on a spring with a damper, pushed by a force that follows it."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    arm = scene.add(fl.RigidBody(1.0, (2e-3, 5e-3, 6e-3), position=(0.2, 0, 0)))
    hinge = scene.add(
        fl.joints.Revolute(fl.ground(), arm.point("centre"), at=(0, 0, 0), axis=(0, 1, 0))
    )
    scene.add(fl.joints.Spring(hinge.angle, stiffness=20.0, damping=0.2))
    scene.add(fl.PointLoad(arm.point("centre"), force=(0, 0, 3.0), following=True))
    return scene


def test_dissipation_and_following_loads():
    """Lagrange-d'Alembert: second order, and dissipation is accounted for to second order."""
    plan = {"duration": 0.4, "save_every": 10**6}
    exact = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12).run(damped(), step=5e-5, **plan)
    runs = [SCHEME.run(damped(), step=h, **plan) for h in (4e-3, 2e-3)]
    errors = [np.abs(run.frames[-1] - exact.frames[-1]).max() for run in runs]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)
    lost = [run.balance[-1, 1] for run in (*runs, exact)]
    assert lost[2] > 1e-2
    assert abs(lost[1] - lost[2]) <= 0.3 * abs(lost[0] - lost[2])
    assert runs[1].balance_error <= 0.3 * runs[0].balance_error


def test_the_matrix_is_kept():
    scene = flying()
    kept = SCHEME.run(scene, duration=0.02, step=2e-4)
    assert kept.factorisations <= 3
    every = fl.schemes.Variational(policy=fl.schemes.EveryIteration()).run(
        flying(), duration=0.02, step=2e-4
    )
    assert every.factorisations >= 100
    np.testing.assert_allclose(kept.frames[-1], every.frames[-1], atol=1e-12)


VECTORS = (
    "Hermite cable",
    "discrete cable",
    "spline cable",
    "net",
    "ANCF beam",
    "thin shell",
    "ANCF shell",
    "solid, hexahedra 1",
    "solid, tetrahedra 2",
)
_POSITIONS_ALONE = ("discrete cable", "net")
ON_ATTACHMENTS = [(name, "Spherical") for name in VECTORS if name not in _POSITIONS_ALONE] + [
    ("net", "Distance, spring"),
    ("Hermite cable", "Distance, spring"),
    ("ANCF beam", "Revolute"),
    ("thin shell", "Revolute, damper"),
    ("solid, hexahedra 1", "Fixed"),
    ("solid, hexahedra 1", "Revolute, drive"),
    ("beam, geodesic", "Sliding"),
    ("beam, geodesic", "Collar"),
]


@pytest.mark.parametrize("name", VECTORS)
def test_momenta_of_vector_coordinates(name):
    """Momenta are exact; the energy balance is of second order."""
    runs = [
        SCHEME.run(build(free(name)).scene, duration=4e-3, step=2e-4 / parts, save_every=10**6)
        for parts in (1, 2)
    ]
    for result in runs:
        assert result.momentum_error <= 1e-13
        assert result.angular_momentum_error <= 1e-13
    assert 0.0 < runs[1].balance_error <= 0.6 * runs[0].balance_error


@pytest.mark.parametrize(("name", "joint"), ON_ATTACHMENTS)
def test_joints_on_attachment_frames(name, joint):
    """They stay closed, keep angular momentum, and converge with second order."""
    data = joined(name, joint)
    runs = [
        SCHEME.run(build(data).scene, duration=4e-4, step=2e-5 / parts, save_every=10**6)
        for parts in (1, 2, 4)
    ]
    for result in runs:
        assert result.joint_violations.max() <= 1e-12
    far, near = (np.abs(a.velocities[-1] - b.velocities[-1]).max() for a, b in pairwise(runs))
    assert np.log2(far / near) == pytest.approx(2.0, abs=0.2)
    assert runs[2].balance_error <= 0.3 * runs[1].balance_error


@pytest.mark.parametrize("damping", [0.0, 0.3])
def test_the_compiled_loop_counts_turns_and_dampers_act_in_it(damping):
    """A flywheel on a spring and a damper turns five times between two recorded states."""
    scene = fl.Scene()
    wheel = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.2)))
    hinge = fl.joints.Revolute(fl.ground(), wheel.point("centre"), axis=(0, 0, 1))
    scene.add(hinge)
    scene.add(fl.joints.Spring(hinge.angle, 0.05, damping=damping, rest=1.0))
    wheel.add_velocity(omega=(0, 0, 40.0), about=wheel.point("centre"))
    run = {"duration": 1.2, "step": 1e-3, "save_every": 600}
    result = fl.schemes.Variational().run(scene, **run)
    decay, t = 0.5 * damping / 0.2, result.times
    frequency = np.sqrt(0.05 / 0.2 - decay**2 + 0j)
    sine = np.where(t > 0.0, (np.sin(frequency * t) / frequency).real, 0.0)
    cosine = np.cos(frequency * t).real
    angle = 1.0 + np.exp(-decay * t) * (-cosine + (40.0 - decay) * sine)
    assert angle[1] > 10.0
    # the Cayley map of a step rotates by θ³/6 too much
    np.testing.assert_allclose(result.coordinate(hinge), angle, rtol=5e-4)


def test_a_discrete_rod_that_turns_over():
    """The directions from which edges are turned follow them, through more than half a turn."""
    section = fl.Section.rectangle(0.05, 0.04, fl.Material(4e7, 0.3, 1000.0))
    ends = []
    for scheme in (SCHEME, fl.GeneralisedAlpha()):
        scene = fl.Scene()
        line = fl.mesh.curve(lambda s: (s, 0.1 * np.sin(3 * s), 0), 4)
        rod = fl.Rod(line, section, up=(0, 0, 1), formulation=fl.elements.DiscreteRod())
        scene.add(rod).add_velocity(omega=(0.5, 2.0, 12.0), about=(0.5, 0, 0))
        ends.append(scheme.run(scene, duration=0.4, step=1e-3, save_every=100))
    here, there = ends
    np.testing.assert_allclose(here.frames[-1][:, 0], there.frames[-1][:, 0], atol=3e-4)
    np.testing.assert_allclose(
        here.angular_momentum[-1], there.angular_momentum[-1], rtol=0, atol=1e-3
    )


@pytest.mark.parametrize("name", ["Hermite cable", "thin shell"])
def test_vector_coordinates_resumed_to_the_last_bit(tmp_path, name):
    plan = {"duration": 3e-3, "step": 1e-4, "save_every": 3}

    def scene():
        return build(joined(name, "Revolute")).scene

    resumed_as_whole(SCHEME, scene, plan, tmp_path / "run.h5")


@pytest.mark.parametrize("scene", [lambda: bars()[0], driven], ids=["free", "driven"])
def test_resumed_to_the_last_bit(tmp_path, scene):
    plan = {"duration": 0.03, "step": 1e-3, "save_every": 3}
    resumed_as_whole(SCHEME, scene, plan, tmp_path / "run.h5")


# --- bad input ---


def test_options():
    with pytest.raises(ValueError, match=r"expected tolerance ≥ 0, got -1\.0"):
        fl.schemes.Variational(tolerance=-1.0)
    with pytest.raises(TypeError, match="policy"):
        fl.schemes.Variational(policy="never")


def test_steps_that_change():
    with pytest.raises(ValueError, match=r"constant steps.* got AdaptiveStep"):
        SCHEME.run(flying(), duration=0.1, step=fl.schemes.AdaptiveStep(1e-4))


def test_jumps():
    scene, one, _ = bars()
    late = fl.loads.PiecewiseSmooth(lambda t: float(t > 0.05), (0.05,))
    scene.add(fl.PointLoad(one.point("end"), force=(0, 0, 1), history=late))
    with pytest.raises(ValueError, match=r"discontinuities at the times \[0.05\]"):
        SCHEME.run(scene, duration=0.1, step=1e-2)


def test_what_it_does_not_support():
    scene = build(joined("rigid body", "KnifeEdge")).scene
    with pytest.raises(ValueError, match=r"velocity constraints .* use GeneralisedAlpha"):
        SCHEME.run(scene, duration=0.1, step=1e-2)


def test_a_step_that_fails():
    scheme = fl.schemes.Variational(max_iterations=2, policy=fl.schemes.FactoriseOnce())
    with pytest.raises(fl.ConvergenceError, match=r"step 1 of 10 .* 2 iterations"):
        scheme.run(bars()[0], duration=0.1, step=1e-2)


def test_the_compiled_loop_rescues_a_step():
    """Steps that frozen matrices do not solve are solved with new ones; without these it fails."""
    plan = {"duration": 0.3, "step": 1e-2}
    result = fl.schemes.Variational(max_iterations=12).run(rigid_pendulum(), **plan)
    assert result.joint_violations.max() <= 1e-12
    with pytest.raises(fl.ConvergenceError, match="did not converge in 5 iterations"):
        fl.schemes.Variational(max_iterations=5, policy=fl.schemes.FactoriseOnce()).run(
            rigid_pendulum(), **plan
        )


@pytest.mark.parametrize("omega", [(0, 0, 12.0), (0, 2.0, 12.0)], ids=["planar", "tumbling"])
def test_the_matrix_of_a_beam_that_rotates_is_kept(omega):
    """A slender free beam: along axes of the midpoint one matrix serves for many steps.

    It rotates by 0.7° in a step, and by more than a quarter of a revolution in the run.
    """

    def run(**options):
        section = fl.Section.rectangle(0.02, 0.03, fl.Material(2.1e11, 0.3, 7850.0))
        scene = fl.Scene()
        beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=10))
        beam.add_velocity(omega=omega, about=(0.3, 0, 0))
        return fl.schemes.Variational(**options).run(scene, duration=0.15, step=1e-3)

    kept, exact = run(), run(policy=fl.schemes.EveryIteration())
    assert kept.factorisations <= 5
    assert exact.total_iterations < 6 * 150
    np.testing.assert_allclose(kept.frames[-1], exact.frames[-1], atol=1e-10)


@pytest.mark.parametrize(("product", "grows"), [(3.9, False), (4.5, True)])
def test_the_limit_of_stability_of_vibrations_of_what_rotates(product, grows):
    """A mass on a stiff spring that rotates by θ in a step is stable for h ω θ < 4."""
    theta, steps = 0.1, 200
    stiffness, mean = (product / theta) ** 2, np.cos(0.5 * theta)
    scene = fl.Scene()
    mass = scene.add(fl.RigidBody(1.0, (1e-3, 1e-3, 1e-3), (1, 0, 0)))
    centre = mass.point("centre")
    mass.add_velocity((0, np.sin(theta), 0))
    distance = fl.joints.Distance(fl.ground(), centre, at=(0, 0, 0))
    scene.add(distance)
    rest = mean - 2.0 * (1.0 - np.cos(theta)) / mean / stiffness
    scene.add(fl.joints.Spring(distance.length, stiffness, rest=rest))
    result = fl.schemes.Variational().run(scene, duration=steps, step=1.0)
    away = np.abs(np.linalg.norm(result.position(centre), axis=1) - 1.0)
    ratio = away[-20:].max() / away[:20].max()
    assert (ratio > 30.0) == grows and (ratio < 2.0) != grows


@pytest.mark.parametrize("kind", ["cable", "spline cable"])
def test_a_cable_that_rotates_keeps_its_matrix_and_momenta(kind):
    """Axes of position gradients rotate with them in the compiled loop, too: few matrices serve."""
    section = fl.Section.circle(0.02, fl.Material(1e6, 0.3, 1000.0))
    if kind == "cable":
        body = fl.Cable.straight((0, 0, 0), (1, 0, 0), section, cells=4)
    else:
        body = fl.SplineCable.circle((0, 0, 0), 1.0, (0, 0, 1), section, cells=8)
    scene = fl.Scene()
    scene.add(body)
    body.add_velocity((0.5, 0.2, 0.1), omega=(0, 0, 2.0), about=(0.5, 0, 0))
    result = fl.schemes.Variational().run(scene, duration=0.3, step=1e-3, progress=False)
    assert result.total_iterations < 4 * 300 and result.factorisations <= 6
    change = np.abs(result.angular_momentum - result.angular_momentum[0]).max()
    assert change < 1e-13 * np.linalg.norm(result.angular_momentum[0])


@pytest.mark.parametrize("degrees", [2.0, 4.0])
def test_spinning_beams_are_stretched_by_mean_positions(degrees, caplog):
    """Its mean length is that under centrifugal forces, longer by θ²/8: the log says so."""
    step, material = 1e-3, fl.Material(E=2e9, nu=0.3, density=1000.0)
    section = fl.Section.rectangle(0.02, 0.02, material)
    beam = fl.Beam.straight((-0.5, 0, 0), (0.5, 0, 0), section, cells=2, name="beam")
    scene = fl.Scene()
    scene.add(beam)
    θ = np.deg2rad(degrees)
    beam.add_velocity(omega=(0, 0, θ / step), about=(0, 0, 0))
    result = fl.schemes.Variational().run(scene, duration=0.4, step=step, progress=False)
    ends = result.position("beam.end") - result.position("beam.start")
    strain = np.linalg.norm(ends, axis=1).mean() - 1.0
    centrifugal = 1000.0 / 2e9 * (θ / step) ** 2 / 12
    assert strain == pytest.approx(centrifugal + θ**2 / 8, rel=0.01)
    assert sum("stretched by up to" in message for message in caplog.messages) == 1
