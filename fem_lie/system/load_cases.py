"""Loads of a scene as functions of time: one load case per history, on the master nodes."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.body import Body
from fem_lie.forms.term import Term
from fem_lie.scene import Scene
from fem_lie.scene.load import History, Load, amplitudes, histories
from fem_lie.system.nodes.masses import Loads
from fem_lie.system.nodes.numbering import Numbering

Contents: TypeAlias = tuple[
    list[tuple[Array, Array, Array]],
    list[tuple[int, int, Array]],
    list[int],
    list[object],
]
"""Nodal loads of all cases; case, assembly and values of strains; case of each term; the terms."""


_SIZE = 21
"""Numbers per node in the arrays of :class:`~fem_lie.system.nodes.masses.Loads`."""


def _views(values: Array) -> tuple[Array, Array, Array]:
    """Arrays of values (21 n,), in that order."""
    n = len(values) // _SIZE
    dead, moment = values[: 12 * n], values[12 * n : 15 * n]
    return dead.reshape(n, 4, 3), moment.reshape(n, 3), values[15 * n :].reshape(n, 6)


class _Case:
    """All loads with one history, at amplitude one.

    Attributes:
        all: Nodal loads in one array, shape (21 n,); the next three are views.
        dead: Forces on (x, d₁, d₂, d₃) fixed in space, shape (n, 4, 3).
        moment: Moments fixed in space, shape (n, 3).
        following: Forces and moments in the nodal frames, shape (n, 6).
        strains: Number of an assembly, and the strain of all its cells.
        terms: Loads with a load stiffness.
    """

    def __init__(self, numbering: Numbering) -> None:
        """Start without loads."""
        self._numbering, count = numbering, numbering.count
        self.all = np.zeros(_SIZE * count)
        self.dead, self.moment, self.following = _views(self.all)
        self.strains: list[tuple[int, Array]] = []
        self.terms: list[Term] = []

    def arrays(self) -> tuple[Array, Array, Array]:
        """Arrays in the order of :class:`~fem_lie.system.nodes.masses.Loads`."""
        return self.dead, self.moment, self.following

    def nodes(self, body: Body) -> Indices:
        """Numbers of a body's nodes."""
        return self._numbering.nodes[body]

    def add_nodal(self, body: Body, force: Array, on_directors: Array, *, following: bool) -> None:
        """Add nodal forces (n, 6) and forces on directors (n, 3, 3).

        A force fixed in space on an attached node is a constant force on ``q`` of its master node.
        """
        master_map, nodes = self._numbering.master_map, self.nodes(body)
        masters = master_map.master[nodes]
        if following:
            # of forces fₖ on the directors: Σ eₖ × fₖ
            moment = force[:, 3:] + np.cross(np.eye(3), on_directors).sum(axis=1)
            values = np.concatenate([force[:, :3], moment], axis=1)
            turn = lie.se3_adjoint(lie.se3_inverse(master_map.offset[nodes]))
            np.add.at(self.following, masters, np.einsum("nji,nj->ni", turn, values))
        else:
            forces = np.concatenate([force[:, np.newaxis, :3], on_directors], axis=1)
            moved = master_map.linear()[nodes].transpose(0, 2, 1) @ forces
            np.add.at(self.dead, masters, moved)
            np.add.at(self.moment, masters, force[:, 3:])

    def add_strain(self, body: Body, strain: Array) -> None:
        """Add a stress-free strain to the cells of the body's assembly."""
        of_body = (body in members for members in self._numbering.members)
        number = next(number for number, found in enumerate(of_body) if found)
        strains = [
            strain if other is body else np.zeros((len(other.model.cells_of()), strain.shape[1]))
            for other in self._numbering.members[number]
        ]
        self.strains.append((number, np.concatenate(strains)))

    def add_term(self, term: Term) -> None:
        """Add a load with a load stiffness."""
        self.terms.append(term)


