"""A run that records less finds the same, to the last bit, and says what it has not."""

import copy
import pickle

import numpy as np
import pytest

import fem_lie as fl
from demos.double_pendulum import pendulum
from tests.interruption import interrupted
from tests.test_explicit import net
from tests.test_saving import top

SCHEMES = {
    "generalised alpha": fl.GeneralisedAlpha(),
    "energy-momentum": fl.EnergyMomentum(),
    "energy-decaying": fl.EnergyDecaying(),
    "variational": fl.schemes.Variational(),
    "composed": fl.schemes.Composed(),
}
PARTS = [
    part for part in (fl.schemes.Record.FRAMES, *fl.schemes.Record) if part != fl.schemes.Record.ALL
]
ALWAYS = "times", "frames", "iterations"
RECORDED_BY = {
    "velocities": fl.schemes.Record.VELOCITIES,
    "kinetic": fl.schemes.Record.ENERGIES,
    "elastic": fl.schemes.Record.ENERGIES,
    "potential": fl.schemes.Record.ENERGIES,
    "balance": fl.schemes.Record.ENERGIES,
    "momentum": fl.schemes.Record.MOMENTA,
    "angular_momentum": fl.schemes.Record.MOMENTA,
    "impulses": fl.schemes.Record.MOMENTA,
    "joint_forces": fl.schemes.Record.FORCES,
    "reactions": fl.schemes.Record.FORCES,
    "joint_coordinates": fl.schemes.Record.COORDINATES,
    "joint_violations": fl.schemes.Record.COORDINATES,
}
"""Which part each quantity belongs to that may be missing."""


def clamped() -> fl.Scene:
    """A beam with a clamp, whose reaction is recorded, and a spring."""
    section = fl.Section.from_stiffness([1e4, 1e4, 1e4, 10.0, 10.0, 10.0], mass=1.0)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(
        fl.joints.Spring(
            fl.joints.Distance(beam.point("start"), beam.point("end")).length,
            stiffness=20.0,
            rest=0.5,
        )
    )
    return scene


def agrees(less: fl.Result, whole: fl.Result, record: fl.schemes.Record) -> None:
    """Whether what was recorded is the same, and the rest is missing."""
    assert less.recorded == record
    for name in (*ALWAYS, *RECORDED_BY):
        if name in ALWAYS or RECORDED_BY[name] in record:
            found, wanted = getattr(less, name), getattr(whole, name)
            np.testing.assert_array_equal(found, wanted, err_msg=name)
        else:
            part = RECORDED_BY[name].name
            with pytest.raises(AttributeError, match=rf"{name} was not .* record=Record\.{part}"):
                getattr(less, name)
    assert less.factorisations == whole.factorisations


@pytest.mark.parametrize("scheme", SCHEMES)
def test_what_is_recorded_is_that_of_the_whole_run(scheme):
    """Two bodies, one of them on a joint of the ground, under a moment."""
    plan = {"duration": 0.02, "step": 1e-3}
    whole = SCHEMES[scheme].run(top(), **plan)
    assert whole.recorded == fl.schemes.Record.ALL
    for part in PARTS:
        agrees(SCHEMES[scheme].run(top(), record=part, **plan), whole, part)


@pytest.mark.parametrize("scheme", ["generalised alpha", "energy-momentum"])
def test_beams_on_joints(scheme):
    plan = {"duration": 0.05, "step": 1e-3}
    whole = SCHEMES[scheme].run(pendulum(1)[0], **plan)
    assert whole.elastic.max() > 0.0
    for part in (
        fl.schemes.Record.FRAMES,
        fl.schemes.Record.ENERGIES,
        fl.schemes.Record.FORCES | fl.schemes.Record.MOMENTA,
    ):
        agrees(SCHEMES[scheme].run(pendulum(1)[0], record=part, **plan), whole, part)


def test_reactions_and_springs():
    """Reactions are found in Python; without them rows are filled in by the compiled loop."""
    plan = {"duration": 0.02, "step": 1e-3}
    whole = fl.GeneralisedAlpha().run(clamped(), **plan)
    assert np.abs(whole.reactions).max() > 1.0 and whole.elastic.max() > 0.0
    for part in PARTS:
        agrees(fl.GeneralisedAlpha().run(clamped(), record=part, **plan), whole, part)


