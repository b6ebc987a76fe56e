"""Which scheme runs which bodies, joints and loads, and whether it is right: a table of the docs.

    python3 -m benchmarks.what_works --save what_works.jsonl [--write]

Every scheme makes three steps of every scene of :mod:`tests.combinations`: each kind of body alone,
with each joint, and with each load. A combination

- works if frames and joint forces at the end are those of generalised-α with steps a quarter as
  large; or those of the scheme itself with such steps, as inertia is lumped in explicit schemes,
  and drilling rotations of shells have an inertia in all but generalised-α;
- is refused if the package says so by an error of its own that has words;
- failed in all other cases: another error, steps that do not converge, numbers that are none,
  frames or joint forces that differ by more than :data:`TOLERANCES`, joints that are violated by
  more than :data:`VIOLATED`, or energy that is not accounted for within :data:`BALANCED`.

An interrupted run continues from the file of results. ``--write`` replaces the tables in
docs/measured/what_works.md. ``--short`` runs a short list only: all bodies, all joints of a beam
and of a rigid body, and loads at the end of nine bodies with and without a history and damping.
"""

from __future__ import annotations

import argparse
import re
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

import fem_lie as fl
from benchmarks.progress import Progress
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.lie.node_types import NodeType, has_position
from fem_lie.solve.motion.integrator import Integrator
from tests.combinations import BODIES, JOINTS, free, joined
from tests.combined_loads import AT_POINTS, CHANGING, LOADS, loaded, variants
from tests.scene_builder import Built, build
from tests.scene_data import SceneData

PACKAGE = Path(fl.__file__).parent
PAGE = Path(__file__).parents[1] / "docs" / "measured" / "what_works.md"
GROUPS = ("body", "joint", "load")
SHORT_JOINED = ("beam, geodesic", "rigid body")
SHORT_LOADED = (
    *SHORT_JOINED,
    "discrete rod",
    "Hermite cable",
    "ANCF beam",
    "shell, Hellinger-Reissner",
    "thin shell",
    "solid, hexahedra 1",
    "reduced-order beam",
)
"""Bodies of the short list with joints and with loads."""
SCHEMES: dict[str, Callable[[Built], Integrator]] = {
    "GeneralisedAlpha": lambda built: fl.GeneralisedAlpha(),
    "GeneralisedAlpha, index 2": lambda built: fl.GeneralisedAlpha(
        index=fl.schemes.ConstraintIndex.STABILISED_TWO
    ),
    "EnergyMomentum": lambda built: fl.EnergyMomentum(),
    "EnergyDecaying": lambda built: fl.EnergyDecaying(),
    "Composed": lambda built: fl.schemes.Composed(),
    "Variational": lambda built: fl.schemes.Variational(),
    "Explicit": lambda built: fl.Explicit(),
    "Asynchronous": lambda built: fl.schemes.Asynchronous(),
    "Hamel": lambda built: fl.schemes.Hamel(),
    "MultiRate": lambda built: fl.schemes.MultiRate({built.bodies["body"]: 3}),
    "MuntheKaas": lambda built: fl.schemes.MuntheKaas(),
}
FINER = 4
"""Steps of the reference in one of a scheme."""
LUMPED = ("Explicit", "Asynchronous")
TOLERANCES = (5e-3, 6e-2)
"""Errors of frames over the largest displacement beyond free flight, and of joint forces over
the largest one."""
VARYING = (6e-2, 2e-1)
"""The same where a load or a motion changes by its size within the three steps."""
VIOLATED = 1e-9
"""Largest violation of a joint, of scenes of length one; of those that bind velocities, too."""
BALANCED = (1e-4, 2e-1)
"""Relative errors of the balance of energy in schemes of second order, and where what acts changes
by its size."""
EXACT = ("EnergyMomentum", "EnergyDecaying", "Composed", "MultiRate")
ROUND_OFF = 1e-6
"""Schemes whose balance is exact, and what is round-off of it where a scene has hardly moved."""
_REFUSALS = (ValueError, TypeError, NotImplementedError)


