"""Sums of forces at different places, with moments about the origin, in compiled code."""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.lie.tuples import Vector, cross, load, load_row, plus, store


@inlined
def add_wrench(out: Array, at: int, x: Vector, force: Vector, moment: Vector) -> None:
    """Add a force at ``x`` and a moment, global components, to six numbers of ``out``."""
    store(out, at, plus(load(out, at), force))
    store(out, at + 3, plus(load(out, at + 3), plus(moment, cross(x, force))))


@inlined
def add_dead(out: Array, at: int, sign: float, H: Array, f: Array) -> None:
    """Add ``sign f``, forces on the rows (x, d₁, d₂, d₃) of ``H``, likewise."""
    for k in range(4):
        arm = cross(load_row(H, k), load_row(f, k))
        for j in range(3):
            if k == 0:
                out[at + j] += sign * f[k, j]
            out[at + 3 + j] += sign * arm[j]
