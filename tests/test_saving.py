"""States that are kept at given times, and results that go to a file while there is room."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import fem_lie as fl

ROOT = Path(__file__).parents[1]
SCHEMES = {
    "generalised alpha": fl.GeneralisedAlpha(),
    "conserving": fl.EnergyMomentum(),
    "decaying": fl.EnergyDecaying(),
}


def top(*, jointed: bool = True, history=None) -> fl.Scene:
    """A body that turns about a point, and a second one that flies."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    one = scene.add(fl.RigidBody(1.0, (0.2, 0.2, 0.3), (0.5, 0, 0)))
    two = scene.add(fl.RigidBody(2.0, (0.1, 0.2, 0.3), (0, 2.0, 0)))
    if jointed:
        scene.add(
            fl.joints.Revolute(fl.ground(), one.point("centre"), at=(0, 0, 0), axis=(0, 1, 0.2))
        )
    two.add_velocity(omega=(1.0, 4.0, 0.2), about=two.point("centre"))
    scene.add(fl.PointLoad(two.point("centre"), moment=(0, 0, 0.5), history=history))
    return scene


def same(a: fl.Result, b: fl.Result, **close) -> None:
    for name in ("times", "frames", "velocities", "joint_forces", "kinetic", "balance", "impulses"):
        np.testing.assert_allclose(getattr(a, name), getattr(b, name), err_msg=name, **close)


@pytest.mark.parametrize("jointed", [True, False])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_times_are_those_of_all_steps_resampled(scheme, jointed):
    """By constant steps, also in the compiled loop of free bodies."""
    plan = {"duration": 0.1, "step": 2e-3}
    all_steps = SCHEMES[scheme].run(top(jointed=jointed), **plan)
    times = [0.0, 0.0031, 0.004, 0.0777, 0.0778]
    kept = SCHEMES[scheme].run(top(jointed=jointed), save_at=times, **plan)
    same(kept, all_steps.resampled(times), rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(kept.frames[2], all_steps.frames[2])
    np.testing.assert_array_equal(kept.iterations[[0, 2]], all_steps.iterations[[0, 2]])
    even = SCHEMES[scheme].run(top(jointed=jointed), save_at=0.03, **plan)
    np.testing.assert_allclose(even.times, [0.0, 0.03, 0.06, 0.09, 0.1])
    same(even, all_steps.resampled(even.times), rtol=1e-12, atol=1e-12)
    assert even.factorisations == all_steps.factorisations


@pytest.mark.parametrize(
    "choice", [fl.schemes.ConstantStep(2e-3), fl.schemes.AdaptiveStep(1e-2, events=(0.05,))]
)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_times_of_steps_that_change(scheme, choice):
    def jumping(t: float) -> float:
        return 1.0 if t < 0.05 else -20.0

    all_steps = SCHEMES[scheme].run(top(history=jumping), duration=0.1, step=choice)
    assert len(all_steps.times) > 12
    kept = SCHEMES[scheme].run(top(history=jumping), duration=0.1, step=choice, save_at=0.0071)
    assert len(kept.times) == 16
    same(kept, all_steps.resampled(kept.times), rtol=1e-12, atol=1e-12)
    assert len(kept.steps.times) == len(all_steps.steps.times)


def test_interpolated_states_are_of_fourth_order():
    times, exact = np.linspace(0.013, 0.3, 20), None
    errors = []
    scheme = fl.GeneralisedAlpha(tolerance=1e-10)
    for step in (6e-2, 3e-2):
        fine = scheme.run(top(), duration=0.3, step=step / 32)
        coarse = fine.resampled(np.arange(round(0.3 / step) + 1) * step).resampled(times)
        exact = scheme.run(top(), duration=0.3, step=step / 32, save_at=times)
        errors.append(np.abs(coarse.frames - exact.frames).max())
    assert errors[0] / errors[1] > 11.0


@pytest.mark.parametrize("save_at", [0.0, -1.0, 0.2, [0.0, 0.2], [0.05, 0.01], [], [[0.0]], np.nan])
def test_bad_times_are_named(save_at):
    with pytest.raises(ValueError, match="save_at must be an interval"):
        fl.GeneralisedAlpha().run(top(), duration=0.1, step=1e-2, save_at=save_at)
    with pytest.raises(ValueError, match="give save_every or save_at"):
        fl.GeneralisedAlpha().run(top(), duration=0.1, step=1e-2, save_every=2, save_at=0.05)


FULL = """
import resource, sys
from pathlib import Path
import fem_lie as fl
from tests.test_saving import SCHEMES, top

def ulimit(size):
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

def history(t):
    # from here on nothing more fits into a file
    if t > 0.05 and sys.argv[3] != "creation":
        ulimit({"results": 20_000, "checkpoint": 2_000}[sys.argv[3]])
    return 1.0

scheme, file = SCHEMES[sys.argv[1]], Path(sys.argv[2])
if sys.argv[3] == "creation":
    ulimit(10_000)
every = 1 if sys.argv[3] == "results" else 100
try:
    scheme.run(
        top(history=history), duration=0.2, step=1e-3, file=file, save_every=every,
        checkpoint_every=10,
    )
except OSError as error:
    ulimit(resource.RLIM_INFINITY)
    print(error.filename, error)
"""


def filled(file: Path, scheme: str, what: str) -> str:
    """What a run says whose disk is full from some time on."""
    command = [sys.executable, "-c", FULL, scheme, str(file), what]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("what", ["results", "checkpoint"])
def test_a_full_disk_is_an_error_that_says_how_far_the_run_is(tmp_path, scheme, what):
    file = tmp_path / "run.h5"
    said = filled(file, scheme, what)
    assert str(file) in said and "the run has reached time 0.06" in said
    assert "resume restarts from time 0.05" in said
    kept = fl.Result.load(file)
    assert kept.times[-1] == (0.05 if what == "results" else 0.0)
    whole = SCHEMES[scheme].run(
        top(history=lambda t: 1.0),
        duration=0.2,
        step=1e-3,
        save_every=1 if len(kept.times) > 1 else 100,
    )
    np.testing.assert_array_equal(kept.frames, whole.frames[: len(kept.times)])
    # with room again it goes on
    resumed = SCHEMES[scheme].resume(top(history=lambda t: 1.0), file)
    same(resumed, whole, rtol=0, atol=0)


def test_a_disk_that_is_full_at_once_leaves_no_file(tmp_path):
    said = filled(tmp_path / "run.h5", "conserving", "creation")
    assert "the file of results cannot be made" in said
    assert os.listdir(tmp_path) == []


SAVE = """
import resource, sys
import fem_lie as fl
from tests.test_saving import top
result = fl.GeneralisedAlpha().run(top(), duration=0.05, step=1e-3)
result.save(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (5000, resource.RLIM_INFINITY))
try:
    result.save(sys.argv[1])
except OSError as error:
    print(error)
"""


def test_saving_to_a_full_disk_is_an_error_that_leaves_the_old_file(tmp_path):
    file = tmp_path / "saved.h5"
    command = [sys.executable, "-c", SAVE, str(file)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert str(file) in done.stdout
    assert os.listdir(tmp_path) == ["saved.h5"] and len(fl.Result.load(file).times) == 51
