"""UFL energies in flat element coordinates, as DOLFINx forms in the nodes' local frames.

The one idea of the package. For a cell with flat coordinates ``y`` (nodal positions and directors,
a relative motion ...) and a stored energy ``W(y)`` in UFL, a :class:`FrameMap` tells how ``y``
moves with the local-frame twists ``h = (v, η)`` of the nodes, ``δy = L(H) h``. Then::

    r = Lᵀ ∂W/∂y            K = Lᵀ (∂²W/∂y²) L + ∂(Lᵀ f)/∂h

FFCx compiles the derivatives of ``W``; the kernels of :mod:`fem_lie.forms.kernels` call what FFCx
made and apply the map. DOLFINx gets them as custom-kernel forms.

**Element-local fields.** ``W(y, s)`` with stress or strain parameters ``s``: the kernels eliminate
``s`` cell by cell, ``r = Lᵀ (W_y − W_ys W_ss⁻¹ W_s)``, ``K`` likewise, and
:meth:`LocalFrameForms.carry` adds ``δs = −W_ss⁻¹ (W_s + W_sy L h)``: mixed energies such as those
of Hellinger-Reissner and Hu-Washizu.

**Carried stress.** An energy given as strain and law, :class:`StrainEnergy`, has a stress field
``N`` at its quadrature points beside ``σ(ε)``: the residual uses ``σ(ε(y))``, the tangent
``δε·C·δε + N·δ²ε`` and the derivative of the map use ``N``, which after each solve becomes
``σ(ε) + C ε'(y) L h``. (Magisano, Leonetti & Garcea, CMAME 313 (2017) 986: mixed integration
points.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from fem_lie._arrays import Array
from fem_lie._form_cache import compile_form
from fem_lie.forms.energy import Forces, StrainEnergy
from fem_lie.forms.kernels import in_local_frames as kernels
from fem_lie.forms.kernels.addresses import FrameMap
from fem_lie.forms.wrapping import CompiledForm, Wrapping, packed_size


class LocalFrameForms:
    """DOLFINx forms of a stored energy in the local frames of the nodes.

    They are assembled over the cells that a rank owns, like any form: the entries of ghosts are
    still to be added to their owners (``scatter_reverse``).

    Attributes:
        energy: Functional, rank 0.
        residual: Forces and moments in the nodal frames, rank 1, on the space of ``increment``.
        residual_kernel: What stands behind it.
        found_energy: Where that leaves the energy of a cell, one of the functions of the form, or
            ``None``.
        tangent: Its derivative with respect to local-frame increments, rank 2.
        increment: Function ``h`` read by :meth:`carry`: translation, rotation in nodal frames.
        local: The element-local fields ``s``, or ``None``.
        stress: The carried stress at the quadrature points, or ``None`` for a plain energy.
        viscous: Viscous forces at the twists ``velocity``, rank 1, or ``None``.
        viscous_tangent: Their derivative with respect to the twists, rank 2, or ``None``.
        velocity: Function read by ``viscous``: local twists of the nodes.
        local_change: Change of the local fields that :meth:`carry` adds, rank 1, if there are any.
        local_size: Number of local fields of a cell.
        velocity_at: Where its values begin among the packed coefficients of ``viscous``.
    """

    energy: fem.Form
    residual: fem.Form
    residual_kernel: Any
    found_energy: fem.Function | None
    tangent: fem.Form
    viscous: fem.Form | None = None
    viscous_tangent: fem.Form | None = None
    velocity: fem.Function
    velocity_at: int

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
            energy: ``W(y)``, or ``W(y, s)`` with element-local fields, as a UFL form; or strain and
                law.
            state: What the nodes store, ``frame_map.values`` doubles per node.
            increment: Function on the space of the local-frame unknowns.
            frame_map: How ``coordinates`` move with the nodes.
            coordinates: ``y``, if the map computes it from the state; otherwise it is the state.
            local: Element-local fields ``s`` (a discontinuous function), condensed and carried. The
                second derivative of ``W`` in ``s`` must be regular.

        Raises:
            ValueError: The local fields are continuous between cells, the measure has no quadrature
                degree, the energy has no or several cell
                integrals or does not depend on ``y``, both strain-and-law and local fields are
                given, or the functions do not fit the map.
        """
        _check_spaces(state, increment, frame_map, coordinates)
        if local is not None:
            _check_local(local)
        self.increment, self.local = increment, local
        self.stress: fem.Function | None = None
        y = state if coordinates is None else coordinates
        self.local_size = 0 if local is None else packed_size(local.function_space)
        self._wrapping = Wrapping(frame_map, state, y, increment, self.local_size)
        if not isinstance(energy, StrainEnergy):
            self._build_plain(energy, y)
        elif local is None:
            self._build_carried(energy, y)
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
        # products with vectors where they will do: a matrix costs several times as much
        z, dy = fem.Function(S), fem.Function(y.function_space)
        condensed = CompiledForm(gradient - ufl.derivative(gradient, s, z))
        changed = CompiledForm(rows + ufl.derivative(rows, y, dy))
        coupling = CompiledForm(ufl.derivative(rows, y, trial))
        own = CompiledForm(ufl.derivative(rows, s, ufl.TrialFunction(S)))
        self._wrap(
            CompiledForm(energy),
            [condensed, CompiledForm(rows), own],
            [stiffness, force, coupling, own],
            Forces(kernels.residual_kernel, [z]),
        )
        extra = [self.increment, dy]
        self._carry = self._wrapping.form(kernels.local_kernel, [S], [changed, own], extra)

    def _build_carried(self, energy: StrainEnergy, y: fem.Function) -> None:
        space, points = y.function_space, energy.quadrature_element()
        self.stress = fem.Function(fem.functionspace(space.mesh, points), name="carried stress")
        test, trial = ufl.TestFunction(space), ufl.TrialFunction(space)
        strain = ufl.variable(energy.strain)
        sigma = ufl.diff(energy.law(strain), strain)
        moduli = ufl.diff(sigma, strain)
        variation, weight, dx = energy.change(y, test), energy.weight, energy.dx
        stiffness = energy.stiffness(self.stress, moduli, y, test, trial)
        carried = CompiledForm(weight * ufl.inner(self.stress, variation) * dx)
        derived = energy.forces is None
        self._wrap(
            CompiledForm(energy.form()),
            [CompiledForm(weight * ufl.inner(sigma, variation) * dx) if derived else carried],
            [CompiledForm(weight * stiffness * dx), carried],
            energy.forces,
        )
        if energy.viscosity is not None:
            self._build_viscous(energy, y)
        dy, tau = fem.Function(space), ufl.TestFunction(self.stress.function_space)
        new = sigma + moduli * energy.change(y, dy)
        self._carry = self._wrapping.form(
            kernels.stress_kernel,
            [self.stress.function_space],
            [CompiledForm(ufl.inner(new, tau) * dx)],
            extra=[self.increment, dy],
        )
        one = ufl.as_vector([1.0] * energy.strain.ufl_shape[0])
        weights = fem.assemble_vector(compile_form(ufl.inner(one, tau) * dx)).array
        # cells of other ranks, and cells without energy, have no weights and keep no stress
        self._per_weight = np.divide(1.0, weights, out=np.zeros_like(weights), where=weights != 0)

    def _build_viscous(self, energy: StrainEnergy, y: fem.Function) -> None:
        """Forces ``Lᵀ ε'ᵀ η ε' L v`` and their derivative in ``v``."""
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
        self.viscous_tangent = self._wrapping.form(kernels.tangent_kernel, [V, V], [matrix])

    def _wrap(
        self,
        energy: CompiledForm,
        residual: Sequence[CompiledForm],
        tangent: Sequence[CompiledForm],
        forces: Forces | None = None,
    ) -> None:
        forces = Forces(kernels.residual_kernel) if forces is None else forces
        V, form = self.increment.function_space, self._wrapping.form
        self._stored = energy
        self.energy = form(kernels.energy_kernel, [], [energy])
        self.residual_kernel, self.found_energy = forces.kernel, forces.energy
        self.residual = form(forces.kernel, [V], residual, forces.reads)
        self.tangent = form(kernels.tangent_kernel, [V, V], tangent)

    @property
    def contents(self) -> tuple[str, list[Array], list[Array]]:
        """What the energy is: its signature, the constants, and the coefficients as they are now.

        They are the same in any process; what the state of the nodes decides is not among them.
        """
        own = self._wrapping.state, self._wrapping.coordinates, self.local
        given = [f for f in self._stored.coefficients if not any(f is other for other in own)]
        values = [np.asarray(c.value, dtype=np.float64) for c in self._stored.constants]
        return self._stored.signature, values, [f.x.array.copy() for f in given]

    @property
    def local_change(self) -> fem.Form:
        """See the class."""
        return self._carry

    def carry(self) -> None:
        """Update the carried stress, or the local fields, by the increment ``h`` about to be made.

        Call it after the solve and *before* the state is updated by ``h``.
        """
        if self.stress is not None:
            new = self.stress.x
            new.array[:] = 0.0
            fem.assemble_vector(new.array, self._carry)
            new.array[:] *= self._per_weight
            new.scatter_forward()
        elif self.local is not None:
            fem.assemble_vector(self.local.x.array, self._carry)
            self.local.x.scatter_forward()


