"""UFL energies in flat element coordinates, as DOLFINx forms in the nodes' local frames.

The one idea of the package. For a cell with flat coordinates ``y`` (nodal positions and directors,
a relative motion ...) and a stored energy ``W(y)`` in UFL, a :class:`FrameMap` tells how ``y``
moves with the local-frame twists ``h = (v, η)`` of the nodes, ``δy = L(H) h``. Then::

    r = Lᵀ ∂W/∂y            K = Lᵀ (∂²W/∂y²) L + ∂(Lᵀ f)/∂h

FFCx compiles the derivatives of ``W``; one compiled kernel, the same for all energies and all maps,
calls what FFCx made, applies the map and condenses element-local fields ``s``. DOLFINx gets it as
a custom-kernel form. The kernel finds the addresses of FFCx's functions and of the map in a header
that travels with the form's constants: so nothing is compiled again when the energy changes, and
everything is cached on disk.

**Carried stress.** An energy given as strain and law, :class:`StrainEnergy`, has a stress field
``N`` at its quadrature points beside ``σ(ε)``: the residual uses ``σ(ε(y))``, the tangent
``δε·C·δε + N·δ²ε`` and the derivative of the map use ``N``, which after each solve becomes
``σ(ε) + C ε'(y) L h``. (Magisano, Leonetti & Garcea, CMAME 313 (2017) 986: mixed integration points.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import basix.ufl
import numba
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from ufl.core.expr import Expr

from fem_lie import _compat
from fem_lie._jit import callback, compiled

# --- calling by address, memory on the stack -----------------------------------------------------

_double_pointer = types.CPointer(types.float64)
UFCX_SIGNATURE = types.void(
    _double_pointer,
    _double_pointer,
    _double_pointer,
    _double_pointer,
    types.CPointer(types.int32),
    types.CPointer(types.uint8),
)
MAP_SIGNATURE = types.void(
    _double_pointer, _double_pointer, _double_pointer, _double_pointer, types.intp
)


@intrinsic
def stack(typing_context, size):  # type: ignore[no-untyped-def]
    """Uninitialised doubles in the caller's stack frame: no allocation per cell."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.alloca(ir.DoubleType(), size=arguments[0])

    return _double_pointer(size), generate


@intrinsic
def _shift(typing_context, pointer, offset):  # type: ignore[no-untyped-def]
    """``pointer + offset``, counted in doubles."""

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.gep(arguments[0], [arguments[1]])

    return _double_pointer(_double_pointer, types.intp), generate


def _call_by_address(argument_types: Sequence[ir.Type]) -> Callable[..., None]:
    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        function_type = ir.FunctionType(ir.VoidType(), argument_types)
        function = builder.inttoptr(arguments[0], function_type.as_pointer())
        # The C calling conventions let a callee ignore trailing arguments: null stands for the
        # `custom_data` that kernels take from DOLFINx 0.11 on, and does no harm before.
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
def _tabulate(typing_context, address, A, w, c, x, entity, permutation):  # type: ignore[no-untyped-def]
    """Call the UFCx function at ``address``."""
    return types.void(types.int64, *UFCX_SIGNATURE.args), _tabulate_code


@intrinsic
def _apply(typing_context, address, state, y, given, out, nodes):  # type: ignore[no-untyped-def]
    """Call the function of a :class:`FrameMap` at ``address``."""
    return types.void(types.int64, *MAP_SIGNATURE.args), _map_code


# --- the header: 64-bit integers in the form's constants ------------------------------------------

_COORDINATES, _PULL, _PUSH, _GEOMETRIC = 0, 1, 2, 3  # addresses of the map's functions
_N_Y, _N_S, _N_H, _NODES = 4, 5, 6, 7  # sizes: coordinates, local fields, unknowns, nodes
_AT_STATE, _AT_Y, _AT_H, _AT_DY = 8, 9, 10, 11  # offsets into the packed coefficients w
_FIRST, _SECOND = 12, 13  # where the descriptions of the two FFCx functions begin
_HEADER_SIZE = 14
# a description: address, offset of its constants, doubles of its w, number of segments, then
# (offset in our w, length) of each segment


