"""Answers requests with runs of Pinocchio or MuJoCo; imports nothing but what their pythons have.

A request is a line of JSON: ``code`` (pinocchio or mujoco), ``bodies`` (mass, moments of inertia
about the centre, position of the centre, spin), ``anchors`` of ball joints to the body before
(none: the body is free), ``gravity``, ``probe`` (a point of the last body at the start), ``step``
and ``steps``. The answer is another one: where the probe ends, and seconds of the processor in the
steps alone.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import numpy as np

Record = dict[str, Any]


def pinocchio(request: Record) -> Record:
    """Articulated-body algorithm, and the classical Runge-Kutta steps in the joint coordinates."""
    import pinocchio as pin

    model, parent, base = pin.Model(), 0, np.zeros(3)
    model.gravity.linear = np.array(request["gravity"])
    bodies, anchors = request["bodies"], request["anchors"] or [None]
    for k, (body, anchor) in enumerate(zip(bodies, anchors, strict=True)):
        centre = np.array(body["centre"])
        at = centre if anchor is None else np.array(anchor)
        joint = pin.JointModelFreeFlyer() if anchor is None else pin.JointModelSpherical()
        parent = model.addJoint(parent, joint, pin.SE3(np.eye(3), at - base), f"joint{k}")
        inertia = pin.Inertia(body["mass"], centre - at, np.diag(body["inertia"]))
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
        base = at
    data, q, v = model.createData(), pin.neutral(model), np.zeros(model.nv)
    if anchors[0] is None:
        v[3:6] = bodies[0]["spin"]
    probe = np.array(request["probe"]) - base
    h, began = request["step"], time.process_time()
    aba, integrate = pin.aba, pin.integrate
    zero = np.zeros(model.nv)
    for _ in range(request["steps"]):
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
    return {"position": data.oMi[parent].act(probe).tolist(), "seconds": seconds}


def mujoco(request: Record) -> Record:
    """MuJoCo's RK4, without contact."""
    import mujoco as mj

    bodies, anchors = request["bodies"], request["anchors"] or [None]
    parts, base = [], np.zeros(3)
    for body, anchor in zip(bodies, anchors, strict=True):
        centre = np.array(body["centre"])
        at = centre if anchor is None else np.array(anchor)
        kind = "free" if anchor is None else "ball"
        offset, inner = at - base, centre - at
        moments = " ".join(map(repr, body["inertia"]))
        parts.append(
            f'<body pos="{_text(offset)}"><joint type="{kind}" armature="0" damping="0"/>'
            f'<inertial pos="{_text(inner)}" mass="{body["mass"]!r}" diaginertia="{moments}"/>'
        )
        base = at
    option = (
        f'<option integrator="RK4" timestep="{request["step"]!r}" '
        f'gravity="{_text(request["gravity"])}"><flag contact="disable"/></option>'
    )
    text = (
        f"<mujoco>{option}<worldbody>{''.join(parts)}{'</body>' * len(parts)}</worldbody></mujoco>"
    )
    model = mj.MjModel.from_xml_string(text)
    data = mj.MjData(model)
    if anchors[0] is None:
        data.qvel[3:6] = bodies[0]["spin"]
    probe, steps = np.array(request["probe"]) - base, request["steps"]
    began = time.process_time()
    mj.mj_step(model, data, nstep=steps)
    seconds = time.process_time() - began
    mj.mj_kinematics(model, data)
    R = data.xmat[-1].reshape(3, 3)
    return {"position": (data.xpos[-1] + R @ probe).tolist(), "seconds": seconds}


def _text(vector: Any) -> str:
    return " ".join(repr(float(x)) for x in vector)


def main() -> None:
    """Answer until the input ends."""
    answers = {"pinocchio": pinocchio, "mujoco": mujoco}
    print(json.dumps({"ready": "trees"}), flush=True)
    for text in sys.stdin:
        request = json.loads(text)
        print(json.dumps(answers[request["code"]](request)), flush=True)


if __name__ == "__main__":
    main()
