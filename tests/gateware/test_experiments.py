# SPDX-License-Identifier: BSD-3-Clause
"""What the experiments say about our gateware: the clocks in them are those of its pages."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from unitylink import protocol as p
from unitylink_lab.experiments.exchange import (
    EPOCH,
    Exchange,
    framed_post,
    framed_read,
    framed_read_many,
    framed_write,
    plain_client,
    read,
    read_many,
    write,
)
from unitylink_lab.experiments.gateware import (
    BITSTREAMS,
    CLASSIC,
    FRAMED,
    GATEWARES,
    LONGEST_READ,
    FramedGateware,
)
from unitylink_lab.experiments.level_one import all_figures, figures
from unitylink_lab.experiments.link_parameters import FT245_ASYNC, LINKS
from unitylink_lab.experiments.low_level import read_burst, synchronous_s, write_burst
from unitylink_lab.experiments.publish_delay import publish_delay
from unitylink_lab.experiments.virtual_link import VirtualLink

PAGES = Path(__file__).resolve().parents[2] / "docs" / "gateware"
SPLITTER_CLOCKS = 1  # with both protocols on one port, classic bytes come one clock later


def page_row(page: str, start: str) -> int:
    text = (PAGES / page).read_text(encoding="utf-8")
    found = re.search(rf"^\| {re.escape(start)}.*?\| (\d+) ", text, re.MULTILINE)
    assert found is not None, start
    return int(found[1])


@pytest.mark.parametrize(
    ("exchange", "through", "period"),
    [
        (read(), "read through a FIFO each side", "period of pipelined reads"),
        (write(), "write through a FIFO each side", "period of pipelined writes"),
    ],
    ids=["read", "write"],
)
def test_classic_clocks_are_those_of_the_core(exchange: Exchange, through: str, period: str) -> None:
    told = figures(CLASSIC, exchange)
    assert told.latency_clocks == page_row("core.md", through) + SPLITTER_CLOCKS
    assert told.period_clocks == page_row("core.md", period)


@pytest.mark.long
def test_the_clocks_of_a_bitstream_are_those_of_the_vhdl() -> None:
    rows = {(row.gateware, row.name): row for row in all_figures(bitstreams=True)}
    unpacked = {key: row for key, row in rows.items() if key[0] in BITSTREAMS}
    assert len(unpacked) == 16
    for (gateware, name), row in unpacked.items():
        assert row == replace(rows[gateware.removesuffix(", bitstream"), name], gateware=gateware)


@pytest.mark.parametrize(
    ("gateware", "exchange"),
    [(CLASSIC, read_many(LONGEST_READ)), (FRAMED, framed_read_many(LONGEST_READ))],
    ids=["classic", "framed"],
)
def test_the_longest_read_of_an_experiment_is_answered(gateware: str, exchange: Exchange) -> None:
    wire = VirtualLink(FT245_ASYNC, GATEWARES[gateware]())
    wire.send(exchange.request(0))
    wire.wait(exchange.reply_bytes)


def test_framed_clocks_are_those_of_the_page() -> None:
    assert figures(FRAMED, framed_read()).period_clocks == page_row("framed.md", "period of pipelined reads")
    post = figures(FRAMED, framed_post())
    assert post.latency_clocks is None
    assert post.period_clocks == framed_post().request_bytes + 1, "with one address byte"


@pytest.mark.parametrize("link", LINKS, ids=lambda link: link.name)
def test_every_frame_comes_through_the_chip(link: object) -> None:
    gateware = FramedGateware()
    wire = VirtualLink(link, gateware)  # type: ignore[arg-type]
    many = framed_read_many(70)
    wire.send(many.request(0))
    wire.wait(many.reply_bytes)
    bytes_ = b"".join(data for _, data in wire.received)
    answers = [plain_client().unframe(piece, EPOCH) for piece in bytes_.split(b"\0")[:-1]]
    assert [kind for kind, _ in answers] == [p.DEVICE_KIND_REPLY] * 2
    assert [len(payload) for _, payload in answers] == [4 + 2 + 4 * 60, 4 + 2 + 4 * 10]


def test_posts_hold_nothing_up_and_writes_do() -> None:
    held = replace(FT245_ASYNC, send_immediate="all")
    posts = write_burst(held, framed_post(), gateware=FRAMED)
    writes = write_burst(held, framed_write(), gateware=FRAMED)
    assert posts.period_s < 1.01 * framed_post().request_bytes * FT245_ASYNC.byte_s
    assert writes.period_s > 4 * posts.period_s


def test_a_read_takes_a_microframe_or_two_in_either_protocol() -> None:
    held = replace(FT245_ASYNC, send_immediate="all")
    assert synchronous_s(held, framed_read(), gateware=FRAMED, count=3) == pytest.approx(250e-6)
    assert read_burst(FT245_ASYNC, 32, gateware=FRAMED).stamped_hz > 0.5 * 8 / FT245_ASYNC.byte_s


@pytest.mark.parametrize("gateware", [CLASSIC, FRAMED])
def test_publishes_of_the_compiled_gateware_come_through_the_chip(gateware: str) -> None:
    told = publish_delay(FT245_ASYNC, gateware, "publishes")
    assert told.publishes > 20
    assert told.most_s < 260e-6
