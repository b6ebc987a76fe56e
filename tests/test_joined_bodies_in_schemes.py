"""Bodies of different kinds that are joined, under every scheme: laws and orders.

A beam or a discrete rod fixed to a shell, a cable on a solid, a cable on a joint that slides along
a beam, knife edges and discs under bodies of several kinds, a beam held between its nodes beside a
cable. All move and rotate at the start, and no global axis is that of anything.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import fem_lie as fl
from tests.combinations import BODIES, END, GRAVITY, joined, moving
from tests.scene_builder import build
from tests.scene_data import JointData, PointRef, RigidData, SceneData, SlidingData
from tests.test_contact_matrix import meeting

CONSERVING: dict[str, fl.EnergyMomentum] = {
    "conserving": fl.EnergyMomentum(),
    "decaying": fl.EnergyDecaying(),
}
SCHEMES: dict[str, Any] = {
    **CONSERVING,
    "variational": fl.schemes.Variational(),
    "explicit": fl.Explicit(),
}
SPIN, MIDDLE = np.array([0.0, 2.0, 1.0]), np.array([0.4, 0.0, 0.0])
DURATION, STEPS = 4e-4, 20
AXIS = np.array([0.48, 0.6, 0.64])


def line(kind: str, name: str, start: np.ndarray, end: np.ndarray) -> Any:
    return replace(BODIES[kind], name=name, start=start, end=end, bow=np.zeros(3))


def on_body(kind: str, line_kind: str, joint: str) -> SceneData:
    """A body and a line on a joint at its end."""
    own = {} if joint in ("Fixed", "Spherical") else {"axis": AXIS}
    corner = "a=1" if "solid" in kind else "end" if "beam" in kind else "10"
    other = line(line_kind, "other", END, END + np.array([0.5, 0.0, 0.3]))
    tie = JointData("joint", joint, PointRef("body", corner), PointRef("other", "start"), **own)
    return moving(BODIES[kind], other, joints=(replace(tie, at=END),), spin=SPIN)


def rope_on_slide(joint: str) -> SceneData:
    """A rigid body that slides along a beam, and a cable that hangs on it."""
    centre = PointRef("other", "centre")
    slide = SlidingData("joint", joint, "body", centre, MIDDLE)
    tie = JointData("tie", "Spherical", centre, PointRef("rope", "start"), at=MIDDLE)
    return moving(
        line("beam, geodesic", "body", np.zeros(3), END),
        RigidData("other", 1.5, np.array([0.02, 0.05, 0.06]), MIDDLE, np.eye(3)),
        line("Hermite cable", "rope", MIDDLE, MIDDLE - np.array([0.0, 0.0, 0.5])),
        joints=(slide, tie),
        spin=SPIN,
        gravity=GRAVITY,
    )


ON_BODIES = {
    f"{other} on {body}, {joint}": (body, other, joint)
    for body in ("shell, Hellinger-Reissner", "shell, Hu-Washizu", "shell, triangles")
    for other, joint in (
        ("beam, geodesic", "Fixed"),
        ("beam, director 2", "Revolute"),
        ("discrete rod", "Fixed"),
    )
}
ON_BODIES |= {
    "cable on a solid": ("solid, hexahedra 1", "Hermite cable", "Spherical"),
    "discrete cable on a solid": ("solid, hexahedra 1", "discrete cable", "Spherical"),
    "cable on a thin shell": ("thin shell", "Hermite cable", "Spherical"),
    "beam on a solid": ("solid, hexahedra 1", "beam, geodesic", "Fixed"),
    "discrete rod on a reduced body": ("reduced-order beam", "discrete rod", "Fixed"),
}
RUNS = [(name, scheme) for name in ON_BODIES for scheme in SCHEMES]
RUNS.remove(("discrete rod on a reduced body", "explicit"))
"""All but those of reduced-order bodies, no node of which has a mass of its own."""


def run(scheme: Any, data: SceneData, finer: int = 1) -> fl.Result:
    steps = STEPS * finer
    scene = build(data).scene
    return scheme.run(scene, duration=DURATION, step=DURATION / steps, progress=False)


def order_of(scheme: Any, data: SceneData) -> float:
    """Order by the last of three runs, each with half the step of the one before."""
    ends = [run(scheme, data, finer).frames[-1] for finer in (2, 4, 8)]
    first, second = (np.abs(a - b).max() for a, b in pairwise(ends))
    return float(np.log2(first / second))


def check(result: fl.Result, scheme: str, balance: float, angular: float) -> None:
    assert result.balance_error < balance
    assert result.momentum_error < (1e-11 if scheme == "decaying" else 1e-12)
    assert result.angular_momentum_error < angular
    assert result.joint_violations.max() < 1e-12


@pytest.mark.parametrize(("name", "scheme"), RUNS)
def test_a_line_on_a_body(name, scheme):
    """Energy is accounted for, momenta are kept, and the order is two.

    A discrete rod that spins about its edges has no balance of angular momentum in any scheme.
    """
    data = on_body(*ON_BODIES[name])
    balance = 1e-11 if scheme in CONSERVING else 1e-7
    angular = 1e-6 if "discrete rod" in name else 1e-11
    check(run(SCHEMES[scheme], data), scheme, balance, angular)
    assert order_of(SCHEMES[scheme], data) == pytest.approx(2.0, abs=0.15)


BOUND = {
    **{f"rope on {joint}": rope_on_slide(joint) for joint in ("Sliding", "Collar", "Sleeve")},
    **{
        f"{joint}, {body}": joined(body, joint)
        for joint in ("KnifeEdge", "RollingDisc")
        for body in (
            "shell, six parameters",
            "solid, hexahedra 1",
            "thin shell",
            "ANCF beam",
        )
    },
    "KnifeEdge, reduced-order beam": joined("reduced-order beam", "KnifeEdge"),
}


@pytest.mark.parametrize("scheme", CONSERVING)
@pytest.mark.parametrize("name", BOUND)
def test_constraints_of_several_nodes_and_of_velocities(name, scheme):
    """They do no work, keep momenta, and hold; nodes may have vector coordinates."""
    data = BOUND[name]
    check(run(CONSERVING[scheme], data), scheme, 1e-11, 1e-11)
    assert order_of(CONSERVING[scheme], data) == pytest.approx(2.0, abs=0.15)


def within(spring: bool) -> fl.Scene:
    """A beam held between two of its nodes, and a cable; or a spring on another node as well."""
    material = fl.Material(4e7, 0.3, 1000.0)
    section = fl.Section.rectangle(0.04, 0.04, material)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=3))
    rope = scene.add(fl.Cable.straight((1, 0, 0), (1.5, 0, 0), section, cells=2))
    scene.add(fl.joints.Spherical(beam.point("end"), rope.point("start")))
    pivot = beam.point_in_cell(1, 0.3)
    scene.add(fl.joints.Spherical(fl.ground(), pivot))
    for body in beam, rope:
        body.add_velocity(omega=(0, 2, 3), about=pivot.position)
    if spring:
        stay = scene.add(fl.joints.Distance(fl.ground(), beam.point("start"), at=(0, 0, 1)))
        scene.add(fl.joints.Spring(stay.length, 50.0))
    return scene


@pytest.mark.parametrize("spring", [False, True])
@pytest.mark.parametrize("scheme", CONSERVING)
def test_a_joint_within_a_beam_beside_a_cable(scheme, spring):
    result = CONSERVING[scheme].run(within(spring), duration=0.02, step=5e-4, progress=False)
    assert result.balance_error < 1e-11
    assert result.joint_violations.max() < 1e-12


def test_a_disc_on_an_interface_without_rotary_inertia_is_refused():
    with pytest.raises(ValueError, match="rotations without inertia"):
        run(fl.EnergyMomentum(), joined("reduced-order beam", "RollingDisc"))


def test_drilling_inertia_is_small():
    """It adds a part of the order of the squared thickness over length to the angular momentum."""
    data = moving(BODIES["shell, six parameters"], spin=SPIN)
    found = [run(SCHEMES[name], data) for name in ("conserving", "variational")]
    other = run(fl.GeneralisedAlpha(radius=1.0), data)
    for result in found:
        change = result.angular_momentum[0] - other.angular_momentum[0]
        assert 0 < np.linalg.norm(change) < 1e-4 * np.linalg.norm(other.angular_momentum[0])


@pytest.mark.parametrize("other", ["reduced-order beam", "rigid body", "solid, hexahedra 1"])
@pytest.mark.parametrize("scheme", [*CONSERVING, "variational"])
def test_a_reduced_body_in_contact(scheme, other):
    """It is struck at an interface: energy and momenta, as of other bodies."""
    scene = meeting("reduced-order beam", other)
    result = SCHEMES[scheme].run(scene, duration=1e-4, step=1e-5, progress=False)
    assert fl.post.contact_forces(result, scene.contacts[0]).touching[-1] == 1
    assert result.balance_error < (1e-11 if scheme in CONSERVING else 1e-4)
    assert result.momentum_error < (1e-11 if scheme == "decaying" else 1e-12)
    assert result.angular_momentum_error < 1e-11
