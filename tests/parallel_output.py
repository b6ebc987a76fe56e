"""Files for ParaView and results of a divided scene: ``mpirun -n N parallel_output.py FOLDER``.

With ``FOLDER FILE`` the series of the results in a file.
"""

import sys
from pathlib import Path

import divided_scenes

import fem_lie as fl

SERIES = "motion", "forces"
"""Series that are written, see :func:`write`."""


def scene():
    """A sheet, two beams on ball joints and a body that falls: faces, lines and a single point."""
    found, _ = divided_scenes.sheet()
    beams, _ = divided_scenes.linked()
    for item in (*beams.bodies, *beams.joints):
        found.add(item)
    found.add(fl.RigidBody(1.0, (0.1, 0.2, 0.3), (0, 0, 3)))
    return found


def write(folder):
    """A motion with section forces in cells, these forces with their vectors, shell resultants."""
    built = scene()
    shell, beam, *_ = built.bodies
    scheme = fl.GeneralisedAlpha(tolerance=1e-12)
    result = scheme.run(built, duration=6e-3, step=2e-3, progress=False)
    forces = fl.post.section_forces(result, beam, built)
    result.write_vtk(folder / "motion.pvd", forces=[forces])
    forces.write_vtk(folder / "forces.pvd")
    fl.post.resultants(result, shell).write_vtk(folder / "sheet.vtu")
    result.save(folder / "motion.h5")


def write_again(folder, file):
    """The motion of a file, which other ranks than these may have written."""
    fl.Result.load(file).write_vtk(folder / "motion.pvd")


if __name__ == "__main__":
    out, *files = map(Path, sys.argv[1:])
    if files:
        write_again(out, *files)
    else:
        divided_scenes.divide()
        write(out)
