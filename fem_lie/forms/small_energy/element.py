"""Record of an element for the small-energy kernel: nodes, vectors, strains, law, constants.

Elements whose numbers of nodes and points are known at run time only pass their constants to the
kernel with each call, behind the data of the cell, like the constants of a form. Their functions
are compiled once for all sizes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt
from numba import types

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie._jit.stack import vector_at
from fem_lie.forms.kernels.addresses import Pointer, double_pointer, shift
from fem_lie.lie.node_types.node_type import TRAITS, NodeType

CELL_SIGNATURE = types.void(double_pointer, double_pointer, double_pointer)
"""Signature of the functions of an element.

Arguments are the result to add to, the data of a cell, and twists or increments of its nodes.
Callers may pass more arguments, which are ignored.
"""

CompiledFunction: TypeAlias = Any
"""Function compiled by :func:`fem_lie.extend.compiled`."""


class Cells(NamedTuple):
    """Constants of an element for compiled code.

    Vectors are numbered linear first, then constant, then derived.

    Attributes:
        types: Type of each node of a cell, shape (k,).
        coordinates: For each coordinate vector its node, its row there, its group of unknowns, and
            1 to 3 for directors of frames, zero for others, shape (r, 4).
        starts: Index of each coordinate vector among the 12 k numbers of all nodes, shape (r,).
        groups: First unknown of each group of three among the 6 k of all nodes, shape (u,).
        terms: Strain and both vectors of each product, shape (t, 3); if strains are a function of
            products, the number of the product instead of the strain.
        factors: Factor of each product, shape (t,).
        inputs: Linear vectors on which each derived vector depends, shape (d, i).
        points: Number of quadrature points.
        vectors: Number of linear vectors at each point.
        curved: Number of linear vectors, the first ones, on which derived vectors depend or by
            which they are multiplied.
        strains: Number of strains at each point.
        parameters: Number of parameters of the law at each point.
        offsets: Number of linear vectors with a constant part at each point: all or none.
        constants: Number of constant vectors at each point.
        viscosities: Number of entries of the viscosity at each point.
        pairs: Both strains of each product of strains in a quadratic law, shape (c, 2).
    """

    types: Indices
    coordinates: Indices
    starts: Indices
    groups: Indices
    terms: Indices
    factors: Array
    inputs: Indices
    points: int
    vectors: int
    curved: int
    strains: int
    parameters: int
    offsets: int
    constants: int
    viscosities: int
    pairs: Indices


class Element(NamedTuple):
    """Element: constants and functions, created by :func:`element`.

    Attributes:
        cells: Constants.
        strain: Strains as a function of products, or ``None`` for sums of products.
        law: Energy as a function of strains, or ``None`` for a quadratic law.
        derive: Derived vector as a function of others, or ``None``.
        like: Tuples with the lengths of products, strains, parameters and components of inputs of a
            derived vector, as far as functions have these arguments.
        turning: 1 if nodal axes rotate with the unknowns, else ``None``, which saves compilation.
    """

    cells: Cells
    strain: CompiledFunction | None
    law: CompiledFunction | None
    derive: CompiledFunction | None
    like: tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...], tuple[float, ...]]
    turning: int | None


def element(
    node_types: Sequence[NodeType],
    products: npt.ArrayLike,
    *,
    vectors: int,
    strains: int = 1,
    points: int = 1,
    parameters: int | None = None,
    strain: CompiledFunction | None = None,
    law: CompiledFunction | None = None,
    derive: CompiledFunction | None = None,
    inputs: Sequence[Sequence[int]] = (),
    constants: int = 0,
    offsets: bool = False,
    viscous: bool = False,
    pairs: npt.ArrayLike = (),
) -> Element:
    """Element for :mod:`fem_lie.forms.small_energy.cell`.

    Args:
        node_types: Type of each node of a cell.
        products: Both vectors of each scalar product, shape (t, 2), if ``strain`` is a function of
            them; else strain, both vectors and factor of each, shape (t, 4): strains are sums.
        vectors: Number of linear vectors at each point; constant and derived ones follow them.
        strains: Number of strains at each point.
        points: Number of quadrature points of a cell.
        parameters: Number of parameters of ``law`` at each point.
        strain: Compiled function of the tuples of products and parameters, which returns the tuple
            of strains. With a quadratic law the second tuple is empty.
        law: Compiled function of the tuples of strains and parameters, which returns the energy at
            a point. Default: ``½ (e − e₀)·C (e − e₀)`` with parameters ``e₀`` and ``C``, a
            quadratic law.
        derive: Compiled function of the tuple of components of linear vectors, which returns the
            three components of a derived vector, such as the unit normal of two tangents.
        inputs: Linear vectors on which each derived vector depends.
        constants: Number of constant vectors at each point.
        offsets: Whether linear vectors have a constant part.
        viscous: Whether there is a viscous stress ``η ė`` (Kelvin-Voigt).
        pairs: Both strains of each product of strains, a strain of second order, that is added to
            a quadratic law, shape (c, 2). The stress conjugate to it is ``g·(e − e₀)``, whose
            factors ``g``, shape (c, strains), are further parameters. Such an energy of third order
            contributes to the stiffness by a stress that is linearised, too.

    Raises:
        ValueError: Products refer to vectors or strains that do not exist, or have another shape;
            derived vectors do not depend on linear vectors, or have no function; or the number of
            parameters of a law that is a function is missing.
    """
    table, width = np.asarray(products, dtype=np.float64), 4 if strain is None else 2
    if table.ndim != 2 or table.shape[1] != width:
        what = "strain, vectors and factor" if strain is None else "two vectors"
        raise ValueError(f"products must have {what} each, shape (t, {width}), got {table.shape}")
    if strain is not None:
        numbers = np.arange(len(table), dtype=np.float64)
        table = np.column_stack([numbers, table, np.ones(len(table))])
    terms = np.ascontiguousarray(table[:, :3].astype(np.int64))
    sums = strains if strain is None else len(terms)
    derived = _inputs(inputs, vectors, derive)
    every = vectors + constants + len(derived)
    if (terms < 0).any() or (terms >= [sums, every, every]).any():
        raise ValueError(
            f"products must be of vectors 0 to {every - 1} in strains 0 to {sums - 1}, got "
            f"{terms.tolist()}"
        )
    if law is not None and parameters is None:
        raise ValueError("a law that is a function needs the number of its parameters, got none")
    both = np.asarray(pairs, dtype=np.int64).reshape(-1, 2)
    if (both < 0).any() or (both >= strains).any() or (law is not None and len(both)):
        raise ValueError(
            f"pairs must be of strains 0 to {strains - 1} in a quadratic law, got {both.tolist()}"
        )
    quadratic = strains + strains**2 + strains * len(both)
    count = quadratic if parameters is None or law is None else parameters
    coordinates, groups = _coordinates(node_types)
    cells = Cells(
        types=np.array([int(each) for each in node_types], dtype=np.int64),
        coordinates=coordinates,
        starts=np.ascontiguousarray(12 * coordinates[:, 0] + 3 * coordinates[:, 1]),
        groups=groups,
        terms=terms,
        factors=np.ascontiguousarray(table[:, 3]),
        inputs=derived,
        points=points,
        vectors=vectors,
        curved=_curved(terms[:, 1:], derived, vectors, every),
        strains=strains,
        parameters=count,
        offsets=vectors if offsets else 0,
        constants=constants,
        viscosities=strains**2 if viscous else 0,
        pairs=np.ascontiguousarray(both),
    )
    # unused tuples of hundreds of numbers would be compiled, too
    like = (
        (0.0,) * (0 if strain is None else len(terms)),
        (0.0,) * (0 if law is None else strains),
        (0.0,) * (0 if law is None else count),
        (0.0,) * (3 * derived.shape[1]),
    )
    turning = 1 if any(kind <= NodeType.POSITION_GRADIENT for kind in node_types) else None
    return Element(cells, strain, law, derive, like, turning)


def _inputs(
    inputs: Sequence[Sequence[int]], vectors: int, derive: CompiledFunction | None
) -> Indices:
    """Inputs of derived vectors as an array, shape (d, i), checked."""
    found = np.array([*inputs] or np.empty((0, 0)), dtype=np.int64)
    if (derive is None) != (len(found) == 0) or (found < 0).any() or (found >= vectors).any():
        function = "no function" if derive is None else "a function"
        raise ValueError(
            "derived vectors must have a function and, as its inputs, linear vectors 0 to "
            f"{vectors - 1}, got {function} and {found.tolist()}"
        )
    return found


def _curved(pairs: Indices, inputs: Indices, vectors: int, every: int) -> int:
    """Number of linear vectors, the first ones, in second derivatives of derived vectors."""
    first = every - len(inputs)
    coupled = pairs[(pairs >= first).any(axis=1)]
    touched = [*inputs.ravel(), *coupled[coupled < vectors]]
    return 1 + int(max(touched, default=-1))


def _coordinates(node_types: Sequence[NodeType]) -> tuple[Indices, Indices]:
    """Coordinate vectors and groups of unknowns of a cell's nodes."""
    rows: list[tuple[int, int, int, int]] = []
    groups: list[int] = []
    for node, kind in enumerate(node_types):
        for number, row in enumerate(TRAITS[kind].rows):
            first = 6 * node + 3 * min(number, 1)
            if first not in groups:
                groups.append(first)
            rows.append((node, row, groups.index(first), row if kind == NodeType.FRAME else 0))
    return np.array(rows, dtype=np.int64), np.array(groups, dtype=np.int64)


