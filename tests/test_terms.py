"""The door of terms: whatever adds forces, energy and a matrix keeps these laws.

A name in the list below is a term that is tested by all of them.
"""

import ast
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest
import ufl

import fem_lie as fl
from fem_lie import lie
from fem_lie.forms import abilities
from fem_lie.system import System
from fem_lie.system.terms.all_terms import Terms
from fem_lie.system.terms.attached import AttachedTerm, RigidCells
from tests.own_elements import random_body
from tests.own_form_body import own_beam
from tests.own_surface import Quartic
from tests.test_packages import MODULES, import_all, imports_of

MATERIAL = fl.Material(100.0, 0.3, 2.0)
INERTIA = np.diag([0.5, 0.0, 0.01, 0.02])
SECTION = fl.Section.from_stiffness([90.0, 40.0, 50.0, 2.0, 1.0, 1.5], INERTIA)
CABLE = fl.Section.from_stiffness([90.0, 40.0, 40.0, 2.0, 1.0, 1.0], INERTIA)
PLACES = [(0.0, 0, 0), (1, 0.2, 0), (2, 0.2, 0.3)]
LAYER = fl.ShellSection.layer(0.2, MATERIAL)


def scene_with(*items) -> fl.Scene:
    scene = fl.Scene()
    for item in items:
        scene.add(item)
    return scene


def loaded_own_beam() -> fl.Scene:
    own = own_beam("viscous")
    q = own.model.problem.q
    moment = ufl.as_vector((0.3, -0.2, 0.5))
    work = fl.extend.dead_moment(moment, ufl.dx(q.function.function_space.mesh, degree=3), q)
    return scene_with(own, fl.loads.FormLoad(own, work))


def beam(formulation=None, **options) -> fl.Scene:
    line = fl.Beam.straight(
        (0, 0, 0), (2, 1, 0), SECTION, cells=2, formulation=formulation, **options
    )
    return scene_with(line)


def ancf(**options) -> fl.Scene:
    return scene_with(fl.AncfBeam.straight((0, 0, 0), (2, 1, 0), SECTION, cells=2, **options))


def branch(**options) -> fl.Scene:
    """Nodes that follow others."""
    mesh = fl.mesh.LineMesh.from_cells(
        [(0, 0, 0), (1, 0, 0), (1.2, 0.8, 0), (1.5, 0, 0.8)], [(0, 1), (1, 2), (1, 3)]
    )
    return scene_with(fl.Beam(mesh, SECTION, **options))


def membrane(law):
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.5 * b, 0.1 * a * b), (2, 2))
    tension = (50.0, -20.0, 10.0)
    section = fl.ShellSection.layer(1e-3, fl.Material(1e6, 0.3, 1e3))
    return scene_with(fl.Membrane(mesh, section, prestress=tension, formulation=law))


def shell(formulation, cell="quadrilateral", degree=1, drilling=False) -> fl.Scene:
    def position(a, b):
        return (2.0 * a, b, 0.3 * a * b)

    mesh = fl.mesh.parametric_surface(position, (2, 1), cell=cell, degree=degree)
    return scene_with(fl.Shell(mesh, LAYER, formulation=formulation, drilling=drilling))


def cable(**options) -> fl.Scene:
    """Nodes of positions and slopes."""
    mesh = fl.mesh.LineMesh.from_cells(PLACES, [(0, 1), (1, 2)], kink_angle=1.5)
    return scene_with(fl.Cable(mesh, CABLE, **options))


def rod(**options) -> fl.Scene:
    """Edges with axes."""
    curve = fl.Rod.curve(
        lambda s: (2 * s, 0.4 * s * s, 0.3 * np.sin(2 * s)),
        SECTION,
        cells=3,
        formulation=fl.elements.DiscreteRod(**options),
    )
    return scene_with(curve)


def thin_shell() -> fl.Scene:
    """Points of two nodes."""
    patch = fl.mesh.smooth_patch(lambda a, b: (2.0 * a, b, 0.3 * a * b), (2, 1))
    return scene_with(fl.ThinShell(patch, LAYER))


def solid() -> fl.Scene:
    """Nodes of positions."""
    material = fl.sections.NeoHooke(80.0, 0.3, density=2.0)
    return scene_with(fl.Solid.brick((2.0, 1.0, 1.0), material, cells=(2, 1, 1)))


def pressed(scene: fl.Scene) -> fl.Scene:
    body = scene.bodies[0]
    if isinstance(body, fl.Beam):
        scene.add(fl.loads.PressureLoad(body, 3.0))
    else:
        scene.add(fl.loads.SurfacePressure(body, lambda x: 1.0 + x[0], gradient=(0.3, -0.2, 0.5)))
    return scene


def sprung() -> fl.Scene:
    """Bodies on ground and on each other, with springs and dampers of all coordinates."""
    one = fl.RigidBody(2.0, np.diag([0.1, 0.2, 0.3]), (0, 0, 0))
    two = fl.RigidBody(1.0, np.diag([0.2, 0.1, 0.3]), (1.0, 0.2, -0.3))
    scene = scene_with(one, two)
    hinge = scene.add(
        fl.joints.Revolute(
            one.point("centre"), two.point("centre"), at=(0.5, 0.1, 0.2), axis=(1, 2, 3)
        )
    )
    slide = scene.add(
        fl.joints.Prismatic(fl.ground(), one.point("centre"), at=(0, 1, 0), axis=(3, 1, 2))
    )
    rope = scene.add(fl.joints.Distance(fl.ground(), two.point("centre")))
    for coordinate, rest in ((hinge.angle, 0.2), (slide.displacement, -0.3), (rope.length, 0.7)):
        scene.add(fl.joints.Spring(coordinate, stiffness=5.0, damping=0.7, rest=rest))
    return scene


