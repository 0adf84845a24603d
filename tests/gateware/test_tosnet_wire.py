# SPDX-License-Identifier: BSD-3-Clause
"""The model of TosNet's wire: its code, scrambler, check, packets and line, against published figures."""

from __future__ import annotations

import doctest
import random
import re
from importlib import import_module
from itertools import groupby, product

import pytest
from gateware.tosnet_crc import checked, crc8, poisoned
from gateware.tosnet_line import bits_of, decode_line, encode_packets
from gateware.tosnet_packets import (
    Node,
    Packet,
    Slot,
    Words,
    cycle,
    data_packet,
    from_master,
    net_set,
    network_registers,
    places,
    start_up,
    taken_by_master,
    through,
)
from gateware.tosnet_scrambler import following, scrambled
from gateware.tosnet_timing import cycle_bytes, cycle_us, strobe_clocks

from gateware import tosnet_code as code

MODULES = ("code", "scrambler", "crc", "packets", "timing", "line")
# Of the published table: character, symbol behind -1 and behind +1, in the order of the line.
PUBLISHED = re.findall(
    r"([DK])(\d\d)\.(\d) ([01]{10}) ([01]{10})",
    """
    D00.0 1001110100 0110001011   D01.0 0111010100 1000101011   D03.0 1100011011 1100010100
    D07.0 1110001011 0001110100   D15.1 0101111001 1010001001   D23.2 1110100101 0001010101
    D10.2 0101010101 0101010101   D21.5 1010101010 1010101010   D24.3 1100110011 0011001100
    D05.3 1010011100 1010010011   D16.4 0110110010 1001001101   D31.7 1010110001 0101001110
    D11.7 1101001110 1101001000   D13.7 1011001110 1011001000   D14.7 0111001110 0111001000
    D17.7 1000110111 1000110001   D18.7 0100110111 0100110001   D20.7 0010110111 0010110001
    K28.0 0011110100 1100001011   K28.1 0011111001 1100000110   K28.2 0011110101 1100001010
    K28.3 0011110011 1100001100   K28.4 0011110010 1100001101   K28.5 0011111010 1100000101
    K28.6 0011110110 1100001001   K28.7 0011111000 1100000111   K23.7 1110101000 0001010111
    K27.7 1101101000 0010010111   K29.7 1011101000 0100010111   K30.7 0111101000 1000010111
    """,
)
DISPARITIES = (-1, 1)
ALL = [(byte, False) for byte in range(256)] + [(byte, True) for byte in code.CONTROLS]
RING = [Node(1, 0x01), Node(7, 0x83), Node(3, 0x00), Node(5, 0x01)]


@pytest.mark.parametrize(("kind", "x", "y", "minus", "plus"), PUBLISHED)
def test_published_symbols(kind: str, x: str, y: str, minus: str, plus: str) -> None:
    byte, control = int(x) | int(y) << 5, kind == "K"
    for disparity, symbol in ((-1, minus), (1, plus)):
        found, behind = code.encode(byte, disparity, control=control)
        assert code.bits(found) == [int(bit) for bit in symbol]
        assert behind == disparity + 2 * symbol.count("1") - 10
        assert code.decode(found, disparity) == (code.Character(byte, control), behind)


def test_alignment_is_the_reference_pattern() -> None:
    assert {symbol for symbol in range(1024) if code.starts_packet(symbol)} == {0b0101111100, 0b1010000011}


def test_each_symbol_means_one_character() -> None:
    for disparity in DISPARITIES:
        assert len({code.encode(byte, disparity, control=k)[0] for byte, k in ALL}) == len(ALL) == 268
    for symbol in range(1024):
        meanings = {found[0] for disparity in DISPARITIES if (found := code.decode(symbol, disparity))}
        assert len(meanings) <= 1


def test_the_line_has_as_many_ones_as_zeros() -> None:
    for (byte, control), disparity in product(ALL, DISPARITIES):
        symbol, behind = code.encode(byte, disparity, control=control)
        assert sum(code.bits(symbol)) - 5 == (behind - disparity) // 2
        assert behind in DISPARITIES


def equal_bits(word: int, count: int) -> bool:
    """Tell whether so many of 20 bits in a row are equal."""
    ones, zeros = word, word ^ 0xFFFFF
    for _ in range(count - 1):
        ones, zeros = ones & ones >> 1, zeros & zeros >> 1
    return bool(ones or zeros)


