"""Scenes divided among ranks, for test_divided.py: ``mpirun -n 2 divided_scenes.py OUT``."""

import logging
import sys
import warnings
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

import fem_lie as fl

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
ROUND = fl.Section.circle(2e-3, STEEL)


def divide():
    """However small a scene is, it is divided among all ranks."""
    for kind in "statics", "dynamics", "vibrations", "buckling", "path":
        PETSc.Options(f"fem_lie_{kind}_")["divided_from"] = 0


def cantilever():
    """A clamped beam with distributed and concentrated loads."""
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.rectangle(0.02, 0.03, STEEL), cells=9)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 500.0)))
    scene.add(fl.LineLoad(beam, force=(0, 30.0, 0)))
    return scene, [beam.point("end"), beam.point(4)]


def sheet():
    """A curved strip with all loads of shells."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.4 * b, 0.1 * a * a), (5, 3))
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.01, STEEL))
    shell.clamp("a=0")
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(shell)
    scene.add(fl.PointLoad(shell.point("11"), force=(0.0, 300.0, 2e3)))
    scene.add(fl.AreaLoad(shell, (0, 0, -200.0)))
    scene.add(fl.loads.SurfacePressure(shell, 100.0))
    scene.add(fl.loads.EdgeLoad(shell, "b=1", force=(0, 50.0, 0)))
    return scene, [shell.point("11"), shell.point("10")]


def heated():
    """The sheet under temperatures, one of them in time."""
    scene, points = sheet()
    shell = scene.bodies[0]
    scene.add(fl.loads.Temperature(shell, 20.0, 1e-5, gradient=1e3))
    scene.add(fl.loads.Temperature(shell, 5.0, 1e-5, history=lambda t: 1.0 + t))
    return scene, points


def sail():
    """A membrane under tension and pressure, held at two edges."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.5 * b, 0.1 * a * a), (6, 4))
    cloth = fl.ShellSection.layer(1e-3, fl.Material(E=1e7, nu=0.3, density=1e3))
    film = fl.Membrane(mesh, cloth, prestress=(300.0, 200.0, 20.0))
    for edge in ("a=0", "a=1"):
        film.clamp(edge)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(film)
    scene.add(fl.loads.SurfacePressure(film, 40.0))
    scene.add(fl.loads.EdgeLoad(film, "b=1", force=(0, 20.0, 0)))
    return scene, [film.point(17), film.point(9)]


def channel():
    """A folded shell, whose fold has a node of each side."""
    mesh = fl.mesh.parametric_surface(
        lambda a, b: (a, 0.2 * min(b, 0.5), 0.2 * max(0.0, b - 0.5)), (4, 4)
    )
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.005, STEEL))
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.AreaLoad(shell, (0, 0, -500.0)))
    return scene, [shell.point("10"), shell.point("11")]


