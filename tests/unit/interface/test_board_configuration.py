# SPDX-License-Identifier: BSD-3-Clause
"""From a spec to the configuration of a board."""

from __future__ import annotations

from typing import Any

import pytest

from unitylink.errors import ValueRangeError
from unitylink.interface.board_configuration import DoubleBufferConfiguration, FifoConfiguration
from unitylink.layer2_message import Link
from unitylink.simulate import Board, BoardConfiguration, TosnetConfiguration, TosnetNode
from unitylink.spec import Spec, compile_text


def spec_of(text: str) -> Spec:
    result = compile_text(text, "test.ul")
    assert result.spec is not None, result
    return result.spec


def memory(address: str) -> Spec:
    return spec_of(f"public board() {{ @word = {address}: READ(); }}")


@pytest.mark.parametrize(
    ("address", "bits"),
    [
        ("0x00", 8),
        ("0xFF", 8),
        ("0x100", 16),
        ("0xFFFF", 16),
        ("0x10000", 24),
        ("0x1000000", 32),
        ("0xFFFFFFFF", 32),
    ],
)
def test_plain_memory_is_as_wide_as_its_highest_address(address: str, bits: int) -> None:
    configuration = BoardConfiguration.for_spec(memory(address))
    assert configuration.address_bits == bits
    assert configuration.tosnet is None


def tosnet(*members: str, base: int = 0) -> TosnetConfiguration:
    body = " ".join(members)
    text = f"public net(ctrl,comm) {{ TOSNET(CTRL=ctrl, COMM=comm, BASE={base}); {body} }}"
    configuration = BoardConfiguration.for_spec(spec_of(text))
    assert configuration.tosnet is not None
    assert configuration.address_bits == (11 if base == 0 else 16)
    return configuration.tosnet


def test_tosnet_has_the_nodes_and_registers_of_the_spec() -> None:
    found = tosnet("@a = 0x80: READ();", "@b = 0x8C: WRITE();", "@c = 0x178: READ();")
    assert found.master_id == 1
    assert found.nodes == (TosnetNode(2, 0b11), TosnetNode(5, 0x80))


def test_the_pc_is_a_node_below_those_that_the_spec_reads_from() -> None:
    assert tosnet("@a = 0x40: READ();", "@b = 0x80: READ();").master_id == 0
    assert tosnet("@a = 0xC0: READ();", "@b = 0x80: READ();").master_id == 1


def test_the_pc_is_the_node_whose_outputs_it_writes() -> None:
    assert tosnet("@a = 0xC0: WRITE();", "@b = 0x80: READ();").master_id == 3


def test_the_cycle_is_that_of_the_ring() -> None:
    found = tosnet("@a = 0x80: READ();", "@b = 0x40: WRITE();")
    assert (found.master_registers, found.nodes) == (1, (TosnetNode(2, 1),))
    assert found.cycle_s == pytest.approx(77.6e-6)


def test_tosnet_above_a_base() -> None:
    assert tosnet("@a = 0x80: READ();", base=0x1000).base == 0x1000


def test_one_network_only() -> None:
    two = " ".join(
        f"public n{base}(ctrl,comm) {{ TOSNET(CTRL=ctrl, COMM=comm, BASE={base}); @a = 0x80: READ(); }}"
        for base in (0, 4096)
    )
    with pytest.raises(ValueRangeError, match="one network"):
        BoardConfiguration.for_spec(spec_of(two))


def test_queues_and_tables_are_those_of_the_spec() -> None:
    spec = spec_of("""
    public a(c,u) { MEMORY(CTRL=c, COMM=u); t: table(); q: queue(); r: other(); }
    table() { DOUBLE_BUFFER(BASE=0x100, SIZE=256); @v = 0x0: WRITE(); }
    queue() { FIFO(BASE=0x80, DEPTH=8); @n = 0x0: READCLEAR(PUBLISH(on arrival)); }
    other() { FIFO(BASE=0x90, DEPTH=4); @n = 0x0: PULSE(); }
    """)
    configuration = BoardConfiguration.for_spec(spec, clock_hz=1_000_000)
    assert configuration.double_buffers == (DoubleBufferConfiguration(0x100, 256),)
    assert configuration.fifos == (
        FifoConfiguration(0x80, 8, event_group=0, remind_clocks=20_000),
        FifoConfiguration(0x90, 4, event_group=None, remind_clocks=20_000),
    )
    assert configuration.edge_events == (0,)
    assert configuration.address_bits == 16  # the address of the commit is 0x200


