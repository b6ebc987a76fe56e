"""Nodal frames as a DOLFINx function, and the map of elements written in directors."""

from __future__ import annotations

from functools import cached_property

import basix.ufl
import numba
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem, mesh
from ufl.core.expr import Expr

from fem_lie import _compat, lie
from fem_lie._arrays import Array, instance, whole
from fem_lie._jit import compiled
from fem_lie.forms.energy import StrainEnergy
from fem_lie.forms.kernels.addresses import FrameMap, Pointer, frame_function
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.lie import directors

VALUES, UNKNOWNS = 12, 6


@compiled
def push_forward(H: Array, h: Array, out: Array) -> None:
    """Rates ``L h``: ``δx = R u``, ``δd_k = R (η × e_k)``; shapes (n, 4, 3), (n, 6), (n, 4, 3)."""
    for i in range(h.shape[0]):
        directors.push_forward(H[i], h[i], out[i])


@compiled
def pull_back(H: Array, f: Array, sign: float, r: Array) -> None:
    """Add ``sign · Lᵀ f``: force ``Rᵀ f_x``, moment ``Σ e_k × Rᵀ f_k``; (n, 4, 3) to (n, 6)."""
    for i in range(f.shape[0]):
        directors.pull_back(H[i], f[i], sign, r[i])


@compiled
def pull_back_derivative(H: Array, f: Array, sign: float, block: Array) -> None:
    """Add ``sign · ∂(Lᵀ f)/∂h`` of one node, see :func:`~.directors.pull_back_derivative`."""
    directors.pull_back_derivative(H, f, sign, block)


