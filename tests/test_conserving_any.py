"""The energy-momentum scheme on nodes that are no frames: rods, nets, thin shells, solids."""

from collections.abc import Callable

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.conserving_any import JOINED, FixedAxes
from benchmarks.conserving_any import SCENES as TURNING
from tests.test_composed import resumed_as_whole

SCHEME = fl.EnergyMomentum()
SECTION = fl.Section.from_stiffness([200.0] * 3 + [0.02] * 3, mass=1.0)
BAR = fl.Section.rectangle(0.1, 0.1, fl.Material(2e3, 0.3, 20.0))
CURVE = np.array([(0, 0, 0), (0.3, 0.05, 0), (0.6, 0, 0.05), (1, 0, 0)])


def flung(body: fl.extend.Body, spin=(0.3, 2.0, 3.0)) -> fl.extend.Body:
    """Flying, turning, and deforming as it does."""
    body.add_velocity(omega=spin, about=(0.4, 0.1, 0.0))
    x = body.frames[:, 0]
    # waves that steps resolve, along all axes of the nodes
    waves = 0.5 * np.sin(2.0 * x[:, [1, 0, 0]] + [0.1, 0.4, 1.0])
    body.velocities[:, :3] += (
        waves * fl.extend.node_types.has_position(body.model.node_types)[:, np.newaxis]
    )
    body.velocities[fl.extend.node_types.has_position(body.model.node_types), 0] += 1.0
    return body


def line(formulation: object, cells: int = 5) -> fl.extend.Body:
    return fl.Cable(
        fl.mesh.straight_line((0, 0, 0), (1, 0, 0), cells), SECTION, formulation=formulation
    )


def net() -> fl.extend.Body:
    x, y = np.meshgrid(np.linspace(0, 1, 4), np.linspace(0, 1, 4), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), 0.05 * np.sin(3 * x * y).ravel()], axis=1)
    grid = np.arange(16).reshape(4, 4)
    return fl.Net(points, [*grid.tolist(), *grid.T.tolist()], SECTION)


def sheet() -> fl.extend.Body:
    patch = fl.mesh.smooth_patch(lambda a, b: np.array([a, 0.5 * b, 0.1 * np.sin(2 * a)]), (3, 2))
    layer = fl.ShellSection.layer(0.02, fl.Material(5e2, 0.3, 1.0))
    return fl.ThinShell(patch, layer)


def brick(
    material: fl.sections.SolidMaterial, cell: str = "hexahedron", degree: int = 1
) -> fl.extend.Body:
    return fl.Solid.brick((1.0, 0.4, 0.2), material, cells=(3, 1, 1), cell=cell, degree=degree)


SAINT_VENANT = fl.sections.SaintVenantKirchhoff(2e3, 0.3, 1.0)

BODIES: dict[str, Callable[[], fl.extend.Body]] = {
    "cable": lambda: line(fl.elements.HermiteCable()),
    "spline cable": lambda: fl.SplineCable.through(CURVE, SECTION),
    "beam of slopes": lambda: fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), BAR, cells=3),
    "discrete cable": lambda: line(fl.elements.DiscreteCable()),
    "net": net,
    "thin shell": sheet,
    "hexahedra": lambda: brick(SAINT_VENANT),
    "hexahedra of degree 2": lambda: brick(SAINT_VENANT, degree=2),
    "tetrahedra": lambda: brick(SAINT_VENANT, "tetrahedron"),
    "neo-Hooke": lambda: brick(fl.sections.NeoHooke(2e3, 0.3, 1.0)),
}
"""A new body or element is tested by adding it here."""


def flying(name: str) -> tuple[fl.Scene, fl.extend.Body]:
    scene = fl.Scene()
    return scene, scene.add(flung(BODIES[name]()))


@pytest.mark.parametrize("name", BODIES)
def test_energy_and_momenta(name):
    """Over hundreds of steps, of which each turns the body far."""
    scene, _ = flying(name)
    result = SCHEME.run(scene, duration=1.0, step=4e-3, save_every=10)
    assert result.energy_error <= 1e-11
    assert result.momentum_error <= 1e-13
    assert result.angular_momentum_error <= 1e-13
    # it does deform, and go far
    assert np.ptp(result.elastic) > 1e-4 * result.kinetic[0]


