"""Errors by more unknowns: beams by elements in halves, shells by cells in four; a cross-check."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.adapt.estimates.beam_residual import along_the_line
from fem_lie.adapt.estimates.estimate import ElementErrors, ErrorEstimate, Way
from fem_lie.adapt.estimates.shell_hierarchical import shell_hierarchical
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.beams.orientation import middle_frames
from fem_lie.bodies.shells.shell import Shell
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.stresses.element_forces import ElementForces
from fem_lie.results.stresses.section_forces import SectionForces, section_forces
from fem_lie.scene import Scene

_ITERATIONS = 6
_STEP = 1e-6  # in differences, of the length of an element and in rad


@dataclass(frozen=True)
class Hierarchical(ErrorEstimate):
    """From solutions with more nodes, in each element or about it.

    Of beams with two nodes the element is cut in halves of its own kind. Its ends stay, and the
    node between is put where forces and moments balance with what acts along the line. The stress
    of an element is right in its middle to higher order, that of a half in the middle of the half:
    what the element misses is the slope from one to the other.

    Shells of first degree have their cells cut in four, and a small problem for each with the cells
    that touch it, see
    :func:`~fem_lie.adapt.estimates.shell_hierarchical.shell_hierarchical`.

    It takes about forty times the forces of a beam, and several hundred times those of a shell: to
    check the others by, not to refine with.

    Example:
        >>> fl.Hierarchical()
        Hierarchical()
    """

    def ways(self) -> Mapping[type, Way]:
        """For beams and shells."""
        return {Beam: _errors, Shell: shell_hierarchical}


def _errors(
    result: Result | StaticResult, beam: Beam, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    if beam.elements.shape[1] != 2:
        raise ValueError(
            f"hierarchical errors are for elements of two nodes, those of {beam.label} have "
            f"{beam.elements.shape[1]}: take Recovery()"
        )
    found = section_forces(result, beam, scene, steps=steps)
    return [_of_state(found, k) for k in range(len(steps))]


def _of_state(found: SectionForces, k: int) -> ElementErrors:
    beam, own = found.beam, found.at_points(k)[:, 0]
    compliance = np.linalg.inv(beam.stiffness)
    load = 0.5 * beam.lengths[:, np.newaxis] * along_the_line(found, k, 0)
    halves = ElementForces(_halves(beam))
    halves.set_eigenstrain(np.repeat(found.strains[k], 2, axis=0))
    frames = _settled(beam, halves, found.frames[k], load)
    stress = halves.of_strain(frames)[:, 0].reshape(-1, 2, 6)
    slope = stress[:, 1] - stress[:, 0]

    def energy(values: Array) -> Array:
        work = np.einsum("mi,mij,mj->m", values, compliance, values)
        return np.asarray(beam.lengths * work)

    missed = np.asarray(energy(slope) / 3.0, dtype=np.float64)
    return ElementErrors(missed, float(energy(own).sum()))


def _halves(beam: Beam) -> Beam:
    """Each element as two, with nodes in the middles behind the others."""
    cut, ends = copy(beam), beam.frames[beam.elements]
    middle = len(beam.frames) + np.arange(len(beam.elements))
    cut.frames = np.concatenate([beam.frames, middle_frames(ends[:, 0], ends[:, 1])])
    first, last = beam.elements.T
    pairs = np.stack([first, middle, middle, last], axis=1)
    cut.elements = pairs.reshape(-1, 2)
    cut.source = None
    cut.lengths = np.repeat(0.5 * beam.lengths, 2)
    for name in ("stiffness", "density", "slopes"):
        setattr(cut, name, np.repeat(getattr(beam, name), 2, axis=0))
    return cut


def _settled(beam: Beam, halves: ElementForces, frames: Array, load: Array) -> Array:
    """Frames of all nodes, those in the middles in balance: Newton's method in each element."""
    ends = frames[beam.elements]
    middle = middle_frames(ends[:, 0], ends[:, 1])
    step = _STEP * np.concatenate([np.full(3, beam.lengths.min()), np.ones(3)])

    def unbalanced(H: Array) -> Array:
        at = halves.at_ends(np.concatenate([frames, H])).reshape(-1, 2, 2, 6)
        return np.asarray(at[:, 0, 1] - at[:, 1, 0] - load)

    for _ in range(_ITERATIONS):
        rest = unbalanced(middle)
        columns = [
            (unbalanced(lie.se3_retract(middle, np.broadcast_to(d, rest.shape))) - rest) / d.sum()
            for d in np.diag(step)
        ]
        change = np.linalg.solve(np.stack(columns, axis=2), rest[..., np.newaxis])[..., 0]
        middle = lie.se3_retract(middle, -change)
    return np.concatenate([frames, middle])