def cell_data(
    of: Element,
    tables: Array,
    parameters: Array,
    *,
    offsets: Array | None = None,
    constants: Array | None = None,
    viscosity: Array | None = None,
) -> Array:
    """Data of cells for the functions of an element, with zero stress.

    Args:
        of: The element.
        tables: ``T`` of each point, shape (m, points, vectors, r), for the ``r`` coordinate vectors
            of one node after the other.
        parameters: Parameters of the law, shape (m, points, parameters).
        offsets: ``z₀``, shape (m, points, vectors, 3), if linear vectors have a constant part.
        constants: Constant vectors, shape (m, points, constants, 3), if there are any.
        viscosity: ``η``, shape (m, points, strains, strains), if the element is viscous.

    Returns:
        Shape (m, any).

    Raises:
        ValueError: An array has another shape, is missing or is superfluous.
    """
    cells, m = of.cells, len(tables)
    p, v, e = cells.points, cells.vectors, cells.strains
    parts = [np.zeros((m, p * (e + len(cells.pairs))))]
    for what, given, needed, shape in (
        ("viscosity", viscosity, cells.viscosities > 0, (m, p, e, e)),
        ("parameters", parameters, True, (m, p, cells.parameters)),
        ("constants", constants, cells.constants > 0, (m, p, cells.constants, 3)),
        ("offsets", offsets, cells.offsets > 0, (m, p, v, 3)),
        ("tables", tables, True, (m, p, v, len(cells.coordinates))),
    ):
        if (given is None) == needed or (given is not None and given.shape != shape):
            expected = f"of shape {shape}" if needed else "none"
            found = "none" if given is None else f"shape {given.shape}"
            raise ValueError(f"{what} of cells must be {expected}, got {found}")
        if given is not None:
            parts.insert(0, given.reshape(m, math.prod(shape[1:])))
    return np.hstack(parts)