def test_overrides() -> None:
    configuration = BoardConfiguration.for_spec(
        memory("0x10"), groups=4, data_bits=16, baud_hz=3_000_000, fifo=16
    )
    assert (configuration.groups, configuration.data_bits, configuration.byte_clocks) == (4, 16, 166)
    with pytest.raises(ValueRangeError, match="no field colour"):
        BoardConfiguration.for_spec(memory("0x10"), colour=1)


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"data_bits": 7}, "data_bits is 7"),
        ({"groups": 257}, "groups is 257"),
        ({"groups": "2"}, "groups is '2'; choose 1 to 256"),
        ({"groups": -1}, "groups"),
        ({"publish_mode": 3}, "publish_mode is 3"),
        ({"checksum": "crc16"}, "checksum is 'crc16'"),
        ({"datalink": "light"}, "datalink is 'light'"),
        ({"published_2012": 2}, "published_2012 is 2; choose True or False"),
        ({"published_2012": True, "protocol": "framed"}, "2012 speaks the classic protocol only"),
        ({"fifo": 2}, "fifo is 2"),
        ({"baud_hz": 10**9}, "baud_hz"),
        ({"polynomial": 256}, "polynomial is 256"),
        ({"edge_events": (300,)}, "edge_events"),
        ({"physical": "usb"}, "physical is 'usb'"),
        ({"physical": "ft245_sync", "baud_hz": 9600}, "ft245_sync has no baud rate"),
        ({"send_immediate": "always"}, "send_immediate is 'always'"),
        ({"tosnet": TosnetConfiguration()}, "address bits"),
        ({"address_bits": 11, "tosnet": TosnetConfiguration(nodes=(TosnetNode(1),))}, "node id 1"),
    ],
)
def test_what_cannot_be_is_refused_by_name(fields: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueRangeError) as caught, Board(configuration=BoardConfiguration(**fields)):
        pass
    assert words in str(caught.value)


@pytest.mark.parametrize("words", ["READ PULSE", "PULSE READ", "READCLEAR PULSE"])
def test_words_with_two_sides(words: str) -> None:
    """The PC clears flags by writing ones.

    A PULSE does not change the READ of its word, in either order of the text.
    """
    both = "".join(f"@{access.lower()} = 0x1: u8 {access}();" for access in words.split())
    spec = spec_of(f"public port() {{ @flags = 0x0: u8 W1C(); {both} @alone = 0x2: PULSE(); }}")
    configuration = BoardConfiguration.for_spec(spec)
    assert (configuration.flag_words, configuration.strobe_words) == ((0,), (1,))
    with Board(configuration=configuration) as board, Link(board.url) as link:
        board.registers[0], board.registers[1] = 0xFF, 0x55
        for mask in (0x0F, 0x0F, 0x10):
            link.write(0, mask)
        link.write(1, 3)
        link.write(2, 1)
        # a plant takes the last of them
        assert [link.read(address) for address in (0, 1, 2)] == [0xE0, 0x55, 1]
        assert [board.registers[address] for address in (0, 1)] == [0xE0, 0x55]


def test_a_queue_s_words_are_its_own() -> None:
    spec = spec_of(
        """public a(ctrl,comm) { MEMORY(CTRL=ctrl, COMM=comm); q: queue(); }
        queue() { FIFO(BASE=0x80, DEPTH=8); @taken = 0x0: READCLEAR(); @put = 0x0: PULSE(); }"""
    )
    assert BoardConfiguration.for_spec(spec).strobe_words == ()


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"engine": "tiny"}, "engine is 'tiny'; choose fast, small"),
        ({"window": 12}, "window is 12; choose a power of two, as 8"),
        ({"window": 3, "engine": "small"}, "window is 3; choose a power of two, as 2"),
        (
            {"base_hz": 20_000_000},
            "every 0 clocks, and 4 groups need 9: choose a BASE_RATE of at most 1333333 Hz",
        ),
        ({"base_hz": 20_000_000, "publish_mode": 0}, "0 clocks, and 4 groups need 1: .* at most 12000000 Hz"),
    ],
)
def test_what_no_gateware_can_be_is_refused_before_it_is_made(
    overrides: dict[str, Any], message: str
) -> None:
    with pytest.raises(ValueRangeError, match=message):
        BoardConfiguration.for_spec(memory("0x00"), **{"clock_hz": 12_000_000, **overrides})
