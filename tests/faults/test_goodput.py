# SPDX-License-Identifier: BSD-3-Clause
"""What passes a line on a virtual clock: each word once, and how fast if frames are lost."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from unitylink import _native
from unitylink_lab.bench.goodput import ASKED, BYTE_NS, LOSS, POSTS, REQUESTS, Traffic, goodput

ROOT = Path(__file__).resolve().parents[2]
WORDS = 20_000
FRAME_BYTES = {"posts": 14, "writes": 14, "reads": 14}  # bytes to move one word, in the busier direction
LINE_PER_S = 1e9 / BYTE_NS


@pytest.mark.parametrize("kind", FRAME_BYTES)
def test_a_line_that_loses_none_is_full(kind: str) -> None:
    report = _native.goodput(1, kind, WORDS, 0.0, byte_ns=BYTE_NS)
    assert report["wrong"] == report["lost"] == 0
    assert report["words_per_s"] >= 0.99 * LINE_PER_S / FRAME_BYTES[kind]
    assert report["sent_bytes_per_word"] <= 1.01 * FRAME_BYTES[kind]


@pytest.mark.parametrize("traffic", REQUESTS, ids=lambda traffic: traffic.name)
def test_requests_are_close_to_ideal_selective_repeat(traffic: Traffic) -> None:
    assert goodput(traffic, LOSS, words=WORDS, seed=3).share >= ASKED
    assert goodput(traffic, 0.1, words=WORDS, seed=3).share >= 0.45


@pytest.mark.parametrize(("lose", "share"), [(0.001, 0.9), (0.01, 0.75), (0.1, 0.3)])
def test_posts_arrive_in_order_and_once_where_frames_are_lost(lose: float, share: float) -> None:
    """Everything after a lost post is sent again.

    If the loss were noticed late, the rate would be far lower.
    """
    assert goodput(POSTS, lose, words=WORDS, seed=3).share >= share


def test_the_curves_of_the_page_are_those_of_the_script() -> None:
    check = [sys.executable, ROOT / "tools" / "docs" / "goodput.py", "--check"]
    done = subprocess.run(check, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, f"`make docs` draws them: {done.stdout}{done.stderr}"


def test_unknown_traffic_is_refused() -> None:
    with pytest.raises(KeyError, match="letters"):
        _native.goodput(1, "letters", WORDS, 0.0)
