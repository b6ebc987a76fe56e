"""Error in space of one state of a body, element by element, in the energy norm.

Of a shell, say::

    found = fl.space_error(result, shell, scene)
    print(found)                           # 3.1 % of the energy norm, in 256 cells
    found.elements, found.total            # square roots of energies
    found.worst(0.5)                       # the fewest elements with half of the error
    found.picture("error.png")

By default it is ``η² = ∫ (σ* − σ)·D⁻¹(σ* − σ)``: how far the stress resultants σ of the elements
are from recovered ones σ*, which are nearer to the truth by an order (O. C. Zienkiewicz & J. Z.
Zhu, IJNME 24 (1987) 337). Both are in local frames, where neighbours can be compared however far
the body has turned; so it holds at any state of statics, of a path and of dynamics. Others are
:class:`~fem_lie.adapt.estimates.estimate.ErrorEstimate` objects, too.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np

from fem_lie._arrays import Array, Indices, instance, number, positive
from fem_lie.adapt.error_picture import draw_error
from fem_lie.adapt.estimates.estimate import ErrorEstimate, Estimated
from fem_lie.adapt.estimates.recovery import Recovery
from fem_lie.pictures.units import SI, Units
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.scene import Scene


def space_error(
    result: Result | StaticResult,
    body: Estimated,
    scene: Scene,
    step: int = -1,
    *,
    estimate: ErrorEstimate | None = None,
) -> SpaceError:
    """ErrorEstimate the error in space of one state of a beam or a shell.

    Args:
        result: Of dynamics, of statics or of a path, in which the body was.
        body: The beam or the shell.
        scene: What was solved.
        step: Which state; default: the last.
        estimate: How; default: :class:`~fem_lie.adapt.estimates.recovery.Recovery`.

    Raises:
        ValueError: The body is not in that scene or result, is no beam or shell, has elements
            without stress or others than the estimate is for, or there is no such step.
    """
    instance(estimate, ErrorEstimate | None, "estimate", "a Recovery, a Residual or None")
    (found,) = (estimate or Recovery()).errors(result, body, scene, [step])
    frames = result.frames[step][nodes_in(result.info, body)]
    return SpaceError(body, frames, found.squares, found.energy)


@dataclass(frozen=True, eq=False)
class SpaceError:
    """Estimated error of a body in one state; made by :func:`space_error`.

    Attributes:
        body: Beam or shell, of m elements.
        frames: Of its nodes in that state, shape (n, 4, 3).
        squares: Square of the error of each element, an energy, shape (m,).
        energy: Square of the norm of the stress, ``∫ σ·D⁻¹σ``: twice the elastic energy.
    """

    body: Estimated
    frames: Array
    squares: Array
    energy: float

    @property
    def elements(self) -> Array:
        """Error of each element, shape (m,)."""
        return np.sqrt(self.squares)

    @property
    def total(self) -> float:
        """Error of the body."""
        return float(np.sqrt(self.squares.sum()))

    @property
    def relative(self) -> float:
        """Error over the norm of the stress; 0 where nothing is strained."""
        return self.total / float(np.sqrt(self.energy)) if self.energy > 0 else 0.0

    def effectivity(self, error: float) -> float:
        """Estimated over known error, 1 at best.

        Args:
            error: In the energy norm, as :attr:`total`.

        Raises:
            ValueError: It is not positive.
        """
        return self.total / positive(error, "error")

    def worst(self, part: float = 0.5) -> Indices:
        """The fewest elements that have this part of the square of the error, worst first.

        (W. Dörfler, SIAM J. Numer. Anal. 33 (1996) 1106.)

        Args:
            part: Between 0 and 1.

        Raises:
            ValueError: It is not.
        """
        return worst(self.squares, part)

    def picture(self, path: str | os.PathLike[str], *, title: str = "", units: Units = SI) -> None:
        """Draw the error: of beams over arc length, of shells in colours.

        What is drawn is its density, the square root of energy per length or area, so that it does
        not depend on the sizes of elements.

        Args:
            path: Name of the ``.png`` file.
            title: Above the picture; default: the error in words.
            units: For the axes.

        Raises:
            ValueError: The name does not end in ``.png``.
        """
        draw_error(self.body, self.frames, self.squares, path, title or str(self), units)

    def __str__(self) -> str:
        """One line."""
        return (
            f"error in space of {self.body.label}: {100 * self.relative:.2g} % of the energy norm, "
            f"{len(self.squares)} elements"
        )


def worst(squares: Array, part: float) -> Indices:
    """Positions of the largest of positive numbers that together have a part of the sum."""
    if not 0.0 < number(part, "part") <= 1.0:
        raise ValueError(f"part must be above 0 and at most 1, got {part!r}")
    order = np.argsort(-squares, kind="stable")
    total = np.cumsum(squares[order])
    count = int(np.searchsorted(total, part * total[-1] * (1 - 1e-12))) + 1
    return np.asarray(order[:count], dtype=np.int64)
