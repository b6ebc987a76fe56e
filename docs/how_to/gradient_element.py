"""An element of one's own on position-gradient nodes: a cable of two nodes, position and slope.

An element for the small-energy kernel says what it is, and nothing of its derivatives: vectors
linear in those of the nodes, strains as a function of their scalar products, and a law. Forces,
tangent stiffness and linearised stress follow. Here the vectors are slope and bend of the cubic,
``f = r′`` and ``g = r″``; stretch ``√(f·f) − 1`` has Lobatto's points, where it does not lock, and
squared curvature ``|f × g|²/|f|⁴`` has Gauss'.
"""

from __future__ import annotations

import math

import numpy as np

import fem_lie as fl
from fem_lie.extend import (
    CELL_SIGNATURE,
    CellFunctions,
    NodeType,
    callback,
    cell,
    cell_data,
    compiled,
    element,
)

SIDE = 0.5 * np.sqrt(0.6)
POINTS = np.array([0.0, 0.5 - SIDE, 0.5, 0.5 + SIDE, 1.0])
LOBATTO = np.array([1.0, 0.0, 4.0, 0.0, 1.0]) / 6
GAUSS = np.array([0.0, 5.0, 8.0, 5.0, 0.0]) / 18
MASSES = (
    np.array([[156.0, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
)


@compiled
def stretch_and_curvature(products, parameters):
    """Strains as a function of f·f, f·g and g·g."""
    ff, fg, gg = products
    return math.sqrt(ff) - 1.0, (ff * gg - fg * fg) / (ff * ff)


@compiled
def energy_of(strains, parameters):
    """Energy at a point, with its weight in the parameters."""
    stretching, bending = parameters
    return 0.5 * stretching * strains[0] * strains[0] + 0.5 * bending * strains[1]


ELEMENT = element(
    [NodeType.POSITION_GRADIENT, NodeType.POSITION_GRADIENT],
    [(0, 0), (0, 1), (1, 1)],
    vectors=2,
    strains=2,
    points=len(POINTS),
    parameters=2,
    strain=stretch_and_curvature,
    law=energy_of,
)


@callback(CELL_SIGNATURE)
def energy(out, w, h):
    """Energy of a cell."""
    cell.add_energy(ELEMENT, out, w)


@callback(CELL_SIGNATURE)
def forces(out, w, h):
    """Forces of a cell."""
    cell.add_forces(ELEMENT, out, w)


@callback(CELL_SIGNATURE)
def tangent(out, w, h):
    """Tangent stiffness of a cell."""
    cell.add_tangent_at_stress(ELEMENT, out, w)


@callback(CELL_SIGNATURE)
def stress(out, w, h):
    """Linearised stress of a cell."""
    cell.update_stress(ELEMENT, out, w, h)


FUNCTIONS = CellFunctions(energy, forces, tangent, stress)


def cable(count: int, EA: float, EI: float, mass: float) -> fl.extend.ElementBody:
    """A straight cable of length one, of so many cells."""
    size, s = 1.0 / count, POINTS
    tables = np.empty((len(s), 2, 4))
    # coordinate vectors: position and slope of one node, then of the other
    tables[:, 0] = np.stack(
        [6 * (s**2 - s) / size, 1 - 4 * s + 3 * s**2, 6 * (s - s**2) / size, 3 * s**2 - 2 * s],
        axis=1,
    )
    tables[:, 1] = (
        np.stack([(12 * s - 6) / size, 6 * s - 4, (6 - 12 * s) / size, 6 * s - 2], axis=1) / size
    )
    parameters = np.stack([EA * size * LOBATTO, EI * size * GAUSS], axis=1)
    rows = np.tile(np.vstack([np.zeros(3), np.eye(3)]), (count + 1, 1, 1))
    rows[:, 0, 0] = np.linspace(0, 1, count + 1)
    scale = np.array([1.0, size, 1.0, size])
    inertia = np.zeros((count, 2, 4, 2, 4))
    inertia[:, :, :2, :, :2] = (mass * size * scale[:, None] * scale * MASSES).reshape(2, 2, 2, 2)
    data = cell_data(ELEMENT, np.tile(tables, (count, 1, 1, 1)), np.tile(parameters, (count, 1, 1)))
    cells = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)
    return fl.extend.ElementBody(
        rows,
        [NodeType.POSITION_GRADIENT] * (count + 1),
        cells,
        element=ELEMENT,
        functions=FUNCTIONS,
        data=data,
        inertia=inertia,
        points={"start": 0, "end": count},
        lines=cells,
    )


def tip(count: int) -> np.ndarray:
    """End of a cantilever that a moment bends by a quarter of a circle."""
    scene, EI = fl.Scene(), 1.0
    body = scene.add(cable(count, EA=1e4, EI=EI, mass=1.0))
    body.clamp(body.point("start"))
    scene.add(fl.PointLoad(body.point("end"), moment=(0, 0, 0.5 * np.pi * EI)))
    return fl.statics(scene, load_steps=3).position(body.point("end"))[-1]


exact = 2 / np.pi * np.array([1, 1, 0])
errors = [np.linalg.norm(tip(count) - exact) for count in (4, 8)]
order = np.log2(errors[0] / errors[1])
print(f"errors {errors[0]:.1e}, {errors[1]:.1e}: order {order:.2f}")
