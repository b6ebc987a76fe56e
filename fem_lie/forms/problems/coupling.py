"""Blocks of the tangent that couple nodal frames with another field on the same mesh.

With an energy ``W(y, t)`` of frames and a field ``t``, and a residual ``R_t(y, t)`` of the field,
Newton's method for both at once needs ``∂(Lᵀ W_y)/∂t`` and ``∂R_t/∂h``. The other two blocks are
those of :func:`~fem_lie.forms.frames.local_frame_forms` and of UFL.
"""

from __future__ import annotations

import ufl
from dolfinx import fem
from ufl.algorithms.analysis import extract_coefficients

from fem_lie.forms.frames import DIRECTORS, NodalFrames
from fem_lie.forms.kernels import in_local_frames as kernels
from fem_lie.forms.wrapping import CompiledForm, Wrapping, packed_size


def derivative_in_field(energy: ufl.Form, q: NodalFrames, field: fem.Function) -> fem.Form:
    """Derivative of forces along nodal frames in a field, rank 2: rows of frames, columns of it.

    Args:
        energy: Energy in ``q.position``, ``q.directors`` and the field, or a virtual work, as for
            :func:`~fem_lie.forms.frames.local_frame_forms`.
        q: Nodal frames.
        field: Any function of DOLFINx on the mesh of ``q``.

    Raises:
        ValueError: The energy does not depend on the field.
    """
    force, y = energy, q.function
    if not energy.arguments():
        force = ufl.derivative(energy, y, ufl.TestFunction(y.function_space))
    force = _integrals_with(field, force, "energy")
    S = field.function_space
    block = CompiledForm(ufl.derivative(force, field, ufl.TrialFunction(S)))
    wrapping = Wrapping(DIRECTORS, y, y, q.increment, packed_size(S))
    spaces = [q.increment.function_space, S]
    return wrapping.form(kernels.field_columns_kernel, spaces, [block])


def derivative_in_frames(residual: ufl.Form, q: NodalFrames) -> fem.Form:
    """Derivative of a field's residual in increments of the frames, rank 2: rows of the field.

    Args:
        residual: Linear form in one test function of the field, which depends on ``q.position`` or
            ``q.directors``.
        q: Nodal frames.

    Raises:
        ValueError: The residual is no linear form, or does not depend on the frames.
    """
    arguments, y = residual.arguments(), q.function
    if len(arguments) != 1:
        raise ValueError(f"expected a residual with one test function, got {len(arguments)}")
    residual = _integrals_with(y, residual, "residual")
    S = arguments[0].ufl_function_space()
    block = CompiledForm(ufl.derivative(residual, y, ufl.TrialFunction(y.function_space)))
    wrapping = Wrapping(DIRECTORS, y, y, q.increment, packed_size(S))
    spaces = [S, q.increment.function_space]
    return wrapping.form(kernels.field_rows_kernel, spaces, [block])


def _integrals_with(f: fem.Function, form: ufl.Form, name: str) -> ufl.Form:
    """Integrals of ``form`` that depend on ``f``."""
    chosen = [i for i in form.integrals() if f in extract_coefficients(i.integrand())]
    if not chosen:
        raise ValueError(f"the {name} does not depend on {f}: {form}")
    return ufl.Form(chosen)