def _check_local(local: fem.Function) -> None:
    """Refuse fields that cells share: they cannot be eliminated cell by cell."""
    space = local.function_space
    layout, dim = space.dofmap.dof_layout, space.mesh.topology.dim
    if any(layout.num_entity_dofs(below) for below in range(dim)):
        raise ValueError(
            "local fields must be discontinuous between cells, such as DG, as they are eliminated "
            f"cell by cell, got {space.ufl_element()}; a field that cells share is one of the "
            "unknowns of the whole problem"
        )


def _check_spaces(
    state: fem.Function,
    increment: fem.Function,
    frame_map: FrameMap,
    coordinates: fem.Function | None,
) -> None:
    """Refuse what would make the kernels read or write beyond their arrays."""
    for name, f, wanted in (
        ("state", state, frame_map.values),
        ("increment", increment, frame_map.unknowns),
    ):
        if f.function_space.dofmap.bs != wanted:
            raise ValueError(
                f"the {name} must have {wanted} values per node for this map, "
                f"got {f.function_space.dofmap.bs}"
            )
    nodes = [f.function_space.dofmap.list.shape[1] for f in (state, increment)]
    if nodes[0] != nodes[1]:
        raise ValueError(f"state and increment must have the same nodes, got {nodes} per cell")
    if (coordinates is None) != (frame_map.coordinates is None):
        raise ValueError(
            "give coordinates exactly if the map computes them from the state: "
            f"this map does{' not' if frame_map.coordinates is None else ''}"
        )