@compiled
def _inner(head, at, A, w, c, x, entity, permutation):  # type: ignore[no-untyped-def]
    """Call the FFCx function described at ``head[at]`` with its own layout of coefficients."""
    constants = _shift(c, head[at + 1])
    segments = head[at + 3]
    if segments == 1:
        _tabulate(head[at], A, _shift(w, head[at + 4]), constants, x, entity, permutation)
        return
    own_pointer = stack(head[at + 2])
    own = numba.carray(own_pointer, (head[at + 2],))
    k = 0
    for segment in range(segments):
        start, length = head[at + 4 + 2 * segment], head[at + 5 + 2 * segment]
        source = numba.carray(_shift(w, start), (length,))
        for i in range(length):
            own[k] = source[i]
            k += 1
    _tabulate(head[at], A, own_pointer, constants, x, entity, permutation)


@compiled
def _clear(pointer, size):  # type: ignore[no-untyped-def]
    values = numba.carray(pointer, (size,))
    for i in range(size):
        values[i] = 0.0


@compiled
def _eliminate(K, f, n_y, n):  # type: ignore[no-untyped-def]
    """Gauss elimination of unknowns ``n_y … n-1`` from the rows of all, pivoting among them."""
    for k in range(n_y, n):
        pivot = k
        for i in range(k + 1, n):
            if abs(K[i, k]) > abs(K[pivot, k]):
                pivot = i
        if pivot != k:
            for j in range(n):
                K[k, j], K[pivot, j] = K[pivot, j], K[k, j]
            f[k], f[pivot] = f[pivot], f[k]
        for i in range(n):
            if i < n_y or i > k:
                factor = K[i, k] / K[k, k]
                for j in range(n):
                    K[i, j] -= factor * K[k, j]
                f[i] -= factor * f[k]


@compiled
def _back_substitute(K, f, dy, n_y, n):  # type: ignore[no-untyped-def]
    """After :func:`_eliminate`: ``f[n_y:] ← −K_ss⁻¹ (f_s + K_sy dy)``."""
    for k in range(n - 1, n_y - 1, -1):
        total = f[k]
        for j in range(n_y):
            total += K[k, j] * dy[j]
        for j in range(k + 1, n):
            total += K[k, j] * f[j]
        f[k] = -total / K[k, k]


# --- the kernels ------------------------------------------------------------------------------------


@compiled
def _prepare(w, c):  # type: ignore[no-untyped-def]
    """Header, pointers to state and coordinates; the coordinates are written into their slot."""
    head = numba.carray(c, (_HEADER_SIZE,)).view(np.int64)
    state, y = _shift(w, head[_AT_STATE]), _shift(w, head[_AT_Y])
    if head[_COORDINATES] != 0:
        _apply(head[_COORDINATES], state, y, y, y, head[_NODES])
    return head, state, y


@callback(UFCX_SIGNATURE)
def energy_kernel(A, w, c, x, entity, permutation):  # type: ignore[no-untyped-def]
    """Rank 0: the energy of a cell."""
    head, _, _ = _prepare(w, c)
    _inner(head, head[_FIRST], A, w, c, x, entity, permutation)


@callback(UFCX_SIGNATURE)
def residual_kernel(A, w, c, x, entity, permutation):  # type: ignore[no-untyped-def]
    """Rank 1: ``Lᵀ (f_y − K_ys K_ss⁻¹ f_s)``. First FFCx function: f, second: K."""
    head, state, y = _prepare(w, c)
    n_y, n = head[_N_Y], head[_N_Y] + head[_N_S]
    f = stack(n)
    _clear(f, n)
    _inner(head, head[_FIRST], f, w, c, x, entity, permutation)
    if n > n_y:
        K = stack(n * n)
        _clear(K, n * n)
        _inner(head, head[_SECOND], K, w, c, x, entity, permutation)
        _eliminate(numba.carray(K, (n, n)), numba.carray(f, (n,)), n_y, n)
    _apply(head[_PULL], state, y, f, A, head[_NODES])


