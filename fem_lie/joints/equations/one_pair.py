"""One pair of frames of a joint, compiled: relative motion, terms and their rates.

:mod:`fem_lie.joints.equations.terms` sums over pairs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie._jit.copies import copy_vector
from fem_lie.joints.equations import functions
from fem_lie.joints.equations.joint_arrays import JointArrays
from fem_lie.joints.equations.relative_motion import relative_motion, variation

WORKSPACE = 75
"""Size of the array that :func:`workspace` divides."""


class Workspace(NamedTuple):
    """Arrays for the quantities of one pair.

    Attributes:
        A: Frame of side A, shape (4, 3).
        B: Frame of side B, shape (4, 3).
        z: Relative motion, shape (12,).
        p: Generalised force conjugate to ``z``, shape (12,).
        f: Values of the functions, shape (3,).
        c: Factors of the gradients of the functions in ``p``, shape (6,).
        sides: Forces and moments on the two frames, shape (2, 6).
        moved: Force and moment on one node, shape (6,).
    """

    A: Array
    B: Array
    z: Array
    p: Array
    f: Array
    c: Array
    sides: Array
    moved: Array


@inlined
def workspace(work: Array) -> Workspace:
    """Views of ``work`` (75,), which is set to zero."""
    work[:] = 0.0
    return Workspace(
        work[:12].reshape(4, 3),
        work[12:24].reshape(4, 3),
        work[24:36],
        work[36:48],
        work[48:51],
        work[51:57],
        work[57:69].reshape(2, 6),
        work[69:75],
    )


@inlined
def locate(H: Array, arrays: JointArrays, j: int, A: Array, B: Array, z: Array, f: Array) -> None:
    """Compute the two frames, the relative motion and the functions of pair j."""
    lie.compose(H[arrays.nodes[j, 0]], arrays.frames[j, 0], A)
    lie.compose(H[arrays.nodes[j, 1]], arrays.frames[j, 1], B)
    relative_motion(A, B, z)
    if arrays.curved[j]:
        functions.values(z, arrays.angle[j], arrays.turned[j], f)


@inlined
def term(arrays: JointArrays, t: int, z: Array, f: Array) -> float:
    """Value of term t; its rate if ``z`` and ``f`` are rates."""
    value = 0.0
    for k in range(12):
        value += arrays.selection[t, k] * z[k]
    for k in range(3):
        value += arrays.functions[t, k] * f[k]
    return value


@inlined
def gradient(arrays: JointArrays, j: int, t: int, z: Array, p: Array) -> None:
    """``p = ∂(term t)/∂z``."""
    copy_vector(arrays.selection[t], p)
    functions.add_gradients(z, arrays.angle[j], arrays.functions[t], p)


@inlined
def twists(v: Array, arrays: JointArrays, j: int, twist: Array) -> None:
    """Twists (2, 6) of the frames of pair j; nodes beyond the rows of ``v`` are at rest."""
    for side in range(2):
        node = arrays.nodes[j, side]
        twist[side] = 0.0
        if node < v.shape[0]:
            lie.apply_adjoint_inverse(arrays.frames[j, side], v[node], twist[side])


@compiled
def rate_of_term(v: Array, arrays: JointArrays, j: int, t: int, z: Array) -> float:
    """Rate of term t of pair j at nodal twists ``v``."""
    twist, dz, p = np.empty((2, 6)), np.empty(12), np.empty(12)
    twists(v, arrays, j, twist)
    variation(z, twist[0], twist[1], dz)
    gradient(arrays, j, t, z, p)
    return float(p @ dz)
