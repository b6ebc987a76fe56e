"""Small scenes as plain data: numbers that know their dimension and how they turn and move.

A scene of data can be written in other units, turned, moved, put into another order, or have one of
its numbers replaced; :mod:`tests.scene_builder` makes a scene of it, :mod:`tests.random_scenes`
draws them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache
from typing import Annotated, Any, get_type_hints

import numpy as np

from tests.unit_systems import UnitSystem

VECTOR, POINT, AXES = "vector", "point", "axes"
"""How numbers turn: as a free vector, as a position, as the columns of a rotation."""


class Quantity:
    """What a number of an item is.

    Attributes:
        exponents: Of length, mass and time; arrays where entries differ, or a function of the item.
        moves: How it turns; ``None``: not at all; or a function of the item.
    """

    def __init__(self, length: Any = 0, mass: Any = 0, time: Any = 0, *, moves: Any = None):
        self.exponents = length if callable(length) else (length, mass, time)
        self.moves = moves


def _along(angle: tuple[int, ...], displacement: tuple[int, ...]) -> Quantity:
    """What depends on the item's coordinate."""
    return Quantity(lambda item: angle if item.coordinate.turns else displacement)


def _unless_following(item: Any) -> str | None:
    return None if item.following else VECTOR


_STRAINS = np.array([0, 0, 0, 1, 1, 1])
_POINTS = np.array([0, 1, 1, 1])


@dataclass(frozen=True)
class SectionData:
    stiffness: Annotated[np.ndarray, Quantity(1 + np.add.outer(_STRAINS, _STRAINS), 1, -2)]
    inertia: Annotated[np.ndarray, Quantity(-1 + np.add.outer(_POINTS, _POINTS), 1)]


@dataclass(frozen=True)
class RectangleData:
    width: Annotated[float, Quantity(1)]
    height: Annotated[float, Quantity(1)]
    E: Annotated[float, Quantity(-1, 1, -2)]
    nu: Annotated[float, Quantity()]
    density: Annotated[float, Quantity(-3, 1)]


@dataclass(frozen=True)
class ShellSectionData:
    thickness: Annotated[float, Quantity(1)]
    E: Annotated[float, Quantity(-1, 1, -2)]
    nu: Annotated[float, Quantity()]
    density: Annotated[float, Quantity(-3, 1)]


@dataclass(frozen=True)
class BeamData:
    """A beam along ``start + s (end − start) + 4 s (1 − s) bow``."""

    name: str
    section: SectionData | RectangleData
    cells: int
    formulation: str
    start: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    end: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    bow: Annotated[np.ndarray, Quantity(1, moves=VECTOR)]
    up: Annotated[np.ndarray, Quantity(moves=VECTOR)]
    drag: Annotated[float, Quantity(time=-1)] = 0.0
    viscosity: Annotated[float, Quantity(time=1)] = 0.0


@dataclass(frozen=True)
class RigidData:
    name: str
    mass: Annotated[float, Quantity(mass=1)]
    inertia: Annotated[np.ndarray, Quantity(2, 1)]
    position: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    rotation: Annotated[np.ndarray, Quantity(moves=AXES)]


@dataclass(frozen=True)
class ShellData:
    """Bilinear between four corners (00, 10, 01, 11), shape (4, 3)."""

    name: str
    section: ShellSectionData
    cells: tuple[int, int]
    formulation: str
    clamped: str | None
    corners: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    along: Annotated[np.ndarray, Quantity(moves=VECTOR)]
    cell: str = "quadrilateral"
    drilling: bool | None = None


@dataclass(frozen=True)
class SlenderData:
    """A rod, cable or ANCF beam along the line of :class:`BeamData`.

    Attributes:
        element: One of those of :mod:`tests.scene_builder`.
        clamped: ``"start"`` or ``None``.
    """

    name: str
    element: str
    section: RectangleData
    cells: int
    clamped: str | None
    start: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    end: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    bow: Annotated[np.ndarray, Quantity(1, moves=VECTOR)]
    up: Annotated[np.ndarray, Quantity(moves=VECTOR)]
    drag: Annotated[float, Quantity(time=-1)] = 0.0


