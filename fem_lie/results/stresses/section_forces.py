"""Section forces of beams and cables: axial and shear forces, torques and bending moments.

They are computed in each state of a result, at both ends and in the middle of each element::

    found = fl.post.section_forces(result, beam, scene)
    found.raw("My"), found.mean("My"), found.smooth("My")    # ends, middles, without jumps
    found.plot("N", "My", path="diagram.png")
    found.write_vtk("forces.pvd")
    result.page("motion.html", colours=[found.colours("N")])

The section with normal e₁ transmits the force and moment that the beam beyond it exerts, in
components along its own e₁, e₂, e₃: N, V_y, V_z and T, M_y, M_z, about the point of the beam's
axis. A positive N is tension; a positive M_y gives tension where z > 0 and a positive M_z where y <
0. Cables have an axial force and, if they bend, a bending moment: :func:`cable_forces`.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array, Indices, instance
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.beams.line_body import LineBody
from fem_lie.bodies.catalogue import Owners, SceneInfo
from fem_lie.bodies.rods.cable_body import CableBody
from fem_lie.elements.rods.cable import HermiteCable
from fem_lie.elements.rods.discrete import DiscreteCable
from fem_lie.pictures.diagrams import COLOURS, figure_of_rows, saved
from fem_lie.pictures.page.colours import NodalColours, at_nodes
from fem_lie.pictures.stage import SI, Units
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in, require_states, state_number
from fem_lie.results.stresses.element_forces import (
    ElementForces,
    in_the_middle,
    single_forces,
    without_jumps,
)
from fem_lie.results.stresses.fields import Fields, check_name
from fem_lie.scene import Scene
from fem_lie.scene.load import strains_of
from fem_lie.scene.scene import require_scene
from fem_lie.sections.section import Section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COMPONENTS = ("N", "Vy", "Vz", "T", "My", "Mz")
QUANTITIES = (*COMPONENTS, "V", "M", "stress max", "stress min")


def of_forces(name: str, values: Array, beam: Beam) -> Array:
    """Values of a quantity, shape (T, m, e).

    Args:
        name: One of :data:`QUANTITIES`: "V" and "M" are the magnitudes of shear and of bending.
        values: Force and moment at e points of each element, shape (T, m, e, 6).
        beam: The beam.

    Raises:
        ValueError: There is no such quantity, or a section has no such stress.
    """
    check_name(name, QUANTITIES, beam.label)
    if name in COMPONENTS:
        return values[..., COMPONENTS.index(name)]
    if name in ("V", "M"):
        first = 1 if name == "V" else 4
        return np.hypot(values[..., first], values[..., first + 1])
    return outer_stress(values, beam.model.sections)[..., 0 if name == "stress max" else 1]


def outer_stress(values: Array, sections: Sequence[Section]) -> Array:
    """Largest and smallest axial stress at the corners of the outline, shape (T, m, e, 2).

    Args:
        values: As in :func:`of_forces`.
        sections: Section of each cell, m of them.

    Raises:
        ValueError: A section has no properties or no outline.
    """
    cells: dict[Section, list[int]] = {}
    for cell, section in enumerate(sections):
        cells.setdefault(section, []).append(cell)
    found = np.empty((*values.shape[:-1], 2))
    for section, which in cells.items():
        stress = values[:, which][..., [0, 4, 5]] @ section.axial_stress().T
        found[:, which] = np.stack([stress.max(axis=-1), stress.min(axis=-1)], axis=-1)
    return found


def unit(name: str, units: Units) -> str:
    """Unit of a quantity."""
    if name in ("N", "Vy", "Vz", "V"):
        return units.force
    if name.startswith("stress"):
        return f"{units.force}/{units.length}²"
    return f"{units.force} {units.length}"


_PALEST = 0.25
_HEIGHT = 1.5  # of a diagram, inches


def diagrams(
    beam: Beam,
    quantities: Sequence[tuple[str, Array]],
    states: Sequence[int],
    path: str | os.PathLike[str] | None,
    units: Units,
) -> Figure:
    """One diagram for each quantity, one line for each smooth segment of the beam and each state.

    Segments of a beam with kinks or branches are drawn one after the other.

    Args:
        beam: The beam, with m elements.
        quantities: Names, and values at both ends of each element, shape (T, m, 2).
        states: Indices of the states; later ones are darker.
        path: Name of the picture; saved if given.
        units: Units of the labels.
    """
    figure, axes = figure_of_rows(len(quantities), f"Section forces of {beam.label}", units)
    figure.set_size_inches(8.0, 1.2 + _HEIGHT * len(quantities))
    chains = beam.model.chains
    pieces = np.split(chains.order, chains.first[1:])
    strengths = np.linspace(_PALEST, 1.0, len(states)) if len(states) > 1 else [1.0]
    for ax, (name, values) in zip(axes, quantities, strict=True):
        ax.axhline(0.0, color="#777777", linewidth=0.8)
        start = 0.0
        for number, cells in enumerate(pieces):
            colour = COLOURS[number % len(COLOURS)]
            for state, strength in zip(states, strengths, strict=True):
                along = start + chains.arc[cells].ravel()
                ax.plot(along, values[state, cells].ravel(), color=colour, alpha=strength)
            start += float(chains.arc[cells].max())
        ax.set_ylabel(f"{name} [{unit(name, units)}]")
    axes[-1].set_xlabel(f"arc length [{units.length}]")
    return saved(figure, path)


def section_forces(
    result: Result | StaticResult,
    beam: Beam,
    scene: Scene,
    states: Sequence[int] | None = None,
) -> SectionForces:
    """Section forces of a beam in states of a result.

    Args:
        result: A result of dynamics, of statics or of a path, of a scene with the beam.
        beam: The beam.
        scene: The scene that was solved; its loads include eigenstrains.
        states: Indices of the states; default: all.

    Raises:
        ValueError: The beam is not in that scene or result, there is no such state, or its elements
            have no bending.
    """
    require_states(result)
    require_scene(scene)
    instance(beam, Beam, "beam", "a Beam")
    beam.model.formulation.require_bends("a section force")
    if beam not in scene.bodies:
        raise ValueError(f"{beam.label} is not in the scene")
    nodes, count = nodes_in(result.info, beam), len(result.frames)
    chosen = range(count) if states is None else [state_number(state, count) for state in states]
    rows = np.array(chosen, dtype=np.int64)
    dynamic = isinstance(result, Result)
    times = (result.times if isinstance(result, Result) else result.factors)[rows]
    frames = result.frames[rows][:, nodes]
    factors = np.ones(len(times)) if dynamic else times
    strains = strains_of(scene.loads, beam, times, factors)
    elements, velocities = ElementForces(beam), None
    if isinstance(result, Result) and elements.viscous:
        velocities = result.velocities[rows][:, nodes]
    ends = np.empty((len(rows), len(beam.model.elements), 2, 6))
    for k, values in enumerate(ends):
        elements.set_eigenstrain(strains[k])
        values[:] = elements.at_ends(frames[k], None if velocities is None else velocities[k])
    single, owners = single_forces(scene, beam), _owners(beam, result.info)
    return SectionForces(beam, times, frames, strains, ends, single, elements, owners)


def _owners(beam: LineBody, info: SceneInfo) -> Owners | None:
    """Ranks that had the elements of a beam; lines that are drawn are pieces of elements."""
    ranks = info.body(beam.name).owners
    if ranks is None or info.parts is None:
        return None
    return Owners(ranks[:: len(ranks) // len(beam.model.elements)], info.parts)


@dataclass(frozen=True, eq=False, repr=False)
class SectionForces(Fields):
    """Section forces of a beam in T states; made by :func:`section_forces`.

    Loads and inertia act on the nodes of elements. Within an element the force on a section is
    constant in space and its moment linear; both are in equilibrium with all forces on nodes and
    joints, to the tolerance of the solution: :attr:`ends`. Between elements they jump by the force
    on the node. Where this force represents distributed loads or inertia, :attr:`middle` and
    :attr:`smooth_ends` are more accurate.

    Attributes:
        beam: The beam, with m elements and n nodes.
        times: Times, or load factors, shape (T,).
        frames: Frames of the nodes, shape (T, n, 4, 3).
        strains: Eigenstrains, shape (T, m, 6).
        ends: Elastic and viscous force and moment at both ends of each element, in the frames
            there, shape (T, m, 2, 6).
        single: Nodes at which concentrated forces may act: joints, supports, point loads, branches.
        elements: The disconnected elements of the beam.
        owners: Ranks that had the elements; ``None`` if the scene was not divided.
    """

    beam: Beam
    times: Array
    frames: Array
    strains: Array
    ends: Array
    single: Indices
    elements: ElementForces
    owners: Owners | None

    @cached_property
    def middle(self) -> Array:
        """Force and moment in the middle of each element, in the frame there, shape (T, m, 6).

        They are the mean of those at both ends, moved to the middle.
        """
        return in_the_middle(self.beam.model.elements, self.frames, self.ends)

    @cached_property
    def smooth_ends(self) -> Array:
        """As :attr:`ends`, continuous where no concentrated force can act, shape (T, m, 2, 6).

        See :func:`fem_lie.results.stresses.element_forces.without_jumps`.
        """
        return without_jumps(self.beam, self.ends, self.single)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all quantities: section forces and moments, magnitudes and axial stresses."""
        return QUANTITIES

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the six components."""
        return COMPONENTS

    @property
    def arc(self) -> Array:
        """Arc length of both ends of each element from the start of its line, shape (m, 2)."""
        return self.beam.model.chains.arc

    @cached_property
    def cut_forces(self) -> Array:
        """Forces at both ends of each element, global components, shape (T, m, 2, 3)."""
        return self._in_space(self.ends[..., :3])

    @cached_property
    def cut_moments(self) -> Array:
        """Moments at both ends, about the axis, global components, shape (T, m, 2, 3)."""
        return self._in_space(self.ends[..., 3:])

    def _in_space(self, vectors: Array) -> Array:
        axes = self.frames[:, self.beam.model.elements[:, :2], 1:]
        return np.asarray(np.einsum("tmik,tmikj->tmij", vectors, axes))

    def at_points(self, state: int = -1) -> Array:
        """Elastic force and moment at the integration points, shape (m, g, 6).

        In elements of two nodes it is the mean force and moment of the element, in axes that rotate
        with the section; the relative difference from :attr:`middle` is of the order of the square
        of the angle between both ends.

        Args:
            state: Index of the state.
        """
        self.elements.set_eigenstrain(self.strains[state])
        return self.elements.of_strain(self.frames[state])

    def raw(self, name: str) -> Array:
        """A quantity at both ends of each element, shape (T, m, 2).

        Args:
            name: A component, "V" or "M" (the magnitudes of shear and of bending), "stress max" or
                "stress min" (largest and smallest axial stress at the corners of the outline, see
                :meth:`fem_lie.sections.section.Section.axial_stress`).

        Raises:
            ValueError: There is no such quantity, or a section has no such stress; likewise in the
                following methods.
        """
        return of_forces(name, self.ends, self.beam)

    def mean(self, name: str) -> Array:
        """A quantity in the middle of each element, shape (T, m).

        Args:
            name: Name of the quantity, such as "N" or "My".
        """
        return of_forces(name, self.middle[:, :, np.newaxis], self.beam)[:, :, 0]

    def smooth(self, name: str) -> Array:
        """As :meth:`raw`, for :attr:`smooth_ends`.

        Args:
            name: Name of the quantity, such as "N" or "My".
        """
        return of_forces(name, self.smooth_ends, self.beam)

    _axes = 2

    @property
    def _body(self) -> Beam:
        return self.beam

    def _values_at(self, nodes: Indices) -> Indices:
        """Ends of elements there; one of two if no concentrated force can act between them."""
        found = np.flatnonzero(np.isin(self.beam.model.elements[:, :2], nodes))
        joined = len(nodes) == 1 and len(found) == 2 and nodes[0] not in self.single
        return found[:1] if joined else found

    # --- pictures and files ---

    def colours(self, name: str, *, units: Units = SI) -> NodalColours:
        """A quantity in all states for the colours of a page: nodal means of :meth:`smooth`.

        Args:
            name: As for :meth:`raw`.
            units: Units of the label.
        """
        at_ends, nodes = self.smooth(name), self.beam.model.elements[:, :2].ravel()
        values = at_nodes(at_ends.reshape(len(at_ends), -1), nodes, self.frames.shape[1])
        return NodalColours(self.beam.name, values, f"{name} [{unit(name, units)}]")

    def plot(
        self,
        *names: str,
        states: Sequence[int] = (-1,),
        smooth: bool = False,
        path: str | os.PathLike[str] | None = None,
        units: Units = SI,
    ) -> Figure:
        """Diagrams of quantities over arc length; saved if there is a path.

        Args:
            names: As for :meth:`raw`; default: the six components.
            states: Indices of the states; later ones are darker.
            smooth: Whether to draw :meth:`smooth`; default: :meth:`raw`.
            path: Name of the picture.
            units: Units of the labels.

        Raises:
            ValueError: See :meth:`raw`.
        """
        values = self.smooth if smooth else self.raw
        found = [(name, values(name)) for name in names or COMPONENTS]
        return diagrams(self.beam, found, states, path, units)

    def write_vtk(self, path: str | os.PathLike[str]) -> None:
        """Write a ``.pvd`` file, and a folder of the same name with a ``.vtu`` file for each state.

        On several ranks a state is a ``.pvtu`` file with a ``.vtu`` file of each rank. Each element
        is a line with its own end points. Point data: the six components at its ends, and ``force``
        and ``moment`` as vectors in space; cell data: the components in its middle.

        Args:
            path: Name of the ``.pvd`` file.

        Raises:
            ValueError: The name does not end in ``.pvd``.
        """
        from fem_lie.pictures.vtk import write_elements

        at_ends = {name: self.ends[..., i] for i, name in enumerate(self.components)}
        at_ends |= {"force": self.cut_forces, "moment": self.cut_moments}
        in_middle = {name: self.middle[..., i] for i, name in enumerate(self.components)}
        positions = self.frames[:, self.beam.model.elements[:, :2], 0]
        write_elements(path, self.times, positions, at_ends, in_middle, self.owners)


def cable_forces(
    result: Result | StaticResult, cable: CableBody, states: Sequence[int] | None = None
) -> CableForces:
    """Axial forces and bending moments of a cable or net in states of a result.

    Args:
        result: A result of dynamics, of statics or of a path, of a scene with the cable.
        cable: A ``Cable``, ``SplineCable`` or ``Net``.
        states: Indices of the states; default: all.

    Raises:
        ValueError: The cable is not in that result, or there is no such state.

    Example:
        >>> rope = fl.Section.circle(0.005, fl.Material(E=1e9, nu=0.3, density=1000.0))
        >>> cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), rope, cells=4)
        >>> cable.pin(cable.point("start"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(cable)
        >>> _ = scene.add(fl.PointLoad(cable.point("end"), force=(50, 0, 0)))
        >>> forces = fl.post.cable_forces(fl.statics(scene), cable)
        >>> forces.mean("N")[-1].round(6)
        array([50., 50., 50., 50.])
    """
    require_states(result)
    instance(cable, CableBody, "cable", "a Cable, SplineCable or Net")
    nodes, count = nodes_in(result.info, cable), len(result.frames)
    chosen = range(count) if states is None else [state_number(state, count) for state in states]
    rows = np.array(chosen, dtype=np.int64)
    times = (result.times if isinstance(result, Result) else result.factors)[rows]
    return CableForces(cable, times, result.frames[rows][:, nodes], _owners(cable, result.info))


@dataclass(frozen=True, eq=False, repr=False)
class CableForces(Fields):
    """Axial forces N and bending moments M of a cable or net in T states; by :func:`cable_forces`.

    N is the elastic force, without that of damping. In cubic elements it is a parabola through its
    values at the integration points, and M the magnitude of ``EI κ``; in ``DiscreteCable`` N is
    constant in each edge, and there is no M, as springs between edges bend.

    Attributes:
        cable: The cable, with m elements and n nodes.
        times: Times, or load factors, shape (T,).
        frames: Coordinates of the nodes, shape (T, n, 4, 3).
        owners: Ranks that had the elements; ``None`` if the scene was not divided.
    """

    cable: CableBody
    times: Array
    frames: Array
    owners: Owners | None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all quantities."""
        return ("N", "M") if isinstance(self.cable.model.formulation, HermiteCable) else ("N",)

    def raw(self, name: str) -> Array:
        """A quantity at both ends of each element, shape (T, m, 2).

        Args:
            name: "N", or "M".
        """
        return self._along(name, np.array([0.0, 1.0]))

    def mean(self, name: str) -> Array:
        """A quantity in the middle of each element, shape (T, m).

        Args:
            name: "N", or "M".
        """
        return self._along(name, np.array([0.5]))[..., 0]

    def smooth(self, name: str) -> Array:
        """The mean of :meth:`raw` over the elements that meet at a node, shape (T, n).

        Args:
            name: "N", or "M".
        """
        at_ends = self.raw(name)
        nodes = self.cable.model.masters[self.cable.model.elements[:, :2]].ravel()
        found = at_nodes(at_ends.reshape(len(at_ends), -1), nodes, self.frames.shape[1])
        return np.asarray(found)[:, self.cable.model.masters]

    @property
    def _body(self) -> CableBody:
        return self.cable

    def _values_at(self, nodes: Indices) -> Indices:
        return nodes[:1]  # nodes of one point have one value

    def _along(self, name: str, along: Array) -> Array:
        """A quantity at places in each element, shape (T, m, p)."""
        check_name(name, self.names, self.cable.label)
        model = self.cable.model
        formulation, ends = model.formulation, model.elements[:, :2]
        assert isinstance(formulation, HermiteCable | DiscreteCable)
        EA, EI = (model.stiffness[:, k, k, np.newaxis] for k in (0, 4))
        found = np.empty((len(self.frames), len(ends), len(along)))
        for k in range(len(found)):
            given = model.frames[ends], self.frames[k, ends], model.lengths, along
            if name == "N":
                found[k] = EA * formulation.axial_strain(*given)
            else:
                assert isinstance(formulation, HermiteCable)
                found[k] = EI * np.linalg.norm(formulation.curvature(*given), axis=-1)
        return found

    # --- pictures and files ---

    def colours(self, name: str, *, units: Units = SI) -> NodalColours:
        """A quantity in all states for the colours of a page: that of :meth:`smooth`.

        Args:
            name: "N", or "M".
            units: Units of the label.
        """
        return NodalColours(self.cable.name, self.smooth(name), f"{name} [{unit(name, units)}]")

    def write_vtk(self, path: str | os.PathLike[str]) -> None:
        """Write a ``.pvd`` file, and a folder of the same name with a ``.vtu`` file for each state.

        Each element is a line with its own end points; point data are the values at its ends, cell
        data those in its middle.

        Args:
            path: Name of the ``.pvd`` file.

        Raises:
            ValueError: The name does not end in ``.pvd``.
        """
        from fem_lie.pictures.vtk import write_elements

        at_ends = {name: self.raw(name) for name in self.names}
        in_middle = {name: self.mean(name) for name in self.names}
        positions = self.frames[:, self.cable.model.elements[:, :2], 0]
        write_elements(path, self.times, positions, at_ends, in_middle, self.owners)
