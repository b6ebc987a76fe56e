"""Reduced-order bodies: a floating frame and modal coordinates within it."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, numbers
from fem_lie.bodies.body import Body
from fem_lie.bodies.model import NO_HOLDS, BodyModel, Holds, MaterialPoint
from fem_lie.bodies.reduced.assembly import ReducedAssembly
from fem_lie.forms.assembly import BodyTerm
from fem_lie.lie.node_types import NodeType
from fem_lie.lie.node_types.floating import FloatingModes
from fem_lie.lie.node_types.floating_coordinates import all_coordinates, all_rates


class ReducedOrderModel(BodyModel):
    """Model of a reduced-order body.

    Attributes:
        interfaces: Nodes of the full body that are interfaces, shape (1 + i,).
        within: Positions and directors of the other interfaces in the frame of the first, at rest,
            shape (i, 4, 3).
        stiffness: Stiffness in the coordinates: displacement and rotation of each other interface
            in the frame, then modal amplitudes, shape (m, m).
        quadratic: ``Q``, symmetric in its last two indices, shape (m, m, m).
        density: Mass matrix of ``(x, d_k, z_a d_k)``, see :mod:`fem_lie.lie.node_types.floating`,
            shape (4 + 3 m, 4 + 3 m).
        full: Full body.
        modes: Displacement and rotation of each node of the full body for each modal coordinate,
            in components along the frame, shape (m, n, 6).
    """

    def __init__(
        self,
        interfaces: Sequence[int],
        stiffness: Array,
        density: Array,
        modes: Array,
        full: Body,
        *,
        points: Mapping[str, int],
        quadratic: Array | None,
        class_name: str,
        name: str,
    ) -> None:
        """Create the nodes.

        Args:
            interfaces: Nodes of the full body that are interfaces; the first is the frame.
            stiffness: Stiffness in the coordinates, shape (m, m).
            density: Mass matrix of ``(x, d_k, z_a d_k)``, shape (4 + 3 m, 4 + 3 m).
            modes: Modes, shape (m, n, 6).
            full: Full body.
            points: Index of each named interface.
            quadratic: Quadratic coefficients of the strains, shape (m, m, m); default: zero, so
                that the stiffness is constant.
            class_name: Name of the class of the body.
            name: Name in messages and results.

        Raises:
            ValueError: Shapes of matrices do not agree with each other or with the interfaces, or
                matrices are not symmetric and finite.
        """
        others, m = len(interfaces) - 1, len(stiffness)
        self.interfaces: Indices = np.array(interfaces, dtype=np.int64)
        frames = full.frames[self.interfaces]
        inner = m - 6 * others
        self.stiffness = _symmetric(stiffness, m, "ReducedOrderBody: stiffness")
        self.density = _symmetric(density, 4 + 3 * m, "ReducedOrderBody: density")
        self.quadratic = np.zeros((m, m, m)) if quadratic is None else quadratic
        if self.quadratic.shape != (m, m, m):
            raise ValueError(
                f"ReducedOrderBody: quadratic must have shape {(m, m, m)}, "
                f"got {self.quadratic.shape}"
            )
        if inner < 0:
            raise ValueError(
                f"ReducedOrderBody: {others} other interfaces have {6 * others} coordinates, "
                f"got {m}"
            )
        self.modes, self.full = modes, full
        first = lie.se3_inverse(frames[0])
        self.within = np.ascontiguousarray(lie.se3_compose(first, frames[1:]))
        amplitudes = np.zeros((-(-inner // 6), 4, 3))
        amplitudes[:, 0] = frames[0, 0]
        nodes = np.arange(1, others + 1)
        super().__init__(
            np.concatenate([frames, amplitudes]),
            cells=np.stack([np.zeros_like(nodes), nodes], axis=1),
            class_name=class_name,
            size=full.model.size,
            points=dict(points),
            name=name,
        )

    def numbered(self, node: int) -> MaterialPoint:
        """Material point at an interface; modal nodes have no points.

        Args:
            node: Number of the interface.
        """
        if not 0 <= node <= len(self.within):
            raise ValueError(
                f"{self.label} has interfaces 0 … {len(self.within)}, got {node}: what is held or "
                "loaded has to be an interface of the reduced body"
            )
        return MaterialPoint(node, f"interface {node}")

    @property
    def node_types(self) -> Indices:
        """Type of each node, shape (n,): frames, then modal nodes."""
        kinds = np.full(len(self.frames), int(NodeType.MODAL), dtype=np.int64)
        kinds[: 1 + len(self.within)] = int(NodeType.FRAME)
        return kinds

    @property
    def missing_unknowns(self) -> Flags:
        """Mask of unused unknowns of the last modal node, shape (n, 6)."""
        found = super().missing_unknowns
        found.ravel()[6 + len(self.stiffness) :] = True
        return found

    def floating_modes(self) -> FloatingModes:
        """Interfaces, mass matrix without that of the frame, and coefficients of the energy."""
        matrix = self.density.copy()
        matrix[:4, :4] = 0.0
        return FloatingModes(self.within, matrix, self.stiffness, self.quadratic)

    @property
    def assembly_key(self) -> Hashable:
        """Key of bodies that are assembled together: equal numbers of interfaces and modes."""
        return type(self), len(self.stiffness), len(self.within)

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> BodyTerm:
        """Assembly of all bodies of one :attr:`assembly_key`."""
        return ReducedAssembly(models)

    def coordinates(self, frames: Array) -> Array:
        """Coordinates in states of its nodes, shape (s, m).

        Args:
            frames: Nodal coordinates, shape (s, n, 4, 3).
        """
        frames = np.ascontiguousarray(frames)
        return np.asarray(all_coordinates(frames, self.within, len(self.stiffness)))

    def rates(self, frames: Array, velocities: Array) -> Array:
        """Rates of the coordinates, shape (s, m).

        Args:
            frames: Nodal coordinates, shape (s, n, 4, 3).
            velocities: Twists, shape (s, n, 6).
        """
        states = np.ascontiguousarray(frames), np.ascontiguousarray(velocities)
        kinds, size = self.node_types, len(self.stiffness)
        return np.asarray(all_rates(kinds, *states, self.within, size))

    def expand(self, frames: Array) -> Array:
        """Frames of all nodes of the full body, shape (s, N, 4, 3).

        Args:
            frames: Nodal coordinates of the reduced-order body, shape (s, n, 4, 3).
        """
        h = np.einsum("sm,mni->sni", self.coordinates(frames), self.modes)
        initial = lie.se3_compose(lie.se3_inverse(self.frames[0]), self.full.frames)
        moved = np.tile(initial, (len(h), 1, 1, 1))
        moved[:, :, 0] += h[:, :, :3]
        # rows are directors: each is rotated within the frame
        moved[:, :, 1:] = np.einsum("snij,nkj->snki", lie.so3_exp(h[:, :, 3:]), initial[:, 1:])
        found = lie.se3_compose(frames[:, :1], moved)
        found[:, self.interfaces] = frames[:, : len(self.interfaces)]
        return np.asarray(found)

    def expand_twists(self, frames: Array, velocities: Array) -> Array:
        """Twists of all nodes of the full body, shape (s, N, 6).

        Args:
            frames: Nodal coordinates of the reduced-order body, shape (s, n, 4, 3).
            velocities: Twists of its nodes, shape (s, n, 6).
        """
        rates = np.einsum("sm,mni->sni", self.rates(frames, velocities), self.modes)
        h = np.einsum("sm,mni->sni", self.coordinates(frames), self.modes)
        arms = self.full.frames[:, 0] - self.frames[0, 0]
        arms = arms @ self.frames[0, 1:].T + h[:, :, :3]
        v, ω = velocities[:, :1, :3], velocities[:, :1, 3:]
        turning = lie.so3_exp(h[:, :, 3:])
        spin = np.einsum("snij,snj->sni", lie.so3_tangent(-h[:, :, 3:]), rates[:, :, 3:])
        inside = self.full.frames[:, 1:] @ self.frames[0, 1:].T  # directors along the frame
        axes = np.einsum("snij,nkj->snki", turning, inside)
        parts = v + np.cross(ω, arms) + rates[:, :, :3], ω + spin
        return np.concatenate([np.einsum("snki,sni->snk", axes, part) for part in parts], axis=2)


class ReducedOrderBody(Body):
    """Reduced-order body: moves with the frame of one interface, and deforms in few modes.

    Strains are small, motion is arbitrarily large. The energy is ``½ eᵀ K e`` with ``e_a = z_a + ½
    Q_abc z_b z_c``, which includes stress stiffening and the shortening by bending. Inertia is that
    of all points of the body, gyroscopic and centrifugal forces included, for positions and
    directors within the frame that are linear in the coordinates.
    :func:`~fem_lie.reduction.reduced_order_body` computes such a body. Interfaces are nodes with
    frames, on which joints, springs, loads, clamps and contacts act as on those of any other body;
    the amplitudes of internal modes are further nodes.

    Example:
        >>> section = fl.Section.circle(0.02, fl.Material(E=2e11, nu=0.3, density=7800.0))
        >>> full = fl.Scene()
        >>> beam = full.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=8))
        >>> rod = fl.reduction.reduced_order_body(full, [beam.point("start"), beam.point("end")], 4)
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> rod = scene.add(rod)
        >>> hinge = scene.add(fl.joints.Revolute(fl.ground(), rod.point("start"), axis=(0, 1, 0)))
        >>> scheme = fl.GeneralisedAlpha(radius=0.8)
        >>> result = scheme.run(scene, duration=0.2, step=2e-3, progress=False)
        >>> bool(result.position(rod.point("end"))[-1, 2] < -0.2)
        True
    """

    model: ReducedOrderModel

    def __init__(
        self,
        interfaces: Sequence[int],
        stiffness: Array,
        density: Array,
        modes: Array,
        full: Body,
        *,
        points: Mapping[str, int],
        quadratic: Array | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes.

        Args:
            interfaces: Nodes of the full body that are interfaces; the first is the frame.
            stiffness: Stiffness in the coordinates, shape (m, m).
            density: Mass matrix of ``(x, d_k, z_a d_k)``, shape (4 + 3 m, 4 + 3 m).
            modes: Modes, shape (m, n, 6).
            full: Full body.
            points: Index of each named interface.
            quadratic: Quadratic coefficients of the strains, shape (m, m, m); default: zero, so
                that the stiffness is constant.
            name: Name in messages and results.

        Raises:
            ValueError: Shapes of matrices do not agree with each other or with the interfaces, or
                matrices are not symmetric and finite.
        """
        super().__init__(
            ReducedOrderModel(
                interfaces,
                stiffness,
                density,
                modes,
                full,
                points=points,
                quadratic=quadratic,
                class_name=type(self).__name__,
                name=name,
            )
        )


def _symmetric(value: Array, size: int, what: str) -> Array:
    """``value`` as a symmetric matrix of given size; ``ValueError`` if it is not."""
    matrix = numbers(value, what)
    if matrix.shape != (size, size) or not np.isfinite(matrix).all():
        raise ValueError(f"{what} must be finite and of shape ({size}, {size}), got {matrix.shape}")
    if np.abs(matrix - matrix.T).max(initial=0.0) > 1e-8 * np.abs(matrix).max(initial=0.0):
        raise ValueError(f"{what} must be symmetric")
    return 0.5 * (matrix + matrix.T)
