# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink import FILE.json`: configurations become specs, and nothing is lost silently."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

from unitylink import cli, connect
from unitylink.boards import load_board
from unitylink.boards.pins import Pinout, assign_pins, lines_of
from unitylink.commands.failure import Failure
from unitylink.commands.riocore import import_riocore
from unitylink.errors import BoardError
from unitylink.gateware import Port
from unitylink.generate import SpecPlan
from unitylink.generate.vhdl import plan_designs
from unitylink.spec import Spec, compile_text, format_text

FILES = Path(__file__).parent / "riocore"
NAMES = ("cart", "lathe", "mill")


def spec_of(text: str) -> Spec:
    result = compile_text(text, "x.ul")
    assert result.spec is not None
    assert not result.diagnostics, "an imported spec compiles without a remark"
    return result.spec


def options(build: str) -> list[str]:
    words = shlex.split(build)
    return [words[i + 1] for i, word in enumerate(words) if word == "--pin"]


def pinout(text: str, build: str) -> Pinout:
    """Return what `unitylink build` makes of the options: ports of the design, and words at pins."""
    (design,) = SpecPlan(spec_of(text)).part(plan_designs)
    ports = [Port(p.name, p.direction == "in", _bits(str(p.type))) for p in design.pins]
    ports += [Port(leaf.path, True, 1) for leaf in design.to_pc.leaves if "." not in leaf.path]
    ports += [Port(leaf.path, False, 1) for leaf in design.from_pc.leaves if "." not in leaf.path]
    return assign_pins(load_board("icebreaker"), lines_of(ports), options(build))


def _bits(kind: str) -> int:
    found = re.search(r"\((\d+) downto 0\)", kind)
    return int(found[1]) + 1 if found else 1


@pytest.mark.parametrize("name", NAMES)
def test_a_configuration_becomes_a_spec(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["import", str(FILES / f"{name}.json"), "--out", f"{name}.ul"]) == 0
    said = capsys.readouterr()
    text = Path(f"{name}.ul").read_text("utf-8")
    spec_of(text)
    assert format_text(text, f"{name}.ul") == text
    assert cli.main(["check", f"{name}.ul"]) == 0
    assert cli.main(["generate", f"{name}.ul", "--out", "made"]) == 0
    with connect(f"sim:{name}.ul") as link:
        assert link.read(0) == 0
    capsys.readouterr()
    assert ("build it with: unitylink build" in said.out) == (name != "lathe")
    assert cli.main(["import", str(FILES / f"{name}.json"), "--out", f"{name}.ul"]) == 1
    assert f"{name}.ul exists" in capsys.readouterr().err


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_left_out_silently(name: str) -> None:
    """Each plugin gives a member of the spec or a note. So do its connections."""
    made = import_riocore(str(FILES / f"{name}.json"))
    told = "\n".join(made.notes)
    text = re.sub(r"[^a-z0-9]", "", made.text.lower())
    for number, plugin in enumerate(json.loads((FILES / f"{name}.json").read_text())["plugins"]):
        called = re.sub(r"[^a-z0-9]", "", plugin.get("name", f"stepdir{number}").lower())
        absorbed = f"plugins[{number}].signals.bit.net" not in told and plugin["type"] == "bitin"
        assert plugin["type"] == "fpga" or f"plugins[{number}] (" in told or called in text or absorbed, (
            plugin
        )
        for signal, node in plugin.get("signals", {}).items():
            switch = name == "mill" and plugin["type"] == "bitin"
            left = f"plugins[{number}]"
            assert switch or f"{left}.signals.{signal}.net" in told or f"{left} (" in told, node