def hinged():
    """A sheet on two hinges, far from each other, which need drilling rotations everywhere."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.4 * b, 0.0), (6, 3))
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.01, STEEL))
    scene = fl.Scene()
    scene.add(shell)
    for corner in "00", "11":
        point = shell.point(corner)
        scene.add(fl.joints.Revolute(fl.ground(), point, axis=(0, 0, 1), name=f"hinge {corner}"))
    scene.add(fl.AreaLoad(shell, (2e3, 1e3, -200.0)))
    return scene, [shell.point("01"), shell.point("10")]


def block():
    """A solid under pressure and traction."""
    rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1e3)
    damping = fl.sections.Damping(stiffness=1e-4)
    brick = fl.Solid.brick((1, 1, 2), rubber, cells=(2, 2, 3), degree=2, damping=damping)
    brick.clamp("c=0")
    scene = fl.Scene()
    scene.add(brick)
    scene.add(fl.loads.FacePressure(brick, "c=1", -2e4))
    scene.add(fl.loads.FaceLoad(brick, "c=1", (1e4, 0, 0)))
    return scene, [brick.point("111"), brick.point("011")]


def pendulum():
    """A flexible double pendulum with a rigid body at its end; spring, friction, law of a user."""
    bar = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))
    upper = fl.Beam.straight((0, 0, 0), (1, 0, 0), bar, cells=4)
    lower = fl.Beam.straight((1, 0, 0), (2, 0, 0), bar, cells=4)
    ball = fl.RigidBody(0.5, 1e-3 * np.eye(3), (2, 0, 0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    for body in upper, lower, ball:
        scene.add(body)
    scene.add(fl.joints.Revolute(fl.ground(), upper.point("start"), axis=(0, 1, 0)))
    knee = scene.add(fl.joints.Revolute(upper.point("end"), lower.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Spring(knee.angle, stiffness=2.0, damping=0.1))
    law = fl.loads.compiled_law(lambda t, q, rate: 3.0 * np.sin(40.0 * t) + np.tanh(rate))
    scene.add(fl.loads.ForceLaw(knee.angle, law))
    scene.add(fl.joints.JointFriction(knee, 0.3, stiction_speed=0.05, radius=0.03))
    scene.add(fl.joints.Spherical(lower.point("end"), ball.point("centre")))
    return scene, [upper.point(2), lower.point("end"), ball.point("centre")]


def linked():
    """Two beams on ball joints, one of them damped, on one part each at most."""
    bar = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))
    damping = fl.sections.Damping(mass=2.0)
    upper = fl.Beam.straight((0, 0, 0), (1, 0, 0), bar, cells=6, damping=damping)
    lower = fl.Beam.straight((1, 0, 0), (2, 0, 0), bar, cells=6)
    lower.add_velocity((0, 0.3, 0))
    upper.add_velocity(omega=(0, 0, 0.3), about=(0, 0, 0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(upper)
    scene.add(lower)
    scene.add(fl.joints.Spherical(fl.ground(), upper.point("start")))
    scene.add(fl.joints.Spherical(upper.point("end"), lower.point("start")))
    return scene, [upper.point(3), lower.point("end")]


def net():
    """Cables that bend and cross, thrown across."""
    points = [(0.1 * i, 0.1 * j, 0.002 * i * j) for j in range(4) for i in range(4)]
    lines = [[4 * j + i for i in range(4)] for j in range(4)]
    net = fl.Net(points, [*lines, *np.transpose(lines).tolist()], ROUND)
    net.pin(net.point(0), net.point(15))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(net)
    return scene, [net.point(3), net.point(9)]


def cable():
    """A hanging cable with bending stiffness, clamped at one end."""
    line = fl.Cable.straight((0, 0, 0), (1, 0, 0), ROUND, cells=12)
    line.clamp(line.point("start"))
    line.pin(line.point("end"))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(line)
    scene.add(fl.LineLoad(line, force=(0, 1.0, 0)))
    return scene, [line.point(5)]


def balls():
    """A sheet, and balls that bounce on the floor and hit each other: pairs in contact change."""
    scene, _ = sheet()
    floor, law = fl.contact.Plane(fl.ground(), (0, 0, 1)), fl.contact.Penalty(2e4)
    found = []
    for position, velocity in (
        ((3, 0, 0.101), (0.3, 0, -0.5)),
        ((4, 0, 0.11), (0, 0, -0.5)),
        ((6, 0, 1), (2, 0, 0)),
        ((6.21, 0, 1), (0, 0, 0)),
    ):
        ball = scene.add(fl.RigidBody(1.0, 4e-3 * np.eye(3), position))
        ball.add_velocity(velocity)
        found.append(fl.contact.Sphere(ball.point("centre"), 0.1))
    for a, b in ((found[0], floor), (found[1], floor), (found[2], found[3])):
        scene.add(fl.contact.Contact(a, b, law))
    return scene, [ball.point for ball in found]


def sliders():
    """A sheet, a ball that spins on the floor and a box that slides, with friction."""
    scene, _ = sheet()
    floor, law = fl.contact.Plane(fl.ground(), (0, 0, 1)), fl.contact.Penalty(2e4, friction=0.3)
    ball, box = (scene.add(fl.RigidBody(1.0, 4e-3 * np.eye(3), (x, 0, 0.0995))) for x in (3, 5))
    ball.add_velocity(omega=(0, 20.0, 0), about=(3, 0, 0.0995))
    box.add_velocity((0.2, 0.1, 0))
    centres = [body.point("centre") for body in (ball, box)]
    surfaces = fl.contact.Sphere(centres[0], 0.1), fl.contact.Box(centres[1], (0.4, 0.4, 0.2))
    for surface in surfaces:
        scene.add(fl.contact.Contact(surface, floor, law))
    return scene, centres


def crossing():
    """A sheet, crossing beams that slide on each other, a rope in a ring, a ball in the floor."""
    scene, _ = sheet()
    bar = fl.Section.circle(0.01, fl.Material(E=5e8, nu=0.3, density=7800.0))
    ends = ((3, 0, 0), (4, 0, 0)), ((3.5, -0.5, 0.0198), (3.5, 0.5, 0.0198))
    lower, upper = (scene.add(fl.Beam.straight(*each, bar, cells=8)) for each in ends)
    upper.add_velocity((0.5, 0.1, -0.2))
    lines = (fl.contact.Line(each, 0.01) for each in (lower, upper))
    scene.add(fl.contact.Contact(*lines, fl.contact.Penalty(1e6, friction=0.3)))
    rope = scene.add(fl.Cable.straight((5, 0, 0), (6, 0, 0), ROUND, cells=6))
    bead = scene.add(fl.RigidBody(0.1, 1e-5 * np.eye(3), (5.42, 0, 0)))
    bead.add_velocity((1.0, 0, 0.5))
    rings = fl.contact.Rings([bead.point("centre")])
    law = fl.contact.Penalty(1e4, friction=0.3)
    scene.add(fl.contact.Contact(fl.contact.Rope(rope), rings, law))
    ball = scene.add(fl.RigidBody(1.0, 4e-3 * np.eye(3), (8, 0, 0.05)))
    floor, centre = fl.contact.Plane(fl.ground(), (0, 0, 1)), ball.point("centre")
    sphere = fl.contact.Sphere(centre, 0.1)
    scene.add(fl.contact.Contact(sphere, floor, fl.contact.Penalty(2e4), ignore_initial=True))
    return scene, [upper.point("end"), bead.point("centre"), centre]


def free_balls():
    """A beam of one cell, which one rank has, and balls that another one has."""
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.rectangle(0.02, 0.03, STEEL), cells=1)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    balls = [scene.add(fl.RigidBody(1.0, np.diag([1.0, 2.0, 3.0]), (k, 1, 0))) for k in range(3)]
    for ball in balls:
        ball.add_velocity(omega=(1.0, 2.0, 0.0), about=(0, 0, 0))
    return scene, [beam.point("end"), *(ball.point("centre") for ball in balls)]


def tumbling(body):
    """A free body that spins, whose nodal axes rotate with the deformation."""
    scene = fl.Scene()
    scene.add(body)
    body.add_velocity(omega=(5.0, 10.0, 20.0), about=(0.5, 0.5, 0.0))
    return scene


def tumbling_plate():
    """A soft, damped plate that spins and stretches, thrown at one corner."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (4, 3))
    layer = fl.ShellSection.layer(0.05, fl.Material(E=1e7, nu=0.3, density=1e3))
    damping = fl.sections.Damping(mass=0.2, stiffness=1e-3)
    plate = fl.Shell(mesh, layer, convected_axes=True, damping=damping)
    scene = tumbling(plate)
    scene.add(fl.PointLoad(plate.point("11"), force=(300.0, -300.0, 0)))
    return scene, [plate.point("11"), plate.point("00")]


