"""Path of the rope of net_capture.py, and what touches what."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np

import fem_lie as fl
from fem_lie.extend import GAP_SIGNATURE, GapSurface, callback, compiled, evaluate

THREAD, BALL = 4e-3, 0.3
"""Radii of threads and of the ball, m."""


@compiled
def outside(X: Any, parameters: Any) -> Any:
    """Signed distance from a ball."""
    return math.sqrt(X[0] * X[0] + X[1] * X[1] + X[2] * X[2]) - parameters[0]


@callback(GAP_SIGNATURE)
def gap(out: Any, X: Any, parameters: Any) -> None:
    """The same with its derivatives."""
    evaluate(outside, (0.0,), out, X, parameters)


class Ball(GapSurface):
    """A ball that lines touch along their length; a Sphere touches them in one point each."""

    gap = gap

    def __init__(self, point: fl.extend.Point, radius: float) -> None:
        """About a point."""
        self.point, self.parameters = point, (radius,)


def add_contacts(scene: fl.Scene, net: fl.Net, rope: fl.Net, ball: fl.RigidBody) -> None:
    """Threads touch the ball, each other and themselves, along their length."""
    lines = [fl.contact.Line(body, THREAD) for body in (net, rope)]
    on_ball, on_threads = fl.contact.Penalty(5e4), fl.contact.Penalty(6e5)
    whole = Ball(ball.point("centre"), BALL)
    for line in lines:
        scene.add(fl.contact.Contact(line, whole, on_ball, name=f"{line.body.label}-ball"))
        scene.add(fl.contact.Contact(line, line, on_threads, name=f"{line.body.label}-itself"))
    scene.add(fl.contact.Contact(*lines, on_threads, name="net-rope"))


def rope_path(corners: list[np.ndarray], size: float) -> np.ndarray:
    """From corner to corner, in even parts of nearly a size."""
    path = [corners[0]]
    for a, b in pairwise(corners):
        parts = max(2, round(np.linalg.norm(b - a) / size))
        path += [a + part / parts * (b - a) for part in range(1, parts + 1)]
    return np.array(path)
