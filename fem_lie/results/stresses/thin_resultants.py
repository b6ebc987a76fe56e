"""Forces and moments within thin shells, at the points of integration of their cells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, instance
from fem_lie.bodies.thin_shells.assembly import ThinShellAssembly
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.results.states import StateSeries


class ThinResultants(NamedTuple):
    """What acts within a thin shell in one state, along the axes of its sections.

    Attributes:
        places: Of the points of integration, shape (m, g, 3).
        strains: ``(E₁₁, E₂₂, 2E₁₂, K₁₁, K₂₂, 2K₁₂)`` there, shape (m, g, 6).
        forces: ``(N₁₁, N₂₂, N₁₂)`` per unloaded length, shape (m, g, 3).
        moments: ``(M₁₁, M₂₂, M₁₂)`` per unloaded length, shape (m, g, 3).
    """

    places: Array
    strains: Array
    forces: Array
    moments: Array


def thin_resultants(result: StateSeries, shell: ThinShell, state: int = -1) -> ThinResultants:
    """Forces and moments within a thin shell, those of the assumed strains.

    Args:
        result: What was found.
        shell: A body of its scene.
        state: Which of its states.

    Raises:
        ValueError: The scene has no such body.
        TypeError: The body is no thin shell.
    """
    instance(shell, ThinShell, "thin_resultants: shell", "a ThinShell (of a Shell: resultants)")
    nodes = result.info.body(shell.name).nodes
    H = np.ascontiguousarray(result.frames[state][nodes])
    term = ThinShellAssembly([shell])
    strains = term.strains(H)
    stress = np.einsum("mij,mgj->mgi", term.stiffness, strains)
    values, _, _ = shell.formulation.surface_rule()
    places = np.einsum("ga,maj->mgj", values, shell.vectors(H))
    return ThinResultants(places, strains, stress[..., :3], stress[..., 3:])
