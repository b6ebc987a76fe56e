"""This library and others, the same scenes in turns: error, time and ratio.

    tools/run python3 benchmarks/peers.py --json peers.json --plots docs/measured

Exudyn and Kratos come by pip into virtual environments in the cache folder, once; what cannot be
had is left out, with a line that says so. Each code has a process of its own on one core, is asked
by lines of JSON (``peer_scenes``), and answers with the seconds that its solver had the processor,
without set-up and compilation. Runs of one resolution follow each other in turns, and the best of
each counts. docs/measured/peers.md has what came out, and what is fair.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from datetime import date
from math import inf
from pathlib import Path
from typing import Any

from benchmarks.peer_scenes import environment, report
from benchmarks.peer_scenes.comparisons import COMPARISONS, Comparison, Method
from benchmarks.peer_scenes.processes import Asked
from benchmarks.peer_scenes.report import Row, Run
from fem_lie import _blas

LIMIT = 900.0  # seconds for one answer, on a busy machine
REPEAT = 3


def compare(
    comparison: Comparison, asked: dict[str, Asked], resolutions: tuple[float, ...], repeat: int
) -> Iterator[Row]:
    """The best runs of all methods that are there, resolution by resolution."""
    methods = [method for method in comparison.methods if method.code in asked]
    for method in methods:
        if method.code == "ours":  # compiles
            asked["ours"].ask(comparison.request(method, comparison.coarsest(method)))
    for resolution in resolutions:
        best: dict[Method, dict[str, Any]] = {}
        failed: dict[Method, str] = {}
        for _ in range(repeat):
            for method in methods:
                if method in failed or resolution not in comparison.resolutions_of(method):
                    continue
                answer = asked[method.code].ask(comparison.request(method, resolution))
                if "failed" in answer:
                    failed[method] = answer["failed"]
                elif answer["seconds"] < best.get(method, {"seconds": inf})["seconds"]:
                    best[method] = answer
        for method, reason in failed.items():
            print(f"{comparison.title}, {resolution:g}: {method.label}: {reason}", flush=True)
        for method in methods:
            if method in best and method not in failed:
                yield row_of(comparison, method, resolution, best[method])


def row_of(
    comparison: Comparison, method: Method, resolution: float, answer: dict[str, Any]
) -> Row:
    """What an answer says."""
    error = comparison.error(answer["place"])
    names = ("seconds", "steps", "iterations", "matrices", "unknowns", "settings")
    found = {name: answer[name] for name in names}
    return Row(comparison.key, method.code, method.label, resolution, error, **found)


def options() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--scene", nargs="+", choices=COMPARISONS, default=list(COMPARISONS))
    parser.add_argument("--repeat", type=int, default=REPEAT, help=f"default: {REPEAT}")
    parser.add_argument("--table", action="store_true", help="only the resolutions of the table")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write rows to FILE")
    parser.add_argument("--plots", type=Path, metavar="FOLDER", help="curves, and rows as csv")
    parser.add_argument("--read", type=Path, metavar="FILE", help="run nothing, read --json")
    parser.add_argument("--references", action="store_true", help="only make references anew")
    given = parser.parse_args()
    if given.repeat < 1:
        parser.error(f"--repeat must be at least 1, got {given.repeat}")
    if given.read and given.json:
        parser.error("--json is for the rows of a run, and --read runs nothing: give one of them")
    return given


def references(keys: list[str]) -> None:
    """Print what stands in ``comparisons``; takes some minutes."""
    ours = Asked("ours", Path(sys.executable), 12 * LIMIT)
    for key in keys:
        request = COMPARISONS[key].fine
        if request is not None:
            print(key, ours.ask(request)["place"], flush=True)
    ours.stop()


def run(keys: list[str], table: bool, repeat: int, file: Path | None = None) -> Run:
    """All rows of the scenes, printed as they come, and written to ``file`` after each scene."""
    made = Run(date.today().isoformat(), _blas.find().name, [])
    peers = {method.code for key in keys for method in COMPARISONS[key].methods} - {"ours"}
    pythons = {"ours": Path(sys.executable), **environment.interpreters(*sorted(peers))}
    asked = {code: Asked(code, python, LIMIT) for code, python in pythons.items()}
    print(f"{made.heading}\n\n{report.HEADER}", flush=True)
    try:
        for key in keys:
            comparison = COMPARISONS[key]
            resolutions = (comparison.base,) if table else comparison.all_resolutions
            for row in compare(comparison, asked, resolutions, repeat):
                made.rows.append(row)
                print(report.line(row, made.rows), flush=True)
            if file is not None:
                made.write(file)
    finally:
        for program in asked.values():
            program.stop()
    return made


def main() -> None:
    given = options()
    if given.references:
        references(given.scene)
        return
    if given.read:
        made = Run.read(given.read)
    else:
        made = run(given.scene, given.table, given.repeat, given.json)
    rows = made.rows
    if given.read or not given.table:
        print(f"\n{made.heading}\n\n{report.table(rows)}\n\n{report.beaten(rows)}")
    if given.plots:
        given.plots.mkdir(parents=True, exist_ok=True)
        report.write_csv(rows, given.plots / "peers.csv")
        for path in report.draw(rows, given.plots):
            print(f"picture: {path}")


if __name__ == "__main__":
    main()
