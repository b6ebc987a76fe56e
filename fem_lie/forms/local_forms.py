"""DOLFINx forms along nodal frames of UFL energies in flat element coordinates.

For a cell with flat coordinates ``y`` (nodal positions and directors, a relative motion ...) and a
strain energy ``W(y)`` in UFL, a :class:`FrameMap` gives the variation of ``y`` for twists ``h = (v,
η)`` of the nodes along their frames, ``δy = L(H) h``. Then the forces and the tangent stiffness
are::

    r = Lᵀ ∂W/∂y            K = Lᵀ (∂²W/∂y²) L + ∂(Lᵀ f)/∂h

FFCx compiles the derivatives of ``W``; the kernels of :mod:`fem_lie.forms.kernels` call these
functions and apply the map. DOLFINx assembles them as forms with custom kernels.

**Element-local fields.** For ``W(y, s)`` with stress or strain parameters ``s``, the kernels
condense ``s`` cell by cell, ``r = Lᵀ (W_y − W_ys W_ss⁻¹ W_s)``, ``K`` likewise, and
:meth:`LocalFrameForms.update_stress` adds ``δs = −W_ss⁻¹ (W_s + W_sy L h)``: for mixed energies
such as those of Hellinger-Reissner and Hu-Washizu.

**Independent stress.** An energy given as strain and law, :class:`StrainEnergy`, has an independent
stress field ``N`` at its quadrature points besides ``σ(ε)``: the residual uses ``σ(ε(y))``; the
tangent ``δε·C·δε + N·δ²ε`` and the derivative of the map use ``N``, which is updated linearly after
each solve, ``N ← σ(ε) + C ε'(y) L h``. (Magisano, Leonetti & Garcea, CMAME 313 (2017) 986: mixed
integration points.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fem_lie._arrays import Array
from fem_lie._form_cache import compile_form
from fem_lie.forms.energy import Forces, StrainEnergy
from fem_lie.forms.kernels import in_local_frames as kernels
from fem_lie.forms.kernels.addresses import FrameMap
from fem_lie.forms.wrapping import CompiledForm, Entities, Wrapping, packed_size


class LocalFrameForms:
    """DOLFINx forms of a strain energy along the frames of the nodes.

    They are assembled over the cells that a rank owns, like any form: contributions to ghosts
    remain to be added at their owners (``scatter_reverse``).

    Attributes:
        energy: Strain energy, rank 0; absent if a virtual work is given.
        has_energy: Whether there is an energy.
        entities: Cells, or facets, over which it is integrated.
        residual: Forces and moments along nodal frames, rank 1, on the space of ``increment``.
        residual_kernel: Kernel of ``residual``.
        found_energy: Function of the form to which that kernel writes the energy of a cell, or
            ``None``.
        tangent: Tangent stiffness in increments along nodal frames, rank 2.
        increment: Function ``h`` that :meth:`update_stress` reads: translation, rotation along
            nodal frames.
        local: Element-local fields ``s``, or ``None``.
        stress: Independent stress at the quadrature points, or ``None`` for a plain energy.
        viscous: Viscous forces at the twists ``velocity``, rank 1, or ``None``.
        viscous_tangent: Derivative of the viscous forces in the twists, rank 2, or ``None``.
        viscous_kernels: Kernels of both.
        velocity: Function that ``viscous`` reads: twists of the nodes along their frames.
        local_change: Change of the local fields that :meth:`update_stress` adds, rank 1, if there
            are any.
        local_size: Number of local fields of a cell.
        local_is_linear: Whether ``W_ss`` is constant, so that the kernels condense the local
            fields exactly.
        velocity_at: Index of ``velocity`` in the packed coefficients of ``viscous``.
    """

    energy: fem.Form
    has_energy: bool
    entities: Entities
    residual: fem.Form
    residual_kernel: Any
    found_energy: fem.Function | None
    tangent: fem.Form
    viscous: fem.Form | None = None
    viscous_tangent: fem.Form | None = None
    viscous_kernels: tuple[Any, Any] = kernels.viscous_kernel, kernels.tangent_kernel
    velocity: fem.Function
    velocity_at: int
    local_is_linear: bool = True

    def __init__(
        self,
        energy: StrainEnergy | ufl.Form,
        state: fem.Function,
        increment: fem.Function,
        frame_map: FrameMap,
        *,
        coordinates: fem.Function | None = None,
        local: fem.Function | None = None,
        relaxation: float = 0.0,
    ) -> None:
        """Differentiate, compile and wrap the energy.

        Args:
            energy: ``W(y)``, or ``W(y, s)`` with element-local fields, as a UFL form over cells or
                exterior facets; a :class:`StrainEnergy`; or a virtual work ``f(y)·δy``, linear in
                ``δy``, of forces without energy.
            state: Stored nodal coordinates, ``frame_map.values`` doubles per node.
            increment: Function on the space of the unknowns along nodal frames.
            frame_map: Variation of ``coordinates`` for twists of the nodes.
            coordinates: ``y``, if the map computes it from the state; by default the state is
                ``y``.
            local: Element-local fields ``s`` (a discontinuous function), condensed and updated
                linearly. The second derivative of ``W`` in ``s`` must be regular.
            relaxation: Relaxation time ``τ`` of Kelvin-Voigt damping, 0: none. The viscosity is τ
                times the moduli of the unloaded law; with local fields, viscous forces are ``−τ
                Lᵀ W_ys W_ss⁻¹ W_sy L v``, the tangent stiffness without that of the stress. Of a
                plain energy it is not known.

        Raises:
            ValueError: The local fields are continuous between cells, the measure has no quadrature
                degree, the energy has no or several integrals or does not depend on ``y``, a
                :class:`StrainEnergy` or a virtual work is given with local fields, a plain energy
                or a virtual work with a relaxation time, the virtual work is in another space than
                ``y``, or the function spaces do not match the map.
        """
        _check_spaces(state, increment, frame_map, coordinates)
        if local is not None:
            _check_local(local)
        self.increment, self.local = increment, local
        self.stress: fem.Function | None = None
        y = state if coordinates is None else coordinates
        if relaxation and local is None and isinstance(energy, ufl.Form):
            raise ValueError(
                "viscous forces need strains: give the energy as a StrainEnergy, or with local "
                "fields"
            )
        self._relaxation = fem.Constant(state.function_space.mesh, float(relaxation))
        self.local_size = 0 if local is None else packed_size(local.function_space)
        self._wrapping = Wrapping(frame_map, state, y, increment, self.local_size)
        if isinstance(energy, ufl.Form) and energy.arguments():
            self._build_virtual_work(energy, y)
        elif isinstance(energy, ufl.Form):
            self._build_plain(energy, y)
        elif local is None:
            self._build_with_stress(energy, y)
        else:
            raise ValueError("give an energy with local fields as a UFL form, not as StrainEnergy")

    def _build_plain(self, energy: ufl.Form, y: fem.Function) -> None:
        test, trial = (make(y.function_space) for make in (ufl.TestFunction, ufl.TrialFunction))
        gradient = ufl.derivative(energy, y, test)
        force = CompiledForm(gradient)
        if force.address == 0:
            raise ValueError(f"the energy does not depend on the coordinates {y}: {energy}")
        stiffness = CompiledForm(ufl.derivative(gradient, y, trial))
        if self.local is None:
            self._wrap(CompiledForm(energy), [force], [stiffness, force])
            return
        s, S = self.local, self.local.function_space
        rows = ufl.derivative(energy, s, ufl.TestFunction(S))
        # products with vectors where possible: a matrix costs several times as much
        z, dy = fem.Function(S), fem.Function(y.function_space)
        condensed = CompiledForm(gradient - ufl.derivative(gradient, s, z))
        changed = CompiledForm(rows + ufl.derivative(rows, y, dy))
        coupling = CompiledForm(ufl.derivative(rows, y, trial))
        second = ufl.derivative(rows, s, ufl.TrialFunction(S))
        own = CompiledForm(second)
        self.local_is_linear = not {s, y} & set(own.coefficients)
        self._wrap(
            CompiledForm(energy),
            [condensed, CompiledForm(rows), own],
            [stiffness, force, coupling, own],
            scratch=[z],
        )
        extra = [self.increment, dy]
        self._update_stress = self._wrapping.form(kernels.local_kernel, [S], [changed, own], extra)
        if self._relaxation.value:
            slower = CompiledForm((1.0 / self._relaxation) * second)
            of_rate = CompiledForm(ufl.derivative(rows, y, dy))
            back = CompiledForm(-ufl.derivative(gradient, s, z))
            self._build_condensed_viscous([of_rate, slower, back], [coupling, slower], [dy, z])

    def _build_virtual_work(self, work: ufl.Form, y: fem.Function) -> None:
        if self.local is not None:
            raise ValueError("local fields need an energy, got a virtual work (a linear form)")
        spaces = [argument.ufl_function_space() for argument in work.arguments()]
        if spaces != [y.function_space]:
            raise ValueError(
                "a virtual work must be linear in one variation of the coordinates, such as "
                f"ufl.derivative(q.position, q.function), got arguments in {spaces}"
            )
        force = CompiledForm(work)
        stiffness = CompiledForm(ufl.derivative(work, y, ufl.TrialFunction(y.function_space)))
        self._wrap(None, [force], [stiffness, force])

    def _build_with_stress(self, energy: StrainEnergy, y: fem.Function) -> None:
        space, points = y.function_space, energy.quadrature_element()
        self.stress = fem.Function(fem.functionspace(space.mesh, points), name="independent stress")
        test, trial = ufl.TestFunction(space), ufl.TrialFunction(space)
        strain = ufl.variable(energy.strain)
        sigma = ufl.diff(energy.law(strain), strain)
        moduli = ufl.diff(sigma, strain)
        variation, weight, dx = energy.change(y, test), energy.weight, energy.dx
        stiffness = energy.stiffness(self.stress, moduli, y, test, trial)
        of_stress = CompiledForm(weight * ufl.inner(self.stress, variation) * dx)
        derived = energy.forces is None
        self._wrap(
            CompiledForm(energy.form()),
            [CompiledForm(weight * ufl.inner(sigma, variation) * dx) if derived else of_stress],
            [CompiledForm(weight * stiffness * dx), of_stress],
            energy.forces,
        )
        if self._relaxation.value:
            energy = replace(energy, viscosity=self._relaxation * _unloaded_moduli(energy))
        if energy.viscosity is not None:
            self._build_viscous(energy, y)
        dy, tau = fem.Function(space), ufl.TestFunction(self.stress.function_space)
        new = sigma + moduli * energy.change(y, dy)
        self._update_stress = self._wrapping.form(
            kernels.stress_kernel,
            [self.stress.function_space],
            [CompiledForm(ufl.inner(new, tau) * dx)],
            extra=[self.increment, dy],
        )
        one = ufl.as_vector([1.0] * energy.strain.ufl_shape[0])
        weights = fem.assemble_vector(compile_form(ufl.inner(one, tau) * dx)).array
        # cells of other ranks, and cells without energy, have zero weights and zero stress
        self._per_weight = np.divide(1.0, weights, out=np.zeros_like(weights), where=weights != 0)

    def _build_viscous(self, energy: StrainEnergy, y: fem.Function) -> None:
        """Build the forces ``Lᵀ ε'ᵀ η ε' L v`` and their derivative in ``v``."""
        V, space = self.increment.function_space, y.function_space
        self.velocity = fem.Function(V, name="velocity")
        self.velocity_at = self._wrapping.extra_at
        test, rate = ufl.TestFunction(space), fem.Function(space)

        def work(change: fem.Function | ufl.Argument) -> ufl.Form:
            stress = energy.viscosity * energy.rate(y, change)
            return energy.weight * ufl.inner(energy.rate(y, test), stress) * energy.dx

        self.viscous = self._wrapping.form(
            kernels.viscous_kernel, [V], [CompiledForm(work(rate))], extra=[self.velocity, rate]
        )
        matrix = CompiledForm(work(ufl.TrialFunction(space)))
        self._stored.append(matrix)
        self.viscous_tangent = self._wrapping.form(kernels.tangent_kernel, [V, V], [matrix])

    def _build_condensed_viscous(
        self,
        forces: Sequence[CompiledForm],
        tangent: Sequence[CompiledForm],
        extra: Sequence[fem.Function],
    ) -> None:
        """Build the forces ``−τ Lᵀ W_ys W_ss⁻¹ W_sy L v`` and their derivative in ``v``."""
        V = self.increment.function_space
        kinds = kernels.condensed_viscous_kernel, kernels.condensed_viscous_tangent_kernel
        self.viscous_kernels = kinds
        self.velocity = fem.Function(V, name="velocity")
        self.velocity_at = self._wrapping.extra_at
        self.viscous = self._wrapping.form(kinds[0], [V], forces, extra=[self.velocity, *extra])
        self.viscous_tangent = self._wrapping.form(kinds[1], [V, V], tangent)
        self._stored.append(tangent[1])

    def _wrap(
        self,
        energy: CompiledForm | None,
        residual: Sequence[CompiledForm],
        tangent: Sequence[CompiledForm],
        forces: Forces | None = None,
        scratch: Sequence[fem.Function] = (),
    ) -> None:
        forces = Forces(kernels.residual_kernel) if forces is None else forces
        V, form = self.increment.function_space, self._wrapping.form
        self._stored = [residual[0] if energy is None else energy]
        self.has_energy = energy is not None
        if energy is not None:
            self.energy = form(kernels.energy_kernel, [], [energy])
        self.residual_kernel, self.found_energy = forces.kernel, forces.energy
        self.residual = form(forces.kernel, [V], residual, forces.reads, scratch=scratch)
        self.tangent = form(kernels.tangent_kernel, [V, V], tangent, alike=self._stored)
        self.entities = Entities.of(self.residual, self._stored[0].kind)

    @property
    def contents(self) -> tuple[str, list[Array], list[Array]]:
        """Signature of energy and viscosity, and current values of constants and coefficients.

        They are equal in all processes, and do not include values that depend on the state of the
        nodes.
        """
        own = self._wrapping.state, self._wrapping.coordinates, self.local
        given = [f for part in self._stored for f in part.coefficients]
        given = [f for f in given if not any(f is other for other in own)]
        constants = [c for part in self._stored for c in part.constants]
        values = [np.asarray(c.value, dtype=np.float64) for c in constants]
        signature = " ".join(part.signature for part in self._stored)
        return signature, values, [f.x.array.copy() for f in given]

    @property
    def local_change(self) -> fem.Form:
        """Change of the local fields by :meth:`update_stress`, rank 1."""
        return self._update_stress

    def update_stress(self) -> None:
        """Update the independent stress, or the local fields, for the increment ``h``.

        Call it after the solve and *before* the state is updated by ``h``.
        """
        if self.stress is not None:
            new = self.stress.x
            new.array[:] = 0.0
            fem.assemble_vector(new.array, self._update_stress)
            new.array[:] *= self._per_weight
            new.scatter_forward()
        elif self.local is not None:
            fem.assemble_vector(self.local.x.array, self._update_stress)
            self.local.x.scatter_forward()


def _unloaded_moduli(energy: StrainEnergy) -> Expr:
    """Second derivative of the law at zero strain."""
    mesh = ufl.domain.extract_unique_domain(energy.strain)
    zero = ufl.variable(fem.Constant(mesh, np.zeros(energy.strain.ufl_shape)))
    return ufl.diff(ufl.diff(energy.law(zero), zero), zero)


def _check_local(local: fem.Function) -> None:
    """Raise ``ValueError`` for fields that cells share, which cannot be condensed cell by cell."""
    space = local.function_space
    layout, dim = space.dofmap.dof_layout, space.mesh.topology.dim
    if any(layout.entity_dofs(below, 0) for below in range(dim)):
        raise ValueError(
            "local fields must be discontinuous between cells, such as DG, as they are condensed "
            f"cell by cell, got {space.ufl_element()}; a field that cells share belongs to the "
            "global unknowns"
        )


def _check_spaces(
    state: fem.Function,
    increment: fem.Function,
    frame_map: FrameMap,
    coordinates: fem.Function | None,
) -> None:
    """Raise ``ValueError`` for spaces with which kernels would access memory out of bounds."""
    for name, f, expected in (
        ("state", state, frame_map.values),
        ("increment", increment, frame_map.unknowns),
    ):
        if f.function_space.dofmap.bs != expected:
            raise ValueError(
                f"the {name} must have {expected} values per node for this map, "
                f"got {f.function_space.dofmap.bs}"
            )
    nodes = [f.function_space.dofmap.list.shape[1] for f in (state, increment)]
    if nodes[0] != nodes[1]:
        raise ValueError(f"state and increment must have the same nodes, got {nodes} per cell")
    if (coordinates is None) != (frame_map.coordinates is None):
        raise ValueError(
            "coordinates are needed if and only if the map computes them from the state: "
            f"this map does{' not' if frame_map.coordinates is None else ''}"
        )
