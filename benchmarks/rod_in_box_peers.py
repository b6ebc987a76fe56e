"""The rod in a box with balls at its ends, beside Exudyn and MuJoCo: who gains energy, and times.

    tools/run python3 -m benchmarks.rod_in_box_peers

All make the steps of ``demos/rod_in_box.py``, 1e-3 s for 2 s, without restitution. Ours are rigid
impacts; MuJoCo has elliptic cones with its own softness, Exudyn springs and dampers of 1e7 N/m
(critical for the rod) in generalised-α with a spectral radius of 0.5, which divides steps by
itself. Energy is kinetic and that of the rod's weight, without what is in springs: the largest gain
from one millisecond to the next, over the rod's weight (a length), and times are the processor's in
solvers alone, over the steps that it took. Peers come by pip where they can be had.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from time import process_time

import numpy as np

import fem_lie as fl
from benchmarks.peer_scenes import environment

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "demos"))

from demos import rod_in_box as demo

STEP, DURATION, RADIUS, LIMIT = 1e-3, 2.0, 0.1, 240.0

MUJOCO = """
import json, sys, time
import mujoco, numpy as np
g = json.load(sys.stdin)
z = lambda v: " ".join(repr(float(x)) for x in np.ravel(v))
half, t = np.array(g["inner"]) / 2, 0.05
walls = ""
for k in range(3):
    for s in (-1, 1):
        size = half + 2 * t; size[k] = t
        at = np.zeros(3); at[k] = s * (half[k] + t)
        walls += f'<geom type="box" size="{z(size)}" pos="{z(at)}"/>'
inertial = lambda b: f'<inertial pos="0 0 0" mass="{b["mass"]}" diaginertia="{z(b["moments"])}"/>'
quat = np.zeros(4)
mujoco.mju_mat2Quat(quat, np.ravel(g["axes"]))
ends = "".join(f'<geom type="sphere" size="{g["radius"]}" pos="{s*g["length"]/2} 0 0"/>'
               for s in (-1, 1))
xml = (f'<mujoco><option timestep="{g["step"]}" cone="elliptic" gravity="0 0 -{g["gravity"]}"/>'
       f'<default><geom friction="{g["friction"]} 0 0" condim="3"/></default><worldbody>'
       f'<body pos="{z(g["box"]["at"])}" gravcomp="1"><freejoint/>{inertial(g["box"])}{walls}'
       '</body>'
       f'<body pos="{z(g["rod"]["at"])}" quat="{z(quat)}"><freejoint/>{inertial(g["rod"])}{ends}'
       '</body></worldbody></mujoco>')
model = mujoco.MjModel.from_xml_string(xml)
data, seconds, energies, deep = mujoco.MjData(model), 0.0, [], 0.0
def energy():
    m = [g["box"]["mass"], g["rod"]["mass"]]
    J = [np.array(g["box"]["moments"]), np.array(g["rod"]["moments"])]
    v = data.qvel.reshape(2, 6)
    kinetic = sum(0.5 * m[i] * v[i, :3] @ v[i, :3] + 0.5 * v[i, 3:] @ (J[i] * v[i, 3:])
                  for i in (0, 1))
    return kinetic + m[1] * g["gravity"] * data.qpos[9]
energies.append(energy())
for _ in range(g["steps"]):
    before = time.process_time()
    mujoco.mj_step(model, data)
    seconds += time.process_time() - before
    energies.append(energy())
    deep = max(deep, -float(data.contact.dist.min(initial=0.0)))
frame = np.zeros(9); mujoco.mju_quat2Mat(frame, data.qpos[10:14])
end = data.qpos[9] - frame.reshape(3, 3)[2, 0] * g["length"] / 2
print(json.dumps([end, max(np.diff(energies)), deep, seconds, g["steps"]]))
"""

EXUDYN = """
import json, sys, time
sys.exudynFast = True
import exudyn as exu, numpy as np
from exudyn.rigidBodyUtilities import RigidBodyInertia
g = json.load(sys.stdin)
k = 1e7
def run(energies):
    mbs = exu.SystemContainer().AddSystem()
    nodes, markers = [], {}
    for name in ("box", "rod"):
        b = g[name]
        made = mbs.CreateRigidBody(
            inertia=RigidBodyInertia(b["mass"], np.diag(b["moments"])),
            referencePosition=b["at"],
            referenceRotationMatrix=np.array(g["axes"]) if name == "rod" else np.eye(3),
            gravity=[0, 0, -g["gravity"] if name == "rod" else 0.0], returnDict=True)
        nodes.append(made["nodeNumber"])
        markers[name] = made["bodyNumber"]
    contact = mbs.AddGeneralContact()
    contact.verboseMode = 0
    contact.frictionProportionalZone = 1e-3
    contact.SetFrictionPairings(g["friction"] * np.eye(1))
    contact.SetSearchTreeCellSize(numberOfCells=[2, 2, 2])
    d = 2 * np.sqrt(k * g["rod"]["mass"])
    import exudyn.itemInterface as item
    for s in (-1, 1):
        m = mbs.AddMarker(item.MarkerBodyRigid(
            bodyNumber=markers["rod"], localPosition=[s * g["length"] / 2, 0, 0]))
        contact.AddSphereWithMarker(m, radius=g["radius"], contactStiffness=k, contactDamping=d,
                                    frictionMaterialIndex=0)
    half = np.array(g["inner"]) / 2
    points, triangles = [], []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for s in (-1, 1):
            first = len(points)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                p = np.zeros(3); p[axis], p[u], p[v] = s * half[axis], a * half[u], b * half[v]
                points.append(p)
            order = [[0, 1, 2], [0, 2, 3]] if s < 0 else [[0, 2, 1], [0, 3, 2]]
            triangles += [[first + i for i in each] for each in order]
    m = mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=markers["box"], localPosition=[0, 0, 0]))
    contact.AddTrianglesRigidBodyBased(rigidBodyMarkerIndex=m, contactStiffness=k,
        contactDamping=d, frictionMaterialIndex=0, pointList=points, triangleList=triangles)
    V = exu.OutputVariableType
    def energy():
        total = 0.0
        for i, name in enumerate(("box", "rod")):
            u = mbs.GetNodeOutput(nodes[i], V.Velocity)
            w = mbs.GetNodeOutput(nodes[i], V.AngularVelocityLocal)
            total += 0.5 * g[name]["mass"] * u @ u + 0.5 * w @ (np.array(g[name]["moments"]) * w)
        return total + g["rod"]["mass"] * g["gravity"] * mbs.GetNodeOutput(nodes[1], V.Position)[2]
    if energies is not None:
        def note(mbs, t):
            energies.append((t, energy()))
            return True
        mbs.SetPostStepUserFunction(note)
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solutionSettings.writeSolutionToFile = False
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = (
        g["steps"], g["steps"] * g["step"])
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.5
    settings.timeIntegration.newton.useModifiedNewton = True
    solver = exu.MainSolverImplicitSecondOrder()
    solver.InitializeSolver(mbs, settings)
    before = time.process_time()
    good = solver.SolveSteps(mbs, settings)
    seconds = time.process_time() - before
    solver.FinalizeSolver(mbs, settings)
    end = mbs.GetObjectOutputBody(markers["rod"], V.Position, [-g["length"] / 2, 0, 0])
    return float(end[2]), seconds, solver.it.currentStepIndex, good
