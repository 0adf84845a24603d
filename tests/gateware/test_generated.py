# SPDX-License-Identifier: BSD-3-Clause
"""Generated designs in GHDL: analysed, synthesised without a latch or warning, answering on their UART."""

from __future__ import annotations

import re
from pathlib import Path
from random import Random
from typing import Any

import pytest

from unitylink.generate import generate_vhdl
from unitylink.generate.vhdl import design_name, word_map
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec import Spec, compile_text, load
from unitylink_lab.conformance.bench import play_on_twin

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "generate-vhdl.md"


def spec_of(text: str, file: str = "robot.ul") -> Spec:
    result = compile_text(text, file)
    assert result.spec is not None, result.diagnostics
    return result.spec


def told(configuration: BoardConfiguration) -> bytes:
    """Return what the twin of this configuration answers to RLC."""
    (answer,) = play_on_twin(configuration, [[("send", "#RLC\n"), ("quiet", 300)]])
    return answer


AWKWARD = """
public signal(ctrl, ^comm) {
   @Led = 0x10: WRITE(ID="synthesis translate_off");
   @led = 0x11: READ(ID="end package; -- \\n constant x");
   @lED_2 = 0x12: signed READ();
   @_ = 0x13: READ();
   @__a__b__ = 0x14: WRITE();
   @entity = 0x15: WRITE();
   @std_ulogic = 0x16: WRITE();
   @z = 0xFFFFFF: READ();
   process: signal_2("\\"quoted\\"") @ (0x40,0x41);
   PROCESS: signal_2("\\u00b5") @ (0x50,0x5F);
   all_of_it = process, PROCESS;
}
signal_2(n): @ (x,^signed) {
   @x: signed READ(ID=n);
   @^signed: WRITE(ID=n);
}
"""
# GHDL warns so about a port without any elements.
HARMLESS = dict.fromkeys(("tosnet_reads", "tosnet_status"), ('no assignment for port "write_words"',))
TOSNET = "public net(c) {{ TOSNET(CTRL=c, COMM=c, BASE=0x100); {} }}"
DESIGNS = {
    "scara": (ROOT / "examples" / "scara" / "scara.ul", {}),
    "servo": (ROOT / "examples" / "servo" / "servo.ul", {}),
    "walker18": (ROOT / "examples" / "walker18" / "walker18.ul", {}),
    "tosnet_reads": (TOSNET.format("@a = 0x80: READ();"), {}),
    "tosnet_writes": (TOSNET.format("@a = 0x84: WRITE();") + "public b() { @x = 0xFF: READ(); }", {}),
    "tosnet_status": (TOSNET.format("@a = 0x400: READ();"), {}),
    "hello_led": (ROOT / "examples" / "hello_led" / "hello_led.ul", {}),
    "awkward": (AWKWARD, {}),
    "narrow": (
        "public a() { @x = 0x0: signed READ(); @y = 0x1: WRITE(); }",
        {"data_bits": 12, "publish_mode": 0},
    ),
    "ft245_async": (ROOT / "examples" / "servo" / "servo.ul", {"physical": "ft245_async"}),
    "rs485": (ROOT / "examples" / "servo" / "servo.ul", {"physical": "rs485", "node": 5}),
    "spi": (ROOT / "examples" / "servo" / "servo.ul", {"physical": "spi"}),
    "ft245_sync": (
        ROOT / "examples" / "servo" / "servo.ul",
        {"physical": "ft245_sync", "send_immediate": "publishes"},
    ),
    "reads": ("public a() { @x = 0x7: READ(); }", {"groups": 2, "read_many": 0, "checksum": "xor"}),
    "writes": ("public a() { @x = 0x7: WRITE(); }", {"edge_events": (0, 15)}),
    "one_group": ("public a() { @x = 0x7: READ(PUBLISH(10 Hz)); }", {"groups": 1}),
    "nothing": ("public a() { }", {}),
    "profile": (ROOT / "examples" / "profile" / "profile.ul", {}),
    "queue": ("public a() { FIFO(BASE=0x40, DEPTH=4); @i = 0x0: PULSE(); @o = 0x0: READCLEAR(); }", {}),
    "table": (
        "public a() { DOUBLE_BUFFER(BASE=0x3, SIZE=1); @v = 0x0: READ(); }",
        {"data_bits": 16, "publish_mode": 0},
    ),
    "devices": ("public a() { @x = 0x7: READ(); } public b() { @x = 0x7: READ(); @y = 0x9: WRITE(); }", {}),
}


