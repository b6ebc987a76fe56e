"""Elements of vectors, strains and a law on nodes of all types, and bodies of their cells."""

import math

import numpy as np

import fem_lie as fl
from fem_lie import lie
from fem_lie.extend import (
    CELL_SIGNATURE,
    CellFunctions,
    NodeType,
    callback,
    cell,
    cell_data,
    compiled,
    element,
    tuples,
)


@compiled
def function_of_products(products, parameters):
    a, b, c, d = products
    return math.sqrt(a) - 1.0, math.atan(b / a) + 0.1 * parameters[1] * c * d


@compiled
def stiffening(strains, parameters):
    first, second = strains
    return parameters[0] * (math.exp(first) - first) + 0.5 * parameters[1] * second * second


SMOOTH = element(
    [NodeType.FRAME, NodeType.POSITION_GRADIENT, NodeType.POSITION],
    [(0, 0), (0, 1), (1, 2), (2, 2)],
    vectors=3,
    strains=2,
    points=2,
    parameters=2,
    strain=function_of_products,
    law=stiffening,
    viscous=True,
)


@compiled
def unit_normal(slopes):
    m = tuples.cross(slopes[:3], slopes[3:])
    return tuples.scaled(1.0 / math.sqrt(tuples.dot(m, m)), m)


NORMALS = element(
    [NodeType.FRAME, NodeType.POSITION_GRADIENT, NodeType.POSITION],
    [(0, 0), (2, 3), (3, 4), (1, 4)],
    vectors=3,
    strains=2,
    points=2,
    parameters=2,
    strain=function_of_products,
    law=stiffening,
    derive=unit_normal,
    inputs=[(0, 1), (1, 2)],
    viscous=True,
)
SUMS = element(
    [NodeType.SURFACE_GRADIENT, NodeType.MIXED_DERIVATIVE, NodeType.MODAL, NodeType.POSITION],
    [(0, 0, 0, 0.5), (1, 0, 1, 1.0), (1, 1, 1, -0.3), (2, 2, 2, 1.0)],
    vectors=3,
    strains=3,
    points=2,
    viscous=True,
)


@callback(CELL_SIGNATURE)
def smooth_energy(A, w, h):
    cell.add_energy(SMOOTH, A, w)


@callback(CELL_SIGNATURE)
def smooth_forces(A, w, h):
    cell.add_forces(SMOOTH, A, w)


@callback(CELL_SIGNATURE)
def smooth_tangent(A, w, h):
    cell.add_tangent_at_stress(SMOOTH, A, w)


@callback(CELL_SIGNATURE)
def smooth_stress(A, w, h):
    cell.update_stress(SMOOTH, A, w, h)


@callback(CELL_SIGNATURE)
def smooth_viscous(A, w, h):
    cell.add_viscous_forces(SMOOTH, A, w, h)


@callback(CELL_SIGNATURE)
def smooth_viscous_tangent(A, w, h):
    cell.add_viscous_tangent(SMOOTH, A, w)


@callback(CELL_SIGNATURE)
def sums_energy(A, w, h):
    cell.add_energy(SUMS, A, w)


@callback(CELL_SIGNATURE)
def sums_forces(A, w, h):
    cell.add_forces(SUMS, A, w)


@callback(CELL_SIGNATURE)
def sums_tangent(A, w, h):
    cell.add_tangent_at_stress(SUMS, A, w)


@callback(CELL_SIGNATURE)
def sums_stress(A, w, h):
    cell.update_stress(SUMS, A, w, h)


@callback(CELL_SIGNATURE)
def sums_viscous(A, w, h):
    cell.add_viscous_forces(SUMS, A, w, h)


@callback(CELL_SIGNATURE)
def sums_viscous_tangent(A, w, h):
    cell.add_viscous_tangent(SUMS, A, w)


@callback(CELL_SIGNATURE)
def normals_energy(A, w, h):
    cell.add_energy(NORMALS, A, w)


@callback(CELL_SIGNATURE)
def normals_forces(A, w, h):
    cell.add_forces(NORMALS, A, w)


@callback(CELL_SIGNATURE)
def normals_tangent(A, w, h):
    cell.add_tangent_at_stress(NORMALS, A, w)


@callback(CELL_SIGNATURE)
def normals_stress(A, w, h):
    cell.update_stress(NORMALS, A, w, h)


@callback(CELL_SIGNATURE)
def normals_viscous(A, w, h):
    cell.add_viscous_forces(NORMALS, A, w, h)


@callback(CELL_SIGNATURE)
def normals_viscous_tangent(A, w, h):
    cell.add_viscous_tangent(NORMALS, A, w)


ELEMENTS = {
    "derived vectors": (
        NORMALS,
        CellFunctions(
            normals_energy,
            normals_forces,
            normals_tangent,
            normals_stress,
            normals_viscous,
            normals_viscous_tangent,
        ),
    ),
    "function of products, with a law": (
        SMOOTH,
        CellFunctions(
            smooth_energy,
            smooth_forces,
            smooth_tangent,
            smooth_stress,
            smooth_viscous,
            smooth_viscous_tangent,
        ),
    ),
    "sums of products": (
        SUMS,
        CellFunctions(
            sums_energy,
            sums_forces,
            sums_tangent,
            sums_stress,
            sums_viscous,
            sums_viscous_tangent,
        ),
    ),
}


def random_body(name, count=3):
    """Cells of a chain of nodes, some of which they share, with vectors without translation."""
    of, functions = ELEMENTS[name]
    kinds, rng = [NodeType(kind) for kind in of.cells.types], np.random.default_rng(1)
    k, active = len(kinds), [fl.extend.node_types.TRAITS[kind].rows for kind in kinds]
    # successive cells share a node of position
    types = [*kinds * count, kinds[0]] if name == "sums of products" else kinds * count
    cells = k * np.arange(count)[:, np.newaxis] + np.arange(k)
    rows = np.tile(np.vstack([np.zeros(3), np.eye(3)]), (len(types), 1, 1))
    rows[:, 1:] = lie.so3_exp(rng.normal(size=(len(types), 3))).swapaxes(1, 2)
    rows[:, 0] = np.arange(len(types))[:, np.newaxis] + 0.2 * rng.normal(size=(len(types), 3))
    if name == "sums of products":
        cells[:, -1] = cells[:, 0] + k - 1
    owners = [(kind, row) for kind, own in zip(kinds, active, strict=True) for row in own]
    positions = np.array([row == 0 for _, row in owners])
    tables = rng.normal(size=(count, of.cells.points, 3, len(positions)))
    tables[..., positions] -= tables[..., positions].mean(axis=-1, keepdims=True)
    amplitudes = np.array([kind == NodeType.MODAL for kind, _ in owners])
    if amplitudes.any():
        # numbers that do not turn stand in the last vector alone
        tables[..., :2, amplitudes] = tables[..., 2:, ~amplitudes] = 0.0
    shape, n = (count, of.cells.points), of.cells.strains
    root = rng.normal(size=(*shape, n, n))
    C = root @ root.swapaxes(-1, -2)
    law = np.concatenate([0.1 * rng.normal(size=(*shape, n)), C.reshape(*shape, -1)], axis=-1)
    parameters = law if of.law is None else rng.uniform(1, 2, (*shape, of.cells.parameters))
    data = cell_data(of, tables, parameters, viscosity=C)
    inertia = np.zeros((count, k, 4, k, 4))
    for node, own in enumerate(active):
        inertia[:, node, own, node, own] = 0.5
    return fl.extend.ElementBody(
        rows, types, cells, element=of, functions=functions, data=data, inertia=inertia
    )
