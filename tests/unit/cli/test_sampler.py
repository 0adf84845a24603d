# SPDX-License-Identifier: BSD-3-Clause
"""How samples are handed out that are gathered for a while."""

from __future__ import annotations

import time

import pytest

from unitylink import connect
from unitylink.simulate import Board
from unitylink.tools.names import Names
from unitylink.tools.sampler import Sampler

RATE_HZ = 1000
GATHER_S = 0.05


def test_what_one_sleep_gathers_is_handed_out_without_another(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A sleep for each sample let `record` fall behind whatever was faster than 50 Hz."""
    slept: list[float] = []
    sleep = time.sleep
    with (
        Board() as board,
        connect(board.url) as link,
        Sampler(link, Names(None).find(["0x20"]), RATE_HZ, gather_s=GATHER_S) as sampler,
    ):
        monkeypatch.setattr(time, "sleep", lambda wait_s: slept.append(wait_s) or sleep(wait_s))
        assert len([sample for sample in sampler.samples(count=500) if sample is not None]) == 500
    assert len(slept) < 500 / (RATE_HZ * GATHER_S) * 3
