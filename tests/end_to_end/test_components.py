# SPDX-License-Identifier: BSD-3-Clause
"""Components behave on the virtual boards, the twin and the compiled VHDL alike: words, pins, events, safe
state.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from unitylink import Link, connect
from unitylink.errors import LinkError, ValueRangeError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard
from unitylink.simulate.rtl.board import rtl_configuration
from unitylink.spec import Spec, compile_text

from .conftest import MUJOCO

TEXT = """
link cart (ADDRESS=8);
public cart() {
   wheel[2]: quadrature_encoder(rate=1 kHz, scale=2*pi/4096 rad, with_index=1);
   drive: pwm(channels=2, frequency_hz=5000);
   pad: gpio(pins=4, safe=5);
   spindle: three_phase_pwm(frequency_hz=5000);
   rotor: hall(scale=2*pi/42 rad);
   tip: biss_encoder(bits=16, scale=2*pi/65536 rad);
   @pressed = 0x0: u4 READ(PUBLISH(on pad.changed));
}
"""


@pytest.fixture
def spec() -> Spec:
    made = compile_text(TEXT, "cart.ul").spec
    assert made is not None
    return made


@pytest.fixture(params=[Board, RtlBoard])
def board(request: pytest.FixtureRequest, spec: Spec) -> Iterator[Board]:
    with request.param(spec, endpoint="tcp") as made:
        yield made


pytestmark = pytest.mark.xdist_group("rtl")


def until(true: Callable[[], bool]) -> None:
    end = time.monotonic() + 10
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def address(spec: Spec, path: str) -> int:
    return dict(spec.walk())[path].address


def test_a_shaft_turns_an_encoder(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        at = address(spec, "wheel[1].position")
        assert link.read(at) == 0
        board.components["wheel[1]"].turn(1000, 0.01)
        until(lambda: link.read(at) == 1000)
        board.components["wheel[1]"].turn(-3, 0.01)
        until(lambda: link.read(at) == (-3 & 0xFFFFFFFF))
        assert link.read(address(spec, "wheel[0].position")) == 0
        assert link.read(address(spec, "wheel[1].impossible")) == 0


def test_pulses_are_counted_and_timed() -> None:
    # A tick of 2**6 clocks is exact. One of 1 MHz is 0.021 % short, and 1000 would be 1001 at times.
    arguments = "time_hz=781250, timeout_ms=50, with_frequency=1"
    text = f"link c(ADDRESS=8); public c() {{ flow: pulse_counter({arguments}); }}"
    spec = compile_text(text, "c.ul").spec
    assert spec is not None
    with Board(spec, endpoint="tcp") as board, Link(board.url) as link:
        # four counts of an encoder are one pulse
        board.components["flow"].turn(4 * 200, seconds=0.256, lines=("line", "gate"))
        until(lambda: link.read(address(spec, "flow.frequency")) == 781.25 * 256)
        assert link.read(address(spec, "flow.period")) == 1000
        until(lambda: link.read(address(spec, "flow.count")) == 200)
        until(lambda: link.read(address(spec, "flow.period")) == 0)
        until(lambda: link.read(address(spec, "flow.frequency")) == 0)
        assert link.read(address(spec, "flow.stamp")) > 199_000


def test_pulses_come_as_many_as_asked_for() -> None:
    text = """
    link cell(ADDRESS=8);
    public cell() { pump: pulse_generator(maximum_hz=50000, scale=1/20000 l, rate=100 Hz); }
    """
    spec = compile_text(text, "cell.ul").spec
    assert spec is not None
    configuration = rtl_configuration(spec, clock_hz=2_000_000)
    for make in (Board, RtlBoard):
        with make(spec, configuration=configuration, endpoint="tcp") as board, Link(board.url) as link:
            robot = load_spec_objects(spec, link)
            pump = board.components["pump"]
            robot["pump.width"].write(100e-6)
            robot["pump.burst"].write(3)
            robot["pump.frequency"].write(0.1)  # l/s: 2000 pulses per second
            robot["pump.to_go"].write(40)
            until(lambda: robot["pump.pulses"].read() == pytest.approx(2e-3))  # noqa: B023
            until(lambda: not robot["pump.state"].read().running)  # noqa: B023
            assert pump.rises("line") == 40
            assert pump.pulse_s("line") == pytest.approx(100e-6)
            pump.drive("trigger", True)
            until(lambda: pump.rises("line") == 43)  # noqa: B023

            robot["pump.burst"].write(0)
            until(lambda: pump.rises("line") > 60)  # noqa: B023
            pump.drive("stop", True)
            until(lambda: robot["pump.state"].read().stopped)  # noqa: B023
            stopped = pump.rises("line")
            robot["pump.frequency"].write(0.1)
            assert not robot["pump.state"].read().running and pump.rises("line") == stopped
            pump.drive("stop", False)
            with pytest.raises(ValueRangeError):
                robot["pump.frequency"].write(2.6)
            robot["pump.frequency"].write(2.5)
            until(lambda: pump.rises("line") > stopped)  # noqa: B023
            robot["pump.frequency"].write(0.0)
            until(lambda: not robot["pump.state"].read().running)  # noqa: B023


def test_an_index_comes_once_a_turn(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        board.components["wheel[0]"].turn(350, 0.01, per_turn=100)
        count = address(spec, "wheel[0].index_count")
        until(lambda: link.read(count) == 3)
        assert link.read(address(spec, "wheel[0].index_position")) == 300


def test_pulse_width_is_seen_at_the_pins(spec: Spec, board: Board) -> None:
    drive = board.components["drive"]
    with Link(board.url) as link:
        assert drive.duty("pins", 1) == 0
        link.write(address(spec, "drive.width[1]"), 1024)
        link.write(address(spec, "drive.control"), 1)
        until(lambda: drive.rises("pins", 1) > 50)
        drive.duty("pins", 1)
        until(lambda: drive.rises("pins", 1) > 500)
        assert drive.duty("pins", 1) == pytest.approx(0.25, rel=0.02)
        assert drive.rises("pins", 0) == 0
        width_s = 0.25 / 5_000
        until(lambda: (drive.pulse_s("pins", 1) or 0) == pytest.approx(width_s))


def test_a_changed_pin_publishes(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        seen: list[object] = []
        robot = load_spec_objects(spec, link)
        robot["pressed"].on_publish(lambda _time, value: seen.append(value))
        link.write(address(spec, "pad.watch"), 0b0100)
        board.components["pad"].drive("pin_in", True, 2)
        until(lambda: len(seen) == 1)
        assert link.read(address(spec, "pad.levels")) == 0b0100
        board.components["pad"].drive("pin_in", True, 1)  # nobody watches it
        until(lambda: link.read(address(spec, "pad.levels")) == 0b0110)
        assert len(seen) == 1
        robot.stop_publishing()


def test_a_driven_pin_reads_its_output(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        link.write(address(spec, "pad.direction"), 0b0011)
        link.write(address(spec, "pad.set"), 0b0110)
        until(lambda: link.read(address(spec, "pad.levels")) == 0b0010)
        assert board.components["pad"].level("pin_out", 2)
        assert not board.components["pad"].level("pin_drive", 2)


def test_positions_are_published_in_radians(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        robot = load_spec_objects(spec, link)
        seen: list[float] = []
        robot["wheel[0].position"].on_publish(lambda _time, value: seen.append(value))
        board.components["wheel[0]"].turn(1024, 0.02)
        until(lambda: bool(seen) and seen[-1] == pytest.approx(math.pi / 2))
        robot.stop_publishing()
    between = [value for value in seen if 0 < value < 1.5]
    assert between and between == sorted(between)


def test_the_dead_man_reaches_the_pins(spec: Spec, board: Board) -> None:
    pad, drive = board.components["pad"], board.components["drive"]
    link = Link(f"{board.url}?protocol=framed&deadman=1")  # longer than a busy machine pauses
    link.write(address(spec, "pad.outputs"), 0b1010)
    link.write(address(spec, "drive.width[0]"), 1000)
    link.write(address(spec, "drive.control"), 1)
    until(lambda: drive.level("pins", 0))
    assert [pad.level("pin_out", bit) for bit in range(4)] == [False, True, False, True]
    board.hang_up()
    until(lambda: not drive.level("pins", 0))
    until(lambda: [pad.level("pin_out", bit) for bit in range(4)] == [True, False, True, False])  # safe=5
    link.close()


def test_a_plant_cannot_set_what_a_component_sets(spec: Spec, board: Board) -> None:
    with pytest.raises(ValueRangeError, match="belongs to the PC or to a component"):
        board.registers[address(spec, "wheel[0].position")] = 1


def test_mistakes_with_pins_are_told(board: Board) -> None:
    with pytest.raises(ValueRangeError, match=r"no component 'wheels'; there are wheel\[0\], wheel"):
        board.components["wheels"]
    with pytest.raises(ValueRangeError, match="drive has no output 'pin'; there are pins"):
        board.components["drive"].level("pin")
    with pytest.raises(ValueRangeError, match="drive has no input 'pins'; there are none"):
        board.components["drive"].drive("pins", True)
    with pytest.raises(ValueRangeError, match=r"drive.pins has 2 pins: choose bit 0 to 1, not 2"):
        board.components["drive"].level("pins", 2)


MODEL = """
<mujoco>
  <option timestep="0.001" integrator="implicitfast"/>
  <worldbody><body><joint name="arm" type="hinge" axis="0 0 1"/>
    <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/></body>
    <body pos="0 0 1"><joint name="spindle" type="hinge" axis="0 0 1"/>
    <inertial pos="0 0 0" mass="1" diaginertia="5e-4 5e-4 5e-4"/></body></worldbody>
