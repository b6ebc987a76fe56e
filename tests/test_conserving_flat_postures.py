"""Conserving schemes where constraints lose rank: there frozen matrices are misleading.

A frozen matrix has the constraints of an older posture, and next to a flat one the digits in which
the bars are not parallel grow with each iteration by the ratio of the two. A step that ends so is
on another branch, with the energy of the right one.
"""

from __future__ import annotations

import pytest

import fem_lie as fl
from demos.double_four_bar import mechanism, parallel

END = 10.0
PARALLEL, ENERGY = 1e-11, 2e-10
"""Bounds: twenty times what full Newton leaves, and what steps next to flat postures lose."""


@pytest.mark.parametrize("step", [4e-3, 2e-3, 1e-3])
def test_all_steps_keep_the_branch(step: float) -> None:
    """Some thirty passages, whatever the distance at which steps end next to them."""
    result = fl.EnergyMomentum().run(mechanism(pins=True), duration=END, step=step)
    assert result.times[-1] == pytest.approx(END)
    assert parallel(result) < PARALLEL
    assert result.energy_error < ENERGY


def test_few_steps_have_new_matrices() -> None:
    """What is costly is done next to flat postures alone: in a second there are four."""
    result = fl.EnergyMomentum().run(mechanism(pins=True), duration=1.0, step=1e-3)
    always = fl.EnergyMomentum(policy=fl.schemes.EveryIteration())
    full = always.run(mechanism(pins=True), duration=1.0, step=1e-3)
    assert result.factorisations < 0.1 * full.factorisations


def test_dissipation_keeps_the_branch() -> None:
    """The decaying scheme has the same iteration."""
    result = fl.EnergyDecaying().run(mechanism(pins=True), duration=END, step=2e-3)
    assert parallel(result) < PARALLEL