def test_the_mill() -> None:
    made = import_riocore(str(FILES / "mill.json"), out="x/mill.ul")
    spec = spec_of(made.text)
    items = dict(spec.walk())
    assert (
        items["motors.target[1]"].scale == pytest.approx(1 / 640) and items["motors.target[1]"].unit == "mm"
    )
    assert items["column.target[0]"].scale == pytest.approx(-1 / 1600), "its direction is inverted"
    assert items["column.speed[0]"].scale > 0, "a limit of the speed has no direction"
    # `onerror` gives 0 at the pin. Our board inverts that pin, so the word is 1, which is off.
    assert items["coolant"].safe == 1 and items["coolant"].type.name == "inverted"
    # its enable is on at 1, and inverted twice: by `invert`, and `onerror` with `invert` then gives 1
    assert items["column_enable"].safe == 1 and items["column_enable"].type.name == "inverted"
    assert "axis 1 is tableY: at most 32000 count/s, 320000 count/s^2" in made.text
    pins = pinout(made.text, made.build)
    found = {name: [pin and pin.name for pin in row] for name, row in pins.pins.items()}
    assert found["motors_step"] == ["P1A1", "P1A3"] and found["motors_direction"] == ["P1A2", "P1A4"]
    assert found["motors_home"] == ["P1B1", None] and found["motors_limit_low"] == [None, "P1B2"]
    assert found["coolant"] == ["LEDG_N"] and found["column_stop"] == [None]
    assert made.build.startswith("unitylink build mill.ul --board icebreaker --pin ")
    assert made.notes[0].startswith("plugins[0] (w5500 net): left out: the gateware has no Ethernet")
    assert any(
        "plugins[3].joint.max_velocity: 3200000 count/s is more than the 1048575" in one for one in made.notes
    )
    assert any("plugins[6].pins.bit.modifier[0]: debounce" in one for one in made.notes)


@pytest.mark.parametrize(("scale", "inverted"), [(320, False), (320, True), (-320, False), (-320, True)])
def test_the_switches_of_a_reversed_axis_stop_it_where_they_are(
    tmp_path: Path, scale: int, inverted: bool
) -> None:
    """stepgen knows no mm: its `limit_low` is the switch towards which `direction` is low."""
    turn = {"modifier": [{"type": "invert"}]} if inverted else {}
    slide = {"type": "stepdir", "name": "slide", "axis": "X", "is_joint": True, "joint": {"scale": scale}}
    slide["pins"] = {"step": {"pin": "PMOD1A:P1"}, "dir": {"pin": "PMOD1A:P2", **turn}}
    low, high = (
        {"type": "bitin", "name": f"{name}_end", "pins": {"bit": {"pin": pin}}}
        | {"signals": {"bit": {"net": f"joint.0.{name}-lim-sw-in"}}}
        for name, pin in (("neg", "PMOD1B:P1"), ("pos", "PMOD1B:P2"))
    )
    file = tmp_path / "slide.json"
    file.write_text(json.dumps({"boardcfg": "ICEBreakerV1.0e", "plugins": [slide, low, high]}))
    made = import_riocore(str(file))
    items = dict(spec_of(made.text).walk())
    turned = items["slide.target[0]"].scale < 0
    assert turned == ((scale < 0) != inverted)
    assert items["slide.speed[0]"].scale > 0 and items["slide.acceleration[0]"].scale > 0
    assert f"--pin slide_limit_low={'P1B2' if turned else 'P1B1'} " in made.build
    assert f"--pin slide_limit_high={'P1B1' if turned else 'P1B2'} " in made.build


def test_the_cart() -> None:
    made = import_riocore(str(FILES / "cart.json"))
    items = dict(spec_of(made.text).walk())
    assert items["left_wheel.position"].scale == -1, "one of its lines is inverted"
    assert items["right_wheel.position"].scale == 0.25
    assert made.text.count("with_index=1") == 1, "of the one with z"
    assert items["servos.width[1]"].maximum == 2500
    # 0 lights the lamp, on the board and by `invert`: so 1 lights it. The button reads 0 when pressed.
    assert items["lamp"].type.kind == "bool" and items["bumper"].type.name == "inverted"
    pins = pinout(made.text, made.build)
    found = {name: [pin and pin.name for pin in row] for name, row in pins.pins.items()}
    assert found["left_pins"] == ["P1A1", "P1A2", None, None] and found["left_fault"] == [None]
    assert found["left_enable"] == ["P1A3"], "through the breakout board"
    assert found["left_wheel_index"] == ["P1B3"] and found["right_wheel_index"] == [None]
    assert found["bumper"] == ["BTN_N"] and found["lamp"] == ["LEDR_N"]


