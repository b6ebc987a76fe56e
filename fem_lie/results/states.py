"""States of a scene, from any solver: positions of points, reactions, and animations."""

from __future__ import annotations

import os
from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar, Literal, Protocol, SupportsIndex

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Indices, instance, number, shown, whole
from fem_lie._summary import Summarised
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.joints.connection import Connection
from fem_lie.lie.node_types import NodeType, has_position
from fem_lie.pictures import bodies, diagrams
from fem_lie.pictures.page.colours import NodalColours
from fem_lie.pictures.page.content import drawn
from fem_lie.pictures.page.page import Diagram, Page, Slider, page
from fem_lie.pictures.shapes import scene_size
from fem_lie.pictures.stage import SI, Canvas, Units
from fem_lie.pictures.vtk import ForcesInBeam, forces_in_cells
from fem_lie.results.files.functions import NodalFields
from fem_lie.results.files.tables import OWN_WRENCH, WRENCH, Columns, components
from fem_lie.results.files.written import EVERY, Nodes, Written, rotation_vectors
from fem_lie.results.plotted_quantities import Curves, Quantity, label_of, plotted
from fem_lie.results.reactions import Support, in_space, joint_axes, reaction, recorded_axes

if TYPE_CHECKING:
    from dolfinx import fem
    from matplotlib.figure import Figure


class Located:
    """Access to positions of points, in one state or in k states.

    Attributes:
        frames: Frames of the N nodes, shape (N, 4, 3), or (k, N, 4, 3).
        info: Bodies and joints.
    """

    frames: Array
    info: SceneInfo

    def position(self, point: Point | str | int) -> Array:
        """Position of a point, global components, shape (3,), or (k, 3) in k states.

        Args:
            point: A point of a body, its name such as "beam 1.end", or a node's number.

        Raises:
            ValueError: There is no such point.
        """
        return np.asarray(self.info.frame(point, self.frames)[..., 0, :])

    def rotation(self, point: Point | str | int) -> Array:
        """Rotation of a point's frame, local to global, shape (3, 3), or (k, 3, 3) in k states.

        At a node of a cable the first column is the position gradient, which is not a unit vector.

        Args:
            point: As for :meth:`position`.

        Raises:
            ValueError: There is no such point.
        """
        return lie.rotation(self.info.frame(point, self.frames))


class Displaced(Located):
    """Access to displacements of points from the undeformed configuration."""

    def displacement(self, point: Point | str | int) -> Array:
        """Displacement of a point, global components, shape (3,), or (k, 3) in k states.

        Args:
            point: As for :meth:`position`.

        Raises:
            ValueError: There is no such point, or the result is from a file of an earlier version.
        """
        return np.asarray(self.position(point) - self.info.frame(point, self.info.undeformed)[0])

    def displacements(self, body: Body | str) -> Array:
        """Displacements of all nodes of a body, global components, shape (n, 3), or (k, n, 3).

        A reduced-order body has the nodes of its interfaces only. Nodes without a position, such as
        the second one at each point of a thin shell, are left out.

        Args:
            body: A body of the scene, or its name.

        Raises:
            ValueError: There is no such body, or the result is from a file of an earlier version.

        Examples:
            The largest deflection of a plate in the last state:

            >>> import fem_lie as fl
            >>> import numpy as np
            >>> mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (4, 4))
            >>> layer = fl.ShellSection.layer(0.01, fl.Material(E=2.1e11, nu=0.3, density=7800.0))
            >>> scene = fl.Scene(gravity=(0, 0, -9.81))
            >>> plate = scene.add(fl.Shell(mesh, layer, name="plate"))
            >>> _ = plate.hinge("a=0"), plate.hinge("a=1")
            >>> u = fl.statics(scene).displacements(plate)
            >>> print(u.shape, f"{abs(u[-1, :, 2]).max():.1e}")
            (1, 25, 3) 5.3e-04
        """
        found = self.info.body(body if isinstance(body, str) else body.name)
        nodes = found.nodes[has_position(self.info.node_types[found.nodes])]
        return np.asarray(self.frames[..., nodes, 0, :] - self.info.undeformed[nodes, 0])


