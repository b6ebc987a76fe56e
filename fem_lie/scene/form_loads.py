"""Loads that are virtual works of the user, on bodies of forms, with a history in time."""

from __future__ import annotations

from dataclasses import dataclass

from fem_lie._arrays import instance
from fem_lie.bodies.forms.form_body import FormBody
from fem_lie.forms.local_forms import LocalFrameForms
from fem_lie.forms.problems.virtual_work import VirtualWork
from fem_lie.scene.load import Carrier, History, Load, Sum


@dataclass(frozen=True, eq=False)
class FormLoad(Load):
    """Virtual work of forces from outside on a body of forms, with a history.

    It is a load in a form of one's own that changes in time, such as a pressure, a wind that
    depends on the direction of the surface, or a moving load. A virtual work that does not change
    can be one of the forms of the :class:`~fem_lie.FrameProblem` instead.

    Attributes:
        loaded: The body, a :class:`~fem_lie.extend.FormBody`.
        work: Virtual work along the frames of the body, such as
            :func:`~fem_lie.extend.dead_force`, :func:`~fem_lie.extend.follower_moment`, or
            :func:`~fem_lie.local_frame_forms` of a form that is linear in a variation of
            ``q.function``. Constants and functions have the values of the start of the run.
        history: Factor as a function of time.

    Example:
        >>> import basix.ufl, dolfinx, ufl
        >>> from mpi4py import MPI
        >>> e = basix.ufl.element("Lagrange", "interval", 1, shape=(3,))
        >>> x, cells = np.array([[0.0, 0, 0], [1, 0, 0]]), np.array([[0, 1]])
        >>> line = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells=cells, x=x, e=e)
        >>> q = fl.NodalFrames(line)
        >>> strain = fl.elements.director_strains(q)[1]
        >>> dx = ufl.dx(line, degree=1)
        >>> energy = fl.extend.StrainEnergy(strain, lambda k: ufl.inner(k, k), dx)
        >>> rod = fl.extend.FormBody(fl.FrameProblem(fl.local_frame_forms(energy, q), q))
        >>> scene = fl.Scene()
        >>> _ = scene.add(rod)
        >>> wind = fl.extend.dead_force(ufl.as_vector((0, 0, 1)), dx, q)
        >>> load = scene.add(fl.loads.FormLoad(rod, wind, history=lambda t: t))
        >>> len(scene.loads)
        1
    """

    carrier = Carrier("loaded", FormBody, "a FormBody")

    loaded: FormBody
    work: LocalFrameForms
    history: History | None = None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type.

        Raises:
            ValueError: The work is an energy, or belongs to other frames than the body.
        """
        super().__post_init__()
        expected = "a virtual work, such as fl.extend.dead_force(force, dx, q)"
        instance(self.work, LocalFrameForms, "FormLoad: work", expected)
        if self.work.has_energy:
            raise ValueError(
                "FormLoad: expected a virtual work, got an energy: give "
                "fl.local_frame_forms(ufl.derivative(energy, q.function), q)"
            )
        if self.work.increment is not self.loaded.model.problem.q.increment:
            raise ValueError(
                f"FormLoad: expected a virtual work along the frames of {self.loaded.label}, got "
                "one of other NodalFrames"
            )

    def contribute(self, to: Sum) -> None:
        """Add the virtual work on all cells.

        Args:
            to: Sum of all loads, to which this one is added.
        """
        to.add_term(VirtualWork(self.loaded.model.assembled(self.work), to.nodes(self.loaded)))
