"""Reduced-order bodies: bases in local frames, Craig-Bampton, POD, hyper-reduction, merging."""

from typing import TYPE_CHECKING

from fem_lie._renamed import unknown_name
from fem_lie.bodies.reduced.reduced_body import ReducedOrderBody
from fem_lie.reduction.axes import FixedAxes, MeanAxes, NodeAxes
from fem_lie.reduction.bases import craig_bampton, krylov, pod, with_derivatives
from fem_lie.reduction.basis import Basis, ReducedStates, load_basis
from fem_lie.reduction.ecsw import CellSample, ecsw
from fem_lie.reduction.making import inertial_modes, reduced_order_body
from fem_lie.reduction.merged_motion import MergedMotion, RegionSegment
from fem_lie.reduction.merging import merged_motion
from fem_lie.reduction.part_files import load_reduced, recover_full_motion, save_reduced
from fem_lie.reduction.reduced_statics import (
    ReducedEquilibrium,
    reduced_frequencies,
    reduced_statics,
)
from fem_lie.reduction.sampled_statics import SampledEquilibria, sampled_statics

__all__ = [
    "Basis",
    "CellSample",
    "FixedAxes",
    "MeanAxes",
    "MergedMotion",
    "NodeAxes",
    "ReducedEquilibrium",
    "ReducedOrderBody",
    "ReducedStates",
    "RegionSegment",
    "SampledEquilibria",
    "craig_bampton",
    "ecsw",
    "inertial_modes",
    "krylov",
    "load_basis",
    "load_reduced",
    "merged_motion",
    "pod",
    "recover_full_motion",
    "reduced_frequencies",
    "reduced_order_body",
    "reduced_statics",
    "sampled_statics",
    "save_reduced",
    "with_derivatives",
]

if not TYPE_CHECKING:  # for users; type checkers know what there is
    __getattr__ = unknown_name(__name__)
