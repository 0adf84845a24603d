# SPDX-License-Identifier: BSD-3-Clause
"""How gathered samples are handed out."""

from __future__ import annotations

import time

import pytest

from unitylink import connect
from unitylink.commands.names import Names
from unitylink.commands.sampler import Sampler
from unitylink.simulate import Board

MANY = 500


def test_samples_of_one_sleep_are_handed_out_without_another_sleep(monkeypatch: pytest.MonkeyPatch) -> None:
    """One sleep for each sample made `record` fall behind everything that was faster than 50 Hz."""
    slept: list[float] = []
    with (
        Board() as board,
        connect(board.url) as link,
        Sampler(link, Names(None).find(["0x20"]), rate_hz=1, gather_s=0.02) as sampler,
    ):
        monkeypatch.setattr(time, "sleep", slept.append)
        for _ in range(MANY):  # the thread of the publishes does the same
            sampler._take(link.now_s(), (), (), ())
        assert len([sample for sample in sampler.samples(count=MANY) if sample is not None]) == MANY
    assert len(slept) <= 1
