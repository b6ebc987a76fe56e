"""Processor time of forces and tangent stiffness of elements per cell, in two checkouts in turns.

    RUN -m benchmarks.element_kernels OTHER [--rounds 5] [--only "ANCF"]

OTHER is the folder of another checkout, such as ``git worktree add OTHER COMMIT``. Each element is
measured on a body of some hundred cells that is deformed at random: the least time of all rounds,
forces with their stress, tangent stiffness at a linearised stress. The last column is the time of
both together in this checkout over that in the other one. Elements that both checkouts have as
hand-written kernels have a factor of one; "cable, as on the page" is the general kernel of
``docs/how_to/gradient_element.py``, beside the same element by hand.
"""

from __future__ import annotations

import json
import logging
import runpy
import subprocess
import sys
from argparse import ArgumentParser
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

HERE = Path(__file__).parents[1]
ANSWER = "--answer"
CELLS = 256
LEAST = 0.05
"""Seconds for which a call is repeated in a round."""


def bodies() -> dict[str, Callable[[], Any]]:
    """A body of each element, of the package that is imported."""
    import fem_lie as fl

    steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
    thread = fl.Section.circle(0.01, steel)
    section = fl.Section.rectangle(0.02, 0.03, steel)
    layer = fl.ShellSection.layer(0.01, steel)
    side = int(np.sqrt(CELLS))

    def wave(s: float) -> tuple[float, float, float]:
        return s, 0.1 * np.sin(6 * s), 0.05 * s * s

    def patch() -> Any:
        return fl.smooth_patch(lambda a, b: (a, b, 0.2 * a * b), (side, side))

    def sewn() -> Any:
        patches = {
            "left": fl.smooth_patch(lambda a, b: (a, b, 0.2 * (a - 1) * b), (2, CELLS // 4)),
            "right": fl.smooth_patch(
                lambda a, b: (1 + a, 0.5 * (b + b**2), 0.1 * a * (b + b**2)), (2, CELLS // 4)
            ),
        }
        return fl.ThinShell(patches, layer, seams=[fl.Seam("left.a=1", "right.a=0", 3.0)])

    def shell() -> Any:
        mesh = fl.surface(lambda a, b: (a, b, 0.2 * a * b), (side, side))
        return fl.Shell(mesh, layer, parameters=fl.Parameters.SIX)

    def page() -> Any:
        file = HERE / "docs" / "how_to" / "gradient_element.py"
        if not hasattr(fl, "ElementBody"):
            return fl.Cable.curve(wave, thread, cells=CELLS)
        with redirect_stdout(StringIO()):
            return runpy.run_path(str(file))["cable"](CELLS, 2e7, 3e2, 1.0)

    return {
        "bends of a discrete cable": lambda: fl.Cable(
            fl.curve(wave, cells=CELLS), thread, formulation=fl.DiscreteCable()
        ),
        "corners of a discrete rod": lambda: fl.Rod.curve(
            wave, section, cells=CELLS, formulation=fl.DiscreteRod()
        ),
        "cable": lambda: fl.Cable.curve(wave, thread, cells=CELLS),
        "cable, as on the page": page,
        "Kirchhoff rod": lambda: fl.Rod.curve(
            wave, section, cells=CELLS, formulation=fl.Kirchhoff()
        ),
        "ANCF beam": lambda: fl.AncfBeam.curve(wave, section, cells=CELLS),
        "warping of an ANCF beam": lambda: fl.AncfBeam.curve(
            wave, section, cells=CELLS, warping=1.0
        ),
        "ANCF plate": lambda: fl.AncfShell(patch(), layer),
        "thin shell": lambda: fl.ThinShell(patch(), layer),
        "seam of thin shells": sewn,
        "drilling": shell,
    }


BESIDE = ("bends", "corners", "warping", "seam")
"""Elements that stand beside others of the same body."""


def term_of(name: str, body: Any) -> Any:
    """The term of an element of a body."""
    if name == "drilling":
        body.drills([])
    term = type(body).assemble([body])
    beside = name.startswith(BESIDE) or name == "drilling"
    return term.beside[0] if beside else term


def least(call: Callable[[], Any]) -> float:
    """Least processor time of some calls."""
    call()
    best, total = np.inf, 0.0
    while total < LEAST:
        start = process_time()
        call()
        spent = process_time() - start
        best, total = min(best, spent), total + spent
    return float(best)


def measured(name: str) -> tuple[float, float]:
    """Processor time per cell of forces and of tangent stiffness, µs."""
    from fem_lie.lie import kinds

    body = bodies()[name]()
    term, rng = term_of(name, body), np.random.default_rng(1)
    H, count = np.empty_like(body.frames), len(body.frames)
    scale = 0.05 * body.size / CELLS
    kinds.follow_all(body.node_kinds, body.frames, scale * rng.normal(size=(count, 6)), H)
    if term.stress_update is not None:
        term.stress_update.reset_stress(H)
    out, kept = np.zeros((count, 6)), term.room()
    term.add_forces(H, out, kept)
    cells = len(term.over_cells[0].nodes) / term.over_cells[0].rows[0, 2]
    forces = least(lambda: term.add_forces(H, out, kept))
    return 1e6 * forces / cells, 1e6 * least(lambda: term.tangent(H, kept)) / cells


def answer(folder: str) -> None:
    """Measure the elements whose names are asked for, with the package of a folder."""
    sys.path.insert(0, folder)
    import fem_lie

    assert Path(fem_lie.__file__).is_relative_to(folder), fem_lie.__file__
    logging.disable(logging.WARNING)
    for line in sys.stdin:
        print(json.dumps(measured(line.strip())), flush=True)


def main() -> None:
    """Print the table."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("other", type=Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", default="")
    given = parser.parse_args()
    command = [sys.executable, "-m", "benchmarks.element_kernels", ANSWER]
    pipes = [
        subprocess.Popen(
            [*command, str(folder.resolve())],
            cwd=HERE,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for folder in (given.other, HERE)
    ]
    print(f"{'element':28} {'forces, µs':>17} {'tangent, µs':>17} {'factor':>7}")
    for name in (name for name in bodies() if given.only in name):
        best = np.full((2, 2), np.inf)
        for _ in range(given.rounds):
            for side, process in enumerate(pipes):
                assert process.stdin is not None and process.stdout is not None
                process.stdin.write(f"{name}\n")
                process.stdin.flush()
                best[side] = np.minimum(best[side], json.loads(process.stdout.readline()))
        (f0, t0), (f1, t1) = best
        factor = (f1 + t1) / (f0 + t0)
        print(f"{name:28} {f0:8.3f} {f1:8.3f} {t0:8.2f} {t1:8.2f} {factor:7.2f}", flush=True)
    for process in pipes:
        assert process.stdin is not None
        process.stdin.close()
        process.wait()


if __name__ == "__main__":
    if sys.argv[1:2] == [ANSWER]:
        answer(sys.argv[2])
    else:
        main()
