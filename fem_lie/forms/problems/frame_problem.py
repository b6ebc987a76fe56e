"""Equilibrium of the user's forms for PETSc's SNES and DOLFINx's NewtonSolver."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc

from fem_lie import _compat
from fem_lie._arrays import instance
from fem_lie._form_cache import compile_form
from fem_lie.forms.frames import NodalFrames
from fem_lie.forms.local_forms import LocalFrameForms

_NO_LIMIT = 1e100
"""Divergence tolerance of SNES that no residual exceeds; PETSc's mark for none has changed."""

_LINE_SEARCH = "fem_lie_line_search_"
"""Prefix of the option by which a line search is chosen."""


class FrameProblem:
    """Sum of forms along nodal frames, whose solver increments move the frames.

    The solver's unknown ``x`` is a sum of increments along nodal frames, of which only differences
    matter: with the frames ``H`` at which the tangent was last assembled, where the unknown was
    ``x₀``, a residual at ``x`` is that of ``H exp(x − x₀)``. A solver may therefore evaluate any
    number of trial points, as line searches do, and reject them. The independent stress and local
    fields are updated for each trial point, too, from their values at ``H``.

    A new load step starts from the frames and the ``x`` of the last one.

    Attributes:
        x: Unknown of the solver, six values per node.
        a: Form from which the matrix is created: ``fem.petsc.create_matrix(problem.a)``.
        L: Form from which the vector is created: ``fem.petsc.create_vector(problem.L)``, from
            DOLFINx 0.10 on ``create_vector(problem.x.function_space)``.
    """

    def __init__(
        self,
        forms: LocalFrameForms | Sequence[LocalFrameForms],
        q: NodalFrames,
        bcs: Sequence[fem.DirichletBC] = (),
    ) -> None:
        """Collect forms and supports.

        Args:
            forms: Forms whose residuals and tangents add, all of the frames ``q``: energies of
                several measures, loads.
            q: Nodal frames that the solver moves.
            bcs: Supports on the space of ``q.increment``. Nodes that do not move have zeros.

        Raises:
            ValueError: There are no forms, forms of other frames, or supports in another space.
            TypeError: An argument is of another type.
        """
        instance(q, NodalFrames, "FrameProblem: q", "NodalFrames")
        known = "a sequence of supports, as of fem.dirichletbc"
        instance(bcs, Sequence, "FrameProblem: bcs", known)
        self.forms = [forms] if isinstance(forms, LocalFrameForms) else list(forms)
        self.q, self.bcs = q, list(bcs)
        for form in self.forms:
            instance(form, LocalFrameForms, "FrameProblem: forms", "forms of fl.local_frame_forms")
        for bc in self.bcs:
            instance(bc, fem.DirichletBC, "FrameProblem: bcs", known)
        V = q.increment.function_space
        if not self.forms:
            raise ValueError("expected forms, got an empty sequence")
        for form in self.forms:
            if form.increment is not q.increment:
                raise ValueError("expected forms of the frames q, got forms of other frames")
        for bc in self.bcs:
            if not _compat.is_on_space(bc, V):
                raise ValueError(
                    "expected bcs on q.increment.function_space, which hold whole nodes, got "
                    "another space; joints to ground at body.point(...) of a FormBody hold single "
                    "components"
                )
        self.x = fem.Function(V, name="sum of increments")
        u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
        # a form may be over few cells: the matrix gets entries of all cells
        self.a = compile_form(ufl.inner(u, v) * ufl.dx(degree=0))
        self.L = self.forms[0].residual
        self.restart()

    def restart(self) -> None:
        """Count increments from the present frames, if something else has changed these."""
        fields = [f for form in self.forms for f in (form.stress, form.local) if f is not None]
        self._fields = [(f, f.x.array.copy()) for f in fields]
        self._frames = self.q.function.x.array.copy()
        self._x = self.x.x.array.copy()

    def snes(self, *, line_search: str = "basic", prefix: str = "") -> PETSc.SNES:
        """New solver with full steps and a direct factorisation, with the tolerances of PETSc.

        ``snes.solve(None, problem.x.x.petsc_vec)`` moves the frames. A right increment stretches a
        slender body at first, and the residual grows a thousandfold before it vanishes: line
        searches that want it to fall stall then, and so PETSc's limit of divergence is switched
        off.

        Args:
            line_search: Type of the line search, as in PETSc's ``-snes_linesearch_type``.
            prefix: Prefix of options in PETSc's database, which overrule all of this.
        """
        snes = PETSc.SNES().create(self.x.function_space.mesh.comm)
        snes.setFunction(self.residual, _compat.create_vector(self.L))
        snes.setJacobian(self.jacobian, petsc.create_matrix(self.a))
        snes.setDivergenceTolerance(_NO_LIMIT)
        ksp = snes.getKSP()
        ksp.setType(PETSc.KSP.Type.PREONLY)
        ksp.getPC().setType(PETSc.PC.Type.LU)
        ksp.getPC().setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        # PETSc for Python reaches line searches through options only
        snes.setOptionsPrefix(_LINE_SEARCH)
        options, name = PETSc.Options(_LINE_SEARCH), "snes_linesearch_type"
        options[name] = line_search
        snes.setFromOptions()
        del options[name]
        snes.setOptionsPrefix(prefix)
        snes.setFromOptions()
        return snes

    def residual(self, snes: PETSc.SNES, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Residual for ``SNES.setFunction``, see :meth:`F`.

        Args:
            snes: Solver that calls this.
            x: Trial point of the solver.
            b: Residual, overwritten.
        """
        self.form(x)
        self.F(x, b)

    def jacobian(self, snes: PETSc.SNES, x: PETSc.Vec, A: PETSc.Mat, P: PETSc.Mat) -> None:
        """Tangent for ``SNES.setJacobian``, see :meth:`J`.

        Args:
            snes: Solver that calls this.
            x: Point of the solver.
            A: Matrix of the solver, the same as ``P``.
            P: Matrix that is factorised, overwritten.
        """
        self.form(x)
        self.J(x, P)

    def F(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Move the frames to ``x`` and compute the residual there.

        Args:
            x: Trial point of the solver, with ghosts.
            b: Residual, overwritten.
        """
        self._move(x)
        with b.localForm() as local:
            local.set(0.0)
        for form in self.forms:
            petsc.assemble_vector(b, form.residual)
            petsc.apply_lifting(b, [form.tangent], [self.bcs], x0=[x], alpha=-1.0)
        b.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
        petsc.set_bc(b, self.bcs, x, -1.0)

    def J(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Compute the tangent at ``x``, from where increments are counted then.

        Args:
            x: Point of the solver, with ghosts.
            A: Matrix, overwritten.
        """
        self._move(x)
        self.restart()
        with x.localForm() as local:
            self._x = local.array_r.copy()
        A.zeroEntries()
        for form in self.forms:
            petsc.assemble_matrix(A, form.tangent, self.bcs)
            # ones on the diagonal are inserted, entries of the next form added; a final assembly
            # would drop the entries that only the next form has
            A.assemble(PETSc.Mat.AssemblyType.FLUSH)
        A.assemble()

    def form(self, x: PETSc.Vec) -> None:
        """Update the ghosts of ``x``: what DOLFINx's NewtonSolver calls before :meth:`F`.

        Args:
            x: Trial point of the solver.
        """
        x.ghostUpdate(addv=PETSc.InsertMode.INSERT, mode=PETSc.ScatterMode.FORWARD)

    def _move(self, x: PETSc.Vec) -> None:
        """Set frames and element-local fields for the trial point ``x``."""
        with x.localForm() as local:
            h = local.array_r - self._x
        self.q.function.x.array[:] = self._frames
        for field, values in self._fields:
            field.x.array[:] = values
        self.q.increment.x.array[:] = h
        moved = bool(np.any(h != 0.0))
        if not self.x.function_space.mesh.comm.allreduce(moved, MPI.LOR):
            return  # the independent stress stays as it is
        for form in self.forms:
            form.update_stress()
        self.q.update(h)