@callback(UFCX_SIGNATURE)
def tangent_kernel(A, w, c, x, entity, permutation):  # type: ignore[no-untyped-def]
    """Rank 2: ``Lᵀ (K_yy − K_ys K_ss⁻¹ K_sy) L + ∂(Lᵀ f_y)/∂h``. First: K, second: carried f."""
    head, state, y = _prepare(w, c)
    n_y, n, n_h, nodes = head[_N_Y], head[_N_Y] + head[_N_S], head[_N_H], head[_NODES]
    K, f = stack(n * n), stack(n)
    _clear(K, n * n)
    _clear(f, n)
    _inner(head, head[_FIRST], K, w, c, x, entity, permutation)
    _inner(head, head[_SECOND], f, w, c, x, entity, permutation)
    if head[_GEOMETRIC] != 0:
        _apply(head[_GEOMETRIC], state, y, f, A, nodes)
    if n > n_y:
        _eliminate(numba.carray(K, (n, n)), numba.carray(f, (n,)), n_y, n)
    KL = stack(n_y * n_h)
    _clear(KL, n_y * n_h)
    for i in range(n_y):
        _apply(head[_PULL], state, y, _shift(K, i * n), _shift(KL, i * n_h), nodes)
    columns = numba.carray(KL, (n_y, n_h))
    column, pulled = stack(n_y), stack(n_h)
    column_values, pulled_values = numba.carray(column, (n_y,)), numba.carray(pulled, (n_h,))
    out = numba.carray(A, (n_h, n_h))
    for j in range(n_h):
        for i in range(n_y):
            column_values[i] = columns[i, j]
        _clear(pulled, n_h)
        _apply(head[_PULL], state, y, column, pulled, nodes)
        for i in range(n_h):
            out[i, j] += pulled_values[i]


@callback(UFCX_SIGNATURE)
def stress_kernel(A, w, c, x, entity, permutation):  # type: ignore[no-untyped-def]
    """Rank 1: the new carried stress, ``σ(ε) + C ε'(y) L h``, times the quadrature weights."""
    head, state, y = _prepare(w, c)
    dy = _shift(w, head[_AT_DY])
    _apply(head[_PUSH], state, y, _shift(w, head[_AT_H]), dy, head[_NODES])
    _inner(head, head[_FIRST], A, w, c, x, entity, permutation)


@callback(UFCX_SIGNATURE)
def local_kernel(A, w, c, x, entity, permutation):  # type: ignore[no-untyped-def]
    """Rank 1: increment of the local fields, ``−K_ss⁻¹ (f_s + K_sy L h)``. First: K, second: f."""
    head, state, y = _prepare(w, c)
    n_y, n = head[_N_Y], head[_N_Y] + head[_N_S]
    K, f, dy = stack(n * n), stack(n), stack(n_y)
    _clear(K, n * n)
    _clear(f, n)
    _inner(head, head[_FIRST], K, w, c, x, entity, permutation)
    _inner(head, head[_SECOND], f, w, c, x, entity, permutation)
    _apply(head[_PUSH], state, y, _shift(w, head[_AT_H]), dy, head[_NODES])
    matrix, vector = numba.carray(K, (n, n)), numba.carray(f, (n,))
    _eliminate(matrix, vector, n_y, n)
    _back_substitute(matrix, vector, numba.carray(dy, (n_y,)), n_y, n)
    out = numba.carray(A, (n - n_y,))
    for i in range(n - n_y):
        out[i] += vector[n_y + i]


