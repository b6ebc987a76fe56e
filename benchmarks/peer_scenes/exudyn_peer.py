"""Answers requests with runs of Exudyn; imports nothing but what its own environment has.

A request is a line of JSON: a description (``descriptions``), ``step`` and ``duration`` or
``load_steps``, and a ``way``. The answer is another one: where the probe ends, seconds of the
processor in the solver alone, steps, iterations, Jacobians, unknowns, and the settings that it
arrived with.

Settings follow the chapter on performance of Exudyn's documentation: the module without range
checks, sparse matrices with a kept pattern, nothing written to files. Where its default tolerances
do not let Newton's method arrive, others follow: that of Exudyn's own test of these beams, then
convergence measured by increments, which the documentation recommends then, and last smaller steps
where it does not converge.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from itertools import combinations, pairwise
from typing import Any

# must be said before the import
sys.exudynFast = True  # type: ignore[attr-defined]
import exudyn as exu  # noqa: E402
import exudyn.itemInterface as item  # noqa: E402
import numpy as np  # noqa: E402
from exudyn import shells  # noqa: E402
from exudyn.rigidBodyUtilities import (  # noqa: E402
    AngularVelocity2EulerParameters_t,
    RotationMatrix2EulerParameters,
)

Record = dict[str, Any]
Probe = Callable[[], Any]
ATTEMPTS: dict[str, Record] = {
    "defaults": {},
    "relative tolerance 1e-6": {"relativeTolerance": 1e-6},
    "increments": {"residualMode": 1},
    "relative tolerance 1e-6, steps cut": {"relativeTolerance": 1e-6},
}
MINIMAL, EXPLICIT = "minimal coordinates, explicit", "explicit"
WIDE = 100.0  # half width of a wall, m
SHORTEST = 1e-13  # step at an impact, s; with the default of 1e-8 s the rod in a box stops
POSITION = exu.OutputVariableType.Position
arrived: dict[str, str] = {}  # what has let a scene arrive, so that repetitions do not try again


def main() -> None:
    """Answer until the input ends."""
    print(json.dumps({"ready": f"Exudyn {exu.config.Version()}"}), flush=True)
    for text in sys.stdin:
        print(json.dumps(answer(json.loads(text))), flush=True)


def answer(request: Record) -> Record:
    """The first run that arrives, with the settings that it took."""
    key = json.dumps(request)
    names = [arrived[key]] if key in arrived else list(ATTEMPTS)
    for name in names:
        mbs = exu.SystemContainer().AddSystem()
        position = build(mbs, request)
        mbs.Assemble()
        solver, settings = prepared(request, name)
        solver.InitializeSolver(mbs, settings)
        start = time.process_time()
        good = solver.SolveSteps(mbs, settings)
        seconds = time.process_time() - start
        solver.FinalizeSolver(mbs, settings)
        if good:
            arrived[key] = name
            counts = solver.it
            return {
                "place": np.asarray(position()).tolist(),
                "seconds": seconds,
                "steps": counts.currentStepIndex - 1,
                "iterations": counts.newtonStepsCount,
                "matrices": counts.newtonJacobiCount,
                "unknowns": mbs.systemData.ODE2Size() + mbs.systemData.AEsize(),
                "settings": name,
            }
    return {"failed": f"does not converge, with {', '.join(names)}"}


def prepared(request: Record, attempt: str) -> tuple[Any, Any]:
    """A solver for the request, and its settings."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.active = False
    settings.parallel.numberOfThreads = 1
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.linearSolver.reuseAnalyzedPattern = True
    if "load_steps" in request:
        static = settings.staticSolver
        static.verboseMode = 0
        static.numberOfLoadSteps = request["load_steps"]
        solver, options = exu.MainSolverStatic(), static.newton
    else:
        motion = settings.timeIntegration
        motion.verboseMode = 0
        motion.endTime = request["duration"]
        motion.numberOfSteps = round(request["duration"] / request["step"])
        motion.adaptiveStep = attempt.endswith("steps cut")
        if "balls" in request:
            motion.minimumStepSize = SHORTEST
        motion.generalizedAlpha.spectralRadius = request["radius"]
        options = motion.newton
        options.useModifiedNewton = request["way"] != "full Newton"
        solver = exu.MainSolverImplicitSecondOrder()
        if request["way"] in (EXPLICIT, MINIMAL):
            motion.solverType = exu.DynamicSolverType.RK44
            solver = exu.MainSolverExplicit()
    for name, value in ATTEMPTS[attempt].items():
        setattr(options, name, value)
    return solver, settings


