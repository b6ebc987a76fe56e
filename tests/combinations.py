"""A small scene, as data, for each kind of body alone and with each joint.

Bodies reach from the origin to (1, 0, 0). They fly and rotate freely, or are joined to a rigid body
at their end. Then the whole is rotated and moved, so that no global axis is that of anything. Loads
are in :mod:`tests.combined_loads`. Stiffness is that of soft rubber; a step of 1e-5 s resolves the
fastest waves.

    data = joined("Hermite cable", "Revolute")
    built = build(data)                                # tests.scene_builder
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fem_lie import lie
from tests.scene_data import (
    BeamData,
    BlockData,
    CoordinateRef,
    DriveData,
    GearData,
    JointData,
    LinkData,
    NetData,
    OnsetData,
    PatchData,
    PointLoadData,
    PointRef,
    RectangleData,
    ReducedData,
    RigidData,
    SceneData,
    ShellData,
    ShellSectionData,
    SlenderData,
    SlidingData,
    SpringData,
    placed,
)

STEPS, STEP = 3, 1e-5
START, END = np.zeros(3), np.array([1.0, 0.0, 0.0])
UP, BOW = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.05, 0.0])
GROUND = PointRef()

_RECTANGLE = RectangleData(0.05, 0.04, 4e7, 0.3, 1000.0)
_SQUARE = replace(_RECTANGLE, width=0.04)
_PLATE = ShellSectionData(0.03, 4e7, 0.3, 1000.0)
_CORNERS = np.array([START, END, [0.0, 0.4, 0.0], [1.0, 0.4, 0.1]])


def _beam(formulation: str) -> BeamData:
    return BeamData("body", _RECTANGLE, 3, formulation, START, END, BOW, UP)


def _slender(element: str) -> SlenderData:
    section = _SQUARE if "cable" in element else _RECTANGLE
    return SlenderData("body", element, section, 3, None, START, END, BOW, UP)


def _shell(formulation: str, cell: str = "quadrilateral", drilling: bool | None = None) -> Any:
    along = np.array([1.0, 0.3, 0.0])
    return ShellData("body", _PLATE, (2, 2), formulation, None, _CORNERS, along, cell, drilling)


def _patch(element: str) -> PatchData:
    return PatchData("body", element, _PLATE, (2, 1), None, _CORNERS)


def _block(cell: str, degree: int) -> BlockData:
    a, b, c = np.diag([1.0, 0.2, 0.2])
    return BlockData("body", cell, degree, None, 2e6, 0.3, 100.0, -0.5 * (b + c), a, b, c)


def _rigid(name: str, centre: np.ndarray) -> RigidData:
    rotation = lie.so3_exp(np.array([0.3, -0.4, 0.2]))
    return RigidData(name, 1.5, np.array([0.02, 0.05, 0.06]), centre, rotation)


_NET = NetData(
    "body",
    _SQUARE,
    np.array([START, [0.5, 0.2, 0.0], [0.5, -0.2, 0.1], END]),
    ((0, 1, 3), (0, 2, 3), (1, 2)),
)

BODIES: dict[str, Any] = {
    "beam, geodesic": _beam("geodesic"),
    "beam, director 1": _beam("director 1"),
    "beam, director 2": _beam("director 2"),
    "Kirchhoff rod": _slender("Kirchhoff rod"),
    "discrete rod": _slender("discrete rod"),
    "Hermite cable": _slender("Hermite cable"),
    "discrete cable": _slender("discrete cable"),
    "spline cable": _slender("spline cable"),
    "net": _NET,
    "ANCF beam": _slender("ANCF beam"),
    "shell, Hellinger-Reissner": _shell("HR"),
    "shell, Hu-Washizu": _shell("HW"),
    "shell, triangles": _shell("HR", "triangle"),
    "shell, six parameters": _shell("HR", drilling=True),
    "thin shell": _patch("thin shell"),
    "ANCF shell": _patch("ANCF shell"),
    "solid, hexahedra 1": _block("hexahedron", 1),
    "solid, hexahedra 2": _block("hexahedron", 2),
    "solid, tetrahedra 2": _block("tetrahedron", 2),
    "rigid body": _rigid("body", 0.5 * (START + END)),
    "reduced-order beam": ReducedData("body", _RECTANGLE, 2, START, END, UP),
}


def ends_of(body: Any) -> tuple[PointRef, PointRef]:
    """The points at the origin and at (1, 0, 0); of a rigid body its centre twice."""
    names = {
        NetData: ("node 0", "node 3"),
        ShellData: ("00", "10"),
        PatchData: ("00", "10"),
        BlockData: ("a=0", "a=1"),
        RigidData: ("centre", "centre"),
    }.get(type(body), ("start", "end"))
    return PointRef(body.name, names[0]), PointRef(body.name, names[1])


def moving(*bodies: Any, **parts: Any) -> SceneData:
    """Bodies that move as one rigid body at the start, rotated and moved from the global axes."""
    motion = {
        "gravity": np.zeros(3),
        "spin": np.array([0.3, 0.5, 0.2]),
        "about": START,
        "velocity": np.array([0.3, -0.2, -0.5]),
    }
    lists: dict[str, Any] = {"joints": (), "supports": (), "actions": (), "loads": ()}
    rest = {"steps": STEPS, "size": 1.0, "duration": STEPS * STEP}
    scene = SceneData(bodies=bodies, **(lists | motion | rest | parts))
    return placed(scene, lie.so3_exp(np.array([0.4, 0.9, -0.5])), np.array([0.2, -0.1, 0.3]))


REST = {"spin": np.zeros(3), "velocity": np.zeros(3)}
GRAVITY = np.array([0.0, 0.0, -9.81])


def free(body: str) -> SceneData:
    """The body flies under gravity."""
    return moving(BODIES[body], gravity=GRAVITY)


# ---- joints

_AXIS = np.array([0.48, 0.6, 0.64])
_SECOND = np.array([0.8, 0.0, -0.6])
_ACROSS = np.array([0.0, 0.5, 0.2])
"""An angular velocity that cables have, too, which do not rotate about their line."""
_COORDINATE = CoordinateRef("joint", 0, True)


def _own(joint: str) -> dict[str, Any]:
    """What a joint has besides its points and its position."""
    own: dict[str, Any] = {} if joint == "Spherical" else {"axis": _AXIS}
    if joint in ("Universal", "Planar"):
        own["second"] = _SECOND
    if joint == "Screw":
        own["pitch"] = 0.2
    return own


_ON_REVOLUTE: dict[str, Any] = {
    "Revolute, spring": SpringData(_COORDINATE, 20.0, rest=0.3),
    "Revolute, damper": SpringData(_COORDINATE, 0.0, 0.05),
    "Revolute, drive": DriveData(_COORDINATE, OnsetData(), 1e-8),
}
_LENGTH = CoordinateRef("joint", 0, False)
_ON_DISTANCE: dict[str, Any] = {
    "Distance, spring": SpringData(_LENGTH, 2000.0, rest=0.3),
    "Distance, drive": DriveData(_LENGTH, None),
}
_PLAIN = (
    "Fixed",
    "Spherical",
    "Revolute",
    "Universal",
    "Prismatic",
    "Cylindrical",
    "Screw",
    "Planar",
    "InPlane",
)
_ALONG_BEAM = ("Sliding", "Collar", "Sleeve")
_ROLLING = ("KnifeEdge", "RollingDisc")
JOINTS = (
    *_PLAIN,
    *_ON_REVOLUTE,
    "Gear",
    *_ON_DISTANCE,
    "RigidLink",
    *_ALONG_BEAM,
    *_ROLLING,
)


def joined(body: str, joint: str) -> SceneData:
    """The end of the straight body on a rigid body, which is loaded; or on ground to roll on.

    What slides starts within the line of the body. All joints allow the motion at the start.
    """
    first = BODIES[body]
    if hasattr(first, "bow"):
        first = replace(first, bow=np.zeros(3))
    if joint in _ROLLING:
        return _rolling(first, joint)
    other = _rigid("other", np.array([0.4, 0.0, 0.0] if joint in _ALONG_BEAM else [1.3, 0.1, 0.05]))
    ref = PointRef("other", "centre")
    force, moment = np.array([5.0, -8.0, 6.0]), np.array([0.5, 0.3, -0.4])
    parts: dict[str, Any] = {"loads": (PointLoadData(ref, False, None, force, moment),)}
    parts["spin"] = _ACROSS
    return moving(first, *_with(first, other, joint, parts), **parts)


def _with(first: Any, other: RigidData, joint: str, parts: dict[str, Any]) -> tuple[Any, ...]:
    """Adds the joint to the parts; returns the bodies after the first."""
    end, ref = ends_of(first)[1], PointRef(other.name, "centre")
    kind = joint.split(",")[0]
    if joint in _ALONG_BEAM:
        parts["joints"] = (SlidingData("joint", joint, first.name, ref, other.position),)
    elif joint == "RigidLink":
        parts["supports"] = (LinkData(end, ref),)
    elif joint in _ON_DISTANCE:
        parts["joints"] = (JointData("joint", kind, end, ref, at=END, to=other.position),)
        parts["actions"] = (_ON_DISTANCE[joint],)
    elif joint == "Gear":
        third, position = _rigid("third", np.array([1.6, -0.2, 0.1])), np.array([1.5, 0.0, 0.0])
        parts["joints"] = (
            JointData("joint", "Revolute", end, ref, at=END, axis=_AXIS),
            JointData(
                "second", "Prismatic", ref, PointRef("third", "centre"), at=position, axis=_SECOND
            ),
        )
        parts["actions"] = (GearData(_COORDINATE, CoordinateRef("second", 0, False), 0.3),)
        return other, third
    else:
        parts["joints"] = (JointData("joint", kind, end, ref, at=END, **_own(kind)),)
        parts["actions"] = tuple(_ON_REVOLUTE[name] for name in (joint,) if name in _ON_REVOLUTE)
    return (other,)


def _rolling(body: Any, joint: str) -> SceneData:
    """All rotates about the point that has no velocity."""
    own: dict[str, Any] = {"axis": _AXIS}
    about = END
    if joint == "RollingDisc":
        own |= {"normal": UP, "radius": 0.1}
        up = UP - (UP @ _AXIS) * _AXIS
        about = END - 0.1 * up / np.linalg.norm(up)
    tie = JointData("joint", joint, GROUND, ends_of(body)[1], at=END, **own)
    motion = {"about": about, "spin": _ACROSS, "velocity": np.zeros(3)}
    return moving(body, joints=(tie,), gravity=GRAVITY, **motion)
