"""Forces and moments at the ends of each element of a beam, in given states.

The elements are assembled as in the scene, but disconnected: each has nodes of its own. The
residual is then the force and moment on each end of each element, for any formulation, and the sum
over the elements at a node is the residual of the scene there.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.bodies.beams.assembly import BeamAssembly
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Point
from fem_lie.joints.sliding import Sliding
from fem_lie.scene import Scene
from fem_lie.scene.nodal_loads import PointLoad
from fem_lie.sections.orientation import middle_frames


class ElementForces:
    """The disconnected elements of a beam; shapes as in :class:`~.beams.beam.Beam`."""

    def __init__(self, beam: Beam) -> None:
        self._elements, self._formulation = beam.model.elements, beam.model.formulation
        m, k = beam.model.elements.shape
        torn = copy(beam)
        torn.model.frames = beam.frames[beam.model.elements].reshape(m * k, 4, 3)
        torn.model.elements = np.arange(m * k).reshape(m, k)
        torn.model.has_mass = False
        self._assembly = BeamAssembly([torn.model])

    @property
    def viscous(self) -> bool:
        """Whether forces depend on velocities."""
        return self._assembly.viscosity is not None

    def set_eigenstrain(self, strains: Array) -> None:
        """Set the eigenstrains of all elements, shape (m, 6)."""
        self._assembly.set_eigenstrain(strains)

    def at_ends(self, frames: Array, velocities: Array | None = None) -> Array:
        """Section force and moment at both ends of each element, shape (m, 2, 6).

        They act on the element at its second end, and from it at its first end: both are those of a
        section whose normal is e₁.

        Args:
            frames: Frames of the beam's nodes, shape (n, 4, 3).
            velocities: Twists of the nodes, shape (n, 6); default: no viscous forces.
        """
        assembly, order = self._assembly, self._assembly.order
        H, forces = np.empty((assembly.count, 4, 3)), np.zeros((assembly.count, 6))
        H[order] = frames[self._elements].reshape(-1, 4, 3)
        assembly.add_forces(H, forces.reshape(-1))
        if velocities is not None and self.viscous:
            v = np.empty((assembly.count, 6))
            v[order] = velocities[self._elements].reshape(-1, 6)
            assembly.add_viscous_forces(H, v, forces.reshape(-1))
        on_nodes = forces[order].reshape(*self._elements.shape, 6)
        return np.stack([-on_nodes[:, 0], on_nodes[:, 1]], axis=1)

    def of_strain(self, frames: Array) -> Array:
        """Elastic force and moment at the integration points, shape (m, g, 6).

        Args:
            frames: Frames of the beam's nodes, shape (n, 4, 3).

        Raises:
            ValueError: The element is user-defined and its energy is not a ``StrainEnergy``.
        """
        assembly = self._assembly
        stress = assembly.forms.stress
        if stress is None:
            raise ValueError(
                "the energy of this element is not a StrainEnergy, so it has no stress"
            )
        H = np.empty((assembly.count, 4, 3))
        H[assembly.order] = frames[self._elements].reshape(-1, 4, 3)
        assembly.reset_stress(H)
        points = stress.function_space.dofmap.list[assembly.cell_order]
        values = np.asarray(stress.x.array.reshape(-1, 6)[points], dtype=np.float64)
        nodes = frames[self._elements]
        return self._formulation.mean_stress(values, nodes, self.at_ends(frames))


def in_the_middle(elements: Indices, frames: Array, ends: Array) -> Array:
    """Mean of the section forces of both ends, moved to the middle of each element, (T, m, 6).

    Elements of two nodes have one value: loads act on nodes, so between them force and moment are
    in equilibrium with those at the ends. A node in the middle has loads of its own, and force and
    moment jump there by these loads.

    Args:
        elements: Nodes of each element, shape (m, k).
        frames: Frames of the beam's nodes, shape (T, n, 4, 3).
        ends: Section forces at the ends, shape (T, m, 2, 6).
    """
    a, b = frames[:, elements[:, 0]], frames[:, elements[:, 1]]
    middle = frames[:, elements[:, 2]] if elements.shape[1] == 3 else middle_frames(a, b)
    middles = np.zeros_like(ends[:, :, 0])
    for i, end in enumerate((a, b)):
        transport = lie.se3_adjoint(lie.se3_compose(lie.se3_inverse(end), middle))
        middles += 0.5 * np.einsum("tmji,tmj->tmi", transport, ends[:, :, i])
    return middles


def single_forces(scene: Scene, beam: Beam) -> Indices:
    """Nodes of a beam at which concentrated forces may act.

    These are the nodes of joints, springs, links, supports and point loads, all nodes of an element
    with an attachment inside, and those of kinks and branches; all nodes if a joint slides along
    the beam.
    """
    sliding = [item for item in (*scene.joints, *scene.connections) if isinstance(item, Sliding)]
    if any(item.beam is beam for item in sliding):
        return np.arange(len(beam.frames))
    points: list[Point] = [load.point for load in scene.loads if isinstance(load, PointLoad)]
    points += [clamp.point for clamp in scene.clamps]
    points += [motion.point for motion in scene.motions]
    for link in scene.links:
        points += [link.a, link.b]
    for connection in (*scene.joints, *scene.connections):
        points += connection.points
    own = [point for point in points if point.body is beam]
    nodes = [
        n for point in own for n in (point.attachment.nodes if point.attachment else (point.node,))
    ]
    following = np.flatnonzero(beam.model.masters != np.arange(len(beam.model.masters)))
    return np.unique([*nodes, *following, *beam.model.masters[following]]).astype(np.int64)


def without_jumps(beam: Beam, ends: Array, single: Indices) -> Array:
    """Section forces at the ends of elements, continuous between elements, shape (T, m, 2, 6).

    Part of a distributed load acts at the nodes. The jump at a node between two elements is
    distributed to both by their lengths. At the other end of an element that has no such neighbour,
    the value has the opposite error. Moments of elements with a curved axis are exact in the mean:
    a load ``−ΔV/ℓ`` makes them quadratic, and adds ``ℓ ΔV/12`` at both ends.

    Values are of second order everywhere, exact for a constant load on a straight line, and
    unchanged where there is no jump.

    Args:
        beam: The beam.
        ends: Section forces, shape (T, m, 2, 6).
        single: Nodes at which values may jump.
    """
    before, behind = neighbours(beam.model.elements, single)
    lengths, found = beam.model.lengths, ends.copy()
    share = (lengths[before] / (lengths[before] + lengths[behind]))[:, np.newaxis]
    jump = ends[:, before, 1] - ends[:, behind, 0]
    left, right = share * jump, (1.0 - share) * jump
    found[:, before, 1] -= left
    found[:, behind, 0] += right
    free_start, free_end = np.ones((2, len(lengths)), dtype=bool)
    free_start[behind] = free_end[before] = False
    at_start, at_end = free_start[before], free_end[behind]
    found[:, before[at_start], 0] += left[:, at_start]
    found[:, behind[at_end], 1] -= right[:, at_end]
    if beam.model.formulation.bows:
        moved = (found - ends)[..., 1:3]
        change = lengths[:, np.newaxis] * (moved[:, :, 1] - moved[:, :, 0]) / 12
        found[..., 4] += change[..., np.newaxis, 1]
        found[..., 5] -= change[..., np.newaxis, 0]
    return found


def neighbours(elements: Indices, single: Indices) -> tuple[Indices, Indices]:
    """Pairs of consecutive elements: two at a node, end to start."""
    count = elements.max() + 1
    meeting = np.bincount(elements[:, :2].ravel(), minlength=count) == 2
    meeting[single] = False
    after = np.full(count, -1)
    after[elements[:, 0]] = np.arange(len(elements))
    node = elements[:, 1]
    before = np.flatnonzero(meeting[node] & (after[node] >= 0))
    return before, after[node[before]]