@pytest.mark.parametrize("name", BODIES)
def test_second_order_against_generalised_alpha(name):
    plan = {"duration": 0.04, "save_every": 10**6}
    exact = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12).run(
        flying(name)[0], step=2.5e-5, **plan
    )
    errors = []
    for step in (4e-4, 2e-4):
        result = SCHEME.run(flying(name)[0], step=step, **plan)
        errors.append(np.abs(result.frames[-1, :, 0] - exact.frames[-1, :, 0]).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)


@pytest.mark.parametrize("name", BODIES)
def test_damping_of_mass_takes_what_it_says(name):
    """Energy falls by the loss alone, momentum as that of a point under the trapezoidal rule."""
    rate, step, steps = 0.8, 4e-3, 60
    body = flung(BODIES[name]())
    body.model.damping = fl.sections.Damping(mass=rate)
    scene = fl.Scene()
    scene.add(body)
    result = SCHEME.run(scene, duration=steps * step, step=step)
    total, lost = result.kinetic + result.elastic, result.balance[:, 1]
    assert np.abs(total + lost - total[0]).max() <= 1e-12 * total[0]
    assert (np.diff(lost) > 0.0).all()
    assert lost[-1] > 0.1 * total[0]
    assert max(result.balance_error, result.momentum_error) <= 1e-12
    assert result.angular_momentum_error <= 1e-12
    kept = ((1.0 - 0.5 * rate * step) / (1.0 + 0.5 * rate * step)) ** np.arange(steps + 1)
    error = np.abs(result.momentum - kept[:, np.newaxis] * result.momentum[0])
    assert error.max() <= 1e-12 * np.abs(result.momentum[0]).max()


@pytest.mark.parametrize("name", ["cable", "spline cable"])
def test_damping_of_strain_takes_what_it_says(name):
    """Energy falls by the loss alone, which is never negative; momenta stay."""
    body = flung(BODIES[name]())
    body.model.damping = fl.sections.Damping(stiffness=2e-3)
    scene = fl.Scene()
    scene.add(body)
    result = SCHEME.run(scene, duration=0.24, step=4e-3)
    total, lost = result.kinetic + result.elastic, result.balance[:, 1]
    assert np.abs(total + lost - total[0]).max() <= 1e-12 * total[0]
    assert (np.diff(lost) > 0.0).all()
    assert lost[-1] > 1e-3 * total[0]
    assert max(result.momentum_error, result.angular_momentum_error) <= 1e-12
    assert np.abs(result.momentum - result.momentum[0]).max() <= 1e-12


def test_damping_of_strain_is_that_of_generalised_alpha():
    def run(scheme: fl.EnergyMomentum | fl.GeneralisedAlpha, step: float) -> fl.Result:
        body = flung(BODIES["cable"]())
        body.model.damping = fl.sections.Damping(stiffness=2e-3)
        scene = fl.Scene()
        scene.add(body)
        return scheme.run(scene, duration=0.04, step=step, save_every=10**6)

    exact = run(fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12), 5e-5)
    found = [run(SCHEME, step) for step in (1e-3, 5e-4)]
    errors = [np.abs(r.frames[-1, :, 0] - exact.frames[-1, :, 0]).max() for r in found]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)
    assert found[-1].balance[-1, 1] == pytest.approx(exact.balance[-1, 1], rel=5e-3)


def swinging() -> fl.Scene:
    """A cable on a pin in gravity, drawn by a force that comes and goes."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    cable = scene.add(line(fl.elements.HermiteCable()))
    cable.pin(cable.point("start"))
    scene.add(fl.LineLoad(cable, (0, 0.5, 0), history=lambda t: np.sin(9.0 * t)))
    return scene


def clamped() -> fl.Scene:
    """A discrete cable whose end keeps its direction."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    cable = scene.add(line(fl.elements.DiscreteCable()))
    cable.clamp(cable.point("start"))
    return scene


def standing() -> fl.Scene:
    """A brick on its foot."""
    scene = fl.Scene(gravity=(0, 3.0, -9.81))
    body = scene.add(brick(SAINT_VENANT))
    body.clamp("a=0")
    return scene


SUPPORTED = {"swinging": swinging, "clamped": clamped, "standing": standing}


