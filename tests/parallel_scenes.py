"""What test_ranks.py compares between numbers of ranks: ``mpirun -n 2 parallel_scenes.py OUT``."""

import sys
from pathlib import Path

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

import fem_lie as fl

PREFIXES = tuple(
    f"fem_lie_{kind}_"
    for kind in ("statics", "dynamics", "vibrations", "path", "path_modes", "buckling")
)
STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)


def share_factors():
    """However small a scene is, all ranks factorise its matrix together."""
    for prefix in PREFIXES:
        PETSc.Options(prefix)["shared_from"] = 1


def sheet():
    """A curved strip, held along an edge and pulled at a corner."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.4 * b, 0.1 * a * a), (4, 3))
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.01, STEEL))
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.PointLoad(shell.point("11"), force=(0.0, 300.0, 2e3)))
    return scene, shell.point("11")


def pendulum():
    """A flexible double pendulum."""
    bar = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))
    upper = fl.Beam.straight((0, 0, 0), (1, 0, 0), bar, cells=4)
    lower = fl.Beam.straight((1, 0, 0), (2, 0, 0), bar, cells=4)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(upper)
    scene.add(lower)
    scene.add(fl.joints.Revolute(fl.ground(), upper.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Revolute(upper.point("end"), lower.point("start"), axis=(0, 1, 0)))
    return scene


def column():
    """A clamped column under twice the load at which it buckles."""
    section = fl.Section.rectangle(0.02, 0.03, STEEL)
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4)
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    stiffness = STEEL.E * 0.03 * 0.02**3 / 12
    scene.add(fl.PointLoad(beam.point("end"), force=(-2 * stiffness * np.pi**2 / 4, 0, 0)))
    return scene


def stopped(after):
    """The pendulum, pushed until some time, where the push raises an error."""
    scene = pendulum()

    def push(t):
        if t > after:
            raise ArithmeticError("no push is known here")
        return t

    scene.add(fl.PointLoad(scene.bodies[1].point("end"), force=(0, 0, 1.0), history=push))
    return scene


def results(file):
    """Of statics, vibrations and motion; the motion goes to a file, which is read, too."""
    scene, corner = sheet()
    rest = fl.statics(scene, load_steps=2)
    modes = fl.vibrations(scene, 3)
    moved = fl.GeneralisedAlpha().run(pendulum(), duration=0.02, step=2e-3, file=file)
    kept = fl.Result.load(file)
    moved.save(file.with_suffix(".saved"))
    saved = fl.Result.load(file.with_suffix(".saved"))
    for other in (kept, saved):
        np.testing.assert_array_equal(other.frames, moved.frames)
    return {
        "place": rest.position(corner),
        "frequencies": modes.frequencies,
        "frames": moved.frames,
        "velocities": moved.velocities,
        "joints": moved.joint_forces,
        "energies": np.array([moved.kinetic, moved.elastic, moved.potential]),
    }


if __name__ == "__main__":
    share_factors()
    out = Path(sys.argv[1])
    found = results(out.with_suffix(".h5"))
    if MPI.COMM_WORLD.rank == 0:
        np.savez(out, **found)
