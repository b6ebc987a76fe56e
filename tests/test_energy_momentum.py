"""Energy-momentum and energy-decaying schemes: invariants, orders, balances, interruption."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import ufl

import fem_lie as fl

ROOT = Path(__file__).parents[1]
SOFT = fl.Material(E=2e7, nu=0.3, density=1200.0)
SQUARE = fl.Section.rectangle(0.02, 0.02, SOFT)

BEAMS = {
    "geodesic": fl.elements.GeodesicBeam(),
    "geodesic without flexibility": fl.elements.GeodesicBeam(bending_flexibility=False),
    "director 1": fl.elements.DirectorBeam(1),
    "director 2": fl.elements.DirectorBeam(2),
    "Kirchhoff": fl.elements.KirchhoffRod(),
}
JOINTS = {
    "spherical": fl.joints.Spherical,
    "revolute": fl.joints.Revolute,
    "fixed": fl.joints.Fixed,
    "in plane": fl.joints.InPlane,
}
"""A new joint is tested by adding it here."""


def stiffening(strain):
    """A law that is no quadratic form."""
    return 40 * ufl.inner(strain, strain) + 4e4 * (strain[0] ** 2 + strain[3] ** 2) ** 2


SHELLS = {
    "MITC4": ("quadrilateral", 1, fl.elements.DisplacementBased()),
    "Hellinger-Reissner": ("quadrilateral", 1, fl.elements.HellingerReissner()),
    "Hu-Washizu": ("quadrilateral", 1, fl.elements.HuWashizu()),
    "MITC3+": ("triangle", 1, fl.elements.HellingerReissner()),
    "MITC6": ("triangle", 2, fl.elements.DisplacementBased()),
    "MITC9": ("quadrilateral", 2, fl.elements.DisplacementBased()),
    "decoupled bending": ("quadrilateral", 1, fl.elements.HellingerReissner(fl.elements.DECOUPLED)),
    "a law of one's own": ("quadrilateral", 1, fl.elements.DisplacementBased(law=stiffening)),
}
"""A new shell element is tested by adding it here."""


def named(scheme: fl.EnergyMomentum) -> str:
    return f"{type(scheme).__name__} {getattr(scheme, 'radius', '')}".strip()


def bars(
    formulation: fl.elements.BeamFormulation | None = None,
    joint: type[fl.joints.Joint] = fl.joints.Spherical,
    gravity=(0, 0, 0),
    cells: int = 3,
) -> tuple[fl.Scene, fl.Beam, fl.Beam]:
    """Two soft bars, hinged to the ground, that start as if they were one rigid body."""
    scene = fl.Scene(gravity=gravity)
    one = scene.add(
        fl.Beam.straight((0, 0, 0), (0.3, 0, 0), SQUARE, cells=cells, formulation=formulation)
    )
    two = scene.add(
        fl.Beam.straight((0.3, 0, 0), (0.3, 0.5, 0), SQUARE, cells=cells, formulation=formulation)
    )
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(joint(one.point("end"), two.point("start"), axis=(1, 0, 0.2)))
    for bar in (one, two):
        bar.add_velocity(omega=(3, 1, -8), about=(0, 0, 0))
    return scene, one, two


def plate(name: str, cells=(3, 2)) -> tuple[fl.Scene, fl.Shell]:
    """A soft plate that tumbles, bending as it does."""
    cell, degree, formulation = SHELLS[name]
    mesh = fl.mesh.parametric_surface(
        lambda a, b: np.array([0.3 * a, 0.2 * b, 0.02 * a * b]), cells, cell=cell, degree=degree
    )
    section = fl.ShellSection.layer(0.004, fl.Material(2e7, 0.3, 1200.0))
    scene = fl.Scene()
    shell = scene.add(fl.Shell(mesh, section, formulation=formulation))
    shell.add_velocity(omega=(5, 8, 3), about=(0.1, 0.1, 0.0))
    shell.add_velocity((0.3, -0.2, 0.1))
    # and bends: one half turns against the other
    turning = np.where(shell.frames[:, 0, 0] > 0.15, 4.0, -4.0)
    shell.velocities[:, 2] += turning * (shell.frames[:, 0, 0] - 0.15)
    return scene, shell


@pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS)
@pytest.mark.parametrize("formulation", BEAMS.values(), ids=BEAMS)
@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.EnergyDecaying(radius=0.6)], ids=named)
def test_beams_and_joints(formulation, joint, scheme):
    """Round-off of 100 steps is some 1e-14; bars bend by a tenth of their length meanwhile."""
    scene, one, two = bars(formulation, joint)
    result = scheme.run(scene, duration=0.2, step=2e-3)
    # with a filter the iteration comes to a standstill a little earlier
    bound = 1e-11 if isinstance(scheme, fl.EnergyDecaying) else 2e-12
    assert result.angular_momentum_error <= bound
    assert result.balance_error <= bound
    assert result.elastic.max() > 1e-3 * result.kinetic[0]
    if isinstance(scheme, fl.EnergyDecaying):
        assert np.diff(result.total_energy).max() <= 1e-13 * result.kinetic[0]
        assert result.balance[-1, 2] > 1e-6 * result.kinetic[0]
    else:
        assert result.energy_error <= bound
    gap = np.linalg.norm(result.position(one.point("start")), axis=1).max()
    if joint is not fl.joints.InPlane:
        apart = result.position(one.point("end")) - result.position(two.point("start"))
        gap = max(gap, np.linalg.norm(apart, axis=1).max())
    assert gap <= 1e-13


@pytest.mark.parametrize("name", SHELLS)
def test_shells_in_flight(name):
    """All seven invariants; the scheme knows nothing of the element but energy and forces."""
    scene, _ = plate(name)
    result = fl.EnergyMomentum().run(scene, duration=0.05, step=1e-3)
    assert result.energy_error <= 1e-11
    assert result.momentum_error <= 1e-12
    assert result.angular_momentum_error <= 1e-12
    assert result.elastic.max() > 1e-3 * result.kinetic[0]


def test_decaying_shell_in_flight():
    scene, _ = plate("Hellinger-Reissner")
    result = fl.EnergyDecaying(radius=0.5).run(scene, duration=0.05, step=1e-3)
    assert np.diff(result.total_energy).max() <= 1e-13 * result.kinetic[0]
    assert result.balance_error <= 1e-11
    assert result.momentum_error <= 1e-11
    assert result.angular_momentum_error <= 1e-11


def test_rigid_bodies_tumble_and_are_joined():
    """A body that spins about its middle axis, and one on a revolute joint at its edge."""
    scene = fl.Scene()
    first = scene.add(fl.RigidBody(2.0, (1.0, 2.0, 2.7)))
    second = scene.add(fl.RigidBody(1.0, (0.3, 0.4, 0.5), (0.5, 0.0, 0.0)))
    scene.add(
        fl.joints.Revolute(
            first.point("centre"), second.point("centre"), at=(0.3, 0.1, 0.0), axis=(0, 1, 0)
        )
    )
    for body in (first, second):
        body.add_velocity(omega=(0.01, 2.0, 0.02), about=(0, 0, 0))
        body.add_velocity((0.1, 0.2, -0.3))
    result = fl.EnergyMomentum().run(scene, duration=4.0, step=1e-2)
    assert result.energy_error <= 1e-12
    assert result.momentum_error <= 1e-12
    assert result.angular_momentum_error <= 1e-12


def test_linked_bodies_and_a_branching_beam():
    """Nodes that follow others, and a rigid body in the middle of a beam."""
    scene, _, two = bars()
    body = scene.add(fl.RigidBody(0.05, (1e-4, 1e-4, 1e-4), (0.35, 0.5, 0.0)))
    body.add_velocity(omega=(3, 1, -8), about=(0, 0, 0))
    scene.add(fl.joints.RigidLink(two.point("end"), body.point("centre")))
    result = fl.EnergyMomentum().run(scene, duration=0.2, step=2e-3)
    assert result.energy_error <= 2e-12
    assert result.angular_momentum_error <= 1e-12


def test_potential_of_gravity_counts():
    scene, _, _ = bars(gravity=(0, 0, -9.81))
    result = fl.EnergyMomentum().run(scene, duration=0.4, step=2e-3)
    assert np.ptp(result.potential) > 0.05 * result.kinetic[0]
    assert result.energy_error <= 1e-12


def ramp(time: float) -> float:
    return float(np.sin(20 * time))


def add_following(scene: fl.Scene, one: fl.Beam, two: fl.Beam) -> None:
    scene.add(
        fl.PointLoad(two.point("end"), force=(0, 0.3, 0.1), moment=(0, 0, 0.01), following=True)
    )


def add_moment(scene: fl.Scene, one: fl.Beam, two: fl.Beam) -> None:
    scene.add(fl.PointLoad(two.point("end"), moment=(0.02, 0, 0.01), history=ramp))


def add_history(scene: fl.Scene, one: fl.Beam, two: fl.Beam) -> None:
    scene.add(fl.LineLoad(two, force=(0, 0, 2.0), history=ramp))


def add_pressure(scene: fl.Scene, one: fl.Beam, two: fl.Beam) -> None:
    scene.add(fl.loads.PressureLoad(two, 2.0))


def add_strain(scene: fl.Scene, one: fl.Beam, two: fl.Beam) -> None:
    scene.add(fl.loads.Eigenstrain(two, (0, 0, 0, 0, 0.3, 0), history=ramp))


def add_drive(scene: fl.Scene, one: fl.Beam, two: fl.Beam) -> None:
    del scene.joints[0]  # the one with the ground
    for bar in (one, two):
        bar.velocities[:] = 0.0
    start = one.point("start").frame.copy()

    def shaken(time: float) -> np.ndarray:
        frame = start.copy()
        frame[0] += 0.03 * (1 - np.cos(8 * time)), 0.0, 0.1 * time**2
        return frame

    scene.add(fl.PrescribedMotion(one.point("start"), shaken))


LOADS = [add_following, add_moment, add_history, add_pressure, add_strain, add_drive]


@pytest.mark.parametrize("add", LOADS, ids=lambda add: add.__name__)
def test_work_of_loads_closes_the_balance(add):
    scene, one, two = bars(joint=fl.joints.Revolute)
    add(scene, one, two)
    result = fl.EnergyMomentum().run(scene, duration=0.2, step=2e-3)
    assert np.abs(result.balance[:, 0]).max() > 1e-4 * result.kinetic.max()
    assert result.balance_error <= 1e-11


def test_loss_by_damping_closes_the_balance():
    scene = fl.Scene()
    damping = fl.sections.Damping(mass=0.5, stiffness=1e-3)
    bar = scene.add(fl.Beam.straight((0, 0, 0), (0.5, 0, 0), SQUARE, cells=4, damping=damping))
    scene.add(fl.joints.Spherical(fl.ground(), bar.point("start")))
    bar.add_velocity(omega=(0, 3, 8), about=(0, 0, 0))
    bar.velocities[-1, 2] += 0.5
    result = fl.EnergyMomentum().run(scene, duration=0.2, step=2e-3)
    assert (np.diff(result.balance[:, 1]) > 0).all()
    assert result.balance_error <= 1e-11


@pytest.mark.parametrize(
    "scheme", [fl.EnergyMomentum(), fl.EnergyDecaying(radius=0.0), fl.EnergyDecaying()], ids=named
)
def test_order(scheme):
    """Against a run with steps that are much smaller; gravity swings the bars slowly."""

    def tip(step: float, scheme) -> np.ndarray:
        scene, one, two = bars(gravity=(0, 0, -9.81), joint=fl.joints.Revolute, cells=2)
        for bar in (one, two):
            bar.velocities[:] = 0.0
        result = scheme.run(scene, duration=0.2, step=step, save_every=10**6)
        return result.position(two.point("end"))[-1]

    coarse, fine = (tip(step, fl.EnergyMomentum()) for step in (2.5e-4, 1.25e-4))
    exact = (4 * fine - coarse) / 3
    errors = [np.linalg.norm(tip(step, scheme) - exact) for step in (2e-3, 1e-3, 5e-4)]
    assert np.log2(errors[1] / errors[2]) > 1.9, errors


@pytest.mark.parametrize("radius", [0.0, 0.5, 0.8, 0.95])
def test_spectral_radius_at_infinity(radius):
    """A single element as a spring whose period is a ten thousandth of the step."""
    scene = fl.Scene()
    bar = scene.add(fl.Beam.straight((0, 0, 0), (0.1, 0, 0), SQUARE, cells=1))
    scene.add(fl.Clamp(bar.point("start")))
    bar.velocities[1, 0] = 1e-3
    stiffness, mass = SQUARE.stiffness[0, 0] / 0.1, SQUARE.inertia[0, 0] * 0.1 / 3
    step = 1e4 / np.sqrt(stiffness / mass)
    # with radius 0 nothing but round-off is left after four steps
    steps = 4 if radius == 0.0 else 30
    result = fl.EnergyDecaying(radius=radius).run(scene, duration=steps * step, step=step)
    energy = result.total_energy
    assert (np.diff(energy) <= 1e-12 * energy[0]).all()
    if radius == 0.0:
        assert energy[4] < 1e-6 * energy[0]
    else:
        # two eigenvalues are close together: the decay is that of one but for a slow factor
        rate = (energy[25] / energy[15]) ** (1 / 20)
        assert rate == pytest.approx(radius, rel=0.06)


def test_decaying_damps_what_is_not_resolved_and_nothing_else():
    """Swinging goes on while the vibrations of stiff bars die."""
    stiff = fl.Section.rectangle(0.02, 0.02, fl.Material(E=2e11, nu=0.3, density=7800.0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    bar = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), stiff, cells=4))
    scene.add(fl.joints.Revolute(fl.ground(), bar.point("start"), axis=(0, 1, 0)))
    result = fl.EnergyDecaying(radius=0.8).run(scene, duration=1.0, step=5e-3)
    swing = np.ptp(result.potential)
    assert result.balance[-1, 2] <= 2e-3 * swing
    assert np.diff(result.total_energy).max() <= 1e-13 * swing


def test_every_policy_gives_the_same_motion():
    tips = []
    for policy in (
        fl.schemes.Automatic(),
        fl.schemes.EveryIteration(),
        fl.schemes.IterationLimit(5),
        Own(),
    ):
        scene, _, two = bars()
        result = fl.EnergyMomentum(policy=policy).run(scene, duration=0.05, step=1e-3)
        tips.append(result.position(two.point("end"))[-1])
        assert result.energy_error <= 1e-12
    np.testing.assert_allclose(tips, [tips[0]] * len(tips), atol=1e-12)


class Own(fl.schemes.RefactorisationPolicy):
    """A policy that cannot be a rule of a compiled loop."""

    def begin(self, bound: bool) -> fl.extend.PolicyState:
        return InTheThird()


class InTheThird(fl.extend.PolicyState):
    def before_iteration(self, iteration: int) -> bool:
        return iteration == 3


def test_tolerance_saves_iterations():
    exact, loose = (
        fl.EnergyMomentum(tolerance=tolerance).run(bars()[0], duration=0.1, step=1e-3)
        for tolerance in (0.0, 1e-7)
    )
    assert loose.iterations[-1] < 0.8 * exact.iterations[-1]
    assert loose.energy_error <= 1e-6


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.EnergyDecaying(radius=0.8)])
@pytest.mark.parametrize("beside_a_cable", [False, True])
@pytest.mark.parametrize("rotation", [np.radians(8.0), np.radians(18.0)])
def test_large_rotations_in_a_step_are_too_slow_and_logged(
    scheme, beside_a_cable, rotation, caplog
):
    """By the Cayley map: 2 atan(θ/2) for θ, 0.81 % of 18°; from 10° on the log says so."""
    top, step = fl.RigidBody(1.0, (0.1, 0.2, 0.3)), 1e-2
    top.add_velocity(omega=(0, 0, rotation / step), about=top.point("centre"))
    scene = fl.Scene()
    scene.add(top)
    if beside_a_cable:
        section = fl.Section.circle(0.01, fl.Material(1e9, 0.3, 1000.0))
        scene.add(fl.Cable.straight((0, 0, 5), (1, 0, 5), section, cells=2))
    with caplog.at_level("WARNING"):
        result = scheme.run(scene, duration=10 * step, step=step, progress=False)
    R = result.frames[:, 0, 1:]
    cosines = 0.5 * (np.einsum("kij,kij->k", R[:-1], R[1:]) - 1.0)
    wanted = 2.0 * np.arctan(0.5 * rotation)
    np.testing.assert_allclose(np.arccos(cosines), wanted, rtol=1e-8)
    messages = [m for m in caplog.messages if "turn by up to" in m]
    if rotation < np.radians(10.0):
        assert not messages
    else:
        assert messages == [m for m in messages if "18° in a step, and 0.81 % too slowly" in m]
        assert len(messages) == 1


@pytest.mark.parametrize(
    ("scheme", "made"),
    [
        (fl.schemes.Variational(), np.arcsin),
        (fl.Explicit(), np.arcsin),
        (fl.schemes.Asynchronous(), np.arcsin),
        (fl.schemes.Hamel(), lambda angle: 2.0 * np.arctan(0.5 * angle)),
    ],
)
def test_other_schemes_by_the_cayley_map_log_large_rotations(scheme, made, caplog):
    """By momenta asin θ for θ, 1.7 % of 18° too much; none of it is in the energy."""
    rotation, step = np.radians(18.0), 1e-2
    top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
    top.add_velocity(omega=(0, 0, rotation / step), about=top.point("centre"))
    scene = fl.Scene()
    scene.add(top)
    with caplog.at_level("WARNING"):
        result = scheme.run(scene, duration=10 * step, step=step, progress=False)
    R = result.frames[:, 0, 1:]
    cosines = 0.5 * (np.einsum("kij,kij->k", R[:-1], R[1:]) - 1.0)
    np.testing.assert_allclose(np.arccos(cosines), made(rotation), rtol=1e-8)
    way = "fast" if made(rotation) > rotation else "slowly"
    error = abs(made(rotation) / rotation - 1.0)
    expected = f"18° in a step, and {100.0 * error:.2g} % too {way}"
    assert len([m for m in caplog.messages if expected in m]) == 1


def test_bad_input():
    with pytest.raises(ValueError, match="tolerance ≥ 0"):
        fl.EnergyMomentum(tolerance=-1.0)
    with pytest.raises(ValueError, match=r"spectral radius must be in \[0, 1\], got 1.2"):
        fl.EnergyDecaying(radius=1.2)
    scene, _, _ = bars()
    with pytest.raises(ValueError, match="not a multiple"):
        fl.EnergyMomentum().run(scene, duration=1.0, step=0.3)
    with pytest.raises(ValueError, match="needs a file"):
        fl.EnergyMomentum().run(scene, duration=1.0, step=0.5, checkpoint_every=1)


def test_a_step_that_fails_says_so():
    scene, _, _ = bars()
    with pytest.raises(fl.ConvergenceError, match="step 1 of 10") as caught:
        fl.EnergyMomentum(max_iterations=1).run(scene, duration=0.01, step=1e-3)
    assert len(caught.value.result.times) == 1


# --- results as they are made, interruption ---

SCRIPT = """
import sys
from tests.test_energy_momentum import bars, SCHEMES
scheme, file, resume = SCHEMES[sys.argv[1]], sys.argv[2], sys.argv[3] == "resume"
scene = bars()[0]
if resume:
    scheme.resume(scene, file)
