"""What is reported of a tree at the end of a step: errors, accelerations, multipliers; compiled."""

from __future__ import annotations

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, linked, uncounted
from fem_lie._jit.copies import copy_vector
from fem_lie._jit.stack import matrix_at, stack, vector_at
from fem_lie.joints.equations import one_pair
from fem_lie.joints.equations.joint_arrays import JointArrays, joint_arrays
from fem_lie.joints.equations.relative_motion import force
from fem_lie.lie.tuples import dot, load, load_frame, plus, rotate_back, store
from fem_lie.solve.trees.elimination import wrench
from fem_lie.solve.trees.steps import STAGES, Run, move_nodes, run_of, twist_of


@linked
def errors(table: Indices, h: float, out: Array) -> None:
    """Estimated errors of the nodes at the last stage, local components, (n, 6)."""
    this, part = run_of(table), vector_at(stack(6), 6)
    links, now, slopes, moved = this.links, this.now, this.slopes, this.now.coriolis
    for k in range(this.angle.shape[0]):
        this.angle[k] = h / 6.0 * (slopes[STAGES - 1, 0, k] - slopes[STAGES, 0, k])
    for i in range(links.parent.shape[0]):
        u, ω = twist_of(links, this.angle, i)
        for k in range(6):
            moved[i, k] = 0.0
        if links.parent[i] >= 0:
            lie.apply_adjoint_inverse(now.X[i], moved[links.parent[i]], moved[i])
        store(moved[i], 0, plus(load(moved[i], 0), u))
        store(moved[i], 3, plus(load(moved[i], 3), ω))
    for node in range(this.link.shape[0]):
        lie.apply_adjoint_inverse(this.own[node], moved[this.link[node]], part)
        for k in range(6):
            out[node, k] = part[k]


@linked
def observe(table: Indices, multipliers: Array) -> None:
    """Frames, twists and their rates of all nodes after :func:`solve`, and multipliers (m,)."""
    this = run_of(table)
    move_nodes(this)
    g, part = load(this.links.gravity, 0), vector_at(stack(6), 6)
    for node in range(this.link.shape[0]):
        i = this.link[node]
        lie.apply_adjoint_inverse(this.own[node], this.now.a[i], part)
        _, d1, d2, d3 = load_frame(this.H[node])
        store(this.a[node], 0, plus(load(part, 0), rotate_back(d1, d2, d3, g)))
        store(this.a[node], 3, load(part, 3))
    _find_multipliers(this, joint_arrays(this.joints), multipliers)


@uncounted
def _find_multipliers(this: Run, arrays: JointArrays, out: Array) -> None:
    """Lagrange multipliers from the forces of the joints on their links."""
    work = vector_at(stack(one_pair.WORKSPACE), one_pair.WORKSPACE)
    A, B, z, p, f, _, sides, total = one_pair.workspace(work)
    m, columns, M = len(arrays.targets), matrix_at(stack(36), 6, 6), matrix_at(stack(42), 6, 7)
    for j in range(this.pairs.shape[0]):
        pair, link, side = this.pairs[j], this.wrenches[j, 0], this.wrenches[j, 1]
        one_pair.locate(this.H, arrays, pair, A, B, z, f)
        force_on, moment_on = wrench(this.now, link)
        store(total, 0, force_on)
        store(total, 3, moment_on)
        count = 0
        for t in range(arrays.first[pair], arrays.first[pair + 1]):
            if arrays.rows[t] < m:
                one_pair.gradient(arrays, pair, t, z, p)
                force(z, p, sides[0], sides[1])
                copy_vector(sides[side], columns[count])
                count += 1
        for i in range(count):
            for k in range(count):
                M[i, k] = _dot_six(columns[i], columns[k])
            M[i, 6] = -_dot_six(columns[i], total)
        _eliminate(M, count)
        count = 0
        for t in range(arrays.first[pair], arrays.first[pair + 1]):
            if arrays.rows[t] < m:
                out[arrays.rows[t]] = M[count, 6]
                count += 1


@inlined
def _dot_six(a: Array, b: Array) -> float:
    """Product of two six-vectors."""
    return dot(load(a, 0), load(b, 0)) + dot(load(a, 3), load(b, 3))


@uncounted
def _eliminate(M: Array, count: int) -> None:
    """Solve with the positive definite ``M`` (count, count) for its last column."""
    for k in range(count):
        for i in range(count):
            if i != k:
                factor = M[i, k] / M[k, k]
                for c in range(k, count):
                    M[i, c] -= factor * M[k, c]
                M[i, 6] -= factor * M[k, 6]
    for k in range(count):
        M[k, 6] /= M[k, k]
