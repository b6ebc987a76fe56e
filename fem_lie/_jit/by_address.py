"""Calls of compiled functions by their addresses, for code that few scenes need.

A call by name compiles the called function with its caller, whether it is ever called or not. A
call by address compiles nothing; whoever provides the address of a callback has it compiled.
"""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.core import cgutils, errors
from numba.extending import intrinsic


@intrinsic
def call_with_arrays(typing_context, address, arrays, numbers):  # type: ignore[no-untyped-def]
    """Call the C function at an address with contiguous arrays and 64-bit integers, both tuples.

    The function takes the address of the first element of each array, and then the integers.
    """
    if not all(each.layout == "C" for each in arrays):
        raise errors.TypingError(f"arrays must be contiguous, got {arrays}")

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        _, array_types, _ = signature.args
        given = [
            context.make_array(kind)(context, builder, value).data
            for kind, value in zip(
                array_types, cgutils.unpack_tuple(builder, arguments[1]), strict=True
            )
        ]
        given += cgutils.unpack_tuple(builder, arguments[2])
        function = ir.FunctionType(ir.VoidType(), [each.type for each in given])
        builder.call(builder.inttoptr(arguments[0], function.as_pointer()), given)
        return context.get_dummy_value()

    return types.void(types.int64, arrays, numbers), generate