end, seconds, steps, good = run(None)
energies = []
run(energies)
t, E = np.array(energies).T
at = np.interp(np.arange(g["steps"] + 1) * g["step"], t, E)
print(json.dumps([end, float(np.diff(at).max()), float("nan"), seconds, steps]))
"""


def given(friction: float) -> dict[str, object]:
    """The scene, for peers."""
    scene, rod, _ = demo.rod_in_box("spheres", fl.contact.Impact(friction))
    (box,) = (body for body in scene.bodies if body is not rod)
    assert isinstance(box, fl.RigidBody)

    def body(one: fl.RigidBody, mass: float, moments: np.ndarray) -> dict[str, object]:
        return {"mass": mass, "moments": moments.tolist(), "at": one.frames[0, 0].tolist()}

    outer, inner = (demo.DENSITY * float(sides.prod()) for sides in (demo.OUTER, demo.INNER))
    hollow = demo.box_inertia(outer, demo.OUTER) - demo.box_inertia(inner, demo.INNER)
    edges = np.array([demo.LENGTH, demo.SIDE, demo.SIDE])
    return {
        "rod": body(rod, demo.MASS, demo.box_inertia(demo.MASS, edges)),
        "box": body(box, outer - inner, hollow),
        "axes": rod.frames[0, 1:].T.tolist(),
        "inner": demo.INNER.tolist(),
        "length": demo.LENGTH,
        "radius": RADIUS,
        "friction": friction,
        "gravity": demo.GRAVITY,
        "step": STEP,
        "steps": round(DURATION / STEP),
    }


def ours(friction: float) -> list[float]:
    """Height of the first end, largest gain, overlap, seconds and steps."""
    scene, rod, _ = demo.rod_in_box("spheres", fl.contact.Impact(friction))
    scheme, first = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-10), rod.point(demo.FIRST)
    scheme.run(scene, duration=STEP, step=STEP, progress=False)
    before = process_time()
    result = scheme.run(scene, duration=DURATION, step=STEP, progress=False)
    seconds, reported = process_time() - before, result.contacts
    assert reported is not None
    gain, steps = float(np.diff(result.total_energy).max()), len(result.times) - 1
    end = float(result.position(first)[-1, 2])
    return [end, gain, float(reported.penetration.max()), seconds, steps]


def peer(inside: Path, script: str, friction: float) -> list[float] | str:
    """Likewise of a peer, or why not."""
    try:
        done = subprocess.run(
            [inside, "-c", script],
            input=json.dumps(given(friction)),
            capture_output=True,
            text=True,
            timeout=LIMIT,
            check=True,
        )
    except subprocess.TimeoutExpired:
        return f"no answer in {LIMIT:.0f} s"
    except subprocess.CalledProcessError as error:
        return f"failed: {(error.stderr or error.stdout).strip().splitlines()[-1]}"
    return [float(each) for each in json.loads(done.stdout.splitlines()[-1])]


def row(name: str, friction: float, found: list[float] | str) -> str:
    """A line of the table."""
    if isinstance(found, str):
        return f"{friction:4} {name:8} {found}"
    end, gain, deep, seconds, steps = found
    return (
        f"{friction:4} {name:8} {end:9.5f} {gain / demo.MASS / demo.GRAVITY:10.1e} {deep:9.1e} "
        f"{steps:7.0f} {1e6 * seconds / steps:8.1f} {1e3 * seconds:8.1f}"
    )


def main() -> None:
    """Print a table."""
    peers = environment.interpreters("exudyn", "mujoco")
    scripts = {"mujoco": MUJOCO, "exudyn": EXUDYN}
    print("   μ code     first end  gain, m   overlap   steps  µs/step  ms in all")
    for friction in (0.0, 0.2, 0.4, 0.6):
        print(row("fem_lie", friction, ours(friction)), flush=True)
        for name, inside in sorted(peers.items()):
            print(row(name, friction, peer(inside, scripts[name], friction)), flush=True)


if __name__ == "__main__":
    main()
