"""A run goes on with the same equations and options only, and to the last bit."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
import ufl

import fem_lie as fl
from tests.interruption import interrupted

STEPS, STEP = 6, 2e-3
Function = Callable[[float], float]
DAMPING, GEODESIC = fl.sections.Damping(mass=1.0, stiffness=1e-4), fl.elements.GeodesicBeam()


@dataclass(frozen=True)
class Case:
    """A beam on a driven hinge, with a spring to a rigid body, and what may be changed of it."""

    young: float = 1e9
    density: float = 1100.0
    damping: fl.sections.Damping = DAMPING
    formulation: fl.elements.BeamFormulation = GEODESIC
    group: fl.lie.Group = fl.lie.Group.SE3
    velocity: float = 0.2
    gravity: tuple[float, ...] = (0.0, 0.0, -9.81)
    axis: tuple[float, ...] = (0.0, 1.0, 0.0)
    drive: Function | None = lambda t: 0.1 * t * t
    spring: tuple[float, ...] = (3.0, 0.1, 0.9)
    inertia: tuple[float, ...] = (0.2, 0.2, 0.2)
    force: tuple[float, ...] = (0.0, 0.0, 2.0)
    following: bool = False
    history: Function | None = sin
    pressure: float = 0.1
    pressed: Function | None = None
    strain: float = 1e-4
    motion: Function = lambda t: 0.01 * t**2
    held: bool = True
    gyroscopic: bool | None = None

    def scene(self) -> fl.Scene:
        scene = fl.Scene(
            self.gravity, matrix_terms=fl.schemes.MatrixTerms(gyroscopic=self.gyroscopic)
        )
        section = fl.Section.circle(0.01, fl.Material(self.young, 0.3, self.density))
        options = {"formulation": self.formulation, "damping": self.damping}
        beam = fl.Beam.straight((0, 0, 0), (0.5, 0, 0), section, cells=2, **options)
        scene.add(beam.set_group(self.group))
        body = scene.add(fl.RigidBody(0.1, self.inertia, (1.0, 0.5, 0)))
        body.add_velocity((0, self.velocity, 0))
        carrier = scene.add(fl.RigidBody(0.1, 0.1 * np.ones(3), (0, -1.0, 0)))
        hinge = scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=self.axis))
        rope = scene.add(fl.joints.Distance(beam.point("end"), body.point("centre")))
        scene.add(fl.joints.Drive(hinge.angle, self.drive))
        k, c, rest = self.spring
        scene.add(fl.joints.Spring(rope.length, k, c, rest))
        scene.add(
            fl.PointLoad(
                beam.point("end"), self.force, following=self.following, history=self.history
            )
        )
        scene.add(fl.loads.PressureLoad(beam, self.pressure, history=self.pressed))
        scene.add(fl.loads.Eigenstrain(beam, (0, 0, 0, 0, self.strain, 0)))
        position = carrier.point("centre").frame

        def moved(t: float) -> np.ndarray:
            frame = position.copy()
            frame[0, 0] += self.motion(t)
            return frame

        scene.add(fl.PrescribedMotion(carrier.point("centre"), moved))
        post = scene.add(fl.Beam.straight((0, 2, 0), (0, 2, 0.5), section, cells=1))
        if self.held:
            scene.add(fl.Clamp(post.point("start")))
        return scene


def run(scene: fl.Scene, scheme: fl.extend.Integrator, file: Path) -> fl.Result:
    return scheme.run(
        scene, duration=STEPS * STEP, step=STEP, file=file, checkpoint_every=STEPS // 2
    )


CHANGES = {
    "Young's modulus": ({"young": 1.1e9}, "stiffness of beam 1"),
    "density": ({"density": 1200.0}, "density of beam 1"),
    "damping of mass": ({"damping": fl.sections.Damping(2.0, 1e-4)}, "damping of beam 1"),
    "viscosity": ({"damping": fl.sections.Damping(1.0, 2e-4)}, "damping of beam 1"),
    "element": ({"formulation": fl.elements.DirectorBeam(1)}, "formulation of beam 1"),
    "group": ({"group": fl.lie.Group.R3xSO3}, "group of beam 1"),
    "velocity": ({"velocity": 0.3}, "velocities of rigidbody 1"),
    "gravity": ({"gravity": (0, 0, -9.0)}, r"gravity \(\[0.0, 0.0, -9.0\], was \[0.0, 0.0, -9.81"),
    "joint": ({"axis": (0.1, 1, 0)}, "constraint definitions of Revolute"),
    "drive": ({"drive": lambda t: 0.2 * t * t}, "function of Drive.*up to time 0.012"),
    "no drive": ({"drive": None}, "function of connection 3"),
    "spring": ({"spring": (4.0, 0.1, 0.9)}, "stiffness, damping and rest of Spring"),
    "damper": ({"spring": (3.0, 0.2, 0.9)}, "stiffness, damping and rest of Spring"),
    "rest": ({"spring": (3.0, 0.1, 1.0)}, "stiffness, damping and rest of Spring"),
    "inertia": ({"inertia": (0.3, 0.2, 0.2)}, "mass_matrix of rigidbody 1"),
    "force": ({"force": (0, 0, 3.0)}, r"force of load 1 \(PointLoad\)"),
    "following": ({"following": True}, r"following of load 1 \(PointLoad\) \(True, was False"),
    "history": ({"history": cos}, "history of load 1"),
    "no history": ({"history": None}, "history of load 1"),
    "pressure": ({"pressure": 0.2}, r"pressure of load 2 .* \(0.2, was 0.1\)"),
    "history of pressure": ({"pressed": cos}, "history of load 2"),
    "strain": ({"strain": 2e-4}, "strain of load 3"),
    "motion": ({"motion": lambda t: 0.02 * t**2}, "motion 1, of rigidbody 2.centre"),
    "clamp": ({"held": False}, "point of clamp 1"),
    "choices": ({"gyroscopic": True}, "matrix_terms"),
}
SCHEMES = {
    "generalised alpha": fl.GeneralisedAlpha(),
    "conserving": fl.EnergyMomentum(),
    "decaying": fl.EnergyDecaying(),
}


@pytest.fixture(scope="module", params=SCHEMES)
def kept(request, tmp_path_factory):
    """A scheme, and the file of a run of it with checkpoints."""
    file = tmp_path_factory.mktemp("resume") / "run.h5"
    run(Case().scene(), SCHEMES[request.param], file)
    return SCHEMES[request.param], file


@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_scene_is_refused_and_the_change_named(kept, change):
    scheme, file = kept
    options, named = CHANGES[change]
    with pytest.raises(ValueError, match=f"(?s)another scene.*what differs: .*{named}"):
        scheme.resume(replace(Case(), **options).scene(), file)


@pytest.mark.parametrize(
    "options",
    [
        {"policy": fl.schemes.IterationLimit(5)},
        {"policy": fl.schemes.Automatic(cost=39.0)},
        {"tolerance": 1e-9},
    ],
)
def test_other_options_are_refused_and_named(kept, options):
    scheme, file = kept
    (name,) = options
    with pytest.raises(ValueError, match=f"other options of the scheme.*option {name}"):
        replace(scheme, **options).resume(Case().scene(), file)
    with pytest.raises(ValueError, match=r"scheme \(.*, was"):
        SCHEMES["decaying" if scheme != SCHEMES["decaying"] else "conserving"].resume(
            Case().scene(), file
        )


def test_what_does_not_touch_the_steps_made_may_change(kept):
    """Names, and what functions return later: nobody can know that."""
    scheme, file = kept
    later = replace(Case(), history=lambda t: sin(t) if t < 1.0 else 7.0).scene()
    later.bodies[0].name = "boom"
    assert len(scheme.resume(later, file).times) == STEPS + 1


def doubled(e):
    return e[0] ** 2 + e[1] ** 2


def shell(law: Callable) -> fl.Scene:
    scene = fl.Scene(gravity=(0, 0, -1.0))
    section = fl.ShellSection.layer(0.1, fl.Material(1e4, 0.0, 1.0))
    mesh = fl.mesh.parametric_surface(lambda u, v: (u, v, 0), (1, 1))
    scene.add(fl.Shell(mesh, section, formulation=fl.elements.HuWashizu(law=law)))
    return scene


def test_another_law_of_the_same_name_is_refused(tmp_path):
    file, scheme = tmp_path / "run.h5", fl.GeneralisedAlpha()

    def law(factor: float) -> Callable:
        return lambda e: 0.5 * factor * ufl.inner(e, e)

    run(shell(law(1e3)), scheme, file)
    assert len(scheme.resume(shell(law(1e3)), file).times) == STEPS + 1
    with pytest.raises(ValueError, match="energy of the elements of shell 1"):
        scheme.resume(shell(law(2e3)), file)


# --- to the last bit, with all that a run remembers in play ---


class EverySeventh(fl.schemes.RefactorisationPolicy):
    """A policy of a user's own, with a state."""

    def begin(self, bound: bool) -> fl.extend.PolicyState:
        return CountsToSeven()