class Combination(NamedTuple):
    """A scheme and a scene.

    Attributes:
        group: "body", "joint" or "load".
        body: Its kind.
        what: Which joint or load; of a body alone nothing.
        variant: Of a load: with a history, with damping.
        scheme: Its name.
    """

    group: str
    body: str
    what: str
    variant: str
    scheme: str

    @property
    def tolerances(self) -> tuple[float, float]:
        """Errors of frames and joint forces that a scheme of second order may have."""
        return VARYING if self.varies else TOLERANCES

    @property
    def varies(self) -> bool:
        """Whether a load or a motion changes by its size within the three steps."""
        return "history" in self.variant or self.what in CHANGING

    @property
    def short(self) -> bool:
        """Whether it is on the short list."""
        if self.group == "joint":
            return self.body in SHORT_JOINED
        return self.group == "body" or (self.body in SHORT_LOADED and self.what in AT_POINTS)

    @property
    def data(self) -> SceneData:
        """The scene."""
        if self.group == "body":
            return free(self.body)
        if self.group == "joint":
            return joined(self.body, self.what)
        return loaded(self.body, self.what, self.variant)


class Outcome(NamedTuple):
    """What came of a combination.

    Attributes:
        verdict: "works", "refused" or "failed".
        words: Of the refusal or failure.
        errors: As :data:`TOLERANCES`, if it ran.
    """

    verdict: str
    words: str = ""
    errors: tuple[float, float] | None = None


def combinations() -> Iterator[Combination]:
    """All of them; those of one scene follow each other."""
    scenes = [("body", body, "", "") for body in BODIES]
    scenes += [("joint", body, joint, "") for joint in JOINTS for body in BODIES]
    scenes += [
        ("load", body, load, variant)
        for load in LOADS
        for body in BODIES
        for variant in variants(body, load)
    ]
    return (Combination(*given, scheme) for given in scenes for scheme in SCHEMES)


class End(NamedTuple):
    """Of a run.

    Attributes:
        rows: Positions, directors and slopes of all nodes, shape (n, 3).
        forces: Of all joints, shape (m, 6).
        violation: Largest one of a joint in the run.
        unbalanced: Relative error of the balance of energy.
    """

    rows: np.ndarray
    forces: np.ndarray
    violation: float
    unbalanced: float


@lru_cache(maxsize=1)
def built_scene(group: str, body: str, what: str, variant: str) -> tuple[SceneData, Built]:
    """A scene that all schemes run, so that its elements are set up once."""
    data = Combination(group, body, what, variant, "").data
    return data, build(data)


