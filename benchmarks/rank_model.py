"""A model of the time of a step of a net of cables on up to 1024 ranks, from counts and seconds.

    python3 -m benchmarks.rank_model --unknowns 2.02e6 --out 1.json
    tools/run mpirun -n 8 python3 -m benchmarks.rank_model --unknowns 2.02e6 --out 8.json
    python3 -m benchmarks.rank_model --model 1.json 8.json

The first run measures, on one rank, processor seconds of a step: of cells and chains, which ranks
divide, and of the rest, knots and nodes between ranks, which MUMPS solves for. The second counts
what ranks tell each other, per step and rank: sums over shared nodes, their bytes, and reductions
of numbers. It is a model: what MUMPS would take on many ranks is taken as what it takes on one, and
latency and rate of the network are those of :data:`MACHINES`, not measured.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any, NamedTuple

from mpi4py import MPI

import numpy as np

import fem_lie as fl
from benchmarks.large_nets import hexagonal_net, squares
from benchmarks.two_ranks import Clock
from fem_lie.linear.condensed.preconditioner import Condensed
from fem_lie.ranks.divided_matrix import DividedMatrix
from fem_lie.ranks.shared_nodes import SharedNodes
from fem_lie.solve.alpha.run import Run

sys.path.insert(0, str(Path(__file__).parents[1] / "demos"))

STEPS = 3


class Machine(NamedTuple):
    """What messages cost.

    Attributes:
        latency: Seconds of a message.
        rate: Bytes in a second.
        most: Largest number of ranks.
    """

    latency: float
    rate: float
    most: int


MACHINES = {
    "laptop": Machine(1e-6, 5e9, 8),
    "node": Machine(1.5e-6, 5e9, 64),
    "cluster": Machine(3e-6, 1e10, 1024),
}
"""Usual figures, of messages within a node and by InfiniBand."""


class Counted:
    """Number of calls and of bytes of methods.

    Attributes:
        calls: By names of methods.
        bytes: Bytes of shared nodes.
    """

    def __init__(self) -> None:
        """None yet."""
        self.calls: dict[str, int] = {}
        self.bytes = 0

    def watch(self, name: str, owner: Any, method: str) -> None:
        """Count a method under a name."""
        given = getattr(owner, method)

        def counted(self_: Any, *args: Any) -> Any:
            self.calls[name] = self.calls.get(name, 0) + 1
            if name == "sums":
                self.bytes += int(self_.copied.sum()) * args[0][0].nbytes
            return given(self_, *args)

        setattr(owner, method, counted)

    def forget(self) -> None:
        """Begin again."""
        self.calls, self.bytes = {}, 0


def measure(unknowns: float, make: Any) -> dict[str, float]:
    """Counts of a step of the rank that has the most, and its seconds."""
    from demos.space_net import STEP, square_net

    scheme, options = fl.GeneralisedAlpha(radius=0.8), {"step": STEP, "progress": False}
    scheme.run(square_net(1, 4), duration=STEP, **options)
    counted, clock, world = Counted(), Clock(), MPI.COMM_WORLD
    counted.watch("sums", SharedNodes, "sum")
    for name in "largest", "total", "all", "any":
        counted.watch("reductions", SharedNodes, name)
    counted.watch("solutions", DividedMatrix, "solve")
    counted.watch("factorisations", Condensed, "setUp")
    clock.watch("step", Run, "_advance")
    clock.watch("solution of the rest", DividedMatrix, "solve")
    clock.watch("factors of the rest", Condensed, "setUp")
    clock.watch("step", Condensed, "_eliminate")
    found: dict[str, float] = {}
    begun = Run.start

    def start(run: Run) -> None:
        begun(run)
        counted.forget()
        clock.turn()
        clock.spent.clear()
        shared = run.equations.shared
        found["nodes"], found["shared"] = float(len(shared.owned)), float(shared.copied.sum())

    Run.start = start  # type: ignore[method-assign]
    result = scheme.run(make(unknowns), duration=STEPS * STEP, save_every=STEPS, **options)
    clock.turn()
    found |= {name: count / STEPS for name, count in counted.calls.items()}
    found["bytes"] = counted.bytes / STEPS
    found |= {f"seconds, {name}": spent / STEPS for name, spent in clock.spent.items()}
    found["iterations"] = float(result.iterations[-1]) / STEPS
    every = world.allgather(found)
    most = {name: max(each.get(name, 0.0) for each in every) for name in found}
    return most | {"ranks": float(world.size), "unknowns": unknowns}


def modelled(
    one: dict[str, float], several: dict[str, float], ranks: int, machine: Machine
) -> dict[str, float]:
    """Seconds of a step on so many ranks: of cells, of the rest, and of messages."""
    rest = one["seconds, solution of the rest"] + one["seconds, factors of the rest"]
    reductions, sums = several["reductions"], several["sums"]
    # a part has about six neighbours, and its boundary shrinks as the root of its size
    boundary = (several["ranks"] / ranks) ** 0.5
    of_sums = 6.0 * sums * machine.latency + boundary * several["bytes"] / machine.rate
    # MUMPS passes its tree up and down in each solution
    of_rest = 4.0 * several["solutions"] * np.log2(ranks) * machine.latency
    messages = 2.0 * np.log2(ranks) * reductions * machine.latency + 2.0 * of_sums + of_rest
    return {
        "cells": one["seconds, step"] / ranks,
        "rest": rest,
        "messages": float(messages) if ranks > 1 else 0.0,
    }


def table(one: dict[str, float], several: dict[str, float]) -> str:
    """Seconds of a step over ranks, in Markdown."""
    titles = "machine", "ranks", "cells", "rest", "messages", "a step, s", "of its ranks, %"
    rows = [f"| {' | '.join(titles)} |", "|---" * len(titles) + "|"]
    alone = sum(modelled(one, several, 1, MACHINES["laptop"]).values())
    for name, machine in MACHINES.items():
        for ranks in (2, 8, 16, 64, 72, 256, 1024):
            if ranks <= machine.most:
                parts = modelled(one, several, ranks, machine)
                whole = sum(parts.values())
                shown = " | ".join(f"{part:.2g}" for part in parts.values())
                share = f"{100 * alone / whole / ranks:.0f}"
                rows.append(f"| {name} | {ranks} | {shown} | {whole:.2g} | {share} |")
    return "\n".join(rows)


def main() -> None:
    """Measure, or print the model."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--unknowns", type=float, default=1e5)
    parser.add_argument("--hexagonal", action="store_true")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--model", nargs=2, type=Path)
    given = parser.parse_args()
    if given.model is not None:
        print(table(*(json.loads(path.read_text()) for path in given.model)))
        return
    found = measure(given.unknowns, hexagonal_net if given.hexagonal else squares)
    if MPI.COMM_WORLD.rank == 0:
        text = json.dumps(found, indent=2)
        print(text)
        if given.out is not None:
            given.out.write_text(text)


if __name__ == "__main__":
    main()
