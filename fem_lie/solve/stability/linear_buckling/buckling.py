"""Linear buckling: the load factors at which a structure that hardly deforms before is unstable.

The stress of linear theory under the full loads, carried in the unloaded configuration, makes the
tangent ``K₀ + K_g``; at the load factor λ it is ``K₀ + λ K_g``, and singular at the factors that
are sought. No geometric stiffness is derived for it: the tangent with a carried stress is what
every iteration of statics uses.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import whole
from fem_lie.linear.direct import ConvergenceError
from fem_lie.results.mode_shapes import BucklingModes
from fem_lie.scene import Scene
from fem_lie.solve.progress_bars import step_bar
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.stability.linear_buckling.geometric import geometric_stiffness
from fem_lie.solve.stability.linear_buckling.load_factors import lowest_positive
from fem_lie.solve.stability.linear_buckling.potential import check_potential, energy_radius
from fem_lie.solve.statics.follow import check_proportion
from fem_lie.solve.stopwatch import Stopwatch
from fem_lie.system.equations import Equations

_STAGES = 5  # that the progress bar counts
_OTHER_SIGN = 100.0  # times that factors of loads that pull are those of reversed loads, or more
_STRAINED = 0.05  # largest strain at them, which linear theory knows nothing of


def buckling(
    scene: Scene, count: int = 4, *, petsc_options_prefix: str = "fem_lie_buckling_"
) -> BucklingModes:
    """Lowest positive load factors of linear buckling, and their modes.

    Args:
        scene: What there is, with its loads at factor 1.
        count: Number of modes.
        petsc_options_prefix: Prefix for the choice of SLEPc's solver.

    Raises:
        ValueError: Bad scene, no load, loads that are not in proportion to the load factor, a
            structure that is not held, elements that carry no stress, loads that have no potential
            among the motions that supports and joints leave free, or more modes than degrees of
            freedom.
        ConvergenceError: There are less positive load factors than were asked for, and its
            ``result`` holds them; or there is none, as where the loads pull.
    """
    check_proportion(scene)
    whole(count, "count")
    model = StableEquilibrium(scene, petsc_options_prefix)
    unknowns = model.equations.unknowns
    _check_stress(model.equations)
    free = int((~unknowns.held).sum()) - unknowns.m
    if not 1 <= count <= free:
        raise ValueError(f"count must be 1 … {free}, the degrees of freedom, got {count}")
    watch = Stopwatch()
    model.check_start(0.0)
    with step_bar("buckling", "stage", _STAGES) as show:
        _, load = model.forces()
        model.factorise(0.0)
        show("displacements")
        K, B = model.pencil()
        dx = model.solve_finely(load)
        show("geometric stiffness")
        G = geometric_stiffness(model, K, dx)
        K = (0.5 * (K + K.T)).tocsr()
        show("load factors and modes")
        factors, vectors = lowest_positive(K, B, G.symmetric, count, petsc_options_prefix)
        show("checks")
        check_potential(model, K, G, (factors, vectors))
        factors *= G.factor
        radius = energy_radius(model, K, G.symmetric) / G.factor
        show("")
    if not len(factors) or (
        factors[0] * radius > _OTHER_SIGN and factors[0] * model.largest_strain(dx) > _STRAINED
    ):
        raise ConvergenceError(_no_buckling(radius))
    shapes = np.array([model.increments(vector) for vector in vectors])
    equations = model.equations
    shapes, turns_only = model.all_nodes(shapes.reshape(-1, unknowns.moving, 6))
    modes = BucklingModes(
        factors=factors,
        shapes=shapes,
        turns_only=turns_only,
        frames=equations.report(equations.start.unloaded).frames.copy(),
        size=model.diameter,
        info=equations.info,
        seconds=watch.seconds,
    )
    if len(factors) < count:
        raise ConvergenceError(
            f"SLEPc found {len(factors)} of {count} positive load factors: there may be no more; "
            "those of reversed loads do not count",
            modes,
        )
    return modes


def _check_stress(equations: Equations) -> None:
    """Raise ``ValueError`` if elements carry none: their stiffness would not know of it."""
    for where, assembly in equations.tables.assemblies:
        if not assembly.carried_stress.size:
            bodies = equations.unknowns.bodies.items()
            labels = [b.label for b, nodes in bodies if where.start <= nodes[0] < where.stop]
            raise ValueError(
                f"the elements of {', '.join(labels)} carry no stress, of which linear buckling is "
                "made: write their energy as a StrainEnergy, not as a plain form, or follow the "
                "path by fl.follow_path"
            )


def _no_buckling(radius: float) -> str:
    """What to say where the loads do not make the scene unstable.

    Args:
        radius: One over the least load factor, which is of the other sign; 0 if there is none.
    """
    what = "these loads do not make the scene unstable at any positive load factor"
    if not radius:
        return f"{what}: they do not change its stiffness"
    return f"{what}: they pull; reversed loads do at about {1.0 / radius:.3g} times their size"
