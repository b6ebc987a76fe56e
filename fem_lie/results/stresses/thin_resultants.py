"""Stress resultants of thin shells at the integration points of their cells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, instance
from fem_lie.bodies.thin_shells.assembly import ThinShellAssembly
from fem_lie.bodies.thin_shells.thin_shell import ThinShell
from fem_lie.results.states import StateSeries


class ThinResultants(NamedTuple):
    """Stress resultants and strains of a thin shell in one state, along the axes of its sections.

    Attributes:
        positions: Current positions of the integration points, shape (m, g, 3).
        strains: ``(E₁₁, E₂₂, 2E₁₂, K₁₁, K₂₂, 2K₁₂)``, shape (m, g, 6).
        forces: ``(N₁₁, N₂₂, N₁₂)`` per undeformed length, shape (m, g, 3).
        moments: ``(M₁₁, M₂₂, M₁₂)`` per undeformed length, shape (m, g, 3).
    """

    positions: Array
    strains: Array
    forces: Array
    moments: Array


def thin_resultants(result: StateSeries, shell: ThinShell, state: int = -1) -> ThinResultants:
    """Stress resultants of a thin shell in one state, from its assumed strains.

    Args:
        result: A result of a scene with the shell.
        shell: The thin shell.
        state: Index of the state.

    Raises:
        ValueError: The scene of the result does not have this body.
        TypeError: The body is not a thin shell.
    """
    instance(shell, ThinShell, "thin_resultants: shell", "a ThinShell (of a Shell: resultants)")
    nodes = result.info.body(shell.name).nodes
    H = np.ascontiguousarray(result.frames[state][nodes])
    term = ThinShellAssembly([shell])
    strains = term.strains(H)
    stress = np.einsum("mij,mgj->mgi", term.stiffness, strains)
    values, _, _ = shell.formulation.surface_rule()
    positions = np.einsum("ga,maj->mgj", values, shell.vectors(H))
    return ThinResultants(positions, strains, stress[..., :3], stress[..., 3:])
