"""Scenes in numbers alone, for any code to build: lists and dictionaries that JSON can carry.

Positions, velocities and spins are in space, frames are rotation matrices whose first column is the
tangent of a beam. Stiffness is that of a section, (EA, GA₂, GA₃, GJ, EI₂, EI₃), inertia that of a
length about its own axes.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np
import numpy.typing as npt

from benchmarks.everyday_rows import plate as bent
from benchmarks.scale import LINK, MASS, RADIUS
from demos import bend45, free_rigid_body, hemisphere, rollup
from demos.double_pendulum import SIDE, SPIN

Description = dict[str, Any]
Array = npt.NDArray[np.float64]


def line(
    positions: Array, frames: Array, length: float, stiffness: list[float], mass: float = 0.0
) -> Description:
    """A beam of elements of equal length through nodes at rest, (n, 3) and (n, 3, 3)."""
    return {
        "places": positions.tolist(),
        "frames": frames.tolist(),
        "velocities": np.zeros_like(positions).tolist(),
        "spin": [0.0, 0.0, 0.0],
        "element_length": length,
        "stiffness": stiffness,
        "mass": mass,
        "inertia": [0.0, 0.0, 0.0],
    }


def double_pendulum(case: int, elements: int) -> Description:
    """The bars of demos/double_pendulum.py."""
    b, E, nu, density = SIDE[case], 70e9, 0.3, 2700.0
    A, second, G = b * b, b**4 / 12, E / (2 * (1 + nu))
    stiffness = [E * A, 5 / 6 * G * A, 5 / 6 * G * A, G * 0.1406 * b**4, E * second, E * second]
    inertia = [2 * density * second, density * second, density * second]

    def bar(start: list[float], tangent: list[float], length: float) -> Description:
        along = np.linspace(0.0, length, elements + 1)[:, np.newaxis]
        axes = np.column_stack([tangent, np.cross((0, 0, 1), tangent), (0, 0, 1)])
        frames = np.tile(axes, (elements + 1, 1, 1))
        positions = start + along * tangent
        body = line(positions, frames, length / elements, stiffness, density * A)
        return body | {"inertia": inertia}

    one = bar([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.3)
    two = bar([0.3, 0.0, 0.0], [0.0, 1.0, 0.0], 0.5)
    spin = np.array(SPIN[case], dtype=float)
    arms = np.array(two["places"]) - two["places"][0]
    two |= {"velocities": np.cross(spin, arms).tolist(), "spin": spin.tolist()}
    between: Description = {"nodes": [[0, elements], [1, 0]]}
    between |= {"axis": [1.0, 0.0, 0.0]} if case == 3 else {}
    return {
        "beams": [one, two],
        "joints": [{"nodes": [None, [0, 0]]}, between],
        "probe": [1, elements],
    }


def bend(elements: int) -> Description:
    """The arc of demos/bend45.py."""
    radius, EI = 100.0, 1e7 / 12
    angle = np.linspace(0.0, pi / 4, elements + 1)
    cosine, sine, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    positions = radius * np.column_stack([sine, 1 - cosine, zero])
    tangents = np.column_stack([cosine, sine, zero])
    normals = np.column_stack([-sine, cosine, zero])
    frames = np.stack(
        [tangents, normals, np.broadcast_to((0.0, 0.0, 1.0), positions.shape)], axis=2
    )
    arc = line(positions, frames, radius * pi / 4 / elements, [1e7, 5e6, 5e6, EI, EI, EI])
    return {
        "beams": [arc],
        "clamp": [0, 0],
        "force": [0.0, 0.0, bend45.FORCE],
        "moment": [0.0, 0.0, 0.0],
        "probe": [0, elements],
    }


def roll(elements: int, stiffness_ratio: float) -> Description:
    """The cantilever of demos/rollup.py."""
    length, EI = rollup.LENGTH, rollup.BENDING
    EA = stiffness_ratio * EI / length**2
    positions = np.linspace((0.0, 0.0, 0.0), (length, 0.0, 0.0), elements + 1)
    frames = np.tile(np.eye(3), (elements + 1, 1, 1))
    straight = line(positions, frames, length / elements, [EA, EA / 2, EA / 2, EI, EI, EI])
    return {
        "beams": [straight],
        "clamp": [0, 0],
        "force": [0.0, 0.0, 0.0],
        "moment": [0.0, 0.0, 2 * pi * EI / length],
        "probe": [0, elements],
    }


def chain(
    bodies: int, link: float = LINK, mass: float = MASS, radius: float = RADIUS
) -> Description:
    """Rods along x, on spherical joints; by default those of benchmarks/scale.py."""
    thick = mass * (link**2 / 12.0 + radius**2 / 4.0)
    rods = [
        {
            "mass": mass,
            "inertia": [mass * radius**2 / 2.0, thick, thick],
            "centre": [(k + 0.5) * link, 0.0, 0.0],
            "velocity": [0.0, 0.0, 0.0],
            "spin": [0.0, 0.0, 0.0],
        }
        for k in range(bodies)
    ]
    joints = [
        {"bodies": [k - 1 if k else None, k], "at": [k * link, 0.0, 0.0]} for k in range(bodies)
    ]
    end = {"body": bodies - 1, "at": [bodies * link, 0.0, 0.0]}
    return {"bodies": rods, "joints": joints, "gravity": [0.0, 0.0, -9.81], "probe": end}


def spinning() -> Description:
    """The free body of demos/free_rigid_body.py; its probe is a point off all axes."""
    J, spin = free_rigid_body.J.tolist(), free_rigid_body.SPIN.tolist()
    body = {"mass": 1.0, "inertia": J, "centre": [0.0, 0.0, 0.0], "spin": spin}
    body["velocity"] = [0.0, 0.0, 0.0]
    probe = {"body": 0, "at": [1.0, 1.0, 1.0]}
    return {"bodies": [body], "joints": [], "gravity": [0.0, 0.0, 0.0], "probe": probe}


def grid(position: Callable[[float, float], Array], side: int) -> Description:
    """A surface of ``side`` × ``side`` cells over the unit square.

    Nodes follow each other row by row, the first parameter fastest; cells are the numbers of their
    four corners, counterclockwise in the parameters.
    """
    steps, row = np.linspace(0.0, 1.0, side + 1), side + 1
    first = [k + row * j for j in range(side) for k in range(side)]
    return {
        "side": side,
        "positions": [position(a, b).tolist() for b in steps for a in steps],
        "cells": [[n, n + 1, n + 1 + row, n + row] for n in first],
    }


def pinched(thickness: float, side: int) -> Description:
    """The quarter of demos/hemisphere.py, its nodes row by row from the equator up.

    ``supports`` are nodes, each with its fixed components of displacement (0, 1, 2) and rotation
    (3, 4, 5); ``loads`` are nodes, each with a dead force; ``probe`` are nodes, each with the
    direction along which the displacement is asked.
    """
    row = side + 1
    half = hemisphere.CASES[thickness][0] / 2
    return grid(hemisphere.position, side) | {
        "radius": hemisphere.RADIUS,
        "hole": float(hemisphere.HOLE),
        "thickness": thickness,
        "young": 6.825e7,
        "poisson": 0.3,
        "supports": [
            *([row * k, [1, 3, 5]] for k in range(row)),
            *([side + row * k, [0, 4, 5]] for k in range(row)),
            [0, [2]],
        ],
        "loads": [[0, [half, 0.0, 0.0]], [side, [0.0, -half, 0.0]]],
        "probe": [[0, [1.0, 0.0, 0.0]], [side, [0.0, -1.0, 0.0]]],
    }


def plate(side: int) -> Description:
    """The plate of benchmarks/everyday_rows/plate.py, described as :func:`pinched` is.

    The edge load is that of bilinear cells: half of a cell's force on each of its two nodes.
    """
    row = side + 1
    ends = [k * row + side for k in range(row)]
    force = np.full(row, bent.FORCE / side)
    force[[0, -1]] /= 2.0
    return grid(lambda a, b: np.array([bent.SIDE * a, bent.SIDE * b, 0.0]), side) | {
        "thickness": bent.THICKNESS,
        "young": bent.STEEL.E,
        "poisson": bent.STEEL.nu,
        "supports": [[k * row, [0, 1, 2, 3, 4, 5]] for k in range(row)],
        "loads": [[node, [0.0, 0.0, f]] for node, f in zip(ends, force.tolist(), strict=True)],
        "probe": [[ends[0], axis] for axis in np.eye(3).tolist()],
    }