def tumbling_block():
    """A soft block that spins and stretches."""
    rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1e3)
    brick = fl.Solid.brick((1, 1, 2), rubber, cells=(2, 2, 4))
    return tumbling(brick), [brick.point("111"), brick.point("000")]


def passing_balls():
    """A sheet, and a ball that is so fast that it passes through another one within a step."""
    scene, _ = sheet()
    balls = []
    for x, speed in ((3.0, 100.0), (3.275, 0.0)):
        ball = scene.add(fl.RigidBody(1.0, 4e-3 * np.eye(3), (x, 0, 0)))
        ball.add_velocity((speed, 0, 0))
        balls.append(fl.contact.Sphere(ball.point("centre"), 0.01))
    scene.add(fl.contact.Contact(*balls, fl.contact.Penalty(1e8)))
    return scene, []


def loose_block():
    """A solid that a load compresses and nothing holds."""
    rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1e3)
    brick = fl.Solid.brick((1, 1, 2), rubber, cells=(2, 2, 3))
    scene = fl.Scene()
    scene.add(brick)
    for face, force in (("c=1", -1e3), ("c=0", 1e3)):
        scene.add(fl.loads.FaceLoad(brick, face, (0, 0, force)))
    return scene, []


def swinging_block():
    """The same on a spherical joint, about which it may turn."""
    scene, _ = loose_block()
    scene.add(fl.joints.Spherical(fl.ground(), scene.bodies[0].point("000")))
    return scene, []


