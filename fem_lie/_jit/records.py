"""Records: numbers with names in one block of memory that Python and compiled code share.

In Python they are structures of ctypes, whose attributes are as fast as elements of an array; those
of a ``np.record`` take thirty times as long. Compiled functions take records as arguments, but
cannot return them: what unpacks a table of addresses (:mod:`fem_lie._jit.packed_arrays`) gives an
array of one record, :data:`Records`.
"""

from __future__ import annotations

import ctypes
from typing import Any, ClassVar, TypeAlias, cast

import numpy as np

Record: TypeAlias = Any
"""Numbers as attributes: a :class:`Fields` in Python, a record of numba in compiled code."""

Records: TypeAlias = Any
"""Array of one record."""


class Fields(ctypes.Structure):
    """Numbers as attributes; zero at first.

    Attributes:
        layout: The same as a type of numpy, which takes 80 µs to find.
    """

    layout: ClassVar[np.dtype[np.void]]


_IN_C = {int: ctypes.c_int64, float: ctypes.c_double}


def record_type(**fields: type | tuple[type, int]) -> type[Fields]:
    """Type of a record.

    Args:
        **fields: Type of each number, ``int`` or ``float``; with a length for a vector of numbers.
    """
    found = [
        (name, cast(Any, _IN_C[of[0]]) * of[1] if isinstance(of, tuple) else _IN_C[of])
        for name, of in fields.items()
    ]
    kind: type[Fields] = type("Record", (Fields,), {"_fields_": found})
    kind.layout = cast("np.dtype[np.void]", np.dtype(kind))
    return kind


def block_of(record: Fields) -> Records:
    """The record as an array of one, a view of its memory."""
    return np.frombuffer(cast(Any, record), type(record).layout).view(np.recarray)


def fields_of(record: Fields) -> dict[str, Any]:
    """Arrays of one number, or of a vector of numbers, by name; they are views of the record."""
    block = np.asarray(block_of(record))
    return {name: block[name] for name in block.dtype.names or ()}
