"""What it costs to record: the double pendulum with all states kept, and less of each, in turns.

    python3 benchmarks/recording.py [--rounds 20]

Microseconds per step are processor time, the least of all rounds, of which a run of a tenth of the
steps is taken away: what remains are steps, those that make matrices included. Bytes are what a
state takes.
"""

from __future__ import annotations

from argparse import ArgumentParser
from time import thread_time

import numpy as np

import fem_lie as fl
from demos.double_pendulum import STEP, pendulum

STEPS = 1000
SCHEMES = {
    "generalised-α": fl.GeneralisedAlpha(radius=0.8),
    "energy-momentum": fl.EnergyMomentum(),
    "variational": fl.schemes.Variational(),
}
RECORDS = {
    "all": fl.schemes.Record.ALL,
    "all but forces": fl.schemes.Record.ALL & ~fl.schemes.Record.FORCES,
    "velocities and energies": fl.schemes.Record.VELOCITIES | fl.schemes.Record.ENERGIES,
    "energies": fl.schemes.Record.ENERGIES,
    "momenta": fl.schemes.Record.MOMENTA,
    "forces": fl.schemes.Record.FORCES,
    "coordinates": fl.schemes.Record.COORDINATES,
    "velocities": fl.schemes.Record.VELOCITIES,
    "frames alone": fl.schemes.Record.FRAMES,
}


def cost(
    scheme: fl.GeneralisedAlpha, record: fl.schemes.Record, steps: int
) -> tuple[float, fl.Result]:
    """Processor time of a run."""
    scene = pendulum(1)[0]
    start = thread_time()
    plan = {"duration": steps * STEP[1], "step": STEP[1], "progress": False}
    result = scheme.run(scene, record=record, **plan)
    return thread_time() - start, result


def main(rounds: int) -> None:
    print("scheme           record                    µs/step   of all   bytes of a state")
    for name, scheme in SCHEMES.items():
        steps = STEPS // 10 if name == "variational" else STEPS
        seconds, sizes = np.empty((2, rounds, len(RECORDS))), np.empty(len(RECORDS))
        for turn in range(rounds):
            for k, record in enumerate(RECORDS.values()):
                seconds[0, turn, k], result = cost(scheme, record, steps)
                seconds[1, turn, k], _ = cost(scheme, record, steps // 10)
                arrays = (value for value in vars(result).values() if hasattr(value, "nbytes"))
                sizes[k] = sum(array.nbytes for array in arrays) / len(result.times)
        least = seconds.min(axis=1)
        best = 1e6 * (least[0] - least[1]) / (steps - steps // 10)
        for text, each, size in zip(RECORDS, best, sizes, strict=True):
            print(f"{name:16} {text:24} {each:8.1f} {each / best[0]:8.2f} {size:10.0f}")


if __name__ == "__main__":
    parser = ArgumentParser(description="What it costs to record")
    parser.add_argument("--rounds", type=int, default=20)
    main(parser.parse_args().rounds)