def folding_beam():
    """A moment that folds the elements of the softer half, which one rank has."""
    stiff, soft = (fl.Section.rectangle(h, 0.03, STEEL) for h in (0.03, 0.003))
    sections = {"piece 1": stiff, "piece 2": soft}
    beam = fl.Beam.polyline([(0, 0, 0), (0.5, 0, 0), (1, 0, 0)], sections, cells=4)
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    curvature = 1.2 * np.pi / 0.125
    moment = soft.stiffness[4, 4] * curvature
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, moment, 0), following=True))
    return scene, []


def free_frame():
    """Two beams on a ball joint, which nothing holds, with a spring across it."""
    bar = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))
    beams = [fl.Beam.straight((k, 0, 0), (k + 1, 0, 0), bar, cells=6) for k in range(2)]
    scene = fl.Scene()
    for beam in beams:
        scene.add(beam)
    scene.add(fl.joints.Spherical(beams[0].point("end"), beams[1].point("start")))
    return scene, [beams[1].point("end")]


def free_plate():
    """A plate that nothing holds, divided among all ranks."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.7 * b, 0.0), (4, 3))
    layer = fl.ShellSection.layer(0.05, fl.Material(E=1e7, nu=0.3, density=1e3))
    plate = fl.Shell(mesh, layer)
    scene = fl.Scene()
    scene.add(plate)
    return scene, [plate.point("11")]


def damped():
    """The linked beams at rest: free motions, some of them damped."""
    scene, points = linked()
    still = fl.Scene()
    for body in scene.bodies:
        body.model.velocities[:] = 0.0
        still.add(body)
    for joint in scene.joints:
        still.add(joint)
    return still, points


def blade():
    """A beam that spins about the axis at its clamp."""
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.rectangle(0.02, 0.03, STEEL), cells=9)
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    return scene, [beam.point("end")]


def crane():
    """A beam with a sprung and damped load: the last of three ranks owns none of its nodes."""
    bar = fl.Section.rectangle(0.02, 0.02, fl.Material(E=5e8, nu=0.3, density=7800.0))
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), bar, cells=4)
    load = fl.RigidBody(2.0, (0.02, 0.03, 0.04), (1, 0, 0))
    scene = fl.Scene()
    scene.add(beam)
    scene.add(load)
    scene.add(fl.Clamp(beam.point("start")))
    ends = beam.point("end"), load.point("centre")
    joint = scene.add(fl.joints.Cylindrical(*ends, axis=(0, 1, 0)))
    scene.add(fl.joints.Spring(joint.angle, stiffness=40.0))
    scene.add(fl.joints.Spring(joint.displacement, stiffness=400.0, damping=2.0))
    return scene, [load.point("centre")]


def column():
    """Two beams on a hinge with a spring, under compression."""
    bar = fl.Section.rectangle(0.02, 0.03, STEEL)
    beams = [fl.Beam.straight((k, 0, 0), (k + 1, 0, 0), bar, cells=4) for k in range(2)]
    scene = fl.Scene()
    for beam in beams:
        scene.add(beam)
    ends = beams[0].point("end"), beams[1].point("start")
    hinge = scene.add(fl.joints.Revolute(*ends, axis=(0, 1, 0)))
    scene.add(fl.joints.Spring(hinge.angle, stiffness=5e3))
    scene.add(fl.Clamp(beams[0].point("start")))
    scene.add(fl.PointLoad(beams[1].point("end"), force=(-1e4, 0, 0)))
    return scene, [beams[1].point("end")]


def panel():
    """A curved panel under compression."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (np.cos(a - 0.5), np.sin(a - 0.5), b), (6, 4))
    shell = fl.Shell(mesh, fl.ShellSection.layer(0.005, STEEL))
    shell.clamp("b=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "b=1", force=(0, 0, -1e4)))
    return scene, [shell.point("11")]


def arch():
    """A flat arch, whose load has bifurcations on the way to its maximum."""
    points = [(x, 0, 0.05 * np.sin(np.pi * x)) for x in np.linspace(0, 1, 5)]
    beam = fl.Beam.polyline(points, fl.Section.rectangle(0.01, 0.01, STEEL), cells=3)
    scene = fl.Scene()
    scene.add(beam)
    for end in "start", "end":
        scene.add(fl.Clamp(beam.point(end)))
    scene.add(fl.LineLoad(beam, force=(0, 0, -1e4)))
    return scene, [beam.point(6), beam.point(3)]


def strut():
    """A clamped strut, which buckles before load factor 1."""
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.rectangle(0.02, 0.03, STEEL), cells=12)
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(-1.2e4, 0, 0)))
    return scene, [beam.point("end")]


