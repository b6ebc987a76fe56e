"""Conserving steps of divided scenes: ``mpirun -n 2 divided_conserving.py OUT SCENE…``."""

import logging
import sys
from contextlib import contextmanager

from mpi4py import MPI

import divided_scenes
import numpy as np

import fem_lie as fl


def linkage():
    """Two flexible bars on hinges, a spring between them, a ball at the end, and a load."""
    bar = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))
    upper = fl.Beam.straight((0, 0, 0), (1, 0, 0), bar, cells=5)
    lower = fl.Beam.straight((1, 0, 0), (2, 0, 0), bar, cells=5)
    balls = [fl.RigidBody(0.5, 1e-3 * np.eye(3), (2, y, 0)) for y in (0.0, 0.5)]
    scene = fl.Scene(gravity=(0, 0, -9.81))
    for body in upper, lower, *balls:
        scene.add(body)
    scene.add(fl.joints.Revolute(fl.ground(), upper.point("start"), axis=(0, 1, 0)))
    knee = scene.add(fl.joints.Revolute(upper.point("end"), lower.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Spring(knee.angle, stiffness=2.0, damping=0.1))
    scene.add(fl.joints.Spherical(lower.point("end"), balls[0].point("centre")))
    centres = (ball.point("centre") for ball in balls)
    scene.add(fl.joints.Spring(fl.joints.Distance(*centres).length, stiffness=300.0))
    scene.add(fl.PointLoad(lower.point(2), force=(0, 0, 3.0), history=lambda t: np.sin(40 * t)))
    return scene, [upper.point(2), lower.point("end"), balls[1].point("centre")]


def struck():
    """Two beams with round ends that meet between their ends, next to a sheet."""
    bar = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))
    scene, _ = divided_scenes.sheet()
    beams = [fl.Beam.straight((3, y, 0), (4, y, 0), bar, cells=4) for y in (0.0, 0.1)]
    ends = []
    for beam, speed in zip(beams, (1.0, -1.0), strict=True):
        scene.add(beam).add_velocity((0, speed, 0))
        ends.append(fl.contact.Sphere(beam.point(1), 0.045))
    scene.add(fl.contact.Contact(*ends, fl.contact.Penalty(1e5)))
    return scene, [beam.point("end") for beam in beams]


SCENES = {
    "linkage": linkage,
    "struck": struck,
    "balls": divided_scenes.balls,
    "linked": divided_scenes.linked,
    "sheet": divided_scenes.sheet,
    "block": divided_scenes.block,
    "net": divided_scenes.net,
    "free balls": divided_scenes.free_balls,
    "plate": divided_scenes.tumbling_plate,
}
SCHEMES = {"conserving": fl.EnergyMomentum(), "decaying": fl.EnergyDecaying(radius=0.6)}
SECANTS = fl.schemes.Automatic(secants=3)
WITH_SECANTS = {
    "conserving with secants": fl.EnergyMomentum(policy=SECANTS),
    "generalised-α with secants": fl.GeneralisedAlpha(tolerance=1e-12, policy=SECANTS),
}


def motion(build, scheme):
    """Positions, velocities, forces, energies, impulses and the error of the energy balance."""
    scene, points = build()
    found = scheme.run(scene, duration=0.02, step=2e-3, progress=False)
    return {
        **{f"position {k}": found.position(point) for k, point in enumerate(points)},
        **{f"velocity {k}": found.velocity(point) for k, point in enumerate(points)},
        "joint forces": found.joint_forces,
        "reactions": found.reactions.sum(axis=1),
        "energies": np.array([found.kinetic, found.elastic, found.potential]),
        "balance": found.balance,
        "impulses": found.impulses,
        "error of balance": np.array(found.balance_error),
        **{
            f"contact forces {k}": fl.post.contact_forces(found, contact).total
            for k, contact in enumerate(scene.contacts)
        },
    }


def results(names=tuple(SCENES)):
    """Results of scenes by their names and quantities."""
    found = {}
    for name in names:
        build = SCENES[name]
        schemes = SCHEMES | (WITH_SECANTS if name == "net" else {})
        for way, scheme in schemes.items():
            values = motion(build, scheme)
            found |= {f"{name}, {way}: {what}": value for what, value in values.items()}
    return found


@contextmanager
def log_of_division():
    """Context with the messages of who has what of a scene."""
    messages, handler = [], logging.Handler()
    handler.emit = lambda record: messages.append(record.getMessage())
    log = logging.getLogger("fem_lie.parts.part_scene")
    level = log.level
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    yield messages
    log.removeHandler(handler)
    log.setLevel(level)


if __name__ == "__main__":
    divided_scenes.divide()
    with log_of_division() as said:
        found = results(sys.argv[2:])
    found["divided"] = np.array(all(" are shared" in message for message in said))
    if MPI.COMM_WORLD.rank == 0:
        np.savez(sys.argv[1], **found)