class CountsToSeven(fl.extend.PolicyState):
    def __init__(self) -> None:
        self.steps, self.taken = 0, np.zeros(2)

    def before_iteration(self, iteration: int) -> bool:
        # both kinds of state decide: a number and an array
        return iteration == 1 and self.steps % 7 == 3 and self.taken[0] == self.steps

    def after_step(self, iterations: int) -> None:
        self.steps += 1
        self.taken += 1.0


def slowing() -> fl.Scene:
    """Two soft bars on hinges turn, fast at the start, and are braked."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.02, 0.02, fl.Material(2e7, 0.3, 1200.0))
    options = {"cells": 2, "damping": fl.sections.Damping(mass=120.0)}
    one = scene.add(fl.Beam.straight((0, 0, 0), (0.3, 0, 0), section, **options))
    two = scene.add(fl.Beam.straight((0.3, 0, 0), (0.3, 0.5, 0), section, **options))
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=(1, 0, 0.2)))
    for bar in (one, two):
        bar.add_velocity(omega=(3, 1, -8), about=(0, 0, 0))
    return scene


POLICIES = {
    "automatic": fl.schemes.Automatic(cost=2, refresh=8),
    "limit": fl.schemes.IterationLimit(5),
    "constraints": fl.schemes.ConstraintsOnly(5),
    "every": fl.schemes.EveryIteration(),
    "never": fl.schemes.FactoriseOnce(),
    "own": EverySeventh(),
}
FELT = {
    "generalised alpha": lambda policy: fl.GeneralisedAlpha(tolerance=1e-8, policy=policy),
    "stabilised": lambda policy: fl.GeneralisedAlpha(
        tolerance=1e-8, index=fl.schemes.ConstraintIndex.STABILISED_TWO, policy=policy
    ),
    "inertial": lambda policy: fl.GeneralisedAlpha(
        tolerance=1e-8, matrix_frame=fl.schemes.MatrixFrame.INERTIAL, policy=policy
    ),
    "conserving": lambda policy: fl.EnergyMomentum(tolerance=1e-5, policy=policy),
    "decaying": lambda policy: fl.EnergyDecaying(radius=0.9, tolerance=1e-6, policy=policy),
}
"""With tolerances that decide how many iterations a step takes."""


def stopped(scheme: fl.extend.Integrator, scene: fl.Scene, file: Path, at: int, **plan) -> None:
    """Run up to a checkpoint after step ``at``, as if the user had stopped it there."""
    with interrupted():
        scheme.run(scene, file=file, checkpoint_every=at, **plan)


def same(a: fl.Result, b: fl.Result) -> None:
    for name in ("times", "frames", "velocities", "joint_forces", "joint_coordinates", "kinetic"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)
    np.testing.assert_array_equal(a.iterations, b.iterations)
    assert (a.k_updates, a.phi_updates) == (b.k_updates, b.phi_updates)


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("scheme", FELT)
def test_resumed_is_uninterrupted_to_the_last_bit(tmp_path, scheme, policy):
    chosen = FELT[scheme](POLICIES[policy])
    plan = {"duration": 0.025, "step": 5e-4}
    whole = chosen.run(slowing(), **plan)
    file = tmp_path / "run.h5"
    stopped(chosen, slowing(), file, 34, **plan)
    same(chosen.resume(slowing(), file), whole)


# --- steps whose size changes ---


def jerked() -> fl.Scene:
    """The same, with a push that begins and ends in between."""
    scene = slowing()
    push = fl.loads.PiecewiseSmooth(lambda t: 5.0 if 0.011 <= t < 0.014 else 0.0, (0.011, 0.014))
    scene.add(fl.PointLoad(scene.bodies[1].point("end"), force=(0, 0, 1.0), history=push))
    return scene


VARIABLE = {
    "tolerance": {"step": fl.schemes.AdaptiveStep(2e-2, first=2e-4, largest=1e-3)},
    "measured": {"step": fl.schemes.AdaptiveStep(2e-2, first=2e-4, largest=1e-3, refinement=2)},
    "constant between jumps": {"step": 5e-4},
    "at times": {"step": fl.schemes.AdaptiveStep(2e-2, first=2e-4, largest=1e-3), "save_at": 1e-3},
}


@pytest.mark.parametrize("plan", VARIABLE)
@pytest.mark.parametrize("scheme", ["generalised alpha", "conserving", "decaying"])
def test_steps_that_change_resume_to_the_last_bit(tmp_path, scheme, plan):
    chosen = FELT[scheme](POLICIES["automatic"])
    options = {"duration": 0.025, "progress": False, **VARIABLE[plan]}
    for every in (5, 34):
        whole = chosen.run(jerked(), file=tmp_path / "a.h5", checkpoint_every=every, **options)
        stopped(chosen, jerked(), tmp_path / "b.h5", every, **options)
        resumed = chosen.resume(jerked(), tmp_path / "b.h5")
        same(resumed, whole)
        for name in ("times", "sizes", "rejected", "measured_rotation", "translation"):
            one, other = (getattr(result.steps, name) for result in (resumed, whole))
            np.testing.assert_array_equal(one, other, err_msg=name)
        read = fl.Result.load(tmp_path / "b.h5")
        same(read, whole)
        np.testing.assert_array_equal(read.steps.sizes, whole.steps.sizes)


@pytest.mark.parametrize("scheme", ["generalised alpha", "conserving"])
def test_files_of_steps_that_change_have_space_for_any_number(tmp_path, scheme):
    """And the run is that in memory but for matrices that checkpoints make anew."""
    chosen, file = FELT[scheme](POLICIES["automatic"]), tmp_path / "run.h5"
    options = {"duration": 0.03, "step": fl.schemes.AdaptiveStep(1.0, first=4e-5, largest=4e-5)}
    whole = chosen.run(slowing(), progress=False, **options)
    kept = chosen.run(slowing(), progress=False, file=file, **options)
    assert len(whole.times) > 700 and len(kept.times) == len(whole.times)
    gap = np.abs(kept.frames[-1] - whole.frames[-1]).max()
    assert gap < 1e-6
    same(fl.Result.load(file), kept)
    assert list(tmp_path.glob(".*")) == []


class OneSize(fl.schemes.ConstantStep):
    """A choice of a user's own."""


def test_steps_of_a_users_own_are_refused_in_files(tmp_path):
    with pytest.raises(ValueError, match="AdaptiveStep or SymmetricStep, got OneSize"):
        fl.GeneralisedAlpha().run(
            slowing(), duration=0.01, step=OneSize(1e-3), file=tmp_path / "run.h5"
        )
    assert not list(tmp_path.iterdir())


def test_a_new_run_does_not_resume_from_a_checkpoint_of_an_older_one(tmp_path):
    """It has ended before the first of its own, and the file has its rows by then."""
    file, scheme = tmp_path / "run.h5", fl.GeneralisedAlpha()
    ends_at = [np.inf]

    def history(t: float) -> float:
        if t > ends_at[0]:
            raise KeyboardInterrupt
        return sin(t)

    scene = Case(history=history).scene()
    run(scene, scheme, file)
    ends_at[0] = 1.5 * STEP
    with pytest.raises(KeyboardInterrupt):
        run(scene, scheme, file)
    ends_at[0] = np.inf
    with pytest.raises(FileNotFoundError, match="checkpoint"):
        scheme.resume(scene, file)
