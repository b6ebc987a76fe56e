"""Options, numbers and names of files of a demo: all that is not its physics.

The options are the parameters of ``main``, what it returns is printed and written.
"""

from __future__ import annotations

import argparse
import inspect
import json
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_type_hints

from mpi4py import MPI

Record = dict[str, Any]

RESULTS = Path(__file__).parents[1] / "results"
"""Where demos leave their pictures."""


def run(
    main: Callable[..., Record],
    without: Mapping[str, Callable[..., Record]] | None = None,
    *,
    show: bool = False,
) -> None:
    """Call ``main`` with what the command line says; ``--json FILE`` writes the record.

    Args:
        main: Its signature gives names, types and defaults of the options (``--load-steps`` for
            ``load_steps``), the docstring of its module the help.
        without: What to call instead of ``main`` when an option of this name is not given.
        show: Print the record, and the names of the pictures, of a ``main`` that prints nothing.
    """
    parser = _parser(main)
    given = vars(parser.parse_args())
    file = given.pop("json", None)
    given.pop("no_pictures", None)
    chosen = main
    for name, other in (without or {}).items():
        if name not in given:
            chosen = other
    start = time.time()
    try:
        record = chosen(**given)
    except ValueError as error:
        parser.exit(2, f"{parser.prog}: {error}\n")
    if show and MPI.COMM_WORLD.rank == 0:
        print(table(record))
        for picture in _written_since(start):
            print(f"{'page' if picture.endswith('.html') else 'picture'}: {picture}")
    if file is not None and MPI.COMM_WORLD.rank == 0:
        Path(file).write_text(json.dumps(record, indent=1) + "\n")


def _parser(main: Callable[..., Record]) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        description=inspect.getdoc(inspect.getmodule(main)),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        # what is not given is left to the defaults of ``main``
        argument_default=argparse.SUPPRESS,
    )
    hints = get_type_hints(main)
    for name, parameter in inspect.signature(main).parameters.items():
        option, default = "--" + name.replace("_", "-"), parameter.default
        (kind,) = [k for k in get_args(hints[name]) or (hints[name],) if k is not NoneType]
        text = "" if default is None else f"default: {default}"
        if kind is bool:
            parser.add_argument(option, action=argparse.BooleanOptionalAction, help=text)
        else:
            parser.add_argument(option, type=kind, metavar=kind.__name__.upper(), help=text)
    if "pictures" not in hints:  # nothing to leave out
        text = argparse.SUPPRESS
        parser.add_argument("--no-pictures", action="store_true", default=False, help=text)
    parser.add_argument("--json", metavar="FILE", help="write the record of numbers to FILE")
    return parser


def one_of(name: str, value: Any, known: Iterable[Any]) -> None:
    """Refuse the value of an option that is not among those that are known."""
    known = list(known)
    if value not in known:
        raise ValueError(f"{name} must be one of {', '.join(map(str, known))}, got {value!r}")


def in_results(name: str) -> Path:
    """A file of this name in the folder of results."""
    RESULTS.mkdir(exist_ok=True)
    return RESULTS / name


def _written_since(start: float) -> list[str]:
    files = sorted(RESULTS.iterdir()) if RESULTS.exists() else []
    return [f"results/{file.name}" for file in files if file.stat().st_mtime >= start]


def table(record: Mapping[str, Any]) -> str:
    """Names and numbers, one below the other; tables of what has the same names."""
    width = max(map(len, map(str, record)), default=0) + 2
    return "\n".join(
        _rows(name, value) if _is_table(value) else f"{_words(name):{width}}{_number(value)}"
        for name, value in record.items()
    )


def _is_table(value: Any) -> bool:
    rows = value.values() if isinstance(value, dict) else ()
    return bool(rows) and all(isinstance(row, dict) for row in rows)


def _rows(name: str, rows: Mapping[str, Mapping[str, Any]]) -> str:
    heads = list(dict.fromkeys(key for row in rows.values() for key in row))
    cells = [[_words(name), *map(_words, heads)]]
    cells += [[str(key), *(_number(row.get(head)) for head in heads)] for key, row in rows.items()]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join(
        "  ".join(f"{cell:{width}}" for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in cells
    )


def _words(name: Any) -> str:
    return str(name).replace("_", " ")


def _number(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_number(part)}" for key, part in value.items())
    if isinstance(value, Collection) and not isinstance(value, str):
        return "  ".join(map(_number, value))
    return "" if value is None else str(value)