def test_the_lathe_is_on_no_board_of_ours() -> None:
    made = import_riocore(str(FILES / "lathe.json"))
    items = dict(spec_of(made.text).walk())
    assert items["cross.target[0]"].scale == pytest.approx(-25.4 / 5080.5), "inches become mm"
    assert items["chuck.target[0]"].unit == "deg" and items["stepdir1.target[0]"].unit == "count"
    assert {"signal_pin", "e_stop", "e_stop_2"} <= set(items)
    assert made.build == "" and "// stepdir1_direction is 33\n" in made.text
    assert any("boardcfg = 'TangNano9K': no board of ours" in one for one in made.notes)
    assert any(one.startswith("modules: wiring that is not in this file") for one in made.notes)
    assert not any("_note" in one for one in made.notes), "riocore ignores such keys"
    elsewhere = import_riocore(str(FILES / "lathe.json"), "icebreaker")
    assert "--board icebreaker" in elsewhere.build and "chuck_step=LED3" in elsewhere.build  # its pin 25
    assert any("J1:STEP: say --pin cross_step=PIN" in one for one in elsewhere.notes)
    with pytest.raises(BoardError, match="no board is called 'icebraker'"):
        import_riocore(str(FILES / "lathe.json"), "icebraker")


def test_polarity_of_an_output(tmp_path: Path) -> None:
    """The word is the level of the pin. SAFE is what `onerror` holds the pin at, and otherwise off."""
    error, turned, high = {"type": "onerror"}, {"type": "invert"}, {"type": "onerror", "invert": True}
    pipelines: list[tuple[list[Any], int]] = [
        ([], 0),
        ([turned], 1),
        ([error], 0),
        ([high], 1),
        ([turned, error], 0),
        ([error, turned], 1),
        ([turned, error, turned], 1),
    ]
    outputs = [
        {"type": "bitout", "name": f"out{i}", "pins": {"bit": {"pin": str(i), "modifier": told}}}
        for i, (told, _) in enumerate(pipelines)
    ]
    items = dict(spec_of(importing(tmp_path, {"plugins": outputs}).text).walk())
    for number, (told, safe) in enumerate(pipelines):
        assert items[f"out{number}"].safe == safe, told
        assert (items[f"out{number}"].type.kind == "enum") == (told.count(turned) == 1)


def test_an_encoder_with_two_inverted_lines_keeps_its_direction(tmp_path: Path) -> None:
    lines = {line: {"pin": line, "modifier": [{"type": "invert"}]} for line in "ab"}
    made = importing(tmp_path, {"plugins": [{"type": "quadencoder", "name": "e", "pins": lines}]})
    assert dict(spec_of(made.text).walk())["e.position"].scale == 0.25


def test_a_switch_of_a_joint_that_is_not_certain_stays_a_word(tmp_path: Path) -> None:
    joints = [{**STEP, "name": axis, "axis": axis, "is_joint": True} for axis in "ZX"]
    switch = {
        "type": "bitin",
        "name": "home",
        "pins": {"bit": "9"},
        "signals": {"bit": {"net": "joint.0.home-sw-in"}},
    }
    made = importing(tmp_path, {"plugins": [*joints, switch]})
    assert "@home = 0x0: bool READ" in made.text
    assert any("plugins[2] (bitin home): joint 0 is not certain" in one for one in made.notes)


def test_the_example_of_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    page = (Path(__file__).resolve().parents[3] / "docs" / "import-riocore.md").read_text("utf-8")
    told, note, spec = (re.findall(rf"```{kind}\n(.*?)```", page, re.S)[0] for kind in ("json", "text", "ul"))
    monkeypatch.chdir(tmp_path)
    Path("slide.json").write_text(told, "utf-8")
    assert cli.main(["import", "slide.json"]) == 0
    assert capfd.readouterr() == (spec, note)
    Path("slide.ul").write_text(spec, "utf-8")
    (command,) = re.findall(r"^unitylink (write .*)$", page, re.M)
    assert cli.main(shlex.split(command)) == 0


def test_many_inputs_and_axes_compile(tmp_path: Path) -> None:
    steppers = [{"type": "stepdir", "pins": {"step": f"S{i}", "dir": f"D{i}"}} for i in range(17)]
    inputs = [{"type": "bitin", "name": "öffner", "pins": {"bit": f"I{i}"}} for i in range(70)]
    made = importing(tmp_path, {"plugins": [*steppers, *inputs]})
    spec = spec_of(made.text)
    assert sum(one.component is not None for one in spec.root().instances) == 5
    assert "axes=4" in made.text, "a board that we do not know may have a slow clock"
    assert "ADDRESS=16" in made.text
    fast = import_riocore(str(tmp_path / "robot.json"), "ice40-hx8k")
    assert fast.text.count("axes=8") == 2