def held(scene: fl.Scene, **options) -> fl.Scene:
    """Force and moment on a position that is no node."""
    position = scene.bodies[0].point_in_cell(1, 0.3)
    scene.add(fl.PointLoad(position, (1.0, -2.0, 3.0), (0.4, 0.7, -0.2), **options))
    return scene


def plate() -> fl.Scene:
    """Points of a position and three slopes."""
    patch = fl.mesh.smooth_patch(lambda a, b: (2.0 * a, b, 0.3 * a * b), (2, 1))
    return scene_with(fl.AncfShell(patch, LAYER))


def sewn() -> fl.Scene:
    """Two patches whose parametrisations do not agree."""
    patches = {
        "left": fl.mesh.smooth_patch(lambda a, b: (a, b, 0.2 * (a - 1) * b), (1, 2)),
        "right": fl.mesh.smooth_patch(
            lambda a, b: (1 + a, 0.5 * (b + b**2), 0.1 * a * (b + b**2)), (1, 1)
        ),
    }
    couplings = [fl.mesh.PatchCoupling("left.a=1", "right.a=0", 3.0)]
    return scene_with(fl.ThinShell(patches, LAYER, couplings=couplings))


def sprung_within() -> fl.Scene:
    """Springs and dampers of a hinge within an element and of the distance to another position."""
    scene = beam()
    position, other = scene.bodies[0].point_in_cell(0, 0.4), scene.bodies[0].point_in_cell(1, 0.7)
    body = scene.add(fl.RigidBody(2.0, np.diag([0.1, 0.2, 0.3]), (0.3, 0.4, 0)))
    hinge = scene.add(
        fl.joints.Revolute(position, body.point("centre"), at=(0.4, 0.2, 0), axis=(1, 2, 3))
    )
    rope = scene.add(fl.joints.Distance(other, body.point("centre")))
    for coordinate, rest in ((hinge.angle, 0.2), (rope.length, 0.7)):
        scene.add(fl.joints.Spring(coordinate, stiffness=5.0, damping=0.7, rest=rest))
    return scene


def touching() -> fl.Scene:
    """Corners and balls of bodies on each other, on a beam, on ground and in a hollow."""
    one = fl.RigidBody(2.0, np.diag([0.1, 0.2, 0.3]), (0, 0, 0))
    two = fl.RigidBody(1.0, np.diag([0.2, 0.1, 0.3]), (1.0, 0.2, -0.3))
    line = fl.Beam.straight((0, 2, 0), (1, 2, 0), SECTION, cells=1)
    return scene_with(one, two, line)


def in_contact(a, b, **law) -> fl.Scene:
    """The surfaces that a scene's bodies have, deep in each other when nodes are moved."""
    scene = touching()
    one, two, line = scene.bodies
    scene.add(
        fl.contact.Contact(a(one, two, line), b(one, two, line), fl.contact.Penalty(50.0, **law))
    )
    return scene


def corners_on_plane(**law) -> fl.Scene:
    return in_contact(
        lambda one, two, line: fl.contact.Box(one.point("centre"), (0.3, 0.4, 0.5)),
        lambda one, two, line: fl.contact.Plane(
            two.point((0.6, 0.1, 0.1)), (-1, 0.1, 0.05), at=(0.16, 0, 0)
        ),
        **law,
    )


def balls_on_balls(**law) -> fl.Scene:
    return in_contact(
        lambda one, two, line: fl.contact.Vertices(
            [one.point("centre"), line.point("start")], 0.62
        ),
        lambda one, two, line: fl.contact.Vertices(
            [two.point((0.85, 0.45, 0.1)), line.point("end")], 0.37
        ),
        **law,
    )


def ball_in_hollow(**law) -> fl.Scene:
    return in_contact(
        lambda one, two, line: fl.contact.Sphere(one.point((0.3, 0.2, 0)), 0.4),
        lambda one, two, line: fl.contact.Sphere(two.point((0.7, 0.4, 0.2)), 0.88, hollow=True),
        **law,
    )


def balls_in_quartic(**law) -> fl.Scene:
    """Inside a surface with a gap function, beside the node that it is fixed to."""
    return in_contact(
        lambda one, two, line: fl.contact.Sphere(one.point((0.3, 0.2, 0)), 0.4),
        lambda one, two, line: Quartic(two.point((0.7, 0.4, 0.2)), size=1.01),
        **law,
    )


def ends_in_quartic(**law) -> fl.Scene:
    return in_contact(
        lambda one, two, line: fl.contact.Vertices([line.point("start"), two.point("centre")], 0.2),
        lambda one, two, line: Quartic(fl.ground(), size=2.6),
        **law,
    )