def build(mbs: Any, request: Record) -> Probe:
    """Add the description to an empty system; returns where its probe is, when asked."""
    if "beams" in request:
        return beams(mbs, request)
    return bodies(mbs, request) if "bodies" in request else hemisphere(mbs, request)


# --- beams ----------------------------------------------------------------------------------------


def beams(mbs: Any, request: Record) -> Probe:
    """Geometrically exact beams between nodes of Euler parameters.

    With nodes of rotation vectors, of six unknowns, Newton's method does not arrive.
    """
    lines = [beam(mbs, line) for line in request["beams"]]
    for joint in request.get("joints", []):
        positions = [None if at is None else lines[at[0]][at[1]] for at in joint["nodes"]]
        if "axis" in joint:
            frames = [np.array(request["beams"][i]["frames"][k]) for i, k in joint["nodes"]]
            hinge(mbs, positions, frames, joint["axis"])
        else:
            ends = [
                node_or_ground(mbs, position, item.MarkerNodePosition) for position in positions
            ]
            mbs.AddObject(item.SphericalJoint(markerNumbers=ends))
    line, node = request["probe"]
    tip = lines[line][node]
    if "clamp" in request:
        line, node = request["clamp"]
        ends = [node_or_ground(mbs, n, item.MarkerNodeRigid) for n in (None, lines[line][node])]
        mbs.AddObject(item.GenericJoint(markerNumbers=ends))
        end = mbs.AddMarker(item.MarkerNodeRigid(nodeNumber=tip))
        mbs.AddLoad(item.Force(markerNumber=end, loadVector=request["force"]))
        mbs.AddLoad(item.Torque(markerNumber=end, loadVector=request["moment"]))
    return lambda: mbs.GetNodeOutput(tip, POSITION)


def beam(mbs: Any, line: Record) -> list[Any]:
    """Its node numbers."""
    section = exu.BeamSection()
    section.stiffnessMatrix = np.diag(line["stiffness"])
    section.massPerLength = line["mass"]
    section.inertia = np.diag(line["inertia"])
    nodes = []
    for position, frame, velocity in zip(
        line["places"], line["frames"], line["velocities"], strict=True
    ):
        turned = RotationMatrix2EulerParameters(np.array(frame))
        rate = AngularVelocity2EulerParameters_t(np.array(line["spin"]), turned)
        node = item.NodeRigidBodyEP(
            referenceCoordinates=[*position, *turned], initialVelocities=[*velocity, *rate]
        )
        nodes.append(mbs.AddNode(node))
    for ends in pairwise(nodes):
        element = item.ObjectBeamGeometricallyExact(
            nodeNumbers=list(ends), length=line["element_length"], sectionData=section
        )
        mbs.AddObject(element)
    return nodes


def node_or_ground(mbs: Any, node: Any, marker: Callable[..., Any]) -> Any:
    """A marker of a node, or of one that stays at the origin."""
    if node is None:
        node = mbs.AddNode(item.NodePointGround(referenceCoordinates=[0, 0, 0]))
    return mbs.AddMarker(marker(nodeNumber=node))


def hinge(mbs: Any, nodes: list[Any], frames: list[Any], axis: list[float]) -> None:
    """A joint that turns about an axis in space, which is the first one of its own frame."""
    first = np.array(axis)
    second = np.cross(first, np.eye(3)[np.argmin(np.abs(first))])
    own = np.column_stack([first, second, np.cross(first, second)])
    markers = []
    for node, frame in zip(nodes, frames, strict=True):
        local = np.eye(4)
        local[:3, :3] = frame.T @ own
        markers.append(mbs.AddMarker(item.MarkerNodeRigid(nodeNumber=node, localHT=local)))
    free = item.GenericJoint(markerNumbers=markers, constrainedAxes=[1, 1, 1, 0, 1, 1])
    mbs.AddObject(free)


# --- rigid bodies ---------------------------------------------------------------------------------


