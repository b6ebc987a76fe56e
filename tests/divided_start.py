"""Motions of divided scenes from an equilibrium: ``mpirun -n 2 … OUT FOLDER``."""

import sys
from pathlib import Path

from mpi4py import MPI

import divided_adaptive
import divided_conserving
import divided_scenes
import numpy as np

import fem_lie as fl

SCHEMES = {"alpha": fl.GeneralisedAlpha(tolerance=1e-12), "conserving": fl.EnergyMomentum()}
SOFT = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))


def scene(pull):
    """Two beams on a clamp and a driven hinge, with a force on the second one."""
    beams = [fl.Beam.straight((k, 0, 0), (k + 1, 0, 0), SOFT, cells=6) for k in range(2)]
    scene = fl.Scene(gravity=(0, 0, -2.0))
    for beam in beams:
        scene.add(beam)
    ends = beams[0].point("end"), beams[1].point("start")
    hinge = scene.add(fl.joints.Revolute(*ends, axis=(1, 0, 0), name="hinge"))
    # holds a turn and a half
    turns = (lambda t: 3.0 * np.pi * t) if pull else None
    scene.add(fl.joints.Drive(hinge.angle, turns))
    scene.add(fl.Clamp(beams[0].point("start")))
    if pull:
        scene.add(fl.PointLoad(beams[1].point("end"), force=(0, 1.5, -3.0)))
    return scene, hinge


def numbers(found, hinge):
    """Motion and forces."""
    return {
        "tip": found.position("beam 2.end"),
        "angle": found.coordinate(hinge),
        "joint forces": found.joint_forces,
        "energies": np.array([found.kinetic, found.elastic, found.potential]),
    }


def runs(folder):
    """Results of runs that write files."""
    (pulled, _), (free, hinge), found = scene(True), scene(False), {}
    still = fl.statics(pulled, load_steps=8)
    plan = {"duration": 0.1, "step": 4e-3, "progress": False, "checkpoint_every": 10}
    for name, scheme in SCHEMES.items():
        result = scheme.run(free, file=folder / f"{name}.h5", start=still, **plan)
        found |= {f"{name}: {what}": each for what, each in numbers(result, hinge).items()}
    return found


def resumed(folder):
    """Results of these runs, resumed from their last checkpoint but one."""
    (free, hinge), found = scene(False), {}
    for name, scheme in SCHEMES.items():
        file = divided_adaptive.killed(folder / f"{name}.h5")
        result = scheme.resume(free, file, progress=False)
        found |= {f"{name}: {what}": each for what, each in numbers(result, hinge).items()}
    return found


def message():
    """Message of all ranks about a drive that one of them has, and that does not hold."""
    (pulled, _), still = scene(True), fl.statics(scene(True)[0], load_steps=8)
    try:
        fl.GeneralisedAlpha().run(pulled, duration=0.1, step=4e-3, start=still)
    except ValueError as error:
        return str(error)
    return "nothing has failed"


if __name__ == "__main__":
    divided_scenes.divide()
    with divided_conserving.log_of_division() as said:
        found = runs(Path(sys.argv[2]))
    found["divided"] = np.array(all(" are shared" in message for message in said))
    found["messages"] = np.array(MPI.COMM_WORLD.allgather(message()))
    if MPI.COMM_WORLD.rank == 0:
        np.savez(sys.argv[1], **found)