def vectors_on_plane(**law) -> fl.Scene:
    """Nodes of positions and slopes, of lines and of a surface, whose axes are not their rows."""
    scene = cable()
    scene.add(fl.AncfBeam.straight((0, 1, 0), (2, 2, 0), SECTION, cells=1))
    scene.add(plate().bodies[0])
    ball = scene.add(fl.RigidBody(2.0, np.diag([0.1, 0.2, 0.3]), (0.6, 0.3, 0.9)))
    nodes = [fl.extend.Point(body, k) for body in scene.bodies[:-1] for k in (0, 1)]
    plane = fl.contact.Plane(ball.point("centre"), (0, 0, 1), at=(0, 0, -0.1))
    scene.add(
        fl.contact.Contact(fl.contact.Vertices(nodes, 0.1), plane, fl.contact.Penalty(50.0, **law))
    )
    return scene


def ends_on_ground(**law) -> fl.Scene:
    return in_contact(
        lambda one, two, line: fl.contact.Vertices(
            [line.point("start"), line.point("end"), two.point("centre")], 0.2
        ),
        lambda one, two, line: fl.contact.Plane(fl.ground(), (0, 0.3, 1), at=(0, 0, -0.45)),
        **law,
    )


def line_on_bar(**law) -> fl.Scene:
    """An element, all of which is within a bar that moves, with ends far off."""
    return in_contact(
        lambda one, two, line: fl.contact.Line(line, 0.4),
        lambda one, two, line: fl.contact.Cylinder(
            two.point((0.5, 1.27, 0.42)), (4, 0.25, 0.43), 0.45
        ),
        **law,
    )


def line_on_line(**law) -> fl.Scene:
    """Two elements along each other."""
    scene = touching()
    *_, line = scene.bodies
    other = scene.add(fl.Beam.straight((-1.5, 1.26, 0.05), (2.5, 1.28, 0), SECTION, cells=1))
    scene.add(
        fl.contact.Contact(
            fl.contact.Line(line, 0.4),
            fl.contact.Line(other, 0.33),
            fl.contact.Penalty(50.0, **law),
        )
    )
    return scene


def sheet(cell: str, position, **options) -> fl.Shell:
    """One square, or two triangles."""
    mesh = fl.mesh.parametric_surface(position, (1, 1), cell=cell, **options)
    element = fl.elements.DisplacementBased() if options.get("degree") == 2 else None
    return fl.Shell(mesh, fl.ShellSection.layer(0.3, MATERIAL), formulation=element)


def shell_on_shell(
    cell: str = "quadrilateral", degree: int = 1, smooth: bool = True, **law
) -> fl.Scene:
    """A sheet above a wider one, as thick as they are apart."""
    scene = fl.Scene(gravity=(0, 0, 0))
    upper = scene.add(sheet(cell, lambda a, b: np.array([a, b, 1.0 + 0.05 * a * b])))
    wide = sheet(cell, lambda a, b: np.array([5 * a - 2.2, 5 * b - 2.1, 0.05 * a]), degree=degree)
    lower = scene.add(wide)
    surfaces = (
        fl.contact.ShellSurface(upper, 1.1, smooth=smooth),
        fl.contact.ShellSurface(lower, 0.9, smooth=smooth),
    )
    scene.add(fl.contact.Contact(*surfaces, fl.contact.Penalty(50.0, **law)))
    return scene


def shell_on_edge() -> fl.Scene:
    """A sheet beside another one."""
    scene = fl.Scene(gravity=(0, 0, 0))
    one = scene.add(sheet("quadrilateral", lambda a, b: np.array([a, 2 * b - 0.5, 0.3 * a])))
    two = scene.add(sheet("quadrilateral", lambda a, b: np.array([2 + a, b - 0.3, 0.4 * b - 0.2])))
    scene.add(
        fl.contact.Contact(
            fl.contact.ShellSurface(one, 1.1),
            fl.contact.ShellSurface(two, 1.1),
            fl.contact.Penalty(50.0),
        )
    )
    return scene


def ball_on_shell(smooth: bool = True) -> fl.Scene:
    """Two balls, one above a triangle."""
    scene = fl.Scene(gravity=(0, 0, 0))
    ball = scene.add(fl.RigidBody(2.0, np.diag([0.1, 0.2, 0.3]), (0.2, 0.1, 1.0)))
    wide = sheet("triangle", lambda a, b: np.array([5 * a - 2.2, 5 * b - 2.1, 0.05 * a]))
    lower = scene.add(wide)
    balls = fl.contact.Vertices([ball.point("centre"), ball.point((0.5, 0.4, 1.05))], 0.5)
    scene.add(
        fl.contact.Contact(
            fl.contact.ShellSurface(lower, 0.9, smooth=smooth), balls, fl.contact.Penalty(50.0)
        )
    )
    return scene


def shell_on_plane(**law) -> fl.Scene:
    """Behind a plane of a body that moves."""
    scene = fl.Scene(gravity=(0, 0, 0))
    body = scene.add(fl.RigidBody(2.0, np.diag([0.1, 0.2, 0.3]), (0.2, 0.1, -0.5)))
    upper = scene.add(sheet("quadrilateral", lambda a, b: np.array([a, b, 0.1 * a * b])))
    plane = fl.contact.Plane(body.point("centre"), (0.1, 0, 1))
    scene.add(
        fl.contact.Contact(
            plane, fl.contact.ShellSurface(upper, 1.0), fl.contact.Penalty(50.0, **law)
        )
    )
    return scene


