"""Errors of all elements on the 45 degree bend, over their number.

The problem, the elements and the reference are those of bend45.py. The error is the distance of the
tip from where the differential equations have it, over the distance of that from the origin.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from demos.bend45 import FORMULATIONS, solve
from demos.command_line import run
from demos.diagrams import COLOURS, diagram

COUNTS = (4, 8, 16, 32)


def main(load_steps: int = 3, pictures: bool = True) -> dict[str, Any]:
    """Errors and iterations of each element, by its name and the number of elements."""
    record: dict[str, Any] = {}
    for name, element in FORMULATIONS.items():
        runs = {count: solve(count, load_steps, element)[0] for count in COUNTS}
        record[name] = {f"error_{count}": run["tip_error"] for count, run in runs.items()}
        record[name] |= {f"iterations_{count}": run["iterations"] for count, run in runs.items()}
    if pictures:
        draw(record)
    return {"elements": record}


def draw(record: dict[str, dict[str, Any]]) -> None:
    """Error over elements of each formulation."""
    counts = np.array(COUNTS)
    with diagram("elements_on_a_bend.png") as axes:
        for k, (name, found) in enumerate(record.items()):
            colour, mark = COLOURS[k % len(COLOURS)], "os^vD<>ph*"[k]
            errors = [found[f"error_{count}"] for count in COUNTS]
            axes.loglog(counts, errors, f"{mark}-", color=colour, label=name)
        for name, order, style in (("plain", 2, "k:"), ("director2", 4, "k--")):
            line = 0.4 * record[name]["error_4"] * (4 / counts) ** order
            axes.loglog(counts, line, style, label=f"order {order}")
        axes.set(xlabel="elements", ylabel="error of the tip, relative", title="45° bend")
        axes.set_xticks(counts, [str(n) for n in counts])
        axes.minorticks_off()
        axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))


if __name__ == "__main__":
    run(main, show=True)