@dataclass(frozen=True)
class NetData:
    """A net; ``points`` have shape (n, 3), and ``cables`` are their numbers along each."""

    name: str
    section: RectangleData
    points: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    cables: tuple[tuple[int, ...], ...]
    clamped: str | None = None
    drag: Annotated[float, Quantity(time=-1)] = 0.0


@dataclass(frozen=True)
class PatchData:
    """A thin or ANCF shell, bilinear between four corners (00, 10, 01, 11), shape (4, 3)."""

    name: str
    element: str
    section: ShellSectionData
    cells: tuple[int, int]
    clamped: str | None
    corners: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    drag: Annotated[float, Quantity(time=-1)] = 0.0


@dataclass(frozen=True)
class BlockData:
    """A neo-Hookean solid: ``corner + α a + β b + γ c`` with numbers from 0 to 1."""

    name: str
    cell: str
    degree: int
    clamped: str | None
    E: Annotated[float, Quantity(-1, 1, -2)]
    nu: Annotated[float, Quantity()]
    density: Annotated[float, Quantity(-3, 1)]
    corner: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    a: Annotated[np.ndarray, Quantity(1, moves=VECTOR)]
    b: Annotated[np.ndarray, Quantity(1, moves=VECTOR)]
    c: Annotated[np.ndarray, Quantity(1, moves=VECTOR)]
    drag: Annotated[float, Quantity(time=-1)] = 0.0


@dataclass(frozen=True)
class ReducedData:
    """A straight beam of four elements reduced to the modes of its ends and some inner ones."""

    name: str
    section: RectangleData
    modes: int
    start: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    end: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    up: Annotated[np.ndarray, Quantity(moves=VECTOR)]


@dataclass(frozen=True)
class PointRef:
    """A named point or a node (``"node 3"``) of a body, or ground."""

    body: str | None = None
    name: str = ""


@dataclass(frozen=True)
class CoordinateRef:
    """A coordinate of a joint; ``number`` among those that it reports."""

    joint: str
    number: int
    turns: bool


@dataclass(frozen=True)
class JointData:
    """``kind`` is the name of the class; what it does not have is ``None``."""

    name: str
    kind: str
    a: PointRef
    b: PointRef
    at: Annotated[np.ndarray | None, Quantity(1, moves=POINT)] = None
    axis: Annotated[np.ndarray | None, Quantity(moves=VECTOR)] = None
    second: Annotated[np.ndarray | None, Quantity(moves=VECTOR)] = None
    to: Annotated[np.ndarray | None, Quantity(1, moves=POINT)] = None
    normal: Annotated[np.ndarray | None, Quantity(moves=VECTOR)] = None
    pitch: Annotated[float | None, Quantity(1)] = None
    radius: Annotated[float | None, Quantity(1)] = None


@dataclass(frozen=True)
class SlidingData:
    name: str
    kind: str
    beam: str
    b: PointRef
    at: Annotated[np.ndarray, Quantity(1, moves=POINT)]


@dataclass(frozen=True)
class LinkData:
    a: PointRef
    b: PointRef


@dataclass(frozen=True)
class ClampData:
    point: PointRef


@dataclass(frozen=True)
class HistoryData:
    """Factor ``offset + amplitude (1 − cos 2π cycles τ)/2`` of the time τ from 0 to 1."""

    offset: Annotated[float, Quantity()]
    amplitude: Annotated[float, Quantity()]
    cycles: Annotated[float, Quantity()]


@dataclass(frozen=True)
class OnsetData:
    """Factor ``τ³``: differences over some steps find its rates at the start exactly."""