VIBRATIONS = {
    "sheet": (sheet, 5, {}),
    "sail": (sail, 3, {}),
    "channel": (channel, 5, {}),
    "hinged": (hinged, 5, {}),
    "block": (block, 4, {}),
    "cable": (cable, 4, {}),
    "free frame": (free_frame, 13, {}),
    "free plate": (free_plate, 10, {}),
    "damped": (damped, 8, {}),
    "blade": (blade, 5, {"spin": (0, 0, 30.0)}),
    "crane": (crane, 4, {}),
    "crane with all modes": (crane, 26, {}),
}
"""Scenes, numbers of modes and arguments of vibrations."""


def loaded_head():
    """A strut that carries a rigid head, whose stiffness matrix has no diagonal."""
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.rectangle(0.02, 0.03, STEEL), cells=8)
    head = fl.RigidBody(1.0, np.eye(3), (1, 0, 0))
    scene = fl.Scene()
    scene.add(beam)
    scene.add(head)
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.joints.Fixed(beam.point("end"), head.point("centre")))
    scene.add(fl.PointLoad(head.point("centre"), force=(-1e4, 0, 0)))
    return scene, [beam.point("end"), head.point("centre")]


BUCKLING = {"column": column, "panel": panel, "loaded head": loaded_head}
"""Scenes that buckle."""

PATHS = {
    "arch": (arch, fl.stability.PathEnds(factor=1.0, critical_points=2), None),
    "strut": (strut, fl.stability.PathEnds(factor=1.0, critical_points=1), None),
    "sheet on hinges": (
        hinged,
        None,
        lambda point: fl.stability.DisplacementControl(point, (0, 0, -1), 2e-3),
    ),
}
"""Scenes, ends and control of paths."""

REFUSED = {
    "loose block": (loose_block, "nothing resists"),
    "swinging block": (swinging_block, "nothing resists"),
    "folding beam": (folding_beam, ""),
}
"""Scenes that statics refuses, and what the message has on any number of ranks."""

REST = {
    "cantilever": cantilever,
    "sheet": sheet,
    "heated": heated,
    "sail": sail,
    "channel": channel,
    "hinged": hinged,
    "block": block,
}
"""Scenes in equilibrium."""

