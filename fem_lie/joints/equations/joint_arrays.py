"""Packed arrays of all joints of a scene, for compiled loops: fifteen arrays passed as two.

The time to call a compiled function from Python grows with the number of its arrays. They are
therefore packed into one array of numbers and one of integers, with the sizes at the head; the
fifteen arrays are views of these.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie._jit.packed_arrays import Integers1, Numbers1
from fem_lie.joints.equations.functions import COUNT

PackedJoints: TypeAlias = tuple[Numbers1, Integers1]
"""Numbers and integers of a :class:`JointArrays`, each as one array."""


class JointArrays(NamedTuple):
    """Pairs of frames of all joints of a scene: ``j`` pairs with ``t`` terms and ``m`` constraints.

    Attributes:
        nodes: Nodes A and B of each pair, shape (j, 2).
        frames: Joint frames in the frames of their nodes, shape (j, 2, 4, 3).
        first: First term of each pair and ``t`` at the end, shape (j + 1,).
        selection: Rows ``S``, shape (t, 12): three columns for Δ, nine for Q (row-major).
        functions: Factors ``c`` of angle, distance, tilt and angular velocity, shape (t, 6).
        rows: Constraint of each term, or ``m`` plus the number of its spring, shape (t,).
        incidences: Incidence of each term's constraint with the nodes of its sides A and B, −1: the
            side does not move, or the term is of a spring, shape (t, 2).
        angle: Rows of sine and cosine of each pair's angle, shape (j, 2, 12).
        curved: 1 for pairs that have terms with functions, else 0, shape (j,).
        turned: Angle at the last accepted state, rad, shape (j,).
        targets: Prescribed values of the constraints, shape (m,).
        springs: Stiffness, damping and rest value, shape (k, 3). With a force law: factors of the
            force and of its derivative in the rate, and the shift of the coordinate. With friction:
            zero, the factor of its force, and zero.
        laws: Address of the force law of each spring, 0: none; first of its data and the end; pair
            of the joint whose friction it is, −1: none, and side of this pair with the bearing,
            shape (k, 5). See :mod:`~fem_lie.joints.equations.laws` and :mod:`~.equations.friction`.
        data: Data of all force laws and of friction.
        clock: Time at which force laws are evaluated, shape (1,).
    """

    nodes: Indices
    frames: Array
    first: Indices
    selection: Array
    functions: Array
    rows: Indices
    incidences: Indices
    angle: Array
    curved: Indices
    turned: Array
    targets: Array
    springs: Array
    laws: Indices
    data: Array
    clock: Array


def pack(arrays: JointArrays) -> PackedJoints:
    """Pack the arrays into two; :func:`views` is the inverse."""
    j, t, m, k = len(arrays.nodes), len(arrays.rows), len(arrays.targets), len(arrays.springs)
    shapes = (arrays.frames, arrays.selection, arrays.functions, arrays.angle)
    numbers = (*shapes, arrays.turned, arrays.targets, arrays.springs, arrays.data, arrays.clock)
    nodes, of_terms = (arrays.nodes, arrays.first), (arrays.rows, arrays.incidences)
    integers = (*nodes, *of_terms, arrays.curved, arrays.laws)
    sizes = np.array([j, t, m, k], dtype=np.int64)
    return (
        np.concatenate([array.ravel() for array in numbers]),
        np.concatenate([sizes, *(array.ravel() for array in integers)]),
    )


def views(packed: PackedJoints) -> JointArrays:
    """Views of the packed arrays."""
    x, i = packed
    j, t, m, k = i[0], i[1], i[2], i[3]
    selection, functions = 24 * j, 24 * j + 12 * t
    angle = functions + COUNT * t
    turned = angle + 24 * j
    targets = turned + j
    springs = targets + m
    data = springs + 3 * k
    first = 4 + 2 * j
    rows = first + j + 1
    incidences = rows + t
    curved = incidences + 2 * t
    laws = curved + j
    return JointArrays(
        i[4:first].reshape(j, 2),
        x[:selection].reshape(j, 2, 4, 3),
        i[first:rows],
        x[selection:functions].reshape(t, 12),
        x[functions:angle].reshape(t, COUNT),
        i[rows:incidences],
        i[incidences:curved].reshape(t, 2),
        x[angle:turned].reshape(j, 2, 12),
        i[curved:laws],
        x[turned:targets],
        x[targets:springs],
        x[springs:data].reshape(k, 3),
        i[laws:].reshape(k, 5),
        x[data : x.shape[0] - 1],
        x[x.shape[0] - 1 :],
    )


joint_arrays = inlined(views)
""":func:`views` in compiled code."""