# --- building the forms -----------------------------------------------------------------------------


@dataclass(frozen=True)
class FrameMap:
    """How flat element coordinates ``y`` move with the local-frame twists ``h`` of the nodes.

    Four compiled functions of signature :data:`MAP_SIGNATURE`, ``(state, y, given, out, nodes)``,
    made with :func:`frame_function`. ``state`` is what the nodes store (``values`` doubles each).

    Attributes:
        coordinates: ``y`` from the state; ``None`` if the state of the cell's nodes is ``y``.
        pull: ``out += Lᵀ given``, a force on ``y`` as forces and moments in the nodal frames.
        push: ``out = L given``, twists of the nodes as a variation of ``y``.
        geometric: ``out += ∂(Lᵀ given)/∂h``, a row-major square matrix; ``None`` if zero.
        values: Doubles stored per node.
        unknowns: Local-frame unknowns per node.
    """

    coordinates: Any
    pull: Any
    push: Any
    geometric: Any
    values: int
    unknowns: int


frame_function = callback(MAP_SIGNATURE)


@dataclass(frozen=True)
class StrainEnergy:
    """A stored energy ``∫ weight · law(ε) dx``, given as strain and law, so that stress can be carried.

    Attributes:
        strain: The strain measure ``ε(y)``, shape ``(n,)``, in UFL.
        law: Energy density as a UFL function of the strain.
        dx: Cell measure with an explicit ``quadrature_degree`` in its metadata.
        weight: Factor of the density, without dependence on ``y``.
    """

    strain: Expr
    law: Callable[[Expr], Expr]
    dx: ufl.Measure
    weight: Expr | float = 1.0

    def form(self) -> ufl.Form:
        """The energy as a UFL form."""
        return self.weight * self.law(self.strain) * self.dx


def packed_size(V: fem.FunctionSpace) -> int:
    """Doubles of a function in ``V`` per cell."""
    return int(V.dofmap.list.shape[1] * V.dofmap.bs)


class _Compiled:
    """A UFL form compiled by FFCx, with what a header must say of it."""

    def __init__(self, form: ufl.Form) -> None:
        if {integral.integral_type() for integral in form.integrals()} != {"cell"}:
            raise ValueError(f"the energy must be integrated over cells (dx) only, got {form}")
        self.form = fem.form(form)
        ufcx = self.form.ufcx_form
        count = ufcx.form_integral_offsets[1] - ufcx.form_integral_offsets[0]
        if count != 1:
            raise ValueError(
                f"the energy must have one cell integral, got {count}: use one dx (or dx(tag)) "
                "and DG0 coefficients for data that differ between parts of the mesh"
            )
        ids = self.form._cpp_object.integral_ids(fem.IntegralType.cell)
        self.cells = self.form._cpp_object.domains(fem.IntegralType.cell, ids[0])
        given = form.coefficients()
        positions = [ufcx.original_coefficient_positions[i] for i in range(ufcx.num_coefficients)]
        self.coefficients = [given[i] for i in positions]
        self.constants = list(form.constants())
        kernel = ufcx.form_integrals[0].tabulate_tensor_float64
        self.address = int(self.form.module.ffi.cast("uintptr_t", kernel))

    def description(self, offsets: dict[fem.Function, int], constants_at: int) -> list[int]:
        """Header entries: address, constants, size of ``w``, and its segments in the union layout."""
        segments: list[list[int]] = []
        for f in self.coefficients:
            start, length = offsets[f], packed_size(f.function_space)
            if segments and segments[-1][0] + segments[-1][1] == start:
                segments[-1][1] += length
            else:
                segments.append([start, length])
        size = sum(length for _, length in segments)
        flat = [number for segment in segments for number in segment]
        return [self.address, constants_at, size, len(segments), *flat]


