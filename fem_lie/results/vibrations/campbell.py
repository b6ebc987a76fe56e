"""Campbell diagram: whirl frequencies of a rotor in the fixed frame over its speed."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._summary import Summarised
from fem_lie.pictures.diagrams import campbell
from fem_lie.pictures.stage import SI, Units
from fem_lie.ranks.files import write_once
from fem_lie.results.files.tables import Table
from fem_lie.results.files.written import Saved, require_suffix
from fem_lie.results.vibrations.modes import Complex

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_GROWS = 1e-6  # real part over absolute value; less is round-off


@dataclass(frozen=True, eq=False, repr=False)
class CampbellDiagram(Summarised, Saved):
    """Whirl of a rotor at k speeds, in the frame that does not rotate.

    In forward whirl the axis of the shaft moves around its straight position in the sense of the
    spin, in backward whirl against it. The j-th line is the j-th slowest whirl in its direction at
    every speed.

    Attributes:
        speeds: Angular velocities, rad per time, shape (k,).
        forward: Eigenvalues of forward whirl, shape (k, p): real part is growth, imaginary part
            angular frequency.
        backward: Eigenvalues of backward whirl, likewise; imaginary parts are negative.
        critical_speeds: Speeds within the range at which a forward whirl is synchronous, so that an
            unbalance excites it, ascending.
        seconds: Wall time.
    """

    speeds: Array
    forward: Complex
    backward: Complex
    critical_speeds: Array
    seconds: float

    @property
    def unstable(self) -> Flags:
        """Whether a whirl grows, shape (k,)."""
        both = np.concatenate([self.forward, self.backward], axis=1)
        return np.asarray((both.real > _GROWS * np.abs(both)).any(axis=1))

    def table(self, *, units: Units = SI) -> str:
        """Table with one line for each speed, frequencies of backward whirl with a minus.

        Args:
            units: Units, for labels.
        """
        names = [f"{way} {j + 1}" for way, j in self._lines()]
        head = [f"{'speed':>12}", *(f"{name:>12}" for name in names)]
        rows = [head, *(self._row(k) for k in range(len(self.speeds)))]
        critical = ", ".join(f"{speed:.6g}" for speed in self.critical_speeds) or "none"
        title = f"whirl frequencies [rad/{units.time}]"
        return "\n".join([title, *("".join(row) for row in rows), f"critical speeds: {critical}"])

    def picture(self, path: str | os.PathLike[str] | None = None, *, units: Units = SI) -> Figure:
        """Diagram of whirl frequencies over speed, with the line of synchronous whirl.

        Args:
            path: Name of the file if it is to be saved.
            units: Units, for labels.
        """
        lines = {"forward": self.forward.imag, "backward": -self.backward.imag}
        return campbell(self.speeds, lines, self.critical_speeds, path, units=units)

    def to_dataframe(self) -> Any:
        """Frequencies and growth of all lines as a ``pandas.DataFrame``, one row for each speed.

        Raises:
            ImportError: pandas is not installed.
        """
        return self._table().to_dataframe()

    def write_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the table of :meth:`to_dataframe`, without pandas.

        Args:
            path: Name of the ``.csv`` file.

        Raises:
            ValueError: The name does not end in ``.csv``.
        """
        require_suffix(path, ".csv", "file")
        write_once(path, partial(self._table().write_csv, path))

    def __str__(self) -> str:
        """The table."""
        return self.table()

    def _lines(self) -> Iterator[tuple[str, int]]:
        for way in ("forward", "backward"):
            yield from ((way, j) for j in range(self.forward.shape[1]))

    def _row(self, k: int) -> list[str]:
        found = np.concatenate([self.forward[k].imag, self.backward[k].imag])
        return [f"{self.speeds[k]:12.6g}", *(f"{value:12.6g}" for value in found)]

    def _table(self) -> Table:
        columns = {}
        for way, j in self._lines():
            values = getattr(self, way)[:, j]
            columns[f"{way} {j + 1} frequency"] = values.imag
            columns[f"{way} {j + 1} growth"] = values.real
        return Table("speed", self.speeds, columns)
