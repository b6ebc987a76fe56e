"""Loads on shells: along named curves and over the surface, fixed in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._jit import Array
from fem_lie.bodies import Body, vector
from fem_lie.loads import History, NodalLoad
from fem_lie.shell import Shell


@dataclass(frozen=True, eq=False)
class EdgeLoad(NodalLoad):
    """Force and moment per reference length on a named curve of a shell, fixed in space.

    Attributes:
        shell: What carries it.
        curve: Name of the curve.
        force: Three components per length, global.
        moment: Likewise; five parameters do not feel what is along the director.
        history: Factor as a function of time.
    """

    shell: Shell
    curve: str
    force: npt.ArrayLike = (0.0, 0.0, 0.0)
    moment: npt.ArrayLike = (0.0, 0.0, 0.0)
    history: History | None = None

    following = False

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or the shell has no such curve."""
        vector(self.force, 3, f"edge force on {self.shell.label}")
        vector(self.moment, 3, f"edge moment on {self.shell.label}")
        self.shell.mesh.curve(self.curve)

    @property
    def body(self) -> Body:
        """The body that carries the load."""
        return self.shell

    def nodal(self) -> Array:
        """Consistent nodal forces and moments of the interpolation, shape (n, 6)."""
        nodes, lengths = self.shell.edges(self.curve)
        density = np.concatenate([self.force, self.moment]).astype(np.float64)
        values = np.zeros((len(self.shell.frames), 6))
        np.add.at(values, nodes, lengths[..., np.newaxis] * density)
        return values


@dataclass(frozen=True, eq=False)
class AreaLoad(NodalLoad):
    """Force per reference area on all of a shell or on some of its cells, fixed in space.

    Attributes:
        shell: What carries it.
        force: Three components per area, global.
        cells: Name of a group of cells; default: all.
        history: Factor as a function of time.
    """

    shell: Shell
    force: npt.ArrayLike
    cells: str | None = None
    history: History | None = None

    following = False

    def check(self) -> None:
        """Raise ``ValueError`` if the load is not finite or the shell has no such cells."""
        vector(self.force, 3, f"area force on {self.shell.label}")
        self.shell.cells_of(self.cells)

    @property
    def body(self) -> Body:
        """The body that carries the load."""
        return self.shell

    def nodal(self) -> Array:
        """Consistent nodal forces of the interpolation, shape (n, 6)."""
        chosen = self.shell.cells_of(self.cells)
        shares = self.shell.areas()[chosen, :, np.newaxis] * np.asarray(self.force, dtype=float)
        values = np.zeros((len(self.shell.frames), 6))
        np.add.at(values[:, :3], self.shell.mesh.cells[chosen], shares)
        return values
