# SPDX-License-Identifier: BSD-3-Clause
"""The simpler datalinks: the twin's answers on them, and a host that uses them."""

from __future__ import annotations

import pytest

from unitylink._native import Device
from unitylink.layer2_message import Link
from unitylink.simulate import Board, BoardConfiguration

LITE = BoardConfiguration(datalink="lite", groups=2, group_size=4, bench_memory=True)
NONE = BoardConfiguration(
    datalink="none", groups=2, group_size=4, bench_memory=True, bus_error_ranges=((0xE0, 0xEF),)
)
UNCHECKED = BoardConfiguration(checksum="none", bench_memory=True)
READ_23 = "#S_RM:\x40\xde\x11\x11\x40\xde##\n"  # the head of the next request was taken for an address


def ask(device: Device, text: str) -> str:
    data = text.encode("latin-1")
    assert device.receive(data) == len(data)
    device.run_until(device.clock + 20_000)
    return device.take().decode("latin-1")


@pytest.mark.parametrize(
    ("configuration", "dialogue"),
    [
        (LITE, [("$R:12*58\n", "?f1\n"), ("#R:12\n", "#S_R:40de1212\n")]),
        (LITE, [("#R:1Z2\n", "#"), ("#R:12\n", "?E_MAB\n"), ("#R:12\n", "#S_R:40de1212\n")]),
        (LITE, [("#RM:02111z\n", "#S_RM:40de1111"), ("$", "?E_MAB\n"), ("#R:1 2\n", "#S_R:40de1212\n")]),
        (LITE, [("#R5\n", ""), ("#R:12\n", "#S_R:40de1212\n"), ("#EPC\n", "#?E_ICC\n")]),
        (LITE, [("#R:12" + "34" * 300 + "\n", "#S_R:40de1212\n")]),
        # An incomplete request keeps what it has done: a group without addresses, one byte of the mask.
        (LITE, [("#WSA:00021112\n", "#S_WSA\n"), ("#WSA:000320\n", "#?E_MAB\n")]),
        (LITE, [("#WSA:00021112\n#WSA:000320\n", "#S_WSA\n#?E_MAB\n"), ("#RSI:00\n", "#S_RSI:000000\n")]),
        (LITE, [("#WIC:0003\n#WIC:ff\n#RIC\n", "#S_WIC\n#?E_MDB\n#S_RIC:0003\n")]),
        (NONE, [("#R:\x12", "#S_R:\x40\xde\x12\x12\n"), ("#W:\x20#\n:!", "#S_W\n")]),
        (NONE, [("#W:\x20#\n:!\n#R:\x20\n", "#S_W\n#S_R:#\n:!\n"), ("#RM:\x02\x11", ""), ("#RLC", READ_23)]),
        (NONE, [("#RM:\x02\x11\xe3$R\n", "#S_RM:\x40\xde\x11\x11?E_FBR\n")]),
        (NONE, [("#RM:\x00#R\n", "#?E_IBS\n#?E_ICC\n"), ("#X:#R*#DPS\n", "#?E_ICC\n#S_DPS\n")]),
        (UNCHECKED, [("$R:12*58\n", "?f1\n"), ("#EPC\n", "#?E_ICC\n"), ("#R:1Z2\n", "?f3\n")]),
    ],
)
def test_dialogue(configuration: BoardConfiguration, dialogue: list[tuple[str, str]]) -> None:
    device = Device(configuration)
    assert [ask(device, text) for text, _ in dialogue] == [answer for _, answer in dialogue]


@pytest.mark.parametrize("configuration", [LITE, UNCHECKED], ids=["lite", "no checksum"])
@pytest.mark.parametrize("options", ["", "?crc=0"])
def test_a_host_finds_its_way(configuration: BoardConfiguration, options: str) -> None:
    with Board(configuration=configuration) as board, Link(board.url + options) as link:
        assert link.configuration.discovered
        link.write(0x20, 0xDEADBEEF)
        assert list(link.read_many([0x20, 0x12])) == [0xDEADBEEF, 0x40DE1212]
        subscription = link.subscribe([0x20, 0x21], divisor=1)
        assert subscription.wait(5)


def test_a_host_is_told_what_it_cannot_ask() -> None:
    configuration = BoardConfiguration(
        datalink="lite", configuration_command=False, groups=2, group_size=4, protocol="classic"
    )
    options = "crc=0&address_bytes=1&data_bytes=4&read_many=255&base_hz=1000&groups=2&group_size=4"
    options += "&rate_bytes=2&publish_mode=2"
    with Board(configuration=configuration) as board, Link(f"{board.url}?{options}") as link:
        assert not link.configuration.discovered
        link.write(0x20, 7)
        assert link.read(0x20) == 7
        assert link.subscribe([0x20], divisor=1).wait(5)
