"""The converter of units, and laws that hold in each system."""

from functools import cache, partial
from types import SimpleNamespace

import numpy as np
import pytest

import fem_lie as fl
from tests.closed_loop import closed_loop
from tests.unit_systems import METRES, MILLIMETRES, OTHER_SYSTEMS, UNIT_SYSTEMS, UnitSystem


def test_newtons_stay_newtons_in_millimetres_and_tonnes():
    assert MILLIMETRES.force(3.0) == pytest.approx(3.0)
    assert MILLIMETRES.stress(2e11) == pytest.approx(2e5)  # MPa
    assert MILLIMETRES.density(7800.0) == pytest.approx(7.8e-9)


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
def test_there_and_back(u):
    x = np.arange(1.0, 7.0)
    for name in ("length", "force", "moment", "twist", "wrench", "inertia", "bending", "damping"):
        there = getattr(u, name)
        back = getattr(u.inverse, name)
        np.testing.assert_allclose(back(there(x)), x, rtol=1e-14)
        assert not np.shares_memory(there(x), x)
    matrix = np.add.outer(x, x)
    stiff = u.section_stiffness(matrix)
    np.testing.assert_allclose(stiff[0, 0], u.force(matrix[0, 0]))
    np.testing.assert_allclose(stiff[0, 4], u.moment(matrix[0, 4]))
    np.testing.assert_allclose(stiff[4, 4], u.bending(matrix[4, 4]))
    assert METRES.time(2.0) == 2.0


MOTION = fl.extend.Method("lu", "umfpack"), fl.extend.Method("lu", "mumps")


def first_accelerations(u: UnitSystem, step: float) -> tuple[np.ndarray, np.ndarray]:
    """At the start of the closed loop; in metres, kilograms and seconds."""
    equations = fl.extend.Equations(closed_loop(u), dynamics=True)
    solver = fl.extend.DirectSolver(equations.matrix, "test_units_", MOTION)
    vdot, weights = fl.extend.accelerations(
        equations, solver, *equations.start[:2], 0.0, u.time(step)
    )
    vdot = np.concatenate([u.inverse.acceleration(vdot[:, :3]), u.inverse.of(vdot[:, 3:], time=-2)])
    wrench = np.where(equations.unknowns.angular, u.moment(1.0), u.force(1.0))
    return vdot, weights / wrench


@pytest.mark.parametrize("step", [1e-3, 1e-5])
@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_a_closed_loop_starts_alike(u, step):
    """Masses of 1e-18 beside constraints of one, by the solver that lost them."""
    found, expected = first_accelerations(u, step), first_accelerations(METRES, step)
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-9 * np.abs(b).max())


@cache
def swing(u: UnitSystem, drilling: bool | None) -> tuple[np.ndarray, int]:
    scene = closed_loop(u, drilling=drilling)
    result = fl.GeneralisedAlpha().run(scene, duration=u.time(0.02), step=u.time(2e-4))
    return u.inverse.frame(result.frames), result.factorisations


@pytest.mark.parametrize("drilling", [False, True])
@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_a_closed_loop_moves_alike(u, drilling):
    found, matrices = swing(u, drilling)
    expected, as_many = swing(METRES, drilling)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)
    assert matrices == as_many


class Careless:
    """A solver whose solutions have a relative error of their own."""

    def __init__(self, ksp, error: float) -> None:
        self._ksp, self._error = ksp, error

    def solve(self, b, x) -> None:
        self._ksp.solve(b, x)
        x.array[:] *= 1.0 + self._error * np.cos(np.arange(len(x.array)))

    def __getattr__(self, name: str):
        return getattr(self._ksp, name)


@pytest.mark.parametrize(
    ("error", "refined", "package"),
    [(0.0, False, "umfpack"), (1e-7, True, "umfpack"), (0.1, False, "mumps")],
)
def test_each_factorisation_is_checked_once(error, refined, package):
    """What is not accurate is refined once, or else solved by the next method."""
    equations = fl.extend.Equations(closed_loop(), dynamics=True)
    solver = fl.extend.DirectSolver(equations.matrix, "test_careless_", MOTION)
    state = equations, solver, *equations.start[:2], 0.0, 1e-3
    expected = fl.extend.accelerations(*state)[0]
    method = MOTION[0]
    solver._solvers[method] = Careless(solver._solver(method), error)
    found = fl.extend.accelerations(*state)[0]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
    assert solver._refines == refined
    assert solver._methods[0].package == package


def test_no_accurate_solver_is_an_error(monkeypatch):
    error = SimpleNamespace(of_terms=1.0, iterable=False)
    monkeypatch.setattr(fl.extend.DirectSolver, "_error", lambda solver: error)
    with pytest.raises(ValueError, match=r"residual is 1\.0e\+00 of its terms"):
        fl.GeneralisedAlpha().run(closed_loop(), duration=1e-3, step=1e-3)


