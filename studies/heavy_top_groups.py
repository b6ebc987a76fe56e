"""The heavy top of heavy_top.py on both groups with smaller and smaller steps."""

from __future__ import annotations

from typing import Any

from demos import heavy_top
from demos.command_line import run
from demos.diagrams import COLOURS, diagram


def main(step: float = 1e-3, halvings: int = 3, pictures: bool = True) -> dict[str, Any]:
    """Records of each group with ``step``, half of it, and so on."""
    steps = [step / 2**k for k in range(halvings + 1)]
    found = {
        group: {f"{h:g}": heavy_top.main(group, h, pictures=False) for h in steps}
        for group in ("SE3", "R3xSO3")
    }
    if pictures:
        with diagram("heavy_top_groups.png") as axes:
            for (group, runs), style, colour in zip(
                found.items(), ("s-", "o-"), COLOURS, strict=False
            ):
                values = [run["position_error"] for run in runs.values()]
                axes.loglog(steps, values, style, color=colour, label=group)
            axes.set(xlabel="step [s]", ylabel="error of the position [m]", title="Heavy top")
    return found


if __name__ == "__main__":
    run(main, show=True)