else:
    scheme.run(scene, duration=4.0, step=1e-3, save_every=7, file=file, checkpoint_every=50)
"""
SCHEMES = {
    "conserving": fl.EnergyMomentum(),
    "decaying": fl.EnergyDecaying(radius=0.7),
    "generalised alpha": fl.GeneralisedAlpha(radius=0.9),
}
ARRAYS = (
    "times",
    "frames",
    "velocities",
    "joint_forces",
    "kinetic",
    "elastic",
    "angular_momentum",
    "balance",
    "impulses",
    "iterations",
)


def same(a: fl.Result, b: fl.Result) -> None:
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)
    assert a.factorisations == b.factorisations


def written(file: Path) -> int:
    """Time at which a file was written last, 0 without it; another process may replace it."""
    try:
        return file.stat().st_mtime_ns
    except FileNotFoundError:
        return 0


def kill_after_a_checkpoint(file: Path, scheme: str, how: str, seconds: float) -> None:
    """Start a run, or go on with one, and kill it ``seconds`` after its next checkpoint."""
    beside = file.with_name(file.name + ".checkpoint")
    before = written(beside)
    process = subprocess.Popen([sys.executable, "-c", SCRIPT, scheme, str(file), how], cwd=ROOT)
    while not written(beside) > before:
        assert process.poll() is None, "the run ended before it could be killed"
        time.sleep(0.01)
    time.sleep(seconds)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()


@pytest.mark.parametrize("scheme", SCHEMES)
def test_killed_twice_and_resumed_is_the_same_to_the_last_bit(tmp_path, scheme):
    whole = SCHEMES[scheme].run(bars()[0], duration=4.0, step=1e-3, save_every=7)
    file = tmp_path / "run.h5"
    rng = np.random.default_rng()
    kill_after_a_checkpoint(file, scheme, "start", rng.uniform(0.0, 0.1))
    first = len(fl.Result.load(file).times)
    assert 1 <= first < len(whole.times)
    kill_after_a_checkpoint(file, scheme, "resume", rng.uniform(0.0, 0.1))
    resumed = SCHEMES[scheme].resume(bars()[0], file)
    same(resumed, whole)
    same(fl.Result.load(file), whole)


def test_results_in_a_file_are_the_same_and_cost_no_memory(tmp_path):
    kept = fl.EnergyMomentum().run(bars()[0], duration=0.1, step=1e-3, save_every=3)
    file = tmp_path / "run.h5"
    paged = fl.EnergyMomentum().run(
        bars()[0], duration=0.1, step=1e-3, save_every=3, file=file, checkpoint_every=10
    )
    same(paged, kept)
    assert isinstance(paged.frames, np.memmap)
    same(fl.Result.load(file), kept)
    assert fl.Result.load(file).factorisations == kept.factorisations
    with pytest.raises(ValueError, match="another scene"):
        fl.EnergyMomentum().resume(bars(joint=fl.joints.Revolute)[0], file)
    with pytest.raises(ValueError, match="other options"):
        fl.EnergyMomentum(max_iterations=7).resume(bars()[0], file)
    with pytest.raises(FileNotFoundError, match="no file"):
        fl.EnergyMomentum().resume(bars()[0], tmp_path / "other.h5")


def test_balance_is_saved_and_loaded(tmp_path):
    scene, one, two = bars()
    add_history(scene, one, two)
    result = fl.EnergyMomentum().run(scene, duration=0.01, step=1e-3)
    result.save(tmp_path / "saved.h5")
    same(fl.Result.load(tmp_path / "saved.h5"), result)