class LoadCases:
    """Loads as functions of time.

    Attributes:
        time_dependent: Whether any load has a history or a factor.
        factors: Factor of each load case, shape (k,).
        terms: Loads with a load stiffness, on all nodes.
        turning: Whether there are moments or follower loads.
    """

    def __init__(self, scene: Scene, numbering: Numbering, weight: Array) -> None:
        """Sum up the loads of each history.

        Args:
            scene: The scene.
            numbering: Numbering of its nodes.
            weight: Force of gravity on (x, d₁, d₂, d₃), shape (n, 4, 3).
        """
        self._assemblies = numbering.assemblies
        # loads with the same history are one case, numbered by the first of them
        distinct: dict[History, int] = {}
        for number, history in histories(scene.loads).items():
            distinct.setdefault(history, number)
        self._histories = {number: history for history, number in distinct.items()}
        case = {None: 0} | {history: 1 + k for k, history in enumerate(distinct)}
        scaled = {load: start for load, start in scene.scaled.items() if load in scene.loads}
        # each load with a factor is a case of its own, with the amplitude of another one
        plain = 1 + len(distinct)
        self._scaled = {load: plain + k for k, load in enumerate(scaled)}
        self._amplitude_of = [*range(plain), *(case[load.history] for load in self._scaled)]
        self.factors = np.array([*np.ones(plain), *scaled.values()])
        self._cases = [_Case(numbering) for _ in self._amplitude_of]
        self._cases[0].dead += weight
        for load in scene.loads:
            load.contribute(self._cases[self._scaled.get(load, case[load.history])])
        self._strains = [(k, *s) for k, part in enumerate(self._cases) for s in part.strains]
        of_cases = [(k, term) for k, part in enumerate(self._cases) for term in part.terms]
        self._case_of_term = [k for k, _ in of_cases]
        self.terms = [term for _, term in of_cases]
        self.time_dependent = len(self._cases) > 1
        nodal = any(case.moment.any() or case.following.any() for case in self._cases)
        self.turning = nodal or any(term.turning for term in self.terms)
        self._last: Array | None = None

    def at(self, time: float, factor: float) -> Loads:
        """Loads at ``time``; gravity and loads without history are times ``factor``.

        Raises:
            ValueError: A history is not finite.
        """
        amplitude = np.concatenate([[factor], amplitudes(self._histories, time)[0]])
        amplitude = self.factors * amplitude[self._amplitude_of]
        if self._last is None or (amplitude != self._last).any():
            self._set_strains(amplitude)
            for case, term in zip(self._case_of_term, self.terms, strict=True):
                term.amplitude = float(amplitude[case])
            self._last = amplitude
        if len(amplitude) == 1 and factor == 1.0:
            return Loads(*self._cases[0].arrays())
        total = np.zeros_like(self._cases[0].all)
        for a, part in zip(amplitude, self._cases, strict=True):
            total += a * part.all
        return Loads(*_views(total))

    def scale(self, load: Load, factor: float) -> None:
        """Set the factor of a load.

        Args:
            load: A load that the scene names as scaled.
            factor: The factor.
        """
        self.factors[self._scaled[load]] = factor

    @property
    def any_nodal(self) -> bool:
        """Whether there are nodal loads, gravity included."""
        return any(array.any() for case in self._cases for array in case.arrays())

    @property
    def strains_change(self) -> bool:
        """Whether a stress-free strain has a history."""
        return any(case > 0 for case, _, _ in self._strains)

    @property
    def constant(self) -> Array:
        """Forces on (x, d₁, d₂, d₃) fixed in space without history, (n, 4, 3)."""
        return self._cases[0].dead

    @property
    def changing(self) -> Flags:
        """Nodes with loads fixed in space that have a history or a factor, (n,)."""
        found = np.zeros(len(self.constant), dtype=bool)
        for case in self._cases[1:]:
            found |= case.dead.any(axis=(1, 2))
        return found

    @property
    def contents(self) -> Contents:
        """Data on which the forces depend, without the histories."""
        cases = [case.arrays() for case in self._cases]
        terms = [term.contents for term in self.terms]
        return cases, self._strains, self._case_of_term, terms

    def _set_strains(self, amplitude: Array) -> None:
        for number in dict.fromkeys(number for _, number, _ in self._strains):
            total = sum(amplitude[c] * strain for c, n, strain in self._strains if n == number)
            assembly = self._assemblies[number][1]
            assembly.set_eigenstrain(np.asarray(total))
            assembly.strains_set += 1