def line_on_plane(**law) -> fl.Scene:
    """An element, all of which is behind a plane."""
    return in_contact(
        lambda one, two, line: fl.contact.Line(line, 0.4),
        lambda one, two, line: fl.contact.Plane(two.point((0.5, 1.65, 0.2)), (0.02, 0.87, -0.5)),
        **law,
    )


def mortar_on_plane(law: fl.contact.MortarPenalty) -> fl.Scene:
    """The same with pressures of nodes."""
    scene = touching()
    _, two, line = scene.bodies
    plane = fl.contact.Plane(two.point((0.5, 1.65, 0.2)), (0.02, 0.87, -0.5))
    scene.add(fl.contact.Contact(fl.contact.Line(line, 0.4), plane, law))
    return scene


def mortar_on_line() -> fl.Scene:
    """Two elements along each other with pressures of nodes."""
    scene = touching()
    *_, line = scene.bodies
    other = scene.add(fl.Beam.straight((-1.5, 1.26, 0.05), (2.5, 1.28, 0), SECTION, cells=1))
    lines = fl.contact.Line(line, 0.4), fl.contact.Line(other, 0.33)
    scene.add(fl.contact.Contact(*lines, fl.contact.MortarPenalty(50.0)))
    return scene


def reduced_order() -> fl.Scene:
    """A beam with a bow, in its ends and four shapes between."""
    full = fl.Scene()
    line = fl.mesh.curve(lambda s: (2 * s, 0.3 * np.sin(np.pi * s), 0.2 * s**2), 6)
    bow = full.add(fl.Beam(line, SECTION))
    return scene_with(
        fl.reduction.reduced_order_body(full, [bow.point("start"), bow.point("end")], 4)
    )


def rope_in_rings() -> fl.Scene:
    """One ring on a body, one on ground."""
    scene = fl.Scene()
    rope = scene.add(fl.Beam.straight((0, 0, 0), (4, 0, 0), SECTION, cells=4))
    body = scene.add(fl.RigidBody(2.0, np.diag([0.1, 0.2, 0.3]), (1.4, 0, -0.5)))
    rings = fl.contact.Rings([body.point("centre"), fl.ground()], at=[(1.4, 0, 0), (2.7, 0, 0)])
    scene.add(fl.contact.Contact(fl.contact.Rope(rope), rings, fl.contact.Penalty(50.0)))
    return scene


CORNERS = "discrete rods (DiscreteRod)"
HELD = "loads on points that are not nodes"
TOUCH = "contacts by penalty"
MASS = fl.sections.Damping(mass=0.7)
VISCOUS = fl.sections.Damping(stiffness=0.3)


class Case(NamedTuple):
    """A scene, and what its term is called."""

    scene: Callable[[], fl.Scene]
    label: str


