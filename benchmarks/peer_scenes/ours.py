"""Answers requests with runs of this library, as the peers do with theirs.

A request is a line of JSON: ``scene`` and its size, ``step`` and ``duration`` or ``load_steps``,
and a ``way``. All states are kept, with energies and joint forces: nothing is chosen otherwise.
Seconds are those of ``result.seconds``, by the clock of the processor.
"""

from __future__ import annotations

import json
import logging
import sys
from collections.abc import Callable
from time import process_time
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

import fem_lie as fl
from benchmarks.everyday_rows import plate as bent
from benchmarks.scale import chain
from demos.bend45 import FORCE
from demos.double_pendulum import pendulum
from demos.free_rigid_body import SPIN, spinning
from demos.hemisphere import FORMULATIONS, RADIUS, pinched, quarter
from demos.rollup import cantilever
from fem_lie._jit import progress
from fem_lie.solve import progress_bars
from fem_lie.solve.motion.integrator import Integrator

Request = dict[str, Any]
Array = npt.NDArray[np.float64]
SCHEMES: dict[str, Integrator] = {
    "generalised-α": fl.GeneralisedAlpha(radius=0.8),
    "energy-momentum": fl.EnergyMomentum(),
    "energy-decaying": fl.EnergyDecaying(radius=0.8),
    "reference": fl.GeneralisedAlpha(radius=0.8, tolerance=1e-11),
}
FRAMES_ALONE = "generalised-α, frames alone"
"""As the first scheme, of which no more is recorded than where bodies are: peers keep nothing."""
BEAMS: dict[str, fl.elements.BeamFormulation] = {
    "geodesic": fl.elements.GeodesicBeam(),
    "directors of degree 2": fl.elements.DirectorBeam(2),
}


class Motion(NamedTuple):
    """A scene, and the position of its probe in a result."""

    scene: fl.Scene
    probe: Callable[[fl.Result], Array]


def main() -> None:
    """Answer until the input ends."""
    logging.disable(logging.WARNING)
    use_processor_time()
    print(json.dumps({"ready": "fem_lie"}), flush=True)
    for text in sys.stdin:
        print(json.dumps(answer(json.loads(text))), flush=True)


def use_processor_time() -> None:
    """Time runs, and the compilation in them, which does not count, by the processor's clock."""
    for module in (progress_bars, progress):
        module.perf_counter = process_time


def answer(request: Request) -> dict[str, Any]:
    """One run; its seconds are those of the processor."""
    try:
        return statics(request) if request["scene"] in STATICS else motion(request)
    except fl.ConvergenceError as error:
        return {"failed": str(error)}


# --- in time --------------------------------------------------------------------------------------


def motion(request: Request) -> dict[str, Any]:
    """Where the probe is at the end, and what it took."""
    made = MOTIONS[request["scene"]](request)
    way, record = request["way"], fl.schemes.Record.ALL
    if way == FRAMES_ALONE:
        way, record = "generalised-α", fl.schemes.Record.FRAMES
    plan = {"duration": request["duration"], "step": request["step"], "progress": False}
    result = SCHEMES[way].run(made.scene, record=record, **plan)
    return {
        "place": made.probe(result).tolist(),
        "seconds": result.seconds,
        "steps": len(result.times) - 1,
        "iterations": int(result.iterations[-1]),
        "matrices": result.factorisations,
        "unknowns": unknowns(made.scene),
        "settings": "defaults",
    }


def unknowns(scene: fl.Scene) -> int:
    """Of nodes and joints."""
    spherical = sum(3 for joint in scene.joints if isinstance(joint, fl.joints.Spherical))
    revolute = sum(5 for joint in scene.joints if isinstance(joint, fl.joints.Revolute))
    return 6 * sum(len(body.frames) for body in scene.bodies) + spherical + revolute


def double_pendulum(request: Request) -> Motion:
    scene, _, two = pendulum(request["case"], request["elements"])
    return Motion(scene, lambda result: result.position(two.point("end"))[-1])