@pytest.mark.parametrize("name", DESIGNS)
def test_synthesis(designs: Any, name: str) -> None:
    source, overrides = DESIGNS[name]
    spec = load(source) if isinstance(source, Path) else spec_of(source)
    library = designs.library(spec, BoardConfiguration.for_spec(spec, **overrides))
    netlist = library.synthesise(f"{design_name(spec)}_top", *HARMLESS.get(name, ()))
    assert f"entity {design_name(spec)}_top is" in netlist


def test_the_boards_of_one_spec_stand_side_by_side(designs: Any) -> None:
    spec = load(ROOT / "examples" / "pa10" / "pa10_pair.ul")
    library = designs.library(spec)
    for board in spec.boards:
        assert f"entity {board.name}_top is" in library.synthesise(f"{board.name}_top")


def test_hello_led_on_its_uart(designs: Any) -> None:
    spec = load(ROOT / "examples" / "hello_led" / "hello_led.ul")
    steps: list[str | int] = [
        "#RLC\n",
        "#W:0000000005\n",
        "#R:00\n",
        "#RM:03000102\n",
        "#W:010000000A\n",  # a READ
        "#R:03\n",  # the address between the words
        "#R:04\n",
        "#WSA:00020102\n",
        "#WSR:000001\n",
        "#EPS\n",
        14_000,  # longer than a millisecond, because the group publishes at 1000 Hz
        "#DPS\n",
    ]
    answers = designs.play(spec, "hello_led_tb", steps)
    assert answers[0] == told(BoardConfiguration.for_spec(spec))
    assert answers[1:9] == [
        b"#S_W\n",
        b"#S_R:00000005\n",
        b"#S_RM:00000005fffffffa00000001\n",
        b"#?E_FBW\n",
        b"#?E_FBR\n",
        b"#?E_FBR\n",
        b"#S_WSA\n",
        b"#S_WSR\n",
    ]
    publish = b"%PUB:0002fffffffa00000001\n"
    assert answers[9].replace(publish, b"") == b"#S_EPS\n"
    assert 1 <= answers[10].count(publish) == len(answers[10]) / len(publish)


NAMES = ["Led", "led", "LED_2", "led_2", "_", "__", "a__b", "a_b_", "_2nd", "n2nd", "signal", "Process"]
NAMES += ["end", "words", "to_pc", "std_ulogic", "unsigned", "address", "x_t", "wire", "null", "work", "ieee"]
TEXTS = [
    "",
    "*/ end;",
    "--",
    "synthesis translate_off",
    "pragma translate_off",
    r"\u00b5\u2028",
    r"\n;",
    r"\"",
]


def random_spec(random: Random) -> Spec:
    """Return a random spec whose constructors, expansions, words and texts have names that could break
    something.
    """
    constructors = random.sample(NAMES, 3)
    free = iter(random.sample(range(0x600), 400))

    def element(name: str) -> str:
        kind = random.choice(["READ", "WRITE"])
        text = random.choice(TEXTS)
        return f'@^{name} = 0x{next(free):X}: {random.choice(["", "signed "])}{kind}(ID="{text}");'

    bodies = []
    for number, constructor in enumerate(constructors):
        names = random.sample(NAMES, random.randint(1, 8))
        members = [element(name) for name in names]
        if number < 2:  # it expands the next constructor, which has no addresses to bind, so only once
            part = random.choice([name for name in NAMES if name not in names])
            members.append(f"^{part}: ^{constructors[number + 1]}();")
        public = "public " if number == 0 else ""
        bodies.append(f"{public}^{constructor}() {{ {' '.join(members)} }}")
    return spec_of("\n".join(bodies), f"{random.choice(NAMES)}.ul")


@pytest.mark.parametrize("seed", range(12))
def test_no_name_and_no_text_can_break_a_design(designs: Any, seed: int) -> None:
    spec = random_spec(Random(seed))
    files = generate_vhdl(spec)
    assert files == generate_vhdl(spec), "the same spec gives the same text"
    assert all(text.isascii() and text.isprintable() for file in files.values() for text in file.splitlines())
    designs.library(spec)._call("-m", "--std=08", "-Wno-hide", f"{design_name(spec)}_top")
    words = word_map(spec)
    assert sorted(words.read.values()) == list(range(len(words.read)))
    user = files[f"vhdl/{design_name(spec)}_user_pkg.vhd"]
    fields = re.findall(r"std_ulogic_vector\(to_pc\.|\(words\(\d+ downto \d+\)\);", user)
    assert len(fields) == len(list(spec.walk())), "every element has its field"


