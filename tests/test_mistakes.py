"""Sixty plausible mistakes: every one has an error that names what was expected, and where."""

import re

import numpy as np
import pytest

import fem_lie as fl

STEEL = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
SECTION = fl.Section.rectangle(0.02, 0.03, STEEL)
LAYER = fl.ShellSection.layer(0.01, STEEL)
BEAM = fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=2, name="arm")
END = BEAM.point("end")
BALL = fl.RigidBody(1.0, (0.1, 0.1, 0.1), name="ball")
MESH = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (2, 2))
SCENE = fl.Scene()
SCENE.add(BEAM)
SCENE.add(fl.Clamp(BEAM.point("start")))
ALPHA = fl.GeneralisedAlpha()


def add(item):
    """Add an item to a scene with the beam and the ball."""
    scene = fl.Scene()
    scene.add(BEAM)
    scene.add(BALL)
    scene.add(item)


def line(*args, **kwargs):
    return fl.Beam.straight((0, 0, 0), (1, 0, 0), *args, **kwargs)


MISTAKES = {
    # names of arguments of other codes
    "elements=": (lambda: line(SECTION, elements=4), "'elements'; expected cells="),
    "n=": (lambda: line(SECTION, n=4), "'n'; expected cells="),
    "young=": (lambda: fl.Material(young=1.0, nu=0.3, density=1.0), "'young'; expected E="),
    "poisson=": (lambda: fl.Material(E=1.0, poisson=0.3, density=1.0), "expected nu="),
    "rho=": (lambda: fl.Material(E=1.0, nu=0.3, rho=1.0), "'rho'; expected density="),
    "diameter=": (lambda: fl.Section.circle(diameter=1, material=STEEL), r"radius= \(half the"),
    "dt=": (lambda: ALPHA.run(SCENE, duration=0.1, dt=0.01), "'dt'; expected step="),
    "h=": (lambda: ALPHA.run(SCENE, duration=0.1, h=0.01), "'h'; expected step="),
    "t_end=": (lambda: ALPHA.run(SCENE, t_end=0.1, step=0.01), "expected duration="),
    "steps by position": (lambda: ALPHA.run(SCENE, 0.1, 0.01), "by name duration=, step="),
    "rho_inf=": (lambda: fl.GeneralisedAlpha(rho_inf=0.8), "'rho_inf'; expected radius="),
    "tol=": (lambda: fl.GeneralisedAlpha(tol=1e-8), "'tol'; expected tolerance="),
    "maxiter=": (lambda: fl.GeneralisedAlpha(maxiter=5), "expected max_iterations="),
    "dt of a scheme": (lambda: fl.Explicit(dt=0.1), "argument step= of run"),
    "radius of a scheme": (lambda: fl.EnergyMomentum(radius=0.5), "it has tolerance, policy"),
    "F=": (lambda: fl.PointLoad(END, F=(0, 0, 1)), "'F'; expected force="),
    "value=": (lambda: fl.PointLoad(END, value=(0, 0, 1)), "expected force="),
    "torque=": (lambda: fl.PointLoad(END, torque=(0, 0, 1)), "expected moment="),
    "follower=": (lambda: fl.PointLoad(END, follower=True), "expected following="),
    "time=": (lambda: fl.PointLoad(END, time=np.sin), "'time'; expected history="),
    "amplitude=": (lambda: fl.PointLoad(END, amplitude=np.sin), "expected history="),
    "g=": (lambda: fl.Scene(g=(0, 0, -9.81)), "'g'; expected gravity="),
    "velocity=": (
        lambda: fl.RigidBody(1.0, (1, 1, 1), velocity=(1, 0, 0)),
        "use its method add_velocity",
    ),
    "thickness=": (lambda: fl.Shell(MESH, thickness=0.1), "'thickness'; expected section="),
    "steps=": (lambda: fl.statics(SCENE, steps=10), "'steps'; expected load_steps="),
    "loads=": (lambda: fl.statics(SCENE, loads=[]), "add loads to the scene"),
    "count as n=": (lambda: fl.vibrations(SCENE, n=3), "'n'; expected count="),
    "mu=": (lambda: fl.contact.Penalty(1e5, mu=0.3), "'mu'; expected friction="),
    "r=": (lambda: fl.contact.Sphere(END, r=0.1), "'r'; expected radius="),
    "k=": (lambda: fl.joints.Spring(1, k=1.0), "'k'; expected stiffness="),
    "angle=": (lambda: fl.joints.Drive(1, angle=np.sin), "'angle'; expected function="),
    "axis of a cylinder": (
        lambda: fl.contact.Cylinder(END, axis=(0, 0, 1)),
        r"expected along= \(the vector from the middle to an end",
    ),
    "alpha=": (lambda: fl.GeneralisedAlpha(alpha=0.1), r"expected radius= \(\(1 - α\)"),
    "beta=": (lambda: fl.GeneralisedAlpha(beta=0.25), r"expected radius= \(β and γ follow"),
    "steps of a path": (
        lambda: fl.follow_path(SCENE, steps=20),
        r"expected resolution= \(one over the number of steps",
    ),
    "times of a picture": (
        lambda: fl.statics(SCENE).picture("tip.png", times=[1.0]),
        "'times'; expected at=",
    ),
    "ratio=": (lambda: fl.sections.Damping(ratio=0.01), "for a ratio ζ at the angular frequency ω"),
    "adaptive=": (
        lambda: ALPHA.run(SCENE, duration=0.1, step=0.01, adaptive=True),
        r"pass step=fl.schemes.AdaptiveStep\(tolerance\)",
    ),
    "initial=": (
        lambda: ALPHA.run(SCENE, duration=0.1, step=0.01, initial=None),
        r"use fl.adaptivity.transfer\(result, its_scene, scene\)",
    ),
    "dofs=": (lambda: fl.Clamp(END, dofs=(0, 1)), r"fl.joints.InPlane\(fl.ground\(\), point"),
    "friction of a hinge": (
        lambda: fl.joints.Revolute(fl.ground(), END, axis=(0, 1, 0), friction=0.1),
        r"to fl.joints.JointFriction\(joint",
    ),
    "material of a layer": (
        lambda: fl.ShellSection(thickness=0.1, material=STEEL),
        r"use fl.ShellSection.layer\(thickness, material\)",
    ),
    "frame of a load": (
        lambda: fl.PointLoad(END, force=(0, 0, 1), frame="local"),
        "following=True takes components along the axes of the point",
    ),
    # wrong kinds of values
    "a force of time": (
        lambda: add(fl.PointLoad(END, force=lambda t: (0, 0, t))),
        "got a function; expected its variation in time as history=",
    ),
    "a pressure on another body": (
        lambda: fl.loads.SurfacePressure(BEAM, 1e3),
        r"on beams: PressureLoad, on solids: FacePressure\), got the Beam 'arm'",
    ),
    "a scalar force": (
        lambda: add(fl.PointLoad(END, force=-10.0)),
        "force of the PointLoad on arm.end must be 3 finite",
    ),
    "a force that is no number": (
        lambda: add(fl.PointLoad(END, force=(0, 0, np.nan))),
        "force of the PointLoad on arm.end must be 3 finite",
    ),
    "a load on a body": (lambda: fl.PointLoad(BEAM, force=(0, 0, 1)), "point such as body.point"),
    "a history that is a list": (
        lambda: fl.PointLoad(END, force=(0, 0, 1), history=[0, 1]),
        "history must be a function of time",
    ),
    "a clamped body": (lambda: fl.Clamp(BEAM), "Clamp: point must be a point such as"),
    "a clamped name": (lambda: fl.Clamp("start"), "Clamp: point must be a point such as"),
    "an unknown point": (lambda: BEAM.point("tip"), "arm has no point 'tip'; it has: end, start"),
    "a point far away": (lambda: BEAM.point((5, 5, 5)), "8.12 away, and the tolerance is"),
    "a node too many": (lambda: BEAM.point(77), "arm has nodes 0 … 2, got 77"),
    "gravity as a number": (lambda: fl.Scene(gravity=9.81), "gravity must be 3 finite numbers"),
    "a list of items": (lambda: fl.Scene().add([BEAM]), "a scene takes bodies, joints"),
    "a class": (lambda: fl.Scene().add(fl.Beam), "a scene takes bodies, joints"),
    "two items": (lambda: fl.Scene().add(BEAM, BALL), "takes item by position"),
    "a load before its body": (
        lambda: fl.Scene().add(fl.PointLoad(END, force=(0, 0, 1))),
        "arm is not in the scene; add it first",
    ),
    "a body twice": (lambda: SCENE.add(BEAM), "arm is in the scene already"),
    "joined bodies": (
        lambda: fl.joints.Revolute(BEAM, BALL, axis=(0, 0, 1)),
        "Revolute: a must be a point such as body.point",
    ),
    "an axis by name": (
        lambda: add(fl.joints.Revolute(END, BALL.point("centre"), axis="z")),
        "axis",
    ),
    "an axis of length 0": (
        lambda: add(fl.joints.Revolute(END, BALL.point("centre"), axis=(0, 0, 0))),
        "axis",
    ),
    "an impossible inertia": (lambda: fl.RigidBody(1.0, (1, 0.1, 0.1)), "none greater than the"),
    "a negative mass": (lambda: fl.RigidBody(-1.0, (1, 1, 1)), "mass must be a positive"),
    "a shell of a file": (lambda: fl.Shell("shell.msh", LAYER), "mesh must be a SurfaceMesh"),
    "a beam's section": (lambda: fl.Shell(MESH, SECTION), "section must be a ShellSection"),
    "swapped arguments": (lambda: fl.ShellSection.layer(STEEL, 0.01), "must be a number"),
    "statics of a body": (lambda: fl.statics(BEAM), "must be a Scene, got the Beam 'arm'"),
    "contact of bodies": (
        lambda: fl.contact.Contact(BEAM, BALL, fl.contact.Penalty(1e5)),
        "Contact: a must be a surface such as Plane or Sphere",
    ),
    "a number for a section": (
        lambda: fl.Cable.straight((0, 0, 0), (1, 0, 0), 1e6, cells=4),
        "Cable: section must be a Section",
    ),
    "steel for a solid": (
        lambda: fl.Solid.brick((1, 1, 1), STEEL, cells=(1, 1, 1)),
        "Solid: material must be a SolidMaterial",
    ),
    "an unknown point of a result": (
        lambda: fl.statics(SCENE).position("arm.tip"),
        "there is no point 'arm.tip'; there are: arm.end, arm.start",
    ),
    "a body instead of a point of a result": (
        lambda: fl.statics(SCENE).position(BEAM),
        r"expected a point of a body, such as body.point\('end'\).*, got the Beam 'arm'",
    ),
    "a position instead of a point of a result": (
        lambda: fl.statics(SCENE).displacement((1, 0.5, 0)),
        r"expected a point of a body.*, got \(1, 0.5, 0\)",
    ),
    "the reaction of a joint": (
        lambda: fl.statics(SCENE).reaction(fl.joints.Fixed(fl.ground(), END, name="weld")),
        r"reaction: expected a Clamp.*, got the Fixed 'weld'; result.joint_force",
    ),
    # wrong numbers
    "a radius above 1": (lambda: fl.GeneralisedAlpha(radius=1.5), r"must be in \[0, 1\], got 1.5"),
    "a step of 0": (lambda: ALPHA.run(SCENE, duration=0.1, step=0.0), "step must be a positive"),
    "a negative duration": (
        lambda: ALPHA.run(SCENE, duration=-0.1, step=0.1),
        "duration must be a positive",
    ),
    "no modes": (lambda: fl.vibrations(SCENE, 0), "count must be at least 1, got 0"),
    "a negative stiffness": (lambda: fl.contact.Penalty(-1.0), "stiffness must be a positive"),
    "a curve by a function": (
        lambda: fl.mesh.SurfaceMesh.from_cells(
            MESH.points, MESH.cells, "quadrilateral", curves={"root": lambda x: x[0] < 1e-9}
        ),
        r"points of curve 'root' must be whole numbers, got a function: .* mesh.named\(",
    ),
    "six relaxation times of a shell": (
        lambda: fl.Shell(MESH, LAYER, damping=fl.sections.Damping(stiffness=range(6))),
        "Shell has one relaxation time for all strains",
    ),
    "a missing file": (
        lambda: fl.mesh.read_gmsh_surface("nothing.msh"),
        "no mesh file 'nothing.msh'",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_named(mistake):
    call, said = MISTAKES[mistake]
    with pytest.raises((TypeError, ValueError, FileNotFoundError)) as caught:
        call()
    assert re.search(said, str(caught.value)), str(caught.value)


def test_there_are_sixty():
    assert len(MISTAKES) >= 60
