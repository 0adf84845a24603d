# SPDX-License-Identifier: BSD-3-Clause
"""Models run no clock while nothing happens, and nobody can tell that from outside."""

from __future__ import annotations

import dataclasses
import random
import time
from pathlib import Path

import pytest

from unitylink import _native, connect
from unitylink._native import Device
from unitylink.interface.components import components_of
from unitylink.simulate import BoardConfiguration
from unitylink.spec import compile_text

CONTROL, TARGET, SPEED, ACCELERATION, VELOCITY_TARGET, STATUS, LATCHED, STAMP = 0, 1, 2, 3, 4, 7, 8, 9
ENABLE_AND_LATCH_HOME = 0b11001
CLOCK_HZ = 50_000_000
REST = 400_000  # clocks: several cycles of base periods and ramps

Stimuli = list[tuple[int, str, int, int]]


def stimuli(axes: int, draw: random.Random) -> tuple[Stimuli, int]:
    """Let axis 0 go somewhere, rest, be looked at, latch, and go back; the end is the second value."""
    found: Stimuli = []
    clock = 1000
    writes = ((SPEED, 20_000 * 256), (ACCELERATION, 8000), (CONTROL, ENABLE_AND_LATCH_HOME), (TARGET, 7))
    for word, value in writes:
        found.append((clock, "w", word, value))
        clock += 1000
    for number in range(3):
        clock += REST + draw.randrange(5000)
        found += [(clock + 200 * word, "r", word, 0) for word in range(11)]
        clock += 3000
        home = 2 * axes
        found += [(clock, "p", home, 1), (clock + 900, "p", home, 0)]
        clock += REST + draw.randrange(5000)
        found += [(clock, "r", LATCHED, 0), (clock + 200, "r", STAMP, 0)]
        found += [(clock + 400, "w", CONTROL, ENABLE_AND_LATCH_HOME), (clock + 600, "w", TARGET, 3 * number)]
    return found, clock + REST


@pytest.mark.parametrize(("axes", "clock_hz"), [(1, 8_000_000), (3, 20_000_000), (4, 1 << 25)])
def test_a_rest_that_is_not_run_is_as_one_that_is(axes: int, clock_hz: int) -> None:
    text = f"link l(ADDRESS=8); public a() {{ m: stepgen(axes={axes}, stable_clocks=4); }}"
    spec = compile_text(text).spec
    assert spec is not None
    (one,) = components_of(spec, clock_hz)
    told, end = stimuli(axes, random.Random(axes))
    stop = 3 * axes
    # an input that is high for one clock goes nowhere, but the model cannot rest meanwhile
    glitches = [(at + late, "p", stop, 1 - late) for at in range(500, end, 4000) for late in (0, 1)]
    run = sorted([*told, *glitches], key=lambda change: change[0])
    seen = _native.ComponentModel(one).play(told, end)
    assert seen == _native.ComponentModel(one).play(run, end)
    answers = [value for _, what, _, value in seen if what == "a"]
    assert any(answers) and len([one for one in seen if one[1] == "o"]) > 10, "it has moved"


def journey(axes: int, draw: random.Random, end: int) -> Stimuli:
    """Let all axes run, mostly by their velocity, and now and then read, halt, latch, shift and turn back."""
    found: Stimuli = []
    most = draw.choice((150_000, 1_000_000)) * 256  # the second is too fast for some pulses
    controls = (3, 3, 3, 1, 0, 7, 0b11011)

    def velocity() -> int:
        return draw.choice((1, -1, 0)) * draw.randrange(most) & 0xFFFFFFFF

    for number in range(5 * axes):
        axis, word = number // 5, number % 5
        control = draw.choice(controls) if axis else 3
        first = velocity() if axis else most // 2
        value = (control, 500, most, draw.choice((200, 15_625, 500_000)), first)[word]
        found.append((2000 + 400 * number, "w", 16 * axis + word, value))
    at = 2000 + 2000 * axes
    while at < end:
        at += draw.choice((500, 5000, 50_000, 300_000)) + draw.randrange(3000)
        base = 16 * draw.randrange(axes)
        found.append(
            draw.choice(
                [(at, "r", base + word, 0) for word in range(10)]
                + 6 * [(at, "w", base + 4, velocity())]
                + 2 * [(at, "p", draw.randrange(3 * axes + 1), draw.randrange(2))]
                + [(at, "w", base, draw.choice(controls)), (at, "w", base + 10, 3)]
            )
        )
    return found


@pytest.mark.parametrize(
    ("axes", "clock_hz"),
    [(1, 25_000_000), (2, 12_000_003), (3, 48_000_000), (5, 50_000_000), (8, 50_000_000)],
)
@pytest.mark.parametrize("hears", [False, True])
def test_steps_that_are_played_at_once_are_those_of_each_clock(axes: int, clock_hz: int, hears: bool) -> None:
    text = f"link l(ADDRESS=8); public a() {{ m: stepgen(axes={axes}); }}"
    spec = compile_text(text).spec
    assert spec is not None
    (one,) = components_of(spec, clock_hz)
    one = dataclasses.replace(one, event_groups=(0,) if hears else (None,))
    told, end = journey(axes, random.Random(20 + axes), 1_500_000), 2_000_000
    seen = _native.ComponentModel(one).play(told, end)
    assert sorted(_native.ComponentModel(one).play(told, end, late=True)) == sorted(seen)
    assert sum(what == "o" for _, what, _, _ in seen) > 500, "it has moved"