DEVICES: list[tuple[dict[str, Any], str, dict[str, str], str]] = [  # plugin, line, pins, note
    (
        {"type": "sonar", "pins": {"trigger": "PMOD1A:P1", "echo": "PMOD1A:P2"}},
        "sonar(scale=0.01715 cm, rate=10 Hz)",
        {"trigger": "P1A1", "echo": "P1A2"},
        "",
    ),
    (
        {"type": "hx711", "scale": 0.5, "pins": {"miso": "PMOD1A:P1", "sclk": "PMOD1A:P2"}},
        "hx711(rate=10 Hz)",
        {"dout": "P1A1", "sck": "P1A2"},
        "plugins[0].scale = 0.5: hx711 has counts of 24 bits",
    ),
    (
        {"type": "hx711", "mode": "CHB_32", "zero": 0, "pins": {"miso": "PMOD1A:P1", "sclk": "PMOD1A:P2"}},
        "hx711(rate=10 Hz)",
        {"dout": "P1A1", "sck": "P1A2"},
        "plugins[0].mode = CHB_32: hx711 begins with a_128",
    ),
    ({"type": "ds18b20", "pins": {"one_wire": "PMOD1A:P1"}}, "one_wire(rate=1 Hz)", {"line": "P1A1"}, ""),
    (
        {"type": "wled", "leds": 12, "level": 100, "pins": {"data": "PMOD1A:P1"}},
        "ws2812(leds=12)",
        {"data": "P1A1"},
        "plugins[0].level = 100: a colour has its brightness",
    ),
    ({"type": "ws2812b", "pins": {"data": "PMOD1A:P1"}}, "ws2812(leds=1)", {"data": "P1A1"}, ""),
    (
        {"type": "pdmout", "resolution": 20, "pins": {"pdm": "PMOD1A:P1"}},
        "pdm(channels=1, bits=16)",
        {"pins": "P1A1"},
        "plugins[0].resolution = 20: pdm has 16 at most",
    ),
    (
        {"type": "freqout", "pins": {"freq": {"pin": "PMOD1A:P1", "modifiers": [{"type": "invert"}]}}},
        "pulse_generator(maximum_hz=1000000, active_level=0)",
        {"line": "P1A1", "trigger": "-", "stop": "-"},
        "",
    ),
    (
        {"type": "freqin", "freq_min": 1, "pins": {"freq": "PMOD1A:P1"}},
        "pulse_counter(timeout_ms=500, with_frequency=1, rate=10 Hz)",
        {"line": "P1A1", "gate": "-"},
        "plugins[0].freq_min = 1: pulse_counter waits 500 ms at most",
    ),
]


@pytest.mark.parametrize(("plugin", "line", "pins", "note"), DEVICES)
def test_a_device_becomes_its_component(
    tmp_path: Path, plugin: dict[str, Any], line: str, pins: dict[str, str], note: str
) -> None:
    named = {**plugin, "name": "it"}
    made = importing(tmp_path, {"boardcfg": "ICEBreakerV1.0e", "plugins": [named]})
    assert f"\n   it: {line};\n" in made.text
    assert sorted(options(made.build)) == sorted(f"it_{port}={pin}" for port, pin in pins.items())
    told = pinout(made.text, made.build).pins.values()
    assert sorted(pin.name for row in told for pin in row if pin) == sorted(set(pins.values()) - {"-"})
    assert [one[: len(note)] for one in made.notes] == ([note] if note else []), "all else is taken"
    without = importing(tmp_path, {"plugins": [{**named, "pins": {}}]})
    assert [one for one in without.notes if "(" + plugin["type"] + " it): left out: it has no pin" in one]


def test_channels_of_pdm_are_as_many_as_the_clock_allows(tmp_path: Path) -> None:
    rows = [{"type": "pdmout", "pins": {"pdm": f"P{i}", "en": f"E{i}"}} for i in range(20)]
    told = {"plugins": [*rows, {**rows[0], "resolution": 12}]}
    made = importing(tmp_path, told)
    assert re.findall(r"pdm\((.+?)\)", made.text) == [
        *["channels=8, bits=8"] * 2,
        "channels=4, bits=8",
        "channels=1, bits=12",
    ]
    assert made.text.count("bool WRITE(SAFE=0)") == 21, "their enables"
    slow = import_riocore(str(tmp_path / "robot.json"), "icebreaker")
    clock_hz = load_board("icebreaker").design_hz
    (most, *_) = re.findall(r"pdm\(channels=(\d+)", slow.text)
    assert (2 * int(most) - 1) * 1_000_000 < clock_hz, "what pdm.ul says of the clock"


