"""Random small scenes with one argument wrong: an error, or the answer of a scene that is right.

    tools/run python3 -m tests.random_faults 500          # tries; then, if wanted, the first seed

What cannot be meant (not finite, of another shape or kind, out of the range of its quantity, a
point of a body that is not in the scene) must be refused before anything is computed, by an error
of the package that says so. What can be meant (a force the other way round, something very large)
must give a finite motion or a failure of the iteration that says so.
"""

from __future__ import annotations

import sys
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

import fem_lie as fl
from tests.random_scenes import HELD, MOTION, random_scene
from tests.scene_builder import build
from tests.scene_data import PointRef, SceneData, arguments, replaced

STEPS = 3
STRAY = PointRef("stray", "centre")

# quantities that are positive, or at least not negative; a sign that is turned must be refused
POSITIVE = {
    "RectangleData": ("width", "height", "E", "density"),
    "ShellSectionData": ("thickness", "E", "density"),
    "BeamData": ("drag", "viscosity"),
    "RigidData": ("mass", "inertia"),
    "SpringData": ("stiffness", "damping"),
    "JointData": ("radius",),
    "SectionData": ("stiffness", "inertia"),
    "SceneData": ("duration",),
}
# choices of the generator that are no arguments of the package
NOT_MEANT = ("kind", "formulation", "steps", "size", "number", "turns", "joint", "beam", "shell")


@dataclass(frozen=True)
class Fault:
    """What was put where.

    Attributes:
        data: The scene with it.
        where: The way to it.
        what: In words.
        refused: Whether it must be refused before anything is computed.
    """

    data: SceneData
    where: tuple[str | int, ...]
    what: str
    refused: bool


