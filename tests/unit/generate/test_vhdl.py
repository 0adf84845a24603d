# SPDX-License-Identifier: BSD-3-Clause
"""The plan of a generated design: names, words, blocks, the text. tests/gateware checks it with GHDL."""

from __future__ import annotations

import os
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from unitylink.commands.generate import command
from unitylink.errors import BindingError, ValueRangeError
from unitylink.generate import generate, generate_vhdl
from unitylink.generate.quoting import Vhdl
from unitylink.generate.vhdl import design_name, word_map
from unitylink.generate.vhdl.blocks import WINDOW, blocks
from unitylink.generate.vhdl.names import KEYWORDS, Names
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.settings import SETTINGS
from unitylink.spec import compile_text, load
from unitylink.spec.model import Spec

ROOT = Path(__file__).resolve().parents[3]
GOLDEN = ROOT / "tests" / "golden"
PAIR = ROOT / "examples" / "pa10" / "pa10_pair.ul"
SPECS = [ROOT / "examples" / name / f"{name}.ul" for name in ("scara", "servo")]


def spec_of(text: str, file: str = "robot.ul") -> Spec:
    result = compile_text(text, file)
    assert result.spec is not None, result.diagnostics
    return result.spec


@pytest.mark.parametrize("path", SPECS, ids=lambda p: p.stem)
def test_golden(path: Path) -> None:
    for name, text in generate(load(path), "vhdl").items():
        if os.environ.get("UPDATE_GOLDEN"):
            (GOLDEN / name).write_text(text, encoding="utf-8")
        assert text == (GOLDEN / name).read_text(encoding="utf-8"), name
    assert generate(load(path), "vhdl") == generate(load(path), "vhdl")


@given(st.lists(st.text(max_size=12) | st.sampled_from(sorted(KEYWORDS)) | st.from_regex(r"\A\w{0,6}\Z")))
def test_names_are_legal_and_distinct(texts: list[str]) -> None:
    names = Names()
    given_names = [names.claim(text) for text in texts]
    assert len(set(given_names)) == len(texts)
    for name in given_names:
        assert re.fullmatch(r"[a-z]([a-z0-9]|_(?=[a-z0-9]))*", name), name
        assert name not in KEYWORDS


@given(st.text())
def test_remarks_stay_on_their_line(text: str) -> None:
    said = Vhdl.remark(text)
    assert said.isascii() and (said.isprintable() or not said) and len(said) <= 200


@given(
    st.sets(st.integers(0, 3000) | st.integers(0, 2**32 - 1), max_size=60),
    st.lists(st.tuples(st.integers(0, 4000), st.sampled_from([1, 3, 6, 65, 700])), max_size=4),
)
def test_blocks_hold_every_address_once_and_keep_out(
    addresses: set[int], others: list[tuple[int, int]]
) -> None:
    keep_out = [range(start, start + words) for start, words in others]
    addresses -= {address for other in keep_out for address in other}
    found = blocks(addresses, keep_out)
    assert sorted(a for block in found for a in block.addresses) == sorted(addresses)
    for block in found:
        assert block.words & (block.words - 1) == 0 and block.base % block.words == 0
        assert block.words <= WINDOW
        assert all(block.base <= address < block.base + block.words for address in block.addresses)
        assert all(block.base >= o.stop or block.base + block.words <= o.start for o in keep_out)
    assert all(one.base + one.words <= other.base for one, other in pairwise(found))


def test_sparse_maps_make_few_slaves() -> None:
    every_fourth = blocks(range(0, 1024, 4))
    assert len(every_fourth) == 16
    scattered = blocks(range(0, 1 << 20, 1 << 14))
    assert [block.words for block in scattered] == [1] * 64


def test_words_are_in_rising_order_for_each_direction() -> None:
    text = "public a() { @x = 0x9: READ(); @y = 0x2: WRITE(); @z = 0x1: READ(); @w = 0x5: WRITE(); }"
    words = word_map(spec_of(text))
    assert (dict(words.read), dict(words.write)) == ({1: 0, 9: 1}, {2: 0, 5: 1})


