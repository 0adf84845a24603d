# SPDX-License-Identifier: BSD-3-Clause
"""Posts: the share of the line's capacity that they use, on a twin with a simulated line, over TCP."""

from __future__ import annotations

import time

import numpy as np

from .figure import BenchError, Figure, Run
from .programs import frame_bytes, twin

BAUD_HZ = 3_000_000
POST_BYTES = frame_bytes(8)  # post, address, word


def measure(run: Run) -> Figure:
    """Measure the bytes of posted writes as a share of those that the line can carry."""
    from unitylink import connect

    count = 2_000 if run.quick else 60_000
    with twin("tcp", baud_hz=BAUD_HZ, fifo=4096) as board, connect(f"{board.line()}?protocol=framed") as link:
        addresses = np.arange(count, dtype=np.uint32) % 64
        values = np.arange(count, dtype=np.uint32)
        began_s, worked_s, sent = time.perf_counter(), time.process_time(), link.statistics().bytes_sent
        link.post_many(addresses, values)
        link.sync()
        took_s, worked_s = time.perf_counter() - began_s, time.process_time() - worked_s
        sent = link.statistics().bytes_sent - sent
        if link.read_many(range(64)).tolist() != values[-64:].tolist() and count % 64 == 0:
            raise BenchError("the last posts are not what was written last")
    line_bytes_per_s = BAUD_HZ / 10
    return Figure(
        "posts",
        "posted writes: bytes on a line of 3 MBd / what it carries",
        0.9,
        False,
        sent / took_s / line_bytes_per_s,
        "x",
        {
            "posts/s": count / took_s,
            "bytes a post": sent / count,
            "single posts the line carries/s": line_bytes_per_s / POST_BYTES,
            "% of a core": 100 * worked_s / took_s,
        },
    )
