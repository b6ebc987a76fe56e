"""Structure of UFL forms: forms whose formulas are equal for other functions on other meshes.

UFL's signatures say the same, in a text that other processes find as well. They take several
traversals of a form, and 10 ms, as long as a small body takes for all else. The structure is found
in one: a tuple for each different node of the formulas, with the numbers of its operands.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field
from typing import Any

import ufl
from ufl.argument import BaseArgument
from ufl.classes import (
    BaseFormOperator,
    Coefficient,
    Constant,
    GeometricQuantity,
    Index,
    Label,
    MultiIndex,
    ScalarValue,
    Zero,
)
from ufl.core.expr import Expr
from ufl.domain import extract_unique_domain
from ufl.utils.sorting import canonicalize_metadata


@dataclass(frozen=True)
class Structure:
    """Structure of a form or of an expression.

    Attributes:
        key: Equal for forms and expressions for which FFCx writes the same code.
        coefficients: Functions, in UFL's order.
        constants: Constants, in UFL's order.
        arguments: Test and trial functions, in UFL's order.
    """

    key: Hashable
    coefficients: list[Any]
    constants: list[Any]
    arguments: list[Any]


def structure_of_form(form: ufl.Form) -> Structure:
    """Structure of a form.

    Raises:
        NotImplementedError: It contains external operators, which FFCx does not compile.
    """
    nodes, integrals = _Nodes(), []
    for each in form.integrals():
        domain, metadata = nodes.domain(each.ufl_domain()), canonicalize_metadata(each.metadata())
        kind, number = each.integral_type(), each.subdomain_id()
        integrals.append((nodes.root(each.integrand()), domain, kind, number, metadata))
    return nodes.structure(tuple(integrals))


def structure_of_expression(value: Expr, of_points: Hashable) -> Structure:
    """Structure of an expression that is evaluated at points.

    Args:
        value: The expression.
        of_points: Equal for equal points.

    Raises:
        NotImplementedError: It contains external operators, which FFCx does not compile.
    """
    nodes = _Nodes()
    return nodes.structure((nodes.root(value), of_points))


@dataclass
class _Nodes:
    """Different nodes of formulas, in the order in which they are met.

    Attributes:
        numbers: Number of each node, which is a tuple.
        known: Number of each UFL expression, by its identity.
        domains: Number of each mesh, by UFL's.
        elements: Coordinate element of each mesh.
        counted: Number of each function, constant, index and label, by its kind.
        arguments: Test and trial functions.
    """

    numbers: dict[Hashable, int] = field(default_factory=dict)
    known: dict[int, int] = field(default_factory=dict)
    domains: dict[int, int] = field(default_factory=dict)
    elements: list[str] = field(default_factory=list)
    counted: dict[type, dict[Any, int]] = field(default_factory=dict)
    arguments: list[Any] = field(default_factory=list)

    def structure(self, whole: Hashable) -> Structure:
        """Structure of formulas with these nodes."""
        functions, order = self._in_order(Coefficient)
        constants, order_of_constants = self._in_order(Constant)
        key = tuple(self.numbers), tuple(self.elements), order, order_of_constants, whole
        arguments = sorted(self.arguments, key=lambda each: (each.number(), each.part() or 0))
        return Structure(key, functions, constants, arguments)

    def _in_order(self, kind: type) -> tuple[list[Any], tuple[int, ...]]:
        """Those of a kind in UFL's order, and in which order they were met."""
        met = list(self.counted.get(kind, ()))
        order = sorted(range(len(met)), key=[each.count() for each in met].__getitem__)
        return [met[i] for i in order], tuple(order)

    def root(self, top: Expr) -> int:
        """Number of a formula, after those of all of its operands."""
        stack, known = [top], self.known
        while stack:
            expression = stack[-1]
            operands = expression.ufl_operands
            if waiting := [each for each in operands if id(each) not in known]:
                stack += waiting
                continue
            stack.pop()
            if id(expression) not in known:
                own = tuple(known[id(each)] for each in operands)
                known[id(expression)] = self._number(self._node(expression, own))
        return known[id(top)]

    def domain(self, domain: Any) -> int:
        """Number of a mesh."""
        number = self.domains.setdefault(domain.ufl_id(), len(self.domains))
        if number == len(self.elements):
            self.elements.append(repr(domain.ufl_coordinate_element()))
        return number

    def _number(self, node: Hashable) -> int:
        return self.numbers.setdefault(node, len(self.numbers))

    def _met(self, kind: type, each: Any) -> int:
        numbers = self.counted.setdefault(kind, {})
        return numbers.setdefault(each, len(numbers))

    def _node(self, e: Expr, operands: tuple[int, ...]) -> Hashable:
        if isinstance(e, BaseFormOperator):
            raise NotImplementedError(
                f"FFCx does not compile {type(e).__name__}, expected UFL without external operators"
            )
        if operands or not e._ufl_is_terminal_:
            return e._ufl_typecode_, operands
        return (e._ufl_typecode_, *self._terminal(e))

    def _terminal(self, e: Any) -> Iterable[Hashable]:
        if isinstance(e, MultiIndex):
            # numbers of fixed indices are negative
            return [self._met(Index, i.count()) if isinstance(i, Index) else ~int(i) for i in e]
        if isinstance(e, Zero):
            free = (self._met(Index, count) for count in e.ufl_free_indices)
            return e.ufl_shape, tuple(free), e.ufl_index_dimensions
        if isinstance(e, ScalarValue):
            return (e._value,)
        if isinstance(e, Label):
            return (self._met(Label, e),)
        if isinstance(e, Coefficient):
            return self._met(Coefficient, e), self._space(e.ufl_function_space())
        if isinstance(e, Constant):
            return self._met(Constant, e), e.ufl_shape, self.domain(e.ufl_domain())
        if isinstance(e, BaseArgument):
            if e not in self.arguments:
                self.arguments.append(e)
            return e.number(), e.part(), self._space(e.ufl_function_space())
        if isinstance(e, GeometricQuantity):
            return (self.domain(extract_unique_domain(e)),)
        return (repr(e),)

    def _space(self, space: Any) -> tuple[str, int]:
        return repr(space.ufl_element()), self.domain(space.ufl_domain())