def rigid_chain(request: Request) -> Motion:
    scene = chain(request["bodies"])
    half = scene.bodies[-1].frames[0, 0, 0] - scene.bodies[-2].frames[0, 0, 0]
    return Motion(scene, lambda result: material(result, -1, (half / 2, 0.0, 0.0)))


def free_body(request: Request) -> Motion:
    return Motion(spinning(SPIN[np.newaxis]), lambda result: material(result, 0, (1.0, 1.0, 1.0)))


def material(result: fl.Result, node: int, arm: tuple[float, ...]) -> Array:
    """The place of a point of a rigid body at the end."""
    frame = result.frames[-1, node]
    return np.asarray(frame[0] + np.array(arm) @ frame[1:])


# --- equilibrium ----------------------------------------------------------------------------------


def statics(request: Request) -> dict[str, Any]:
    """Where the probe is, and what it took."""
    position, result, count = STATICS[request["scene"]](request)
    loads = result.load_steps > len(result.factors)
    return {
        "place": position.tolist(),
        "seconds": result.seconds,
        "steps": result.load_steps,
        "iterations": int(result.total_iterations),
        "matrices": int(result.total_iterations),
        "unknowns": count,
        "settings": "load-capped arc length" if loads else f"{request['load_steps']} load steps",
    }


def arc(elements: int, formulation: fl.elements.BeamFormulation) -> tuple[fl.Scene, fl.Beam]:
    """The bend of demos/bend45.py, meshed by a function."""
    EA, GA, EI = 1e7, 5e6, 1e7 / 12

    def position(t: float) -> list[float]:
        return [100 * np.sin(t * np.pi / 4), 100 * (1 - np.cos(t * np.pi / 4)), 0.0]

    section = fl.Section.from_stiffness([EA, GA, GA, EI, EI, EI])
    scene = fl.Scene()
    beam = scene.add(fl.Beam.curve(position, section, cells=elements, formulation=formulation))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, FORCE)))
    return scene, beam


def bend(request: Request) -> tuple[Array, fl.StaticResult, int]:
    scene, beam = arc(request["elements"], BEAMS[request["way"]])
    result = fl.statics(scene, load_steps=request["load_steps"])
    return result.position(beam.point("end"))[-1], result, 6 * len(beam.frames)


def rollup(request: Request) -> tuple[Array, fl.StaticResult, int]:
    scene, beam = cantilever(request["elements"], request["stiffness_ratio"])
    result = fl.statics(scene, load_steps=request["load_steps"])
    return result.position(beam.point("end"))[-1], result, 6 * len(beam.frames)


def hemisphere(request: Request) -> tuple[Array, fl.StaticResult, int]:
    scene = pinched(request["thickness"], quarter(request["cells"]), FORMULATIONS[request["way"]])
    result = fl.follow_loads(scene)
    outward = result.position("hemisphere.00")[-1, 0] - RADIUS
    inward = RADIUS - result.position("hemisphere.10")[-1, 1]
    return np.array([outward, inward]), result, 5 * len(scene.bodies[0].frames)


def plate(request: Request) -> tuple[Array, fl.StaticResult, int]:
    scene = bent.plate(request["cells"])
    result = fl.follow_loads(scene)  # as statics does with shells
    moved = result.position("plate.10")[-1] - (bent.SIDE, 0.0, 0.0)
    return moved, result, 5 * len(scene.bodies[0].frames)


MOTIONS: dict[str, Callable[[Request], Motion]] = {
    "double pendulum": double_pendulum,
    "chain": rigid_chain,
    "free body": free_body,
}
STATICS: dict[str, Callable[[Request], tuple[Array, Any, int]]] = {
    "45° bend": bend,
    "roll-up": rollup,
    "hemisphere": hemisphere,
    "plate": plate,
}


if __name__ == "__main__":
    main()
