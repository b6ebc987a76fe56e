"""Tables of results: one row for each state or mode, as CSV files and pandas data frames."""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array

WRENCH = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
"""Names of the components of a force and a moment along global axes."""

OWN_WRENCH = ("F1", "F2", "F3", "M1", "M2", "M3")
"""Names of these along the axes of a joint."""

Columns = dict[str, npt.NDArray[Any]]
"""Values of k states by name, each of shape (k,)."""


@dataclass(frozen=True, eq=False)
class Table:
    """Quantities of k states or modes.

    Attributes:
        label: Name of the index: "time", "load factor" or "mode".
        index: Time, load factor or number of each row, shape (k,).
        columns: Quantities by name, each of shape (k,).
    """

    label: str
    index: Array
    columns: Columns

    def to_dataframe(self) -> Any:
        """The table as a ``pandas.DataFrame``.

        Raises:
            ImportError: pandas is not installed.
        """
        try:
            import pandas
        except ImportError as error:
            raise ImportError(
                "to_dataframe needs pandas, which is not installed (pip install pandas); "
                "write_csv writes the same table without it"
            ) from error
        return pandas.DataFrame(self.columns, index=pandas.Index(self.index, name=self.label))

    def write_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the table; values are read back without loss.

        Args:
            path: Name of the file.
        """
        columns = [self.index.tolist(), *(values.tolist() for values in self.columns.values())]
        with open(path, "w", newline="", encoding="utf-8") as file:
            rows = csv.writer(file)
            rows.writerow([self.label, *self.columns])
            rows.writerows(zip(*columns, strict=True))


def components(name: str, values: npt.NDArray[Any], suffixes: Sequence[str]) -> Columns:
    """Columns ``name suffix`` of the components of values, shape (k, c).

    Complex values become columns of real parts, ``… re``, and of imaginary parts, ``… im``.
    """
    named = {f"{name} {suffix}": values[:, i] for i, suffix in enumerate(suffixes)}
    return in_real_parts(named) if np.iscomplexobj(values) else named


def in_real_parts(columns: Mapping[str, npt.NDArray[Any]]) -> Columns:
    """Columns of the real and of the imaginary part of each column."""
    return {
        f"{name} {part}": getattr(values, attribute)
        for name, values in columns.items()
        for part, attribute in (("re", "real"), ("im", "imag"))
    }
