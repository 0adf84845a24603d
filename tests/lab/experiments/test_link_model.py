# SPDX-License-Identifier: BSD-3-Clause
"""The model of the chip does what its assumptions say. The paper's low-level figures follow from them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from unitylink_lab.experiments.chip import Chip
from unitylink_lab.experiments.exchange import read, write
from unitylink_lab.experiments.gateware import Gateware2012
from unitylink_lab.experiments.link_parameters import (
    FT245_ASYNC,
    FT245_SYNC,
    LINKS,
    SOURCES,
    assumptions,
    uart,
)
from unitylink_lab.experiments.low_level import read_burst, synchronous_s, write_burst
from unitylink_lab.experiments.virtual_link import VirtualLink

IMMEDIATE = replace(FT245_ASYNC, send_immediate="all")


def test_reads_one_by_one_come_out_as_in_the_paper() -> None:
    assert synchronous_s(FT245_ASYNC, read()) == pytest.approx(974e-6, rel=0.10)
    assert synchronous_s(IMMEDIATE, read()) == pytest.approx(223.6e-6, rel=0.25)


def test_a_burst_pauses_as_the_time_stamps_of_the_paper_say() -> None:
    burst = read_burst(FT245_ASYNC, 600)
    assert burst.stamped_hz == pytest.approx(35.3e6, rel=0.10)
    assert burst.unpaused_hz == pytest.approx(64.2e6, rel=0.10)
    assert burst.between_pauses == pytest.approx(36, abs=4)


def test_send_immediate_lets_one_reply_through_in_a_microframe() -> None:
    burst = read_burst(IMMEDIATE, 18)
    assert 112 / burst.received_hz == pytest.approx(FT245_ASYNC.microframe_s)


def test_a_write_burst_is_no_faster_than_its_line() -> None:
    assert write_burst(IMMEDIATE, write()).period_s >= write().request_bytes * FT245_ASYNC.byte_s


@pytest.mark.parametrize("sends", [{}, {"send_immediate": "all"}, {"event_character": 0x0A}], ids=str)
def test_every_byte_arrives_in_order(sends: dict[str, object]) -> None:
    for link in LINKS:
        wire = VirtualLink(replace(link, **sends), Gateware2012())  # type: ignore[arg-type]
        wire.send(read().burst(40))
        wire.wait(14 * 40)
        assert b"".join(data for _, data in wire.received) == b"#S_R:00000000\n" * 40
        assert wire.lost == 0
        times = [time_s for time_s, _ in wire.received]
        assert times == sorted(times)


def test_a_packet_is_full_at_510_bytes_and_the_timer_sends_the_rest() -> None:
    chip = Chip(FT245_ASYNC)
    for _ in range(600):
        chip.put(0x41, ends_message=False)
    assert len(chip.poll(125e-6) or b"") == 510
    assert chip.poll(250e-6) is None
    assert len(chip.poll(1125e-6) or b"") == 90


def test_send_immediate_holds_the_chip_until_the_next_in() -> None:
    chip = Chip(IMMEDIATE)
    chip.put(0x0A, ends_message=True)
    assert chip.room == 0
    assert chip.poll(125e-6) == b"\n"
    assert chip.room == 1020


def test_only_publishes_send_at_once_where_only_they_may() -> None:
    chip = Chip(replace(FT245_ASYNC, send_immediate="publishes"))
    chip.put(0x0A, ends_message=True)
    assert chip.poll(125e-6) is None
    chip.put(0x0A, ends_message=True, publish=True)
    assert chip.poll(250e-6) == b"\n\n"


def test_a_uart_that_outruns_the_gateware_loses_bytes() -> None:
    wire = VirtualLink(replace(uart(12_000_000), byte_s=20e-9), Gateware2012(fifo=16))
    wire.send(read().burst(20))
    wire.run_until(2e-3)
    assert wire.lost > 0


def test_a_reply_that_never_comes_is_told() -> None:
    wire = VirtualLink(FT245_ASYNC, Gateware2012())
    wire.send(b"#R:12")
    with pytest.raises(TimeoutError, match="14 of 14 bytes are missing"):
        wire.wait(14, limit_s=0.01)


def test_the_chip_is_emptied_several_times_a_microframe_where_its_driver_does() -> None:
    payload_hz = 8 * FT245_SYNC.payload_bytes * FT245_SYNC.packets_per_microframe / FT245_SYNC.microframe_s
    assert payload_hz == pytest.approx(320e6, rel=0.03)
    once_hz = 8 * FT245_SYNC.payload_bytes * FT245_SYNC.chip_packets / FT245_SYNC.microframe_s
    assert read_burst(FT245_SYNC, 600).stamped_hz > 1.5 * once_hz


def test_a_faster_line_is_not_slower() -> None:
    slow, fast = synchronous_s(uart(1_000_000), read()), synchronous_s(FT245_SYNC, read())
    assert fast <= slow


def test_every_parameter_has_a_source() -> None:
    assert {row["name"] for row in assumptions()} == set(SOURCES)
