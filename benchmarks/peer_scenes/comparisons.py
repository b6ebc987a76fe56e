"""What is compared: scenes, ways to compute them, resolutions, and references.

Errors are distances of the probe from the same reference for all. References of motions are our
own runs with fine meshes and steps (``peers.py --references`` computes them again), those of the
free body and of contacts their closed forms; those of the bend and of the hemispheres stand in
their demos.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from benchmarks.peer_scenes import contacts, descriptions
from benchmarks.peer_scenes.ours import ADAPTIVE
from benchmarks.peer_scenes.ours import FRAMES_ALONE as LEAST
from demos import bend45, free_rigid_body, hemisphere, rollup
from demos.double_pendulum import STEP

Request = dict[str, Any]
RADIUS = 0.8  # spectral, of all schemes that have one
ROLLED = 1e8  # EA L²/EI


NAMES = {
    "ours": "fem_lie",
    "exudyn": "Exudyn",
    "kratos": "Kratos",
    "mujoco": "MuJoCo",
    "pinocchio": "Pinocchio",
}


class Method(NamedTuple):
    """Who computes, and how; the first of a comparison is what the others are compared with."""

    code: str
    way: str

    @property
    def label(self) -> str:
        """For tables and plots."""
        return f"{NAMES[self.code]}, {self.way}"


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
        own: Resolutions of methods that have others.
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
    own: Mapping[Method, tuple[float, ...]] = MappingProxyType({})

    def resolutions_of(self, method: Method) -> tuple[float, ...]:
        """Those that a method computes."""
        return self.own.get(method, self.resolutions)

    def coarsest(self, method: Method) -> float:
        """The first of them."""
        return max(self.resolutions_of(method), key=_coarseness)

    @property
    def all_resolutions(self) -> tuple[float, ...]:
        """Those of any method, from coarse to fine."""
        found = {*self.resolutions}.union(*self.own.values())
        return tuple(sorted(found, key=_coarseness, reverse=True))

    def error(self, position: list[float]) -> float:
        """Of a probe; of hemispheres the larger one of both deflections, relative."""
        gap = np.subtract(position, self.reference)
        if len(self.reference) == 2:
            return float(np.abs(gap / self.reference).max())
        return float(np.linalg.norm(gap) / self.size)


def _coarseness(resolution: float) -> float:
    """Steps are below one, and coarse where large; numbers of cells are coarse where small."""
    return resolution if resolution < 1 else 1 / resolution


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


# --- rigid bodies, which all codes are asked by the same description ------------------------------

ADAPTED = 1e6  # m/s⁴
EXPLICIT = Method("ours", "Munthe-Kaas")
CHOSEN = Method("ours", f"Munthe-Kaas, {ADAPTIVE}")
PINOCCHIO, MUJOCO = Method("pinocchio", "RK4"), Method("mujoco", "RK4")
MINIMAL, RK44 = Method("exudyn", "minimal coordinates, explicit"), Method("exudyn", "explicit")


def rigid(scene: Request, duration: float) -> Callable[[Method, float], Request]:
    """Requests for a motion of rigid bodies with a step.

    The tolerance of adaptive steps is such that their mean is about the given one.
    """

    def request(method: Method, step: float) -> Request:
        asked = scene | {"code": method.code, "way": method.way, "step": step, "radius": RADIUS}
        if method == CHOSEN:
            asked["tolerance"] = ADAPTED * step**3
        return asked | {"duration": duration}

    return request


def rigid_chain(end: tuple[float, ...], bodies: int = 28, duration: float = 0.5) -> Comparison:
    scene = descriptions.chain(bodies)
    steps = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4)
    return Comparison(
        "chain",
        f"Chain of {bodies} rigid bodies",
        (ALPHA, *NEWTONS),
        steps,
        1e-3,
        rigid(scene, duration),
        end,
        duration=duration,
        fine=fine(scene, 2e-5, duration),
    )


LENGTH, MASS = 2.0, 3.0
CHAIN_ENDS = {
    30: (-0.4709166393790, 0.0, -1.7141021884205),
    100: (-0.4667928269374, 0.0, -1.6943533586585),
    300: (-0.4652413058373, 0.0, -1.6923528565585),
}
IMPLICIT_STEPS = (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5)


def tree(
    links: int,
    base: float,
    explicit: tuple[float, ...],
    methods: Mapping[Method, tuple[float, ...]],
    end: tuple[float, ...],
    finest: float,
    duration: float = 0.7,
) -> Comparison:
    """A chain of 2 m and 3 kg that falls from the horizontal; ``explicit`` are our own steps."""
    link, mass = LENGTH / links, MASS / links
    scene = descriptions.chain(links, link, mass, 0.1 * link)
    return Comparison(
        f"chain{links}",
        f"Chain of {links} links",
        (EXPLICIT, *methods),
        explicit,
        base,
        rigid(scene, duration),
        end,
        duration=duration,
        fine=scene | {"way": EXPLICIT.way, "step": finest, "duration": duration},
        own=methods,
    )


def trees() -> list[Comparison]:
    """Methods with the steps that they can afford."""
    coarse = (7e-3, 5e-3, 3.5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
    middle = (2e-3, 1.4e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2.5e-5)
    short = (2.5e-4, 2e-4, 1.4e-4, 1e-4, 7e-5, 5e-5, 2.5e-5)
    return [
        tree(
            30,
            1e-3,
            coarse,
            {
                CHOSEN: coarse,
                ALPHA: IMPLICIT_STEPS,
                PINOCCHIO: coarse,
                MUJOCO: coarse,
                NEWTONS[0]: IMPLICIT_STEPS,
                MINIMAL: coarse[:-1],
            },
            CHAIN_ENDS[30],
            2.5e-5,
        ),
        tree(
            100,
            1e-3,
            middle,
            {
                CHOSEN: middle,
                ALPHA: IMPLICIT_STEPS[:-1],
                PINOCCHIO: middle,
                MUJOCO: middle[:-2],
                NEWTONS[0]: IMPLICIT_STEPS[:-1],
                MINIMAL: middle[:3],
            },
            CHAIN_ENDS[100],
            1e-5,
        ),
        tree(300, 2e-4, short, {MUJOCO: (2e-4,)}, CHAIN_ENDS[300], 1e-5),
    ]


def free_body(duration: float = 1.0) -> Comparison:
    end = free_rigid_body.exact(np.array([duration]))[0] @ np.ones(3)
    steps = (2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
    return Comparison(
        "free_body",
        "Free rigid body",
        (EXPLICIT, ALPHA, NEWTONS[0], RK44, PINOCCHIO, MUJOCO),
        steps,
        1e-3,
        rigid(descriptions.spinning(), duration),
        tuple(end),
        duration=duration,
    )


# --- contacts -------------------------------------------------------------------------------------

IMPACTS, PENALTY = (Method("ours", f"generalised-α, {law}") for law in ("impacts", "penalty"))
CONSERVING = Method("ours", "energy-momentum, undamped penalty")
STIFF, SOFT = (Method("mujoco", f"{kind} contact") for kind in ("stiff", "default"))
SPRINGS = Method("mujoco", "spring and damper")
FARTHEST = 16  # of the balls of the pile
PILE_END = (-0.10479682, -0.08740849, 0.12300386)
ROD_END = (-0.14036771, -0.41204831, -0.82736859)
CONTACT_STEPS = (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5)


def contact(
    key: str,
    title: str,
    scene: Request,
    methods: Mapping[Method, tuple[float, ...]],
    end: tuple[float, ...],
    duration: float,
    fine: Request | None = None,
) -> Comparison:
    """A motion in contact; compliant contacts are as stiff as the step allows."""
    asked = rigid(scene, duration)

    def request(method: Method, step: float) -> Request:
        return asked(method, step) | contacts.compliant(scene, step)

    return Comparison(
        key,
        title,
        tuple(methods),
        CONTACT_STEPS,
        1e-3,
        request,
        end,
        duration=duration,
        fine=fine,
        own=methods,
    )


def touching() -> list[Comparison]:
    """Closed forms, and a rod in a box.

    Springs need short steps, and without a damper a block that has stopped vibrates on.
    """
    rigid_steps, springs = (5e-2, 2e-2, 1e-2, *CONTACT_STEPS), CONTACT_STEPS[:-1]
    ours, few = CONTACT_STEPS[:6], CONTACT_STEPS[:4]
    free = {IMPACTS: rigid_steps, STIFF: rigid_steps, SOFT: rigid_steps}
    stepped = {NEWTONS[0]: springs, RK44: springs}
    own = {PENALTY: ours, CONSERVING: few}
    bouncing = {
        IMPACTS: rigid_steps,
        PENALTY: ours,
        Method("ours", "Munthe-Kaas, penalty"): ours,
        SPRINGS: rigid_steps,
        **stepped,
    }
    balls = contacts.pile(20, FARTHEST)
    rod, box = contacts.rod_with_balls(), dict.fromkeys((IMPACTS, STIFF, SOFT), (2e-2, 1e-2, *ours))
    return [
        contact(
            "sliding_ball",
            "Ball that slides, then rolls",
            contacts.thrown(),
            free | own | stepped,
            tuple(contacts.thrown_end(0.3)),
            0.3,
        ),
        contact(
            "bouncing_ball",
            "Ball that bounces, e = 0.8",
            contacts.dropped(),
            bouncing,
            tuple(contacts.dropped_end(0.9)),
            0.9,
        ),
        contact(
            "block",
            "Block that stops on a slope",
            contacts.block(),
            free | own | stepped,
            tuple(contacts.block_end(1.0)),
            1.0,
        ),
        contact(
            "rod_in_box",
            "Rod in a box, μ = 0.2",
            rod,
            box | {PENALTY: ours[:3], NEWTONS[0]: ours, RK44: ours},
            ROD_END,
            2.0,
            rod | {"way": IMPACTS.way, "step": 2.5e-6, "duration": 2.0},
        ),
        contact(
            "pile",
            "20 balls that come to rest",
            balls,
            box | {NEWTONS[0]: ours[2:3]},
            PILE_END,
            1.0,
            balls | {"way": IMPACTS.way, "step": 1e-5, "duration": 1.0},
        ),
    ]


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
        *trees(),
        free_body(),
        *touching(),
        bend(),
        roll(),
        pinched("hemisphere", 0.04, (*SHELLS, Method("exudyn", "thin plate")), (4, 8, 16, 24), 16),
        pinched("thin_hemisphere", 0.01, SHELLS, (8, 16, 24, 32), 32),
        bent_plate(),
    )
}