@dataclass(frozen=True)
class _Layout:
    """What all kernels of one energy share: who the coordinates, the state and the increments are."""

    frame_map: FrameMap
    state: fem.Function
    coordinates: fem.Function
    increment: fem.Function
    local_size: int

    def form(
        self,
        kernel: Any,
        spaces: Sequence[fem.FunctionSpace],
        inner: Sequence[_Compiled],
        coordinate_increment: fem.Function | None = None,
    ) -> fem.Form:
        """Wrap FFCx's functions by one of our kernels into a DOLFINx form."""
        functions = dict.fromkeys([self.state, self.coordinates])
        functions |= dict.fromkeys(f for part in inner for f in part.coefficients)
        if coordinate_increment is not None or kernel is local_kernel:
            functions[self.increment] = None
        offsets, total = {}, 0
        for f in functions:
            offsets[f] = total
            total += packed_size(f.function_space)
        mesh = self.state.function_space.mesh
        header = self._header(offsets, coordinate_increment)
        sizes = [sum(int(np.prod(c.ufl_shape)) for c in part.constants) for part in inner]
        length = _HEADER_SIZE + sum(4 + 2 * len(part.coefficients) for part in inner)
        constants: list[fem.Constant] = []
        for k, part in enumerate(inner):
            header[_FIRST + k] = len(header)
            header += part.description(offsets, length + sum(sizes[:k]))
            constants += part.constants
        header += [0] * (length - len(header))
        bits = np.array(header, dtype=np.int64).view(np.float64)
        constants.insert(0, fem.Constant(mesh, bits))
        return _compat.custom_form(
            spaces, kernel.address, inner[0].cells, list(functions), constants, mesh
        )

    def _header(
        self, offsets: dict[fem.Function, int], coordinate_increment: fem.Function | None
    ) -> list[int]:
        def address(function: Any) -> int:
            return 0 if function is None else function.address

        unknowns = packed_size(self.increment.function_space)
        return [
            address(self.frame_map.coordinates),
            address(self.frame_map.pull),
            address(self.frame_map.push),
            address(self.frame_map.geometric),
            packed_size(self.coordinates.function_space),
            self.local_size,
            unknowns,
            unknowns // self.frame_map.unknowns,
            offsets[self.state],
            offsets[self.coordinates],
            offsets.get(self.increment, 0),
            0 if coordinate_increment is None else offsets[coordinate_increment],
            0,
            0,
        ]


