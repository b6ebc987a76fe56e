"""A body on the user's mesh whose energy, loads and inertia are forms of the user."""

from __future__ import annotations

import logging
from collections.abc import Hashable, Sequence
from typing import Any

import basix
import numpy as np
import ufl
from dolfinx import fem

from fem_lie import lie
from fem_lie._arrays import Flags, Indices, diameter, instance
from fem_lie.bodies.body import Body
from fem_lie.bodies.model import NO_HOLDS, BodyModel, Holds, LagrangeNodes
from fem_lie.forms.assembly import Assembly, NodalInertia
from fem_lie.forms.frames import UNKNOWNS, NodalFrames
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.forms.problems.frame_problem import FrameProblem
from fem_lie.forms.problems.inertia import MassBlocks, mass_blocks
from fem_lie.sections.material import Damping

_log = logging.getLogger(__name__)

_AROUND = {3: [0, 1, 2], 4: [0, 1, 3, 2]}
"""Where corners of DOLFINx's surface cells are in cyclic order, by their number."""

_RIGID = np.array([0.3, -0.7, 0.5, 0.9, 0.4, -1.1])
"""Motion that changes no energy of deformation: translation, rotation."""

_ROUND_OFF = 1e-10
"""Of forces for which no digit is left, relative to those of large strains."""


class FormModel(BodyModel):
    """Model of a body of forms.

    Attributes:
        problem: Forms, nodal frames and supports.
        mass: Constant mass matrix, or ``None`` for statics.
        damping: Mass-proportional damping.
    """

    def __init__(
        self,
        problem: FrameProblem,
        mass: MassBlocks | None,
        damping: Damping,
        class_name: str,
        name: str,
    ) -> None:
        """Take the nodes of the frames, in their order."""
        self.problem, self.mass, self.damping = problem, mass, damping
        fields = [f for form in problem.forms for f in (form.stress, form.local) if f is not None]
        self._fields = [(f, f.x.array.copy()) for f in fields]
        space = problem.q.function.function_space
        super().__init__(
            problem.q.frames,
            class_name=class_name,
            size=diameter(problem.q.frames[:, 0]) or 1.0,
            points={},
            name=name,
        )
        self.held |= _held(problem)
        dofs = space.dofmap.list.astype(np.int64)
        cell = space.mesh.basix_cell()
        if space.mesh.topology.dim == 2:
            self.faces = dofs[:, _AROUND[len(basix.topology(cell)[0])]]
            self.thickness = np.zeros(len(dofs))
        else:
            self.cells = dofs[:, basix.topology(cell)[1]].reshape(-1, 2)

    @property
    def assembly_key(self) -> Hashable:
        """The body itself: each is assembled on its own mesh."""
        return self

    @property
    def contents(self) -> object:
        """Forms with the values of their constants and coefficients, and the mass matrix."""
        mass = () if self.mass is None else tuple(self.mass)
        return [form.contents for form in self.problem.forms], mass

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> Assembly:
        """Assembly of the only body: its first energy, with all other forms as further terms."""
        (model,) = models
        for field, values in model._fields:
            field.x.array[:] = values
        # a sorted list keeps its order among equals: energies come first
        first, *others = sorted(model.problem.forms, key=lambda form: not form.has_energy)
        assembly: Assembly = model.assembled(first)
        if found := assembly.initial_stress():
            _log.warning(
                "%s: the energy has forces in the unloaded configuration (%s). If it is not meant "
                "to be under stress before it is loaded, subtract the strains of that "
                "configuration: fem_lie.extend.present_values",
                model.label,
                found,
            )
        assembly.further_terms += [model.assembled(form) for form in others]
        if model.mass is not None:
            blocks = np.zeros((len(assembly.indices), 4, 4))
            count, (rows, columns) = len(model.frames), assembly.pairs
            at = np.searchsorted(
                rows * count + columns, model.mass.rows * count + model.mass.columns
            )
            blocks[at] = model.mass.blocks
            rate = model.damping.mass
            assembly.inertia = NodalInertia(blocks, rate * blocks if rate else None)
        return assembly

    def assembled(self, form: LocalFrameForms) -> Assembly:
        """Term of one of the forms, with nodes in the order of the frames.

        Args:
            form: One of the forms.
        """
        count = len(form.entities.cells)
        return Assembly(self.problem.q, form, np.arange(len(self.frames)), np.arange(count), None)

    def lagrange_nodes(self) -> LagrangeNodes:
        """Nodes of the space of the frames, on the user's mesh."""
        space = self.problem.q.function.function_space
        degree = int(space.ufl_element().degree)
        return LagrangeNodes(space.mesh, degree, space.dofmap.list.astype(np.int64))