def test_an_axis_that_moves_is_computed_while_nobody_looks() -> None:
    text = "link l(ADDRESS=8); public a() { m: stepgen(); }"
    spec = compile_text(text).spec
    assert spec is not None
    parts = components_of(spec, CLOCK_HZ)
    device = Device(BoardConfiguration(address_bits=16, publish_mode=0, clock_hz=CLOCK_HZ, components=parts))
    device.run_until(4 * CLOCK_HZ)
    assert device.next_event is None, "it rests"
    for word, value in ((SPEED, 20_000 * 256), (ACCELERATION, 8000), (4, 20_000 * 256), (CONTROL, 3)):
        device.receive(b"#W:%04X%08X\n" % (word, value))
    for second in range(5, 9):
        device.run_until(second * CLOCK_HZ)
        assert device.next_event is not None
        assert device.clock < device.next_event <= device.clock + CLOCK_HZ // 20, "it lags by less than 50 ms"


def test_an_axis_that_rests_for_an_hour_costs_nothing(tmp_path: Path) -> None:
    file = tmp_path / "stage.ul"
    file.write_text("link stage (ADDRESS=8);\npublic stage() {\n   motor: stepgen();\n}\n", encoding="utf-8")
    with connect(f"sim:{file}", time="lockstep") as link:
        link.write(SPEED, 20_000 * 256)
        link.write(ACCELERATION, 8000)
        link.write(TARGET, 100)
        link.write(CONTROL, 1)
        link.step(3600.0)
        busy_s = time.process_time()
        assert link.read(5) == 100, "it has gone there meanwhile"
        assert time.process_time() - busy_s < 1.0


def test_a_device_that_does_not_answer_costs_nothing_while_it_is_awaited(tmp_path: Path) -> None:
    file = tmp_path / "well.ul"
    text = "link well (ADDRESS=8);\npublic well() {\n   meter: modbus_master();\n}\n"
    file.write_text(text, encoding="utf-8")
    with connect(f"sim:{file}?timeout=30", time="lockstep") as link:
        link.step(60.0)
        busy_s = time.process_time()
        assert link.read(2) > 100, "it has failed so often"
        assert time.process_time() - busy_s < 1.0


def settling(velocity: int, acceleration: int, stop_clock: int, control: int) -> Device:
    """Return a device of two axes, of which one is told to stop. Its event is in group 0."""
    spec = compile_text("link l(ADDRESS=8); public a() { m: stepgen(axes=2); }").spec
    assert spec is not None
    parts = tuple(dataclasses.replace(one, event_groups=(0,)) for one in components_of(spec, CLOCK_HZ))
    device = Device(BoardConfiguration(address_bits=16, publish_mode=0, clock_hz=CLOCK_HZ, components=parts))

    def write(address: int, value: int) -> None:
        device.receive(b"#W:%04X%08X\n" % (address, value & 0xFFFFFFFF))

    device.run_until(5000)
    write(SPEED, 200_000 * 256)
    write(ACCELERATION, acceleration)
    write(VELOCITY_TARGET, velocity * 256)
    write(TARGET, velocity // 50)
    write(CONTROL, control)
    device.run_until(stop_clock)
    write(VELOCITY_TARGET, 0)
    device.run_until(stop_clock + 20_000)
    return device


def moves(device: Device) -> bool:
    """Return whether the status of the first axis says so."""
    status = device.get(STATUS)
    assert status is not None
    return bool(status & 1)


def settled_clock(journey: tuple[int, int, int, int]) -> int | None:
    """Return when the first axis settles, by looking at its status all the time."""
    after = journey[2] + 20_000
    for step in (50_000, 2000, 40):
        device = settling(*journey)
        device.run_until(after)
        while moves(device):
            after = device.clock
            if after > CLOCK_HZ // 2:
                return None
            device.run_until(after + step)
    return after


@pytest.mark.parametrize("seed", range(4))
def test_a_board_that_hears_only_an_event_looks_before_it_comes(seed: int) -> None:
    draw = random.Random(seed)
    checked = 0
    while checked < 3:
        journey = (
            draw.choice([1, -1]) * draw.randrange(100, 100_000),
            draw.choice([3000, 15625, 100_000]),
            draw.randrange(100_000, 2_000_000),
            draw.choice([3, 3, 1]),
        )
        clock = settled_clock(journey)
        for lead in (100, 2000, 100_000, 1_000_000):
            if clock is not None and clock - lead > journey[2] + 20_000:
                device = settling(*journey)
                device.run_until(clock - lead)
                assert device.next_event is not None and device.next_event <= clock + 2, (journey, lead)
                checked += 1