MOTIONS = REST | {
    "pendulum": pendulum,
    "net": net,
    "cable": cable,
    "balls": balls,
    "sliders": sliders,
    "free balls": free_balls,
    "plate": tumbling_plate,
    "soft block": tumbling_block,
}
EXPLICIT = {name: MOTIONS[name] for name in ("net", "cable", "balls", "soft block")}
EXPLICIT["linked beams"] = linked


@contextmanager
def counted_refinements():
    """Context with the messages that solutions are refined."""
    messages, handler = [], logging.Handler()
    handler.emit = lambda record: messages.append(record) if "refined" in record.msg else None
    log = logging.getLogger("fem_lie.linear.direct")
    level = log.level
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    yield messages
    log.removeHandler(handler)
    log.setLevel(level)


def statics(build):
    """Displacements, reactions, negative pivots and iterations."""
    scene, points = build()
    found = fl.statics(scene)
    # its state is taken in the numbering of the whole scene
    modes = fl.vibrations(scene, 3, at=found)
    return {
        "frequencies": modes.frequencies,
        **{f"displacement {k}": found.displacement(point) for k, point in enumerate(points)},
        "reactions": found.reactions.sum(axis=1),
        "negative pivots": found.negative_pivots,
        "iterations": found.iterations,
    }


def motion(build):
    """Positions, velocities, forces, coordinates, energies and impulses."""
    scene, points = build()
    # with contacts, iterations of several ranks take other corrections to the same solution
    scheme = fl.GeneralisedAlpha(tolerance=1e-12) if scene.contacts else fl.GeneralisedAlpha()
    with counted_refinements() as refined:
        found = scheme.run(scene, duration=0.02, step=2e-3, progress=False)
    return {
        "refined": np.array(len(refined)),
        **{f"position {k}": found.position(point) for k, point in enumerate(points)},
        **{f"velocity {k}": found.velocity(point) for k, point in enumerate(points)},
        "joint forces": found.joint_forces,
        "joint coordinates": found.joint_coordinates,
        "reactions": found.reactions.sum(axis=1),
        "energies": np.array([found.kinetic, found.elastic, found.potential]),
        "impulses": found.impulses,
        **({} if scene.contacts else {"iterations": found.iterations}),
        "mass": np.array(found.info.mass),
        **{
            f"contact forces {k}": fl.post.contact_forces(found, contact).total
            for k, contact in enumerate(scene.contacts)
        },
    }


def vibrations(build, count, given):
    """Eigenvalues, and amplitudes of points in the slowest mode that is not a rigid motion."""
    scene, points = build()
    modes = fl.vibrations(scene, count, **given)
    first = int(np.flatnonzero(np.abs(modes.eigenvalues) > 1.0)[0])
    return {"eigenvalues": modes.eigenvalues, "amplitudes": amplitudes(modes, first, points)}


def buckling(build):
    """Load factors, and amplitudes of points in the first mode."""
    scene, points = build()
    modes = fl.buckling(scene, 3)
    return {"factors": modes.factors, "amplitudes": amplitudes(modes, 0, points)}


LOCATED = fl.stability.PathOptions(locate=1e-10)
"""States of several ranks at critical points are equal to the tolerance of their location."""


def path(build, ends, control):
    """States, observations and critical points of a path, and the branch at the first of them."""
    scene, points = build()
    observe = {"height": lambda state: float(state.position(points[0])[2])}
    given = {"until": ends, "observe": observe, "control": control and control(points[0])}
    given["options"] = LOCATED
    if control:
        del given["until"]
    run = fl.follow_path(scene, **given)
    found = {
        "factors": run.factors,
        "positions": run.position(points[0]),
        "reactions": run.reactions.sum(axis=1),
        "heights": run.observed["height"],
        "critical factors": np.array([point.factor for point in run.critical]),
    }
    if run.bifurcations:
        first = run.bifurcations[0]
        found |= branch(scene, points, fl.stability.switch_branch(scene, first), first.factor)
    return found


