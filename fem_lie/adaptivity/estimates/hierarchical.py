"""Hierarchical error estimates: beam elements cut in halves, shell cells cut into four."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags
from fem_lie.adaptivity.estimates.cut import Cut, Patches, areas_of, on_all_nodes, shapes_of_parts
from fem_lie.adaptivity.estimates.estimate import ElementErrors, ErrorEstimate, Estimator
from fem_lie.adaptivity.estimates.residual import along_the_line
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.shells.placing import frames_with
from fem_lie.bodies.shells.shell import Shell
from fem_lie.mesh.shapes import tabulated
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.states import nodes_in
from fem_lie.results.stresses.element_forces import ElementForces
from fem_lie.results.stresses.nodal_values import extrapolation, unit
from fem_lie.results.stresses.section_forces import SectionForces, section_forces
from fem_lie.results.stresses.shell_stress import ShellStress, integration
from fem_lie.results.stresses.stress_free import require_no_strains
from fem_lie.scene import Scene
from fem_lie.sections.orientation import middle_frames

_FIVE = 5
_STEP = 1e-6  # increment for numerical derivatives: over the length of the model, and in rad
_FINER = 4.0 / 3.0  # squared error over the squared difference between both meshes, at first order


def shell_hierarchical(
    result: Result | StaticResult, shell: Shell, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    """Errors from the residual of the cells' stress when each cell is cut into four.

    Each cell has a small linear problem: its corners and all new nodes adjacent to one of them are
    free, the boundary of the patch is fixed (local problems on patches: I. Babuška & W. C.
    Rheinboldt, SIAM J. Numer. Anal. 15 (1978) 736). Its forces are the external forces minus those
    of the stress σ *of the uncut cells*. So positions of the coarse mesh, which would cause
    spurious stress in the fine cells of thin shells, do not enter. The stress correction δ of the
    cell follows. External forces on new nodes are interpolated from the forces on old nodes, per
    area inside and per length at borders; a point force remains at its node. An element of first
    order loses half of its error by the refinement, so ``η² = 4/3 ∫ δ·D⁻¹δ``.

    Raises:
        ValueError: The cells are not of degree 1, or there are so few that a patch has no boundary;
            the shell is not in that result, or there is no such state.
    """
    if shell.model.mesh.degree != 1:
        raise ValueError(
            f"hierarchical errors need cells of degree 1, those of {shell.label} are of degree "
            f"{shell.model.mesh.degree}: use RecoveryEstimate()"
        )
    corners = shell.model.cut_mesh.cells.shape[1]
    if len(shell.frames) < corners + 2:
        raise ValueError(
            f"hierarchical errors need {corners + 2} nodes or more, {shell.label} has "
            f"{len(shell.frames)}: use RecoveryEstimate()"
        )
    require_no_strains(result, shell, "errors of shells cannot be estimated")
    nodes, cut = nodes_in(result.info, shell), Cut.of(shell)
    patches = Patches.of(cut)
    return [_cut_errors(cut, patches, result.frames[step][nodes]) for step in steps]


def _cut_errors(cut: Cut, patches: Patches, frames: Array) -> ElementErrors:
    shell, cells = cut.shell, cut.fine.model.cut_mesh.cells
    stress = ShellStress.of(shell)
    own, (rule, _) = stress(frames), integration(shell)
    inside = _at_parts(shell, rule) @ own[:, np.newaxis]  # (m, 4, g, 8)
    H = _between(cut, frames)
    axes, free = _supports(cut, H)
    areas = areas_of(cut.fine)
    strains = areas[..., np.newaxis, np.newaxis] * np.repeat(stress.compliance, 4, axis=0)[:, None]
    slopes = np.einsum("mgikb,mkba->mgika", _slopes(cut, H), axes[cells])
    works = np.einsum("mgij,mgjka->mgika", strains, slopes)
    balanced = np.einsum("mgi,mgika->mka", inside.reshape(*areas.shape, 8), works)
    acts = _local(H, on_all_nodes(cut, frames))[:, :_FIVE]
    rest = np.einsum("Nba,Nb->Na", axes, acts)
    np.subtract.at(rest, cells, balanced)
    m, g, *_ = slopes.shape
    K = np.swapaxes(works.reshape(m, 8 * g, -1), 1, 2) @ slopes.reshape(m, 8 * g, -1)
    moved = patches.solved(cells, K, rest, free)
    missed = np.einsum("mgika,mka->mgi", slopes, moved)
    squares = _FINER * np.einsum("mgi,mgij,mgj->m", missed, strains, missed)
    energy = np.einsum("mgi,mij,mgj,mg->", own, stress.compliance, own, areas_of(shell))
    return ElementErrors(squares.reshape(-1, 4).sum(axis=1), float(energy))


def _slopes(cut: Cut, H: Array) -> Array:
    """Derivatives of stress in nodal twists of each fine cell, shape (4 m, g, 8, k, 5)."""
    stress, cells = ShellStress.of(cut.separate), cut.fine.model.cut_mesh.cells
    frames, found = H[cells.ravel()], []
    for corner in range(cells.shape[1]):
        for unit_of, size in zip(
            np.eye(6)[:_FIVE], [cut.shell.model.size] * 3 + [1.0] * 2, strict=True
        ):
            step = np.zeros((*cells.shape, 6))
            step[:, corner] = _STEP * size * unit_of
            turned = (lie.se3_retract(frames, s * step.reshape(-1, 6)) for s in (1, -1))
            after, before = (stress(moved) for moved in turned)
            found.append((after - before) / (2.0 * _STEP * size))
    slopes = np.stack(found, axis=3)
    return slopes.reshape(*slopes.shape[:3], cells.shape[1], _FIVE)


def _supports(cut: Cut, H: Array) -> tuple[Array, Flags]:
    """Axes (N, 5, 5) of nodal motions, as columns in twists, and whether they are free, (N, 5)."""
    shell, n = cut.shell, len(cut.shell.frames)
    axes = np.tile(np.eye(_FIVE), (len(H), 1, 1))
    in_space = np.flatnonzero(np.isfinite(shell.model.supports).all(axis=(1, 2)))
    axes[in_space, :3, :3] = H[in_space, 1:] @ np.swapaxes(shell.model.supports[in_space], 1, 2)
    free = np.ones((len(H), _FIVE), dtype=np.bool_)
    free[:n] = ~shell.model.held[:, :_FIVE]
    free[n:][cut.held] = False
    return axes, free


def _at_parts(shell: Shell, rule: Array) -> Array:
    """Interpolation from integration points of a cell to those of each part, shape (4, g, g)."""
    mesh = shell.model.cut_mesh
    corners = extrapolation(mesh, rule)
    positions = tabulated(mesh.cell, 1, rule)[0]
    return np.asarray(positions @ shapes_of_parts(mesh.cell) @ corners)


# --- positions of new nodes ---


def _between(cut: Cut, frames: Array) -> Array:
    """Frames of all nodes; new ones are on bent edges between their ends.

    Edges whose directors rotate relative to each other are curved, so that no shear arises.
    """
    shell = cut.shell
    a, b = frames[cut.ends[:, 0]], frames[cut.ends[:, 1]]
    positions, directors = _bulged(a, b)
    unloaded, _ = _bulged(shell.frames[cut.ends[:, 0]], shell.frames[cut.ends[:, 1]])
    n, edges = len(frames), len(cut.ends)
    x0, up = cut.fine.frames[n : n + edges, 0], directors
    height = (
        positions
        - np.einsum("ej,ej->e", unloaded - x0, cut.fine.frames[n : n + edges, 3])[:, np.newaxis]
        * up
    )
    found = [frames, frames_with(height, up)]
    if len(cut.fine.frames) > n + edges:
        corners = frames[shell.model.cut_mesh.cells]
        ends = frames[cut.ends, 0].mean(axis=1)
        bulge = (height - ends)[cut.sides].sum(axis=1) / 2.0
        found.append(
            frames_with(corners[:, :, 0].mean(axis=1) + bulge, unit(corners[:, :, 3].sum(axis=1)))
        )
    return np.concatenate(found)


def _bulged(a: Array, b: Array) -> tuple[Array, Array]:
    """Midpoints and directors of edges between frames."""
    up, along = unit(a[:, 3] + b[:, 3]), b[:, 0] - a[:, 0]
    turn = np.einsum("ej,ej->e", b[:, 3] - a[:, 3], along) / 8.0
    return 0.5 * (a[:, 0] + b[:, 0]) + turn[:, np.newaxis] * up, up


def _local(H: Array, wrench: Array) -> Array:
    pair = wrench.reshape(-1, 2, 3)
    return np.asarray(np.einsum("npj,nij->npi", pair, H[:, 1:]).reshape(-1, 6))


_ITERATIONS = 6


@dataclass(frozen=True)
class HierarchicalEstimate(ErrorEstimate):
    """Error estimate from solutions with additional nodes, in each element or patch.

    *Beams with two nodes*: an element is cut into halves of the same formulation. Its ends are
    fixed, and the new node is in equilibrium with the distributed load. The stress of an element is
    of higher order at its midpoint, and that of a half at the midpoint of the half; the error of
    the element is the slope between both.

    *Shells of first degree*: each cell is cut into four, with a local problem on the cell and its
    neighbours, see :func:`~fem_lie.adaptivity.estimates.hierarchical.shell_hierarchical`.

    The estimate costs about forty evaluations of the forces of a beam, and several hundred of those
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
