"""What is compared: scenes, ways to compute them, resolutions, and references.

Errors are distances of the probe from the same reference for all. References of motions are our
own runs with fine meshes and steps (``peers.py --references`` makes them anew), that of the free
body is its closed form; those of the bend and of the hemispheres stand in their demos.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from benchmarks.peer_scenes import descriptions
from benchmarks.peer_scenes.ours import FRAMES_ALONE as LEAST
from demos import bend45, free_rigid_body, hemisphere, rollup
from demos.double_pendulum import STEP

Request = dict[str, Any]
RADIUS = 0.8  # spectral, of all schemes that have one
ROLLED = 1e8  # EA L²/EI


class Method(NamedTuple):
    """Who computes, and how; the first of a comparison is what the others are compared with."""

    code: str
    way: str

    @property
    def label(self) -> str:
        """For tables and plots."""
        name = {"ours": "fem_lie", "exudyn": "Exudyn", "kratos": "Kratos"}[self.code]
        return f"{name}, {self.way}"


class Comparison(NamedTuple):
    """One scene at several resolutions.

    Attributes:
        key: Its name on the command line.
        title: Of its plot.
        methods: Who computes it.
        resolutions: Steps, numbers of elements or cells.
        base: Of these, that of the table.
        request: What a method is asked at a resolution.
        reference: The probe.
        size: What distances from it are divided by.
        duration: Seconds of a motion, 0 in statics.
        fine: Of what the reference is the answer, where it is our own.
    """

    key: str
    title: str
    methods: tuple[Method, ...]
    resolutions: tuple[float, ...]
    base: float
    request: Callable[[Method, float], Request]
    reference: tuple[float, ...]
    size: float = 1.0
    duration: float = 0.0
    fine: Request | None = None

    def error(self, position: list[float]) -> float:
        """Of a probe; of hemispheres the larger one of both deflections, relative."""
        gap = np.subtract(position, self.reference)
        if len(self.reference) == 2:
            return float(np.abs(gap / self.reference).max())
        return float(np.linalg.norm(gap) / self.size)


NEWTONS = (Method("exudyn", "modified Newton"), Method("exudyn", "full Newton"))
ALPHA = Method("ours", "generalised-α")
SCHEMES = (ALPHA, Method("ours", "energy-momentum"), Method("ours", "energy-decaying"))
FRAMES_ALONE = Method("ours", LEAST)
KRATOS = Method("kratos", "thin quadrilateral")


# --- in time --------------------------------------------------------------------------------------


def in_time(
    ours: Request, theirs: descriptions.Description, duration: float
) -> Callable[[Method, float], Request]:
    """Requests for a motion with a step."""

    def request(method: Method, step: float) -> Request:
        scene = ours if method.code == "ours" else theirs | {"radius": RADIUS}
        return scene | {"way": method.way, "step": step, "duration": duration}

    return request


def fine(scene: Request, step: float, duration: float) -> Request:
    """A request for a reference."""
    return scene | {"way": "reference", "step": step, "duration": duration}


def double_pendulum(
    case: int, duration: float, steps: tuple[float, ...], end: tuple[float, ...]
) -> Comparison:
    ours = {"scene": "double pendulum", "case": case, "elements": 10}
    return Comparison(
        f"pendulum{case}",
        f"Double pendulum, case {case}",
        (*SCHEMES, *NEWTONS, FRAMES_ALONE),
        steps,
        STEP[case],
        in_time(ours, descriptions.double_pendulum(case, 10), duration),
        end,
        duration=duration,
        fine=fine(ours | {"elements": 40}, STEP[case] / 10, duration),
    )


COARSE = (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
FINER = (5e-3, 2e-3, 1e-3, 1e-4, 1e-5)
THIN_END = (0.65481055, 0.34555242, 0.26035040)


def thin_pendulum_over_elements(duration: float = 0.2, step: float = 1e-4) -> Comparison:
    """Case 2, whose error is that of the mesh."""

    def request(method: Method, elements: float) -> Request:
        n = int(elements)
        ours = {"scene": "double pendulum", "case": 2, "elements": n}
        return in_time(ours, descriptions.double_pendulum(2, n), duration)(method, step)

    return Comparison(
        "pendulum2_mesh",
        "Double pendulum, case 2, over elements",
        (ALPHA, *NEWTONS),
        (3, 5, 10, 20, 40),
        10,
        request,
        THIN_END,
        duration=duration,
    )


def rigid_chain(end: tuple[float, ...], bodies: int = 28, duration: float = 0.5) -> Comparison:
    ours = {"scene": "chain", "bodies": bodies}
    request = in_time(ours, descriptions.chain(bodies), duration)
    steps = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4)
    return Comparison(
        "chain",
        f"Chain of {bodies} rigid bodies",
        (ALPHA, *NEWTONS),
        steps,
        1e-3,
        request,
        end,
        duration=duration,
        fine=fine(ours, 2e-5, duration),
    )


def free_body(duration: float = 1.0) -> Comparison:
    request = in_time({"scene": "free body"}, descriptions.spinning(), duration)
    end = free_rigid_body.exact(np.array([duration]))[0] @ np.ones(3)
    steps = (2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
    methods = (ALPHA, NEWTONS[0], Method("exudyn", "explicit"))
    title = "Free rigid body"
    return Comparison(
        "free_body", title, methods, steps, 1e-3, request, tuple(end), duration=duration
    )


# --- equilibrium ----------------------------------------------------------------------------------


def bend() -> Comparison:
    def request(method: Method, elements: float) -> Request:
        n = int(elements)
        theirs = descriptions.bend(n)
        scene = {"scene": "45° bend", "elements": n} if method.code == "ours" else theirs
        return scene | {"way": method.way, "load_steps": 3}

    methods = (
        Method("ours", "geodesic"),
        Method("ours", "directors of degree 2"),
        Method("exudyn", "geometrically exact"),
    )
    end = tuple(bend45.REFERENCE)
    size = float(np.linalg.norm(end))
    counts = (4, 8, 16, 32, 64)
    return Comparison("bend", "45° bend", methods, counts, 8, request, end, size)


def roll() -> Comparison:
    def request(method: Method, elements: float) -> Request:
        n = int(elements)
        ours = {"scene": "roll-up", "elements": n, "stiffness_ratio": ROLLED}
        scene = ours if method.code == "ours" else descriptions.roll(n, ROLLED)
        return scene | {"way": method.way, "load_steps": 6}

    methods = (Method("ours", "geodesic"), Method("exudyn", "geometrically exact"))
    origin = (0.0, 0.0, 0.0)
    counts, size = (8, 16, 32), rollup.LENGTH
    return Comparison("rollup", "Roll-up", methods, counts, 8, request, origin, size)


def pinched(
    key: str, thickness: float, methods: tuple[Method, ...], cells: tuple[int, ...], base: int
) -> Comparison:
    def request(method: Method, count: float) -> Request:
        n = int(count)
        ours = {"scene": "hemisphere", "thickness": thickness, "cells": n}
        scene = ours if method.code == "ours" else descriptions.pinched(thickness, n)
        # the fewest with which each arrives, of 1, 2, 4, 5, 8, 10 and 20
        return scene | {"way": method.way, "load_steps": 8 if method == KRATOS else 5}

    title = f"Hemisphere, R/t = {hemisphere.RADIUS / thickness:g}"
    _, *deflections = hemisphere.CASES[thickness]
    return Comparison(key, title, methods, cells, base, request, tuple(deflections))


BENT = (-0.32985710, -0.00004093, 0.67084781)


def bent_plate() -> Comparison:
    """The probe is the displacement of a corner of the loaded edge."""

    def request(method: Method, count: float) -> Request:
        n = int(count)
        scene = {"scene": "plate", "cells": n} if method.code == "ours" else descriptions.plate(n)
        return scene | {"way": method.way, "load_steps": 4}

    methods = (Method("ours", "HR"), KRATOS)
    size = float(np.linalg.norm(BENT))
    fine, counts = {"scene": "plate", "cells": 128}, (8, 16, 32, 50)
    return Comparison("plate", "Bent plate", methods, counts, 50, request, BENT, size, fine=fine)


SHELLS = (Method("ours", "HR"), Method("ours", "HR+"), KRATOS)

COMPARISONS: dict[str, Comparison] = {
    made.key: made
    for made in (
        double_pendulum(1, 1.0, COARSE, (-0.25256411, -0.71726063, 0.22332309)),
        double_pendulum(3, 1.0, COARSE, (-0.00854916, -0.34301282, 0.47136792)),
        double_pendulum(2, 0.2, FINER, THIN_END),
        thin_pendulum_over_elements(),
        rigid_chain((2.2186000512, 0.0, -1.2262518657)),
        free_body(),
        bend(),
        roll(),
        pinched("hemisphere", 0.04, (*SHELLS, Method("exudyn", "thin plate")), (4, 8, 16, 24), 16),
        pinched("thin_hemisphere", 0.01, SHELLS, (8, 16, 24, 32), 32),
        bent_plate(),
    )
}