TERMS: dict[str, Case] = {
    "geodesic beam": Case(lambda: beam(fl.elements.GeodesicBeam()), "elements"),
    "director beam": Case(lambda: beam(fl.elements.DirectorBeam(1)), "elements"),
    "quadratic director beam": Case(lambda: beam(fl.elements.DirectorBeam(2)), "elements"),
    "Kirchhoff rod": Case(lambda: beam(fl.elements.KirchhoffRod()), "elements"),
    "rod along a spline": Case(
        lambda: scene_with(fl.Rod(fl.mesh.Spline.through(PLACES, cells=2).mesh(), CABLE)),
        "elements",
    ),
    "own viscous forms": Case(lambda: scene_with(own_beam("viscous")), "elements"),
    "own mixed forms": Case(lambda: scene_with(own_beam("mixed")), "elements"),
    "own moment": Case(lambda: scene_with(own_beam("moment", "viscous")), "virtual work"),
    "own moment as a load": Case(loaded_own_beam, "virtual work"),
    "viscous beam": Case(lambda: beam(damping=VISCOUS), "elements"),
    "branched beam": Case(lambda: branch(damping=VISCOUS), "elements"),
    "cable": Case(cable, "elements"),
    "discrete cable": Case(lambda: cable(formulation=fl.elements.DiscreteCable()), "elements"),
    "spline cable": Case(
        lambda: scene_with(fl.SplineCable.through(PLACES, CABLE, cells=2)), "elements"
    ),
    "bending springs": Case(
        lambda: cable(formulation=fl.elements.DiscreteCable()), "bending springs"
    ),
    "discrete rod": Case(rod, "elements"),
    "corners of a rod": Case(rod, CORNERS),
    "corners of a naturally curved rod": Case(lambda: rod(natural=(0.3, -0.4, 0.2)), CORNERS),
    "mixed shell": Case(lambda: shell(fl.elements.HellingerReissner()), "elements"),
    "mixed triangles": Case(lambda: shell(fl.elements.HellingerReissner(), "triangle"), "elements"),
    "plain geodesic beam": Case(lambda: beam(fl.elements.GeodesicBeam(False)), "elements"),
    "three-field shell": Case(lambda: shell(fl.elements.HuWashizu()), "elements"),
    "assumed shear shell": Case(lambda: shell(fl.elements.DisplacementBased()), "elements"),
    "quadratic shell": Case(
        lambda: shell(fl.elements.DisplacementBased(), "triangle", 2), "elements"
    ),
    "shell with drilling rotations": Case(
        lambda: shell(fl.elements.HellingerReissner(), drilling=True), "elements"
    ),
    "membrane": Case(lambda: membrane(fl.elements.LinearMembrane()), "elements"),
    "tension field": Case(lambda: membrane(fl.elements.TensionField(0.1)), "elements"),
    "drilling": Case(
        lambda: shell(fl.elements.HellingerReissner(), drilling=True),
        "drilling of shells with drilling rotations",
    ),
    "pressure on a beam": Case(lambda: pressed(beam()), "pressure on beams"),
    "pressure on a branch": Case(lambda: pressed(branch()), "pressure on beams"),
    "pressure on a shell": Case(
        lambda: pressed(shell(fl.elements.HellingerReissner())), "pressure on shells"
    ),
    "pressure on a curved shell": Case(
        lambda: pressed(shell(fl.elements.DisplacementBased(), "triangle", 2)), "pressure on shells"
    ),
    "thin shell": Case(thin_shell, "elements"),
    "coupling of thin shells": Case(sewn, "couplings"),
    "plate with shear": Case(plate, "elements"),
    "pressure on a plate with shear": Case(lambda: pressed(plate()), "pressure on thin shells"),
    "beam of slopes": Case(ancf, "elements"),
    "restrained warping": Case(lambda: ancf(warping=0.7), "restrained warping"),
    "damping of mass of a beam of slopes": Case(lambda: ancf(damping=MASS), "damping of mass"),
    "load within a beam of slopes": Case(lambda: held(ancf()), HELD),
    "viscous element of vectors": Case(
        lambda: scene_with(random_body("function of products, with a law")), "elements"
    ),
    "solid": Case(solid, "elements"),
    "reduced-order body": Case(reduced_order, "reduced bodies"),
    "rope in rings": Case(rope_in_rings, "rings on a rope"),
    "pressure on a thin shell": Case(lambda: pressed(thin_shell()), "pressure on thin shells"),
    "load within a geodesic": Case(lambda: held(beam()), HELD),
    "load within two directors": Case(lambda: held(beam(fl.elements.DirectorBeam(1))), HELD),
    "load within three directors": Case(lambda: held(beam(fl.elements.DirectorBeam(2))), HELD),
    "load that follows within a branch": Case(lambda: held(branch(), following=True), HELD),
    "springs": Case(sprung, "springs"),
    "springs within an element": Case(sprung_within, "springs"),
    "dampers within an element": Case(sprung_within, "dampers"),
    "dampers": Case(sprung, "dampers"),
    "corners on a plane": Case(corners_on_plane, TOUCH),
    "balls on balls": Case(balls_on_balls, TOUCH),
    "ball in a hollow": Case(ball_in_hollow, TOUCH),
    "ends on ground": Case(ends_on_ground, TOUCH),
    "nodes of vectors on a plane": Case(vectors_on_plane, TOUCH),
    "nodes of vectors that damp on a plane": Case(lambda: vectors_on_plane(damping=0.3), TOUCH),
    "balls within a quartic": Case(balls_in_quartic, TOUCH),
    "ends within a quartic on ground": Case(ends_in_quartic, TOUCH),
    "damped balls within a quartic": Case(lambda: balls_in_quartic(damping=3.0), TOUCH),
    "line on a bar": Case(line_on_bar, TOUCH),
    "line on a line": Case(line_on_line, TOUCH),
    "line on a plane": Case(line_on_plane, TOUCH),
    "mortar on a plane": Case(
        lambda: mortar_on_plane(fl.contact.MortarPenalty(50.0)), "mortar contacts"
    ),
    "multipliers on a plane": Case(
        lambda: mortar_on_plane(fl.contact.Mortar(50.0)), "mortar contacts with multipliers"
    ),
    "mortar on a line": Case(mortar_on_line, "mortar contacts"),
    "shell on a shell": Case(shell_on_shell, TOUCH),
    "triangles on triangles": Case(lambda: shell_on_shell("triangle"), TOUCH),
    "shell on quadratic cells": Case(lambda: shell_on_shell(degree=2), TOUCH),
    "shell on quadratic triangles": Case(lambda: shell_on_shell("triangle", 2), TOUCH),
    "bilinear shell surface on a shell": Case(lambda: shell_on_shell(smooth=False), TOUCH),
    "bilinear shell surface of triangles": Case(
        lambda: shell_on_shell("triangle", smooth=False), TOUCH
    ),
    "shell on an edge": Case(shell_on_edge, TOUCH),
    "balls on a shell": Case(ball_on_shell, TOUCH),
    "balls on a bilinear shell surface": Case(lambda: ball_on_shell(smooth=False), TOUCH),
    "shell on a plane": Case(shell_on_plane, TOUCH),
    "shell with contact damping on a shell": Case(lambda: shell_on_shell(damping=0.3), TOUCH),
    "line that damps on a bar": Case(lambda: line_on_bar(damping=0.3), TOUCH),
    "corners on a plane that damps": Case(lambda: corners_on_plane(damping=0.3), TOUCH),
    "balls that damp": Case(lambda: balls_on_balls(damping=0.3), TOUCH),
    "damping of mass": Case(lambda: beam(damping=MASS), "damping of mass"),
    "damping of mass of a cable": Case(lambda: cable(damping=MASS), "damping of mass"),
    "damping of mass of a branch": Case(lambda: branch(damping=MASS), "damping of mass"),
}