def data_at_rest(of: Element, tables: Array, vectors: Array, C: Array) -> Array:
    """Data of cells with a quadratic law whose energy vanishes at given vectors.

    Args:
        of: Element whose strains are sums of products of linear vectors.
        tables: ``T``, see :func:`cell_data`.
        vectors: Vectors of the unloaded cells, shape (m, points, vectors, 3).
        C: Moduli times quadrature weights, shape (m, points, strains, strains).
    """
    sums, first, second = of.cells.terms.T
    products = np.einsum("mptj,mptj->mpt", vectors[:, :, first], vectors[:, :, second])
    unloaded = np.zeros((*tables.shape[:2], of.cells.strains))
    np.add.at(unloaded.T, sums, (of.cells.factors * products).T)
    moduli = C.reshape(*C.shape[:2], -1)
    return cell_data(of, tables, np.concatenate([unloaded, moduli], axis=2))


PACKED_SIGNATURE = types.void(double_pointer, double_pointer, double_pointer, double_pointer)
"""Signature of functions of elements with packed constants.

Arguments are the result to add to, the data of a cell, the constants, and twists or increments of
its nodes.
"""

_HEAD = 15
"""Number of sizes before the arrays."""


def packed(cells: Cells) -> Array:
    """Constants as an array of doubles for :func:`unpacked`; integers keep their bits."""
    sizes = [len(cells.types), len(cells.coordinates), len(cells.groups), len(cells.terms)]
    sizes += [*cells.inputs.shape, *(each for each in cells if isinstance(each, int))]
    sizes.append(len(cells.pairs))
    arrays = [cells.types, cells.coordinates, cells.starts, cells.groups, cells.terms]
    arrays += [cells.inputs, cells.pairs]
    integers = np.concatenate([np.array(sizes), *(each.ravel() for each in arrays)])
    return np.concatenate([integers.astype(np.int64).view(np.float64), cells.factors])


@inlined
def unpacked(c: Pointer) -> Cells:
    """Constants of an element at the address ``c``."""
    head = vector_at(c, _HEAD).view(np.int64)
    k, r, u, t, d, i = head[0], head[1], head[2], head[3], head[4], head[5]
    size = k + 5 * r + u + 3 * t + d * i + 2 * head[14]
    rest = vector_at(shift(c, _HEAD), size).view(np.int64)
    at = k + 5 * r + u
    return Cells(
        rest[:k],
        rest[k : k + 4 * r].reshape((r, 4)),
        rest[k + 4 * r : k + 5 * r],
        rest[k + 5 * r : at],
        rest[at : at + 3 * t].reshape((t, 3)),
        vector_at(shift(c, _HEAD + size), t),
        rest[at + 3 * t : at + 3 * t + d * i].reshape((d, i)),
        head[6],
        head[7],
        head[8],
        head[9],
        head[10],
        head[11],
        head[12],
        head[13],
        rest[at + 3 * t + d * i :].reshape((head[14], 2)),
    )