@pytest.mark.parametrize("name", SUPPORTED)
def test_loads_and_supports(name):
    """Work of what changes in time and impulses of supports are accounted for to round-off."""
    result = SCHEME.run(SUPPORTED[name](), duration=0.6, step=2e-3, save_every=10)
    assert result.balance_error <= 1e-11
    assert np.ptp(result.kinetic) > 1e-3
    assert result.momentum_error <= 1e-12
    if name != "clamped":  # whose moment no node takes
        assert result.angular_momentum_error <= 1e-12


def test_reactions_are_those_of_generalised_alpha():
    plan = {"duration": 0.2, "save_every": 20}
    found, other = (s.run(swinging(), step=5e-4, **plan) for s in (SCHEME, fl.GeneralisedAlpha()))
    size = np.abs(other.reactions).max()
    np.testing.assert_allclose(found.reactions[1:], other.reactions[1:], atol=0.02 * size)


@pytest.mark.parametrize("name", JOINED)
def test_joints(name):
    """Energy, work, momenta and constraints to round-off, and the motion of generalised-α."""
    made, step = JOINED[name]
    plan = {"duration": 0.1, "step": 2.0 * step, "save_every": 10}
    found, other = (
        s.run(made(), **plan) for s in (SCHEME, fl.GeneralisedAlpha(radius=0.95, tolerance=1e-9))
    )
    assert found.balance_error <= 1e-11
    assert found.momentum_error <= 1e-12
    assert found.angular_momentum_error <= 1e-12
    assert found.joint_violations.max() <= 1e-13
    away = np.abs(found.frames[:, :, 0] - other.frames[:, :, 0]).max()
    assert away <= 2e-3 * np.abs(other.frames[-1, :, 0] - other.frames[0, :, 0]).max()
    np.testing.assert_allclose(found.joint_coordinates, other.joint_coordinates, rtol=0, atol=1e-3)
    np.testing.assert_allclose(found.balance, other.balance, rtol=0, atol=2e-3)


def test_joint_forces_and_order():
    """Against generalised-α with small steps: of second order, joint forces at ends of steps."""
    made, _ = JOINED["two bricks, motor, damper"]
    plan = {"duration": 0.1, "save_every": 10**6}
    scheme = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12)
    exact = scheme.run(made(), step=1e-4, **plan)
    errors, forces = [], np.abs(exact.joint_forces[-1]).max()
    for step in (2e-3, 1e-3):
        result = SCHEME.run(made(), step=step, **plan)
        errors.append(np.abs(result.frames[-1, :, 0] - exact.frames[-1, :, 0]).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)
    np.testing.assert_allclose(
        result.joint_forces[-1], exact.joint_forces[-1], rtol=0, atol=0.02 * forces
    )


def test_joints_resumed_to_the_last_bit(tmp_path):
    made, step = JOINED["two bricks, motor, damper"]
    plan = {"duration": 16 * step, "step": step}
    resumed_as_whole(SCHEME, made, plan, tmp_path / "run.h5")


@pytest.mark.parametrize("scheme", [SCHEME, fl.EnergyDecaying()], ids=["conserving", "decaying"])
def test_resumed_to_the_last_bit(scheme, tmp_path):
    plan = {"duration": 0.12, "step": 4e-3}
    resumed_as_whole(scheme, lambda: flying("cable")[0], plan, tmp_path / "run.h5")


@pytest.mark.parametrize("name", BODIES)
def test_decaying(name):
    """Energy rises in no step, falls by the accounted dissipation alone, and momenta stay."""
    result = fl.EnergyDecaying(radius=0.5).run(flying(name)[0], duration=0.24, step=4e-3)
    total = result.kinetic + result.elastic
    assert np.diff(total).max() <= 1e-12 * total[0]
    assert result.balance[-1, 2] > 1e-6 * total[0]
    assert max(result.balance_error, result.momentum_error) <= 1e-12
    assert result.angular_momentum_error <= 1e-12


