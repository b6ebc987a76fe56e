"""Forces of asynchronous steps that are in no cell of the queue, and nodes that move with them.

Contact, springs, pressure and loads in time act on nodes that share no cell. They are one more
element with a step of its own: evaluated together, at the positions of all nodes at one time, and
applied as impulses, half a step before and half a step after that time.

Nodes with rotations or gradients, and those with joints or damping, move together in such steps as
in the explicit scheme, and the cells around them have such steps, too.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._state import Stateful, attributes
from fem_lie.contact.contact import Contact
from fem_lie.forms.cell_forms import FormArrays, add_forces
from fem_lie.lie.node_types import POSITION
from fem_lie.solve.explicit import nodes
from fem_lie.solve.explicit.joints import Joints
from fem_lie.solve.explicit.stable import damping_rates
from fem_lie.system.equations import Equations, TimeState

_SIDES, _OFF_CENTRE = 2.0, 4.0
"""Number of sides of a contact, and ratio of compliances of a free rigid body at its surface and at
its mass centre: factors of the stiffness of a contact."""


def together(equations: Equations, masses: nodes.Masses) -> Flags:
    """Nodes that move together: those with joints or damping, and all but positions, (n,).

    Args:
        equations: Equations of the scene, with lumped inertia.
        masses: Lumped inertia of its nodes.
    """
    found = np.asarray(equations.unknowns.kinds != POSITION)
    rates = damping_rates(equations, masses)
    found[: len(rates)] |= rates[:, 0] > 0.0
    if equations.unknowns.m:
        B = equations.constraints(equations.start.frames).jacobian
        found[B.indices[B.data != 0.0] // 6] = True
    return found


def sizes_of_cells(equations: Equations) -> Array:
    """Size of the largest cell around each node, (n,)."""
    found, x = np.zeros(equations.unknowns.moving), equations.start.frames[:, 0]
    for term in equations.arrays.terms:
        if term.of_bodies:
            i, j = term.pairs
            np.maximum.at(found, i, np.linalg.norm(x[i] - x[j], axis=1))
    return found


def stiffness_in_contact(equations: Equations, masses: nodes.Masses) -> Array:
    """Bound of the stiffness ``Σ k K_ii`` of contacts at each node, closed or not, (n, 6, 6).

    Args:
        equations: Equations of the scene.
        masses: Lumped inertia of its nodes.
    """
    sizes, found = sizes_of_cells(equations), np.zeros((len(masses.ways), 6, 6))
    for contact in equations.scene.contacts:
        touched = nodes_in_contact(equations, contact)
        # along lines and over areas it is per length or area
        k = _SIDES * contact.law.largest_stiffness * sizes[touched] ** contact.pair.power
        k[masses.ways[touched] > nodes.STRAIGHT] *= _OFF_CENTRE
        found[touched, :3, :3] += k[:, np.newaxis, np.newaxis] * np.eye(3)
    return found


def nodes_in_contact(equations: Equations, contact: Contact) -> Indices:
    """Nodes that the surfaces of a contact are fixed to."""
    points = (*contact.a.points, *contact.b.points)
    numbers = equations.unknowns.bodies
    found = [numbers[point.body][point.node] for point in points if point.body is not None]
    return np.unique(np.array(found, dtype=np.int64))


class OuterForces(Stateful):
    """Forces that are in no cell of the queue; true if there are any.

    Attributes:
        r: The forces with the sign of a residual, along the axes of the nodes, at the time at which
            they were evaluated last, (n, 6).
        nodes: Nodes that they act on, or may act on later, (n,).
    """

    STATE = attributes("r")

    def __init__(self, equations: Equations, single: Flags, cells: FormArrays) -> None:
        """Find the forces without evaluating them.

        Args:
            equations: Equations of the scene, with lumped inertia.
            single: Nodes that fall by themselves under constant loads, (n,).
            cells: Cells that are not in the queue.
        """
        unknowns, known = equations.unknowns, equations.arrays
        self._equations, self._cells = equations, cells
        self._terms = [term for term in known.terms if term.tables is None and not term.load]
        self._falling: Indices = np.flatnonzero(single)
        self.r = np.zeros((unknowns.moving, 6))
        self.nodes: Flags = known.changing | ~single
        self.nodes[cells.nodes] = True
        loads = [term for term in known.terms if term.load]
        for term in (*self._terms, *loads):
            self.nodes[term.pairs[0]] = True
        for contact in equations.scene.contacts:
            self.nodes[nodes_in_contact(equations, contact)] = True

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self.nodes.any())

    def evaluate(self, time: float, H: Array) -> None:
        """Evaluate the forces.

        Args:
            time: Time, from which on its loads act.
            H: Frames of all nodes at that time, ground and prescribed motions.
        """
        equations, i = self._equations, self._falling
        self.r[:] = -equations.prescribed(time).loads(H).reshape(-1, 6)
        self.r[i, :3] += np.einsum("nai,ni->na", H[i, 1:], equations.arrays.conservative[i, 0])
        for term in self._terms:
            if term.local is not None:
                term.local.condense(H)
            term.add_forces(H, self.r)
        add_forces(H, (*self._cells,), self.r.reshape(-1))
        self.r[equations.unknowns.held] = 0.0
        equations.check_laws()


class CommonMotion(Stateful):
    """Motion of the nodes that move together.

    Attributes:
        p: Their momenta, see :mod:`.nodes`, (n, 6); zero for all other nodes.
    """

    STATE = attributes("p", "joints")

    def __init__(
        self, equations: Equations, masses: nodes.Masses, chosen: Flags, size: float
    ) -> None:
        """Start with the initial velocities.

        Args:
            equations: Equations of the scene, with lumped inertia.
            masses: Lumped inertia of its nodes.
            chosen: Nodes that move together, (n,).
            size: Step size.
        """
        n, H = equations.unknowns.moving, equations.start.frames
        self._masses = masses._replace(ways=np.where(chosen, masses.ways, nodes.STILL))
        self.p, self._rest = np.zeros((n, 6)), np.zeros((n, 6))
        nodes.momenta((*self._masses,), H, equations.start.velocities, self.p)
        self._size, joined = size, equations.unknowns.constraints > 0
        self._decay = np.exp(-0.5 * size * damping_rates(equations, masses))
        self.joints = Joints(equations, self._masses, self._decay) if joined else None

    def restart(self) -> None:
        """Forget what belongs to earlier axes of the nodes."""
        if self.joints is not None:
            self.joints.restart()

    def step(self, H: Array, r: Array, weigh: Callable[[], None]) -> bool:
        """Make a step in place; return whether the joints could be kept closed.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            r: Forces at the start on entry, at the end on return, (n, 6).
            weigh: Evaluates these forces at the frames.
        """
        h, masses, forces = self._size, (*self._masses,), r.reshape(-1)
        if self.joints is not None:
            return self.joints.step(h, H, self.p, forces, weigh)
        nodes.kick(masses, H, forces, 0.5 * h, self.p)
        nodes.decay(self._decay, self.p)
        nodes.drift(masses, self.p, h, H)
        nodes.decay(self._decay, self.p)
        weigh()
        nodes.kick(masses, H, forces, 0.5 * h, self.p)
        return True

    def state(self, H: Array, v: Array) -> TimeState:
        """State of all nodes.

        Args:
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists of all other nodes, (n, 6), to which those of these nodes are added.
        """
        own = np.zeros_like(v)
        nodes.twists((*self._masses,), H, self.p, own)
        v += own
        if self.joints is None:
            return TimeState(H, v, self._rest, np.zeros(0))
        return TimeState(H, v, *self.joints.forces(H, v))
