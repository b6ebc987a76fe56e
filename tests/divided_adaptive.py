"""Steps of chosen sizes of divided scenes: ``mpirun -n 2 divided_adaptive.py OUT FOLDER RUN…``."""

import shutil
import sys
from pathlib import Path

from mpi4py import MPI

import divided_conserving
import divided_scenes
import h5py
import numpy as np

import fem_lie as fl

DURATION, EVERY, JUMP = 0.02, 4, 0.008


def pushed(build):
    """A scene with a load that jumps on its first point."""
    scene, points = build()
    jumps = fl.loads.PiecewiseSmooth(lambda t: 1.0 + 3.0 * (t >= JUMP), (JUMP,))
    scene.add(fl.PointLoad(points[0], force=(0, 0.5, 2.0), history=jumps))
    return scene, points


def driven():
    """A beam on a driven hinge, whose velocity jumps, and one that hangs on it."""
    bar = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))
    beams = [fl.Beam.straight((k, 0, 0), (k + 1, 0, 0), bar, cells=6) for k in range(2)]
    scene = fl.Scene(gravity=(0, 0, -9.81))
    for beam in beams:
        scene.add(beam)
    hinge = scene.add(fl.joints.Revolute(fl.ground(), beams[0].point("start"), axis=(0, 1, 0)))
    angle = fl.loads.PiecewiseSmooth(lambda t: 0.5 * max(0.0, t - JUMP), (JUMP,))
    scene.add(fl.joints.Drive(hinge.angle, angle))
    scene.add(fl.joints.Spherical(beams[0].point("end"), beams[1].point("start")))
    return scene, [beams[0].point(3), beams[1].point("end")]


ALPHA = fl.GeneralisedAlpha(tolerance=1e-12)
CONSERVING, DECAYING = fl.EnergyMomentum(), fl.EnergyDecaying(radius=0.6)


def chosen(tolerance, refinement=1):
    """Steps that begin at a millisecond; loose tolerances let them grow."""
    return fl.schemes.AdaptiveStep(tolerance, first=1e-3, refinement=refinement)


RUNS = {
    "plate": (lambda: pushed(divided_scenes.tumbling_plate), ALPHA, chosen(0.3)),
    "driven": (driven, ALPHA, chosen(1e-3, refinement=2)),
    "net": (divided_scenes.net, ALPHA, chosen(0.03)),
    "sliders": (divided_scenes.sliders, ALPHA, chosen(10.0)),
    "jump": (lambda: pushed(divided_scenes.linked), ALPHA, 2e-3),
    "driven, decaying": (driven, DECAYING, chosen(1e-2)),
    "linkage, conserving": (divided_conserving.linkage, CONSERVING, chosen(1e-2, refinement=2)),
    "net, decaying": (divided_scenes.net, DECAYING, chosen(0.03)),
    "jump, conserving": (lambda: pushed(divided_scenes.linked), CONSERVING, 2e-3),
}
"""Scene, scheme and choice of steps."""


def numbers(found, points):
    """Steps with their errors, motion, energies and forces."""
    steps = found.steps
    return {
        "times": found.times,
        "sizes": steps.sizes,
        "rejected": steps.rejected,
        "translation errors": steps.translation,
        "rotation errors": steps.rotation,
        "measured errors": np.nan_to_num(steps.measured_translation),
        **{f"position {k}": found.position(point) for k, point in enumerate(points)},
        **{f"velocity {k}": found.velocity(point) for k, point in enumerate(points)},
        "joint forces": found.joint_forces,
        "energies": np.array([found.kinetic, found.elastic, found.potential]),
        "balance": found.balance,
        "impulses": found.impulses,
    }


def runs(folder, names=tuple(RUNS)):
    """Results of runs, from files and some in memory, and resumed from a checkpoint."""
    found = {}
    for name in names:
        build, scheme, step = RUNS[name]
        scene, points = build()
        given = {"duration": DURATION, "step": step, "progress": False}
        if name.startswith("jump"):
            found[f"{name}, in memory"] = numbers(scheme.run(scene, **given), points)
        file = folder / f"{name}.h5"
        run = scheme.run(scene, file=file, checkpoint_every=EVERY, **given)
        found[name] = numbers(run, points)
        resumed = scheme.resume(scene, killed(file), progress=False)
        found[f"{name}, resumed"] = numbers(resumed, points)
    return {f"{run}: {what}": each for run, own in found.items() for what, each in own.items()}


def killed(file):
    """A copy of a file as it was after its checkpoint but one."""
    copy = file.with_suffix(".killed.h5")
    if MPI.COMM_WORLD.rank == 0:
        shutil.copy(file, copy)
        shutil.copy(f"{file}.checkpoint.before", f"{copy}.checkpoint")
        with np.load(f"{copy}.checkpoint") as kept, h5py.File(copy, "r+") as rows:
            rows["rows"][:] = kept["row"]
    MPI.COMM_WORLD.barrier()
    return copy


if __name__ == "__main__":
    divided_scenes.divide()
    with divided_conserving.log_of_division() as said:
        found = runs(Path(sys.argv[2]), sys.argv[3:])
    found["divided"] = np.array(all(" are shared" in message for message in said))
    if MPI.COMM_WORLD.rank == 0:
        np.savez(sys.argv[1], **found)