every_term = pytest.mark.parametrize("name", TERMS)
# the matrix of multipliers is that of the saddle point, which has their geometric stiffness
every_derivative = pytest.mark.parametrize("name", sorted({*TERMS} - {"multipliers on a plane"}))
STEP = 1e-5


@cache
def made(name: str) -> System:
    return System(TERMS[name].scene(), dynamics=True)


class Model:
    """A term in a bent state, with the increments that its nodes may make."""

    def __init__(self, name: str) -> None:
        self.system = made(name)
        (self.term,) = (t for t in self.system.terms if t.label == TERMS[name].label)
        self.count, self.rng = self.system.count, np.random.default_rng(7)
        self.H = self.moved(self.system.frames, self.increment(), 0.2)
        self.reset_stress()

    def reset_stress(self) -> None:
        """Make stress that is updated linearly that of the present state."""
        if self.term.stress_update is not None:
            self.term.stress_update.reset_stress(self.H)

    def increment(self) -> np.ndarray:
        return np.where(self.system.held, 0.0, self.rng.normal(size=(self.count, 6)))

    def moved(self, H: np.ndarray, h: np.ndarray, size: float) -> np.ndarray:
        there = H.copy()
        fl.extend.node_types.retract_all(self.system.kinds, H, size * h, there)
        return there

    def as_fast(self, v: np.ndarray, there: np.ndarray) -> np.ndarray:
        """The velocity of the nodes' groups, twists of frames, that ``v`` is, elsewhere."""
        moving, kinds = v.copy(), fl.extend.node_types.at_rest(self.system.kinds)
        fl.extend.node_types.all_to_group(kinds, self.H, moving)
        fl.extend.node_types.all_from_group(kinds, there, moving)
        return moving

    def forces(self, H: np.ndarray, kept: np.ndarray | None = None) -> np.ndarray:
        out = np.zeros((self.count, 6))
        if self.term.local is not None:
            self.term.local.condense(H)
        self.term.add_forces(H, out, kept)
        return out

    def viscous(self, H: np.ndarray, v: np.ndarray) -> np.ndarray:
        out = np.zeros((self.count, 6))
        if self.term.viscosity is not None:
            self.term.viscosity.add_viscous_forces(H, v, out)
        return out

    def tangent(self) -> np.ndarray:
        """Of the forces in the present state, blocks of pairs."""
        kept = self.term.workspace()
        self.forces(self.H, kept)
        self.reset_stress()
        blocks, more = self.term.tangent(self.H, kept), self.term.geometric(self.H)
        return blocks.copy() if more is None else blocks + more

    def times(self, blocks: np.ndarray, h: np.ndarray) -> np.ndarray:
        """Blocks of the term's pairs times a vector of the nodes."""
        rows, columns = self.term.pairs
        out = np.zeros((self.count, 6))
        np.add.at(out, rows, np.einsum("pij,pj->pi", blocks, h[columns]))
        return out


def close(found: np.ndarray, expected: np.ndarray, part: float) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=part * np.abs(expected).max())


@every_term
def test_forces_are_the_gradient_of_the_energy(name):
    model = Model(name)
    if model.term.load:
        assert model.term.energy(model.H) == 0.0  # what it does is work
        return
    forces = model.forces(model.H)
    for _ in range(3):
        h = model.increment()
        ahead, back = (model.term.energy(model.moved(model.H, h, s * STEP)) for s in (1, -1))
        work = np.vdot(forces, h)
        # third derivatives times the step's square, and round-off over the step
        assert abs((ahead - back) / (2 * STEP) - work) <= 1e-7 * np.abs(forces * h).sum()


@every_derivative
def test_tangent_is_the_derivative_of_the_forces(name):
    model = Model(name)
    blocks = model.tangent()
    for _ in range(3):
        h = model.increment()
        ahead, back = (model.forces(model.moved(model.H, h, s * STEP)) for s in (1, -1))
        close(model.times(blocks, h), (ahead - back) / (2 * STEP), 1e-6)


@every_term
def test_tangent_depends_on_what_it_is_given_alone(name):
    """Not on what forces were asked for last."""
    model = Model(name)
    before = model.tangent()
    kept = model.term.workspace()
    model.forces(model.H, kept)
    model.forces(model.moved(model.H, model.increment(), 0.1), model.term.workspace())
    model.reset_stress()
    blocks, more = model.term.tangent(model.H, kept), model.term.geometric(model.H)
    close(blocks if more is None else blocks + more, before, 1e-13)


@every_term
def test_pairs_have_all_that_moves_the_forces(name):
    """When one node moves, forces change at those alone that are paired with it."""
    model = Model(name)
    model.forces(model.H)  # which find out who is near whom
    rows, columns = model.term.pairs
    assert rows.max(initial=0) < model.count
    assert columns.max(initial=0) < model.count
    still, v = np.zeros((model.count, 6)), model.increment()
    for node in range(model.count):
        alone = still.copy()
        alone[node] = model.increment()[node]
        there = model.moved(model.H, alone, 0.1)
        moved = model.forces(there) - model.forces(model.H)
        moved += model.viscous(model.H, v + alone) - model.viscous(model.H, v)
        elsewhere = np.setdiff1d(np.arange(model.count), rows[columns == node])
        assert np.abs(moved[elsewhere]).max(initial=0.0) <= 1e-12 * max(np.abs(moved).max(), 1.0)


