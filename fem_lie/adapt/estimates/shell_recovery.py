"""Recovered stress of shells: averaged over smooth patches of cells in one frame each."""

from __future__ import annotations

from collections.abc import Sequence

from fem_lie._arrays import Array
from fem_lie.adapt.estimates.stress_fields import StressFields
from fem_lie.bodies.shells.shell import Shell
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.history import Result
from fem_lie.results.stresses.nodal_values import CellPoints
from fem_lie.results.stresses.shell_resultants import Resultants, resultant_series
from fem_lie.results.stresses.shell_stress import ShellStress, in_axes, integration
from fem_lie.scene import Scene


def shell_fields(
    result: Result | StaticResult, shell: Shell, scene: Scene, steps: Sequence[int]
) -> list[StressFields]:
    """Stress of the cells, and the one recovered from it, in some states.

    The recovered stress has the shape functions of the mesh between values at its nodes: those of
    the cells that meet smoothly there, each turned to one frame of the patch, in the mean, and at
    edges a plane through the values around (see :mod:`~fem_lie.results.stresses.shell_values`).
    Rigid motion is in the frames and not in what is averaged.

    Raises:
        ValueError: The shell is not in that result, or there is no such step.
    """
    series = resultant_series(result, shell, steps=steps)
    rule, _ = integration(shell)
    shapes = CellPoints.of(shell.own_mesh, rule).shapes
    compliance = ShellStress.of(shell).compliance
    return [_fields(found, shapes, compliance) for found in series]


def _fields(found: Resultants, shapes: Array, compliance: Array) -> StressFields:
    places, number = found.places, found.places.patches.number
    nodal = in_axes(found.averaged[number], places.shared[number], places.section_at_nodes)
    own = in_axes(found.at_points, places.asked, places.section)
    return StressFields(own, shapes @ nodal, found.areas, compliance)
