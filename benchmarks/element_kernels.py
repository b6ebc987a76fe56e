"""Processor time of forces and tangent stiffness of elements per cell, in two checkouts in turns.

    RUN -m benchmarks.element_kernels OTHER [--rounds 5] [--only "ANCF"] [--derived] [--cold]

OTHER is the folder of another checkout, such as ``git worktree add OTHER COMMIT``. Each element is
measured on a body of some hundred cells that is deformed at random: the least time of all rounds,
forces with their stress, forces and energy as conserving schemes ask for them, tangent stiffness at
a linearised stress. The last four columns are times in this checkout over those in the other one:
of each of the three, and of forces and tangent together.
Elements that both checkouts have as hand-written kernels have factors of one.

With ``--derived`` forces of this checkout that are written by hand, beside an energy in UFL, are
those that FFCx derives from it, the cable is that of the general kernel of
``docs/how_to/gradient_element.py``, and corners of discrete rods, thin shells and reduced-order
bodies are those of ``benchmarks/derived_kernels.py``. With ``--cold`` the columns are instead the
processor time in seconds of building the term and of its first forces, energy and tangent, in new
processes whose caches of machine code are empty.
"""

from __future__ import annotations

import json
import logging
import os
import runpy
import subprocess
import sys
from argparse import ArgumentParser
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

HERE = Path(__file__).parents[1]
ANSWER = "--answer"
CELLS = 256
LEAST = 0.05
"""Seconds for which a call is repeated in a round."""


