"""What users meet every day, each with what it is compared with, in one run.

    python3 -m benchmarks.everyday --table [word ...] [--list]

Rows are those whose titles have one of the words, by default all. Times are of the processor,
the least of three; what is compared is measured in turns. A row is an entry of ``ROWS`` in a file
of ``benchmarks/everyday_rows``: a title, its target and a function that measures it.
"""

from __future__ import annotations

from argparse import ArgumentParser
from datetime import date
from itertools import chain

from benchmarks.everyday_rows import first_use, shells, solvers
from benchmarks.everyday_rows.row import Row, Unavailable
from fem_lie import _blas

FILES = (first_use, solvers, shells)
ROWS: tuple[Row, ...] = tuple(chain.from_iterable(file.ROWS for file in FILES))
"""All rows, in the order of the table."""


def chosen(words: list[str]) -> list[Row]:
    """Rows whose titles have one of the words, or all.

    Raises:
        SystemExit: No title has one of them.
    """
    rows = [row for row in ROWS if not words or any(word in row.title for word in words)]
    if not rows:
        raise SystemExit(f"no row has one of the words {', '.join(words)}; see --list")
    return rows


def print_table(rows: list[Row]) -> None:
    """Measure rows, and print each as soon as it is known."""
    print(f"{date.today()}, {_blas.find().name}\n")
    print("| row | measured | compared with | target | |\n|---|---|---|---|---|", flush=True)
    for row in rows:
        try:
            outcome = row.measure()
        except Unavailable as reason:
            measured, verdict = f" | {reason}", "not measured"
        else:
            measured = f"{outcome.ours} | {outcome.peer}"
            verdict = "met" if outcome.met else "missed"
        print(f"| {row.title} | {measured} | {row.target} | {verdict} |", flush=True)


def main(arguments: list[str] | None = None) -> None:
    """Print titles or the table."""
    parser = ArgumentParser(prog="python3 -m benchmarks.everyday", description="Everyday speed")
    parser.add_argument("words", nargs="*", help="rows whose titles have one of these")
    task = parser.add_mutually_exclusive_group(required=True)
    task.add_argument("--table", action="store_true", help="measure and print")
    task.add_argument("--list", action="store_true", help="print titles and targets")
    asked = parser.parse_args(arguments)
    rows = chosen(asked.words)
    if asked.list:
        print("\n".join(f"{row.title}: {row.target}" for row in rows))
    else:
        print_table(rows)


if __name__ == "__main__":
    main()
