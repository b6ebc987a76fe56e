"""Import of FFCx that leaves Python's warnings on stderr.

FFCx calls ``logging.captureWarnings(True)`` when it is imported. From then on every warning goes to
the logger ``py.warnings``, which has no handler in a plain script, so the warning is lost. This
module is the first import of the package. It reverts that call, and keeps a capture that the user's
own code has made.
"""

from __future__ import annotations

import logging
import sys
import warnings


def _import_ffcx() -> None:
    """Import FFCx, and revert its capture of warnings.

    If FFCx was imported before, the origin of the capture is unknown. It is then reverted unless a
    handler receives the captured warnings.
    """
    imported_before = "ffcx" in sys.modules
    show = warnings.showwarning
    import ffcx  # noqa: F401

    captured_by_ffcx = warnings.showwarning is not show
    if captured_by_ffcx or (imported_before and not _captured_warnings_are_handled()):
        logging.captureWarnings(False)


def _captured_warnings_are_handled() -> bool:
    """Whether a handler other than a ``NullHandler`` receives records of ``py.warnings``."""
    logger: logging.Logger | None = logging.getLogger("py.warnings")
    while logger is not None:
        if any(not isinstance(handler, logging.NullHandler) for handler in logger.handlers):
            return True
        logger = logger.parent if logger.propagate else None
    return False


_import_ffcx()
