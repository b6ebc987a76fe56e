"""Runs that the user stops once a checkpoint is on the disk."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

import pytest


@contextmanager
def interrupted(checkpoints: int = 1) -> Iterator[None]:
    """What runs in it is stopped by the keyboard when so many checkpoints have been written.

    A checkpoint is replaced in one piece: the interruption comes right after that.
    """
    replace, written = os.replace, 0

    def stop(source: str, target: str) -> None:
        nonlocal written
        replace(source, target)
        written += str(target).endswith(".checkpoint")
        if written == checkpoints:
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(os, "replace", stop)
        yield