def hinged(u: UnitSystem) -> tuple[fl.Scene, fl.RigidBody]:
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(u.mass(1.0), u.inertia([0.1, 0.1, 0.1]), u.length([0.5, 0, 0])))
    return scene, body


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
def test_what_does_not_start_as_it_must_is_refused(u):
    """A part of 1e-4 is wrong, whatever the unit of length."""
    scene, body = hinged(u)
    rod = fl.joints.Distance(fl.ground(), body.point("centre"), at=(0, 0, 0))
    with pytest.raises(ValueError, match="must start at"):
        scene.add(fl.joints.Drive(rod.length, lambda t: u.length(0.5 + 1e-4)))
    frame = body.point("centre").frame + np.eye(4, 3) * u.length(1e-4) * np.array(
        [[1.0], [0], [0], [0]]
    )
    with pytest.raises(ValueError, match="must start at its frame"):
        scene.add(fl.PrescribedMotion(body.point("centre"), lambda t: frame))
    scene.add(
        fl.joints.Revolute(
            fl.ground(), body.point("centre"), at=(0, 0, 0), axis=(0, 0, 1), name="hinge"
        )
    )
    body.add_velocity(u.velocity([1e-3, 1.0, 0]))
    with pytest.raises(ValueError, match="initial velocities break hinge"):
        fl.GeneralisedAlpha().run(scene, duration=u.time(0.1), step=u.time(0.01))


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
def test_what_is_driven_smoothly_starts_at_rest_and_nothing_else_does(u):
    """Rates of drives are differences, whose error is no broken constraint."""
    for smooth in (True, False):
        scene, body = hinged(u)
        hinge = fl.joints.Revolute(
            fl.ground(), body.point("centre"), at=(0, 0, 0), axis=(0, 0, 1), name="hinge"
        )
        scene.add(hinge)
        angle = (lambda τ: 0.3 * np.sin(2 * τ) ** 2) if smooth else (lambda τ: 1e-2 * τ)
        scene.add(fl.joints.Drive(hinge.angle, lambda t, angle=angle: angle(t / u.time(1.0))))
        run = partial(fl.GeneralisedAlpha().run, scene, duration=u.time(0.1), step=u.time(0.01))
        if smooth:
            body_end = run().rotation(body.point("centre"))[-1]
            np.testing.assert_allclose(body_end[1, 0], np.sin(0.3 * np.sin(0.2) ** 2), atol=1e-9)
        else:
            with pytest.raises(ValueError, match="initial velocities break"):
                run()


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
def test_links_that_velocities_contradict_are_refused(u):
    scene, body = hinged(u)
    other = scene.add(fl.RigidBody(u.mass(1.0), u.inertia([0.1, 0.1, 0.1]), u.length([0, 1, 0])))
    scene.add(fl.joints.RigidLink(body.point("centre"), other.point("centre")))
    body.add_velocity(omega=u.rate([0, 0, 1.0]), about=(0, 0, 0))
    other.add_velocity(omega=u.rate([0, 0, 1.0]), about=u.length([1e-3, 0, 0]))
    with pytest.raises(ValueError, match="contradict a rigid link"):
        fl.extend.Equations(scene, dynamics=True)


@pytest.mark.parametrize("u", UNIT_SYSTEMS, ids=str)
def test_redundant_constraints_are_the_same_in_all_systems(u):
    scene, body = hinged(u)
    for x in (0.0, 1.0):
        scene.add(fl.joints.Fixed(fl.ground(), body.point("centre"), at=u.length([x, 0, 0])))
    with pytest.raises(ValueError, match="6 of 12 constraints are redundant"):
        fl.extend.Equations(scene, dynamics=True)


@cache
def slide(u: UnitSystem) -> tuple[np.ndarray, int]:
    """A bead runs along a bent beam; its geometric stiffness is found by differences."""
    steel = fl.Material(u.stress(2e9), 0.3, u.density(2000.0))
    section = fl.Section.rectangle(u.length(0.02), u.length(0.02), steel)
    scene = fl.Scene(gravity=u.acceleration([0, 0, -9.81]))
    ends = u.length([0, 0, 0]), u.length([1, 0, -0.2])
    beam = scene.add(fl.Beam.straight(*ends, section, cells=6))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.Clamp(beam.point("end")))
    bead = scene.add(
        fl.RigidBody(u.mass(1.0), u.inertia([1e-3] * 3), u.length([0.25, 0, -0.05]), name="bead")
    )
    scene.add(fl.joints.Sliding(beam, bead.point("centre")))
    scheme = fl.GeneralisedAlpha(policy=fl.schemes.EveryIteration())
    result = scheme.run(scene, duration=u.time(0.1), step=u.time(2e-3))
    return u.inverse.length(result.position("bead.centre")), int(result.iterations[-1])


@pytest.mark.parametrize("u", OTHER_SYSTEMS, ids=str)
def test_a_bead_slides_alike(u):
    """With as many iterations: the matrix is the same."""
    found, expected = slide(u), slide(METRES)
    np.testing.assert_allclose(found[0], expected[0], rtol=0, atol=1e-9)
    assert found[1] == expected[1]
