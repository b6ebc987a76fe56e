"""The loads of a scene at any time: one case for each history, on the moving nodes."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.scene import Scene
from fem_lie.scene.load import History, NodalLoad, StrainLoad, amplitudes, histories
from fem_lie.scene.pressure import Pressure
from fem_lie.scene.pressure_loads import PressureLoad, SurfacePressure
from fem_lie.scene.surface_pressure import SurfacePushes
from fem_lie.system.nodes.loads import Loads
from fem_lie.system.nodes.numbering import Numbering

Contents: TypeAlias = tuple[
    list[tuple[Array, Array, Array]],
    list[tuple[int, int, Array]],
    list[int],
    list[tuple[Array | Indices, ...]],
]
"""Nodal loads of all cases; case, assembly and values of strains; cases of pressures, and these."""


class _Case:
    """All loads that have one history: what they are at amplitude one."""

    def __init__(self, count: int) -> None:
        self.dead = np.zeros((count, 4, 3))
        self.moment = np.zeros((count, 3))
        self.following = np.zeros((count, 6))

    def arrays(self) -> tuple[Array, Array, Array]:
        """In the order of :class:`~fem_lie.system.nodes.loads.Loads`."""
        return self.dead, self.moment, self.following


class LoadCases:
    """Loads as functions of time.

    Attributes:
        time_dependent: Whether any load has a history.
        pressures: The forces of each pressure.
        turning: Whether there are moments or following loads.
    """

    def __init__(self, scene: Scene, numbering: Numbering, weight: Array) -> None:
        """Sum up the loads of each history.

        Args:
            scene: What there is.
            numbering: Of its nodes.
            weight: Force of gravity on (x, d₁, d₂, d₃), shape (n, 4, 3).
        """
        self._numbering = numbering
        # equal histories are one, under the number of the first load that has it
        distinct: dict[History, int] = {}
        for number, history in histories(scene.loads).items():
            distinct.setdefault(history, number)
        self._histories = {number: history for history, number in distinct.items()}
        case = {None: 0} | {history: 1 + k for k, history in enumerate(distinct)}
        case_of = [case[load.history] for load in scene.loads]
        count = numbering.count
        self._cases = [_Case(count) for _ in range(1 + len(distinct))]
        self._cases[0].dead += weight
        self._strains: list[tuple[int, int, Array]] = []
        self.pressures: list[Pressure | SurfacePushes] = []
        self._case_of_pressure: list[int] = []
        for number, load in zip(case_of, scene.loads, strict=True):
            if isinstance(load, NodalLoad):
                self._add_nodal(self._cases[number], load)
            elif isinstance(load, StrainLoad):
                self._strains.append((number, *self._in_assembly(load)))
            elif isinstance(load, PressureLoad):
                self._case_of_pressure.append(number)
                self.pressures.append(Pressure(self._pieces(load), load.across()))
            elif isinstance(load, SurfacePressure):
                self._case_of_pressure.append(number)
                cells = numbering.nodes[load.body][load.faces()]
                self.pressures.append(SurfacePushes(cells, load.rule(), load.on_cells()))
        self.time_dependent = bool(distinct)
        self.turning = any(case.moment.any() or case.following.any() for case in self._cases)
        self._last: Array | None = None

    def _add_nodal(self, case: _Case, load: NodalLoad) -> None:
        """A force fixed in space is a force on ``q``, wherever its node follows its leader."""
        attachment = self._numbering.attachment
        nodes = self._numbering.nodes[load.body]
        leaders, values, levers = attachment.leader[nodes], load.nodal(), load.on_directors()
        if load.following:
            # of forces fₖ on the directors: Σ eₖ × fₖ
            values[:, 3:] += np.cross(np.eye(3), levers).sum(axis=1)
            turn = lie.se3_adjoint(lie.se3_inverse(attachment.offset[nodes]))
            np.add.at(case.following, leaders, np.einsum("nji,nj->ni", turn, values))
        else:
            forces = np.concatenate([values[:, np.newaxis, :3], levers], axis=1)
            moved = attachment.linear()[nodes].transpose(0, 2, 1) @ forces
            np.add.at(case.dead, leaders, moved)
            np.add.at(case.moment, leaders, values[:, 3:])

    def _in_assembly(self, load: StrainLoad) -> tuple[int, Array]:
        """Number of the load's assembly and the strain of all cells there, shape (M, 6)."""
        for number, members in enumerate(self._numbering.members):
            if load.body in members:
                strains = [
                    load.strains() if body is load.body else np.zeros((len(body.cells_of()), 6))
                    for body in members
                ]
                return number, np.concatenate(strains)
        raise AssertionError("a load on a body that is not in the scene")

    def _pieces(self, load: PressureLoad) -> Indices:
        """Pairs of successive nodes on the loaded elements, in the numbering of all nodes."""
        beam = load.body
        elements = beam.elements[beam.cells_of(load.cells)]
        along = elements[:, [0, *range(2, elements.shape[1]), 1]]
        pairs = np.stack([along[:, :-1], along[:, 1:]], axis=2).reshape(-1, 2)
        return self._numbering.nodes[beam][pairs]

    def at(self, time: float, factor: float) -> Loads:
        """Loads at ``time``; those without history, and gravity, times ``factor``.

        Raises:
            ValueError: A history is not finite.
        """
        amplitude = np.concatenate([[factor], amplitudes(self._histories, time)[0]])
        if self._last is None or (amplitude != self._last).any():
            self._set_strains(amplitude)
            for case, pressure in zip(self._case_of_pressure, self.pressures, strict=True):
                pressure.amplitude = float(amplitude[case])
            self._last = amplitude
        if len(amplitude) == 1 and factor == 1.0:
            return Loads(*self._cases[0].arrays())
        loads = Loads(*(np.zeros_like(array) for array in self._cases[0].arrays()))
        for a, part in zip(amplitude, self._cases, strict=True):
            for total, array in zip(loads, part.arrays(), strict=True):
                total += a * array
        return loads

    @property
    def any_nodal(self) -> bool:
        """Whether gravity or any load acts on nodes."""
        return any(array.any() for case in self._cases for array in case.arrays())

    @property
    def strains_change(self) -> bool:
        """Whether a strain without stress has a history."""
        return any(case > 0 for case, _, _ in self._strains)

    @property
    def constant(self) -> Array:
        """Forces on (x, d₁, d₂, d₃) fixed in space that have no history, (n, 4, 3)."""
        return self._cases[0].dead

    @property
    def contents(self) -> Contents:
        """All that forces are made of, but for the histories."""
        cases = [case.arrays() for case in self._cases]
        pressures = [pressure.contents for pressure in self.pressures]
        return cases, self._strains, self._case_of_pressure, pressures

    def _set_strains(self, amplitude: Array) -> None:
        for number in dict.fromkeys(number for _, number, _ in self._strains):
            total = sum(amplitude[c] * strain for c, n, strain in self._strains if n == number)
            self._numbering.assemblies[number][1].set_eigenstrain(np.asarray(total))