@dataclass(frozen=True)
class MotionData:
    """The point moves by ``c(τ) shift`` and turns by the rotation vector ``c(τ) turn``."""

    point: PointRef
    history: HistoryData | OnsetData
    shift: Annotated[np.ndarray, Quantity(1, moves=VECTOR)]
    turn: Annotated[np.ndarray, Quantity(moves=VECTOR)]


@dataclass(frozen=True)
class SpringData:
    coordinate: CoordinateRef
    stiffness: Annotated[float, _along((2, 1, -2), (0, 1, -2))]
    damping: Annotated[float, _along((2, 1, -1), (0, 1, -1))] = 0.0
    rest: Annotated[float | None, _along((0, 0, 0), (1, 0, 0))] = None


@dataclass(frozen=True)
class DriveData:
    """From the start by ``amplitude`` times the history; without one it stays."""

    coordinate: CoordinateRef
    history: HistoryData | OnsetData | None
    amplitude: Annotated[float, _along((0, 0, 0), (1, 0, 0))] = 0.0


@dataclass(frozen=True)
class ContactData:
    """A ball around a point above a plane fixed to ground.

    Attributes:
        stiffness: Of the penalty; ``None``: impacts.
    """

    ball: PointRef
    radius: Annotated[float, Quantity(1)]
    stiffness: Annotated[float | None, Quantity(0, 1, -2)]
    normal: Annotated[np.ndarray, Quantity(moves=VECTOR)]
    at: Annotated[np.ndarray, Quantity(1, moves=POINT)]


def _of_ratio(item: Any) -> tuple[int, ...]:
    return int(item.second.turns) - int(item.first.turns), 0, 0


@dataclass(frozen=True)
class GearData:
    first: CoordinateRef
    second: CoordinateRef
    ratio: Annotated[float, Quantity(_of_ratio)]


@dataclass(frozen=True)
class PointLoadData:
    point: PointRef
    following: bool
    history: HistoryData | None
    force: Annotated[np.ndarray, Quantity(1, 1, -2, moves=_unless_following)]
    moment: Annotated[np.ndarray, Quantity(2, 1, -2, moves=_unless_following)]


@dataclass(frozen=True)
class LineLoadData:
    beam: str
    following: bool
    history: HistoryData | None
    force: Annotated[np.ndarray, Quantity(0, 1, -2, moves=_unless_following)]
    moment: Annotated[np.ndarray, Quantity(1, 1, -2, moves=_unless_following)]


@dataclass(frozen=True)
class BeamPressureData:
    beam: str
    history: HistoryData | None
    pressure: Annotated[float, Quantity(0, 1, -2)]
    direction: Annotated[np.ndarray, Quantity()]


@dataclass(frozen=True)
class EigenstrainData:
    beam: str
    history: HistoryData | None
    strain: Annotated[np.ndarray, Quantity(-_STRAINS)]


@dataclass(frozen=True)
class PreStressData:
    beam: str
    history: HistoryData | None
    resultant: Annotated[np.ndarray, Quantity(1 + _STRAINS, 1, -2)]


@dataclass(frozen=True)
class AreaLoadData:
    shell: str
    history: HistoryData | None
    force: Annotated[np.ndarray, Quantity(-1, 1, -2, moves=VECTOR)]


@dataclass(frozen=True)
class EdgeLoadData:
    shell: str
    curve: str
    following: bool
    history: HistoryData | None
    force: Annotated[np.ndarray, Quantity(0, 1, -2, moves=_unless_following)]


@dataclass(frozen=True)
class SurfacePressureData:
    shell: str
    history: HistoryData | None
    pressure: Annotated[float, Quantity(-1, 1, -2)]


@dataclass(frozen=True)
class FaceLoadData:
    solid: str
    face: str
    history: HistoryData | None
    force: Annotated[np.ndarray, Quantity(-1, 1, -2, moves=VECTOR)]


@dataclass(frozen=True)
class FacePressureData:
    solid: str
    face: str
    history: HistoryData | None
    pressure: Annotated[float, Quantity(-1, 1, -2)]