def test_order_of_decaying():
    plan = {"duration": 0.02, "save_every": 10**6}
    exact = SCHEME.run(flying("cable")[0], step=5e-5, **plan)
    errors = []
    for step in (4e-4, 2e-4):
        result = fl.EnergyDecaying(radius=0.8).run(flying("cable")[0], step=step, **plan)
        errors.append(np.abs(result.frames[-1, :, 0] - exact.frames[-1, :, 0]).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_waves_that_no_step_resolves_fall_by_the_radius(radius):
    """A stretched stiff cable of one element: two-step method at infinite frequency."""
    stiff = fl.Section.from_stiffness([1e9] * 3 + [1e-3] * 3, mass=1.0)
    cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), stiff, cells=1)
    cable.velocities[1, 0] = 1e-3
    scene = fl.Scene()
    scene.add(cable)
    result = fl.EnergyDecaying(radius=radius).run(scene, duration=0.4, step=0.01)
    free = 0.5 * (result.momentum[0] ** 2).sum()
    waves = result.kinetic + result.elastic - free
    steps = 20
    assert waves[steps] <= 2.0 * steps**2 * max(radius, 0.1) ** (2 * (steps - 2)) * waves[0]


def test_steps_without_a_solution_are_made_in_parts(caplog):
    """Each of which conserves, and the cable goes where small steps take it."""
    result = SCHEME.run(flying("cable")[0], duration=1.2, step=0.1)
    assert result.divided >= 1
    assert "were divided into up to" in caplog.text
    assert result.energy_error <= 1e-11
    assert max(result.momentum_error, result.angular_momentum_error) <= 1e-11
    small = SCHEME.run(flying("cable")[0], duration=1.2, step=4e-3, save_every=300)
    middle = [each.frames[-1, :, 0].mean(axis=0) for each in (result, small)]
    np.testing.assert_allclose(*middle, rtol=0, atol=0.05)


@pytest.mark.parametrize("name", TURNING)
def test_velocities_of_all_nodes_are_those_of_generalised_alpha(name):
    """Of both coordinate vectors, of which rows of results once had a mean spin."""
    made, step = TURNING[name]
    plan = {"duration": 0.1 * step, "step": 0.01 * step}
    exact = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12).run(made(), **plan)
    found = SCHEME.run(made(), **plan)
    for half in (slice(0, 3), slice(3, 6)):
        one, two = (result.velocities[-1, :, half] for result in (found, exact))
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-3 * np.abs(two).max(initial=1e-3))


def with_a_hinge(scene: fl.Scene, cable: fl.extend.Body) -> None:
    scene.add(fl.joints.Revolute(fl.ground(), cable.point("start"), axis=(1, 0, 0)))


def with_a_lever(scene: fl.Scene, cable: fl.extend.Body) -> None:
    scene.add(fl.joints.Spherical(fl.ground(), cable.point("start"), at=(0, 0, 1)))


SCENES = {
    "rotation of a cable's end": with_a_hinge,
    "away from": with_a_lever,
}


@pytest.mark.parametrize("words", SCENES)
def test_refused_scenes(words):
    scene, cable = flying("cable")
    SCENES[words](scene, cable)
    with pytest.raises(ValueError, match=words):
        SCHEME.run(scene, duration=0.1, step=0.01)


def test_matrices_are_not_made_for_the_last_digits():
    """Steps that converge, if slowly, keep their matrix; a policy that counts is obeyed."""
    rope = fl.Section.from_stiffness([2e3] * 3 + [0.2] * 3, mass=1.0)

    def run(policy: fl.schemes.RefactorisationPolicy) -> fl.Result:
        scene = fl.Scene(gravity=(0, 0, -9.81))
        cable = scene.add(fl.Cable.straight((0, 0, 0), (1, 0, 0), rope, cells=8))
        cable.pin(cable.point("start"))
        return fl.EnergyMomentum(policy=policy).run(scene, duration=1.6, step=8e-3)

    kept, limited = run(fl.schemes.Automatic()), run(fl.schemes.IterationLimit(4))
    # with patience for eight iterations, whatever they achieve, it were 107
    assert kept.factorisations <= 30
    assert limited.factorisations >= 200
    assert max(kept.energy_error, limited.energy_error) <= 1e-11


@pytest.mark.parametrize("name", ["tumbling brick", "tumbling beam of slopes"])
def test_the_matrix_is_kept_along_own_axes(name):
    """The same motion along axes fixed in space takes at least five times as many."""
    plan = {"duration": 0.3, "step": 1e-3, "save_every": 100}
    own, fixed = (s.run(TURNING[name][0](), **plan) for s in (SCHEME, FixedAxes()))
    np.testing.assert_allclose(own.frames[:, :, 0], fixed.frames[:, :, 0], rtol=0, atol=1e-12)
    assert fixed.factorisations >= 5 * own.factorisations