def test_a_word_of_several_devices_has_one_field_and_both_directions() -> None:
    text = (
        "public a() { @x = 0x7: READ(); } public b() { @y = 0x7: READ(); } public c() { @z = 0x7: WRITE(); }"
    )
    spec = spec_of(text)
    words = word_map(spec)
    assert (dict(words.read), dict(words.write)) == ({7: 0}, {7: 0})
    user = generate_vhdl(spec)["vhdl/robot_user_pkg.vhd"]
    assert "to_pc.a.x" in user and "to_pc.b" not in user and "from_pc.c.z" in user


@pytest.mark.parametrize("words", ["READ PULSE", "PULSE READ", "READCLEAR PULSE", "PULSE READCLEAR"])
def test_a_pulse_does_not_hide_the_read_word_that_it_shares(words: str) -> None:
    """In either order of the text: the word belongs to the logic, the strobe lasts one clock, and a read is
    reported.
    """
    both = " ".join(f"@{access.lower()} = 0x0: {access}();" for access in words.split())
    design = generate_vhdl(spec_of(f"public robot() {{ {both} }}"))["vhdl/robot_design.vhd"]
    assert "reads(0) <= read_words(31 downto 0);" in design
    assert "<= writes(0) when changed(0) = '1' else (others => '0');" in design
    assert ("was_read(0) <= taken(0);" in design) == ("READCLEAR" in words)


def test_a_design_for_each_board_has_all_of_its_inputs() -> None:
    spec = load(PAIR)
    files = generate_vhdl(spec)
    parts = ("build.sh", "config_pkg.vhd", "design.vhd", "top.vhd", "user_pkg.vhd")
    assert sorted(files) == [f"vhdl/{arm}_{part}" for arm in ("left_arm", "right_arm") for part in parts]
    for board in spec.boards:
        user = files[f"vhdl/{board.name}_user_pkg.vhd"]
        inputs = {f"to_pc.arm.j({joint}).{word}" for joint in range(7) for word in ("pos", "speed")}
        assert {text for text in inputs if f"std_ulogic_vector({text})" in user} == inputs
    assert generate_vhdl(spec.only("right_arm")).items() <= files.items(), "alone it is the same design"
    spoken = generate_vhdl(spec, {"protocol": "framed"})
    assert all(
        "=> protocol_framed," in spoken[f"vhdl/{arm}_config_pkg.vhd"] for arm in ("left_arm", "right_arm")
    )


def test_one_configuration_is_of_one_board() -> None:
    spec = load(PAIR)
    left = BoardConfiguration.for_spec(spec.only("left_arm"))
    with pytest.raises(BindingError, match="has 2 boards, but only one configuration"):
        generate_vhdl(spec, left)
    with pytest.raises(
        ValueRangeError, match=r"left_arm, right_arm; choose one: --root left_arm, or \?root="
    ):
        BoardConfiguration.for_spec(spec)


def test_boards_that_vhdl_does_not_tell_apart() -> None:
    text = "link a (DATA=32); link A (DATA=16); "
    text += " ".join(f"public p{n}() {{ MEMORY(LINK={n}); @x = 0x1: READ(); }}" for n in ("a", "A"))
    with pytest.raises(BindingError, match=r"two boards of robot\.ul are both pa in VHDL"):
        generate_vhdl(spec_of(text))


