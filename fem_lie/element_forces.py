"""Forces and moments at the ends of each element of a beam, in given states.

The elements are assembled as the scene assembles them, but torn apart: each has nodes of its own.
Then the residual is the force and moment on each end of each element, whatever the element is, and
what meets at a node adds up to the residual of the scene there.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from fem_lie import lie
from fem_lie._lines import Array, Indices
from fem_lie.beam import Beam, BeamAssembly
from fem_lie.orientation import middle_frames


class ElementForces:
    """The elements of a beam, each for itself; shapes as in :class:`~fem_lie.beam.Beam`."""

    def __init__(self, beam: Beam) -> None:
        self._elements = beam.elements
        m, k = beam.elements.shape
        torn = copy(beam)
        torn.frames = beam.frames[beam.elements].reshape(m * k, 4, 3)
        torn.elements = np.arange(m * k).reshape(m, k)
        torn.has_mass = False
        self._assembly = BeamAssembly([torn])

    def set_eigenstrain(self, strains: Array) -> None:
        """Strains without stress of all elements, shape (m, 6)."""
        self._assembly.set_eigenstrain(strains)

    def at_ends(self, frames: Array, velocities: Array | None = None) -> Array:
        """What holds both ends of each element against its neighbours, shape (m, 2, 6).

        Force and moment that the rest of the beam beyond the end exerts if the end is the second,
        and the contrary if it is the first: both are those of a section whose normal is e₁.

        Args:
            frames: Of the beam's nodes, shape (n, 4, 3).
            velocities: Local twists of the nodes, shape (n, 6); without, nothing is viscous.
        """
        assembly, order = self._assembly, self._assembly.order
        H, forces = np.empty((assembly.count, 4, 3)), np.zeros((assembly.count, 6))
        H[order] = frames[self._elements].reshape(-1, 4, 3)
        assembly.add_forces(H, forces.reshape(-1))
        if velocities is not None and assembly.viscous:
            v = np.empty((assembly.count, 6))
            v[order] = velocities[self._elements].reshape(-1, 6)
            assembly.add_viscous_forces(H, v, forces.reshape(-1))
        on_nodes = forces[order].reshape(*self._elements.shape, 6)
        return np.stack([-on_nodes[:, 0], on_nodes[:, 1]], axis=1)

    def of_strain(self, frames: Array) -> Array:
        """Stress ``σ = D ε`` of the element at its points of integration, shape (m, g, 6).

        Args:
            frames: Of the beam's nodes, shape (n, 4, 3).

        Raises:
            ValueError: The element is a user's own whose energy is not strain and law.
        """
        assembly = self._assembly
        stress = assembly.forms.stress
        if stress is None:
            raise ValueError("the energy of this element is no StrainEnergy: it has no stress")
        H = np.empty((assembly.count, 4, 3))
        H[assembly.order] = frames[self._elements].reshape(-1, 4, 3)
        assembly.reset_stress(H)
        points = stress.function_space.dofmap.list[assembly.cell_order]
        return np.asarray(stress.x.array.reshape(-1, 6)[points], dtype=np.float64)


def in_the_middle(elements: Indices, frames: Array, ends: Array) -> Array:
    """Mean of what both ends carry to the middle of each element, shape (T, m, 6).

    There is one value for elements of two nodes: loads act on nodes, so that between them force and
    moment are in equilibrium with those at the ends. A node in the middle has loads of its own, and
    force and moment jump there by as much.

    Args:
        elements: Nodes of each element, shape (m, k).
        frames: Of the beam's nodes, shape (T, n, 4, 3).
        ends: At the ends, shape (T, m, 2, 6).
    """
    a, b = frames[:, elements[:, 0]], frames[:, elements[:, 1]]
    middle = frames[:, elements[:, 2]] if elements.shape[1] == 3 else middle_frames(a, b)
    carried = np.zeros_like(ends[:, :, 0])
    for i, end in enumerate((a, b)):
        turn = lie.se3_adjoint(lie.se3_compose(lie.se3_inverse(end), middle))
        carried += 0.5 * np.einsum("tmji,tmj->tmi", turn, ends[:, :, i])
    return carried