@frame_function
def _director_pull(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    shape = (nodes, 4, 3)
    pull_back(
        numba.carray(state, shape), numba.carray(given, shape), 1.0, numba.carray(out, (nodes, 6))
    )


@frame_function
def _director_push(state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int) -> None:
    shape = (nodes, 4, 3)
    push_forward(
        numba.carray(state, shape), numba.carray(given, (nodes, 6)), numba.carray(out, shape)
    )


@frame_function
def _director_geometric(
    state: Pointer, y: Pointer, given: Pointer, out: Pointer, nodes: int
) -> None:
    H, f = numba.carray(state, (nodes, 4, 3)), numba.carray(given, (nodes, 4, 3))
    A = numba.carray(out, (nodes, 6, nodes, 6))
    for i in range(nodes):
        pull_back_derivative(H[i], f[i], 1.0, A[i, :, i])


DIRECTORS = FrameMap(
    coordinates=None,
    pull_back=_director_pull,
    push_forward=_director_push,
    geometric=_director_geometric,
    values=VALUES,
    unknowns=UNKNOWNS,
)
"""Map with position and directors of each node as flat coordinates, for any cell and degree."""


@compiled
def _retract_all(H: Array, h: Array) -> None:
    for i in range(H.shape[0]):
        lie.retract(H[i], h[i], H[i])
        lie.reorthonormalise(H[i])


class NodalFrames:
    """Frames at the nodes of a mesh: positions ``x`` and directors ``d_k = R e_k``.

    Attributes:
        function: DOLFINx function of 12 values per node, ``(x, d₁, d₂, d₃)``.
        increment: DOLFINx function of 6 unknowns per node, (translation, rotation) along its frame.
    """

    def __init__(self, msh: mesh.Mesh, degree: int = 1) -> None:
        """Create the frames at the nodes of the mesh, with ``R = I``.

        In parallel, a mesh that branches must be created with ``max_facet_to_cell_links`` from
        DOLFINx 0.10 on; line meshes must not branch with DOLFINx 0.9.

        Args:
            msh: Mesh in space (``gdim`` 3), with any cells.
            degree: Degree of the Lagrange nodes.

        Raises:
            ValueError: The mesh is not in three-dimensional space, or branches where DOLFINx cuts
                it or may have cut it; on every rank.
        """
        instance(msh, mesh.Mesh, "NodalFrames: mesh", "a mesh of DOLFINx")
        whole(degree, "NodalFrames: degree")
        if msh.geometry.dim != 3:
            raise ValueError(f"nodal frames need a mesh with gdim 3, got gdim {msh.geometry.dim}")
        _compat.check_branches(msh)
        cell = msh.basix_cell()

        def space(size: int) -> fem.FunctionSpace:
            return fem.functionspace(
                msh, basix.ufl.element("Lagrange", cell, degree, shape=(size,))
            )

        self.function = fem.Function(space(VALUES), name="frames")
        self.increment = fem.Function(space(UNKNOWNS), name="increment")
        self.frames[:, 0] = self.function.function_space.tabulate_dof_coordinates()
        self.frames[:, 1:] = np.eye(3)

    @property
    def frames(self) -> npt.NDArray[np.float64]:
        """View of all frames (ghosts included), shape ``(n, 4, 3)``, see :mod:`fem_lie.lie`."""
        return self.function.x.array.reshape(-1, 4, 3)

    @cached_property
    def rates(self) -> fem.Function:
        """Function of rates ``(ẋ, ḋ₁, ḋ₂, ḋ₃)``, in which kinetic energies are written."""
        return fem.Function(self.function.function_space, name="rates")

    @property
    def velocity(self) -> Expr:
        """Velocity ``ẋ`` in UFL, shape (3,)."""
        return _vectors(self.rates)[0]

    @property
    def director_rates(self) -> list[Expr]:
        """Rates of the directors ``ḋ₁, ḋ₂, ḋ₃`` in UFL, shape (3,) each."""
        return _vectors(self.rates)[1:]

    @property
    def position(self) -> Expr:
        """Position ``x`` in UFL, shape (3,)."""
        return _vectors(self.function)[0]

    @property
    def directors(self) -> list[Expr]:
        """Directors ``d₁, d₂, d₃`` in UFL, shape (3,) each."""
        return _vectors(self.function)[1:]

    def update(self, h: npt.ArrayLike) -> None:
        """Update all frames, ``H ← H exp(h)``.

        Args:
            h: Increments of all local nodes, ghosts included, ``6 n`` values.

        Raises:
            ValueError: ``h`` has another number of values.
        """
        frames, values = self.frames, np.asarray(h, dtype=np.float64)
        if values.size != UNKNOWNS * len(frames):
            raise ValueError(
                f"h must have {UNKNOWNS} values for each of {len(frames)} nodes, "
                f"got {values.size} values"
            )
        _retract_all(frames, values.reshape(-1, UNKNOWNS))


def _vectors(f: fem.Function) -> list[Expr]:
    """The four vectors of a function of 12 values per node."""
    return [ufl.as_vector([f[3 * k + j] for j in range(3)]) for k in range(4)]


def local_frame_forms(
    energy: StrainEnergy | ufl.Form, q: NodalFrames, local: fem.Function | None = None
) -> LocalFrameForms:
    """DOLFINx forms along nodal frames of an energy in positions and directors.

    Args:
        energy: UFL form ``W`` in ``q.position`` and ``q.directors``; a :class:`StrainEnergy`; or a
            virtual work in ``δx = ufl.derivative(q.position, q.function)`` and those of directors.
        q: Nodal frames; see :class:`NodalFrames` for branching meshes in parallel.
        local: Element-local fields of ``W``, discontinuous between cells; the kernel condenses
            them.

    Raises:
        ValueError: ``local`` is continuous between cells, or the energy is on another mesh than the
            frames; see also :class:`LocalFrameForms`.
        TypeError: An argument is of another type, such as an energy that is not integrated.
    """
    form = "a UFL form, such as w * ufl.dx(mesh), or a StrainEnergy"
    instance(energy, StrainEnergy | ufl.Form, "local_frame_forms: energy", form)
    instance(q, NodalFrames, "local_frame_forms: q", "NodalFrames")
    function = "a function of DOLFINx, or None"
    instance(local, fem.Function | None, "local_frame_forms: local", function)
    if isinstance(energy, ufl.Form):
        _check_mesh(energy, q)
    return LocalFrameForms(energy, q.function, q.increment, DIRECTORS, local=local)


def _check_mesh(form: ufl.Form, q: NodalFrames) -> None:
    """Raise ``ValueError`` if integrals or functions of a form are on another mesh than frames."""
    own = q.function.function_space.mesh.ufl_domain()
    spaces = [f.ufl_function_space() for f in form.coefficients()]
    domains = [each.ufl_domain() for each in (*form.integrals(), *spaces)]
    if others := {str(each) for each in domains if each != own}:
        raise ValueError(
            f"expected an energy on the mesh of the frames q, {own}, got integrals or functions on "
            f"{', '.join(sorted(others))}"
        )