def test_no_pair_has_six_equal_bits_or_a_false_start() -> None:
    sent = [one for one in ALL if not one[1] or one[0] in (code.K28_1, code.K28_5)]
    starts = {symbol for symbol in range(1024) if code.starts_packet(symbol)}
    pairs = set()
    for first, disparity in product(sent, DISPARITIES):
        symbol, behind = code.encode(first[0], disparity, control=first[1])
        pairs |= {symbol | code.encode(byte, behind, control=k)[0] << 10 for byte, k in sent}
    assert len(pairs) > 100_000
    assert not any(equal_bits(pair, 6) for pair in pairs)
    assert any(equal_bits(pair, 5) for pair in pairs)
    assert not any(pair >> shift & 0x3FF in starts for pair in pairs for shift in range(1, 10))


def test_no_control_character_of_that_name() -> None:
    with pytest.raises(ValueError, match="no control character 0x00"):
        code.encode(0, -1, control=True)


def test_scrambler_repeats_after_63_bytes() -> None:
    states = [0x55]
    while (state := following(states[-1])) != states[0]:
        states.append(state)
    assert len(states) == len(set(states)) == 63
    assert scrambled(bytes(4), 0x55) == bytes(states[:4])
    assert scrambled(bytes(3), 0x00) == b"\xff\xff\xff"  # zeros would not scramble


def test_check() -> None:
    assert crc8(b"123456789") == 0xDF
    assert crc8(checked(b"123456789")) == 0
    assert poisoned(checked(b"1234")) == b"1234" + bytes([crc8(b"1234") ^ 0xFF])


@pytest.mark.parametrize("place", range(4))
def test_start_up(place: int) -> None:
    nets = ["4101", "42 01 17", "43 01 17 23", "44 01 17 23 35"]
    masks = ["60 0101", "60 0101 8383", "60 0101 8383 0000", "60 0101 8383 0000 0101"]
    expected = ["21", "31", nets[place], "54 01172335", masks[place], "70 0101 8383 0000 0101"]
    assert start_up(RING, place) == [checked(bytes.fromhex(text)) for text in expected]


def test_lowest_id_is_master_and_the_ring_keeps_its_order() -> None:
    assert from_master([*RING[2:], *RING[:2]]) == RING
    assert network_registers(RING) == [0x010101, 0x838317, 0x000023, 0x010135]


def test_fifteen_nodes_fit_into_the_packets() -> None:
    ring = [Node(number, 0xFF) for number in range(1, 16)]
    assert net_set(ring)[0] == 0x5F
    assert len(net_set(ring)) == 17
    assert cycle_bytes(ring) == len(data_packet(ring, Words(), Slot(1))) + 2 == 18 + 32 * 120


def test_sections_of_a_data_packet() -> None:
    words = Words({7 * 64 + 4: 0x44332211, 7 * 64 + 7 * 8: 0xAA, 7 * 64 + 8 + 3: 0xBB000000, 64: 1, 68: 2})
    packet = data_packet(RING, words, Slot(7, b"Hello", valid=True))
    assert packet[0] == 0xA0
    assert packet[1:5] == b"\x01\0\0\0"  # node 1: OUT, then IN
    assert packet[17:21] == b"\x02\0\0\0"
    of_out, of_in = places(RING, 1)
    assert (of_out.start, of_in.start, of_in.stop) == (33, 33 + 48, 33 + 96)
    assert packet[of_out][:16] == b"\xaa" + bytes(15)  # register 7 is first
    assert packet[of_out][16:32] == bytes(15) + b"\xbb"
    assert packet[of_in][32:36] == b"\x11\x22\x33\x44"  # register 0 is last, the low byte first
    assert packet[-15:-1] == b"\x97Hello" + bytes(7) + b"\x57"
    assert crc8(packet) == 0


def test_a_cycle_brings_every_word_to_its_reader() -> None:
    draw = random.Random(7)
    master = Words({at: draw.getrandbits(32) for at in range(1024)})
    own = [Words({at: draw.getrandbits(32) for at in range(1024)}) for _ in RING[1:]]
    asked = Slot(5, b"ask", valid=True)
    answer = Slot(5, b"answer", valid=True, of_master=False)
    fibres = cycle(RING, master, own, asked, {2: answer, 3: answer})
    assert len(fibres) == 4
    for at, packet in enumerate(fibres):
        assert crc8(packet) == 0
        assert Slot.of(packet[-15:-1]) == (answer if at == 3 else asked)  # only the addressed node answers
    outputs, found = taken_by_master(RING, fibres[-1])
    assert found == answer
    for place, node in enumerate(RING[1:], start=1):
        mirror = through(RING, place, fibres[place - 1], own[place - 1])[1]
        for register, word in product(node.registers, range(4)):
            at = node.id * 64 + register * 8 + word
            assert outputs.words[at] == own[place - 1].words[at]
            assert mirror.words[at + 4] == master.words[at + 4]
            assert at not in mirror.words  # its own OUT is not overwritten by the old one


