"""What an element is for the small-energy kernel: nodes, vectors, strains, a law, constants.

Constants of elements whose numbers of nodes and points are known at run time, for their kernels.

Functions of such an element get the constants with each call, behind the data of the cell, as the
constants of a form. They are compiled once for all sizes.
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
"""Of the functions of an element: what they add to, the data of a cell, and twists or increments of
its nodes. Callers may pass more arguments, which are ignored."""

CompiledFunction: TypeAlias = Any
"""A function made with :func:`fem_lie.compiled`."""


class Cells(NamedTuple):
    """Constants of an element for compiled code.

    Vectors are numbered linear ones first, then constant ones, then derived ones.

    Attributes:
        types: Type of each node of a cell, shape (k,).
        coordinates: Of each coordinate vector: its node, its number there, its group of unknowns,
            and 1 to 3 for directors of frames, zero else, shape (r, 4).
        starts: First of each among the 12 k numbers of all nodes, shape (r,).
        groups: First unknown of each group of three among the 6 k of all nodes, shape (u,).
        terms: Strain and both vectors of each product, shape (t, 3); where strains are a function
            of products, the number of the product instead of the strain.
        factors: Of each product, shape (t,).
        inputs: Linear vectors that each derived vector is a function of, shape (d, i).
        points: Points of integration.
        vectors: Linear vectors at each point.
        curved: How many of these, the first ones, derived vectors depend on or are multiplied by.
        strains: At each point.
        parameters: Numbers of the law at each point.
        offsets: Linear vectors with a constant part at each point: all or none.
        constants: Constant vectors at each point.
        viscosities: Numbers of the viscosity at each point.
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


class Element(NamedTuple):
    """An element: constants and functions. :func:`element` makes one.

    Attributes:
        cells: Constants.
        strain: Strains as a function of products, or ``None`` for sums of products.
        law: Energy as a function of strains, or ``None`` for a quadratic law.
        derive: Derived vector as a function of others, or ``None``.
        like: Tuples as long as those of products, strains, parameters and components of inputs of
            a derived vector, as far as functions take these.
        turning: 1 if axes of nodes turn with their unknowns, else ``None``, which spares their
            compilation.
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
) -> Element:
    """An element for :mod:`fem_lie.forms.small_energy.cell`.

    Args:
        node_types: Of the nodes of a cell.
        products: Both vectors of each scalar product, shape (t, 2), where ``strain`` is a function
            of them; else strain, both vectors and factor of each, shape (t, 4): strains are sums.
        vectors: Number of linear vectors at each point; constant and derived ones follow them.
        strains: Number of strains at each point.
        points: Points of integration of a cell.
        parameters: Numbers of ``law`` at each point.
        strain: Compiled function of the tuples of products and parameters, which returns the tuple
            of strains. With a quadratic law the second tuple is empty.
        law: Compiled function of the tuples of strains and parameters, which returns the energy at
            a point. Default: ``½ (e − e₀)·C (e − e₀)``, whose parameters are ``e₀`` and ``C``.
        derive: Compiled function of the tuple of components of linear vectors, which returns the
            three components of a derived vector, such as a unit normal of two slopes.
        inputs: Linear vectors that each derived vector is this function of.
        constants: Number of constant vectors at each point.
        offsets: Whether linear vectors have a constant part.
        viscous: Whether there is a stress ``η ė`` (Kelvin and Voigt).

    Raises:
        ValueError: Products are of other vectors or strains than there are, or have another shape;
            derived vectors are of other vectors than linear ones, or without a function; a law
            that is a function has no number of parameters.
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
    count = strains + strains**2 if parameters is None or law is None else parameters
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
    )
    # tuples of hundreds of numbers that nobody takes would be compiled, too
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
    """Those of derived vectors, shape (d, i), after a check."""
    found = np.array([*inputs] or np.empty((0, 0)), dtype=np.int64)
    if (derive is None) != (len(found) == 0) or (found < 0).any() or (found >= vectors).any():
        function = "no function" if derive is None else "a function"
        raise ValueError(
            "derived vectors must have a function and, as its inputs, linear vectors 0 to "
            f"{vectors - 1}, got {function} and {found.tolist()}"
        )
    return found


