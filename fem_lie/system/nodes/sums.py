"""Compiled sums over the nodes of a scene: inertia, loads, and blocks of the matrix."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked, uncounted
from fem_lie._jit.packed_arrays import Integers1, Integers2, Numbers2, Numbers3, Numbers4, unpacking
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.cell_forms import add_forces
from fem_lie.forms.kernels.addresses import pointer
from fem_lie.joints.equations import terms
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays
from fem_lie.lie.node_types import (
    floating,
    inertia,
    pull_all_back,
    pull_back_derivative,
    push_all_forward,
    to_global_components,
)
from fem_lie.lie.node_types.floating import PlainFloating
from fem_lie.lie.node_types.inertia import PlainInertia, PlainMotion
from fem_lie.system.nodes.masses import PlainLoads
from fem_lie.system.nodes.numbering import expand

PlainAttached: TypeAlias = tuple[Integers1, Numbers3, Numbers3, Numbers2, Integers2, Integers1]
"""Master node and offset of each node of some cells, workspace for their frames and forces, and the
table of the cells, see :class:`~fem_lie.forms.cell_forms.FormArrays`.
"""


@inlined
def add_moments(H: Array, moment: Array, following: Array, r: Array) -> None:
    """Subtract the loads of a node from ``r``: a global moment (3,), local loads (6,)."""
    for a in range(3):
        for j in range(3):
            r[3 + a] -= H[1 + a, j] * moment[j]
        r[a] -= following[a]
        r[3 + a] -= following[3 + a]


@uncounted
def _add_moments(H: Array, moment: Array, following: Array, r: Array) -> None:
    """``add_moments`` of all nodes, (n, 3) and (n, 6); ``r`` (6 n,)."""
    for i in range(moment.shape[0]):
        add_moments(H[i], moment[i], following[i], r[6 * i : 6 * i + 6])


@compiled
def _add_moment_stiffness(H: Array, moment: Array, diagonal: Indices, K: Array) -> None:
    """Subtract ``∂(local components of global moments)/∂h``, ``(Rᵀm)^``, from ``K``."""
    for i in range(moment.shape[0]):
        block = K[diagonal[i]]
        n0 = n1 = n2 = 0.0
        for j in range(3):
            n0 += H[i, 1, j] * moment[i, j]
            n1 += H[i, 2, j] * moment[i, j]
            n2 += H[i, 3, j] * moment[i, j]
        block[3, 4] += n2
        block[3, 5] -= n1
        block[4, 3] -= n2
        block[4, 5] += n0
        block[5, 3] += n1
        block[5, 4] -= n0


@compiled
def nodal_residual(
    kinds: Indices,
    motion: PlainMotion,
    mass: PlainInertia,
    bodies: PlainFloating,
    loads: PlainLoads,
    work: Array,
    r: Array,
) -> None:
    """``r = Lᵀ (G q̈ − dead) − loads``, with inertia of floating bodies; ``work`` (2, n, 4, 3).

    Records are plain tuples, which makes calls from Python faster.
    """
    _nodal_forces(kinds, motion, mass, loads, work, r)
    integers, numbers = bodies
    if integers[0] > 0:
        floating.add_forces(kinds, motion[0], motion[1], work[0], integers, numbers, work[1])
    _, moment, following = loads
    pull_all_back(kinds, motion[0], work[1], 1.0, r)
    _add_moments(motion[0], moment, following, r)


@uncounted
def _nodal_forces(
    kinds: Indices,
    motion: PlainMotion,
    mass: PlainInertia,
    loads: PlainLoads,
    work: Array,
    r: Array,
) -> None:
    """Set ``work[1] = G q̈ − dead``, and ``r`` to zero."""
    H, v, a = motion
    indptr, indices, blocks = mass
    dead, _, _ = loads
    count = dead.shape[0]
    r[:] = 0.0
    inertia.accelerations(kinds, H, v[:count], a[:count], work[0])
    inertia.multiply(indptr, indices, blocks, work[0], work[1])
    for i in range(count):
        for k in range(4):
            for j in range(3):
                work[1, i, k, j] -= dead[i, k, j]


@compiled
def add_joints(
    H: Array, v: Array, joints: PackedJoints, multipliers: Array, scale: Array, count: int, r: Array
) -> None:
    """Add ``Bᵀλ`` to ``r``, and set ``scale · Φ``; packed joints are faster to pass."""
    terms.evaluate(H, v, joint_arrays(joints), multipliers, scale, count, r)


@uncounted
def add_attached(H: Array, following: PlainAttached, r: Array) -> None:
    """Add forces of cells with rigidly attached nodes to those of the master nodes."""
    master, offset, frames, forces, rows, nodes = following
    moved = vector_at(stack(6), 6)
    expand(H, master, offset, frames)
    for i in range(master.shape[0]):
        for k in range(6):
            forces[i, k] = 0.0
    flat = vector_at(pointer(forces.ctypes.data), 6 * forces.shape[0])
    add_forces(frames, (rows, nodes), flat)
    for i in range(master.shape[0]):
        lie.apply_adjoint_inverse_transposed(offset[i], forces[i], moved)
        for k in range(6):
            r[6 * master[i] + k] += moved[k]


class _Forces(NamedTuple):
    """Constant arrays of :func:`residual`.

    Attributes:
        kinds: Types of the nodes, (n,).
        mass: Mass matrix.
        loads: Nodal loads.
        joints: Packed arrays of the joints.
        work: Workspace, (2, n, 4, 3).
        cells: Cells of master nodes, see :class:`~fem_lie.forms.cell_forms.FormArrays`.
        attached: Arrays of :func:`add_attached`.
        bodies: Floating bodies.
    """

    kinds: Integers1
    mass: PlainInertia
    loads: PlainLoads
    joints: PackedJoints
    work: Numbers4
    cells: tuple[Integers2, Integers1]
    attached: PlainAttached
    bodies: PlainFloating


_forces = unpacking(_Forces)


@linked
def residual(
    H: Array, v: Array, a: Array, multipliers: Array, scale: Array, r: Array, table: Indices
) -> None:
    """:func:`nodal_residual`, joints, and forces of elements in one sum.

    Args:
        H: Frames of all nodes, ground and prescribed motions.
        v: Twists, shape (≥ n, 6).
        a: Their rates.
        multipliers: Lagrange multipliers, shape (m,).
        scale: Scale factor of each constraint, shape (m,).
        r: Residual, shape (6 n + m,), overwritten.
        table: Constant arrays, see :class:`_Forces`.
    """
    this = _forces(table)
    nodal_residual(this.kinds, (H, v, a), this.mass, this.bodies, this.loads, this.work, r)
    terms.evaluate(H, v, joint_arrays(this.joints), multipliers, scale, this.work.shape[1], r)
    add_forces(H, this.cells, r)
    if this.attached[0].shape[0] > 0:
        add_attached(H, this.attached, r)


@compiled
def load_potential(H: Array, dead: Array) -> float:
    """Potential of gravity and of forces fixed in space, ``−Σ dead · q``."""
    energy = 0.0
    for i in range(dead.shape[0]):
        for j in range(3):
            for k in range(4):
                energy -= dead[i, k, j] * H[i, k, j]
    return energy


@compiled
def report_rates(
    kinds: Indices,
    H: Array,
    qdot: Array,
    mass: PlainInertia,
    bodies: PlainFloating,
    dead: Array,
    work: Array,
    invariants: Array,
) -> float:
    """Set kinetic energy and momenta (7,), and return the potential; ``work`` (1, n, 4, 3).

    ``qdot``: rates of (x, d₁, d₂, d₃), and of products of floating bodies if there are any, see
    :func:`~fem_lie.lie.node_types.floating.add_invariants`, (≥ n, 4, 3).
    """
    (indptr, indices, blocks), count = mass, dead.shape[0]
    rates = qdot[:count]
    values = inertia.invariants_of_rates(kinds, H, rates, indptr, indices, blocks, work[0])
    for k in range(7):
        invariants[k] = values[k]
    potential, (integers, numbers) = load_potential(H, dead), bodies
    if integers[0] > 0:
        potential += floating.add_invariants(H, qdot, count, integers, numbers, invariants)
    return potential


@compiled
def report(
    kinds: Indices,
    H: Array,
    v: Array,
    mass: PlainInertia,
    bodies: PlainFloating,
    dead: Array,
    work: Array,
    invariants: Array,
) -> float:
    """:func:`report_rates` at twists ``v``; ``work`` (2, n, 4, 3)."""
    push_all_forward(kinds, H, v, work[0])
    return report_rates(kinds, H, work[0], mass, bodies, dead, work[1:], invariants)


@compiled
def add_mass_damping(
    kinds: Indices, H: Array, v: Array, D: PlainInertia, work: Array, f: Array, r: Array
) -> None:
    """``f += D q̇``, ``r += Lᵀ D q̇`` with the block-sparse matrix ``D``; ``work`` (2, n, 4, 3)."""
    indptr, indices, blocks = D
    push_all_forward(kinds, H, v, work[0])
    inertia.multiply(indptr, indices, blocks, work[0], work[1])
    f += work[1]
    pull_all_back(kinds, H, work[1], 1.0, r)


@compiled
def load_tangent(
    kinds: Indices, H: Array, forces: Array, moment: Array, diagonal: Indices, K: Array
) -> None:
    """Add derivatives of :func:`nodal_residual`, except those in accelerations, to ``K``.

    Args:
        kinds: Types of the nodes.
        H: Frames.
        forces: ``G q̈ − dead`` of the residual, shape (n, 4, 3).
        moment: Global moments, shape (n, 3).
        diagonal: Positions of the diagonal in the pattern.
        K: Blocks, updated.
    """
    for i in range(moment.shape[0]):
        pull_back_derivative(kinds[i], H[i], forces[i], 1.0, K[diagonal[i]])
    _add_moment_stiffness(H, moment, diagonal, K)


@compiled
def load_vector(
    kinds: Indices, H: Array, dead: Array, moment: Array, following: Array, r: Array
) -> None:
    """``r = Lᵀ dead + loads`` on the moving nodes, shape (n, 6)."""
    r[:] = 0.0
    _add_moments(H, moment, following, r.reshape(-1))
    r *= -1.0
    pull_all_back(kinds, H, dead, 1.0, r.reshape(-1))


@compiled
def to_inertial(
    kinds: Indices,
    A: Array,
    columns: Array,
    rows: Array,
    H: Array,
    nodes: Indices,
    indptr: Indices,
    bind: Indices,
) -> None:
    """Transform blocks and the constraint Jacobian to global components at frames ``H``.

    Blocks become ``R_i A_ij R_jᵀ``, rows of the Jacobian ``b_j R_jᵀ``.
    """
    for i in range(indptr.shape[0] - 1):
        for b in range(indptr[i], indptr[i + 1]):
            j = bind[b]
            for n in range(6):
                to_global_components(kinds[i], H[i], A[b, :, n])
            for k in range(6):
                to_global_components(kinds[j], H[j], A[b, k])
    for incidence in range(rows.shape[0]):
        node = nodes[incidence]
        to_global_components(kinds[node], H[node], columns[incidence])
        to_global_components(kinds[node], H[node], rows[incidence])
