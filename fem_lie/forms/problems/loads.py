"""Loads on nodal frames as forms with their tangents, over any measure ``dx(…)`` or ``ds(…)``.

At the end of a line ``ds`` is a concentrated load. Loads are fixed in space (dead) or along the
nodal directors (followers); gravity is the dead force ``ρA g`` over ``dx``. A force fixed in space
has a tangent, as residuals are along nodal frames: ``−[Rᵀf]×`` times the rotation.
"""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie.forms.frames import NodalFrames, local_frame_forms
from fem_lie.forms.local_forms import LocalFrameForms


def dead_force(force: Expr | fem.Constant, measure: ufl.Measure, q: NodalFrames) -> LocalFrameForms:
    """Forms of a force fixed in space, of the potential ``−∫ f·x``.

    Args:
        force: Force per length or area of the reference mesh, shape (3,), in space. A
            ``fem.Constant`` can be changed later.
        measure: Part of the mesh; at a vertex the force itself.
        q: Nodal frames.
    """
    change = ufl.derivative(q.position, q.function)
    return local_frame_forms(-ufl.inner(_vector("force", force), change) * measure, q)


def dead_moment(
    moment: Expr | fem.Constant, measure: ufl.Measure, q: NodalFrames
) -> LocalFrameForms:
    """Forms of a moment fixed in space, which has no energy: its tangent is not symmetric.

    Args:
        moment: Moment per length or area of the reference mesh, shape (3,), in space.
        measure: Part of the mesh; at a vertex the moment itself.
        q: Nodal frames.
    """
    # rotation of an orthonormal triad: δφ = ½ Σ d_k × δd_k
    pairs = [(d, ufl.derivative(d, q.function)) for d in q.directors]
    work = sum(ufl.inner(_vector("moment", moment), ufl.cross(d, change)) for d, change in pairs)
    return local_frame_forms(-work / 2 * measure, q)


def follower_force(
    force: Expr | fem.Constant, measure: ufl.Measure, q: NodalFrames
) -> LocalFrameForms:
    """Forms of a force with constant components along the directors.

    Args:
        force: Force per length or area of the reference mesh, shape (3,), along ``d₁, d₂, d₃``.
        measure: Part of the mesh; at a vertex the force itself.
        q: Nodal frames.
    """
    work = ufl.inner(_in_space("force", force, q), ufl.derivative(q.position, q.function))
    return local_frame_forms(-work * measure, q)


def follower_moment(
    moment: Expr | fem.Constant, measure: ufl.Measure, q: NodalFrames
) -> LocalFrameForms:
    """Forms of a moment with constant components along the directors.

    Args:
        moment: Moment per length or area of the reference mesh, shape (3,), along ``d₁, d₂, d₃``.
        measure: Part of the mesh; at a vertex the moment itself.
        q: Nodal frames.
    """
    return dead_moment(_in_space("moment", moment, q), measure, q)


def _in_space(name: str, value: Expr, q: NodalFrames) -> Expr:
    components, d = _vector(name, value), q.directors
    return sum((components[k] * d[k] for k in range(1, 3)), components[0] * d[0])


def _vector(name: str, value: Expr) -> Expr:
    if np.iscomplexobj(getattr(value, "value", 0.0)):
        raise TypeError(f"expected {name} of real numbers, got the complex {value.value}")
    shape = getattr(value, "ufl_shape", None)
    if shape != (3,):
        raise ValueError(
            f"expected {name} as a UFL vector of shape (3,), such as fem.Constant(mesh, (0.0, 0.0, "
            f"1.0)), got {value!r}"
        )
    return value
