"""Answers requests with runs of this library, as the peers do with theirs.

A request is a line of JSON: ``scene`` and its size, or a description of rigid bodies
(``descriptions``, ``contacts``), ``step`` and ``duration`` or ``load_steps``, and a ``way``. Of
flexible bodies all states are kept, with energies and joint forces: nothing is chosen otherwise. Of
rigid bodies only the end is kept, without energies, as the peers do. Seconds are those of
``result.seconds``, by the clock of the processor.
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
from demos.bend45 import FORCE
from demos.double_pendulum import pendulum
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
    "Munthe-Kaas": fl.schemes.MuntheKaas(),
    "reference": fl.GeneralisedAlpha(radius=0.8, tolerance=1e-11),
}
FRAMES, ADAPTIVE = "frames alone", "adaptive steps"
FRAMES_ALONE = f"generalised-α, {FRAMES}"
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
        return statics(request) if request.get("scene") in STATICS else motion(request)
    except fl.ConvergenceError as error:
        return {"failed": str(error)}


# --- in time --------------------------------------------------------------------------------------


def motion(request: Request) -> dict[str, Any]:
    """Where the probe is at the end, and what it took."""
    made = rigid_bodies(request) if "bodies" in request else MOTIONS[request["scene"]](request)
    scheme, _, more = request["way"].partition(", ")
    result = SCHEMES[scheme].run(made.scene, **plan_of(request, more), progress=False)
    return {
        "place": made.probe(result).tolist(),
        "seconds": result.seconds,
        "steps": steps_of(result, request),
        "iterations": int(result.iterations[-1]),
        "matrices": result.factorisations,
        "unknowns": unknowns(made.scene),
        "settings": "defaults",
    }


def plan_of(request: Request, more: str) -> dict[str, Any]:
    """Duration, steps, and what is kept."""
    duration, step = request["duration"], request["step"]
    plan: dict[str, Any] = {"duration": duration, "step": step}
    if more == ADAPTIVE:
        plan["step"] = fl.schemes.AdaptiveStep(request["tolerance"])
    if "bodies" in request:
        plan["save_every"] = max(1, round(duration / step))
    if "bodies" in request or more == FRAMES:
        plan["record"] = fl.schemes.Record.FRAMES
    return plan


def steps_of(result: fl.Result, request: Request) -> int:
    """Number of steps of a run."""
    chosen = result.steps
    return round(request["duration"] / request["step"]) if chosen is None else len(chosen.sizes)


def unknowns(scene: fl.Scene) -> int:
    """Of nodes and joints."""
    spherical = sum(3 for joint in scene.joints if isinstance(joint, fl.joints.Spherical))
    revolute = sum(5 for joint in scene.joints if isinstance(joint, fl.joints.Revolute))
    return 6 * sum(len(body.frames) for body in scene.bodies) + spherical + revolute


def double_pendulum(request: Request) -> Motion:
    scene, _, two = pendulum(request["case"], request["elements"])
    return Motion(scene, lambda result: result.position(two.point("end"))[-1])


def rigid_bodies(request: Request) -> Motion:
    """Bodies, joints and contacts as they are described."""
    scene, centres = fl.Scene(gravity=request["gravity"]), []
    for given in request["bodies"]:
        body = scene.add(fl.RigidBody(given["mass"], given["inertia"], given["centre"]))
        centres.append(body.point("centre"))
        body.add_velocity(given["velocity"], omega=given["spin"], about=given["centre"])
        if "force" in given:
            scene.add(fl.PointLoad(body.point("centre"), given["force"]))
    for joint in request["joints"]:
        before, after = (fl.ground() if k is None else centres[k] for k in joint["bodies"])
        scene.add(fl.joints.Spherical(before, after, at=joint["at"]))
    add_contacts(scene, request)
    at = request["probe"]
    k = at["body"]
    arm = np.subtract(at["at"], request["bodies"][k]["centre"])
    return Motion(scene, lambda result: material(result, k, arm))


def impact(request: Request, mass: float) -> fl.contact.Impact:
    """Rigid contact."""
    return fl.contact.Impact(request["friction"], request["restitution"])


def penalty(request: Request, mass: float) -> fl.contact.Penalty:
    """A spring and a damper between a ball that carries a mass and a wall."""
    frequency, ratio = request["frequency"], request["damping_ratio"]
    stiffness, damping = mass * frequency**2, 2 * ratio * mass * frequency
    return fl.contact.Penalty(stiffness, damping, friction=request["friction"])


LAWS: dict[str, Callable[[Request, float], fl.contact.Impact | fl.contact.Penalty]] = {
    "impacts": impact,
    "penalty": penalty,
    "undamped penalty": lambda request, mass: penalty(request | {"damping_ratio": 0.0}, mass),
}


def add_contacts(scene: fl.Scene, request: Request) -> None:
    """All balls touch all walls, and each other if they are said to."""
    balls = request.get("balls", [])
    if not balls:
        return
    points = [scene.bodies[ball["body"]].point(ball["at"]) for ball in balls]
    (radius,) = {ball["radius"] for ball in balls}
    owners = [ball["body"] for ball in balls]
    (mass,) = {request["bodies"][k]["mass"] / owners.count(k) for k in owners}
    law = LAWS[request["way"].partition(", ")[2]](request, mass)
    surface = fl.contact.Vertices(points, radius)
    for wall in request["walls"]:
        held = fl.ground() if wall["body"] is None else scene.bodies[wall["body"]].point("centre")
        plane = fl.contact.Plane(held, wall["normal"], wall["at"])
        scene.add(fl.contact.Contact(surface, plane, law))
    if "touch" in request:
        scene.add(fl.contact.Contact(surface, surface, law))


def material(result: fl.Result, node: int, arm: Array) -> Array:
    """The place of a point of a rigid body at the end."""
    frame = result.frames[-1, node]
    return np.asarray(frame[0] + arm @ frame[1:])


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
}
STATICS: dict[str, Callable[[Request], tuple[Array, Any, int]]] = {
    "45° bend": bend,
    "roll-up": rollup,
    "hemisphere": hemisphere,
    "plate": plate,
}


if __name__ == "__main__":
    main()
