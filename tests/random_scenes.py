"""Random small scenes, as data (:mod:`tests.scene_data`), each from its seed.

A scene grows from ground, or from a body that flies, one body after the other: each is attached to
a point of what is there by a random joint, clamp or link. Then come springs, drives and gears along
coordinates of these joints, loops that are closed through a flexible body (so that no constraint is
redundant), and loads. Lengths are about 1, forces some tens, stiffness that of plastics; a step
resolves the motion and not all waves.

    data = random_scene(7, MOTION)
    built = build(data)                                # tests.scene_builder
    fl.GeneralisedAlpha().run(built.scene, duration=data.duration, step=data.duration / data.steps)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

import fem_lie as fl
from tests.scene_data import (
    AreaLoadData,
    BeamData,
    BeamPressureData,
    BlockData,
    ClampData,
    ContactData,
    CoordinateRef,
    DriveData,
    EdgeLoadData,
    EigenstrainData,
    GearData,
    HistoryData,
    JointData,
    LineLoadData,
    LinkData,
    MotionData,
    OnsetData,
    PatchData,
    PointLoadData,
    PointRef,
    PreStressData,
    RectangleData,
    ReducedData,
    RigidData,
    SceneData,
    SectionData,
    ShellData,
    ShellSectionData,
    SlenderData,
    SlidingData,
    SpringData,
    SurfacePressureData,
)


@dataclass(frozen=True)
class Wanted:
    """What a scene may have.

    Attributes:
        loose: Bodies may move without strain: joints are free, or scenes fly.
        histories: Loads with histories, drives and prescribed motions.
        sliding: Bodies that slide along beams.
        rolling: Discs that roll, and knife edges.
        six: Shells may get six parameters.
        pressure: Pressure on shells.
        damping: Of beams and springs.
        strains: Eigenstrain and pre-stress of beams.
        following: Loads without a potential: moments, pressure on beams, forces that follow.
        elements: Other bodies than beams, shells and rigid ones, of :data:`ELEMENTS`; with them
            come contacts by penalties.
        bodies: At most.
        steps: In time.
    """

    loose: bool = True
    histories: bool = True
    sliding: bool = True
    rolling: bool = True
    six: bool = True
    pressure: bool = True
    damping: bool = True
    strains: bool = True
    following: bool = True
    elements: tuple[str, ...] = ()
    bodies: int = 4
    steps: int = 25


MOTION = Wanted()
"""For generalised-α."""
CONSERVING = Wanted(sliding=False, rolling=False, six=False, pressure=False)
"""For the schemes that conserve."""
HELD = Wanted(loose=False, sliding=False, rolling=False)
"""For statics and vibrations: nothing moves without strain."""
PROPORTIONAL = replace(
    HELD, histories=False, damping=False, strains=False, pressure=False, following=False
)
"""For buckling: loads grow with the load factor."""

_CABLES = ("Hermite cable", "discrete cable")
_SLENDER = ("Kirchhoff rod", "discrete rod", *_CABLES, "ANCF beam")
_PATCHES = ("thin shell", "ANCF shell")
_BLOCKS = ("hexahedron 1", "hexahedron 2", "tetrahedron 2")
ELEMENTS = (*_SLENDER, *_PATCHES, *_BLOCKS, "reduced")
"""Of rods, cables, ANCF beams and shells, thin shells and solids; and reduced-order beams."""

MIXED = replace(MOTION, elements=ELEMENTS)
"""For generalised-α: all kinds of bodies, joints, loads and contacts."""
MIXED_CONSERVING = replace(CONSERVING, elements=ELEMENTS)
"""The same for the schemes that conserve."""

STEP = 5e-3
GROUND = PointRef()

# of each coordinate, whether it is an angle
_COORDINATES = {
    "Revolute": (True,),
    "Prismatic": (False,),
    "Cylindrical": (True, False),
    "Screw": (True, False),
    "Planar": (True, False, False),
    "Universal": (True, True),
    "Distance": (False,),
    "Fixed": (),
    "Spherical": (),
    "InPlane": (),
    "KnifeEdge": (),
}
# those of which each is the joint's own; of a screw one follows from the other
_INDEPENDENT = {**_COORDINATES, "Screw": (True,)}
_WITH_SECOND = ("Planar", "Universal")
_HELD = ("Fixed", "Revolute", "Prismatic", "Cylindrical", "Screw", "Planar", "Universal")
_LOOSE = (*_HELD, "Spherical", "InPlane", "Distance")


def random_scene(seed: int, wanted: Wanted = MOTION) -> SceneData:
    """The scene of a seed."""
    return _Growth(np.random.default_rng(seed), wanted).scene()


@dataclass(frozen=True)
class _Port:
    """A place of a body where something can be attached; ``at``: it is not a node."""

    ref: PointRef
    point_at: np.ndarray
    body: Any = None
    at: bool = False


@dataclass
class _Growth:
    rng: np.random.Generator
    wanted: Wanted
    bodies: list[Any] = field(default_factory=list)
    joints: list[Any] = field(default_factory=list)
    supports: list[Any] = field(default_factory=list)
    actions: list[Any] = field(default_factory=list)
    loads: list[Any] = field(default_factory=list)
    free: list[CoordinateRef] = field(default_factory=list)
    moving: bool = True
    spin: np.ndarray = field(default_factory=lambda: np.zeros(3))
    about: np.ndarray = field(default_factory=lambda: np.zeros(3))
    velocity: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def scene(self) -> SceneData:
        self._first()
        for _ in range(self.rng.integers(0, self.wanted.bodies)):
            self._grow()
        if self.rng.random() < 0.4:
            self._close()
        if self.wanted.sliding and self.rng.random() < 0.4:
            self._slide()
        if self.wanted.elements:
            self._touch()
        self._act()
        for _ in range(self.rng.integers(1, 4)):
            self._load()
        weighs = self.rng.random() < 0.7
        return SceneData(
            bodies=tuple(self.bodies),
            joints=tuple(self.joints),
            supports=tuple(self.supports),
            actions=tuple(self.actions),
            loads=tuple(self.loads),
            steps=self.wanted.steps,
            gravity=self._vector(9.81 if self._chance(0.5) else 3.0) * weighs,
            spin=self.spin * self.moving,
            about=self.about,
            velocity=self.velocity * self.moving,
            size=1.0,
            duration=STEP * self.wanted.steps,
        )

    # ---- chance

    def _chance(self, probability: float) -> bool:
        return bool(self.rng.random() < probability)

    def _between(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def _direction(self) -> np.ndarray:
        v = self.rng.normal(size=3)
        return v / np.linalg.norm(v)

    def _vector(self, size: float) -> np.ndarray:
        return size * self._direction()

    def _across(self, axis: np.ndarray) -> np.ndarray:
        v = np.cross(axis, self._direction())
        return v / np.linalg.norm(v)

    def _one(self, items: Sequence[Any]) -> Any:
        return items[self.rng.integers(len(items))]

    def _history(self) -> HistoryData | None:
        if not self.wanted.histories or self._chance(0.5):
            return None
        return HistoryData(self._between(0.0, 1.0), self._between(0.3, 1.0), self._cycles())

    def _cycles(self) -> float:
        return self._between(0.3, 1.5) * max(1.0, self.wanted.steps / 100)

    def _course(self) -> HistoryData | OnsetData:
        """Of what is driven: it starts from rest, as differences over a few steps see it."""
        return OnsetData() if self.wanted.steps < 1000 else HistoryData(0.0, 1.0, self._cycles())

    # ---- bodies

    def _body(
        self, point_at: np.ndarray, *, clamped: bool = False, parent: _Port | None = None
    ) -> _Port:
        """A new body with one of its positions there."""
        makers: list[Any] = [self._beam, self._beam, self._shell] + [self._rigid] * (not clamped)
        if self.wanted.elements:
            makers = [*makers[1:], self._slender, self._slender, self._patch, self._block]
            makers += [self._reduced] * (not clamped and "reduced" in self.wanted.elements)
        while True:
            maker = makers[self.rng.integers(len(makers))]
            body, port = maker(f"body {len(self.bodies)}", point_at)
            if parent is None or not (self._turns_held(parent, port) and (parent.at or port.at)):
                self.bodies.append(body)
                return port

    def _beam(self, name: str, point_at: np.ndarray) -> tuple[BeamData, _Port]:
        along = self._vector(self._between(0.5, 1.5))
        at_start = self._chance(0.7)
        start = point_at if at_start else point_at - along
        body = BeamData(
            name=name,
            section=self._section(),
            cells=int(self.rng.integers(2, 5)),
            formulation=self._one(("geodesic", "geodesic, plain", "director 1", "director 2")),
            start=start,
            end=start + along,
            bow=self._across(along) * self._between(0.05, 0.2) * self._chance(0.4),
            up=self._across(along),
            drag=self._between(0.1, 2.0) * (self.wanted.damping and self._chance(0.2)),
            viscosity=self._between(1e-4, 1e-3) * (self.wanted.damping and self._chance(0.3)),
        )
        return body, _Port(PointRef(name, "start" if at_start else "end"), point_at, body)

    def _section(self) -> SectionData | RectangleData:
        width, height = self._between(0.02, 0.06), self._between(0.02, 0.06)
        E, nu, density = self._between(3e8, 3e9), self._between(0.0, 0.4), self._between(1e3, 3e3)
        if self._chance(0.6):
            return RectangleData(width, height, E, nu, density)
        # off its axis and turned, so that all is coupled with all
        plain = fl.Section.rectangle(width, height, fl.Material(E, nu, density))
        y, z = 0.3 * width * self.rng.normal(size=2)
        section = plain.offset(y, z).rotated(self._between(0.0, 3.0))
        assert section.inertia is not None
        return SectionData(np.array(section.stiffness), np.array(section.inertia))

    def _rigid(self, name: str, point_at: np.ndarray) -> tuple[RigidData, _Port]:
        mass, box = self._between(1.0, 5.0), self.rng.uniform(0.1, 0.4, 3)
        at_centre = self._chance(0.3)
        a, b = self._direction(), self._direction()
        b = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
        body = RigidData(
            name=name,
            mass=mass,
            inertia=mass / 12 * ((box**2).sum() - box**2),
            position=point_at if at_centre else point_at + self._vector(self._between(0.1, 0.4)),
            rotation=np.column_stack([a, b, np.cross(a, b)]),
        )
        return body, _Port(PointRef(name, "centre"), point_at, body, at=not at_centre)

    def _shell(self, name: str, point_at: np.ndarray) -> tuple[ShellData, _Port]:
        n = self._direction()
        a = self._across(n)
        b = np.cross(n, a)
        u, v = self._between(0.4, 1.0) * a, self._between(0.4, 1.0) * b
        corners = np.array([np.zeros(3), u, v, u + v + 0.1 * self.rng.normal(size=3)])
        body = ShellData(
            name=name,
            section=ShellSectionData(
                self._between(0.01, 0.03), self._between(3e8, 3e9), 0.3, self._between(1e3, 3e3)
            ),
            cells=(int(self.rng.integers(1, 3)), int(self.rng.integers(1, 3))),
            formulation=self._one(("HR", "HR", "MITC4")),
            clamped=None,
            corners=point_at + corners,
            along=a + 0.3 * b,
        )
        return body, _Port(PointRef(name, "00"), point_at, body)

    def _slender(self, name: str, point_at: np.ndarray) -> tuple[SlenderData, _Port]:
        along = self._vector(self._between(0.5, 1.5))
        element = self._element(_SLENDER)
        body = SlenderData(
            name=name,
            element=element,
            section=self._rectangle(square=element in _CABLES),
            cells=int(self.rng.integers(2, 4)),
            clamped=None,
            start=point_at,
            end=point_at + along,
            bow=self._across(along) * self._between(0.05, 0.1) * self._chance(0.4),
            up=self._across(along),
        )
        return body, _Port(PointRef(name, "start"), point_at, body)

    def _element(self, of: Sequence[str]) -> str:
        return str(self._one([name for name in of if name in self.wanted.elements]))

    def _rectangle(self, *, square: bool = False) -> RectangleData:
        width, height = self.rng.uniform(0.02, 0.06, 2)
        height = width if square else height
        return RectangleData(
            width, height, self._between(3e8, 3e9), self._between(0.0, 0.4), self._between(1e3, 3e3)
        )

    def _patch(self, name: str, point_at: np.ndarray) -> tuple[PatchData, _Port]:
        flat, port = self._shell(name, point_at)
        element = self._element(_PATCHES)
        body = PatchData(name, element, flat.section, flat.cells, None, flat.corners)
        return body, _Port(port.ref, point_at, body)

    def _block(self, name: str, point_at: np.ndarray) -> tuple[BlockData, _Port]:
        a = self._direction()
        b = self._across(a)
        c = np.cross(a, b)
        u, v, w = (
            self._between(*range_) * n
            for range_, n in (((0.4, 1.0), a), ((0.1, 0.3), b), ((0.1, 0.3), c))
        )
        cell, degree = self._element(_BLOCKS).split()
        body = BlockData(
            name=name,
            cell=cell,
            degree=int(degree),
            clamped=None,
            E=self._between(1e6, 1e7),
            nu=self._between(0.1, 0.35),
            density=self._between(1e2, 3e2),
            corner=point_at - 0.5 * (v + w),
            a=u,
            b=v,
            c=w,
        )
        return body, _Port(PointRef(name, "a=0"), point_at, body)

    def _reduced(self, name: str, point_at: np.ndarray) -> tuple[ReducedData, _Port]:
        along = self._vector(self._between(0.5, 1.5))
        modes, up = int(self.rng.integers(1, 4)), self._across(along)
        body = ReducedData(name, self._rectangle(), modes, point_at, point_at + along, up)
        return body, _Port(PointRef(name, "start"), point_at, body)

    def _ports(self, body: Any) -> list[_Port]:
        """Where the next thing can be attached."""
        if isinstance(body, BlockData):
            middle = body.corner + 0.5 * (body.b + body.c)
            return [_Port(PointRef(body.name, "a=1"), middle + body.a, body)]
        if isinstance(body, BeamData | SlenderData | ReducedData):
            return [
                _Port(PointRef(body.name, "start"), body.start, body),
                _Port(PointRef(body.name, "end"), body.end, body),
            ]
        if isinstance(body, RigidData):
            point_at = body.position + self._vector(self._between(0.1, 0.4))
            return [_Port(PointRef(body.name, "centre"), point_at, body, at=True)]
        return [
            _Port(PointRef(body.name, corner), point_at, body)
            for corner, point_at in zip(("00", "10", "01", "11"), body.corners, strict=True)
        ]

    # ---- growth

    def _first(self) -> None:
        """The first body: it flies, rolls, is clamped, or hangs on a joint."""
        point_at = self.rng.normal(size=3)
        self.about = point_at
        kind = self.rng.random()
        if self.wanted.loose and kind < 0.3:
            self._body(point_at)
            self.spin, self.velocity = self._vector(2.0), self._vector(1.0)
        elif self.wanted.loose and self.wanted.rolling and kind < 0.4:
            self._roll(point_at)
        elif kind < 0.6:
            self._clamp(self._body(point_at, clamped=True))
        elif self.wanted.histories and kind < 0.7:
            self.moving = False
            port = self._body(point_at, clamped=True)
            if _holds_itself(port.body):
                self._clamp(port)
            else:
                turns = self._chance(0.5)
                shift, turn = self._vector(0.05 * (not turns)), self._vector(0.2 * turns)
                self.supports.append(MotionData(port.ref, self._course(), shift, turn))
        else:
            self._join(_Port(GROUND, point_at), self._body(point_at))

    def _clamp(self, port: _Port) -> None:
        self.moving = False
        if _holds_itself(port.body):
            # the port "00" lies on both curves
            where = self._one(("a=0", "b=0")) if port.ref.name == "00" else port.ref.name
            held = replace(port.body, clamped=where)
            self.bodies[self.bodies.index(port.body)] = held
        else:
            self.supports.append(ClampData(port.ref))

    def _roll(self, point_at: np.ndarray) -> None:
        """A disc or a sledge on a plane."""
        body, _ = self._rigid(f"body {len(self.bodies)}", point_at)
        normal = self._direction()
        tilted = self._across(normal) + self._between(-0.5, 0.5) * normal
        ref, name = PointRef(body.name, "centre"), f"joint {len(self.joints)}"
        self.bodies.append(body)
        self.moving = False
        if self._chance(0.7):
            radius = self._between(0.2, 0.5)
            self.joints.append(
                JointData(
                    name, "RollingDisc", GROUND, ref, axis=tilted, normal=normal, radius=radius
                )
            )
        else:
            self.joints.append(JointData(name, "KnifeEdge", GROUND, ref, axis=tilted))

    def _grow(self) -> None:
        """One more body on one that is there, or on ground."""
        if self._chance(0.2):
            self.moving = False
            point_at = self.about + self.rng.normal(size=3)
            self._join(_Port(GROUND, point_at), self._body(point_at))
            return
        parent = self._one(self._ports(self._one(self.bodies)))
        if self._on_clamp(parent):
            return
        if self.wanted.loose and self._chance(0.1):
            self._rod(parent)
        else:
            self._join(parent, self._body(parent.point_at, parent=parent))

    def _on_clamp(self, port: _Port) -> bool:
        """Whether the node cannot move, so that a joint there may be redundant."""
        held = [s.point for s in self.supports if not isinstance(s, LinkData)]
        where = port.body.clamped if _holds_itself(port.body) else None
        clamped = where is not None and port.ref.name in _CURVES.get(where, (where,))
        return port.ref in held or clamped

    def _rod(self, parent: _Port) -> None:
        point_at = parent.point_at + self._vector(self._between(0.3, 0.8))
        child = self._body(point_at, parent=parent)
        joint = self._joint("Distance", parent, child)
        self.joints.append(joint)
        self.actions.append(DriveData(CoordinateRef(joint.name, 0, False), None))

    def _join(self, parent: _Port, child: _Port) -> None:
        """A joint or link between two ports at one position."""
        if self._may_link(parent, child) and self._chance(0.15):
            self.supports.append(LinkData(parent.ref, child.ref))
            return
        kind = self._kind(parent, child)
        joint = self._joint(kind, parent, child)
        self.joints.append(joint)
        own = [CoordinateRef(joint.name, k, turns) for k, turns in enumerate(_INDEPENDENT[kind])]
        if not self.wanted.loose:
            for coordinate in own:
                self._spring(coordinate)
        self.free += own
        if parent.body is None:
            self._let_turn(joint)

    def _may_link(self, parent: _Port, child: _Port) -> bool:
        """Whether both are nodes with frames."""
        if parent.body is None or self._turns_held(parent, child):
            return False
        return not any(
            isinstance(p.body, BlockData | PatchData)
            or (isinstance(p.body, SlenderData) and p.body.element == "ANCF beam")
            for p in (parent, child)
        )

    def _turns_held(self, *ports: _Port) -> bool:
        """Whether a shell with five parameters or a cable is among them."""
        if any(isinstance(p.body, SlenderData) and p.body.element in _CABLES for p in ports):
            return True
        return not self.wanted.six and any(isinstance(p.body, ShellData) for p in ports)

    def _kind(self, parent: _Port, child: _Port) -> str:
        if self._turns_held(parent, child):
            # what needs no rotation of a shell's node; held scenes have six parameters
            return "Spherical"
        return str(self._one(_LOOSE[:-1] if self.wanted.loose else _HELD))

    def _joint(self, kind: str, parent: _Port, child: _Port) -> JointData:
        axis = self._direction()
        apart = kind == "Distance"
        return JointData(
            f"joint {len(self.joints)}",
            kind,
            parent.ref,
            child.ref,
            at=parent.point_at if parent.at or child.at or apart else None,
            axis=None if apart else axis,
            second=self._across(axis) if kind in _WITH_SECOND else None,
            to=child.point_at if apart else None,
            pitch=self._between(0.1, 0.5) if kind == "Screw" else None,
        )

    def _let_turn(self, joint: JointData) -> None:
        """A motion of all at the start that the only joint to ground allows."""
        assert joint.axis is not None
        point_at = self.about
        if joint.kind == "Spherical":
            self.spin = self._vector(2.0)
        elif joint.kind == "Revolute":
            self.spin = 2.0 * joint.axis
        elif joint.kind == "Prismatic":
            self.velocity = joint.axis
        elif joint.kind == "Planar":
            self.spin, self.velocity = 2.0 * joint.axis, self._across(joint.axis)
        elif joint.kind == "Cylindrical":
            self.spin, self.velocity = 2.0 * joint.axis, 0.5 * joint.axis
        else:
            self.moving = False
        self.about = point_at

    def _close(self) -> None:
        """A loop: the end of a flexible body is tied to another body or to ground."""
        ends = [
            _Port(PointRef(body.name, "end"), body.end, body)
            for body in self.bodies
            if isinstance(body, BeamData)
        ]
        used = {ref for joint in self.joints for ref in (joint.a, joint.b)}
        used |= {s.point for s in self.supports if not isinstance(s, LinkData)}
        used |= {ref for s in self.supports if isinstance(s, LinkData) for ref in (s.a, s.b)}
        loose = [port for port in ends if port.ref not in used]
        if not loose:
            return
        port = self._one(loose)
        others = [body for body in self.bodies if isinstance(body, RigidData)]
        if others and self._chance(0.6):
            other = _Port(PointRef(self._one(others).name, "centre"), port.point_at, at=True)
        else:
            other, self.moving = _Port(GROUND, port.point_at), False
        self.joints.append(self._joint(self._one(_LOOSE[:-1]), other, port))

    def _slide(self) -> None:
        """A body that slides along a straight beam of geodesic elements."""
        rails = [
            body
            for body in self.bodies
            if isinstance(body, BeamData) and "geodesic" in body.formulation and not body.bow.any()
        ]
        if not rails:
            return
        rail = self._one(rails)
        at = rail.start + self._between(0.2, 0.8) * (rail.end - rail.start)
        body, port = self._rigid(f"body {len(self.bodies)}", at)
        self.bodies.append(body)
        kind = self._one(("Sliding", "Collar", "Sleeve"))
        self.joints.append(SlidingData(f"joint {len(self.joints)}", kind, rail.name, port.ref, at))

    def _touch(self) -> None:
        """A rigid body before a plane, which it may meet."""
        bodies = [body for body in self.bodies if isinstance(body, RigidData)]
        if not bodies or not self._chance(0.4):
            return
        body, normal, radius = self._one(bodies), self._direction(), self._between(0.05, 0.1)
        at = body.position - (radius + self._between(0.0, 0.01)) * normal
        stiffness = self._between(5e3, 2e4)
        self.actions.append(
            ContactData(PointRef(body.name, "centre"), radius, stiffness, normal, at)
        )

    # ---- what acts

    def _spring(self, coordinate: CoordinateRef) -> None:
        stiffness = self._between(20.0, 200.0) if coordinate.turns else self._between(200.0, 2e3)
        damping = self._between(0.0, 0.02) * stiffness * (self.wanted.damping and self._chance(0.5))
        self.actions.append(SpringData(coordinate, stiffness, damping))

    def _act(self) -> None:
        """Springs, drives, gears along coordinates of joints, and a spring between two bodies."""
        free = [self.free[i] for i in self.rng.permutation(len(self.free))]
        if self.wanted.loose:
            for coordinate in free:
                if self._chance(0.3):
                    self._spring(coordinate)
        if self.wanted.histories and free and self._chance(0.3):
            self._drive(free.pop())
        if self.wanted.loose and len(free) > 1 and self._chance(0.3):
            first, second = free.pop(), free.pop()
            if first.joint != second.joint:
                self.moving = False
                self.actions.append(GearData(first, second, self._between(0.5, 2.0)))
        if len(self.bodies) > 1 and self._chance(0.3):
            self._tether()

    def _drive(self, coordinate: CoordinateRef) -> None:
        self.moving = False
        amplitude = self._between(0.05, 0.3) * (1.0 if coordinate.turns else 0.3)
        self.actions.append(DriveData(coordinate, self._course(), amplitude))

    def _tether(self) -> None:
        """A spring between two points."""
        i, j = self.rng.choice(len(self.bodies), 2, replace=False)
        a, b = (self._one(self._ports(self.bodies[k])) for k in (i, j))
        if self._turns_held(a, b) or np.linalg.norm(a.point_at - b.point_at) < 0.1:
            return
        joint = self._joint("Distance", a, b)
        self.joints.append(joint)
        self._spring(CoordinateRef(joint.name, 0, False))

    # ---- loads

    def _load(self) -> None:
        body = self._one(self.bodies)
        if isinstance(body, BeamData):
            self._load_beam(body)
        elif isinstance(body, RigidData):
            self._load_point(PointRef(body.name, "centre"))
        elif not isinstance(body, ShellData):
            self._load_any(body)
        else:
            self._load_shell(body)

    def _follows(self, part: float) -> bool:
        """Whether a load has no potential, by chance."""
        return self._chance(part) and self.wanted.following

    def _load_point(self, point: PointRef) -> None:
        self.loads.append(
            PointLoadData(
                point,
                self._follows(0.5),
                self._history(),
                force=self._vector(self._between(1.0, 30.0)),
                moment=self._vector(self._between(0.5, 5.0)) * self._follows(0.5),
            )
        )

    def _load_any(self, body: Any) -> None:
        """A force at its far end, and a moment where it has rotations."""
        gradients = isinstance(body, SlenderData) and body.element == "ANCF beam"
        if not self.wanted.pressure and (gradients or isinstance(body, BlockData)):
            # conserving schemes have loads on nodes alone
            return
        port = self._ports(body)[-1]
        rotates = not isinstance(body, PatchData) and not self._turns_held(port)
        force = self._vector(self._between(1.0, 30.0))
        moment = self._vector(self._between(0.1, 1.0)) * (rotates and self._chance(0.5))
        following = rotates and self._chance(0.5)
        self.loads.append(PointLoadData(port.ref, following, self._history(), force, moment))

    def _load_beam(self, beam: BeamData) -> None:
        kinds = 5 if self.wanted.strains else 3 if self.wanted.following else 2
        kind, history = self.rng.integers(kinds), self._history()
        if kind == 0:
            self._load_point(PointRef(beam.name, "end"))
        elif kind == 1:
            force, moment = self._vector(20.0), self._vector(2.0) * self._follows(0.5)
            self.loads.append(LineLoadData(beam.name, self._follows(0.5), history, force, moment))
        elif kind == 2:
            angle = self._between(0.0, 6.0)
            push = np.array([0.0, np.cos(angle), np.sin(angle)])
            self.loads.append(BeamPressureData(beam.name, history, self._between(5.0, 20.0), push))
        elif kind == 3:
            strain = np.concatenate([1e-3 * self.rng.normal(size=3), 0.1 * self.rng.normal(size=3)])
            self.loads.append(EigenstrainData(beam.name, history, strain))
        else:
            stress = np.concatenate([20 * self.rng.normal(size=3), 2 * self.rng.normal(size=3)])
            self.loads.append(PreStressData(beam.name, history, stress))

    def _load_shell(self, shell: ShellData) -> None:
        kind, history = self.rng.integers(3), self._history()
        if kind == 0 and self.wanted.pressure:
            pressure = self._between(-100.0, 100.0)
            self.loads.append(SurfacePressureData(shell.name, history, pressure))
        elif kind == 1:
            curve, following = self._one(("a=1", "b=1")), self._follows(0.4)
            force = self._vector(self._between(5.0, 20.0))
            self.loads.append(EdgeLoadData(shell.name, curve, following, history, force))
        else:
            self.loads.append(AreaLoadData(shell.name, history, self._vector(50.0)))


def _holds_itself(body: Any) -> bool:
    """Whether clamps are a matter of the body, and not of a node."""
    return hasattr(body, "clamped")


_CURVES = {"a=0": ("00", "01"), "b=0": ("00", "10")}