def bodies(derived: bool = False) -> dict[str, Callable[[], Any]]:
    """A body of each element, of the package that is imported; ``derived``: see the module."""
    import fem_lie as fl

    steel = fl.Material(E=2e11, nu=0.3, density=7800.0)
    cord = fl.Section.circle(0.01, steel)
    section = fl.Section.rectangle(0.02, 0.03, steel)
    layer = fl.ShellSection.layer(0.01, steel)
    side = int(np.sqrt(CELLS))

    def wave(s: float) -> tuple[float, float, float]:
        return s, 0.1 * np.sin(6 * s), 0.05 * s * s

    def patch() -> Any:
        return fl.mesh.smooth_patch(lambda a, b: (a, b, 0.2 * a * b), (side, side))

    def sewn() -> Any:
        patches = {
            "left": fl.mesh.smooth_patch(lambda a, b: (a, b, 0.2 * (a - 1) * b), (2, CELLS // 4)),
            "right": fl.mesh.smooth_patch(
                lambda a, b: (1 + a, 0.5 * (b + b**2), 0.1 * a * (b + b**2)), (2, CELLS // 4)
            ),
        }
        return fl.ThinShell(
            patches, layer, couplings=[fl.mesh.PatchCoupling("left.a=1", "right.a=0", 3.0)]
        )

    def shell() -> Any:
        mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.2 * a * b), (side, side))
        return fl.Shell(mesh, layer, drilling=True)

    def reduced() -> Any:
        scene = fl.Scene()
        beam = scene.add(fl.Beam.curve(wave, section, cells=16))
        return fl.reduction.reduced_order_body(scene, [beam.point("start"), beam.point("end")], 6)

    def page() -> Any:
        file = HERE / "docs" / "how_to" / "gradient_element.py"
        with redirect_stdout(StringIO()):
            return runpy.run_path(str(file))["cable"](CELLS, 2e7, 3e2, 1.0)

    return {
        "bends of a discrete cable": lambda: fl.Cable(
            fl.mesh.curve(wave, cells=CELLS), cord, formulation=fl.elements.DiscreteCable()
        ),
        "corners of a discrete rod": lambda: fl.Rod.curve(
            wave, section, cells=CELLS, formulation=fl.elements.DiscreteRod()
        ),
        "cable": page if derived else lambda: fl.Cable.curve(wave, cord, cells=CELLS),
        "geodesic beam": lambda: fl.Beam.curve(
            wave, section, cells=CELLS, formulation=fl.elements.GeodesicBeam()
        ),
        "Kirchhoff rod": lambda: fl.Rod.curve(
            wave, section, cells=CELLS, formulation=fl.elements.KirchhoffRod()
        ),
        "ANCF beam": lambda: fl.AncfBeam.curve(wave, section, cells=CELLS),
        "warping of an ANCF beam": lambda: fl.AncfBeam.curve(
            wave, section, cells=CELLS, warping=1.0
        ),
        "ANCF plate": lambda: fl.AncfShell(patch(), layer),
        "thin shell": lambda: fl.ThinShell(patch(), layer),
        "coupling of thin shells": sewn,
        "drilling": shell,
        "reduced body": reduced,
    }


BESIDE = ("bends", "corners", "warping", "coupling")
"""Elements that stand beside others of the same body."""


def term_of(name: str, body: Any, derived: bool) -> Any:
    """The term of an element of a body."""
    if derived:
        from benchmarks.derived_kernels import TERMS

        if name in TERMS:
            return TERMS[name](body.model)
    if name == "drilling":
        body.model.has_drilling([])
    term = body.model.assemble([body.model])
    beside = name.startswith(BESIDE) or name == "drilling"
    return term.further_terms[0] if beside else term


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


def measured(name: str, derived: bool) -> list[float]:
    """Processor time per cell of forces, of forces and energy, and of tangent stiffness, µs."""
    from fem_lie.lie import node_types

    body = bodies(derived)[name]()
    term, rng = term_of(name, body, derived), np.random.default_rng(1)
    H, count = np.empty_like(body.frames), len(body.frames)
    scale = 0.05 * body.model.size / CELLS
    node_types.retract_all(
        body.model.node_types, body.frames, scale * rng.normal(size=(count, 6)), H
    )
    # older packages have other names for it
    if getattr(term, "stress_update", None) is not None:
        term.stress_update.reset_stress(H)
    out, kept = np.zeros((count, 6)), term.workspace()
    term.add_forces(H, out, kept)
    cells = len(term.over_cells[0].nodes) // term.over_cells[0].rows[0, 2]
    calls: list[Callable[[], Any]] = [
        lambda: term.add_forces(H, out, kept),
        with_energy(term, H),
        lambda: term.tangent(H, kept),
    ]
    return [1e6 * least(call) / cells for call in calls]


def with_energy(term: Any, H: Any) -> Callable[[], Any]:
    """Call for forces and energy, of terms whose cells share what both need one by one."""
    from fem_lie.forms.assembly import Assembly
    from fem_lie.forms.cells import Cells, evaluate

    out, still = np.zeros((len(H), 6)), np.zeros_like(H)
    if not isinstance(term, Assembly):
        return lambda: (term.add_forces(H, out, None), term.energy(H))
    cells = Cells([(slice(0, len(H)), term)])
    F, W = np.empty((cells.incidences, 6)), np.empty(cells.count)
    return lambda: evaluate(cells.table, H, still, F, W)


def first_calls(name: str, derived: bool) -> list[float]:
    """Processor time of building a term, and of its first forces, energy and tangent, s."""
    body = bodies(derived)[name]()
    start = process_time()
    term, H = term_of(name, body, derived), body.frames
    built, kept = process_time(), term.workspace()
    term.add_forces(H, np.zeros((len(H), 6)), kept)
    term.energy(H)
    term.tangent(H, kept)
    return [built - start, process_time() - built]


def derive_forces() -> None:
    """Let FFCx derive all forces of energies in UFL."""
    from fem_lie.forms.energy import StrainEnergy

    made = StrainEnergy.__init__

    def without_forces(self: Any, *args: Any, **named: Any) -> None:
        made(self, *args, **(named | {"forces": None}))

    StrainEnergy.__init__ = without_forces  # type: ignore[method-assign]


def answer(folder: str, options: list[str]) -> None:
    """Measure the elements whose names are asked for, with the package of a folder."""
    sys.path.insert(0, folder)
    import fem_lie

    assert Path(fem_lie.__file__).is_relative_to(folder), fem_lie.__file__
    logging.disable(logging.WARNING)
    derived = "--derived" in options
    if derived:
        derive_forces()
    measure = first_calls if "--cold" in options else measured
    for line in sys.stdin:
        print(json.dumps(measure(line.strip(), derived)), flush=True)


class Checkout:
    """A process that measures elements with the package of a folder; a cold one for each time."""

    def __init__(self, folder: Path, options: list[str]) -> None:
        self._command = [sys.executable, "-m", "benchmarks.element_kernels", ANSWER]
        self._command += [str(folder.resolve()), *options]
        self._process = None if "--cold" in options else self._started(os.environ)

    def _started(self, environment: Mapping[str, str]) -> subprocess.Popen[str]:
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        return subprocess.Popen(self._command, cwd=HERE, env=environment, text=True, **pipes)

    def measure(self, name: str) -> list[float]:
        """Times of an element."""
        if self._process is not None:
            return self._asked(self._process, name)
        with TemporaryDirectory() as cache:
            process = self._started({**os.environ, "XDG_CACHE_HOME": cache})
            found = self._asked(process, name)
            process.communicate()
        return found

    def _asked(self, process: subprocess.Popen[str], name: str) -> list[float]:
        assert process.stdin is not None and process.stdout is not None
        process.stdin.write(f"{name}\n")
        process.stdin.flush()
        found: list[float] = json.loads(process.stdout.readline())
        return found

    def end(self) -> None:
        """Let the process end."""
        if self._process is not None:
            self._process.communicate()


def main() -> None:
    """Print the table."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("other", type=Path)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", default="")
    parser.add_argument("--derived", action="store_true")
    parser.add_argument("--cold", action="store_true")
    given = parser.parse_args()
    cold = ["--cold"] if given.cold else []
    derived = ["--derived"] if given.derived else []
    both = Checkout(given.other, cold), Checkout(HERE, cold + derived)
    columns = ["build, s", "calls, s"] if given.cold else ["forces, µs", "and energy", "tangent"]
    print(f"{'element':26}" + "".join(f"{each:>17}" for each in columns), "  factors")
    for name in (name for name in bodies() if given.only in name):
        best = np.full((2, len(columns)), np.inf)
        for _ in range(1 if given.cold else given.rounds):
            for side, checkout in enumerate(both):
                best[side] = np.minimum(best[side], checkout.measure(name))
        ends = best[:, [0, -1]].sum(axis=1)
        factors = [*(best[1] / best[0]), ends[1] / ends[0]]
        times = "".join(f"{a:9.3f}{b:8.3f}" for a, b in best.T)
        print(f"{name:26}{times}  ", " ".join(f"{each:5.2f}" for each in factors), flush=True)
    for checkout in both:
        checkout.end()


if __name__ == "__main__":
    if sys.argv[1:2] == [ANSWER]:
        answer(sys.argv[2], sys.argv[3:])
    else:
        main()