def end(given: Combination, finer: int = 1) -> End:
    """Run a combination, with steps that are ``finer`` times as small."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data, built = built_scene(*given[:4])
        result = SCHEMES[given.scheme](built).run(
            built.scene.with_loads(*built.scene.loads),
            duration=data.duration,
            step=data.duration / data.steps / finer,
            progress=False,
        )
    rows = _rows(result.frames[-1], result.info.node_types)
    violation = _largest(result.joint_violations)
    return End(rows, np.asarray(result.joint_forces[-1]), violation, float(result.balance_error))


_VECTORS = {
    NodeType.FRAME: slice(1, 4),
    NodeType.POSITION_GRADIENT: slice(1, 2),
    NodeType.SURFACE_GRADIENT: slice(1, 3),
    NodeType.MIXED_DERIVATIVE: slice(1, 3),
}
"""Rows that are directors or slopes."""


def _rows(H: np.ndarray, kinds: np.ndarray) -> np.ndarray:
    """Positions, directors and slopes of the nodes that have them, shape (n, 3)."""
    found = [H[has_position(kinds), 0]]
    found += [H[kinds == kind, rows].reshape(-1, 3) for kind, rows in _VECTORS.items()]
    return np.concatenate(found)


class Reference(NamedTuple):
    """The end with smaller steps, and how far forces moved it from free flight."""

    end: End
    moved: float


@lru_cache(maxsize=2)
def reference(given: Combination) -> Reference:
    """What a combination gives with smaller steps."""
    data, built = built_scene(*given[:4])
    found, info = end(given, FINER), SceneInfo.of(built.scene.bodies)
    H = np.concatenate([body.frames for body in built.scene.bodies])
    rates = np.cross(data.spin, H - np.array([data.about, *np.zeros((3, 3))]))
    rates[:, 0] += data.velocity
    flight = _rows(H + data.duration * rates, info.node_types)
    least = 0.5 * data.duration**2  # by an acceleration of 1, where what is held does not move
    return Reference(found, max(least, _largest(found.rows - flight)))


def outcome(given: Combination) -> Outcome:
    """Run a combination."""
    try:
        found = end(given)
        own = given.scheme in LUMPED or _has_inertia_of_drilling(given)
        known, moved = reference(given if own else given._replace(scheme="GeneralisedAlpha"))
    except Exception as error:
        return _failure(error)
    scale = max(_largest(known.forces), np.finfo(float).tiny)
    errors = (
        _largest(found.rows - known.rows) / moved,
        _largest(found.forces - known.forces) / scale,
    )
    if not all(error <= most for error, most in zip(errors, given.tolerances, strict=True)):
        said = "frames and joint forces differ from the reference by {:.1e} and {:.1e}"
        return Outcome("failed", said.format(*errors), errors)
    broken = _broken(given, found)
    return Outcome("failed" if broken else "works", broken, errors)


def _has_inertia_of_drilling(given: Combination) -> bool:
    """Whether the scheme has an inertia that generalised-α has not, where shells drill."""
    scene = built_scene(*given[:4])[1].scene
    drills = any(scene.has_drilling(body) for body in scene.bodies if isinstance(body, fl.Shell))
    return drills and not given.scheme.startswith("GeneralisedAlpha")


def _broken(given: Combination, found: End) -> str:
    """Which law a run breaks, in words; empty if it keeps all."""
    if not found.violation <= VIOLATED:
        return f"joints are violated by {found.violation:.1e}"
    most = ROUND_OFF if given.scheme in EXACT else BALANCED[given.varies]
    if not found.unbalanced <= most:
        return f"the balance of energy has an error of {found.unbalanced:.1e}"
    return ""


def _largest(values: np.ndarray) -> float:
    """Of all components; what is no number stays none."""
    return float(np.abs(values).max(initial=0.0))


def _failure(error: Exception) -> Outcome:
    """A refusal is raised by the package itself, and has words."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    own = PACKAGE in Path(last.filename).parents and (last.line or "").startswith("raise")
    said = type(error) in _REFUSALS and own and str(error)
    name = "" if said else f"{type(error).__name__}: "
    return Outcome("refused" if said else "failed", name + str(error))


def outcomes_of(wanted: Iterable[Combination], progress: Progress) -> dict[Combination, Outcome]:
    """Outcomes of all that are wanted, of which some may be known."""
    return {
        given: Outcome(*progress.result(" | ".join(given), partial(outcome, given)))
        for given in wanted
    }


# ---- the tables


_NAMES = {
    r"got the \w+ 'body'": "got another body",
    r"got \w+ between [\w, ]+;": "got something else;",
    r"\bbody\.(start|end|node \d|\d\d|a=\d)": "a point of body",
    r"\bnode \d+ of body": "a node of body",
    r"have positions( and (position|surface) gradients)?:": "have positions:",
}
"""What messages name, and what notes have instead, so that there are few of them."""


def general(words: str) -> str:
    """A message without the class, points and nodes of the body."""
    for name, instead in _NAMES.items():
        words = re.sub(name, instead, words)
    return words


class Notes:
    """Refusals and failures, each with a number; a cell of a table has the numbers."""

    def __init__(self) -> None:
        """There are none yet."""
        self.words: dict[str, int] = {}

    def cell(self, found: Iterable[Outcome]) -> str:
        """Of all outcomes of a cell: whether some work, and the numbers of what others say."""
        outcomes = list(found)
        said = dict.fromkeys(f"**failed**: {o.words}" for o in outcomes if o.verdict == "failed")
        said |= dict.fromkeys(general(o.words) for o in outcomes if o.verdict == "refused")
        numbers = sorted(self.words.setdefault(words, len(self.words) + 1) for words in said)
        works = any(o.verdict == "works" for o in outcomes)
        return " ".join(["✓"] * works + [str(number) for number in numbers])


