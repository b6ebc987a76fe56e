"""FFCx's functions wrapped by the kernels of :mod:`fem_lie.forms.kernels` into DOLFINx forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import IntegralType

from fem_lie import _compat
from fem_lie._arrays import Array, Indices
from fem_lie._form_cache import compiled
from fem_lie.forms.kernels import in_local_frames as kernels
from fem_lie.forms.kernels.addresses import FrameMap

KINDS = {"cell": IntegralType.cell, "exterior_facet": IntegralType.exterior_facet}
"""Kinds of integrals that can be wrapped, by UFL's names."""


class Entities(NamedTuple):
    """Cells, or facets, over which a form is integrated, in the order of their local numbers.

    Attributes:
        order: Index of each among those of the form, shape (m,).
        cells: Cell of each, shape (m,).
        facets: Local number of each facet in its cell; zero for cells, shape (m,).
    """

    order: Indices
    cells: Indices
    facets: Indices

    @classmethod
    def of(cls, form: fem.Form, kind: IntegralType) -> Entities:
        """Entities of a form with one integral."""
        found = _compat.integration_entities(form, kind).astype(np.int64)
        pairs = found.reshape(-1, 2 if kind == IntegralType.exterior_facet else 1)
        cells, facets = pairs[:, 0], pairs[:, 1] if pairs.shape[1] > 1 else np.zeros_like(found)
        order = np.argsort(facets, kind="stable")
        return cls(order, cells[order], facets[order])

    @property
    def sizes(self) -> Indices:
        """Number of entities of each local number, shape (numbers,)."""
        return np.unique(self.facets, return_counts=True)[1]

    def constants(self, packed: Array) -> Array:
        """Constants for each local number, which their header contains, shape (numbers, any)."""
        numbers = np.unique(self.facets)
        found = np.tile(packed, (len(numbers), 1))
        found.view(np.int64)[:, kernels.ENTITY] = numbers
        return found


def packed_size(V: fem.FunctionSpace) -> int:
    """Doubles of a function in ``V`` per cell."""
    return int(V.dofmap.list.shape[1] * V.dofmap.bs)


class CompiledForm:
    """UFL form compiled by FFCx, with the data for a header.

    Attributes:
        kind: Integral over cells (dx) or exterior facets (ds).
        entities: Cells, or pairs (cell, local facet) in one row; empty if the form is zero.
        coefficients: Functions that FFCx's function reads, in its order; those of which derivatives
            are left.
        constants: Constants in that order.
        address: Address of FFCx's function; 0 if the form is zero, as second derivatives may be.
        signature: Signature of the form, equal in all processes.
    """

    def __init__(self, form: ufl.Form) -> None:
        names = {integral.integral_type() for integral in form.integrals()}
        if len(names) != 1 or not names <= set(KINDS):
            raise ValueError(
                "the energy must be integrated over cells (dx) or over exterior facets (ds), got "
                f"{' and '.join(sorted(names))} in {form}; a sum over both is two LocalFrameForms, "
                "which fl.FrameProblem adds"
            )
        self.kind = KINDS[names.pop()]
        self._form, of_form = compiled(form)
        data = self._form.ufcx_form
        count = data.form_integral_offsets[len(KINDS)] - data.form_integral_offsets[0]
        # dx((1, 2)) has one function for both subdomains
        addresses = {
            int(self._form.module.ffi.cast("uintptr_t", integral.tabulate_tensor_float64))
            for integral in (data.form_integrals[i] for i in range(count))
        }
        if len(addresses) > 1:
            raise ValueError(
                f"the energy must have one integral, got {count}: make LocalFrameForms of the "
                "energy of each subdomain, dx(1) and dx(2), which fl.FrameProblem adds, or use one "
                "dx and DG0 coefficients"
            )
        self.coefficients = _compat.coefficients_of(data, of_form.coefficients)
        self.constants = of_form.constants
        self.signature = self._form.module.ffi.string(data.signature).decode()
        self.address = max(addresses, default=0)
        self.entities = _compat.integration_entities(self._form, self.kind)

    def description(self, offsets: dict[fem.Function, int], constants_at: int) -> list[int]:
        """Header entries: address, constants, size of ``w``, offset and length of segments."""
        segments: list[list[int]] = []
        for f in self.coefficients:
            start, length = offsets[f], packed_size(f.function_space)
            if segments and sum(segments[-1]) == start:
                segments[-1][1] += length
            else:
                segments.append([start, length])
        size = sum(length for _, length in segments)
        flat = [number for segment in segments for number in segment]
        return [self.address, constants_at, size, len(segments), *flat]


