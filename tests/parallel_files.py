"""Files of divided scenes: ``mpirun -n N parallel_files.py OUT run|resume FOLDER [CASE…]``."""

import sys
from pathlib import Path

from mpi4py import MPI

import divided_conserving
import divided_scenes
import numpy as np

import fem_lie as fl

STEP, STEPS, EVERY = 2e-3, 10, 4
BETWEEN = 0.8  # of a step: as many states as with each step are known at the first checkpoint
AT_TIMES = "sheet, implicit", "pendulum, implicit", "net, explicit"
"""Cases whose states are recorded between steps."""
SCENES = {
    **{name: divided_scenes.MOTIONS[name] for name in ("sheet", "net", "pendulum", "plate")},
    "linked beams": divided_scenes.linked,
    "balls": divided_scenes.balls,
    "sliders": divided_scenes.sliders,
    "crossing": divided_scenes.crossing,
}
CONSERVING = {
    "linkage, conserving": (divided_conserving.linkage, fl.EnergyMomentum()),
    "swinging block, conserving": (divided_scenes.swinging_block, fl.EnergyMomentum()),
    "balls, conserving": (divided_scenes.balls, fl.EnergyMomentum()),
    "sliders, conserving": (divided_scenes.sliders, fl.EnergyMomentum()),
    "net, decaying": (divided_scenes.net, fl.EnergyDecaying(radius=0.6)),
    "plate, decaying": (divided_scenes.tumbling_plate, fl.EnergyDecaying(radius=0.6)),
}
"""Scenes and schemes, by case."""


def turning(build):
    """A scene with a load that depends on time, and joints that turn."""
    scene, points = build()
    scene.add(fl.PointLoad(points[0], force=(0, 0, 2.0), history=np.sin))
    return scene


def cases():
    """Name, scheme, scene and step of all runs."""
    for name, build in SCENES.items():
        yield f"{name}, implicit", fl.GeneralisedAlpha(tolerance=1e-12), turning(build), STEP
        if name in ("net", "linked beams", "balls"):
            scene = turning(build)
            yield f"{name}, explicit", fl.Explicit(), scene, 0.5 * fl.Explicit().stable_step(scene)
    for name, (build, scheme) in CONSERVING.items():
        yield name, scheme, build()[0], STEP


def run(folder):
    """Each scene to its end, with checkpoints on the way."""
    return {
        name: scheme.run(
            scene,
            duration=STEPS * step,
            step=step,
            save_at=BETWEEN * step if name in AT_TIMES else None,
            file=folder / f"{name}.h5",
            checkpoint_every=EVERY,
            progress=False,
        )
        for name, scheme, scene, step in cases()
    }


def resume(folder, names=()):
    """The same, or some of them, from the last checkpoints."""
    return {
        name: scheme.resume(scene, folder / f"{name}.h5", progress=False)
        for name, scheme, scene, _ in cases()
        if not names or name in names
    }


def numbers(results):
    """What is compared, by scene and quantity."""
    found = {}
    for case, result in results.items():
        # the nodes of each body in its own order
        nodes = np.concatenate([body.nodes for body in result.info.bodies])
        found[f"{case}: frames"] = result.frames[:, nodes]
        found[f"{case}: velocities"] = result.velocities[:, nodes]
        found[f"{case}: times"] = result.times
        found[f"{case}: reactions"] = result.reactions.sum(axis=1)
        for name in "joint_forces", "kinetic", "elastic", "balance", "impulses":
            found[f"{case}: {name}"] = getattr(result, name)
        if result.friction is not None:
            found[f"{case}: friction"] = result.friction.each
    return found


if __name__ == "__main__":
    divided_scenes.divide()
    out, what, folder, *names = sys.argv[1:]
    found = run(Path(folder)) if what == "run" else resume(Path(folder), names)
    if MPI.COMM_WORLD.rank == 0:
        np.savez(out, **numbers(found))
