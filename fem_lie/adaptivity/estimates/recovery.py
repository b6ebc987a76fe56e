"""Errors by recovered stress: how far the stress of the elements is from a smoother one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_lie._arrays import Array
from fem_lie.adaptivity.estimates.estimate import (
    ElementErrors,
    ErrorEstimate,
    Estimated,
    Estimator,
    steps_of,
)
from fem_lie.adaptivity.estimates.lines import ancf_beam_fields, cable_fields
from fem_lie.adaptivity.estimates.residual import ShellEdges
from fem_lie.adaptivity.estimates.solids import solid_fields
from fem_lie.adaptivity.estimates.stress_fields import StressFields
from fem_lie.adaptivity.estimates.surfaces import ancf_shell_fields, thin_fields
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.gradients.ancf_beam import AncfBeam
from fem_lie.bodies.gradients.ancf_shell import AncfShell
from fem_lie.bodies.rods.cable_body import CableBody
from fem_lie.bodies.shells.shell import Shell
from fem_lie.bodies.solids.solid import Solid
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.stresses.element_forces import without_jumps
from fem_lie.results.stresses.nodal_values import CellPoints
from fem_lie.results.stresses.section_forces import SectionForces, section_forces
from fem_lie.results.stresses.shell_resultants import Resultants, resultant_series
from fem_lie.results.stresses.shell_stress import ShellStress, in_axes, integration
from fem_lie.results.stresses.stress_free import require_no_strains
from fem_lie.scene import Scene


def beam_fields(
    result: Result | StaticResult, beam: Beam, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Stress of the elements and recovered stress in some states.

    Forces at the ends of elements are in equilibrium with all forces on nodes and joints, so they
    are of higher order than ``σ = D ε``; in local frames they are components of one smooth field.
    The recovered stress is a polynomial in each element, of a degree equal to the number g of
    integration points. It interpolates these forces at both ends, without the jumps of distributed
    loads, and with g = 2 it has the mean of the element's own stress. The superconvergent patch of
    Zienkiewicz & Zhu (IJNME 33 (1992) 1331) is the element itself.

    Raises:
        ValueError: See :func:`~fem_lie.results.stresses.section_forces.section_forces`; or the
            energy of the element is not a strain energy.
    """
    found = section_forces(result, beam, scene, states=steps)
    return [_beam_fields(found, k) for k in range(len(steps))]


def _beam_fields(found: SectionForces, k: int) -> StressFields:
    beam, stress = found.beam, found.at_points(k)
    # without viscous forces
    ends = found.elements.at_ends(found.frames[k])[np.newaxis]
    ends = without_jumps(beam, ends, found.single)[0]
    g = stress.shape[1]
    x, w = np.polynomial.legendre.leggauss(g + 1)
    at = 0.5 * (1.0 + x)
    own, (start, end) = _polynomial(stress, at), np.swapaxes(ends, 0, 1)[:, :, np.newaxis]
    recovered = start + at[:, np.newaxis] * (end - start)
    if g > 1:
        missing = 1.5 * (stress.mean(axis=1) - ends.mean(axis=1))[:, np.newaxis]
        recovered = recovered + missing * (4.0 * at * (1.0 - at))[:, np.newaxis]
    weights = 0.5 * w * beam.model.lengths[:, np.newaxis]
    return StressFields(own, recovered, weights, np.linalg.inv(beam.model.stiffness))


def _polynomial(values: Array, at: Array) -> Array:
    """Values (m, g, 6) at Gauss points, interpolated to points ``at`` (q,) from 0 to 1."""
    x, _ = np.polynomial.legendre.leggauss(values.shape[1])
    points = np.vander(0.5 * (1.0 + x), increasing=True)
    positions = np.vander(at, values.shape[1], increasing=True)
    return np.asarray(np.einsum("qg,mgi->mqi", positions @ np.linalg.inv(points), values))


def shell_fields(
    result: Result | StaticResult, shell: Shell, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Stress of the cells and recovered stress in some states.

    The recovered stress is interpolated from nodal values by the shape functions of the mesh. Nodal
    values are means over the cells that meet smoothly at the node, each rotated to one frame; at
    edges they are from a plane fitted to the values around (see
    :mod:`~fem_lie.results.stresses.shell_values`). Rigid motion is contained in the frames, not in
    the averaged components.

    Raises:
        ValueError: The shell is not in that result, or there is no such state.
    """
    require_no_strains(result, shell, "errors of shells cannot be estimated")
    series = resultant_series(result, shell, states=steps)
    rule, _ = integration(shell)
    shapes = CellPoints.of(shell.model.cut_mesh, rule).shapes
    compliance = ShellStress.of(shell).compliance
    return [_shell_fields(found, shapes, compliance) for found in series]


def _shell_fields(found: Resultants, shapes: Array, compliance: Array) -> StressFields:
    positions, number = found.stress_points, found.stress_points.patches.number
    nodal = in_axes(found.averaged[number], positions.shared[number], positions.section_at_nodes)
    own = in_axes(found.at_points, positions.asked, positions.section)
    return StressFields(own, shapes @ nodal, found.areas, compliance)


_RECOVERIES: dict[type, Callable[..., list[StressFields]]] = {
    Beam: beam_fields,
    Shell: shell_fields,
    ThinShell: thin_fields,
    AncfShell: ancf_shell_fields,
    AncfBeam: ancf_beam_fields,
    CableBody: cable_fields,
    Solid: solid_fields,
}


@dataclass(frozen=True)
class RecoveryEstimate(ErrorEstimate):
    """Error estimate ``∫ (σ* − σ)·D⁻¹(σ* − σ)`` with a recovered stress σ*: the default.

    (O. C. Zienkiewicz & J. Z. Zhu, IJNME 24 (1987) 337.)

    Example:
        >>> fl.adaptivity.RecoveryEstimate()
        RecoveryEstimate()
    """

    def estimators(self) -> Mapping[type, Estimator]:
        """Functions for all elastic bodies."""
        return {**dict.fromkeys(_RECOVERIES, _errors), Shell: shell_errors}


def shell_errors(
    result: Result | StaticResult, shell: Shell, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    """Errors by recovered stress, and for cells of degree 1 those of boundary layers.

    Recovered stress cannot represent a layer that is narrower than cells: of the Scordelis-Lo roof
    the estimate was half of the error without them.

    Raises:
        ValueError: The shell is not in that result, or there is no such state.
    """
    found = shell_fields(result, shell, scene, steps)
    if shell.model.cut_mesh.degree > 1:
        return [fields.errors for fields in found]
    edges = ShellEdges.of(shell)
    return [
        replace(fields.errors, squares=fields.errors.squares + edges.layer_squares(fields.own))
        for fields in found
    ]


def _errors(
    result: Result | StaticResult, body: Estimated, scene: Scene, steps: Sequence[int]
) -> list[ElementErrors]:
    return [fields.errors for fields in fields_of(result, body, scene, steps)]


def fields_of(
    result: Result | StaticResult, body: Estimated, scene: Scene, steps: Sequence[int] = (-1,)
) -> list[StressFields]:
    """Stress of the elements of a body and recovered stress in some states.

    Raises:
        ValueError: See :meth:`~fem_lie.adaptivity.estimates.estimate.ErrorEstimate.errors`.
    """
    chosen = steps_of(result, body, scene, steps, tuple(_RECOVERIES))
    (recovery,) = (r for kind, r in _RECOVERIES.items() if isinstance(body, kind))
    return recovery(result, body, scene, chosen)