def test_tosnet_words_belong_to_whom_the_network_says() -> None:
    members = {
        "read_out": "@a = 0x80: READ();",  # node 2 drives it
        "write_in": "@b = 0x84: WRITE();",  # the PC drives node 2's IN word
        "write_own": "@c = 0x40: WRITE();",  # the PC is node 1
        "read_in": "@d = 0x85: READ();",  # the PC wrote it, so the user's logic drives nothing
        "write_out": "@e = 0x81: WRITE();",  # TosNet refuses this
        "status": "@f = 0x400: READ();",  # TosNet's own
    }
    spec = spec_of(f"public net(c) {{ TOSNET(CTRL=c, COMM=c, BASE=0x800); {' '.join(members.values())} }}")
    words = word_map(spec)
    assert dict(words.read) == {0x880: 0}
    assert dict(words.write) == {0x840: 0, 0x884: 1, 0x885: 2}
    user = generate_vhdl(spec)["vhdl/robot_user_pkg.vhd"]
    assert "from_pc.b" in user and "from_pc.d" not in user and "from_pc.e" not in user


def test_names_of_files_and_entities() -> None:
    spec = spec_of("public a() { @x = 0x7: READ(); }", "My__Robot-2.ul")
    assert design_name(spec) == "my_robot_2"
    files = generate_vhdl(spec)
    parts = ("build.sh", "config_pkg.vhd", "design.vhd", "top.vhd", "user_pkg.vhd")
    assert sorted(files) == [f"vhdl/my_robot_2_{part}" for part in parts]
    assert "entity my_robot_2_top is" in files["vhdl/my_robot_2_top.vhd"]


def test_comments_cannot_command_a_tool() -> None:
    text = 'public a() { @x = 0x7: READ(ID="synthesis translate_off"); @y = 0x8: READ(ID="pragma x"); }'
    for file in generate_vhdl(spec_of(text)).values():
        for comment in re.findall(r"--\s*(\w+)", file):
            assert comment not in ("synthesis", "pragma", "synopsys", "rtl_synthesis", "translate_off")


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"bench_memory": True}, "bench_memory is True; gateware has False"),
        ({"silent_ranges": ((1, 2),)}, "silent_ranges of a board configuration is for virtual boards"),
        ({"reply_max": 1000, "long_frames": True}, "reply_max is 1000; gateware has 250"),
        ({"address_bits": 4}, "x lies at 0x17; address_bits is 4"),
    ],
)
def test_what_the_gateware_has_not_is_refused(overrides: dict[str, Any], message: str) -> None:
    spec = spec_of("public a() { @x = 0x17: READ(); }")
    with pytest.raises(BindingError, match=message):
        generate_vhdl(spec, BoardConfiguration.for_spec(spec, **overrides))


def test_words_beside_a_component_do_not_overlap_it() -> None:
    """The words share a window of 64 addresses with the component, and stand on both sides of it."""
    spec = spec_of("public a() { @x = 0x0: READ(); @y = 0x1F: READ(); p: pwm() @ 0x8; }")
    design = generate_vhdl(spec)["vhdl/robot_design.vhd"]
    ranges = re.findall(r'=> \(base => x"(\w+)", words => (\d+)\)', design)
    assert [(int(base, 16), int(words)) for base, words in ranges] == [(0x0, 1), (0x1F, 1), (0x8, 6)]


STREAM = ("valid", "ready", "data")
QUEUES = """
public a(c,u) { MEMORY(CTRL=c, COMM=u); q: queue(); t: table(); @led = 0x0: WRITE(); }
queue() { FIFO(BASE=0x40, DEPTH=8); %s }
table() { DOUBLE_BUFFER(BASE=0x50, SIZE=5); %s }
"""


@pytest.mark.parametrize(
    ("members", "ports"),
    [
        (("@n = 0x0: READCLEAR();", "@v = 0x0: WRITE();"), {f"q_to_pc_{p}" for p in STREAM}),
        (("@n = 0x0: PULSE();", "@v = 0x0: WRITE();"), {f"q_from_pc_{p}" for p in STREAM}),
        (
            ("@n = 0x1: READ();", "@v = 0x0: READ();"),
            {f"t_user_write_{p}" for p in (*STREAM, "address")},
        ),
    ],
)
def test_a_queue_and_a_table_have_ports_for_what_the_spec_uses(
    members: tuple[str, str], ports: set[str]
) -> None:
    top = generate_vhdl(spec_of(QUEUES % members))["vhdl/robot_top.vhd"]
    entity = top[top.index("  port (") : top.index("end entity;")]
    always = {"t_committed", "t_user_read_address", "t_user_read_data"}
    assert set(re.findall(r"^    ([qt]_\w+) ", entity, re.M)) == ports | always


