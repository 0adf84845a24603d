# SPDX-License-Identifier: BSD-3-Clause
"""Pictures in a data set of LeRobot: PNG, and the statistics of their colours."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Pixels = npt.NDArray[np.uint8]  # (height, width, 3)

QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}
_LEVELS = 256


def png_of(pixels: Pixels, *, effort: int = 9) -> bytes:
    """Return a picture as PNG, without a package for it. `effort` is that of zlib, 1 to 9."""
    height, width, _ = pixels.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = np.zeros((height, 1 + 3 * width), dtype=np.uint8)  # before each row is 0: it is not filtered
    rows[:, 1:] = pixels.reshape(height, 3 * width)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = zlib.compress(rows.tobytes(), effort)
    parts = chunk(b"IHDR", header), chunk(b"IDAT", data), chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


class ColourStatistics:
    """The exact statistics of the three colours of pictures, as shares of full brightness."""

    def __init__(self) -> None:
        self._counts = np.zeros((3, _LEVELS), dtype=np.int64)
        self._pictures = 0

    def add(self, pixels: Pixels) -> None:
        """Count the pixels of a picture."""
        for colour in range(3):
            self._counts[colour] += np.bincount(pixels[..., colour].ravel(), minlength=_LEVELS)
        self._pictures += 1

    def numbers(self) -> dict[str, list[Any]]:
        """Return the statistics as LeRobot has them: a list of three, each of one row of one number."""
        level = np.arange(_LEVELS) / (_LEVELS - 1)
        share = self._counts / self._counts.sum(axis=1, keepdims=True)
        mean = share @ level
        reached = np.cumsum(share, axis=1)
        found = {
            "min": [level[np.flatnonzero(row)[0]] for row in self._counts],
            "max": [level[np.flatnonzero(row)[-1]] for row in self._counts],
            "mean": mean,
            "std": np.sqrt(np.maximum(share @ level**2 - mean**2, 0)),
            **{
                key: [level[min(int(np.searchsorted(row, part)), _LEVELS - 1)] for row in reached]
                for key, part in QUANTILES.items()
            },
        }
        shaped = {key: [[[float(number)]] for number in numbers] for key, numbers in found.items()}
        return {**shaped, "count": [self._pictures]}


def together(episodes: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """Return the statistics of several episodes. Quantiles are their mean, as LeRobot puts them together."""
    counts = np.array([one["count"][0] for one in episodes], dtype=np.float64)
    share = (counts / counts.sum()).reshape(-1, 1, 1, 1)
    rows = {key: np.array([one[key] for one in episodes]) for key in episodes[0] if key != "count"}
    mean = (share * rows["mean"]).sum(axis=0)
    spread = (share * (rows["std"] ** 2 + (rows["mean"] - mean) ** 2)).sum(axis=0)
    made = {key: (share * row).sum(axis=0) for key, row in rows.items()}
    made |= {"min": rows["min"].min(axis=0), "max": rows["max"].max(axis=0), "std": np.sqrt(spread)}
    return {**{key: value.tolist() for key, value in made.items()}, "count": [int(counts.sum())]}