class FormBody(Body):
    """Body on a mesh of DOLFINx, whose energy, loads and inertia are forms along nodal frames.

    It makes the forms of a :class:`~fem_lie.FrameProblem` a body of a scene, which all schemes step
    in time: with loads, joints and other bodies of the scene, and with results as functions on the
    mesh. Nodes are those of the frames, in their order, and start where the frames are.

    Energies are those of deformation, which rigid motions do not change; forces from outside are
    virtual works. All forms act in full at all times, with the values that their constants and
    functions have when a run starts: loads that change in time are loads of the scene, such as
    :class:`fem_lie.loads.FormLoad`. Results have the states: a run leaves the frames where they
    are, and uses the element-local fields.
    """

    model: FormModel

    def __init__(
        self,
        problem: FrameProblem,
        *,
        inertia: ufl.Form | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Take the forms.

        Args:
            problem: Forms, nodal frames and supports, on a mesh of one process.
            inertia: Kinetic energy, quadratic in ``q.velocity`` and ``q.director_rates``, such as
                :func:`~fem_lie.extend.kinetic_energy`, or a sum of several; default: none, for
                statics.
            damping: Mass-proportional damping; damping by strain rates is the ``viscosity`` of a
                :class:`~fem_lie.extend.StrainEnergy`.
            name: Name in messages and results.

        Raises:
            ValueError: The mesh is distributed, all forms are virtual work, supports have values
                other than zero, there is damping of strain or without inertia, or ``inertia`` is no
                such kinetic energy.
            TypeError: An argument has an unexpected type.
        """
        instance(problem, FrameProblem, "FormBody: problem", "a FrameProblem")
        expected = "a kinetic energy as a UFL form, such as fl.extend.kinetic_energy, or None"
        instance(inertia, ufl.Form | None, "FormBody: inertia", expected)
        damping = Damping.of_mass(damping, "FormBody")
        if damping.mass and inertia is None:
            raise ValueError("FormBody: expected inertia with mass-proportional damping, got none")
        comm = problem.q.function.function_space.mesh.comm
        if comm.size > 1:
            raise ValueError(
                "FormBody: expected a mesh of one process, created with MPI.COMM_SELF (every rank "
                f"then has the whole scene), got a mesh on {comm.size} processes"
            )
        if not any(each.has_energy for each in problem.forms):
            raise ValueError("FormBody: expected at least one energy, got virtual work only")
        for form in problem.forms:
            if form.has_energy and not _is_of_deformation(form, problem.q):
                raise ValueError(
                    "FormBody: expected energies that rigid motions do not change, got one that "
                    "depends on the position in space: give it as a load, "
                    "fl.local_frame_forms(ufl.derivative(energy, q.function), q), or gravity and "
                    "forces by fl.extend.dead_force"
                )
        mass = None if inertia is None else mass_blocks(inertia, problem.q)
        super().__init__(FormModel(problem, mass, damping, type(self).__name__, name))


def _is_of_deformation(form: LocalFrameForms, q: NodalFrames) -> bool:
    """Whether forces along nodal frames are the same after a rigid motion."""
    before = q.frames.copy()
    forces = fem.assemble_vector(form.residual).array.copy()
    units = np.repeat([diameter(before[:, 0]) or 1.0, 1.0], 3)
    q.frames[:] = lie.se3_compose(lie.se3_exp(_RIGID * units), before)
    change = np.abs(fem.assemble_vector(form.residual).array - forces).reshape(-1, UNKNOWNS)
    stiffness = abs(fem.assemble_matrix(form.tangent).to_scipy())
    q.frames[:] = before
    scale = np.abs(forces) + stiffness @ np.tile(units, len(before))
    # forces, then moments
    found, most = (a.reshape(-1, 2, 3).max(axis=(0, 2)) for a in (change, scale))
    return bool((found <= _ROUND_OFF * most).all())


def _held(problem: FrameProblem) -> Flags:
    """Mask of the unknowns that the supports hold, shape (n, 6).

    Raises:
        ValueError: A support has a value other than zero.
    """
    held: Flags = np.zeros(problem.x.x.array.size, dtype=bool)
    for bc in problem.bcs:
        unknowns: Indices = bc.dof_indices()[0].astype(np.int64)
        values = np.zeros(held.size)
        bc.set(values)
        if values.any():
            raise ValueError(
                "FormBody: expected supports with zeros, got other values: prescribe motions by "
                "fl.PrescribedMotion in the scene"
            )
        held[unknowns] = True
    return held.reshape(-1, UNKNOWNS)