def test_what_a_queue_and_a_table_cannot_be() -> None:
    spec = spec_of(QUEUES % ("@n = 0x0: READCLEAR();", "@v = 0x0: WRITE();"))
    with pytest.raises(BindingError, match="the FIFOs and double buffers of a design are those of its spec"):
        generate_vhdl(spec, BoardConfiguration())
    spec = spec_of("public a() { DOUBLE_BUFFER(BASE=0x3B, SIZE=5); @v = 0x0: WRITE(); }")
    with pytest.raises(BindingError, match="a ends at 0x40; address_bits is 6"):
        generate_vhdl(spec, BoardConfiguration.for_spec(spec, address_bits=6))
    long = spec_of("public a() { FIFO(DEPTH=256); @n = 0x0: READCLEAR(); }")
    with pytest.raises(
        BindingError, match="a holds 256 words, a number that does not fit its words of 8 bits"
    ):
        generate_vhdl(long, BoardConfiguration.for_spec(long, data_bits=8))


def test_the_arrival_of_words_is_wired_up_inside() -> None:
    members = "@n = 0x0: READCLEAR(PUBLISH(on arrival)); @m = 0x1: READ(PUBLISH(on x));"
    text = f"public a() {{ FIFO(DEPTH=8); {members} }}"
    files = generate_vhdl(spec_of(text))
    assert "lines(0) <= arrival_line;" in files["vhdl/robot_design.vhd"]
    assert "arrival_event" not in files["vhdl/robot_config_pkg.vhd"]
    assert "x_event" in files["vhdl/robot_config_pkg.vhd"]


def test_one_event_of_a_component_may_publish_several_groups() -> None:
    text = """public a() {
       keys: gpio();
       @x = 0x10: READ(PUBLISH(on keys.changed, GROUP=one));
       @y = 0x11: READ(PUBLISH(on keys.changed, GROUP=two));
    }"""
    design = generate_vhdl(spec_of(text))["vhdl/robot_design.vhd"]
    assert design.count("changed => changed_line,") == design.count("signal changed_line :") == 1
    assert "lines(0) <= changed_line;" in design and "lines(1) <= changed_line;" in design


def test_the_users_logic_drives_a_value_that_is_published_on_change() -> None:
    text = "public a() { @x = 0x0: READWRITE(PUBLISH(on change)); }"
    with pytest.raises(BindingError, match="x is published on change, but your logic does not drive it"):
        generate_vhdl(spec_of(text))


@pytest.mark.parametrize("physical", SETTINGS["physical"].choices)
def test_the_command_makes_a_top_level_on_each_physical_layer(physical: str, tmp_path: Path) -> None:
    made = [str(SPECS[1]), "--out", str(tmp_path), "--only", "vhdl", "--physical", physical]
    assert CliRunner().invoke(command, made).exit_code == 0
    text = (tmp_path / "vhdl" / "servo_top.vhd").read_text(encoding="utf-8")
    name = "spi_slave" if physical == "spi" else physical
    entity = (ROOT / "gateware" / "physical" / f"{name}.vhd").read_text(encoding="utf-8")
    instance = text.partition(f"  {name} : entity unitylink.{name}\n")[2].partition(");")[0]
    ports = re.findall(r"^    (\w+) +: (?:in|out)", entity.partition("port (")[2], re.MULTILINE)
    assert [port for port in ports if f" {port} => " not in instance] == []
    assert CliRunner().invoke(command, [*made, "--check"]).exit_code == 0
    found = CliRunner().invoke(command, [*made, "--check", "--send-immediate", "never"])
    assert found.exit_code == (1 if "ft245" in physical else 0)


