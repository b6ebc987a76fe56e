"""Which factorisation is the fastest for a scene."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from petsc4py import PETSc

from fem_lie.lie.kinds import SURFACE
from fem_lie.linear.condensed.elimination import plan_of
from fem_lie.linear.domains.interface import WAYS
from fem_lie.linear.packages import (
    CHAINS,
    INDEFINITE,
    LATTICES,
    MOTION,
    SURFACES,
    SYMMETRIC,
    THREADS,
    Domains,
)
from fem_lie.ranks.together import several

if TYPE_CHECKING:
    from fem_lie.linear.bordered import KKT
    from fem_lie.linear.packages import Method
    from fem_lie.system.equations import Equations

LARGE = 20000
"""Nodes of a scene whose chains are eliminated before a library has the rest."""


_DOMAINS = "domains"


def on_domains(prefix: str) -> tuple[Method, ...]:
    """Subdomains, one on each rank, if PETSc's option ``-<prefix>domains`` asks for them.

    Raises:
        ValueError: There is no such way, or one rank alone.
    """
    options = PETSc.Options(prefix)
    if not options.hasName(_DOMAINS):
        return ()
    way = options.getString(_DOMAINS)
    if way not in WAYS:
        raise ValueError(f"-{prefix}domains: wanted {' or '.join(WAYS)}, got {way!r}")
    if not several():
        raise ValueError(
            f"-{prefix}domains {way}: each rank has one subdomain, so several ranks are wanted, "
            "got one: mpirun -n N"
        )
    return (Domains(way, way),)


def methods_in_time(equations: Equations) -> tuple[Method, ...]:
    """What is fastest for the equations of motion of a scene, whose matrix is not symmetric."""
    kkt, shells = equations.matrix, bool(equations.unknowns.uncoupled.any())
    if shells:
        return MOTION
    if len(kkt.indptr) > LARGE and 2 * len(plan_of(kkt).order) > len(kkt.indptr):
        return THREADS
    return LATTICES if meshed(kkt) else CHAINS


def meshed(kkt: KKT) -> bool:
    """Whether nodes are left when all with at most two neighbours are eliminated one by one.

    Of chains, trees and single loops none is left, of a truss or a net its knots.
    """
    ends, columns = kkt.indptr.tolist(), kkt.indices.tolist()
    near = [set(columns[a:b]) - {i} for i, (a, b) in enumerate(pairwise(ends))]
    due = [i for i, others in enumerate(near) if len(others) <= 2]
    gone = set[int]()
    while due:
        i = due.pop()
        if i in gone:
            continue
        gone.add(i)
        for j in near[i]:
            near[j] = (near[j] | near[i]) - {i, j}
            if len(near[j]) <= 2:
                due.append(j)
    return len(gone) < len(near)


def methods_for(equations: Equations) -> tuple[Method, ...]:
    """What is fastest for the static equations of a scene."""
    unknowns = equations.unknowns
    thin = bool((unknowns.kinds == SURFACE).any())  # shells whose nodes are no frames
    if not thin and not unknowns.uncoupled.any():
        return CHAINS
    if not equations.unknowns.symmetric:
        return SURFACES
    return SYMMETRIC if equations.unknowns.m == 0 else INDEFINITE


def methods_on_paths(equations: Equations) -> tuple[Method, ...]:
    """Those whose factors tell the number of negative pivots, where the matrix is symmetric."""
    return INDEFINITE if equations.unknowns.symmetric else methods_for(equations)
