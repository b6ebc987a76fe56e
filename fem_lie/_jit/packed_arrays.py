"""Records of arrays at fixed addresses, passed to compiled functions as one array of addresses.

Each array argument adds 0.15 µs to a call of a compiled function from Python: twenty arrays cost as
much as the work on a small scene. Arrays that do not move during a run are passed by address. The
annotations of a named tuple say how its arrays are laid out, and both sides follow them: what packs
a record, :class:`PackedArrays`, and the compiled function that :func:`unpacking` makes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import count
from typing import (
    Annotated,
    Any,
    NamedTuple,
    TypeAlias,
    TypeVar,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np
from llvmlite import ir
from numba import from_dtype, types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

from fem_lie._arrays import Array, Indices
from fem_lie._jit.records import Fields, block_of

_MOST = 4  # dimensions


class Layout(NamedTuple):
    """Layout of an array.

    Attributes:
        kind: Type of its numbers, or of its one record.
        shape: Lengths along its axes, ``None`` where they are known at run time only; lengths that
            the compiler knows are faster.
    """

    kind: Any
    shape: tuple[int | None, ...]


_n = None
Numbers1: TypeAlias = Annotated[Array, Layout(np.float64, (_n,))]
Numbers2: TypeAlias = Annotated[Array, Layout(np.float64, (_n, _n))]
Numbers3: TypeAlias = Annotated[Array, Layout(np.float64, (_n, _n, _n))]
Numbers4: TypeAlias = Annotated[Array, Layout(np.float64, (_n, _n, _n, _n))]
Integers1: TypeAlias = Annotated[Indices, Layout(np.int64, (_n,))]
Integers2: TypeAlias = Annotated[Indices, Layout(np.int64, (_n, _n))]
Integers3: TypeAlias = Annotated[Indices, Layout(np.int64, (_n, _n, _n))]
Frames: TypeAlias = Annotated[Array, Layout(np.float64, (_n, 4, 3))]
ManyFrames: TypeAlias = Annotated[Array, Layout(np.float64, (_n, _n, 4, 3))]
Sixes: TypeAlias = Annotated[Array, Layout(np.float64, (_n, 6))]
ManySixes: TypeAlias = Annotated[Array, Layout(np.float64, (_n, _n, 6))]
IntegerSixes: TypeAlias = Annotated[Indices, Layout(np.int64, (_n, 6))]


def one(kind: type[Fields]) -> Layout:
    """Layout of an array of one record, see :mod:`fem_lie._jit.records`."""
    return Layout(kind.layout, (1,))


class PackedArrays:
    """Addresses of the arrays and numbers of a record, which it keeps alive.

    None of the arrays may be replaced.

    Attributes:
        addresses: Address and shape of each array, or value of each number, for compiled functions,
            shape (k, 5).
    """

    def __init__(self, record: Iterable[Any]) -> None:
        """Store all fields in order, those of records within it in their place.

        Raises:
            TypeError: An array is not contiguous, or not of doubles, 64-bit integers or records.
        """
        fields = tuple(_flat(record))
        self.addresses = np.ones((len(fields), 1 + _MOST), dtype=np.int64)
        self.set(fields)

    def set(self, record: Iterable[Any]) -> None:
        """Store the fields of another record in the same array of addresses."""
        self._fields = tuple(_flat(record))
        for row, field in zip(self.addresses, self._fields, strict=True):
            _describe(field, row)


def _flat(record: Any) -> Iterator[Any]:
    for field in record:
        if isinstance(field, tuple):
            yield from _flat(field)
        else:
            yield field


def _describe(field: Any, row: Indices) -> None:
    """Set the row of a field: the value of a number, or the address and shape of an array."""
    if isinstance(field, bool | int | np.integer | np.bool_):
        row[0] = int(field)
    elif isinstance(field, float):
        row[:1].view(np.float64)[0] = field
    else:
        record = isinstance(field, Fields)
        array = np.asarray(block_of(field)) if record else field
        plain = record or array.dtype in (np.float64, np.int64)
        if not array.flags.c_contiguous or not plain:
            raise TypeError(f"expected contiguous doubles or integers, got {array.dtype}")
        row[0] = array.ctypes.data
        row[1 : 1 + array.ndim] = array.shape


RecordT = TypeVar("RecordT")


def unpacking(kind: type[RecordT]) -> Callable[[Indices], RecordT]:
    """Function that unpacks the addresses of :class:`PackedArrays`, for compiled code.

    Args:
        kind: Named tuple whose annotations are layouts such as :data:`Frames`, numbers, and tuples
            of these.
    """
    content = _content(kind)
    returned = content.numba_type

    @intrinsic
    def unpack(typing_context, table):  # type: ignore[no-untyped-def]
        def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
            data = make_array(signature.args[0])(context, builder, arguments[0]).data
            return content.value(_Table(context, builder, data, count()))

        return returned(table), generate

    return cast(Callable[[Indices], RecordT], unpack)


class _Table(NamedTuple):
    """A packed table in generated code, whose next row is read.

    Attributes:
        context: Target of numba.
        builder: Builder of the code.
        data: Pointer to the table.
        rows: Numbers of its rows, from the next one.
    """

    context: Any
    builder: Any
    data: Any
    rows: Iterator[int]

    def read(self, row: int, column: int) -> Any:
        """An entry of the table."""
        at = cgutils.intp_t((1 + _MOST) * row + column)
        return self.builder.load(self.builder.gep(self.data, [at]))


class _ArrayField(NamedTuple):
    """An array of a record."""

    layout: Layout

    @property
    def numba_type(self) -> Any:
        """Its type in compiled code."""
        kind, shape = self.layout
        return types.Array(from_dtype(np.dtype(kind)), len(shape), "C")

    def value(self, table: _Table) -> Any:
        """The array at the address in the next row."""
        context, builder, kind = table.context, table.builder, self.numba_type
        row, size = next(table.rows), np.dtype(self.layout.kind).itemsize
        lengths = [
            table.read(row, 1 + k) if known is None else cgutils.intp_t(known)
            for k, known in enumerate(self.layout.shape)
        ]
        strides = [cgutils.intp_t(size)]
        for length in lengths[:0:-1]:
            strides.insert(0, builder.mul(strides[0], length))
        pointer = context.get_data_type(kind.dtype).as_pointer()
        array = make_array(kind)(context, builder)
        populate_array(
            array,
            data=builder.inttoptr(table.read(row, 0), pointer),
            shape=lengths,
            strides=strides,
            itemsize=cgutils.intp_t(size),
            meminfo=None,
        )
        return array._getvalue()


class _NumberField(NamedTuple):
    """A number of a record."""

    kind: type

    @property
    def numba_type(self) -> Any:
        """Its type in compiled code."""
        return {bool: types.boolean, int: types.int64, float: types.float64}[self.kind]

    def value(self, table: _Table) -> Any:
        """The number in the next row."""
        found = table.read(next(table.rows), 0)
        if self.kind is float:
            return table.builder.bitcast(found, ir.DoubleType())
        return table.builder.trunc(found, ir.IntType(1)) if self.kind is bool else found


class _TupleField(NamedTuple):
    """A record, or a plain tuple, with its fields."""

    kind: type | None
    fields: tuple[Any, ...]

    @property
    def numba_type(self) -> Any:
        """Its type in compiled code."""
        return types.BaseTuple.from_types([each.numba_type for each in self.fields], self.kind)

    def value(self, table: _Table) -> Any:
        """All fields, from the next row on."""
        found = [each.value(table) for each in self.fields]
        return table.context.make_tuple(table.builder, self.numba_type, found)


def _content(annotation: Any) -> Any:
    """Content of a field with this annotation."""
    layouts = [each for each in get_args(annotation)[1:] if isinstance(each, Layout)]
    if layouts:
        return _ArrayField(layouts[0])
    if annotation in (bool, int, float):
        return _NumberField(annotation)
    if get_origin(annotation) is tuple:
        return _TupleField(None, tuple(_content(each) for each in get_args(annotation)))
    hints = get_type_hints(annotation, include_extras=True)
    return _TupleField(annotation, tuple(_content(hints[name]) for name in annotation._fields))
