"""Jets: numbers with first or second derivatives, for forward mode in compiled code.

A jet of ``n`` variables has a value, a gradient and, if it is of second order, the upper half of
its Hessian, as plain numbers in registers. In compiled code jets add, subtract, multiply and divide
with each other and with plain numbers, compare by their values, and support the functions of
:mod:`math` in :data:`_FUNCTIONS`. So a function of plain numbers is also a function of jets. (A.
Griewank & A. Walther, *Evaluating Derivatives*, 2nd ed. 2008, ch. 13.)
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, lower_builtin, models, register_model, type_callable

_DOUBLE = ir.DoubleType()
_FLAGS = ("nnan", "nsz", "contract")
"""Floating-point flags of derivatives, by which products with constant zeros are removed."""


class JetType(types.Type):
    """Type of jets.

    Attributes:
        variables: Number of variables.
        order: Order of the derivatives, 1 or 2.
    """

    def __init__(self, variables: int, order: int) -> None:
        """Set the name of the type."""
        self.variables, self.order = variables, order
        super().__init__(name=f"Jet({variables}, {order})")

    @property
    def count(self) -> int:
        """Number of numbers of a jet."""
        n = self.variables
        return 1 + n + (n * (n + 1) // 2 if self.order == 2 else 0)


@register_model(JetType)
class _JetModel(models.StructModel):
    def __init__(self, manager: Any, kind: JetType) -> None:
        super().__init__(manager, kind, [("parts", types.UniTuple(types.float64, kind.count))])


class _Jet(NamedTuple):
    """Jet as LLVM values: value, gradient, and Hessian in pairs i ≤ j."""

    value: Any
    gradient: list[Any]
    hessian: list[Any]


def _pairs(n: int) -> list[tuple[int, int]]:
    return [(i, j) for i in range(n) for j in range(i, n)]


def _read(context: Any, builder: Any, kind: JetType, value: Any) -> _Jet:
    proxy = cgutils.create_struct_proxy(kind)(context, builder, value=value)
    parts = cgutils.unpack_tuple(builder, proxy.parts)
    n = kind.variables
    return _Jet(parts[0], parts[1 : 1 + n], parts[1 + n :])


def _made(context: Any, builder: Any, kind: JetType, jet: _Jet) -> Any:
    proxy = cgutils.create_struct_proxy(kind)(context, builder)
    parts = [jet.value, *jet.gradient, *jet.hessian]
    proxy.parts = cgutils.pack_array(builder, parts)
    return proxy._getvalue()


class _Derivatives:
    """Arithmetic of derivatives, with the flags that remove zeros."""

    def __init__(self, builder: Any) -> None:
        self._builder = builder

    def plus(self, a: Any, b: Any) -> Any:
        return self._builder.fadd(a, b, flags=_FLAGS)

    def minus(self, a: Any, b: Any) -> Any:
        return self._builder.fsub(a, b, flags=_FLAGS)

    def times(self, a: Any, b: Any) -> Any:
        return self._builder.fmul(a, b, flags=_FLAGS)

    def over(self, a: Any, b: Any) -> Any:
        return self._builder.fdiv(a, b, flags=_FLAGS)


_Rule = Callable[[Any, Any, JetType, _Jet, _Jet], _Jet]


def _sum(context: Any, builder: Any, kind: JetType, a: _Jet, b: _Jet) -> _Jet:
    d = _Derivatives(builder)
    return _Jet(
        builder.fadd(a.value, b.value),
        [d.plus(x, y) for x, y in zip(a.gradient, b.gradient, strict=True)],
        [d.plus(x, y) for x, y in zip(a.hessian, b.hessian, strict=True)],
    )


def _difference(context: Any, builder: Any, kind: JetType, a: _Jet, b: _Jet) -> _Jet:
    d = _Derivatives(builder)
    return _Jet(
        builder.fsub(a.value, b.value),
        [d.minus(x, y) for x, y in zip(a.gradient, b.gradient, strict=True)],
        [d.minus(x, y) for x, y in zip(a.hessian, b.hessian, strict=True)],
    )


def _product(context: Any, builder: Any, kind: JetType, a: _Jet, b: _Jet) -> _Jet:
    d = _Derivatives(builder)

    def along(x: Any, y: Any) -> Any:
        return d.plus(d.times(a.value, y), d.times(b.value, x))

    hessian = []
    for (i, j), x, y in _with_pairs(kind, a.hessian, b.hessian):
        mixed = d.times(a.gradient[i], b.gradient[j])
        mixed = d.plus(mixed, d.times(a.gradient[j], b.gradient[i]))
        hessian.append(d.plus(along(x, y), mixed))
    gradient = [along(x, y) for x, y in zip(a.gradient, b.gradient, strict=True)]
    return _Jet(builder.fmul(a.value, b.value), gradient, hessian)


def _quotient(context: Any, builder: Any, kind: JetType, a: _Jet, b: _Jet) -> _Jet:
    d = _Derivatives(builder)
    q = builder.fdiv(a.value, b.value)
    inverse = d.over(_DOUBLE(1.0), b.value)
    # derivatives of a = q b
    gradient = [
        d.times(d.minus(x, d.times(q, y)), inverse)
        for x, y in zip(a.gradient, b.gradient, strict=True)
    ]
    hessian = []
    for (i, j), x, y in _with_pairs(kind, a.hessian, b.hessian):
        mixed = d.times(gradient[i], b.gradient[j])
        mixed = d.plus(mixed, d.times(gradient[j], b.gradient[i]))
        left = d.minus(d.minus(x, d.times(q, y)), mixed)
        hessian.append(d.times(left, inverse))
    return _Jet(q, gradient, hessian)


_Entry: TypeAlias = tuple[tuple[int, int], Any, Any]


def _with_pairs(kind: JetType, a: list[Any], b: list[Any]) -> list[_Entry]:
    """Entries of two Hessians with their rows and columns; empty for first order."""
    return [] if kind.order == 1 else list(zip(_pairs(kind.variables), a, b, strict=True))


# --- two jets, or a jet and a plain number --------------------------------------------------------


def _common(a: Any, b: Any) -> JetType | None:
    """Type of the result of an operation on two numbers of which at least one is a jet."""
    jets = {each for each in (a, b) if isinstance(each, JetType)}
    plain = [each for each in (a, b) if not isinstance(each, JetType)]
    if len(jets) != 1 or not all(isinstance(each, types.Number) for each in plain):
        return None
    return jets.pop()


def _type_binary(operation: Any, comparison: bool = False) -> None:
    @type_callable(operation)
    def types_of(context: Any) -> Callable[..., Any]:
        def result(a: Any, b: Any) -> Any:
            kind = _common(a, b)
            return types.boolean if comparison and kind is not None else kind

        return result


def _lower_binary(operation: Any, rule: _Rule) -> None:
    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = signature.return_type
        a, b = _both(context, builder, kind, signature, arguments)
        return _made(context, builder, kind, rule(context, builder, kind, a, b))

    for pair in ((JetType, JetType), (JetType, types.Number), (types.Number, JetType)):
        lower_builtin(operation, *pair)(lowered)


def _both(
    context: Any, builder: Any, kind: JetType, signature: Any, arguments: Any
) -> tuple[_Jet, _Jet]:
    """Both operands as jets; plain numbers are constants."""
    zero = _DOUBLE(0.0)
    found = []
    for own, value in zip(signature.args, arguments, strict=True):
        if isinstance(own, JetType):
            found.append(_read(context, builder, own, value))
        else:
            number = context.cast(builder, value, own, types.float64)
            n = kind.variables
            found.append(_Jet(number, [zero] * n, [zero] * (kind.count - 1 - n)))
    return found[0], found[1]


def _lower_comparison(operation: Any, sign: str) -> None:
    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = _common(*signature.args)
        assert kind is not None
        a, b = _both(context, builder, kind, signature, arguments)
        return builder.fcmp_ordered(sign, a.value, b.value)

    for pair in ((JetType, JetType), (JetType, types.Number), (types.Number, JetType)):
        lower_builtin(operation, *pair)(lowered)


_RULES: dict[Any, _Rule] = {
    operator.add: _sum,
    operator.sub: _difference,
    operator.mul: _product,
    operator.truediv: _quotient,
}
for _operation, _rule in _RULES.items():
    _type_binary(_operation)
    _lower_binary(_operation, _rule)
for _operation, _sign in (
    (operator.lt, "<"),
    (operator.le, "<="),
    (operator.gt, ">"),
    (operator.ge, ">="),
):
    _type_binary(_operation, comparison=True)
    _lower_comparison(_operation, _sign)


# --- functions of one variable --------------------------------------------------------------------


def _square_root(d: _Derivatives, x: Any, f: Any) -> tuple[Any, Any]:
    first = d.over(_DOUBLE(0.5), f)
    return first, d.over(d.times(_DOUBLE(-0.5), first), x)


def _arctangent(d: _Derivatives, x: Any, f: Any) -> tuple[Any, Any]:
    first = d.over(_DOUBLE(1.0), d.plus(_DOUBLE(1.0), d.times(x, x)))
    return first, d.times(d.times(_DOUBLE(-2.0), x), d.times(first, first))


def _exponential(d: _Derivatives, x: Any, f: Any) -> tuple[Any, Any]:
    return f, f


def _logarithm(d: _Derivatives, x: Any, f: Any) -> tuple[Any, Any]:
    first = d.over(_DOUBLE(1.0), x)
    return first, d.minus(_DOUBLE(0.0), d.times(first, first))


_FUNCTIONS: dict[Any, Callable[[_Derivatives, Any, Any], tuple[Any, Any]]] = {
    math.sqrt: _square_root,
    math.atan: _arctangent,
    math.exp: _exponential,
    math.log: _logarithm,
}
"""First and second derivative of each function, from its argument and value."""


def _plain_value(context: Any, builder: Any, function: Any, x: Any) -> Any:
    """Value of a function of a number; a square root is one instruction, without a library call."""
    if function is math.sqrt:
        return builder.call(builder.module.declare_intrinsic("llvm.sqrt", [_DOUBLE]), [x])
    own = context.typing_context.resolve_value_type(function)
    context.typing_context.resolve_function_type(own, (types.float64,), {})
    return context.get_function(own, types.float64(types.float64))(builder, (x,))


def _define_function(function: Any, rule: Callable[..., tuple[Any, Any]]) -> None:
    @type_callable(function)
    def type_of(context: Any) -> Callable[[Any], Any]:
        return lambda a: a if isinstance(a, JetType) else None

    @lower_builtin(function, JetType)
    def lowered(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = signature.return_type
        a = _read(context, builder, kind, arguments[0])
        value = _plain_value(context, builder, function, a.value)
        d = _Derivatives(builder)
        first, second = rule(d, a.value, value)
        gradient = [d.times(first, x) for x in a.gradient]
        hessian = [
            d.plus(d.times(first, x), d.times(second, d.times(a.gradient[i], a.gradient[j])))
            for (i, j), x, _ in _with_pairs(kind, a.hessian, a.hessian)
        ]
        return _made(context, builder, kind, _Jet(value, gradient, hessian))


for _function, _rule_of_function in _FUNCTIONS.items():
    _define_function(_function, _rule_of_function)


@type_callable(operator.neg)
def _type_of_negative(context: Any) -> Callable[[Any], Any]:
    return lambda a: a if isinstance(a, JetType) else None


@lower_builtin(operator.neg, JetType)
def _negative(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    kind = signature.return_type
    a = _read(context, builder, kind, arguments[0])
    parts = [a.value, *a.gradient, *a.hessian]
    value, *rest = [builder.fsub(_DOUBLE(-0.0), part) for part in parts]
    n = kind.variables
    return _made(context, builder, kind, _Jet(value, rest[:n], rest[n:]))


# --- in and out -----------------------------------------------------------------------------------


def _variables(order: int) -> Callable[..., Any]:
    def of(typing_context, values):  # type: ignore[no-untyped-def]
        n = len(values)
        kind = JetType(n, order)

        def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
            numbers, found = cgutils.unpack_tuple(builder, arguments[0]), []
            zeros = [_DOUBLE(0.0)] * (kind.count - 1 - n)
            for i, number in enumerate(numbers):
                gradient = [_DOUBLE(float(i == j)) for j in range(n)]
                found.append(_made(context, builder, kind, _Jet(number, gradient, zeros)))
            return context.make_tuple(builder, signature.return_type, found)

        return types.UniTuple(kind, n)(values), generate

    return of


first_order = intrinsic(_variables(1))
"""Jets of first order with the numbers of a tuple as variables."""

second_order = intrinsic(_variables(2))
"""Jets of second order with the numbers of a tuple as variables."""


@intrinsic
def store_parts(typing_context, values, address):  # type: ignore[no-untyped-def]
    """Write a tuple of jets or plain numbers to memory, one after the other.

    A jet is written as value, gradient, and the Hessian row by row, i ≤ j.
    """

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        k, kinds = 0, signature.args[0]
        for kind, value in zip(kinds, cgutils.unpack_tuple(builder, arguments[0]), strict=True):
            if isinstance(kind, JetType):
                a = _read(context, builder, kind, value)
                parts = [a.value, *a.gradient, *a.hessian]
            else:
                parts = [context.cast(builder, value, kind, types.float64)]
            for part in parts:
                builder.store(part, builder.gep(arguments[1], [ir.IntType(64)(k)]))
                k += 1
        return context.get_dummy_value()

    return types.void(values, address), generate


@intrinsic
def numbers_at(typing_context, address, like):  # type: ignore[no-untyped-def]
    """Tuple of numbers from memory, as long as ``like``."""
    count = len(like)

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        found = [builder.load(builder.gep(arguments[0], [ir.IntType(64)(k)])) for k in range(count)]
        return context.make_tuple(builder, signature.return_type, found)

    return types.UniTuple(types.float64, count)(address, like), generate