def test_scara_on_its_uart(designs: Any) -> None:
    spec = load(ROOT / "examples" / "scara" / "scara.ul")
    cycle = 12_000_000 // 10_000  # clocks of one network cycle
    steps: list[str | int] = [
        "#RLC\n",
        "#WSA:000400880089008A008B\n",
        "#WSR:000001\n",
        "#W:008C00000064\n",
        "#W:008DFFFFFF9C\n",
        2 * cycle,
        "#R:0088\n",  # before the commit
        "#W:040000000001\n",
        2 * cycle,
        "#RM:0400880089008A008B\n",
        "#EPC\n",
        14_000,
    ]
    answers = designs.play(spec, "scara_tb", steps)
    assert answers[0] == told(BoardConfiguration.for_spec(spec))
    assert answers[1:6] == [b"#S_WSA\n", b"#S_WSR\n", b"#S_W\n", b"#S_W\n", b""]
    assert answers[6:9] == [b"#S_R:00000000\n", b"#S_W\n", b""]
    assert answers[9] == b"#S_RM:00000065ffffff9b0000000000000000\n"
    assert b"&PUB:000400000065ffffff9b0000000000000000*" in answers[11]


def test_the_board_of_the_page(designs: Any) -> None:
    """The board around a generated design in docs/generate-vhdl.md can be analysed and synthesised."""
    block, *_ = re.findall(r"^```vhdl\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    board = designs.folder / "board.vhd"
    board.write_text(block, encoding="ascii")
    spec = load(ROOT / "examples" / "hello_led" / "hello_led.ul")
    assert "entity board is" in designs.library(spec, None, [board]).synthesise("board")


def test_servo_board_from_its_uart_to_its_pins(designs: Any) -> None:
    """The example: the spec places PWM and encoder, and there is a user's logic with an event."""
    folder = ROOT / "examples" / "servo"
    spec = load(folder / "servo.ul")
    steps: list[str | int] = [
        "#RLC\n",
        "#WSA:000120\n",  # the address of the trips, for group 0: it publishes on limit
        "#WIC:0001\n",
        "#EPS\n",
        "#W:0200000640\n",  # servo 0: 1600 us
        "#W:0300000960\n",  # servo 1: 2400 us
        "#W:0000000001\n",  # enable
        24_000,  # 3 ms
        "#R:08\n",
        "#R:20\n",
        "#W:2200000000\n",
    ]
    answers = designs.play(spec, "servo_tb", steps, [folder / "servo_board.vhd"])
    assert answers[0] == told(BoardConfiguration.for_spec(spec))
    assert answers[1:7] == [b"#S_WSA\n", b"#S_WIC\n", b"#S_EPS\n", b"#S_W\n", b"#S_W\n", b"#S_W\n"]
    assert answers[7] == b"%PUB:000100000001\n", "the switch has closed once, and nobody asked"
    assert answers[8] in (b"#S_R:0000000f\n", b"#S_R:00000010\n")  # 1600 us are 16 steps of 100 us
    assert answers[9:] == [b"#S_R:00000001\n", b"#S_W\n"]
    library = designs.library(spec, None, [folder / "servo_board.vhd"])
    assert "entity servo_board is" in library.synthesise("servo_board")


def test_hello_led_board_from_its_uart_to_its_pins(designs: Any) -> None:
    """The first design that a user puts on a board: LEDs, buttons, a counter of milliseconds."""
    folder = ROOT / "examples" / "hello_led"
    spec = load(folder / "hello_led.ul")
    steps: list[str | int] = ["#RLC\n", "#W:00000000A5\n", 24_000, "#R:01\n", "#R:02\n", 8_000, "#R:02\n"]
    board = folder / "hello_led_board.vhd"
    answers = designs.play(spec, "hello_led_board_tb", steps, [board])
    assert answers[0] == told(BoardConfiguration.for_spec(spec))
    assert answers[1:4] == [b"#S_W\n", b"", b"#S_R:00000009\n"]
    first, second = (int(answers[index].strip().rpartition(b":")[2], 16) for index in (4, 6))
    assert 3 <= first < second <= first + 2  # milliseconds
    assert "entity hello_led_board is" in designs.library(spec, None, [board]).synthesise("hello_led_board")


@pytest.mark.parametrize("protocol", ["both", "framed"])
def test_a_design_with_frames_is_synthesised(designs: Any, protocol: str) -> None:
    spec = load(ROOT / "examples" / "servo" / "servo.ul")
    configuration = BoardConfiguration.for_spec(spec, protocol=protocol)
    assert (0x22, 0) in configuration.safe_words
    design = designs.library(spec, configuration)
    (package,) = designs.folder.glob("vhdl/*_config_pkg.vhd")
    assert '(x"00000022", x"00000000")' in package.read_text(encoding="utf-8")
    assert "core" in design.synthesise(f"{design_name(spec)}_design")