def test_the_spec_tells_the_physical_layer(tmp_path: Path) -> None:
    file = tmp_path / "elbow.ul"
    file.write_text("link elbow (PHYSICAL=rs485, NODE=7, BAUD=1 MHz); public elbow() { @x = 0x1: READ(); }")
    made = [str(file), "--out", str(tmp_path), "--only", "vhdl"]
    assert CliRunner().invoke(command, made).exit_code == 0
    top = (tmp_path / "vhdl" / "elbow_top.vhd").read_text(encoding="utf-8")
    assert "rs485_node : positive range 1 to 63 := 7;" in top and "baud_hz    : positive := 1000000;" in top
    numbers = (tmp_path / "vhdl" / "elbow_config_pkg.vhd").read_text(encoding="utf-8")
    assert "=> protocol_framed," in numbers  # no classic text goes over an RS-485 pair
    assert CliRunner().invoke(command, [*made, "--physical", "uart"]).exit_code == 0
    assert "entity unitylink.uart" in (tmp_path / "vhdl" / "elbow_top.vhd").read_text(encoding="utf-8")


def test_the_engine_of_the_design(tmp_path: Path) -> None:
    file = tmp_path / "lamp.ul"
    file.write_text("link lamp (ENGINE=small, BAUD=1 MHz); public lamp() { @x = 0x1: READ(); }")
    made = [str(file), "--out", str(tmp_path), "--only", "vhdl"]
    assert CliRunner().invoke(command, made).exit_code == 0

    def text(part: str) -> str:
        return (tmp_path / "vhdl" / f"lamp_{part}.vhd").read_text(encoding="utf-8")

    assert "engine      => unitylink.engine_pkg.engine_small," in text("design")
    assert "=> protocol_framed," in text("config_pkg")
    assert "assert clock_hz / 43 >= baud_hz / 10\n" in text("top")
    assert CliRunner().invoke(command, [*made, "--physical", "ft245_async"]).exit_code == 0
    assert "small engine" not in text("top"), "the design takes each byte when it can"
    assert CliRunner().invoke(command, [*made, "--engine", "fast"]).exit_code == 0
    assert "engine_fast" in text("design") and "=> protocol_both," in text("config_pkg")


def test_a_physical_layer_is_of_vhdl_only(tmp_path: Path) -> None:
    arguments = [str(SPECS[1]), "--out", str(tmp_path), "--physical"]
    found = CliRunner().invoke(command, [*arguments, "ft245_async"])
    assert found.exit_code == 2
    assert "--physical: only for VHDL; add --only vhdl" in found.output
    found = CliRunner().invoke(command, [*arguments, "usb", "--only", "vhdl"])
    assert isinstance(found.exception, ValueRangeError)


def component(entity: str, port: str) -> str:
    return (
        f'@component("{entity}") @pin("{port}", "out") own(): @base[1] {{ @x = base: WRITE(); }} '
        "public p() { slaves: own() @ 0x10; }"
    )


def test_a_port_has_no_name_that_the_design_uses() -> None:
    """The design has a signal slaves_m2s. Ports and signals share one region of names."""
    design = generate_vhdl(spec_of(component("own", "m2s"), "p.ul"))["vhdl/p_design.vhd"]
    assert re.search(r"^    slaves_m2s_2 +: out std_ulogic;$", design, re.MULTILINE)
    assert "m2s => slaves_m2s_2," in design


@pytest.mark.parametrize(("entity", "port"), [("process", "x"), ("own", "Signal")])
def test_no_entity_and_no_port_is_a_word_of_vhdl(entity: str, port: str) -> None:
    with pytest.raises(BindingError, match=r"vhdl: slaves: (process|Signal) is a keyword of VHDL or Verilog"):
        generate_vhdl(spec_of(component(entity, port), "p.ul"))
