"""Table 1 of the paper on local frames: the deployable truss with every policy.

Rows of truss_deployment.py, with a step and half of it.
"""

from __future__ import annotations

from typing import Any

from demos import truss_deployment
from demos.command_line import run


def main(
    cells: int = 2,
    tubes: str = "stiff",
    step: float = 2e-3,
    elements: int = 10,
    duration: float = truss_deployment.DEPLOYMENT,
    inertial: bool = False,
    pictures: bool = False,
) -> dict[str, Any]:
    """Records by policy and step; no pictures are made."""
    rows = {}
    for h in (step, 0.5 * step):
        for name in truss_deployment.POLICIES:
            options = {"duration": duration, "inertial": inertial, "pictures": pictures}
            row = truss_deployment.main(cells, tubes, h, name, elements, **options)
            rows[f"{name}, h = {h:g}"] = row
    return {"rows": rows}


if __name__ == "__main__":
    run(main, show=True)
