# SPDX-License-Identifier: BSD-3-Clause
"""Recordings: samples of named values in MCAP or CSV files.

>>> import tempfile
>>> path = tempfile.mkdtemp() + "/arm.csv"
>>> with create(path, Origin("arm.ul", "", "0" * 16)) as writer:
...     writer.add(Sample(1.5, {"x.position": 3}))
>>> [sample.values for sample in samples(path)]
[{'x.position': 3}]
"""

from __future__ import annotations

from .formats import ENDINGS, check_name, create, origin, samples
from .recording import Origin, RecordingTruncated, Sample, Writer

__all__ = [
    "ENDINGS",
    "Origin",
    "RecordingTruncated",
    "Sample",
    "Writer",
    "check_name",
    "create",
    "origin",
    "samples",
]