def bodies(mbs: Any, request: Record) -> Probe:
    """Rigid bodies on nodes of a Lie group, whose mass is constant, joints and contacts."""
    if request["way"] == MINIMAL:
        return kinematic_tree(mbs, request)
    made = [body(mbs, given, request["gravity"]) for given in request["bodies"]]
    for joint in request["joints"]:
        ends = [
            point(mbs, ground(mbs) if k is None else made[k], local(request, k, joint["at"]))
            for k in joint["bodies"]
        ]
        mbs.AddObject(item.SphericalJoint(markerNumbers=ends))
    contacts(mbs, request, made)
    probe = request["probe"]
    arm = local(request, probe["body"], probe["at"])
    return lambda: mbs.GetObjectOutputBody(made[probe["body"]], POSITION, arm)


def body(mbs: Any, given: Record, gravity: list[float]) -> Any:
    """Its number."""
    node = item.NodeRigidBodyRotVecLG(
        referenceCoordinates=[*given["centre"], 0, 0, 0],
        initialVelocities=[*given["velocity"], *given["spin"]],
    )
    J = np.array(given["inertia"])
    J = np.diag(J) if J.ndim == 1 else J
    rigid = item.ObjectRigidBody(
        mass=given["mass"],
        inertia=[*np.diag(J), J[1, 2], J[0, 2], J[0, 1]],
        nodeNumber=mbs.AddNode(node),
    )
    number = mbs.AddObject(rigid)
    whole = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=number))
    mbs.AddLoad(item.LoadMassProportional(markerNumber=whole, loadVector=gravity))
    if "force" in given:
        centre = point(mbs, number, [0.0, 0.0, 0.0])
        mbs.AddLoad(item.Force(markerNumber=centre, loadVector=given["force"]))
    return number


def contacts(mbs: Any, request: Record, made: list[Any]) -> None:
    """Balls and walls, which are triangles that are larger than the scene.

    Friction is proportional to speeds below 1 m/s² times the step: its default with 1e-3 s. The
    forces of ``GeneralContact`` do not rebound with such dampers, so that each pair is a connector.
    """
    balls = request.get("balls", [])
    if not balls:
        return
    owners = [ball["body"] for ball in balls]
    mass = request["bodies"][owners[0]]["mass"] / owners.count(owners[0])
    law = {
        "dynamicFriction": request["friction"],
        "frictionProportionalZone": request["step"],
        "contactStiffness": mass * request["frequency"] ** 2,
        "contactDamping": 2 * request["pulling_damping_ratio"] * mass * request["frequency"],
    }

    def state() -> Any:
        values = {"numberOfDataCoordinates": 4, "initialCoordinates": [0.0] * 4}
        return mbs.AddNode(item.NodeGenericData(**values))

    centres = [
        rigid_marker(mbs, made[ball["body"]], local(request, ball["body"], ball["at"]))
        for ball in balls
    ]
    for wall in request["walls"]:
        k = wall["body"]
        corners = exu.Vector3DList(triangle(local(request, k, wall["at"]), wall["normal"]))
        face = rigid_marker(mbs, ground(mbs) if k is None else made[k], [0.0, 0.0, 0.0])
        for ball, centre in zip(balls, centres, strict=True):
            connector = item.ObjectContactSphereTriangle(
                markerNumbers=[centre, face],
                nodeNumber=state(),
                sphereRadius=ball["radius"],
                trianglePoints=corners,
                includeEdges=0,
                **law,
            )
            mbs.AddObject(connector)
    for one, other in combinations(range(len(balls)), 2) if "touch" in request else ():
        connector = item.ObjectContactSphereSphere(
            markerNumbers=[centres[one], centres[other]],
            nodeNumber=state(),
            spheresRadii=[balls[one]["radius"], balls[other]["radius"]],
            **law,
        )
        mbs.AddObject(connector)


def triangle(at: Any, normal: Any) -> list[Any]:
    """Corners of a large triangle about a position, counterclockwise about its normal."""
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    second = np.cross(normal, first)
    return [at + WIDE * (a * first + b * second) for a, b in ((-1, -1), (1, -1), (0, 1))]


def rigid_marker(mbs: Any, body: Any, position: list[float]) -> Any:
    """A marker with axes at a position of a body."""
    return mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=body, localPosition=position))


