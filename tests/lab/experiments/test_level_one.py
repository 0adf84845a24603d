# SPDX-License-Identifier: BSD-3-Clause
"""Level 1 has the paper's clocks for the 2012 gateware."""

from __future__ import annotations

import pytest

from unitylink_lab.experiments.exchange import (
    Exchange,
    framed_post,
    framed_read,
    framed_write,
    read,
    read_many,
    write,
)
from unitylink_lab.experiments.level_one import figures
from unitylink_lab.experiments.link_parameters import FT245_ASYNC
from unitylink_lab.experiments.publish_delay import SEND_IMMEDIATE, publish_delay


def test_the_2012_gateware_is_the_paper_s() -> None:
    reads, writes = figures("2012", read()), figures("2012", write())
    assert (reads.latency_clocks, writes.latency_clocks) == (57, 63)
    assert reads.request_hz == pytest.approx(85.7e6, rel=1e-3)
    assert reads.reply_hz == pytest.approx(200e6, rel=1e-3)
    assert writes.request_hz == pytest.approx(151.3e6, rel=1e-3)
    assert writes.reply_hz == pytest.approx(54.1e6, rel=1e-2)
    assert writes.effect_clocks == 50


@pytest.mark.parametrize("words", [1, 4, 32])
def test_a_read_of_many_words_costs_what_the_simulation_said(words: int) -> None:
    assert figures("2012", read_many(words)).period_clocks == 14 + 16 * words


@pytest.mark.parametrize("exchange", [framed_read(), framed_write(), framed_post()], ids=lambda e: e.name)
def test_no_two_framed_requests_are_a_repeat(exchange: Exchange) -> None:
    frames = exchange.burst(300)
    assert len(set(frames.split(b"\0"))) == 301  # there is an empty piece after the last border
    assert exchange.request_bytes == frames.index(b"\0") + 1


def test_send_immediate_brings_a_publish_at_once() -> None:
    delays = {sends: publish_delay(FT245_ASYNC, "2012", sends) for sends in SEND_IMMEDIATE}
    assert all(told.publishes > 20 for told in delays.values())
    assert delays["publishes"].most_s < 260e-6
    assert delays["never"].mean_s > 500e-6
    assert delays["all"].most_s == pytest.approx(delays["publishes"].most_s, rel=0.02)
