"""Arrays as text: base64 of bytes, with few digits where they are looked at alone."""

from __future__ import annotations

import base64
import json
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array

Packed = dict[str, str]

_KINDS = {"u1": "u1", "i2": "<i2", "u4": "<u4", "f4": "<f4"}
LARGEST = 32767
"""Of whole numbers of two bytes."""


def packed(values: npt.NDArray[Any], kind: str) -> Packed:
    """An array as the script takes it: kind (bytes of a number, as NumPy calls them) and data."""
    data = np.ascontiguousarray(values, dtype=_KINDS[kind])
    return {"kind": kind, "data": base64.b64encode(data.tobytes()).decode("ascii")}


def whole_places(places: Array, middle: Array, unit: float) -> Packed:
    """Places in whole units from a middle, in two bytes; what lies beyond is set to the rim."""
    steps = np.rint((places - middle) / unit)
    return packed(np.clip(steps, -LARGEST, LARGEST), "i2")


def unit_of(places: list[Array]) -> tuple[Array, float]:
    """Middle of the box about places (..., 3), and the unit in which two bytes reach its rim."""
    low = np.min([x.reshape(-1, 3).min(axis=0) for x in places], axis=0)
    high = np.max([x.reshape(-1, 3).max(axis=0) for x in places], axis=0)
    return 0.5 * (low + high), float((high - low).max()) / (2 * LARGEST) or 1.0


def json_text(content: object) -> str:
    """As JSON that can stand in an element of a page."""
    return json.dumps(content, ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
