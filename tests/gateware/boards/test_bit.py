# SPDX-License-Identifier: BSD-3-Clause
"""A bitstream as a link: built, unpacked, compiled, and reached through the pins of its UART."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from unitylink import connect
from unitylink.boards import Order, load_board
from unitylink.cli import main
from unitylink.errors import BoardError, DeviceMismatch, ToolError, UrlError
from unitylink.layer2_message import Link
from unitylink.resources import resource_folder
from unitylink.simulate.bit import Chip, Placed, placed
from unitylink.simulate.bit.pins import pin_map

pytestmark = pytest.mark.xdist_group("boards")  # one process, so that its tests share the bitstream

LAMP = """
link lamp (ENGINE=small);
public lamp() {
   @led = 0x10: u2 WRITE();
   @buttons = 0x11: u3 READ();
   @inside = 0x12: u8 WRITE();
}
"""


@pytest.fixture(scope="module")
def spec(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("bit") / "lamp.ul"
    file.write_text(LAMP)
    return file


@pytest.fixture(scope="module")
def url(spec: Path) -> str:
    return f"bit:{spec}?board=icebreaker"


@pytest.fixture(scope="module")
def link(url: str) -> Iterator[Link]:
    with connect(url) as link:
        yield link


@pytest.fixture(scope="module")
def lamp(spec: Path, link: Link) -> Placed:
    """The same bitstream, from the cache."""
    order = Order(spec_file=str(spec), folder=Path(), board=load_board("icebreaker"))
    said: list[str] = []
    found = placed(order, said.append)
    assert said == []
    return found


def test_words_are_at_the_pins(link: Link) -> None:
    pins = link.board.pins
    assert link.protocol == "framed"
    link.write(0x12, 0xA5)
    assert link.read(0x12) == 0xA5
    for value in (1, 2, 3, 0):
        link.write(0x10, value)
        assert link.read(0x10) == value
        assert (pins["LEDG_N"], pins["LEDR_N"]) == (not value & 1, not value & 2), "lit by low pins"
    assert link.read(0x11) == 0, "nobody presses a button"
    for name, low, bit in (("BTN_N", True, 1), ("P2_9", False, 2), ("P2_4", False, 4)):
        pins[name] = not low
        assert link.read(0x11) == bit
        pins[name] = low
    assert link.read(0x11) == 0
    assert all(pins.driven(name) == name.startswith("LED") for name in pins)


def test_a_plant_has_the_words_at_the_pins(link: Link) -> None:
    registers = link.board.registers
    registers[0x11] = 5
    assert link.read(0x11) == 5
    registers[0x11] = 0
    link.write(0x10, 2)
    link.read(0x10)
    assert registers[0x10] == 2
    with pytest.raises(Exception, match="nothing is there"):
        registers[0x12]


@pytest.mark.long  # the way is that of an iCE40; test_ecp5 compares a design with its bitstream
def test_words_are_at_the_pins_of_an_ecp5(spec: Path) -> None:
    with connect(f"bit:{spec}?board=ulx3s:25f") as link:
        pins = link.board.pins
        assert link.board.configuration.clock_hz == 37_500_000, "the PLL makes it of 25 MHz"
        link.write(0x12, 0xA5)
        assert link.read(0x12) == 0xA5
        for value in (1, 2, 3, 0):
            link.write(0x10, value)
            assert link.read(0x10) == value
            assert (pins["LED0"], pins["LED1"]) == (bool(value & 1), bool(value & 2))
        for name, bit in (("BTN1", 1), ("BTN2", 2), ("BTN3", 4)):
            pins[name] = True
            assert link.read(0x11) == bit
            pins[name] = False
        assert link.read(0x11) == 0


def test_a_pin_without_a_word_gets_a_place_of_its_own_way() -> None:
    chip = Chip("", 1, ("R1", "T1"), ("B2", "C2"))
    places = pin_map(chip, load_board("ulx3s:25f"), {}, {})
    given = {place.address for place in places.inputs.values()}
    told = {place.address for place in (*places.levels.values(), *places.drives.values())}
    assert not given & told, "a word is read or written, not both"


def test_pins_that_are_not_there(link: Link) -> None:
    with pytest.raises(BoardError, match="pin LEDG: the design does not use it; did you mean LEDG_N"):
        link.board.pins["LEDG"]
    with pytest.raises(BoardError, match="pin LEDG_N: only the chip drives it; the inputs are BTN_N, "):
        link.board.pins["LEDG_N"] = True


def test_what_has_been_built(
    lamp: Placed, spec: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "lamp-icebreaker"
    folder.mkdir()
    (folder / "report.json").write_text(json.dumps(dict(lamp.report)))
    file = folder / Path(lamp.report["bitstream"]).name
    with pytest.raises(
        BoardError, match=r"\.bin: No such file or directory; `unitylink build` makes it again"
    ):
        connect(f"bit:{folder}")
    file.write_bytes(lamp.bitstream)
    assert main(["read", f"bit:{folder}", "--spec", str(spec), "led", "inside"]) == 0
    assert "inside" in capsys.readouterr().out
    other = tmp_path / "other.ul"
    other.write_text(LAMP.replace("0x12", "0x13"))
    with pytest.raises(DeviceMismatch, match="the bitstream was built from another spec: its hash is "):
        connect(f"bit:{folder}?spec={other}")
    with pytest.raises(UrlError, match=r"lamp-icebreaker has been built, and baud_hz cannot be changed now"):
        connect(f"bit:{folder}?baud=9600")
    with connect(f"bit:{file}?board=icebreaker") as alone:
        assert alone.read(0x10) == 0


@pytest.mark.parametrize(
    ("rest", "kind", "message"),
    [
        ("", UrlError, "say for which board it is: board=NAME; there are ecp5-evn, "),
        ("?board=icebraker", BoardError, "no board is called 'icebraker'; did you mean icebreaker"),
        (
            "?board=ecp5-ft2232h",
            BoardError,
            "its link is ft245_sync, and a bitstream is run with a UART only",
        ),
        ("?board=icebreaker&fifo=16", UrlError, "fifo is for sim: and rtl:"),
        ("?board=icebreaker&physical=spi", UrlError, "the link of icebreaker is uart; leave physical= out"),
    ],
)
def test_what_cannot_be_run(spec: Path, rest: str, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        connect(f"bit:{spec}{rest}")


def test_a_design_that_does_not_fit_is_refused_before_it_is_placed() -> None:
    scara = resource_folder("examples") / "scara" / "scara.ul"
    with pytest.raises(BoardError, match=r"does not fit on iCEBreaker .* block RAMs and the chip has 30"):
        connect(f"bit:{scara}?board=icebreaker&protocol=both")


def test_a_file_that_is_no_bitstream(tmp_path: Path, lamp: Placed) -> None:
    file = tmp_path / "lamp.bin"
    with pytest.raises(UrlError, match=r"lamp\.bin: No such file or directory"):
        connect(f"bit:{file}?board=icebreaker")
    file.write_bytes(b"no bitstream")
    with pytest.raises(BoardError, match="it is not a bitstream of an iCE40: "):
        connect(f"bit:{file}?board=icebreaker")
    file.write_bytes(lamp.bitstream)
    with pytest.raises(BoardError, match="it is a bitstream of an iCE40 5k, not of a 8k"):
        connect(f"bit:{file}?board=ice40-hx8k")


def test_missing_tools(url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ToolError, match=r"nextpnr-ice40 is missing; .*sudo apt-get install nextpnr-ice40"):
        connect(url)