def _points(data: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """The ways to all references to points of bodies."""
    if isinstance(data, PointRef):
        if data.body is not None:
            yield path
    elif isinstance(data, tuple):
        for i, part in enumerate(data):
            yield from _points(part, (*path, i))
    elif is_dataclass(data):
        for name in data.__dataclass_fields__:
            yield from _points(getattr(data, name), (*path, name))


def _item(data: SceneData, path: tuple[str | int, ...]) -> Any:
    """What has the argument."""
    item: Any = data
    for step in path[:-1]:
        item = item[step] if isinstance(step, int) else getattr(item, step)
    return item


def _is_number(value: Any) -> bool:
    return isinstance(value, float | np.ndarray) and np.size(value) > 0


def _entry(value: Any, rng: np.random.Generator, wrong: float) -> Any:
    """One entry replaced."""
    if np.ndim(value) == 0:
        return wrong
    array = np.array(value, dtype=np.float64)
    array.flat[rng.integers(array.size)] = wrong
    return array


def _shape(value: Any, rng: np.random.Generator) -> Any:
    if np.ndim(value) == 0:
        return np.full(int(rng.integers(2, 5)), value)
    array = np.asarray(value)
    return (array.ravel()[:-1], array[np.newaxis], np.append(array, 1.0))[rng.integers(3)]


def fault(seed: int) -> tuple[SceneData, Fault]:
    """A random scene and the same with a fault."""
    rng = np.random.default_rng([seed, 15])
    data = random_scene(seed, MOTION if seed % 3 else HELD)
    if rng.random() < 0.2 and (ways := list(_points(data))):
        where, other = (ways[rng.integers(len(ways))] for _ in range(2))
        if rng.random() < 0.6:
            return data, Fault(replaced(data, where, STRAY), where, "a stray point", True)
        there = _item(data, (*other, "name"))
        return data, Fault(replaced(data, where, there), where, "another body's point", False)
    leaves = [
        (path, value)
        for path, value in arguments(data)
        if path[-1] not in NOT_MEANT and (_is_number(value) or isinstance(value, bool | int))
    ]
    where, value = leaves[rng.integers(len(leaves))]
    kind = type(_item(data, where)).__name__
    if isinstance(value, bool):
        wrong, what, refused = "no", "a word", True
    elif isinstance(value, int):
        wrong = (0, -1, 1.5, "two")[rng.integers(4)]
        what, refused = repr(wrong), True
    else:
        wrong, what, refused = _wrong_number(value, rng, str(where[-1]) in POSITIVE.get(kind, ()))
    return data, Fault(replaced(data, where, wrong), where, what, refused)


def _wrong_number(value: Any, rng: np.random.Generator, positive: bool) -> tuple[Any, str, bool]:
    choice = rng.integers(8)
    if choice == 0:
        return _entry(value, rng, float("nan")), "nan", True
    if choice == 1:
        return _entry(value, rng, float("inf")), "infinite", True
    if choice == 2:
        return _shape(value, rng), "another shape", True
    if choice == 3:
        return (
            ("word", [None], object(), 1j * np.asarray(value))[rng.integers(4)],
            "no number",
            True,
        )
    if choice == 4:
        nothing = not np.any(value)
        return -1.0 * np.asarray(value)[()], "the other sign", positive and not nothing
    factor = 10.0 ** rng.choice([-200.0, -12.0, 12.0, 30.0, 200.0])
    return np.asarray(value)[()] * factor, f"{factor:g} times as much", False


def _solved(data: SceneData, static: bool) -> np.ndarray:
    """Frames of the last state."""
    stray = fl.RigidBody(1.0, (1, 1, 1), name="stray")
    scene = build(data, strays=(stray,)).scene
    if static:
        return fl.statics(scene).frames[-1]
    step = data.duration / data.steps
    run = fl.GeneralisedAlpha().run(scene, duration=STEPS * step, step=step, progress=False)
    return np.asarray(run.frames[-1])


def _blame(error: BaseException) -> str | None:
    """What is wrong with an error; ``None``: it is one of the package that says something."""
    frames = traceback.extract_tb(error.__traceback__)
    last = frames[-1]
    if Path(last.filename).is_relative_to(Path(__file__).parent):
        return None  # in a function of the user's own
    if not isinstance(error, ValueError | TypeError | fl.ConvergenceError):
        return f"{type(error).__name__} in {Path(last.filename).name}:{last.lineno}: {error}"
    own = Path(fl.__file__).parent
    if not Path(last.filename).is_relative_to(own) or "raise" not in (last.line or ""):
        position = f"{Path(last.filename).name}:{last.lineno}"
        return f"{type(error).__name__} by chance, in {position}: {error}"
    return None


def verdict(seed: int) -> tuple[str, str]:
    """``error``, ``same``, ``other`` (a scene that is right) or ``bad``, and why."""
    right, found = fault(seed)
    static = seed % 3 == 0 and seed % 2 == 0
    label = f"seed {seed}: {'.'.join(map(str, found.where))} {found.what}"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # what the package says by itself, such as of coarse elements
        warnings.simplefilter("ignore", UserWarning)
        # functions of the user's own
        warnings.filterwarnings("ignore", module=r"tests\.scene_builder")
        try:
            frames = _solved(found.data, static)
        except Exception as error:
            blame = _blame(error)
            text = str(error).splitlines()[0] if str(error) else type(error).__name__
            if blame is None and found.refused and isinstance(error, fl.ConvergenceError):
                blame = f"only the iteration failed: {text}"
            return ("error", f"{label}: {text}") if blame is None else ("bad", f"{label}: {blame}")
        if not np.isfinite(frames).all():
            return "bad", f"{label}: the result is not finite"
        expected = _solved(right, static)
    same = frames.shape == expected.shape and np.abs(frames - expected).max() <= 1e-8
    if found.refused and not same:
        return "bad", f"{label}: taken in silence"
    return ("same" if same else "other"), label


def main(tries: int, first: int = 0, say: Callable[[str], None] = print) -> int:
    """Number of bad verdicts among the tries."""
    counts: Counter[str] = Counter()
    for seed in range(first, first + tries):
        kind, text = verdict(seed)
        counts[kind] += 1
        if kind == "bad":
            say(text)
    say(f"{tries} tries: {dict(counts)}")
    return counts["bad"]


if __name__ == "__main__":
    sys.exit(min(1, main(*map(int, sys.argv[1:3]))))
