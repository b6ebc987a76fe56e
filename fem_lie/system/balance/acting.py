"""What acts on a scene at one time: loads, damping, reactions of ground, drives and supports."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie.lie.kinds.inertia import Inertia
from fem_lie.system import outer_forces
from fem_lie.system.balance.held_forces import HeldForces
from fem_lie.system.outer_forces import LOADS, LOSS, POWER, REACTIONS, PlainScene, add_local
from fem_lie.system.system import System


def supported(system: System) -> Flags:
    """Which unknowns are held from outside, shape (n, 6).

    What a shell of five parameters needs to have its drilling held is none: it is no support. Nor
    are unknowns that a node has not.
    """
    held = system.held & ~system.numbering.absent
    inner = system.uncoupled.copy()
    inner[[system.numbering.node(clamp.point) for clamp in system.scene.clamps]] = False
    held[inner, 5] = False
    return held


class Acting:
    """What acts on the bodies of a scene, looked at as a whole; true if there is anything.

    Attributes:
        strained: Whether strains without stress change.
        plain: Whether all is seen by :func:`~fem_lie.system.outer_forces.look`.
        plain_but_held: Whether all but what holds nodes is.
        looks: Whether that looks at loads, and whether at joints.
        scene: What it looks at.
    """

    def __init__(self, system: System) -> None:
        """See what there is."""
        self._system, held = system, supported(system)
        self._held = HeldForces(system, held) if held.any() else None
        self.strained = system.load_cases.strains_change
        connections = system.connections
        self._loaded, rates = system.load_cases.any_nodal, system.terms.rates
        joined = connections.outward
        self._others = joined and not connections.of_joints_only
        self._pushed = len(system.terms.loads) > 0
        # of damping by a constant matrix and of dampers compiled looks know
        self._viscous = system.terms.chosen(
            lambda term: term.viscosity is None or term.viscosity.rates is None
        )
        apart = self._pushed or self._viscous.viscous
        self._grounded = [term.ground for term in system.terms if term.ground is not None]
        apart = apart or bool(self._grounded)
        moved = self._others or apart or self.strained
        special = moved or self._held is not None
        self._any = special or self._loaded or joined or rates is not None or connections.driven
        self.plain, self.plain_but_held = self._any and not special, not moved
        damping = Inertia.none().plain if rates is None else rates
        self.looks = self._loaded, joined and not self._others
        constant = system.load_cases.constant, damping, connections.packed, system.floating.plain
        loads = system.lasting_loads.plain
        self.scene: PlainScene = (system.kinds, loads, *constant, *self.looks)

    def __bool__(self) -> bool:
        """Whether anything acts."""
        return self._any

    @property
    def arrays(self) -> list[Any]:
        """Those of :attr:`scene`, one after the other."""
        kinds, loads, conservative, damping, joints, bodies, *_ = self.scene
        return [kinds, *loads, conservative, *damping, *joints, *bodies]

    def look(
        self, H: Array, v: Array, a: Array, weights: Array, row: Array, wrenches: Array
    ) -> None:
        """See what acts at the present time of the equations.

        Args:
            H: Frames of all rows.
            v: Twists, shape (n, 6).
            a: Their rates.
            weights: Multipliers, shape (m,).
            row: Power, loss and forces, see :mod:`fem_lie.system.outer_forces`, shape (14,),
                overwritten.
            wrenches: What ground and prescribed frames do, in these frames, shape (p + 1, 6),
                overwritten.
        """
        system, n = self._system, self._system.count
        outer_forces.look(H, v, weights, self.scene, row, wrenches)
        if self._pushed:
            forces = system.terms.of_loads(H)
            add_local(system.kinds, H, forces, LOADS, 1.0, row)
            row[POWER] += np.sum(forces * v)
        if self._viscous.viscous:
            forces = np.zeros(6 * n)
            self._viscous.add_viscous_forces(H, v, forces)
            row[LOSS] += forces @ v.ravel()
        for term in self._grounded:
            forces = np.zeros((n, 6))
            term.add_of_ground(H, v, forces)
            add_local(system.kinds, H, forces, REACTIONS, -1.0, row)
        if self._others:
            wrenches[:], loss = system.connections.reactions(H, v, weights)
            row[LOSS] += loss
            fixed = np.zeros(len(wrenches), dtype=np.int64)  # frames, all of them
            add_local(fixed, H[n:], wrenches, REACTIONS, 1.0, row)
        if self._held is not None:
            nodes, forces = self._held.nodes, self._held.find(H, v, a, weights)
            add_local(system.kinds[nodes], H[nodes], forces, REACTIONS, 1.0, row)
