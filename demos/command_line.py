"""The command line of a demo: its options are the parameters of its ``main``."""

from __future__ import annotations

import argparse
import inspect
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_type_hints

Record = dict[str, Any]


def run(
    main: Callable[..., Record], without: Mapping[str, Callable[..., Record]] | None = None
) -> None:
    """Call ``main`` with what the command line says; ``--json FILE`` writes the record.

    Args:
        main: Its signature gives names, types and defaults of the options (``--load-steps`` for
            ``load_steps``), the docstring of its module the help.
        without: What to call instead of ``main`` when an option of this name is not given.
    """
    parser = _parser(main)
    given = vars(parser.parse_args())
    file = given.pop("json", None)
    chosen = main
    for name, other in (without or {}).items():
        if name not in given:
            chosen = other
    try:
        record = chosen(**given)
    except ValueError as error:
        parser.exit(2, f"{parser.prog}: {error}\n")
    if file is not None:
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
    parser.add_argument("--json", metavar="FILE", help="write the record of numbers to FILE")
    return parser
