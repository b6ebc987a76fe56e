"""Records: numbers with names in one block of memory that Python and compiled code share.

Compiled functions take records as arguments, but cannot return them: what unpacks a table of
addresses (:mod:`fem_lie._jit.fixed_arrays`) gives an array of one record, :data:`Records`, where
Python has the record itself.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

Record: TypeAlias = Any
"""Numbers as attributes: a ``np.record`` in Python, a record of numba in compiled code."""

Records: TypeAlias = Any
"""Array of one record."""


def record_type(**fields: type | tuple[type, int]) -> np.dtype[np.void]:
    """Type of a record.

    Args:
        **fields: Type of each number, ``int`` or ``float``; with a length for a vector of numbers.
    """
    given = {
        name: field if isinstance(field, tuple) else (field, ()) for name, field in fields.items()
    }
    return np.dtype([(name, np.dtype(kind), shape) for name, (kind, shape) in given.items()])


def new_record(kind: np.dtype[np.void]) -> Record:
    """Record of zeros.

    Args:
        kind: Type of the record.
    """
    return np.zeros(1, kind).view(np.recarray)[0]


def fields_of(record: Record) -> dict[str, Any]:
    """Arrays of one number, or of a vector of numbers, by name; they are views of the record."""
    block = np.asarray(record.base)
    return {name: block[name][0:1] for name in block.dtype.names or ()}