HEADING = "## Schemes, bodies, joints and loads"
_INTRODUCTION = (
    "`RUN -m benchmarks.what_works --write` makes these tables: three steps of every scheme with "
    "every body alone, joined at its end to a rigid body (or to ground, where it rolls), and under "
    "every load, with and without a history and damping.",
    "✓: frames are within {0:g} of the displacement by forces, and joint forces within {1:g} of "
    "the largest, of generalised-α with a quarter of the step (explicit schemes, and all "
    "others where shells drill: of themselves); "
    "{2:g} and {3:g}, where a load or motion changes by its size in the three steps. A number: "
    "refused, with this message; `body` and `other` are names of bodies.",
    "A cell of the tables of joints and loads is of all bodies that the scheme supports alone: ✓ "
    "and numbers, if some work and others are refused. Of {4} combinations {5} work, {6} are "
    "refused, and {7} failed; of {8} on the short list (`--short`) {9} work. Those that work "
    "satisfy their joints within {10:g}, and account for their energy within {11:g} in schemes "
    "that conserve it, {12:g} in others ({13:g} where something changes by its size).",
)


def tables(outcomes: dict[Combination, Outcome]) -> str:
    """The section of the docs, in Markdown."""
    notes, count = Notes(), Counter(found.verdict for found in outcomes.values())
    working = [c for c, found in outcomes.items() if found.verdict == "works"]
    alone = {(c.body, c.scheme) for c in working if c.group == "body"}
    counts = len(outcomes), count["works"], count["refused"], count["failed"]
    short = [found.verdict == "works" for c, found in outcomes.items() if c.short]
    counts = *counts, len(short), sum(short), VIOLATED, ROUND_OFF, *BALANCED
    lines = [HEADING, "", *(line.format(*TOLERANCES, *VARYING, *counts) for line in _INTRODUCTION)]
    for group, names in (("body", BODIES), ("joint", JOINTS), ("load", LOADS)):
        cells: dict[tuple[str, str], list[Outcome]] = {}
        for c, found in outcomes.items():
            if c.group == group and (group == "body" or (c.body, c.scheme) in alone):
                row = c.body if group == "body" else c.what
                cells.setdefault((row, c.scheme), []).append(found)
        lines += ["", f"| {group} | " + " | ".join(f"`{name}`" for name in SCHEMES) + " |"]
        lines += ["|---" * (1 + len(SCHEMES)) + "|"]
        for name in names:
            row = (notes.cell(cells.get((name, scheme), ())) for scheme in SCHEMES)
            lines.append(f"| {name} | " + " | ".join(row) + " |")
    lines += ["", *(f"{number}. {words}" for words, number in notes.words.items()), ""]
    return "\n".join(lines)


def write(outcomes: dict[Combination, Outcome]) -> None:
    """Replace the section of the docs."""
    text = PAGE.read_text(encoding="utf-8")
    before, _, rest = text.partition(HEADING)
    _, mark, after = rest.partition("\n## ")
    PAGE.write_text(before + tables(outcomes) + mark + after, encoding="utf-8")


def main() -> None:
    """Run all, print the tables and what failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--save", type=Path, help="file of results, to continue from")
    parser.add_argument("--groups", nargs="+", choices=GROUPS, default=GROUPS)
    parser.add_argument("--short", action="store_true", help="the short list alone")
    parser.add_argument("--write", action="store_true", help="into the docs, if all are there")
    given = parser.parse_args()
    if given.write and (given.short or set(given.groups) != set(GROUPS)):
        parser.error("--write needs all groups and the whole list")
    chosen = (c for c in combinations() if c.group in given.groups and (c.short or not given.short))
    outcomes = outcomes_of(chosen, Progress(given.save))
    print(tables(outcomes))
    for combination, found in outcomes.items():
        if found.verdict == "failed":
            print("failed:", *combination, found.words, sep=" | ")
    if given.write:
        write(outcomes)


if __name__ == "__main__":
    main()