</mujoco>
"""
MAP = """
model = "cart.xml"
[values]
"drive" = {joint = "arm", motor = "maxon RE 30", ratio = 20, supply_v = 24, reverse_channel = 1}
"wheel[1]" = {joint = "arm"}
"spindle" = {motor = "GBM2804H-100T", supply_v = 12}
"rotor" = {joint = "spindle"}
"tip" = {joint = "arm", sign = -1}
"pad" = {joint = "arm", channel = 2, above = 30, unit = "deg"}
"""


@MUJOCO
@pytest.mark.parametrize("scheme", ["sim", "rtl"])
def test_joints_of_mujoco_are_turned_by_pins_and_safe_when_their_model_fails(
    scheme: str, spec: Spec, tmp_path: Path
) -> None:
    for name, text in (("cart.ul", TEXT), ("cart.xml", MODEL), ("cart.toml", MAP)):
        (tmp_path / name).write_text(text)
    file = tmp_path / "cart.ul"
    url = f"{scheme}:{file}?plant=mujoco:{tmp_path / 'cart.toml'}&protocol=framed&deadman=0.02"
    with connect(url, time="lockstep") as link, connect(f"sim:{file}", time="lockstep") as other:
        robot, board = load_spec_objects(spec, link), link.board
        robot["pad.outputs"].write(0b1010)
        robot["drive.width[0]"].write(1.0)
        robot["drive.control"].write({"enable": True})
        link.step(0.15)
        turned = board.plant.data.qpos[0]
        assert 0.6 < turned < 3.0
        assert robot["wheel[1].position"].read() == pytest.approx(turned, abs=0.03)
        assert robot["wheel[0].position"].read() == 0.0
        assert robot["tip.position"].read() == pytest.approx(-turned, abs=0.03)
        assert robot["tip.failures"].read() == 0
        assert robot["pad.levels"].read() == 0b0100

        # a field that turns takes the brushless motor along
        robot["spindle.control"].write({"enable": True, "sample_start": False, "sample_middle": False})
        for number in range(16):
            for phase in range(3):
                turn = math.pi / 12 * number - 2 * math.pi / 3 * phase
                robot[f"spindle.duty[{phase}]"].write(0.8 * math.cos(turn))
            link.step(0.01)
        turned = board.plant.data.joint("spindle").qpos[0]
        assert turned == pytest.approx(math.pi / 12 * 16 / 7, abs=0.2)
        assert robot["rotor.position"].read() == pytest.approx(turned, abs=2 * math.pi / 42)

        board.plant.data.qvel[0] = 1e12
        if scheme == "rtl":
            with pytest.raises(LinkError):
                link.step(0.01)
            other.step(0.03)  # all boards share their time, and nobody talks to this one
        else:
            link.step(0.01)
        assert re.search(r"unstable at 0\.3\d* s, first at joint 'arm'", str(board.error))
        assert not board.components["drive"].level("pins", 0)
        gates = [board.components["spindle"].level(side, n) for side in ("high", "low") for n in range(3)]
        assert not any(gates)
        outputs = [board.components["pad"].level("pin_out", bit) for bit in range(4)]
        assert outputs == [True, False, True, False]  # safe=5
