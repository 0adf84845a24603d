# SPDX-License-Identifier: BSD-3-Clause
"""`watch` and `record` on a line that is lost: they report it and go on."""

from __future__ import annotations

import logging

import pytest

from unitylink import connect
from unitylink.commands.names import Names
from unitylink.commands.sampler import Sampler
from unitylink.simulate import Board


def test_samples_go_on_and_the_loss_is_told(caplog: pytest.LogCaptureFixture) -> None:
    items = Names(None).find(["0x20"])
    with (
        caplog.at_level(logging.WARNING, "unitylink"),
        Board(endpoint="tcp") as board,
        connect(f"{board.url}?timeout=5", reconnect=True) as link,
        Sampler(link, items, 100) as sampler,
    ):
        taken = 0
        for sample in sampler.samples():
            taken += sample is not None
            if taken == 3 and not link.statistics().reconnections and not link.trouble:
                board.registers[0x20] = 7
                board.hang_up()
            if sample is not None and sample[2][0] == 7 and "the samples go on" in caplog.text:
                break
    assert "the line was lost, and is being opened again" in caplog.text
    assert link.statistics().reconnections == 1
