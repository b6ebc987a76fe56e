"""Events, limits, sensors and controllers of divided scenes: ``mpirun -n 2 … OUT runs FOLDER``."""

import sys
from pathlib import Path

from mpi4py import MPI

import divided_adaptive
import divided_conserving
import divided_scenes
import numpy as np

import fem_lie as fl
from fem_lie.schemes import ContinuousController, Controller, Event, Lock, Release, Scale, Sensor

STEP, EVERY = 2e-3, 6
SCHEME = fl.GeneralisedAlpha(radius=0.6, tolerance=1e-12)
SOFT = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))


def pendulum():
    """Two beams that hang on hinges one after the other, and the hinges."""
    beams = [fl.Beam.straight((k, 0, 0), (k + 1, 0, 0), SOFT, cells=5) for k in range(2)]
    scene = fl.Scene(gravity=(0, 0, -9.81))
    for beam in beams:
        scene.add(beam)
    ends = fl.ground(), beams[0].point("start"), beams[0].point("end"), beams[1].point("start")
    hinges = [
        scene.add(fl.joints.Revolute(a, b, axis=(0, 1, 0), name=name))
        for a, b, name in ((*ends[:2], "upper"), (*ends[2:], "lower"))
    ]
    return scene, beams, hinges


def stops():
    """Hinges with stops: one rebounds, the other one comes to rest and leaves again."""
    scene, beams, (upper, lower) = pendulum()
    beams[0].add_velocity(omega=(0, 2.0, 0), about=beams[0].point("start"))
    beams[1].add_velocity((0, 0, -2.0))
    scene.add(fl.joints.Limit(upper.angle, upper=0.02, lower=-0.01, restitution=0.5))
    scene.add(fl.joints.Limit(lower.angle, upper=0.05, lower=-0.03))
    return scene, [beams[0].point(2), beams[1].point("end")]


def latched():
    """What functions of both beams lock, release and scale, and sensors on both."""
    scene, (first, second), (upper, lower) = pendulum()
    tip, middle = second.point("end"), first.point(3)
    latch = scene.add(fl.joints.Drive(lower.angle, active=False, name="latch"))
    push = scene.add(fl.PointLoad(tip, force=(0, 2.0, -30.0)))
    weight = scene.add(fl.LineLoad(first, force=(0, 0, -20.0)))
    spring = scene.add(fl.joints.Spring(upper.angle, 50.0, name="spring"))
    seen = []

    def lowered(state):
        return state.position(tip)[2] + 0.5 * state.position(middle)[2] + 0.01

    def fast(state):
        return state.rate(upper) - state.velocity(tip)[2] - 1.0

    def open_again(state):
        return state.time - 0.041 if state.position("beam 2.end")[0] > 0.5 else -1.0

    scene.add(Event(lowered, [Lock(latch), Scale(push, 0.5), lambda state: seen.append(1)]))
    scene.add(Event(fast, [Scale(weight, -2.0), Scale(spring, 3.0)], direction=1))
    scene.add(Event(open_again, [Release(latch), Scale(push, 0.0)]))
    scene.add(Sensor("tip", lambda state: state.position(tip)[2]))
    scene.add(Sensor("turn", lambda state: state.rotation(middle)[0, 2] + state.coordinate(lower)))
    scene.add(Sensor("rates", lambda state: state.rate(lower) + state.velocity(middle)[4]))
    return scene, [middle, tip]


def controlled():
    """Controllers with samples and without, whose loads are on both beams, and a stop."""
    scene, (first, second), (upper, lower) = pendulum()
    tip, middle = second.point("end"), first.point(3)
    scene.add(fl.joints.Limit(upper.angle, upper=0.012, restitution=0.6))
    push = scene.add(fl.PointLoad(tip, force=(0, 0, 10.0)))
    lift = scene.add(fl.LineLoad(first, force=(0, 0, 10.0)))
    turn = scene.add(fl.PointLoad(first.point(2), force=(0, 0, 10.0)))

    def held(state, memory):
        gap, turned = state.position(middle)[2], state.coordinate(lower)
        total = memory[0] - gap
        return [50.0 * turned - 20.0 * gap, 10.0 * total - state.velocity(tip)[2]], [total]

    def gap(state):
        return -state.position(tip)[2] - 0.1 * state.coordinate(upper)

    scene.add(Controller(held, [push, lift], period=5e-3, memory=[0.0]))
    scene.add(
        ContinuousController(
            rate=lambda state, x: [gap(state), (gap(state) - x[1]) / 0.01],
            output=lambda state, x: 9.0 * gap(state) + 5.0 * x[0] + 2.0 * (gap(state) - x[1]),
            actuators=[turn],
            initial=[0.0, 0.1],
        )
    )
    return scene, [middle, tip]


def failing():
    """A condition that asks for a point and then fails, on one rank only."""
    scene, (first, second), _ = pendulum()

    def here_only(state):
        height = state.position(first.point(2))[2]
        if MPI.COMM_WORLD.rank == MPI.COMM_WORLD.size - 1 and state.time > 3.0 * STEP:
            raise ValueError("only here")
        return height + state.position(second.point("end"))[2] - 1.0

    scene.add(Event(here_only, fl.schemes.Stop()))
    return scene


RUNS = {
    "stops": (stops, STEP),
    "latched": (latched, STEP),
    "controlled": (controlled, STEP),
    "adaptive": (latched, fl.schemes.AdaptiveStep(0.1, first=1e-3)),
}
DURATION = 0.05


def numbers(found, points):
    """Motion, forces, and all that happened."""
    steps = found.steps
    return {
        "events": steps.event_numbers,
        "event times": steps.event_times,
        "event losses": steps.event_losses,
        "times": found.times,
        "sensors": steps.sensor_values,
        **{f"position {k}": found.position(point) for k, point in enumerate(points)},
        **{f"velocity {k}": found.velocity(point) for k, point in enumerate(points)},
        "coordinates": found.joint_coordinates,
        "joint forces": found.joint_forces,
        "energies": np.array([found.kinetic, found.elastic, found.potential]),
        "balance": found.balance,
    }


def runs(folder):
    """Results of runs that write files."""
    found = {}
    for name, (build, step) in RUNS.items():
        scene, points = build()
        given = {"duration": DURATION, "step": step, "progress": False}
        file = folder / f"{name}.h5"
        run = SCHEME.run(scene, file=file, checkpoint_every=EVERY, **given)
        found |= {f"{name}: {what}": each for what, each in numbers(run, points).items()}
    return found


def resumed(folder):
    """Results of these runs, resumed from their last checkpoint but one."""
    found = {}
    for name, (build, _) in RUNS.items():
        scene, points = build()
        file = divided_adaptive.killed(folder / f"{name}.h5")
        run = SCHEME.resume(scene, file, progress=False)
        found |= {f"{name}: {what}": each for what, each in numbers(run, points).items()}
    return found


def message():
    """Message of all ranks about a function that fails on one."""
    try:
        SCHEME.run(failing(), duration=DURATION, step=STEP, progress=False)
    except fl.ConvergenceError as error:
        return str(error)
    return "nothing has failed"


if __name__ == "__main__":
    divided_scenes.divide()
    with divided_conserving.log_of_division() as said:
        found = {"runs": runs, "resumed": resumed}[sys.argv[2]](Path(sys.argv[3]))
    found["divided"] = np.array(all(" are shared" in message for message in said))
    found["messages"] = np.array(MPI.COMM_WORLD.allgather(message()))
    if MPI.COMM_WORLD.rank == 0:
        np.savez(sys.argv[1], **found)
