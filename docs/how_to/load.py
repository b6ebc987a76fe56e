"""A load of one's own: a force per length on a beam that falls linearly from its start to its end.

A load is a frozen dataclass. It says which argument is the body (`carrier`) and how many components
its other arguments have (`components`); types, the time function, components and groups of cells
are checked by the base class. `nodal` gives the force and the moment at each node.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

import fem_lie as fl
from fem_lie.extend import Carrier, History, NodalLoad


@dataclass(frozen=True, eq=False)
class RampLoad(NodalLoad):
    """Force per unloaded length, fixed in space, linear along the beam and zero at its end.

    Attributes:
        beam: The beam, one line from "start" to "end".
        force: At the start, three global components, force per length.
        history: Factor as a function of time.
    """

    carrier = Carrier("beam", fl.Beam, "a Beam")
    components = MappingProxyType({"force": 3})
    following = False

    beam: fl.Beam
    force: npt.ArrayLike
    history: History | None = None

    def nodal(self) -> np.ndarray:
        """Forces with the moments of the distributed ones, shape (n, 6)."""
        ends = self.beam.model.elements[:, :2]
        parts = (
            1.0 - self.beam.model.chains.arc / self.beam.model.lengths.sum()
        )  # at both ends of elements
        shares = (
            parts @ np.array([[2.0, 1.0], [1.0, 2.0]]) * self.beam.model.lengths[:, np.newaxis] / 6
        )
        values = np.zeros((len(self.beam.frames), 6))
        np.add.at(values[:, :3], ends, shares[..., np.newaxis] * np.asarray(self.force))
        return values


def deflection(cells: int) -> float:
    """Of the end of a cantilever under a small load, over that by bending and shear."""
    section = fl.Section.circle(0.01, fl.Material(E=2.1e11, nu=0.3, density=7800.0))
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=cells))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(RampLoad(beam, (0, 0, 1e-3)))
    found = fl.statics(scene).displacement(beam.point("end"))[-1, 2]
    bending, shear = section.stiffness[4, 4], section.stiffness[2, 2]
    return float(found / (1e-3 * (1 / (30 * bending) + 1 / (6 * shear))))


errors = [abs(deflection(cells) - 1.0) for cells in (16, 32)]
order = np.log2(errors[0] / errors[1])
print(f"errors {errors[0]:.1e}, {errors[1]:.1e}: order {order:.2f}")