STEP = {"type": "stepdir", "pins": {"step": "4", "dir": "2"}}
WRONG: list[tuple[Any, str]] = [
    ([], "the file: an object { } is expected"),
    ({"boards": []}, "the file: a configuration of riocore has plugins"),
    ({"plugins": {"a": 1}}, "plugins: a list [ ] is expected"),
    ({"plugins": [3]}, "plugins[0]: an object { } is expected, not 3"),
    ({"plugins": [{"pins": {}}]}, "plugins[0]: a plugin has a type"),
    ({"plugins": [{"type": ["x"]}]}, "plugins[0].type: a text is expected"),
    ({"plugins": [{**STEP, "pins": [1]}]}, "plugins[0].pins: an object { } is expected"),
    (
        {"plugins": [{**STEP, "pins": {"step": {"pin": True}}}]},
        "plugins[0].pins.step.pin: a text is expected",
    ),
    (
        {"plugins": [{**STEP, "pins": {"step": {"pin": "1", "modifier": 5}}}]},
        "plugins[0].pins.step.modifier: a list",
    ),
    ({"plugins": [{**STEP, "is_joint": "yes"}]}, "plugins[0].is_joint: true or false is expected"),
    ({"plugins": [{**STEP, "joint": {"scale": "fast"}}]}, "plugins[0].joint.scale: a number is expected"),
    ({"plugins": [{**STEP, "joint": {"scale": 0}}]}, "plugins[0].joint.scale: steps per unit"),
    ({"plugins": [{"type": "hbridge", "frequency": 2.5}]}, "plugins[0].frequency: a whole number from 10"),
    (
        {"plugins": [{"type": "quadencoder", "quad_type": 9}]},
        "plugins[0].quad_type: a whole number from 0 to 4",
    ),
    ({"plugins": [{**STEP, "signals": {"velocity": 1}}]}, "plugins[0].signals.velocity: an object"),
    (
        {"plugins": [{"type": "wled", "leds": 0, "pins": {"data": "1"}}]},
        "plugins[0].leds: a whole number from 1",
    ),
    (
        {"plugins": [{"type": "pdmout", "resolution": 7, "pins": {"pdm": "1"}}]},
        "plugins[0].resolution: a whole number from 8 to 32",
    ),
    (
        {"boardcfg": "ICEBreakerV1.0e", "plugins": [STEP, STEP]},
        "plugins[1].pins.step: 4 is taken by plugins[0].pins.step",
    ),
]


def importing(folder: Path, told: Any) -> Any:
    file = folder / "robot.json"
    file.write_text(told if isinstance(told, str) else json.dumps(told), "utf-8")
    return import_riocore(str(file))


@pytest.mark.parametrize(("told", "message"), WRONG)
def test_a_mistake_is_named_with_its_place(tmp_path: Path, told: Any, message: str) -> None:
    with pytest.raises(Failure, match=re.escape(f"robot.json: {message}")):
        importing(tmp_path, told)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"plugins":\n [}', "robot.json:2:3: no JSON: Expecting value"),
        ('{"plugins": [], "plugins": []}', "'plugins' stands twice in one object"),
        ('{"plugins": [NaN]}', "NaN is no number of JSON"),
        ('{"plugins": ' + "[" * 100_000, "nested too deeply"),
        ('{"plugins": [' + "9" * 5000 + "]}", "robot.json: "),
    ],
)
def test_what_is_no_json_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(Failure, match=re.escape(message)):
        importing(tmp_path, text)


def test_wrong_usage_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["import", str(FILES / "mill.json"), "--top", "mill"]) == 2
    assert "--top and --include are for SystemRDL" in capsys.readouterr().err
    assert cli.main(["import", "x.rdl", "--board", "icebreaker"]) == 2
    assert "--board is for a configuration of riocore" in capsys.readouterr().err
    assert cli.main(["import", str(tmp_path / "none.json")]) == 1
    assert "none.json: No such file" in capsys.readouterr().err
    (tmp_path / "latin.json").write_bytes(b'{"name": "\xe4"}')
    assert cli.main(["import", str(tmp_path / "latin.json")]) == 1
    assert "byte 10 is not UTF-8" in capsys.readouterr().err
