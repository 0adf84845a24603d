# SPDX-License-Identifier: BSD-3-Clause
"""Posts: how much of a line's bytes they fill, and how fast they arrive where frames are lost.

The first is measured on a twin behind a line of its own pace, over TCP; the second on a virtual clock
(`native/src/faults/post_stream.hpp`), where the same seed gives the same rate.
"""

from __future__ import annotations

import time
from statistics import median

import numpy as np

from .figure import BenchError, Figure, Run
from .programs import frame_bytes, twin

BAUD_HZ = 3_000_000
POST_BYTES = frame_bytes(8)  # post, address, word
LOSS = 0.01
WORDS = 32  # of a message, as post_many sends them
SEEDS = 5


def measure(run: Run) -> Figure:
    """Measure the bytes of posted writes against those the line can carry."""
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


def measure_loss(run: Run) -> Figure:
    """Measure the rate of posts where 1 % of the frames are lost, against 99 % of that where none is."""
    from unitylink import _native

    posts = 5_000 if run.quick else 100_000
    quiet = _native.stream_posts(1, posts, 0.0, WORDS)
    shares = []
    for seed in range(1, 2 if run.quick else SEEDS + 1):
        lossy = _native.stream_posts(seed, posts, LOSS, WORDS)
        if lossy["disorder"] or not lossy["posts_per_s"]:
            raise BenchError(f"posts were not executed in order, once (seed {seed})")
        shares.append(lossy["posts_per_s"] / quiet["posts_per_s"] / (1 - LOSS))
    return Figure(
        "posts-loss",
        "posts at 1 % of frames lost / 99 % of those at none, virtual 12 MBd",
        0.97,
        False,
        median(shares),
        "x",
        {
            "posts/s without loss": quiet["posts_per_s"],
            "bytes a post": quiet["sent_bytes_per_post"],
            "least": min(shares),
            "most": max(shares),
        },
    )