@every_term
def test_viscous_tangent_is_the_derivative_of_viscous_forces(name):
    """In velocities, and in frames where that is not left out; they are linear and take energy."""
    model = Model(name)
    if model.term.viscosity is None:
        return
    v = model.increment()
    assert np.vdot(model.viscous(model.H, v), v) > 0.0
    by_twists, by_frames = model.term.viscosity.viscous_tangent(model.H, v)
    close(model.times(by_twists, v), model.viscous(model.H, v), 1e-12)
    if by_frames is None:
        return
    h = model.increment()
    there = [model.moved(model.H, h, s * STEP) for s in (1, -1)]
    ahead, back = (model.viscous(H, model.as_fast(v, H)) for H in there)
    close(model.times(by_frames, h), (ahead - back) / (2 * STEP), 1e-7)


@every_term
def test_linearised_stress_is_restored(name):
    model = Model(name)
    stress, path = model.term.stress_update, model.term.path
    if stress is None:
        return
    kept = model.term.workspace()
    model.forces(model.H, kept)  # solves for local unknowns, if forces depend on them
    values = stress.linearised_values.copy()
    before = model.term.tangent(model.H, kept).copy()
    if path is not None:  # what friction has waits for accepted states
        path.accept(model.moved(model.H, model.increment(), 0.1))
    else:
        stress.update_stress(model.H, 0.1 * model.increment())
    assert len(values) == 0 or np.abs(stress.linearised_values - values).max() > 0.0
    stress.restore(values)
    assert np.array_equal(stress.linearised_values, values)
    assert np.array_equal(model.term.tangent(model.H, kept), before)
    stress.clear_stress()
    stress.reset_stress(model.H)
    close(model.term.tangent(model.H, kept), before, 1e-12)


@every_term
def test_a_sum_of_terms_is_what_they_are_one_by_one(name):
    """However they are joined; with the sum over joints of what is within that."""
    model = Model(name)
    terms = Terms([model.term, model.term], model.count, moving=True)
    r, v = np.zeros(model.system.size), model.increment()
    terms.add_forces(model.H, r)
    terms.add_viscous_forces(model.H, v, r)
    alone = 2.0 * (model.forces(model.H) + model.viscous(model.H, v))
    if model.term.within_joints:
        alone[:] = 0.0
    np.testing.assert_allclose(
        r[: alone.size], alone.ravel(), rtol=0, atol=1e-13 * np.abs(alone).max(initial=1.0)
    )
    assert terms.energy(model.H) == pytest.approx(2.0 * model.term.energy(model.H), rel=1e-13)


@pytest.mark.parametrize("shape", [(3, 6), (17,)])
def test_forces_do_not_go_beyond_the_array_for_them(shape):
    system = System(beam(), dynamics=True)
    assert system.count == 3
    with pytest.raises(ValueError, match=r"shape \(18,\) or longer, got one of shape"):
        system.terms.add_forces(system.frames, np.zeros(shape))


def test_what_is_within_the_sum_over_joints_is_there():
    """Forces of springs and dampers, as the residual of a scene has them, and their stiffness."""
    model = Model("springs")
    system, v = model.system, model.increment()
    r, rest = np.zeros((2, system.size))
    weights, scale = np.zeros(system.m), np.ones(system.m)
    system.connections.sets[0].evaluate(model.H, v, weights, scale, model.count, r)
    for term in system.terms:
        nodal = rest[: 6 * model.count].reshape(-1, 6)
        term.add_forces(model.H, nodal)
        if term.viscosity is not None:
            term.viscosity.add_viscous_forces(model.H, v, nodal)
    close(r[: 6 * model.count], rest[: 6 * model.count], 1e-13)


@pytest.mark.parametrize(
    "scene",
    [sprung, lambda: pressed(branch()), lambda: pressed(shell(fl.elements.HellingerReissner()))],
    ids=["springs", "pressure on a branch", "pressure on a shell"],
)
@pytest.mark.parametrize("dynamics", [True, False])
def test_matrix_is_that_of_the_forces_it_is_given(scene, dynamics):
    """Whatever residuals were computed in between."""
    system = System(scene(), dynamics=dynamics)
    n, rng = system.count, np.random.default_rng(4)
    first, second = (np.where(system.held, 0.0, 0.1 * rng.normal(size=(n, 6))) for _ in range(2))
    frames, plan = [], fl.extend.Plan(np.zeros((n, 6)), np.ones(system.m), 3.0, 2.0)
    for h in (first, second):
        H = system.frames.copy()
        H[:n] = lie.se3_retract(H[:n], h)
        frames.append(H)
    v, a = (rng.normal(size=(n, 6)) if dynamics else np.zeros((n, 6)) for _ in range(2))
    here, there = (fl.extend.TimeState(H, v, a, rng.normal(size=system.m)) for H in frames)
    forces, r, found = system.workspace(), np.empty(system.size), []
    for others in ([], [there]):
        system.terms.reset_stress(here.H)
        system.residual(here, plan.scale, r, forces)
        for other in others:
            system.residual(other, plan.scale, r, system.workspace())
        system.terms.reset_stress(here.H)
        system.fill_matrix(here, forces, plan)
        found.append(system.kkt.csr[0].copy())
    close(found[1], found[0], 1e-13)