class LocalFrameForms:
    """DOLFINx forms of a stored energy in the local frames of the nodes.

    Attributes:
        energy: Functional, rank 0.
        residual: Forces and moments in the nodal frames, rank 1, on the space of ``increment``.
        tangent: Its derivative with respect to local-frame increments, rank 2.
        increment: Function ``h`` read by :meth:`carry` (translation, rotation in each node's frame).
        stress: The carried stress at the quadrature points, or ``None`` for a plain energy.
    """

    def __init__(
        self,
        energy: StrainEnergy | ufl.Form,
        state: fem.Function,
        increment: fem.Function,
        frame_map: FrameMap,
        *,
        coordinates: fem.Function | None = None,
        local: fem.Function | None = None,
    ) -> None:
        """Differentiate, compile and wrap.

        Args:
            energy: ``W(y)``, or ``W(y, s)`` with element-local fields, as a UFL form; or strain and law.
            state: What the nodes store, ``frame_map.values`` doubles per node.
            increment: Function on the space of the local-frame unknowns.
            frame_map: How ``coordinates`` move with the nodes.
            coordinates: ``y``; the state itself if not given.
            local: Element-local fields ``s`` (a DG function), condensed and carried.

        Raises:
            ValueError: The measure has no quadrature degree, the energy no or several cell
                integrals, or both strain-and-law and local fields are given.
        """
        y = state if coordinates is None else coordinates
        self.increment, self.local, self.stress = increment, local, None
        self._layout = _Layout(
            frame_map, state, y, increment, 0 if local is None else packed_size(local.function_space)
        )
        self._space = increment.function_space
        if isinstance(energy, StrainEnergy):
            if local is not None:
                raise ValueError("give an energy with local fields as a UFL form, not as StrainEnergy")
            self._build_carried(energy, y)
        else:
            self._build_plain(energy, y, local)

    def _build_plain(self, energy: ufl.Form, y: fem.Function, local: fem.Function | None) -> None:
        if local is None:
            unknowns, space = y, y.function_space
        else:
            parts = [f.function_space.ufl_element() for f in (y, local)]
            space = fem.functionspace(y.function_space.mesh, basix.ufl.mixed_element(parts))
            unknowns = (y, local)
        test, trial = ufl.TestFunction(space), ufl.TrialFunction(space)
        gradient = ufl.derivative(energy, unknowns, test)
        force, stiffness = _Compiled(gradient), _Compiled(ufl.derivative(gradient, unknowns, trial))
        self._wrap(_Compiled(energy), force, stiffness, force)
        if local is not None:
            self._carry = self._layout.form(
                local_kernel, [local.function_space], [stiffness, force]
            )

    def _build_carried(self, energy: StrainEnergy, y: fem.Function) -> None:
        degree = (energy.dx.metadata() or {}).get("quadrature_degree")
        if degree is None:
            raise ValueError(
                "the measure of a StrainEnergy needs a quadrature degree: "
                'ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": 1})'
            )
        mesh, space = y.function_space.mesh, y.function_space
        points = basix.ufl.quadrature_element(
            mesh.basix_cell(), value_shape=energy.strain.ufl_shape, degree=degree
        )
        self.stress = fem.Function(fem.functionspace(mesh, points), name="carried stress")
        test, trial = ufl.TestFunction(space), ufl.TrialFunction(space)
        strain = ufl.variable(energy.strain)
        sigma = ufl.diff(energy.law(strain), strain)
        moduli = ufl.diff(sigma, strain)
        dstrain = ufl.derivative(energy.strain, y, test)
        weight, dx = energy.weight, energy.dx
        force = weight * ufl.inner(self.stress, dstrain) * dx
        variation = ufl.derivative(energy.strain, y, trial)
        stiffness = weight * ufl.inner(dstrain, moduli * variation) * dx
        stiffness += ufl.derivative(force, y, trial)
        self._wrap(
            _Compiled(energy.form()),
            _Compiled(ufl.derivative(energy.form(), y, test)),
            _Compiled(stiffness),
            _Compiled(force),
        )
        dy, tau = fem.Function(space), ufl.TestFunction(self.stress.function_space)
        new = sigma + moduli * ufl.derivative(energy.strain, y, dy)
        carried = _Compiled(ufl.inner(new, tau) * energy.dx)
        self._carry = self._layout.form(
            stress_kernel, [self.stress.function_space], [carried], coordinate_increment=dy
        )
        one = ufl.inner(ufl.as_vector([1.0] * energy.strain.ufl_shape[0]), tau) * energy.dx
        self._weights = fem.assemble_vector(fem.form(one)).array

    def _wrap(
        self, energy: _Compiled, force: _Compiled, stiffness: _Compiled, carried: _Compiled
    ) -> None:
        V, form = self._space, self._layout.form
        condensed = [stiffness] if self._layout.local_size else []
        self.energy = form(energy_kernel, [], [energy])
        self.residual = form(residual_kernel, [V], [force, *condensed])
        self.tangent = form(tangent_kernel, [V, V], [stiffness, carried])

    def carry(self) -> None:
        """Update the carried stress, or the local fields, by the increment ``h`` about to be made.

        Call it after the solve and *before* the state is updated by ``h``.
        """
        if self.stress is not None:
            new = fem.assemble_vector(self._carry)
            self.stress.x.array[:] = new.array / self._weights
        elif self.local is not None:
            self.local.x.array[:] += fem.assemble_vector(self._carry).array
