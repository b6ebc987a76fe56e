"""Hierarchical error estimates: beam elements cut in halves, shell cells cut into four."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
import scipy.sparse.linalg
from scipy.sparse import diags

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie.adaptivity.estimates.cut import (
    Cut,
    areas_of,
    assembled,
    free_motions,
    interpolation,
    on_all_nodes,
    on_new_nodes,
    shapes_of_parts,
    unit_steps,
    unknowns,
)
from fem_lie.adaptivity.estimates.estimate import ElementErrors, ErrorEstimate, Estimator
from fem_lie.adaptivity.estimates.residual import ShellEdges, along_the_line, unresolved
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.shell import Shell
from fem_lie.mesh.shapes import tabulated
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.results.stresses.element_forces import ElementForces
from fem_lie.results.stresses.nodal_values import extrapolation
from fem_lie.results.stresses.section_forces import SectionForces, section_forces
from fem_lie.results.stresses.shell_stress import ShellStress, integration
from fem_lie.results.stresses.stress_free import require_no_strains
from fem_lie.scene import Scene
from fem_lie.sections.orientation import middle_frames

_FIVE = 5
_STEP = 1e-6  # increment for numerical derivatives: over the length of the model, and in rad
_FINER = 4.0 / 3.0  # squared error over the squared difference between both meshes, at first order
_REGULAR = 1e-13  # relative to the diagonal, less than the softest bending of thin shells
_PIVOT, _SYMMETRIC = 0.01, {"SymmetricMode": True}  # of SuperLU: pivots from the diagonal


def shell_hierarchical(
    result: Result | StaticResult, shell: Shell, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    """Errors from the residual of the cells' stress when each cell is cut into four.

    One linear problem for all nodes of the fine cells, with the stiffness of their material and of
    the stress (hierarchical bases: R. E. Bank & R. K. Smith, SIAM J. Numer. Anal. 30 (1993) 921).
    Forces are the external forces minus those of the stress σ *of the uncut cells*. So positions of
    the coarse mesh, which would cause spurious stress in the fine cells of thin shells, do not
    enter. Coarse cells are in equilibrium: no work is done in motions of the old nodes with new
    ones between them. Fine cells, which resolve other strains, would find some in motions without
    stretching, so the forces on old nodes are those that do none. New nodes on supported edges are
    supported. External forces on new nodes are interpolated from the forces on old nodes, per area
    inside and per length at borders; a point force remains at its node.

    The solution is the stress correction δ of the cells. An element of first order loses half of
    its error by the refinement, so ``η² = 4/3 ∫ δ·D⁻¹δ``, and of boundary layers what neither has.

    Raises:
        ValueError: The cells are not of degree 1; the shell is not in that result, or there is no
            such state.
    """
    if shell.model.mesh.degree != 1:
        raise ValueError(
            f"hierarchical errors need cells of degree 1, those of {shell.label} are of degree "
            f"{shell.model.mesh.degree}: use RecoveryEstimate()"
        )
    require_no_strains(result, shell, "errors of shells cannot be estimated")
    nodes, cut = nodes_in(result.info, shell), Cut.of(shell)
    return [_cut_errors(cut, result.frames[step][nodes]) for step in steps]


def _cut_errors(cut: Cut, frames: Array) -> ElementErrors:
    shell, cells = cut.shell, cut.fine.model.cut_mesh.cells
    stress, (rule, _) = ShellStress.of(shell), integration(shell)
    own, areas = stress(frames), areas_of(cut.fine)
    H = on_all_nodes(cut, frames)
    D_inverse = np.repeat(stress.compliance, 4, axis=0)
    inside = (_at_parts(shell, rule) @ own[:, np.newaxis]).reshape(*areas.shape, 8)
    strains = areas[..., np.newaxis] * np.einsum("mij,mgj->mgi", D_inverse, inside)
    slopes, K = _derivatives(cut, H, strains)
    K += np.einsum("mg,mgip,mij,mgjq->mpq", areas, slopes, D_inverse, slopes, optimize=True)
    balanced = np.einsum("mgi,mgip->mp", strains, slopes)
    moved = _solved(cut, H, K, balanced)[unknowns(cells)]
    missed = np.einsum("mgip,mp->mgi", slopes, moved)
    squares = _FINER * np.einsum("mg,mgi,mij,mgj->m", areas, missed, D_inverse, missed)
    energy = np.einsum("mgi,mij,mgj,mg->", own, stress.compliance, own, areas_of(shell))
    layers = ShellEdges.of(shell).layer_squares(own, _beyond_halves)
    return ElementErrors(squares.reshape(-1, 4).sum(axis=1) + layers, float(energy))


def _beyond_halves(ratio: Array) -> Array:
    """Part of the energy of a boundary layer that is missing and not in ``4/3 ∫ δ·D⁻¹δ``.

    Args:
        ratio: Size of the cells over the width of the layer.
    """
    return np.asarray(_FINER * unresolved(0.5 * ratio) - (_FINER - 1.0) * unresolved(ratio))


def _solved(cut: Cut, H: Array, K: Array, balanced: Array) -> Array:
    """Twists of all nodes, shape (5 N,).

    Args:
        cut: The refined shell.
        H: Frames of all its nodes.
        K: Stiffness of the fine cells, shape (4 m, k 5, k 5).
        balanced: Forces of the stress of the uncut cells on the fine cells, shape (4 m, k 5).
    """
    number, old = unknowns(cut.fine.model.cut_mesh.cells), _FIVE * len(cut.shell.frames)
    motions = free_motions(cut, H)
    rest = np.zeros(_FIVE * len(H))
    np.subtract.at(rest, number, balanced)
    rest[old:] += on_new_nodes(cut, H, motions).ravel()
    rest = motions @ (motions.T @ rest)
    rest[:old] = -(interpolation(cut, H).T @ rest[old:])
    matrix = motions.T @ assembled(K, number, number, _FIVE * len(H)) @ motions
    # a shell without supports of its own is not held against rigid motion
    matrix = matrix + diags(_REGULAR * np.abs(matrix.diagonal()))
    factors = scipy.sparse.linalg.splu(
        matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=_PIVOT, options=_SYMMETRIC
    )
    return np.asarray(motions @ factors.solve(motions.T @ rest))


def _derivatives(cut: Cut, H: Array, strains: Array) -> tuple[Array, Array]:
    """Derivatives of the stress of each fine cell in the twists of its nodes.

    Args:
        cut: The refined shell.
        H: Frames of all its nodes.
        strains: Strains times areas of the integration points, shape (4 m, g, 8).

    Returns:
        First derivatives, shape (4 m, g, 8, k 5), and second derivatives of the sum of stress times
        ``strains``, the stiffness of the stress, shape (4 m, k 5, k 5).
    """
    stress, cells = ShellStress.of(cut.separate), cut.fine.model.cut_mesh.cells
    frames, steps = H[cells.ravel()], unit_steps(cells.shape, cut.shell.model.size)

    def work(of: Array) -> Array:
        return np.asarray(np.einsum("mgi,mgi->m", strains, of))

    def at(step: Array) -> Array:
        return stress(lie.se3_retract(frames, step.reshape(-1, 6)))

    start = work(at(np.zeros((*cells.shape, 6))))
    slopes, ahead = [], []
    K = np.empty((len(cells), len(steps), len(steps)))
    for i, (step, size) in enumerate(steps):
        after, before = at(step), at(-step)
        slopes.append((after - before) / (2.0 * size))
        ahead.append(work(after))
        K[:, i, i] = (ahead[i] + work(before) - 2.0 * start) / size**2
        for j, (other, length) in enumerate(steps[:i]):
            change = work(at(step + other)) - ahead[i] - ahead[j] + start
            K[:, i, j] = K[:, j, i] = change / (size * length)
    return np.stack(slopes, axis=3), K


def _at_parts(shell: Shell, rule: Array) -> Array:
    """Interpolation from integration points of a cell to those of each part, shape (4, g, g)."""
    mesh = shell.model.cut_mesh
    corners = extrapolation(mesh, rule)
    positions = tabulated(mesh.cell, 1, rule)[0]
    return np.asarray(positions @ shapes_of_parts(mesh.cell) @ corners)


_ITERATIONS = 6


@dataclass(frozen=True)
class HierarchicalEstimate(ErrorEstimate):
    """Error estimate from solutions with additional nodes, in each element or patch.

    *Beams with two nodes*: an element is cut into halves of the same formulation. Its ends are
    fixed, and the new node is in equilibrium with the distributed load. The stress of an element is
    of higher order at its midpoint, and that of a half at the midpoint of the half; the error of
    the element is the slope between both.

    *Shells of first degree*: each cell is cut into four, with one linear problem for all fine
    cells, see :func:`~fem_lie.adaptivity.estimates.hierarchical.shell_hierarchical`.

    The estimate costs about forty evaluations of the forces of a beam, and over a thousand of those
    of a shell. It is meant to verify other estimates, not for refinement.

    Example:
        >>> fl.adaptivity.HierarchicalEstimate()
        HierarchicalEstimate()
    """

    def estimators(self) -> Mapping[type, Estimator]:
        """Functions for beams and shells."""
        return {Beam: _errors, Shell: shell_hierarchical}


def _errors(
    result: Result | StaticResult, beam: Beam, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    if beam.model.elements.shape[1] != 2:
        raise ValueError(
            f"hierarchical errors need elements of two nodes, those of {beam.label} have "
            f"{beam.model.elements.shape[1]}: use RecoveryEstimate()"
        )
    found = section_forces(result, beam, scene, states=steps)
    return [_of_state(found, k) for k in range(len(steps))]


def _of_state(found: SectionForces, k: int) -> ElementErrors:
    beam, own = found.beam, found.at_points(k)[:, 0]
    compliance = np.linalg.inv(beam.model.stiffness)
    load = 0.5 * beam.model.lengths[:, np.newaxis] * along_the_line(found, k, 0)
    halves = ElementForces(_halves(beam))
    halves.set_eigenstrain(np.repeat(found.strains[k], 2, axis=0))
    frames = _equilibrated(beam, halves, found.frames[k], load)
    stress = halves.of_strain(frames)[:, 0].reshape(-1, 2, 6)
    slope = stress[:, 1] - stress[:, 0]

    def energy(values: Array) -> Array:
        work = np.einsum("mi,mij,mj->m", values, compliance, values)
        return np.asarray(beam.model.lengths * work)

    missed = np.asarray(energy(slope) / 3.0, dtype=np.float64)
    return ElementErrors(missed, float(energy(own).sum()))


def _halves(beam: Beam) -> Beam:
    """The beam with each element cut in two; new nodes follow the old ones."""
    cut, ends = copy(beam), beam.frames[beam.model.elements]
    middle = len(beam.frames) + np.arange(len(beam.model.elements))
    cut.model.frames = np.concatenate([beam.frames, middle_frames(ends[:, 0], ends[:, 1])])
    first, last = beam.model.elements.T
    pairs = np.stack([first, middle, middle, last], axis=1)
    cut.model.elements = pairs.reshape(-1, 2)
    cut.model.source = None
    cut.model.lengths = np.repeat(0.5 * beam.model.lengths, 2)
    for name in ("stiffness", "density", "slopes"):
        setattr(cut.model, name, np.repeat(getattr(beam.model, name), 2, axis=0))
    return cut


def _equilibrated(beam: Beam, halves: ElementForces, frames: Array, load: Array) -> Array:
    """Frames of all nodes with new nodes in equilibrium, by Newton's method in each element."""
    ends = frames[beam.model.elements]
    middle = middle_frames(ends[:, 0], ends[:, 1])
    step = _STEP * np.concatenate([np.full(3, beam.model.lengths.min()), np.ones(3)])

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