class StateSeries(Summarised, Displaced, Written):
    """A sequence of k states: a motion, or equilibria along a load.

    Attributes:
        frames: Frames of the N nodes, shape (k, N, 4, 3).
        joint_forces: Force and moment of each joint on its point ``a``, shape (k, j, 6).
        reactions: Force and moment of each support on its node, shape (k, s, 6).
        iterations: Number of linear solutions in all accepted steps up to each state, shape (k,).
        factorisations: Number of factorisations of the matrix.
        seconds: Wall time of the solution, without set-up.
    """

    _PLOTTED: ClassVar[Quantity]
    """What :meth:`plot` draws by default."""

    joint_forces: Array
    reactions: Array
    iterations: Indices
    factorisations: int
    seconds: float

    def functions(self, body: Body | str, state: int = -1) -> dict[str, fem.Function]:
        """A state of a body as DOLFINx functions, vectors in global components, by name.

        ``displacement`` from the undeformed configuration, ``rotation vector`` of the nodes' axes
        (at most π), ``e1``, ``e2``, ``e3``, and the velocities of a motion if they were recorded.
        Where several nodes share a point, as at a kink, values are those of the first one.

        Args:
            body: A body of the scene: the functions are on the undeformed DOLFINx mesh that it was
                made from. Its name, or a body made otherwise: on a mesh of the lines or faces as
                which it is drawn.
            state: Number of the state.

        Raises:
            ValueError: There is no such body or state, or the body has no cells.
        """
        return self._functions(body, state_number(state, len(self.frames)))

    def write_vtk(
        self, path: str | os.PathLike[str], *, forces: Sequence[ForcesInBeam] = ()
    ) -> None:
        """Write all states as a series for ParaView, pyvista or meshio.

        Point data are those of :meth:`functions`; cell data are ``body``, the number of the body,
        and section forces in the middle of elements, nan elsewhere.

        Args:
            path: Name of the ``.pvd`` file; each state is a ``.vtu`` file in a folder of the same
                name, on several ranks a ``.pvtu`` file with a ``.vtu`` file of each rank.
            forces: Section forces of beams at all states, to be written, too.

        Raises:
            ValueError: The name does not end in ``.pvd``, or section forces are at other states.
            OSError: A file cannot be written, for example because the disk is full.
        """
        self._write_vtk(path, forces_in_cells(self.info, self._rows().values, forces))

    def _frames_of(self, row: int, nodes: Nodes = EVERY) -> Array:
        return np.asarray(self.frames[row, nodes])

    def _fields_of(self, row: int, nodes: Nodes = EVERY) -> NodalFields:
        H = self._frames_of(row, nodes)
        return {
            "displacement": H[:, 0] - self.info.undeformed[nodes, 0],
            "rotation vector": rotation_vectors(self.info, H, nodes),
        }

    def _quantities(self) -> Columns:
        """Forces of joints and supports, if they were recorded.

        Components are global ones, ``Fx`` and so on; those of joints whose axes in space are not
        known are along these axes, ``F1`` and so on.
        """
        joints, supports = self._forces()
        columns: Columns = {}
        for j, joint in enumerate(self.info.joints[: joints.shape[1]]):
            axes = recorded_axes(joint, self.frames) if len(self.frames) else None
            if axes is None:
                columns |= components(joint.name, joints[:, j], OWN_WRENCH)
            else:
                columns |= components(joint.name, in_space(joints[:, j], axes), WRENCH)
        names = self.info.node_labels()
        for s, node in enumerate(self.info.supports.at[: supports.shape[1]]):
            columns |= components(f"reaction {names[node]}", supports[:, s], WRENCH)
        return columns

    def _forces(self) -> tuple[Array, Array]:
        """Forces of joints (k, j, 6) and of supports (k, s, 6), none if they were not recorded."""
        return self.joint_forces, self.reactions

    def _quantities_at(self, point: Point | str | int) -> Columns:
        """Position of the point."""
        return components(label_of(point), self.position(point), ("x", "y", "z"))

    @property
    def total_iterations(self) -> int:
        """Number of linear solutions in all accepted steps."""
        return int(self.iterations[-1]) if len(self.iterations) else 0

    def plot(
        self,
        *of: Point | Connection | Support | str | int,
        quantity: Quantity | None = None,
        path: str | os.PathLike[str] | None = None,
        units: Units = SI,
    ) -> Figure:
        """Plot components of positions, displacements or forces; saved if ``path`` is given.

        Args:
            of: Points; joints for ``"joint_force"``; supports for ``"reaction"``. Each has a
                diagram, or two, of the force and of the moment.
            quantity: ``"position"``, ``"displacement"``, ``"joint_force"`` or ``"reaction"``, along
                global axes; default: positions over time, displacements over the load factor.
            path: Name of the file; default: none is written.
            units: Units, for labels.

        Raises:
            ValueError: There is no such quantity, or nothing it is to be drawn of.
        """
        name = quantity or self._PLOTTED
        along, series = self._curves(of, name, units)
        title = name.replace("_", " ").capitalize()
        return diagrams.components(along, series, title, path, units=units)

    def _curves(
        self, of: Sequence[Point | Connection | Support | str | int], name: Quantity, units: Units
    ) -> Curves:
        """Times or load factors with their label, and the components over them."""
        size = scene_size(self.info.undeformed)
        return self._along(units), plotted(self, of, name, units, size)

    def joint_force(
        self, joint: Connection | str, axes: Literal["joint", "global"] = "joint"
    ) -> Array:
        """Force and moment of a joint on its point ``a``, shape (k, 6).

        The moment is about the joint; the opposite of both acts on ``b``.

        Args:
            joint: A joint of the scene, or its name.
            axes: Axes of the components: ``"joint"``, e₁, e₂, e₃ of the joint, which rotate with
                ``a`` and at the start are the last three rows of ``joint.frame()``; or
                ``"global"``.

        Raises:
            ValueError: There is no such joint, or its axes in space are not known: it slides along
                a beam, or it is on a body without nodal frames and only its name is given.
        """
        if axes not in ("joint", "global"):
            raise ValueError(f"joint_force: axes: expected 'joint' or 'global', got {shown(axes)}")
        wrench = np.asarray(self.joint_forces[:, self.info.joint(joint)])
        if axes == "joint":
            return wrench
        return in_space(wrench, joint_axes(joint, self.info, self.frames))

    def reaction(self, *supports: Support) -> Array:
        """Force and moment of a clamp, roller or prescribed motion, or of several together, (k, 6).

        Args:
            supports: :class:`~fem_lie.Clamp`, :class:`~fem_lie.PrescribedMotion`, or points (or
                their names) at which a body is held, as by ``Shell.roller``. Supports of the same
                node count once.

        Returns:
            Resultant on the bodies, global components; moments are about the first support.

        Raises:
            ValueError: No support is given, or one of them holds nothing.
        """
        return reaction(supports, self.info, self.frames, self.joint_forces, self.reactions)

    def _magnified(self, frames: Array, factor: float) -> Array:
        """Frames (k, N, 4, 3) for pictures, with displacements and rotations times a factor."""
        if number(factor, "magnified") == 1.0:
            return frames
        start = self.info.undeformed
        found = start + factor * (frames - start)
        framed = self.info.node_types == NodeType.FRAME
        R0, R = (np.swapaxes(H[..., framed, 1:, :], -1, -2) for H in (start, frames))
        turned = lie.so3_log(R @ np.swapaxes(R0, -1, -2))
        found[:, framed, 1:] = np.swapaxes(lie.so3_exp(factor * turned) @ R0, -1, -2)
        return np.asarray(found)

    def animate(
        self,
        path: str | os.PathLike[str],
        *,
        images: int = 100,
        seconds: float = 5.0,
        trace: Sequence[Point | str | int] = (),
        title: str = "",
        units: Units = SI,
        view: npt.ArrayLike | None = None,
    ) -> None:
        """Draw the states as an animated picture.

        Args:
            path: Name of the ``.gif`` file.
            images: Number of images, evenly spaced in time; for equilibria the largest number of
                images.
            seconds: Duration.
            trace: Points whose paths are drawn.
            title: Title of the picture.
            units: Units of the axes.
            view: Direction from the scene to the viewer: (0, 0, 1) from above. Default: at right
                angles to a plane scene, else (1, 1, 1).

        Raises:
            ValueError: The name does not end in ``.gif``, there is no such point, or no image.
        """
        rows, paths = self._instants(whole(images, "images")), self._traces(trace)
        bodies.animate(
            self.info,
            self.frames[rows],
            path,
            seconds=seconds,
            paths=paths,
            canvas=Canvas(title, units, bodies.PLAYED.size, view=view),
        )

    def page(
        self,
        path: str | os.PathLike[str] | None = None,
        *,
        states: int = 300,
        seconds: float = 5.0,
        trace: Sequence[Point | str | int] = (),
        colours: Sequence[NodalColours] = (),
        title: str = "",
        units: Units = SI,
    ) -> Page:
        """HTML page with the states as an animation: one file for any browser, without a network.

        The user rotates and zooms the model, plays the animation and selects states with a slider.
        Diagrams are synchronised: energies of a motion, or the path of the first traced point of an
        equilibrium.

        Args:
            path: Name of the ``.html`` file; a notebook shows the returned page without one.
            states: Largest number of states, evenly spaced; positions between them are
                interpolated.
            seconds: Duration of the animation.
            trace: Points whose paths are drawn.
            colours: Values of bodies in all states of this result, such as
                :meth:`fem_lie.results.stresses.section_forces.SectionForces.colours`.
            title: Title of the page.
            units: Units of the axes.

        Raises:
            ValueError: The name does not end in ``.html``, there is no such point, or no state, or
                colours are not those of this result.
        """
        rows = np.unique(self._instants(whole(states, "states")))
        shown = [one.rows(rows, len(self.frames)) for one in colours]
        content = drawn(self.info, self.frames[rows], self._traces(trace), shown, units)
        values, label, unit = self._along(units)
        slider = Slider(values[rows], label, unit, seconds, plays=len(rows) > 1)
        return page(path, content, slider, self._diagrams(rows, trace, units), title)

    @abstractmethod
    def _along(self, units: Units) -> tuple[Array, str, str]:
        """Parameter of the states, shape (k,), its name, and its unit."""

    @abstractmethod
    def _diagrams(
        self, rows: Indices, trace: Sequence[Point | str | int], units: Units
    ) -> Sequence[Diagram]:
        """Diagrams that are synchronised with the states of a page."""

    @abstractmethod
    def _instants(self, images: int) -> Indices:
        """Indices of the states in an animation."""

    def _traces(self, points: Sequence[Point | str | int], magnified: float = 1.0) -> list[Array]:
        """Paths of points through all states, with displacements times a factor."""
        if magnified == 1.0:
            return [self.position(point) for point in points]
        more = magnified - 1.0
        return [
            np.asarray(self.position(point) + more * self.displacement(point)) for point in points
        ]


