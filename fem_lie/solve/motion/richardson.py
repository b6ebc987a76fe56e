"""Time discretisation error of any scheme, from runs with halved steps (Richardson).

Schemes with an error estimate in each step use it during the run
(:mod:`fem_lie.solve.step_control`). For all others, and to check the estimates, a scene is run with
steps ``h``, ``h/2`` and ``h/4``: if the changes from run to run decrease by ``2^p``, the error of
the last run is its change over ``2^p − 1``. The order ``p`` is observed, not assumed: if it differs
much from that of the scheme, the steps do not resolve the motion, or only round-off is left.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, positive
from fem_lie._summary import Summarised
from fem_lie.results import Result
from fem_lie.results.record import Record
from fem_lie.scene import Scene
from fem_lie.solve.motion.integrator import Integrator

_PARTS = 1, 2, 4


@dataclass(frozen=True, repr=False)
class TimeErrorEstimate(Summarised):
    """Time discretisation error of the run with the smallest steps, largest over all nodes.

    Attributes:
        times: Times at the ends of the largest steps, shape (k + 1,).
        translation: Error of positions at these times, length, (k + 1,).
        rotation: Error of rotations, rad, (k + 1,).
        order: Order observed at the end, the lower one of positions and rotations; infinite if the
            last two runs do not differ.
        result: The run with the smallest steps.
    """

    times: Array
    translation: Array
    rotation: Array
    order: float
    result: Result


def estimate_time_error(
    scheme: Integrator, scene: Scene, *, duration: float, step: float
) -> TimeErrorEstimate:
    """Time discretisation error of a scheme, from runs with the steps h, h/2 and h/4.

    Args:
        scheme: Any scheme with constant steps. :class:`~fem_lie.schemes.Asynchronous` halves all
            steps only if ``step`` is not above the smallest step of any cell.
        scene: The scene.
        duration: End time; a multiple of ``step``.
        step: The largest steps.

    Returns:
        The error of the run with steps ``step/4``.

    Raises:
        ValueError: As from :meth:`~fem_lie.Integrator.run`.
        ConvergenceError: A step failed.

    Example:
        >>> top = fl.RigidBody(1.0, (0.1, 0.2, 0.3))
        >>> top.add_velocity(omega=(0, 0.1, 2), about=top.point("centre"))
        >>> scene = fl.Scene()
        >>> _ = scene.add(top)
        >>> error = fl.schemes.estimate_time_error(fl.Explicit(), scene, duration=1.0, step=0.05)
        >>> round(error.order), bool(error.rotation[-1] < 1e-4)
        (2, True)
    """
    positive(step, "step")
    runs = [
        scheme.run(
            scene,
            duration=duration,
            step=step / parts,
            save_every=parts,
            record=Record.VELOCITIES if parts < _PARTS[-1] else Record.ALL,
        )
        for parts in _PARTS
    ]
    changes = [_changes(one.frames, other.frames) for one, other in pairwise(runs)]
    orders, errors = [], []
    for far, near in zip(*changes, strict=True):
        order = float(np.log2(far[-1] / near[-1])) if near[-1] > 0.0 else np.inf
        orders.append(order)
        # an error that does not decrease is at least as large as its change
        errors.append(near / max(2.0**order - 1.0, 1.0))
    return TimeErrorEstimate(runs[-1].times, errors[0], errors[1], min(orders), runs[-1])


def _changes(one: Array, other: Array) -> tuple[Array, Array]:
    """Largest distances and angles between frames (k, N, 4, 3), at each time."""
    away = np.linalg.norm(other[:, :, 0] - one[:, :, 0], axis=-1)
    turned = np.linalg.norm(lie.se3_relative(one, other)[..., 3:], axis=-1)
    return away.max(axis=1), turned.max(axis=1)
