"""Inertia of nodal frames, from a kinetic energy in UFL.

A kinetic energy that is quadratic in the rates ``q̇ = (ẋ, ḋ₁, ḋ₂, ḋ₃)`` of positions and directors
has a constant mass matrix ``G``. With ``q̇ = L v`` for twists ``v`` along nodal frames, forces of
inertia are ``Lᵀ G (L v̇ + L̇ v)``, of which the second part is centrifugal and gyroscopic.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem
from dolfinx.fem import petsc
from scipy.sparse import csr_matrix
from ufl.algorithms import expand_derivatives
from ufl.core.expr import Expr

from fem_lie._arrays import Array, Indices, instance, numbers
from fem_lie._form_cache import compile_form
from fem_lie.forms.frames import VALUES, NodalFrames

_VECTORS = VALUES // 3
_ROUND_OFF = 1e-12


class MassBlocks(NamedTuple):
    """Constant mass matrix of (x, d₁, d₂, d₃), sparse by pairs of nodes.

    Attributes:
        rows: First node of each pair, ascending, shape (nnz,).
        columns: Second node of each pair, ascending in each row, shape (nnz,).
        blocks: Mass matrix of each pair, shape (nnz, 4, 4).
    """

    rows: Indices
    columns: Indices
    blocks: Array


def kinetic_energy(
    density: Expr | fem.Constant | fem.Function | npt.ArrayLike,
    measure: ufl.Measure,
    q: NodalFrames,
) -> ufl.Form:
    """Kinetic energy ``½ ∫ Σ ρ_ab q̇_a·q̇_b`` of the rates of (x, d₁, d₂, d₃).

    Args:
        density: Mass matrix ``ρ`` per length, area or volume of the reference mesh, shape (4, 4),
            such as ``fl.Section.inertia`` or that of :func:`fem_lie.sections.director_mass_matrix`;
            at a vertex the mass matrix itself.
        measure: Part of the mesh, ``dx(…)`` or ``ds(…)``.
        q: Nodal frames.

    Raises:
        ValueError: The density does not have shape (4, 4).
    """
    instance(measure, ufl.Measure, "kinetic_energy: measure", "a measure such as ufl.dx(mesh)")
    instance(q, NodalFrames, "kinetic_energy: q", "NodalFrames")
    mesh = q.function.function_space.mesh
    symbolic = isinstance(density, Expr)
    ρ: Any = density if symbolic else fem.Constant(mesh, numbers(density, "density"))
    if ρ.ufl_shape != (_VECTORS, _VECTORS):
        raise ValueError(
            "kinetic_energy: expected density as a mass matrix of (x, d₁, d₂, d₃), shape (4, 4), "
            f"got shape {ρ.ufl_shape}"
        )
    rates = ufl.as_matrix([list(rate) for rate in (q.velocity, *q.director_rates)])
    return ufl.inner(ρ * rates, rates) / 2 * measure


def mass_blocks(energy: ufl.Form, q: NodalFrames) -> MassBlocks:
    """Mass matrix of a kinetic energy.

    Args:
        energy: Quadratic form in ``q.velocity`` and ``q.director_rates``.
        q: Nodal frames, on a mesh of one process.

    Raises:
        ValueError: The energy is no such form, depends on the frames, or has a mass that depends on
            directions in space.
    """
    space = q.rates.function_space
    first = expand_derivatives(ufl.derivative(energy, q.rates, ufl.TestFunction(space)))
    second = expand_derivatives(ufl.derivative(first, q.rates, ufl.TrialFunction(space)))
    if second.empty():
        raise ValueError(
            "expected an inertia that is quadratic in q.velocity and q.director_rates, as of "
            f"fl.extend.kinetic_energy, got {energy}"
        )
    for name, f in ("rates", q.rates), ("frames", q.function):
        if f in second.coefficients():
            raise ValueError(
                "expected an inertia with a constant mass matrix, got one that depends on the "
                f"{name}: {energy}"
            )
    at_rest = q.rates.x.array.copy()
    q.rates.x.array[:] = 0.0
    momentum = fem.assemble_vector(compile_form(first)).array if not first.empty() else np.zeros(1)
    q.rates.x.array[:] = at_rest
    if momentum.any():
        raise ValueError(
            f"expected an inertia without terms that are linear in the rates, got {energy}"
        )
    assembled = petsc.assemble_matrix(compile_form(second))
    assembled.assemble()
    indptr, indices, values = assembled.getValuesCSR()
    matrix = csr_matrix((values, indices, indptr)).tobsr((VALUES, VALUES))
    matrix.sort_indices()
    blocks = matrix.data.reshape(-1, _VECTORS, 3, _VECTORS, 3).transpose(0, 1, 3, 2, 4)
    mass = blocks[..., 0, 0]
    away = np.abs(blocks - mass[..., np.newaxis, np.newaxis] * np.eye(3)).max(initial=0.0)
    if away > _ROUND_OFF * np.abs(mass).max(initial=0.0):
        raise ValueError(
            "expected an inertia with the same mass in all directions of space, sums of q̇_a·q̇_b, "
            f"got {energy}"
        )
    rows = np.repeat(np.arange(len(q.frames)), np.diff(matrix.indptr))
    return MassBlocks(rows, matrix.indices.astype(np.int64), mass.copy())
