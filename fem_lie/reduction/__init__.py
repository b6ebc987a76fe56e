"""Reduced-order bodies: bases in local frames, Craig-Bampton, POD, hyper-reduction, merging.

Beams with sections that distort in few modes are here, too.
"""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.bodies.distorting.distorting_beam import DistortingBeam
    from fem_lie.bodies.reduced.reduced_body import ReducedOrderBody
    from fem_lie.reduction.axes import FixedAxes, MeanAxes, NodeAxes
    from fem_lie.reduction.bases import (
        craig_bampton,
        interpolated_basis,
        krylov,
        pod,
        with_derivatives,
    )
    from fem_lie.reduction.basis import Basis, ReducedStates, load_basis
    from fem_lie.reduction.energy_sampling import CellSample, ecsw
    from fem_lie.reduction.making import inertial_modes, reduced_order_body
    from fem_lie.reduction.merged_result import MergedMotion, RegionSegment
    from fem_lie.reduction.merging import merged_motion
    from fem_lie.reduction.part_files import load_reduced, recover_full_motion, save_reduced
    from fem_lie.reduction.reduced_equilibria import (
        ReducedEquilibrium,
        reduced_frequencies,
        reduced_statics,
    )
    from fem_lie.reduction.sampled_equilibria import SampledEquilibria, sampled_statics
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "Basis",
    "CellSample",
    "DistortingBeam",
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
    "interpolated_basis",
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
