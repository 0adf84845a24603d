# SPDX-License-Identifier: BSD-3-Clause
"""What charts show, as MCAP."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from unitylink.recording import Origin, Sample, create

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from unitylink.layer4_data import Value

    Series = tuple[
        Value[Any], NDArray[np.float64]
    ]  # an item; its times, least and greatest values, shape (3, n)


def mcap_bytes(series: Sequence[Series], origin: Origin, since_1970_s: float) -> bytes:
    """Return a file with the samples of items, as finely as they are kept.

    Old samples are kept 8, 64 or 512 together. Then the file has the least and the greatest of them, both
    with the time of the first. Members of enumerations are written by name. Raises ToolError if the library
    of the format is absent.
    """
    rows = []
    for number, (value, samples) in enumerate(series):
        enum = value.quantity.type.enum
        members = {one.value: one.name for one in enum.values} if enum is not None else {}
        for time_s, least, greatest in samples.T.tolist():
            rows.append((time_s, number, members.get(least, least)))
            if greatest != least:
                rows.append((time_s, number, members.get(greatest, greatest)))
    rows.sort(key=lambda row: row[0])
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "values.mcap"
        with create(file, origin) as writer:
            for time_s, number, one in rows:
                writer.add(Sample(since_1970_s + time_s, {series[number][0].path: one}))
        return file.read_bytes()
