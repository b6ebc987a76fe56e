"""Answers requests with runs of Pinocchio or MuJoCo; imports nothing but what their pythons have.

A request is a line of JSON: a description of rigid bodies (``descriptions``, ``contacts``),
``code``, ``step``, ``duration`` and a ``way``. The answer is another one: where the probe ends,
seconds of the processor in the steps, number of steps, unknowns and settings.

Bodies follow each other such that each comes after the one that it hangs on.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import numpy as np

Record = dict[str, Any]
UPPER = (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)


def anchors(request: Record) -> list[tuple[int | None, Any]]:
    """Of each body the one that it hangs on, and the position of the joint; None: it is free."""
    found: list[tuple[int | None, Any]] = [(None, None)] * len(request["bodies"])
    for joint in request["joints"]:
        before, body = joint["bodies"]
        found[body] = before, np.array(joint["at"])
    return found


def tensor(body: Record) -> Any:
    """Inertia about the centre, from three moments or as it is given, shape (3, 3)."""
    given = np.array(body["inertia"])
    return np.diag(given) if given.ndim == 1 else given


def answered(request: Record, probe: Any, seconds: float, unknowns: int, settings: str) -> Record:
    """The answer."""
    steps = round(request["duration"] / request["step"])
    counts = {"steps": steps, "iterations": 0, "matrices": 0, "unknowns": unknowns}
    return {"place": np.asarray(probe).tolist(), "seconds": seconds, "settings": settings} | counts


# --- Pinocchio ------------------------------------------------------------------------------------


def pinocchio(request: Record) -> Record:
    """Articulated-body algorithm, and the classical Runge-Kutta steps in the joint coordinates."""
    import pinocchio as pin

    model, bodies = pin.Model(), request["bodies"]
    model.gravity.linear = np.array(request["gravity"])
    joints, origins = [], []
    for k, (body, (before, at)) in enumerate(zip(bodies, anchors(request), strict=True)):
        centre = np.array(body["centre"])
        kind = pin.JointModelFreeFlyer() if at is None else pin.JointModelSpherical()
        parent, base = (0, np.zeros(3)) if before is None else (joints[before], origins[before])
        origin = centre if at is None else at
        joints.append(model.addJoint(parent, kind, pin.SE3(np.eye(3), origin - base), f"joint{k}"))
        origins.append(origin)
        inertia = pin.Inertia(body["mass"], centre - origin, tensor(body))
        model.appendBodyToJoint(joints[-1], inertia, pin.SE3.Identity())
    data, q, v = model.createData(), pin.neutral(model), np.zeros(model.nv)
    for joint, body, (_, at) in zip(joints, bodies, anchors(request), strict=True):
        if at is None:
            first = model.idx_vs[joint]
            v[first : first + 6] = np.concatenate([body["velocity"], body["spin"]])
    h, began = request["step"], time.process_time()
    aba, integrate = pin.aba, pin.integrate
    zero = np.zeros(model.nv)
    for _ in range(round(request["duration"] / h)):
        a1 = aba(model, data, q, v, zero).copy()
        v2 = v + 0.5 * h * a1
        a2 = aba(model, data, integrate(model, q, 0.5 * h * v), v2, zero).copy()
        v3 = v + 0.5 * h * a2
        a3 = aba(model, data, integrate(model, q, 0.5 * h * v2), v3, zero).copy()
        v4 = v + h * a3
        a4 = aba(model, data, integrate(model, q, h * v3), v4, zero)
        q = integrate(model, q, (h / 6.0) * (v + 2.0 * (v2 + v3) + v4))
        v = v + (h / 6.0) * (a1 + 2.0 * (a2 + a3) + a4)
    seconds = time.process_time() - began
    pin.forwardKinematics(model, data, q)
    probe = request["probe"]
    arm = np.array(probe["at"]) - origins[probe["body"]]
    end = data.oMi[joints[probe["body"]]].act(arm)
    return answered(request, end, seconds, model.nv, "defaults")


# --- MuJoCo ---------------------------------------------------------------------------------------

STIFF = 'solref="{twice} 1" solimp="0.99 0.999 1e-4"'
LAWS = {
    "stiff contact": STIFF,
    "default contact": "",
    "spring and damper": 'solref="-{square} -{rate}" solimp="0.999 0.999 1e-4"',
}
"""Softness of contacts by way; ``square`` and ``rate`` are per unit of mass."""
WALL = 5.0  # half width and half thickness of a wall that moves: planes cannot


def mujoco(request: Record) -> Record:
    """RK4 without contact, else the default integrator with elliptic cones."""
    import mujoco as mj

    model = mj.MjModel.from_xml_string(text_of(request))
    data = mj.MjData(model)
    for k, (body, (_, at)) in enumerate(zip(request["bodies"], anchors(request), strict=True), 1):
        if at is None:
            first = model.body_dofadr[k]
            data.qvel[first : first + 6] = np.concatenate([body["velocity"], body["spin"]])
        data.xfrc_applied[k, :3] = body.get("force", np.zeros(3))
    steps = round(request["duration"] / request["step"])
    began = time.process_time()
    mj.mj_step(model, data, nstep=steps)
    seconds = time.process_time() - began
    mj.mj_kinematics(model, data)
    probe = request["probe"]
    arm = np.array(probe["at"]) - request["bodies"][probe["body"]]["centre"]
    k = probe["body"] + 1
    end = data.xipos[k] + data.xmat[k].reshape(3, 3) @ arm
    return answered(request, end, seconds, model.nv, "defaults")


def text_of(request: Record) -> str:
    """The model; bodies are named by their order."""
    held = anchors(request)
    children: list[list[int]] = [[] for _ in held]
    for k, (before, at) in enumerate(held):
        if at is not None and before is not None:
            children[before].append(k)

    def body_of(k: int, base: Any) -> str:
        body, (_, at) = request["bodies"][k], held[k]
        centre = np.array(body["centre"])
        origin = centre if at is None else at
        kind = "free" if at is None else "ball"
        inside = "".join(body_of(child, origin) for child in children[k])
        return (
            f'<body pos="{_text(origin - base)}">'
            f'<joint type="{kind}" armature="0" damping="0"/>'
            f'<inertial pos="{_text(centre - origin)}" mass="{body["mass"]!r}" '
            f'fullinertia="{_text(tensor(body)[UPPER])}"/>{surfaces(request, k, origin)}{inside}'
            "</body>"
        )

    roots = [k for k, (before, at) in enumerate(held) if at is None or before is None]
    parts = [body_of(k, np.zeros(3)) for k in roots]
    ways = {"integrator": "RK4"} if request["way"] == "RK4" else {"cone": "elliptic"}
    option = " ".join(f'{name}="{value}"' for name, value in ways.items())
    return (
        f'<mujoco><option {option} timestep="{request["step"]!r}" '
        f'gravity="{_text(request["gravity"])}"/>{defaults(request)}'
        f"<worldbody>{surfaces(request, None, np.zeros(3))}{''.join(parts)}</worldbody></mujoco>"
    )


def defaults(request: Record) -> str:
    """Friction and softness of all contacts."""
    if "balls" not in request:
        return ""
    law = LAWS[request["way"]].format(
        twice=2 * request["step"],
        square=request["frequency"] ** 2,
        rate=2 * request["damping_ratio"] * request["frequency"],
    )
    return f'<default><geom friction="{request["friction"]} 0 0" condim="3" {law}/></default>'


def surfaces(request: Record, body: int | None, origin: Any) -> str:
    """Balls and walls of a body or of ground; walls do not touch each other."""
    made, touched = [], 3 if "touch" in request else 2
    for ball in request.get("balls", []):
        if ball["body"] == body:
            at = np.array(ball["at"]) - origin
            made.append(
                f'<geom type="sphere" size="{ball["radius"]!r}" pos="{_text(at)}" '
                f'contype="1" conaffinity="{touched}"/>'
            )
    for wall in request.get("walls", []):
        if wall["body"] == body:
            at, normal = np.array(wall["at"]) - origin, np.array(wall["normal"])
            kind = 'type="plane" size="0 0 1"'
            if body is not None:
                kind, at = f'type="box" size="{WALL} {WALL} {WALL}"', at - WALL * normal
            made.append(
                f'<geom {kind} pos="{_text(at)}" zaxis="{_text(normal)}" '
                'contype="2" conaffinity="1"/>'
            )
    return "".join(made)


def _text(vector: Any) -> str:
    return " ".join(repr(float(x)) for x in vector)


def main() -> None:
    """Answer until the input ends."""
    answers = {"pinocchio": pinocchio, "mujoco": mujoco}
    print(json.dumps({"ready": "rigid bodies"}), flush=True)
    for text in sys.stdin:
        request = json.loads(text)
        print(json.dumps(answers[request["code"]](request)), flush=True)


if __name__ == "__main__":
    main()
