"""What a scene adds to its nodes beside inertia and joints: all assemblies, and pressure.

Everything is written on all nodes and collected on those that lead.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.forms.assembly import Assembly
from fem_lie.forms.cell_forms import add_cells, joined
from fem_lie.scene.pressure import Pressure
from fem_lie.scene.surface_pressure import SurfacePushes
from fem_lie.system.nodes.attachment import Attachment


class Elastic:
    """Sum of the assemblies, seen from the nodes that lead.

    Attributes:
        pairs: Rows and columns of the node pairs that each assembly couples, then each pressure.
        viscous: Whether there are viscous forces.
        tables: Of forces and of energy, for :func:`~fem_lie.forms.cell_forms.add_cells` at the
            frames of the leaders, if that is all there is; else ``None``.
    """

    def __init__(
        self,
        assemblies: list[tuple[slice, Assembly]],
        attachment: Attachment,
        pressures: Sequence[Pressure | SurfacePushes] = (),
    ) -> None:
        """Find the pattern.

        Args:
            assemblies: Each with its part of all nodes.
            attachment: Which node follows which.
            pressures: On pairs of all nodes.
        """
        self._assemblies, self._attachment, self._pressures = assemblies, attachment, pressures
        self.viscous = any(assembly.viscous for _, assembly in assemblies)
        self._settling = [pair for pair in assemblies if pair[1].settles]
        self.tables = self._joined()
        self._all = np.zeros((len(attachment.leader), 6))
        # Ad(C⁻¹): twist of a node from that of its leader
        self._turn = lie.se3_adjoint(lie.se3_inverse(attachment.offset))
        self._nodes = [
            (
                where.start + np.repeat(np.arange(assembly.count), np.diff(assembly.indptr)),
                where.start + assembly.indices.astype(np.int64),
            )
            for where, assembly in assemblies
        ]
        self._nodes += [(pressure.rows, pressure.columns) for pressure in pressures]
        leader = attachment.leader
        self.pairs: list[tuple[Indices, Indices]] = [(leader[r], leader[c]) for r, c in self._nodes]

    def _joined(self) -> list[tuple[Indices, Indices]] | None:
        plain = all(assembly.summed_alone for _, assembly in self._assemblies)
        if not self._attachment.trivial or self._pressures or not plain:
            return None
        first = [where.start for where, _ in self._assemblies]
        tables = [assembly.tables for _, assembly in self._assemblies]
        return [joined([table[k] for table in tables], first) for k in range(2)]

    def add_forces(self, H: Array, r: Array) -> None:
        """Add the elastic forces at frames ``H`` of the leaders to ``r``, (≥ 6 count,)."""
        frames, forces = self._attachment.frames(H), self._on_all(r)
        for where, assembly in self._assemblies:
            assembly.add_forces(frames[where], forces[where].reshape(-1))
        for pressure in self._pressures:
            pressure.add_forces(frames, forces)
        self._collect(forces, r)

    def pressure_forces(self, H: Array) -> Array:
        """Forces of all pressures on the leaders, in their frames, shape (count, 6)."""
        frames, forces = self._attachment.frames(H), np.zeros_like(self._all)
        for pressure in self._pressures:
            pressure.add_forces(frames, forces)
        found = np.zeros((self._attachment.count, 6))
        self._attachment.collect(-forces, found)
        return found

    def add_viscous_forces(self, H: Array, v: Array, r: Array) -> None:
        """Likewise the viscous forces at twists ``v`` of the leaders."""
        frames, forces = self._attachment.frames(H), self._on_all(r)
        twists = self._attachment.twists(v)
        for where, assembly in self._assemblies:
            if assembly.viscous:
                assembly.add_viscous_forces(frames[where], twists[where], forces[where].reshape(-1))
        self._collect(forces, r)

    def _on_all(self, r: Array) -> Array:
        """To add forces on all nodes to, (N, 6): ``r`` itself if every node leads, or zeros."""
        if self._attachment.trivial:
            return r[: self._all.size].reshape(-1, 6)
        self._all[:] = 0.0
        return self._all

    def _collect(self, forces: Array, r: Array) -> None:
        if not self._attachment.trivial:
            self._attachment.collect(forces, r[: 6 * self._attachment.count].reshape(-1, 6))

    def energy(self, H: Array) -> float:
        """Stored energy."""
        if self.tables is not None:
            value = np.zeros(1)
            add_cells(H, self.tables[1], 0, value)
            return float(value[0])
        frames = self._attachment.frames(H)
        return sum(assembly.energy(frames[where]) for where, assembly in self._assemblies)

    def tangents(self, H: Array) -> list[Array]:
        """Blocks of the tangent for each entry of ``pairs``, with the carried stress."""
        frames = self._attachment.frames(H)
        blocks = [assembly.tangent(frames[where]) for where, assembly in self._assemblies]
        blocks += [pressure.tangent(frames) for pressure in self._pressures]
        return [self._moved(k, part) for k, part in enumerate(blocks)]

    def pressure_tangents(self, H: Array) -> list[tuple[int, Array]]:
        """Number of the pair and blocks of the tangent of each pressure at amplitude one."""
        frames, found = self._attachment.frames(H), []
        for k, pressure in enumerate(self._pressures, start=len(self._assemblies)):
            amplitude, pressure.amplitude = pressure.amplitude, 1.0
            found.append((k, self._moved(k, pressure.tangent(frames))))
            pressure.amplitude = amplitude
        return found

    def viscous_tangents(self, H: Array) -> list[tuple[int, Array]]:
        """Number of the pair and blocks of the derivative of the viscous forces in the twists."""
        frames = self._attachment.frames(H)
        return [
            (k, self._moved(k, assembly.viscous_tangent(frames[where])))
            for k, (where, assembly) in enumerate(self._assemblies)
            if assembly.viscous
        ]

    def carry(self, H: Array, h: Array) -> None:
        """Carry all stresses on along the increment ``h`` (6 count,) made from frames ``H``."""
        frames = self._attachment.frames(H)
        twists = self._attachment.twists(h.reshape(-1, 6))
        for where, assembly in self._assemblies:
            assembly.carry(frames[where], twists[where].ravel())

    def carried(self) -> list[Array]:
        """Copies of what the assemblies carry from iterate to iterate."""
        return [assembly.carried.copy() for _, assembly in self._assemblies]

    def restore(self, carried: list[Array]) -> None:
        """Carry again what was carried when it was copied."""
        for (_, assembly), values in zip(self._assemblies, carried, strict=True):
            assembly.restore(values)

    def clear_stress(self) -> None:
        """Make all carried stresses zero: a tangent without geometric stiffness."""
        for _, assembly in self._assemblies:
            assembly.clear_stress()

    def settle(self, H: Array) -> None:
        """Make what the forces at frames ``H`` need of carried unknowns that of these frames."""
        if not self._settling:
            return
        frames = self._attachment.frames(H)
        for where, assembly in self._settling:
            assembly.settle(frames[where])

    def reset_stress(self, H: Array) -> None:
        """Make all carried stresses the true ones at frames ``H``."""
        frames = self._attachment.frames(H)
        for where, assembly in self._assemblies:
            assembly.reset_stress(frames[where])

    def _moved(self, k: int, blocks: Array) -> Array:
        if self._attachment.trivial:
            return blocks
        r, c = self._nodes[k]
        turned: Array = self._turn[r].transpose(0, 2, 1) @ blocks @ self._turn[c]
        return turned