# --- nobody asks which they are ---

import_all()


def all_kinds(of: type[fl.extend.Term] = fl.extend.Term) -> list[type[fl.extend.Term]]:
    return [kind for sub in of.__subclasses__() for kind in (sub, *all_kinds(sub))]


def test_all_terms_of_the_package_are_in_the_list():
    """But for those that are bases of others, or others seen from elsewhere."""
    listed = {type(getattr(model.term, "term", model.term)) for model in map(Model, TERMS)}
    kinds = {kind for kind in all_kinds() if kind.__module__.startswith("fem_lie.")}
    assert {kind for kind in kinds if not kind.__subclasses__()} - {
        AttachedTerm,
        RigidCells,
    } <= listed


@pytest.mark.parametrize("module", ["system.system", "system.tangent", "system.load_cases"])
def test_the_equations_import_no_term_by_name(module):
    where = {kind.__module__.removeprefix("fem_lie.") for kind in all_kinds()}
    assert "system.terms.springs" in where
    assert "elements.beams.pressure" in where
    assert not where & imports_of(module)


@pytest.mark.parametrize("module", ["system.system", "system.tangent", "system.load_cases"])
def test_the_equations_ask_no_term_and_no_load_what_it_is(module):
    tree = ast.parse(MODULES[module].read_text(encoding="utf-8"))
    calls = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
    assert not [f for f in calls if isinstance(f, ast.Name) and f.id in ("isinstance", "type")]


ABILITIES = {
    abilities.ViscousForces: ("add_viscous_forces", "viscous_tangent"),
    abilities.LinearisedStress: (
        "values",
        "update_stress",
        "clear_stress",
        "reset_stress",
        "restore",
    ),
    abilities.ContactState: ("contact_state", "restore_contact"),
    abilities.LocalUnknowns: ("condense",),
    abilities.PathDependence: ("accept",),
    abilities.PassageCheck: ("check_passage", "watch", "watch_again", "watched"),
    abilities.StepForces: ("add_over_step", "keep_gaps", "overlaps", "tangent_over_step"),
    abilities.LowRankTangent: ("stiff_rows",),
    abilities.GroundForces: ("add_of_ground",),
}


@pytest.mark.parametrize(("ability", "methods"), ABILITIES.items())
def test_a_term_that_lacks_what_its_abilities_ask_for_is_refused(ability, methods):
    class Tides(fl.extend.Term):
        pairs = property(lambda self: (np.empty(0, int), np.empty(0, int)))

        def add_forces(self, H, out, kept=None):
            """None."""

        def tangent(self, H, kept):
            """None."""

    class Lacking(Tides, ability):
        """Says that it has the ability, and defines nothing of it."""

    assert not any(getattr(Tides(), name) for name in HAVE)
    with pytest.raises(TypeError) as caught:
        Lacking()
    assert all(method in str(caught.value) for method in ("Lacking", *methods))


HAVE = (
    *("viscosity", "stress_update", "of_contact", "local", "path", "passage", "over_step"),
    *("low_rank", "ground"),
)
"""What a term may have; by default it has none."""


@pytest.mark.parametrize("evaluations", [(1.00105,), (0.99, 1.00105)])
def test_forces_of_a_step_do_not_depend_on_what_was_evaluated_before(evaluations):
    """The tangents of lines follow accepted states, in increments of the stretch."""
    bar = fl.Section.circle(0.01, fl.Material(E=1e9, nu=0.3, density=1e3))
    ends = ((0, 0, 0), (1, 0, 0)), ((0.43, -0.5, 0.03), (0.43, 0.5, 0.03))
    scene = fl.Scene()
    lines = [scene.add(fl.Beam.straight(*each, bar, cells=2)) for each in ends]
    sides = (fl.contact.Line(each, 0.01) for each in lines)
    scene.add(fl.contact.Contact(*sides, fl.contact.Penalty(1e6)))
    equations = fl.EnergyMomentum().equations(scene)
    (term,) = [each for each in equations.arrays.terms if each.over_step is not None]

    def frames(stretch, fall):
        H = equations.start.frames.copy()
        H[: equations.unknowns.moving, 0] *= stretch
        H[:, 0, 2] -= fall * (H[:, 0, 2] > 0.01)
        return H

    def forces(between):
        """After an accepted state without stretch, evaluations, and one that is stretched."""
        contact, out = term.over_step, np.zeros((equations.unknowns.moving, 6))
        for stretch in (1.0, *between, 1.001):
            term.add_forces(frames(stretch, 0.013), np.zeros_like(out))
            if stretch not in between:
                assert not contact.overlaps(frames(stretch, 0.0))
                contact.keep_gaps()
        start, end = frames(1.001, 0.011), frames(1.001, 0.013)
        ends = abilities.Ends(start, end, 0.5 * (start + end), end - start)
        contact.add_over_step(ends, out, np.zeros(6))
        return out

    expected = forces(())
    assert np.abs(expected).max() > 1.0
    np.testing.assert_array_equal(forces(evaluations), expected)
