"""Scenes of fem_lie from the data of :mod:`tests.scene_data`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial, singledispatch
from typing import Any

import numpy as np

import fem_lie as fl
from fem_lie import lie
from tests import scene_data as data

FORMULATIONS: dict[str, Any] = {
    "geodesic": fl.elements.GeodesicBeam(),
    "geodesic, plain": fl.elements.GeodesicBeam(False),
    "director 1": fl.elements.DirectorBeam(1),
    "director 2": fl.elements.DirectorBeam(2),
    "HR": fl.elements.HellingerReissner(),
    "MITC4": fl.elements.DisplacementBased(),
    "HW": fl.elements.HuWashizu(),
}
SLENDER: dict[str, Callable[..., Any]] = {
    "Kirchhoff rod": partial(fl.Rod, formulation=fl.elements.KirchhoffRod()),
    "discrete rod": partial(fl.Rod, formulation=fl.elements.DiscreteRod()),
    "Hermite cable": lambda *line, up, **options: fl.Cable(*line, **options),
    "discrete cable": lambda *line, up, **options: fl.Cable(
        *line, formulation=fl.elements.DiscreteCable(), **options
    ),
    "spline cable": lambda mesh, section, up, **options: fl.SplineCable.through(
        mesh.points, section, **options
    ),
    "ANCF beam": fl.AncfBeam,
}
PATCHES: dict[str, Callable[..., Any]] = {"thin shell": fl.ThinShell, "ANCF shell": fl.AncfShell}


@dataclass
class Built:
    """A scene, and its parts by their names in the data."""

    scene: fl.Scene
    clock: float
    bodies: dict[str, Any] = field(default_factory=dict)
    joints: dict[str, Any] = field(default_factory=dict)
    faces: dict[data.PointRef, fl.extend.Point] = field(default_factory=dict)

    def point(self, ref: data.PointRef) -> fl.extend.Point:
        if ref.body is None:
            return fl.ground()
        body = self.bodies[ref.body]
        if isinstance(body, fl.Solid):
            return self.faces[ref]
        _, is_node, number = ref.name.partition("node ")
        return body.point(int(number)) if is_node else body.point(ref.name)

    def coordinate(self, ref: data.CoordinateRef) -> fl.joints.Coordinate:
        return self.joints[ref.joint].coordinates()[ref.number]

    def history(
        self, given: data.HistoryData | data.OnsetData | None
    ) -> Callable[[float], float] | None:
        return None if given is None else lambda t: _factor(given, t / self.clock)


def _factor(given: data.HistoryData | data.OnsetData, τ: float) -> float:
    if isinstance(given, data.OnsetData):
        return τ**3
    wave = 0.5 * (1.0 - float(np.cos(2 * np.pi * given.cycles * τ)))
    return given.offset + given.amplitude * wave


def build(
    given: data.SceneData,
    *,
    static: bool = False,
    redundant: fl.joints.RedundantConstraints = fl.joints.RedundantConstraints.REFUSE,
    strays: tuple[fl.extend.Body, ...] = (),
) -> Built:
    """The scene; in statics histories run with the load factor. It does not have the ``strays``."""
    scene = fl.Scene(given.gravity, redundant=redundant)
    built = Built(scene, 1.0 if static else given.duration)
    built.bodies |= {body.name: body for body in strays}
    for part in (*given.bodies, *given.joints, *given.supports, *given.actions, *given.loads):
        add(part, built)
    for body in scene.bodies:
        body.add_velocity(omega=given.spin, about=given.about)
        body.add_velocity(given.velocity)
    return built


def _section(given: data.SectionData | data.RectangleData) -> fl.Section:
    if isinstance(given, data.RectangleData):
        material = fl.Material(given.E, given.nu, given.density)
        return fl.Section.rectangle(given.width, given.height, material)
    return fl.Section.from_stiffness(given.stiffness, given.inertia)


@singledispatch
def add(item: Any, built: Built) -> None:
    """Add a part to the scene."""
    raise TypeError(f"no part of a scene: {item!r}")


@add.register
def _(item: data.BeamData, built: Built) -> None:
    def line(s: float) -> np.ndarray:
        return item.start + s * (item.end - item.start) + 4 * s * (1 - s) * item.bow

    built.bodies[item.name] = built.scene.add(
        fl.Beam.curve(
            line,
            _section(item.section),
            cells=item.cells,
            up=item.up,
            formulation=FORMULATIONS[item.formulation],
            damping=fl.sections.Damping(item.drag, item.viscosity),
            name=item.name,
        )
    )


@add.register
def _(item: data.RigidData, built: Built) -> None:
    body = fl.RigidBody(item.mass, item.inertia, item.position, item.rotation, name=item.name)
    built.bodies[item.name] = built.scene.add(body)


@add.register
def _(item: data.ShellData, built: Built) -> None:
    def position(a: float, b: float) -> np.ndarray:
        return np.array([(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b]) @ item.corners

    s = item.section
    shell = fl.Shell(
        fl.mesh.parametric_surface(position, item.cells, cell=item.cell),
        fl.ShellSection.layer(s.thickness, fl.Material(s.E, s.nu, s.density)),
        along=item.along,
        formulation=FORMULATIONS[item.formulation],
        drilling=item.drilling,
        name=item.name,
    )
    if item.clamped is not None:
        shell.clamp(item.clamped)
    built.bodies[item.name] = built.scene.add(shell)


@add.register
def _(item: data.SlenderData, built: Built) -> None:
    def line(s: float) -> np.ndarray:
        return item.start + s * (item.end - item.start) + 4 * s * (1 - s) * item.bow

    mesh, make = fl.mesh.curve(line, item.cells), SLENDER[item.element]
    damping, section = fl.sections.Damping(item.drag), _section(item.section)
    body = built.scene.add(make(mesh, section, up=item.up, damping=damping, name=item.name))
    if item.clamped is not None:
        if isinstance(body, fl.AncfBeam | fl.Cable):
            body.clamp(body.point(item.clamped))
        else:
            built.scene.add(fl.Clamp(body.point(item.clamped)))
    built.bodies[item.name] = body


@add.register
def _(item: data.NetData, built: Built) -> None:
    damping, section = fl.sections.Damping(item.drag), _section(item.section)
    net = fl.Net(item.points, item.cables, section, damping=damping, name=item.name)
    if item.clamped is not None:
        net.pin(net.point(0))
    built.bodies[item.name] = built.scene.add(net)


@add.register
def _(item: data.PatchData, built: Built) -> None:
    def position(a: float, b: float) -> np.ndarray:
        return np.array([(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b]) @ item.corners

    s = item.section
    section = fl.ShellSection.layer(s.thickness, fl.Material(s.E, s.nu, s.density))
    patch = fl.mesh.smooth_patch(position, item.cells)
    shell = PATCHES[item.element](
        patch, section, damping=fl.sections.Damping(item.drag), name=item.name
    )
    if item.clamped is not None:
        shell.clamp(item.clamped)
    built.bodies[item.name] = built.scene.add(shell)


@add.register
def _(item: data.BlockData, built: Built) -> None:
    def position(α: float, β: float, γ: float) -> np.ndarray:
        return item.corner + α * item.a + β * item.b + γ * item.c

    mesh = fl.mesh.parametric_volume(position, (1, 1, 1), cell=item.cell)
    law = fl.sections.NeoHooke(item.E, item.nu, item.density)
    damping = fl.sections.Damping(item.drag)
    solid = fl.Solid(mesh, law, degree=item.degree, damping=damping, name=item.name)
    if item.clamped is not None:
        solid.clamp(item.clamped)
    built.bodies[item.name] = built.scene.add(solid)
    # axes that rotate with the scene, as forces that follow a face are along them
    axes = np.array([side / np.linalg.norm(side) for side in (item.a, item.b, item.c)])
    for face in ("a=0", "a=1"):
        built.faces[data.PointRef(item.name, face)] = solid.point(face, axes=axes)


@add.register
def _(item: data.ReducedData, built: Built) -> None:
    full = fl.Beam(
        fl.mesh.straight_line(item.start, item.end, 4),
        _section(item.section),
        up=item.up,
        name=item.name,
    )
    scene = fl.Scene()
    scene.add(full)
    body = fl.reduction.reduced_order_body(
        scene, [full.point("start"), full.point("end")], item.modes, name=item.name
    )
    built.bodies[item.name] = built.scene.add(body)


@add.register
def _(item: data.ContactData, built: Built) -> None:
    ball = fl.contact.Sphere(built.point(item.ball), item.radius)
    plane = fl.contact.Plane(fl.ground(), item.normal, item.at)
    law = fl.contact.Impact() if item.stiffness is None else fl.contact.Penalty(item.stiffness)
    built.scene.add(fl.contact.Contact(ball, plane, law))


_OWN = ("at", "axis", "second", "to", "normal", "pitch", "radius")


@add.register
def _(item: data.JointData, built: Built) -> None:
    kind = getattr(fl.joints, item.kind)
    given = {name: getattr(item, name) for name in _OWN if getattr(item, name) is not None}
    joint = kind(built.point(item.a), built.point(item.b), name=item.name, **given)
    built.joints[item.name] = built.scene.add(joint)


@add.register
def _(item: data.SlidingData, built: Built) -> None:
    kind = getattr(fl.joints, item.kind)
    joint = kind(built.bodies[item.beam], built.point(item.b), at=item.at, name=item.name)
    built.joints[item.name] = built.scene.add(joint)


@add.register
def _(item: data.LinkData, built: Built) -> None:
    built.scene.add(fl.joints.RigidLink(built.point(item.a), built.point(item.b)))


@add.register
def _(item: data.ClampData, built: Built) -> None:
    built.scene.add(fl.Clamp(built.point(item.point)))


@add.register
def _(item: data.MotionData, built: Built) -> None:
    point = built.point(item.point)
    start = point.frame.copy()

    def motion(t: float) -> np.ndarray:
        c = _factor(item.history, t / built.clock)
        H = start @ lie.so3_exp(c * item.turn).T
        H[0] = start[0] + c * item.shift
        return H

    built.scene.add(fl.PrescribedMotion(point, motion))


@add.register
def _(item: data.SpringData, built: Built) -> None:
    coordinate = built.coordinate(item.coordinate)
    built.scene.add(fl.joints.Spring(coordinate, item.stiffness, item.damping, item.rest))


@add.register
def _(item: data.DriveData, built: Built) -> None:
    coordinate, history = built.coordinate(item.coordinate), built.history(item.history)
    if history is None:
        built.scene.add(fl.joints.Drive(coordinate))
        return
    start = coordinate.start()
    built.scene.add(fl.joints.Drive(coordinate, lambda t: start + item.amplitude * history(t)))


@add.register
def _(item: data.GearData, built: Built) -> None:
    first, second = built.coordinate(item.first), built.coordinate(item.second)
    built.scene.add(fl.joints.Gear(first, second, item.ratio))


@add.register
def _(item: data.PointLoadData, built: Built) -> None:
    built.scene.add(
        fl.PointLoad(
            built.point(item.point),
            item.force,
            item.moment,
            following=item.following,
            history=built.history(item.history),
        )
    )


@add.register
def _(item: data.LineLoadData, built: Built) -> None:
    built.scene.add(
        fl.LineLoad(
            built.bodies[item.beam],
            item.force,
            item.moment,
            following=item.following,
            history=built.history(item.history),
        )
    )


@add.register
def _(item: data.BeamPressureData, built: Built) -> None:
    beam, history = built.bodies[item.beam], built.history(item.history)
    built.scene.add(fl.loads.PressureLoad(beam, item.pressure, item.direction, history=history))


@add.register
def _(item: data.EigenstrainData, built: Built) -> None:
    beam, history = built.bodies[item.beam], built.history(item.history)
    built.scene.add(fl.loads.Eigenstrain(beam, item.strain, history=history))


@add.register
def _(item: data.PreStressData, built: Built) -> None:
    beam, history = built.bodies[item.beam], built.history(item.history)
    built.scene.add(fl.loads.PreStress(beam, item.resultant, history=history))


@add.register
def _(item: data.AreaLoadData, built: Built) -> None:
    shell, history = built.bodies[item.shell], built.history(item.history)
    built.scene.add(fl.AreaLoad(shell, item.force, history=history))


@add.register
def _(item: data.EdgeLoadData, built: Built) -> None:
    shell, history = built.bodies[item.shell], built.history(item.history)
    load = fl.loads.EdgeLoad(
        shell, item.curve, item.force, history=history, following=item.following
    )
    built.scene.add(load)


@add.register
def _(item: data.SurfacePressureData, built: Built) -> None:
    shell, history = built.bodies[item.shell], built.history(item.history)
    built.scene.add(fl.loads.SurfacePressure(shell, item.pressure, history=history))


@add.register
def _(item: data.FaceLoadData, built: Built) -> None:
    solid, history = built.bodies[item.solid], built.history(item.history)
    built.scene.add(fl.loads.FaceLoad(solid, item.face, item.force, history=history))


@add.register
def _(item: data.FacePressureData, built: Built) -> None:
    solid, history = built.bodies[item.solid], built.history(item.history)
    built.scene.add(fl.loads.FacePressure(solid, item.face, item.pressure, history=history))


@add.register
def _(item: data.BulkLoadData, built: Built) -> None:
    solid, history = built.bodies[item.solid], built.history(item.history)
    built.scene.add(fl.loads.BulkLoad(solid, item.force, history=history))