class States(Protocol):
    """Any result with k states: of statics, of paths, of dynamics, or frames with their bodies."""

    @property
    def frames(self) -> Array:
        """Frames of all nodes in all states, shape (k, N, 4, 3)."""

    @property
    def info(self) -> SceneInfo:
        """Bodies and the numbers of their nodes."""


def require_states(value: object) -> None:
    """Raise ``TypeError`` if a value is not a result of statics, of a path or of dynamics."""
    if not hasattr(value, "info") or np.ndim(getattr(value, "frames", 0.0)) != 4:
        raise TypeError(f"expected a result of statics, a path or dynamics, got {shown(value)}")


def state_number(state: int, count: int) -> int:
    """Index of one of ``count`` states, counted from the end if ``state`` is negative.

    Raises:
        ValueError: There is no such state.
        TypeError: The index is not an integer.
    """
    instance(state, SupportsIndex, "state", "the number of a state")
    if not -count <= state < count:
        raise ValueError(f"the result has {count} states, got state {state}")
    return int(state) % count


def nodes_in(info: SceneInfo, body: Body, where: str = "that result") -> Indices:
    """Numbers of the nodes of a body in a result.

    Raises:
        ValueError: The result does not have the body, or the body has another number of nodes
            there.
    """
    nodes = info.body(body.name).nodes
    if len(nodes) != len(body.frames):
        raise ValueError(
            f"{body.label} has {len(body.frames)} nodes, in {where} it has {len(nodes)}"
        )
    return nodes


def evenly(count: int, most: int) -> Indices:
    """Indices of ``most`` evenly spaced of ``count`` states, with first and last, or of all."""
    return np.linspace(0, count - 1, min(most, count)).round().astype(np.int64)


def nearest(values: Array, wanted: float, what: str) -> int:
    """Index of the state whose time, or load factor, is nearest to ``wanted``.

    Raises:
        ValueError: The value is not finite.
        TypeError: The value is not a number.
    """
    return int(np.abs(values - number(wanted, what)).argmin())
