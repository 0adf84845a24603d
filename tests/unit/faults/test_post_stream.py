# SPDX-License-Identifier: BSD-3-Clause
"""A line full of posts on a virtual clock: how fast they arrive; in order and once where frames are lost."""

from __future__ import annotations

import pytest

from unitylink import _native

POSTS = 20_000
POST_BYTES = 14
BYTE_NS = 833
LINE_PER_S = 1e9 / BYTE_NS / POST_BYTES


def test_posts_fill_a_line_that_loses_none() -> None:
    report = _native.stream_posts(1, POSTS, 0.0, byte_ns=BYTE_NS)
    assert report["disorder"] == report["lost"] == 0
    assert report["posts_per_s"] >= 0.99 * LINE_PER_S
    assert report["sent_bytes_per_post"] <= 1.01 * POST_BYTES


@pytest.mark.parametrize(("lose", "share"), [(0.001, 0.75), (0.01, 0.4), (0.1, 0.05)])
def test_posts_arrive_in_order_and_once_where_frames_are_lost(lose: float, share: float) -> None:
    """What is behind a lost one is sent again; were that noticed late, the rate would be far lower."""
    report = _native.stream_posts(3, POSTS, lose, byte_ns=BYTE_NS)
    assert report["disorder"] == 0
    assert report["lost"] > 0
    assert report["posts_per_s"] >= share * LINE_PER_S