def branch(scene, points, start, factor):
    """Some states of a branch, and a path that starts in one of them."""
    ends = fl.stability.PathEnds(steps=6)
    run = fl.follow_path(scene, until=ends, start=start)
    again = fl.follow_path(scene, until=ends, start=run.stations[3])
    places = [np.abs(each.position(points[0])) for each in (run, again)]
    factors = [each.factors / factor for each in (run, again)]
    return {"branch positions": np.array(places), "branch factors": np.array(factors)}


def amplitudes(modes, mode, points):
    """Lengths of the displacements of points in a mode."""
    return np.array([np.linalg.norm(modes.displacement(point)[mode]) for point in points])


def explicit(build):
    """Positions, velocities, joint forces, energies and impulses of explicit steps."""
    scene, points = build()
    step = 0.5 * fl.Explicit().stable_step(scene)
    found = fl.Explicit().run(scene, duration=40 * step, step=step, save_every=10, progress=False)
    return {
        **{f"position {k}": found.position(point) for k, point in enumerate(points)},
        **{f"velocity {k}": found.velocity(point) for k, point in enumerate(points)},
        "joint forces": found.joint_forces,
        "energies": np.array([found.kinetic, found.elastic, found.potential]),
        "impulses": found.impulses,
    }


def is_refused(solve, build, reason):
    """Whether a solver fails for a reason, on each rank."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of elements that are about to fold
            solve(build()[0])
    except fl.ConvergenceError as error:
        return np.array(reason in str(error))
    return np.array(False)


def fails_on_all():
    """Whether all ranks get an error of a load that one of them has, and end their run."""
    scene, points = cantilever()

    def push(t):
        if t > 5e-3:
            raise ArithmeticError("no push is known here")
        return t

    scene.add(fl.PointLoad(points[0], force=(0, 0, 1.0), history=push))
    with TemporaryDirectory() as folder:
        file = Path(MPI.COMM_WORLD.bcast(folder)) / "run.h5"
        try:
            fl.GeneralisedAlpha().run(scene, duration=1e-2, step=1e-3, file=file, progress=False)
        except ArithmeticError as error:
            MPI.COMM_WORLD.barrier()
            return np.array("no push is known here" in str(error))
    return np.array(False)


def fast(scene):
    """Steps that are too large for surfaces to stay on their sides."""
    return fl.GeneralisedAlpha().run(scene, duration=0.02, step=2e-3, progress=False)


def refusals():
    """Whether scenes are refused, and loads that fail on one rank end all of them."""
    found = {}
    for name, (build, reason) in REFUSED.items():
        found[f"{name} is refused"] = is_refused(fl.statics, build, reason)
    found["a load fails on all ranks"] = fails_on_all()
    found["fast balls are refused"] = is_refused(fast, passing_balls, "passed through the other")
    return found


def of_each(scenes, of, way):
    """Results of scenes by their names and quantities; ``of`` takes what a scene is built from."""
    return {
        f"{name}{way}, {what}": value
        for name, given in scenes.items()
        for what, value in of(*(given if isinstance(given, tuple) else (given,))).items()
    }


PARTS = {
    "refusals": refusals,
    "rest": lambda: of_each(REST, statics, " at rest"),
    "motions": lambda: of_each(MOTIONS, motion, " in motion"),
    "explicit": lambda: of_each(EXPLICIT, explicit, " in explicit motion"),
    "vibrations": lambda: of_each(VIBRATIONS, vibrations, ", vibrations"),
    "buckling": lambda: of_each(BUCKLING, buckling, ", buckling"),
    "paths": lambda: of_each(PATHS, path, ", path"),
}
"""Results of one kind of analysis, by its name."""


def results(parts=tuple(PARTS)):
    """Results of some kinds of analyses, by those, scene and quantity."""
    return {f"{part}: {name}": value for part in parts for name, value in PARTS[part]().items()}


if __name__ == "__main__":
    divide()
    out, *parts = sys.argv[1:]
    found = results(parts)
    if "paths" in parts:
        followed = fl.follow_path(strut()[0], until=PATHS["strut"][1], options=LOCATED)
        followed.save(f"{out}.path")
    if MPI.COMM_WORLD.rank == 0:
        np.savez(out, **found)