@dataclass(frozen=True)
class Wrapping:
    """Data common to all forms of one energy.

    Attributes:
        frame_map: Map from ``coordinates`` to the nodes.
        state: Stored nodal coordinates.
        coordinates: Flat element coordinates ``y``; the state itself, or a function that the map
            fills.
        increment: Unknowns ``h`` along nodal frames.
        local_size: Number of element-local unknowns ``s`` of a cell.
    """

    frame_map: FrameMap
    state: fem.Function
    coordinates: fem.Function
    increment: fem.Function
    local_size: int

    @property
    def extra_at(self) -> int:
        """Index of the first extra function of a form in its packed coefficients."""
        known = dict.fromkeys([self.state, self.coordinates])
        return sum(packed_size(f.function_space) for f in known)

    def form(
        self,
        kernel: Any,
        spaces: Sequence[fem.FunctionSpace],
        inner: Sequence[CompiledForm],
        extra: Sequence[fem.Function] = (),
        *,
        scratch: Sequence[fem.Function] = (),
        alike: Sequence[CompiledForm] = (),
    ) -> fem.Form:
        """Form with one kernel around FFCx's functions.

        Args:
            kernel: One of :mod:`fem_lie.forms.kernels`.
            spaces: Function spaces of the arguments of the new form.
            inner: One to four compiled forms, in the order that the kernel expects.
            extra: Functions that the kernel reads or fills: the increment ``h``, and ``δy = L h``.
            scratch: Functions that the kernel fills, right after the state: ``z`` of the residual
                with element-local fields.
            alike: Further forms whose coefficients are coefficients, too, so that another form has
                the same ones.
        """
        # state first: fem_lie.forms.assembly writes it into the packed coefficients itself
        functions = dict.fromkeys([self.state, *scratch, self.coordinates, *extra])
        # in one order, so that forms of the same functions share what is packed
        read = {f for part in (*inner, *alike) for f in part.coefficients}
        functions |= dict.fromkeys(sorted(read, key=lambda f: f.count()))
        sizes = [packed_size(f.function_space) for f in functions]
        starts = np.cumsum([0, *sizes[:-1]]).tolist()
        offsets = dict(zip(functions, starts, strict=True))
        constants = [c for part in inner for c in part.constants]
        mesh = self.state.function_space.mesh
        # constants are doubles; kernels reinterpret the bits as integers
        bits = np.array(self._header(inner, offsets, [*scratch, *extra]), dtype=np.int64).view(
            np.float64
        )
        constants.insert(0, fem.Constant(mesh, bits))
        entities = max((part.entities for part in inner), key=len)  # a zero form has none
        return _compat.custom_form(
            spaces, kernel.address, inner[0].kind, entities, list(functions), constants, mesh
        )

    def _header(
        self,
        inner: Sequence[CompiledForm],
        offsets: dict[fem.Function, int],
        extra: Sequence[fem.Function],
    ) -> list[int]:
        """Header of integers that :mod:`fem_lie.forms.kernels` reads."""
        unknowns = packed_size(self.increment.function_space)
        head = [0] * kernels.HEADER_SIZE
        for entry, function in (
            (kernels.COORDINATES, self.frame_map.coordinates),
            (kernels.PULL_BACK, self.frame_map.pull_back),
            (kernels.PUSH_FORWARD, self.frame_map.push_forward),
            (kernels.GEOMETRIC, self.frame_map.geometric),
        ):
            head[entry] = 0 if function is None else function.address
        head[kernels.N_Y] = packed_size(self.coordinates.function_space)
        head[kernels.N_S] = self.local_size
        head[kernels.N_H] = unknowns
        head[kernels.NODES] = unknowns // self.frame_map.unknowns
        head[kernels.AT_STATE] = offsets[self.state]
        head[kernels.AT_Y] = offsets[self.coordinates]
        for entry, f in zip((kernels.AT_H, kernels.AT_DY), extra, strict=False):
            head[entry] = offsets[f]
        # the constants follow the header, so its length must be known before it is written
        constants_at = len(head) + sum(len(part.description(offsets, 0)) for part in inner)
        descriptions = kernels.FIRST, kernels.SECOND, kernels.THIRD, kernels.FOURTH
        for entry, part in zip(descriptions, inner, strict=False):
            head[entry] = len(head)
            head += part.description(offsets, constants_at)
            constants_at += sum(int(np.prod(c.ufl_shape)) for c in part.constants)
        return head
