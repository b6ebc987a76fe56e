"""Stress-free stretch of the cells of a solid, by temperature or growth."""

from __future__ import annotations

import dolfinx
import numpy as np
from dolfinx import fem

from fem_lie._arrays import Array
from fem_lie.elements.solids.element import PAIRS


def inverse_stretch(strains: Array, label: str) -> Array:
    """Inverse ``U₀⁻¹ = (1 + 2 E₀)^(-½)`` of stress-free stretches, shape (m, 3, 3).

    Args:
        strains: Green's strains ``E₀`` as (11, 22, 33, 2·12, 2·13, 2·23), shape (m, 6).
        label: Name of the body, for the message.

    Raises:
        ValueError: A strain is not that of a stretch.
    """
    C = np.tile(np.eye(3), (len(strains), 1, 1))
    for (i, j), component in zip(PAIRS, strains.T, strict=True):
        C[:, i, j] += component * (2 if i == j else 1)
        C[:, j, i] = C[:, i, j]
    squares, axes = np.linalg.eigh(C)
    if (squares <= 0.0).any():
        cell = int(np.argwhere(squares <= 0.0)[0, 0])
        raise ValueError(
            f"a stress-free strain of {label} must be that of a stretch, with 1 + 2 E positive "
            f"definite, got (11, 22, 33, 2·12, 2·13, 2·23) = {strains[cell]}"
        )
    return np.asarray((axes / np.sqrt(squares)[:, np.newaxis]) @ axes.swapaxes(1, 2))


class StressFreeStretch:
    """Stretch ``U₀`` in which a cell has no stress: that of the gradient is ``F U₀⁻¹``.

    Attributes:
        inverse: ``U₀⁻¹``, cellwise, shape (3, 3); the identity at first.
    """

    def __init__(self, mesh: dolfinx.mesh.Mesh, label: str) -> None:
        """Start with the unloaded state.

        Args:
            mesh: The mesh.
            label: Name of the body, for messages.
        """
        self._label = label
        self.inverse = fem.Function(fem.functionspace(mesh, ("DG", 0, (3, 3))))
        self._matrices: Array = self.inverse.x.array.reshape(-1, 3, 3)
        self._matrices[:] = np.eye(3)

    def set(self, strains: Array) -> None:
        """Set Green's strain of the stress-free state of each cell, shape (m, 6).

        Raises:
            ValueError: A strain is not that of a stretch.
        """
        self._matrices[:] = inverse_stretch(strains, self._label)