@dataclass(frozen=True)
class BulkLoadData:
    solid: str
    history: HistoryData | None
    force: Annotated[np.ndarray, Quantity(-2, 1, -2, moves=VECTOR)]


@dataclass(frozen=True)
class SceneData:
    """All of a scene; the time of histories is that over ``duration``, in statics the load factor.

    ``spin`` about ``about`` and ``velocity`` are the motion of all bodies at the start.
    """

    bodies: tuple[Any, ...]
    joints: tuple[Any, ...]
    supports: tuple[Any, ...]
    actions: tuple[Any, ...]
    loads: tuple[Any, ...]
    steps: int
    gravity: Annotated[np.ndarray, Quantity(1, 0, -2, moves=VECTOR)]
    spin: Annotated[np.ndarray, Quantity(time=-1, moves=VECTOR)]
    about: Annotated[np.ndarray, Quantity(1, moves=POINT)]
    velocity: Annotated[np.ndarray, Quantity(1, 0, -1, moves=VECTOR)]
    size: Annotated[float, Quantity(1)]
    duration: Annotated[float, Quantity(time=1)]


@cache
def _quantities(kind: type) -> dict[str, Quantity]:
    """Those of the fields of a class that are one."""
    hints = get_type_hints(kind, include_extras=True)
    return {
        name: about
        for name, hint in hints.items()
        for about in getattr(hint, "__metadata__", ())
        if isinstance(about, Quantity)
    }


def _mapped(data: Any, change: Callable[[Any, Quantity, Any], Any]) -> Any:
    """A copy with ``change(item, quantity, value)`` for every quantity of the tree."""
    if isinstance(data, tuple):
        return tuple(_mapped(part, change) for part in data)
    if not is_dataclass(data):
        return data
    known, new = _quantities(type(data)), {}
    for f in fields(data):
        value = getattr(data, f.name)
        if f.name in known:
            new[f.name] = None if value is None else change(data, known[f.name], value)
        else:
            new[f.name] = _mapped(value, change)
    return replace(data, **new)


def _of(item: Any, about: Any) -> Any:
    return about(item) if callable(about) else about


def converted(data: SceneData, units: UnitSystem) -> SceneData:
    """The same scene in other units."""
    return _mapped(data, lambda item, about, value: units.of(value, *_of(item, about.exponents)))


def placed(data: SceneData, rotation: np.ndarray, shift: np.ndarray) -> SceneData:
    """The same scene elsewhere: ``x → rotation x + shift``."""

    def change(item: Any, about: Quantity, value: Any) -> Any:
        how = _of(item, about.moves)
        if how is None:
            return value
        if how == AXES:
            return rotation @ value
        return value @ rotation.T + (shift if how == POINT else 0.0)

    return _mapped(data, change)


def reordered(data: SceneData, rng: np.random.Generator) -> SceneData:
    """The same with bodies, joints, supports, springs and loads in another order."""

    def mixed(items: tuple[Any, ...]) -> tuple[Any, ...]:
        return tuple(items[i] for i in rng.permutation(len(items)))

    names = ("bodies", "joints", "supports", "actions", "loads")
    return replace(data, **{name: mixed(getattr(data, name)) for name in names})


Path = tuple[str | int, ...]


def arguments(data: Any, path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """All leaves of the tree, numbers or not, with the way to them."""
    if isinstance(data, tuple):
        for i, part in enumerate(data):
            yield from arguments(part, (*path, i))
    elif is_dataclass(data):
        for f in fields(data):
            yield from arguments(getattr(data, f.name), (*path, f.name))
    else:
        yield path, data


def replaced(data: Any, path: Path, value: Any) -> Any:
    """A copy with another value at the end of a way."""
    if not path:
        return value
    head, rest = path[0], path[1:]
    if isinstance(data, tuple):
        assert isinstance(head, int)
        return (*data[:head], replaced(data[head], rest, value), *data[head + 1 :])
    return replace(data, **{str(head): replaced(getattr(data, str(head)), rest, value)})
