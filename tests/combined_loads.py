"""A small scene, as data, for each kind of body with each load and support.

Bodies are those of :mod:`tests.combinations`: loaded at their end or all over, with and without a
history, with damping, held at the origin, or in contact with a plane.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from tests.combinations import BODIES, END, GRAVITY, REST, UP, ends_of, moving
from tests.scene_data import (
    AreaLoadData,
    BeamData,
    BeamPressureData,
    BlockData,
    BulkLoadData,
    ClampData,
    ContactData,
    EdgeLoadData,
    EigenstrainData,
    FaceLoadData,
    FacePressureData,
    HistoryData,
    LineLoadData,
    MotionData,
    NetData,
    OnsetData,
    PatchData,
    PointLoadData,
    PreStressData,
    RigidData,
    SceneData,
    ShellData,
    SlenderData,
    SurfacePressureData,
)

_LINES, _SURFACES, _SOLIDS = (BeamData, SlenderData, NetData), (ShellData, PatchData), (BlockData,)
_FORCE, _MOMENT = np.array([1.0, -2.0, 3.0]), np.array([0.3, 0.2, -0.1])
_NOTHING = np.zeros(3)
_HISTORY = HistoryData(0.3, 1.0, 0.25)


class Load(NamedTuple):
    """What acts on a body.

    Attributes:
        parts: Those of the scene, of a body and a history.
        on: Classes of bodies that it is for.
        constant: Whether there is no history.
    """

    parts: Callable[[Any, HistoryData | None], dict[str, Any]]
    on: tuple[type, ...] = (object,)
    constant: bool = False


def _at_end(force: np.ndarray, moment: np.ndarray, *, following: bool = False) -> Load:
    return Load(
        lambda body, history: {
            "loads": (PointLoadData(ends_of(body)[1], following, history, force, moment),)
        }
    )


def _of_body(make: Callable[[str, HistoryData | None], Any], *on: type) -> Load:
    return Load(lambda body, history: {"loads": (make(body.name, history),)}, on)


def _clamped(body: Any, history: HistoryData | None) -> dict[str, Any]:
    return REST | {"supports": (ClampData(ends_of(body)[0]),), "gravity": GRAVITY}


def _moved(body: Any, history: HistoryData | None) -> dict[str, Any]:
    shift, turn = np.array([1e-8, 2e-8, -1e-8]), np.array([2e-8, 1e-8, 3e-8])
    return REST | {"supports": (MotionData(ends_of(body)[0], OnsetData(), shift, turn),)}


def _touching(stiffness: float | None) -> Load:
    def parts(body: Any, history: HistoryData | None) -> dict[str, Any]:
        end, reach = ends_of(body)[1], 0.1
        position = body.position if isinstance(body, RigidData) else END
        overlap = 0.0 if stiffness is None else 5e-5
        plane = position - (reach - overlap) * UP
        return {"actions": (ContactData(end, reach, stiffness, UP, plane),)}

    return Load(parts, constant=True)


_STRAIN = np.array([1e-3, 0.0, 2e-3, 0.02, 0.1, -0.05])
LOADS: dict[str, Load] = {
    "force": _at_end(_FORCE, _NOTHING),
    "following force": _at_end(_FORCE, _NOTHING, following=True),
    "moment": _at_end(_NOTHING, _MOMENT),
    "line load": _of_body(
        lambda name, history: LineLoadData(name, False, history, 3 * _FORCE, _MOMENT), *_LINES
    ),
    "following line load": _of_body(
        lambda name, history: LineLoadData(name, True, history, 3 * _FORCE, _MOMENT), *_LINES
    ),
    "pressure on a line": _of_body(
        lambda name, history: BeamPressureData(name, history, 10.0, UP), *_LINES
    ),
    "eigenstrain": _of_body(lambda name, history: EigenstrainData(name, history, _STRAIN), *_LINES),
    "pre-stress": _of_body(
        lambda name, history: PreStressData(name, history, 100 * _STRAIN), *_LINES
    ),
    "force per area": _of_body(
        lambda name, history: AreaLoadData(name, history, 20 * _FORCE), *_SURFACES
    ),
    "force on an edge": _of_body(
        lambda name, history: EdgeLoadData(name, "a=1", False, history, 5 * _FORCE), *_SURFACES
    ),
    "following force on an edge": _of_body(
        lambda name, history: EdgeLoadData(name, "a=1", True, history, 5 * _FORCE), *_SURFACES
    ),
    "pressure on a surface": _of_body(
        lambda name, history: SurfacePressureData(name, history, 50.0), *_SURFACES
    ),
    "force on a face": _of_body(
        lambda name, history: FaceLoadData(name, "a=1", history, 50 * _FORCE), *_SOLIDS
    ),
    "pressure on a face": _of_body(
        lambda name, history: FacePressureData(name, "a=1", history, 100.0), *_SOLIDS
    ),
    "force per volume": _of_body(
        lambda name, history: BulkLoadData(name, history, 300 * _FORCE), *_SOLIDS
    ),
    "clamp": Load(_clamped, constant=True),
    "prescribed motion": Load(_moved, constant=True),
    "contact, penalty": _touching(1e6),
    "contact, impact": _touching(None),
}
AT_POINTS = ("force", "following force", "moment")
CHANGING = ("Revolute, drive", "prescribed motion", "contact, penalty")
"""What changes much in a step without a history, too."""


def variants(body: str, load: str) -> tuple[str, ...]:
    """Of a load on a body: with a history, with damping; none if it is not for this body."""
    first, about = BODIES[body], LOADS[load]
    if not isinstance(first, about.on):
        return ()
    if about.constant:
        return ("",)
    damped = load in AT_POINTS and hasattr(first, "drag")
    return ("", "history", "damping", "history, damping") if damped else ("", "history")


def loaded(body: str, load: str, variant: str = "") -> SceneData:
    """The load on a body that flies, or is held at the origin by what acts."""
    first = BODIES[body]
    if "damping" in variant:
        first = replace(first, drag=50.0)
    parts = LOADS[load].parts(first, _HISTORY if "history" in variant else None)
    if load == "clamp" and hasattr(first, "clamped"):
        # supports of these are a matter of the body
        where = "start" if isinstance(first, SlenderData | NetData) else "a=0"
        first, parts = replace(first, clamped=where), parts | {"supports": ()}
    return moving(first, **parts)