def _curved(pairs: Indices, inputs: Indices, vectors: int, every: int) -> int:
    """How many linear vectors, the first ones, second derivatives of derived ones are of."""
    first = every - len(inputs)
    beside = pairs[(pairs >= first).any(axis=1)]
    touched = [*inputs.ravel(), *beside[beside < vectors]]
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
    """Data of cells as the functions of an element read them, with zero stress.

    Args:
        of: The element.
        tables: ``T`` of each point, shape (m, points, vectors, r), of the ``r`` coordinate vectors
            of one node after the other.
        parameters: Of the law, shape (m, points, parameters).
        offsets: ``z₀``, shape (m, points, vectors, 3), if linear vectors have a constant part.
        constants: Constant vectors, shape (m, points, constants, 3), if there are any.
        viscosity: ``η``, shape (m, points, strains, strains), if the element is viscous.

    Returns:
        Shape (m, any).

    Raises:
        ValueError: One has another shape, or is missing or superfluous.
    """
    cells, m = of.cells, len(tables)
    p, v, e = cells.points, cells.vectors, cells.strains
    parts = [np.zeros((m, p * e))]
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
    """Data of cells with a quadratic law whose energy is zero at given vectors.

    Args:
        of: An element whose strains are sums of products of linear vectors.
        tables: ``T``, see :func:`cell_data`.
        vectors: Those of the unloaded cells, shape (m, points, vectors, 3).
        C: Moduli with the weights of the points, shape (m, points, strains, strains).
    """
    sums, first, second = of.cells.terms.T
    products = np.einsum("mptj,mptj->mpt", vectors[:, :, first], vectors[:, :, second])
    unloaded = np.zeros((*tables.shape[:2], of.cells.strains))
    np.add.at(unloaded.T, sums, (of.cells.factors * products).T)
    moduli = C.reshape(*C.shape[:2], -1)
    return cell_data(of, tables, np.concatenate([unloaded, moduli], axis=2))


PACKED_SIGNATURE = types.void(double_pointer, double_pointer, double_pointer, double_pointer)
"""Of their functions: what they add to, the data of a cell, the constants, and twists or increments
of its nodes."""

_HEAD = 14
"""Numbers before the arrays."""


def packed(cells: Cells) -> Array:
    """Constants as :func:`unpacked` reads them; integers keep their bits."""
    sizes = [len(cells.types), len(cells.coordinates), len(cells.groups), len(cells.terms)]
    sizes += [*cells.inputs.shape, *(each for each in cells if isinstance(each, int))]
    arrays = cells.types, cells.coordinates, cells.starts, cells.groups, cells.terms, cells.inputs
    integers = np.concatenate([np.array(sizes), *(each.ravel() for each in arrays)])
    return np.concatenate([integers.astype(np.int64).view(np.float64), cells.factors])


@inlined
def unpacked(c: Pointer) -> Cells:
    """Constants at ``c``."""
    head = vector_at(c, _HEAD).view(np.int64)
    k, r, u, t, d, i = head[0], head[1], head[2], head[3], head[4], head[5]
    size = k + 5 * r + u + 3 * t + d * i
    rest = vector_at(shift(c, _HEAD), size).view(np.int64)
    at = k + 5 * r + u
    return Cells(
        rest[:k],
        rest[k : k + 4 * r].reshape((r, 4)),
        rest[k + 4 * r : k + 5 * r],
        rest[k + 5 * r : at],
        rest[at : at + 3 * t].reshape((t, 3)),
        vector_at(shift(c, _HEAD + size), t),
        rest[at + 3 * t : size].reshape((d, i)),
        head[6],
        head[7],
        head[8],
        head[9],
        head[10],
        head[11],
        head[12],
        head[13],
    )