def test_a_broken_packet_is_poisoned_by_the_next_node() -> None:
    packet = data_packet(RING, Words(), Slot(0))
    broken = packet[:40] + bytes([packet[40] ^ 1]) + packet[41:]
    sent = through(RING, 1, broken, Words())[0]
    assert (Packet(packet).good, Packet(packet).poisoned) == (True, False)
    assert (Packet(sent).good, Packet(sent).poisoned) == (False, True)
    again = through(RING, 2, sent, Words())[0]
    assert Packet(again).poisoned


@pytest.mark.parametrize(("nodes", "expected"), [(2, 77.6), (5, 172.4), (15, 488.4)])
def test_cycle_time_is_the_reference_figure(nodes: int, expected: float) -> None:
    assert cycle_us([Node(number, 1) for number in range(1, nodes + 1)]) == pytest.approx(expected)


def test_all_strobes_are_at_the_same_moment() -> None:
    hop = 300
    for nodes in range(2, 16):
        moments = {address * hop + strobe_clocks(nodes, address) for address in range(1, nodes)}
        assert moments == {nodes * hop}  # of the packet that the master sent at 0; it comes back to it then
        assert strobe_clocks(nodes, 0) == 0


@pytest.mark.parametrize("clocks_per_bit", [3, 4, 4.5, 8])
@pytest.mark.parametrize("ppm", [-200, 0, 200])
def test_a_line_keeps_its_packets(clocks_per_bit: float, ppm: float) -> None:
    bodies = [*start_up(RING, 0), data_packet(RING, Words({64: 0xFFFFFFFF}), Slot(3))]
    samples = encode_packets(bodies, clocks_per_bit, ppm=ppm)
    packets = decode_line(samples, clocks_per_bit)
    assert [one.body for one in packets] == bodies
    assert all(one.good for one in packets)
    assert [one.start for one in packets] == sorted(one.start for one in packets)
    assert [one.command for one in packets] == [2, 3, 4, 5, 6, 7, 10]
    assert all(
        one.end - one.start == pytest.approx(10 * clocks_per_bit * (len(one.body) + 2), rel=0.1)
        for one in packets
    )


def test_a_line_has_no_long_runs() -> None:
    samples = encode_packets([bytes(300)], 1)
    assert max(len(list(run)) for _, run in groupby(samples)) <= 5


def test_the_receiver_starts_anywhere() -> None:
    bodies = [checked(bytes([0x20, at])) for at in range(4)]
    samples = encode_packets(bodies)
    for cut in range(0, 300, 7):
        found = [one.body for one in decode_line(samples[cut:])]
        assert found == bodies[-len(found) :]
    assert len(decode_line(samples[:-200])) == 3  # the last packet's end is not there


@pytest.mark.parametrize(
    "body", [*start_up(RING, 3), checked(bytes(range(40)))], ids=lambda body: body.hex()[:8]
)
def test_no_wrong_bit_gives_another_packet(body: bytes) -> None:
    rest, seen = 4, set()
    for place in range(10 * rest, 10 * (rest + 2 + len(body))):
        samples = encode_packets([body], rest=rest, wrong_bits=[place])
        found = decode_line(samples)
        assert not any(one.good for one in found), f"bit {place}"  # its disparity tells
        seen |= {one.broken for one in found}
        loose = [one for one in decode_line(samples, strict=False) if one.good and one.body != body]
        assert not loose, f"bit {place}: without the disparity the check tells"
    assert {"no symbol of 8b10b", "a symbol of the wrong disparity"} <= seen


def test_without_disparity_a_broken_packet_has_a_wrong_check() -> None:
    lines = [encode_packets([checked(bytes(range(40)))], wrong_bits=[place]) for place in range(200, 210)]
    wrong = [line for line in lines if decode_line(line)[0].broken == "a symbol of the wrong disparity"]
    found = [decode_line(line, strict=False)[0] for line in wrong]
    assert any((one.broken, one.good, one.poisoned) == ("", False, False) for one in found)


@pytest.mark.parametrize("module", MODULES)
def test_docstrings_are_true(module: str) -> None:
    found = doctest.testmod(import_module(f"gateware.tosnet_{module}"))
    assert (found.failed, found.attempted > 0) == (0, True)


def test_bits_follow_the_edges() -> None:
    assert [level for level, _ in bits_of([1] * 4 + [0] * 9 + [1] * 3, 4)] == [1, 0, 0, 1]
