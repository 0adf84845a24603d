# SPDX-License-Identifier: BSD-3-Clause
"""Triangles from an STL file, binary or text."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from unitylink.errors import UnityLinkError

from .bounded import read_bounded

MOST_BYTES = 20_000_000
MOST_TRIANGLES = 200_000
_HEAD, _EACH = 84, 50  # bytes
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


def read_stl(path: Path) -> bytes:
    """Return the triangles, as `Mesh` has them.

    Raises UnityLinkError if the file is no STL, is damaged, or is too large to be drawn by a phone.
    """
    data = read_bounded(path, MOST_BYTES, "simplify the mesh")
    count = int.from_bytes(data[80:84], "little") if len(data) >= _HEAD else 0
    if len(data) >= _HEAD and len(data) == _HEAD + _EACH * count:
        rows = np.frombuffer(
            data, np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("more", "<u2")]), count, _HEAD
        )
        corners = np.ascontiguousarray(rows["corners"])
    elif data.lstrip()[:5].lower() == b"solid" and b"facet" in data[:1000]:
        try:
            numbers = np.array([[float(one) for one in found] for found in _VERTEX.findall(data)], "<f4")
        except ValueError as error:
            raise UnityLinkError(f"{path}: a corner that is no number: {error}") from error
        if not len(numbers) or len(numbers) % 3:
            raise UnityLinkError(f"{path}: {len(numbers)} corners, which are not three for each triangle")
        corners = numbers.reshape(-1, 9)
    else:
        raise UnityLinkError(f"{path}: no STL file, or one that was cut off")
    if len(corners) > MOST_TRIANGLES:
        raise UnityLinkError(
            f"{path}: {len(corners):,} triangles, more than the {MOST_TRIANGLES:,} that are drawn; "
            "simplify the mesh"
        )
    if not np.isfinite(corners).all():
        raise UnityLinkError(f"{path}: a corner that is no finite number")
    return corners.astype("<f4").tobytes()
