"""Access by address in compiled code: function calls, numbers, maps of nodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from fem_lie._jit import callback

double_pointer = types.CPointer(types.float64)

Pointer: TypeAlias = Any
"""Pointer to doubles, in compiled code only."""

UFCX_SIGNATURE = types.void(
    double_pointer,
    double_pointer,
    double_pointer,
    double_pointer,
    types.CPointer(types.int32),
    types.CPointer(types.uint8),
)
"""Signature of DOLFINx kernels (UFCx)."""

MAP_SIGNATURE = types.void(
    double_pointer, double_pointer, double_pointer, double_pointer, types.intp
)
"""Signature of the functions of a :class:`FrameMap`."""


@intrinsic
def shift(typing_context, pointer, offset):  # type: ignore[no-untyped-def]
    """``pointer + offset``, counted in doubles."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.gep(arguments[0], [arguments[1]])

    return double_pointer(double_pointer, types.intp), generate


def _call_by_address(argument_types: Sequence[ir.Type]) -> Callable[..., None]:
    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        function_type = ir.FunctionType(ir.VoidType(), argument_types)
        function = builder.inttoptr(arguments[0], function_type.as_pointer())
        # The C calling convention lets a callee ignore trailing arguments: null is the
        # `custom_data` argument of kernels from DOLFINx 0.11 on, and is harmless before.
        given = list(arguments[1:])
        given += [ir.Constant(t, None) for t in argument_types[len(given) :]]
        builder.call(function, given)
        return context.get_dummy_value()

    return generate


_double_p = ir.DoubleType().as_pointer()
_byte_p = ir.IntType(8).as_pointer()
_int_p = ir.IntType(32).as_pointer()
_tabulate_code = _call_by_address([_double_p] * 4 + [_int_p, _byte_p, _byte_p])
_map_code = _call_by_address([_double_p] * 4 + [ir.IntType(64)])


@intrinsic
def tabulate(typing_context, address, A, w, c, x, entity, permutation):  # type: ignore[no-untyped-def]
    """Call the UFCx function at ``address``."""
    return types.void(types.int64, *UFCX_SIGNATURE.args), _tabulate_code


@intrinsic
def pointer(typing_context, address):  # type: ignore[no-untyped-def]
    """Pointer to doubles at an address."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.inttoptr(arguments[0], _double_p)

    return double_pointer(types.int64), generate


@intrinsic
def integer_pointer(typing_context, address):  # type: ignore[no-untyped-def]
    """Pointer to 64-bit integers at an address."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.inttoptr(arguments[0], ir.IntType(64).as_pointer())

    return types.CPointer(types.int64)(types.int64), generate


@intrinsic
def own_entity(typing_context, entity, stored):  # type: ignore[no-untyped-def]
    """Local number of a facet: ``entity``, or the integer at ``stored`` if that is null."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        given, other = arguments
        missing = builder.icmp_unsigned("==", given, ir.Constant(_int_p, None))
        return builder.select(missing, builder.bitcast(other, _int_p), given)

    integers = types.CPointer(types.int32)
    return integers(integers, double_pointer), generate


@intrinsic
def call_kernel(typing_context, address, A, w, c, x):  # type: ignore[no-untyped-def]
    """Call a kernel at ``address``, as DOLFINx calls it for a cell."""
    return types.void(types.int64, *UFCX_SIGNATURE.args[:4]), _tabulate_code


@intrinsic
def apply(typing_context, address, state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    """Call the function of a frame map at ``address``."""
    return types.void(types.int64, *MAP_SIGNATURE.args), _map_code


frame_function = callback(MAP_SIGNATURE)


@dataclass(frozen=True)
class FrameMap:
    """Variation of flat element coordinates ``y`` for twists ``h`` of the nodes along their frames.

    Four compiled functions of signature :data:`MAP_SIGNATURE`, ``(state, y, given, out, nodes)``,
    made with :func:`frame_function`. ``state`` holds the stored nodal coordinates (``values``
    doubles each). The functions must live as long as the forms, as functions of a module do.

    Attributes:
        coordinates: ``y`` from the state; ``None`` if the state of the cell's nodes is ``y``.
        pull_back: ``out += Lᵀ given``, forces on ``y`` as forces and moments along nodal frames.
        push_forward: ``out = L given``, twists of the nodes as a variation of ``y``.
        geometric: ``out += ∂(Lᵀ given)/∂h``, a row-major square matrix; ``None`` if zero.
        values: Doubles stored per node.
        unknowns: Unknowns per node along its frame.
    """

    coordinates: Any
    pull_back: Any
    push_forward: Any
    geometric: Any
    values: int
    unknowns: int