@pytest.mark.parametrize("scheme", [fl.Explicit(), fl.schemes.Asynchronous()])
def test_explicit_steps(scheme):
    plan = {"duration": 0.01, "step": 1e-4, "save_every": 5}
    whole = scheme.run(net()[0], **plan)
    for part in PARTS:
        agrees(scheme.run(net()[0], record=part, **plan), whole, part)


def test_free_bodies_and_their_impacts():
    def scene() -> fl.Scene:
        built = top(jointed=False)
        for k, body in enumerate(built.bodies):
            floor = fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, -0.1 - k))
            built.add(
                fl.contact.Contact(
                    fl.contact.Sphere(body.point("centre"), 0.1), floor, fl.contact.Impact()
                )
            )
        return built

    for made in (lambda: top(jointed=False), scene):
        plan = {"duration": 0.3, "step": 1e-2}
        whole = fl.GeneralisedAlpha().run(made(), **plan)
        for part in PARTS:
            less = fl.GeneralisedAlpha().run(made(), record=part, **plan)
            agrees(less, whole, part)
            assert (less.contacts is None) == (whole.contacts is None)


@pytest.mark.parametrize("scheme", ["generalised alpha", "energy-momentum"])
def test_steps_that_change_and_states_between_them(scheme):
    """States between steps follow from velocities, which are not kept for that."""
    plan = {"duration": 0.1, "step": fl.schemes.AdaptiveStep(1e-2), "save_at": 0.0071}
    whole = SCHEMES[scheme].run(top(), **plan)
    less = SCHEMES[scheme].run(top(), record=fl.schemes.Record.MOMENTA, **plan)
    agrees(less, whole, fl.schemes.Record.MOMENTA)
    np.testing.assert_array_equal(less.steps.sizes, whole.steps.sizes)
    with pytest.raises(AttributeError, match="velocities was not recorded"):
        less.resampled([0.01])


@pytest.mark.parametrize("scheme", ["generalised alpha", "energy-momentum", "variational"])
def test_files_have_no_more_and_a_resumed_run_neither(tmp_path, scheme):
    part, plan = fl.schemes.Record.ENERGIES, {"duration": 0.02, "step": 1e-3}
    whole, file = SCHEMES[scheme].run(top(), **plan), tmp_path / "run.h5"
    with interrupted(3):
        SCHEMES[scheme].run(top(), record=part, file=file, checkpoint_every=3, **plan)
    agrees(SCHEMES[scheme].resume(top(), file), whole, part)
    loaded = fl.Result.load(file)
    agrees(loaded, whole, part)
    loaded.save(tmp_path / "again.h5")
    agrees(fl.Result.load(tmp_path / "again.h5"), whole, part)
    everything = tmp_path / "all.h5"
    whole.save(everything)
    assert everything.stat().st_size > (tmp_path / "again.h5").stat().st_size


def test_errors_of_momenta_need_energies():
    plan = {"duration": 0.01, "step": 1e-3}
    less = fl.GeneralisedAlpha().run(top(), record=fl.schemes.Record.MOMENTA, **plan)
    with pytest.raises(AttributeError, match=r"kinetic was not .* record=Record\.ENERGIES"):
        _ = less.momentum_error
    both = fl.schemes.Record.MOMENTA | fl.schemes.Record.ENERGIES
    assert fl.GeneralisedAlpha().run(top(), record=both, **plan).momentum_error < 1e-6


def test_pictures_pages_and_copies_of_frames_alone(tmp_path):
    plan = {"duration": 0.01, "step": 1e-3, "record": fl.schemes.Record.FRAMES}
    frames = fl.GeneralisedAlpha().run(top(), **plan)
    frames.page(tmp_path / "page.html")
    frames.write_vtk(tmp_path / "series.pvd")
    frames.picture(tmp_path / "picture.png")
    for twin in (copy.copy(frames), copy.deepcopy(frames), pickle.loads(pickle.dumps(frames))):
        agrees(twin, frames, fl.schemes.Record.FRAMES)
    with pytest.raises(AttributeError, match="kinetic was not recorded"):
        frames.plot_energies()
    with pytest.raises(AttributeError, match="momentum was not recorded"):
        frames.plot_momentum()


@pytest.mark.parametrize("record", ["energies", {"velocities"}, 3, None, True])
def test_what_is_no_record_is_refused(record):
    with pytest.raises(TypeError, match="record must be a Record such as"):
        fl.GeneralisedAlpha().run(top(), duration=0.1, step=1e-2, record=record)