def kinematic_tree(mbs: Any, request: Record) -> Probe:
    """A chain in minimal coordinates: three hinges for a spherical joint, about y first.

    That motion is about y alone, far from where the axes of the first and the last are parallel.
    """
    given, joints, J = request["bodies"], request["joints"], exu.JointType
    n, none = 3 * len(given), np.zeros(3)
    origins = np.array([joint["at"] for joint in joints])
    steps = np.diff(origins, axis=0, prepend=np.zeros((1, 3)))
    centres = np.array([body["centre"] for body in given])
    node = mbs.AddNode(
        item.NodeGenericODE2(
            referenceCoordinates=[0.0] * n,
            initialCoordinates=[0.0] * n,
            initialCoordinates_t=[0.0] * n,
            numberOfODE2Coordinates=n,
        )
    )
    tree = item.ObjectKinematicTree(
        nodeNumber=node,
        gravity=request["gravity"],
        jointTypes=[J.RevoluteY, J.RevoluteZ, J.RevoluteX] * len(given),
        linkParents=list(np.arange(n) - 1),
        jointTransformations=exu.Matrix3DList([np.eye(3)] * n),
        jointOffsets=exu.Vector3DList([x for step in steps for x in (step, none, none)]),
        linkInertiasCOM=exu.Matrix3DList(
            [M for body in given for M in (np.zeros((3, 3)),) * 2 + (np.diag(body["inertia"]),)]
        ),
        linkCOMs=exu.Vector3DList([x for arm in centres - origins for x in (none, none, arm)]),
        linkMasses=[m for body in given for m in (0.0, 0.0, body["mass"])],
    )
    number = mbs.AddObject(tree)
    arm = np.array(request["probe"]["at"]) - origins[-1]
    marker = item.MarkerKinematicTreeRigid(
        objectNumber=number, linkNumber=n - 1, localPosition=arm.tolist()
    )
    end = mbs.AddMarker(marker)
    return lambda: mbs.GetMarkerOutput(end, POSITION)


def point(mbs: Any, body: Any, position: list[float]) -> Any:
    """A marker at a place of a body."""
    return mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=body, localPosition=position))


def ground(mbs: Any) -> Any:
    """The number of a body that stays."""
    return mbs.AddObject(item.ObjectGround())


def local(request: Record, index: int | None, position: list[float]) -> Any:
    """A position from the centre of a body, whose axes are those of space."""
    centre = [0.0, 0.0, 0.0] if index is None else request["bodies"][index]["centre"]
    return (np.array(position) - centre).tolist()


# --- shells ---------------------------------------------------------------------------------------


def hemisphere(mbs: Any, request: Record) -> Probe:
    """Thin plates with 4 × 9 unknowns, by Exudyn's own mesh of a hemisphere with a hole."""
    n, radius = request["side"], request["radius"]
    mesh = shells.ShellMesh(
        vertices=[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
        numberOfElementsX=n,
        numberOfElementsY=n,
        youngsModulus=request["young"],
        poissonsRatio=request["poisson"],
        density=1.0,
        thickness=request["thickness"],
        surfaceMap=shells.SurfaceMap.HemisphericalShell(
            1, 1, radius, request["hole"], thetaRange=np.pi / 2
        ),
    )
    # Lobatto points against membrane locking, as its documentation says
    mesh.CreateANCFThinPlateElements(mbs, useReducedOrderIntegration=1)
    edges = mesh.boundaryNodeNumbers
    # coordinates 0-2 are the position, 3-5 the slope along, 6-8 the slope down
    for node in edges["left"]:
        shells.AddNodeConstraints(mbs, node, [1, 3, 5, 7])
    for node in edges["right"]:
        shells.AddNodeConstraints(mbs, node, [0, 4, 5, 6])
    ends = edges["top"][0], edges["top"][-1]
    shells.AddNodeConstraints(mbs, ends[0], [2])
    for node, (_, force) in zip(ends, request["loads"], strict=True):
        marker = mbs.AddMarker(item.MarkerNodePosition(nodeNumber=node))
        mbs.AddLoad(item.Force(markerNumber=marker, loadVector=force))
    return lambda: [
        mbs.GetNodeOutput(ends[0], POSITION)[0] - radius,
        radius - mbs.GetNodeOutput(ends[1], POSITION)[1],
    ]


if __name__ == "__main__":
    main()
