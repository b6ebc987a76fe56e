"""Conserving schemes on random scenes of joints and drives; the long study is a benchmark."""

from __future__ import annotations

import pytest

import fem_lie as fl
from benchmarks.random_conserving import measures, scenes

STEPS = 200


@pytest.mark.parametrize(
    "data",
    [data for _, data in scenes(6, 10_000)],
    ids=[str(seed) for seed, _ in scenes(6, 10_000)],
)
def test_random_scenes_keep_their_balance(data):
    """Drives as fast as in the long study, its first steps."""

    for scheme in (fl.EnergyMomentum(), fl.EnergyDecaying()):
        row = measures(data, scheme, STEPS)
        assert row["steps"] == STEPS
        assert row["balance"] < 1e-10 and row["violation"] < 1e-10
